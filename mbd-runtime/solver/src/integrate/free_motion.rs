//! The motion of bodies and points that nothing acts on, in a form that runs backwards to the same bits but for rounding, and that keeps the angular
//! momentum of every body as exactly as its numbers are stored.
//!
//! ```text
//! x ← x + t v                                                                    positions, angles of a plane             (1)
//! T = ½ Σ L_k²/I_k,  the flow of ½ L_k²/I_k: a rotation about principal axis k by θ = t L_k/I_k                            (2)
//! Q ← Q ∘ exp(½ θ e_k),  L ← exp(−θ e_k) L
//! ```
//!
//! with (2) in the order 1, 2, 3, 2, 1, all but the third for half of the time: symmetric, order 2, symplectic. L in principal axes. A rotation of it
//! adds what changes, s y − (1 − c) x: with c itself a million steps at h |ω| = 0.01 lose 1e-10 of L instead of 1e-13, since c, a little below 1, rounds
//! to the same side for long. For the same reason the state takes up changes of angular velocities, not angular velocities that went to other axes and back.
//! Source: `E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration`, VII.5.3 and VII.5.5. Rejected: the implicit midpoint rule, which
//! keeps energy and momentum, too, and turns the body to the wrong place.

use std::ops::Range;

use mbd_scene::laws::BodyNumbers;
use mbd_scene::{AngularVelocity, Float, Model, Part};
use nalgebra::{Matrix3, Quaternion, Vector3};

use crate::laws::numbers_of;
use crate::moving::moving;
use crate::node::eigen::eigen;

/// Bodies and points of a model with what their free motion needs.
#[derive(Clone, Debug, Default)]
pub(crate) struct FreeMotion {
    /// Where in the state what moves along a straight line is, and its speed; angles of a plane among them.
    straight: Vec<(Range<usize>, Range<usize>)>,
    turning: Vec<TurningBody>,
    /// Whether angular velocities are components in body axes.
    body_axes: bool,
}

/// A body that turns in space.
#[derive(Clone, Debug)]
struct TurningBody {
    attitude: Range<usize>,
    spin: Range<usize>,
    /// Inertia about the centre of mass and its inverse, body axes.
    inertia: Matrix3<f64>,
    inverse: Matrix3<f64>,
    /// Principal moments [kg m²].
    moments: Vector3<f64>,
    /// Principal axes to body axes; `None`: they are the body's own.
    axes: Option<Matrix3<f64>>,
}

impl FreeMotion {
    /// That of a model, with its parameters.
    pub(crate) fn new<T: Float>(model: &dyn Model<T>) -> Self {
        let (scene, layout) = (model.scene(), model.layout());
        let numbers = numbers_of(model);
        let (mut straight, mut turning) = (Vec::new(), Vec::new());
        for part in moving(layout) {
            straight.push((part.position, part.velocity));
            match part.part {
                Part::Body(body) if layout.directions.plane.is_none() => {
                    let body = &numbers.bodies[body];
                    turning.push(TurningBody::new(body, part.attitude, part.spin));
                }
                _ => straight.push((part.attitude, part.spin)),
            }
        }
        FreeMotion {
            straight,
            turning,
            body_axes: scene.angular_velocity == AngularVelocity::Body,
        }
    }

    /// Whether nothing was looked up.
    pub(crate) fn is_empty(&self) -> bool {
        self.straight.is_empty()
    }

    /// Moves everything by (1) and (2) for a time, which may be negative.
    pub(crate) fn advance<T: Float>(&self, time: f64, state: &mut [T]) {
        for (at, speeds) in &self.straight {
            for (at, speed) in at.clone().zip(speeds.clone()) {
                let more = T::from_f64(time) * state[speed];
                state[at] += more;
            }
        }
        for body in &self.turning {
            body.advance(time, state, self.body_axes);
        }
    }

    /// Adds to rates of angular velocities what (2) does to them already, ω̇ = −I⁻¹ (ω × I ω): what is left is what acts on the bodies.
    pub(crate) fn take_out_of<T: Float>(&self, state: &[T], rates: &mut [T]) {
        for body in &self.turning {
            body.take_out_of(state, rates, self.body_axes);
        }
    }
}

fn vector<T: Float>(list: &[T], at: &Range<usize>) -> Vector3<f64> {
    Vector3::from_fn(|k, _| list[at.start + k].to_f64())
}

fn write<T: Float>(list: &mut [T], at: &Range<usize>, vector: &Vector3<f64>) {
    for k in 0..3 {
        list[at.start + k] = T::from_f64(vector[k]);
    }
}

