//! The stiff method: its order on every kind of scene, lines far stiffer than steps resolve, and what it refuses.

use super::support::*;
use mbd_runtime::scene::{NodeModel, PointKind};
use mbd_runtime::{
    Generic, Method, Model, Options, Scales, Simulation, Source, Stabilise, StepError, model,
};

model! {
    /// A turning body on a spring in wind that changes with time, with a filter of its own.
    model Kite<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        body kite {
            mass: 1.5 kg,
            inertia: diag(0.2, 0.3, 0.5) kg*m^2,
            frame bridle at [0.3, 0.1, -0.2] m,
        }
        joint kite_free: free from world to kite.com;
        spring tether from world to kite.bridle {
            free_length: 1 m,
            stiffness: 40 N/m,
            damping: 0.7 N*s/m,
        }
        load wind on kite =
            [3 N * sin(2 rad/s * time), 1 N * cos(1 rad/s * time) + 0.2 N*s/m * lag, 0 N];
        load air on kite = -0.1 kg/m * norm(kite.velocity) * kite.velocity;
        state lag = 0.5 m/s { rate: (norm(kite.velocity) - lag) / 0.3 s }
        output pull = tether.tension;
    }
}

model! {
    /// Two links on joints with a spring and a damper, driven by time.
    model Arm<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        body upper {
            mass: 2 kg,
            inertia: diag(0.1, 0.1, 0.02) kg*m^2,
            frame top at [0.0, 0.0, 0.5] m,
            frame end at [0.0, 0.0, -0.5] m,
        }
        body lower {
            mass: 1 kg,
            inertia: diag(0.05, 0.05, 0.01) kg*m^2,
            frame top at [0.0, 0.0, 0.4] m,
        }
        joint shoulder: hinge from world to upper.top {
            axis: y,
            stiffness: 30 N*m/rad,
            damping: 0.4 N*m*s,
            force: 5 N*m * sin(3 rad/s * time),
            start: 40 deg,
        }
        joint elbow: universal from upper.end to lower.top {
            axes: [x, y],
            angle1: { start: 20 deg, start_rate: 1 rad/s },
        }
    }
}

model! {
    /// A load on a line that is wound by time, below a jib that a motor turns by time, from a world that moves.
    model Hoist<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        world {
            frame deck at [0.2 m * sin(2 rad/s * time), 0.0 m, 3.0 m + 0.1 m * cos(3 rad/s * time)],
        }
        body jib { mass: 5 kg, inertia: diag(0.5, 0.5, 0.5) kg*m^2, frame tip at [1.0, 0.0, 0.0] m }
        point bob { mass: 2 kg, start at [1.0, 0.0, 1.9] m }
        joint mast: hinge from world.deck to jib.com {
            axis: z,
            motor: 0.5 rad * sin(1 rad/s * time),
        }
        spring rope from jib.tip to bob {
            free_length: 1 m - 0.2 m/s * time,
            stiffness: 800 N/m,
            damping: 8 N*s/m,
        }
    }
}

model! {
    /// Van der Pol's oscillator, ε = 1e-6, beside a mass.
    model Relaxation<T> {
        units: si;
        gravity: none;
        point idle { mass: 1 }
        state y = 2 { rate: z }
        state z = 0 { rate: 1e6 * ((1 - y^2) * z - y) }
    }
}

model! {
    /// A load whose value is finite at the start, and whose derivative is not.
    model Edge<T> {
        gravity: none;
        param a = 1e200;
        point bob { mass: 1 kg }
        load odd on bob = [1 N * tanh(a * (a * (bob.position.x / 1 m))), 0 N, 0 N];
    }
}

model! {
    /// A mass that is pushed.
    model Pushed<T> {
        gravity: none;
        input push: force = 1 N;
        point bob { mass: 1 kg }
        load hand on bob = [push, 0 N, 0 N];
    }
}

/// Even steps of the stiff method: every error passes, and the largest step is the step.
fn even_steps(step: f64) -> Options {
    let scales = Scales {
        length: 1e6,
        angle: 1e6,
        speed: 1e6,
        rate: 1e6,
        energy: 1e6,
        state: 1e6,
    };
    let method = Method::adaptive("rodas5p", 0.01).expect("an adaptive method");
    Options {
        method: method.with_largest_step(step),
        scales: Some(scales),
        work: true,
        ..Options::rodas5p(0.01)
    }
}

