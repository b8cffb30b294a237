//! What a program gives that cannot be used: refused by its name, and nothing is written.

use mbd_compiler::Interpreted;
use mbd_runtime::{
    Collapse, Content, Generic, LinearisationError, Options, ParamError, RunError, Sampling,
    Simulation, StepError, Trajectory, TrimError, inverse_dynamics, linearise, model, trim,
};

model! {
    /// A door with a closer.
    pub model Door<T> {
        units: si;
        gravity: none;
        input push: force;
        body leaf { mass: 2, inertia: diag(0.17, 0.17, 0.02), frame top at [0, 0, 0.5] }
        joint pin: hinge from world to leaf.top { axis: y, stiffness: 10, rest: 1 };
        load by_hand on leaf = [push, 0, 0];
        output swing = pin.angle;
        metric most = max swing;
    }
}

model! {
    /// A sail in gusts.
    model Sail {
        units: si;
        gravity: none;
        table gust = { 0 s: 1 N, 1 s: 3 N, 2 s: 2 N };
        body hull { mass: 2, inertia: diag(0.17, 0.17, 0.02) }
        joint afloat: free from world to hull.com;
        load wind on hull = [gust(time), 0, 0];
    }
}

model! {
    /// The same with other outputs, as many.
    model Gate {
        units: si;
        gravity: none;
        input push: force;
        body leaf { mass: 2, inertia: diag(0.17, 0.17, 0.02), frame top at [0, 0, 0.5] }
        joint pin: hinge from world to leaf.top { axis: y, stiffness: 10, rest: 1 };
        load by_hand on leaf = [push, 0, 0];
        output speed = pin.angle_rate;
        metric most = max speed;
    }
}

fn door() -> Door {
    Door::new(DoorParams::default()).expect("defaults")
}

fn cause(result: Result<impl std::fmt::Debug, RunError>) -> StepError {
    result.expect_err("it is refused").cause
}

#[test]
fn a_history_of_another_model_is_refused_and_stays_empty() {
    let (door, gate) = (door(), Gate::new(GateParams::default()).expect("defaults"));
    let mut history = Trajectory::new(&gate, Sampling::Every(0.1), Content::RESULTS);
    let mut run = Simulation::new(&door, Options::tsit5(1e-6)).expect("options that fit");
    let error = run
        .record(1.0, &mut history)
        .expect_err("other outputs than these");
    assert_eq!(
        error.cause.to_string(),
        "a history of another model is not supported"
    );
    assert!(history.is_empty());
    // The run goes on where it was, and its own history takes it; so does that of the same scene in single precision.
    let mut own = Trajectory::new(&door, Sampling::Every(0.1), Content::RESULTS);
    run.record(1.0, &mut own).expect("it runs");
    assert_eq!(own.len(), 11);
    let single = Door::<f32>::new(DoorParams::default()).expect("defaults");
    let mut run = Simulation::new(&single, Options::tsit5(1e-4)).expect("options that fit");
    own.clear();
    run.record(1.0, &mut own).expect("it runs");
    assert_eq!(own.len(), 11);
}

#[test]
fn a_history_that_no_memory_holds_is_refused_before_a_step() {
    let door = door();
    for (until, every) in [(1e300, 0.1), (1e6, 1e-6), (0.2, 1e-9)] {
        let mut run = Simulation::new(&door, Options::tsit5(1e-6)).expect("options that fit");
        let mut history = Trajectory::new(&door, Sampling::Every(every), Content::RESULTS);
        let cause = cause(run.record(until, &mut history));
        assert_eq!(cause.status(), "long_history", "{until} {every}: {cause}");
        assert!(history.is_empty() && run.time() == 0.0);
    }
    // Closer than time resolves, or where the grid begins long before the run.
    let mut run = Simulation::new(&door, Options::tsit5(1e-6)).expect("options that fit");
    let state = run.state().to_vec();
    run.set_state(1e9, &state).expect("a time that resolves");
    let mut history = Trajectory::new(&door, Sampling::Every(1e-7), Content::RESULTS);
    let cause = cause(run.record(1e9 + 1e-6, &mut history));
    assert!(matches!(cause, StepError::InvalidInput { .. }), "{cause}");
    let mut history = Trajectory::new(&door, Sampling::Every(1e-3), Content::RESULTS);
    let mut early = Simulation::new(&door, Options::tsit5(1e-6)).expect("options that fit");
    early.record(0.01, &mut history).expect("it runs");
    run.record(1e9 + 0.01, &mut history).expect("it runs");
    assert!((20..=24).contains(&history.len()), "{}", history.len());
}

