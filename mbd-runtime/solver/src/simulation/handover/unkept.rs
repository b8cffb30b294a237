//! What does not go on as it was because the next model never changes it: a line, a spring or a joint that was detached and that holds there, a coordinate
//! that was locked and that moves there.
//!
//! A model has a switch for what its events detach, attach, lock or free, and for nothing else. What the next one has no switch for is as it declares it;
//! whether that is meant (a latch that closes) or forgotten only its author knows, so it is told.

use mbd_scene::{Detachable, Float, Scene};

use crate::simulation::ModelRun;
use crate::unilateral::Mode;

/// Everything that an event of a scene may name as detached or attached: lines and springs, then joints.
pub fn detachables(scene: &Scene) -> impl Iterator<Item = Detachable> {
    let lines = (0..scene.lines.len()).map(Detachable::Line);
    let joints = (0..scene.joints.len()).map(Detachable::Joint);
    lines.chain(joints)
}

/// Whether both are lines or springs, or both are joints.
pub fn alike(one: Detachable, other: Detachable) -> bool {
    matches!(one, Detachable::Line(_)) == matches!(other, Detachable::Line(_))
}

/// What was detached in the last run and holds in the next scene, and the coordinates that were locked and move there.
pub fn unkept<T: Float>(last: &ModelRun<T>, to: &Scene) -> [Vec<String>; 2] {
    let from = last.system.model.clone();
    let (scene, layout) = (from.scene(), from.layout());
    let (mut attached, mut freed) = (Vec::new(), Vec::new());
    for old in detachables(scene).filter(|&old| scene.is_detachable(old)) {
        let mode = layout.switch_of(old);
        let mode = mode.and_then(|at| last.system.modes().get(at));
        let is_detached = mode == Some(&Mode::Detached);
        match scene.locked(old) {
            Some(coordinate) if !is_detached && is_free(to, &coordinate) => freed.push(coordinate),
            Some(_) => {}
            None if is_detached => {
                let name = scene.detachable_name(old);
                let mut same = detachables(to)
                    .filter(|&new| alike(old, new) && to.detachable_name(new) == name);
                if same.any(|new| !to.is_detachable(new)) {
                    attached.push(name.to_owned());
                }
            }
            None => {}
        }
    }
    [attached, freed]
}

/// Whether a scene has this coordinate, `pin.angle`, and neither a lock nor a motor for it.
fn is_free(scene: &Scene, coordinate: &str) -> bool {
    scene.joints.iter().enumerate().any(|(index, joint)| {
        let named = |number: &usize| {
            let own = joint.law.coordinate(*number);
            own.is_some_and(|own| coordinate == format!("{}.{}", joint.name, own.name))
        };
        let Some(number) = (0..joint.law.coordinates()).find(named) else {
            return false;
        };
        let is_driven = joint.motors().any(|(driven, _)| driven == number);
        !is_driven && scene.lock_of(index, number).is_none()
    })
}