/// The rotation matrix of a quaternion of any length: orthogonal but for rounding.
fn matrix(quaternion: &Quaternion<f64>) -> Matrix3<f64> {
    let Quaternion { coords } = quaternion;
    let [x, y, z, w] = [coords.x, coords.y, coords.z, coords.w];
    let double = 2.0 / coords.norm_squared();
    let [xx, yy, zz] = [x * x, y * y, z * z];
    let [xy, xz, yz] = [x * y, x * z, y * z];
    let [wx, wy, wz] = [w * x, w * y, w * z];
    Matrix3::new(
        1.0 - double * (yy + zz),
        double * (xy - wz),
        double * (xz + wy),
        double * (xy + wz),
        1.0 - double * (xx + zz),
        double * (yz - wx),
        double * (xz - wy),
        double * (yz + wx),
        1.0 - double * (xx + yy),
    )
}

impl TurningBody {
    fn new(body: &BodyNumbers<f64>, attitude: Range<usize>, spin: Range<usize>) -> Self {
        let inertia = body.inertia;
        let off = |i, j| inertia[(i, j)] != 0.0 || inertia[(j, i)] != 0.0;
        let (moments, axes) = if off(0, 1) || off(0, 2) || off(1, 2) {
            let [(a, x), (b, y), (c, _)] = eigen(&inertia);
            let axes = Matrix3::from_columns(&[x, y, x.cross(&y)]);
            (Vector3::new(a, b, c), Some(axes))
        } else {
            (inertia.diagonal(), None)
        };
        TurningBody {
            attitude,
            spin,
            inertia,
            inverse: body.inverse_inertia,
            moments,
            axes,
        }
    }

    /// The attitude as a quaternion, body to world.
    fn attitude<T: Float>(&self, state: &[T]) -> Quaternion<f64> {
        let [w, x, y, z] = [0, 1, 2, 3].map(|k| state[self.attitude.start + k].to_f64());
        Quaternion::new(w, x, y, z)
    }

    fn advance<T: Float>(&self, time: f64, state: &mut [T], body_axes: bool) {
        let attitude = self.attitude(state);
        let to_world = matrix(&attitude);
        let before = vector(state, &self.spin);
        let spin = match body_axes {
            true => before,
            false => to_world.tr_mul(&before),
        };
        let (turn, more) = match &self.axes {
            None => self.turn(time, &spin),
            Some(axes) => {
                let (turn, more) = self.turn(time, &axes.tr_mul(&spin));
                (
                    Quaternion::from_parts(turn.w, axes * turn.vector()),
                    axes * more,
                )
            }
        };
        let attitude = attitude * turn;
        let spin = match body_axes {
            true => before + more,
            false => matrix(&attitude) * (spin + more),
        };
        let parts = [attitude.w, attitude.i, attitude.j, attitude.k];
        for (at, part) in self.attitude.clone().zip(parts) {
            state[at] = T::from_f64(part);
        }
        write(state, &self.spin, &spin);
    }

    /// (2) in principal axes: the turn of the body, and what it changes of its angular velocity.
    fn turn(&self, time: f64, spin: &Vector3<f64>) -> (Quaternion<f64>, Vector3<f64>) {
        let mut momentum = spin.component_mul(&self.moments);
        let mut whole = Quaternion::identity();
        let half = 0.5 * time;
        for (axis, time) in [(0, half), (1, half), (2, time), (1, half), (0, half)] {
            let (sine, cosine) = (0.5 * time * momentum[axis] / self.moments[axis]).sin_cos();
            let mut turn = Vector3::zeros();
            turn[axis] = sine;
            whole *= Quaternion::from_parts(cosine, turn);
            let (s, v) = (2.0 * sine * cosine, 2.0 * sine * sine);
            let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
            let (x, y) = (momentum[i], momentum[j]);
            momentum[i] += s * y - v * x;
            momentum[j] -= s * x + v * y;
        }
        (whole, momentum.component_div(&self.moments) - spin)
    }

    fn take_out_of<T: Float>(&self, state: &[T], rates: &mut [T], body_axes: bool) {
        let attitude = matrix(&self.attitude(state));
        let spin = vector(state, &self.spin);
        let spin = match body_axes {
            true => spin,
            false => attitude.tr_mul(&spin),
        };
        let more = self.inverse * spin.cross(&(self.inertia * spin));
        let more = match body_axes {
            true => more,
            false => attitude * more,
        };
        let rate = vector(rates, &self.spin) + more;
        write(rates, &self.spin, &rate);
    }
}
