//! Operands of one rank in a row, `a + b - c` or `a * b / c`, as a tree.

use super::expression::Expression;

/// Operands in a row.
pub struct Chain {
    /// `+ -` or `* /`.
    signs: [char; 2],
    operands: Vec<ChainOperand>,
}

struct ChainOperand {
    /// Whether the second sign stands before it.
    inverse: bool,
    expression: Expression,
    depth: usize,
}

impl ChainOperand {
    /// Both, grouped under the sign of the first. What follows a `-` or `/` inside has the opposite sign then.
    fn with(self, next: ChainOperand, signs: [char; 2]) -> ChainOperand {
        let sign = signs[usize::from(self.inverse != next.inverse)];
        ChainOperand {
            inverse: self.inverse,
            expression: Expression::Binary {
                sign,
                sides: Box::new([self.expression, next.expression]),
            },
            depth: self.depth.max(next.depth) + 1,
        }
    }
}

impl Chain {
    /// A row of one operand.
    pub fn new(signs: [char; 2], (expression, depth): (Expression, usize)) -> Self {
        let first = ChainOperand {
            inverse: false,
            expression,
            depth,
        };
        Chain {
            signs,
            operands: vec![first],
        }
    }

    /// One more, with the sign before it.
    pub fn push(&mut self, sign: char, (expression, depth): (Expression, usize)) {
        self.operands.push(ChainOperand {
            inverse: sign == self.signs[1],
            expression,
            depth,
        });
    }

    /// The tree and its depth: grouped from the left where that is no deeper than `deepest`, or else neighbour with neighbour, again and again,
    /// so that the depth grows with the logarithm of the number of operands, and with it what rounding makes of a sum.
    pub fn grouped(mut self, deepest: usize) -> Option<(Expression, usize)> {
        let signs = self.signs;
        let depths = self.operands.iter().map(|operand| operand.depth);
        let from_left = depths.reduce(|left, right| left.max(right) + 1);
        if from_left > Some(deepest) {
            while self.operands.len() > 1 {
                self.operands = neighbours(self.operands, signs);
            }
        }
        let all = self.operands.into_iter();
        let tree = all.reduce(|left, right| left.with(right, signs))?;
        Some((tree.expression, tree.depth))
    }
}

/// Neighbours grouped. `/ a * b` is left for the next time: it would divide by `b`, which may be a vector.
fn neighbours(operands: Vec<ChainOperand>, signs: [char; 2]) -> Vec<ChainOperand> {
    let mut grouped = Vec::with_capacity(operands.len() / 2 + 1);
    let mut operands = operands.into_iter().peekable();
    while let Some(operand) = operands.next() {
        let next = operands.next_if(|next| next.inverse || !operand.inverse);
        grouped.push(match next {
            Some(next) => operand.with(next, signs),
            None => operand,
        });
    }
    grouped
}
