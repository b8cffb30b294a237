//! Derivatives through the nodes: against differences of the solved system, and finite where nothing pulls.

use super::common::{COLUMNS, Run, parachute, state_of};
use mbd_runtime::node::Tolerance;
use mbd_runtime::{
    Generic, Linearisation, LinearisationError, Model, Options, Quantity, Simulation,
};
use mbd_scene::{Clamp, Difference, Formula, NodeModel, Parameter, PointKind, Scene, Unit};
use tests::declared::read;
use tests::reference::{load, numbers};
use tests::web::{Tie, Web, WebLine};

const EULER: NodeModel = NodeModel::Stepwise {
    formula: Difference::Euler,
    clamp: Clamp::Positive,
};

/// Record `index` of a history as a state.
fn record(name: &str, index: usize) -> (Vec<f64>, Vec<f64>) {
    let data = load(name);
    let state: Vec<f64> = COLUMNS
        .iter()
        .flat_map(|name| numbers(&data[*name][index]))
        .collect();
    (state_of(&state), numbers(&data["node_x"][index]))
}

/// The parachute with the stiffness, damping and free length of the riser as parameters.
fn scene(model: NodeModel, damping: f64) -> Scene {
    let mut scene = parachute(PointKind::Node(model), damping);
    let parameter = |name: &str, default: f64| Parameter {
        name: name.into(),
        doc: String::new(),
        default,
        range: None,
        unit: Unit::default(),
    };
    scene.params = vec![
        parameter("riser_k", 60e3),
        parameter("riser_l", 4.0),
        parameter("riser_c", 600.0 * damping),
    ];
    scene.lines[0].stiffness = Formula::Param(0);
    scene.lines[0].free_length = Formula::Param(1);
    if damping > 0.0 {
        scene.lines[0].damping = Formula::Param(2);
    }
    scene
}

/// ẋ and node unknowns with everything solved anew, modes frozen.
fn solved<M: Model<f64>>(run: &mut Run<M>, span: f64, state: &[f64]) -> Vec<f64> {
    run.solve(0.0, span, state).unwrap();
    let mut all = run.ask(Quantity::Derivative, state);
    all.extend(run.nodes.nodes());
    all
}

/// Largest difference between the linearisation by the state and central differences, relative to the largest element of each row.
fn worst_by_state<M: Model<f64>>(run: &mut Run<M>, span: f64, h: f64) -> f64 {
    let state = run.state.clone();
    run.solve(0.0, span, &state).unwrap();
    let mut linear = Linearisation::new(run.model.layout());
    linear
        .evaluate(&run.model, &run.nodes.at(0.0, &state, &[]), &mut run.work)
        .expect("derivatives without rows");
    let (n, nodes) = (state.len(), linear.node_by_state().rows());
    let element = |row: usize, column: usize| {
        if row < n {
            linear.state().at(row, column)
        } else {
            linear.node_by_state().at(row - n, column)
        }
    };
    let mut differences = vec![vec![0.0; n]; n + nodes];
    for column in 0..n {
        let mut moved = state.clone();
        moved[column] = state[column] + h;
        let above = solved(run, span, &moved);
        moved[column] = state[column] - h;
        let below = solved(run, span, &moved);
        for (row, (a, b)) in above.iter().zip(&below).enumerate() {
            differences[row][column] = (a - b) / (2.0 * h);
        }
    }
    let mut worst: f64 = 0.0;
    for (row, differences) in differences.iter().enumerate() {
        let scale = differences.iter().fold(1.0f64, |m, x| m.max(x.abs()));
        for (column, difference) in differences.iter().enumerate() {
            let found = element(row, column);
            assert!(found.is_finite());
            let error = (found - difference).abs() / scale;
            if error > 1e-5 {
                println!("row {row} column {column}: {found:e} {difference:e}");
            }
            worst = worst.max(error);
        }
    }
    worst
}

