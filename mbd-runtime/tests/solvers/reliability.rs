//! What is promised when something goes wrong, and what never changes.

use std::cell::Cell;

use super::support::*;
use mbd_runtime::scene::{
    Clamp, Difference, Direction, Formula, Load, LoadKind, NodeModel, Place, PointKind, Scene,
};
use mbd_runtime::{
    Collapse, Content, External, Generic, Method, Options, RunError, Sampling, Simulation, Source,
    StepError, Stop, Trajectory,
};

const RATE: PointKind = PointKind::Node(NodeModel::Rate);
const STATIC: PointKind = PointKind::Node(NodeModel::Static);
const STEPWISE: PointKind = PointKind::Node(NodeModel::Stepwise {
    formula: Difference::Bdf2,
    clamp: Clamp::Positive,
});

/// The parachute of case 3 from t = 0.
fn case3(node: &PointKind) -> (Generic<f64>, Vec<f64>, Vec<f64>) {
    let file = reference("parachute/case3_mass_0p1kg.json");
    let state = parachute_state(&file, node.clone());
    (
        generic(parachute(&file, node.clone())),
        state,
        floats(&file["node_x"][0]),
    )
}

fn begin(
    model: &Generic<f64>,
    options: Options,
    state: &[f64],
    nodes: &[f64],
    node: &PointKind,
) -> Simulation<f64> {
    let mut simulation = Simulation::new(model, options).unwrap();
    simulation.set_state(0.0, state).unwrap();
    if matches!(node, PointKind::Node(_)) {
        simulation.set_nodes(nodes).unwrap();
    }
    simulation
}

#[test]
fn a_run_continued_from_a_snapshot_is_equal_to_the_bit() {
    let mass = PointKind::Mass(1.0.into());
    let cases = [
        (&mass, Options::tsit5(1e-7)),
        (&mass, Options::rk4(1e-3)),
        (&RATE, Options::rk4(0.01)),
        (&RATE, Options::tsit5(1e-7)),
        (&STATIC, Options::rk4(2e-3)),
        (&STEPWISE, Options::rk4(0.01)),
        (
            &STEPWISE,
            Options {
                work: true,
                ..Options::rk4(0.01)
            },
        ),
    ];
    for (node, options) in cases {
        let (model, state, nodes) = case3(node);
        let mut straight = begin(&model, options, &state, &nodes, node);
        (0..40).for_each(|_| straight.step().unwrap());
        let snapshot = straight.snapshot();
        (0..60).for_each(|_| straight.step().unwrap());
        let mut resumed = Simulation::new(&model, options).unwrap();
        resumed.restore(&snapshot).unwrap();
        (0..60).for_each(|_| resumed.step().unwrap());
        assert_eq!(
            straight.time().to_bits(),
            resumed.time().to_bits(),
            "{options:?}"
        );
        let bits = |x: &[f64]| x.iter().map(|x| x.to_bits()).collect::<Vec<u64>>();
        assert_eq!(
            bits(straight.state()),
            bits(resumed.state()),
            "{node:?} {options:?}"
        );
        assert_eq!(straight.memory(), resumed.memory());
        assert_eq!(straight.work(), resumed.work());
        assert_eq!(straight.snapshot(), resumed.snapshot());
    }
}

#[test]
fn recording_a_run_does_not_change_a_bit_of_it() {
    for (node, options) in [
        (&RATE, Options::rk4(0.01)),
        (&STEPWISE, Options::rk4(0.01)),
        (&STATIC, Options::tsit5(1e-7)),
    ] {
        let (model, state, nodes) = case3(node);
        let mut plain = begin(&model, options, &state, &nodes, node);
        plain.run(1.0).unwrap();
        for sampling in [Sampling::Every(0.0031), Sampling::Steps] {
            let mut recorded = begin(&model, options, &state, &nodes, node);
            let mut trajectory = Trajectory::new(&model, sampling, Content::ALL);
            recorded.record(1.0, &mut trajectory).unwrap();
            assert_eq!(plain.snapshot(), recorded.snapshot());
            assert_eq!(plain.statistics(), recorded.statistics());
        }
    }
}

