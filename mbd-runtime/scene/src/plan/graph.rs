//! The graph of bodies and joints while they leave it, and what that costs.

use crate::{Carrying, Directions, JointSlots, Part, PointSlots};

/// The graph while nodes leave it.
#[derive(Clone)]
pub(super) struct EliminationGraph {
    pub(super) parts: Vec<Part>,
    pub(super) sizes: Vec<usize>,
    pub(super) neighbours: Vec<Vec<usize>>,
    /// Whether fill has reached its diagonal block.
    filled: Vec<bool>,
    /// What each joint sits on: `None` for the world; empty for a body.
    ends: Vec<Vec<Option<usize>>>,
    /// The joints on each body; empty for a joint.
    joints: Vec<Vec<usize>>,
    /// Whether states are known at which the loops close.
    closed: bool,
    gone: Vec<bool>,
    /// Room for what one node is coupled to.
    coupled_to: Vec<bool>,
}

impl EliminationGraph {
    pub(super) fn new(
        directions: Directions,
        bodies: usize,
        points: &[PointSlots],
        joints: &[JointSlots],
        closed: bool,
    ) -> Self {
        let mut graph = EliminationGraph {
            closed,
            ..EliminationGraph::empty()
        };
        let held = |part: Part| {
            let holds =
                |joint: &JointSlots| !joint.kept.is_empty() && joint.ends.contains(&Some(part));
            joints.iter().any(holds)
        };
        let moving = (0..bodies)
            .map(|body| (Part::Body(body), directions.speeds()))
            .chain(
                (0..points.len())
                    .map(|point| (Part::Point(point), directions.translations().len())),
            );
        for (part, size) in moving.filter(|&(part, _)| held(part)) {
            graph.push(part, size);
        }
        let kept = joints.iter().enumerate();
        for (index, joint) in kept.filter(|(_, joint)| !joint.kept.is_empty()) {
            let node = graph.push(Part::Joint(index), joint.kept.len());
            for end in joint.ends.iter() {
                let other = end.and_then(|end| graph.node(end));
                graph.ends[node].push(other);
                if let Some(other) = other {
                    graph.join(node, other);
                    graph.joints[other].push(node);
                }
            }
        }
        graph
    }

    /// Nothing yet.
    pub(super) fn empty() -> Self {
        EliminationGraph {
            parts: Vec::new(),
            sizes: Vec::new(),
            neighbours: Vec::new(),
            filled: Vec::new(),
            ends: Vec::new(),
            joints: Vec::new(),
            closed: true,
            gone: Vec::new(),
            coupled_to: Vec::new(),
        }
    }

    pub(super) fn push(&mut self, part: Part, size: usize) -> usize {
        self.parts.push(part);
        self.sizes.push(size);
        self.neighbours.push(Vec::new());
        self.filled.push(false);
        self.ends.push(Vec::new());
        self.joints.push(Vec::new());
        self.gone.push(false);
        self.coupled_to.push(false);
        self.parts.len() - 1
    }

    pub(super) fn node(&self, part: Part) -> Option<usize> {
        self.parts.iter().position(|&known| known == part)
    }

    pub(super) fn join(&mut self, a: usize, b: usize) {
        if a != b && !self.neighbours[a].contains(&b) {
            self.neighbours[a].push(b);
            self.neighbours[b].push(a);
        }
    }

    pub(super) fn is_joint(&self, node: usize) -> bool {
        matches!(self.parts[node], Part::Joint(_))
    }

    /// A body is always ready, a joint once (2) holds with it.
    fn ready(&self, node: usize) -> bool {
        !self.gone[node] && (!self.is_joint(node) || self.filled[node] && self.is_held(node))
    }

    /// Whether what has gone and is tied to a joint, by joints gone and itself, makes its rows independent of theirs.
    fn is_held(&self, joint: usize) -> bool {
        let mut beside: Option<usize> = None;
        let (mut point, mut world, mut parts) = (false, false, 0);
        let (mut seen, mut open) = (vec![false; self.parts.len()], vec![joint]);
        seen[joint] = true;
        let mut next = 0;
        while let Some(&tied) = open.get(next) {
            next += 1;
            for &end in &self.ends[tied] {
                match end {
                    None => world = true,
                    Some(other) if self.gone[other] => {
                        if std::mem::replace(&mut seen[other], true) {
                            continue;
                        }
                        parts += 1;
                        point |= matches!(self.parts[other], Part::Point(_));
                        for &joint in self.joints[other].iter().filter(|&&j| self.gone[j]) {
                            if !std::mem::replace(&mut seen[joint], true) {
                                open.push(joint);
                            }
                        }
                    }
                    Some(other) if *beside.get_or_insert(other) != other => return false,
                    Some(_) => {}
                }
            }
        }
        let tree = open.len() <= parts;
        beside.is_none() || !world && !point && (tree || self.closed)
    }

