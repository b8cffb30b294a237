//! Derivatives of traced terms, by one forward sweep a variable over the terms that depend on it.
//!
//! Rules at the corners: √x gives dx · 1/(2 max(√x, TINY)), finite at zero; max and min at equality take the derivative of their first
//! argument; a select differentiates both arms under its mask; a mask has no derivative. Each is what a dual number would do.

use std::collections::{HashMap, HashSet};

use mbd_scene::{Real, TINY};
use num_traits::{One, Zero};

use crate::expression::{Expr, Slot, TermKind};
use crate::operation::{Binary, Fused, Op, Unary};

/// A variable: where it enters, and what the reader calls it.
#[derive(Clone, Debug)]
pub struct DerivativeVariable {
    /// Where it enters.
    pub slot: Slot,
    /// Its name; the terms of its sweep belong to the section `d_<name>`.
    pub name: String,
}

/// The structural non-zeros of ∂(outputs)/∂(variables) as (row, column, term), column by column.
pub fn jacobian(outputs: &[(usize, Expr)], by: &[DerivativeVariable]) -> Vec<(usize, usize, Expr)> {
    let reached = reachable(outputs.iter().map(|&(_, expr)| expr));
    let users = Users::new(&reached);
    let rows = rows(outputs);
    let mut entries = Vec::new();
    let mut tangents: HashMap<Expr, Expr> = HashMap::new();
    for (column, variable) in by.iter().enumerate() {
        let Some(start) = users.start(variable) else {
            continue;
        };
        Expr::section(&format!("d_{}", variable.name));
        tangents.clear();
        tangents.insert(start, Expr::one());
        for expr in users.dependents(start) {
            if let TermKind::Apply(op) = expr.node()
                && let Some(tangent) = tangent(expr, op, |a| tangents.get(&a).copied())
                && !tangent.is_structural_zero()
            {
                tangents.insert(expr, tangent);
            }
            if let (Some(rows), Some(&tangent)) = (rows.get(&expr), tangents.get(&expr)) {
                entries.extend(rows.iter().map(|&row| (row, column, tangent)));
            }
        }
    }
    entries
}

/// The rows of each output term.
fn rows(outputs: &[(usize, Expr)]) -> HashMap<Expr, Vec<usize>> {
    let mut rows: HashMap<Expr, Vec<usize>> = HashMap::new();
    for &(row, expr) in outputs {
        rows.entry(expr).or_default().push(row);
    }
    rows
}

/// Who uses each term: a sweep visits only what depends on its variable.
pub struct Users {
    of: HashMap<Expr, Vec<Expr>>,
    slots: HashMap<Slot, Expr>,
}

impl Users {
    /// Those of terms in the order of their creation.
    pub fn new(reached: &[Expr]) -> Self {
        let mut users = Users {
            of: HashMap::new(),
            slots: HashMap::new(),
        };
        for &expr in reached {
            match expr.node() {
                TermKind::Slot(slot) => {
                    users.slots.insert(slot, expr);
                }
                TermKind::Apply(op) => {
                    for argument in op.arguments() {
                        users.of.entry(argument).or_default().push(expr);
                    }
                }
                TermKind::Constant(_) | TermKind::Truth(_) => {}
            }
        }
        users
    }

    /// The term that a variable is; `None` where nothing uses it.
    pub fn start(&self, variable: &DerivativeVariable) -> Option<Expr> {
        self.slots.get(&variable.slot).copied()
    }

    /// `start` and everything that depends on it, in the order of creation.
    pub fn dependents(&self, start: Expr) -> Vec<Expr> {
        let mut seen = HashSet::from([start]);
        let mut open = vec![start];
        while let Some(expr) = open.pop() {
            let users = self.of.get(&expr).map_or(&[][..], Vec::as_slice);
            open.extend(users.iter().filter(|&&user| seen.insert(user)));
        }
        let mut all: Vec<Expr> = seen.into_iter().collect();
        all.sort_unstable_by_key(|expr| expr.index());
        all
    }
}

/// Every term the outputs need, in the order of creation.
pub fn reachable(outputs: impl Iterator<Item = Expr>) -> Vec<Expr> {
    let mut seen = HashSet::new();
    let mut open: Vec<Expr> = outputs.collect();
    while let Some(expr) = open.pop() {
        if seen.insert(expr)
            && let TermKind::Apply(op) = expr.node()
        {
            open.extend(op.arguments());
        }
    }
    let mut reached: Vec<Expr> = seen.into_iter().collect();
    reached.sort_unstable_by_key(|expr| expr.index());
    reached
}