/// A point of 1 kg pulled by an external force.
fn pulled() -> Scene {
    let mut scene = empty("Pulled");
    scene.points.push(point("bob", PointKind::Mass(1.0.into())));
    scene.loads.push(Load {
        name: "thruster".into(),
        doc: String::new(),
        at: Place::Point(0),
        kind: LoadKind::External,
    });
    scene
}

/// A force of 1 N along x that turns to NaN when the point has gone too far, or after some calls.
struct Failing {
    beyond: f64,
    calls: Cell<u64>,
    after: u64,
}

impl External<f64> for Failing {
    fn evaluate(&self, _: f64, state: &[f64], out: &mut [f64]) {
        self.calls.set(self.calls.get() + 1);
        let fails = state[0] > self.beyond || self.calls.get() > self.after;
        out.fill(0.0);
        out[0] = if fails { f64::NAN } else { 1.0 };
    }
}

#[test]
fn a_load_that_turns_to_nan_is_named_and_the_last_accepted_step_is_kept() {
    let model = generic(pulled());
    for options in [
        Options::rk4(0.05),
        Options {
            method: Method::Tsit5 {
                rtol: 1e-6,
                max_step: 0.05,
            },
            ..Options::tsit5(1e-6)
        },
    ] {
        let failing = |beyond, after| Failing {
            beyond,
            calls: Cell::new(0),
            after,
        };
        let mut simulation =
            Simulation::with_loads(&model, options, failing(f64::INFINITY, 100)).unwrap();
        let error = simulation.run(10.0).unwrap_err();
        let StepError::NonFinite {
            source: Source::Load(name),
            ..
        } = &error.cause
        else {
            panic!("{error}");
        };
        assert_eq!(name, "thruster");
        assert!(error.to_string().contains("thruster"), "{error}");
        // The same run, stopped there.
        let mut other =
            Simulation::with_loads(&model, options, failing(f64::INFINITY, u64::MAX)).unwrap();
        while other.statistics().steps < simulation.statistics().steps {
            other.step().unwrap();
        }
        assert_eq!(other.time(), simulation.time());
        assert_eq!(other.state(), simulation.state());
        assert_eq!(error.progress.time, simulation.time());
        // The run may continue after repair: here the load fails only beyond 2 m.
        let mut near = Simulation::with_loads(&model, options, failing(2.0, u64::MAX)).unwrap();
        let error = near.run(10.0).unwrap_err();
        assert!(
            matches!(error.cause, StepError::NonFinite { .. }),
            "{error}"
        );
        assert!(
            near.state()[0] <= 2.0 && near.state()[0] > 1.8,
            "{:?}",
            near.state()
        );
    }
}

#[test]
fn a_rejected_trial_leaves_state_and_memory_to_the_bit() {
    let (model, state, nodes) = case3(&RATE);
    let options = Options {
        locate: false,
        max_steps: 1,
        ..Options::tsit5(1e-8)
    };
    let mut simulation = begin(&model, options, &state, &nodes, &RATE);
    simulation.start().unwrap();
    let mut rejected = 0;
    while simulation.time() < 0.6 {
        let (time, state) = (simulation.time(), simulation.state().to_vec());
        let (memory, counted) = (simulation.memory().clone(), simulation.statistics());
        // The budget is one trial, accepted or rejected.
        let error = simulation.run(1.0).unwrap_err();
        assert_eq!(
            error.cause,
            StepError::TooManySteps {
                steps: 1,
                stiff: None
            }
        );
        if simulation.statistics().rejected > counted.rejected {
            rejected += 1;
            assert_eq!(simulation.statistics().steps, counted.steps);
            assert_eq!(simulation.time().to_bits(), time.to_bits());
            assert_eq!(simulation.state(), state);
            assert_eq!(*simulation.memory(), memory);
        }
    }
    assert!(rejected > 3, "{rejected}");
}

