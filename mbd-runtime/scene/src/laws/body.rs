//! A rigid body: where its frames are, how they move, what its inertia resists.
//!
//! ```text
//! p_WF = r + R p_BF,   v_WF = ṙ + R (ω′ × p_BF)                                                                  (1)
//! q̇ = ½ q ⊗ (0, ω′)            (ω = R ω′ in world components: q̇ = ½ (0, ω) ⊗ q)                                 (2)
//! M = diag(m I₃, I′),  h = (−m g, ω′ × I′ω′)                       body components                              (3)
//! M = diag(m I₃, R I′ Rᵀ),  h = (−m g, R (ω′ × I′ω′))              world components                             (4)
//! ```
//!
//! R from a unit quaternion, w first, body to world. The state carries ω′ or ω by declaration. In a plane R is the turn about the normal,
//! ω = ω′ lies along it, and of (3) and (4), which agree, the components in the plane count: M = diag(m I₂, I′ about the normal), h = −m g.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use crate::laws::numbers::BodyNumbers;
use crate::scalar::algebra::{labelled, quaternion_of, quaternion_rate, rotation, vector};
use crate::{AngularVelocity, Directions, Real, Slots};

/// What the state carries of a rotation.
#[derive(Clone, Copy, Debug)]
pub enum Attitude<S> {
    /// A quaternion w x y z.
    Quaternion([S; 4]),
    /// The angle about the normal of a plane, whose rate is ω.
    Angle(S),
    /// Nothing: a joint of the tree carries the body.
    Axes,
}

/// A body in motion.
#[derive(Clone, Copy, Debug)]
pub struct BodyMotion<S: Real> {
    /// Position of the centre of mass, world axes [m].
    pub position: Vector3<S>,
    /// Rotation body → world.
    pub rotation: Matrix3<S>,
    /// 1 over the length of the columns of that: 1/|q|², which leaves 1 inside a step.
    pub unit: S,
    /// What the state carries of it.
    pub attitude: Attitude<S>,
    /// Velocity of the centre of mass, world axes [m/s].
    pub velocity: Vector3<S>,
    /// Angular velocity in body axes [rad/s].
    pub omega_body: Vector3<S>,
    /// Angular velocity in world axes [rad/s].
    pub omega_world: Vector3<S>,
}

impl<S: Real> BodyMotion<S> {
    /// Nothing known yet.
    pub fn unknown() -> Self {
        BodyMotion {
            position: Vector3::zeros(),
            rotation: Matrix3::zeros(),
            unit: S::one(),
            attitude: Attitude::Quaternion([S::zero(); 4]),
            velocity: Vector3::zeros(),
            omega_body: Vector3::zeros(),
            omega_world: Vector3::zeros(),
        }
    }

    /// Reads a body's motion from the state; `nq` is the length of q.
    pub fn read(
        state: &[S],
        slots: Slots,
        nq: usize,
        directions: Directions,
        components: AngularVelocity,
    ) -> Self {
        let at = slots.q + directions.translations().len();
        let first: Vector3<S> = vector(state, at);
        let (rotation, unit, attitude) = match directions.plane {
            Some(plane) => (
                plane.axis().turn(first.x),
                S::one(),
                Attitude::Angle(first.x),
            ),
            None => {
                let rest: Vector3<S> = vector(state, at + 1);
                let quaternion = [first.x, rest.x, rest.y, rest.z];
                let [ww, xx, yy, zz] = quaternion.map(|x| x * x);
                let unit = S::one() / ((ww + xx) + (yy + zz)).label("square");
                (rotation(quaternion), unit, Attitude::Quaternion(quaternion))
            }
        };
        let position = directions.linear(state, slots.q);
        let velocity = directions.linear(state, nq + slots.v);
        let omega = directions.angular(state, nq + slots.v);
        let (omega_body, omega_world) = match components {
            AngularVelocity::Body => (omega, labelled(rotation * omega, ["w_x", "w_y", "w_z"])),
            AngularVelocity::World => (
                labelled(rotation.transpose() * omega, ["w_x", "w_y", "w_z"]),
                omega,
            ),
        };
        BodyMotion {
            position,
            rotation,
            unit,
            attitude,
            velocity,
            omega_body,
            omega_world,
        }
    }

