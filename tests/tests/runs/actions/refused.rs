//! Actions that cannot be done end the run by name, and the run stays before them.

use mbd_runtime::{Generic, Options, Simulation, StepError, model};
use tests::declared::read;

model! {
    /// A spring whose stiffness is set to what a state says.
    model Softened {
        gravity: none;
        param k = 40 N/m in 10 N/m ..= 100 N/m;
        state wanted = 40 N/m { rate: -20 N/m/s }
        point mass { mass: 1.0 kg, start at [1.0, 0.0, 0.0] m }
        spring tie from world to mass { free_length: 0.5 m, stiffness: k }
        event softer = time rises 2 s { set: k = wanted }
    }
}

model! {
    /// A pendulum whose length is set.
    model Longer {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        param length = 1 m;
        body bob {
            mass: 1.0 kg,
            inertia: diag(0.1, 0.1, 0.1) kg*m^2,
            frame top at [0.0, 0.0, length],
        }
        joint pin: hinge from world to bob.top { axis: y, start: 0.3 rad }
        event longer = time rises 1 s { set: length = 1.5 m }
    }
}

#[test]
fn a_value_outside_its_range_ends_the_run_before_the_action() {
    let model = Softened::new(SoftenedParams::default()).expect("defaults");
    let mut run = Simulation::new(&model, Options::tsit5(1e-9)).expect("options that fit");
    for _ in 0..2 {
        let error = run.run(3.0).expect_err("k would be 0");
        let StepError::Action { event, time, why } = &error.cause else {
            panic!("{error}")
        };
        assert_eq!(event, "softer");
        assert!((time - 2.0).abs() < 1e-13);
        assert!(
            why.contains("`k`")
                && why.contains("outside its declared range")
                && !why.contains("SI"),
            "{why}"
        );
        assert_eq!(run.model().params(), [40.0]);
        assert!((run.time() - 2.0).abs() < 1e-13);
    }
    assert!(run.actions().is_empty() && run.events().is_empty());
}

#[test]
fn a_param_that_would_move_a_body_on_its_joint_is_refused_by_name() {
    let model = Longer::new(LongerParams::default()).expect("defaults");
    let mut run = Simulation::new(&model, Options::rk4(1e-3)).expect("options that fit");
    let error = run.run(2.0).expect_err("the bob would jump");
    let told = error.to_string();
    assert!(
        told.contains("`longer`") && told.contains("`pin`") && told.contains("jump"),
        "{told}"
    );
    assert_eq!(run.model().params(), [1.0]);
}

/// In relative coordinates no joint comes apart: the bodies themselves would be elsewhere.
#[test]
fn a_param_that_moves_what_joint_coordinates_place_is_refused_by_name() {
    let scene = |frames: &str, setting: &str| {
        read(&format!(
            "model Door {{ coordinates: relative; gravity: none;
                param off = 0 m in -1 m ..= 1 m;
                param slant = 0 rad;
                param k = 1 N/m;
                {frames}
                joint pin: hinge from world.sill to leaf.edge {{ axis: y, start_rate: 1 rad/s }}
                joint loose: free from world to bob.com;
                spring tie from leaf.tip to bob {{ free_length: 1 m, stiffness: k }}
                body bob {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame eye at [0 m, 0 m, off], start at [3, 0, 0] m }}
                event moved = time rises 0.5 s {{ set: {setting} }} }}"
        ))
    };
    let leaf = |at: &str, tip: &str| {
        format!(
            "body leaf {{ mass: 2 kg, inertia: diag(0.4, 0.5, 0.4) kg*m^2, frame edge at {at}, frame tip at {tip} }}"
        )
    };
    let (fixed, tip) = ("[0, 0, 0] m", "[1, 0, 0] m");
    let refused = [
        (
            leaf("[off, 0 m, 0 m]", tip),
            "world { frame sill at [0, 0, 0] m }",
            "off = 0.1 m",
            "0.1 m",
        ),
        (
            leaf(fixed, tip),
            "world { frame sill at [0 m, 0 m, off] }",
            "off = 1 m",
            "1 m",
        ),
        (
            leaf(fixed, tip),
            "world { frame sill at [0, 0, 0] m rotated about(y, slant) }",
            "slant = 90 deg",
            "90 deg",
        ),
    ];
    for (leaf, world, setting, by) in &refused {
        let model = Generic::<f64>::with_defaults(scene(&format!("{world} {leaf}"), setting));
        let model = model.expect("defaults");
        let mut run = Simulation::new(&model, Options::tsit5(1e-9)).expect("options that fit");
        let told = run.run(1.0).expect_err("the leaf would jump").to_string();
        let words = ["`moved`", "`leaf`", by, "jump"];
        assert!(words.iter().all(|word| told.contains(word)), "{told}");
        assert!(run.actions().is_empty());
    }
    // What only a spring ends at, or nothing, may be elsewhere.
    for leaf in [leaf(fixed, "[1 m, 0 m, off]"), leaf(fixed, tip)] {
        let world = "world { frame sill at [0, 0, 0] m }";
        let model = Generic::<f64>::with_defaults(scene(&format!("{world} {leaf}"), "off = 0.1 m"));
        let model = model.expect("defaults");
        let mut run = Simulation::new(&model, Options::tsit5(1e-9)).expect("options that fit");
        run.run(1.0).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(run.actions().len(), 1);
    }
}

#[test]
fn a_run_that_locates_nothing_refuses_events_that_act() {
    let model = Softened::new(SoftenedParams::default()).expect("defaults");
    let options = Options {
        locate: false,
        ..Options::rk4(1e-3)
    };
    let error = Simulation::new(&model, options)
        .map(|_| ())
        .expect_err("nothing would act");
    assert!(error.to_string().contains("`softer`"), "{error}");
}

model! {
    /// A spring that becomes too stiff for the step.
    model Hardened {
        gravity: none;
        param k = 100 N/m;
        point mass { mass: 1.0 kg, start at [1.1, 0.0, 0.0] m }
        spring tie from world to mass { free_length: 1 m, stiffness: k }
        event harder = time rises 1 s { set: k = 1e7 N/m }
    }
}

#[test]
fn a_run_that_goes_back_over_an_event_has_what_was_set_before_it() {
    let model = Hardened::new(HardenedParams::default()).expect("defaults");
    let mut run = Simulation::new(&model, Options::rk4(1e-3)).expect("options that fit");
    for _ in 0..2 {
        let error = run.run(2.0).expect_err("a step of h ω = 3.2");
        assert!(
            matches!(error.cause, StepError::UnstableStep { .. }),
            "{error}"
        );
        assert!(run.time() <= 1.0, "{}", run.time());
        assert_eq!(run.model().params(), [100.0]);
        assert!(run.actions().is_empty() && run.events().is_empty());
    }
    let fine = Options::rk4(1e-4);
    let mut other = Simulation::new(&model, fine).expect("options that fit");
    other.restore(&run.snapshot()).expect("the same method");
    other.run(1.1).expect("h ω = 0.32");
    assert_eq!(other.model().params(), [1e7]);
}
