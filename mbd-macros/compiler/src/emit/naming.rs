//! A name for every register of a program.

use crate::equations::Equations;
use crate::expression::Slot;
use crate::hash::Map;
use crate::lists::Group;
use crate::names::{self, identifier};
use crate::outline::Piece;
use crate::program::{Operand, Program, Register};

/// Identifiers given out once each.
#[derive(Default)]
pub struct Unique {
    /// Every name given out, and how many were made of it.
    used: Map<String, usize>,
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
pub struct Names {
    /// Numbers from outside.
    pub given: Vec<String>,
    /// Numbers known at build time.
    pub constants: Vec<String>,
    /// Values of operations; `None` for one that stands where it is used.
    pub values: Vec<Option<String>>,
}

/// The names of a program in one function: numbers by their value, slots by the declaration, terms by what the law called them.
pub fn flat_names(equations: &Equations, program: &Program, lets: &[bool]) -> Names {
    let mut unique = Unique::default();
    for group in Group::ALL.into_iter().filter(|&group| group != Group::Time) {
        unique.take(group.name());
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
    let things: Vec<String> = program.sections.iter().map(|s| identifier_of(s)).collect();
    let values = program.instructions.iter().zip(lets);
    let values = values.map(|(instruction, &has)| {
        let thing = things.get(instruction.section).map_or("", String::as_str);
        has.then(|| unique.name(&term_name(thing, instruction.name)))
    });
    Names {
        given,
        constants,
        values: values.collect(),
    }
}

/// The names in a kernel, whose windows begin at the names `windows`. One that many share names no one thing, and one whose known numbers are
/// arguments none of them.
pub fn kernel_names(
    equations: &Equations,
    program: &Program,
    (piece, lets): (&Piece, &[bool]),
    windows: &[String],
    (shared, tabled): (bool, bool),
) -> Names {
    let mut unique = Unique::default();
    for name in windows {
        unique.take(name);
    }
    for name in ["work", "begin", "numbers", "known", "own"] {
        unique.take(name);
    }
    let given = piece.given.iter();
    let given = given
        .map(|&register| unique.name(&given_name(equations, program, register, shared)))
        .collect();
    let constants = piece.constants.iter();
    let constants = constants
        .map(|&register| match program.operand(register) {
            Operand::Constant(value) if !tabled => unique.name(&number_name(value)),
            _ => unique.name("number"),
        })
        .collect();
    let mut thing = (None, String::new());
    let values = piece.instructions.iter().zip(lets);
    let values = values.map(|(&index, &has)| {
        let instruction = program.instructions.get(index).filter(|_| has)?;
        if !shared && thing.0 != Some(instruction.section) {
            let section = program.sections.get(instruction.section);
            thing = (
                Some(instruction.section),
                section.map_or_else(String::new, |section| identifier_of(section)),
            );
        }
        Some(unique.name(&term_name(&thing.1, instruction.name)))
    });
    Names {
        given,
        constants,
        values: values.collect(),
    }
}

/// The name of a number that a kernel takes.
fn given_name(
    equations: &Equations,
    program: &Program,
    register: Register,
    shared: bool,
) -> String {
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
            let label = instruction.and_then(|instruction| instruction.name);
            let thing = match instruction.and_then(|i| program.sections.get(i.section)) {
                Some(section) if !shared => identifier_of(section),
                _ => String::new(),
            };
            term_name(&thing, label)
        }
        Operand::Constant(value) => number_name(value),
    }
}

/// Whether a name means something else: an argument of every function, a keyword.
fn is_reserved(name: &str) -> bool {
    matches!(
        name,
        "out"
            | "as"
            | "async"
            | "await"
            | "break"
            | "const"
            | "continue"
            | "crate"
            | "dyn"
            | "else"
            | "enum"
            | "extern"
            | "false"
            | "fn"
            | "for"
            | "if"
            | "impl"
            | "in"
            | "let"
            | "loop"
            | "match"
            | "mod"
            | "move"
            | "mut"
            | "pub"
            | "ref"
            | "return"
            | "self"
            | "Self"
            | "static"
            | "struct"
            | "super"
            | "trait"
            | "true"
            | "type"
            | "unsafe"
            | "use"
            | "where"
            | "while"
            | "abstract"
            | "become"
            | "box"
            | "do"
            | "final"
            | "gen"
            | "macro"
            | "override"
            | "priv"
            | "try"
            | "typeof"
            | "unsized"
            | "virtual"
            | "yield"
            | "_"
    )
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

/// A derived term carries the name the law gave it.
fn slot_name(equations: &Equations, slot: Slot) -> String {
    if let Slot::Derived(index) = slot
        && let Some((_, register)) = equations.derived.outputs.get(index)
        && let Operand::Value(value) = equations.derived.operand(*register)
        && let Some(instruction) = equations.derived.instructions.get(value)
        && let Some(label) = instruction.name
    {
        let section = equations.derived.sections.get(instruction.section);
        let thing = section.map_or("", String::as_str);
        return if thing.is_empty() {
            label.to_owned()
        } else {
            format!("{}_{label}", identifier(thing))
        };
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
