//! What a joint allows: the pose of frame 2 in frame 1, its velocity, and the joint coordinates they depend on.

use nalgebra::{Matrix3, Vector3};

use crate::{Real, quaternion_rate, rotation};

/// Frame 2 in frame 1.
#[derive(Clone, Copy, Debug)]
pub struct Pose<S: Real> {
    /// s: origin of frame 2 from the origin of frame 1, frame-1 axes [m].
    pub position: Vector3<S>,
    /// R12: frame-2 axes → frame-1 axes.
    pub rotation: Matrix3<S>,
}

/// A velocity of frame 2 in frame 1, or an acceleration, or a column of H; frame-1 axes.
#[derive(Clone, Copy, Debug)]
pub struct Twist<S: Real> {
    /// Of the origin of frame 2 [m/s].
    pub linear: Vector3<S>,
    /// Angular [rad/s].
    pub angular: Vector3<S>,
}

impl<S: Real> Pose<S> {
    /// The frames coincide.
    #[must_use]
    pub fn identity() -> Self {
        Pose {
            position: Vector3::zeros(),
            rotation: Matrix3::identity(),
        }
    }

    /// The pose of a frame that has the pose `inner` in this one.
    #[must_use]
    pub fn then(&self, inner: &Self) -> Self {
        Pose {
            position: self.position + self.rotation * inner.position,
            rotation: self.rotation * inner.rotation,
        }
    }

    /// The pose of frame 1 in frame 2.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.transpose();
        Pose {
            position: -(rotation * self.position),
            rotation,
        }
    }
}

impl<S: Real> Twist<S> {
    /// No motion.
    #[must_use]
    pub fn zero() -> Self {
        Twist {
            linear: Vector3::zeros(),
            angular: Vector3::zeros(),
        }
    }

    /// A translation.
    #[must_use]
    pub fn slide(linear: Vector3<S>) -> Self {
        Twist {
            linear,
            angular: Vector3::zeros(),
        }
    }

    /// A rotation about an axis through the origin of frame 2.
    #[must_use]
    pub fn spin(angular: Vector3<S>) -> Self {
        Twist {
            linear: Vector3::zeros(),
            angular,
        }
    }
}

/// Joint coordinates q, joint speeds u and the joint's numbers. A number that is not there reads as NaN.
#[derive(Clone, Copy, Debug)]
pub struct Relative<'a, S> {
    /// Coordinates.
    pub q: &'a [S],
    /// Speeds.
    pub u: &'a [S],
    /// Numbers of the joint, in the order of [`crate::joints::JointDefinition::numbers`].
    pub numbers: &'a [S],
}

fn read<S: Real>(list: &[S], index: usize) -> S {
    list.get(index)
        .copied()
        .unwrap_or_else(|| S::from_f64(f64::NAN))
}

impl<S: Real> Relative<'_, S> {
    /// Coordinate number `index`.
    #[must_use]
    pub fn q(&self, index: usize) -> S {
        read(self.q, index)
    }

    /// Speed number `index`.
    #[must_use]
    pub fn u(&self, index: usize) -> S {
        read(self.u, index)
    }

    /// Number `index` of the joint.
    #[must_use]
    pub fn number(&self, index: usize) -> S {
        read(self.numbers, index)
    }

    /// Three speeds from `at` on.
    #[must_use]
    pub fn u3(&self, at: usize) -> Vector3<S> {
        Vector3::from_fn(|i, _| self.u(at + i))
    }

    /// Three coordinates from `at` on.
    #[must_use]
    pub fn q3(&self, at: usize) -> Vector3<S> {
        Vector3::from_fn(|i, _| self.q(at + i))
    }

    /// The attitude R12 of a quaternion w x y z from `at` on.
    #[must_use]
    pub fn attitude(&self, at: usize) -> Matrix3<S> {
        rotation(std::array::from_fn(|i| self.q(at + i)))
    }

    /// Writes q̇ of a quaternion from `q_at` on whose angular velocity in frame 2 are the speeds from `u_at` on: ½ q ⊗ (0, ω).
    pub fn attitude_rates(&self, q_at: usize, u_at: usize, rates: &mut [S]) {
        let quaternion = std::array::from_fn(|i| self.q(q_at + i));
        let all = quaternion_rate(quaternion, &self.u3(u_at), true);
        for (rate, value) in rates.iter_mut().skip(q_at).zip(all) {
            *rate = value;
        }
    }
}

/// Writes the three columns of a free attitude, whose speeds are the angular velocity in frame 2, from column `at` on.
pub fn attitude_columns<S: Real>(attitude: &Matrix3<S>, at: usize, columns: &mut [Twist<S>]) {
    for (axis, column) in columns.iter_mut().skip(at).take(3).enumerate() {
        *column = Twist::spin(attitude.column(axis).into_owned());
    }
}

/// Writes columns from the first on, as many as fit.
pub fn write<S: Real, const N: usize>(columns: &mut [Twist<S>], values: [Twist<S>; N]) {
    for (column, value) in columns.iter_mut().zip(values) {
        *column = value;
    }
}

/// A frame of the world in motion, world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameMotion<S: Real> {
    /// Its origin [m].
    pub position: Vector3<S>,
    /// Frame axes → world axes; `None`: parallel to the world for good.
    pub rotation: Option<Matrix3<S>>,
    /// Velocity of its origin [m/s].
    pub velocity: Vector3<S>,
    /// Angular velocity [rad/s].
    pub omega: Vector3<S>,
    /// Acceleration of its origin [m/s²].
    pub acceleration: Vector3<S>,
    /// Angular acceleration [rad/s²].
    pub alpha: Vector3<S>,
}
