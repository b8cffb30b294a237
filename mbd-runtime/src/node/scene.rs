//! The networks of a scene as balances: every evaluation is one call of the model, so generic, interpreted and generated code share the solver.

use mbd_scene::laws::line;
use mbd_scene::{At, Float, Layout, LineEnd, Model, NodeModel, Quantity, Work};
use nalgebra::Vector3;

use super::balance::{Balance, Evaluation};
use super::rate::RateNode;
use super::solver::Solver;

/// One line of a network: where it ends and where its effective numbers live.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlanLine {
    pub line: usize,
    pub effective: Option<usize>,
    pub ends: [LineEnd; 2],
}

/// One network with everything its solve needs; made once from the layout.
#[derive(Clone, Debug)]
pub(crate) struct Plan<T: Float> {
    pub index: usize,
    pub model: NodeModel,
    /// Indices into `Layout::nodes`.
    pub nodes: Vec<usize>,
    pub lines: Vec<PlanLine>,
    /// Per node the anchors that carry it along: its own, or all of the network if it has none.
    pub own_anchors: Vec<Vec<usize>>,
    /// Offsets of the node positions in z (`rate`).
    pub z: Option<usize>,
    pub solver: Solver<T>,
    /// The first node's rate problem: the law of a rate node, and the start of a stepwise one.
    pub rate: RateNode<T>,
    /// Per line of `rate`: its anchor.
    pub legs: Vec<(usize, PlanLine)>,
    /// Stiffness and free length of the present solve.
    pub k: Vec<T>,
    pub l: Vec<T>,
    pub p: Vec<T>,
    pub load: Vec<T>,
}

impl<T: Float> Plan<T> {
    /// The plans of all networks.
    pub fn of(layout: &Layout) -> Vec<Self> {
        (0..layout.networks.len())
            .filter_map(|index| Plan::new(layout, index))
            .collect()
    }

    fn new(layout: &Layout, index: usize) -> Option<Self> {
        let network = layout.networks.get(index)?;
        let line = |&line: &usize| {
            let slots = layout.lines.get(line)?;
            Some(PlanLine {
                line,
                effective: slots.effective,
                ends: slots.ends,
            })
        };
        let lines: Vec<PlanLine> = network.lines.iter().filter_map(line).collect();
        let own = |&node: &usize| {
            let own: Vec<usize> = network
                .anchors
                .iter()
                .copied()
                .filter(|&a| layout.anchors.get(a).is_some_and(|a| a.node == node))
                .collect();
            if own.is_empty() {
                network.anchors.clone()
            } else {
                own
            }
        };
        let leg = |line: &PlanLine| match line.ends {
            [LineEnd::Anchor(a), LineEnd::Node(_)] | [LineEnd::Node(_), LineEnd::Anchor(a)] => {
                Some((a, *line))
            }
            _ => None,
        };
        let legs: Vec<(usize, PlanLine)> = lines.iter().filter_map(leg).collect();
        let zeros = |n: usize| vec![T::zero(); n];
        Some(Plan {
            index,
            model: network.model,
            nodes: network.nodes.clone(),
            own_anchors: network.nodes.iter().map(own).collect(),
            z: network
                .nodes
                .first()
                .and_then(|&node| layout.nodes.get(node)?.z)
                .map(|z| layout.nq + layout.nv + z),
            solver: Solver::new(network.nodes.len(), lines.len(), &network.blocks),
            rate: RateNode::new(legs.len()),
            legs,
            k: zeros(lines.len()),
            l: zeros(lines.len()),
            p: zeros(3 * network.nodes.len()),
            load: zeros(3 * network.nodes.len()),
            lines,
        })
    }

    /// Whether the rate problem of the first node is the whole network.
    pub fn is_single(&self) -> bool {
        self.nodes.len() == 1 && self.legs.len() == self.lines.len()
    }

    /// Copies the loads of its nodes out of `Quantity::AnchorStates`.
    pub fn read_loads(&mut self, ends: &[T], anchors: usize) {
        for (&node, load) in self.nodes.iter().zip(self.load.chunks_exact_mut(3)) {
            let at = 6 * anchors + 3 * node;
            if let Some(values) = ends.get(at..at + 3) {
                load.copy_from_slice(values);
            }
        }
    }
}

