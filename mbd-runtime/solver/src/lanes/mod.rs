//! The numbers of several cases beside each other in one register: a scalar for every generated model over `T`.
//!
//! Every operation is that of `f64` in each lane, to the bit, whatever the other lanes hold: sums, products, quotients and roots are
//! rounded correctly by all of them, products in sums are fused for one number where they are for several ([`FUSES`]), sine and cosine are made of such
//! operations, and exponential and its like are those of `f64` lane by lane. So a case gives the same numbers in a lane as alone, on every machine that
//! the build is for. Where a law selects, both sides are evaluated and each lane takes its own.

use std::fmt;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use mbd_scene::{FUSES, LARGEST_ANGLE, Real, sin_cos_within};
use num_traits::{One, Zero};
use wide::{f64x4, f64x8};

mod form;
mod group;
mod joints;
mod lockstep;
mod networks;

pub use form::{Beside, Equations, Forms, InLanes, LaneParameters};
pub(crate) use group::{Lane, Runs, Together, together};
pub use lockstep::LockStep;

/// A scalar that holds the numbers of several cases.
pub trait Lanes: Real + Send + Sync {
    /// How many.
    const WIDTH: usize;

    /// The numbers that `of` gives for each lane, from 0.
    #[must_use]
    fn each(of: impl FnMut(usize) -> f64) -> Self;

    /// The number of a lane; NaN of a lane that there is not.
    #[must_use]
    fn lane(self, index: usize) -> f64;

    /// The numbers of all lanes.
    #[must_use]
    fn numbers(&self) -> &[f64];

    /// The same to be changed.
    #[must_use]
    fn numbers_mut(&mut self) -> &mut [f64];

    /// Whether a comparison holds in some lane.
    #[must_use]
    fn is_any(mask: Self::Mask) -> bool;
}

