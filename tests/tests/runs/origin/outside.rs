//! What the outside gives and gets is in the world: states, histories, events, energies, controllers, snapshots, what goes on in another model.

use mbd_compiler::Interpreted;
use mbd_runtime::{Content, Generic, Options, Sampling, Simulation, Trajectory};
use mbd_scene::Scene;
use tests::assert_close;
use tests::declared::read;

/// A capsule under two parachutes, tied to a mast, over a small planet: everything that refers to the world. `knot`: what stands where lines meet.
fn fleet(knot: &str, [family, followed]: [&str; 2]) -> Scene {
    read(&format!(
        "model Fleet {{
            coordinates: {family};
            gravity: point_mass {{ mu: 400000 m^3/s^2, center: [0, 0, -200] m }};
            origin: follows {followed};
            world {{ frame mast at [0, 0, 50] m }}
            body capsule {{ mass: 5 kg, inertia: diag(1, 1.2, 0.8) kg*m^2, frame top at [0, 0, 0.5] m,
                start at [100, 50, 30] m velocity [20, 3, 1] m/s angular_velocity [0.3, 0.2, 0.1] rad/s }}
            body lid {{ mass: 0.5 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame rim at [0, 0, 0.2] m }}
            joint float: free from world to capsule.com;
            joint hinge: hinge from capsule.top to lid.rim {{ axis: x, start: 10 deg, damping: 0.1 N*m*s }}
            point left {{ mass: 1 kg, start at [99, 50, 32.8] m velocity [20, 3, 1] m/s }}
            point right {{ mass: 1.5 kg, start at [101, 50, 32.8] m velocity [20, 3, 1] m/s }}
            point knot {knot}
            line riser from capsule.top to knot {{ free_length: 1 m, stiffness: 2 kN/m, damping: 20 N*s/m }}
            line a from knot to left {{ free_length: 1.5 m, stiffness: 1 kN/m, damping: 10 N*s/m }}
            line b from knot to right {{ free_length: 1.5 m, stiffness: 1 kN/m, damping: 10 N*s/m }}
            spring tether from world.mast to left {{ free_length: 100 m, stiffness: 2 N/m }}
            load drag on left = -0.02 kg/m * norm(left.velocity) * left.velocity + [0, 0, 60] N;
            load wind on right = [0.1 N/m * (right.position.x - 100 m), 0 N, 60 N];
            state flown = 0 m {{ rate: norm(capsule.velocity) }}
            output gap = right.position - capsule.top.position;
            output slip = right.velocity.x - capsule.velocity.x;
            output height = capsule.position.z;
            output sailed = capsule.velocity - [20, 0, 0] m/s;
            event low = capsule.position.z falls 25 m;
        }}"
    ))
}

/// A history of 2 s with everything, and the run.
fn flown(scene: Scene, options: Options) -> (Trajectory, Simulation<f64>) {
    let model = Generic::<f64>::with_defaults(scene).expect("defaults");
    let options = Options {
        work: true,
        momentum: true,
        ..options
    };
    let mut run = Simulation::new(&model, options).expect("options");
    let mut history = Trajectory::new(&model, Sampling::Every(0.125), Content::ALL);
    run.record(2.0, &mut history)
        .unwrap_or_else(|error| panic!("{error}"));
    (history, run)
}

#[test]
fn every_number_that_is_told_is_that_of_a_run_whose_origin_stays() {
    for knot in [
        "{ mass: 0.5 kg, start at [100, 50, 31.6] m velocity [20, 3, 1] m/s }",
        "{ equilibrium: static }",
        "{ equilibrium: rate }",
    ] {
        for family in [
            ["absolute", "capsule"],
            ["relative", "lid"],
            ["absolute", "left"],
        ] {
            let follows = fleet(knot, family);
            let mut stays = follows.clone();
            stays.runs.origin = None;
            let options = Options::tsit5(1e-10);
            let (still, rested) = flown(stays, options);
            let (moving, moved) = flown(follows, options);
            assert_eq!(moving.names(), still.names());
            for name in moving.names() {
                let name = &name.name;
                let [a, b] =
                    [&moving, &still].map(|history| history.column(name).expect("a column"));
                let what = format!("{knot} {family:?} {name}");
                let size = b.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
                assert_close(a, b, 0.0, 3e-6 * size, &what);
            }
            assert_eq!(
                moved.events().len(),
                rested.events().len(),
                "{knot} {family:?}"
            );
            for (a, b) in moved.events().iter().zip(rested.events()) {
                assert!(
                    (a.time - b.time).abs() < 1e-7,
                    "{knot} {family:?} {a:?} {b:?}"
                );
            }
            assert_close(moved.state(), rested.state(), 1e-6, 1e-6, "state");
            assert_close(moved.nodes(), rested.nodes(), 1e-5, 1e-5, "nodes");
            let [a, b] = [&moved, &rested].map(|run| run.imbalance().expect("told").relative());
            assert!(a < 1e-5 && b < 1e-5, "{knot} {family:?}: {a:e} {b:e}");
            // The capsule is never further than the scene is long.
            let (_, near) = moved.near_origin().expect("it follows");
            assert!(near[..3].iter().all(|x| x.abs() < 101.0), "{near:?}");
        }
    }
}

