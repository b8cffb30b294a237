//! The counterexamples of the equilibrium node: scenes on which simpler solvers cycle, jump or lose digits. Data exact as printed there.

use mbd_runtime::node::{
    Balance, BalanceEvaluation, BlockCholesky, History, Leg, NodeError, Outcome, RateNode,
    RateOutcome, Solver, Strategy, Tolerance, effective,
};
use mbd_scene::laws::LineNumbers;
use mbd_scene::{Clamp, Difference};
use nalgebra::Vector3;
use tests::random::Random;
use tests::web::{Confluence, Equilibrium, Web, WebBalance};

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

/// Newton steps of slope search alone.
fn searched(problem: &Confluence<f64>, start: [f64; 3]) -> (Outcome<f64>, [f64; 3]) {
    let web = problem.web().unwrap();
    let mut solver = Solver::new(1, web.lines.len(), &web.blocks());
    let (k, l) = web.constants();
    let mut p = start;
    let mut balance = WebBalance::new(&web);
    let outcome = solver.search(&mut balance, &k, &l, &mut p, Tolerance::alone());
    (outcome, p)
}

/// |g| along plain Newton steps.
fn plain_newton(problem: &Confluence<f64>, start: [f64; 3], steps: usize) -> Vec<f64> {
    let web = problem.web().unwrap();
    let mut balance = WebBalance::new(&web);
    let mut factor = BlockCholesky::<f64, 3>::new(1, &[(0, 0)]);
    let mut at = BalanceEvaluation::new(1, 1);
    let (k, l) = web.constants();
    let mut p = start;
    let mut residuals = Vec::new();
    for _ in 0..steps {
        balance.evaluate(&p, &k, &l, &mut at);
        residuals.push(at.gradient().iter().map(|g| g * g).sum::<f64>().sqrt());
        let h = at.block(0);
        let shift = 1e-15 * (h[0][0] + h[1][1] + h[2][2]);
        let mut step: Vec<f64> = at.gradient().iter().map(|g| -g).collect();
        if !factor.factor(shift, |_| h) {
            break;
        }
        factor.solve(&mut step);
        for (p, step) in p.iter_mut().zip(step) {
            *p += step;
        }
    }
    residuals
}

fn iterations(found: &Equilibrium<f64>) -> usize {
    found.outcome.iterations()
}

fn ratio_1000() -> Confluence<f64> {
    confluence(
        &[[-1.7, 1.5, 0.0], [1.3, 0.0, 0.0], [1.5, 0.8, 0.0]],
        &[100.0, 1e5, 5e4],
        &[1.2, 1.4, 1.3],
    )
}

#[test]
fn plain_newton_cycles_for_ever_at_stiffness_ratio_1000() {
    let seen = plain_newton(&ratio_1000(), [0.9, 2.7, 0.0], 1006);
    let period = &seen[1000..1006];
    let mut sorted = period.to_vec();
    sorted.sort_by(f64::total_cmp);
    let printed = [25.73, 43.67, 1399.0, 1404.0, 8679.0, 12771.0];
    for (a, b) in sorted.iter().zip(printed) {
        assert!((a / b - 1.0).abs() < 1e-3, "{period:?}");
    }
}

#[test]
fn the_ladder_balances_the_ratio_1000_cycle_from_every_start_and_in_every_disturbed_copy() {
    let answer = [0.20081493867, 0.86765607085, 0.0];
    let tensions = [80.323645030, 36.954277503, 47.274491396];
    let found = solve(&ratio_1000(), [0.9, 2.7, 0.0]);
    near(&found.nodes[0], &answer, 1e-10);
    near(&found.tensions, &tensions, 1e-8);
    let (outcome, p) = searched(&ratio_1000(), [0.9, 2.7, 0.0]);
    near(&p, &answer, 1e-10);
    assert_eq!(outcome.iterations(), 8);
    let mut random = Random::new(1);
    for spatial in [0.0, 1.0] {
        for _ in 0..1000 {
            let [x, y, z] = random.vector(3.0);
            let found = solve(&ratio_1000(), [x, y, spatial * z]);
            near(&found.nodes[0], &answer, 1e-9);
            near(&found.tensions, &tensions, 1e-6);
        }
    }
    for _ in 0..500 {
        let mut near_by = ratio_1000();
        let mut shake = |x: &mut f64| *x *= 1.0 + random.uniform(-1e-3, 1e-3);
        near_by.stiffness.iter_mut().for_each(&mut shake);
        near_by.free_length.iter_mut().for_each(&mut shake);
        near_by
            .anchors
            .as_flattened_mut()
            .iter_mut()
            .for_each(&mut shake);
        let found = solve(&near_by, [0.9, 2.7, 0.0]);
        assert!(matches!(found.outcome, Outcome::Taut { .. }));
        assert!(iterations(&found) <= 100);
    }
}

