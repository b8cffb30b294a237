//! Distance: two points at a fixed distance, a massless rod with a ball at each end.
//!
//! ```text
//! Φ = (d·d − L²) / (2 L)     1 row [m]                                                                      (1)
//! s = L n, n = turn(x, α) turn(y, β) z, R12(quaternion); speeds α̇, β̇, ω2 in frame 2                         (2)
//! H = [L x × n, L y′ × n, 0; 0, 0, R12], y′ = turn(x, α) y;   b = [L (ω̇ × n + ω × (ω × n)); 0]              (3)
//!   with ω = α̇ x + β̇ y′, ω̇ = α̇ β̇ x × y′
//! ```
//!
//! Source: derived; 5 freedoms. The rows need d ≠ 0, that is L > 0; the angles of (2) lock at β = ±90°, the rows do not.
//! Rejected: |d| − L = 0, a root more and undefined at d = 0.

use serde::{Deserialize, Serialize};

use super::dimension::LENGTH;
use super::motion::{attitude_columns, write};
use super::{Axis, Field, Fields, JointDefinition, Pose, Relative, Rule, Twist};
use crate::rows::{Ends, Rows};
use crate::{Formula, Real};
use nalgebra::Vector3;

/// A massless rod: 5 freedoms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Distance {
    /// Length of the rod [m], > 0.
    pub length: Formula,
}

static ROD: Field = Field {
    name: "length",
    dimension: LENGTH,
    rule: Rule::Positive,
};

/// The second axis y′ and the direction n of the rod.
fn rod<S: Real>(at: &Relative<'_, S>) -> (Vector3<S>, Vector3<S>) {
    let first = Axis::X.turn(at.q(0));
    let second = first * Axis::Y.vector();
    (
        second,
        first * (Axis::Y.turn(at.q(1)) * Axis::Z.vector::<S>()),
    )
}

impl JointDefinition for Distance {
    const FREEDOMS: usize = 5;
    const COORDINATES: usize = 6;
    const SUMMARY: &'static str = "a massless rod of `length` between two points";
    const AXES: [bool; 2] = [false; 2];

    fn read(fields: &mut dyn Fields) -> Self {
        Distance {
            length: fields.number(&ROD),
        }
    }

    fn numbers(&self) -> Vec<(&'static Field, &Formula)> {
        vec![(&ROD, &self.length)]
    }

    fn numbers_mut(&mut self) -> Vec<&mut Formula> {
        vec![&mut self.length]
    }

    fn constrain<S: Real>(&self, ends: &Ends<'_, S>, rows: &mut Rows<S>) {
        rows.distance(ends, ends.number(0));
    }

    fn motion<S: Real>(&self, at: &Relative<'_, S>) -> Pose<S> {
        Pose {
            position: rod(at).1.map(|x| at.number(0) * x),
            rotation: at.attitude(2),
        }
    }

    fn subspace<S: Real>(&self, at: &Relative<'_, S>, columns: &mut [Twist<S>]) {
        let (second, n) = rod(at);
        let swing = |axis: Vector3<S>| Twist::slide(axis.cross(&n).map(|x| at.number(0) * x));
        write(columns, [swing(Axis::X.vector()), swing(second)]);
        attitude_columns(&at.attitude(2), 2, columns);
    }

    fn bias<S: Real>(&self, at: &Relative<'_, S>) -> Twist<S> {
        let (second, n) = rod(at);
        let x = Axis::X.vector::<S>();
        let omega = x.map(|a| at.u(0) * a) + second.map(|a| at.u(1) * a);
        let change = x.cross(&second).map(|a| at.u(0) * at.u(1) * a);
        let curve = change.cross(&n) + omega.cross(&omega.cross(&n));
        Twist::slide(curve.map(|a| at.number(0) * a))
    }

    fn rates<S: Real>(&self, at: &Relative<'_, S>, rates: &mut [S]) {
        for (index, rate) in rates.iter_mut().take(2).enumerate() {
            *rate = at.u(index);
        }
        at.attitude_rates(2, 2, rates);
    }
}
