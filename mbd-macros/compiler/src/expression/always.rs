//! What holds of a term whatever the numbers from outside are: whether it is a number at all, and not below zero.
//!
//! ```text
//! number:   √a of a ≥ 0     a/c of a constant c ≠ 0     never ln a, a/b     else as its arguments                  (1)
//! a ≥ 0:    constants, |a|, √a, eᵃ     a a     sums, products, quotients, smaller ones of such     the larger of one    (2)
//! ```
//!
//! Numbers from outside are finite: a run ends with an error where one is not. What overflows is not looked for. Derived.

use super::{Expr, Graph, Slot, TermKind};
use crate::operation::{Binary, Op, Unary};

/// What always holds of a term.
#[derive(Clone, Copy, Debug)]
pub(super) struct Always {
    /// It is a number.
    pub number: bool,
    /// It is not below zero, if it is a number.
    pub not_negative: bool,
}

impl Graph {
    /// (1) and (2) of a term whose arguments are there.
    pub(super) fn always_of(&self, node: TermKind) -> Always {
        match node {
            TermKind::Constant(bits) => Always {
                number: !f64::from_bits(bits).is_nan(),
                not_negative: f64::from_bits(bits) >= 0.0,
            },
            TermKind::Truth(_) => Always {
                number: true,
                not_negative: false,
            },
            TermKind::Slot(slot) => Always {
                // These are made of terms that stand elsewhere.
                number: !matches!(slot, Slot::Derived(_) | Slot::Value(_)),
                not_negative: false,
            },
            TermKind::Apply(op) => Always {
                number: op.arguments().all(|a| self.of(a).number) && self.keeps_numbers(op),
                not_negative: self.is_not_negative(op),
            },
        }
    }

    fn of(&self, expr: Expr) -> Always {
        self.always[expr.index()]
    }

    /// Whether an operation on numbers is one.
    fn keeps_numbers(&self, op: Op<Expr>) -> bool {
        match op {
            Op::Unary(Unary::Sqrt, a) => self.of(a).not_negative,
            Op::Unary(Unary::Ln, _) => false,
            Op::Binary(Binary::Div, _, b) => self.constant(b).is_some_and(|b| b != 0.0),
            _ => true,
        }
    }

    fn is_not_negative(&self, op: Op<Expr>) -> bool {
        let not_negative = |a: Expr| self.of(a).not_negative;
        match op {
            Op::Unary(Unary::Abs | Unary::Sqrt | Unary::Exp, _) => true,
            Op::Binary(Binary::Mul, a, b) if a == b => true,
            Op::Binary(Binary::Add | Binary::Mul | Binary::Div | Binary::Min, a, b) => {
                not_negative(a) && not_negative(b)
            }
            Op::Binary(Binary::Max, a, b) => not_negative(a) || not_negative(b),
            Op::Select(_, a, b) => not_negative(a) && not_negative(b),
            _ => false,
        }
    }
}
