//! Jets: a value and its first two time derivatives, carried through a law. The oracle of Φ_v and γ; shares no line with the closed forms.

use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use mbd_scene::Real;
use num_traits::{One, Zero};

/// Value, rate and rate of rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet(pub [f64; 3]);

impl Jet {
    /// A number that stays.
    #[must_use]
    pub fn constant(value: f64) -> Self {
        Jet([value, 0.0, 0.0])
    }

    /// f(self) from f, f′ and f″ at the value.
    fn chain(self, f: f64, first: f64, second: f64) -> Self {
        let [_, d, dd] = self.0;
        Jet([f, first * d, first * dd + second * d * d])
    }
}

impl Add for Jet {
    type Output = Jet;
    fn add(self, other: Jet) -> Jet {
        Jet(std::array::from_fn(|i| self.0[i] + other.0[i]))
    }
}

impl Sub for Jet {
    type Output = Jet;
    fn sub(self, other: Jet) -> Jet {
        Jet(std::array::from_fn(|i| self.0[i] - other.0[i]))
    }
}

impl Mul for Jet {
    type Output = Jet;
    fn mul(self, other: Jet) -> Jet {
        let ([a, da, dda], [b, db, ddb]) = (self.0, other.0);
        Jet([a * b, da * b + a * db, dda * b + 2.0 * da * db + a * ddb])
    }
}

impl Div for Jet {
    type Output = Jet;
    fn div(self, other: Jet) -> Jet {
        let b = other.0[0];
        self * other.chain(1.0 / b, -1.0 / (b * b), 2.0 / (b * b * b))
    }
}

impl Neg for Jet {
    type Output = Jet;
    fn neg(self) -> Jet {
        Jet(self.0.map(|x| -x))
    }
}

macro_rules! assign {
    ($($trait:ident $method:ident $op:tt),*) => {$(
        impl $trait for Jet {
            fn $method(&mut self, other: Jet) {
                *self = *self $op other;
            }
        }
    )*};
}

assign!(AddAssign add_assign +, SubAssign sub_assign -, MulAssign mul_assign *, DivAssign div_assign /);

impl Zero for Jet {
    fn zero() -> Self {
        Jet::constant(0.0)
    }
    fn is_zero(&self) -> bool {
        self.0 == [0.0; 3]
    }
}

impl One for Jet {
    fn one() -> Self {
        Jet::constant(1.0)
    }
}

impl Real for Jet {
    type Mask = bool;

    fn from_f64(value: f64) -> Self {
        Jet::constant(value)
    }
    fn sqrt(self) -> Self {
        let root = self.0[0].sqrt();
        self.chain(root, 0.5 / root, -0.25 / (root * root * root))
    }
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.0[0].sin_cos();
        (self.chain(sin, cos, -sin), self.chain(cos, -sin, -cos))
    }
    fn exp(self) -> Self {
        let e = self.0[0].exp();
        self.chain(e, e, e)
    }
    fn ln(self) -> Self {
        let x = self.0[0];
        self.chain(x.ln(), 1.0 / x, -1.0 / (x * x))
    }
    fn tanh(self) -> Self {
        let t = self.0[0].tanh();
        self.chain(t, 1.0 - t * t, -2.0 * t * (1.0 - t * t))
    }
    fn floor(self) -> Self {
        Jet::constant(self.0[0].floor())
    }
    fn atan2(self, x: Self) -> Self {
        let value = f64::atan2(self.0[0], x.0[0]);
        let rate = |y: Jet, x: Jet| (x.0[0] * y.0[1] - y.0[0] * x.0[1]) / (x * x + y * y).0[0];
        let radius = x * x + self * self;
        let curve = (x.0[0] * self.0[2] - self.0[0] * x.0[2]) / radius.0[0]
            - rate(self, x) * radius.0[1] / radius.0[0];
        Jet([value, rate(self, x), curve])
    }
    fn abs(self) -> Self {
        if self.0[0] < 0.0 { -self } else { self }
    }
    fn min(self, other: Self) -> Self {
        if other.0[0] < self.0[0] { other } else { self }
    }
    fn max(self, other: Self) -> Self {
        if other.0[0] > self.0[0] { other } else { self }
    }
    fn lt(self, other: Self) -> bool {
        self.0[0] < other.0[0]
    }
    fn le(self, other: Self) -> bool {
        self.0[0] <= other.0[0]
    }
    fn both(a: bool, b: bool) -> bool {
        a & b
    }
    fn select(mask: bool, a: Self, b: Self) -> Self {
        if mask { a } else { b }
    }
    fn is_finite_all(self) -> bool {
        self.0.iter().all(|x| x.is_finite())
    }
}