#[test]
fn a_time_at_which_nothing_short_is_resolved_is_refused() {
    let door = door();
    let mut run = Simulation::new(&door, Options::tsit5(1e-6)).expect("options that fit");
    let state = run.state().to_vec();
    for time in [1e15, -1e17, 1e300] {
        let cause = cause(run.set_state(time, &state));
        assert!(
            cause.to_string().contains("nothing shorter than 4 ms"),
            "{cause}"
        );
    }
}

#[test]
fn a_time_that_is_none_has_no_linear_system() {
    let door = door();
    let run = Simulation::new(&door, Options::tsit5(1e-6)).expect("options that fit");
    let error = linearise(&door, f64::NAN, run.state(), &[0.0]).expect_err("no time");
    assert_eq!(
        error.to_string(),
        "`time` cannot be NaN: give a finite number"
    );
}

#[test]
fn a_trim_names_the_number_that_is_none() {
    let door = door();
    for none in [f64::NAN, f64::INFINITY] {
        for (name, asked) in [
            ("pin.angle", trim(&door).fix("pin.angle", none)),
            ("pin.angle", trim(&door).guess("pin.angle", none)),
            ("pin.angle", trim(&door).rate("pin.angle", none)),
            ("push", trim(&door).input("push", none)),
            ("push", trim(&door).all_inputs(&[none])),
            ("time", trim(&door).at(none)),
            ("leaf.x", trim(&door).state(&[none; 13])),
        ] {
            let error = asked.solve().expect_err("no number");
            let TrimError::Linearisation(cause) = &error else {
                panic!("{error}");
            };
            assert!(
                matches!(cause, LinearisationError::Given { name: named, .. } if named == name),
                "{error}"
            );
            assert_eq!(
                error.to_string(),
                format!("`{name}` cannot be {none}: give a finite number")
            );
        }
    }
}

#[test]
fn a_linear_system_and_efforts_name_the_number_that_is_none() {
    let door = door();
    let run = Simulation::new(&door, Options::tsit5(1e-6)).expect("options that fit");
    let mut state = run.state().to_vec();
    let told = |error: LinearisationError| error.to_string();
    let push = linearise(&door, 0.0, &state, &[f64::INFINITY]).expect_err("no input");
    assert_eq!(told(push), "`push` cannot be inf: give a finite number");
    let effort = inverse_dynamics(&door, 0.0, &state, &[0.0], &[("pin.angle", f64::NAN)]);
    let effort = effort.expect_err("no number");
    assert_eq!(
        told(effort),
        "`pin.angle` cannot be NaN: give a finite number"
    );
    state[2] = f64::NAN;
    let place = linearise(&door, 0.0, &state, &[0.0]).expect_err("no place");
    assert_eq!(told(place), "`leaf.z` cannot be NaN: give a finite number");
}

#[test]
fn a_controller_that_would_be_asked_without_end_is_refused_by_its_period() {
    let door = door();
    let mut run = Simulation::new(&door, Options::tsit5(1e-6)).expect("options that fit");
    let none = |_: &DoorSample<'_>, _: &mut DoorInputs| {};
    for (period, said) in [
        (0.0, "`sampling period` cannot be 0"),
        (f64::NAN, "`sampling period` cannot be NaN"),
        (
            1e-23,
            "`sampling period (time resolves 3.6e-21 s here)` cannot be 1e-23",
        ),
    ] {
        let cause = cause(run.control_every(period, none));
        assert_eq!(cause.to_string(), said);
    }
    // What a run until a time would ask for.
    run.control_every(1e-12, none).expect("resolved at zero");
    let cause = |until: f64, run: &mut Simulation<f64>| cause(run.run(until)).to_string();
    assert_eq!(
        cause(30.0, &mut run),
        "`sampling period (3.0e13 samples until 30 s, of at most 1e9)` cannot be 1e-12"
    );
    assert_eq!(
        cause(1e4, &mut run),
        "`sampling period (time resolves 3.6e-11 s here)` cannot be 1e-12"
    );
    assert_eq!(run.time(), 0.0);
    run.run(1e-10).expect("a hundred samples");
}

/// What a function of a program that uses runs writes: one type of error.
fn heavier(run: &mut Simulation<f64>, params: &[f64]) -> Result<(), RunError> {
    run.set_params(params)?;
    run.run(0.1)?;
    Ok(())
}

