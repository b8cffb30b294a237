//! Coupled nodes, and single nodes against an independent reference.

use mbd_compiler::read_text;
use mbd_runtime::node::{Balance, BalanceEvaluation, BlockCholesky, NodeError, Outcome, Tolerance};
use mbd_runtime::{Generic, Options, Simulation, StepError};
use nalgebra::DMatrix;
use tests::assert_close;
use tests::networks::{Kind, unsolved};
use tests::random::Random;
use tests::reference::{field, load, numbers};
use tests::web::{Confluence, Tie, Web, WebBalance, WebLine};

const TIGHT: Tolerance<f64> = Tolerance {
    relative: 1e-13,
    absolute: 1e-16,
};

/// 2 to 5 nodes, 4 to 15 lines, every node on at least one line.
fn network(random: &mut Random) -> Web<f64> {
    let nodes = 2 + random.below(4);
    let anchors: Vec<[f64; 3]> = (0..3 + random.below(4))
        .map(|_| random.vector(2.0))
        .collect();
    let count = nodes.max(4) + random.below(12);
    let lines = (0..count)
        .map(|i| {
            let from = Tie::Node(if i < nodes { i } else { random.below(nodes) });
            let mut to = Tie::Anchor(random.below(anchors.len()));
            if random.uniform(0.0, 1.0) < 0.4 {
                let other = Tie::Node(random.below(nodes));
                to = if other == from { to } else { other };
            }
            WebLine {
                ends: [from, to],
                stiffness: random.decades(3.0, 5.0),
                free_length: random.uniform(0.1, 2.0),
            }
        })
        .collect();
    Web {
        anchors,
        loads: vec![[0.0; 3]; nodes],
        lines,
    }
}

#[test]
fn tensions_of_a_network_are_unique_from_any_start() {
    let mut random = Random::new(5);
    let (mut steps, mut taut, mut most) = (0, 0, 0);
    for _ in 0..400 {
        let web = network(&mut random);
        let largest = web
            .lines
            .iter()
            .fold(0.0f64, |m, line| m.max(line.stiffness * line.free_length));
        let mut first: Option<Vec<f64>> = None;
        for _ in 0..3 {
            let start: Vec<[f64; 3]> = web.loads.iter().map(|_| random.vector(4.0)).collect();
            let found = web.solve(&start, Tolerance::inside_step()).unwrap();
            if matches!(found.outcome, Outcome::Taut { .. }) {
                taut += 1;
                steps += found.outcome.iterations();
                most = most.max(found.outcome.iterations());
            }
            match &first {
                None => first = Some(found.tensions),
                Some(first) => {
                    for (a, b) in found.tensions.iter().zip(first) {
                        assert!((a - b).abs() < 1e-10 * largest, "{a} {b} of {largest}");
                    }
                }
            }
        }
    }
    println!(
        "{taut} taut solves, mean {:.2} steps, at most {most}",
        steps as f64 / f64::from(taut)
    );
    assert!(taut > 600);
}

/// Whether lines lead from every node to an anchor.
fn is_tied(web: &Web<f64>) -> bool {
    let mut tied = vec![false; web.loads.len()];
    for _ in 0..tied.len() {
        for line in &web.lines {
            let ends = line.ends.map(|end| match end {
                Tie::Anchor(_) => true,
                Tie::Node(node) => tied[node],
            });
            for end in line.ends {
                if let Tie::Node(node) = end {
                    tied[node] |= ends[0] || ends[1];
                }
            }
        }
    }
    tied.into_iter().all(|tied| tied)
}

/// Networks with a group of nodes that no line ties to an anchor, of which this many are tried: what they take until they are refused is most of the test.
const LOOSE: usize = 6;

#[test]
fn forces_on_every_node_of_a_network_balance_its_load() {
    let mut random = Random::new(6);
    let (mut refused, mut loose) = (0, 0);
    for _ in 0..2000 {
        let mut web = network(&mut random);
        for load in &mut web.loads {
            *load = random.vector(50.0);
        }
        let start: Vec<[f64; 3]> = web.loads.iter().map(|_| random.vector(4.0)).collect();
        let is_loose = !is_tied(&web);
        loose += usize::from(is_loose);
        if is_loose && loose > LOOSE {
            continue;
        }
        let found = match web.solve(&start, Tolerance::inside_step()) {
            Ok(found) => found,
            // A loaded group of nodes that no line ties to an anchor has no balance.
            Err(NodeError::NotConverged { .. }) if is_loose => {
                refused += 1;
                continue;
            }
            Err(other) => panic!("{other}"),
        };
        let mut balance = WebBalance::new(&web);
        let mut at = BalanceEvaluation::new(web.loads.len(), web.blocks().len());
        let (k, l) = web.constants();
        balance.evaluate(found.nodes.as_flattened(), &k, &l, &mut at);
        let strongest = found.tensions.iter().fold(50.0f64, |m, t| m.max(*t));
        assert!(at.gradient().iter().all(|g| g.abs() < 1e-9 * strongest));
    }
    // Such groups fly off until rounding of their places outweighs their load.
    assert!(refused >= 1 && loose < 50, "{refused} of {loose}");
}

