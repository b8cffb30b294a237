//! Lock: a coordinate of a joint stays where it is. No joint that a declaration names: events lock and free coordinates, `{ lock: boom.angle }`.
//!
//! ```text
//! Φ = x − c     1 row [m or rad], modulo 2π of an angle that jumps by full turns; c is x where it was locked            (1)
//! ```
//!
//! c is no number of the scene: it is in [`At::hold`](crate::At::hold), behind what may be detached. Where nobody says it, x itself is taken, so that (1)
//! holds: for ranks, which depend on Φ_v alone. The multiplier is the force or the torque along x that holds it. Source: derived.
//! Rejected: a motor whose course is a state of its own: two more numbers of the state for a number that changes at instants only.

use serde::{Deserialize, Serialize};

use super::{Fields, JointDefinition, Relation};
use crate::Real;

/// A joint coordinate that an event locks: takes one freedom while it is attached.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lock {
    /// x: joint and number of the coordinate.
    pub couples: [(usize, usize); 1],
}

impl JointDefinition for Lock {
    const FREEDOMS: usize = 5;
    const COORDINATES: usize = 0;
    const SUMMARY: &'static str = "a coordinate of a joint stays where an event locked it";

    fn read(fields: &mut dyn Fields) -> Self {
        let [coordinate, _] = fields.coordinates();
        Lock {
            couples: [coordinate],
        }
    }

    fn couples(&self) -> &[(usize, usize)] {
        &self.couples
    }

    fn relation<S: Real>(&self, _numbers: &[S]) -> Option<Relation<S>> {
        Some(Relation::new([S::one()], S::zero()))
    }
}