/// Implements a scalar of several lanes on a register.
macro_rules! lanes {
    ($(#[$doc:meta])* $name:ident, $wide:ident, $width:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, PartialEq)]
        pub struct $name($wide);

        impl $name {
            /// Sine and cosine in the quarter turns that the last two bits of the first number count: in odd ones they are exchanged, half of them are
            /// opposite.
            #[inline(always)]
            fn in_quarters([counted, sine, cosine]: [Self; 3]) -> (Self, Self) {
                let one = $wide::splat(1.0);
                // A number whose other bits are those of 1, so that none is too small to be compared.
                let has = |bit: u64| ((counted.0 & $wide::splat(f64::from_bits(bit))) | one).simd_ne(one);
                let (is_odd, is_second) = (has(1), has(2));
                let exchanged = (sine.0 ^ cosine.0) & is_odd;
                let sign = $wide::splat(-0.0);
                (
                    $name(sine.0 ^ exchanged ^ (is_second & sign)),
                    $name(cosine.0 ^ exchanged ^ ((is_second ^ is_odd) & sign)),
                )
            }

            /// A function of one number, lane by lane.
            #[inline]
            fn map(self, of: impl FnMut(f64) -> f64) -> Self {
                $name($wide::from(self.0.to_array().map(of)))
            }
        }

        impl Lanes for $name {
            const WIDTH: usize = $width;

            #[inline]
            fn each(of: impl FnMut(usize) -> f64) -> Self {
                $name($wide::from(std::array::from_fn::<f64, $width, _>(of)))
            }

            #[inline]
            fn lane(self, index: usize) -> f64 {
                self.0.as_array().get(index).copied().unwrap_or(f64::NAN)
            }

            #[inline]
            fn numbers(&self) -> &[f64] {
                self.0.as_array()
            }

            #[inline]
            fn numbers_mut(&mut self) -> &mut [f64] {
                self.0.as_mut_array()
            }

            #[inline(always)]
            fn is_any(mask: $wide) -> bool {
                mask.any()
            }
        }

        impl From<[f64; $width]> for $name {
            #[inline]
            fn from(numbers: [f64; $width]) -> Self {
                $name($wide::from(numbers))
            }
        }

        impl From<$name> for [f64; $width] {
            #[inline]
            fn from(lanes: $name) -> Self {
                lanes.0.to_array()
            }
        }

        impl fmt::Debug for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                self.0.to_array().fmt(f)
            }
        }

        lanes!(operator $name, Add add, AddAssign add_assign);
        lanes!(operator $name, Sub sub, SubAssign sub_assign);
        lanes!(operator $name, Mul mul, MulAssign mul_assign);
        lanes!(operator $name, Div div, DivAssign div_assign);

        impl Neg for $name {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                $name(-self.0)
            }
        }

        impl Zero for $name {
            #[inline(always)]
            fn zero() -> Self {
                $name($wide::splat(0.0))
            }
            fn is_zero(&self) -> bool {
                *self == Self::zero()
            }
        }

        impl One for $name {
            #[inline(always)]
            fn one() -> Self {
                $name($wide::splat(1.0))
            }
        }

        impl Real for $name {
            /// All bits set in the lanes where it holds.
            type Mask = $wide;

            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                $name($wide::splat(value))
            }
            #[inline(always)]
            fn fmadd(self, b: Self, c: Self) -> Self {
                if FUSES {
                    $name(self.0.mul_add(b.0, c.0))
                } else {
                    self * b + c
                }
            }
            #[inline(always)]
            fn fmsub(self, b: Self, c: Self) -> Self {
                if FUSES {
                    $name(self.0.mul_sub(b.0, c.0))
                } else {
                    self * b - c
                }
            }
            #[inline(always)]
            fn fnmadd(self, b: Self, c: Self) -> Self {
                if FUSES {
                    $name(self.0.mul_neg_add(b.0, c.0))
                } else {
                    c - self * b
                }
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                $name(self.0.sqrt())
            }
            /// Not inlined: some sixty operations wherever an angle turns up.
            fn sin_cos(self) -> (Self, Self) {
                let largest = Self::from_f64(LARGEST_ANGLE);
                if self.abs().le(largest).all() {
                    return sin_cos_within(self, |near| near.any(), Self::in_quarters);
                }
                let mut cosines = [0.0; $width];
                let mut cosine = cosines.iter_mut();
                let sines = self.map(|x| {
                    let (sin, cos) = Real::sin_cos(x);
                    if let Some(slot) = cosine.next() {
                        *slot = cos;
                    }
                    sin
                });
                (sines, cosines.into())
            }
            #[inline]
            fn exp(self) -> Self {
                self.map(f64::exp)
            }
            #[inline]
            fn ln(self) -> Self {
                self.map(f64::ln)
            }
            #[inline]
            fn tanh(self) -> Self {
                self.map(f64::tanh)
            }
            #[inline]
            fn floor(self) -> Self {
                self.map(f64::floor)
            }
            #[inline]
            fn atan2(self, x: Self) -> Self {
                let x = x.0.to_array();
                let mut x = x.iter();
                self.map(|y| y.atan2(x.next().copied().unwrap_or(f64::NAN)))
            }
            #[inline(always)]
            fn abs(self) -> Self {
                $name(self.0.abs())
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                Self::select(other.lt(self), other, self)
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                Self::select(self.lt(other), other, self)
            }
            #[inline(always)]
            fn lt(self, other: Self) -> $wide {
                self.0.simd_lt(other.0)
            }
            #[inline(always)]
            fn le(self, other: Self) -> $wide {
                self.0.simd_le(other.0)
            }
            #[inline(always)]
            fn both(a: $wide, b: $wide) -> $wide {
                a & b
            }
            #[inline(always)]
            fn select(mask: $wide, a: Self, b: Self) -> Self {
                $name(mask.select(a.0, b.0))
            }
            fn is_finite_all(self) -> bool {
                self.0.to_array().into_iter().all(f64::is_finite)
            }
        }
    };
    (operator $name:ident, $trait:ident $function:ident, $assign:ident $assigning:ident) => {
        impl $trait for $name {
            type Output = Self;
            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                $name(self.0.$function(other.0))
            }
        }

        impl $assign for $name {
            #[inline(always)]
            fn $assigning(&mut self, other: Self) {
                *self = $trait::$function(*self, other);
            }
        }
    };
}

lanes! {
    /// Four cases beside each other: a register of AVX2.
    Lanes4, f64x4, 4
}

