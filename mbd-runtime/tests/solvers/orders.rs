//! Orders of the methods, and runs against closed forms.

use super::support::*;
use mbd_runtime::{Method, Options, Scales, Simulation};

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
        for options in [
            Options::rk4(1e-3),
            Options::rattle(1e-3),
            Options::tsit5(1e-10),
            Options::vern7(1e-11),
        ] {
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

/// Height and speed of the bouncing mass of 1 kg, dropped from `drop` above the slack edge of a cord of 1 m, at time `t`.
fn bounce(stiffness: f64, drop: f64, t: f64) -> [f64; 2] {
    let (g, w) = (9.81_f64, stiffness.sqrt());
    let fall = (2.0 * drop / g).sqrt();
    let speed = g * fall;
    let sag = g / stiffness;
    let phase = (speed / w).atan2(sag);
    let contact = (2.0 * std::f64::consts::PI - 2.0 * phase) / w;
    let period = 2.0 * fall + contact;
    // Time since the last apex.
    let since = t.rem_euclid(period);
    if since < fall {
        return [-1.0 + drop - 0.5 * g * since * since, -g * since];
    }
    if since < fall + contact {
        let angle = w * (since - fall) + phase;
        let radius = sag.hypot(speed / w);
        return [
            -1.0 - (sag - radius * angle.cos()),
            -radius * w * angle.sin(),
        ];
    }
    let left = period - since;
    [-1.0 + drop - 0.5 * g * left * left, g * left]
}

fn bouncing_error(options: Options) -> f64 {
    let (stiffness, drop, until) = (1e4, 0.15, 3.0);
    let model = generic(bouncing(stiffness, 0.0));
    let end = run(
        &model,
        options,
        &[0.0, 0.0, -1.0 + drop, 0.0, 0.0, 0.0],
        until,
    );
    let [z, v] = bounce(stiffness, drop, until);
    (end[2] - z).hypot((end[5] - v) / stiffness.sqrt())
}

#[test]
fn a_bouncing_mass_keeps_the_order_of_rk4_and_rattle_across_located_switches() {
    for method in [Options::rk4, Options::rattle] {
        let errors: Vec<f64> = (0..5)
            .map(|k| bouncing_error(method(4e-3 / f64::from(1 << k))))
            .collect();
        let orders = orders(&errors);
        println!("{errors:?} {orders:?}");
        assert!(
            orders.iter().skip(1).all(|order| *order > 3.8),
            "{errors:?} {orders:?}"
        );
        let ignored = bouncing_error(Options {
            locate: false,
            ..method(2.5e-4)
        });
        assert!(ignored > 100.0 * errors[4], "{ignored:e}");
    }
}

#[test]
fn a_bouncing_mass_follows_the_tolerance_of_tsit5() {
    for rtol in [1e-4, 1e-6, 1e-8, 1e-10] {
        let error = bouncing_error(Options::tsit5(rtol));
        println!("{rtol:e} {error:e}");
        assert!(error < 30.0 * rtol, "{rtol:e}: {error:e}");
    }
}

/// Even steps of an adaptive method: every error passes, and the largest step is the step.
fn even_steps(options: Options, step: f64) -> Options {
    let large = Scales {
        length: 1e6,
        angle: 1e6,
        speed: 1e6,
        rate: 1e6,
        energy: 1e6,
        state: 1e6,
    };
    let method = Method::adaptive(options.method.word(), 0.01).expect("an adaptive method");
    Options {
        method: method.with_largest_step(step),
        scales: Some(large),
        guard_tolerance: Some(1e-13),
        ..options
    }
}

#[test]
fn a_bouncing_mass_keeps_the_order_of_vern7_across_located_switches() {
    let errors: Vec<f64> = (0..4)
        .map(|k| bouncing_error(even_steps(Options::vern7(0.01), 8e-3 / f64::from(1 << k))))
        .collect();
    let orders = orders(&errors);
    println!("{errors:?} {orders:?}");
    assert!(
        orders.iter().all(|order| *order > 6.5) || errors[2] < 1e-11,
        "{errors:?} {orders:?}"
    );
}

#[test]
fn a_bouncing_mass_follows_the_tolerance_of_vern7() {
    for rtol in [1e-4, 1e-6, 1e-8, 1e-10] {
        let error = bouncing_error(Options::vern7(rtol));
        println!("{rtol:e} {error:e}");
        assert!(error < 30.0 * rtol, "{rtol:e}: {error:e}");
    }
}