#[test]
fn a_stepwise_node_with_its_memory_is_the_same_wherever_the_origin_is() {
    for family in [["absolute", "capsule"], ["relative", "lid"]] {
        for formula in ["stepwise", "stepwise { formula: bdf2 }"] {
            let follows = fleet(&format!("{{ equilibrium: {formula} }}"), family);
            let mut stays = follows.clone();
            stays.runs.origin = None;
            let options = Options::rk4(2e-3);
            let (still, rested) = flown(stays, options);
            let (moving, moved) = flown(follows, options);
            for name in moving.names() {
                let name = &name.name;
                let [a, b] =
                    [&moving, &still].map(|history| history.column(name).expect("a column"));
                let what = format!("{formula} {family:?} {name}");
                let size = b.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
                assert_close(a, b, 0.0, 1e-8 * size, &what);
            }
            assert_close(moved.nodes(), rested.nodes(), 1e-9, 1e-9, "nodes");
            let (_, near) = moved.near_origin().expect("it follows");
            assert!(near[..3].iter().all(|x| x.abs() < 101.0), "{near:?}");
        }
    }
}

/// A stone on a riser under two lines to points that are braked: lines of 2 m.
fn braked(family: &str) -> Scene {
    read(&format!(
        "model Braked {{
           coordinates: {family};
           gravity: [0, 0, -9.81] m/s^2;
           origin: follows stone;
           body stone {{
             mass: 10 kg, inertia: diag(0.1, 0.2, 0.3) kg*m^2, frame top at [0, 0.1, 0.3] m,
             start at [0, 0, 3000] m velocity [3, 0, -20] m/s
           }}
           joint flies: free from world to stone.com
           point knot {{ equilibrium: stepwise }}
           point brake[i in 0..2] {{ mass: 0.5 kg, start at [i - 0.5, 0, 3004.5] m velocity [3, 0, -20] m/s }}
           line riser from stone.top to knot {{ free_length: 2 m, stiffness: 2 kN/m, damping: 60 N*s/m }}
           line leg[i in 0..2] from knot to brake[i] {{ free_length: 2 m, stiffness: 1 kN/m, damping: 30 N*s/m }}
           load air[i in 0..2] on brake[i] = -0.3 kg/m * norm(brake[i].velocity) * brake[i].velocity;
         }}"
    ))
}

#[test]
fn what_a_stepwise_node_damps_is_the_same_at_the_steps_after_which_the_origin_moves_on() {
    for family in ["absolute", "relative"] {
        let follows = braked(family);
        let mut stays = follows.clone();
        stays.runs.origin = None;
        let [moving, still] = [follows, stays].map(|scene| {
            let model = Generic::<f64>::with_defaults(scene).expect("defaults");
            let options = Options {
                work: true,
                ..Options::rk4(2e-3)
            };
            let mut run = Simulation::new(&model, options).expect("options");
            let mut history = Trajectory::new(&model, Sampling::Steps, Content::ALL);
            run.record(3.0, &mut history)
                .unwrap_or_else(|error| panic!("{error}"));
            history
        });
        for name in ["power.dampers", "work.dampers", "riser.tension"] {
            let [a, b] = [&moving, &still].map(|history| history.column(name).expect("a column"));
            let size = b.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
            assert_close(a, b, 0.0, 1e-6 * size, &format!("{family} {name}"));
        }
    }
}

#[test]
fn a_place_in_the_world_is_passed_once_however_its_last_digits_go_up_and_down() {
    // 6.4e6 m away the world has digits of 1e-9 m, and a place there is the sum of that of the origin and of what is measured from it.
    for guard in ["dart.position.x", "norm(dart.position)"] {
        let scene = read(&format!(
            "model Passing {{
               gravity: [-9.81, 0, 0] m/s^2;
               origin: follows dart;
               state passed = 0 {{ rate: 0 }}
               point dart {{ mass: 1 kg, start at [6.4001e6, 0, 0] m velocity [-30, 1200, 3] m/s }}
               point tail {{ mass: 1 kg, start at [6.4001e6, 2, 0] m velocity [-30, 1200, 3] m/s }}
               spring tie from dart to tail {{ free_length: 1 m, stiffness: 400 N/m }}
               event mark[i in 0..400] = {guard} falls 6.4001e6 m - (i + 1) * 0.0625 m
                 {{ set: passed = passed + 1 }}
             }}"
        ));
        let model = Interpreted::<f64>::new(scene, &[]).expect("no params");
        let mut run = Simulation::new(&model, Options::rodas5p(1e-8)).expect("options");
        run.run(0.8).unwrap_or_else(|error| panic!("{error}"));
        let passed = run.state().last().copied();
        assert_eq!((passed, run.events().len()), (Some(400.0), 400), "{guard}");
    }
}

