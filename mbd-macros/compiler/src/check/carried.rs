//! Bodies without mass, or with a moment that is not positive: in relative coordinates what they carry may give their joints an inertia.

use mbd_scene::{Coordinates, Place, Scene};

use super::WrongInertia;
use crate::messages::check as say;
use crate::resolve::fold::at_defaults;
use crate::resolve::{Named, Resolver};

/// The bodies, by their index, that have no mass or a moment that is not positive, with all params at their defaults.
pub fn without_inertia(scene: &Scene) -> Vec<usize> {
    let lacks = |index: &usize| {
        scene.bodies.get(*index).is_some_and(|body| {
            let moments = super::inertia(&body.inertia, scene);
            has_no_mass(scene, *index) || matches!(moments, Err(WrongInertia::NotPositive(_)))
        })
    };
    scene.unchecked.iter().copied().filter(lacks).collect()
}

/// Refuses such bodies in absolute coordinates, and those without mass that carry nothing which has any.
pub fn check_carried(resolver: &mut Resolver<'_>) {
    let absolute = resolver.scene.coordinates == Coordinates::Absolute && !resolver.asked.family;
    let lacking = without_inertia(&resolver.scene);
    let idle = carry_nothing(&resolver.scene);
    for body in lacking {
        let Some(&at) = resolver.declared.get(&Named::Body(body)) else {
            continue;
        };
        let name = resolver.scene.bodies.get(body);
        let name = name.map_or("", |body| body.name.as_str());
        if absolute {
            // Nobody knows how a robot was meant to be taken in whose options could not be read.
            if resolver.whole {
                let report = say::no_inertia_in_absolute(at, name);
                resolver.messages.push(report);
            }
        } else if idle.contains(&body) && !resolver.any_bad("joint") {
            let report = say::carries_nothing(at, name);
            resolver.messages.push(report);
        }
    }
}

fn has_no_mass(scene: &Scene, body: usize) -> bool {
    let body = scene.bodies.get(body);
    let mass = body.and_then(|body| at_defaults(&body.mass, scene));
    mass.is_some_and(|mass| mass <= 0.0)
}

/// The bodies without mass behind which nothing with mass is joined: ends of the tree, one after the other.
fn carry_nothing(scene: &Scene) -> Vec<usize> {
    let joints = scene.joints.iter();
    let mut joints: Vec<[Place; 2]> = joints.map(|joint| [joint.parent, joint.child]).collect();
    let mut open = scene.unchecked.clone();
    open.retain(|body| has_no_mass(scene, *body));
    let mut idle = Vec::new();
    loop {
        let on = |body: usize, ends: &[Place; 2]| {
            let own = |end: &Place| matches!(end, Place::Body(other, _) if *other == body);
            ends.iter().any(own)
        };
        let end = open
            .iter()
            .position(|body| joints.iter().filter(|ends| on(*body, ends)).count() < 2);
        let Some(end) = end else {
            return idle;
        };
        let body = open.swap_remove(end);
        joints.retain(|ends| !on(body, ends));
        idle.push(body);
    }
}
