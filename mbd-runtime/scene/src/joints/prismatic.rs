//! Prismatic (slider): one translation along a shared axis.
//!
//! ```text
//! Φ = [ u1·d ; v1·d ; u1·v2 ; v1·a2 ; a1·u2 ]     5 rows [m m 1 1 1]; u, v complete the axis a (z: x, y)     (1)
//! s = s a, R12 = I; H = [a; 0], b = 0                                                                        (2)
//! ```
//!
//! Source: Kamman, Connecting Joints I: prismatic, 1 freedom. The lock rows have eight roots, all of full rank: the start must satisfy
//! u1·u2, v1·v2, a1·a2 > 0. Rejected: in-plane rows with the parent's arm s1 in place of e, wrong by the slide.

use serde::{Deserialize, Serialize};

use super::motion::write;
use super::{Axis, Carried, Coordinate, Fields, JointDefinition, Pose, Relative, Twist};
use crate::Real;
use crate::rows::{Ends, Rows};

/// A slider on a rail: 1 freedom, the displacement along the axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Prismatic {
    /// The axis, the same components in both joint frames.
    pub axis: Axis,
}

impl Prismatic {
    fn axes(&self) -> [Axis; 3] {
        let [u, v] = self.axis.complement();
        [u, v, self.axis]
    }
}

impl JointDefinition for Prismatic {
    const FREEDOMS: usize = 1;
    const SUMMARY: &'static str = "one translation along `axis`";

    fn read(fields: &mut dyn Fields) -> Self {
        Prismatic {
            axis: fields.axis("axis", Axis::Z),
        }
    }

    fn constrain<S: Real>(&self, ends: &Ends<'_, S>, rows: &mut Rows<S>) {
        for u in self.axis.complement() {
            rows.in_plane(ends, &u);
        }
        rows.lock(ends, self.axes());
    }

    fn carried<S: Real>(&self, ends: &Ends<'_, S>, _own: bool) -> Option<Carried<S>> {
        let across = Carried::in_planes(ends, &self.axis.complement());
        Some(across.locks(ends, self.axes()).slides(ends, &self.axis))
    }

    fn about_z(&self) -> Option<(Self, Axis)> {
        Some((Prismatic { axis: Axis::Z }, self.axis))
    }

    fn motion<S: Real>(&self, at: &Relative<'_, S>) -> Pose<S> {
        Pose {
            position: self.axis.vector::<S>().map(|x| at.q(0) * x),
            ..Pose::identity()
        }
    }

    fn subspace<S: Real>(&self, _at: &Relative<'_, S>, columns: &mut [Twist<S>]) {
        write(columns, [Twist::slide(self.axis.vector())]);
    }

    fn coordinate(&self, index: usize) -> Option<Coordinate> {
        (index == 0).then(|| Coordinate::slide("slide", "slide_rate", self.axis))
    }

    fn branch<S: Real>(&self, ends: &Ends<'_, S>) -> [S; 3] {
        self.axes().map(|axis| ends.cosine(&axis, &axis))
    }
}
