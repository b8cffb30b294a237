//! An origin that follows what flies, in scenes where joints hold other things to the world: their ends there are measured from it, too.

use mbd_compiler::Interpreted;
use mbd_runtime::{
    Content, Generic, Model, Options, Sampling, Simulation, StepError, Trajectory, model,
};
use mbd_scene::Scene;
use tests::agreement::agrees;
use tests::assert_close;
use tests::declared::read;

/// A drone on a line to the tip of a crane: the crane turns on the world, with a hook on a hinge and a counterweight that a moving frame of the world
/// guides, and closes a loop with a strut.
macro_rules! yard {
    ($name:ident $family:ident) => {
        model! {
            /// A crane and a drone.
            pub model $name<T> {
                coordinates: $family;
                gravity: [0, 0, -9.81] m/s^2;
                origin: follows drone;
                verify;
                world { frame pad at [40, 10, 2] m, frame far at [41.2, 10, 2] m, frame rail at [30 m + 1 m/s * time, 0 m, sin(1 rad/s * time) * 0.1 m] }
                body arm { mass: 10 kg, inertia: diag(3, 3, 1) kg*m^2, frame foot at [0, 0, -1] m, frame tip at [0, 0, 1] m, frame middle at [0, 0, 0] m }
                body hook { mass: 2 kg, inertia: diag(0.2, 0.2, 0.1) kg*m^2, frame eye at [0, 0, 0.3] m }
                body strut { mass: 1 kg, inertia: diag(0.2, 0.2, 0.1) kg*m^2, frame low at [0, 0, -0.7] m, frame high at [0, 0, 0.7] m }
                body cart { mass: 4 kg, inertia: diag(1, 1, 1) kg*m^2, frame box at [0.1, 0, 0] m }
                body drone { mass: 3 kg, inertia: diag(0.2, 0.3, 0.4) kg*m^2, frame belly at [0, 0, -0.1] m,
                    start at [45, 12, 8] m velocity [9, 2, 6] m/s angular_velocity [0.2, 0.1, 0.3] rad/s }
                joint slew: hinge from world.pad to arm.foot { axis: y, start: 20 deg, damping: 3 N*m*s }
                joint swivel: spherical from arm.tip to hook.eye;
                joint stay: hinge from world.far to strut.low { axis: y }
                joint slide: point_on_line from arm.middle to strut.high { axis: z }
                joint guide: prismatic from world.rail to cart.box { axis: x, start_rate: 0.5 m/s, stiffness: 20 N/m, damping: 1 N*s/m }
                joint flying: free from world to drone.com;
                line leash from arm.tip to drone.belly { free_length: 3 m, stiffness: 60 N/m, damping: 3 N*s/m }
                line tail from cart.com to drone.belly { free_length: 9 m, stiffness: 5 N/m, damping: 1 N*s/m }
                output above = drone.position - hook.position;
                output turned = slew.angle;
                output rolled = guide.slide;
                output pull = norm(slew.force);
            }
        }
    };
}
yard!(Absolute absolute);
yard!(Relative relative);

#[test]
fn generated_and_interpreted_equations_are_those_of_the_laws_where_joints_end_in_the_world() {
    agrees(&Absolute::<f64>::new(Default::default()).expect("defaults"));
    agrees(&Relative::<f64>::new(Default::default()).expect("defaults"));
}

/// A history of 1.5 s with everything.
fn flown(model: &dyn Model<f64>, options: Options) -> Trajectory {
    let options = Options {
        work: true,
        momentum: true,
        ..options
    };
    let mut run = Simulation::new(model, options).expect("options");
    let mut history = Trajectory::new(model, Sampling::Every(0.125), Content::ALL);
    run.record(1.5, &mut history)
        .unwrap_or_else(|error| panic!("{error}"));
    history
}