/// State and works of a model at a time from its declared start.
fn end(model: &(impl Model<f64> + ?Sized), options: Options, until: f64) -> Vec<f64> {
    let options = Options {
        work: true,
        ..options
    };
    let mut run = Simulation::new(model, options).unwrap();
    let mut start = run.state().to_vec();
    // Drag by |v| v has no second derivative at rest.
    if model.layout().nc == 0 {
        start[7..10].copy_from_slice(&[1.0, 0.5, -0.2]);
    }
    run.set_state(0.0, &start).unwrap();
    run.run(until).unwrap_or_else(|error| panic!("{error}"));
    let mut state = run.state().to_vec();
    state.extend(run.work().unwrap());
    println!("{:?} {:?}", options.method, run.statistics());
    state
}

/// The errors over steps that halve from `step`, against a tight run of Vern7.
fn errors(model: &(impl Model<f64> + ?Sized), step: f64, halvings: u32, until: f64) -> Vec<f64> {
    let exact = end(model, Options::vern7(1e-13), until);
    let steps = (0..halvings).map(|k| step / f64::from(1 << k));
    steps
        .map(|step| largest_difference(&end(model, even_steps(step), until), &exact))
        .collect()
}

#[test]
fn the_stiff_method_is_of_order_five_on_turning_bodies_and_states_of_the_user() {
    let kite = Kite::<f64>::new(KiteParams::default()).unwrap();
    let generic = Generic::<f64>::with_defaults(kite.scene().clone()).unwrap();
    let errors = errors(&kite, 0.04, 4, 2.0);
    let orders = orders(&errors);
    println!("{errors:?} {orders:?}");
    assert!((orders[2] - 5.0).abs() < 0.15, "{errors:?} {orders:?}");
    // The same by the laws themselves.
    let [a, b] = [
        end(&kite, even_steps(0.01), 2.0),
        end(&generic, even_steps(0.01), 2.0),
    ];
    assert!(largest_difference(&a, &b) < 1e-10);
}

#[test]
fn the_stiff_method_is_of_order_five_through_joints() {
    let arm = Arm::<f64>::new(ArmParams::default()).unwrap();
    let errors = errors(&arm, 0.01, 5, 1.0);
    let orders = orders(&errors);
    println!("{errors:?} {orders:?}");
    assert!((orders[2] - 5.0).abs() < 0.15, "{errors:?} {orders:?}");
    let generic = Generic::<f64>::with_defaults(arm.scene().clone()).unwrap();
    let [a, b] = [
        end(&arm, even_steps(0.01), 1.0),
        end(&generic, even_steps(0.01), 1.0),
    ];
    assert!(largest_difference(&a, &b) < 1e-10);
}

#[test]
fn the_stiff_method_is_of_order_five_where_time_moves_the_world_winds_lines_and_drives_motors() {
    let hoist = Hoist::<f64>::new(HoistParams::default()).unwrap();
    let errors = errors(&hoist, 0.02, 4, 1.0);
    let orders = orders(&errors);
    println!("{errors:?} {orders:?}");
    assert!((orders[2] - 5.0).abs() < 0.15, "{errors:?} {orders:?}");
}

#[test]
fn the_stiff_method_is_of_order_five_through_nodes() {
    for (name, node) in [
        ("case3_mass_0p1kg", NodeModel::Rate),
        ("case3_eq_C0", NodeModel::Static),
    ] {
        let file = reference(&format!("parachute/{name}.json"));
        let node = PointKind::Node(node);
        let model = generic(parachute(&file, node.clone()));
        let mut run = Simulation::new(&model, Options::vern7(1e-10)).unwrap();
        run.set_state(0.0, &parachute_state(&file, node)).unwrap();
        run.set_nodes(&floats(&file["node_x"][0])).unwrap();
        // Taut, and no switch meanwhile.
        run.run(5.0).unwrap_or_else(|error| panic!("{error}"));
        let (start, nodes) = (run.state().to_vec(), run.nodes().to_vec());
        let fly = |options: Options| {
            let options = Options {
                work: false,
                ..options
            };
            let mut run = Simulation::new(&model, options).unwrap();
            run.set_state(5.0, &start).unwrap();
            if model.layout().nz == 0 {
                run.set_nodes(&nodes).unwrap();
            }
            run.run(5.8).unwrap_or_else(|error| panic!("{error}"));
            println!("{:?}", run.statistics());
            run.state().to_vec()
        };
        let exact = fly(Options::vern7(1e-13));
        let errors =
            [4e-2, 2e-2, 1e-2, 5e-3].map(|step| largest_difference(&fly(even_steps(step)), &exact));
        let orders = orders(&errors);
        println!("{name}: {errors:?} {orders:?}");
        assert!(
            orders[2] > 4.8 || errors[2] < 1e-10,
            "{name}: {errors:?} {orders:?}"
        );
    }
}

