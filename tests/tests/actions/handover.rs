//! Runs that another model takes over.

use mbd_runtime::{Options, PointState, Simulation, StepError, Stop, model};

use super::methods;

model! {
    /// Two stages that are one body until the clamp opens.
    model Stack {
        gravity: none;
        input thrust: force = 5 N;
        body lower { mass: 30 kg, inertia: diag(5, 5, 1) kg*m^2, frame head at [0.0, 0.0, 1.0] m, start at [1.0, 2.0, 3.0] m rotated rpy(0.1, 0.2, 0.3) velocity [2.0, 0.0, 50.0] m/s angular_velocity [0.2, 0.1, 1.0] rad/s }
        body upper { mass: 10 kg, inertia: diag(2, 2, 0.5) kg*m^2, frame foot at [0.0, 0.0, -1.0] m }
        joint lower_free: free from world to lower.com;
        joint clamp: rigid from lower.head to upper.foot;
        state burnt = 0 s { rate: 1 }
        load push on lower = [thrust, 0.0, 0.0];
        event separated = time rises 1 s { then: stop }
    }
}

model! {
    /// Both stages apart, and a cover of its own that comes off.
    model Apart {
        gravity: none;
        input thrust: force = 1 N;
        body lower { mass: 30 kg, inertia: diag(5, 5, 1) kg*m^2 }
        joint lower_free: free from world to lower.com;
        body upper { mass: 10 kg, inertia: diag(2, 2, 0.5) kg*m^2 }
        joint upper_free: free from world to upper.com;
        point cover { mass: 1 kg }
        state burnt = 0 s { rate: 1 }
        state since = 0 s { rate: 1 }
        load push on lower = [thrust, 0.0, 0.0];
    }
}

model! {
    /// The upper stage alone.
    model Upper {
        gravity: none;
        body upper { mass: 10 kg, inertia: diag(2, 2, 0.5) kg*m^2 }
        joint upper_free: free from world to upper.com;
    }
}

model! {
    /// The same in a plane.
    model Flat {
        planar: xz;
        gravity: none;
        body upper { mass: 10 kg, inertia: diag(2, 2, 0.5) kg*m^2 }
        joint upper_free: free from world to upper.com;
    }
}

#[test]
fn stages_that_separate_into_another_model_keep_their_momentum() {
    let stack = Stack::new(StackParams::default()).expect("defaults");
    let apart = Apart::new(ApartParams::default()).expect("defaults");
    let upper = Upper::new(UpperParams::default()).expect("defaults");
    for options in methods() {
        let word = options.method.name();
        let mut first = Simulation::new(&stack, options).expect("options that fit");
        assert_eq!(first.run(5.0).expect("a flight"), Stop::Event(0));
        let mut second = Simulation::new(&apart, options).expect("options that fit");
        let cover = [0.0, 0.0, 0.0, 7.0, 8.0, 9.0];
        let handover = second
            .take_over(&mut first, &[("cover", &cover)])
            .expect("a start");
        assert_eq!(handover.carried, ["lower", "upper", "burnt"], "{word}");
        assert_eq!(handover.started, ["cover", "since"], "{word}");
        assert!(handover.dropped.is_empty(), "{word}");
        assert_eq!(second.time(), first.time());
        let [before, after] = handover.momentum;
        for k in 0..3 {
            // The cover is new.
            assert!(
                (after[k] - before[k] - cover[3 + k]).abs() < 1e-13 * 2000.0,
                "{word}"
            );
            assert!(
                (after[3 + k] - before[3 + k]).abs() < 1e-13 * 2000.0,
                "{word}"
            );
        }
        let state = ApartState::from_slice(second.state()).expect("a state");
        assert!(
            (state.burnt() - 1.0).abs() < 1e-12 && state.since() == 0.0,
            "{word}"
        );
        assert_eq!(second.held_inputs(), [5.0], "{word}");
        assert_eq!(
            state.cover(),
            PointState {
                position: [0.0; 3],
                velocity: [7.0, 8.0, 9.0]
            }
        );
        second.run(2.0).expect("a flight");
        let mut third = Simulation::new(&upper, options).expect("options that fit");
        let handover = third.take_over(&mut second, &[]).expect("a start");
        assert_eq!(
            handover.dropped,
            ["lower", "cover", "burnt", "since"],
            "{word}"
        );
        third.run(3.0).expect("a flight");
    }
}

#[test]
fn what_starts_nowhere_or_lies_in_another_plane_is_refused_by_name() {
    let stack = Stack::new(StackParams::default()).expect("defaults");
    let mut first = Simulation::new(&stack, Options::rk4(1e-2)).expect("options that fit");
    first.run(5.0).expect("a flight");
    let apart = Apart::new(ApartParams::default()).expect("defaults");
    let mut second = Simulation::new(&apart, Options::rk4(1e-2)).expect("options that fit");
    let told = |error: mbd_runtime::RunError| error.to_string();
    let error = second
        .take_over(&mut first, &[])
        .expect_err("the cover is nowhere");
    assert!(
        matches!(&error.cause, StepError::Unplaced { name, .. } if name == "cover"),
        "{error}"
    );
    let error = told(
        second
            .take_over(&mut first, &[("cover", &[0.0])])
            .expect_err("six numbers"),
    );
    assert!(
        error.contains("`cover`") && error.contains("6 numbers"),
        "{error}"
    );
    let error = told(
        second
            .take_over(&mut first, &[("covr", &[0.0])])
            .expect_err("no such thing"),
    );
    assert!(error.contains("`covr`"), "{error}");
    let flat = Flat::new(FlatParams::default()).expect("defaults");
    let mut second = Simulation::new(&flat, Options::rk4(1e-2)).expect("options that fit");
    let error = told(
        second
            .take_over(&mut first, &[])
            .expect_err("another plane"),
    );
    assert!(error.contains("plane"), "{error}");
}
