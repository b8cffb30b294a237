//! Cutting a long program into pieces of a few hundred operations that end where a body, line or variable ends.
//!
//! Pieces that do the same are meant to be recognised ([`crate::kernels`]), so cuts are made where runs of operations that occur twice begin
//! and end. The order of operations does not change, so neither does a bit of the result. A mask is no number and cannot be handed on: a piece
//! that needs one from an earlier piece compares again.

use std::collections::HashSet;
use std::ops::Range;

use mbd_scene::Quantity;

use crate::hash::Map;
use crate::operation::Op;
use crate::program::{Operand, Program, Register};

/// A program of at most this many operations stays one function, the fastest there is while it fits.
pub const FLAT: usize = 1000;
/// One that a run spends its time in is cut into as few pieces as can be up to this length: calls would cost it half as much again as its
/// operations (ten coupled planar four-bars, 2,250 operations: 0.79 µs in shared pieces, 0.53 µs in one), and all it is to build is little.
const DENSE: usize = 2500;
/// One that a run spends little time in is cut from this length on if most of it repeats.
const SMALL: usize = 200;
/// No piece is longer, copies of masks apart.
const LONGEST: usize = 600;
/// A run of operations on one thing that occurs twice becomes a piece of its own from this length on; shorter ones come in groups.
const SHARED: usize = 20;
/// Shorter rounds make a piece together.
const FULL: usize = 10;
/// No round has more runs.
const MOST: usize = 24;
/// Fewer rounds are none.
const FEWEST: usize = 3;

/// A part of a program.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// Its instructions, by index, in order.
    pub instructions: Vec<usize>,
    /// What each does: arguments counted inside the piece.
    pub pattern: Vec<Op<Local>>,
    /// The numbers it takes that are not known at build time, in the order of their first use.
    pub given: Vec<Register>,
    /// The numbers it takes that are known at build time, in the order of their first use.
    pub constants: Vec<Register>,
    /// Its instructions whose values are used later, as places in `instructions`: first those that go to the result, by their place there.
    pub results: Vec<usize>,
}

/// An argument of an operation of a piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Local {
    /// The value of an operation of the piece.
    Value(usize),
    /// A number of [`Piece::given`].
    Given(usize),
    /// A number of [`Piece::constants`].
    Constant(usize),
}

/// Cuts a program; `None` if it is short enough to stay one function.
#[must_use]
pub fn outline(program: &Program) -> Option<Vec<Piece>> {
    let count = program.instructions.len();
    if count <= FLAT && (is_hot(program) || count + program.outputs.len() < SMALL) {
        return None;
    }
    if count <= DENSE && is_hot(program) {
        return Some(fewest(program));
    }
    let pieces = cut(program);
    let mut known = HashSet::new();
    let distinct: usize = pieces
        .iter()
        .filter(|piece| known.insert((&piece.pattern, &piece.results)))
        .map(|piece| piece.instructions.len())
        .sum();
    (count > FLAT || 2 * distinct <= count).then_some(pieces)
}

/// Whether a run spends its time there; rows and their rates are short beside derivative and correction.
fn is_hot(program: &Program) -> bool {
    program.what.is_some_and(|what| {
        !matches!(
            what,
            Quantity::Energy
                | Quantity::Momentum
                | Quantity::MassMatrix
                | Quantity::BiasForce
                | Quantity::Forces
                | Quantity::Lines
                | Quantity::Outputs
                | Quantity::Constraint
                | Quantity::ConstraintJacobian
                | Quantity::ConstraintRate
                | Quantity::ConstraintBias
                | Quantity::Multipliers
                | Quantity::Reactions
        )
    })
}

/// As few pieces as can be, about equally long.
fn fewest(program: &Program) -> Vec<Piece> {
    let cutter = Cutter::new(program);
    let count = program.instructions.len();
    let length = count.div_ceil(count.div_ceil(LONGEST));
    let all: Vec<usize> = (0..count).collect();
    all.chunks(length)
        .map(|piece| cutter.measure(piece.to_vec()))
        .collect()
}

/// Pieces at the borders of what repeats.
fn cut(program: &Program) -> Vec<Piece> {
    let cutter = Cutter::new(program);
    let runs = runs(program);
    let mut alone: Vec<Option<Piece>> = runs
        .iter()
        .map(|run| Some(cutter.measure(run.clone())))
        .collect();
    let kinds = kinds(&alone);
    let lengths: Vec<usize> = runs.iter().map(Vec::len).collect();
    let piece = |group: Range<usize>| match alone.get_mut(group.start).filter(|_| group.len() == 1)
    {
        Some(piece) => piece.take(),
        None => Some(cutter.measure(runs[group].concat())),
    };
    let groups = groups(&kinds, &lengths);
    groups.into_iter().filter_map(piece).collect()
}