#[test]
fn numbers_that_cannot_be_used_are_refused_before_any_step() {
    let model = generic(bouncing(1e4, 10.0));
    let invalid = |result: Result<(), RunError>, slot: &str| {
        let error = result.unwrap_err();
        let StepError::InvalidInput { slot: found, .. } = &error.cause else {
            panic!("{error}");
        };
        assert!(found.contains(slot), "{found} is not {slot}");
        assert_eq!(error.progress.statistics.steps, 0);
    };
    let names = ["bob.x", "bob.y", "bob.z", "bob.vx", "bob.vy", "bob.vz"];
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
        for (slot, name) in names.iter().enumerate() {
            let mut simulation = Simulation::new(&model, Options::rk4(1e-3)).unwrap();
            let mut state = [0.0; 6];
            state[slot] = bad;
            invalid(simulation.set_state(0.0, &state), name);
        }
        let mut simulation = Simulation::new(&model, Options::rk4(1e-3)).unwrap();
        if bad != 1e300 {
            invalid(simulation.set_state(bad, &[0.0; 6]), "time");
            invalid(simulation.run(bad).map(|_| ()), "end time");
            let step = Simulation::new(&model, Options::rk4(bad)).map(|_| ());
            invalid(step, "step");
            invalid(
                Simulation::new(
                    &model,
                    Options {
                        guard_tolerance: Some(bad),
                        ..Options::rk4(1e-3)
                    },
                )
                .map(|_| ()),
                "guard",
            );
        }
        invalid(
            Simulation::new(&model, Options::tsit5(bad)).map(|_| ()),
            "rtol",
        );
    }
    for step in [0.0, -1e-3] {
        invalid(
            Simulation::new(&model, Options::rk4(step)).map(|_| ()),
            "step",
        );
        invalid(
            Simulation::new(&model, Options::tsit5(step)).map(|_| ()),
            "rtol",
        );
    }
    // Beyond half a turn nothing tells which turn an angle is in: whatever the steps, what is asked for is what is done.
    for max_angle in [0.0, -1.0, 2.0 + 1e-9, 5.0, f64::INFINITY, f64::NAN] {
        for options in [Options::rk4(1e-3), Options::tsit5(1e-6)] {
            let options = Options {
                max_angle,
                ..options
            };
            invalid(Simulation::new(&model, options).map(|_| ()), "max_angle");
        }
    }
    let mut simulation = Simulation::new(&model, Options::rk4(1e-3)).unwrap();
    let short = simulation.set_state(0.0, &[0.0; 5]).unwrap_err();
    assert_eq!(
        short.cause.to_string(),
        "state: 5 numbers were given, and it has 6 in this model"
    );
    let free = generic(free_body([1.0, 2.0, 3.0]));
    let mut turning = Simulation::new(&free, Options::rk4(1e-3)).unwrap();
    invalid(turning.set_state(0.0, &[0.0; 13]), "quaternion");
    let mut trajectory = Trajectory::new(&model, Sampling::Every(f64::NAN), Content::ALL);
    invalid(
        simulation.record(1.0, &mut trajectory).map(|_| ()),
        "sampling",
    );
}

#[test]
fn a_chattering_line_is_reported_by_name_instead_of_grinding_on() {
    // A stiff cord: the mass bounces by a millimetre, 35 times a second, for hours.
    let model = generic(bouncing(1e10, 0.0));
    let mut simulation = Simulation::new(&model, Options::tsit5(1e-9)).unwrap();
    simulation
        .set_state(0.0, &[0.0, 0.0, -0.999, 0.0, 0.0, 0.0])
        .unwrap();
    let started = std::time::Instant::now();
    let error = simulation.run(1e4).unwrap_err();
    let StepError::EventChatter {
        line,
        is_event,
        count,
        window,
    } = &error.cause
    else {
        panic!("{error}");
    };
    assert_eq!((line.as_str(), *is_event, *count), ("cord", false, 200));
    assert!((*window - 10.0).abs() < 1e-9);
    assert!(started.elapsed().as_secs_f64() < 5.0);
}