#[test]
fn a_relaxation_oscillator_ends_where_the_test_set_for_initial_value_problems_says() {
    // vdpol of the Test Set for IVP Solvers (Mazzia, Magherini), reference solution at t = 2.
    let want = [0.170_616_773_217_048_3e1, -0.892_809_701_024_797_5];
    let model = Relaxation::<f64>::new(RelaxationParams::default()).unwrap();
    for (rtol, bound) in [(1e-5, 1e-3), (1e-8, 1e-6)] {
        let mut run = Simulation::new(&model, Options::rodas5p(rtol)).unwrap();
        run.run(2.0).unwrap_or_else(|error| panic!("{error}"));
        let error = largest_difference(&run.state()[6..8], &want);
        println!("{rtol:e}: {error:e} {:?}", run.statistics());
        assert!(error < bound, "{rtol:e}: {error:e}");
        assert!(run.statistics().steps < 3000);
    }
}

#[test]
fn a_line_with_a_stiff_damper_needs_few_steps() {
    // s″ = g − K s − C s′ from rest at the edge of slack.
    let (g, k, c, t) = (9.81, 1e3, 1e9_f64, 2.0);
    let root = (0.25 * c * c - k).sqrt();
    let fast = -0.5 * c - root;
    let slow = k / fast;
    let s = |t: f64| {
        g / k * (1.0 + (slow * (fast * t).exp() - fast * (slow * t).exp()) / (fast - slow))
    };
    let model = generic(bouncing(k, c));
    for rtol in [1e-5, 1e-6, 1e-7, 1e-8] {
        let mut run = Simulation::new(&model, Options::rodas5p(rtol)).unwrap();
        run.set_state(0.0, &[0.0, 0.0, -1.0, 0.0, 0.0, 0.0])
            .unwrap();
        run.run(t).unwrap_or_else(|error| panic!("{error}"));
        let error = (-1.0 - run.state()[2] - s(t)).abs();
        let pull = k * (-1.0 - run.state()[2]) - c * run.state()[5];
        println!("{rtol:e}: {error:e} m, {pull} N, {:?}", run.statistics());
        assert!(error <= rtol, "{rtol:e}: {error:e}");
        assert!((pull / g - 1.0).abs() < 1e-3, "{pull}");
        assert!(run.statistics().steps <= 500);
    }
}

#[test]
fn a_bouncing_mass_follows_the_tolerance_of_rodas5p_across_its_switches() {
    let (stiffness, drop, until) = (1e4, 0.15, 3.0);
    let model = generic(bouncing(stiffness, 0.0));
    let start = [0.0, 0.0, -1.0 + drop, 0.0, 0.0, 0.0];
    let exact = run(&model, Options::vern7(1e-12), &start, until);
    for rtol in [1e-4, 1e-6, 1e-8] {
        let mut run = Simulation::new(&model, Options::rodas5p(rtol)).unwrap();
        run.set_state(0.0, &start).unwrap();
        run.run(until).unwrap_or_else(|error| panic!("{error}"));
        let (end, work) = (run.state(), run.statistics());
        // A step that passes a switch ends there on its interpolant, without a factor of its own.
        assert!(work.switches > 10, "{work:?}");
        assert_eq!(work.factors, work.steps + work.rejected, "{work:?}");
        let error = (end[2] - exact[2]).hypot((end[5] - exact[5]) / stiffness.sqrt());
        println!("{rtol:e} {error:e}");
        assert!(error < 30.0 * rtol, "{rtol:e}: {error:e}");
    }
}

#[test]
fn the_drop_with_a_light_point_needs_few_factors() {
    // 5 s into the drop every line is taut; the second case swings.
    for (case, limit) in [("case2", [600, 75]), ("case3", [750, 95])] {
        let file = reference(&format!("parachute/{case}_mass_0p1kg.json"));
        let node = PointKind::Mass(0.1.into());
        let model = generic(parachute(&file, node.clone()));
        let mut run = Simulation::new(&model, Options::rodas5p(1e-9)).unwrap();
        run.set_state(0.0, &parachute_state(&file, node)).unwrap();
        run.run(5.0).unwrap_or_else(|error| panic!("{error}"));
        let start = run.state().to_vec();
        let fly = |options: Options| {
            let mut run = Simulation::new(&model, options).unwrap();
            run.set_state(0.0, &start).unwrap();
            run.run(2.0).unwrap_or_else(|error| panic!("{error}"));
            (run.state().to_vec(), run.statistics())
        };
        let (exact, explicit) = fly(Options::vern7(1e-10));
        let (end, work) = fly(Options::rodas5p(1e-3));
        // Positions of chute and capsule.
        let error = [0, 7].map(|at| largest_difference(&end[at..at + 3], &exact[at..at + 3]));
        println!("{case}: {error:?} m, {work:?}, {} f of Vern7", explicit.rhs);
        assert!(error.iter().all(|error| *error < 1e-5), "{error:?}");
        assert!(work.rhs <= limit[0] && work.factors <= limit[1], "{work:?}");
    }
}