/// A number for each piece, the same for those that do the same.
fn kinds(pieces: &[Option<Piece>]) -> Vec<usize> {
    let mut known: Map<(&[Op<Local>], &[usize]), usize> = Map::default();
    let mut kinds = Vec::with_capacity(pieces.len());
    for piece in pieces.iter().flatten() {
        let next = known.len();
        kinds.push(
            *known
                .entry((&piece.pattern, &piece.results))
                .or_insert(next),
        );
    }
    kinds
}

/// Which runs make a piece together, given the kind and the length of each.
///
/// Where kinds follow one another in rounds, as from body to body, a piece is a round, or several short ones: a call costs as much as ten
/// operations.
fn groups(kinds: &[usize], lengths: &[usize]) -> Vec<Range<usize>> {
    let mut groups = Vec::new();
    let (mut open, mut start) = (0, 0);
    while start < kinds.len() {
        let Some((period, end)) = rounds(kinds, lengths, start) else {
            start += 1;
            continue;
        };
        groups.extend(others(kinds, lengths, open..start));
        groups.extend(
            (start..end)
                .step_by(period)
                .map(|from| from..end.min(from + period)),
        );
        (open, start) = (end, end);
    }
    groups.extend(others(kinds, lengths, open..start));
    groups
}

/// The runs of a piece, and the end of the rounds that begin with run `start`.
fn rounds(kinds: &[usize], lengths: &[usize], start: usize) -> Option<(usize, usize)> {
    let rest = &kinds[start..];
    let (period, rounds) = (1..=MOST.min(rest.len() / FEWEST))
        .map(|period| {
            let again = rest.iter().zip(&rest[period..]).take_while(|(a, b)| a == b);
            (period, 1 + again.count() / period)
        })
        .filter(|&(_, rounds)| rounds >= FEWEST)
        .max_by_key(|&(period, rounds)| (period * rounds, std::cmp::Reverse(period)))?;
    let length: usize = lengths[start..start + period].iter().sum();
    let together = match length * rounds <= 2 * FULL {
        true => rounds,
        false => FULL.div_ceil(length.max(1)).min(rounds / 2),
    };
    (length <= LONGEST).then_some((period * together.max(1), start + period * rounds))
}

/// Runs that do not come in rounds: those with others alike in groups that start and end where those of the others do.
fn others(kinds: &[usize], lengths: &[usize], runs: Range<usize>) -> Vec<Range<usize>> {
    let alike = |run: usize| kinds.iter().filter(|&&kind| kind == kinds[run]).count() > 1;
    let mut groups: Vec<Range<usize>> = Vec::new();
    let (mut open, mut length) = (runs.start, 0);
    for run in runs.clone() {
        if run > open {
            let full = alike(open) && length >= SHARED;
            let other = alike(run) != alike(open) || alike(run) && lengths[run] >= SHARED;
            if full || other || length + lengths[run] > LONGEST {
                groups.push(open..run);
                (open, length) = (run, 0);
            }
        }
        length += lengths[run];
    }
    if open < runs.end {
        groups.push(open..runs.end);
    }
    groups
}

/// Runs of instructions that belong to one thing, none longer than [`LONGEST`].
fn runs(program: &Program) -> Vec<Vec<usize>> {
    let mut runs: Vec<Vec<usize>> = Vec::new();
    let mut section = None;
    for (index, instruction) in program.instructions.iter().enumerate() {
        match runs.last_mut() {
            Some(run) if section == Some(instruction.section) => run.push(index),
            _ => runs.push(vec![index]),
        }
        section = Some(instruction.section);
    }
    runs.into_iter()
        .flat_map(|run| {
            let parts = run.len().div_ceil(LONGEST).max(1);
            let length = run.len().div_ceil(parts).max(1);
            run.chunks(length)
                .map(<[usize]>::to_vec)
                .collect::<Vec<_>>()
        })
        .collect()
}

/// What cutting a program needs to know about it.
struct Cutter<'a> {
    program: &'a Program,
    /// Registers before the first value.
    first: usize,
    /// Per instruction, the last instruction that uses it; the number of instructions if a result does.
    uses: Vec<usize>,
    /// Per instruction, its first place in the result.
    places: Map<usize, usize>,
}

impl<'a> Cutter<'a> {
    fn new(program: &'a Program) -> Self {
        let first = program.constants.len() + program.slots.len();
        let mut places = Map::default();
        for &(place, register) in &program.outputs {
            if let Some(value) = register.index().checked_sub(first) {
                places.entry(value).or_insert(place);
            }
        }
        Cutter {
            program,
            first,
            uses: last_uses(program, first),
            places,
        }
    }

    fn is_mask(&self, index: usize) -> bool {
        matches!(self.program.instructions[index].op, Op::Compare(..))
    }