#[test]
fn the_jacobian_through_a_taut_node_equals_differences_of_the_solved_system() {
    for (model, damping, file) in [
        (NodeModel::Static, 0.0, "parachute/case3_eq_C0.json"),
        (EULER, 1.0, "parachute/case2_damped.json"),
        (NodeModel::Rate, 1.0, "parachute/case2_damped.json"),
    ] {
        let (state, node) = record(file, 105);
        let mut run = Run::new(scene(model, damping), &state, Some(&node)).unwrap();
        run.nodes.freeze(true);
        let worst = worst_by_state(&mut run, 0.01, 1e-6);
        println!("{model:?}: {worst:e}");
        assert!(worst < 1e-6, "{model:?}: {worst:e}");
    }
}

#[test]
fn the_jacobian_of_a_slack_node_is_finite_and_follows_the_anchors() {
    for (model, damping, file) in [
        (NodeModel::Static, 0.0, "parachute/case2_eq_C0.json"),
        (EULER, 1.0, "parachute/case2_damped.json"),
        (NodeModel::Rate, 1.0, "parachute/case2_damped.json"),
    ] {
        let (state, node) = record(file, 0);
        let mut run = Run::new(scene(model, damping), &state, Some(&node)).unwrap();
        run.nodes.freeze(true);
        let worst = worst_by_state(&mut run, 0.01, 1e-6);
        println!("{model:?}: {worst:e}");
        assert!(worst < 1e-6, "{model:?}: {worst:e}");
        let lines = 2 * run.model.layout().effective_lines;
        assert!(run.nodes.effective()[..lines].iter().all(|&x| x == 0.0));
    }
}

#[test]
fn a_rate_node_dragged_by_one_or_two_lines_has_the_derivative_of_its_rule() {
    // At the start all lines are slack by a millimetre or more: a horizontal shift stretches the legs on the far side.
    let (mut state, mut node) = record("parachute/case2_damped.json", 0);
    for (k, x) in state.iter_mut().enumerate().skip(14) {
        *x += 0.1 * ((3 * k) as f64).sin();
    }
    node.iter_mut()
        .zip([0.0, 0.0, -0.002])
        .for_each(|(x, dx)| *x += dx);
    for (azimuth, expected) in [(20.0f64, 1), (80.0, 2)] {
        let away = [azimuth.to_radians().cos(), azimuth.to_radians().sin(), 0.0];
        let moved: Vec<f64> = node.iter().zip(away).map(|(x, d)| x - 0.03 * d).collect();
        let mut run = Run::new(scene(NodeModel::Rate, 1.0), &state, Some(&moved)).unwrap();
        run.nodes.freeze(true);
        let active = run.nodes.hold().iter().filter(|&&hold| hold > 0.0).count();
        assert_eq!(active, expected);
        let worst = worst_by_state(&mut run, 0.0, 1e-7);
        assert!(worst < 1e-5, "{worst:e}");
    }
}

/// Two bodies that fly apart across the lines that join them to a node between: what each line has of the motion across them, T/d over its sum, changes as
/// the bodies move, with a load that holds the node beside their line, too. Against differences of the solved node.
#[test]
fn the_derivative_of_a_node_between_two_moving_bodies_counts_how_its_lines_share_it() {
    for load in ["", "load w on k = [0, 0, -20 N - 3 N/m * left.position.x];"] {
        let scene = read(&format!(
            "model Knot {{ gravity: none;
                body left {{ mass: 2 kg, inertia: diag(1, 1, 1) kg*m^2, start at [-1.02, 0, 0] m velocity [-0.1, 0.9, 0.2] m/s }}
                body right {{ mass: 3 kg, inertia: diag(1, 1, 1) kg*m^2, start at [1.6, 0, 0] m velocity [0.2, -0.3, 0.4] m/s }}
                joint a: free from world to left.com;
                joint b: free from world to right.com;
                point k {{ equilibrium: rate }}
                line one from left.com to k {{ free_length: 1 m, stiffness: 3 kN/m, damping: 50 N*s/m }}
                line other from right.com to k {{ free_length: 1.5 m, stiffness: 2 kN/m, damping: 80 N*s/m }}
                {load}
                output speed = k.velocity;
            }}"
        ));
        let model = Generic::new(scene, &[]).expect("no params");
        let mut simulation = Simulation::new(&model, Options::tsit5(1e-8)).expect("a method");
        simulation.run(0.01).expect("a hundredth of a second");
        let state = simulation.state().to_vec();
        let mut run = Run::new(model.scene().clone(), &state, None).expect("a state");
        run.nodes.freeze(true);
        let worst = worst_by_state(&mut run, 0.0, 1e-6);
        assert!(worst < 1e-6, "{load}: {worst:e}");
    }
}

