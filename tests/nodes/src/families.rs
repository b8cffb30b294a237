//! Random equilibrium problems, family by family: from ordinary ones to the hardest a line scene can pose. Seeded.

use mbd_runtime::node::{Outcome, Solver, Strategy, Tolerance};

use crate::web::{Confluence, Web, WebBalance};
use laws::random::Random;

/// What makes the problems of a family hard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// 2 to 8 lines anywhere, stiffness over two decades.
    Random,
    /// Stiffness over eight decades.
    StiffnessRatio,
    /// Stretches of 1e-10 … 1e-2 of the length.
    BarelyTaut,
    /// Both of them.
    Both,
    /// All anchors on one line.
    Collinear,
    /// All anchors in one plane, stiffness 1e2 … 1e8.
    Coplanar,
    /// No free length.
    NoFreeLength,
    /// Two anchors exactly as far apart as both free lengths together.
    Critical,
}

/// Where the solver starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// Anywhere near the anchors.
    Random,
    /// At the mean of the anchors weighted by stiffness.
    Centroid,
    /// On an anchor.
    Anchor,
    /// Up to 1e6 m away.
    Far,
}

/// The combinations of the campaign.
pub const COMBINATIONS: [(Family, Start); 17] = [
    (Family::Random, Start::Random),
    (Family::Random, Start::Centroid),
    (Family::Random, Start::Anchor),
    (Family::Random, Start::Far),
    (Family::StiffnessRatio, Start::Random),
    (Family::StiffnessRatio, Start::Centroid),
    (Family::BarelyTaut, Start::Random),
    (Family::BarelyTaut, Start::Centroid),
    (Family::Both, Start::Random),
    (Family::Both, Start::Centroid),
    (Family::Collinear, Start::Random),
    (Family::Collinear, Start::Centroid),
    (Family::Coplanar, Start::Random),
    (Family::Coplanar, Start::Centroid),
    (Family::NoFreeLength, Start::Random),
    (Family::NoFreeLength, Start::Anchor),
    (Family::Critical, Start::Random),
];

impl Family {
    /// Whether its stiffnesses spread over eight decades.
    #[must_use]
    pub fn is_spread(self) -> bool {
        matches!(self, Family::StiffnessRatio | Family::Both)
    }

    /// One problem of the family.
    #[must_use]
    pub fn problem(self, random: &mut Random) -> Confluence<f64> {
        let n = if self == Family::Critical {
            2
        } else {
            2 + random.below(7)
        };
        let (along, across) = (random.vector(1.0), random.vector(1.0));
        let anchors: Vec<[f64; 3]> = (0..n)
            .map(|_| match self {
                Family::Collinear => {
                    let t = random.uniform(-2.0, 2.0);
                    along.map(|a| t * a)
                }
                Family::Coplanar => {
                    let (s, t) = (random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0));
                    [0, 1, 2].map(|k| s * along[k] + t * across[k])
                }
                _ => random.vector(2.0),
            })
            .collect();
        let stiffness = (0..n)
            .map(|_| match self {
                Family::StiffnessRatio | Family::Both => random.decades(0.0, 8.0),
                Family::Coplanar => random.decades(2.0, 8.0),
                _ => random.decades(3.0, 5.0),
            })
            .collect();
        let inside = inside(&anchors, random);
        let slack = random.decades(-10.0, -2.0);
        let free_length = anchors
            .iter()
            .map(|anchor| {
                let d = distance(anchor, &inside);
                match self {
                    Family::BarelyTaut | Family::Both => {
                        d * (1.0 - slack * random.uniform(0.0, 1.0))
                    }
                    Family::NoFreeLength => 0.0,
                    Family::Critical => distance(&anchors[0], &anchors[1]) / 2.0,
                    _ => d * random.uniform(0.2, 1.2),
                }
            })
            .collect();
        Confluence {
            anchors,
            stiffness,
            free_length,
            load: [0.0; 3],
        }
    }
}

