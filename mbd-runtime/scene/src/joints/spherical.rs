//! Spherical (ball and socket): three rotations about a shared point.
//!
//! ```text
//! Φ = d     3 rows [m m m]                                                      (1)
//! s = 0, R12(quaternion); u = ω2 in frame 2; H = [0; R12], b = 0                (2)
//! ```
//!
//! Source: Kamman, Connecting Joints I: spherical, 3 freedoms. Never singular, one branch. Rejected: three angles, which lock.

use serde::{Deserialize, Serialize};

use super::motion::attitude_columns;
use super::{Axis, Carried, Fields, JointDefinition, Pose, Relative, Twist};
use crate::Real;
use crate::rows::{Ends, Rows};

/// A ball and its socket: 3 freedoms.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spherical {}

impl JointDefinition for Spherical {
    const FREEDOMS: usize = 3;
    const COORDINATES: usize = 4;
    const SUMMARY: &'static str = "three rotations about a shared point";
    const AXES: [bool; 2] = [false; 2];

    fn read(_fields: &mut dyn Fields) -> Self {
        Spherical {}
    }

    fn constrain<S: Real>(&self, ends: &Ends<'_, S>, rows: &mut Rows<S>) {
        rows.coincide(ends);
    }

    fn carried<S: Real>(&self, _ends: &Ends<'_, S>, _own: bool) -> Option<Carried<S>> {
        let mut carried = Carried::coincide();
        let axes = [Axis::X, Axis::Y, Axis::Z];
        carried
            .free
            .extend(axes.map(|axis| Twist::spin(axis.vector())));
        carried.bias = Some(Twist::zero());
        Some(carried)
    }

    fn motion<S: Real>(&self, at: &Relative<'_, S>) -> Pose<S> {
        Pose {
            rotation: at.attitude(0),
            ..Pose::identity()
        }
    }

    fn subspace<S: Real>(&self, at: &Relative<'_, S>, columns: &mut [Twist<S>]) {
        attitude_columns(&at.attitude(0), 0, columns);
    }

    fn rates<S: Real>(&self, at: &Relative<'_, S>, rates: &mut [S]) {
        at.attitude_rates(0, 0, rates);
    }
}
