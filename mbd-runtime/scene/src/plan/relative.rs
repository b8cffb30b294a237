//! The system of relative coordinates: the speeds of the tree, leaves first, then the rows that close loops.
//!
//! M couples the speeds of a link with those of the links that carry it, so that taking speeds out from the leaves to the root fills nothing
//! (Featherstone, Rigid Body Dynamics Algorithms, branch-induced sparsity). M is positive definite, so that all rows may wait to the end. What motors
//! and couplings of the tree give is no unknown: see `tree/dependent.rs`.

use super::graph::EliminationGraph;
use crate::{Dependent, Elimination, Layout, Link, Order, Part, PointSlots, Scene};

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

/// Links on the way to the world, on average, from which on articulated bodies take fewer operations than M and its factor. Slender rods on crossed
/// axes: a chain of eight takes 1,402 by its factor, one of sixteen 5,318, by articulated bodies 4,121.
const LONG: f64 = 6.5;

/// How many links lie on the way to the world, on average.
fn depth(layout: &Layout) -> f64 {
    let Some(tree) = &layout.tree else {
        return 0.0;
    };
    let depths = (0..tree.links.len()).map(|link| tree.path(link).count());
    depths.sum::<usize>() as f64 / tree.links.len().max(1) as f64
}

/// A factor of M of more operations than this, the terms of M not counted, is long to write out: it grows with the cube of the length, what articulated bodies take
/// with the length.
const LONG_FACTOR: usize = 3000;

/// Whether as many solutions as there are derivatives by the state take fewer operations by articulated bodies than by the factor of M, which has a
/// number for every speed that moves what another one moves; or the factor is long.
fn solves_by_articulated_bodies(layout: &Layout) -> bool {
    let Some(tree) = layout.tree.as_ref().filter(|_| layout.nc == 0) else {
        return false;
    };
    let planar = layout.directions.plane.is_some();
    let (mut dense, mut articulated, mut factor) = (0, 0, 0);
    for (index, link) in tree.links.iter().enumerate() {
        let inboard = tree.path(index).skip(1).map(|link| tree.links[link].speeds);
        let inboard: usize = inboard.sum();
        let solutions = 2 * layout.nv;
        for own in 0..link.speeds {
            let moves = inboard + own;
            dense += 4 * moves * solutions + moves * moves;
            factor += moves * moves;
        }
        // A column of a plane moves two forces and a couple, one of space six; an offset likewise. The factor takes what ten solutions do.
        let (column, offset) = match planar || link.parallel {
            true => (13, 8),
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

/// The order of elimination of a layout with a tree, and where its blocks live.
pub(super) fn relative(scene: &Scene, layout: &Layout) -> Elimination {
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
    // Articulated bodies know no rows but those of motors.
    let driven = dependents
        .iter()
        .filter(|own| own.sources.is_empty())
        .count();
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
            articulated: driven == layout.nc && driven < layout.nv && depth(layout) > LONG,
            ..Order::default()
        },
        ..Elimination::default()
    };
    elimination.lay_out(graph, &nodes, &vec![None; layout.joints.len()]);
    for (step, &node) in elimination.steps.iter_mut().zip(&nodes) {
        step.speeds = std::mem::take(&mut speeds[node]);
    }
    elimination.articulated_factor = solves_by_articulated_bodies(layout);
    elimination.dependents = dependents;
    elimination
}

impl Layout {
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
