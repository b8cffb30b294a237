//! Ranges: what a law can be worth while its arguments are anywhere in theirs. The interval arithmetic of R. E. Moore, *Interval Analysis* (1966), without
//! the rounding outwards: for looks, not for proofs to the last digit.
//!
//! An argument that occurs twice counts as two, so that a range may be wider than what it stands for; it closes in on that as the arguments do.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use num_traits::{One, Zero};

use crate::Real;

/// All numbers from `low` to `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Range {
    /// The smallest.
    pub low: f64,
    /// The largest.
    pub high: f64,
}

/// What a comparison of ranges can say.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Possible {
    /// It can hold.
    holds: bool,
    /// It can fail.
    fails: bool,
}

impl Range {
    /// Every number.
    const EVERYTHING: Range = Range {
        low: f64::NEG_INFINITY,
        high: f64::INFINITY,
    };

    /// The range between two numbers, in either order; everything where one is not a number.
    pub(crate) fn between(a: f64, b: f64) -> Self {
        match a.is_nan() || b.is_nan() {
            true => Range::EVERYTHING,
            false => Range {
                low: a.min(b),
                high: a.max(b),
            },
        }
    }

    /// The smallest range that holds both.
    pub(crate) fn hull(self, other: Self) -> Self {
        Range {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    /// What is in both; this one where nothing is, or the other has no bounds.
    pub(crate) fn meet(self, other: Self) -> Self {
        let (low, high) = (self.low.max(other.low), self.high.min(other.high));
        if low <= high {
            Range { low, high }
        } else {
            self
        }
    }

    /// How far it goes.
    pub(crate) fn width(self) -> f64 {
        self.high - self.low
    }

    /// How far `other` goes beyond this range.
    pub(crate) fn beyond(self, other: Self) -> f64 {
        (self.low - other.low).max(other.high - self.high).max(0.0)
    }

    fn contains(self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }

    /// The image under a function that rises.
    fn rising(self, f: impl Fn(f64) -> f64) -> Self {
        Range::between(f(self.low), f(self.high))
    }

    /// The hull of numbers.
    fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let mut values = values.into_iter();
        let first = values.next().unwrap_or(f64::NAN);
        let first = Range::between(first, first);
        values.fold(first, |hull, x| hull.hull(Range::between(x, x)))
    }

    /// The range of the sine.
    fn sine(self) -> Self {
        // The first crest and the first trough from `low` on.
        let next = |at: f64| at + TAU * ((self.low - at) / TAU).ceil();
        let ends = Range::of([self.low.sin(), self.high.sin()]);
        match self.width() < TAU {
            true => Range {
                low: if next(-FRAC_PI_2) <= self.high {
                    -1.0
                } else {
                    ends.low
                },
                high: if next(FRAC_PI_2) <= self.high {
                    1.0
                } else {
                    ends.high
                },
            },
            false => Range::between(-1.0, 1.0),
        }
    }
}

/// 0 ∞ is 0 here: one of the two is a bound that is not taken.
fn times(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 { 0.0 } else { a * b }
}

impl Add for Range {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Range::between(self.low + other.low, self.high + other.high)
    }
}

impl Sub for Range {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Range::between(self.low - other.high, self.high - other.low)
    }
}

impl Mul for Range {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let [a, b, c, d] = [self.low, self.high, other.low, other.high];
        Range::of([times(a, c), times(a, d), times(b, c), times(b, d)])
    }
}

impl Div for Range {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        match other.contains(0.0) {
            true => Range::EVERYTHING,
            false => {
                let [a, b, c, d] = [self.low, self.high, other.low, other.high];
                Range::of([a / c, a / d, b / c, b / d])
            }
        }
    }
}

impl Neg for Range {
    type Output = Self;
    fn neg(self) -> Self {
        Range {
            low: -self.high,
            high: -self.low,
        }
    }
}

macro_rules! assign {
    ($($trait:ident $method:ident $op:tt),*) => {$(
        impl $trait for Range {
            fn $method(&mut self, other: Self) {
                *self = *self $op other;
            }
        }
    )*};
}

assign!(AddAssign add_assign +, SubAssign sub_assign -, MulAssign mul_assign *, DivAssign div_assign /);

impl Zero for Range {
    fn zero() -> Self {
        Self::from_f64(0.0)
    }
    fn is_zero(&self) -> bool {
        *self == Self::zero()
    }
}

impl One for Range {
    fn one() -> Self {
        Self::from_f64(1.0)
    }
}

impl Real for Range {
    type Mask = Possible;

