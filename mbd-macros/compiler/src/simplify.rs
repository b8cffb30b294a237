//! What a term becomes when it is made: constants fold, nothing is added, nothing is multiplied by one, signs move outwards.
//!
//! −x is x with a sign, and (−c) x the product c x with a sign where that has been asked for: what a law does to a lever and to its opposite, or
//! to two places of a body on either side of its centre, is shared. Where a sign stays, [`crate::selection`] has a place for it.
//!
//! Every rule gives the bits of the operation it replaces, signs of zero and what is not finite apart. Nothing is re-associated.

use crate::expression::{Expr, Graph, TermKind};
use crate::operation::{Binary, Comparison, Op, Unary};

impl Graph {
    /// A number; the two zeros are one.
    pub(crate) fn number(&mut self, value: f64) -> Expr {
        // The two zeros are one: a sign of zero is no structure.
        let value = if value == 0.0 { 0.0 } else { value };
        self.add_node(TermKind::Constant(value.to_bits()))
    }

    /// −x, √x, … of a term, in its simplest form.
    pub(crate) fn unary(&mut self, kind: Unary, a: Expr) -> Expr {
        if let Some(x) = self.constant(a) {
            let value = kind.value(x);
            if value.is_finite() {
                return self.number(value);
            }
        }
        match (kind, self.node(a)) {
            (Unary::Neg, TermKind::Apply(Op::Unary(Unary::Neg, inner))) => inner,
            (Unary::Abs, TermKind::Apply(Op::Unary(Unary::Neg, inner))) => {
                self.unary(Unary::Abs, inner)
            }
            (Unary::Abs, TermKind::Apply(Op::Unary(Unary::Abs | Unary::Sqrt | Unary::Exp, _))) => a,
            _ => self.add_node(TermKind::Apply(Op::Unary(kind, a))),
        }
    }

    /// A sum, product, … of two terms, in its simplest form.
    pub(crate) fn binary(&mut self, kind: Binary, a: Expr, b: Expr) -> Expr {
        if let (Some(x), Some(y)) = (self.constant(a), self.constant(b)) {
            let value = kind.value(x, y);
            if value.is_finite() {
                return self.number(value);
            }
        }
        let simpler = match kind {
            Binary::Add => self.simpler_sum(a, b),
            Binary::Sub => self.simpler_difference(a, b),
            Binary::Mul => self.simpler_product(a, b),
            Binary::Div => self.simpler_quotient(a, b),
            Binary::Min | Binary::Max => (a == b).then_some(a),
            Binary::Atan2 => None,
        };
        if let Some(simpler) = simpler {
            return simpler;
        }
        let (a, b) = match kind.commutes() {
            true => in_order(a, b),
            false => (a, b),
        };
        self.add_node(TermKind::Apply(Op::Binary(kind, a, b)))
    }

    fn simpler_sum(&mut self, a: Expr, b: Expr) -> Option<Expr> {
        if self.constant(a) == Some(0.0) {
            return Some(b);
        }
        if self.constant(b) == Some(0.0) {
            return Some(a);
        }
        match (self.negated(a), self.negated(b)) {
            (_, Some(b)) => Some(self.binary(Binary::Sub, a, b)),
            (Some(a), None) => Some(self.binary(Binary::Sub, b, a)),
            (None, None) => None,
        }
    }

    fn simpler_difference(&mut self, a: Expr, b: Expr) -> Option<Expr> {
        if a == b {
            return Some(self.number(0.0));
        }
        if self.constant(b) == Some(0.0) {
            return Some(a);
        }
        if self.constant(a) == Some(0.0) {
            return Some(self.unary(Unary::Neg, b));
        }
        match (self.negated(a), self.negated(b)) {
            (_, Some(b)) => Some(self.binary(Binary::Add, a, b)),
            (Some(a), None) => {
                let sum = self.binary(Binary::Add, a, b);
                Some(self.unary(Unary::Neg, sum))
            }
            (None, None) => {
                // y − x already differs by a sign.
                let opposite = TermKind::Apply(Op::Binary(Binary::Sub, b, a));
                let opposite = self.asked(opposite)?;
                Some(self.unary(Unary::Neg, opposite))
            }
        }
    }