#[test]
fn a_cycle_of_period_five_at_stiffness_ratio_40000_balances() {
    let problem = confluence(
        &[
            [-0.156, -0.769, 0.0],
            [1.97, 1.17, 0.0],
            [-0.0442, -0.442, 0.0],
        ],
        &[5.77e6, 131.0, 1.76e5],
        &[0.831, 0.252, 0.521],
    );
    let start = [3.04, -0.404, 0.0];
    let mut period = plain_newton(&problem, start, 1005)[1000..].to_vec();
    period.sort_by(f64::total_cmp);
    let printed = [30.83, 242.2, 1918.0, 22818.0, 33253.0];
    for (a, b) in period.iter().zip(printed) {
        assert!((a / b - 1.0).abs() < 1e-3, "{period:?}");
    }
    let found = solve(&problem, start);
    near(
        &found.nodes[0],
        &[0.37313459631, -0.12822809280, 0.0],
        1e-10,
    );
    near(
        &found.tensions,
        &[38.390364553, 236.58635960, 199.08867353],
        2e-7,
    );
    let (outcome, _) = searched(&problem, start);
    assert_eq!(outcome.iterations(), 10);
}

#[test]
fn the_kink_counts_as_taut_so_one_dimension_does_not_cycle() {
    let problem = confluence(&[[0.0; 3], [3.0, 0.0, 0.0]], &[1.0, 1.0], &[1.0, 1.0]);
    let residuals = plain_newton(&problem, [5.0, 0.0, 0.0], 4);
    near(&residuals, &[5.0, 1.5, 1.0, 0.0], 1e-12);
    let found = solve(&problem, [5.0, 0.0, 0.0]);
    near(&found.nodes[0], &[1.5, 0.0, 0.0], 1e-12);
    assert_eq!(iterations(&found), 3);
}

#[test]
fn newton_contracts_by_two_thirds_at_the_critical_collinear_point() {
    let problem = confluence(&[[0.0; 3], [2.0, 0.0, 0.0]], &[1e4, 1e4], &[1.0, 1.0]);
    let residuals = plain_newton(&problem, [1.0, 0.1, 0.0], 12);
    for pair in residuals.windows(2) {
        let ratio = pair[1] / pair[0];
        assert!((0.2950..0.2966).contains(&ratio), "{residuals:?}");
    }
    let found = solve(&problem, [1.0, 0.1, 0.0]);
    assert!(iterations(&found) <= 40, "{found:?}");
    assert!(found.nodes[0][1].abs() < 1e-4 && found.tensions[0] < 1e-4);
}

#[test]
fn a_stiff_light_node_hangs_between_two_cables() {
    let stiffness = 1e8 / 2.4;
    let mut problem = confluence(
        &[[-2.0, 0.0, 2.0], [2.0, 0.0, 2.0]],
        &[stiffness; 2],
        &[2.4; 2],
    );
    problem.load = [0.0, 0.0, -2.0 * 9.81];
    for (start, most) in [([0.0, 0.0, 1.0], 2), ([0.3, 0.1, -1.0], 14)] {
        let found = solve(&problem, start);
        near(&found.tensions, &[17.746951, 17.746951], 1e-5);
        near(&found.nodes[0], &[0.0, 0.0, 0.6733493], 1e-7);
        assert!(
            iterations(&found) <= most,
            "{} steps from {start:?}",
            iterations(&found)
        );
    }
}

