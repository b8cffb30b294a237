//! The two ends of a joint in motion: all a row may depend on.
//!
//! Every vector of an end is written in the end's **own components**: along its body's axes (`AngularVelocity::Body`) or along world axes
//! (`AngularVelocity::World`). Two turns connect them: A takes child components to parent components, `outward` takes own components to
//! world axes. With world components both are the identity and cost nothing, so one text gives both tables of rows.

use std::cell::OnceCell;

use nalgebra::{Matrix3, Vector3};

use crate::scalar::algebra::labelled;
use crate::{AngularVelocity, Axis, FrameMotion, Real};

/// A rotation, or none at all.
#[derive(Clone, Copy, Debug)]
pub enum Rotation<S: Real> {
    /// The same components on both sides.
    Identity,
    /// By a matrix.
    Matrix(Matrix3<S>),
}

impl<S: Real> From<Option<Matrix3<S>>> for Rotation<S> {
    fn from(rotation: Option<Matrix3<S>>) -> Self {
        rotation.map_or(Rotation::Identity, Rotation::Matrix)
    }
}

impl<S: Real> Rotation<S> {
    /// R v.
    pub fn apply(&self, v: &Vector3<S>) -> Vector3<S> {
        match self {
            Rotation::Identity => *v,
            Rotation::Matrix(r) => r * v,
        }
    }

    /// Rᵀ v.
    pub fn back(&self, v: &Vector3<S>) -> Vector3<S> {
        match self {
            Rotation::Identity => *v,
            Rotation::Matrix(r) => r.transpose() * v,
        }
    }

    /// Rᵀ e_k: row k of R.
    pub fn row(&self, k: usize) -> Vector3<S> {
        let unit = |i: usize| if i == k { S::one() } else { S::zero() };
        match self {
            Rotation::Identity => Vector3::from_fn(|i, _| unit(i)),
            Rotation::Matrix(r) => Vector3::from_fn(|i, _| r[(k.min(2), i)]),
        }
    }

    /// R e_k: column k of R.
    pub fn column(&self, k: usize) -> Vector3<S> {
        let unit = |i: usize| if i == k { S::one() } else { S::zero() };
        match self {
            Rotation::Identity => Vector3::from_fn(|i, _| unit(i)),
            Rotation::Matrix(r) => Vector3::from_fn(|i, _| r[(i, k.min(2))]),
        }
    }

    /// self other: other first.
    pub fn after(&self, other: &Rotation<S>) -> Rotation<S> {
        match (self, other) {
            (Rotation::Identity, other) => *other,
            (turn, Rotation::Identity) => *turn,
            (Rotation::Matrix(a), Rotation::Matrix(b)) => Rotation::Matrix(a * b),
        }
    }

    /// self otherᵀ: other back first.
    pub fn after_back(&self, other: &Rotation<S>) -> Rotation<S> {
        match (self, other) {
            (turn, Rotation::Identity) => *turn,
            (Rotation::Identity, Rotation::Matrix(r)) => Rotation::Matrix(r.transpose()),
            (Rotation::Matrix(a), Rotation::Matrix(b)) => Rotation::Matrix(a * b.transpose()),
        }
    }

    /// selfᵀ other.
    pub fn to(&self, other: &Rotation<S>) -> Rotation<S> {
        match (self, other) {
            (Rotation::Identity, other) => *other,
            (Rotation::Matrix(r), Rotation::Identity) => Rotation::Matrix(r.transpose()),
            (Rotation::Matrix(a), Rotation::Matrix(b)) => Rotation::Matrix(a.transpose() * b),
        }
    }
}

