//! What a program gives that cannot be used: refused by its name, and nothing is written.

use mbd_runtime::{
    Content, Options, RunError, Sampling, Simulation, StepError, Trajectory, TrimError, linearise,
    model, trim,
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
        "a number that was given as time is not finite"
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
            ("inputs", trim(&door).all_inputs(&[none])),
            ("time", trim(&door).at(none)),
            ("state", trim(&door).state(&[none; 13])),
        ] {
            let error = asked.solve().expect_err("no number");
            assert!(
                matches!(&error, TrimError::Given { name: named, .. } if named == name),
                "{error}"
            );
            assert_eq!(
                error.to_string(),
                format!("`{name}` cannot be {none}: give a finite number")
            );
        }
    }
}
