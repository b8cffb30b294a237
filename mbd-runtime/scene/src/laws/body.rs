//! A rigid body: where its frames are, how they move, what its inertia resists.
//!
//! ```text
//! p_WF = r + R p_BF,   v_WF = ṙ + R (ω′ × p_BF)                                                                  (1)
//! q̇ = ½ q ⊗ (0, ω′)            (ω = R ω′ in world components: q̇ = ½ (0, ω) ⊗ q)                                 (2)
//! M = diag(m I₃, I′),  h = (−m g, ω′ × I′ω′)                       body components                              (3)
//! M = diag(m I₃, R I′ Rᵀ),  h = (−m g, R (ω′ × I′ω′))              world components                             (4)
//! ```
//!
//! R from a unit quaternion, w first, body to world. The state carries ω′ or ω by declaration.

use nalgebra::{Matrix3, Vector3};

use super::algebra::{labelled, rotation, vector, write};
use super::numbers::BodyNumbers;
use crate::{AngularVelocity, Real, Slots};

/// A body in motion.
#[derive(Clone, Copy, Debug)]
pub struct Motion<S: Real> {
    /// Position of the centre of mass, world axes [m].
    pub position: Vector3<S>,
    /// Rotation body → world.
    pub rotation: Matrix3<S>,
    /// The quaternion w x y z.
    pub quaternion: [S; 4],
    /// Velocity of the centre of mass, world axes [m/s].
    pub velocity: Vector3<S>,
    /// Angular velocity in body axes [rad/s].
    pub omega_body: Vector3<S>,
    /// Angular velocity in world axes [rad/s].
    pub omega_world: Vector3<S>,
}

impl<S: Real> Motion<S> {
    /// Nothing known yet.
    pub fn unknown() -> Self {
        let zero = S::zero();
        Motion {
            position: Vector3::zeros(),
            rotation: Matrix3::zeros(),
            quaternion: [zero; 4],
            velocity: Vector3::zeros(),
            omega_body: Vector3::zeros(),
            omega_world: Vector3::zeros(),
        }
    }

    /// Reads a body's motion from the state; `nq` is the length of q.
    pub fn read(state: &[S], slots: Slots, nq: usize, components: AngularVelocity) -> Self {
        let position = vector(state, slots.q);
        let imaginary = vector(state, slots.q + 4);
        let quaternion = [
            vector(state, slots.q + 3).x,
            imaginary.x,
            imaginary.y,
            imaginary.z,
        ];
        let rotation = rotation(quaternion);
        let velocity = vector(state, nq + slots.v);
        let omega = vector(state, nq + slots.v + 3);
        let (omega_body, omega_world) = match components {
            AngularVelocity::Body => (omega, labelled(rotation * omega, ["w_x", "w_y", "w_z"])),
            AngularVelocity::World => (
                labelled(rotation.transpose() * omega, ["w_x", "w_y", "w_z"]),
                omega,
            ),
        };
        Motion {
            position,
            rotation,
            quaternion,
            velocity,
            omega_body,
            omega_world,
        }
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

    /// q̇ by (2), w first.
    pub fn quaternion_rate(&self, components: AngularVelocity) -> [S; 4] {
        let [w, x, y, z] = self.quaternion;
        let half = S::from_f64(0.5);
        let (omega, sign) = match components {
            AngularVelocity::Body => (self.omega_body, S::one()),
            AngularVelocity::World => (self.omega_world, -S::one()),
        };
        let omega = omega.map(|rate| half * rate);
        let swirl = Vector3::new(
            y * omega.z - z * omega.y,
            z * omega.x - x * omega.z,
            x * omega.y - y * omega.x,
        );
        [
            -(x * omega.x + y * omega.y + z * omega.z),
            w * omega.x + sign * swirl.x,
            w * omega.y + sign * swirl.y,
            w * omega.z + sign * swirl.z,
        ]
    }

    /// ω′ × I′ω′ [N m], body axes.
    pub fn gyroscopic(&self, body: &BodyNumbers<S>) -> Vector3<S> {
        labelled(
            self.omega_body.cross(&(body.inertia * self.omega_body)),
            ["gyro_x", "gyro_y", "gyro_z"],
        )
    }

    /// Writes ω̇ for a torque about the centre of mass in world axes [N m] (components by declaration), from (3) or (4).
    pub fn angular_acceleration(
        &self,
        body: &BodyNumbers<S>,
        torque: &Vector3<S>,
        components: AngularVelocity,
    ) -> Vector3<S> {
        let torque = labelled(
            self.rotation.transpose() * torque,
            ["torque_x", "torque_y", "torque_z"],
        );
        let acceleration = labelled(
            body.inverse_inertia * (torque - self.gyroscopic(body)),
            ["spin_x", "spin_y", "spin_z"],
        );
        match components {
            AngularVelocity::Body => acceleration,
            AngularVelocity::World => self.rotation * acceleration,
        }
    }

    /// Kinetic energy [J].
    pub fn kinetic_energy(&self, body: &BodyNumbers<S>) -> S {
        let spin = self.omega_body.dot(&(body.inertia * self.omega_body));
        S::from_f64(0.5) * (body.mass * self.velocity.dot(&self.velocity) + spin)
    }

    /// Writes the 6 × 6 diagonal block of M by (3) or (4) into a row-major n × n matrix at `at`.
    pub fn mass_block(
        &self,
        body: &BodyNumbers<S>,
        components: AngularVelocity,
        out: &mut [S],
        n: usize,
        at: usize,
    ) {
        let inertia = match components {
            AngularVelocity::Body => body.inertia,
            AngularVelocity::World => self.rotation * body.inertia * self.rotation.transpose(),
        };
        for i in 0..3 {
            write_at(out, (at + i) * n + at + i, body.mass);
            // The lower triangle repeats the upper one, so that M is symmetric to the bit.
            let row = Vector3::from_fn(|j, _| inertia[(i.min(j), i.max(j))]);
            write(out, (at + 3 + i) * n + at + 3, &row);
        }
    }
}

/// Writes one number if the slice is long enough.
fn write_at<S: Real>(out: &mut [S], at: usize, value: S) {
    if let Some(slot) = out.get_mut(at) {
        *slot = value;
    }
}