#[test]
fn a_stiffness_ratio_of_1e8_keeps_its_digits() {
    let anchors = [
        [0.0, 0.0, 4.0],
        [0.6, 0.0, 0.0],
        [-0.3, 0.52, 0.0],
        [-0.3, -0.52, 0.0],
    ];
    let free_length = [2.9, 1.2, 1.2, 1.2];
    let found = solve(
        &confluence(&anchors, &[1e8, 1.0, 1e4, 1e2], &free_length),
        [0.0, 0.0, 1.0],
    );
    near(
        &found.tensions,
        &[12.52498, 0.1741592, 7.893841, 5.743100],
        1e-5,
    );
    near(&found.nodes[0], &[-0.20955532, 0.06694115, 1.1083558], 1e-7);
    assert!(iterations(&found) <= 60, "{}", iterations(&found));
    let found = solve(
        &confluence(&anchors, &[6e4, 4.7e4, 4.7e4, 4.7e4], &free_length),
        [0.0, 0.0, 1.0],
    );
    near(
        &found.tensions,
        &[2337.52139, 894.42686, 895.59396, 895.59396],
        1e-5,
    );
    assert_eq!(iterations(&found), 4);
}

#[test]
fn lines_without_free_length_balance_at_the_mean_weighted_by_stiffness() {
    let problem = confluence(
        &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]],
        &[1e3, 2e3, 3e3],
        &[0.0; 3],
    );
    let found = solve(&problem, [0.0; 3]);
    near(&found.nodes[0], &[1.0 / 3.0, 1.0, 0.0], 1e-14);
    assert_eq!(iterations(&found), 1);
    let twice = confluence(&[[1.0, 2.0, 3.0]; 2], &[1e3, 2e3], &[0.0; 2]);
    let found = solve(&twice, [0.0; 3]);
    assert!(matches!(found.outcome, Outcome::Slack { .. }));
    near(&found.nodes[0], &[1.0, 2.0, 3.0], 1e-14);
    assert_eq!(found.tensions, [0.0, 0.0]);
}

#[test]
fn coincident_anchors_share_the_force_by_stiffness() {
    let problem = confluence(
        &[[0.0; 3], [0.0; 3], [3.0, 0.0, 0.0]],
        &[1e4, 3e4, 2e4],
        &[1.0; 3],
    );
    let found = solve(&problem, [0.7, 0.4, -0.3]);
    near(&found.nodes[0], &[4.0 / 3.0, 0.0, 0.0], 1e-10);
    near(
        &found.tensions,
        &[10000.0 / 3.0, 10000.0, 40000.0 / 3.0],
        1e-5,
    );
}

#[test]
fn all_slack_is_a_normal_return_with_exactly_no_force() {
    let problem = confluence(&[[0.0; 3], [1.0, 0.0, 0.0]], &[1e4, 1e4], &[1.0, 1.0]);
    let inside = [0.5, 0.1, 0.2];
    let found = solve(&problem, inside);
    assert_eq!(found.outcome, Outcome::Slack { iterations: 0 });
    assert_eq!(
        (found.nodes[0], &found.tensions[..]),
        (inside, &[0.0, 0.0][..])
    );
    let found = solve(&problem, [5.0, 0.1, 0.0]);
    assert_eq!(found.outcome, Outcome::Slack { iterations: 2 });
    let one = confluence(&[[0.0; 3]], &[1e4], &[1.0]);
    let found = solve(&one, [5.0, 0.1, 0.3]);
    assert_eq!(found.outcome, Outcome::Slack { iterations: 1 });
    assert_eq!(found.tensions, [0.0]);
    let radius = found.nodes[0].iter().map(|x| x * x).sum::<f64>().sqrt();
    assert!((radius - 1.0).abs() < 1e-14);
}

/// Two damped lines, anchors at (±1.5, 0), node at (0, 0.1), in implicit steps of length `h` by the stepwise law: when they first carry,
/// their tension 0.1 s later, and the most Newton steps.
fn misaligned_pair(h: f64) -> (f64, f64, usize) {
    let (a, free_length, stiffness) = (1.5f64, 1.499f64, 47e3);
    let numbers = LineNumbers {
        stiffness,
        damping: stiffness * 0.01,
        free_length,
    };
    let mut p = [0.0, 0.1, 0.0];
    let stretch =
        |p: &[f64; 3]| [-a, a].map(|x| ((p[0] - x).powi(2) + p[1].powi(2)).sqrt() - free_length);
    let (mut time, mut jump, mut most, mut tension) = (0.0, None, 0, 0.0);
    while jump.is_none_or(|jump| time < jump + 0.1) {
        time += h;
        let laws = stretch(&p).map(|last| {
            let history = History { last, before: None };
            effective(&numbers, Difference::Euler, Clamp::Positive, h, history)
        });
        let anchors = [[-a, 0.0, 0.0], [a, 0.0, 0.0]];
        let problem = confluence(&anchors, &laws.map(|law| law[0]), &laws.map(|law| law[1]));
        let web = problem.web().unwrap();
        let found = web.solve(&[p], Tolerance::inside_step()).unwrap();
        most = most.max(iterations(&found));
        p = found.nodes[0];
        tension = found.tensions[0];
        if tension > 10.0 && jump.is_none() {
            jump = Some(time);
        }
    }
    (jump.unwrap_or(0.0), tension, most)
}

