//! Random networks of nodes, and random rate problems, for short tests and for long runs. Seeded.

use mbd_runtime::node::{History, NodeError, RateNode, RateOutcome, Tolerance, effective};
use mbd_scene::laws::LineNumbers;
use mbd_scene::{Clamp, Difference};
use nalgebra::Vector3;

use crate::web::{Equilibrium, Tie, Web, WebLine};
use laws::random::Random;

/// What makes the networks of a family hard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// Stiffness over two decades, a load on every node.
    Loaded,
    /// The same without a load.
    Free,
    /// Stiffness over six decades.
    Spread,
    /// Lines of 1e4 N/m or this many times as stiff.
    Uneven(f64),
    /// Damped lines of `stepwise` nodes: stiffness and length that a step with implicit Euler gives them.
    Stepwise,
}

/// The families of the long run.
pub const KINDS: [Kind; 5] = [
    Kind::Loaded,
    Kind::Free,
    Kind::Spread,
    Kind::Uneven(1e6),
    Kind::Stepwise,
];

impl Kind {
    fn stiffness(self, random: &mut Random) -> f64 {
        match self {
            Kind::Loaded | Kind::Free | Kind::Stepwise => random.decades(3.0, 5.0),
            Kind::Spread => random.decades(2.0, 8.0),
            Kind::Uneven(ratio) => match random.below(2) {
                0 => 1e4,
                _ => 1e4 * ratio,
            },
        }
    }

    /// A network of so many nodes, each tied to an anchor or to a node that is.
    #[must_use]
    pub fn network(self, random: &mut Random, nodes: usize) -> Web<f64> {
        let anchors: Vec<[f64; 3]> = (0..3 + nodes).map(|_| random.vector(2.0)).collect();
        let lines = (0..3 * nodes)
            .map(|i| {
                let node = i % nodes;
                let to = match random.below(2) {
                    1 if node > 0 => Tie::Node(random.below(node)),
                    _ => Tie::Anchor(random.below(anchors.len())),
                };
                let stiffness = self.stiffness(random);
                let free_length = random.uniform(0.1, 2.0);
                let [stiffness, free_length] = match self {
                    Kind::Stepwise => in_a_step(random, stiffness, free_length),
                    _ => [stiffness, free_length],
                };
                WebLine {
                    ends: [Tie::Node(node), to],
                    stiffness,
                    free_length,
                }
            })
            .collect();
        let load = match self {
            Kind::Free => 0.0,
            _ => 1e3,
        };
        Web {
            loads: (0..nodes).map(|_| random.vector(load)).collect(),
            anchors,
            lines,
        }
    }
}

/// K_e and L_e of a damped line in a step of 1e-4 s to 0.1 s, after a stretch of either sign.
fn in_a_step(random: &mut Random, stiffness: f64, free_length: f64) -> [f64; 2] {
    let numbers = LineNumbers {
        stiffness,
        damping: stiffness * random.uniform(0.005, 0.02),
        free_length,
    };
    let history = History {
        last: random.uniform(-0.1, 0.2),
        before: None,
    };
    let step = random.decades(-4.0, -1.0);
    effective(&numbers, Difference::Euler, Clamp::Positive, step, history)
}

/// The largest force on a node that its lines leave [N], over the sum of all tensions and loads, and what rounding of lengths makes of them
/// [N], over the same: [balance, rounding].
#[must_use]
pub fn unbalanced(web: &Web<f64>, found: &Equilibrium<f64>) -> [f64; 2] {
    let place = |tie: Tie| match tie {
        Tie::Anchor(a) => Vector3::from(web.anchors[a]),
        Tie::Node(n) => Vector3::from(found.nodes[n]),
    };
    let mut forces: Vec<Vector3<f64>> = web.loads.iter().map(|load| (*load).into()).collect();
    let mut sum: f64 = forces.iter().map(|load| load.norm()).sum();
    let mut rounding = 0.0;
    for (line, &tension) in web.lines.iter().zip(&found.tensions) {
        let [from, to] = line.ends.map(place);
        let along = (to - from).try_normalize(0.0).unwrap_or_default() * tension;
        let [own, other] = line.ends;
        for (tie, force) in [(own, along), (other, -along)] {
            if let Tie::Node(node) = tie {
                forces[node] += force;
            }
        }
        sum += tension;
        rounding += f64::EPSILON * line.stiffness * (from.norm() + to.norm());
    }
    let worst = forces.iter().map(|force| force.norm()).fold(0.0, f64::max);
    [worst / sum, rounding / sum]
}

