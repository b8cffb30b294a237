//! The networks of a scene as balances: every evaluation is one call of the model, so generic, interpreted and generated code share the solver.

use mbd_scene::laws::{LineNumbers, line as law};
use mbd_scene::{
    At, Clamp, Difference, Float, Layout, LineEnd, Model, NodeModel, Quantity, Real, Work,
};
use nalgebra::Vector3;

use super::balance::{Balance, BalanceEvaluation, triple};
use super::error::Uneven;
use super::rate::RateNode;
use super::solver::Solver;
use super::stage::Stage;
use crate::unilateral::Mode;

/// The free length of a line that is detached [m]: no place is so far away, and its square is a number in single precision, too.
pub(crate) const ENDLESS: f64 = 1e15;

/// Whether a line is detached.
pub(crate) fn is_detached(modes: &[Mode], line: &PlanLine) -> bool {
    modes.get(line.line) == Some(&Mode::Detached)
}

/// One line of a network: where it ends and where its effective numbers live.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlanLine {
    pub line: usize,
    pub effective: Option<usize>,
    pub ends: [LineEnd; 2],
}

impl PlanLine {
    /// K, C and L0.
    pub fn numbers<'m, T: Float>(&self, model: &'m dyn Model<T>) -> Option<&'m LineNumbers<T>> {
        model.lines().get(self.line)
    }

    /// Whether it has damping.
    pub fn is_damped<T: Float>(&self, model: &dyn Model<T>) -> bool {
        self.numbers(model)
            .is_some_and(|numbers| numbers.damping > T::zero())
    }

    /// From its `from` end to its `to` end, with anchors as in `Quantity::AnchorStates` and nodes 3 a node [m].
    pub fn vector<S: Real>(&self, anchors: &[S], nodes: &[S]) -> Vector3<S> {
        let [from, to] = self.ends.map(|end| match end {
            LineEnd::Anchor(anchor) => triple(anchors, 6 * anchor),
            LineEnd::Node(node) => triple(nodes, 3 * node),
            LineEnd::Plain => Vector3::zeros(),
        });
        to - from
    }
}

/// One network with everything its solve needs; made once from the layout.
#[derive(Clone, Debug)]
pub(crate) struct NetworkPlan<T: Float> {
    pub index: usize,
    pub model: NodeModel,
    /// Indices into `Layout::nodes`.
    pub nodes: Vec<usize>,
    pub lines: Vec<PlanLine>,
    /// Per node the anchors that carry it along: its own, or all of the network if it has none.
    pub own_anchors: Vec<Vec<usize>>,
    /// Where the position of a `rate` node is in the state.
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
    /// Ẇ of the first node [N/s], where it is told.
    pub load_rate: Vector3<T>,
}

impl<T: Float> NetworkPlan<T> {
    /// The plans of all networks.
    pub fn of(layout: &Layout) -> Vec<Self> {
        (0..layout.networks.len())
            .filter_map(|index| NetworkPlan::new(layout, index))
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
        let leg = |line: &PlanLine| match line.ends {
            [LineEnd::Anchor(a), LineEnd::Node(_)] | [LineEnd::Node(_), LineEnd::Anchor(a)] => {
                Some((a, *line))
            }
            _ => None,
        };
        let legs: Vec<(usize, PlanLine)> = lines.iter().filter_map(leg).collect();
        let zeros = |n: usize| vec![T::zero(); n];
        let first = layout.nodes.get(*network.nodes.first()?)?;
        let own = |&node: &usize| own_anchors(layout, &network.anchors, node);
        Some(NetworkPlan {
            index,
            model: network.model,
            nodes: network.nodes.clone(),
            own_anchors: network.nodes.iter().map(own).collect(),
            z: first.z.map(|z| layout.nq + layout.nv + z),
            solver: Solver::new(network.nodes.len(), lines.len(), &network.blocks),
            rate: RateNode::new(legs.len()),
            legs,
            k: zeros(lines.len()),
            l: zeros(lines.len()),
            p: zeros(3 * network.nodes.len()),
            load: zeros(3 * network.nodes.len()),
            load_rate: Vector3::zeros(),
            lines,
        })
    }

    /// Whether its node is part of the state.
    pub fn is_rate(&self) -> bool {
        self.model == NodeModel::Rate
    }

    /// Formula and clamp of the damping of a stepwise network.
    pub fn stepwise(&self) -> Option<(Difference, Clamp)> {
        match self.model {
            NodeModel::Stepwise { formula, clamp } => Some((formula, clamp)),
            NodeModel::Static | NodeModel::Rate => None,
        }
    }

    /// Whether the rate problem of the first node is the whole network.
    pub fn is_single(&self) -> bool {
        self.nodes.len() == 1 && self.legs.len() == self.lines.len()
    }

