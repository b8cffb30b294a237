//! The counterexamples of the equilibrium node: scenes on which simpler solvers cycle, jump or lose digits. Data exact as printed.

use mbd_runtime::node::{Confluence, Equilibrium, Outcome};

fn confluence(anchors: &[[f64; 3]], stiffness: &[f64], free_length: &[f64]) -> Confluence<f64> {
    Confluence {
        anchors: anchors.to_vec(),
        stiffness: stiffness.to_vec(),
        free_length: free_length.to_vec(),
        load: [0.0; 3],
    }
}

#[track_caller]
fn near(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() <= tolerance, "{found:?} is not {expected:?}");
    }
}

#[track_caller]
fn solve(problem: &Confluence<f64>, start: [f64; 3]) -> Equilibrium<f64> {
    problem
        .solve(start)
        .expect("a convex problem has a balance")
}

#[test]
fn newton_cycles_at_stiffness_ratio_1000_but_the_ladder_balances() {
    let problem = confluence(
        &[[-1.7, 1.5, 0.0], [1.3, 0.0, 0.0], [1.5, 0.8, 0.0]],
        &[100.0, 1e5, 5e4],
        &[1.2, 1.4, 1.3],
    );
    let found = solve(&problem, [0.9, 2.7, 0.0]);
    println!("{:?}", found);
    near(&found.nodes[0], &[0.20081493867, 0.86765607085, 0.0], 1e-10);
    near(
        &found.tensions,
        &[80.323645030, 36.954277503, 47.274491396],
        1e-8,
    );
}
