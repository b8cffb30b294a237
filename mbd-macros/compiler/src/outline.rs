//! Cutting a long program into kernels: pieces of a few hundred operations that end where a body, line or variable ends.
//!
//! Pieces of the same shape (same operations on the same pattern of arguments, numbers known at build time apart) share one kernel. The
//! order of operations does not change, so neither does a bit of the result. A mask is no number and cannot be handed on: a piece that
//! needs one from an earlier piece compares again.

use std::collections::{BTreeMap, HashMap, HashSet};

use crate::operation::Op;
use crate::program::{Operand, Program, Register};

/// A program of at most this many operations stays one function.
pub const FLAT: usize = 1000;
/// No kernel is longer, copies of masks apart.
const LONGEST: usize = 600;
/// A run of operations on one thing that occurs twice becomes a kernel of its own from this length on; shorter ones come in groups.
const SHARED: usize = 60;

/// A part of a program.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// Its instructions, by index, in order.
    pub instructions: Vec<usize>,
    /// The numbers it takes that are not known at build time, in the order of their first use.
    pub given: Vec<Register>,
    /// The numbers it takes that are known at build time, in the order of their first use.
    pub constants: Vec<Register>,
    /// Its instructions whose values are used later.
    pub results: Vec<usize>,
    /// Its shape.
    pub shape: usize,
}

/// A program in pieces.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// The pieces, in order.
    pub pieces: Vec<Piece>,
    /// Per shape: the first piece that has it, and whether its pieces differ in their known numbers.
    pub shapes: Vec<(usize, bool)>,
}

/// What one operation of a shape does: arguments counted inside the piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Local {
    Value(usize),
    Given(usize),
    Constant(usize),
}

type Key = (Vec<Op<Local>>, Vec<usize>);

/// Cuts a program; `None` if it is short enough to stay one function.
#[must_use]
pub fn outline(program: &Program) -> Option<Outline> {
    if program.instructions.len() <= FLAT {
        return None;
    }
    let first = program.constants.len() + program.slots.len();
    let uses = last_uses(program, first);
    let runs = runs(program);
    let measured: Vec<(Vec<usize>, Key)> = runs
        .into_iter()
        .map(|run| {
            let key = measure(program, first, &uses, run.clone()).1;
            (run, key)
        })
        .collect();
    let mut counts: HashMap<&Key, usize> = HashMap::new();
    for (_, key) in &measured {
        *counts.entry(key).or_default() += 1;
    }
    let mut cuts: Vec<Vec<usize>> = Vec::new();
    let mut open: Vec<usize> = Vec::new();
    let mut open_is_alike = false;
    for (run, key) in &measured {
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
    Some(share(program, first, &uses, cuts))
}

/// Gives each piece its shape.
fn share(program: &Program, first: usize, uses: &[usize], cuts: Vec<Vec<usize>>) -> Outline {
    let mut found: HashMap<Key, usize> = HashMap::new();
    let mut outline = Outline {
        pieces: Vec::new(),
        shapes: Vec::new(),
    };
    for cut in cuts {
        let (mut piece, key) = measure(program, first, uses, cut);
        let numbers = |piece: &Piece| -> Vec<Operand> {
            piece
                .constants
                .iter()
                .map(|&c| program.operand(c))
                .collect()
        };
        piece.shape = match found.get(&key) {
            Some(&shape) => {
                if let Some((earlier, differ)) = outline.shapes.get_mut(shape) {
                    *differ |= numbers(&outline.pieces[*earlier]) != numbers(&piece);
                }
                shape
            }
            None => {
                outline.shapes.push((outline.pieces.len(), false));
                found.insert(key, outline.shapes.len() - 1);
                outline.shapes.len() - 1
            }
        };
        outline.pieces.push(piece);
    }
    outline
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

/// What a piece takes and gives, and its shape. Masks from outside are added to its instructions.
fn measure(program: &Program, first: usize, uses: &[usize], cut: Vec<usize>) -> (Piece, Key) {
    let inside: HashSet<usize> = cut.iter().copied().collect();
    let end = cut.last().copied().unwrap_or_default();
    let mut instructions = Vec::new();
    let mut copied = HashSet::new();
    for &index in &cut {
        copy_masks(
            program,
            first,
            index,
            &inside,
            &mut copied,
            &mut instructions,
        );
        instructions.push(index);
    }
    let local: BTreeMap<usize, usize> = instructions.iter().copied().zip(0..).collect();
    let (mut given, mut constants): (Vec<Register>, Vec<Register>) = (Vec::new(), Vec::new());
    let (mut given_at, mut constant_at) = (HashMap::new(), HashMap::new());
    let mut enter = |register: Register| {
        if let Some(&value) = register
            .index()
            .checked_sub(first)
            .and_then(|v| local.get(&v))
        {
            return Local::Value(value);
        }
        if matches!(program.operand(register), Operand::Constant(_)) {
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
    let pattern: Vec<Op<Local>> = instructions
        .iter()
        .map(|&index| program.instructions[index].op.map(&mut enter))
        .collect();
    let is_mask = |index: usize| matches!(program.instructions[index].op, Op::Compare(..));
    let results: Vec<usize> = cut
        .iter()
        .copied()
        .filter(|&index| uses[index] > end && !is_mask(index))
        .collect();
    let places = results.iter().map(|index| local[index]).collect();
    let piece = Piece {
        instructions,
        given,
        constants,
        results,
        shape: 0,
    };
    (piece, (pattern, places))
}

/// Adds the masks from outside that instruction `index` needs, arguments first.
fn copy_masks(
    program: &Program,
    first: usize,
    index: usize,
    inside: &HashSet<usize>,
    copied: &mut HashSet<usize>,
    into: &mut Vec<usize>,
) {
    for argument in program.instructions[index].op.arguments() {
        let Some(value) = argument.index().checked_sub(first) else {
            continue;
        };
        let is_mask = matches!(program.instructions[value].op, Op::Compare(..));
        if is_mask && !inside.contains(&value) && copied.insert(value) {
            copy_masks(program, first, value, inside, copied, into);
            into.push(value);
        }
    }
}
