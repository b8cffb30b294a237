//! Selection of operations: which one computes a term. A sign that nothing took up goes into what it stands before, where it costs nothing.
//!
//! ```text
//! −(x − y) = y − x     −(c x) = (−c) x     −(x y) = (−x) y     −(x / y) = (−x) / y     −(x + y) = (−x) − y          (1)
//! ```
//!
//! The first two hold for any term. The others ask for the opposite of x instead of x, so x must be read there alone, and be one of (1) in turn.
//! All give the bits of what they replace, signs of zero apart.
//!
//! A sum takes up a product that stands in it and that the law gave no name, the second of two:
//!
//! ```text
//! x y + z     x y − z     z − x y                                                        (2)
//! ```
//!
//! Processors have these as one operation with one rounding. Whoever else reads the product computes it: which sums are fused hangs on the terms
//! alone, not on what a program is for, so that a term has the same bits in all programs.

use crate::expression::{Expr, Graph, Label, TermKind};
use crate::operation::{Binary, Fused, Op, Unary};
use crate::program::TermPlaces;

/// How deep a sign is looked for a place: the search ends in a program of any depth.
const DEEPEST: usize = 32;

/// The operations of a program.
pub(crate) struct Operations<'a> {
    graph: &'a Graph,
    derived: &'a TermPlaces,
    /// Terms of which the opposite is computed.
    negated: Vec<bool>,
}

impl<'a> Operations<'a> {
    /// Those that `outputs` need; terms of `derived` are computed already.
    pub(crate) fn new(
        graph: &'a Graph,
        outputs: &[(usize, Expr)],
        derived: &'a TermPlaces,
    ) -> Self {
        let mut operations = Operations {
            graph,
            derived,
            negated: vec![false; graph.len()],
        };
        let needed = operations.reached(outputs, |expr| operations.unfused(expr));
        let mut reads = vec![0_u32; graph.len()];
        let mut signs = Vec::new();
        for index in (0..graph.len()).filter(|&index| needed[index]) {
            let expr = graph.term(index);
            if let Some(op) = operations.unfused(expr) {
                op.arguments().for_each(|a| reads[a.index()] += 1);
                if let Op::Unary(Unary::Neg, a) = op {
                    signs.push(a);
                }
            }
        }
        for &(_, expr) in outputs {
            reads[expr.index()] += 1;
        }
        for a in signs {
            operations.negate(a, &reads, DEEPEST);
        }
        operations
    }

    /// The operation that computes a term, or the opposite of it where that is what is computed.
    pub(crate) fn of(&self, expr: Expr) -> Option<Op<Expr>> {
        let op = self.unfused(expr)?;
        Some(self.fused(expr, op).unwrap_or(op))
    }

    /// A sum with a product in it, by (2), of the operation of a term.
    fn fused(&self, expr: Expr, op: Op<Expr>) -> Option<Op<Expr>> {
        let Op::Binary(kind @ (Binary::Add | Binary::Sub), x, y) = op else {
            return None;
        };
        let [first, second] = [self.product(x), self.product(y)];
        let takes_first = first.is_some() && (second.is_none() || self.is_last(x, expr));
        let (kind, (a, b), c) = match (kind, takes_first) {
            (Binary::Add, true) => (Fused::Fmadd, first?, y),
            (Binary::Add, false) => (Fused::Fmadd, second?, x),
            (_, true) => (Fused::Fmsub, first?, y),
            (_, false) => (Fused::Fnmadd, second?, x),
        };
        Some(Op::Fused(kind, a, b, c))
    }

    /// Whether a term is the second of a sum, or of the sum behind a sign, as they are in the graph.
    fn is_last(&self, expr: Expr, sum: Expr) -> bool {
        match self.graph.node(sum) {
            TermKind::Apply(Op::Unary(Unary::Neg, sum)) => self.is_last(expr, sum),
            TermKind::Apply(Op::Binary(_, _, last)) => last == expr,
            _ => false,
        }
    }

    /// The factors of a product that the law gave no name and that is not computed already.
    fn product(&self, expr: Expr) -> Option<(Expr, Expr)> {
        match self.unfused(expr)? {
            Op::Binary(Binary::Mul, a, b)
                if self.derived.of(expr).is_none() && self.graph.name(expr).is_none() =>
            {
                Some((a, b))
            }
            _ => None,
        }
    }

    /// The operation on terms as they are in the graph.
    fn unfused(&self, expr: Expr) -> Option<Op<Expr>> {
        let TermKind::Apply(op) = self.graph.node(expr) else {
            return None;
        };
        let opposite = match op {
            Op::Unary(Unary::Neg, a) => self.opposite(a),
            _ if self.is_negated(expr) => self.opposite(expr),
            _ => None,
        };
        Some(opposite.unwrap_or(op))
    }