/// One end: a place on a body, at a point with mass or in the world. Of a frame of the world that moves, what stands below for the
/// centre of mass is its origin, and its own components are along world axes.
#[derive(Clone, Copy, Debug)]
pub struct End<S: Real> {
    /// Centre of mass, world axes [m].
    pub position: Vector3<S>,
    /// Its velocity, world axes [m/s].
    pub velocity: Vector3<S>,
    /// Angular velocity, own components [rad/s].
    pub omega: Vector3<S>,
    /// Own components → world axes.
    pub outward: Rotation<S>,
    /// The joint's point from the centre of mass, own components [m].
    pub arm: Vector3<S>,
    /// The point whose velocity the columns of the rows multiply, from the centre of mass, own components [m].
    pub reference: Vector3<S>,
    /// Joint frame → own components.
    pub frame: Rotation<S>,
    /// Acceleration of `position` [m/s²] and angular acceleration [rad/s²] where time alone prescribes them, world axes.
    pub prescribed: Option<[Vector3<S>; 2]>,
}

impl<S: Real> End<S> {
    /// An end fixed in the world, at `arm` from its origin.
    pub fn fixed(arm: Vector3<S>, frame: Rotation<S>) -> Self {
        End {
            position: Vector3::zeros(),
            velocity: Vector3::zeros(),
            omega: Vector3::zeros(),
            outward: Rotation::Identity,
            arm,
            reference: Vector3::zeros(),
            frame,
            prescribed: None,
        }
    }

    /// An end on a frame of the world that moves.
    pub fn moving(motion: &FrameMotion<S>) -> Self {
        End {
            position: motion.position,
            velocity: motion.velocity,
            omega: motion.omega,
            prescribed: Some([motion.acceleration, motion.alpha]),
            ..End::fixed(Vector3::zeros(), motion.rotation.into())
        }
    }

    /// An axis of the joint frame, own components.
    pub fn axis(&self, axis: &Axis) -> Vector3<S> {
        self.frame.apply(&axis.vector())
    }

    /// The joint's point from the reference point, own components [m].
    pub fn lever(&self) -> Vector3<S> {
        self.arm - self.reference
    }

    /// Velocity of the reference point, world axes [m/s], and angular velocity, own components [rad/s].
    pub fn velocities(&self) -> [Vector3<S>; 2] {
        let turning = self.outward.apply(&self.omega.cross(&self.reference));
        [self.velocity + turning, self.omega]
    }

    /// ω × arm: velocity of the joint's point against the centre of mass, own components [m/s].
    pub fn swing(&self) -> Vector3<S> {
        self.omega.cross(&self.arm)
    }
}

/// What perpendicular and in-plane rows share: the child's angular velocity seen from the parent.
#[derive(Clone, Copy, Debug)]
pub struct Spin<S: Real> {
    /// w = ω_p − A ω_c, parent components [rad/s].
    pub difference: Vector3<S>,
    /// w·w.
    pub square: S,
    /// ω_p × ω_c.
    pub cross: Vector3<S>,
}

impl<S: Real> Spin<S> {
    fn new(parent: &Vector3<S>, child: &Vector3<S>) -> Self {
        let child = labelled(*child, ["child_w_x", "child_w_y", "child_w_z"]);
        let difference = labelled(
            parent - child,
            ["relative_w_x", "relative_w_y", "relative_w_z"],
        );
        Spin {
            difference,
            square: difference.dot(&difference).label("relative_w_squared"),
            cross: labelled(
                parent.cross(&child),
                ["w_cross_x", "w_cross_y", "w_cross_z"],
            ),
        }
    }
}
/// The elements of A.
const RELATIVE: [[&str; 3]; 3] = [
    ["a11", "a12", "a13"],
    ["a21", "a22", "a23"],
    ["a31", "a32", "a33"],
];

/// Parent end and child end of a joint, and its numbers.
#[derive(Clone, Debug)]
pub struct Ends<'a, S: Real> {
    /// The parent's end.
    pub parent: End<S>,
    /// The child's end.
    pub child: End<S>,
    numbers: &'a [S],
    components: AngularVelocity,
    relative: OnceCell<Rotation<S>>,
    spin: OnceCell<Spin<S>>,
    spin_in_child: OnceCell<Spin<S>>,
}