    /// What a piece takes and gives, and its pattern. Masks from outside are added to its instructions.
    fn measure(&self, cut: Vec<usize>) -> Piece {
        let end = cut.last().copied().unwrap_or_default();
        let start = cut.first().copied().unwrap_or_default();
        let mut instructions = Vec::with_capacity(cut.len());
        let mut copied = HashSet::new();
        for &index in &cut {
            self.copy_masks(index, start, &mut copied, &mut instructions);
            instructions.push(index);
        }
        let local: Map<usize, usize> = instructions.iter().copied().zip(0..).collect();
        let (mut given, mut constants): (Vec<Register>, Vec<Register>) = (Vec::new(), Vec::new());
        let (mut given_at, mut constant_at) = (Map::default(), Map::default());
        let mut enter = |register: Register| {
            let value = register.index().checked_sub(self.first);
            if let Some(&value) = value.and_then(|value| local.get(&value)) {
                return Local::Value(value);
            }
            if matches!(self.program.operand(register), Operand::Constant(_)) {
                return Local::Constant(*constant_at.entry(register).or_insert_with(|| {
                    constants.push(register);
                    constants.len() - 1
                }));
            }
            Local::Given(*given_at.entry(register).or_insert_with(|| {
                given.push(register);
                given.len() - 1
            }))
        };
        let pattern = instructions
            .iter()
            .map(|&index| self.program.instructions[index].op.map(&mut enter))
            .collect();
        let mut results: Vec<usize> = cut
            .iter()
            .copied()
            .filter(|&index| self.uses[index] > end && !self.is_mask(index))
            .collect();
        results.sort_by_key(|index| self.places.get(index).copied().unwrap_or(usize::MAX));
        let results = results.iter().map(|index| local[index]).collect();
        Piece {
            instructions,
            pattern,
            given,
            constants,
            results,
        }
    }

    /// Adds the masks from before `start` that instruction `index` needs, arguments first.
    fn copy_masks(
        &self,
        index: usize,
        start: usize,
        copied: &mut HashSet<usize>,
        into: &mut Vec<usize>,
    ) {
        for argument in self.program.instructions[index].op.arguments() {
            let Some(value) = argument.index().checked_sub(self.first) else {
                continue;
            };
            if self.is_mask(value) && value < start && copied.insert(value) {
                self.copy_masks(value, start, copied, into);
                into.push(value);
            }
        }
    }
}

/// Per instruction, the last instruction that uses it; the number of instructions if a result does.
fn last_uses(program: &Program, first: usize) -> Vec<usize> {
    let count = program.instructions.len();
    let mut uses = vec![0; count];
    for (index, instruction) in program.instructions.iter().enumerate() {
        for argument in instruction.op.arguments() {
            if let Some(value) = argument.index().checked_sub(first) {
                uses[value] = index;
            }
        }
    }
    for (_, register) in &program.outputs {
        if let Some(value) = register.index().checked_sub(first) {
            uses[value] = count;
        }
    }
    // A mask that is compared again needs its arguments where it is used.
    for index in (0..count).rev() {
        let instruction = &program.instructions[index];
        if matches!(instruction.op, Op::Compare(..)) {
            for argument in instruction.op.arguments() {
                if let Some(value) = argument.index().checked_sub(first) {
                    uses[value] = uses[value].max(uses[index]);
                }
            }
        }
    }
    uses
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_are_the_rounds_from_body_to_body() {
        // Two runs before, five rounds of three, one after.
        let kinds = [&[7, 8][..], &[1, 2, 1].repeat(5), &[9]].concat();
        let lengths = vec![15; kinds.len()];
        let found = groups(&kinds, &lengths);
        let rounds: Vec<Range<usize>> = (2..17).step_by(3).map(|at| at..at + 3).collect();
        assert_eq!(found.first(), Some(&(0..2)));
        assert_eq!(found.get(1..6), Some(&rounds[..]));
        assert_eq!(found.last(), Some(&(17..18)));
    }

    #[test]
    fn short_rounds_make_a_piece_together() {
        assert_eq!(groups(&[4; 12], &[3; 12]), [0..4, 4..8, 8..12]);
        assert_eq!(groups(&[4; 5], &[2; 5]), [0..5]);
        // Three long rounds stay apart.
        assert_eq!(groups(&[4; 3], &[90; 3]), [0..1, 1..2, 2..3]);
    }

    #[test]
    fn every_run_is_in_one_group_and_none_is_too_long() {
        let mut seed: usize = 1;
        for _ in 0..2000 {
            let mut next = |below: usize| {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                (seed >> 33) % below
            };
            let count = next(60);
            let kinds: Vec<usize> = (0..count).map(|_| next(3)).collect();
            let lengths: Vec<usize> = kinds.iter().map(|kind| [2, 40, 350][*kind]).collect();
            let mut end = 0;
            for group in groups(&kinds, &lengths) {
                assert_eq!(group.start, end);
                end = group.end;
                assert!(lengths[group].iter().sum::<usize>() <= LONGEST);
            }
            assert_eq!(end, count);
        }
    }
}
