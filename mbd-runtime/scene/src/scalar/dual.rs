//! Dual numbers: a value and its derivatives by N variables, exact to rounding. The generic solver's Jacobians.

use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use num_traits::{One, Zero};

use crate::{Real, TINY};

/// `value` + Σ `slopes`[i] ε_i with ε_i ε_j = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<T, const N: usize> {
    /// The value.
    pub value: T,
    /// Its derivatives.
    pub slopes: [T; N],
}

impl<T: Real, const N: usize> Dual<T, N> {
    /// A number that does not depend on any variable.
    #[must_use]
    pub fn constant(value: T) -> Self {
        Dual {
            value,
            slopes: [T::zero(); N],
        }
    }

    /// Variable number `index`; a constant if there is no such variable.
    #[must_use]
    pub fn variable(value: T, index: usize) -> Self {
        let mut dual = Self::constant(value);
        if let Some(slope) = dual.slopes.get_mut(index) {
            *slope = T::one();
        }
        dual
    }

    /// f(value) with derivative f′.
    fn chain(self, value: T, slope: T) -> Self {
        let mut slopes = self.slopes;
        for own in &mut slopes {
            *own *= slope;
        }
        Dual { value, slopes }
    }

    /// `a` where the mask holds, `b` elsewhere; `value` is that of the result.
    fn choose(mask: T::Mask, value: T, a: Self, b: Self) -> Self {
        a.zip(b, value, |a, b| T::select(mask, a, b))
    }

    fn zip(self, other: Self, value: T, f: impl Fn(T, T) -> T) -> Self {
        let mut slopes = self.slopes;
        for (slope, other) in slopes.iter_mut().zip(&other.slopes) {
            *slope = f(*slope, *other);
        }
        Dual { value, slopes }
    }
}

impl<T: Real, const N: usize> Add for Dual<T, N> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.zip(other, self.value + other.value, |a, b| a + b)
    }
}

impl<T: Real, const N: usize> Sub for Dual<T, N> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.zip(other, self.value - other.value, |a, b| a - b)
    }
}

#[allow(
    clippy::suspicious_arithmetic_impl,
    reason = "the product and quotient rules mix operators"
)]
impl<T: Real, const N: usize> Mul for Dual<T, N> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.zip(other, self.value * other.value, |a, b| {
            a * other.value + self.value * b
        })
    }
}

#[allow(
    clippy::suspicious_arithmetic_impl,
    reason = "the product and quotient rules mix operators"
)]
impl<T: Real, const N: usize> Div for Dual<T, N> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        self.zip(other, value, |a, b| (a - value * b) / other.value)
    }
}

impl<T: Real, const N: usize> Neg for Dual<T, N> {
    type Output = Self;
    fn neg(self) -> Self {
        Dual {
            value: -self.value,
            slopes: self.slopes.map(|slope| -slope),
        }
    }
}

macro_rules! assign {
    ($($trait:ident $method:ident $op:tt),*) => {$(
        impl<T: Real, const N: usize> $trait for Dual<T, N> {
            fn $method(&mut self, other: Self) {
                *self = *self $op other;
            }
        }
    )*};
}

assign!(AddAssign add_assign +, SubAssign sub_assign -, MulAssign mul_assign *, DivAssign div_assign /);

impl<T: Real, const N: usize> Zero for Dual<T, N> {
    fn zero() -> Self {
        Self::constant(T::zero())
    }
    fn is_zero(&self) -> bool {
        *self == Self::zero()
    }
}

impl<T: Real, const N: usize> One for Dual<T, N> {
    fn one() -> Self {
        Self::constant(T::one())
    }
}

impl<T: Real, const N: usize> Real for Dual<T, N> {
    type Mask = T::Mask;

    fn from_f64(value: f64) -> Self {
        Self::constant(T::from_f64(value))
    }
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, T::from_f64(0.5) / root.max(T::from_f64(TINY)))
    }
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (self.chain(sin, cos), self.chain(cos, -sin))
    }
    fn exp(self) -> Self {
        let value = self.value.exp();
        self.chain(value, value)
    }
    fn ln(self) -> Self {
        self.chain(self.value.ln(), T::one() / self.value)
    }
    fn tanh(self) -> Self {
        let value = self.value.tanh();
        self.chain(value, T::one() - value * value)
    }
    fn floor(self) -> Self {
        Self::constant(self.value.floor())
    }
    fn atan2(self, x: Self) -> Self {
        let squared = (self.value * self.value + x.value * x.value).max(T::from_f64(TINY));
        self.zip(x, self.value.atan2(x.value), |dy, dx| {
            (x.value * dy - self.value * dx) / squared
        })
    }
    fn abs(self) -> Self {
        let negative = self.value.lt(T::zero());
        Self::choose(negative, self.value.abs(), -self, self)
    }
    fn min(self, other: Self) -> Self {
        let value = self.value.min(other.value);
        Self::choose(other.value.lt(self.value), value, other, self)
    }
    fn max(self, other: Self) -> Self {
        let value = self.value.max(other.value);
        Self::choose(self.value.lt(other.value), value, other, self)
    }
    fn lt(self, other: Self) -> T::Mask {
        self.value.lt(other.value)
    }
    fn le(self, other: Self) -> T::Mask {
        self.value.le(other.value)
    }
    fn both(a: T::Mask, b: T::Mask) -> T::Mask {
        T::both(a, b)
    }
    fn select(mask: T::Mask, a: Self, b: Self) -> Self {
        Self::choose(mask, T::select(mask, a.value, b.value), a, b)
    }
    fn is_finite_all(self) -> bool {
        self.value.is_finite_all() && self.slopes.iter().all(|slope| slope.is_finite_all())
    }
    fn is_always_a_number(self) -> bool {
        self.value.is_always_a_number()
    }
    fn label(self, name: &'static str) -> Self {
        Dual {
            value: self.value.label(name),
            ..self
        }
    }
    fn section(name: &str) {
        T::section(name);
    }
}