#[test]
fn a_load_without_a_limit_collapses_the_step_with_a_cause() {
    let model = generic(pulled());
    struct Blows;
    impl External<f64> for Blows {
        fn evaluate(&self, _: f64, state: &[f64], out: &mut [f64]) {
            out.fill(0.0);
            // v̇ = 1 + v²: tan t.
            out[0] = 1.0 + state[3] * state[3];
        }
    }
    let mut simulation = Simulation::with_loads(&model, Options::tsit5(1e-8), Blows).unwrap();
    let error = simulation.run(2.0).unwrap_err();
    assert!(
        matches!(error.cause, StepError::StepCollapse { .. }),
        "{error}"
    );
    assert!((simulation.time() - std::f64::consts::FRAC_PI_2).abs() < 1e-3);
    // A jump that no step resolves.
    struct Jumps;
    impl External<f64> for Jumps {
        fn evaluate(&self, _: f64, state: &[f64], out: &mut [f64]) {
            out.fill(0.0);
            out[0] = if state[0] < 0.5 { 1.0 } else { 1e12 };
        }
    }
    let options = Options {
        locate: false,
        ..Options::tsit5(1e-9)
    };
    let mut simulation = Simulation::with_loads(&model, options, Jumps).unwrap();
    let error = simulation.run(2.0).unwrap_err();
    assert!(
        matches!(&error.cause, StepError::StepCollapse { cause: Collapse::ErrorTest, block, .. } if block.contains("bob")),
        "{error}"
    );
}

#[test]
fn a_fixed_step_above_the_limit_is_reported_with_a_step_that_works() {
    let (model, state, nodes) = case3(&PointKind::Mass(0.1.into()));
    let mut simulation = begin(
        &model,
        Options::rk4(2.5e-4),
        &state,
        &nodes,
        &PointKind::Mass(0.1.into()),
    );
    let error = simulation.run(10.0).unwrap_err();
    let StepError::UnstableStep { suggestion, .. } = error.cause else {
        panic!("{error}");
    };
    assert!(suggestion < 1.6e-4, "{error}");
    let mut again = begin(
        &model,
        Options::rk4(1.5e-4),
        &state,
        &nodes,
        &PointKind::Mass(0.1.into()),
    );
    again.run(2.0).unwrap();
    let unwatched = Options {
        watch: false,
        ..Options::rk4(2.5e-4)
    };
    let mut unwatched = begin(
        &model,
        unwatched,
        &state,
        &nodes,
        &PointKind::Mass(0.1.into()),
    );
    let _ = unwatched.run(1.0);
}

#[test]
fn budget_cancellation_and_unsupported_combinations_are_typed() {
    let model = generic(bouncing(1e4, 10.0));
    let mut simulation = Simulation::new(
        &model,
        Options {
            max_steps: 10,
            ..Options::rk4(1e-3)
        },
    )
    .unwrap();
    let error = simulation.run(1.0).unwrap_err();
    assert_eq!(
        error.cause,
        StepError::TooManySteps {
            steps: 10,
            stiff: None
        }
    );
    assert!((simulation.time() - 0.01).abs() < 1e-12);
    let mut simulation = Simulation::new(&model, Options::rk4(1e-3)).unwrap();
    let error = simulation
        .run_while(1.0, None, &mut |time| time < 0.1)
        .unwrap_err();
    assert_eq!(error.cause, StepError::Cancelled);
    assert!((simulation.time() - 0.1).abs() < 1e-9);
    simulation.run(1.0).unwrap();
    let (model, ..) = case3(&STEPWISE);
    let error = Simulation::new(&model, Options::tsit5(1e-6))
        .map(|_| ())
        .unwrap_err();
    assert!(matches!(error.cause, StepError::Unsupported { .. }));
    assert!(
        error.to_string().contains("confluence") && error.to_string().contains("Rk4"),
        "{error}"
    );
    let model = generic(pulled());
    let mut unsupplied = Simulation::new(&model, Options::rk4(1e-3)).unwrap();
    let error = unsupplied.run(1.0).unwrap_err();
    assert!(error.to_string().contains("thruster"), "{error}");
}

