//! The scalar of every law: one trait, run by numbers, lanes, dual numbers and symbols alike.
//!
//! A law is written once over [`Real`]. `f64` and `f32` run it, dual numbers differentiate it, the compiler's expression type turns it
//! into equations. For that to work a law never branches on a value: it uses [`Real::select`], [`Real::min`] and [`Real::max`], and
//! keeps **both** operands of a select finite for every input (guard the length or the root first, then select).

use std::fmt::Debug;
use std::ops::Neg;

use nalgebra::{ClosedAddAssign, ClosedDivAssign, ClosedMulAssign, ClosedSubAssign, Scalar};
use num_traits::{One, Zero};

/// A length below this is treated as this when it divides [m]: far below any taut length, far above what squares to zero in `f32`.
pub const TINY: f64 = 1e-18;

/// Whether a product and a sum are one operation, rounded once: on x86 processors that a build is for and that have FMA (`-C target-cpu=native`,
/// `x86-64-v3`). Elsewhere in software it would take fifty times as long, and a build for any processor has the same bits on all of them.
pub const FUSES: bool = cfg!(target_feature = "fma");

/// What a law may do with a number.
pub trait Real:
    Scalar
    + Copy
    + Zero
    + One
    + ClosedAddAssign
    + ClosedSubAssign
    + ClosedMulAssign
    + ClosedDivAssign
    + Neg<Output = Self>
{
    /// The result of a comparison: `bool` for a number, a lane mask for lanes, a symbol for symbols.
    type Mask: Copy + Debug;

    /// The number nearest to `value`.
    fn from_f64(value: f64) -> Self;
    /// self · `b` + `c`: rounded once where [`FUSES`], twice elsewhere.
    #[inline(always)]
    #[must_use]
    fn fmadd(self, b: Self, c: Self) -> Self {
        self * b + c
    }
    /// self · `b` − `c`, rounded as [`Real::fmadd`].
    #[inline(always)]
    #[must_use]
    fn fmsub(self, b: Self, c: Self) -> Self {
        self * b - c
    }
    /// `c` − self · `b`, rounded as [`Real::fmadd`].
    #[inline(always)]
    #[must_use]
    fn fnmadd(self, b: Self, c: Self) -> Self {
        c - self * b
    }
    /// √self, for self ≥ 0. Its derivative is taken as dx / (2 max(√x, [`TINY`])): finite at zero.
    fn sqrt(self) -> Self;
    /// (sin self, cos self), self in radians.
    fn sin_cos(self) -> (Self, Self);
    /// e to the power self.
    fn exp(self) -> Self;
    /// The natural logarithm of self, for self > 0.
    fn ln(self) -> Self;
    /// The hyperbolic tangent of self.
    fn tanh(self) -> Self;
    /// The largest whole number that is not above self. Its derivative is zero.
    fn floor(self) -> Self;
    /// The angle of the vector (`x`, self) [rad], in (−π, π].
    fn atan2(self, x: Self) -> Self;
    /// |self|.
    fn abs(self) -> Self;
    /// The smaller of two.
    fn min(self, other: Self) -> Self;
    /// The larger of two. At equality the derivative is that of `self`.
    fn max(self, other: Self) -> Self;
    /// self < other.
    fn lt(self, other: Self) -> Self::Mask;
    /// self ≤ other.
    fn le(self, other: Self) -> Self::Mask;
    /// Both masks.
    fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// `a` where the mask holds, `b` elsewhere. Both are evaluated.
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;
    /// Whether every lane is finite.
    fn is_finite_all(self) -> bool;
    /// Whether this is a number whatever it is made of: no quotient, root or logarithm can make it NaN. Only symbols know that.
    fn is_always_a_number(self) -> bool {
        false
    }

    /// Names this term for the reader of generated code (`r12`, `u_x`); numbers ignore it.
    #[must_use]
    fn label(self, _name: &'static str) -> Self {
        self
    }

    /// Says that the terms which follow belong to the body, line or node `_name`; numbers ignore it.
    fn section(_name: &str) {}
}

/// A [`Real`] that is one plain machine number: what iterative solvers and step control need on top of a law.
pub trait Float: Real<Mask = bool> + PartialOrd + Default + Send + Sync {
    /// The distance from 1 to the next larger number.
    const EPSILON: Self;
    /// The value as `f64`, exactly.
    fn to_f64(self) -> f64;
    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool {
        self.is_finite_all()
    }
}

macro_rules! machine_number {
    ($t:ident, $sin_cos:path) => {
        impl Real for $t {
            type Mask = bool;

            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                value as $t
            }
            #[inline(always)]
            fn fmadd(self, b: Self, c: Self) -> Self {
                if FUSES {
                    $t::mul_add(self, b, c)
                } else {
                    self * b + c
                }
            }
            #[inline(always)]
            fn fmsub(self, b: Self, c: Self) -> Self {
                self.fmadd(b, -c)
            }
            #[inline(always)]
            fn fnmadd(self, b: Self, c: Self) -> Self {
                (-self).fmadd(b, c)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                $t::sqrt(self)
            }
            #[inline(always)]
            fn sin_cos(self) -> (Self, Self) {
                $sin_cos(self)
            }
            #[inline(always)]
            fn exp(self) -> Self {
                $t::exp(self)
            }
            #[inline(always)]
            fn ln(self) -> Self {
                $t::ln(self)
            }
            #[inline(always)]
            fn tanh(self) -> Self {
                $t::tanh(self)
            }
            #[inline(always)]
            fn floor(self) -> Self {
                $t::floor(self)
            }
            #[inline(always)]
            fn atan2(self, x: Self) -> Self {
                $t::atan2(self, x)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                $t::abs(self)
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                if other < self { other } else { self }
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                if other > self { other } else { self }
            }
            #[inline(always)]
            fn lt(self, other: Self) -> bool {
                self < other
            }
            #[inline(always)]
            fn le(self, other: Self) -> bool {
                self <= other
            }
            #[inline(always)]
            fn both(a: bool, b: bool) -> bool {
                a & b
            }
            #[inline(always)]
            fn select(mask: bool, a: Self, b: Self) -> Self {
                if mask { a } else { b }
            }
            #[inline(always)]
            fn is_finite_all(self) -> bool {
                self.is_finite()
            }
        }

        impl Float for $t {
            const EPSILON: Self = $t::EPSILON;

            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
        }
    };
}

machine_number!(f64, super::circular::sin_cos);
machine_number!(f32, f32::sin_cos);

#[cfg(test)]
mod tests {
    use super::*;

    /// (1 + u)² − (1 + 2u) is u², which a product that is rounded loses.
    fn left_of_a_square<T: Float>() -> [f64; 4] {
        let u = T::EPSILON;
        let (a, b) = (T::one() + u, T::one() + u + u);
        [a.fmadd(a, -b), a.fmsub(a, b), a.fnmadd(a, b), u * u].map(Float::to_f64)
    }

    #[test]
    fn a_product_in_a_sum_is_rounded_where_the_target_has_no_such_instruction() {
        for [plus, minus, from, square] in [left_of_a_square::<f64>(), left_of_a_square::<f32>()] {
            let expected = if FUSES { square } else { 0.0 };
            assert_eq!([plus, minus, -from], [expected; 3]);
        }
    }
}
