//! Articulated bodies: accelerations of a tree in one pass to the root and one back, linear in the number of links.
//!
//! ```text
//! f = M a + K α + p_f,   n = Kᵀ a + J α + p_n          what a link and all it carries ask of its joint                        (1)
//! A = X A_p + ζ + Σ h u̇                                 its acceleration: that of what carries it, velocities, its coordinates  (2)
//! U = I h,  D = h·U,  u̇ = (τ − h·p − U·A)/D;   I −= U Uᵀ/D,  p += U (τ − h·p)/D       for each column h, last to first         (3)
//! I_p += Xᵀ I X,   p_p += Xᵀ (p + I ζ)                                                                                         (4)
//! ```
//!
//! A column that a motor drives is no free one: its h u̇ belongs to ζ, and the motor pushes with h·f − τ (Featherstone, §9.2: hybrid dynamics).
//!
//! I = (M, K, J) of (1) at the origin of the link; of M all but the mass m on its diagonal is kept, which moves to other axes unchanged. Where a
//! column is one of the six axes, its row and column vanish by (3) and are left out. Source: Featherstone, Rigid Body Dynamics Algorithms, ch. 7.

use nalgebra::{Matrix3, Vector3};

use super::inertia::SpatialInertia;
use super::kinematics::LinkMotion;
use crate::{Real, Twist};

/// A column that has been eliminated.
#[derive(Clone, Copy, Debug)]
struct EliminatedColumn<S: Real> {
    /// U.
    push: Twist<S>,
    /// 1/D.
    inverse: S,
    /// τ − h·p.
    work: S,
}

/// A link with all that it carries.
#[derive(Clone, Debug)]
pub(super) struct Articulated<S: Real> {
    /// m.
    mass: S,
    /// M − m.
    linear: Matrix3<S>,
    /// K.
    mixed: Matrix3<S>,
    /// J.
    angular: Matrix3<S>,
    /// p.
    push: Twist<S>,
    columns: [EliminatedColumn<S>; 6],
}

impl<S: Real> Articulated<S> {
    /// A body by itself, and what it asks for at rest.
    pub fn of(rigid: &SpatialInertia<S>, push: Twist<S>) -> Self {
        Articulated {
            mass: rigid.mass,
            linear: Matrix3::zeros(),
            mixed: -rigid.moment.cross_matrix(),
            angular: rigid.inertia,
            push,
            columns: [EliminatedColumn {
                push: Twist::zero(),
                inverse: S::zero(),
                work: S::zero(),
            }; 6],
        }
    }

    /// I of (1) times an acceleration.
    fn times(&self, motion: &Twist<S>) -> Twist<S> {
        let (a, alpha) = (&motion.linear, &motion.angular);
        Twist {
            linear: a.map(|x| self.mass * x) + self.linear * a + self.mixed * alpha,
            angular: self.mixed.transpose() * a + self.angular * alpha,
        }
    }

    /// Takes the free columns of its joint out, by (3); `forces` act along all of them.
    pub fn release(
        &mut self,
        motion: &LinkMotion<S>,
        forces: &[S],
        is_free: impl Fn(usize) -> bool,
    ) {
        let columns = motion.columns.iter().zip(forces).enumerate().rev();
        for (k, (column, &force)) in columns.filter(|(k, _)| is_free(*k)) {
            let push = labelled(self.times(column), ["U1", "U2", "U3", "U4", "U5", "U6"]);
            let pivot = column.dot(&push).label("D");
            let inverse = S::one() / pivot;
            let work = force - column.dot(&self.push);
            self.columns[k] = EliminatedColumn {
                push,
                inverse,
                work,
            };
            self.take_off(&push, inverse);
            self.push = self.push.plus(&push, work * inverse);
            if let Some(axis) = unit(column) {
                self.clear(axis, force);
            }
        }
    }

    /// I −= U Uᵀ/D.
    fn take_off(&mut self, push: &Twist<S>, inverse: S) {
        let [u, w] = [push.linear, push.angular];
        let [scaled_u, scaled_w] =
            [u, w].map(|v| v.map(|x| if x.is_zero() { x } else { x * inverse }));
        for i in 0..3 {
            for j in 0..=i {
                self.linear[(i, j)] -= scaled_u[i] * u[j];
                self.linear[(j, i)] = self.linear[(i, j)];
                self.angular[(i, j)] -= scaled_w[i] * w[j];
                self.angular[(j, i)] = self.angular[(i, j)];
            }
            for j in 0..3 {
                self.mixed[(i, j)] -= scaled_u[i] * w[j];
            }
        }
    }

