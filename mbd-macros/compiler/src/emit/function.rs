//! One program as one function: arguments, named terms, results.

use mbd_scene::Quantity;
use proc_macro2::TokenStream;

use super::kernel;
use super::literal::{digits, document};
use super::naming::flat_names;
use super::quantity;
use super::scalars::{Scalar, Scalars};
use super::terms::{Terms, lets};
use crate::equations::{SceneEquations, is_matrix};
use crate::kernels::Kernels;
use crate::lists::{NumberList, ProgramArguments};
use crate::operation::Op;
use crate::partition::Local;
use crate::program::{Operand, Program, Register};
use crate::solution::Solution;
use crate::titles::headings;

/// The function of a program, which is number `index` of [`SceneEquations::every_program`]: `fn name<T: Real>(lists it reads, out)`, or, for one in
/// blocks, `fn name<T: Real>(lists it reads, work, out) -> bool`.
pub fn function(
    equations: &SceneEquations,
    (kernels, scalars): (&Kernels, &Scalars),
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
    let scalar = scalars.of_program(index);
    out.push_str(scalar.generics());
    out.push('(');
    let together = kernels.solution.as_ref();
    let together = together.and_then(|solution| Some((solution, solution.member(index)?)));
    match (kernels.drivers.get(index), together) {
        (Some(Some(driver)), _) => {
            kernel::driver(equations, (program, scalar), (kernels, driver), &mut out);
        }
        (_, Some((solution, (place, _)))) => member(equations, solution, program, place, &mut out),
        _ => flat(equations, (program, scalar), &mut out),
    }
    tokens(&out)
}

/// The function of the quantities that are found together. rustc takes it into the function of each and leaves out what that does not need.
pub fn solution(equations: &SceneEquations, scalars: &Scalars, solution: &Solution) -> TokenStream {
    let mut out = String::new();
    let (scene, layout) = (&equations.scene, &equations.layout);
    let names: Vec<String> = solution
        .members
        .iter()
        .map(|member| quantity::name(scene, layout, member.what))
        .collect();
    let what = format!(" The system solved once: {}.", names.join(", "));
    document(&mut out, &what);
    document(&mut out, &format!(" {}.", solution.program.cost()));
    out.push_str("#[inline(always)] fn solution");
    out.push_str(scalars.of_model().generics());
    out.push('(');
    let lists = ProgramArguments::of(&solution.program, layout).0;
    taken((equations, &solution.program), &lists, &mut out);
    let members = solution.members.iter().zip(&names);
    let given: Vec<String> = members
        .clone()
        .map(|(member, name)| format!("{name}: &mut [T; {}]", member.len))
        .collect();
    out.push_str(&format!("{}) {{\n", given.join(", ")));
    let parts: Vec<(usize, Quantity)> = solution
        .members
        .iter()
        .map(|member| (member.begin, member.what))
        .collect();
    let program = (&solution.program, scalars.of_model());
    let terms = body(equations, program, &parts, &mut out);
    let values = results(&solution.program, &terms);
    for (member, name) in members {
        let own = member.begin..member.begin + member.len;
        let own = values.iter().filter(|(place, _)| own.contains(place));
        let own: Vec<&str> = own.map(|&(_, value)| value).collect();
        out.push_str(&format!("*{name} = [{}];\n", own.join(", ")));
    }
    out.push('}');
    tokens(&out)
}

/// The function of a quantity that is found with others, from its arguments on. Lists it does not read are zero, as nothing of it depends on them;
/// what the others find goes nowhere.
fn member(
    equations: &SceneEquations,
    solution: &Solution,
    program: &Program,
    place: usize,
    out: &mut String,
) {
    let own = ProgramArguments::of(program, &equations.layout);
    taken((equations, program), &own.0, out);
    let all = ProgramArguments::of(&solution.program, &equations.layout);
    let passed = |&group: &NumberList| match group {
        group if own.reads(group) => group.name().to_owned(),
        NumberList::Time => "T::from_f64(0.0)".to_owned(),
        group => format!("&[T::from_f64(0.0); {}]", group.len(equations, None)),
    };
    let passed = all.0.iter().map(passed);
    let written = solution.members.iter().enumerate();
    let written = written.map(|(index, member)| match index == place {
        true => "out".to_owned(),
        false => format!("&mut [T::from_f64(0.0); {}]", member.len),
    });
    let passed: Vec<String> = passed.chain(written).collect();
    out.push_str(&format!(
        "out: &mut [T; {}]) {{\nsolution({});\n}}",
        program.len,
        passed.join(", ")
    ));
}

