//! One program as one function: arguments, named terms, results.

use proc_macro2::TokenStream;

use super::kernel;
use super::literal::{digits, number_text};
use super::naming::flat_names;
use super::terms::{Terms, lets};
use crate::equations::{Equations, is_matrix};
use crate::kernels::Kernels;
use crate::lists::{Arguments, Group};
use crate::operation::Op;
use crate::outline::Local;
use crate::program::{Operand, Program, Register};
use crate::titles::headings;

/// The function of a program, which is number `index` of [`Equations::every_program`]: `fn name<T: Real>(lists it reads, out)`, or, for one in
/// pieces, `fn name<T: Real>(lists it reads, work, out) -> bool`.
pub fn function(
    equations: &Equations,
    kernels: &Kernels,
    (index, program): (usize, &Program),
    name: &str,
    docs: &[String],
) -> TokenStream {
    let mut out = String::new();
    for line in docs {
        document(&mut out, line);
    }
    out.push_str("#[inline(never)] fn ");
    out.push_str(name);
    out.push_str("<T: ::mbd_runtime::Real>(");
    match kernels.drivers.get(index) {
        Some(Some(driver)) => kernel::driver(equations, program, (kernels, driver), &mut out),
        _ => flat(equations, program, &mut out),
    }
    tokens(&out)
}

/// Text that is Rust as tokens at the call of the macro.
pub fn tokens(text: &str) -> TokenStream {
    text.parse().unwrap_or_default()
}

/// A line of documentation.
pub fn document(out: &mut String, line: &str) {
    out.push_str("#[doc = ");
    out.push_str(&format!("{line:?}"));
    out.push_str("]\n");
}

/// The lists a function takes, as arguments.
pub fn taken(equations: &Equations, lists: &[Group], out: &mut String) {
    for &group in lists {
        out.push_str(group.name());
        if group == Group::Time {
            out.push_str(": T, ");
        } else {
            out.push_str(": &[T; ");
            digits(out, group.len(equations));
            out.push_str("], ");
        }
    }
}

fn flat(equations: &Equations, program: &Program, out: &mut String) {
    let arguments = Arguments::of(program, &equations.layout);
    taken(equations, &arguments.0, out);
    out.push_str("out: &mut [T; ");
    digits(out, program.len);
    out.push_str("]) {\n");
    let (ops, results) = inside(program);
    let lets = lets(
        &ops,
        |index| program.instructions[index].is_named(),
        &results,
    );
    let names = flat_names(equations, program, &ops, &lets);
    for &group in arguments.0.iter().filter(|&&group| group != Group::Time) {
        list(equations, program, group, &names.given, out);
    }
    let all: Vec<usize> = (0..ops.len()).collect();
    let terms = Terms {
        headings: headings(equations, program, &all, &lets),
        ops: &ops,
        given: names.given,
        constants: names.constants,
        values: names.values,
    };
    constants(&program.constants, &terms.constants, out);
    terms.write(out);
    returned(program, &terms, out);
    out.push('}');
}

/// Every operation of a program, arguments counted by kind, and which of them go to the result.
fn inside(program: &Program) -> (Vec<Op<Local>>, Vec<usize>) {
    let known = program.constants.len();
    let first = known + program.slots.len();
    let local = |register: Register| match register.index() {
        index if index < known => Local::Constant(index),
        index if index < first => Local::Given(index - known),
        index => Local::Value(index - first),
    };
    let ops = program.instructions.iter().map(|i| i.op.map(local));
    let results = program.outputs.iter();
    let results = results.filter_map(|(_, register)| register.index().checked_sub(first));
    (ops.collect(), results.collect())
}

/// `let [canopy_x, _, canopy_z, …] = *q;`: what is read of a list.
fn list(
    equations: &Equations,
    program: &Program,
    group: Group,
    names: &[String],
    out: &mut String,
) {
    let mut pattern = vec!["_"; group.len(equations)];
    for (&slot, name) in program.slots.iter().zip(names) {
        let (of, place) = Group::of(slot, &equations.layout);
        if of == group
            && let Some(item) = pattern.get_mut(place)
        {
            *item = name;
        }
    }
    out.push_str("let [");
    out.push_str(&pattern.join(", "));
    out.push_str("] = *");
    out.push_str(group.name());
    out.push_str(";\n");
}

/// `let half = T::from_f64(0.5);` for each known number.
pub fn constants(values: &[f64], names: &[String], out: &mut String) {
    for (&value, name) in values.iter().zip(names) {
        out.push_str("let ");
        out.push_str(name);
        out.push_str(" = T::from_f64(");
        out.push_str(&number_text(value));
        out.push_str(");\n");
    }
}

/// `*out = […]` for a list, one assignment a non-zero for a matrix.
fn returned(program: &Program, terms: &Terms, out: &mut String) {
    let name = |register: Register| match program.operand(register) {
        Operand::Constant(_) => terms.constants.get(register.index()).map(String::as_str),
        Operand::Slot(_) => {
            let slot = register.index() - program.constants.len();
            terms.given.get(slot).map(String::as_str)
        }
        Operand::Value(value) => Some(terms.name(value)),
    };
    let named = program.outputs.iter();
    let named = named.map(|&(place, register)| (place, name(register).unwrap_or_default()));
    if program.what.is_some_and(is_matrix) {
        for (place, name) in named {
            out.push_str("out[");
            digits(out, place);
            out.push_str("] = ");
            out.push_str(name);
            out.push_str(";\n");
        }
    } else {
        let names: Vec<&str> = named.map(|(_, name)| name).collect();
        out.push_str("*out = [");
        out.push_str(&names.join(", "));
        out.push_str("];\n");
    }
}
