//! What of a state has a name of its own: bodies, points, nodes that are states, declared states. Joints of a tree are placed by the bodies they carry.

use std::ops::Range;

use mbd_scene::{Layout, Part, Scene};

use crate::columns::{node_name, part_name};
use crate::moving::moving;

/// What something is: only what is the same goes on under its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OwnerKind {
    /// A body.
    Body,
    /// A point with mass.
    Point,
    /// A node that is a state.
    Node,
    /// A declared state.
    State,
}

/// Something of a state that has a name.
#[derive(Clone, Debug)]
pub struct Owned {
    /// Its name.
    pub name: String,
    /// What it is.
    pub kind: OwnerKind,
    /// Where its numbers are, in order; what it has not is empty.
    slots: [Range<usize>; 4],
    /// Whether the declaration says where it starts.
    pub placed: bool,
}

impl Owned {
    /// How many numbers it has.
    pub fn count(&self) -> usize {
        self.slots.iter().map(ExactSizeIterator::len).sum()
    }

    /// Where they are.
    pub fn places(&self) -> impl Iterator<Item = usize> + '_ {
        self.slots.iter().cloned().flatten()
    }
}

/// Everything of a state, in its order: bodies, points, nodes, declared states.
pub fn owned(scene: &Scene, layout: &Layout) -> Vec<Owned> {
    let parts = moving(layout).filter_map(|part| {
        let kind = match part.part {
            Part::Body(_) => OwnerKind::Body,
            Part::Point(_) => OwnerKind::Point,
            Part::Joint(_) | Part::Coordinates(_) => return None,
        };
        let mut declared = scene.starts.parts.iter();
        Some(Owned {
            name: part_name(scene, part.part).to_owned(),
            kind,
            placed: declared.any(|start| start.part == part.part),
            slots: [part.position, part.attitude, part.velocity, part.spin],
        })
    });
    let alone = |name: &str, kind: OwnerKind, own: Range<usize>| Owned {
        name: name.to_owned(),
        kind,
        // The start finds a node in balance.
        placed: true,
        slots: [own, 0..0, 0..0, 0..0],
    };
    let first = layout.nq + layout.nv;
    let nodes = layout.nodes.iter().filter_map(|node| {
        let at = first + node.z?;
        Some(alone(
            node_name(scene, node.point),
            OwnerKind::Node,
            at..at + 3,
        ))
    });
    let states = scene.states.iter().zip(layout.states()..);
    let states = states.map(|(state, at)| alone(&state.name, OwnerKind::State, at..at + 1));
    parts.chain(nodes).chain(states).collect()
}
