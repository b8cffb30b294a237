//! Random motions that obey every joint of a tree, couplings apart: joint coordinates first, bodies from them.

use mbd_scene::laws::Numbers;
use mbd_scene::{Place, Scene};
use nalgebra::Matrix3;

use crate::mechanism::{Coordinates, Instance, Seat, carried, state};
use crate::random::Random;

/// A random state of bodies that hang from the world or from a body declared before, each by one joint, parameters at their defaults.
///
/// # Panics
/// If a body hangs from nothing placed before it.
#[must_use]
pub fn obeying(scene: &Scene, random: &mut Random) -> Vec<f64> {
    let defaults: Vec<f64> = scene.params.iter().map(|param| param.default).collect();
    let numbers = Numbers::new(scene, &defaults);
    let seat = |place: Place| {
        let frame = match place {
            Place::World(frame) => &numbers.world_frames[frame],
            Place::Body(body, frame) => &numbers.bodies[body].frames[frame],
            Place::Point(_) => panic!("points carry nothing here"),
        };
        Seat {
            point: frame.position,
            frame: frame.rotation.unwrap_or_else(Matrix3::identity),
        }
    };
    let mut bodies: Vec<Option<Instance>> = vec![None; scene.bodies.len()];
    let joints = scene.joints.iter().zip(&numbers.joints);
    for (joint, own) in joints.filter(|(joint, _)| joint.law.couples().is_empty()) {
        let parent = match joint.parent {
            Place::Body(body, _) => bodies[body].expect("a parent declared before"),
            _ => Instance::rest(),
        };
        if let Place::Body(child, _) = joint.child {
            let at = Coordinates::random(&joint.law, own.clone(), random);
            let seats = [seat(joint.parent), seat(joint.child)];
            bodies[child] = Some(carried(&joint.law, seats, &parent, &at));
        }
    }
    let bodies: Vec<Instance> = bodies
        .into_iter()
        .map(|body| body.unwrap_or_else(|| Instance::random(random)))
        .collect();
    state(scene, &bodies, &[])
}
