//! What a joint tells the solver about the velocity of its child: the columns H that its rows leave free, and columns N that its rows hold.
//!
//! ```text
//! V_c = X V_p + H u + N ν                  velocity of the child at its joint point Q                             (1)
//! rows:  C (V_c − X V_p) = γ               C: the columns of the rows on the child at Q                           (2)
//! C H = 0,   C N = 1                       on the constraints and off them                                        (3)
//! ```
//!
//! X takes the motion of the parent to a point as a rigid body does: to the parent's joint point P where the points coincide, to Q where the
//! child slides. By (3) the rows are solved by ν = γ, whatever u: exact off the constraints, too, and the rest of the elimination sees
//! H alone. Rows marked `after` are solved one after the other behind the first ones; for them (3) is triangular.
//! Source: Featherstone, Rigid Body Dynamics Algorithms, motion subspace; coordinate partitioning (Wehage and Haug) for N.

use nalgebra::{Matrix3, Vector3};

use super::{Axis, Twist};
use crate::Real;
use crate::rows::{Ends, couple};
use crate::scalar::Few;

/// A column of N.
#[derive(Clone, Copy, Debug)]
pub struct HeldDirection<S: Real> {
    /// Its direction.
    pub column: Twist<S>,
    /// What it is multiplied by.
    pub inverse: S,
    /// Whether its row is solved behind those before it: the row may see their columns, and they do not see this one.
    pub after: bool,
}

/// H and N of a joint at Q: linear along world axes, angular along the components of the child's end, or along `axes`.
#[derive(Clone, Debug)]
pub struct Carried<S: Real> {
    /// H, one column a freedom; that of a coordinate at the coordinate's number, seen by no motor but its own.
    pub free: Few<Twist<S>, 3>,
    /// N, one column a row, in the order of the rows.
    pub held: Few<HeldDirection<S>, 6>,
    /// The axes of the angular parts, as columns, where they are not those of the child's end.
    pub axes: Option<Matrix3<S>>,
    /// N γ of the rows that are not `after`, besides what (1) brings along with the parent's motion, where there is a short form for it.
    pub bias: Option<Twist<S>>,
    /// Whether the joint points coincide, so that X takes the parent's motion to P; to Q else.
    pub meets: bool,
}

impl<S: Real> HeldDirection<S> {
    fn new(column: Twist<S>, inverse: S) -> Self {
        HeldDirection {
            column,
            inverse,
            after: false,
        }
    }
}

impl<S: Real> Carried<S> {
    /// Nothing free and nothing held yet.
    pub(crate) fn new(meets: bool) -> Self {
        Carried {
            free: Few::new(Twist::zero()),
            held: Few::new(HeldDirection::new(Twist::zero(), S::zero())),
            axes: None,
            bias: None,
            meets,
        }
    }

    /// The points coincide: three rows, N = 1 in world axes.
    #[must_use]
    pub fn coincide() -> Self {
        let mut carried = Carried::new(true);
        for axis in [Axis::X, Axis::Y, Axis::Z] {
            carried
                .held
                .push(HeldDirection::new(Twist::slide(axis.vector()), S::one()));
        }
        carried
    }

    /// Q stays where it is along these axes of frame 1, at right angles to each other: one row each, N the axes.
    #[must_use]
    pub fn in_planes(ends: &Ends<'_, S>, axes: &[Axis]) -> Self {
        let mut carried = Carried::new(false);
        for axis in axes {
            let along = ends.parent.outward.apply(&ends.parent.axis(axis));
            carried
                .held
                .push(HeldDirection::new(Twist::slide(along), S::one()));
        }
        carried
    }

    /// The child is free to move along an axis of frame 1.
    #[must_use]
    pub fn slides(mut self, ends: &Ends<'_, S>, axis: &Axis) -> Self {
        let along = ends.parent.outward.apply(&ends.parent.axis(axis));
        self.free.push(Twist::slide(along));
        self
    }

    /// The child is free to turn about an axis that both frames share, and held by the rows u1·a2 = v1·a2 = 0 of its complement:
    ///
    /// ```text
    /// H = a2,   N = [v1, −u1]/(a1·a2),   N γ = a1 × g/(a1·a2),   g = |w|² a2 − (a2·w) w,  w = ω_p − ω_c        (4)
    /// ```
    #[must_use]
    pub fn turns(mut self, ends: &Ends<'_, S>, axis: &Axis) -> Self {
        let [u, v] = axis.complement();
        let [a, u, v] = [*axis, u, v].map(|axis| ends.in_child(&axis));
        let own = ends.child.axis(axis);
        let spin = ends.spin_in_child();
        let w = spin.difference;
        let inverse = (S::one() / a.dot(&own)).label("inverse_cosine");
        let lean = own.map(|x| spin.square * x) - w.map(|x| own.dot(&w) * x);
        self.free.push(Twist::spin(own));
        self.held.push(HeldDirection::new(Twist::spin(v), inverse));
        self.held.push(HeldDirection::new(Twist::spin(-u), inverse));
        self.bias = Some(Twist::spin(a.cross(&lean).map(|x| x * inverse)));
        self
    }

