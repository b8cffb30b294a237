//! The system of relative coordinates: the speeds of the tree, leaves first, then the rows that close loops.
//!
//! M couples the speeds of a link with those of the links that carry it, so that taking speeds out from the leaves to the root fills nothing
//! (Featherstone, Rigid Body Dynamics Algorithms, branch-induced sparsity). M is positive definite, so that all rows may wait to the end. What motors
//! and couplings of the tree give is no unknown: see `tree/dependent.rs`.

use super::graph::EliminationGraph;
use crate::{Dependent, Elimination, Layout, Link, Order, Part, PointSlots, Scene, Tree};

impl Link {
    /// Its speeds as a node of the system.
    #[must_use]
    pub fn part(&self) -> Part {
        match self.joint {
            Some(joint) => Part::Coordinates(joint),
            None => Part::Body(self.body),
        }
    }
}

/// How a link moves, as far as it decides what is cheaper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LinkKind {
    /// In a plane.
    Planar,
    /// About or along one axis.
    Axial,
    /// By a quaternion, on what carries it.
    Spherical,
    /// By several angles.
    Universal,
    /// Free of all others.
    Floating,
}

impl LinkKind {
    fn of(link: &Link, planar: bool) -> Self {
        match link.turns {
            _ if planar || link.parallel => LinkKind::Planar,
            _ if link.joint.is_none() => LinkKind::Floating,
            0 | 1 => LinkKind::Axial,
            _ if link.attitude().is_some() => LinkKind::Spherical,
            _ => LinkKind::Universal,
        }
    }

    /// By how many operations more the factor of M costs than articulated bodies, beside the factor itself: for each speed whose force is handed on by
    /// this link, for the link where another one carries it, and where the world does. Least squares over 300 trees of 2 to 14 links of the joints of
    /// a tree, branched and not, as the compiler counted them: the choice by them takes 1.4 % more operations than the better one on the mean.
    fn excess(self) -> [i64; 3] {
        match self {
            LinkKind::Planar => [11, -35, 13],
            LinkKind::Axial => [-2, -24, -1],
            LinkKind::Spherical => [54, -191, 26],
            LinkKind::Universal => [48, -393, -29],
            LinkKind::Floating => [0, 0, -86],
        }
    }
}

/// By about how many operations the factor of M and its terms take more than articulated bodies, in a derivative.
fn excess_of_factor(layout: &Layout) -> i64 {
    let Some(tree) = &layout.tree else {
        return 0;
    };
    let planar = layout.directions.plane.is_some();
    let mut carried = vec![0; tree.links.len()];
    let mut excess = 0;
    for (index, link) in tree.links.iter().enumerate().rev() {
        carried[index] += link.speeds as i64;
        let inboard = moved_with(tree, index);
        let factor = (inboard..inboard + link.speeds).map(|moves| (moves * moves) as i64);
        let [each, once, of_world] = LinkKind::of(link, planar).excess();
        excess += factor.sum::<i64>();
        excess += match link.inboard {
            Some(inboard) => {
                carried[inboard] += carried[index];
                each * carried[index] + once
            }
            None => of_world,
        };
    }
    excess
}

/// Where the excess is estimated to be further from zero than this for each link, its sign is certain. The estimates of those trees were wrong by up to 110.
const CERTAIN: i64 = 150;

/// A factor of M of more operations than this, the terms of M not counted, is long to write out: it grows with the cube of the length, what articulated bodies take
/// with the length.
const LONG_FACTOR: usize = 3000;

/// Operations of the factor of M of a tree, its terms not counted; `None` where rows close loops or there is no tree.
fn factor_of_mass(layout: &Layout) -> Option<usize> {
    let tree = layout.tree.as_ref().filter(|_| layout.nc == 0)?;
    let links = tree.links.iter().enumerate();
    let moves = links
        .flat_map(|(index, link)| moved_with(tree, index)..moved_with(tree, index) + link.speeds);
    Some(moves.map(|moves| moves * moves).sum())
}

/// The speeds that carry a link, its own left out.
fn moved_with(tree: &Tree, link: usize) -> usize {
    tree.path(link)
        .skip(1)
        .map(|link| tree.links[link].speeds)
        .sum()
}

/// Whether as many solutions as there are derivatives by the state are estimated to take fewer operations by articulated bodies than by the factor of M,
/// which has a number for every speed that moves what another one moves; or the factor is long.
fn solves_by_articulated_bodies(layout: &Layout) -> bool {
    let (Some(tree), Some(factor)) = (&layout.tree, factor_of_mass(layout)) else {
        return false;
    };
    let planar = layout.directions.plane.is_some();
    let solutions = 2 * layout.nv;
    let (mut dense, mut articulated) = (factor, 0);
    for (index, link) in tree.links.iter().enumerate() {
        let inboard = moved_with(tree, index);
        let moves: usize = (inboard..inboard + link.speeds).sum();
        dense += 4 * moves * solutions;
        // A column of a plane moves two forces and a couple, one of space six; an offset likewise. The factor takes what ten solutions do.
        let (column, offset) = match planar || link.parallel {
            true => (11, 7),
            false => (46, 24),
        };
        articulated += (offset + column * link.speeds) * (solutions + 10);
    }
    articulated < dense || factor > LONG_FACTOR
}