#[test]
fn parameter_derivatives_through_the_node_equal_differences() {
    for (model, damping, file) in [
        (NodeModel::Static, 0.0, "parachute/case3_eq_C0.json"),
        (NodeModel::Rate, 1.0, "parachute/case2_damped.json"),
        (EULER, 1.0, "parachute/case2_damped.json"),
    ] {
        let (state, node) = record(file, 105);
        let scene = scene(model, damping);
        let run_at = |params: &[f64]| {
            let mut run = Run::new(scene.clone(), &state, Some(&node)).unwrap();
            run.model = Generic::new(scene.clone(), params).unwrap();
            run
        };
        let nominal = [60e3, 4.0, 600.0 * damping];
        let mut run = run_at(&nominal);
        let at_state = run.state.clone();
        run.solve(0.0, 0.01, &at_state).unwrap();
        let mut linear = Linearisation::new(run.model.layout());
        linear
            .evaluate(
                &run.model,
                &run.nodes.at(0.0, &at_state, &[]),
                &mut run.work,
            )
            .expect("derivatives without rows");
        for (column, h) in [1.0, 1e-7, 1e-2].into_iter().enumerate() {
            if column == 2 && damping == 0.0 {
                continue;
            }
            let shifted = |sign: f64| {
                let mut params = nominal;
                params[column] += sign * h;
                solved(&mut run_at(&params), 0.01, &at_state)
            };
            let (above, below) = (shifted(1.0), shifted(-1.0));
            let n = at_state.len();
            for row in 0..above.len() {
                let difference = (above[row] - below[row]) / (2.0 * h);
                let found = if row < n {
                    linear.parameter().at(row, column)
                } else {
                    linear.node_by_parameter().at(row - n, column)
                };
                let scale = 1e-5 * difference.abs() + 1e-6 / h.min(1.0) * 1e-3;
                assert!(
                    (found - difference).abs() < scale,
                    "{model:?} row {row} column {column}: {found:e} {difference:e}"
                );
            }
        }
    }
}

/// What K_e and L_e say of damping is in proportion to it: nothing, where there is none.
#[test]
fn damping_that_a_param_leaves_out_of_a_stepwise_node_has_no_derivative_by_it() {
    let (state, node) = record("parachute/case2_damped.json", 105);
    let mut scene = scene(EULER, 0.0);
    scene.lines[0].damping = Formula::Param(2);
    let mut run = Run::new(scene, &state, Some(&node)).expect("a balance");
    run.solve(0.0, 0.01, &state).expect("a balance");
    let mut linear = Linearisation::new(run.model.layout());
    let at = run.nodes.at(0.0, &state, &[]);
    let refused = linear.evaluate(&run.model, &at, &mut run.work);
    let line = "riser".to_owned();
    assert_eq!(refused, Err(LinearisationError::NoDamping { line }));
}

/// The taut static node of case 3 as a problem of its own: the same anchors, lines and node.
fn taut_web(run: &Run<Generic<f64>>) -> (Web<f64>, [f64; 3]) {
    let anchors: Vec<[f64; 3]> = run.nodes.ends()[..24]
        .chunks_exact(6)
        .map(|end| [end[0], end[1], end[2]])
        .collect();
    let lines = run.model.lines().iter().enumerate();
    let web = Web {
        loads: vec![[0.0; 3]],
        lines: lines
            .map(|(i, numbers)| WebLine {
                ends: [Tie::Node(0), Tie::Anchor(i)],
                stiffness: numbers.stiffness,
                free_length: numbers.free_length,
            })
            .collect(),
        anchors,
    };
    let p = run.nodes.nodes();
    (web, [p[0], p[1], p[2]])
}

