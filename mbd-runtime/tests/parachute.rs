//! The parachute against its reference histories.

mod support;

use mbd_runtime::scene::{Clamp, Difference, NodeModel, PointKind};
use mbd_runtime::{Content, Options, Sampling, Simulation, Trajectory};
use support::*;

/// Largest difference of the riser force to the reference in windows of time.
fn compare(name: &str, node: PointKind, options: Options, until: f64, windows: &[f64]) -> Vec<f64> {
    let file = reference(&format!("parachute/{name}.json"));
    let model = generic(parachute(&file, node.clone()));
    let mut simulation = Simulation::new(&model, options).unwrap();
    simulation
        .set_state(0.0, &parachute_state(&file, node.clone()))
        .unwrap();
    if matches!(node, PointKind::Node(_)) {
        simulation.set_nodes(&floats(&file["node_x"][0])).unwrap();
    }
    let times: Vec<f64> = floats(&file["t"])
        .into_iter()
        .filter(|t| *t <= until)
        .collect();
    let mut trajectory = Trajectory::new(&model, Sampling::At(times.clone()), Content::ALL);
    let started = std::time::Instant::now();
    let ended = simulation.record(until, &mut trajectory);
    let force = trajectory.column("riser_force").unwrap();
    let want = floats(&file["riser_force"]);
    let mut worst = vec![0.0_f64; windows.len() + 1];
    let mut at = vec![0.0_f64; windows.len() + 1];
    for ((t, a), b) in times.iter().zip(force).zip(&want) {
        let window = windows.iter().position(|w| t <= w).unwrap_or(windows.len());
        if (a - b).abs() > worst[window] {
            worst[window] = (a - b).abs();
            at[window] = *t;
        }
    }
    println!(
        "{name} {:?}: worst {worst:?} at {at:?}; {:?}; {:?}",
        options.method,
        simulation.statistics(),
        started.elapsed()
    );
    for (time, what) in trajectory.events.iter().take(60) {
        print!("{time:.6} {what}; ");
    }
    println!();
    ended.unwrap_or_else(|error| panic!("{error}"));
    worst
}

fn mass(m: f64) -> PointKind {
    PointKind::Mass(m.into())
}

#[test]
fn explore() {
    compare(
        "case2_mass_1kg",
        mass(1.0),
        Options::tsit5(1e-9),
        10.0,
        &[1.0, 2.0],
    );
    compare(
        "case2_mass_0p1kg",
        mass(0.1),
        Options::rk4(1e-4),
        2.0,
        &[1.0, 2.0],
    );
    compare(
        "case3_mass_0p1kg",
        mass(0.1),
        Options::rk4(1e-4),
        2.0,
        &[1.0, 2.0],
    );
    compare(
        "case3_mass_0p1kg",
        mass(0.1),
        Options::tsit5(1e-10),
        2.0,
        &[1.0, 2.0],
    );
    compare(
        "case3_mass_C0_1kg",
        mass(1.0),
        Options::tsit5(1e-12),
        1.0,
        &[0.5, 1.0],
    );
    compare(
        "case3_mass_C0_1kg",
        mass(1.0),
        Options::rk4(1e-4),
        1.0,
        &[0.5, 1.0],
    );
    for h in [0.01, 0.005, 0.0025] {
        compare(
            "case2_damped",
            PointKind::Node(NodeModel::Rate),
            Options::rk4(h),
            10.0,
            &[1.0, 2.0],
        );
    }
    compare(
        "case2_damped",
        PointKind::Node(NodeModel::Rate),
        Options::tsit5(1e-9),
        10.0,
        &[1.0, 2.0],
    );
    compare(
        "case2_eq_C0",
        PointKind::Node(NodeModel::Static),
        Options::rk4(1e-3),
        2.0,
        &[1.0, 2.0],
    );
    let stepwise = |formula| {
        PointKind::Node(NodeModel::Stepwise {
            formula,
            clamp: Clamp::Positive,
        })
    };
    for h in [0.01, 0.0025] {
        compare(
            "case2_damped",
            stepwise(Difference::Euler),
            Options::rk4(h),
            10.0,
            &[1.0, 2.0],
        );
        compare(
            "case2_damped",
            stepwise(Difference::Bdf2),
            Options::rk4(h),
            10.0,
            &[1.0, 2.0],
        );
    }
}
