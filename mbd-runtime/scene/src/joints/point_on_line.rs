//! Point on a line: a ball in a groove.
//!
//! ```text
//! Φ = [ u1·d ; v1·d ]     2 rows [m m]; u, v complete the axis a of the parent (z: x, y)       (1)
//! s = s a, R12(quaternion); speeds ṡ, ω2 in frame 2; H = [a, 0; 0, R12], b = 0                 (2)
//! ```
//!
//! Source: derived, the two in-plane rows of a cylindrical joint; 4 freedoms. Never singular, one branch.
//! Rejected: a1 × d = 0, three rows of rank 2.

use serde::{Deserialize, Serialize};

use super::motion::{attitude_columns, write};
use super::{Axis, Coordinate, Fields, JointDefinition, Pose, Relative, Twist};
use crate::Real;
use crate::rows::{Ends, Rows};

/// A ball in a groove: 4 freedoms, the displacement along the line, then the attitude.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PointOnLine {
    /// The direction of the line, fixed in the parent.
    pub axis: Axis,
}

impl JointDefinition for PointOnLine {
    const FREEDOMS: usize = 4;
    const COORDINATES: usize = 5;
    const SUMMARY: &'static str = "a point of the child stays on a line of the parent along `axis`";
    const AXES: [bool; 2] = [true, false];

    fn read(fields: &mut dyn Fields) -> Self {
        PointOnLine {
            axis: fields.axis("axis", Axis::Z),
        }
    }

    fn constrain<S: Real>(&self, ends: &Ends<'_, S>, rows: &mut Rows<S>) {
        for u in self.axis.complement() {
            rows.in_plane(ends, &u);
        }
    }

    fn motion<S: Real>(&self, at: &Relative<'_, S>) -> Pose<S> {
        Pose {
            position: self.axis.vector::<S>().map(|x| at.q(0) * x),
            rotation: at.attitude(1),
        }
    }

    fn subspace<S: Real>(&self, at: &Relative<'_, S>, columns: &mut [Twist<S>]) {
        write(columns, [Twist::slide(self.axis.vector())]);
        attitude_columns(&at.attitude(1), 1, columns);
    }

    fn rates<S: Real>(&self, at: &Relative<'_, S>, rates: &mut [S]) {
        if let Some(rate) = rates.first_mut() {
            *rate = at.u(0);
        }
        at.attitude_rates(1, 1, rates);
    }

    fn coordinate(&self, index: usize) -> Option<Coordinate> {
        (index == 0).then(|| Coordinate::slide("slide", "slide_rate", self.axis))
    }
}