/// The derivative of one operation; `of` gives those of its arguments, `None` for zero.
pub fn tangent(value: Expr, op: Op<Expr>, of: impl Fn(Expr) -> Option<Expr>) -> Option<Expr> {
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
                Unary::Ln => da / a,
                Unary::Tanh => da * (Expr::one() - value * value),
                Unary::Floor => return None,
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
        Op::Fused(kind, a, b, c) => {
            let (da, db, dc) = (of(a), of(b), of(c));
            if da.is_none() && db.is_none() && dc.is_none() {
                return None;
            }
            let zero = Expr::zero();
            let product = da.map_or(zero, |da| da * b) + db.map_or(zero, |db| a * db);
            let other = dc.unwrap_or(zero);
            Some(match kind {
                Fused::Fmadd => product + other,
                Fused::Fmsub => product - other,
                Fused::Fnmadd => other - product,
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expression::{recorded, session};
    use crate::program::Program;
    use crate::{Registers, operation::Comparison};
    use mbd_scene::At;

    /// f and ∂f/∂(x, y) at a place, by the interpreter.
    fn value_and_slopes(f: impl Fn(Expr, Expr) -> Expr, x: [f64; 2]) -> [f64; 3] {
        let ((outputs, order), graph) = session(|| {
            recorded(|| {
                let f = f(Expr::slot(Slot::State(0)), Expr::slot(Slot::State(1)));
                let by = [0, 1].map(|i| DerivativeVariable {
                    slot: Slot::State(i),
                    name: format!("x{i}"),
                });
                let mut outputs = vec![(0, f)];
                let entries = jacobian(&[(0, f)], &by);
                outputs.extend(
                    entries
                        .into_iter()
                        .map(|(_, column, term)| (1 + column, term)),
                );
                outputs
            })
        });
        let program = Program::build(
            &graph,
            None,
            &outputs,
            3,
            &order,
            &crate::program::TermPlaces::default(),
        );
        let at = At::of_state(0.0, &x, &[]);
        let mut out = [0.0; 3];
        program.run(
            &at,
            &[],
            &[],
            &mut Registers::new(program.registers()),
            &mut out,
        );
        out
    }

    fn assert_slopes(name: &str, f: impl Fn(Expr, Expr) -> Expr, x: [f64; 2]) {
        let [_, fx, fy] = value_and_slopes(&f, x);
        let h = 1e-6;
        let at = |dx: f64, dy: f64| value_and_slopes(&f, [x[0] + dx, x[1] + dy])[0];
        for (got, want) in [
            (fx, (at(h, 0.0) - at(-h, 0.0)) / (2.0 * h)),
            (fy, (at(0.0, h) - at(0.0, -h)) / (2.0 * h)),
        ] {
            assert!(
                (got - want).abs() < 1e-8 * (1.0 + want.abs()),
                "{name}: {got} is not {want}"
            );
        }
    }

    #[test]
    fn every_operation_has_the_slope_of_its_graph() {
        for x in [[0.7, 1.3], [-0.4, 0.9], [2.1, -0.6]] {
            assert_slopes("+", |x, y| x + y * x, x);
            assert_slopes("-", |x, y| x * x - y, x);
            assert_slopes("·", |x, y| x * y * x, x);
            assert_slopes("/", |x, y| x / y, x);
            assert_slopes("−", |x, y| -(x * y), x);
            assert_slopes("√", |x, y| (x * x + y * y).sqrt(), x);
            assert_slopes("sin", |x, y| (x * y).sin_cos().0, x);
            assert_slopes("cos", |x, y| (x * y).sin_cos().1, x);
            assert_slopes("exp", |x, y| (x / y).exp(), x);
            assert_slopes("atan2", |x, y| y.atan2(x), x);
            assert_slopes("|·|", |x, y| (x * y).abs(), x);
            assert_slopes("min", |x, y| Real::min(x * x, y), x);
            assert_slopes("max", |x, y| Real::max(x * x, y), x);
            assert_slopes("select", |x, y| Expr::select(x.lt(y), x * y, y / x), x);
        }
    }

    #[test]
    fn slopes_at_a_corner_are_finite_and_those_of_the_first_argument() {
        assert_eq!(value_and_slopes(Real::max, [1.0, 1.0]), [1.0, 1.0, 0.0]);
        assert_eq!(value_and_slopes(Real::min, [1.0, 1.0]), [1.0, 1.0, 0.0]);
        assert_eq!(
            value_and_slopes(|x, y| (x * x + y * y).sqrt(), [0.0, 0.0]),
            [0.0; 3]
        );
        assert_eq!(
            value_and_slopes(|x, _| x.abs(), [0.0, 0.0]),
            [0.0, 1.0, 0.0]
        );
        let at_zero = value_and_slopes(|x, y| x.sqrt() + y, [0.0, 2.0]);
        assert!(at_zero.iter().all(|x| x.is_finite()), "{at_zero:?}");
    }

    #[test]
    fn what_does_not_depend_on_a_variable_is_no_entry() {
        let entries = session(|| {
            let (x, y) = (Expr::slot(Slot::State(0)), Expr::slot(Slot::State(1)));
            let by = [0, 1].map(|i| DerivativeVariable {
                slot: Slot::State(i),
                name: String::new(),
            });
            jacobian(&[(0, x * x), (1, y), (2, Expr::from_f64(3.0))], &by)
        })
        .0;
        let places: Vec<(usize, usize)> = entries
            .iter()
            .map(|&(row, column, _)| (row, column))
            .collect();
        assert_eq!(places, [(0, 0), (1, 1)]);
    }

    #[test]
    fn a_mask_has_no_slope() {
        let node = session(|| {
            let x = Expr::slot(Slot::State(0));
            let op = Op::Compare(Comparison::Lt, x, Expr::zero());
            tangent(x, op, |_| Some(Expr::one()))
        })
        .0;
        assert_eq!(node, None);
    }
}
