//! The operations of an expression, of a program and of generated code: one list for all three.

use mbd_scene::Real;

/// An operation of one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Unary {
    /// −a.
    Neg,
    /// √a.
    Sqrt,
    /// sin a.
    Sin,
    /// cos a.
    Cos,
    /// e to the power a.
    Exp,
    /// The natural logarithm of a.
    Ln,
    /// tanh a.
    Tanh,
    /// The largest whole number that is not above a.
    Floor,
    /// |a|.
    Abs,
}

/// An operation of two arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Binary {
    /// a + b.
    Add,
    /// a − b.
    Sub,
    /// a · b.
    Mul,
    /// a / b.
    Div,
    /// The angle of the vector (b, a).
    Atan2,
    /// The smaller of two.
    Min,
    /// The larger of two.
    Max,
}

/// A product and a sum in one, called as the instructions of processors that have them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Fused {
    /// a · b + c.
    Fmadd,
    /// a · b − c.
    Fmsub,
    /// c − a · b.
    Fnmadd,
}

/// An operation that gives a mask.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Comparison {
    /// a < b of two numbers.
    Lt,
    /// a ≤ b of two numbers.
    Le,
    /// Both of two masks.
    Both,
}

/// One operation on arguments of type `R`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Op<R> {
    /// Of one number.
    Unary(Unary, R),
    /// Of two numbers.
    Binary(Binary, R, R),
    /// The product of the first two, and the third. Only programs have it: they take it where a sum has a product in it.
    Fused(Fused, R, R, R),
    /// Gives a mask.
    Compare(Comparison, R, R),
    /// The second where the first, a mask, holds; the third elsewhere.
    Select(R, R, R),
}

impl<R: Copy> Op<R> {
    /// How many operations it counts for: a product in a sum for two.
    #[must_use]
    pub fn operations(self) -> usize {
        match self {
            Op::Fused(..) => 2,
            _ => 1,
        }
    }

    /// Its arguments, in order.
    pub fn arguments(self) -> impl Iterator<Item = R> {
        let (all, count) = match self {
            Op::Unary(_, a) => ([a, a, a], 1),
            Op::Binary(_, a, b) | Op::Compare(_, a, b) => ([a, b, b], 2),
            Op::Select(a, b, c) | Op::Fused(_, a, b, c) => ([a, b, c], 3),
        };
        UpToThree { all, count, at: 0 }
    }

    /// The same operation on other arguments.
    pub fn map<Q>(self, mut to: impl FnMut(R) -> Q) -> Op<Q> {
        match self {
            Op::Unary(kind, a) => Op::Unary(kind, to(a)),
            Op::Binary(kind, a, b) => Op::Binary(kind, to(a), to(b)),
            Op::Fused(kind, a, b, c) => Op::Fused(kind, to(a), to(b), to(c)),
            Op::Compare(kind, a, b) => Op::Compare(kind, to(a), to(b)),
            Op::Select(mask, a, b) => Op::Select(to(mask), to(a), to(b)),
        }
    }
}

/// One to three things: much cheaper than a chain of iterators where nobody optimises.
struct UpToThree<R> {
    all: [R; 3],
    count: usize,
    at: usize,
}

impl<R: Copy> Iterator for UpToThree<R> {
    type Item = R;

    #[inline]
    fn next(&mut self) -> Option<R> {
        if self.at == self.count {
            return None;
        }
        self.at += 1;
        Some(self.all[self.at - 1])
    }
}

impl Unary {
    /// Its value.
    #[inline]
    pub fn value<T: Real>(self, a: T) -> T {
        match self {
            Unary::Neg => -a,
            Unary::Sqrt => a.sqrt(),
            Unary::Sin => a.sin_cos().0,
            Unary::Cos => a.sin_cos().1,
            Unary::Exp => a.exp(),
            Unary::Ln => a.ln(),
            Unary::Tanh => a.tanh(),
            Unary::Floor => a.floor(),
            Unary::Abs => a.abs(),
        }
    }
}

impl Binary {
    /// Its value.
    #[inline]
    pub fn value<T: Real>(self, a: T, b: T) -> T {
        match self {
            Binary::Add => a + b,
            Binary::Sub => a - b,
            Binary::Mul => a * b,
            Binary::Div => a / b,
            Binary::Atan2 => a.atan2(b),
            Binary::Min => a.min(b),
            Binary::Max => a.max(b),
        }
    }

    /// Whether the arguments may change places without changing a bit of the value.
    #[must_use]
    pub fn commutes(self) -> bool {
        matches!(self, Binary::Add | Binary::Mul)
    }
}

impl Fused {
    /// Its value.
    #[inline]
    pub fn value<T: Real>(self, a: T, b: T, c: T) -> T {
        match self {
            Fused::Fmadd => a.fmadd(b, c),
            Fused::Fmsub => a.fmsub(b, c),
            Fused::Fnmadd => a.fnmadd(b, c),
        }
    }
}
