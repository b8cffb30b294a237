//! Cutting a long program into blocks of a few hundred operations that end where a body, line or variable ends.
//!
//! Blocks that do the same are meant to be recognised ([`crate::kernels`]), so cuts are made where runs of operations that occur twice begin
//! and end. The order of operations does not change, so neither does a bit of the result. A mask is no number and cannot be handed on: a block
//! that needs one from an earlier block compares again.

use std::collections::HashSet;
use std::ops::Range;

use mbd_scene::Quantity;

use crate::hash::{FastMap, mixed};
use crate::operation::Op;
use crate::program::{Program, Register};

/// A program of at most this many operations stays one function, the fastest there is while it fits.
pub const FLAT: usize = 1000;
/// One that a run spends its time in is cut into as few blocks as can be up to this length: calls would cost it half as much again as its
/// operations (ten coupled planar four-bars, 2,250 operations: 0.79 µs in shared blocks, 0.53 µs in one), and all it is to build is little.
const DENSE: usize = 2500;
/// One that a run spends little time in is cut from this length on if most of it repeats.
const SMALL: usize = 200;
/// No block is longer, copies of masks apart.
const LONGEST: usize = 600;
/// A run of operations on one thing that occurs twice becomes a block of its own from this length on; shorter ones come in groups.
const SHARED: usize = 20;

/// Shorter rounds make a block together.
const FULL: usize = 10;
/// No round has more runs.
const MOST: usize = 24;
/// Fewer rounds are none.
const FEWEST: usize = 3;

/// A part of a program.
#[derive(Clone, Debug, PartialEq)]
pub struct ProgramBlock {
    /// Its instructions, by index, in order.
    pub instructions: Vec<usize>,
    /// What each does: arguments counted inside the block.
    pub pattern: Vec<Op<Local>>,
    /// The numbers it takes that are not known at build time, in the order of their first use.
    pub given: Vec<Register>,
    /// The numbers it takes that are known at build time, in the order of their first use.
    pub constants: Vec<Register>,
    /// Its instructions whose values are used later, as places in `instructions`: first those that go to the result, by their place there.
    pub results: Vec<usize>,
    /// What it does and which of it is used later in a few words: equal for blocks alike.
    pub shape: Vec<u32>,
}

/// An argument of an operation of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Local {
    /// The value of an operation of the block.
    Value(usize),
    /// A number of [`ProgramBlock::given`].
    Given(usize),
    /// A number of [`ProgramBlock::constants`].
    Constant(usize),
}

/// Cuts a program; `None` if it is short enough to stay one function.
#[must_use]
pub fn partition(program: &Program) -> Option<Vec<ProgramBlock>> {
    let count = program.operations();
    if count <= FLAT && (is_hot(program) || count + program.outputs.len() < SMALL) {
        return None;
    }
    if count <= DENSE && is_hot(program) {
        return Some(fewest(program));
    }
    let length = program.instructions.len();
    let blocks = cut(program, 0..length);
    let mut shapes = Shapes::default();
    let mut distinct = 0;
    for block in &blocks {
        let (_, new) = shapes.of(&block.shape);
        if new {
            distinct += block.instructions.len();
        }
    }
    (count > FLAT || 2 * distinct <= length).then_some(blocks)
}

/// Cuts a program that begins with the operations of another where that one is cut into `first`, and then at `ends`. Blocks hand on what any
/// later one needs.
#[must_use]
pub fn partition_after(
    program: &Program,
    first: &[ProgramBlock],
    ends: &[usize],
) -> Vec<ProgramBlock> {
    let mut cutter = Cutter::new(program);
    let mut start = 0;
    let mut blocks = Vec::new();
    for block in first {
        let end = block.instructions.last().map_or(start, |last| last + 1);
        blocks.push(cutter.measure((start..end).collect()));
        start = end;
    }
    for &end in ends {
        blocks.extend(cut(program, start..end));
        start = end;
    }
    blocks
}

/// Whether a run spends its time there; rows and their rates are short beside derivative and correction.
fn is_hot(program: &Program) -> bool {
    // One column after another runs through blocks from body to body.
    program.by_column.is_none()
        && program.what.is_some_and(|what| {
            !matches!(
                what,
                Quantity::Energy
                    | Quantity::Momentum
                    | Quantity::MassMatrix
                    | Quantity::BiasForce
                    | Quantity::Forces
                    | Quantity::CentreOfMass
                    | Quantity::CentreOfMassJacobian
                    | Quantity::FrameJacobian(..)
                    | Quantity::Lines
                    | Quantity::Outputs
                    | Quantity::Coordinates
                    | Quantity::Constraint
                    | Quantity::ConstraintJacobian
                    | Quantity::ConstraintRate
                    | Quantity::ConstraintBias
                    | Quantity::Multipliers
                    | Quantity::Reactions
            )
        })
}

