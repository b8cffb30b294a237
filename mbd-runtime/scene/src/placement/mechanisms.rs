//! What hangs together by joints, without the world.

use super::JointStart;
use crate::{Layout, Part};

/// The parts of every mechanism of which something is given: a coordinate of one of its joints, or where one of its parts is. What is declared of all
/// others is nothing to what is given.
pub(crate) fn touched(layout: &Layout, given: &[JointStart], fixed: &[Part]) -> Vec<Part> {
    let moved = |joint: &[Option<Part>]| joint.iter().copied().flatten().collect::<Vec<Part>>();
    let joints = layout.joints.iter().map(|slots| moved(&slots.ends));
    let joints: Vec<Vec<Part>> = joints.collect();
    let of_joints = given.iter().filter_map(|start| joints.get(start.joint));
    let mut found: Vec<Part> = of_joints.flatten().chain(fixed).copied().collect();
    let mut next = 0;
    while let Some(&part) = found.get(next) {
        for joint in joints.iter().filter(|joint| joint.contains(&part)) {
            let others = joint.iter().filter(|end| !found.contains(end));
            let others: Vec<Part> = others.copied().collect();
            found.extend(others);
        }
        next += 1;
    }
    found
}