    fn from_f64(value: f64) -> Self {
        Range::between(value, value)
    }
    fn sqrt(self) -> Self {
        self.rising(|x| x.max(0.0).sqrt())
    }
    fn sin_cos(self) -> (Self, Self) {
        let quarter = Self::from_f64(FRAC_PI_2);
        (self.sine(), (self + quarter).sine())
    }
    fn exp(self) -> Self {
        self.rising(f64::exp)
    }
    fn ln(self) -> Self {
        self.rising(|x| x.max(0.0).ln())
    }
    fn tanh(self) -> Self {
        self.rising(f64::tanh)
    }
    fn floor(self) -> Self {
        self.rising(f64::floor)
    }
    fn atan2(self, x: Self) -> Self {
        // Across the negative x axis the angle jumps; elsewhere its extremes are at corners.
        match self.contains(0.0) && x.low <= 0.0 {
            true => Range::between(-PI, PI),
            false => {
                let corner = |y: f64| [y.atan2(x.low), y.atan2(x.high)];
                Range::of(corner(self.low).into_iter().chain(corner(self.high)))
            }
        }
    }
    fn abs(self) -> Self {
        match self.contains(0.0) {
            true => Range::between(0.0, self.high.max(-self.low)),
            false => Range::between(self.low.abs(), self.high.abs()),
        }
    }
    fn min(self, other: Self) -> Self {
        Range::between(self.low.min(other.low), self.high.min(other.high))
    }
    fn max(self, other: Self) -> Self {
        Range::between(self.low.max(other.low), self.high.max(other.high))
    }
    fn lt(self, other: Self) -> Possible {
        Possible {
            holds: self.low < other.high,
            fails: self.high >= other.low,
        }
    }
    fn le(self, other: Self) -> Possible {
        Possible {
            holds: self.low <= other.high,
            fails: self.high > other.low,
        }
    }
    fn both(a: Possible, b: Possible) -> Possible {
        Possible {
            holds: a.holds && b.holds,
            fails: a.fails || b.fails,
        }
    }
    fn select(mask: Possible, a: Self, b: Self) -> Self {
        match (mask.holds, mask.fails) {
            (true, false) => a,
            (false, true) => b,
            _ => a.hull(b),
        }
    }
    fn is_finite_all(self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }
    fn is_always_a_number(self) -> bool {
        // What is not a number is everything here.
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A law of two arguments that uses everything a law may.
    fn law<S: Real>([x, y]: [S; 2]) -> Vec<S> {
        let number = S::from_f64;
        let (sin, cos) = (x * number(2.0)).sin_cos();
        let quotient = x / (y * y + number(0.5));
        vec![
            x + y,
            x - y,
            x * y,
            quotient,
            -x,
            sin,
            cos,
            x.abs().sqrt(),
            (x * number(0.3)).exp(),
            (y.abs() + number(0.1)).ln(),
            y.tanh(),
            (x * number(3.0)).floor(),
            y.atan2(x),
            x.min(y),
            x.max(y),
            S::select(x.lt(y), sin, cos),
            S::select(S::both(x.le(y), y.lt(number(1.0))), x, y * y),
        ]
    }

    #[test]
    fn a_range_holds_every_value_of_a_law_and_closes_in_on_it() {
        let mut seed = 7_u32;
        let mut next = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(seed) / f64::from(u32::MAX) * 8.0 - 4.0
        };
        for round in 0..2000 {
            let width = if round % 2 == 0 { 2.0 } else { 1e-9 };
            let (x, y, w) = (next(), next(), width);
            let ranges = law([Range::between(x, x + w), Range::between(y, y + w)]);
            let points = [0.0, 0.3, 0.8, 1.0];
            let mut seen: Vec<Option<Range>> = vec![None; ranges.len()];
            for (a, b) in points.iter().flat_map(|a| points.map(|b| (*a, b))) {
                for (place, value) in law([x + a * w, y + b * w]).into_iter().enumerate() {
                    let range = ranges[place];
                    let slack = 1e-14 * (1.0 + value.abs());
                    assert!(
                        range.low <= value + slack && value - slack <= range.high,
                        "{place}: {value} in {range:?} at {x} {y}"
                    );
                    let point = Range::between(value, value);
                    seen[place] = Some(seen[place].map_or(point, |hull| hull.hull(point)));
                }
            }
            for (range, seen) in ranges.iter().zip(seen).filter(|_| width < 1.0) {
                let seen = seen.unwrap();
                // A jump inside is seen by the corners.
                assert!(seen.beyond(*range) < 1e-6, "{range:?} {seen:?} at {x} {y}");
            }
        }
    }

    #[test]
    fn what_has_no_bound_is_everything() {
        let zero = Range::between(-1.0, 1.0);
        assert_eq!(Range::one() / zero, Range::EVERYTHING);
        assert_eq!(Range::from_f64(f64::NAN), Range::EVERYTHING);
        assert!(!Range::EVERYTHING.is_finite_all());
        assert_eq!(Range::EVERYTHING * Range::zero(), Range::zero());
        assert_eq!(
            Range::between(0.0, 100.0).sin_cos().0,
            Range::between(-1.0, 1.0)
        );
    }
}
