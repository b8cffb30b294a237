//! Whether every body is held by joints that lead to the world, or is declared free.

use std::collections::BTreeMap;

use mbd_scene::Place;

use super::any_bad;
use crate::messages::check as say;
use crate::resolve::{Named, Resolver};

/// Every body is attached, and free at most once.
pub fn check_attached(resolver: &mut Resolver<'_>) {
    check_free_once(resolver);
    if any_bad(resolver, "joint") {
        return;
    }
    let mut groups = Groups::new(resolver.scene.bodies.len());
    for joint in &resolver.scene.joints {
        groups.join(node(joint.parent), node(joint.child));
    }
    let mut floating: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    let world = groups.root(0);
    for body in 0..resolver.scene.bodies.len() {
        let root = groups.root(body + 1);
        if root != world {
            floating.entry(root).or_default().push(body);
        }
    }
    for bodies in floating.into_values() {
        let names: Vec<&str> = bodies
            .iter()
            .filter_map(|&body| resolver.scene.bodies.get(body))
            .map(|body| body.name.as_str())
            .collect();
        let first = bodies.first().map(|&body| Named::Body(body));
        let declared = first.and_then(|first| resolver.declared.get(&first));
        let report = match (declared, names.as_slice()) {
            (Some(&at), [only]) => say::floating(at, only),
            (Some(&at), [_, _, ..]) => say::floating_together(at, &names),
            _ => continue,
        };
        resolver.messages.push(report);
    }
}

/// A joint marked `loop` closes one: without the marked joints its two ends are joined already.
pub fn check_marks(resolver: &mut Resolver<'_>) {
    if any_bad(resolver, "joint") {
        return;
    }
    let scene = &resolver.scene;
    let mut groups = Groups::new(scene.bodies.len());
    for joint in scene.joints.iter().filter(|joint| !joint.cut) {
        groups.join(node(joint.parent), node(joint.child));
    }
    let mut reports = Vec::new();
    for (index, joint) in scene.joints.iter().enumerate() {
        let (parent, child) = (node(joint.parent), node(joint.child));
        if !joint.cut || groups.root(parent) == groups.root(child) {
            continue;
        }
        let world = groups.root(0);
        let alone = if groups.root(child) == world {
            parent
        } else {
            child
        };
        let body = alone.checked_sub(1);
        let places = (
            resolver.declared.get(&Named::Joint(index)),
            body.and_then(|body| resolver.declared.get(&Named::Body(body))),
        );
        if let (Some(&at), Some(&body)) = places {
            reports.push(say::no_loop(at, &joint.name, body));
        }
    }
    reports
        .into_iter()
        .for_each(|report| resolver.messages.push(report));
}

fn check_free_once(resolver: &mut Resolver<'_>) {
    let mut first: BTreeMap<usize, usize> = BTreeMap::new();
    let scene = &resolver.scene;
    for (index, joint) in scene.joints.iter().enumerate() {
        let Place::Body(body, _) = joint.child else {
            continue;
        };
        if joint.law.rows() > 0 {
            continue;
        }
        let Some(&other) = first.get(&body) else {
            first.insert(body, index);
            continue;
        };
        let places = (
            resolver.declared.get(&Named::Joint(index)),
            resolver.declared.get(&Named::Joint(other)),
            scene.bodies.get(body),
        );
        if let (Some(&at), Some(&earlier), Some(owner)) = places {
            let report = say::two_joints(at, &owner.name, earlier);
            resolver.messages.push(report);
        }
    }
}

/// 0 for the world, a body's index plus 1.
fn node(place: Place) -> usize {
    match place {
        Place::Body(body, _) => body + 1,
        Place::World(_) | Place::Point(_) => 0,
    }
}

/// What joints hold together: the world is 0, bodies follow.
struct Groups {
    up: Vec<usize>,
}

impl Groups {
    fn new(bodies: usize) -> Self {
        Groups {
            up: (0..=bodies).collect(),
        }
    }

    /// The smallest member of the group, shortening the way to it.
    fn root(&mut self, member: usize) -> usize {
        let mut at = member;
        while let Some(&up) = self.up.get(at).filter(|&&up| up != at) {
            let above = self.up.get(up).copied().unwrap_or(up);
            if let Some(entry) = self.up.get_mut(at) {
                *entry = above;
            }
            at = up;
        }
        at
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        if let Some(entry) = self.up.get_mut(a.max(b)) {
            *entry = a.min(b);
        }
    }
}