    fn simpler_product(&mut self, a: Expr, b: Expr) -> Option<Expr> {
        for (x, y) in [(a, b), (b, a)] {
            let c = self.constant(x);
            if c == Some(0.0) {
                return Some(x);
            }
            if c == Some(1.0) {
                return Some(y);
            }
            if c == Some(-1.0) {
                return Some(self.unary(Unary::Neg, y));
            }
            if let Some(inner) = self.negated(x) {
                return Some(match self.constant(y) {
                    Some(c) => {
                        let c = self.number(-c);
                        self.binary(Binary::Mul, inner, c)
                    }
                    None => {
                        let product = self.binary(Binary::Mul, inner, y);
                        self.unary(Unary::Neg, product)
                    }
                });
            }
            if let Some(c) = c {
                // What is multiplied by −c already differs by a sign.
                let c = self.number(-c);
                let (first, second) = in_order(c, y);
                let opposite = TermKind::Apply(Op::Binary(Binary::Mul, first, second));
                if let Some(opposite) = self.asked(opposite) {
                    return Some(self.unary(Unary::Neg, opposite));
                }
            }
        }
        None
    }

    fn simpler_quotient(&mut self, a: Expr, b: Expr) -> Option<Expr> {
        if self.constant(a) == Some(0.0) && self.constant(b) != Some(0.0) {
            return Some(a);
        }
        if self.constant(b) == Some(1.0) {
            return Some(a);
        }
        if self.constant(b) == Some(-1.0) {
            return Some(self.unary(Unary::Neg, a));
        }
        let (x, y) = match (self.negated(a), self.negated(b)) {
            (Some(x), Some(y)) => return Some(self.binary(Binary::Div, x, y)),
            (Some(x), None) => (x, b),
            (None, Some(y)) => (a, y),
            (None, None) => return None,
        };
        let quotient = self.binary(Binary::Div, x, y);
        Some(self.unary(Unary::Neg, quotient))
    }

    /// A comparison of two terms.
    pub(crate) fn compare(&mut self, kind: Comparison, a: Expr, b: Expr) -> Expr {
        if let (Some(x), Some(y)) = (self.constant(a), self.constant(b)) {
            let value = match kind {
                Comparison::Lt => x < y,
                _ => x <= y,
            };
            return self.add_node(TermKind::Truth(value));
        }
        if a == b {
            return self.add_node(TermKind::Truth(kind == Comparison::Le));
        }
        self.add_node(TermKind::Apply(Op::Compare(kind, a, b)))
    }

    /// Both of two masks.
    pub(crate) fn both(&mut self, a: Expr, b: Expr) -> Expr {
        match (self.truth(a), self.truth(b)) {
            (Some(true), _) => b,
            (_, Some(true)) => a,
            (Some(false), _) => a,
            (_, Some(false)) => b,
            _ if a == b => a,
            _ => self.add_node(TermKind::Apply(Op::Compare(Comparison::Both, a, b))),
        }
    }

    /// The first of two terms where a mask holds.
    pub(crate) fn select(&mut self, mask: Expr, a: Expr, b: Expr) -> Expr {
        match self.truth(mask) {
            Some(true) => a,
            Some(false) => b,
            None if a == b => a,
            None => self.add_node(TermKind::Apply(Op::Select(mask, a, b))),
        }
    }
}

/// The arguments of an operation that commutes, the one made first in front.
fn in_order(a: Expr, b: Expr) -> (Expr, Expr) {
    match b.index() < a.index() {
        true => (b, a),
        false => (a, b),
    }
}