#[test]
fn a_derivative_that_is_no_number_is_named() {
    let model = Edge::<f64>::new(EdgeParams::default()).unwrap();
    let mut run = Simulation::new(&model, Options::rodas5p(1e-6)).unwrap();
    let error = run.run(1.0).unwrap_err();
    let StepError::NonFinite {
        source: Source::Jacobian { rate, by },
        ..
    } = &error.cause
    else {
        panic!("{error}");
    };
    assert_eq!((rate.as_str(), by.as_str()), ("bob.vx", "bob.x"));
    assert!(error.to_string().contains("`bob.vx` by `bob.x`"), "{error}");
    assert_eq!(run.time(), 0.0);
}

#[test]
fn what_has_no_derivatives_is_refused_with_the_remedy() {
    let model = generic(bouncing(1e3, 1.0));
    let baumgarte = Options {
        stabilise: Stabilise::Baumgarte { alpha: 10.0 },
        ..Options::rodas5p(1e-6)
    };
    let error = Simulation::new(&model, baumgarte).err().expect("refused");
    assert!(
        error.to_string().contains("Stabilise::Projection"),
        "{error}"
    );
    // A function of time and state has no derivatives; what is held or sampled needs none.
    let pushed = Pushed::<f64>::new(PushedParams::default()).unwrap();
    for options in [Options::rodas5p(1e-8), Options::auto(1e-8)] {
        let mut run = Simulation::new(&pushed, options).unwrap();
        run.control_every(0.5, |sample, inputs: &mut PushedInputs| {
            inputs.push = sample.time;
        })
        .unwrap();
        run.run(1.0).unwrap();
        assert!((run.state()[3] - 0.25).abs() < 1e-9);
        let mut run = Simulation::new(&pushed, options).unwrap();
        let wish = |sample: &PushedSample<'_>, inputs: &mut PushedInputs| inputs.push = sample.time;
        let error = run.control(wish).unwrap_err();
        assert!(error.to_string().contains("control_every"), "{error}");
    }
}

#[test]
fn stiffness_is_named_when_an_explicit_method_meets_it() {
    let relaxation = Relaxation::<f64>::new(RelaxationParams::default()).unwrap();
    for method in ["tsit5", "vern7"] {
        let options = Options {
            method: Method::adaptive(method, 1e-6).unwrap(),
            max_steps: 3000,
            ..Options::tsit5(1e-6)
        };
        let mut run = Simulation::new(&relaxation, options).unwrap();
        let error = run.run(2.0).unwrap_err();
        assert!(error.to_string().contains("(`z`)"), "{error}");
    }
    // The line of the issue: a million steps for 4 ms.
    let line = generic(bouncing(1e3, 1e9));
    let options = Options {
        max_steps: 3000,
        ..Options::tsit5(1e-6)
    };
    let mut run = Simulation::new(&line, options).unwrap();
    run.set_state(0.0, &[0.0, 0.0, -1.00981, 0.0, 0.0, 0.0])
        .unwrap();
    let error = run.run(2.0).unwrap_err();
    let StepError::TooManySteps {
        stiff: Some(stiff), ..
    } = &error.cause
    else {
        panic!("{error}");
    };
    println!("{error}");
    assert_eq!(stiff.block, "velocity of bob");
    assert_eq!(stiff.line.as_deref(), Some("cord"));
    assert!(stiff.rho > 0.5 * stiff.limit && stiff.rho < 2.0 * stiff.limit);
    let told = error.to_string();
    assert!(told.contains("stiff") && told.contains("rodas5p"), "{told}");
    assert!(!told.contains("larger step"), "{told}");

    // The run that may take another method needs few steps.
    for rtol in [1e-4, 1e-7] {
        let mut run = Simulation::new(&line, Options::auto(rtol)).unwrap();
        run.set_state(0.0, &[0.0, 0.0, -1.00981, 0.0, 0.0, 0.0])
            .unwrap();
        run.run(2.0).unwrap_or_else(|error| panic!("{error}"));
        println!("{rtol:e} {:?}", run.statistics());
        assert!(run.statistics().steps < 500);
        assert!((run.state()[2] + 1.00981).abs() < 1e-6);
    }
    // A smooth motion is not stiff, however small the budget.
    let kite = Kite::<f64>::new(KiteParams::default()).unwrap();
    let options = Options {
        max_steps: 40,
        ..Options::tsit5(1e-10)
    };
    let error = Simulation::new(&kite, options)
        .unwrap()
        .run(9.0)
        .unwrap_err();
    assert!(
        matches!(error.cause, StepError::TooManySteps { stiff: None, .. }),
        "{error}"
    );
}