/// Node and forces on the anchors, −T u each.
fn answers(web: &Web<f64>, start: [f64; 3]) -> Vec<f64> {
    let tight = Tolerance {
        relative: 1e-14,
        absolute: 1e-16,
    };
    let found = web
        .solve(&[start], tight)
        .or_else(|_| web.solve(&[start], Tolerance::inside_step()));
    let found = found.unwrap();
    let p = found.nodes[0];
    let mut all = p.to_vec();
    for (anchor, tension) in web.anchors.iter().zip(&found.tensions) {
        let e = [0, 1, 2].map(|k| anchor[k] - p[k]);
        let d = e.iter().map(|x| x * x).sum::<f64>().sqrt();
        all.extend(e.map(|x| -tension * x / d));
    }
    all
}

#[test]
fn the_node_follows_its_anchors_and_they_see_one_symmetric_stiffness() {
    let (state, node) = record("parachute/case3_eq_C0.json", 105);
    let mut run = Run::new(scene(NodeModel::Static, 0.0), &state, Some(&node)).unwrap();
    run.solve(0.0, 0.01, &state).unwrap();
    let follow = run.ask(Quantity::NodeByAnchor(0), &state);
    let stiffness = run.ask(Quantity::CondensedStiffness(0), &state);
    for row in 0..3 {
        for column in 0..3 {
            let sum: f64 = (0..4).map(|i| follow[12 * row + 3 * i + column]).sum();
            assert!((sum - f64::from(row == column)).abs() < 1e-12);
        }
    }
    let scale = stiffness.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    for i in 0..12 {
        for j in 0..12 {
            assert!((stiffness[12 * i + j] - stiffness[12 * j + i]).abs() < 1e-12 * scale);
        }
        for k in 0..3 {
            let pushed: f64 = (0..4).map(|a| stiffness[12 * i + 3 * a + k]).sum();
            assert!(
                pushed.abs() < 1e-10 * scale,
                "a translation of all anchors changes no force"
            );
        }
    }
    let (web, p) = taut_web(&run);
    let h = 1e-6;
    for column in 0..12 {
        let moved = |sign: f64| {
            let mut web = web.clone();
            web.anchors[column / 3][column % 3] += sign * h;
            answers(&web, p)
        };
        let (above, below) = (moved(1.0), moved(-1.0));
        for row in 0..15 {
            let difference = (above[row] - below[row]) / (2.0 * h);
            let (found, scale) = if row < 3 {
                (follow[12 * row + column], 1.0)
            } else {
                (-stiffness[12 * (row - 3) + column], scale)
            };
            assert!(
                (found - difference).abs() < 1e-6 * scale,
                "row {row}, column {column}: {found} {difference}"
            );
        }
    }
}

#[test]
fn one_ulp_around_the_slack_edge_all_sensitivities_are_finite() {
    let (state, node) = record("parachute/case2_eq_C0.json", 0);
    let mut run = Run::new(scene(NodeModel::Static, 0.0), &state, Some(&node)).unwrap();
    run.solve(0.0, 0.01, &state).unwrap();
    let riser = |state: &[f64], p: f64| state[2] - 22.0 - p;
    for edge in [4.0f64.next_down(), 4.0, 4.0f64.next_up()] {
        let mut state = state.clone();
        state[2] = edge + 22.0 + 2.5;
        let p = [0.0, 0.0, 2.5];
        assert!((riser(&state, p[2]) - edge).abs() < 1e-14);
        let ends: Vec<f64> = run.nodes.ends().to_vec();
        let effective = [60e3, edge, 47e3, 1.5, 47e3, 1.5, 47e3, 1.5];
        let at = mbd_runtime::At {
            time: 0.0,
            state: &state,
            nodes: &p,
            effective: &effective,
            hold: &[0.0; 4],
            ends: &ends,
            inputs: &[],
            rows: &[],
        };
        let mut linear = Linearisation::new(run.model.layout());
        linear
            .evaluate(&run.model, &at, &mut run.work)
            .expect("derivatives without rows");
        for matrix in [
            linear.state(),
            linear.node_by_state(),
            linear.parameter(),
            linear.node_by_parameter(),
        ] {
            assert!(matrix.values().iter().all(|x| x.is_finite()));
        }
        for what in [Quantity::NodeByAnchor(0), Quantity::CondensedStiffness(0)] {
            let mut out = vec![0.0; run.model.layout().len(what)];
            run.model.evaluate(what, &at, &mut run.work, &mut out);
            assert!(out.iter().all(|x| x.is_finite()));
        }
    }
}
