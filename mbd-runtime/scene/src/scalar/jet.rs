//! Jets: a value with its first two derivatives by time, on any scalar. How a prescribed motion becomes velocity and acceleration.
//!
//! ```text
//! (f g)″ = f″ g + 2 f′ g′ + f g″,   (f(g))″ = f′(g) g″ + f″(g) g′²                                                (1)
//! ```
//!
//! A jet is itself a [`Real`], so the law of formulas runs on it unchanged, and on a jet of symbols it records both derivatives.

use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use nalgebra::Vector3;
use num_traits::{One, Zero};

use crate::{Real, TINY};

/// A function of time at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet<S> {
    /// The value.
    pub value: S,
    /// Its first derivative [1/s].
    pub rate: S,
    /// Its second derivative [1/s²].
    pub curve: S,
}

impl<S: Real> Jet<S> {
    /// A number that stays.
    #[must_use]
    pub fn constant(value: S) -> Self {
        Jet {
            value,
            rate: S::zero(),
            curve: S::zero(),
        }
    }

    /// Time itself.
    #[must_use]
    pub fn time(value: S) -> Self {
        Jet {
            rate: S::one(),
            ..Self::constant(value)
        }
    }

    /// f(self) by (1), from f, f′ and f″ at the value.
    fn chain(self, value: S, first: S, second: S) -> Self {
        Jet {
            value,
            rate: first * self.rate,
            curve: first * self.curve + second * (self.rate * self.rate),
        }
    }

    /// `self` where the mask holds, `other` elsewhere; `value` is that of the result.
    fn choose(mask: S::Mask, value: S, a: Self, b: Self) -> Self {
        Jet {
            value,
            rate: S::select(mask, a.rate, b.rate),
            curve: S::select(mask, a.curve, b.curve),
        }
    }
}

/// Values, rates and second derivatives of three functions of time.
#[must_use]
pub fn split<S: Real>(jets: &Vector3<Jet<S>>) -> [Vector3<S>; 3] {
    [
        Vector3::from_fn(|i, _| jets[i].value),
        Vector3::from_fn(|i, _| jets[i].rate),
        Vector3::from_fn(|i, _| jets[i].curve),
    ]
}

impl<S: Real> Add for Jet<S> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Jet {
            value: self.value + other.value,
            rate: self.rate + other.rate,
            curve: self.curve + other.curve,
        }
    }
}

impl<S: Real> Sub for Jet<S> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Jet {
            value: self.value - other.value,
            rate: self.rate - other.rate,
            curve: self.curve - other.curve,
        }
    }
}

#[allow(
    clippy::suspicious_arithmetic_impl,
    reason = "the product and quotient rules mix operators"
)]
impl<S: Real> Mul for Jet<S> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let cross = self.rate * other.rate;
        Jet {
            value: self.value * other.value,
            rate: self.rate * other.value + self.value * other.rate,
            curve: self.curve * other.value + (cross + cross) + self.value * other.curve,
        }
    }
}

#[allow(
    clippy::suspicious_arithmetic_impl,
    reason = "the product and quotient rules mix operators"
)]
impl<S: Real> Div for Jet<S> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        // a = q b, differentiated twice.
        let value = self.value / other.value;
        let rate = (self.rate - value * other.rate) / other.value;
        let cross = rate * other.rate;
        Jet {
            value,
            rate,
            curve: (self.curve - (cross + cross) - value * other.curve) / other.value,
        }
    }
}

impl<S: Real> Neg for Jet<S> {
    type Output = Self;
    fn neg(self) -> Self {
        Jet {
            value: -self.value,
            rate: -self.rate,
            curve: -self.curve,
        }
    }
}

macro_rules! assign {
    ($($trait:ident $method:ident $op:tt),*) => {$(
        impl<S: Real> $trait for Jet<S> {
            fn $method(&mut self, other: Self) {
                *self = *self $op other;
            }
        }
    )*};
}

assign!(AddAssign add_assign +, SubAssign sub_assign -, MulAssign mul_assign *, DivAssign div_assign /);

impl<S: Real> Zero for Jet<S> {
    fn zero() -> Self {
        Self::constant(S::zero())
    }
    fn is_zero(&self) -> bool {
        self.value.is_zero() && self.rate.is_zero() && self.curve.is_zero()
    }
}

impl<S: Real> One for Jet<S> {
    fn one() -> Self {
        Self::constant(S::one())
    }
}

impl<S: Real> Real for Jet<S> {
    type Mask = S::Mask;