/// The speeds that the row of a coupling is over; `None` where it stays in the system: not all are speeds of the tree, or it may be detached.
fn coupled(scene: &Scene, layout: &Layout, joint: usize) -> Option<Vec<usize>> {
    let slots = layout.joints.get(joint)?;
    let couples = scene.joints.get(joint)?.law.couples().iter();
    let speeds = couples.map(|&(of, index)| {
        let link = layout.carried(of)?;
        let attitude = scene.joints[of].law.attitude().unwrap_or_default();
        (!attitude.contains(&index)).then_some(link.slots.v + index)
    });
    let speeds: Vec<usize> = speeds.collect::<Option<_>>()?;
    let repeats = (1..speeds.len()).any(|k| speeds[..k].contains(&speeds[k]));
    let one = slots.len == 1 && slots.kept.len() == 1;
    (one && slots.switch.is_none() && !repeats).then_some(speeds)
}

/// The speeds that motors and couplings of joints of the tree give. Couplings follow what is driven, and each other: one that names a speed that
/// is given, or followed, comes first, so that trains of them leave altogether, in whatever order they are declared.
fn dependents(scene: &Scene, layout: &Layout) -> Vec<Dependent> {
    let mut named = vec![false; layout.nv];
    let mut found = Vec::new();
    for (joint, (declared, slots)) in scene.joints.iter().zip(&layout.joints).enumerate() {
        let Some(link) = layout.carried(joint) else {
            continue;
        };
        for (row, (index, _)) in (slots.row..).zip(declared.motors()) {
            let speed = link.slots.v + index;
            named[speed] = true;
            found.push(Dependent {
                speed,
                joint,
                row,
                number: 0,
                sources: Vec::new(),
            });
        }
    }
    let couplings = (0..layout.joints.len()).filter_map(|joint| {
        let speeds = coupled(scene, layout, joint)?;
        (!speeds.is_empty()).then_some((joint, speeds))
    });
    let mut couplings: Vec<(usize, Vec<usize>)> = couplings.collect();
    while !couplings.is_empty() {
        let follows = |(_, speeds): &(usize, Vec<usize>)| speeds.iter().any(|&own| named[own]);
        let next = couplings.iter().position(follows).unwrap_or_default();
        let (joint, speeds) = couplings.remove(next);
        let Some(number) = speeds.iter().position(|&speed| !named[speed]) else {
            continue;
        };
        speeds.iter().for_each(|&speed| named[speed] = true);
        let sources = speeds.iter().enumerate();
        let sources = sources.filter(|(other, _)| *other != number);
        found.push(Dependent {
            speed: speeds[number],
            joint,
            row: layout.joints[joint].row,
            number,
            sources: sources.map(|(other, &speed)| (speed, other)).collect(),
        });
    }
    found
}

/// Whether a tree may be solved by articulated bodies, which know no rows but those of motors: by the number of rows, and what gives speeds.
fn is_open(layout: &Layout, dependents: &[Dependent]) -> bool {
    let driven = dependents.iter().filter(|own| own.sources.is_empty());
    let driven = driven.count();
    driven == layout.nc && driven < layout.nv
}

