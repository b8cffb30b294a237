//! Equilibrium problems of their own: anchors and lines as plain lists, without a scene.
//!
//! The line law is the one of the scenes, so these problems test the solver and the law together.

use mbd_scene::Float;
use nalgebra::{Matrix3, Vector3};

use super::balance::{Balance, Evaluation};
use super::error::NodeError;
use super::solver::{Outcome, Solver, Tolerance};
use mbd_scene::laws::line as law;

/// Where a line of a [`Web`] ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tie {
    /// At a fixed place: index into [`Web::anchors`].
    Anchor(usize),
    /// At a node: index into [`Web::loads`].
    Node(usize),
}

/// A tension-only line of a [`Web`]: T = K (d − L)₊.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WebLine<T> {
    /// Its two ends.
    pub ends: [Tie; 2],
    /// Stiffness K > 0 [N/m].
    pub stiffness: T,
    /// Free length L ≥ 0 [m].
    pub free_length: T,
}

/// Coupled nodes held by lines.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Web<T> {
    /// Fixed places [m].
    pub anchors: Vec<[T; 3]>,
    /// The load on each node [N]; its length is the number of nodes.
    pub loads: Vec<[T; 3]>,
    /// The lines.
    pub lines: Vec<WebLine<T>>,
}

/// One node held by lines: the equilibrium point of a parachute's confluence.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Confluence<T> {
    /// The far end of each line [m].
    pub anchors: Vec<[T; 3]>,
    /// Stiffness K of each line, > 0 [N/m].
    pub stiffness: Vec<T>,
    /// Free length L of each line, ≥ 0 [m].
    pub free_length: Vec<T>,
    /// The load W on the node [N].
    pub load: [T; 3],
}

/// A solved [`Web`].
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibrium<T> {
    /// How the solve ended; never `NotConverged`, which is an error.
    pub outcome: Outcome<T>,
    /// The nodes [m].
    pub nodes: Vec<[T; 3]>,
    /// The tension of each line [N]; exactly zero everywhere when the outcome is `Slack`.
    pub tensions: Vec<T>,
}

impl<T: Float> Confluence<T> {
    /// The same problem as a web of one node.
    ///
    /// # Errors
    /// [`NodeError::Shape`] if the lists differ in length.
    pub fn web(&self) -> Result<Web<T>, NodeError> {
        let n = self.anchors.len();
        NodeError::same_length("stiffness", self.stiffness.len(), n)?;
        NodeError::same_length("free_length", self.free_length.len(), n)?;
        let lines = self.stiffness.iter().zip(&self.free_length).enumerate();
        Ok(Web {
            anchors: self.anchors.clone(),
            loads: vec![self.load],
            lines: lines
                .map(|(i, (&stiffness, &free_length))| WebLine {
                    ends: [Tie::Node(0), Tie::Anchor(i)],
                    stiffness,
                    free_length,
                })
                .collect(),
        })
    }

    /// Solves for the node from `start`, to the tolerance of a problem of its own.
    ///
    /// # Errors
    /// [`NodeError`] for inputs that are no lines, or if no balance was found.
    pub fn solve(&self, start: [T; 3]) -> Result<Equilibrium<T>, NodeError> {
        self.web()?.solve(&[start], Tolerance::alone())
    }
}

impl<T: Float> Web<T> {
    /// Refuses what is no problem: K ≤ 0, L < 0, anything that is not finite, ends that do not exist or coincide.
    ///
    /// # Errors
    /// [`NodeError`] naming the line, the anchor or the load.
    pub fn check(&self) -> Result<(), NodeError> {
        for (index, line) in self.lines.iter().enumerate() {
            NodeError::check_line(index, line.stiffness, T::zero(), line.free_length)?;
            let exists = |tie: &Tie| match *tie {
                Tie::Anchor(a) => a < self.anchors.len(),
                Tie::Node(n) => n < self.loads.len(),
            };
            if !line.ends.iter().all(exists) || line.ends[0] == line.ends[1] {
                return Err(NodeError::InvalidLine {
                    line: index,
                    what: "ends",
                    value: f64::NAN,
                });
            }
        }
        NodeError::check_finite("anchors", self.anchors.as_flattened())?;
        NodeError::check_finite("loads", self.loads.as_flattened())
    }

    /// Structural non-zero blocks of H, row ≥ column: the diagonal, then the pairs of nodes joined by a line.
    #[must_use]
    pub fn blocks(&self) -> Vec<(usize, usize)> {
        let mut pairs: Vec<(usize, usize)> = self
            .lines
            .iter()
            .filter_map(|line| match line.ends {
                [Tie::Node(a), Tie::Node(b)] => Some((a.max(b), a.min(b))),
                _ => None,
            })
            .collect();
        pairs.sort_unstable();
        pairs.dedup();
        (0..self.loads.len()).map(|n| (n, n)).chain(pairs).collect()
    }

    /// Solves from `start`, one place a node.
    ///
    /// # Errors
    /// [`NodeError`] for inputs that are no problem, or if no balance was found.
    pub fn solve(
        &self,
        start: &[[T; 3]],
        tolerance: Tolerance<T>,
    ) -> Result<Equilibrium<T>, NodeError> {
        self.check()?;
        NodeError::same_length("start", start.len(), self.loads.len())?;
        NodeError::check_finite("start", start.as_flattened())?;
        let blocks = self.blocks();
        let mut solver = Solver::new(self.loads.len(), self.lines.len(), &blocks);
        let mut nodes = start.to_vec();
        let mut balance = WebBalance::new(self, &blocks);
        let (k, l) = self.constants();
        let outcome = solver.solve(&mut balance, &k, &l, nodes.as_flattened_mut(), tolerance);
        let tensions = match outcome {
            Outcome::NotConverged {
                residual,
                iterations,
            } => {
                return Err(NodeError::NotConverged {
                    node: 0,
                    residual_n: residual.to_f64(),
                    iterations,
                });
            }
            Outcome::Slack { .. } => vec![T::zero(); self.lines.len()],
            Outcome::Taut { .. } => self.tensions(&nodes),
        };
        Ok(Equilibrium {
            outcome,
            nodes,
            tensions,
        })
    }