    /// The rotation as a vector [rad], its axis times its angle φ = 2 atan2(|u|, |w|) of the quaternion (w, u), 0 ≤ φ ≤ π; u and −u are one
    /// rotation, so that the vector jumps to its opposite at half a turn. Near no rotation φ/|u| = 2/|w| (1 − t²/3 + t⁴/5), t = |u|/|w|, so that
    /// its slope is right there, too. In a plane the normal times the angle, which counts turns.
    pub fn orientation(&self, directions: Directions) -> Vector3<S> {
        let number = S::from_f64;
        let (w, u) = match self.attitude {
            Attitude::Quaternion([w, x, y, z]) => (w, Vector3::new(x, y, z)),
            Attitude::Axes => {
                let [w, x, y, z] = quaternion_of(&self.rotation);
                (w, Vector3::new(x, y, z))
            }
            Attitude::Angle(angle) => {
                let about = directions.rotations();
                return Vector3::from_fn(|i, _| match about.contains(&i) {
                    true => angle,
                    false => S::zero(),
                });
            }
        };
        let (sine, cosine) = (u.dot(&u), w.abs());
        let small = sine.lt(number(1e-6) * (w * w));
        let below = S::select(small, cosine, S::one());
        let t = sine / (below * below);
        let series = number(2.0) / below * (S::one() - t * (number(1.0 / 3.0) - t * number(0.2)));
        let root = S::select(small, S::one(), sine).sqrt();
        let whole = number(2.0) * root.atan2(cosine) / root;
        let part = S::select(small, series, whole);
        let signed = S::select(w.lt(S::zero()), -part, part);
        labelled(u.map(|x| signed * x), ["turn_x", "turn_y", "turn_z"])
    }

    /// Lever arm R p of a place `p` in body axes, world axes [m].
    pub fn arm(&self, p: &Vector3<S>) -> Vector3<S> {
        labelled(self.rotation * p, ["arm_x", "arm_y", "arm_z"])
    }

    /// Velocity of a place `p` in body axes, world axes [m/s], equation (1).
    pub fn velocity_of(&self, p: &Vector3<S>) -> Vector3<S> {
        labelled(
            self.velocity + self.rotation * self.omega_body.cross(p),
            ["v_x", "v_y", "v_z"],
        )
    }

    /// Angular velocity in world axes for positions R p: d(R p)/dt = ω × R p whatever the length of the quaternion.
    pub fn omega_exact(&self, components: AngularVelocity) -> Vector3<S> {
        match components {
            AngularVelocity::Body => self.rotation * self.omega_body.map(|x| x * self.unit),
            AngularVelocity::World => self.omega_world,
        }
    }

    /// Writes the rates of the attitude from `at` on: q̇ by (2), w first; in a plane ω.
    pub fn write_attitude_rate(
        &self,
        out: &mut [S],
        at: usize,
        directions: Directions,
        components: AngularVelocity,
    ) {
        let Attitude::Quaternion(quaternion) = self.attitude else {
            let rates = out.iter_mut().skip(at).zip(directions.rotations());
            rates.for_each(|(rate, &axis)| *rate = self.omega_body[axis]);
            return;
        };
        let (omega, in_body) = match components {
            AngularVelocity::Body => (self.omega_body, true),
            AngularVelocity::World => (self.omega_world, false),
        };
        let rates = quaternion_rate(quaternion, &omega, in_body);
        for (slot, rate) in out.iter_mut().skip(at).zip(rates) {
            *slot = rate;
        }
    }

    /// I′ω′ [N m s], body axes.
    fn spin(&self, body: &BodyNumbers<S>) -> Vector3<S> {
        labelled(
            body.inertia * self.omega_body,
            ["spin_x", "spin_y", "spin_z"],
        )
    }

