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
//! The orders differ a lot in cost, so candidates are counted and the cheapest is taken.
//!
//! The last candidate takes a body out **together with its parent joint**, leaf to root, where the joint states the columns H that it leaves
//! free ([`Carrying`]): substitution in place of pivots, the articulated-body recursion on a tree. The rows of the other joints wait as above.

mod carrying;
mod graph;
mod layout;
mod relative;

use graph::EliminationGraph;
use relative::relative;

use crate::{
    Below, Carrying, Directions, Elimination, EliminationStep, JointSlots, Order, Part, PointSlots,
};

/// The parent joint of each body: the first that can carry it, unless the body carries itself through it.
fn parent_joints(
    bodies: usize,
    joints: &[JointSlots],
    carrying: &[Option<Carrying>],
) -> Vec<Option<usize>> {
    let mut parents: Vec<Option<usize>> = vec![None; bodies];
    for (index, (joint, carrying)) in joints.iter().zip(carrying).enumerate() {
        let &[parent, Some(Part::Body(child))] = &*joint.ends else {
            continue;
        };
        let carries = joint.all_kept() && joint.len > 0 && carrying.is_some();
        let mut inboard = parent;
        while let Some(Part::Body(body)) = inboard
            && body != child
        {
            inboard = parents[body].and_then(|joint| joints[joint].ends[0]);
        }
        if carries && parents[child].is_none() && inboard != Some(Part::Body(child)) {
            parents[child] = Some(index);
        }
    }
    parents
}

/// Chooses the components of the unknowns of every body that a joint carries.
fn in_components(
    directions: Directions,
    parents: &[Option<usize>],
    joints: &[JointSlots],
    carrying: &[Option<Carrying>],
) -> Vec<Option<Carrying>> {
    let mut carrying = carrying.to_vec();
    if directions.plane.is_some() {
        return carrying;
    }
    let carried = |body: usize| {
        let on = move |joint: &usize| joints[*joint].ends[0] == Some(Part::Body(body));
        parents.iter().flatten().copied().filter(on)
    };
    for (body, joint) in parents.iter().enumerate() {
        if let (Some(joint), None) = (*joint, carried(body).next()) {
            carrying[joint] = carrying[joint].map(|own| own.of_leaf());
        }
    }
    loop {
        let before = carrying.clone();
        for (body, joint) in parents.iter().enumerate() {
            let others = carried(body).any(|joint| before[joint].is_some_and(|child| !child.own));
            if let Some(own) = joint.and_then(|joint| carrying[joint].as_mut()) {
                own.own &= !(others && own.may_turn());
            }
        }
        if carrying == before {
            return carrying;
        }
    }
}

/// What an order is chosen for.
pub(crate) struct Topology<'a> {
    /// The axes along which things move and about which bodies turn.
    pub directions: Directions,
    /// Number of bodies.
    pub bodies: usize,
    /// What each point owns.
    pub points: &'a [PointSlots],
    /// The rows of each joint and what it sits on.
    pub joints: &'a [JointSlots],
    /// How each joint carries its child.
    pub carrying: &'a [Option<Carrying>],
    /// Whether states are known at which the loops of the joints close.
    pub closed: bool,
}

impl Topology<'_> {
    fn graph(&self) -> EliminationGraph {
        EliminationGraph::new(
            self.directions,
            self.bodies,
            self.points,
            self.joints,
            self.closed,
        )
    }

    /// The cheapest of the candidate orders.
    pub(crate) fn choose(&self) -> Order {
        let graph = self.graph();
        let least_degree =
            |g: &EliminationGraph, n: usize| (g.neighbours[n].len(), usize::from(g.is_joint(n)));
        let least_cost = |g: &EliminationGraph, n: usize| (g.cost(n), 0);
        let parents = parent_joints(self.bodies, self.joints, self.carrying);
        let carrying = in_components(self.directions, &parents, self.joints, self.carrying);
        let pairs: Vec<Option<(usize, Carrying)>> = graph
            .parts
            .iter()
            .map(|part| match *part {
                Part::Body(body) => {
                    let joint = parents[body]?;
                    Some((graph.node(Part::Joint(joint))?, carrying[joint]?))
                }
                _ => None,
            })
            .collect();
        let plain = [
            graph.clone().run(least_degree),
            graph.clone().run(least_cost),
        ];
        let articulated = graph.clone().run_articulated(&pairs);
        let [a, b] = plain.each_ref().map(|(_, cost)| *cost);
        let last = articulated.as_ref().map_or(usize::MAX, |(_, cost)| *cost);
        let cheapest = plain.into_iter().min_by_key(|(_, cost)| *cost);
        let (order, paired) = match (articulated, cheapest) {
            (Some((order, cost)), Some((_, other))) if cost <= other => (order, true),
            (_, cheapest) => (cheapest.unwrap_or_default().0, false),
        };
        Order {
            parts: order.into_iter().map(|node| graph.parts[node]).collect(),
            articulated: paired,
            articulated_factor: false,
            candidates: [a, b, last],
        }
    }

    /// The blocks of an order; those of the order that [`Topology::choose`] takes where this one is not of this system.
    pub(crate) fn lay_out(&self, order: Order) -> Elimination {
        let graph = self.graph();
        let nodes = |order: &Order| {
            let nodes = order.parts.iter().map(|&part| graph.node(part));
            let nodes: Option<Vec<usize>> = nodes.collect();
            nodes.filter(|nodes| nodes.len() == graph.parts.len())
        };
        let (order, nodes) = match nodes(&order) {
            Some(nodes) => (order, nodes),
            None => {
                let order = self.choose();
                let nodes = nodes(&order).unwrap_or_default();
                (order, nodes)
            }
        };
        let parents = parent_joints(self.bodies, self.joints, self.carrying);
        let carrying = in_components(self.directions, &parents, self.joints, self.carrying);
        let mut elimination = Elimination {
            bodies: vec![None; self.bodies],
            points: vec![None; self.points.len()],
            joints: vec![None; self.joints.len()],
            coordinates: vec![None; self.joints.len()],
            parent_joints: match order.articulated {
                true => parents,
                false => vec![None; self.bodies],
            },
            order,
            ..Elimination::default()
        };
        elimination.lay_out(graph, &nodes, &carrying);
        elimination
    }
}

impl Elimination {
    fn lay_out(
        &mut self,
        mut graph: EliminationGraph,
        order: &[usize],
        carrying: &[Option<Carrying>],
    ) {
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
                Part::Coordinates(joint) => self.coordinates[joint] = Some(step),
            }
            let mut later: Vec<usize> = graph.eliminate(node).iter().map(|&n| place[n]).collect();
            later.sort_unstable();
            let parent = match part {
                Part::Body(body) => self.parent_joints[body],
                _ => None,
            };
            let own = parent.and_then(|joint| carrying.get(joint).copied().flatten());
            // A joint that leaves with its child, the step before: X a coupling; H, its least pivots and axes; ν.
            let child = self
                .steps
                .last()
                .and_then(|step| Some((step.size, step.carrying?.free)));
            let [width, room, unknowns] = match child {
                Some((speeds, free)) => [speeds, (speeds + 1) * free + 9, speeds],
                None => [size, size * size, size],
            };
            let diagonal = self.room(room);
            let below = later.iter().map(|&step| Below {
                step,
                at: self.room(width * graph.sizes[order[step]]),
                targets: Vec::new(),
            });
            let below = below.collect();
            self.steps.push(EliminationStep {
                part,
                first: self.unknowns,
                size,
                speeds: Vec::new(),
                diagonal,
                below,
                carrying: own,
                paired: child.is_some(),
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
}