    /// Leaves out the row and the column of an axis along which the link is free.
    fn clear(&mut self, axis: usize, force: S) {
        let (zero, k) = (S::zero(), axis % 3);
        for i in 0..3 {
            if axis < 3 {
                let own = if i == k { -self.mass } else { zero };
                (self.linear[(i, k)], self.linear[(k, i)]) = (own, own);
                self.mixed[(k, i)] = zero;
            } else {
                (self.angular[(i, k)], self.angular[(k, i)]) = (zero, zero);
                self.mixed[(i, k)] = zero;
            }
        }
        match axis {
            0..=2 => self.push.linear[k] = force,
            _ => self.push.angular[k] = force,
        }
    }

    /// Hands a link that has released its columns on to the one that carries it, by (4). `brought`: ζ of (2).
    pub fn take(&mut self, other: &Self, motion: &LinkMotion<S>, brought: &Twist<S>) {
        let (turn, r) = (&motion.turn, motion.offset.cross_matrix());
        let [linear, angular] = [&other.linear, &other.angular].map(|block| turn.congruent(block));
        let mixed = turn.similar(&other.mixed);
        let moved = mixed - linear * r - r.map(|x| other.mass * x);
        self.mass += other.mass;
        self.linear += linear;
        self.mixed += moved;
        self.angular += symmetric(&(angular - mixed.transpose() * r + r * moved));
        self.push.add(&motion.hand_on(&other.force(brought)));
    }

    /// U and 1/D of a column that it has released.
    pub fn eliminated(&self, k: usize) -> (Twist<S>, S) {
        let EliminatedColumn { push, inverse, .. } = self.columns[k];
        (push, inverse)
    }

    /// What its joint pushes with, by (1), at its acceleration without the free columns.
    pub fn force(&self, own: &Twist<S>) -> Twist<S> {
        let mut push = self.times(own);
        push.add(&self.push);
        push
    }

    /// The accelerations of its free coordinates and of itself, by (2) and (3), from its acceleration without them.
    pub fn find(
        &self,
        motion: &LinkMotion<S>,
        mut own: Twist<S>,
        rates: &mut [S],
        is_free: impl Fn(usize) -> bool,
    ) -> Twist<S> {
        for (k, column) in motion
            .columns
            .iter()
            .enumerate()
            .filter(|(k, _)| is_free(*k))
        {
            let free = &self.columns[k];
            let rate = (free.work - free.push.dot(&own)) * free.inverse;
            rates[k] = rate;
            own = own.plus(column, rate);
        }
        own
    }
}

/// A matrix whose upper triangle repeats the lower one.
fn symmetric<S: Real>(matrix: &Matrix3<S>) -> Matrix3<S> {
    Matrix3::from_fn(|i, j| matrix[(i.max(j), i.min(j))])
}

/// The axis that a column is, of three along and three about.
pub(super) fn unit<S: Real>(column: &Twist<S>) -> Option<usize> {
    let all = || column.linear.iter().chain(column.angular.iter());
    let mut own = all().enumerate().filter(|(_, x)| !x.is_zero());
    let (axis, _) = own.next().filter(|(_, x)| x.is_one())?;
    own.next().is_none().then_some(axis)
}

fn labelled<S: Real>(push: Twist<S>, names: [&'static str; 6]) -> Twist<S> {
    let name = |v: Vector3<S>, at: usize| Vector3::from_fn(|i, _| v[i].label(names[at + i]));
    Twist {
        linear: name(push.linear, 0),
        angular: name(push.angular, 3),
    }
}

/// The matrix of a cross product.
trait CrossMatrix<S: Real> {
    fn cross_matrix(&self) -> Matrix3<S>;
}

impl<S: Real> CrossMatrix<S> for Vector3<S> {
    fn cross_matrix(&self) -> Matrix3<S> {
        let (zero, v) = (S::zero(), self);
        Matrix3::new(zero, -v.z, v.y, v.z, zero, -v.x, -v.y, v.x, zero)
    }
}
