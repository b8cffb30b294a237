//! Motors that drive a loop as far as it reaches: beyond a dead centre no coordinates of the others close it.

use super::{JointStart, PlacementError, place, touched};
use crate::evaluate::{Scratch, driven_coordinates, evaluate};
use crate::laws::numbers::Numbers;
use crate::tree::Absolute;
use crate::{Arguments, Layout, Part, Quantity, Scene, StartFrom};

/// A loop that motors have driven as far as it reaches.
#[derive(Clone, Debug, PartialEq)]
pub struct BeyondReach {
    /// The coordinates that motors drive there, by their names.
    pub motors: Vec<String>,
    /// The joint that would come apart, by name.
    pub joint: String,
}

/// Whether loops that close in a state, at `now`, close no more where the courses of their motors have these `ahead`. Both are searched for in the same
/// way, from the coordinates in the state on, so that a search that finds nothing blames no motor. What follows declared states, as motors behind filters
/// do, is where the state has it.
#[must_use]
pub fn beyond_reach(
    scene: &Scene,
    layout: &Layout,
    [now, ahead]: [StartFrom<'_>; 2],
    state: &[f64],
) -> Option<BeyondReach> {
    if layout.tree.is_some() {
        let absolute = Absolute::of(scene);
        let placed = absolute.state((scene, layout), now, state);
        return beyond_reach(&absolute.scene, &absolute.layout, [now, ahead], &placed);
    }
    let numbers = Numbers::new(scene, now.params);
    let scratch = &mut Scratch::new(layout);
    let there = Arguments::before_a_run(scene, layout, ahead, state);
    let driven = driven_coordinates(scene, layout, &numbers, &there.at(), scratch);
    let known = |start: &JointStart| start.value.is_some_and(f64::is_finite);
    if driven.is_empty() || !driven.iter().all(known) {
        return None;
    }
    let here = Arguments::before_a_run(scene, layout, now, state);
    let what = Quantity::Coordinates;
    let mut told = vec![0.0; layout.len(what)];
    evaluate(
        what,
        scene,
        layout,
        &numbers,
        &here.at(),
        scratch,
        &mut told,
    );
    let all = scene
        .joints
        .iter()
        .enumerate()
        .flat_map(|(joint, declared)| {
            let own = 0..declared.law.measured().count();
            own.map(move |coordinate| (joint, coordinate))
        });
    // A value and its rate of each coordinate.
    let near = all
        .zip(told.chunks(2))
        .map(|((joint, coordinate), told)| JointStart {
            joint,
            coordinate,
            value: told.first().copied(),
            rate: None,
            about: true,
        });
    let near: Vec<JointStart> = near.collect();
    let open = |from| place(scene, layout, from, &near, &[], &mut state.to_vec()).err();
    let (None, Some(PlacementError::Open { joint, .. })) = (open(now), open(ahead)) else {
        return None;
    };
    let ends = layout.joints[joint].ends.iter().copied().flatten();
    let mechanism = touched(layout, &[], &ends.collect::<Vec<Part>>());
    let of_mechanism = driven.iter().filter(|start| {
        let mut ends = layout.joints[start.joint].ends.iter().flatten();
        ends.any(|end| mechanism.contains(end))
    });
    let motors = of_mechanism.map(|start| scene.coordinate_name(start.joint, start.coordinate));
    Some(BeyondReach {
        motors: motors.collect(),
        joint: scene.joints[joint].name.clone(),
    })
}