    fn from_f64(value: f64) -> Self {
        Self::constant(S::from_f64(value))
    }
    fn sqrt(self) -> Self {
        // r r = a, differentiated twice; finite at zero by the rule of [`Real::sqrt`].
        let root = self.value.sqrt();
        let half = S::from_f64(0.5);
        let under = root.max(S::from_f64(TINY));
        let rate = half * self.rate / under;
        Jet {
            value: root,
            rate,
            curve: (half * self.curve - rate * rate) / under,
        }
    }
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (self.chain(sin, cos, -sin), self.chain(cos, -sin, -cos))
    }
    fn exp(self) -> Self {
        let value = self.value.exp();
        self.chain(value, value, value)
    }
    fn ln(self) -> Self {
        let inverse = S::one() / self.value;
        self.chain(self.value.ln(), inverse, -(inverse * inverse))
    }
    fn tanh(self) -> Self {
        let value = self.value.tanh();
        let slope = S::one() - value * value;
        self.chain(value, slope, -((value + value) * slope))
    }
    fn floor(self) -> Self {
        Self::constant(self.value.floor())
    }
    fn atan2(self, x: Self) -> Self {
        let y = self;
        let square = (y.value * y.value + x.value * x.value).max(S::from_f64(TINY));
        let rate = (x.value * y.rate - y.value * x.rate) / square;
        let half = x.value * x.rate + y.value * y.rate;
        let turn = x.value * y.curve - y.value * x.curve;
        Jet {
            value: y.value.atan2(x.value),
            rate,
            curve: (turn - rate * (half + half)) / square,
        }
    }
    fn abs(self) -> Self {
        let negative = self.value.lt(S::zero());
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
    fn lt(self, other: Self) -> S::Mask {
        self.value.lt(other.value)
    }
    fn le(self, other: Self) -> S::Mask {
        self.value.le(other.value)
    }
    fn both(a: S::Mask, b: S::Mask) -> S::Mask {
        S::both(a, b)
    }
    fn select(mask: S::Mask, a: Self, b: Self) -> Self {
        Self::choose(mask, S::select(mask, a.value, b.value), a, b)
    }
    fn is_finite_all(self) -> bool {
        self.value.is_finite_all() && self.rate.is_finite_all() && self.curve.is_finite_all()
    }
    fn label(self, name: &'static str) -> Self {
        Jet {
            value: self.value.label(name),
            ..self
        }
    }
    fn section(name: &str) {
        S::section(name);
    }
}

#[cfg(test)]
mod tests {
    use super::Jet;
    use crate::{Dual, Real};

    /// A function of time through every operation of [`Real`].
    fn course<S: Real>(t: S) -> S {
        let number = S::from_f64;
        let (sin, cos) = (number(2.0) * t).sin_cos();
        let root = (number(3.0) + sin * t).sqrt();
        let decay = (-(t / number(1.7))).exp();
        let angle = (sin - number(0.2)).atan2(cos + root);
        let larger = (sin * decay).max(cos).min(number(5.0) * t);
        let chosen = S::select(number(0.5).lt(t), (cos - t).abs(), root);
        (root * angle + larger / (number(2.0) + decay)) * chosen - (-t) * larger
    }

    #[test]
    fn both_derivatives_are_those_of_nested_dual_numbers() {
        for t in [0.1, 0.4, 0.9, 1.6, 2.3, 4.0] {
            // The rate of a jet whose scalars are dual numbers of time, differentiated once more, is the second derivative.
            let time = Jet::time(Dual::<f64, 1>::variable(t, 0));
            let course = course(time);
            let plain = self::course(Jet::time(t));
            let near = |a: f64, b: f64| (a - b).abs() <= 1e-13 * a.abs().max(b.abs()).max(1.0);
            assert!(near(course.value.slopes[0], plain.rate), "first at {t}");
            assert!(near(course.rate.slopes[0], plain.curve), "second at {t}");
            assert_eq!(course.value.value, plain.value);
        }
    }

    #[test]
    fn both_derivatives_are_those_of_finite_differences() {
        for t in [0.2_f64, 0.8, 1.9, 3.1] {
            let (h, jet) = (1e-4, course(Jet::time(t)));
            let [a, b, c] = [course(t - h), course(t), course(t + h)];
            assert_eq!(jet.value.to_bits(), b.to_bits());
            assert!((jet.rate - (c - a) / (2.0 * h)).abs() < 1e-6);
            assert!((jet.curve - (c - 2.0 * b + a) / (h * h)).abs() < 1e-5);
        }
    }

    #[test]
    fn a_root_that_touches_zero_stays_finite() {
        let jet = (Jet::time(0.0_f64) * Jet::time(0.0)).sqrt();
        assert!(jet.is_finite_all(), "{jet:?}");
    }
}