mod runs {
    //! Runs that are stopped, driven, gone on with.

    use mbd_runtime::{
        Batch, Case, Content, Generic, NoLoads, Options, PointState, Sampling, Simulation, Stop,
        Trajectory, model,
    };
    use tests::assert_close;

    use super::fleet;

    model! {
        /// Two stages far away that hang together by a spring until they part.
        pub model Stack<T> {
            gravity: none;
            origin: follows upper;
            input thrust: force;
            point lower { mass: 3 kg, start at [1000000000, 0, 0] m velocity [7000, 0, 0] m/s }
            point upper { mass: 1 kg, start at [1000000001.5, 0, 0] m velocity [7000, 0, 0] m/s }
            spring clamp from lower to upper { free_length: 1.5 m, stiffness: 100 N/m }
            load push on lower = [thrust, 0 N, 0 N];
            output speed = lower.velocity.x;
            event parted = time rises 1 s { detach: clamp, then: stop }
        }
    }

    model! {
        /// The upper stage and what it leaves behind, without a clamp.
        pub model Apart<T> {
            gravity: none;
            origin: follows lower;
            point upper { mass: 1 kg }
            point lower { mass: 3 kg }
            spring tape from lower to upper { free_length: 1.5 m, stiffness: 25 N/m }
            output stretch = tape.stretch;
        }
    }

    model! {
        /// The same, its origin in the world.
        pub model Still {
            gravity: none;
            point upper { mass: 1 kg }
            point lower { mass: 3 kg }
            output gap = upper.position - lower.position;
        }
    }

    #[test]
    fn a_snapshot_goes_on_to_the_bit() {
        for knot in [
            "{ mass: 0.5 kg, start at [100, 50, 31.6] m }",
            "{ equilibrium: rate }",
            "{ equilibrium: static }",
        ] {
            for options in [
                Options::tsit5(1e-8),
                Options::rk4(1e-3),
                Options::rodas5p(1e-6),
            ] {
                let model = Generic::<f64>::with_defaults(fleet(knot, ["absolute", "capsule"]))
                    .expect("defaults");
                let mut run = Simulation::new(&model, options).expect("options");
                run.run(1.0).expect("a flight");
                let kept = run.snapshot();
                run.run(1.5).expect("a flight");
                let mut other = Simulation::new(&model, options).expect("options");
                other.restore(&kept).expect("a snapshot of this model");
                assert_eq!(other.time(), 1.0);
                other.run(1.5).expect("a flight");
                assert_eq!(run.near_origin(), other.near_origin(), "{knot}");
                assert_eq!(run.state(), other.state(), "{knot}");
            }
        }
    }

