//! The system of bodies and joints, and the order in which it is solved: fixed by the scene, chosen by counting.
//!
//! ```text
//! [M  Φ_vᵀ] [ v̇]   [f − h]
//! [Φ_v   0] [−λ] = [  γ  ]                                                        (1)
//! ```
//!
//! Its graph has a node of 6 speeds a body (3 a point with mass; in a plane 3 and 2) and a node of n rows a joint; an edge where a joint sits on a body. The
//! world has no node. The diagonal block of a joint is zero until its bodies have filled it with −Φ_v M⁻¹ Φ_vᵀ, so a joint must wait:
//!
//! ```text
//! rows of the joints gone × speeds of the bodies gone: full row rank               (2)
//! ```
//!
//! makes every pivot of a joint negative and every pivot of a body positive, without pivoting. That one of its bodies has gone is not
//! enough: a body between two hinges has 6 speeds, and both hinges 10 rows. A joint goes once what has gone and is tied to it, by joints
//! gone and itself, hangs
//! - on nothing that is still there: then these rows are whole, and independent where Φ_v has full rank;
//! - or on one body that is still there, like a tree: every joint has a body of its own behind it, on which its rows are independent (on a
//!   point they need not be);
//! - or on one body in any way: on the joints, moving that body is moving all the others, so its columns are not missed. This needs joints
//!   that can hold together; where no state was found at which the loops close, only the first two count.
//!
//! The orders differ a lot in cost: a hub with 11 arms costs ten times more bodies first than leaf first, a chain half as much again leaf
//! first as bodies first. So candidates are counted and the cheapest is taken.
//!
//! The last candidate takes a body out **together with the joint that carries it**, leaf to root, where the joint determines part of the
//! body's speeds exactly ([`Partition`]): substitution in place of pivots, the articulated-body recursion on a tree. The rows of the
//! other joints wait as above.

use crate::layout::{JointSlots, PointSlots};
use crate::partition::Partition;
use crate::plane::Directions;

/// What a node of the system is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The speeds of a body: six, in a plane three.
    Body(usize),
    /// The speeds of a point with mass: three, in a plane two.
    Point(usize),
    /// The rows of a joint.
    Joint(usize),
}

/// A node of the system at its place in the order.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// What it is.
    pub part: Part,
    /// First unknown.
    pub first: usize,
    /// Number of unknowns.
    pub size: usize,
    /// Where its diagonal block starts in the store (size × size, row by row, lower triangle used).
    pub diagonal: usize,
    /// Later nodes it is coupled to, in order.
    pub below: Vec<Below>,
    /// A body that leaves together with the joint that carries it, the next step: how that joint parts its speeds.
    pub partition: Option<Partition>,
    /// A joint that leaves together with the body it carries, the step before.
    pub rides: bool,
}

/// A coupling to a later node.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Below {
    /// The later node: index into [`Elimination::steps`].
    pub step: usize,
    /// Where the block starts in the store (size of the later node × size of this one, row by row).
    pub at: usize,
    /// Where the products with the couplings up to and including this one go, one a coupling.
    pub targets: Vec<usize>,
}

/// The order of elimination of a scene, and where its blocks live.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Elimination {
    /// The nodes, first eliminated first.
    pub steps: Vec<Step>,
    /// Number of unknowns.
    pub unknowns: usize,
    /// Length of the store of blocks.
    pub store: usize,
    /// The step of each body; `None` where no joint holds it.
    pub bodies: Vec<Option<usize>>,
    /// The step of each point.
    pub points: Vec<Option<usize>>,
    /// The step of each joint; `None` where it has no rows.
    pub joints: Vec<Option<usize>>,
    /// The joint that carries each body out of the system; `None` where none does.
    pub carriers: Vec<Option<usize>>,
    /// Estimated operations of the candidates: bodies first, least degree, least cost, articulated bodies.
    pub candidates: [usize; 4],
}

