//! Whether every body is held by joints that lead to the world, or is declared free. A point with mass passes on what holds it; a body that
//! hangs on a free point is as free as the point.

use std::collections::BTreeMap;

use mbd_scene::{Joint, Place};

use crate::messages::check as say;
use crate::resolve::{Named, Resolver};

/// Every body is attached, and free at most once.
pub fn check_attached(resolver: &mut Resolver<'_>) {
    check_free_once(resolver);
    if resolver.any_bad("joint") {
        return;
    }
    let bodies = resolver.scene.bodies.len();
    let mut groups = AttachedGroups::new(bodies + resolver.scene.points.len());
    for joint in &resolver.scene.joints {
        groups.join(node(joint.parent, bodies), node(joint.child, bodies));
    }
    let mut floating: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    let world = groups.root(0);
    for body in 0..bodies {
        let root = groups.root(body + 1);
        if root != world {
            floating.entry(root).or_default().push(body);
        }
    }
    let points = 0..resolver.scene.points.len();
    let points: Vec<usize> = points
        .map(|point| groups.root(1 + bodies + point))
        .collect();
    for (root, bodies) in floating {
        let names: Vec<&str> = bodies
            .iter()
            .filter_map(|&body| resolver.scene.bodies.get(body))
            .map(|body| body.name.as_str())
            .collect();
        let first = bodies.first().map(|&body| Named::Body(body));
        let declared = first.and_then(|first| resolver.declared.get(&first));
        let report = match (declared, names.as_slice()) {
            (Some(&at), [only]) if points.contains(&root) => say::on_points(at, only),
            (Some(&at), [only]) => say::floating(at, only),
            (Some(&at), [_, _, ..]) => say::floating_together(at, &names),
            _ => continue,
        };
        resolver.messages.push(report);
    }
}

/// A joint marked `loop` closes one: without the marked joints its two ends are joined already.
pub fn check_marks(resolver: &mut Resolver<'_>) {
    if resolver.any_bad("joint") {
        return;
    }
    let scene = &resolver.scene;
    let bodies = scene.bodies.len();
    let mut groups = AttachedGroups::new(bodies + scene.points.len());
    let ends = |joint: &Joint| [joint.parent, joint.child];
    for joint in scene.joints.iter().filter(|joint| !joint.cut) {
        let [parent, child] = ends(joint).map(|place| node(place, bodies));
        groups.join(parent, child);
    }
    let mut reports = Vec::new();
    for (index, joint) in scene.joints.iter().enumerate() {
        let [parent, child] = ends(joint).map(|place| node(place, bodies));
        if !joint.cut || groups.root(parent) == groups.root(child) {
            continue;
        }
        // What the joint attaches: its child, unless that leads to the world.
        let held = groups.root(child) == groups.root(0);
        let attached = match if held { joint.parent } else { joint.child } {
            Place::Body(body, _) => Named::Body(body),
            Place::Point(point) => Named::Point(point),
            Place::World(_) => continue,
        };
        let places = (
            resolver.declared.get(&Named::Joint(index)),
            resolver.declared.get(&attached),
        );
        if let (Some(&at), Some(&owner)) = places {
            reports.push(say::no_loop(at, &joint.name, owner));
        }
    }
    let messages = &mut resolver.messages;
    reports.into_iter().for_each(|report| messages.push(report));
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

/// 0 for the world, then the bodies, then the points.
fn node(place: Place, bodies: usize) -> usize {
    match place {
        Place::World(_) => 0,
        Place::Body(body, _) => 1 + body,
        Place::Point(point) => 1 + bodies + point,
    }
}

/// What joints hold together: the world is 0, bodies and points follow.
struct AttachedGroups {
    up: Vec<usize>,
}

impl AttachedGroups {
    fn new(members: usize) -> Self {
        AttachedGroups {
            up: (0..=members).collect(),
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
