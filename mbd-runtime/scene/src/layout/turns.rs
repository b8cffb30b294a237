//! Which angles count turns: those in (−π, π] by the attitudes of their ends, where anything of a run reads them.

use crate::joints::JointForces;
use crate::scene::Scene;
use crate::{Formula, Layout};

/// The angles, by joint and number of the coordinate, that a spring or a stop acts along, or that a formula reads. Links of the tree count turns by
/// themselves.
pub(super) fn counted(scene: &Scene, layout: &Layout) -> Vec<(usize, usize)> {
    let mut angles = Vec::new();
    for (joint, declared) in scene.joints.iter().enumerate() {
        let coordinates = 0..declared.law.measured().count();
        let periodic = coordinates.filter(|&number| {
            let coordinate = declared.law.coordinate(number);
            coordinate.is_some_and(|coordinate| coordinate.is_periodic())
        });
        if layout.carried(joint).is_none() {
            angles.extend(periodic.map(|number| (joint, number)));
        }
    }
    if angles.is_empty() {
        return angles;
    }
    let mut read = Vec::new();
    for (joint, declared) in scene.joints.iter().enumerate() {
        let acts = |forces: &&JointForces| {
            forces.stiffness.is_some() || forces.stops.iter().any(Option::is_some)
        };
        let acting = declared.forces.iter().filter(acts);
        read.extend(acting.map(|forces| (joint, forces.coordinate)));
    }
    for formula in scene.read_by_runs() {
        formula.walk(&mut |part| {
            if let Formula::Coordinate(joint, number) = *part {
                read.push((joint, number));
            }
        });
    }
    angles.retain(|angle| read.contains(angle));
    angles
}