    /// The child does not turn: rows (x1, y2), (y1, z2), (z1, x2), whose columns c make N the crosses of two over their product.
    #[must_use]
    pub fn locks(mut self, ends: &Ends<'_, S>, [x, y, z]: [Axis; 3]) -> Self {
        let [a, b, c] = [(x, y), (y, z), (z, x)].map(|(a, b)| couple(ends, &a, &b));
        let (bc, ca, ab) = (b.cross(&c), c.cross(&a), a.cross(&b));
        let inverse = (S::one() / a.dot(&bc)).label("inverse_product");
        let columns = [bc, ca, ab].map(|column| HeldDirection::new(Twist::spin(column), inverse));
        self.held.extend(columns);
        self
    }

    /// One more row, which holds the child along `column` alone.
    pub fn hold(&mut self, column: Twist<S>, inverse: S) {
        self.held.push(HeldDirection::new(column, inverse));
    }

    /// One more row, behind all others, that holds the child along `column`.
    pub fn hold_after(&mut self, column: Twist<S>, inverse: S) {
        self.held.push(HeldDirection {
            column,
            inverse,
            after: true,
        });
    }

    /// One more row behind all others, `row` its columns on the child at Q: it takes column `index` of H over to N.
    pub fn drive(&mut self, index: usize, row: &Twist<S>) {
        if index < self.free.len() {
            let column = self.free[index];
            self.hold_after(column, S::one() / row.dot(&column));
        }
    }

    /// N γ for right-hand sides of the rows, whose columns on the child at Q are `rows`.
    pub fn solve(
        &self,
        first: Twist<S>,
        rows: &[Twist<S>],
        right: impl Fn(usize) -> S,
    ) -> Twist<S> {
        let mut motion = first;
        for (number, (held, row)) in self.held.iter().zip(rows).enumerate() {
            if held.after {
                let left = right(number) - row.dot(&motion);
                motion = motion.plus(&held.column, left * held.inverse);
            }
        }
        motion
    }

    /// N γ of the rows that are not `after`.
    pub fn first(&self, right: impl Fn(usize) -> S) -> Twist<S> {
        let mut motion = Twist::zero();
        let held = self.held.iter().enumerate();
        for (number, held) in held.filter(|(_, held)| !held.after) {
            let right = right(number);
            if !right.is_zero() {
                motion = motion.plus(&held.column, right * held.inverse);
            }
        }
        motion
    }

    /// The multipliers x with Cᵀ x = push, for a push that does no work along H: Nᵀ of it, the rows behind the others first.
    pub fn multipliers(&self, mut push: Twist<S>, rows: &[Twist<S>]) -> [S; 6] {
        let mut multipliers = [S::zero(); 6];
        for after in [true, false] {
            let held = self.held.iter().zip(rows).enumerate().rev();
            for (number, (held, row)) in held.filter(|(_, (held, _))| held.after == after) {
                let x = held.inverse * held.column.dot(&push);
                multipliers[number] = x;
                if after {
                    push = push.plus(row, -x);
                }
            }
        }
        multipliers
    }
}

impl<S: Real> Twist<S> {
    /// The power of a force and couple over this velocity.
    #[must_use]
    pub fn dot(&self, other: &Self) -> S {
        let products = |a: &Vector3<S>, b: &Vector3<S>| {
            let pairs = a
                .iter()
                .zip(b.iter())
                .filter(|(a, b)| !a.is_zero() && !b.is_zero());
            pairs.fold(S::zero(), |sum, (&a, &b)| sum + a * b)
        };
        products(&self.linear, &other.linear) + products(&self.angular, &other.angular)
    }

    /// self + factor × other.
    #[must_use]
    pub fn plus(&self, other: &Self, factor: S) -> Self {
        let sum = |a: &Vector3<S>, b: &Vector3<S>| {
            a.zip_map(b, |a, b| if b.is_zero() { a } else { a + factor * b })
        };
        Twist {
            linear: sum(&self.linear, &other.linear),
            angular: sum(&self.angular, &other.angular),
        }
    }
}
