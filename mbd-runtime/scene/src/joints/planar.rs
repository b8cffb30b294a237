//! Planar: two translations in a plane and a rotation about its normal.
//!
//! ```text
//! Φ = [ a1·d ; u1·a2 ; v1·a2 ]     3 rows [m 1 1]; a the normal; u, v complete it (z: x, y)        (1)
//! s = x u + y v, R12 = turn(a, θ); speeds ẋ, ẏ, θ̇; H = [u, v, 0; 0, 0, a], b = 0                   (2)
//! ```
//!
//! Source: derived like the table of Kamman, Connecting Joints I; 3 freedoms. The attitude rows also hold for a2 = −a1: the start must
//! satisfy a1·a2 > 0. Rejected: three points in a plane, whose rank depends on where they are.

use serde::{Deserialize, Serialize};

use super::motion::write;
use super::{Axis, Carried, Coordinate, Fields, JointDefinition, Pose, Relative, Twist};
use crate::Real;
use crate::rows::{Ends, Rows};

/// A puck on a table: 3 freedoms, two ways in the plane, then the angle about the normal.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Planar {
    /// The normal of the plane, the same components in both joint frames.
    pub axis: Axis,
}

impl JointDefinition for Planar {
    const FREEDOMS: usize = 3;
    const SUMMARY: &'static str =
        "two translations in the plane normal to `axis` and a rotation about it";

    fn read(fields: &mut dyn Fields) -> Self {
        Planar {
            axis: fields.axis("axis", Axis::Z),
        }
    }

    fn constrain<S: Real>(&self, ends: &Ends<'_, S>, rows: &mut Rows<S>) {
        rows.in_plane(ends, &self.axis);
        for u in self.axis.complement() {
            rows.perpendicular(ends, &u, &self.axis);
        }
    }

    fn carried<S: Real>(&self, ends: &Ends<'_, S>, _own: bool) -> Option<Carried<S>> {
        let [u, v] = self.axis.complement();
        let across = Carried::in_planes(ends, &[self.axis]);
        let within = across.slides(ends, &u).slides(ends, &v);
        Some(within.turns(ends, &self.axis))
    }

    fn motion<S: Real>(&self, at: &Relative<'_, S>) -> Pose<S> {
        let [u, v] = self.axis.complement().map(|axis| axis.vector::<S>());
        Pose {
            position: u.map(|x| at.q(0) * x) + v.map(|x| at.q(1) * x),
            rotation: self.axis.turn(at.q(2)),
        }
    }

    fn subspace<S: Real>(&self, _at: &Relative<'_, S>, columns: &mut [Twist<S>]) {
        let [u, v] = self.axis.complement().map(|axis| axis.vector());
        write(
            columns,
            [
                Twist::slide(u),
                Twist::slide(v),
                Twist::spin(self.axis.vector()),
            ],
        );
    }

    fn coordinate(&self, index: usize) -> Option<Coordinate> {
        let [u, v] = self.axis.complement();
        match index {
            0 => Some(Coordinate::slide("x", "x_rate", u)),
            1 => Some(Coordinate::slide("y", "y_rate", v)),
            2 => Some(Coordinate::turn("angle", "angle_rate", self.axis)),
            _ => None,
        }
    }

    fn branch<S: Real>(&self, ends: &Ends<'_, S>) -> [S; 3] {
        [ends.cosine(&self.axis, &self.axis), S::one(), S::one()]
    }
}