/// As few blocks as can be, about equally long.
fn fewest(program: &Program) -> Vec<ProgramBlock> {
    let mut cutter = Cutter::new(program);
    let count = program.instructions.len();
    let length = count.div_ceil(program.operations().div_ceil(LONGEST));
    let all: Vec<usize> = (0..count).collect();
    all.chunks(length)
        .map(|block| cutter.measure(block.to_vec()))
        .collect()
}

/// Blocks of a range of a program, at the borders of what repeats.
fn cut(program: &Program, range: Range<usize>) -> Vec<ProgramBlock> {
    let mut cutter = Cutter::new(program);
    let runs = runs(program, range);
    let mut alone: Vec<Option<ProgramBlock>> = runs
        .iter()
        .map(|run| Some(cutter.measure(run.clone())))
        .collect();
    let mut shapes = Shapes::default();
    let blocks = alone.iter().flatten();
    let kinds: Vec<usize> = blocks.map(|block| shapes.of(&block.shape).0).collect();
    let lengths: Vec<usize> = runs.iter().map(Vec::len).collect();
    let block = |group: Range<usize>| match alone.get_mut(group.start).filter(|_| group.len() == 1)
    {
        Some(block) => block.take(),
        None => Some(cutter.measure(runs[group].concat())),
    };
    let groups = groups(&kinds, &lengths);
    groups.into_iter().filter_map(block).collect()
}

/// Which runs make a block together, given the kind and the length of each.
///
/// Where kinds follow one another in rounds, as from body to body, a block is a round, or several short ones: a call costs as much as ten
/// operations.
fn groups(kinds: &[usize], lengths: &[usize]) -> Vec<Range<usize>> {
    let mut counts = vec![0; kinds.iter().max().map_or(0, |most| most + 1)];
    for &kind in kinds {
        if let Some(count) = counts.get_mut(kind) {
            *count += 1;
        }
    }
    let alike = |run: usize| counts.get(kinds[run]).is_some_and(|&count| count > 1);
    let mut groups = Vec::new();
    let (mut open, mut start) = (0, 0);
    while start < kinds.len() {
        let Some((period, end)) = rounds(kinds, lengths, start) else {
            start += 1;
            continue;
        };
        groups.extend(others(alike, lengths, open..start));
        groups.extend(
            (start..end)
                .step_by(period)
                .map(|from| from..end.min(from + period)),
        );
        (open, start) = (end, end);
    }
    groups.extend(others(alike, lengths, open..start));
    groups
}

/// The runs of a block, and the end of the rounds that begin with run `start`.
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

/// Runs that do not come in rounds: those with others alike in groups that start and end where those of the others do. Groups that are too short for
/// a block of their own join what is before them.
fn others(
    alike: impl Fn(usize) -> bool,
    lengths: &[usize],
    runs: Range<usize>,
) -> Vec<Range<usize>> {
    let mut groups: Vec<Range<usize>> = Vec::new();
    // Whether the last group may take what comes next: it has nothing to be shared for.
    let mut takes = false;
    let mut close = |group: Range<usize>| {
        let length = |group: &Range<usize>| lengths[group.clone()].iter().sum::<usize>();
        let (own, is_shared) = (length(&group), alike(group.start));
        let short = own < SHARED;
        match groups.last_mut() {
            Some(last) if takes && (short || !is_shared) && length(last) + own <= LONGEST => {
                last.end = group.end;
                takes = true;
            }
            _ => {
                groups.push(group);
                takes = short || !is_shared;
            }
        }
    };
    let (mut open, mut length) = (runs.start, 0);
    for run in runs.clone() {
        if run > open {
            let full = alike(open) && length >= SHARED;
            let other = alike(run) != alike(open) || alike(run) && lengths[run] >= SHARED;
            if full || other || length + lengths[run] > LONGEST {
                close(open..run);
                (open, length) = (run, 0);
            }
        }
        length += lengths[run];
    }
    if open < runs.end {
        close(open..runs.end);
    }
    groups
}

/// The shapes of blocks, counted.
#[derive(Default)]
pub struct Shapes(FastMap<u64, Vec<(Vec<u32>, usize)>>, usize);

impl Shapes {
    /// The number of a shape in the order of their first occurrence, and whether this is that.
    pub fn of(&mut self, shape: &[u32]) -> (usize, bool) {
        let mut hash = shape.len() as u64;
        for &word in shape {
            hash = mixed(hash, u64::from(word));
        }
        let same = self.0.entry(hash).or_default();
        if let Some(&(_, number)) = same.iter().find(|(known, _)| known == shape) {
            return (number, false);
        }
        same.push((shape.to_vec(), self.1));
        self.1 += 1;
        (self.1 - 1, true)
    }
}

