//! The spanning tree along which bodies are placed: joints of which something is said first.

use super::{FREE, JointStart, flies_from_world};
use crate::{Layout, Part, Place, Scene};

/// A joint walked from the part that is placed to the one it places.
#[derive(Clone, Copy)]
pub(super) struct PlacingJoint {
    pub joint: usize,
    pub to: Part,
    pub to_parent: bool,
}

/// The spanning tree, in the order in which it is walked, and the joints of which something is said exactly that are decided without: their ends are
/// placed already.
pub(super) fn tree(
    scene: &Scene,
    layout: &Layout,
    given: &[JointStart],
    fixed: &[Part],
) -> (Vec<PlacingJoint>, Vec<usize>) {
    // What holds exactly goes first, what may give way next: what is left over closes the loops.
    let rank = |joint: usize| {
        let own = given.iter().filter(|start| start.joint == joint);
        let gives_way = |start: &JointStart| start.about && start.rate.is_none();
        own.map(|start| u8::from(gives_way(start)))
            .min()
            .unwrap_or(2)
    };
    // What flies from another body starts where that is.
    let flies = |joint: usize| {
        let from_body = matches!(scene.joints[joint].parent, Place::Body(..));
        from_body && scene.joints[joint].law.freedoms() == FREE
    };
    // What forbids nothing in a plane, as a joint `planar` about its normal, places as in a tree of relative coordinates: by its coordinates, which are
    // zero where nothing is said of them.
    let slides =
        |joint: usize| layout.joints[joint].len == 0 && scene.joints[joint].law.freedoms() < FREE;
    let mut order: Vec<usize> = (0..layout.joints.len())
        .filter(|&joint| {
            let holds = layout.starts_joined(joint) || slides(joint);
            (holds && scene.joints[joint].law.couples().is_empty()) || flies(joint)
        })
        .collect();
    let last = |joint: usize| flies(joint) || slides(joint) && rank(joint) == 2;
    // What leaves more than an attitude open, a rod to a point say, tells least of where a body is.
    let hangs = |joint: usize| scene.joints[joint].law.freedoms() > 3;
    order.sort_by_key(|&joint| {
        let cut = scene.joints[joint].cut;
        (last(joint), rank(joint), cut, hangs(joint))
    });
    // What hangs together; the world and everything fixed are one.
    let mut together: Vec<Vec<Option<Part>>> = vec![vec![None]];
    together[0].extend(fixed.iter().copied().map(Some));
    let (mut edges, mut decided) = (Vec::new(), Vec::new());
    for joint in order {
        let [Some(&parent), Some(&child)] = [0, 1].map(|k| layout.joints[joint].ends.get(k)) else {
            continue;
        };
        let ends = [parent, child];
        let [a, b] = ends.map(|end| {
            let found = together.iter().position(|set| set.contains(&end));
            found.unwrap_or_else(|| {
                together.push(vec![end]);
                together.len() - 1
            })
        });
        if a == b {
            if rank(joint) == 0 {
                decided.push(joint);
            }
            continue;
        }
        let moved = together.remove(a.max(b));
        together[a.min(b)].extend(moved);
        edges.push((joint, ends));
    }
    let mut placed: Vec<Option<Part>> = vec![None];
    placed.extend(fixed.iter().copied().map(Some));
    let flying: Vec<Part> = scene.joints.iter().filter_map(flies_from_world).collect();
    let mut links = Vec::new();
    while !edges.is_empty() {
        let next = edges
            .iter()
            .position(|(_, ends)| ends.iter().any(|end| placed.contains(end)));
        let Some(next) = next else {
            // Nothing ties these to the world: the body that flies from it stays where it is, else the one that was declared first, as it is the one
            // that floats in a tree of relative coordinates.
            let ends = || edges.iter().flat_map(|(_, ends)| ends);
            let flying = |end: &&Option<Part>| end.is_some_and(|part| flying.contains(&part));
            let bodies = ends().filter_map(|end| match end {
                Some(Part::Body(body)) => Some(*body),
                _ => None,
            });
            let first = || bodies.min().map(Part::Body);
            let stays = ends().find(flying).copied().flatten().or_else(first);
            placed.push(stays.or(edges[0].1[0]));
            continue;
        };
        let (joint, [parent, child]) = edges.remove(next);
        let to_parent = placed.contains(&child);
        let to = if to_parent { parent } else { child };
        if let Some(to) = to {
            links.push(PlacingJoint {
                joint,
                to,
                to_parent,
            });
            placed.push(Some(to));
        }
    }
    (links, decided)
}
