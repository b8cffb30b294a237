//! Grouped inertial parameters: what of the inertia of a link nothing tells apart from an inertia of the link that carries it.
//!
//! ```text
//! J H = 0,  Xᵀ J X = J for every motion X of the joint:      ½ Vᵀ J V = ½ V_pᵀ (X_fᵀ J X_f) V_p,   V = X X_f V_p + H u      (1)
//! ```
//!
//! Such parts of J go to the inboard link, where the joint sits on it; M, h and accelerations stay as they are, forces in the joint do not. Of a
//! link on a hinge about z these are its mass, its first moment along z and one of two moments of inertia across. Source: Gautier and Khalil, Direct
//! calculation of minimum set of inertial parameters of serial robots, 1990; (1) in place of their table of joints.

use nalgebra::{Matrix3, Vector3};

use super::inertia::SpatialInertia;
use super::link_axes::as_seen;
use super::turn::Turn;
use crate::joints::JointLaw;
use crate::{Grouped, LinkAxes, Real, Relative, Twist};

/// Where (1) is tried: coordinates, and numbers of the joint, without a relation between them.
const TRIED: [[f64; 4]; 3] = [[0.0; 4], [0.7, -0.4, 1.1, 0.3], [-1.9, 0.8, 0.2, -0.6]];

impl Grouped {
    /// Those of the link that a joint carries.
    pub(super) fn of(law: &JointLaw, axes: Option<&LinkAxes>) -> Self {
        let (seen, _) = as_seen(law, axes);
        let law = seen.as_ref().unwrap_or(law);
        let is_free = |part: &SpatialInertia<f64>| TRIED.iter().all(|at| obeys(law, part, at));
        let unit = |axis: usize| Vector3::from_fn(|row, _| f64::from(u8::from(row == axis)));
        let inertia = |inertia: Matrix3<f64>| SpatialInertia {
            inertia,
            ..SpatialInertia::none()
        };
        let any = Matrix3::new(1.0, 0.2, 0.3, 0.2, 1.4, 0.1, 0.3, 0.1, 1.9);
        let across = |axis: usize| Matrix3::from_diagonal(&(Vector3::repeat(1.0) - unit(axis)));
        Grouped {
            mass: is_free(&SpatialInertia {
                mass: 1.0,
                ..SpatialInertia::none()
            }),
            moment: [0, 1, 2].map(|axis| {
                is_free(&SpatialInertia {
                    moment: unit(axis),
                    ..SpatialInertia::none()
                })
            }),
            inertia: is_free(&inertia(any)),
            across: (0..3).find(|&axis| is_free(&inertia(across(axis)))),
        }
    }

    /// Takes them out of an inertia.
    pub(super) fn take_out<S: Real>(&self, own: &mut SpatialInertia<S>) -> SpatialInertia<S> {
        let mut out = SpatialInertia::none();
        if self.mass {
            std::mem::swap(&mut own.mass, &mut out.mass);
        }
        for (axis, _) in self.moment.iter().enumerate().filter(|(_, free)| **free) {
            std::mem::swap(&mut own.moment[axis], &mut out.moment[axis]);
        }
        match self.across {
            _ if self.inertia => std::mem::swap(&mut own.inertia, &mut out.inertia),
            Some(axis) => {
                let [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
                let equal = own.inertia[(b, b)];
                own.inertia[(a, a)] -= equal;
                own.inertia[(b, b)] = S::zero();
                (out.inertia[(a, a)], out.inertia[(b, b)]) = (equal, equal);
            }
            None => {}
        }
        out
    }
}

/// (1) for one part at one place.
fn obeys(law: &JointLaw, part: &SpatialInertia<f64>, at: &[f64; 4]) -> bool {
    let small = |difference: f64| difference.abs() < 1e-9;
    let mut q = vec![0.0; law.coordinates()];
    q.iter_mut()
        .zip(at)
        .for_each(|(slot, &value)| *slot = value);
    if let Some(attitude) = law.attitude() {
        q[attitude.start] += 1.0;
        let length = q[attitude.clone()]
            .iter()
            .map(|x| x * x)
            .sum::<f64>()
            .sqrt();
        q[attitude].iter_mut().for_each(|x| *x /= length);
    }
    let numbers: Vec<f64> = (0..law.numbers().len())
        .map(|k| 1.3 + 0.4 * k as f64)
        .collect();
    let relative = Relative {
        q: &q,
        u: &[],
        numbers: &numbers,
    };
    let pose = law.motion(&relative);
    let mut columns = vec![Twist::zero(); law.freedoms()];
    law.subspace(&relative, &mut columns);
    let mut moved = SpatialInertia::none();
    moved.take(part, &Turn::by(pose.rotation), &pose.position);
    let same = small(moved.mass - part.mass)
        && (moved.moment - part.moment).iter().all(|x| small(*x))
        && (moved.inertia - part.inertia).iter().all(|x| small(*x));
    // `part` moved is `part`, so that columns in frame 1 about its origin may be taken as they are.
    let still = |column: &Twist<f64>| {
        let [x, k] = [column.linear, column.angular];
        let origin = Twist {
            linear: x - k.cross(&pose.position),
            angular: k,
        };
        let push = part.push(&origin);
        push.linear
            .iter()
            .chain(push.angular.iter())
            .all(|x| small(*x))
    };
    same && columns.iter().all(still)
}
