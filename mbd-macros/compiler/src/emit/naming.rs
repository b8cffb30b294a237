//! A name for every register of a program.

use std::collections::{HashMap, HashSet};

use proc_macro2::{Ident, Span};

use super::function::Group;
use crate::equations::Equations;
use crate::expression::Slot;
use crate::names::{self, identifier};
use crate::program::{Operand, Program};

/// Identifiers given out once each.
#[derive(Default)]
pub struct Unique {
    used: HashSet<String>,
    next: HashMap<String, usize>,
}

impl Unique {
    /// The name itself, or with the first number that makes it new.
    pub fn name(&mut self, base: &str) -> Ident {
        let mut text = base.to_owned();
        // `out` and `given` are arguments; a keyword is no name.
        while syn::parse_str::<Ident>(&text).is_err()
            || matches!(text.as_str(), "out" | "given" | "numbers")
            || !self.used.insert(text.clone())
        {
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
    for instruction in &program.instructions {
        let section = program
            .sections
            .get(instruction.section)
            .map_or("", String::as_str);
        let thing = if section.is_empty() {
            String::new()
        } else {
            identifier(section)
        };
        let base = match (thing.is_empty(), instruction.name) {
            (true, None) => "t".to_owned(),
            (true, Some(label)) => label.to_owned(),
            (false, None) => format!("{thing}_t"),
            (false, Some(label)) => format!("{thing}_{label}"),
        };
        names.push(unique.name(&base));
    }
    names
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
