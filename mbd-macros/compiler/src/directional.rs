//! Derivatives in one direction at a time, where all of a matrix would be long to write out: one sweep over the terms for every direction, in place of one for every
//! variable.
//!
//! ```text
//! ṙ = Σ_j ∂r/∂x_j ẋ_j                                        for a direction ẋ that is given; a column of ∂r/∂x where ẋ is a unit vector
//! ```
//!
//! In a chain in relative coordinates everything outboard of a joint follows from its coordinate: the terms of all columns grow with the square of the
//! length, those of a sweep with the length. What does not depend on the direction is computed before, once for all columns: the [*values*](Slot::Value).

use std::collections::{HashMap, HashSet};

use mbd_scene::Layout;

use crate::differentiate::{DerivativeVariable, Users, reachable, tangent};
use crate::expression::{Expr, Slot, Term, TermKind, recorded};
use crate::operation::Op;

/// Sweeps of more terms than this, all variables together, are long to write out.
const LONG: usize = 8000;
/// Where what depends on each variable is less than one part in so many of as many whole sweeps, sweeps over it alone take less time, however many directions stand beside
/// each other in a register.
const DENSE: usize = 4;

/// What the columns are that a program finds one at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct MatrixColumns {
    /// The columns of the matrix in which something depends: a direction each.
    pub columns: Vec<usize>,
    /// How many columns the matrix has.
    pub width: usize,
    /// How many numbers it reads that do not depend on the direction.
    pub values: usize,
    /// Row and column of everything in the matrix that is not zero in every state, row by row.
    pub pattern: Vec<(usize, usize)>,
}

/// The derivative of outputs in a direction.
pub struct Directional {
    /// The structural non-zeros of ṙ, by row.
    pub outputs: Vec<(usize, Expr)>,
    /// The terms that were asked for on the way.
    pub order: Vec<Term>,
    /// What of it does not depend on the direction and is used by what does.
    pub values: Vec<Expr>,
    /// The columns of which this is one.
    pub columns: MatrixColumns,
}

/// Differentiates outputs in a direction, whose numbers are [`Slot::Direction`], in relative coordinates where all derivatives together are long and most
/// terms depend; `None` elsewhere. `order`: the terms of the outputs, each with what it belongs to.
pub fn directional(
    layout: &Layout,
    outputs: &[(usize, Expr)],
    by: &[DerivativeVariable],
    order: &[Term],
) -> Option<Directional> {
    layout.tree.as_ref()?;
    let reached = reachable(outputs.iter().map(|&(_, expr)| expr));
    let DependentTerms {
        swept,
        columns,
        pattern,
    } = DependentTerms::of(outputs, by, &reached);
    if swept <= LONG || DENSE * swept <= columns.len() * reached.len() {
        return None;
    }
    let sections: HashMap<Expr, usize> = order.iter().map(|t| (t.expr, t.section)).collect();
    let slots = columns.iter().filter_map(|&column| by.get(column));
    let seeds: HashMap<Slot, usize> = slots.map(|own| own.slot).zip(0..).collect();
    let mut tangents: HashMap<Expr, Expr> = HashMap::new();
    let (found, order) = recorded(|| {
        for expr in reached {
            let own = match expr.node() {
                TermKind::Slot(slot) => seeds
                    .get(&slot)
                    .map(|&index| Expr::slot(Slot::Direction(index))),
                TermKind::Apply(op) => {
                    if let Some(&section) = sections.get(&expr) {
                        Expr::in_section(section);
                    }
                    tangent(expr, op, |argument| tangents.get(&argument).copied())
                }
                TermKind::Constant(_) | TermKind::Truth(_) => None,
            };
            if let Some(own) = own.filter(|own| !own.is_structural_zero()) {
                tangents.insert(expr, own);
            }
        }
        let found = outputs.iter();
        let found = found.filter_map(|&(row, expr)| Some((row, *tangents.get(&expr)?)));
        found.collect::<Vec<_>>()
    });
    let values = values(&found);
    Some(Directional {
        columns: MatrixColumns {
            columns,
            width: by.len(),
            values: values.len(),
            pattern,
        },
        values,
        outputs: found,
        order,
    })
}

/// Which terms and outputs depend on which variable.
struct DependentTerms {
    /// Terms of the sweeps of all variables.
    swept: usize,
    /// The variables that something depends on.
    columns: Vec<usize>,
    /// Row and column of every output that depends, row by row.
    pattern: Vec<(usize, usize)>,
}

impl DependentTerms {
    /// Of outputs and the terms that they reach.
    fn of(outputs: &[(usize, Expr)], by: &[DerivativeVariable], reached: &[Expr]) -> Self {
        let users = Users::new(reached);
        let (mut swept, mut columns, mut pattern) = (0, Vec::new(), Vec::new());
        for (column, variable) in by.iter().enumerate() {
            let Some(start) = users.start(variable) else {
                continue;
            };
            let dependents: HashSet<Expr> = users.dependents(start).into_iter().collect();
            let rows = outputs.iter().filter(|(_, expr)| dependents.contains(expr));
            swept += dependents.len();
            columns.push(column);
            pattern.extend(rows.map(|&(row, _)| (row, column)));
        }
        pattern.sort_unstable();
        DependentTerms {
            swept,
            columns,
            pattern,
        }
    }
}

/// The terms without direction that terms with one use. A mask is no number: it is compared again where it is used.
fn values(outputs: &[(usize, Expr)]) -> Vec<Expr> {
    let reached = reachable(outputs.iter().map(|&(_, expr)| expr));
    let mut directed: HashSet<Expr> = HashSet::new();
    for &expr in &reached {
        let depends = match expr.node() {
            TermKind::Slot(slot) => matches!(slot, Slot::Direction(_)),
            TermKind::Apply(op) => op.arguments().any(|a| directed.contains(&a)),
            TermKind::Constant(_) | TermKind::Truth(_) => false,
        };
        if depends {
            directed.insert(expr);
        }
    }
    let here = |expr: &Expr| {
        directed.contains(expr) || matches!(expr.node(), TermKind::Apply(Op::Compare(..)))
    };
    let number = |expr: &Expr| matches!(expr.node(), TermKind::Slot(_) | TermKind::Apply(_));
    let mut values: Vec<Expr> = Vec::new();
    let mut seen: HashSet<Expr> = HashSet::new();
    let mut open: Vec<Expr> = outputs.iter().map(|&(_, expr)| expr).collect();
    while let Some(expr) = open.pop() {
        if !seen.insert(expr) {
            continue;
        }
        if !here(&expr) {
            values.extend(Some(expr).filter(number));
        } else if let TermKind::Apply(op) = expr.node() {
            open.extend(op.arguments());
        }
    }
    values.sort_unstable_by_key(|expr| expr.index());
    values
}
