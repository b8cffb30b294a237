//! Derivatives of traced terms, by one forward sweep a variable over the terms that depend on it.
//!
//! Rules at the corners: √x gives dx · 1/(2 max(√x, TINY)), finite at zero; max and min at equality take the derivative of their first
//! argument; a select differentiates both arms under its mask; a mask has no derivative. Each is what a dual number would do.

use std::collections::HashSet;

use mbd_scene::{Real, TINY};
use num_traits::{One, Zero};

use crate::expression::{Expr, Node, Slot};
use crate::operation::{Binary, Op, Unary};

/// A variable: where it enters, and what the reader calls it.
#[derive(Clone, Debug)]
pub struct By {
    /// Where it enters.
    pub slot: Slot,
    /// Its name; the terms of its sweep belong to the section `d_<name>`.
    pub name: String,
}

/// The structural non-zeros of ∂(outputs)/∂(variables) as (row, column, term), column by column.
pub fn jacobian(outputs: &[(usize, Expr)], by: &[By]) -> Vec<(usize, usize, Expr)> {
    let reached = reachable(outputs.iter().map(|&(_, expr)| expr));
    let mut entries = Vec::new();
    let mut tangents: Vec<Option<Expr>> = vec![None; reached.last().map_or(0, |e| e.index() + 1)];
    for (column, variable) in by.iter().enumerate() {
        Expr::section(&format!("d_{}", variable.name));
        tangents.fill(None);
        for &expr in &reached {
            let tangent = match expr.node() {
                Node::Slot(slot) => (slot == variable.slot).then(Expr::one),
                Node::Apply(op) => {
                    tangent(expr, op, |a| tangents.get(a.index()).copied().flatten())
                }
                Node::Constant(_) | Node::Truth(_) => None,
            };
            tangents[expr.index()] = tangent.filter(|t| !t.is_structural_zero());
        }
        entries.extend(outputs.iter().filter_map(|&(row, expr)| {
            let tangent = tangents.get(expr.index()).copied().flatten()?;
            Some((row, column, tangent))
        }));
    }
    entries
}

/// Every term the outputs need, in the order of creation.
pub fn reachable(outputs: impl Iterator<Item = Expr>) -> Vec<Expr> {
    let mut seen = HashSet::new();
    let mut open: Vec<Expr> = outputs.collect();
    while let Some(expr) = open.pop() {
        if seen.insert(expr)
            && let Node::Apply(op) = expr.node()
        {
            open.extend(op.arguments());
        }
    }
    let mut reached: Vec<Expr> = seen.into_iter().collect();
    reached.sort_unstable_by_key(|expr| expr.index());
    reached
}

/// The derivative of one operation; `of` gives those of its arguments, `None` for zero.
fn tangent(value: Expr, op: Op<Expr>, of: impl Fn(Expr) -> Option<Expr>) -> Option<Expr> {
    match op {
        Op::Compare(..) => None,
        Op::Unary(kind, a) => {
            let da = of(a)?;
            Some(match kind {
                Unary::Neg => -da,
                Unary::Sqrt => {
                    let slope = Expr::from_f64(0.5) / value.max(Expr::from_f64(TINY));
                    da * slope
                }
                Unary::Sin => da * a.sin_cos().1,
                Unary::Cos => -(da * a.sin_cos().0),
                Unary::Exp => da * value,
                Unary::Abs => Expr::select(a.lt(Expr::zero()), -da, da),
            })
        }
        Op::Binary(kind, a, b) => {
            let (da, db) = (of(a), of(b));
            if da.is_none() && db.is_none() {
                return None;
            }
            let zero = Expr::zero();
            Some(match kind {
                Binary::Add => da.unwrap_or(zero) + db.unwrap_or(zero),
                Binary::Sub => da.unwrap_or(zero) - db.unwrap_or(zero),
                Binary::Mul => da.map_or(zero, |da| da * b) + db.map_or(zero, |db| a * db),
                Binary::Div => {
                    let inverse = Expr::one() / b;
                    (da.unwrap_or(zero) - db.map_or(zero, |db| value * db)) * inverse
                }
                Binary::Min => Expr::select(b.lt(a), db.unwrap_or(zero), da.unwrap_or(zero)),
                Binary::Max => Expr::select(a.lt(b), db.unwrap_or(zero), da.unwrap_or(zero)),
                Binary::Atan2 => {
                    let length = (a * a + b * b).max(Expr::from_f64(TINY));
                    let turn = da.map_or(zero, |da| da * b) - db.map_or(zero, |db| a * db);
                    turn * (Expr::one() / length)
                }
            })
        }
        Op::Select(mask, a, b) => {
            let (da, db) = (of(a), of(b));
            if da.is_none() && db.is_none() {
                return None;
            }
            let zero = Expr::zero();
            Some(Expr::select(
                mask.as_mask(),
                da.unwrap_or(zero),
                db.unwrap_or(zero),
            ))
        }
    }
}
