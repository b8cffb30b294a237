//! Actions that bring about their own event.

use mbd_runtime::{Happening, Simulation, StepError, model};

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

model! {
    /// A clock whose first alarm is at the start, one whose first is later, and a place that begins at its value.
    model Alarm {
        gravity: none;
        param first = 0 s in 0 s ..= 1 s;
        const speed = 1 m/s;
        state next = first { rate: 0 }
        state ticks = 0 { rate: 0 }
        state later = 50 ms { rate: 0 }
        state tocks = 0 { rate: 0 }
        state place = 0 m { rate: speed }
        point idle { mass: 1 kg }
        event tick = time rises next { set: [ticks = ticks + 1, next = next + 100 ms] }
        event tock = time rises later { set: [tocks = tocks + 1, later = later + 100 ms] }
        event left = place rises 0 m;
    }
}

/// A controller that asks for its next instant with `time rises next` acts at t0 + k T from t0 on: from the start where t0 is the start, as
/// `time rises 0 s` does. It never acted, as its guard was on the far side from the start.
#[test]
fn a_clock_whose_first_alarm_is_at_the_start_ticks_from_the_start() {
    for (first, ticks) in [(0.0, 11), (1e-9, 11), (0.1, 10)] {
        let model = Alarm::new(AlarmParams { first }).expect("in range");
        for options in methods() {
            let mut run = Simulation::new(&model, options).expect("options that fit");
            run.run(1.05).expect("a run");
            let at = |event: usize| -> Vec<f64> {
                let own = run.events().iter();
                let own = own.filter(|it| it.what == Happening::Declared(event));
                own.map(|it| it.time).collect()
            };
            let found = at(0);
            assert_eq!(
                found.len(),
                ticks,
                "{first} s, {:?}: {found:?}",
                options.method
            );
            for (k, time) in found.iter().enumerate() {
                let expected = first + 0.1 * k as f64;
                assert!((time - expected).abs() < 1e-11, "{time} {expected}");
            }
            assert_eq!(at(1).len(), 11, "{:?}", options.method);
            assert!(
                at(2).is_empty(),
                "what begins at its value has not passed it"
            );
        }
    }
}