impl Start {
    /// A start of this kind for a problem.
    #[must_use]
    pub fn place(self, problem: &Confluence<f64>, random: &mut Random) -> [f64; 3] {
        match self {
            Start::Random => random.vector(3.0),
            Start::Far => {
                let size = random.decades(0.0, 6.0);
                random.vector(size)
            }
            Start::Anchor => problem.anchors[random.below(problem.anchors.len())],
            Start::Centroid => {
                let total: f64 = problem.stiffness.iter().sum();
                [0, 1, 2].map(|k| {
                    let weighted = problem.anchors.iter().zip(&problem.stiffness);
                    weighted.map(|(p, w)| p[k] * w).sum::<f64>() / total
                })
            }
        }
    }
}

/// A point among the anchors: a random mean with positive weights.
fn inside(anchors: &[[f64; 3]], random: &mut Random) -> [f64; 3] {
    let weights: Vec<f64> = anchors.iter().map(|_| random.uniform(0.1, 1.0)).collect();
    let total: f64 = weights.iter().sum();
    [0, 1, 2].map(|k| {
        anchors
            .iter()
            .zip(&weights)
            .map(|(p, w)| p[k] * w)
            .sum::<f64>()
            / total
    })
}

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b) * (a - b))
        .sum::<f64>()
        .sqrt()
}

/// What became of a family.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// Problems.
    pub problems: usize,
    /// Ended on the warm strategy.
    pub warm: usize,
    /// Ended by homotopy.
    pub homotopy: usize,
    /// Ended by slope search.
    pub search: usize,
    /// All slack.
    pub slack: usize,
    /// Typed failures.
    pub failed: usize,
    /// Newton steps of each problem.
    pub iterations: Vec<usize>,
}

impl Tally {
    /// Counts one solve.
    pub fn count(&mut self, outcome: &Outcome<f64>) {
        self.problems += 1;
        self.iterations.push(outcome.iterations());
        match outcome {
            Outcome::Taut {
                strategy: Strategy::Warm,
                ..
            } => self.warm += 1,
            Outcome::Taut {
                strategy: Strategy::Homotopy,
                ..
            } => self.homotopy += 1,
            Outcome::Taut {
                strategy: Strategy::Search,
                ..
            } => self.search += 1,
            Outcome::Slack { .. } => self.slack += 1,
            Outcome::NotConverged { .. } => self.failed += 1,
        }
    }

    /// Mean, 99th percentile and maximum of the Newton steps.
    #[must_use]
    pub fn steps(&self) -> (f64, usize, usize) {
        let mut sorted = self.iterations.clone();
        sorted.sort_unstable();
        let at = |part: f64| {
            let index = (part * sorted.len() as f64) as usize;
            sorted
                .get(index.min(sorted.len().saturating_sub(1)))
                .copied()
                .unwrap_or(0)
        };
        let mean = sorted.iter().sum::<usize>() as f64 / sorted.len().max(1) as f64;
        (mean, at(0.99), at(1.0))
    }
}

/// Solves `count` problems of one combination, with a load of 1e-2 … 1e4 N in a random direction if `loaded`.
///
/// # Panics
/// Never for the problems of [`Family::problem`].
#[must_use]
pub fn run(family: Family, start: Start, loaded: bool, count: usize, seed: u64) -> Tally {
    let mut random = Random::new(seed);
    let mut tally = Tally::default();
    for _ in 0..count {
        let mut problem = family.problem(&mut random);
        if loaded {
            let size = random.decades(-2.0, 4.0);
            problem.load = random.vector(1.0).map(|x| x * size);
        }
        let mut p = start.place(&problem, &mut random);
        let web = problem.web().expect("lists of one length");
        tally.count(&solve(&web, &mut p));
    }
    tally
}

/// Solves a web of one node in place.
pub fn solve(web: &Web<f64>, p: &mut [f64]) -> Outcome<f64> {
    let mut solver = Solver::new(web.loads.len(), web.lines.len(), &web.blocks());
    let mut balance = WebBalance::new(web);
    let (k, l) = web.constants();
    solver.solve(&mut balance, &k, &l, p, Tolerance::alone())
}