/// What came of many networks.
#[derive(Clone, Debug, Default)]
pub struct Solved {
    /// Networks.
    pub problems: u64,
    /// In balance, some line taut.
    pub taut: u64,
    /// All slack.
    pub slack: u64,
    /// No balance found, and the two lines named whose stiffness is too uneven.
    pub named: u64,
    /// Of these the least ratio of stiffness.
    pub ratio: f64,
    /// No balance found, and nothing named: which.
    pub unnamed: Vec<u64>,
    /// Told to be in balance, and not: which.
    pub wrong: Vec<u64>,
    /// Most Newton steps of one.
    pub most: usize,
    /// Sum of the Newton steps.
    pub steps: usize,
    /// The worst balance, over tensions and loads.
    pub worst: f64,
}

impl Solved {
    /// Solves the problem of this number, from a random start.
    ///
    /// # Panics
    /// Where a network is refused as none.
    pub fn solve(&mut self, kind: Kind, number: u64, nodes: usize) {
        let mut random = Random::new(number);
        let web = kind.network(&mut random, nodes);
        let start: Vec<[f64; 3]> = web.loads.iter().map(|_| random.vector(2.0)).collect();
        self.problems += 1;
        match web.solve(&start, Tolerance::inside_step()) {
            Ok(found) => {
                let steps = found.outcome.iterations();
                self.most = self.most.max(steps);
                self.steps += steps;
                if found.tensions.iter().all(|tension| *tension == 0.0) {
                    self.slack += 1;
                    // A load that nothing carries is no balance.
                    let loaded = web.loads.as_flattened().iter().any(|load| *load != 0.0);
                    self.wrong.extend(loaded.then_some(number));
                    return;
                }
                self.taut += 1;
                let [open, rounding] = unbalanced(&web, &found);
                self.worst = self.worst.max(open);
                let good = open <= 1e-9 + 10.0 * rounding;
                self.wrong.extend((!good).then_some(number));
            }
            Err(NodeError::NotConverged {
                uneven: Some(pair), ..
            }) => {
                self.ratio = match self.named {
                    0 => pair.ratio,
                    _ => self.ratio.min(pair.ratio),
                };
                self.named += 1;
            }
            Err(NodeError::NotConverged { .. }) => self.unnamed.push(number),
            Err(other) => panic!("network {number} of {kind:?}: {other}"),
        }
    }
}

/// A random rate problem of 2 to 8 damped lines.
#[must_use]
pub fn rate_problem(random: &mut Random) -> RateNode<f64> {
    let n = 2 + random.below(7);
    let mut node: RateNode<f64> = RateNode::new(n);
    for i in 0..n {
        let stiffness = random.decades(4.0, 5.0);
        let numbers = LineNumbers {
            stiffness,
            damping: stiffness * random.uniform(0.005, 0.02),
            free_length: random.uniform(0.8, 1.2),
        };
        let direction = Vector3::from(random.vector(1.0)).normalize();
        node.set_leg(
            i,
            direction * random.uniform(0.95, 1.2),
            Vector3::from(random.vector(3.0)),
            numbers,
        );
        node.set_mode(i, true, random.below(2) == 0);
    }
    node.place(Vector3::zeros(), [Vector3::zeros(); 2]);
    node.taut_by_stretch();
    node
}

