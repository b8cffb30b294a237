//! Far from the origin: differences of positions lose their digits, and a run says so before it is wrong.

use mbd_runtime::{CoarsePositions, Generic, Options, Scalar, Simulation, StepError};
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

/// Two points of 1 kg on a spring along x, so far from the origin [m], for a second.
fn swinging<T: Scalar>(
    distance: f64,
    origin: &str,
    options: Options,
) -> (u64, Option<CoarsePositions>) {
    let other = distance + 1.2;
    let scene = read(&format!(
        "model Swinging {{ gravity: none; {origin}
         point a {{ mass: 1 kg, start at [{distance:?}, 0, 0] m }}
         point b {{ mass: 1 kg, start at [{other:?}, 0, 0] m }}
         spring s from a to b {{ free_length: 1 m, stiffness: 100 N/m }} }}"
    ));
    let model = Generic::<T>::with_defaults(scene).expect("defaults");
    let mut run = Simulation::new(&model, options).expect("options");
    run.run(1.0).expect("a run");
    (run.statistics().steps, run.coarse_positions())
}

#[test]
fn a_tolerance_below_the_digits_of_positions_is_told_where_rounding_takes_more_steps() {
    let at = |distance: f64, origin: &str, tolerance: f64| {
        let told = |options| swinging::<f64>(distance, origin, options);
        [Options::tsit5, Options::vern7, Options::rodas5p].map(|method| told(method(tolerance)))
    };
    let (far, near) = (at(6.4e6, "", 1e-11), at(0.0, "", 1e-11));
    for ((steps, told), (fewer, nothing)) in far.into_iter().zip(near) {
        assert!(steps > 3 * fewer, "{steps} {fewer}");
        assert_eq!(nothing, None);
        let told = told.expect("few digits");
        assert_eq!(told.to_follow.as_deref(), Some(told.part.as_str()));
        assert!(["a", "b"].contains(&told.part.as_str()));
        // 6.4e6 m have 2^-52 of that between two numbers, or half of it.
        assert!((told.apart / 1.42e-9 - 1.0).abs() < 0.01, "{told:?}");
        assert!(told.distance > 6.39e6 && told.distance < 6.41e6);
        // At the tolerance that is told nothing is left to tell.
        for (steps, told) in at(6.4e6, "", told.tolerance.expect("one that a run takes")) {
            assert_eq!(told, None, "{steps}");
        }
    }
    for (_, told) in at(6.4e6, "origin: follows a;", 1e-11) {
        assert_eq!(told, None);
    }
    for (_, told) in at(6.4e6, "", 1e-7) {
        assert_eq!(told, None);
    }
    // What a tree carries, tied to a point beside it.
    let carried = |origin: &str| {
        let scene = read(&format!(
            "model Carried {{ gravity: none; coordinates: relative; {origin}
             body a {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, start at [6.4e6, 0, 0] m, frame t at [0.5, 0, 0] m }}
             body b {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame t at [-0.5, 0, 0] m }}
             joint fa: free from world to a.com;
             joint s: prismatic from a.t to b.t {{ axis: x, stiffness: 100 N/m, start: 0.3 m }}
             point c {{ mass: 1 kg, start at [6400001.8, 0, 0] m }}
             spring q from b.t to c {{ free_length: 1 m, stiffness: 100 N/m }} }}"
        ));
        let model = Generic::<f64>::with_defaults(scene).expect("defaults");
        let mut run = Simulation::new(&model, Options::vern7(1e-11)).expect("options");
        run.run(0.3).expect("a run");
        (run.statistics().steps, run.coarse_positions())
    };
    let ((far, told), (near, nothing)) = (carried(""), carried("origin: follows a;"));
    assert!(far > 5 * near && told.is_some(), "{far} {near}");
    assert_eq!(nothing, None);
    // Single precision: 3e3 m away positions are a third of a millimetre apart; near by no tolerance that it takes is too small.
    let single =
        |distance: f64, tolerance| swinging::<f32>(distance, "", Options::tsit5(tolerance)).1;
    assert!(single(3e3, 1e-5).is_some());
    assert_eq!(single(3e3, 1e-2), None);
    for tolerance in [1e-6, 1e-5, 1e-4] {
        assert_eq!(single(1.0, tolerance), None, "{tolerance}");
    }
}

#[test]
fn an_orbit_whose_speed_has_too_few_digits_for_the_tolerance_is_told() {
    let flown = |origin: &str, tolerance: f64| {
        let scene = read(&format!(
            "model Orbit {{ {origin} gravity: point_mass {{ mu: 3.986e14 m^3/s^2, center: [0, 0, 0] m }};
             point a {{ mass: 1 kg, start at [6.8e6, 0, 0] m velocity [0, 7656, 0] m/s }} }}"
        ));
        let model = Generic::<f64>::with_defaults(scene).expect("defaults");
        let mut run = Simulation::new(&model, Options::vern7(tolerance)).expect("options");
        run.run(1000.0).expect("a run");
        (run.statistics().steps, run.coarse_positions())
    };
    let (far, told) = flown("", 1e-12);
    let (near, nothing) = flown("origin: follows a;", 1e-12);
    assert!(far > 3 * near, "{far} {near}");
    assert_eq!(
        (told.map(|told| told.part), nothing),
        (Some("a".to_owned()), None)
    );
    for tolerance in [1e-10, 1e-8] {
        assert_eq!(flown("", tolerance).1, None, "{tolerance}");
    }
}

/// In single precision positions of an orbit are half a metre apart, and no tolerance that a run takes is as loose: none is told.
#[test]
fn no_tolerance_is_told_that_a_run_would_refuse() {
    let scene = read(
        "model Orbit { gravity: point_mass { mu: 3.986e14 m^3/s^2, center: [0, 0, 0] m };
         point a { mass: 1 kg, start at [7e6, 0, 0] m velocity [0, 7546, 0] m/s } }",
    );
    let model = Generic::<f32>::with_defaults(scene).expect("defaults");
    let mut run = Simulation::new(&model, Options::tsit5(1e-3)).expect("options");
    run.run(100.0).expect("a run");
    let told = run.coarse_positions().expect("few digits");
    assert_eq!(
        (told.tolerance, told.to_follow.as_deref()),
        (None, Some("a"))
    );
}