/// The order of elimination of a layout with a tree, and where its blocks live; articulated bodies as this order has it, or where they are
/// estimated to be cheaper.
pub(super) fn relative(scene: &Scene, layout: &Layout, order: Option<&Order>) -> Elimination {
    let dependents = dependents(scene, layout);
    let leaves = |joint: usize| dependents.iter().any(|own| own.joint == joint);
    let independent = |first: usize, count: usize| {
        let speeds = first..first + count;
        let free = |speed: &usize| !dependents.iter().any(|own| own.speed == *speed);
        speeds.filter(free).collect::<Vec<_>>()
    };
    let mut graph = EliminationGraph::empty();
    let mut speeds = Vec::new();
    let links = layout.tree.as_ref().map_or(&[][..], |tree| &tree.links);
    for link in links.iter().rev().filter(|link| link.speeds > 0) {
        let own = independent(link.slots.v, link.speeds);
        graph.push(link.part(), own.len());
        speeds.push(own);
    }
    let held = |part: Part| {
        layout
            .joints
            .iter()
            .any(|slots| !slots.kept.is_empty() && slots.ends.contains(&Some(part)))
    };
    for (point, slots) in layout.points.iter().enumerate() {
        let part = Part::Point(point);
        if let (PointSlots::Mass(slots), true) = (slots, held(part)) {
            let own = independent(slots.v, layout.directions.translations().len());
            graph.push(part, own.len());
            speeds.push(own);
        }
    }
    if let Some(tree) = &layout.tree {
        for link in 0..links.len() {
            let own = graph.node(links[link].part());
            for other in tree.path(link).skip(1) {
                if let (Some(own), Some(other)) = (own, graph.node(links[other].part())) {
                    graph.join(own, other);
                }
            }
        }
    }
    for (joint, slots) in layout.joints.iter().enumerate() {
        if slots.kept.is_empty() || leaves(joint) {
            continue;
        }
        let row = graph.push(Part::Joint(joint), slots.kept.len());
        speeds.push(Vec::new());
        for part in layout.moved_by(joint) {
            if let Some(other) = graph.node(part) {
                graph.join(row, other);
            }
        }
    }
    // What moves with a dependent speed moves with what that follows.
    let node_of = |graph: &EliminationGraph, speed: usize| {
        let own = |link: &&Link| (link.slots.v..link.slots.v + link.speeds).contains(&speed);
        links
            .iter()
            .find(own)
            .and_then(|link| graph.node(link.part()))
    };
    for dependent in dependents.iter().rev() {
        let Some(own) = node_of(&graph, dependent.speed) else {
            continue;
        };
        let sources = dependent.sources.iter();
        let sources: Vec<usize> = sources
            .filter_map(|&(speed, _)| node_of(&graph, speed))
            .collect();
        let mut moved = graph.neighbours[own].clone();
        moved.extend_from_slice(&sources);
        moved.push(own);
        for &source in &sources {
            moved.iter().for_each(|&other| graph.join(source, other));
        }
    }
    let nodes = (0..graph.parts.len()).filter(|&node| graph.sizes[node] > 0);
    let nodes: Vec<usize> = nodes.collect();
    for neighbours in &mut graph.neighbours {
        neighbours.retain(|&other| graph.sizes[other] > 0);
    }
    let mut elimination = Elimination {
        bodies: vec![None; layout.bodies.len()],
        points: vec![None; layout.points.len()],
        joints: vec![None; layout.joints.len()],
        coordinates: vec![None; layout.joints.len()],
        parent_joints: vec![None; layout.bodies.len()],
        order: Order {
            parts: nodes.iter().map(|&node| graph.parts[node]).collect(),
            articulated: is_open(layout, &dependents)
                && order.map_or(excess_of_factor(layout) > 0, |order| order.articulated),
            articulated_factor: order.map_or_else(
                || solves_by_articulated_bodies(layout),
                |order| order.articulated_factor,
            ),
            ..Order::default()
        },
        ..Elimination::default()
    };
    elimination.lay_out(graph, &nodes, &vec![None; layout.joints.len()]);
    for (step, &node) in elimination.steps.iter_mut().zip(&nodes) {
        step.speeds = std::mem::take(&mut speeds[node]);
    }
    elimination.dependents = dependents;
    elimination
}

impl Layout {
    /// The same with accelerations by the other algorithm, where either the factor of M or articulated bodies may be the cheaper one: in relative
    /// coordinates without rows, and where an estimate leaves it open. Counting both decides.
    #[must_use]
    pub fn with_other_algorithm(&self) -> Option<Layout> {
        let tree = self.tree.as_ref()?;
        let open = is_open(self, &self.elimination.dependents);
        let near = excess_of_factor(self).abs() <= CERTAIN * tree.links.len() as i64;
        (open && near).then(|| {
            let mut other = self.clone();
            let order = &mut other.elimination.order;
            order.articulated = !order.articulated;
            other
        })
    }

    /// The same with the other factor for its derivatives, that of M or of articulated bodies; `None` where there is one alone, or that of M is too long.
    #[must_use]
    pub fn with_other_factor(&self) -> Option<Layout> {
        let factor = factor_of_mass(self)?;
        (factor <= LONG_FACTOR).then(|| {
            let mut other = self.clone();
            let order = &mut other.elimination.order;
            order.articulated_factor = !order.articulated_factor;
            other.factor = crate::tree::factored_len(&other);
            other
        })
    }

    /// The nodes of the system whose speeds the rows of a joint see: on the paths from its ends to where they meet.
    fn moved_by(&self, joint: usize) -> Vec<Part> {
        let mut parts = Vec::new();
        let (Some(tree), Some(slots)) = (&self.tree, self.joints.get(joint)) else {
            return parts;
        };
        if tree.carried(joint).is_some() {
            return vec![Part::Coordinates(joint)];
        }
        for pair in slots.ends.chunks(2) {
            let links = tree.links_of(pair);
            let meet = tree.meeting(links);
            for (end, link) in pair.iter().zip(links) {
                match (end, link) {
                    (Some(Part::Point(_)), _) => parts.extend(*end),
                    (_, Some(link)) => {
                        let path = tree.path(link).take_while(|link| Some(*link) != meet);
                        parts.extend(path.map(|link| tree.links[link].part()));
                    }
                    _ => {}
                }
            }
        }
        parts
    }
}