/// What came of many rate problems.
#[derive(Clone, Debug, Default)]
pub struct Decided {
    /// Problems.
    pub problems: u64,
    /// Velocity decided by dampers in all directions, by the mean of the anchors where nothing pulls, by the balance of what pulls.
    pub spreads: [u64; 3],
    /// What is open of a balance where lines lie as good as in one plane, over what pulls.
    pub open: f64,
    /// Which problem broke what.
    pub broken: Vec<(u64, &'static str)>,
}

/// The fastest that a line lets its end move by itself: K s/C and the velocities of the anchors [m/s].
fn fastest(node: &RateNode<f64>) -> f64 {
    let legs = node.legs().iter();
    legs.map(|leg| {
        leg.numbers.stiffness * leg.stretch.max(0.0) / leg.numbers.damping + leg.velocity.norm()
    })
    .sum()
}

impl Decided {
    /// Decides the problem of this number: the minimum of a convex function, whose conditions are checked.
    pub fn decide(&mut self, number: u64) {
        let mut node = rate_problem(&mut Random::new(number));
        self.problems += 1;
        let decided = node.decide();
        let broken = match decided {
            true => self.look(&node),
            false => Some("undecided"),
        };
        self.broken.extend(broken.map(|what| (number, what)));
    }

    fn look(&mut self, node: &RateNode<f64>) -> Option<&'static str> {
        let velocity = node.velocity().norm();
        if velocity.is_nan() || velocity >= 1e3 * fastest(node) {
            return Some("faster than its lines let it");
        }
        let (mut force, mut scale) = (Vector3::zeros(), 0.0);
        for leg in node.legs().iter().filter(|leg| leg.taut) {
            scale += leg.pull.abs() + 10.0 * leg.numbers.damping;
            if leg.active {
                force += leg.anchor.normalize() * leg.pull;
            }
        }
        if node.spread() == RateOutcome::Algebraic {
            let active = node.legs().iter().filter(|leg| leg.active);
            let pulls: f64 = active.map(|leg| leg.pull).sum();
            // As good as in one plane: what is open is a force across it.
            self.open = (force.norm() / pulls).max(self.open);
            self.spreads[2] += 1;
            return None;
        }
        self.spreads[usize::from(node.spread() == RateOutcome::Idle)] += 1;
        for leg in node.legs().iter().filter(|leg| leg.taut) {
            let wrong = if leg.active { -leg.pull } else { leg.pull };
            if wrong > 1e-5 * scale {
                return Some("a line pushes, or should pull");
            }
        }
        (force.norm() > 1e-9 * scale).then_some("not in balance")
    }
}

/// Of `count` networks whose lines are of 1e4 N/m and of `stiff`: how many found no balance and named two lines, how many named none, and the most steps a balance took.
#[must_use]
pub fn unsolved(random: &mut Random, count: usize, nodes: usize, stiff: f64) -> [usize; 3] {
    let (mut named, mut unnamed, mut most) = (0, 0, 0);
    for _ in 0..count {
        let web = Kind::Uneven(stiff / 1e4).network(random, nodes);
        let start: Vec<[f64; 3]> = web.loads.iter().map(|_| random.vector(2.0)).collect();
        match web.solve(&start, Tolerance::inside_step()) {
            Ok(found) => most = most.max(found.outcome.iterations()),
            Err(NodeError::NotConverged { uneven, .. }) => match uneven {
                Some(pair) => {
                    assert_eq!(web.lines[pair.softest].stiffness, 1e4);
                    assert_eq!(web.lines[pair.stiffest].stiffness, stiff);
                    assert_eq!(pair.ratio, stiff / 1e4);
                    named += 1;
                }
                None => unnamed += 1,
            },
            Err(other) => panic!("{other}"),
        }
    }
    println!(
        "{count} networks of {nodes} nodes, {stiff:e} N/m: {named} named, {unnamed} unnamed, at most {most} steps"
    );
    [named, unnamed, most]
}