#[test]
fn stiffness_of_a_stretched_node_is_positive_definite_with_the_bound_of_its_lines() {
    let mut random = Random::new(8);
    for _ in 0..20_000 {
        let n = 1 + random.below(7);
        let problem = Confluence {
            anchors: (0..n).map(|_| random.vector(2.0)).collect(),
            stiffness: (0..n).map(|_| random.decades(2.0, 6.0)).collect(),
            free_length: (0..n).map(|_| random.uniform(0.0, 2.0)).collect(),
            load: [0.0; 3],
        };
        let web = problem.web().unwrap();
        let mut balance = WebBalance::new(&web);
        let mut at = BalanceEvaluation::new(1, 1);
        let (k, l) = web.constants();
        let p = random.vector(3.0);
        balance.evaluate(&p, &k, &l, &mut at);
        let tensions = web.tensions(&[p]);
        let mut bound = 0.0;
        for (tension, anchor) in tensions.iter().zip(&problem.anchors) {
            let d = anchor
                .iter()
                .zip(p)
                .map(|(a, p)| (a - p) * (a - p))
                .sum::<f64>()
                .sqrt();
            bound += tension / d;
        }
        let h = at.block(0);
        let trace = h[0][0] + h[1][1] + h[2][2];
        // H minus slightly less than the bound is still positive definite.
        let mut factor = BlockCholesky::<f64, 3>::new(1, &[(0, 0)]);
        let shift = -bound + 1e-14 * trace + 1e-300;
        assert!(trace == 0.0 || factor.factor(shift, |_| h));
    }
}

#[test]
fn the_sparse_factor_solves_what_the_dense_inverse_solves() {
    let mut random = Random::new(9);
    for size in 1..9 {
        for _ in 0..20 {
            let mut pattern: Vec<(usize, usize)> = (0..size).map(|k| (k, k)).collect();
            for row in 0..size {
                for column in 0..row {
                    if random.uniform(0.0, 1.0) < 0.35 {
                        pattern.push(if random.below(2) == 0 {
                            (row, column)
                        } else {
                            (column, row)
                        });
                    }
                }
            }
            let blocks: Vec<[[f64; 3]; 3]> = pattern
                .iter()
                .map(|&(row, column)| {
                    let mut block = [random.vector(1.0), random.vector(1.0), random.vector(1.0)];
                    if row == column {
                        let plain = block;
                        for i in 0..3 {
                            for j in 0..3 {
                                block[i][j] = plain[i][j] + plain[j][i];
                            }
                            block[i][i] += 40.0;
                        }
                    }
                    block
                })
                .collect();
            let mut dense = DMatrix::<f64>::zeros(3 * size, 3 * size);
            for (&(row, column), block) in pattern.iter().zip(&blocks) {
                for i in 0..3 {
                    for j in 0..3 {
                        dense[(3 * row + i, 3 * column + j)] = block[i][j];
                        dense[(3 * column + j, 3 * row + i)] = block[i][j];
                    }
                }
            }
            let expected: Vec<f64> = (0..3 * size).map(|_| random.uniform(-1.0, 1.0)).collect();
            let right = &dense * nalgebra::DVector::from_vec(expected.clone());
            let mut factor = BlockCholesky::new(size, &pattern);
            assert!(factor.factor(0.0, |k| blocks[k]));
            let mut x: Vec<f64> = right.iter().copied().collect();
            factor.solve(&mut x);
            assert_close(&x, &expected, 1e-12, 0.0, "solution");
        }
    }
}

#[test]
fn a_chain_is_eliminated_without_fill() {
    let chain: Vec<(usize, usize)> = (0..9)
        .map(|k| (k, k))
        .chain((1..9).map(|k| (k, k - 1)))
        .collect();
    assert_eq!(
        BlockCholesky::<f64, 3>::new(9, &chain).stored(),
        chain.len()
    );
    let star: Vec<(usize, usize)> = (0..9)
        .map(|k| (k, k))
        .chain((1..9).map(|k| (k, 0)))
        .collect();
    assert_eq!(BlockCholesky::<f64, 3>::new(9, &star).stored(), star.len());
}

