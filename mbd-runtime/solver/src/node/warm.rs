//! The formulas of warm Newton, over any scalar: one solve, or several beside each other of which each is frozen when it is done.

use mbd_scene::{Real, solve_regular};
use nalgebra::Vector3;

use super::balance::{OneNode, Pulls, inner};

/// Rounding that is more than this part of all forces, over the root of the tolerance of rounding, resolves no balance: 1e-5 of them in f64, 0.2 in f32.
const UNRESOLVED: f64 = 300.0;

/// Where a descent stands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Standing<S: Real> {
    /// Whether nothing pulls and nothing is to be pulled.
    pub slack: S::Mask,
    /// Whether the residual is at its target.
    pub balanced: S::Mask,
}

/// When a descent is over: the residual over ΣT + |W| and over the floor, and the part of the floor below which ΣT is slack.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Targets<S> {
    pub relative: S,
    pub absolute: S,
    pub slack: S,
}

impl<S: Real> Targets<S> {
    /// The same over another scalar.
    pub(crate) fn map<R: Real>(self, number: impl Fn(S) -> R) -> Targets<R> {
        Targets {
            relative: number(self.relative),
            absolute: number(self.absolute),
            slack: number(self.slack),
        }
    }

    /// Where a descent stands with a residual |g| and a load |W|.
    #[inline]
    pub(crate) fn judge(&self, here: &Pulls<S>, residual: S, load: S) -> Standing<S> {
        let (zero, one) = (S::zero(), S::one());
        let (tension, floor) = (here.tension, here.floor);
        let is_zero = |x: S| S::both(x.le(zero), zero.le(x));
        let faint = S::select(tension.le(self.slack * floor), one, zero);
        let idle = S::select(is_zero(here.stretched), one, faint);
        let (scale, rounding) = (tension + load, self.absolute * floor);
        // Several nodes that nothing holds against their load fly off, until rounding of their places outweighs it: that is no balance.
        let rounding = match here.nodes {
            0 | 1 => rounding,
            _ => {
                let most = S::from_f64(UNRESOLVED) * self.absolute.sqrt() * scale;
                let too_much = S::both(zero.lt(load), most.lt(rounding));
                S::select(too_much, most, rounding)
            }
        };
        let target = self.relative * scale + rounding;
        Standing {
            slack: S::both(is_zero(load), zero.lt(idle)),
            balanced: residual.le(target),
        }
    }
}

/// The Newton direction δ of one node, and whether H is certainly regular there, as it is at almost every step; `epsilon` is the rounding unit.
#[inline]
pub(crate) fn direction_of_one<S: Real>(here: &OneNode<S>, epsilon: S) -> (Vector3<S>, S::Mask) {
    let ([xx, xy, xz, yy, yz, zz], [gx, gy, gz]) = (here.stiffness, here.gradient);
    let shift = shift(xx + yy + zz, epsilon);
    let shifted = [xx + shift, xy, xz, yy + shift, yz, zz + shift];
    let (delta, margin) = solve_regular(shifted, &-Vector3::new(gx, gy, gz));
    // 0 x is zero for a finite number and NaN for others.
    let zero = S::zero();
    let faults = delta.iter().fold(zero, |sum, x| sum + zero * *x);
    (delta, S::both(zero.lt(margin), zero.le(faults)))
}

/// The smallest r of a Newton step: it keeps a line taut whose kink the step would land on.
pub(crate) fn shift<S: Real>(trace: S, epsilon: S) -> S {
    S::from_f64(4.5) * epsilon * trace
}

/// The Euclidean length of a vector, and whether that is certain: the squares neither overflow nor underflow, or all numbers are zero.
#[inline]
pub(crate) fn certain_norm<S: Real>(list: &[S; 3], epsilon: S) -> (S, S::Mask) {
    let (zero, one) = (S::zero(), S::one());
    let square = inner(list, list);
    let safe = is_safe(square, epsilon);
    let sum = list.iter().fold(zero, |sum, x| sum + x.abs());
    let certain = S::select(safe, one, S::select(sum.le(zero), one, zero));
    (S::select(safe, square, zero).sqrt(), zero.lt(certain))
}

/// Whether a sum of squares lost nothing but what is rounding of the others.
pub(crate) fn is_safe<S: Real>(square: S, epsilon: S) -> S::Mask {
    let [low, high] = [epsilon * epsilon, S::one() / epsilon];
    S::both(low.lt(square), square.lt(high * high))
}

/// Where a node would be that moved as its anchors do on the average [m].
#[inline]
pub(crate) fn carried<S: Real>(
    last: Vector3<S>,
    displacements: impl ExactSizeIterator<Item = Vector3<S>>,
) -> Vector3<S> {
    let share = S::one() / S::from_f64(displacements.len().max(1) as f64);
    displacements.fold(last, |moved, step| moved + step.map(|x| share * x))
}

/// Where the search for a node begins: there, and further by what it moves against its anchors [m/s] in the time τ since. Without that Newton takes
/// a step more. Of one node; of several the tolerance of the balance, and not rounding, would say how near the start is.
pub(crate) fn predicted<S: Real>(carried: Vector3<S>, against: Vector3<S>, tau: S) -> Vector3<S> {
    carried + against.map(|x| tau * x)
}

/// How fast a node moves against its anchors [m/s], by its place τ after it was carried along with them.
pub(crate) fn against<S: Real>(place: Vector3<S>, carried: Vector3<S>, tau: S) -> Vector3<S> {
    let per_second = S::one() / tau;
    (place - carried).map(|x| per_second * x)
}