    /// Stiffness and free length of every line, as the solver takes them.
    #[must_use]
    pub fn constants(&self) -> (Vec<T>, Vec<T>) {
        self.lines
            .iter()
            .map(|line| (line.stiffness, line.free_length))
            .unzip()
    }

    /// The tension of every line with the nodes at `nodes` [N].
    #[must_use]
    pub fn tensions(&self, nodes: &[[T; 3]]) -> Vec<T> {
        self.lines
            .iter()
            .map(|line| {
                let vector = self.vector(line, nodes.as_flattened());
                let geometry = law::geometry(&vector, line.free_length);
                law::effective_tension(line.stiffness, geometry.stretch)
            })
            .collect()
    }

    /// From the first end of a line to the second; zero for an end that does not exist.
    fn vector(&self, line: &WebLine<T>, nodes: &[T]) -> Vector3<T> {
        let [from, to] = line.ends.map(|tie| match tie {
            Tie::Anchor(a) => self.anchors.get(a).map_or(&[][..], |a| &a[..]),
            Tie::Node(n) => nodes.get(3 * n..3 * n + 3).unwrap_or(&[]),
        });
        match (from, to) {
            (&[a, b, c], &[x, y, z]) => Vector3::new(x - a, y - b, z - c),
            _ => Vector3::zeros(),
        }
    }
}

/// A [`Web`] as a [`Balance`].
#[derive(Clone, Debug)]
pub struct WebBalance<'a, T> {
    web: &'a Web<T>,
    /// Per line between two nodes: its block of H.
    pairs: Vec<usize>,
}

impl<'a, T: Float> WebBalance<'a, T> {
    /// Prepares `web`, whose blocks are [`Web::blocks`].
    #[must_use]
    pub fn new(web: &'a Web<T>, blocks: &[(usize, usize)]) -> Self {
        let block = |line: &WebLine<T>| match line.ends {
            [Tie::Node(a), Tie::Node(b)] => blocks
                .iter()
                .position(|&block| block == (a.max(b), a.min(b)))
                .unwrap_or(0),
            _ => 0,
        };
        WebBalance {
            web,
            pairs: web.lines.iter().map(block).collect(),
        }
    }
}

impl<T: Float> Balance<T> for WebBalance<'_, T> {
    fn nodes(&self) -> usize {
        self.web.loads.len()
    }

    fn lines(&self) -> usize {
        self.web.lines.len()
    }

    fn load(&self) -> &[T] {
        self.web.loads.as_flattened()
    }

    fn evaluate(&mut self, p: &[T], k: &[T], l: &[T], out: &mut Evaluation<T>) {
        let nodes = self.web.loads.len();
        let values = out.values_mut();
        let (gradient, rest) = values.split_at_mut(3 * nodes);
        let (blocks, sums) = rest.split_at_mut(rest.len() - 3);
        for (g, &w) in gradient.iter_mut().zip(self.web.loads.as_flattened()) {
            *g = -w;
        }
        blocks.fill(T::zero());
        sums.fill(T::zero());
        for (((line, &pair), &k), &l) in self.web.lines.iter().zip(&self.pairs).zip(k).zip(l) {
            let vector = self.web.vector(line, p);
            let geometry = law::geometry(&vector, l);
            if geometry.stretch < T::zero() {
                continue;
            }
            let tension = law::effective_tension(k, geometry.stretch);
            let force = geometry.direction.map(|u| tension * u);
            let stiffness = law::stiffness(&geometry, &law::Tangent::linear(k, l), tension);
            let mut reach = geometry.length;
            for (tie, sign) in line.ends.iter().zip([-T::one(), T::one()]) {
                let &Tie::Node(n) = tie else { continue };
                for a in 0..3 {
                    gradient[3 * n + a] += sign * force[a];
                    reach += p[3 * n + a].abs();
                }
                add(blocks, n, &stiffness, T::one());
            }
            if let [Tie::Node(_), Tie::Node(_)] = line.ends {
                add(blocks, pair, &stiffness, -T::one());
            }
            sums[0] += tension;
            sums[1] += k * reach;
            if geometry.stretch > T::zero() {
                sums[2] += T::one();
            }
        }
    }

    fn smallest_slack(&self, p: &[T], l: &[T]) -> T {
        let mut smallest = None;
        for (line, &l) in self.web.lines.iter().zip(l) {
            let slack = -law::geometry(&self.web.vector(line, p), l).stretch;
            if slack > T::zero() && smallest.is_none_or(|least| slack < least) {
                smallest = Some(slack);
            }
        }
        smallest.unwrap_or_default()
    }
}

/// Adds the six distinct numbers of a symmetric block.
fn add<T: Float>(blocks: &mut [T], block: usize, value: &Matrix3<T>, sign: T) {
    let six = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
    for (target, index) in blocks[6 * block..].iter_mut().zip(six) {
        *target += sign * value[index];
    }
}
