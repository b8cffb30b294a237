//! Constant velocity (Rzeppa, double cardan): a bend in any direction, and the shafts turn at equal speeds whatever the bend.
//!
//! ```text
//! Φ = [ d ; (v1·u2 − u1·v2)/2 ]     4 rows [m m m 1]; a the axis of the shaft in either frame, u, v its complement             (1)
//! s = 0, R12 of the quaternion (1, x u + y v)/√(1 + x² + y²), x and y the tangent of half the bend about u and v                (2)
//! H = k [0, 0; u − y a, v + x a],   k = 2/(1 + x² + y²),   b = −k (x ẋ + y ẏ) [0; ω]                                           (3)
//! ```
//!
//! With the quaternion (w, p) of R12 the last row is 2 w (a·p): no turn about the shafts besides the bend, so ω lies in the plane that halves
//! the angle between the shafts, and ω_1·a1 = ω_2·a2. Source: derived; homokinetic plane, Hunt, Constant-velocity shaft couplings (1973).
//! 2 freedoms. The row also holds at every half turn, w = 0: the start must satisfy u1·u2 + v1·v2 > 0. Singular where the shafts fold back,
//! a2 = −a1. Rejected: two universal joints and a shaft between them, one body more; angles as coordinates, singular at a right angle.

use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

use super::motion::write;
use super::{Axis, Carried, Fields, Fold, JointDefinition, Pose, Relative, Twist};
use crate::Real;
use crate::rotation;
use crate::rows::{Ends, Row, Rows, couple, perpendicular};

/// A drive-shaft joint: 2 freedoms, the tangents of half the bend about two axes across the shaft.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ConstantVelocity {
    /// The axis of the shafts, the same components in both joint frames.
    pub axis: Axis,
}

impl ConstantVelocity {
    /// (v1·u2 − u1·v2)/2.
    fn twist<S: Real>(&self, ends: &Ends<'_, S>) -> Row<S> {
        let [u, v] = self.axis.complement();
        let half = S::from_f64(0.5);
        let back = perpendicular(ends, &u, &v).scaled(-half);
        perpendicular(ends, &v, &u).scaled(half).plus(&back)
    }

    /// k, the bend x u + y v, and u, v, a.
    fn bend<S: Real>(&self, at: &Relative<'_, S>) -> (S, Vector3<S>, [Vector3<S>; 3]) {
        let [u, v] = self.axis.complement();
        let [u, v, a] = [u, v, self.axis].map(|axis| axis.vector::<S>());
        let bend = u.map(|c| at.q(0) * c) + v.map(|c| at.q(1) * c);
        let k = S::from_f64(2.0) / (S::one() + bend.dot(&bend));
        (k, bend, [u, v, a])
    }
}

impl JointDefinition for ConstantVelocity {
    const FREEDOMS: usize = 2;
    const SUMMARY: &'static str = "a bend in any direction; the shafts along `axis` turn equally";
    const FOLD: Option<Fold> = Some(Fold {
        // 2 w², w the cosine of half the bend.
        least: 1.5e-4,
        told: "is bent by more than 179 degrees: where its shafts fold back it does not say how they turn",
        remedy: "keep the bend small by springs or stops, end the run before, or take a joint that bends any way: `spherical`, `universal`",
    });

    fn read(fields: &mut dyn Fields) -> Self {
        ConstantVelocity {
            axis: fields.axis("axis", Axis::Z),
        }
    }

    fn constrain<S: Real>(&self, ends: &Ends<'_, S>, rows: &mut Rows<S>) {
        rows.coincide(ends);
        rows.push(|| self.twist(ends));
    }

    fn carried<S: Real>(&self, ends: &Ends<'_, S>, own: bool) -> Option<Carried<S>> {
        // The column c of the row on the child.
        let [u, v] = self.axis.complement();
        let half = S::from_f64(0.5);
        let column = (couple(ends, &v, &u) - couple(ends, &u, &v)).map(|x| half * x);
        let [u2, v2, a2] = [u, v, self.axis].map(|axis| ends.child.axis(&axis));
        let mut carried = Carried::coincide();
        if own {
            // Axes along c and across it, of length one: free columns of one number each.
            let inverse = S::one() / column.dot(&column).sqrt();
            let normal = column.map(|x| x * inverse);
            let side = v2.cross(&normal);
            let unit = S::one() / side.dot(&side).sqrt();
            let side = side.map(|x| x * unit);
            // |w|² Φ − ((v1·w)(u2·w) − (u1·w)(v2·w))/2, w = ω_p − ω_c: γ besides what the parent brings along.
            let [u1, v1] = [u, v].map(|axis| ends.in_child(&axis));
            let spin = ends.spin_in_child();
            let w = spin.difference;
            let lean =
                |a: &Vector3<S>, b: &Vector3<S>| spin.square * a.dot(b) - a.dot(&w) * b.dot(&w);
            let right = half * (lean(&v1, &u2) - lean(&u1, &v2));
            carried.axes = Some(Matrix3::from_columns(&[normal, side, normal.cross(&side)]));
            let [x, y, z] = [Axis::X, Axis::Y, Axis::Z].map(|axis| axis.vector::<S>());
            carried.free.extend([y, z].map(Twist::spin));
            carried.bias = Some(Twist::spin(x.map(|x| x * (right * inverse))));
            carried.hold(Twist::spin(x), inverse);
        } else {
            let inverse = S::one() / a2.dot(&column);
            for across in [v2.cross(&column), column.cross(&u2)] {
                carried.free.push(Twist::spin(across.map(|x| x * inverse)));
            }
            carried.hold(Twist::spin(a2), inverse);
        }
        Some(carried)
    }

    fn motion<S: Real>(&self, at: &Relative<'_, S>) -> Pose<S> {
        let (k, bend, _) = self.bend(at);
        let w = (k * S::from_f64(0.5)).sqrt();
        let [x, y, z] = bend.map(|c| w * c).into();
        Pose {
            rotation: rotation([w, x, y, z]),
            ..Pose::identity()
        }
    }

    fn subspace<S: Real>(&self, at: &Relative<'_, S>, columns: &mut [Twist<S>]) {
        let (k, bend, [u, v, _]) = self.bend(at);
        let column = |axis: Vector3<S>| Twist::spin((axis + bend.cross(&axis)).map(|c| k * c));
        write(columns, [column(u), column(v)]);
    }

    fn bias<S: Real>(&self, at: &Relative<'_, S>) -> Twist<S> {
        let (k, bend, [u, v, _]) = self.bend(at);
        let rate = u.map(|c| at.u(0) * c) + v.map(|c| at.u(1) * c);
        let omega = (rate + bend.cross(&rate)).map(|c| k * c);
        Twist::spin(omega.map(|c| -(k * bend.dot(&rate)) * c))
    }

    fn branch<S: Real>(&self, ends: &Ends<'_, S>) -> [S; 3] {
        let [u, v] = self.axis.complement();
        let spread = ends.cosine(&u, &u) + ends.cosine(&v, &v);
        [spread, S::one(), S::one()]
    }
}
