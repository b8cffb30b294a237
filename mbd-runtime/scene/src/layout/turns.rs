//! Which angles count turns: those in (−π, π] by the attitudes of their ends, where anything of a run reads them.

use crate::event::Setting;
use crate::joints::JointForces;
use crate::scene::{LoadKind, Scene};
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
    for formula in read_by_runs(scene) {
        formula.walk(&mut |part| {
            if let Formula::Coordinate(joint, number) = *part {
                read.push((joint, number));
            }
        });
    }
    angles.retain(|angle| read.contains(angle));
    angles
}

/// The formulas that may depend on the state.
fn read_by_runs(scene: &Scene) -> impl Iterator<Item = &Formula> {
    let lets = scene.lets.iter().map(|named| &named.value);
    let rates = scene.states.iter().map(|state| &state.rate);
    let outputs = scene.outputs.iter().map(|output| &output.value);
    let guards = scene.events.iter().map(|event| &event.guard);
    let settings = scene.events.iter().flat_map(|event| &event.actions.set);
    let set = settings.map(|setting: &Setting| &setting.value);
    let loads = scene.loads.iter().filter_map(|load| match &load.kind {
        LoadKind::Force(formula) | LoadKind::Torque(formula) => Some(formula),
        _ => None,
    });
    let lengths = scene.lines.iter().map(|line| &line.free_length);
    let forces = scene.joints.iter().flat_map(|joint| &joint.forces);
    let driven = forces.flat_map(|forces| {
        let command = forces.filter.as_ref().map(|filter| &filter.command);
        [forces.force.as_ref(), forces.motor.as_ref(), command]
    });
    lets.chain(rates)
        .chain(outputs)
        .chain(guards)
        .chain(set)
        .chain(loads)
        .chain(lengths)
        .chain(driven.flatten())
}
