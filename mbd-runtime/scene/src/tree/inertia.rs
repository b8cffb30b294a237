//! Inertia and forces along the tree.
//!
//! ```text
//! f = m a + G h,   n = I α + ω × I ω + h × a,   G = α̃ + ω̃ ω̃            a body at the origin of its link: h = m c, I about it     (1)
//! f_p += E f,   n_p += E n + r × E f                                    what a link hands on to the one that carries it          (2)
//! τ = Hᵀ [f; n]                                                                                                                  (3)
//! m_p += m,  h_p += E h + m r,  I_p += E I Eᵀ + 2 (r·Eh) 1 − Eh rᵀ − r Ehᵀ + m (r·r 1 − r rᵀ)     composite bodies               (4)
//! ```
//!
//! Source: Featherstone, Rigid Body Dynamics Algorithms: recursive Newton–Euler (5), composite bodies (6), with accelerations of points in place of
//! spatial ones.

use nalgebra::{Matrix3, Vector3};

use super::kinematics::LinkMotion;
use super::system::{TreeSystem, links};
use super::turn::Turn;
use crate::laws::evaluation::Evaluation;
use crate::laws::numbers::BodyNumbers;
use crate::scalar::algebra::labelled;
use crate::{Real, Twist};

/// Mass, first moment and inertia about the origin of a link, its axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SpatialInertia<S: Real> {
    /// m [kg].
    pub mass: S,
    /// h [kg m].
    pub moment: Vector3<S>,
    /// I [kg m²].
    pub inertia: Matrix3<S>,
}

impl<S: Real> SpatialInertia<S> {
    /// That of the body of a link.
    fn of(body: &BodyNumbers<S>, link: &LinkMotion<S>) -> Self {
        let c = &link.centre;
        let about_centre = link.body * body.inertia * link.body.transpose();
        let square = c.dot(c);
        SpatialInertia {
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
        SpatialInertia {
            mass: S::zero(),
            moment: Vector3::zeros(),
            inertia: Matrix3::zeros(),
        }
    }

    /// (1) with ω × I ω in the elements of G: what lengthens it is the inertia's own products alone.
    pub fn inertial(&self, motion: &Twist<S>, omega: &Vector3<S>) -> Twist<S> {
        let (a, alpha, i) = (&motion.linear, &motion.angular, &self.inertia);
        let (s, g) = (swirl(omega), gradient(alpha, omega));
        let along = |x: usize| {
            let (y, z) = ((x + 1) % 3, (x + 2) % 3);
            let own = i[(x, x)] * alpha[x] + s[(y, z)] * (i[(z, z)] - i[(y, y)]);
            let products = g[(y, x)] * i[(x, z)] - g[(z, x)] * i[(x, y)];
            own + products + (g[(y, y)] - g[(z, z)]) * i[(y, z)]
        };
        Twist {
            linear: a.map(|x| self.mass * x) + g * self.moment,
            angular: Vector3::from_fn(|x, _| along(x)) + self.moment.cross(a),
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

    /// Adds an inertia by (4): that of axes E, here `turn`, with their origin at r.
    pub fn take(&mut self, other: &Self, turn: &Turn<S>, r: &Vector3<S>) {
        let moment = turn.apply(&other.moment);
        let rotated = turn.congruent(&other.inertia);
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

impl<S: Real> TreeSystem<S> {
    /// Reads the inertias of the links, each as its body has it.
    pub(super) fn read_inertias(&mut self, evaluation: &Evaluation<'_, S>) {
        for (index, link) in links(evaluation.layout).iter().enumerate() {
            let body = &evaluation.numbers.bodies[link.body];
            self.inertias[index] = SpatialInertia::of(body, &evaluation.links[index]);
        }
    }

    /// Reads the inertias of the links with their parameters grouped.
    pub(super) fn group_inertias(&mut self, evaluation: &Evaluation<'_, S>) {
        self.read_inertias(evaluation);
        for (index, link) in links(evaluation.layout).iter().enumerate().rev() {
            let handed = link.grouped.take_out(&mut self.inertias[index]);
            if let Some(inboard) = link.inboard {
                let (axes, origin) = &evaluation.links[index].joint;
                self.inertias[inboard].take(&handed, &Turn::by(*axes), origin);
            }
        }
    }
}

/// ω̃ ω̃.
fn swirl<S: Real>(w: &Vector3<S>) -> Matrix3<S> {
    let squares = w.map(|x| x * x);
    symmetric_from(|i, j| match i == j {
        true => -(squares[(i + 1) % 3] + squares[(i + 2) % 3]),
        false => w[i] * w[j],
    })
}

/// G: how the acceleration of a link changes over its places.
fn gradient<S: Real>(alpha: &Vector3<S>, omega: &Vector3<S>) -> Matrix3<S> {
    let (s, a) = (swirl(omega), alpha);
    let zero = S::zero();
    s + Matrix3::new(zero, -a.z, a.y, a.z, zero, -a.x, -a.y, a.x, zero)
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
        let force = self.turn.apply(&push.linear);
        Twist {
            angular: self.turn.apply(&push.angular) + self.offset.cross(&force),
            linear: force,
        }
    }

    /// (3) of column number `k`.
    pub(super) fn along(&self, k: usize, push: &Twist<S>) -> S {
        self.columns
            .get(k)
            .map_or_else(S::zero, |column| column.dot(push))
    }

    /// The acceleration of the link by (3) of [`super::kinematics`] without those of its coordinates, from that of the link that carries it.
    pub(super) fn accelerated(&self, inboard: &Twist<S>) -> Twist<S> {
        let carried =
            inboard.linear + gradient(&inboard.angular, &self.inboard_omega) * self.offset;
        Twist {
            linear: self.turn.back(&carried) + self.bias.linear,
            angular: self.turn.back(&inboard.angular) + self.bias.angular,
        }
    }

    /// The part of it that velocities make.
    pub(super) fn brought(&self) -> Twist<S> {
        self.accelerated(&Twist::zero())
    }

    /// The part of it that the acceleration of the link that carries it makes.
    pub(super) fn followed(&self, inboard: &Twist<S>) -> Twist<S> {
        let carried = inboard.linear + inboard.angular.cross(&self.offset);
        Twist {
            linear: self.turn.back(&carried),
            angular: self.turn.back(&inboard.angular),
        }
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
