//! Cutting a long program into pieces of a few hundred operations that end where a body, line or variable ends.
//!
//! Pieces that do the same are meant to be recognised ([`crate::kernels`]), so cuts are made where runs of operations that occur twice begin
//! and end. The order of operations does not change, so neither does a bit of the result. A mask is no number and cannot be handed on: a piece
//! that needs one from an earlier piece compares again.

use std::collections::HashSet;
use std::ops::Range;

use mbd_scene::Quantity;

use crate::hash::{Map, mixed};
use crate::operation::Op;
use crate::program::{Program, Register};

/// A program of at most this many operations stays one function, the fastest there is while it fits.
pub const FLAT: usize = 1000;
/// One that a run spends little time in is cut from this length on if most of it repeats.
const SMALL: usize = 200;
/// No piece is longer, copies of masks apart.
const LONGEST: usize = 600;
/// A run of operations on one thing that occurs twice becomes a piece of its own from this length on; shorter ones come in groups.
const SHARED: usize = 20;

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
    /// What it does and which of it is used later in a few words: equal for pieces alike.
    pub shape: Vec<u32>,
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
    let pieces = cut(program);
    let mut shapes = Shapes::default();
    let mut distinct = 0;
    for piece in &pieces {
        let (_, new) = shapes.of(&piece.shape);
        if new {
            distinct += piece.instructions.len();
        }
    }
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

fn cut(program: &Program) -> Vec<Piece> {
    let mut cutter = Cutter::new(program);
    let runs = runs(program);
    let mut alone: Vec<Option<Piece>> = Vec::with_capacity(runs.len());
    let mut shapes = Shapes::default();
    let mut kinds = Vec::with_capacity(runs.len());
    let mut counts: Vec<usize> = Vec::new();
    for run in &runs {
        let piece = cutter.measure(run.clone());
        let (kind, new) = shapes.of(&piece.shape);
        if new {
            counts.push(0);
        }
        counts[kind] += 1;
        kinds.push(kind);
        alone.push(Some(piece));
    }
    let alike: Vec<bool> = kinds.iter().map(|&kind| counts[kind] > 1).collect();
    // Runs from one number to another that make one piece.
    let mut groups: Vec<Range<usize>> = Vec::new();
    let (mut open, mut length) = (0, 0);
    for (index, run) in runs.iter().enumerate() {
        if index > open {
            // Short runs with others alike come in groups that start and end where those of the others do.
            let full = alike[open] && length >= SHARED;
            let other = alike[index] != alike[open] || alike[index] && run.len() >= SHARED;
            if full || other || length + run.len() > LONGEST {
                groups.push(open..index);
                (open, length) = (index, 0);
            }
        }
        length += run.len();
    }
    if open < runs.len() {
        groups.push(open..runs.len());
    }
    let piece = |group: Range<usize>| match alone.get_mut(group.start).filter(|_| group.len() == 1)
    {
        Some(piece) => piece.take(),
        None => Some(cutter.measure(runs[group].concat())),
    };
    groups.into_iter().filter_map(piece).collect()
}

/// The shapes of pieces, counted.
#[derive(Default)]
pub struct Shapes(Map<u64, Vec<(Vec<u32>, usize)>>, usize);

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
    places: Vec<usize>,
    /// Per register, the piece that last used it and what it is there.
    local: Vec<(u32, Local)>,
    /// How many pieces were measured.
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

    /// What a piece takes and gives, and its pattern. Masks from outside are added to its instructions.
    fn measure(&mut self, cut: Vec<usize>) -> Piece {
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
        let (piece, known) = (self.measured, self.program.constants.len());
        let (given, constants) = (&mut Vec::new(), &mut Vec::new());
        let (mut pattern, mut shape) = (Vec::with_capacity(cut.len()), Vec::new());
        for (place, &index) in instructions.iter().enumerate() {
            let local = self.local.as_mut_slice();
            let op = self.program.instructions[index].op.map(|register| {
                let entry = &mut local[register.index()];
                if entry.0 != piece {
                    let number = if register.index() < known {
                        constants.push(register);
                        Local::Constant(constants.len() - 1)
                    } else {
                        given.push(register);
                        Local::Given(given.len() - 1)
                    };
                    *entry = (piece, number);
                }
                entry.1
            });
            local[self.first + index] = (piece, Local::Value(place));
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
        Piece {
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

/// An operation of a piece as words, different for different operations.
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