/// Text that is Rust as tokens at the call of the macro.
pub fn tokens(text: &str) -> TokenStream {
    text.parse().unwrap_or_default()
}

/// The lists a function takes, as arguments.
pub fn taken(
    (equations, program): (&SceneEquations, &Program),
    lists: &[NumberList],
    out: &mut String,
) {
    for &group in lists {
        out.push_str(group.name());
        if group == NumberList::Time {
            out.push_str(": T, ");
        } else {
            out.push_str(": &[T; ");
            digits(out, group.len(equations, Some(program)));
            out.push_str("], ");
        }
    }
}

fn flat(equations: &SceneEquations, (program, scalar): (&Program, Scalar), out: &mut String) {
    let arguments = ProgramArguments::of(program, &equations.layout);
    taken((equations, program), &arguments.0, out);
    out.push_str("out: &mut [T; ");
    digits(out, program.len);
    out.push_str("]) {\n");
    let whole = program.what.filter(|_| program.by_column.is_none());
    let parts: Vec<(usize, Quantity)> = whole.map(|what| (0, what)).into_iter().collect();
    let terms = body(equations, (program, scalar), &parts, out);
    returned(program, &terms, out);
    out.push('}');
}

/// What a function reads, knows and computes; the names of all that. `parts`: what the result holds from which place on.
fn body(
    equations: &SceneEquations,
    (program, scalar): (&Program, Scalar),
    parts: &[(usize, Quantity)],
    out: &mut String,
) -> Terms {
    let (ops, results) = inside(program);
    let lets = lets(
        &ops,
        |index| program.instructions[index].is_named(),
        &results,
    );
    let names = flat_names(equations, program, parts, (&ops, &lets));
    for group in ProgramArguments::of(program, &equations.layout).0 {
        if group != NumberList::Time {
            list(equations, program, group, &names.given, out);
        }
    }
    let all: Vec<usize> = (0..ops.len()).collect();
    let terms = Terms {
        scalar,
        headings: headings(equations, program, &all, &lets),
        ops,
        given: names.given,
        constants: names.constants,
        values: names.values,
    };
    constants(scalar, &program.constants, &terms.constants, out);
    terms.write(out);
    terms
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
    equations: &SceneEquations,
    program: &Program,
    group: NumberList,
    names: &[String],
    out: &mut String,
) {
    let mut pattern = vec!["_"; group.len(equations, Some(program))];
    for (&slot, name) in program.slots.iter().zip(names) {
        let (of, place) = NumberList::of(slot, &equations.layout);
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

/// `let half = T::from_f64(0.5);`, or `let half: T = 0.5;`, for each known number.
pub fn constants(scalar: Scalar, values: &[f64], names: &[String], out: &mut String) {
    for (&value, name) in values.iter().zip(names) {
        out.push_str("let ");
        out.push_str(name);
        out.push_str(match scalar {
            Scalar::Any => " = ",
            Scalar::Double => ": T = ",
        });
        out.push_str(&scalar.number(value));
        out.push_str(";\n");
    }
}

/// The name of each number of the result, by its place.
fn results<'t>(program: &Program, terms: &'t Terms) -> Vec<(usize, &'t str)> {
    let name = |register: Register| match program.operand(register) {
        Operand::Constant(_) => terms.constants.get(register.index()).map(String::as_str),
        Operand::Slot(_) => {
            let slot = register.index() - program.constants.len();
            terms.given.get(slot).map(String::as_str)
        }
        Operand::Value(value) => Some(terms.name(value)),
    };
    let outputs = program.outputs.iter();
    outputs
        .map(|&(place, register)| (place, name(register).unwrap_or_default()))
        .collect()
}

/// `*out = […]` for a list, one assignment a non-zero for a matrix.
fn returned(program: &Program, terms: &Terms, out: &mut String) {
    let named = results(program, terms);
    if program.what.is_some_and(is_matrix) {
        for (place, name) in named {
            out.push_str("out[");
            digits(out, place);
            out.push_str("] = ");
            out.push_str(name);
            out.push_str(";\n");
        }
    } else {
        let names: Vec<&str> = named.into_iter().map(|(_, name)| name).collect();
        out.push_str("*out = [");
        out.push_str(&names.join(", "));
        out.push_str("];\n");
    }
}
