//! Full turns of an angle that the attitudes of its ends tell up to full turns only.
//!
//! ```text
//! θ = ϑ + 2π ⌊(θ_n − ϑ)/2π + ½⌋      ϑ = atan2(S, C) in (−π, π], θ_n the angle at the last step                  (1)
//! ```
//!
//! The angle next to the last one, so that springs wind up, stops are no passage, and controllers see what relative coordinates have in their
//! state. Exact while a step turns by less than half a turn. Rejected: counting the passages of ±π, which a stage passes that a step does not.

use std::f64::consts::TAU;

use crate::Real;
use crate::laws::evaluation::Evaluation;

/// An angle next to another one, by (1) [rad].
pub fn next_to(angle: f64, last: f64) -> f64 {
    angle + TAU * ((last - angle) / TAU + 0.5).floor()
}

impl<S: Real> Evaluation<'_, S> {
    /// An angle in (−π, π] with the turns that were counted, by (1).
    pub(crate) fn with_turns(&self, joint: usize, coordinate: usize, angle: S) -> S {
        let Some(place) = self.layout.turn_of(joint, coordinate) else {
            return angle;
        };
        let last = self.at.hold.get(place).copied();
        let last = last.unwrap_or_else(S::zero);
        let turns = (last - angle) * S::from_f64(1.0 / TAU) + S::from_f64(0.5);
        angle + turns.floor().label("turns") * S::from_f64(TAU)
    }
}