#[test]
fn declared_events_are_located_named_and_stop_the_run() {
    let mut scene = bouncing(1e4, 0.0);
    scene
        .events
        .push(event("half_way", apply_height(-0.5), Direction::Falls));
    scene
        .events
        .push(event("taut", Formula::Tension(0), Direction::Rises));
    scene
        .events
        .push(event("slack", Formula::Tension(0), Direction::Falls));
    let model = generic(scene);
    for options in [Options::rk4(7e-3), Options::tsit5(1e-9)] {
        let mut simulation = Simulation::new(
            &model,
            Options {
                stop_at_events: true,
                ..options
            },
        )
        .unwrap();
        simulation.set_state(0.0, &[0.0; 6]).unwrap();
        let g = 9.81_f64;
        assert_eq!(simulation.run(10.0).unwrap(), Stop::Event(0));
        assert!(
            (simulation.time() - (1.0 / g).sqrt()).abs() < 1e-9,
            "{}",
            simulation.time()
        );
        assert_eq!(simulation.run(10.0).unwrap(), Stop::Event(1));
        let taut = (2.0 / g).sqrt();
        assert!((simulation.time() - taut).abs() < 1e-9);
        assert_eq!(simulation.run(10.0).unwrap(), Stop::Event(2));
        let w = 100.0_f64;
        let phase = ((2.0 * g).sqrt() / w).atan2(g / (w * w));
        let slack = taut + (2.0 * std::f64::consts::PI - 2.0 * phase) / w;
        println!("{:e}", simulation.time() - slack);
        assert!((simulation.time() - slack).abs() < 1e-4);
        let names: Vec<String> = simulation
            .events()
            .iter()
            .map(|event| simulation.event_name(event.what))
            .collect();
        assert_eq!(
            names,
            ["half_way", "cord: taut", "taut", "cord: slack", "slack"]
        );
    }
}

/// The guard z − height of the bob.
fn apply_height(height: f64) -> Formula {
    use mbd_runtime::scene::Function;
    let z = Formula::Component(vec![Formula::Position(Place::Point(0))], 2);
    apply(Function::Sub, &[z, height.into()])
}

#[test]
fn the_energy_balance_closes_with_the_work_of_loads_and_dampers() {
    let mass = PointKind::Mass(1.0.into());
    let cases = [
        (&mass, Options::tsit5(1e-8), 1e-6),
        (&mass, Options::rk4(2e-4), 1e-6),
        (&RATE, Options::tsit5(1e-8), 1e-5),
        (&RATE, Options::rk4(1e-3), 1e-5),
    ];
    for (node, options, bound) in cases {
        let (model, state, nodes) = case3(node);
        let options = Options {
            work: true,
            ..options
        };
        let mut simulation = begin(&model, options, &state, &nodes, node);
        let mut trajectory = Trajectory::new(&model, Sampling::Every(0.05), Content::ALL);
        simulation.record(3.0, &mut trajectory).unwrap();
        let column = |name| trajectory.column(name).unwrap();
        let (energy, loads, dampers) = (
            column("energy.total"),
            column("work.loads"),
            column("work.dampers"),
        );
        let balance: Vec<f64> = (0..energy.len())
            .map(|i| energy[i] - loads[i] - dampers[i])
            .collect();
        let drift = balance
            .iter()
            .fold(0.0_f64, |worst, x| worst.max((x - balance[0]).abs()));
        let work = simulation.work().unwrap();
        println!("{node:?} {:?} {drift:e} {work:?}", options.method);
        assert!(drift < bound, "{node:?} {:?} {drift:e}", options.method);
        assert!(work[0] < -10.0 && work[1] < -1e-2, "{work:?}");
    }
}

