//! Dampers between two things: springs with a damping and no stiffness, against their closed form.

use mbd_runtime::{
    Content, Generic, Model, Options, Sampling, Simulation, StepError, Trajectory, model,
};
use tests::agreement::agrees;
use tests::assert_close;
use tests::declared::read;

model! {
    /// Two carts with a damper between them, one pushed off; beside it a spring whose stiffness may be zero.
    pub model Carts<T> {
        gravity: none;
        verify;
        param k = 0 N/m in 0 N/m ..= 5 N/m;
        point first { mass: 1 kg, start at [0.0, 0.0, 0.0] m velocity [2.0, 0.0, 0.0] m/s }
        point second { mass: 2 kg, start at [4.0, 0.0, 0.0] m }
        spring strut from first to second { damping: 1.2 N*s/m }
        spring coil from first to second { free_length: 4 m, stiffness: k, damping: 0.6 N*s/m }
        output push = strut.tension;
        metric heat = integral(1.8 N*s/m * strut.stretch_rate^2) in mN*m;
    }
}

#[test]
fn generated_interpreted_and_generic_dampers_agree_with_all_their_derivatives() {
    agrees(&Carts::<f64>::new(Default::default()).expect("defaults"));
}

/// Their closing speed falls as exp(−c t/μ) with c = 1.8 N s/m and the reduced mass μ = 2/3 kg, and ½ μ v² becomes heat: 4/3 J.
#[test]
fn a_damper_slows_what_it_joins_and_keeps_its_momentum() {
    let model = Carts::<f64>::new(Default::default()).expect("defaults");
    let mut run = Simulation::<f64>::new(&model, Options::tsit5(1e-11)).expect("options");
    for until in [0.1, 0.5, 2.0] {
        run.run(until).expect("a motion that dies out");
        let state = run.state();
        let found = [state[6] - state[9], state[6] + 2.0 * state[9]];
        let wanted = [2.0 * f64::exp(-2.7 * until), 2.0];
        assert_close(&found, &wanted, 1e-9, 1e-9, &format!("{until} s"));
    }
    let mut history = Trajectory::new(&model, Sampling::Every(0.1), Content::RESULTS);
    let mut run = Simulation::<f64>::new(&model, Options::tsit5(1e-11)).expect("options");
    run.record(20.0, &mut history)
        .expect("a motion that dies out");
    let heat = &history.metrics(model.scene())[0];
    assert_eq!(heat.unit, "mN*m");
    let found = heat.value.expect("an integral");
    assert_close(&[found], &[4000.0 / 3.0], 1e-6, 1e-6, "heat");
}

/// A point that nobody puts anywhere starts at the origin, where the spring begins.
#[test]
fn a_spring_that_pushes_with_both_ends_at_one_place_is_refused_by_name_and_others_are_not() {
    let begun = |coil: &str, start: &str, family: &str| {
        let scene = read(&format!(
            "model Coil {{ coordinates: {family}; gravity: [0.0, 0.0, -9.81] m/s^2;
                body sled {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }}
                joint guide: prismatic from world to sled.com {{ axis: z{start} }}
                spring coil from world to sled.com {{ stiffness: 1 kN/m, damping: 2 N*s/m, free_length: {coil} }}
                event taken = time rises 1 s {{ attach: coil }}
            }}"
        ));
        let model = Generic::<f64>::with_defaults(scene).expect("no params");
        let mut run = Simulation::new(&model, Options::tsit5(1e-6)).expect("options");
        run.start().map_err(|error| error.cause)
    };
    for family in ["absolute", "relative"] {
        let error = begun("0.1 m", "", family).expect_err("a force without a direction");
        let StepError::NoDirection { spring, force, .. } = &error else {
            panic!("{error}");
        };
        assert_eq!((spring.as_str(), *force), ("coil", -100.0));
        for (coil, start) in [
            ("0.1 m", ", start: -1 mm"),
            ("0.1 m, at_start: detached", ""),
            ("0 m", ""),
        ] {
            assert_eq!(begun(coil, start, family), Ok(()), "{coil} {family}");
        }
    }
}
