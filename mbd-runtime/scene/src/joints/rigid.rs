//! Rigid (weld): no relative motion.
//!
//! ```text
//! Φ = [ d ; x1·y2 ; y1·z2 ; z1·x2 ]     6 rows [m m m 1 1 1]     (1)
//! s = 0, R12 = I                                                 (2)
//! ```
//!
//! Source: Kamman, Connecting Joints I: rigid, 0 freedoms. The three lock rows have eight roots, all of full rank: the start must
//! satisfy x1·x2, y1·y2, z1·z2 > 0. Rejected: the vector part of the relative quaternion, one branch less but a row of degree four.

use serde::{Deserialize, Serialize};

use super::{Axis, Carried, Fields, JointDefinition, Pose, Relative, Twist};
use crate::Real;
use crate::rows::{Ends, Rows};

/// A weld: 0 freedoms.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rigid {}

impl JointDefinition for Rigid {
    const FREEDOMS: usize = 0;
    const SUMMARY: &'static str = "a weld: nothing is allowed";

    fn read(_fields: &mut dyn Fields) -> Self {
        Rigid {}
    }

    fn constrain<S: Real>(&self, ends: &Ends<'_, S>, rows: &mut Rows<S>) {
        rows.coincide(ends);
        rows.lock(ends, [Axis::X, Axis::Y, Axis::Z]);
    }

    fn carried<S: Real>(&self, ends: &Ends<'_, S>, _own: bool) -> Option<Carried<S>> {
        Some(Carried::coincide().locks(ends, [Axis::X, Axis::Y, Axis::Z]))
    }

    fn motion<S: Real>(&self, _at: &Relative<'_, S>) -> Pose<S> {
        Pose::identity()
    }

    fn subspace<S: Real>(&self, _at: &Relative<'_, S>, _columns: &mut [Twist<S>]) {}

    fn branch<S: Real>(&self, ends: &Ends<'_, S>) -> [S; 3] {
        [Axis::X, Axis::Y, Axis::Z].map(|axis| ends.cosine(&axis, &axis))
    }
}
