//! Dampers between two things: springs with a damping and no stiffness, against their closed form.

use mbd_runtime::{Content, Model, Options, Sampling, Simulation, Trajectory, model};
use tests::agreement::agrees;
use tests::assert_close;

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