impl<'a, S: Real> Ends<'a, S> {
    /// Two ends whose own components are along body axes or along world axes, and the numbers of the joint.
    pub fn new(
        parent: End<S>,
        child: End<S>,
        numbers: &'a [S],
        components: AngularVelocity,
    ) -> Self {
        Ends {
            parent,
            child,
            numbers,
            components,
            relative: OnceCell::new(),
            spin: OnceCell::new(),
            spin_in_child: OnceCell::new(),
        }
    }

    /// Number `index` of the joint; NaN if there is none.
    pub fn number(&self, index: usize) -> S {
        self.numbers
            .get(index)
            .copied()
            .unwrap_or_else(|| S::from_f64(f64::NAN))
    }

    /// A: child components → parent components.
    pub fn relative(&self) -> &Rotation<S> {
        self.relative.get_or_init(|| match self.components {
            AngularVelocity::World => Rotation::Identity,
            AngularVelocity::Body => match self.parent.outward.to(&self.child.outward) {
                Rotation::Matrix(rotation) => Rotation::Matrix(Matrix3::from_fn(|row, column| {
                    rotation[(row, column)].label(RELATIVE[row][column])
                })),
                Rotation::Identity => Rotation::Identity,
            },
        })
    }

    /// The child's angular velocity seen from the parent.
    pub fn spin(&self) -> &Spin<S> {
        self.spin.get_or_init(|| {
            Spin::new(
                &self.parent.omega,
                &self.relative().apply(&self.child.omega),
            )
        })
    }

    /// The same in child components.
    pub fn spin_in_child(&self) -> &Spin<S> {
        self.spin_in_child.get_or_init(|| {
            let parent = self.relative().back(&self.parent.omega);
            Spin::new(&parent, &self.child.omega)
        })
    }

    /// An axis of frame 1, child components.
    pub fn in_child(&self, axis: &Axis) -> Vector3<S> {
        self.relative().back(&self.parent.axis(axis))
    }

    /// d: the child's joint point from the parent's, world axes [m].
    pub fn gap(&self) -> Vector3<S> {
        let (p, c) = (&self.parent, &self.child);
        c.position + c.outward.apply(&c.arm) - p.position - p.outward.apply(&p.arm)
    }

    /// ḋ, world axes [m/s].
    pub fn gap_rate(&self) -> Vector3<S> {
        let (p, c) = (&self.parent, &self.child);
        c.velocity + c.outward.apply(&c.swing()) - p.velocity - p.outward.apply(&p.swing())
    }

    /// e: the child's joint point from the parent's centre of mass, parent components [m].
    pub fn reach(&self) -> Vector3<S> {
        let (p, c) = (&self.parent, &self.child);
        p.outward.back(&(c.position - p.position)) + self.relative().apply(&c.arm)
    }

    /// Velocity of the child's joint point against the parent's centre of mass, parent components [m/s].
    pub fn reach_rate(&self) -> Vector3<S> {
        let (p, c) = (&self.parent, &self.child);
        p.outward.back(&(c.velocity - p.velocity)) + self.relative().apply(&c.swing())
    }

    /// u − ω_p × e: velocity of the child's joint point seen from the parent, parent components [m/s].
    pub fn slide_rate(&self) -> Vector3<S> {
        self.reach_rate() - self.parent.omega.cross(&self.reach())
    }

    /// Axis number `k` of frame 1, world axes.
    pub fn direction(&self, k: usize) -> Vector3<S> {
        self.parent.outward.apply(&self.parent.frame.column(k))
    }

    /// Cosine of the angle between axis `a` of frame 1 and axis `b` of frame 2.
    pub fn cosine(&self, a: &Axis, b: &Axis) -> S {
        let b = self.relative().apply(&self.child.axis(b));
        self.parent.axis(a).dot(&b)
    }
}