#[test]
fn confluences_agree_with_forty_digit_references() {
    let data = load("lines/lines_confluence_a.json");
    let mut seen = 0;
    for case in data["cases"].as_array().unwrap() {
        let lines = case["lines"].as_array().unwrap();
        if lines.iter().any(|line| line["c"].as_f64() != Some(0.0)) {
            continue;
        }
        seen += 1;
        let of = |name: &str| {
            lines
                .iter()
                .map(|line| line[name].as_f64().unwrap())
                .collect()
        };
        let triple = |list: Vec<f64>| [list[0], list[1], list[2]];
        let problem = Confluence {
            anchors: lines.iter().map(|line| triple(field(line, "a"))).collect(),
            stiffness: of("k"),
            free_length: of("l0"),
            load: triple(field(case, "load")),
        };
        let web = problem.web().unwrap();
        let found = web.solve(&[[0.0, 0.0, 1.1]], TIGHT).unwrap();
        let x = field(case, "x");
        assert_close(&found.nodes[0], &x, 1e-12, 0.0, "position");
        assert_close(
            &found.tensions,
            &field(case, "tension"),
            1e-12,
            0.0,
            "tensions",
        );
        let mut balance = WebBalance::new(&web);
        let mut at = BalanceEvaluation::new(1, 1);
        let (k, l) = web.constants();
        let mut check = |p: &[f64], jacobian: &[f64]| {
            balance.evaluate(p, &k, &l, &mut at);
            let block = at.block(0);
            let found: Vec<f64> = block.as_flattened().iter().map(|h| -h).collect();
            assert_close(&found, jacobian, 1e-12, 0.0, "Jacobian");
            at.gradient().iter().map(|g| -g).collect::<Vec<f64>>()
        };
        check(&x, &numbers(&case["jacobian_at_x"]));
        for probe in case["probes"].as_array().unwrap() {
            let force = check(&field(probe, "x"), &numbers(&probe["jacobian"]));
            assert_close(&force, &field(probe, "residual"), 1e-12, 0.0, "residual");
        }
    }
    assert_eq!(seen, 6);
}

#[test]
fn networks_with_lines_a_million_times_as_stiff_as_others_balance() {
    let [named, unnamed, most] = unsolved(&mut Random::new(2), 1000, 5, 1e10);
    assert_eq!([named, unnamed], [0, 0]);
    // More than 12 + 8·40 + 300, which was the cap.
    assert!(most > 632);
    let [named, unnamed, _] = unsolved(&mut Random::new(1), 20, 50, 1e10);
    assert_eq!([named, unnamed], [0, 0]);
}

#[test]
fn networks_with_lines_a_billion_times_as_stiff_as_others_balance_or_name_two_of_them() {
    let [named, unnamed, _] = unsolved(&mut Random::new(1), 1000, 5, 1e13);
    assert!(named > 0);
    assert_eq!(unnamed, 0);
}

/// The network as a declaration; a body that moves freely makes it a scene that runs.
fn declaration(web: &Web<f64>) -> String {
    let mut frames = String::new();
    for (i, [x, y, z]) in web.anchors.iter().enumerate() {
        frames += &format!("frame post{i} at [{x:?}, {y:?}, {z:?}] m, ");
    }
    let mut items = String::new();
    for (i, [x, y, z]) in web.loads.iter().enumerate() {
        items += &format!("point knot{i} {{ equilibrium: static }}\n");
        items += &format!("load weight{i} on knot{i} = [{x:?}, {y:?}, {z:?}] N;\n");
    }
    let place = |tie: Tie| match tie {
        Tie::Anchor(a) => format!("world.post{a}"),
        Tie::Node(n) => format!("knot{n}"),
    };
    for (i, line) in web.lines.iter().enumerate() {
        let [from, to] = line.ends.map(place);
        let (stiffness, free_length) = (line.stiffness, line.free_length);
        items += &format!(
            "line stay{i} from {from} to {to} {{ stiffness: {stiffness:?} N/m, free_length: {free_length:?} m }}\n"
        );
    }
    format!(
        "model Network {{ gravity: [0.0, 0.0, 0.0] m/s^2;
            world {{ {frames} }}
            point bob {{ mass: 1 kg }}
            {items} }}"
    )
}

#[test]
fn a_run_that_finds_no_balance_names_its_softest_and_its_stiffest_line_and_says_what_to_change() {
    let mut random = Random::new(1);
    let stiff = 1e16;
    let mut told = 0;
    for _ in 0..60 {
        let web = Kind::Uneven(stiff / 1e4).network(&mut random, 5);
        let scene = read_text(&declaration(&web)).scene.expect("a network");
        let model = Generic::<f64>::with_defaults(scene).expect("no params");
        let mut run = Simulation::<f64>::new(&model, Options::rk4(1e-3)).expect("options");
        let Err(error) = run.run(1e-3) else { continue };
        let StepError::NoEquilibrium {
            uneven: Some(pair), ..
        } = &error.cause
        else {
            continue;
        };
        told += 1;
        let stiffness = |name: &str| {
            let index = name.strip_prefix("stay").and_then(|i| i.parse().ok());
            index.map(|i: usize| web.lines[i].stiffness)
        };
        assert_eq!(stiffness(&pair.softest), Some(1e4));
        assert_eq!(stiffness(&pair.stiffest), Some(stiff));
        assert_eq!(pair.ratio, stiff / 1e4);
        let (soft, hard) = (&pair.softest, &pair.stiffest);
        let text = error.to_string();
        for part in [
            format!("`{hard}` is 1e12 times as stiff as `{soft}`"),
            format!("make `{hard}` softer or `{soft}` stiffer"),
        ] {
            assert!(text.contains(&part), "{text}");
        }
        // Each is told in the same words.
        if told == 8 {
            break;
        }
    }
    assert!(told > 0);
}