#[test]
fn a_trajectory_has_named_columns_with_units_and_writes_them() {
    let (model, state, nodes) = case3(&STATIC);
    let mut simulation = begin(&model, Options::tsit5(1e-8), &state, &nodes, &STATIC);
    let mut trajectory = Trajectory::new(&model, Sampling::Every(0.1), Content::ALL);
    simulation.record(1.0, &mut trajectory).unwrap();
    assert_eq!(trajectory.len(), 11);
    for name in [
        "time",
        "capsule.x",
        "capsule.qw",
        "capsule.omega_body_x",
        "chute.vz",
        "confluence.x",
        "riser.tension",
        "leg[2].stretch",
        "riser_force",
        "energy.kinetic",
    ] {
        assert!(trajectory.column(name).is_some(), "{name}");
    }
    assert_eq!(trajectory.column("nonsense"), None);
    assert_eq!(
        trajectory.column("riser.tension"),
        trajectory.column("riser_force")
    );
    let mut text = Vec::new();
    trajectory.to_csv(&mut text).unwrap();
    let text = String::from_utf8(text).unwrap();
    let mut lines = text.lines();
    let header = lines.next().unwrap();
    assert!(
        header.starts_with("time [s],chute.x [m],") && header.contains("riser.tension [N]"),
        "{header}"
    );
    let row: Vec<f64> = lines
        .nth(3)
        .unwrap()
        .split(',')
        .map(|cell| cell.parse().unwrap_or(f64::NAN))
        .collect();
    assert_eq!(row.len(), trajectory.names().len());
    assert!((row[0] - 0.3).abs() < 1e-12);
    // A second call goes on where the first ended.
    simulation.record(2.0, &mut trajectory).unwrap();
    assert_eq!(trajectory.len(), 21);
    assert!(trajectory.times().windows(2).all(|pair| pair[1] > pair[0]));
}

#[test]
fn single_precision_follows_double_precision() {
    let file = reference("parachute/case3_mass_0p1kg.json");
    let scene = || parachute(&file, RATE);
    let state = parachute_state(&file, RATE);
    let double = generic(scene());
    let single = Generic::<f32>::with_defaults(scene()).unwrap();
    let end = run(&double, Options::rk4(0.005), &state, 2.0);
    let narrow: Vec<f32> = state.iter().map(|x| *x as f32).collect();
    let mut simulation = Simulation::new(&single, Options::rk4(0.005)).unwrap();
    simulation.set_state(0.0, &narrow).unwrap();
    simulation
        .run(2.0)
        .unwrap_or_else(|error| panic!("{error}"));
    let wide: Vec<f64> = simulation.state().iter().map(|x| f64::from(*x)).collect();
    let error = largest_difference(&end, &wide);
    println!("{error:e} {:?}", simulation.statistics());
    assert!(error < 1e-2, "{error:e}");
}

#[test]
fn results_do_not_depend_on_where_the_origin_is() {
    let mut scene = bouncing(1e4, 30.0);
    let end = |scene: &Scene, at: [f64; 3]| {
        let model = generic(scene.clone());
        let start = [at[0] + 0.3, at[1], at[2] - 0.9, 0.0, 0.5, 0.0];
        let mut simulation = Simulation::new(&model, Options::tsit5(1e-8)).unwrap();
        simulation.set_state(0.0, &start).unwrap();
        simulation.run(2.0).unwrap();
        let x = simulation.state();
        (
            [x[0] - at[0], x[1] - at[1], x[2] - at[2], x[3], x[4], x[5]],
            simulation.statistics(),
        )
    };
    let (here, steps_here) = end(&scene, [0.0; 3]);
    let at = [100.0, -50.0, 70.0];
    scene.world_frames.push(frame("hook", at));
    scene.lines[0].from = Place::World(1);
    let (there, steps_there) = end(&scene, at);
    assert!(
        largest_difference(&here, &there) < 1e-10,
        "{here:?} {there:?}"
    );
    assert!(
        steps_here.steps.abs_diff(steps_there.steps) <= 1,
        "{steps_here:?} {steps_there:?}"
    );
}

