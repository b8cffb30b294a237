//! Far from the origin: differences of positions lose their digits, and a run says so before it is wrong.

use mbd_runtime::{Generic, Options, Scalar, Simulation, StepError};
use tests::declared::read;

/// A bob of 1 kg on a rope at rest, both ends as far from the origin as `offset` [m].
fn hanging<T: Scalar>(stiffness: f64, offset: f64) -> Simulation<T> {
    let scene = read(&format!(
        "model Hanging {{ gravity: [0, 0, -9.81] m/s^2; world {{ frame hook at [{offset:?}, 0, 0] m }} point bob {{ mass: 1 kg }}
         spring rope from world.hook to bob {{ free_length: 1 m, stiffness: {stiffness:?} N/m, damping: 10 N*s/m }} }}"
    ));
    let model = Generic::<T>::with_defaults(scene).expect("defaults");
    let mut run = Simulation::new(&model, Options::tsit5(1e-5)).expect("options");
    let rest = -1.0 - 9.81 / stiffness;
    let state = [offset, 0.0, rest, 0.0, 0.0, 0.0].map(T::from_f64);
    run.set_state(0.0, &state).expect("a state");
    run
}

fn refused<T: Scalar>(run: &mut Simulation<T>) -> bool {
    match run.run(0.1).map_err(|error| error.cause) {
        Ok(_) => false,
        Err(StepError::FarFromOrigin { part, .. }) => {
            assert_eq!(part, "bob");
            true
        }
        Err(other) => panic!("{other:?}"),
    }
}

#[test]
fn positions_without_digits_are_refused_and_those_with_few_are_told() {
    // K/m ε |p| over g: (stiffness, offset, share).
    for (stiffness, offset) in [
        (1e4_f64, 1.0_f64),
        (1e4, 1e6),
        (1e6, 1e9),
        (1e6, 1e11),
        (1e4, 1e12),
    ] {
        let share = f64::EPSILON * offset.max(1.0 + 9.81 / stiffness) * stiffness / 9.81;
        let mut run = hanging::<f64>(stiffness, offset);
        assert_eq!(refused(&mut run), share > 0.1, "{stiffness} {offset}");
        assert!(
            (run.rounding() / share - 1.0).abs() < 0.01,
            "{} {share}",
            run.rounding()
        );
    }
    for (stiffness, offset) in [(1e2, 1.0), (1e2, 1e3), (1e4, 1e4), (1e4, 1e6)] {
        let share = f64::from(f32::EPSILON) * offset * stiffness / 9.81;
        let mut run = hanging::<f32>(stiffness, offset);
        assert_eq!(refused(&mut run), share > 0.1, "{stiffness} {offset}");
    }
}

#[test]
fn bodies_that_a_tree_carries_are_looked_at_where_they_are() {
    // The coordinate is an angle near zero; the stretch of the rope is a difference of positions.
    let run = |offset: f64| {
        let scene = read(&format!(
            "model Crane {{ coordinates: relative; gravity: [0, 0, -9.81] m/s^2;
             world {{ frame pin at [{offset:?}, 0, 0] m, frame hook at [{offset:?}, 0, 3] m }}
             body jib {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame foot at [-1, 0, 0] m, frame head at [1, 0, 0] m }}
             joint pin: hinge from world.pin to jib.foot {{ axis: y }}
             spring rope from world.hook to jib.head {{ free_length: 3.5 m, stiffness: 1e6 N/m, damping: 10 N*s/m }} }}"
        ));
        let model = Generic::<f64>::with_defaults(scene).expect("defaults");
        let mut run = Simulation::new(&model, Options::tsit5(1e-5)).expect("options");
        run.run(0.01).map_err(|error| error.cause)
    };
    assert!(run(1e3).is_ok());
    let far = run(1e11);
    assert!(
        matches!(far, Err(StepError::FarFromOrigin { ref part, .. }) if part == "pin"),
        "{far:?}"
    );
}

#[test]
fn joints_without_digits_are_refused() {
    let run = |offset: f64| {
        let scene = read(&format!(
            "model Arm {{ gravity: [0, 0, -9.81] m/s^2; world {{ frame hook at [{offset:?}, 0, 0] m }}
             body arm {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0, 0, 0.5] m }}
             joint pin: hinge from world.hook to arm.top {{ axis: y, start: 1 rad }} }}"
        ));
        let model = Generic::<f64>::with_defaults(scene).expect("defaults");
        let mut run = Simulation::new(&model, Options::rk4(0.01)).expect("options");
        run.run(1.0).map_err(|error| error.cause)
    };
    assert!(run(1e6).is_ok());
    let far = run(1e16);
    assert!(
        matches!(far, Err(StepError::FarFromOrigin { ref part, .. }) if part == "arm"),
        "{far:?}"
    );
}
