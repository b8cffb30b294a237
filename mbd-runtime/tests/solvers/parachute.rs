//! The parachute against its reference histories: riser force [N].

use super::support::*;
use mbd_runtime::scene::{Clamp, Difference, NodeModel, Place, PointKind};
use mbd_runtime::{Content, Options, Sampling, Simulation, Trajectory};

const RATE: PointKind = PointKind::Node(NodeModel::Rate);

fn mass(m: f64) -> PointKind {
    PointKind::Mass(m.into())
}

fn stepwise(formula: Difference) -> PointKind {
    PointKind::Node(NodeModel::Stepwise {
        formula,
        clamp: Clamp::Positive,
    })
}

#[test]
fn a_point_with_mass_follows_its_reference_through_every_bounce() {
    let (worst, trajectory) = compare(
        "case2_mass_1kg",
        &mass(1.0),
        Options::tsit5(1e-9),
        4.0,
        &[1.0, 4.0],
    );
    assert!(worst[0] < 2e-3 && worst[1] < 4e-4, "{worst:?}");
    assert_eq!(trajectory.statistics.switches, 14);
    let (worst, _) = compare(
        "case2_mass_0p1kg",
        &mass(0.1),
        Options::rk4(1e-4),
        2.0,
        &[2.0],
    );
    assert!(worst[0] < 6e-5, "{worst:?}");
    let (worst, _) = compare(
        "case3_mass_0p1kg",
        &mass(0.1),
        Options::tsit5(1e-10),
        2.0,
        &[2.0],
    );
    assert!(worst[0] < 7e-5, "{worst:?}");
}

#[test]
fn an_undamped_point_with_mass_follows_its_reference_until_it_is_chaotic() {
    let (worst, _) = compare(
        "case3_mass_C0_1kg",
        &mass(1.0),
        Options::tsit5(1e-12),
        1.0,
        &[1.0],
    );
    assert!(worst[0] < 1e-6, "{worst:?}");
}

#[test]
fn a_rate_node_keeps_order_four_through_the_slack_phase() {
    let errors: Vec<Vec<f64>> = [0.01, 0.005, 0.0025]
        .into_iter()
        .map(|h| {
            compare(
                "case2_damped",
                &RATE,
                Options::rk4(h),
                10.0,
                &[1.0, 2.0, 10.0],
            )
            .0
        })
        .collect();
    for window in 0..3 {
        let orders = orders(
            &errors
                .iter()
                .map(|worst| worst[window])
                .collect::<Vec<f64>>(),
        );
        assert!(
            orders.iter().all(|order| *order > 3.6),
            "window {window}: {orders:?}"
        );
    }
    assert!(
        errors[0][0] < 0.2 && errors[2][0] < 1e-3 && errors[2][2] < 5e-8,
        "{errors:?}"
    );
}

#[test]
fn a_rate_node_follows_the_tolerance_of_tsit5() {
    let (worst, trajectory) = compare(
        "case2_damped",
        &RATE,
        Options::tsit5(1e-9),
        70.0,
        &[2.0, 70.0],
    );
    assert!(worst.iter().all(|error| *error < 3e-5), "{worst:?}");
    assert!(trajectory.events.len() <= 12, "{:?}", trajectory.events);
}

#[test]
fn a_rate_node_runs_through_the_many_switches_of_case_3() {
    let file = reference("parachute/case3_mass_0p1kg.json");
    let model = generic(parachute(&file, RATE));
    let end = |options| {
        let mut simulation = Simulation::new(&model, options).unwrap();
        simulation
            .set_state(0.0, &parachute_state(&file, RATE))
            .unwrap();
        simulation.set_nodes(&floats(&file["node_x"][0])).unwrap();
        simulation
            .run(10.0)
            .unwrap_or_else(|error| panic!("{error}"));
        println!("{options:?} {:?}", simulation.statistics());
        (simulation.state().to_vec(), simulation.statistics())
    };
    let (tight, counted) = end(Options::tsit5(1e-10));
    assert!(counted.switches < 30, "{counted:?}");
    let runs: Vec<_> = [0.01, 0.005, 0.0025]
        .into_iter()
        .map(|h| end(Options::rk4(h)))
        .collect();
    let errors: Vec<f64> = runs
        .iter()
        .map(|(state, _)| largest_difference(state, &tight))
        .collect();
    let orders = orders(&errors);
    // The guard tolerance follows the error of the step: no switches on the integrator's noise.
    assert!(runs.iter().all(|(_, counted)| counted.switches < 40));
    assert!(
        orders.iter().all(|order| *order > 3.8),
        "{errors:?} {orders:?}"
    );
}

#[test]
fn a_static_node_follows_its_reference_while_errors_are_not_amplified() {
    let node = PointKind::Node(NodeModel::Static);
    let (worst, _) = compare("case2_eq_C0", &node, Options::rk4(1e-3), 1.0, &[1.0]);
    assert!(worst[0] < 5e-3, "{worst:?}");
    let (worst, _) = compare("case3_eq_C0", &node, Options::rk4(1e-3), 1.0, &[1.0]);
    assert!(worst[0] < 2e-2, "{worst:?}");
}

#[test]
fn a_stepwise_node_is_of_order_one_and_its_bdf2_form_of_order_two() {
    let late = |formula, h| {
        compare(
            "case2_damped",
            &stepwise(formula),
            Options::rk4(h),
            10.0,
            &[2.0, 10.0],
        )
        .0[1]
    };
    let steps = [0.01, 0.005, 0.0025];
    let euler = orders(&steps.map(|h| late(Difference::Euler, h)));
    let bdf2 = orders(&steps.map(|h| late(Difference::Bdf2, h)));
    println!("{euler:?} {bdf2:?}");
    assert!(euler.iter().all(|order| *order > 0.9), "{euler:?}");
    assert!(bdf2.iter().all(|order| *order > 1.8), "{bdf2:?}");
}

#[test]
fn a_misaligned_pair_of_a_rate_node_jumps_to_its_tension_on_the_line_of_its_anchors() {
    let (a, l, k, c, y) = (1.5_f64, 1.499_f64, 47e3, 470.0, 0.1_f64);
    let mut scene = empty("Pair");
    for (index, x) in [a, -a].into_iter().enumerate() {
        scene
            .world_frames
            .push(frame(&format!("post[{index}]"), [x, 0.0, 0.0]));
        scene.lines.push(line(
            &format!("stay[{index}]"),
            Place::World(index + 1),
            Place::Point(0),
            [k, c, l],
        ));
    }
    scene.points.push(point("knot", RATE));
    let model = generic(scene);
    let jump = c / k * ((a.hypot(y) - l) / (a - l)).ln();
    for h in [1e-3, 1e-4] {
        let mut simulation = Simulation::new(&model, Options::rk4(h)).unwrap();
        simulation.set_state(0.0, &[0.0, y, 0.0]).unwrap();
        simulation.set_nodes(&[0.0, y, 0.0]).unwrap();
        let mut trajectory = Trajectory::new(&model, Sampling::Steps, Content::ALL);
        simulation
            .record(0.02, &mut trajectory)
            .unwrap_or_else(|error| panic!("{error}"));
        let tension = trajectory.column("stay[0].tension").unwrap();
        let after = tension.iter().position(|t| *t > 1.0).unwrap();
        let time = trajectory.times()[after];
        println!("{h:e}: {time} of {jump}, {:?}", tension.last());
        assert!((time - jump).abs() < 1.5 * h, "{time} {jump}");
        assert!(
            (tension.last().unwrap() - k * (a - l)).abs() < 1e-6,
            "{:?}",
            tension.last()
        );
    }
}
