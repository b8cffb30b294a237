//! Free: nothing is forbidden; it says that a body floats.
//!
//! ```text
//! Φ: no row                                                                                   (1)
//! s, R12(quaternion); u = [v2; ω2] in frame 2; H = [R12, 0; 0, R12], b = [R12 (ω2 × v2); 0]   (2)
//! ```
//!
//! Source: Kamman, Connecting Joints I: free, 6 freedoms. Never singular: the attitude is a quaternion. Rejected: three angles, which lock.

use serde::{Deserialize, Serialize};

use super::motion::attitude_columns;
use super::{Fields, JointDefinition, Pose, Relative, Twist};
use crate::Real;
use crate::rows::{Ends, Rows};

/// A body that floats: 6 freedoms.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Free {}

impl JointDefinition for Free {
    const FREEDOMS: usize = 6;
    const COORDINATES: usize = 7;
    const SUMMARY: &'static str = "everything is allowed";

    fn read(_fields: &mut dyn Fields) -> Self {
        Free {}
    }

    fn constrain<S: Real>(&self, _ends: &Ends<'_, S>, _rows: &mut Rows<S>) {}

    fn motion<S: Real>(&self, at: &Relative<'_, S>) -> Pose<S> {
        Pose {
            position: at.q3(0),
            rotation: at.attitude(3),
        }
    }

    fn subspace<S: Real>(&self, at: &Relative<'_, S>, columns: &mut [Twist<S>]) {
        let attitude = at.attitude(3);
        for (axis, column) in columns.iter_mut().take(3).enumerate() {
            *column = Twist::slide(attitude.column(axis).into_owned());
        }
        attitude_columns(&attitude, 3, columns);
    }

    fn bias<S: Real>(&self, at: &Relative<'_, S>) -> Twist<S> {
        Twist::slide(at.attitude(3) * at.u3(3).cross(&at.u3(0)))
    }

    fn rates<S: Real>(&self, at: &Relative<'_, S>, rates: &mut [S]) {
        let velocity = at.attitude(3) * at.u3(0);
        for (rate, &component) in rates.iter_mut().zip(velocity.iter()) {
            *rate = component;
        }
        at.attitude_rates(3, 3, rates);
    }
}
