//! Actions that bring about their own event.

use mbd_runtime::{Simulation, StepError, model};

use super::methods;

model! {
    /// A state that two events throw to and fro at one instant.
    model Flipping {
        units: si;
        gravity: none;
        point idle { mass: 1 }
        state side = 0 { rate: 0 }
        event begin = time rises 1 { set: side = 1 }
        event up = side rises 0.5 { set: side = 0 }
        event down = side falls 0.5 { set: side = 1 }
    }
}

model! {
    /// Zeno's relay: each time the value passes the level, the level follows half of the way.
    model Zeno {
        units: si;
        gravity: none;
        param level = 1;
        point idle { mass: 1 }
        state value = 0 { rate: 1 }
        event passed = value rises level { set: level = 0.5 * (level + 2) }
    }
}

#[test]
fn events_that_bring_about_each_other_are_chatter_by_name() {
    let model = Flipping::new(FlippingParams::default()).expect("defaults");
    for options in methods() {
        let mut run = Simulation::new(&model, options).expect("options that fit");
        let error = run.run(2.0).expect_err("no end");
        let StepError::EventChatter { line, .. } = &error.cause else {
            panic!("{error}")
        };
        assert!(line == "up" || line == "down", "{error}");
        assert!((run.time() - 1.0).abs() < 1e-13);
        assert!(error.to_string().contains("acts: once"), "{error}");
    }
}

#[test]
fn a_level_that_is_approached_in_halves_is_passed_in_the_end_or_told() {
    let model = Zeno::new(ZenoParams::default()).expect("defaults");
    for options in methods() {
        let mut run = Simulation::new(&model, options).expect("options that fit");
        match run.run(3.0) {
            // In rounding the level arrives at 2, and the value goes past it.
            Ok(_) => assert!(
                (45..60).contains(&run.actions().len()),
                "{}",
                run.actions().len()
            ),
            Err(error) => assert!(
                matches!(error.cause, StepError::EventChatter { .. }),
                "{error}"
            ),
        }
        assert!((run.events()[1].time - 1.5).abs() < 1e-12);
    }
}