    fn coupled(&self, node: usize) -> usize {
        self.neighbours[node].iter().map(|&n| self.sizes[n]).sum()
    }

    /// Estimated operations of eliminating a node now. The columns of an untouched body are mostly zero: 2.5 of its 6 count.
    pub(super) fn cost(&self, node: usize) -> usize {
        let (n, m) = (self.sizes[node], self.coupled(node));
        if !self.is_joint(node) && !self.filled[node] {
            return 5 * n * m * (m + 1) / 12 + n * m / 2;
        }
        n * n * n / 3 + m * n * n + n * m * (m + 1)
    }

    /// Takes a node out; what it was coupled to is now coupled. Hands back its neighbours.
    pub(super) fn eliminate(&mut self, node: usize) -> Vec<usize> {
        self.gone[node] = true;
        let neighbours = std::mem::take(&mut self.neighbours[node]);
        for (i, &a) in neighbours.iter().enumerate() {
            self.filled[a] = true;
            self.neighbours[a].retain(|&other| other != node);
            // Long chains in relative coordinates couple all with all: a list is not searched for each.
            self.mark(a, true);
            for &b in neighbours.iter().take(i) {
                if !self.coupled_to[b] {
                    self.neighbours[a].push(b);
                    self.neighbours[b].push(a);
                }
            }
            self.mark(a, false);
        }
        neighbours
    }

    fn mark(&mut self, node: usize, coupled: bool) {
        for &other in &self.neighbours[node] {
            self.coupled_to[other] = coupled;
        }
    }

    /// Estimated operations of eliminating a body together with its parent joint. What is handed on to other axes or another point is
    /// multiplied by X, a third of whose products meets a zero or a one.
    fn pair_cost(&self, body: usize, joint: usize, carrying: &Carrying) -> usize {
        let loops = self.coupled(body) - self.sizes[joint];
        let speeds = self.sizes[body] + loops;
        let release = if carrying.own {
            // Each column is one speed, which is gone afterwards.
            (1..=carrying.free)
                .map(|k| (speeds - k) * (speeds - k + 1))
                .sum()
        } else {
            carrying.free * speeds * (speeds + 1)
        };
        if carrying.shared {
            return release + speeds * (speeds + 1) / 2;
        }
        let held = self.sizes[body] - carrying.free;
        let outside = loops + self.coupled(joint) - self.sizes[body];
        release + (2 * held * held * outside + held * outside * (outside + 1)) * 7 / 20
    }

    /// Eliminates each body that a joint carries together with that joint, the carried before what carries them, and the rest by cost.
    /// `pairs`: per node its parent joint, as a node, and how that carries it. None if there are no such bodies.
    pub(super) fn run_articulated(
        mut self,
        pairs: &[Option<(usize, Carrying)>],
    ) -> Option<(Vec<usize>, usize)> {
        let mut paired = vec![false; self.parts.len()];
        for &(joint, _) in pairs.iter().flatten() {
            paired[joint] = true;
        }
        let (mut order, mut cost) = (Vec::new(), 0);
        loop {
            // What still carries something waits.
            let mut carries = vec![false; self.parts.len()];
            let left = pairs
                .iter()
                .enumerate()
                .filter(|&(child, _)| !self.gone[child]);
            for (child, (joint, _)) in left.filter_map(|(child, pair)| Some((child, (*pair)?))) {
                for &node in self.neighbours[joint].iter().filter(|&&n| n != child) {
                    carries[node] = true;
                }
            }
            let price = |graph: &EliminationGraph, node: usize| match pairs[node] {
                Some((joint, carrying)) => graph.pair_cost(node, joint, &carrying),
                None => graph.cost(node),
            };
            let next = (0..self.parts.len())
                .filter(|&node| !self.gone[node] && !paired[node])
                .filter(|&node| match self.is_joint(node) {
                    true => self.ready(node),
                    false => !carries[node],
                })
                .min_by_key(|&node| price(&self, node));
            let Some(node) = next else { break };
            cost += price(&self, node);
            self.eliminate(node);
            order.push(node);
            if let Some((joint, _)) = pairs[node] {
                self.eliminate(joint);
                order.push(joint);
            }
        }
        let any = paired.contains(&true);
        (any && order.len() == self.parts.len()).then_some((order, cost))
    }

    /// Eliminates everything, always the ready node of the smallest key; the order and its cost.
    pub(super) fn run(
        mut self,
        key: impl Fn(&EliminationGraph, usize) -> (usize, usize),
    ) -> (Vec<usize>, usize) {
        let (mut order, mut cost) = (Vec::new(), 0);
        while let Some(node) = (0..self.parts.len())
            .filter(|&node| self.ready(node))
            .min_by_key(|&node| key(&self, node))
        {
            cost += self.cost(node);
            self.eliminate(node);
            order.push(node);
        }
        (order, cost)
    }
}