#[test]
fn a_misaligned_pair_relaxes_without_force_and_then_jumps_to_its_full_tension() {
    let closed_form = 0.01 * (((2.25f64 + 0.01).sqrt() - 1.499) / 0.001).ln();
    assert!((closed_form - 14.655e-3).abs() < 1e-6);
    for (h, printed) in [(1e-3, 16.0e-3), (1e-4, 14.8e-3), (1e-5, 14.67e-3)] {
        let (jump, tension, most) = misaligned_pair(h);
        assert!((jump - printed).abs() < 0.5 * h, "h {h}: jump at {jump}");
        assert!((tension - 47.0).abs() < 0.1, "h {h}: {tension} N");
        assert!(most <= 6, "h {h}: {most} Newton steps");
    }
}

/// Counterexample 11: three carrying lines on prescribed anchors.
struct Prescribed;

impl Prescribed {
    const NUMBERS: [[f64; 3]; 3] = [[6e4, 600.0, 4.0], [4.7e4, 470.0, 1.5], [4.7e4, 470.0, 1.5]];

    fn anchor(i: usize, t: f64) -> (Vector3<f64>, Vector3<f64>) {
        let base = [[0.0, 0.0, 4.05], [0.6, 0.0, -1.38], [-0.6, 0.0, -1.38]][i];
        let size = [
            [0.02, 0.3, 0.004],
            [0.05, 0.1, -0.002],
            [-0.04, 0.15, 0.003],
        ][i];
        let rate = [[3.0, 5.0, 40.0], [4.0, 6.0, 35.0], [5.0, 3.0, 45.0]][i];
        let at = |k: usize| base[k] + size[k] * (rate[k] * t).sin();
        let velocity = |k: usize| size[k] * rate[k] * (rate[k] * t).cos();
        (
            Vector3::new(at(0), at(1), at(2)),
            Vector3::new(velocity(0), velocity(1), velocity(2)),
        )
    }

    /// Velocity and place (projected on the plane of the anchors) of the node.
    fn rate(node: &mut RateNode<f64>, p: Vector3<f64>, t: f64) -> (Vector3<f64>, Vector3<f64>) {
        for (i, [stiffness, damping, free_length]) in Self::NUMBERS.into_iter().enumerate() {
            let (anchor, velocity) = Self::anchor(i, t);
            let numbers = LineNumbers {
                stiffness,
                damping,
                free_length,
            };
            node.set_leg(i, anchor, velocity, numbers);
            node.set_mode(i, true, true);
        }
        let mut place = p;
        for _ in 0..2 {
            node.place(place, [Vector3::zeros(); 2]);
            node.taut_by_stretch();
            assert!(node.decide());
            place = node.projected().expect("three coplanar lines carry");
        }
        assert_eq!(node.spread(), RateOutcome::Algebraic);
        (node.velocity(), place)
    }

