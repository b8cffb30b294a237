//! Cylindrical (sleeve on a shaft): a translation along an axis and a rotation about it.
//!
//! ```text
//! Φ = [ u1·d ; v1·d ; u1·a2 ; v1·a2 ]     4 rows [m m 1 1]; u, v complete the axis a (z: x, y)     (1)
//! s = s a, R12 = turn(a, θ); speeds ṡ, θ̇; H = [a, 0; 0, a], b = 0                                  (2)
//! ```
//!
//! Source: Kamman, Connecting Joints I: cylindrical, 2 freedoms. The attitude rows also hold for a2 = −a1: the start must satisfy
//! a1·a2 > 0. Rejected: two points on a line, which are singular when they meet.

use serde::{Deserialize, Serialize};

use super::motion::write;
use super::{Axis, Carried, Coordinate, Fields, JointDefinition, Pose, Relative, Twist};
use crate::Real;
use crate::rows::{Ends, Rows};

/// A sleeve on a shaft: 2 freedoms, the displacement along the axis, then the angle about it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Cylindrical {
    /// The axis, the same components in both joint frames.
    pub axis: Axis,
}

impl JointDefinition for Cylindrical {
    const FREEDOMS: usize = 2;
    const SUMMARY: &'static str = "a translation along `axis` and a rotation about it";

    fn read(fields: &mut dyn Fields) -> Self {
        Cylindrical {
            axis: fields.axis("axis", Axis::Z),
        }
    }

    fn constrain<S: Real>(&self, ends: &Ends<'_, S>, rows: &mut Rows<S>) {
        for u in self.axis.complement() {
            rows.in_plane(ends, &u);
        }
        for u in self.axis.complement() {
            rows.perpendicular(ends, &u, &self.axis);
        }
    }

    fn carried<S: Real>(&self, ends: &Ends<'_, S>, _own: bool) -> Option<Carried<S>> {
        let across = Carried::in_planes(ends, &self.axis.complement());
        Some(across.slides(ends, &self.axis).turns(ends, &self.axis))
    }

    fn about_z(&self) -> Option<(Self, Axis)> {
        Some((Cylindrical { axis: Axis::Z }, self.axis))
    }

    fn motion<S: Real>(&self, at: &Relative<'_, S>) -> Pose<S> {
        Pose {
            position: self.axis.vector::<S>().map(|x| at.q(0) * x),
            rotation: self.axis.turn(at.q(1)),
        }
    }

    fn subspace<S: Real>(&self, _at: &Relative<'_, S>, columns: &mut [Twist<S>]) {
        let axis = self.axis.vector();
        write(columns, [Twist::slide(axis), Twist::spin(axis)]);
    }

    fn coordinate(&self, index: usize) -> Option<Coordinate> {
        match index {
            0 => Some(Coordinate::slide("slide", "slide_rate", self.axis)),
            1 => Some(Coordinate::turn("angle", "angle_rate", self.axis)),
            _ => None,
        }
    }

    fn branch<S: Real>(&self, ends: &Ends<'_, S>) -> [S; 3] {
        [ends.cosine(&self.axis, &self.axis), S::one(), S::one()]
    }
}
