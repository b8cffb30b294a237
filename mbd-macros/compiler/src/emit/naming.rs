//! A name for every register of a program.

use mbd_scene::Quantity;

use super::quantity;
use super::wording::Wording;
use crate::equations::SceneEquations;
use crate::expression::Slot;
use crate::hash::FastMap;
use crate::lists::NumberList;
use crate::names::{self, identifier};
use crate::operation::Op;
use crate::partition::{Local, ProgramBlock};
use crate::program::{Instruction, Operand, Program, Register};
use crate::syntax::words;

/// Identifiers given out once each.
#[derive(Default)]
pub struct Unique {
    /// Every name given out, and how many were made of it.
    used: FastMap<String, usize>,
}

impl Unique {
    fn take(&mut self, name: &str) {
        self.used.insert(name.to_owned(), 1);
    }

    /// The name itself, or with the first number that makes it new.
    pub fn name(&mut self, base: &str) -> String {
        if !self.used.contains_key(base) {
            self.take(base);
            if !is_reserved(base) {
                return base.to_owned();
            }
        }
        loop {
            let count = self.used.entry(base.to_owned()).or_insert(1);
            *count += 1;
            let text = format!("{base}_{count}");
            if !self.used.contains_key(&text) {
                self.take(&text);
                return text;
            }
        }
    }
}

/// The names in a function.
pub struct FunctionNames {
    /// Numbers from outside.
    pub given: Vec<String>,
    /// Numbers known at build time.
    pub constants: Vec<String>,
    /// Values of operations; `None` for one that stands where it is used.
    pub values: Vec<Option<String>>,
}

/// The names of a program in one function: numbers by their value, slots by the declaration, terms by what the law called them. `parts`: what its
/// result holds from which place on.
pub fn flat_names(
    equations: &SceneEquations,
    program: &Program,
    parts: &[(usize, Quantity)],
    (ops, lets): (&[Op<Local>], &[bool]),
) -> FunctionNames {
    let mut unique = Unique::default();
    for group in NumberList::ALL
        .into_iter()
        .filter(|&group| group != NumberList::Time)
    {
        unique.take(group.name());
    }
    // A function of several quantities writes each to an argument of its name.
    for &(_, what) in parts {
        unique.take(quantity::kind(what));
    }
    // Slots first: their names are promised by the declaration.
    let slots = program.slots.iter();
    let given = slots
        .map(|&slot| unique.name(&slot_name(equations, slot)))
        .collect();
    let constants = program.constants.iter();
    let constants = constants
        .map(|&value| unique.name(&number_name(value)))
        .collect();
    let indices: Vec<usize> = (0..program.instructions.len()).collect();
    let (law, things) = (ValueNames::new(equations, program, parts), things(program));
    let thing = |section: usize| things.get(section).map_or("", String::as_str);
    value_names(&law, (&indices, ops, lets), thing, given, constants, unique)
}

/// The names in a kernel that takes `windows`. One that many share names no one thing, and one whose known numbers are arguments none of them.
pub fn kernel_names(
    equations: &SceneEquations,
    program: &Program,
    (block, lets): (&ProgramBlock, &[bool]),
    windows: &[String],
    (shared, tabled): (bool, bool),
) -> FunctionNames {
    let mut unique = Unique::default();
    for name in windows {
        unique.take(name);
    }
    for name in ["numbers", "own"] {
        unique.take(name);
    }
    let whole = program.what.filter(|_| program.by_column.is_none());
    let whole: Vec<(usize, Quantity)> = whole.map(|what| (0, what)).into_iter().collect();
    let law = ValueNames::new(equations, program, &whole);
    let given = block.given.iter();
    let given = given
        .map(|&register| unique.name(&given_name(&law, register, shared)))
        .collect();
    let constants = block.constants.iter();
    let constants = constants
        .map(|&register| match program.operand(register) {
            Operand::Constant(value) if !tabled => unique.name(&number_name(value)),
            _ => unique.name("number"),
        })
        .collect();
    let things = if shared { Vec::new() } else { things(program) };
    let thing = |section: usize| things.get(section).map_or("", String::as_str);
    let operations = (
        block.instructions.as_slice(),
        block.pattern.as_slice(),
        lets,
    );
    value_names(&law, operations, thing, given, constants, unique)
}

/// What the law and the declaration call the values of a program.
struct ValueNames<'a> {
    equations: &'a SceneEquations,
    program: &'a Program,
    /// What its result holds from which place on.
    parts: &'a [(usize, Quantity)],
    /// Per instruction, its first place in the result.
    places: Vec<Option<usize>>,
}

impl<'a> ValueNames<'a> {
    fn new(
        equations: &'a SceneEquations,
        program: &'a Program,
        parts: &'a [(usize, Quantity)],
    ) -> Self {
        let mut places = vec![None; program.instructions.len()];
        for &(place, register) in program.outputs.iter().rev() {
            if let Operand::Value(value) = program.operand(register) {
                places[value] = Some(place);
            }
        }
        ValueNames {
            equations,
            program,
            parts,
            places,
        }
    }