    /// ω′ × I′ω′ [N m], body axes.
    pub fn gyroscopic(&self, body: &BodyNumbers<S>) -> Vector3<S> {
        let (w, inertia) = (self.omega_body, &body.inertia);
        let principal = (0..3).all(|k| inertia[(k, (k + 1) % 3)].is_zero());
        let couple = if principal {
            // A structural fact of the declaration, not a branch on the state: inertia is constant.
            Vector3::from_fn(|i, _| {
                let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                (inertia[(k, k)] - inertia[(j, j)]) * (w[j] * w[k])
            })
        } else {
            w.cross(&self.spin(body))
        };
        labelled(couple, ["gyro_x", "gyro_y", "gyro_z"])
    }

    /// Writes ω̇ for a torque about the centre of mass in world axes, and one in `own` axes [N m] (components by declaration), from (3) or (4).
    pub fn angular_acceleration(
        &self,
        body: &BodyNumbers<S>,
        [torque, own]: [&Vector3<S>; 2],
        components: AngularVelocity,
    ) -> Vector3<S> {
        let torque = labelled(
            self.rotation.transpose() * torque + own,
            ["torque_x", "torque_y", "torque_z"],
        );
        let acceleration = labelled(
            body.inverse_inertia * (torque - self.gyroscopic(body)),
            ["alpha_x", "alpha_y", "alpha_z"],
        );
        match components {
            AngularVelocity::Body => acceleration,
            AngularVelocity::World => self.rotation * acceleration,
        }
    }

    /// Kinetic energy [J].
    pub fn kinetic_energy(&self, body: &BodyNumbers<S>) -> S {
        let spin = self.omega_body.dot(&self.spin(body));
        S::from_f64(0.5) * (body.mass * self.velocity.dot(&self.velocity) + spin)
    }

    /// Writes the 6 × 6 diagonal block of M by (3) or (4), in a plane its 3 × 3 part, into a row-major n × n matrix at `at`.
    pub fn mass_block(
        &self,
        body: &BodyNumbers<S>,
        (directions, components): (Directions, AngularVelocity),
        out: &mut [S],
        n: usize,
        at: usize,
    ) {
        let inertia = match components {
            AngularVelocity::Body => body.inertia,
            AngularVelocity::World => self.rotation * body.inertia * self.rotation.transpose(),
        };
        let moves = directions.translations().len();
        for i in at..at + moves {
            write_at(out, i * n + i, body.mass);
        }
        for (k, &i) in directions.rotations().iter().enumerate() {
            // The lower triangle repeats the upper one, so that M is symmetric to the bit.
            let row = Vector3::from_fn(|j, _| inertia[(i.min(j), i.max(j))]);
            directions.write_angular(out, (at + moves + k) * n + at, &row);
        }
    }
}

/// Writes one number if the slice is long enough.
fn write_at<S: Real>(out: &mut [S], at: usize, value: S) {
    if let Some(slot) = out.get_mut(at) {
        *slot = value;
    }
}

/// The numbers that the state carries of a rotation.
pub fn attitude_of(axes: &Matrix3<f64>, directions: Directions) -> impl Iterator<Item = f64> {
    let quaternion = || {
        let turn = Rotation3::from_matrix_unchecked(*axes);
        let q = UnitQuaternion::from_rotation_matrix(&turn).into_inner();
        [q.w, q.i, q.j, q.k]
    };
    let (numbers, count) = match directions.plane {
        None => (quaternion(), 4),
        Some(plane) => {
            let [a, b] = [1, 2].map(|k| (plane.normal() + k) % 3);
            let [sin, cos] = [axes[(b, a)] - axes[(a, b)], axes[(a, a)] + axes[(b, b)]];
            ([sin.atan2(cos), 0.0, 0.0, 0.0], 1)
        }
    };
    numbers.into_iter().take(count)
}