    #[test]
    fn controllers_and_starts_see_the_world() {
        let stack = Stack::<f64>::new(Default::default()).expect("defaults");
        let mut run = Simulation::new(&stack, Options::tsit5(1e-10)).expect("options");
        run.control(|sample: &StackSample<'_>, inputs: &mut StackInputs| {
            let state = sample.state().lower();
            // As far in the world as it says, and as fast.
            let far = state.position[0] >= 1e9 && state.velocity[0] > 6900.0;
            inputs.thrust = if far { 4.0 } else { f64::NAN };
        })
        .expect("inputs");
        assert_eq!(run.run(5.0).expect("a flight"), Stop::Event(0));
        let end = StackState::from_slice(run.state()).expect("a state");
        // Together 4 kg under 4 N for a second.
        let momentum = 3.0 * end.lower().velocity[0] + end.upper().velocity[0];
        assert!((momentum - 4.0 * 7001.0).abs() < 1e-8, "{momentum}");
        let mut again = Simulation::new(&stack, Options::tsit5(1e-10)).expect("options");
        again
            .set_inputs(&StackInputs { thrust: 0.0 })
            .expect("inputs");
        again.set_state(2.0, &end.to_vec()).expect("a state");
        assert_eq!(again.state(), end.to_vec());
        let (origin, near) = again.near_origin().expect("it follows");
        assert_eq!(origin, [end.upper().position, end.upper().velocity]);
        assert_eq!(near[3..6], [0.0; 3]);
    }

    #[test]
    fn another_model_goes_on_with_the_digits_of_the_first() {
        let stack = Stack::<f64>::new(Default::default()).expect("defaults");
        let apart = Apart::<f64>::new(Default::default()).expect("defaults");
        let mut first = Simulation::new(&stack, Options::vern7(1e-12)).expect("options");
        first
            .set_inputs(&StackInputs { thrust: 8.0 })
            .expect("inputs");
        first.run(5.0).expect("a flight");
        let gap = |state: &[f64], [a, b]: [usize; 2]| state[3 * b] - state[3 * a];
        let before = gap(first.near_origin().expect("it follows").1, [0, 1]);
        // ẍ = −100 (1/3 + 1) x − 8/3 from rest: x = −(8/3)/ω² (1 − cos ω t).
        let omega = (100.0_f64 * (1.0 / 3.0 + 1.0)).sqrt();
        let exact = 1.5 - 8.0 / 3.0 / omega.powi(2) * (1.0 - omega.cos());
        assert!((before - exact).abs() < 1e-10, "{before} {exact}");
        let mut second = Simulation::new(&apart, Options::vern7(1e-12)).expect("options");
        second.take_over(&mut first, &[]).expect("a start");
        let after = gap(second.near_origin().expect("it follows").1, [1, 0]);
        assert!((after - before).abs() < 1e-13, "{after} {before}");
        second.run(2.0).expect("a flight");
        // Where no origin follows, what goes on has the digits of the world.
        let mut third = Simulation::new(
            &Still::new(Default::default()).expect("defaults"),
            Options::rk4(0.1),
        )
        .expect("options");
        third.take_over(&mut second, &[]).expect("a start");
        assert_eq!(third.state(), second.state());
        let mut fourth = Simulation::new(&apart, Options::vern7(1e-12)).expect("options");
        let given = [1e9, 5.0, 0.0, 0.0, 0.0, 0.0];
        fourth
            .take_over(&mut third, &[("upper", &given)])
            .expect("a start");
        let state = ApartState::from_slice(fourth.state()).expect("a state");
        assert_eq!(
            state.upper(),
            PointState {
                position: [1e9, 5.0, 0.0],
                velocity: [0.0; 3]
            }
        );
    }

    #[test]
    fn cases_of_a_batch_are_the_runs_they_are_alone() {
        let stack = Stack::<f64>::new(Default::default()).expect("defaults");
        let case = |k: u32| {
            Case::new().inputs(&StackInputs {
                thrust: f64::from(k),
            })
        };
        let options = Options::tsit5(1e-8);
        let finished = Batch::new(&stack, options, 0.9)
            .cases((0..9).map(case))
            .run(|_, history| history.column("speed").unwrap_or_default().to_vec());
        for (k, finished) in finished.iter().enumerate() {
            let mut alone = Simulation::new(&stack, options).expect("options");
            alone
                .set_inputs(&StackInputs { thrust: k as f64 })
                .expect("inputs");
            let mut history = Trajectory::new(&stack, Sampling::Steps, Content::RESULTS);
            alone.record(0.9, &mut history).expect("a flight");
            let speeds = finished.result.as_ref().expect("a flight").last();
            let own = history.column("speed").expect("an output");
            assert_eq!(speeds, own.last(), "{k}");
        }
    }

    #[test]
    fn the_symplectic_method_and_histories_in_single_precision_have_the_world() {
        let stack = Stack::<f64>::new(Default::default()).expect("defaults");
        let mut run = Simulation::new(&stack, Options::rattle(1e-3)).expect("options");
        run.set_inputs(&StackInputs { thrust: 0.0 })
            .expect("inputs");
        run.run(0.9).expect("a flight");
        let x = 1e9 + 7000.0 * 0.9;
        assert_close(&run.state()[..1], &[x], 0.0, 1e-6, "place");
        let single = Stack::<f32>::new(Default::default()).expect("defaults");
        let mut run =
            Simulation::with_loads(&single, Options::rk4(1e-3), NoLoads).expect("options");
        run.set_inputs(&StackInputs { thrust: 0.0_f32 })
            .expect("inputs");
        let mut history = Trajectory::new(&single, Sampling::Every(0.3), Content::ALL);
        run.record(0.9, &mut history).expect("a flight");
        let found = history.column("lower.x").expect("a column");
        let exact = [0.0, 0.3, 0.6, 0.9].map(|time| 1e9 + 7000.0 * time);
        // In f32 numbers are 64 m apart there; what is told has the digits of f64.
        assert_close(found, &exact, 0.0, 1e-3, "places of f32");
    }
}
