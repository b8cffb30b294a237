//! A name for every register of a program.

use std::collections::{HashMap, HashSet};

use proc_macro2::{Ident, Span};

use crate::equations::Equations;
use crate::expression::Slot;
use crate::lists::Group;
use crate::names::{self, identifier};
use crate::program::{Operand, Program, Register};

/// Identifiers given out once each.
#[derive(Default)]
pub struct Unique {
    used: HashSet<String>,
    next: HashMap<String, usize>,
}

impl Unique {
    /// With the arguments of a kernel taken; `windows` are some of them.
    pub fn for_kernel(windows: &[Ident]) -> Self {
        let mut unique = Unique::default();
        unique.used.extend(windows.iter().map(Ident::to_string));
        let taken = ["work", "begin", "numbers", "known", "own"].map(str::to_owned);
        unique.used.extend(taken);
        unique
    }

    /// The name itself, or with the first number that makes it new.
    pub fn name(&mut self, base: &str) -> Ident {
        let mut text = base.to_owned();
        while is_reserved(&text) || !self.used.insert(text.clone()) {
            let count = self.next.entry(base.to_owned()).or_insert(1);
            *count += 1;
            text = format!("{base}_{count}");
        }
        Ident::new(&text, Span::call_site())
    }
}

/// A name for every register: numbers by their value, slots by the declaration, terms by what the law called them.
pub fn register_names(equations: &Equations, program: &Program) -> Vec<Ident> {
    let mut unique = Unique::default();
    for group in Group::ALL.into_iter().filter(|&group| group != Group::Time) {
        unique.used.insert(group.name().to_owned());
    }
    // Slots first: their names are promised by the declaration.
    let slots: Vec<Ident> = program
        .slots
        .iter()
        .map(|&slot| unique.name(&slot_name(equations, slot)))
        .collect();
    let mut names: Vec<Ident> = program
        .constants
        .iter()
        .map(|&value| unique.name(&number_name(value)))
        .collect();
    names.extend(slots);
    let things: Vec<String> = program.sections.iter().map(|s| identifier_of(s)).collect();
    for instruction in &program.instructions {
        let thing = things.get(instruction.section).map_or("", String::as_str);
        names.push(unique.name(&term_name(thing, instruction.name)));
    }
    names
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

/// The name of a register in a kernel; one that many share names no one thing.
pub fn local_name(
    equations: &Equations,
    program: &Program,
    register: Register,
    shared: bool,
) -> String {
    match program.operand(register) {
        Operand::Constant(value) => number_name(value),
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
    }
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