/// The bob of a cord that goes taut at 1 m, dropped from 0.9 m below its end, until `until`: tensions of all steps, and the energy lost [J].
fn dropped(stiffness: f64, damping: f64, rtol: f64, until: f64) -> (Vec<f64>, f64) {
    let model = generic(bouncing(stiffness, damping));
    let mut simulation = Simulation::new(&model, Options::tsit5(rtol)).unwrap();
    let start = [0.0, 0.0, -0.9, 0.0, 0.0, 0.0];
    simulation.set_state(0.0, &start).unwrap();
    let mut trajectory = Trajectory::new(&model, Sampling::Steps, Content::ALL);
    simulation
        .record(until, &mut trajectory)
        .unwrap_or_else(|error| panic!("{error}"));
    let energy = trajectory.column("energy.total").unwrap();
    let lost = energy.first().unwrap() - energy.last().unwrap();
    (trajectory.column("cord.tension").unwrap().to_vec(), lost)
}

#[test]
fn stiff_lines_neither_push_nor_make_energy_at_loose_tolerances() {
    // Between impacts the bob falls freely; an impact on K costs what the damping ratio ζ = C/(2 √(K m)) says, nothing without C.
    for (stiffness, damping, rtol, until) in [
        (1e9, 0.0, 1e-3, 2.0),
        (1e9, 1e3, 1e-3, 2.0),
        (1e11, 1e3, 1e-6, 0.5),
        (1e5, 1e2, 1e-3, 5.0),
        (1e6, 0.0, 1e-3, 2.0),
    ] {
        let (tensions, lost) = dropped(stiffness, damping, rtol, until);
        let least = tensions.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(least >= 0.0, "K {stiffness:e}: {least:e} N");
        // The fall of 0.1 m brings 0.98 J.
        let largest = tensions.iter().copied().fold(0.0, f64::max);
        let hardest = (2.0 * 9.81 * 0.1 * stiffness).sqrt() + 2.0 * 9.81;
        assert!(largest < 1.01 * hardest, "K {stiffness:e}: {largest:e} N");
        let (_, tight) = dropped(stiffness, damping, 1e-3 * rtol, until);
        assert!(
            (lost - tight).abs() < 3e-3,
            "K {stiffness:e}: {lost} J, {tight} J"
        );
        if damping == 0.0 {
            assert!(lost.abs() < 3e-3, "K {stiffness:e}: {lost} J");
        }
    }
}

#[test]
fn a_run_is_cancelled_between_the_rows_of_one_step_and_goes_on_as_if_it_had_not_been() {
    let (model, state, nodes) = case3(&RATE);
    let rows = 100_000;
    let times: Vec<f64> = (1..=rows)
        .map(|k| 1e-3 * f64::from(k) / f64::from(rows))
        .collect();
    for options in [Options::rk4(1e-3), Options::tsit5(1e-6)] {
        let record = |limit: u32| {
            let mut simulation = begin(&model, options, &state, &nodes, &RATE);
            let content = Content {
                lines: false,
                nodes: false,
                reactions: false,
                outputs: false,
                energy: false,
                ..Content::ALL
            };
            let mut trajectory = Trajectory::new(&model, Sampling::At(times.clone()), content);
            let mut asked = 0;
            let outcome = simulation.run_while(1e-3, Some(&mut trajectory), &mut |_| {
                asked += 1;
                asked < limit
            });
            (simulation, trajectory, asked, outcome)
        };
        let (whole, all, asked, outcome) = record(u32::MAX);
        outcome.unwrap();
        assert!(asked >= rows);
        assert_eq!(all.times(), times);
        let (mut simulation, mut trajectory, asked, outcome) = record(50_000);
        assert_eq!(outcome.unwrap_err().cause, StepError::Cancelled);
        assert_eq!(asked, 50_000);
        assert!(
            trajectory
                .times()
                .last()
                .is_none_or(|last| *last <= simulation.time())
        );
        assert!(simulation.time() < 0.5e-3);
        simulation.record(1e-3, &mut trajectory).unwrap();
        assert_eq!(simulation.snapshot(), whole.snapshot());
        assert_eq!(trajectory.names(), all.names());
        for name in all.names() {
            assert_eq!(
                trajectory.column(&name.name),
                all.column(&name.name),
                "{}",
                name.name
            );
        }
    }
}
