//! Equilibrium problems of their own: anchors and lines as plain lists, without a scene.
//!
//! The line law is the one of the scenes, so these problems test the solver and the law together.

use mbd_runtime::node::{
    Balance, BalanceEvaluation, NodeError, Outcome, Solver, Tie as Place, Tied, Tolerance,
};
use mbd_scene::Float;
use mbd_scene::laws::Pulled;
use nalgebra::Vector3;

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

/// A scalar on which webs are solved: for each the solver is compiled here, once and optimised, and not again in every test that asks for it.
pub trait Solvable: Float {
    /// [`Web::solve`] on this scalar.
    ///
    /// # Errors
    /// As there.
    fn solve(
        web: &Web<Self>,
        start: &[[Self; 3]],
        tolerance: Tolerance<Self>,
    ) -> Result<Equilibrium<Self>, NodeError>;
}

macro_rules! solvable {
    ($($scalar:ty)*) => {$(
        impl Solvable for $scalar {
            fn solve(
                web: &Web<Self>,
                start: &[[Self; 3]],
                tolerance: Tolerance<Self>,
            ) -> Result<Equilibrium<Self>, NodeError> {
                web.solve_here(start, tolerance)
            }
        }
    )*};
}

solvable!(f64 f32);

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

impl<T: Solvable> Confluence<T> {
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

impl<T: Solvable> Web<T> {
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
        T::solve(self, start, tolerance)
    }

    fn solve_here(
        &self,
        start: &[[T; 3]],
        tolerance: Tolerance<T>,
    ) -> Result<Equilibrium<T>, NodeError> {
        self.check()?;
        NodeError::same_length("start", start.len(), self.loads.len())?;
        NodeError::check_finite("start", start.as_flattened())?;
        let mut balance = WebBalance::new(self);
        let mut solver = Solver::new(self.loads.len(), self.lines.len(), &balance.blocks);
        let mut nodes = start.to_vec();
        let (k, l) = self.constants();
        let outcome = solver.solve(&mut balance, &k, &l, nodes.as_flattened_mut(), tolerance);
        outcome.check(Some(0), || solver.uneven(&balance, &k, &l))?;
        let tensions = match outcome {
            Outcome::Slack { .. } => vec![T::zero(); self.lines.len()],
            Outcome::Taut { .. } | Outcome::NotConverged { .. } => self.tensions(&nodes),
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
        let place = |tie: Tie| match tie {
            Tie::Anchor(a) => (None, self.anchors[a].into()),
            Tie::Node(n) => (Some(n), nodes[n].into()),
        };
        let tension = |line: &WebLine<T>| {
            Pulled::new(line.ends.map(place), [line.stiffness, line.free_length]).tension
        };
        self.lines.iter().map(tension).collect()
    }
}

/// A [`Web`] as a [`Balance`].
#[derive(Clone, Debug)]
pub struct WebBalance<T> {
    load: Vec<T>,
    blocks: Vec<(usize, usize)>,
    lines: Vec<[Place<T>; 2]>,
}

impl<T: Solvable> WebBalance<T> {
    /// Of a web.
    #[must_use]
    pub fn new(web: &Web<T>) -> Self {
        let place = |tie: Tie| match tie {
            Tie::Anchor(a) => Place::Anchor(web.anchors[a]),
            Tie::Node(n) => Place::Node(n),
        };
        WebBalance {
            load: web.loads.as_flattened().to_vec(),
            blocks: web.blocks(),
            lines: web.lines.iter().map(|line| line.ends.map(place)).collect(),
        }
    }

    fn tied(&self) -> Tied<'_, T> {
        Tied {
            load: &self.load,
            blocks: &self.blocks,
            lines: &self.lines,
        }
    }
}

impl<T: Solvable> Balance<T> for WebBalance<T> {
    fn nodes(&self) -> usize {
        self.tied().nodes()
    }

    fn load(&self) -> &[T] {
        &self.load
    }

    fn evaluate(&mut self, p: &[T], k: &[T], l: &[T], out: &mut BalanceEvaluation<T>) {
        self.tied().evaluate(p, k, l, out);
    }

    fn places(&self, line: usize, p: &[T]) -> [Vector3<T>; 2] {
        self.tied().places(line, p)
    }
}