/// Runs of instructions that belong to one thing, none longer than [`LONGEST`].
fn runs(program: &Program, range: Range<usize>) -> Vec<Vec<usize>> {
    let mut runs: Vec<Vec<usize>> = Vec::new();
    let mut section = None;
    for index in range {
        let instruction = &program.instructions[index];
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
    places: Vec<usize>,
    /// Per register, the block that last used it and what it is there.
    local: Vec<(u32, Local)>,
    /// How many blocks were measured.
    measured: u32,
    /// Whether it compares at all.
    has_masks: bool,
}

impl<'a> Cutter<'a> {
    fn new(program: &'a Program) -> Self {
        let first = program.constants.len() + program.slots.len();
        let mut places = vec![usize::MAX; program.instructions.len()];
        for &(place, register) in &program.outputs {
            if let Some(value) = register.index().checked_sub(first) {
                places[value] = places[value].min(place);
            }
        }
        Cutter {
            program,
            first,
            uses: last_uses(program, first),
            places,
            local: vec![(0, Local::Value(0)); program.registers()],
            measured: 0,
            has_masks: program
                .instructions
                .iter()
                .any(|i| matches!(i.op, Op::Compare(..))),
        }
    }

    fn is_mask(&self, index: usize) -> bool {
        matches!(self.program.instructions[index].op, Op::Compare(..))
    }

    /// What a block takes and gives, and its pattern. Masks from outside are added to its instructions.
    fn measure(&mut self, cut: Vec<usize>) -> ProgramBlock {
        let end = cut.last().copied().unwrap_or_default();
        let start = cut.first().copied().unwrap_or_default();
        let mut instructions = Vec::with_capacity(cut.len());
        let mut copied = HashSet::new();
        for &index in &cut {
            if self.has_masks {
                self.copy_masks(index, start, &mut copied, &mut instructions);
            }
            instructions.push(index);
        }
        self.measured += 1;
        let (block, known) = (self.measured, self.program.constants.len());
        let (given, constants) = (&mut Vec::new(), &mut Vec::new());
        let (mut pattern, mut shape) = (Vec::with_capacity(cut.len()), Vec::new());
        for (place, &index) in instructions.iter().enumerate() {
            let local = self.local.as_mut_slice();
            let op = self.program.instructions[index].op.map(|register| {
                let entry = &mut local[register.index()];
                if entry.0 != block {
                    let number = if register.index() < known {
                        constants.push(register);
                        Local::Constant(constants.len() - 1)
                    } else {
                        given.push(register);
                        Local::Given(given.len() - 1)
                    };
                    *entry = (block, number);
                }
                entry.1
            });
            local[self.first + index] = (block, Local::Value(place));
            write(op, &mut shape);
            pattern.push(op);
        }
        let mut results: Vec<usize> = Vec::new();
        for &index in &cut {
            if self.uses[index] > end && !self.is_mask(index) {
                results.push(index);
            }
        }
        results.sort_by_key(|&index| self.places[index]);
        shape.push(u32::MAX);
        for result in &mut results {
            if let (_, Local::Value(place)) = self.local[self.first + *result] {
                *result = place;
            }
            shape.push(*result as u32);
        }
        ProgramBlock {
            instructions,
            pattern,
            given: std::mem::take(given),
            constants: std::mem::take(constants),
            results,
            shape,
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

/// An operation of a block as words, different for different operations.
fn write(op: Op<Local>, words: &mut Vec<u32>) {
    let word = |local: Local| match local {
        Local::Value(index) => index as u32,
        Local::Given(index) => 1 << 30 | index as u32,
        Local::Constant(index) => 2 << 30 | index as u32,
    };
    // The kind says how many words follow; the operations end with a word that is no kind.
    match op {
        Op::Unary(kind, a) => {
            words.push(kind as u32);
            words.push(word(a));
        }
        Op::Binary(kind, a, b) => {
            words.push(16 + kind as u32);
            words.push(word(a));
            words.push(word(b));
        }
        Op::Compare(kind, a, b) => {
            words.push(32 + kind as u32);
            words.push(word(a));
            words.push(word(b));
        }
        Op::Select(mask, a, b) => {
            words.push(48);
            words.push(word(mask));
            words.push(word(a));
            words.push(word(b));
        }
        Op::Fused(kind, a, b, c) => {
            words.push(64 + kind as u32);
            words.push(word(a));
            words.push(word(b));
            words.push(word(c));
        }
    }
}

/// Per instruction, the last instruction that uses it; the number of instructions if a result does.
fn last_uses(program: &Program, first: usize) -> Vec<usize> {
    let count = program.instructions.len();
    let mut uses = vec![0; count];
    let last = uses.as_mut_slice();
    for (index, instruction) in program.instructions.iter().enumerate() {
        for argument in instruction.op.arguments() {
            let register = argument.index();
            if register >= first {
                last[register - first] = index;
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
    fn blocks_are_the_rounds_from_body_to_body() {
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
    fn short_rounds_make_a_block_together() {
        assert_eq!(groups(&[4; 12], &[3; 12]), [0..4, 4..8, 8..12]);
        assert_eq!(groups(&[4; 5], &[2; 5]), std::slice::from_ref(&(0..5)));
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
