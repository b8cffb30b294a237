//! Orders of the methods, and runs against closed forms.

mod support;

use mbd_runtime::{Options, Simulation};
use support::*;

#[test]
fn a_torque_free_body_follows_the_elliptic_functions() {
    for name in ["long", "short"] {
        let file = reference(&format!("closed_form/closed_torque_free_{name}_axis.json"));
        let inertia = floats(&file["parameters"]["principal_inertia"]);
        let model = generic(free_body([inertia[0], inertia[1], inertia[2]]));
        let mut state = vec![0.0; 13];
        state[3..7].copy_from_slice(&floats(&file["initial"]["quat"]));
        state[10..13].copy_from_slice(&floats(&file["initial"]["omega_body"]));
        let history = &file["time_history"];
        let (times, omega, quat) = (
            floats(&history["t"]),
            floats(&history["omega_body"]),
            floats(&history["quat"]),
        );
        for options in [Options::rk4(1e-3), Options::tsit5(1e-10)] {
            let mut simulation = Simulation::new(&model, options).unwrap();
            simulation.set_state(0.0, &state).unwrap();
            let mut worst: f64 = 0.0;
            for (i, &t) in times.iter().enumerate() {
                simulation.run(t).unwrap();
                let x = simulation.state();
                worst = worst.max(largest_difference(&x[10..13], &omega[3 * i..3 * i + 3]));
                let q = &quat[4 * i..4 * i + 4];
                let flipped: Vec<f64> = q.iter().map(|x| -x).collect();
                worst = worst.max(
                    largest_difference(&x[3..7], q).min(largest_difference(&x[3..7], &flipped)),
                );
            }
            println!(
                "{name} {:?}: {worst:e}, {:?}",
                options.method,
                simulation.statistics()
            );
            assert!(worst < 3e-10, "{name} {:?}: {worst:e}", options.method);
        }
    }
}