/// Three numbers of a list as a vector; zero beyond its end.
pub(crate) fn triple<T: Float>(list: &[T], at: usize) -> Vector3<T> {
    match list.get(at..at + 3) {
        Some(&[x, y, z]) => Vector3::new(x, y, z),
        _ => Vector3::zeros(),
    }
}

/// From the `from` end of a line to its `to` end, with anchors as in `Quantity::AnchorStates` and nodes 3 a node [m].
pub(crate) fn vector<T: Float>(ends: &[LineEnd; 2], anchors: &[T], nodes: &[T]) -> Vector3<T> {
    let [from, to] = ends.map(|end| match end {
        LineEnd::Anchor(anchor) => triple(anchors, 6 * anchor),
        LineEnd::Node(node) => triple(nodes, 3 * node),
        LineEnd::Plain => Vector3::zeros(),
    });
    to - from
}

/// One network of a scene at one instant, as a [`Balance`].
pub(crate) struct SceneBalance<'a, T: Float> {
    pub model: &'a dyn Model<T>,
    pub work: &'a mut Work<T>,
    pub network: usize,
    pub members: &'a [usize],
    pub lines: &'a [PlanLine],
    pub load: &'a [T],
    pub time: T,
    pub state: &'a [T],
    pub inputs: &'a [T],
    pub ends: &'a [T],
    pub hold: &'a [T],
    /// All node unknowns; those of the network follow the trial point.
    pub nodes: &'a mut [T],
    /// All effective numbers; those of the network follow the trial stiffness.
    pub effective: &'a mut [T],
}

impl<T: Float> SceneBalance<'_, T> {
    /// Writes node positions and line constants where the model reads them.
    pub fn scatter(&mut self, p: &[T], k: &[T], l: &[T]) {
        for (&node, p) in self.members.iter().zip(p.chunks_exact(3)) {
            if let Some(target) = self.nodes.get_mut(3 * node..3 * node + 3) {
                target.copy_from_slice(p);
            }
        }
        for ((line, &k), &l) in self.lines.iter().zip(k).zip(l) {
            if let Some(at) = line.effective
                && let Some(target) = self.effective.get_mut(2 * at..2 * at + 2)
            {
                target.copy_from_slice(&[k, l]);
            }
        }
    }
}

impl<T: Float> Balance<T> for SceneBalance<'_, T> {
    fn nodes(&self) -> usize {
        self.members.len()
    }

    fn lines(&self) -> usize {
        self.lines.len()
    }

    fn load(&self) -> &[T] {
        self.load
    }

    fn evaluate(&mut self, p: &[T], k: &[T], l: &[T], out: &mut Evaluation<T>) {
        self.scatter(p, k, l);
        let at = At {
            time: self.time,
            state: self.state,
            nodes: self.nodes,
            effective: self.effective,
            hold: self.hold,
            ends: self.ends,
            inputs: self.inputs,
            rows: &[],
        };
        self.model.evaluate(
            Quantity::Equilibrium(self.network),
            &at,
            self.work,
            out.values_mut(),
        );
    }

    fn smallest_slack(&self, p: &[T], l: &[T]) -> T {
        let mut smallest = None;
        for (line, &l) in self.lines.iter().zip(l) {
            let [from, to] = line.ends.map(|end| match end {
                LineEnd::Anchor(anchor) => triple(self.ends, 6 * anchor),
                LineEnd::Node(node) => self
                    .members
                    .iter()
                    .position(|&member| member == node)
                    .map_or_else(Vector3::zeros, |local| triple(p, 3 * local)),
                LineEnd::Plain => Vector3::zeros(),
            });
            let slack = -line::geometry(&(to - from), l).stretch;
            if slack > T::zero() && smallest.is_none_or(|least| slack < least) {
                smallest = Some(slack);
            }
        }
        smallest.unwrap_or_default()
    }
}