#[test]
fn a_run_among_joints_to_the_world_is_that_of_an_origin_that_stays() {
    let absolute = Absolute::<f64>::new(Default::default()).expect("defaults");
    let relative = Relative::<f64>::new(Default::default()).expect("defaults");
    for generated in [&absolute as &dyn Model<f64>, &relative] {
        let scene = generated.scene().clone();
        let mut stays: Scene = scene.clone();
        stays.runs.origin = None;
        let stays = Generic::<f64>::with_defaults(stays).expect("defaults");
        let interpreted = Interpreted::<f64>::new(scene.clone(), &[]).expect("no params");
        let generic = Generic::<f64>::with_defaults(scene).expect("defaults");
        // Fixed steps are the same ones in both runs, whatever their length.
        let rattle = Options::rattle(4e-3);
        for options in [
            Options::tsit5(1e-10),
            Options::rodas5p(1e-8),
            Options::rk4(4e-3),
            rattle,
        ] {
            if options == rattle && generated.layout().tree.is_some() {
                continue;
            }
            let still = flown(&stays, options);
            // The laws are the same to the bit: `agrees`; one method flies all executions.
            let others = [&interpreted as &dyn Model<f64>, &generic];
            let others = others
                .into_iter()
                .filter(|_| options == Options::tsit5(1e-10));
            for model in others.chain([generated]) {
                let moving = flown(model, options);
                assert_eq!(moving.names(), still.names());
                for name in moving.names() {
                    let name = &name.name;
                    let [a, b] =
                        [&moving, &still].map(|history| history.column(name).expect("a column"));
                    let what = format!(
                        "{} {} {name}",
                        options.method.name(),
                        generated.scene().name
                    );
                    let size = b.iter().fold(10.0_f64, |most, x| most.max(x.abs()));
                    assert_close(a, b, 0.0, 1e-7 * size, &what);
                }
            }
        }
    }
}

/// A rocket on its pad 1e9 m away, with a payload on a spring; it is let go after a second and pushed.
fn launch(family: &str) -> Scene {
    read(&format!(
        "model Launch {{ gravity: none; coordinates: {family}; origin: follows rocket;
            world {{ frame pad at [1000000000, 0, 0] m }}
            body rocket {{ mass: 2 kg, inertia: diag(1, 1, 1) kg*m^2, start at [1000000000, 0, 0] m }}
            joint afloat: free from world to rocket.com;
            joint clamp: rigid from world.pad to rocket.com;
            point payload {{ mass: 3 kg, start at [1000000001.25, 0, 0] m }}
            spring tie from rocket.com to payload {{ free_length: 1 m, stiffness: 120 N/m }}
            event released = time rises 1 s {{ detach: clamp }}
            output stretch = tie.stretch; }}"
    ))
}

#[test]
fn what_a_joint_holds_far_away_until_it_is_let_go_has_the_digits_of_its_scene() {
    for family in ["absolute", "relative"] {
        let model = Generic::<f64>::with_defaults(launch(family)).expect("defaults");
        let mut run = Simulation::new(&model, Options::vern7(1e-12)).expect("options");
        let stretch = |run: &mut Simulation<f64>| {
            let mut out = [0.0];
            run.evaluate(mbd_runtime::Quantity::Outputs, &mut out)
                .expect("outputs");
            out[0]
        };
        run.run(1.0)
            .unwrap_or_else(|error| panic!("{family}: {error}"));
        // Held: ω² = 120/3; then free: ω² = 120 (1/2 + 1/3), from the stretch and the rate of that instant.
        let held = 40.0_f64.sqrt();
        let [at, rate] = [0.25 * held.cos(), -0.25 * held * held.sin()];
        assert!((stretch(&mut run) - at).abs() < 1e-10, "{family}");
        run.run(3.0)
            .unwrap_or_else(|error| panic!("{family}: {error}"));
        let free = 100.0_f64.sqrt();
        let exact = at * (2.0 * free).cos() + rate / free * (2.0 * free).sin();
        let found = stretch(&mut run);
        assert!((found - exact).abs() < 1e-9, "{family}: {found} {exact}");
    }
}

#[test]
fn joints_far_from_what_flies_lose_their_digits_and_say_so() {
    // The pendulum at the world origin, the origin with a probe that is 1e15 m away.
    let run = |far: f64| {
        let scene = read(&format!(
            "model Two {{ gravity: [0, 0, -9.81] m/s^2; origin: follows probe;
                point probe {{ mass: 1 kg, start at [{far:?}, 0, 0] m }}
                body bob {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame top at [0, 0, 1] m }}
                joint pin: hinge from world to bob.top {{ axis: y, start: 0.5 rad }} }}"
        ));
        let model = Generic::<f64>::with_defaults(scene).expect("defaults");
        let mut run = Simulation::new(&model, Options::tsit5(1e-6)).expect("options");
        let ended = run.run(0.5).map_err(|error| error.cause);
        (ended, run.rounding())
    };
    let (near, share) = run(1e6);
    assert!(near.is_ok(), "{near:?}");
    assert!(
        (share / (2.0 * f64::EPSILON * 1e6) - 1.0).abs() < 0.6,
        "{share:e}"
    );
    let (far, _) = run(1e16);
    assert!(
        matches!(far, Err(StepError::FarFromOrigin { .. })),
        "{far:?}"
    );
}