#[test]
fn auto_is_stiff_only_where_the_scene_is() {
    let relaxation = Relaxation::<f64>::new(RelaxationParams::default()).unwrap();
    for rtol in [1e-4, 1e-7] {
        let mut exact = Simulation::new(&relaxation, Options::rodas5p(1e-9)).unwrap();
        exact.run(2.0).unwrap();
        let mut run = Simulation::new(&relaxation, Options::auto(rtol)).unwrap();
        run.run(2.0).unwrap_or_else(|error| panic!("{error}"));
        let error = largest_difference(&run.state()[6..8], &exact.state()[6..8]);
        let work = run.statistics();
        println!("{rtol:e}: {error:e} {work:?}");
        assert!(error < 100.0 * rtol, "{error:e}");
        assert!(work.stiff_steps > 0 && work.stiff_steps < work.steps);
        assert!(work.method_changes >= 3, "{work:?}");
    }
    // To the bit the explicit method where nothing is stiff.
    let kite = Kite::<f64>::new(KiteParams::default()).unwrap();
    let fly = |options: Options| {
        let mut run = Simulation::new(&kite, options).unwrap();
        run.run(2.0).unwrap();
        assert_eq!(run.statistics().stiff_steps, 0);
        run.state().to_vec()
    };
    assert_eq!(fly(Options::auto(1e-8)), fly(Options::vern7(1e-8)));
    assert_eq!(fly(Options::auto(1e-4)), fly(Options::tsit5(1e-4)));
}

#[test]
fn a_run_of_auto_goes_on_from_a_snapshot_to_the_bit() {
    let model = Relaxation::<f64>::new(RelaxationParams::default()).unwrap();
    let options = Options::auto(1e-5);
    let mut one = Simulation::new(&model, options).unwrap();
    one.run(0.3).unwrap();
    let mut other = Simulation::new(&model, options).unwrap();
    other.restore(&one.snapshot()).unwrap();
    one.run(1.0).unwrap();
    other.run(1.0).unwrap();
    assert!(one.statistics().stiff_steps > 0);
    assert_eq!(one.state(), other.state());
}

#[test]
fn a_run_of_the_stiff_method_goes_on_from_a_snapshot_to_the_bit() {
    let kite = Kite::<f64>::new(KiteParams::default()).unwrap();
    let mut one = Simulation::new(&kite, Options::rodas5p(1e-7)).unwrap();
    one.run(0.4).unwrap();
    let mut other = Simulation::new(&kite, Options::rodas5p(1e-7)).unwrap();
    other.restore(&one.snapshot()).unwrap();
    one.run(1.0).unwrap();
    other.run(1.0).unwrap();
    assert_eq!(one.state(), other.state());
}

model! {
    /// A knot between two walls, 2 m apart, on cords of 0.9 m: nothing in it moves by itself.
    model Cord {
        gravity: none;
        emit: [derivative, outputs];
        world { frame left at [-1.0, 0.0, 0.0] m, frame right at [1.0, 0.0, 0.0] m }
        point knot;
        line a from world.left to knot { free_length: 0.9 m, stiffness: 1 kN/m }
        line b from world.right to knot { free_length: 0.9 m, stiffness: 1 kN/m }
        output pull = a.tension;
    }
}

#[test]
fn a_scene_in_which_nothing_moves_by_itself_is_run_by_every_method() {
    let cord = Cord::new(CordParams::default()).expect("no params");
    for options in [
        Options::rodas5p(1e-8),
        Options::auto(1e-8),
        Options::vern7(1e-8),
        Options::rk4(0.1),
    ] {
        let mut run = Simulation::new(&cord, options).expect("options that fit");
        run.run(1.0).expect("a knot that stays");
        // 1 kN/m times 1 m − 0.9 m on both sides.
        let pull = run.output("pull").expect("an output");
        assert!((pull - 100.0).abs() < 1e-9, "{pull} N by {options:?}");
    }
}