    /// The name of what is computed.
    pub(crate) fn name(&self, expr: Expr) -> Option<Label> {
        let name = self.graph.name(expr)?;
        let opposite = name.opposite != self.is_negated(expr);
        Some(Label { opposite, ..name })
    }

    /// Whether the opposite of a term is computed in its place.
    fn is_negated(&self, expr: Expr) -> bool {
        self.negated[expr.index()]
    }

    /// Which terms must be computed: operations that the outputs reach without passing a derived term.
    pub(crate) fn needed(&self, outputs: &[(usize, Expr)]) -> Vec<bool> {
        self.reached(outputs, |expr| self.of(expr))
    }

    /// The same by the operations that `of` gives.
    fn reached(
        &self,
        outputs: &[(usize, Expr)],
        of: impl Fn(Expr) -> Option<Op<Expr>>,
    ) -> Vec<bool> {
        let mut needed = vec![false; self.graph.len()];
        let known = needed.as_mut_slice();
        let mut open: Vec<Expr> = outputs.iter().map(|&(_, expr)| expr).collect();
        while let Some(expr) = open.pop() {
            if known[expr.index()] || self.derived.of(expr).is_some() {
                continue;
            }
            if let Some(op) = of(expr) {
                known[expr.index()] = true;
                open.extend(op.arguments());
            }
        }
        needed
    }

    /// The operation that computes the opposite of a term, by (1).
    fn opposite(&self, expr: Expr) -> Option<Op<Expr>> {
        if self.derived.of(expr).is_some() {
            return None;
        }
        let TermKind::Apply(Op::Binary(kind, x, y)) = self.graph.node(expr) else {
            return None;
        };
        let negated = self.is_negated(x) || self.is_negated(y);
        match kind {
            Binary::Sub => Some(Op::Binary(kind, y, x)),
            Binary::Mul | Binary::Div if negated => Some(Op::Binary(kind, x, y)),
            Binary::Mul => match self.graph.opposite_number(x) {
                Some(x) => Some(Op::Binary(kind, x, y)),
                None => Some(Op::Binary(kind, x, self.graph.opposite_number(y)?)),
            },
            Binary::Add if self.is_negated(x) => Some(Op::Binary(Binary::Sub, x, y)),
            Binary::Add if negated => Some(Op::Binary(Binary::Sub, y, x)),
            _ => None,
        }
    }

