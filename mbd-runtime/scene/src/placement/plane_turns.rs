//! In a plane the state of a body counts turns, and a joint between two bodies begins with those that they have between them.
//!
//! ```text
//! φ = ϑ + 2π ⌊(±(θ_2 − θ_1) − ϑ)/2π + ½⌋     where |θ_2 − θ_1| > π and |θ_1| or |θ_2| > π, ϑ in (−π, π], + where the axis points along the normal          (1)
//! ```
//!
//! Bodies within half a turn of each other say nothing about turns: how a joint hangs may be as far around. Nor do attitudes within half a turn of the
//! world's: 170° and −170° are 20° apart, in the plane as in space. Nor do bodies that a tree of joints carries
//! about what closes its loops: their turns are those of the joints between, three times 120° around a triangle. Derived.

use std::f64::consts::PI;

use nalgebra::Vector3;

use super::JointStart;
use crate::laws::Numbers;
use crate::laws::turns::next_to;
use crate::{Layout, Part, Place, Relative, Scene, Tree, Twist};

/// Where the angles whose turns are counted begin by (1), of joints between bodies that are turns apart; `measured`: ϑ of a joint and its coordinate [rad].
pub(crate) fn by_bodies(
    (scene, layout): (&Scene, &Layout),
    numbers: &Numbers<f64>,
    state: &[f64],
    measured: &dyn Fn((usize, usize)) -> f64,
) -> Vec<JointStart> {
    let tree = Tree::span(scene);
    let start = |&(joint, coordinate): &(usize, usize)| {
        let declared = scene.joints.get(joint)?;
        let ends = [declared.parent, declared.child];
        let own = tree.carried(joint).is_some() || ends.iter().all(|end| floats(&tree, *end));
        if !own {
            return None;
        }
        let [from, to] = ends.map(|place| angle(layout, place, state));
        let between = to? - from?;
        let along = along_normal((scene, layout), numbers, (joint, coordinate))?;
        let value = next_to(measured((joint, coordinate)), along.signum() * between);
        let counts_turns = [from?, to?].iter().any(|angle| angle.abs() > PI);
        (counts_turns && between.abs() > PI && along != 0.0).then_some(JointStart {
            joint,
            coordinate,
            value: Some(value),
            rate: None,
            about: true,
        })
    };
    layout.turns.iter().filter_map(start).collect()
}

/// Whether no joint of the tree carries the body of a place: that of the world never moves.
fn floats(tree: &Tree, place: Place) -> bool {
    match place {
        Place::World(_) | Place::Point(_) => true,
        Place::Body(body, _) => {
            let link = tree
                .of_body
                .get(body)
                .and_then(|&link| tree.links.get(link));
            link.is_some_and(|link| link.joint.is_none())
        }
    }
}

/// The angle of a body in the state [rad]; the world has none.
fn angle(layout: &Layout, place: Place, state: &[f64]) -> Option<f64> {
    layout.directions.plane?;
    match place {
        Place::World(_) => Some(0.0),
        Place::Body(body, _) => {
            let slots = layout.own_slots(Part::Body(body))?;
            state.get(slots.q + 2).copied()
        }
        Place::Point(_) => None,
    }
}

/// How far the axis of a coordinate points along the normal of the plane, by its frame on the parent.
fn along_normal(
    (scene, layout): (&Scene, &Layout),
    numbers: &Numbers<f64>,
    (joint, coordinate): (usize, usize),
) -> Option<f64> {
    let plane = layout.directions.plane?;
    let declared = scene.joints.get(joint)?;
    let frame = match declared.parent {
        Place::World(frame) => numbers.world_frames.get(frame)?,
        Place::Body(body, frame) => numbers.bodies.get(body)?.frames.get(frame)?,
        Place::Point(_) => return None,
    };
    let zero = vec![0.0; declared.law.freedoms()];
    let at = Relative {
        q: &zero,
        u: &zero,
        numbers: numbers.joints.get(joint)?,
    };
    let mut columns = vec![Twist::zero(); declared.law.freedoms()];
    declared.law.subspace(&at, &mut columns);
    let axis: Vector3<f64> = columns.get(coordinate)?.angular;
    let axis = frame.rotation.map_or(axis, |rotation| rotation * axis);
    Some(axis[plane.normal()])
}
