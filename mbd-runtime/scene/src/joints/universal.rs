//! Universal (cardan, Hooke): two rotations about crossed axes.
//!
//! ```text
//! Φ = [ d ; a1·b2 ]     4 rows [m m m 1]; a fixed in the parent, b in the child, a ⟂ b      (1)
//! s = 0, R12 = turn(a, α) turn(b, β)                                                        (2)
//! H = [0, 0; a, turn(a, α) b],   b = α̇ β̇ [0; a × turn(a, α) b]                              (3)
//! ```
//!
//! Source: Kamman, Connecting Joints I: universal, 2 freedoms. The columns of H are always perpendicular: two angles never lock.
//! The reaction torque lies along a1 × b2. Rejected: axes that are not perpendicular; the reader refuses them.

use nalgebra::Matrix3;
use serde::{Deserialize, Serialize};

use super::motion::write;
use super::{Axis, Carried, Coordinate, Fields, JointDefinition, Measure, Pose, Relative, Twist};
use crate::Real;
use crate::rows::{Ends, Rows, couple};

/// A cardan joint: 2 freedoms, the angle about the first axis, then about the second.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Universal {
    /// The axis fixed in the parent and the axis fixed in the child, perpendicular.
    pub axes: [Axis; 2],
}

impl Default for Universal {
    fn default() -> Self {
        Universal {
            axes: [Axis::X, Axis::Y],
        }
    }
}

impl JointDefinition for Universal {
    const FREEDOMS: usize = 2;
    const SUMMARY: &'static str =
        "two rotations about crossed `axes`, one of the parent, one of the child";

    fn read(fields: &mut dyn Fields) -> Self {
        Universal {
            axes: fields.axes("axes", [Axis::X, Axis::Y], true),
        }
    }

    fn constrain<S: Real>(&self, ends: &Ends<'_, S>, rows: &mut Rows<S>) {
        let [a, b] = self.axes;
        rows.coincide(ends);
        rows.perpendicular(ends, &a, &b);
    }

    fn carried<S: Real>(&self, ends: &Ends<'_, S>, own: bool) -> Option<Carried<S>> {
        let [a, b] = self.axes;
        let mut carried = Carried::coincide();
        let (first, second) = (ends.in_child(&a), ends.child.axis(&b));
        let n = couple(ends, &a, &b);
        let square = n.dot(&n);
        if own {
            // The axes n, b × n and b, of length one: free columns of one number each.
            let inverse = S::one() / square.sqrt();
            let normal = n.map(|x| x * inverse);
            // |w|² a·b − (a·w)(b·w), w = ω_p − ω_c: γ besides what the parent brings along.
            let spin = ends.spin_in_child();
            let w = spin.difference;
            let right = spin.square * first.dot(&second) - first.dot(&w) * second.dot(&w);
            carried.axes = Some(Matrix3::from_columns(&[
                normal,
                second.cross(&normal),
                second,
            ]));
            let [x, y, z] = [Axis::X, Axis::Y, Axis::Z].map(|axis| Twist::spin(axis.vector()));
            carried.free.extend([y, z]);
            carried.bias = Some(Twist::spin(
                Axis::X.vector::<S>().map(|x| x * (right * inverse)),
            ));
            carried.hold(x, inverse);
        } else {
            carried
                .free
                .extend([Twist::spin(first), Twist::spin(second)]);
            carried.hold(Twist::spin(n), S::one() / square);
        }
        Some(carried)
    }

    fn motion<S: Real>(&self, at: &Relative<'_, S>) -> Pose<S> {
        let [a, b] = self.axes;
        Pose {
            rotation: a.turn(at.q(0)) * b.turn(at.q(1)),
            ..Pose::identity()
        }
    }

    fn subspace<S: Real>(&self, at: &Relative<'_, S>, columns: &mut [Twist<S>]) {
        let [a, b] = self.axes;
        let second = a.turn(at.q(0)) * b.vector();
        write(columns, [Twist::spin(a.vector()), Twist::spin(second)]);
    }

    fn bias<S: Real>(&self, at: &Relative<'_, S>) -> Twist<S> {
        let [a, b] = self.axes;
        let second = a.turn(at.q(0)) * b.vector::<S>();
        let rate = at.u(0) * at.u(1);
        Twist::spin(a.vector::<S>().cross(&second).map(|x| rate * x))
    }

    fn coordinate(&self, index: usize) -> Option<Coordinate> {
        // R12 b = b cos α + c sin α and R12ᵀ a = a cos β + c sin β, c = a × b.
        let [a, b] = self.axes;
        let c = a.cross(&b);
        match index {
            0 => Some(Coordinate {
                name: "angle1",
                rate: "angle1_rate",
                measure: Measure::Angle {
                    cosine: [b, b],
                    sine: [c, b],
                },
            }),
            1 => Some(Coordinate {
                name: "angle2",
                rate: "angle2_rate",
                measure: Measure::Angle {
                    cosine: [a, a],
                    sine: [a, c],
                },
            }),
            _ => None,
        }
    }
}