    fn tensions(h: f64) -> Vec<f64> {
        let mut node = RateNode::new(3);
        let normal = |t| {
            let [a, b, c] = [0, 1, 2].map(|i| Self::anchor(i, t).0);
            ((b - a).cross(&(c - a)), a)
        };
        let mut p = Vector3::new(0.02, 0.0, 0.03);
        let (n, a) = normal(0.0);
        p -= n * (n.dot(&(p - a)) / n.norm_squared());
        let mut t = 0.0;
        for _ in 0..(0.5 / h).round() as usize {
            let (k1, _) = Self::rate(&mut node, p, t);
            let (k2, _) = Self::rate(&mut node, p + k1 * (h / 2.0), t + h / 2.0);
            let (k3, _) = Self::rate(&mut node, p + k2 * (h / 2.0), t + h / 2.0);
            let (k4, _) = Self::rate(&mut node, p + k3 * h, t + h);
            p += (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (h / 6.0);
            t += h;
            p = Self::rate(&mut node, p, t).1;
        }
        Self::rate(&mut node, p, t);
        node.legs().iter().map(|leg: &Leg<f64>| leg.pull).collect()
    }
}

#[test]
fn three_carrying_lines_stay_coplanar_and_keep_order_four() {
    let answer = [2625.4566, 1434.7730, 1453.9143];
    let mut errors = Vec::new();
    for h in [0.01, 0.005, 0.0025, 0.00125] {
        let found = Prescribed::tensions(h);
        let error = found
            .iter()
            .zip(answer)
            .fold(0.0f64, |worst, (a, b)| worst.max((a - b).abs()));
        println!("h {h}: {found:?}, error {error:e} N");
        errors.push(error);
    }
    assert!(errors[0] < 5e-2 && errors[2] < 3e-4, "{errors:?}");
    assert!((errors[0] / errors[1]).log2() > 3.7, "{errors:?}");
}

#[test]
fn one_ulp_on_either_side_of_the_slack_edge_everything_is_finite_and_tension_continuous() {
    let edge = 1.5f64;
    for place in [edge.next_down(), edge, edge.next_up()] {
        let problem = confluence(&[[0.0; 3], [3.0, 0.0, 0.0]], &[1e4, 2e4], &[1.5, 1.5]);
        let web: Web<f64> = problem.web().unwrap();
        let mut balance = WebBalance::new(&web);
        let mut at = BalanceEvaluation::new(1, 1);
        let (k, l) = web.constants();
        balance.evaluate(&[place, 0.0, 0.0], &k, &l, &mut at);
        assert!(
            at.gradient()
                .iter()
                .all(|g| g.is_finite() && g.abs() < 1e-10)
        );
        assert!(at.block(0).as_flattened().iter().all(|h| h.is_finite()));
        let found = solve(&problem, [place, 0.0, 0.0]);
        assert!(found.tensions.iter().all(|&t| (0.0..1e-10).contains(&t)));
    }
}

#[test]
fn what_is_no_line_is_refused_by_name() {
    let good = ratio_1000();
    for (k, l, what) in [
        (0.0, 1.0, "stiffness"),
        (-1.0, 1.0, "stiffness"),
        (f64::NAN, 1.0, "stiffness"),
        (1.0, -1e-9, "free length"),
        (1.0, f64::INFINITY, "free length"),
    ] {
        let mut bad = good.clone();
        (bad.stiffness[1], bad.free_length[1]) = (k, l);
        match bad.solve([0.0; 3]) {
            Err(NodeError::InvalidLine {
                line: 1,
                what: named,
                ..
            }) => assert_eq!(named, what),
            other => panic!("{other:?}"),
        }
    }
    let mut bad = good.clone();
    bad.anchors[2][1] = f64::NAN;
    assert!(matches!(
        bad.solve([0.0; 3]),
        Err(NodeError::NotFinite { index: 7, .. })
    ));
    assert!(matches!(
        good.solve([f64::NAN; 3]),
        Err(NodeError::NotFinite { what: "start", .. })
    ));
    let mut bad = good;
    bad.stiffness.pop();
    assert!(matches!(bad.solve([0.0; 3]), Err(NodeError::Shape { .. })));
}

#[test]
fn single_precision_balances_to_its_own_digits() {
    let problem = Confluence::<f32> {
        anchors: vec![
            [0.0, 0.0, 4.0],
            [0.6, 0.0, 0.0],
            [-0.3, 0.52, 0.0],
            [-0.3, -0.52, 0.0],
        ],
        stiffness: vec![6e4, 4.7e4, 4.7e4, 4.7e4],
        free_length: vec![2.9, 1.2, 1.2, 1.2],
        load: [0.0; 3],
    };
    let found = problem.solve([0.0, 0.0, 1.0]).unwrap();
    assert!(matches!(
        found.outcome,
        Outcome::Taut {
            strategy: Strategy::Warm,
            ..
        }
    ));
    for (a, b) in found
        .tensions
        .iter()
        .zip([2337.521, 894.427, 895.594, 895.594])
    {
        assert!((a / b - 1.0).abs() < 1e-4, "{found:?}");
    }
}
