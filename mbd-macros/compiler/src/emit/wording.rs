//! Words for terms that the law gave no name: a sum, product or quotient of two named numbers is called by them.

use crate::hash::FastMap;
use crate::operation::{Binary, Fused, Op, Unary};
use crate::partition::Local;

/// No such name is longer.
const LONGEST: usize = 28;

/// The operations of a function, and the words for its numbers so far.
pub struct Wording<'a> {
    /// Each operation.
    ops: &'a [Op<Local>],
    /// Words for the numbers from outside.
    given: &'a [String],
    /// Words for the numbers known at build time.
    constants: &'a [String],
    /// Words for the values so far; `None` for a value that has no words of its own.
    values: Vec<Option<String>>,
    /// Differences with a name, by what is subtracted from what.
    differences: FastMap<(Local, Local), usize>,
}

impl<'a> Wording<'a> {
    /// Before the first value has a name.
    pub fn new(ops: &'a [Op<Local>], given: &'a [String], constants: &'a [String]) -> Self {
        Wording {
            ops,
            given,
            constants,
            values: Vec::with_capacity(ops.len()),
            differences: FastMap::default(),
        }
    }

    /// Says what the next value is called; `None` if by a number only, or not at all.
    pub fn push(&mut self, name: Option<String>) {
        let index = self.values.len();
        if let (Some(_), Some(&Op::Binary(Binary::Sub, a, b))) = (&name, self.ops.get(index)) {
            self.differences.entry((a, b)).or_insert(index);
        }
        self.values.push(name);
    }

    /// Words for the next value, which belongs to `thing`.
    pub fn next(&self, thing: &str) -> Option<String> {
        let text = self.words(*self.ops.get(self.values.len())?, thing)?;
        (text.len() <= LONGEST).then_some(text)
    }

    fn words(&self, op: Op<Local>, thing: &str) -> Option<String> {
        let word = |local: Local| self.word(local, thing);
        match op {
            Op::Binary(Binary::Sub, a, b) if self.differences.contains_key(&(b, a)) => {
                let index = *self.differences.get(&(b, a))?;
                Some(format!("minus_{}", word(Local::Value(index))?))
            }
            Op::Binary(Binary::Mul, a, b) if a == b => Some(format!("{}_squared", word(a)?)),
            Op::Binary(Binary::Add, a, b) if a == b => Some(format!("twice_{}", word(a)?)),
            Op::Binary(Binary::Mul, a, b) => Some(format!("{}_{}", word(a)?, word(b)?)),
            Op::Binary(Binary::Add, a, b) => Some(format!("{}_plus_{}", word(a)?, word(b)?)),
            Op::Binary(Binary::Sub, a, b) => Some(format!("{}_minus_{}", word(a)?, word(b)?)),
            Op::Binary(Binary::Div, a, b) if word(a).as_deref() == Some("one") => {
                Some(format!("inverse_{}", word(b)?))
            }
            Op::Binary(Binary::Div, a, b) => Some(format!("{}_over_{}", word(a)?, word(b)?)),
            Op::Fused(Fused::Fmadd, a, b, c) => {
                Some(format!("{}_{}_plus_{}", word(a)?, word(b)?, word(c)?))
            }
            Op::Fused(Fused::Fmsub, a, b, c) => {
                Some(format!("{}_{}_minus_{}", word(a)?, word(b)?, word(c)?))
            }
            Op::Fused(Fused::Fnmadd, a, b, c) => {
                Some(format!("{}_minus_{}_{}", word(c)?, word(a)?, word(b)?))
            }
            Op::Unary(Unary::Neg, a) => Some(format!("minus_{}", word(a)?)),
            Op::Unary(Unary::Sqrt, a) => Some(format!("root_{}", word(a)?)),
            Op::Unary(Unary::Sin, a) => Some(format!("sin_{}", word(a)?)),
            Op::Unary(Unary::Cos, a) => Some(format!("cos_{}", word(a)?)),
            Op::Unary(Unary::Abs, a) => Some(format!("size_{}", word(a)?)),
            _ => None,
        }
    }

    /// The word for a number inside the words for another of `thing`.
    fn word(&self, local: Local, thing: &str) -> Option<String> {
        let full = match local {
            Local::Given(index) => self.given.get(index)?,
            Local::Constant(index) => {
                let name = self.constants.get(index)?;
                // A number without a word of its own is a factor of some size.
                return Some(match name.starts_with("c_") || name == "c" {
                    true => "scaled".to_owned(),
                    false => name.clone(),
                });
            }
            Local::Value(index) => match self.values.get(index)? {
                Some(name) => name,
                None => return None,
            },
        };
        let own = full
            .strip_prefix(thing)
            .and_then(|rest| rest.strip_prefix('_'));
        Some(own.filter(|_| !thing.is_empty()).unwrap_or(full).to_owned())
    }
}
