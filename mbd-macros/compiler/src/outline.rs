//! Cutting a long program into pieces of a few hundred operations that end where a body, line or variable ends.
//!
//! Pieces that do the same are meant to be recognised ([`crate::kernels`]), so cuts are made where runs of operations that occur twice begin
//! and end. The order of operations does not change, so neither does a bit of the result. A mask is no number and cannot be handed on: a piece
//! that needs one from an earlier piece compares again.

use std::collections::{HashMap, HashSet};

use mbd_scene::Quantity;

use crate::operation::Op;
use crate::program::{Operand, Program, Register};

/// A program of at most this many operations stays one function, the fastest there is while it fits.
pub const FLAT: usize = 1000;
/// One that no step of a run waits for is cut from this length on if most of it repeats.
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
    if count <= FLAT && (is_awaited(program) || count + program.outputs.len() < SMALL) {
        return None;
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

/// Whether steps of a run wait for the result.
fn is_awaited(program: &Program) -> bool {
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
    let cutter = Cutter::new(program);
    let runs: Vec<(Vec<usize>, Key)> = runs(program)
        .into_iter()
        .map(|run| {
            let piece = cutter.measure(run.clone());
            (run, (piece.pattern, piece.results))
        })
        .collect();
    let mut counts: HashMap<&Key, usize> = HashMap::new();
    for (_, key) in &runs {
        *counts.entry(key).or_default() += 1;
    }
    let mut cuts: Vec<Vec<usize>> = Vec::new();
    let mut open: Vec<usize> = Vec::new();
    let mut open_is_alike = false;
    for (run, key) in &runs {
        let alike = counts.get(key).is_some_and(|&count| count > 1);
        // Short runs with others alike come in groups that start and end where those of the others do.
        let full = open_is_alike && open.len() >= SHARED;
        let other = alike != open_is_alike || alike && run.len() >= SHARED;
        if !open.is_empty() && (full || other || open.len() + run.len() > LONGEST) {
            cuts.push(std::mem::take(&mut open));
        }
        open.extend(run);
        open_is_alike = alike;
    }
    if !open.is_empty() {
        cuts.push(open);
    }
    cuts.into_iter().map(|cut| cutter.measure(cut)).collect()
}

type Key = (Vec<Op<Local>>, Vec<usize>);

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
    places: HashMap<usize, usize>,
}

impl<'a> Cutter<'a> {
    fn new(program: &'a Program) -> Self {
        let first = program.constants.len() + program.slots.len();
        let mut places = HashMap::new();
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
        let local: HashMap<usize, usize> = instructions.iter().copied().zip(0..).collect();
        let (mut given, mut constants): (Vec<Register>, Vec<Register>) = (Vec::new(), Vec::new());
        let (mut given_at, mut constant_at) = (HashMap::new(), HashMap::new());
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
