//! Point on a plane: a ball on a table.
//!
//! ```text
//! Φ = a1·d     1 row [m]; a the normal, fixed in the parent                                             (1)
//! s = x u + y v, R12(quaternion); speeds ẋ, ẏ, ω2 in frame 2; H = [u, v, 0; 0, 0, R12], b = 0           (2)
//! ```
//!
//! u, v complete the normal (z: x, y). Source: derived, one in-plane row; 5 freedoms. Never singular, one branch.
//! Rejected: a one-sided contact, which is no joint but a load.

use serde::{Deserialize, Serialize};

use super::motion::{attitude_columns, write};
use super::{Axis, Coordinate, Fields, JointDefinition, Pose, Relative, Twist};
use crate::Real;
use crate::rows::{Ends, Rows};

/// A ball on a table: 5 freedoms, two ways in the plane, then the attitude.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PointOnPlane {
    /// The normal of the plane, fixed in the parent.
    pub axis: Axis,
}

impl JointDefinition for PointOnPlane {
    const FREEDOMS: usize = 5;
    const COORDINATES: usize = 6;
    const SUMMARY: &'static str =
        "a point of the child stays in the plane of the parent normal to `axis`";
    const AXES: [bool; 2] = [true, false];

    fn read(fields: &mut dyn Fields) -> Self {
        PointOnPlane {
            axis: fields.axis("axis", Axis::Z),
        }
    }

    fn constrain<S: Real>(&self, ends: &Ends<'_, S>, rows: &mut Rows<S>) {
        rows.in_plane(ends, &self.axis);
    }

    fn motion<S: Real>(&self, at: &Relative<'_, S>) -> Pose<S> {
        let [u, v] = self.axis.complement().map(|axis| axis.vector::<S>());
        Pose {
            position: u.map(|x| at.q(0) * x) + v.map(|x| at.q(1) * x),
            rotation: at.attitude(2),
        }
    }

    fn subspace<S: Real>(&self, at: &Relative<'_, S>, columns: &mut [Twist<S>]) {
        let [u, v] = self.axis.complement().map(|axis| axis.vector());
        write(columns, [Twist::slide(u), Twist::slide(v)]);
        attitude_columns(&at.attitude(2), 2, columns);
    }

    fn rates<S: Real>(&self, at: &Relative<'_, S>, rates: &mut [S]) {
        for (index, rate) in rates.iter_mut().take(2).enumerate() {
            *rate = at.u(index);
        }
        at.attitude_rates(2, 2, rates);
    }

    fn coordinate(&self, index: usize) -> Option<Coordinate> {
        let [u, v] = self.axis.complement();
        match index {
            0 => Some(Coordinate::slide("x", "x_rate", u)),
            1 => Some(Coordinate::slide("y", "y_rate", v)),
            _ => None,
        }
    }
}
