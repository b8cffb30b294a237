//! What a law may do with a symbol: every operation is a term.

use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use mbd_scene::Real;
use num_traits::{One, Zero};

use super::{Expr, Mask, with};
use crate::operation::{Binary, Comparison, Unary};

macro_rules! operator {
    ($trait:ident $method:ident $assign_trait:ident $assign:ident) => {
        impl $trait for Expr {
            type Output = Expr;
            fn $method(self, other: Expr) -> Expr {
                self.binary(Binary::$trait, other)
            }
        }
        impl $assign_trait for Expr {
            fn $assign(&mut self, other: Expr) {
                *self = self.binary(Binary::$trait, other);
            }
        }
    };
}

operator!(Add add AddAssign add_assign);
operator!(Sub sub SubAssign sub_assign);
operator!(Mul mul MulAssign mul_assign);
operator!(Div div DivAssign div_assign);

impl Neg for Expr {
    type Output = Expr;
    fn neg(self) -> Expr {
        self.unary(Unary::Neg)
    }
}

impl Zero for Expr {
    fn zero() -> Self {
        Expr::from_f64(0.0)
    }
    fn is_zero(&self) -> bool {
        self.is_structural_zero()
    }
}

impl One for Expr {
    fn one() -> Self {
        Expr::from_f64(1.0)
    }
}

impl Real for Expr {
    type Mask = Mask;

    fn from_f64(value: f64) -> Self {
        with(|graph| graph.number(value))
    }
    fn sqrt(self) -> Self {
        self.unary(Unary::Sqrt)
    }
    fn sin_cos(self) -> (Self, Self) {
        (self.unary(Unary::Sin), self.unary(Unary::Cos))
    }
    fn exp(self) -> Self {
        self.unary(Unary::Exp)
    }
    fn ln(self) -> Self {
        self.unary(Unary::Ln)
    }
    fn tanh(self) -> Self {
        self.unary(Unary::Tanh)
    }
    fn floor(self) -> Self {
        self.unary(Unary::Floor)
    }
    fn atan2(self, x: Self) -> Self {
        self.binary(Binary::Atan2, x)
    }
    fn abs(self) -> Self {
        self.unary(Unary::Abs)
    }
    fn min(self, other: Self) -> Self {
        self.binary(Binary::Min, other)
    }
    fn max(self, other: Self) -> Self {
        self.binary(Binary::Max, other)
    }
    fn lt(self, other: Self) -> Mask {
        Mask(with(|graph| graph.compare(Comparison::Lt, self, other)))
    }
    fn le(self, other: Self) -> Mask {
        Mask(with(|graph| graph.compare(Comparison::Le, self, other)))
    }
    fn both(a: Mask, b: Mask) -> Mask {
        Mask(with(|graph| graph.both(a.0, b.0)))
    }
    fn select(mask: Mask, a: Self, b: Self) -> Self {
        with(|graph| graph.select(mask.0, a, b))
    }
    fn is_finite_all(self) -> bool {
        true
    }
    fn is_always_a_number(self) -> bool {
        with(|graph| graph.always[self.index()].number)
    }
    fn label(self, name: &'static str) -> Self {
        with(|graph| graph.label(self, name));
        self
    }
    fn section(name: &str) {
        with(|graph| graph.section = graph.named(name));
    }
}
