//! The independent derivative oracle: the laws run on the dual numbers of `num-dual`, which share no line with our own.

use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use mbd_scene::Real;
use num_dual::{Dual64, DualNum};
use num_traits::{One, Zero};

/// A dual number of `num-dual`, as a scalar of our laws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oracle(pub Dual64);

impl Oracle {
    /// A number that does not depend on the variable.
    #[must_use]
    pub fn constant(value: f64) -> Self {
        Oracle(Dual64::from_re(value))
    }

    /// The variable itself.
    #[must_use]
    pub fn variable(value: f64) -> Self {
        Oracle(Dual64::new(value, 1.0))
    }
}

macro_rules! forward {
    ($($trait:ident $method:ident $assign:ident $assign_method:ident),*) => {$(
        impl $trait for Oracle {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                Oracle(self.0.$method(other.0))
            }
        }
        impl $assign for Oracle {
            fn $assign_method(&mut self, other: Self) {
                *self = $trait::$method(*self, other);
            }
        }
    )*};
}

forward!(
    Add add AddAssign add_assign,
    Sub sub SubAssign sub_assign,
    Mul mul MulAssign mul_assign,
    Div div DivAssign div_assign
);

impl Neg for Oracle {
    type Output = Self;
    fn neg(self) -> Self {
        Oracle(-self.0)
    }
}

impl Zero for Oracle {
    fn zero() -> Self {
        Self::constant(0.0)
    }
    fn is_zero(&self) -> bool {
        // Equality of these numbers is that of their values.
        self.0.re == 0.0 && self.0.eps == 0.0
    }
}

impl One for Oracle {
    fn one() -> Self {
        Self::constant(1.0)
    }

    fn is_one(&self) -> bool {
        self.0.re == 1.0 && self.0.eps == 0.0
    }
}

impl Real for Oracle {
    type Mask = bool;

    fn from_f64(value: f64) -> Self {
        Self::constant(value)
    }
    fn sqrt(self) -> Self {
        Oracle(DualNum::sqrt(&self.0))
    }
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = DualNum::sin_cos(&self.0);
        (Oracle(sin), Oracle(cos))
    }
    fn exp(self) -> Self {
        Oracle(DualNum::exp(&self.0))
    }
    fn ln(self) -> Self {
        Oracle(DualNum::ln(&self.0))
    }
    fn tanh(self) -> Self {
        Oracle(DualNum::tanh(&self.0))
    }
    fn floor(self) -> Self {
        Self::constant(self.0.re.floor())
    }
    fn atan2(self, x: Self) -> Self {
        Oracle(DualNum::atan2(&self.0, x.0))
    }
    fn abs(self) -> Self {
        if self.0.re < 0.0 { -self } else { self }
    }
    fn min(self, other: Self) -> Self {
        if other.0.re < self.0.re { other } else { self }
    }
    fn max(self, other: Self) -> Self {
        if other.0.re > self.0.re { other } else { self }
    }
    fn lt(self, other: Self) -> bool {
        self.0.re < other.0.re
    }
    fn le(self, other: Self) -> bool {
        self.0.re <= other.0.re
    }
    fn both(a: bool, b: bool) -> bool {
        a & b
    }
    fn select(mask: bool, a: Self, b: Self) -> Self {
        if mask { a } else { b }
    }
    fn is_finite_all(self) -> bool {
        self.0.re.is_finite() && self.0.eps.is_finite()
    }
}
