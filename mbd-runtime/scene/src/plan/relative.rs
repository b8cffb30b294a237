//! The system of relative coordinates: the speeds of the tree, leaves first, then the rows that close loops.
//!
//! M couples the speeds of a link with those of the links that carry it, so that taking speeds out from the leaves to the root fills nothing
//! (Featherstone, Rigid Body Dynamics Algorithms, branch-induced sparsity). M is positive definite, so that all rows may wait to the end.

use super::graph::EliminationGraph;
use crate::{Elimination, Layout, Link, Order, Part, PointSlots};

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

/// The order of elimination of a layout with a tree, and where its blocks live.
pub(super) fn relative(layout: &Layout) -> Elimination {
    let mut graph = EliminationGraph::empty();
    let links = layout.tree.as_ref().map_or(&[][..], |tree| &tree.links);
    for link in links.iter().rev().filter(|link| link.speeds > 0) {
        graph.push(link.part(), link.speeds);
    }
    let held = |part: Part| {
        layout
            .joints
            .iter()
            .any(|slots| !slots.kept.is_empty() && slots.ends.contains(&Some(part)))
    };
    for (point, slots) in layout.points.iter().enumerate() {
        let part = Part::Point(point);
        if matches!(slots, PointSlots::Mass(_)) && held(part) {
            graph.push(part, layout.directions.translations().len());
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
        if slots.kept.is_empty() {
            continue;
        }
        let row = graph.push(Part::Joint(joint), slots.kept.len());
        for part in layout.moved_by(joint) {
            if let Some(other) = graph.node(part) {
                graph.join(row, other);
            }
        }
    }
    let nodes: Vec<usize> = (0..graph.parts.len()).collect();
    let mut elimination = Elimination {
        bodies: vec![None; layout.bodies.len()],
        points: vec![None; layout.points.len()],
        joints: vec![None; layout.joints.len()],
        coordinates: vec![None; layout.joints.len()],
        parent_joints: vec![None; layout.bodies.len()],
        order: Order {
            parts: graph.parts.clone(),
            articulated: layout.nc == 0 && depth(layout) > LONG,
            ..Order::default()
        },
        ..Elimination::default()
    };
    elimination.lay_out(graph, &nodes, &vec![None; layout.joints.len()]);
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