#[test]
fn params_that_cannot_be_run_are_an_error_of_the_run() {
    let door = door();
    let mut run = Simulation::new(&door, Options::tsit5(1e-6)).expect("options that fit");
    heavier(&mut run, &[]).expect("it has none");
    let error = heavier(&mut run, &[1.0]).expect_err("it has none");
    assert!(
        matches!(
            &error.cause,
            StepError::Params {
                error: ParamError::Count {
                    expected: 0,
                    found: 1
                }
            }
        ),
        "{error}"
    );
    assert_eq!(error.cause.status(), "params");
    assert_eq!(error.progress.time, 0.1);
}

#[test]
fn a_table_of_a_scene_that_a_program_changed_is_refused_where_it_is_none() {
    let with = |x: [f64; 3], y: &[f64]| {
        let mut scene = Sail::scene();
        (scene.tables[0].x, scene.tables[0].y) = (x.to_vec(), y.to_vec());
        let told = Generic::<f64>::with_defaults(scene.clone())
            .map(drop)
            .map_err(|error| error.to_string());
        let interpreted = Interpreted::<f64>::new(scene, &[]).map(drop);
        assert_eq!(told, interpreted.map_err(|error| error.to_string()));
        told
    };
    assert_eq!(with([0.0, 1.0, 2.5], &[1.0, 3.0, 2.0]), Ok(()));
    for (x, y, named) in [
        ([0.0, 2.0, 1.0], &[1.0, 3.0, 2.0][..], "`gust.x[2]`"),
        ([0.0, 1.0, f64::INFINITY], &[1.0, 3.0, 2.0], "`gust.x[2]`"),
        ([0.0, 1.0, 2.0], &[1.0, 3.0], "`gust.y`"),
        ([0.0, 1.0, 2.0], &[1.0, f64::NAN, 2.0], "`gust.y[1]`"),
    ] {
        let told = with(x, y).expect_err(named);
        assert!(told.starts_with(named), "{told}");
    }
}

#[test]
fn a_history_tells_the_outputs_that_are_no_numbers_in_some_row() {
    let throw = Throw::new(ThrowParams::default()).expect("no params");
    let mut run = Simulation::new(&throw, Options::rk4(0.1)).expect("options that fit");
    let mut history = Trajectory::new(&throw, Sampling::Every(0.1), Content::ALL);
    run.record(1.0, &mut history).expect("it falls");
    let told: Vec<_> = history.not_finite();
    let told: Vec<_> = told.iter().map(|it| (it.name, it.time, it.rows)).collect();
    assert_eq!(
        told,
        [
            ("way.x", 0.0, 1),
            ("way.y", 0.0, 1),
            ("way.z", 0.0, 1),
            ("ratio", 0.0, 11)
        ]
    );
}

model! {
    /// A stone at rest, with outputs that it has no value for.
    model Throw {
        units: si;
        gravity: [0, 0, -10];
        point stone { mass: 1 }
        output way = stone.velocity / norm(stone.velocity);
        output speed = norm(stone.velocity);
        output ratio = 1 / stone.position.x;
    }
}

#[test]
fn a_declared_start_beyond_single_precision_is_refused_by_its_name() {
    let generic = mbd_runtime::Generic::<f32>::with_defaults(tests::declared::read(
        "model Far { gravity: none; point stone { mass: 1 kg, start at [1e39, 0, 0] m } }",
    ));
    let far = generic.expect("no params");
    let mut run = Simulation::new(&far, Options::rk4(1e-3)).expect("options that fit");
    let cause = cause(run.run(0.1));
    assert!(
        matches!(&cause, StepError::InvalidInput { slot, value } if slot == "stone.x" && value.is_infinite()),
        "{cause}"
    );
}

#[test]
fn a_step_that_time_does_not_resolve_is_told_as_that() {
    for step in [1e-50, 1e-4] {
        let mut run = Simulation::new(&door(), Options::rk4(step)).expect("options that fit");
        if step > 1e-10 {
            let rest = run.state().to_vec();
            run.set_state(1e12, &rest).expect("a state");
        }
        let error = run.run(run.time() + 1.0).expect_err("no step");
        assert!(
            matches!(
                error.cause,
                StepError::StepCollapse {
                    cause: Collapse::Resolution,
                    ..
                }
            ),
            "{error}"
        );
        let text = error.to_string();
        assert!(
            text.contains("time does not resolve it") && text.contains("take a longer step"),
            "{text}"
        );
    }
}