    /// Sets K_e and L_e of every line; those that are detached are longer than anything.
    pub fn set_law(
        &mut self,
        model: &dyn Model<T>,
        modes: &[Mode],
        find: impl Fn(&PlanLine, &LineNumbers<T>) -> [T; 2],
    ) {
        let numbers = model.lines();
        for ((line, k), l) in self.lines.iter().zip(&mut self.k).zip(&mut self.l) {
            if let Some(numbers) = numbers.get(line.line) {
                [*k, *l] = match is_detached(modes, line) {
                    true => [numbers.stiffness, T::from_f64(ENDLESS)],
                    false => find(line, numbers),
                };
            }
        }
    }

    /// Stretch of one of its lines of a free length, with its node at p where that is part of the state [m].
    pub fn stretch(&self, line: &PlanLine, free_length: T, anchors: &[T], nodes: &[T]) -> T {
        let vector = match (self.z, line.ends) {
            (Some(_), [LineEnd::Anchor(a), _] | [_, LineEnd::Anchor(a)]) => {
                triple(anchors, 6 * a) - triple(&self.p, 0)
            }
            _ => line.vector(anchors, nodes),
        };
        law::geometry(&vector, free_length).stretch
    }

    /// Gives the rate problem anchors, velocities and constants, and places it at `p`.
    pub fn set_legs(&mut self, model: &dyn Model<T>, modes: &[Mode], ends: &[T]) {
        for (index, (anchor, line)) in self.legs.iter().enumerate() {
            if let Some(&numbers) = line.numbers(model) {
                let numbers = match is_detached(modes, line) {
                    true => LineNumbers {
                        free_length: T::from_f64(ENDLESS),
                        ..numbers
                    },
                    false => numbers,
                };
                let [place, velocity] = [0, 3].map(|k| triple(ends, 6 * anchor + k));
                self.rate.set_leg(index, place, velocity, numbers);
            }
        }
        let load = [triple(&self.load, 0), self.load_rate];
        self.rate.place(triple(&self.p, 0), load);
    }

    /// Copies the loads of its nodes, and their rates, out of `Quantity::AnchorStates`.
    pub fn read_loads(&mut self, ends: &[T], layout: &Layout) {
        let first = 6 * layout.anchors.len();
        for (&node, load) in self.nodes.iter().zip(self.load.chunks_exact_mut(3)) {
            load.copy_from_slice(triple(ends, first + 3 * node).as_slice());
        }
        let node = self.nodes.first().and_then(|&node| layout.nodes.get(node));
        if let Some(at) = node.and_then(|node| node.load_rate) {
            self.load_rate = triple(ends, at);
        }
    }
}

/// The same two lines by their indices in the scene.
pub(crate) fn of_scene(uneven: Uneven, lines: &[PlanLine]) -> Option<Uneven> {
    let index = |line: usize| lines.get(line).map(|line| line.line);
    Some(Uneven {
        softest: index(uneven.softest)?,
        stiffest: index(uneven.stiffest)?,
        ratio: uneven.ratio,
    })
}

/// Of the anchors of a network those that carry a node along: its own, or all if it has none.
pub(crate) fn own_anchors(layout: &Layout, anchors: &[usize], node: usize) -> Vec<usize> {
    let owns = |&anchor: &usize| layout.anchors.get(anchor).is_some_and(|a| a.node == node);
    let own: Vec<usize> = anchors.iter().copied().filter(owns).collect();
    match own.is_empty() {
        true => anchors.to_vec(),
        false => own,
    }
}

/// One network of a scene at one instant, as a [`Balance`].
pub(crate) struct SceneBalance<'a, T: Float> {
    pub stage: Stage<'a, T>,
    pub work: &'a mut Work<T>,
    pub network: usize,
    pub members: &'a [usize],
    pub lines: &'a [PlanLine],
    pub load: &'a [T],
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

    fn load(&self) -> &[T] {
        self.load
    }

    fn evaluate(&mut self, p: &[T], k: &[T], l: &[T], out: &mut BalanceEvaluation<T>) {
        self.scatter(p, k, l);
        let at = At {
            time: self.stage.time,
            state: self.stage.state,
            nodes: self.nodes,
            effective: self.effective,
            hold: self.hold,
            ends: self.ends,
            inputs: self.stage.inputs,
            rows: &[],
        };
        let what = Quantity::Equilibrium(self.network);
        self.stage
            .model
            .evaluate(what, &at, self.work, out.values_mut());
    }

    fn places(&self, line: usize, p: &[T]) -> [Vector3<T>; 2] {
        let ends = self.lines.get(line).map(|line| line.ends);
        ends.unwrap_or([LineEnd::Plain; 2]).map(|end| match end {
            LineEnd::Anchor(anchor) => triple(self.ends, 6 * anchor),
            LineEnd::Node(node) => {
                let local = self.members.iter().position(|&member| member == node);
                local.map_or_else(Vector3::zeros, |local| triple(p, 3 * local))
            }
            LineEnd::Plain => Vector3::zeros(),
        })
    }
}
