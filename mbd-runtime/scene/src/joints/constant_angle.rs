//! Constant angle: the angle between a direction of the parent and one of the child stays.
//!
//! ```text
//! Φ = a1·b2 − cos γ     1 row [1]                                                                         (1)
//! s, R12 = turn(a, α) C turn(b, β), C constant with C b at the angle γ from a                             (2)
//! H = [I, 0, 0; 0, a, c], c = turn(a, α) C b; speeds ṡ, α̇, β̇;   b = α̇ β̇ [0; a × c]                        (3)
//! ```
//!
//! Source: derived, a perpendicular row with another right-hand side; 5 freedoms. Singular at γ = 0 and γ = π, where the gradient a × b
//! vanishes: refused; two parallel directions are two perpendicular rows. Rejected: the angle itself, undefined there.

use serde::{Deserialize, Serialize};

use super::dimension::ANGLE;
use super::motion::write;
use super::{Axis, Field, Fields, JointDefinition, Pose, Relative, Rule, Twist};
use crate::rows::{Ends, Rows};
use crate::{Formula, Real};
use nalgebra::{Matrix3, Vector3};

/// Two directions at a fixed angle: 5 freedoms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConstantAngle {
    /// The direction fixed in the parent and the one fixed in the child, each in its joint frame.
    #[serde(default = "both")]
    pub axes: [Axis; 2],
    /// The angle between them [rad], 0 < γ < π.
    pub angle: Formula,
}

fn both() -> [Axis; 2] {
    [Axis::Z, Axis::X]
}

static BETWEEN: Field = Field {
    name: "angle",
    dimension: ANGLE,
    rule: Rule::OpenHalfTurn,
};

impl ConstantAngle {
    /// turn(a, α) C.
    fn carried<S: Real>(&self, at: &Relative<'_, S>) -> Matrix3<S> {
        let [a, b] = self.axes;
        let tilt = a.complement()[0].turn(at.number(0));
        a.turn(at.q(3)) * tilt * (a.frame::<S>() * b.frame::<S>().transpose())
    }
}

impl JointDefinition for ConstantAngle {
    const FREEDOMS: usize = 5;
    const SUMMARY: &'static str =
        "two directions, one of the parent and one of the child, keep the `angle` between them";

    fn read(fields: &mut dyn Fields) -> Self {
        ConstantAngle {
            axes: fields.axes("axes", both(), false),
            angle: fields.number(&BETWEEN),
        }
    }

    fn numbers(&self) -> Vec<(&'static Field, &Formula)> {
        vec![(&BETWEEN, &self.angle)]
    }

    fn numbers_mut(&mut self) -> Vec<&mut Formula> {
        vec![&mut self.angle]
    }

    fn constrain<S: Real>(&self, ends: &Ends<'_, S>, rows: &mut Rows<S>) {
        let [a, b] = self.axes;
        rows.angle(ends, &a, &b, ends.number(0).sin_cos().1);
    }

    fn motion<S: Real>(&self, at: &Relative<'_, S>) -> Pose<S> {
        Pose {
            position: at.q3(0),
            rotation: self.carried(at) * self.axes[1].turn(at.q(4)),
        }
    }

    fn subspace<S: Real>(&self, at: &Relative<'_, S>, columns: &mut [Twist<S>]) {
        let [a, b] = self.axes;
        let slide = |axis: Axis| Twist::slide(axis.vector());
        let carried: Vector3<S> = self.carried(at) * b.vector::<S>();
        let [x, y, z] = [Axis::X, Axis::Y, Axis::Z].map(slide);
        write(
            columns,
            [x, y, z, Twist::spin(a.vector()), Twist::spin(carried)],
        );
    }

    fn bias<S: Real>(&self, at: &Relative<'_, S>) -> Twist<S> {
        let [a, b] = self.axes;
        let carried = self.carried(at) * b.vector::<S>();
        let rate = at.u(3) * at.u(4);
        Twist::spin(a.vector::<S>().cross(&carried).map(|x| rate * x))
    }
}
