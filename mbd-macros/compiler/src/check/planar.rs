//! What a planar scene must obey: joints that close in the plane, motors and couplings that move something there.

use mbd_scene::{Layout, Plane};

use crate::describe;
use crate::messages::check as say;
use crate::resolve::{Named, Resolver};

/// Tells joints whose frames disagree out of the plane, and motors and couplings of coordinates that the plane holds.
pub fn check_planar(resolver: &mut Resolver<'_>) {
    let Some(plane) = resolver.scene.planar else {
        return;
    };
    if !resolver.whole || !resolver.messages.is_empty() {
        return;
    }
    let scene = &resolver.scene;
    let mut reports = Vec::new();
    for apart in Layout::apart(scene) {
        let joint = scene.joints.get(apart.joint);
        let at = resolver.declared.get(&Named::Joint(apart.joint));
        if let (Some(joint), Some(&at)) = (joint, at) {
            let places = [joint.parent, joint.child].map(|place| describe::place(scene, place));
            let axes = (plane.word(), normal(plane));
            reports.push(match apart.gap {
                Some(gap) => say::apart(at, &joint.name, axes, &places, gap),
                None => say::leaning(at, &joint.name, axes, &places),
            });
        }
    }
    for (joint, index) in Layout::still(scene) {
        let found = scene.coordinate(joint, index);
        let at = resolver.declared.get(&Named::Joint(joint));
        if let (Some((joint, coordinate)), Some(&at)) = (found, at) {
            let name = format!("{}.{}", joint.name, coordinate.name);
            let driven = joint.motors().any(|(own, _)| own == index);
            reports.push(say::still(at, &name, plane.word(), driven));
        }
    }
    let messages = &mut resolver.messages;
    reports.into_iter().for_each(|report| messages.push(report));
}

fn normal(plane: Plane) -> &'static str {
    ["x", "y", "z"]
        .get(plane.normal())
        .copied()
        .unwrap_or_default()
}
