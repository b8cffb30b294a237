//! Joint coordinates as functions of the state.
//!
//! ```text
//! rate = c v + c_t,   acceleration = c v̇ − γ_c        c, c_t, γ_c: the coordinate as a row                        (1)
//! ```

use nalgebra::Vector3;

use crate::laws::evaluation::Evaluation;
use crate::{Part, Real};

/// Writes value, rate and acceleration of every measured coordinate by (1); numbers that are not finite where a joint has an end on a point without
/// mass.
pub(super) fn coordinates<S: Real>(evaluation: &Evaluation<'_, S>, out: &mut [S]) {
    let (scene, layout) = (evaluation.scene, evaluation.layout);
    let (directions, components) = (layout.directions, scene.angular_velocity);
    let given = evaluation.at.rows;
    let mut slots = out.chunks_exact_mut(3);
    for (index, joint) in scene.joints.iter().enumerate() {
        S::section(&joint.name);
        let ends = evaluation.ends(index, components);
        for coordinate in joint.law.measured() {
            let Some(slot) = slots.next() else { return };
            let Some(ends) = &ends else {
                slot.fill(S::from_f64(f64::NAN));
                continue;
            };
            let mut row = ends.row(&coordinate);
            row.prescribe(ends);
            let (mut rate, mut acceleration) = (row.time, -row.bias);
            for (part, columns) in row.parts(&layout.joints[index].ends) {
                let Some((first, velocities)) = evaluation.speeds_of(part, components) else {
                    continue;
                };
                rate += columns.rate(&velocities);
                if !given.is_empty() {
                    let angular = match part {
                        Part::Body(_) => directions.angular(given, first),
                        _ => Vector3::zeros(),
                    };
                    acceleration += columns.rate(&[directions.linear(given, first), angular]);
                }
            }
            slot.copy_from_slice(&[ends.value(&coordinate), rate, acceleration]);
        }
    }
}
