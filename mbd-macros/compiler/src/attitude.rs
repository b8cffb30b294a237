//! `coordinates: auto`: bodies that are points with mass to all that a declaration says.
//!
//! Such a body floats, and everything ends at its centre of mass: nothing turns it, and nothing depends on how it is turned or asks for it. Its declaration
//! is read as that of a point with mass, so that what a point does not have is told by who reads it.

use std::collections::BTreeSet;

use mbd_scene::{Formula, Joint, JointLaw, LoadKind, Part, Place, Scene};

use crate::describe;
use crate::resolve::Resolver;
use crate::syntax::{Item, ModelSyntax};

/// The fields of a body that a point with mass has, too.
const OF_POINTS: [&str; 2] = ["mass", "start"];

/// A model of which some bodies are points, and the names of these.
pub struct WithPoints<'a> {
    /// The model.
    pub model: ModelSyntax<'a>,
    /// The names.
    pub names: Vec<String>,
}

impl<'a> WithPoints<'a> {
    /// The model with every body a point that may be one; `None` where there is none.
    pub fn of(model: &ModelSyntax<'a>, resolver: &Resolver<'_>) -> Option<Self> {
        let scene = &resolver.scene;
        let turns = bodies_that_turn(scene);
        let among = |word: &str, is_meant: &dyn Fn(usize) -> bool| -> BTreeSet<String> {
            let instances = || resolver.of(word).into_iter();
            let name = |item: &Item<'_>| item.name.as_ref().map(|name| name.word.text.clone());
            let others: BTreeSet<String> = instances()
                .filter(|instance| !is_meant(instance.slot))
                .filter_map(|instance| name(instance.item))
                .collect();
            let all = instances().filter_map(|instance| name(instance.item));
            all.filter(|name| !others.contains(name)).collect()
        };
        let points = among("body", &|body| !turns.contains(&body));
        // A point needs no joint to float.
        let frees = among("joint", &|joint| {
            let joint = scene.joints.get(joint);
            joint.is_some_and(|joint| {
                is_free(joint) && body_of(joint.child).is_some_and(|body| !turns.contains(&body))
            })
        });
        let mut reduced = model.clone();
        reduced.items.retain(|item| {
            let name = item.name.as_ref();
            item.word.text != "joint" || name.is_none_or(|name| !frees.contains(&name.word.text))
        });
        for item in &mut reduced.items {
            let name = item.name.as_ref();
            let is_point = name.is_some_and(|name| points.contains(&name.word.text));
            if item.word.text == "body" && is_point {
                item.word.text = "point".to_owned();
                item.block
                    .retain(|field| OF_POINTS.contains(&field.word.text.as_str()));
            }
        }
        (!points.is_empty()).then(|| WithPoints {
            model: reduced,
            names: points.into_iter().collect(),
        })
    }
}

fn body_of(place: Place) -> Option<usize> {
    match place {
        Place::Body(body, _) => Some(body),
        Place::World(_) | Place::Point(_) => None,
    }
}

/// Whether a joint only says that a body floats.
fn is_free(joint: &Joint) -> bool {
    let from_world = matches!(joint.parent, Place::World(_));
    matches!(joint.law, JointLaw::Free(_)) && from_world && joint.forces.is_empty()
}

/// The bodies that something may turn, or of which something asks how they are turned.
fn bodies_that_turn(scene: &Scene) -> BTreeSet<usize> {
    let mut turning = BTreeSet::new();
    let off_centre = |place: Place| match place {
        Place::Body(body, 1..) => Some(body),
        _ => None,
    };
    for line in &scene.lines {
        turning.extend([line.from, line.to].into_iter().filter_map(off_centre));
    }
    for joint in &scene.joints {
        let ends = [joint.parent, joint.child].into_iter();
        match (is_free(joint), &joint.law) {
            (true, _) | (false, JointLaw::Distance(_)) => {
                turning.extend(ends.filter_map(off_centre))
            }
            _ => turning.extend(ends.filter_map(body_of)),
        }
    }
    for load in &scene.loads {
        turning.extend(match load.kind {
            LoadKind::Force(_) => off_centre(load.at),
            LoadKind::Torque(_) | LoadKind::External => body_of(load.at),
        });
    }
    for start in &scene.starts.parts {
        if let (Part::Body(body), true) = (
            start.part,
            start.rotation.is_some() || start.angular_velocity.is_some(),
        ) {
            turning.insert(body);
        }
    }
    // What is drawn of a body is drawn along its axes; what another scene begins with has an attitude.
    turning.extend(scene.shapes.iter().map(|shape| shape.body));
    if scene
        .events
        .iter()
        .any(|event| event.actions.next.is_some())
    {
        turning.extend(0..scene.bodies.len());
    }
    describe::rewrite(&mut scene.clone(), &mut |formula| {
        turning.extend(match formula {
            Formula::Orientation(body)
            | Formula::AngularVelocityWorld(body)
            | Formula::AngularVelocityBody(body)
            | Formula::AngularAcceleration(body) => Some(*body),
            Formula::Axis(place, _) => body_of(*place),
            Formula::Position(place) | Formula::Velocity(place) | Formula::Acceleration(place) => {
                off_centre(*place)
            }
            _ => None,
        });
    });
    turning
}