/// The graph while nodes leave it.
#[derive(Clone)]
struct Graph {
    parts: Vec<Part>,
    sizes: Vec<usize>,
    neighbours: Vec<Vec<usize>>,
    /// Whether fill has reached its diagonal block.
    filled: Vec<bool>,
    /// What each joint sits on: `None` for the world; empty for a body.
    ends: Vec<Vec<Option<usize>>>,
    /// The joints on each body; empty for a joint.
    joints: Vec<Vec<usize>>,
    /// Whether states are known at which the loops close.
    closed: bool,
    gone: Vec<bool>,
}

impl Graph {
    fn new(
        directions: Directions,
        bodies: usize,
        points: &[PointSlots],
        joints: &[JointSlots],
        closed: bool,
    ) -> Self {
        let mut graph = Graph {
            parts: Vec::new(),
            sizes: Vec::new(),
            neighbours: Vec::new(),
            filled: Vec::new(),
            ends: Vec::new(),
            joints: Vec::new(),
            closed,
            gone: Vec::new(),
        };
        let held = |part: Part| {
            let holds =
                |joint: &JointSlots| !joint.kept.is_empty() && joint.ends.contains(&Some(part));
            joints.iter().any(holds)
        };
        let moving = (0..bodies)
            .map(|body| (Part::Body(body), directions.speeds()))
            .chain((0..points.len()).map(|point| (Part::Point(point), directions.moves().len())));
        for (part, size) in moving.filter(|&(part, _)| held(part)) {
            graph.push(part, size);
        }
        let kept = joints.iter().enumerate();
        for (index, joint) in kept.filter(|(_, joint)| !joint.kept.is_empty()) {
            let node = graph.push(Part::Joint(index), joint.kept.len());
            for end in joint.ends {
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

    fn push(&mut self, part: Part, size: usize) -> usize {
        self.parts.push(part);
        self.sizes.push(size);
        self.neighbours.push(Vec::new());
        self.filled.push(false);
        self.ends.push(Vec::new());
        self.joints.push(Vec::new());
        self.gone.push(false);
        self.parts.len() - 1
    }

    fn node(&self, part: Part) -> Option<usize> {
        self.parts.iter().position(|&known| known == part)
    }

    fn join(&mut self, a: usize, b: usize) {
        if a != b && !self.neighbours[a].contains(&b) {
            self.neighbours[a].push(b);
            self.neighbours[b].push(a);
        }
    }

    fn is_joint(&self, node: usize) -> bool {
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
    fn cost(&self, node: usize) -> usize {
        let (n, m) = (self.sizes[node], self.coupled(node));
        if !self.is_joint(node) && !self.filled[node] {
            return 5 * n * m * (m + 1) / 12 + n * m / 2;
        }
        n * n * n / 3 + m * n * n + n * m * (m + 1)
    }

    /// Takes a node out; what it was coupled to is now coupled. Hands back its neighbours.
    fn eliminate(&mut self, node: usize) -> Vec<usize> {
        self.gone[node] = true;
        let neighbours = std::mem::take(&mut self.neighbours[node]);
        for (i, &a) in neighbours.iter().enumerate() {
            self.filled[a] = true;
            self.neighbours[a].retain(|&other| other != node);
            for &b in neighbours.iter().take(i) {
                self.join(a, b);
            }
        }
        neighbours
    }

    /// Estimated operations of eliminating a body together with the joint that carries it. A third of the products meets a zero or a one;
    /// a body that is locked to its parent but for `ways` is added to it.
    fn pair_cost(&self, body: usize, joint: usize, ways: Option<usize>) -> usize {
        let rows = self.sizes[joint];
        let loops = self.coupled(body) - rows;
        if let Some(ways) = ways {
            let speeds = self.sizes[body] + loops;
            return (2 * ways + 1) * speeds * (speeds + 1) / 2;
        }
        let outside = loops + self.coupled(joint) - self.sizes[body];
        let free = (self.sizes[body] - rows) * (rows + loops) * (rows + loops + 1);
        free + (2 * rows * rows * outside + rows * outside * (outside + 1)) * 7 / 20
    }

    /// Eliminates each body that a joint carries together with that joint, the carried before their carriers, and the rest by cost.
    /// `carriers`: per node the joint node that carries it; `ways`: what is free where the joint locks it. None if there are no such bodies.
    fn run_articulated(
        mut self,
        carriers: &[Option<usize>],
        ways: &[Option<usize>],
    ) -> Option<(Vec<usize>, usize)> {
        let riding: Vec<usize> = carriers.iter().copied().flatten().collect();
        let (mut order, mut cost) = (Vec::new(), 0);
        loop {
            let carries = |graph: &Graph, node: usize| {
                let outboard = carriers
                    .iter()
                    .enumerate()
                    .filter_map(|(n, &j)| Some((n, j?)));
                outboard.into_iter().any(|(n, joint)| {
                    n != node && !graph.gone[n] && graph.neighbours[joint].contains(&node)
                })
            };
            let price = |graph: &Graph, node: usize| match carriers[node] {
                Some(joint) => graph.pair_cost(node, joint, ways[node]),
                None => graph.cost(node),
            };
            let next = (0..self.parts.len())
                .filter(|&node| !self.gone[node] && !riding.contains(&node))
                .filter(|&node| match self.is_joint(node) {
                    true => self.ready(node),
                    false => !carries(&self, node),
                })
                .min_by_key(|&node| price(&self, node));
            let Some(node) = next else { break };
            cost += price(&self, node);
            self.eliminate(node);
            order.push(node);
            if let Some(joint) = carriers[node] {
                self.eliminate(joint);
                order.push(joint);
            }
        }
        (!riding.is_empty() && order.len() == self.parts.len()).then_some((order, cost))
    }

    /// Eliminates everything, always the ready node of the smallest key; the order and its cost.
    fn run(mut self, key: impl Fn(&Graph, usize) -> (usize, usize)) -> (Vec<usize>, usize) {
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

/// The joint that carries each body: the first that parts its speeds, unless the body carries itself through it.
fn carriers(
    bodies: usize,
    joints: &[JointSlots],
    partitions: &[Option<Partition>],
) -> Vec<Option<usize>> {
    let mut carriers: Vec<Option<usize>> = vec![None; bodies];
    for (index, (joint, partition)) in joints.iter().zip(partitions).enumerate() {
        let [parent, Some(Part::Body(child))] = joint.ends else {
            continue;
        };
        let parts =
            joint.all_kept() && partition.is_some_and(|partition| joint.len == partition.rows());
        let mut inboard = parent;
        while let Some(Part::Body(body)) = inboard
            && body != child
        {
            inboard = carriers[body].and_then(|joint| joints[joint].ends[0]);
        }
        if parts && carriers[child].is_none() && inboard != Some(Part::Body(child)) {
            carriers[child] = Some(index);
        }
    }
    carriers
}

impl Elimination {
    /// Chooses the cheapest of the candidate orders and lays out its blocks. `partitions`: how each joint parts the speeds of its child;
    /// `closed`: whether states are known at which the loops of the joints close.
    #[must_use]
    pub fn new(
        directions: Directions,
        bodies: usize,
        points: &[PointSlots],
        joints: &[JointSlots],
        partitions: &[Option<Partition>],
        closed: bool,
    ) -> Self {
        let graph = Graph::new(directions, bodies, points, joints, closed);
        let bodies_first = |g: &Graph, n: usize| (usize::from(g.is_joint(n)), g.cost(n));
        let least_degree =
            |g: &Graph, n: usize| (g.neighbours[n].len(), usize::from(g.is_joint(n)));
        let least_cost = |g: &Graph, n: usize| (g.cost(n), 0);
        let carriers = carriers(bodies, joints, partitions);
        let carrying: Vec<Option<usize>> = graph
            .parts
            .iter()
            .map(|part| match *part {
                Part::Body(body) => carriers[body].and_then(|joint| graph.node(Part::Joint(joint))),
                _ => None,
            })
            .collect();
        let ways: Vec<Option<usize>> = graph
            .parts
            .iter()
            .map(|part| match *part {
                Part::Body(body) => Some(partitions[carriers[body]?]?.locked?.free),
                _ => None,
            })
            .collect();
        let plain = [
            graph.clone().run(bodies_first),
            graph.clone().run(least_degree),
            graph.clone().run(least_cost),
        ];
        let articulated = graph.clone().run_articulated(&carrying, &ways);
        let [a, b, c] = plain.each_ref().map(|(_, cost)| *cost);
        let last = articulated.as_ref().map_or(usize::MAX, |(_, cost)| *cost);
        let mut elimination = Elimination {
            candidates: [a, b, c, last],
            bodies: vec![None; bodies],
            points: vec![None; points.len()],
            joints: vec![None; joints.len()],
            carriers: vec![None; bodies],
            ..Elimination::default()
        };
        let cheapest = plain.into_iter().min_by_key(|(_, cost)| *cost);
        match (articulated, cheapest) {
            (Some((order, cost)), Some((_, other))) if cost <= other => {
                elimination.carriers = carriers;
                elimination.lay_out(graph, &order, partitions);
            }
            (_, Some((order, _))) => elimination.lay_out(graph, &order, partitions),
            _ => {}
        }
        elimination
    }

    fn lay_out(&mut self, mut graph: Graph, order: &[usize], partitions: &[Option<Partition>]) {
        let mut place = vec![0; graph.parts.len()];
        for (step, &node) in order.iter().enumerate() {
            place[node] = step;
        }
        for (step, &node) in order.iter().enumerate() {
            let (part, size) = (graph.parts[node], graph.sizes[node]);
            match part {
                Part::Body(body) => self.bodies[body] = Some(step),
                Part::Point(point) => self.points[point] = Some(step),
                Part::Joint(joint) => self.joints[joint] = Some(step),
            }
            let mut later: Vec<usize> = graph.eliminate(node).iter().map(|&n| place[n]).collect();
            later.sort_unstable();
            let carrier = match part {
                Part::Body(body) => self.carriers[body],
                _ => None,
            };
            let partition = carrier.and_then(|joint| partitions.get(joint).copied().flatten());
            // What a joint holds of the body that rides out with it, the step before.
            let carried = self.steps.last().filter(|step| step.partition.is_some());
            let [width, room, unknowns] = match carried.map(|step| (step.size, step.partition)) {
                Some((speeds, Some(partition))) => partition.room(speeds),
                _ => [size, size * size, size],
            };
            let diagonal = self.room(room);
            let below = later.iter().map(|&step| Below {
                step,
                at: self.room(width * graph.sizes[order[step]]),
                targets: Vec::new(),
            });
            let below = below.collect();
            self.steps.push(Step {
                part,
                first: self.unknowns,
                size,
                diagonal,
                below,
                partition,
                rides: matches!(part, Part::Joint(joint) if self.carriers.contains(&Some(joint))),
            });
            self.unknowns += unknowns;
        }
        for step in 0..self.steps.len() {
            for coupling in 0..self.steps[step].below.len() {
                let row = self.steps[step].below[coupling].step;
                let targets = self.steps[step].below[..=coupling]
                    .iter()
                    .filter_map(|column| self.block(row, column.step))
                    .collect();
                self.steps[step].below[coupling].targets = targets;
            }
        }
    }

    fn room(&mut self, len: usize) -> usize {
        self.store += len;
        self.store - len
    }

    /// The step of a part; `None` if the system has no such part.
    #[must_use]
    pub fn step_of(&self, part: Part) -> Option<usize> {
        match part {
            Part::Body(body) => self.bodies.get(body).copied().flatten(),
            Part::Point(point) => self.points.get(point).copied().flatten(),
            Part::Joint(joint) => self.joints.get(joint).copied().flatten(),
        }
    }

    /// Where the block of two nodes starts, rows of the later one.
    #[must_use]
    pub fn block(&self, row: usize, column: usize) -> Option<usize> {
        let step = self.steps.get(column)?;
        if row == column {
            return Some(step.diagonal);
        }
        let below = step.below.iter().find(|below| below.step == row)?;
        Some(below.at)
    }
}