    /// The name of a value that is a result, with the thing it belongs to.
    fn result(&self, index: usize) -> Option<String> {
        let place = (*self.places.get(index)?)?;
        let mut parts = self.parts.iter().rev();
        let &(begin, what) = parts.find(|&&(begin, _)| begin <= place)?;
        let (scene, layout) = (&self.equations.scene, &self.equations.layout);
        names::result(scene, layout, what, place - begin)
    }
}

/// The things that the instructions of a program belong to, as identifiers.
fn things(program: &Program) -> Vec<String> {
    program.sections.iter().map(|s| identifier_of(s)).collect()
}

/// Names the operations `ops`, which are instructions `indices` of a program: by the law, by the result they are, by their operands, else by a
/// number. `thing` names sections.
fn value_names<'t>(
    law: &ValueNames<'_>,
    (indices, ops, lets): (&[usize], &[Op<Local>], &[bool]),
    thing: impl Fn(usize) -> &'t str,
    given: Vec<String>,
    constants: Vec<String>,
    mut unique: Unique,
) -> FunctionNames {
    let mut wording = Wording::new(ops, &given, &constants);
    let mut values = Vec::with_capacity(ops.len());
    for (&index, &has) in indices.iter().zip(lets) {
        let instruction = law.program.instructions.get(index).filter(|_| has);
        let Some(instruction) = instruction else {
            wording.push(None);
            values.push(None);
            continue;
        };
        let thing = thing(instruction.section);
        let named = match label_of(instruction) {
            Some(label) => Some(term_name(thing, Some(&label))),
            None => {
                let result = (!thing.is_empty()).then(|| law.result(index)).flatten();
                result.or_else(|| Some(term_name(thing, Some(&wording.next(thing)?))))
            }
        };
        let name = unique.name(named.as_deref().unwrap_or(&term_name(thing, None)));
        // A number says nothing in the name of another.
        wording.push(named.filter(|named| *named == name));
        values.push(Some(name));
    }
    FunctionNames {
        given,
        constants,
        values,
    }
}

/// The name of a number that a kernel takes.
fn given_name(law: &ValueNames<'_>, register: Register, shared: bool) -> String {
    let (equations, program) = (law.equations, law.program);
    match program.operand(register) {
        Operand::Slot(slot) => {
            let name = slot_name(equations, slot);
            match name.rsplit_once('_') {
                Some((_, last)) if shared && last.starts_with(|c: char| c.is_ascii_lowercase()) => {
                    last.to_owned()
                }
                _ if shared => "given".to_owned(),
                _ => name,
            }
        }
        Operand::Value(value) => {
            let instruction = program.instructions.get(value);
            let label = instruction.and_then(label_of);
            let thing = match instruction.and_then(|i| program.sections.get(i.section)) {
                Some(section) if !shared => identifier_of(section),
                _ => String::new(),
            };
            let result = || law.result(value).filter(|_| !shared);
            match label {
                None => result().unwrap_or_else(|| term_name(&thing, None)),
                Some(label) => term_name(&thing, Some(&label)),
            }
        }
        Operand::Constant(value) => number_name(value),
    }
}

/// Whether a name means something else: an argument of every function, a keyword.
fn is_reserved(name: &str) -> bool {
    name == "out" || words::is_keyword(name)
}

/// The identifier of a thing; nothing for nothing.
fn identifier_of(section: &str) -> String {
    match section {
        "" => String::new(),
        name => identifier(name),
    }
}

fn term_name(thing: &str, label: Option<&str>) -> String {
    match (thing, label) {
        ("", None) => "t".to_owned(),
        ("", Some(label)) => label.to_owned(),
        (thing, None) => format!("{thing}_t"),
        (thing, Some(label)) => format!("{thing}_{label}"),
    }
}

/// What the law calls a value.
fn label_of(instruction: &Instruction) -> Option<String> {
    let label = instruction.name?;
    Some(match label.opposite {
        true => format!("minus_{}", label.text),
        false => label.text.to_owned(),
    })
}

/// A derived term carries the name the law gave it.
fn slot_name(equations: &SceneEquations, slot: Slot) -> String {
    let derived = &equations.derived;
    if let Slot::Derived(index) = slot
        && let Some((_, register)) = derived.outputs.get(index)
        && let Operand::Value(value) = derived.operand(*register)
        && let Some(instruction) = derived.instructions.get(value)
        && let Some(label) = label_of(instruction)
    {
        let section = derived.sections.get(instruction.section);
        let thing = identifier_of(section.map_or("", String::as_str));
        return term_name(&thing, Some(&label));
    }
    names::slot(&equations.scene, &equations.layout, slot)
}

fn number_name(value: f64) -> String {
    let known = [
        (0.0, "zero"),
        (0.5, "half"),
        (1.0, "one"),
        (2.0, "two"),
        (3.0, "three"),
        (-0.5, "minus_half"),
        (-1.0, "minus_one"),
        (-2.0, "minus_two"),
        (mbd_scene::TINY, "tiny"),
    ];
    if let Some((_, name)) = known.iter().find(|(number, _)| *number == value) {
        return (*name).to_owned();
    }
    let text = format!("{value:?}");
    if text.len() > 8 || !value.is_finite() {
        return "c".to_owned();
    }
    let text = text
        .trim_end_matches(".0")
        .replace('.', "_")
        .replace("e-", "em")
        .replace('-', "m");
    format!("c_{text}")
}