    /// Has the opposite of a term computed in its place, where only a sign reads it and that costs nothing.
    fn negate(&mut self, expr: Expr, reads: &[u32], deep: usize) -> bool {
        if reads[expr.index()] != 1 || deep == 0 || self.derived.of(expr).is_some() {
            return false;
        }
        let TermKind::Apply(Op::Binary(kind, x, y)) = self.graph.node(expr) else {
            return false;
        };
        let free = self.opposite(expr).is_some();
        let inside = matches!(kind, Binary::Add | Binary::Mul | Binary::Div);
        let found =
            free || inside && (self.negate(x, reads, deep - 1) || self.negate(y, reads, deep - 1));
        self.negated[expr.index()] = found;
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expression::{Slot, Term, recorded, session};
    use crate::program::{Program, Register};
    use mbd_scene::Real;

    /// How many operations terms take, and their values at x = 3, y = 5, z = 7.
    fn computed(law: impl Fn(Expr, Expr, Expr) -> Vec<Expr>) -> (usize, Vec<f64>) {
        let (program, values) = run(law);
        (program.operations(), values)
    }

    /// Which operations terms take, and their values.
    fn instructions(law: impl Fn(Expr, Expr, Expr) -> Vec<Expr>) -> (Vec<Op<Register>>, Vec<f64>) {
        let (program, values) = run(law);
        (program.instructions.iter().map(|i| i.op).collect(), values)
    }

    fn run(law: impl Fn(Expr, Expr, Expr) -> Vec<Expr>) -> (Program, Vec<f64>) {
        let numbers = [3.0, 5.0, 7.0];
        let ((values, order), graph): ((Vec<Expr>, Vec<Term>), Graph) = session(|| {
            let [x, y, z] = [0, 1, 2].map(|index| Expr::slot(Slot::State(index)));
            recorded(|| law(x, y, z))
        });
        let outputs: Vec<(usize, Expr)> = values.into_iter().enumerate().collect();
        let places = TermPlaces::default();
        let program = Program::build(&graph, None, &outputs, outputs.len(), &order, &places);
        let mut file: Vec<f64> = program.constants.clone();
        for slot in &program.slots {
            if let Slot::State(index) = *slot {
                file.push(numbers[index]);
            }
        }
        for instruction in &program.instructions {
            let value = match instruction.op {
                Op::Unary(kind, a) => kind.value(file[a.index()]),
                Op::Binary(kind, a, b) => kind.value(file[a.index()], file[b.index()]),
                Op::Fused(kind, a, b, c) => {
                    kind.value(file[a.index()], file[b.index()], file[c.index()])
                }
                _ => f64::NAN,
            };
            file.push(value);
        }
        let found = program.outputs.iter().map(|&(_, r)| file[r.index()]);
        let found = found.collect();
        (program, found)
    }

    /// Registers of x, y and z where nothing is known at build time.
    const SLOTS: [Register; 3] = [Register(0), Register(1), Register(2)];

    #[test]
    fn a_sum_takes_up_the_second_of_its_products() {
        let [x, y, z] = SLOTS;
        let first = Op::Binary(Binary::Mul, x, y);
        let fused = |kind| Op::Fused(kind, y, z, Register(3));
        let (sum, value) = instructions(|x, y, z| vec![x * y + y * z]);
        assert_eq!((sum, value), (vec![first, fused(Fused::Fmadd)], vec![50.0]));
        let (difference, value) = instructions(|x, y, z| vec![x * y - y * z]);
        assert_eq!(
            (difference, value),
            (vec![first, fused(Fused::Fnmadd)], vec![-20.0])
        );
        let (product, value) = instructions(|x, y, z| vec![x * y - z]);
        assert_eq!(
            (product, value),
            (vec![Op::Fused(Fused::Fmsub, x, y, z)], vec![8.0])
        );
        // It is the same one where the opposite of the sum is computed.
        let (opposite, value) = instructions(|x, y, z| vec![-(x * y - y * z)]);
        assert_eq!(
            (opposite, value),
            (vec![first, fused(Fused::Fmsub)], vec![20.0])
        );
    }

    #[test]
    fn what_else_is_computed_does_not_change_how_a_sum_is() {
        let [x, y, z] = SLOTS;
        let fused = Op::Fused(Fused::Fmadd, x, y, z);
        let (alone, _) = instructions(|x, y, z| vec![x * y + z]);
        assert_eq!(alone, [fused]);
        let (beside, values) = instructions(|x, y, z| vec![x * y + z, x * y]);
        assert_eq!(beside, [Op::Binary(Binary::Mul, x, y), fused]);
        assert_eq!(values, [22.0, 15.0]);
        // One product, whoever reads it.
        let (program, _) = run(|x, y, z| vec![x * y + z, x * y, x * y - z]);
        assert_eq!((program.cost().muls, program.cost().adds), (1, 2));
        // A product that the law named stays a term, for the reader.
        let (named, _) = instructions(|x, y, z| vec![(x * y).label("area") + z]);
        assert_eq!(named.len(), 2);
    }

    #[test]
    fn a_sign_before_a_difference_or_a_multiple_is_no_operation() {
        assert_eq!(computed(|x, y, _| vec![-(x - y)]), (1, vec![2.0]));
        let twice = |x: Expr| x * Expr::from_f64(2.0);
        assert_eq!(computed(|x, _, _| vec![-twice(x)]), (1, vec![-6.0]));
        assert_eq!(computed(|x, y, _| vec![x - y, -(x - y)]).0, 2);
    }

    #[test]
    fn a_sign_goes_into_products_quotients_and_sums_that_nothing_else_reads() {
        let twice = |x: Expr| x * Expr::from_f64(2.0);
        assert_eq!(computed(|x, y, z| vec![-((x - y) * z)]), (2, vec![14.0]));
        assert_eq!(computed(|x, y, z| vec![-(x / (y - z))]), (2, vec![1.5]));
        assert_eq!(
            computed(|x, y, z| vec![-(twice(x) * y + x * z)]),
            (4, vec![-51.0])
        );
        assert_eq!(
            computed(|x, y, z| vec![-(z + (x - y) * x) * y]),
            (4, vec![-5.0])
        );
    }

    #[test]
    fn a_sign_stays_where_what_it_stands_before_is_read_elsewhere_too() {
        assert_eq!(
            computed(|x, y, z| {
                let product = (x - y) * z;
                vec![-product, product]
            }),
            (3, vec![14.0, -14.0])
        );
        assert_eq!(
            computed(|x, y, z| {
                let difference = x - y;
                vec![-(difference * z), difference]
            }),
            (3, vec![14.0, -2.0])
        );
        assert_eq!(computed(|x, y, _| vec![-(x + y)]), (2, vec![-8.0]));
    }
}
