//! Hinge (revolute, pin): one rotation about a shared axis.
//!
//! ```text
//! Φ = [ d ; u1·a2 ; v1·a2 ]     5 rows [m m m 1 1]; u, v complete the axis a (z: x, y)     (1)
//! s = 0, R12 = turn(a, θ); H = [0; a], b = 0                                               (2)
//! ```
//!
//! Source: Kamman, Connecting Joints I: hinge, 1 freedom. Both attitude rows also hold for a2 = −a1: the start must satisfy a1·a2 > 0.
//! Rejected: a1 × a2 = 0, three rows of rank 2; and rows in angular velocities alone, whose misalignment cannot be projected away.

use serde::{Deserialize, Serialize};

use super::motion::write;
use super::{Axis, Carried, Coordinate, Fields, JointDefinition, Pose, Relative, Twist};
use crate::Real;
use crate::rows::{Ends, Rows};

/// A door hinge, a wheel axle: 1 freedom, the angle about the axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Hinge {
    /// The axis, the same components in both joint frames.
    pub axis: Axis,
}

impl JointDefinition for Hinge {
    const FREEDOMS: usize = 1;
    const SUMMARY: &'static str = "one rotation about `axis`";

    fn read(fields: &mut dyn Fields) -> Self {
        Hinge {
            axis: fields.axis("axis", Axis::Z),
        }
    }

    fn constrain<S: Real>(&self, ends: &Ends<'_, S>, rows: &mut Rows<S>) {
        rows.coincide(ends);
        for u in self.axis.complement() {
            rows.perpendicular(ends, &u, &self.axis);
        }
    }

    fn carried<S: Real>(&self, ends: &Ends<'_, S>, _own: bool) -> Option<Carried<S>> {
        Some(Carried::coincide().turns(ends, &self.axis))
    }

    fn about_z(&self) -> Option<(Self, Axis)> {
        Some((Hinge { axis: Axis::Z }, self.axis))
    }

    fn motion<S: Real>(&self, at: &Relative<'_, S>) -> Pose<S> {
        Pose {
            rotation: self.axis.turn(at.q(0)),
            ..Pose::identity()
        }
    }

    fn subspace<S: Real>(&self, _at: &Relative<'_, S>, columns: &mut [Twist<S>]) {
        write(columns, [Twist::spin(self.axis.vector())]);
    }

    fn coordinate(&self, index: usize) -> Option<Coordinate> {
        (index == 0).then(|| Coordinate::turn("angle", "angle_rate", self.axis))
    }

    fn branch<S: Real>(&self, ends: &Ends<'_, S>) -> [S; 3] {
        [ends.cosine(&self.axis, &self.axis), S::one(), S::one()]
    }
}