lanes! {
    /// Eight cases beside each other: a register of AVX-512, or two of AVX2.
    Lanes8, f64x8, 8
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of every kind: signs of zero, tiny, huge, infinite, none.
    const NUMBERS: [f64; 16] = [
        0.0,
        -0.0,
        1.0,
        -1.5,
        0.1,
        3.7,
        -2.2,
        1e-310,
        1e300,
        -1e300,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
        std::f64::consts::PI,
        -123_456.789,
        5e-324,
    ];

    fn unary<L: Real>(x: L) -> [L; 11] {
        let (sin, cos) = x.sin_cos();
        [
            -x,
            x.abs(),
            x.sqrt(),
            sin,
            cos,
            x.exp(),
            x.ln(),
            x.tanh(),
            x.floor(),
            L::select(x.lt(L::zero()), L::one(), x),
            L::select(L::both(L::zero().le(x), x.le(L::one())), x, -L::one()),
        ]
    }

    fn binary<L: Real>(x: L, y: L) -> [L; 12] {
        let selected = L::select(x.le(y), x, y);
        [
            x + y,
            x - y,
            x * y,
            x / y,
            x.min(y),
            x.max(y),
            x.atan2(y),
            selected,
            L::select(x.lt(y), x, y),
            x.fmadd(y, -(x * y)),
            x.fmsub(y, x),
            x.fnmadd(x, y),
        ]
    }

    fn same(a: f64, b: f64) -> bool {
        // Which NaN an operation gives says nothing.
        a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
    }

    fn every_lane_is_the_scalar<L: Lanes>() {
        for shift in 0..NUMBERS.len() {
            let x = L::each(|lane| NUMBERS[(lane + shift) % NUMBERS.len()]);
            for (number, result) in unary(x).into_iter().enumerate() {
                for lane in 0..L::WIDTH {
                    let expected = unary(x.lane(lane))[number];
                    assert!(
                        same(result.lane(lane), expected),
                        "{number}: {:?}",
                        x.lane(lane)
                    );
                }
            }
            for other in 0..NUMBERS.len() {
                let y = L::each(|lane| NUMBERS[(3 * lane + other) % NUMBERS.len()]);
                for (number, result) in binary(x, y).into_iter().enumerate() {
                    for lane in 0..L::WIDTH {
                        let [a, b] = [x, y].map(|it| it.lane(lane));
                        let expected = binary(a, b)[number];
                        assert!(same(result.lane(lane), expected), "{number}: {a:?} {b:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn an_operation_in_a_lane_is_that_of_one_number_to_the_bit() {
        every_lane_is_the_scalar::<Lanes4>();
        every_lane_is_the_scalar::<Lanes8>();
    }

    /// Angles in all quarters, next to whole ones, at the last for which they are counted and beyond.
    fn sines_are_those_of_one_number<L: Lanes>() {
        for k in -60_000..60_000_i32 {
            let whole = f64::from(k) * std::f64::consts::FRAC_PI_2;
            let x = L::each(|lane| match lane {
                0 => whole,
                1 => whole + 1.2e-4,
                2 => 1.618 * f64::from(k),
                3 => 1e-4 * f64::from(k),
                4 => whole.next_up(),
                5 => whole - 1.4e-4,
                6 => f64::from(k % 2) * LARGEST_ANGLE,
                _ => f64::from(k.signum()) * 0.0,
            });
            let (sine, cosine) = x.sin_cos();
            for lane in 0..L::WIDTH {
                let expected = Real::sin_cos(x.lane(lane));
                let found = (sine.lane(lane), cosine.lane(lane));
                assert!(
                    same(found.0, expected.0) && same(found.1, expected.1),
                    "{:?}: {found:?} {expected:?}",
                    x.lane(lane)
                );
            }
        }
    }

    #[test]
    fn sine_and_cosine_in_a_lane_are_those_of_one_number_to_the_bit() {
        sines_are_those_of_one_number::<Lanes4>();
        sines_are_those_of_one_number::<Lanes8>();
    }

    #[test]
    fn one_lane_that_is_not_finite_is_noticed() {
        let mut numbers = [1.0; 8];
        assert!(Lanes8::from(numbers).is_finite_all());
        numbers[5] = f64::NAN;
        assert!(!Lanes8::from(numbers).is_finite_all());
        assert!(Lanes8::from(numbers).lane(8).is_nan());
    }
}
