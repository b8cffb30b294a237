//! Inertia and forces along the tree.
//!
//! ```text
//! f = m a + α × h + ω × (ω × h),   n = I α + ω × I ω + h × a            a body at the origin of its link: h = m c, I about it     (1)
//! f_p += E f,   n_p += E n + r × E f                                    what a link hands on to the one that carries it          (2)
//! τ = Hᵀ [f; n]                                                                                                                  (3)
//! m_p += m,  h_p += E h + m r,  I_p += E I Eᵀ + 2 (r·Eh) 1 − Eh rᵀ − r Ehᵀ + m (r·r 1 − r rᵀ)     composite bodies               (4)
//! ```
//!
//! Source: Featherstone, Rigid Body Dynamics Algorithms: recursive Newton–Euler (5), composite bodies (6), with accelerations of points in place of
//! spatial ones.

use nalgebra::{Matrix3, Vector3};

use super::kinematics::LinkMotion;
use crate::laws::numbers::BodyNumbers;
use crate::scalar::algebra::labelled;
use crate::{Real, Twist};

/// Mass, first moment and inertia about the origin of a link, its axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inertia<S: Real> {
    /// m [kg].
    pub mass: S,
    /// h [kg m].
    pub moment: Vector3<S>,
    /// I [kg m²].
    pub inertia: Matrix3<S>,
}

impl<S: Real> Inertia<S> {
    /// That of the body of a link.
    pub fn of(body: &BodyNumbers<S>, link: &LinkMotion<S>) -> Self {
        let c = &link.centre;
        let about_centre = link.body * body.inertia * link.body.transpose();
        let square = c.dot(c);
        Inertia {
            mass: body.mass,
            moment: labelled(
                c.map(|x| body.mass * x),
                ["moment_x", "moment_y", "moment_z"],
            ),
            inertia: symmetric_from(|i, j| {
                let diagonal = if i == j { square } else { S::zero() };
                about_centre[(i, j)] + body.mass * (diagonal - c[i] * c[j])
            }),
        }
    }

    /// Nothing.
    pub fn none() -> Self {
        Inertia {
            mass: S::zero(),
            moment: Vector3::zeros(),
            inertia: Matrix3::zeros(),
        }
    }

    /// (1) for an acceleration, of a body at rest.
    pub fn push(&self, motion: &Twist<S>) -> Twist<S> {
        let (a, alpha) = (&motion.linear, &motion.angular);
        Twist {
            linear: a.map(|x| self.mass * x) + alpha.cross(&self.moment),
            angular: self.inertia * alpha + self.moment.cross(a),
        }
    }

    /// What velocities add in (1).
    pub fn gyroscopic(&self, omega: &Vector3<S>) -> Twist<S> {
        Twist {
            linear: omega.cross(&omega.cross(&self.moment)),
            angular: omega.cross(&(self.inertia * omega)),
        }
    }

    /// Adds the inertia of a link that this one carries, by (4).
    pub fn take(&mut self, other: &Self, link: &LinkMotion<S>) {
        let (r, turn) = (&link.offset, &link.turn);
        let moment = turn * other.moment;
        let rotated = turn * other.inertia * turn.transpose();
        let (along, square) = (moment.dot(r), r.dot(r));
        let diagonal = along + along + other.mass * square;
        // h rᵀ + r hᵀ + m r rᵀ = w rᵀ + r hᵀ with w = h + m r, which is the moment that is handed on.
        let whole = moment + r.map(|x| other.mass * x);
        let moved = symmetric_from(|i, j| {
            let across = whole[i] * r[j] + r[i] * moment[j];
            let diagonal = if i == j { diagonal } else { S::zero() };
            rotated[(i, j)] + (diagonal - across)
        });
        self.mass += other.mass;
        self.moment += whole;
        self.inertia += moved;
    }
}

/// A symmetric matrix from its lower triangle.
fn symmetric_from<S: Real>(of: impl Fn(usize, usize) -> S) -> Matrix3<S> {
    let mut matrix = Matrix3::zeros();
    for i in 0..3 {
        for j in 0..=i {
            matrix[(i, j)] = of(i, j);
            matrix[(j, i)] = matrix[(i, j)];
        }
    }
    matrix
}

impl<S: Real> LinkMotion<S> {
    /// (2): a force and a couple at the origin of the link, at that of the link which carries it.
    pub(super) fn hand_on(&self, push: &Twist<S>) -> Twist<S> {
        let force = self.turn * push.linear;
        Twist {
            angular: self.turn * push.angular + self.offset.cross(&force),
            linear: force,
        }
    }

    /// (3) of column number `k`.
    pub(super) fn along(&self, k: usize, push: &Twist<S>) -> S {
        self.columns
            .get(k)
            .map_or_else(S::zero, |column| column.dot(push))
    }

    /// Its acceleration by velocities alone, where what carries it has none.
    pub(super) fn brought(&self) -> Twist<S> {
        self.accelerated(&Twist::zero(), &[])
    }

    /// The acceleration of the link by (3) of [`super::kinematics`], from that of the link that carries it and the accelerations of its coordinates.
    pub(super) fn accelerated(&self, inboard: &Twist<S>, rates: &[S]) -> Twist<S> {
        let (w, r) = (&self.inboard_omega, &self.offset);
        let carried = inboard.linear + inboard.angular.cross(r) + w.cross(&w.cross(r));
        let back = self.turn.transpose();
        let mut motion = Twist {
            linear: back * carried + self.bias.linear,
            angular: back * inboard.angular + self.bias.angular,
        };
        for (column, &rate) in self.columns.iter().zip(rates) {
            motion = motion.plus(column, rate);
        }
        motion
    }

    /// A force on the body at its centre of mass and a couple, world axes, and a couple in its own components, at the origin of the link.
    pub(super) fn taken(&self, [force, torque]: [&Vector3<S>; 2], own: &Vector3<S>) -> Twist<S> {
        let back = self.axes.transpose();
        let force = back * force;
        Twist {
            angular: back * torque + self.body * own + self.centre.cross(&force),
            linear: force,
        }
    }
}

impl<S: Real> Twist<S> {
    /// Adds another.
    pub(super) fn add(&mut self, other: &Self) {
        self.linear += other.linear;
        self.angular += other.angular;
    }
}
