//! A program in blocks: kernels that many share, and the function that calls them.
//!
//! The working list belongs to the caller. A kernel takes windows of fixed lengths and writes one range of fixed length: nothing in it can be out
//! of range. A call cuts them out of the list, which is split where the range begins: what is before is read, the range is written. No place can
//! be wrong, since operations only use earlier ones; should the list be too short, the driver is `false` and writes nothing. Its length is known
//! to the driver, so rustc proves the places of every call that is written out.

use proc_macro2::TokenStream;

use super::function::{constants, taken, tokens};
use super::literal::{digits, document, number_text};
use super::naming::kernel_names;
use super::scalars::{Scalar, Scalars};
use super::terms::{Terms, lets};
use crate::equations::SceneEquations;
use crate::kernels::{Kernel, KernelDriver, Kernels, ResultPlaces, Window};
use crate::lists::NumberList;
use crate::partition::ProgramBlock;
use crate::program::{Instruction, Operand, Program, Register};
use crate::strided::{RoundItem, StridedRun};
use crate::titles::headings;

/// Every kernel of a model.
pub fn kernels(equations: &SceneEquations, kernels: &Kernels, scalars: &Scalars) -> TokenStream {
    let programs: Vec<&Program> = equations.every_program().collect();
    let mut out = String::new();
    for (index, kernel) in kernels.kernels.iter().enumerate() {
        let (program, block) = kernel.first;
        let scalar = scalars.of_kernel(index);
        let driver = kernels.drivers.get(program).and_then(Option::as_ref);
        let program = programs.get(program).zip(driver);
        let program = program.map(|(program, driver)| driver.program(program));
        let block = driver.and_then(|driver| driver.blocks.get(block));
        if let (Some(program), Some(block)) = (program, block) {
            write(equations, program, (kernel, scalar), block, &mut out);
        }
    }
    tokens(&out)
}

fn write(
    equations: &SceneEquations,
    program: &Program,
    (kernel, scalar): (&Kernel, Scalar),
    block: &ProgramBlock,
    out: &mut String,
) {
    let windows: Vec<String> = (0..kernel.windows.len())
        .map(|index| format!("from_{index}"))
        .collect();
    let named = |at: usize| {
        let instruction = block.instructions.get(at);
        let instruction = instruction.and_then(|&index| program.instructions.get(index));
        instruction.is_some_and(Instruction::is_named)
    };
    let lets = lets(&block.pattern, named, &block.results);
    let sharing = (kernel.users > 1, kernel.tabled);
    let names = kernel_names(equations, program, (block, &lets), &windows, sharing);
    let headings = match kernel.users {
        1 => headings(equations, program, &block.instructions, &lets),
        // One that many share has terms of no one thing.
        _ => Vec::new(),
    };
    let terms = Terms {
        scalar,
        headings,
        ops: block.pattern.clone(),
        given: names.given,
        constants: names.constants,
        values: names.values,
    };
    document(out, &documentation(program, kernel, block));
    let generics = scalar.generics();
    out.push_str(&format!("#[inline(never)] fn {}{generics}(", kernel.name));
    for (window, name) in kernel.windows.iter().zip(&windows) {
        out.push_str(&format!("{name}: &[T; {}], ", window.len));
    }
    if kernel.tabled {
        out.push_str(&format!("numbers: &[f64; {}], ", block.constants.len()));
    }
    out.push_str(&format!("own: &mut [T; {}]) {{\n", block.results.len()));
    for (window, name) in kernel.windows.iter().zip(&windows) {
        taken_from(window, &terms.given, name, out);
    }
    if kernel.tabled {
        out.push_str("let [");
        out.push_str(&terms.constants.join(", "));
        out.push_str("] = numbers.map(T::from_f64);\n");
    } else {
        let known = block.constants.iter();
        let known = known.filter_map(|&register| constant(program, register));
        constants(scalar, &known.collect::<Vec<f64>>(), &terms.constants, out);
    }
    terms.write(out);
    out.push_str("*own = [");
    let results: Vec<&str> = block.results.iter().map(|&at| terms.name(at)).collect();
    out.push_str(&results.join(", "));
    out.push_str("];\n}\n");
    at_places((kernel, scalar), block, &windows, out);
}

/// `let &[wx, _, wz] = from_0;`: what is read of a window.
fn taken_from(window: &Window, given: &[String], name: &str, out: &mut String) {
    let mut pattern = vec!["_"; window.len];
    for &(place, index) in &window.given {
        if let (Some(item), Some(name)) = (pattern.get_mut(place), given.get(index)) {
            *item = name;
        }
    }
    out.push_str(&format!("let &[{}] = {name};\n", pattern.join(", ")));
}

/// The kernel at places of a working list. Where these are known when the driver is compiled, nothing is left of it but the call.
fn at_places(
    (kernel, scalar): (&Kernel, Scalar),
    block: &ProgramBlock,
    windows: &[String],
    out: &mut String,
) {
    let (name, generics) = (&kernel.name, scalar.generics());
    document(out, &format!(" [`{name}`] at places of `work`."));
    let places: Vec<&str> = ["begin"]
        .into_iter()
        .chain(windows.iter().map(String::as_str))
        .collect();
    out.push_str(&format!(
        "#[inline(always)] fn {name}_at{generics}(work: &mut [T], [{}]: [usize; {}]",
        places.join(", "),
        places.len()
    ));
    if kernel.tabled {
        out.push_str(&format!(", numbers: &[f64; {}]", block.constants.len()));
    }
    let cut: String = windows
        .iter()
        .map(|window| {
            format!("let ::core::option::Option::Some({window}) = ::mbd_runtime::__private::window(known, {window}) else {{ return false; }};\n")
        })
        .collect();
    out.push_str(&format!(
        ") -> bool {{
            let ::core::option::Option::Some((known, own)) = ::mbd_runtime::__private::own_range(work, begin) else {{ return false; }};
            {cut}{name}({}{}own);
            true
        }}\n",
        windows.iter().map(|window| format!("{window}, ")).collect::<String>(),
        if kernel.tabled { "numbers, " } else { "" },
    ));
}

fn documentation(program: &Program, kernel: &Kernel, block: &ProgramBlock) -> String {
    let mut things: Vec<&str> = Vec::new();
    for &index in &block.instructions {
        let section = program.instructions[index].section;
        let thing = program.sections.get(section).map_or("", String::as_str);
        if !thing.is_empty() && !things.contains(&thing) {
            things.push(thing);
        }
    }
    let operations: usize = block.pattern.iter().map(|op| op.operations()).sum();
    let what = match things.as_slice() {
        [first, second, third, .., last] if things.len() > 6 => {
            format!("{first}, {second}, {third} … {last}")
        }
        _ => things.join(", "),
    };
    match kernel.users {
        1 => format!(" Terms of {what}: {operations} operations."),
        users => format!(" Terms of {what}, called in {users} places: {operations} operations."),
    }
}

/// The function of a program in blocks, from its arguments on.
pub fn driver(
    equations: &SceneEquations,
    (program, scalar): (&Program, Scalar),
    (kernels, driver): (&Kernels, &KernelDriver),
    out: &mut String,
) {
    let program = driver.program(program);
    let lists: Vec<NumberList> = driver.lists.iter().map(|&(group, _)| group).collect();
    let taken_lists: Vec<NumberList> = lists
        .into_iter()
        .filter(|list| !list.is_in_place())
        .collect();
    taken((equations, program), &taken_lists, out);
    out.push_str("work: &mut [T], out: &mut [T; ");
    digits(out, program.len);
    out.push_str(&format!(
        "]) -> bool {{
        let ::core::option::Option::Some(work) = work.first_chunk_mut::<{}>() else {{ return false; }};\n",
        driver.work
    ));
    let mut steps = Steps::default();
    let entered = driver
        .lists
        .iter()
        .filter(|(group, _)| !group.is_in_place());
    for &(group, at) in entered {
        let list = match group {
            NumberList::Time => format!("&[{}]", group.name()),
            _ => group.name().to_owned(),
        };
        steps.call(format!(
            "::mbd_runtime::__private::enter(work, {at}, {list})"
        ));
    }
    if !driver.kept.is_empty() {
        let values = driver.kept.iter().filter_map(|&r| constant(program, r));
        let values: Vec<String> = values.map(|value| scalar.number(value)).collect();
        let values = values.join(", ");
        steps.call(format!(
            "::mbd_runtime::__private::enter(work, {}, &[{values}])",
            driver.kept_at
        ));
    }
    for run in &driver.calls {
        calls(program, kernels, driver, run, &mut steps);
    }
    steps.end();
    out.push_str(&steps.text);
    results(&driver.results, out);
    out.push_str("}\n");
}

/// Hands the results over.
fn results(results: &ResultPlaces, out: &mut String) {
    let stretches = match results {
        ResultPlaces::All(places) => {
            document(out, " Places of the results in `work`.");
            out.push_str("const RESULTS: &[usize; ");
            digits(out, places.len());
            out.push_str(&format!("] = &{places:?};\n"));
            out.push_str("::mbd_runtime::__private::take(work, out, RESULTS)\n");
            return;
        }
        ResultPlaces::Some(stretches) => stretches,
    };
    let doc = " Structural non-zeros: rounds of (count, (place in `out`, step), (place in `work`, step)).";
    document(out, doc);
    out.push_str("const RESULTS: &[::mbd_runtime::__private::Copies] = &[");
    for run in stretches {
        out.push_str(&format!("({}, &[", run.rounds));
        for item in &run.items {
            out.push_str(&format!("({}", item.key));
            for (at, step) in item.at.iter().zip(&item.step) {
                out.push_str(&format!(", ({at}, {step})"));
            }
            out.push_str("), ");
        }
        out.push_str("]), ");
    }
    out.push_str("];\n::mbd_runtime::__private::copy(work, out, RESULTS)\n");
}

fn constant(program: &Program, register: Register) -> Option<f64> {
    match program.operand(register) {
        Operand::Constant(value) => Some(value),
        _ => None,
    }
}

/// Calls that follow one another, each only after the one before could do its work.
#[derive(Default)]
struct Steps {
    text: String,
    /// Calls of the statement that is open.
    open: usize,
}

impl Steps {
    /// No statement has more calls.
    const MOST: usize = 16;

    fn call(&mut self, call: String) {
        if self.open == Self::MOST {
            self.end();
        }
        self.text.push_str(match self.open {
            0 => "let done = ",
            _ => " && ",
        });
        self.text.push_str(&call);
        self.open += 1;
    }

    fn end(&mut self) {
        if std::mem::take(&mut self.open) > 0 {
            self.text.push_str(";\nif !done { return false; }\n");
        }
    }
}

/// A call, or rounds of calls.
fn calls(
    program: &Program,
    kernels: &Kernels,
    driver: &KernelDriver,
    run: &StridedRun,
    steps: &mut Steps,
) {
    let name = |item: &RoundItem| {
        let kernel = kernels.kernels.get(item.key);
        kernel.map_or("", |kernel| &kernel.name)
    };
    let tabled = |item: &RoundItem| {
        let kernel = kernels.kernels.get(item.key);
        kernel.is_some_and(|kernel| kernel.tabled)
    };
    let row = |round: usize, item: usize| {
        let block = driver.block(run, round, item);
        let constants = block.into_iter().flat_map(|block| &block.constants);
        let numbers = constants.filter_map(|&c| constant(program, c));
        let numbers: Vec<String> = numbers.map(number_text).collect();
        format!("[{}]", numbers.join(", "))
    };
    let rows = |item: usize| {
        let rows: Vec<String> = (0..run.rounds).map(|round| row(round, item)).collect();
        format!("&[{}]", rows.join(", "))
    };
    if run.rounds == 1 {
        for (index, item) in run.items.iter().enumerate() {
            let table = match tabled(item) {
                true => format!(", &{}", row(0, index)),
                false => String::new(),
            };
            steps.call(format!("{}_at(work, {:?}{table})", name(item), item.at));
        }
        return;
    }
    if let [item] = run.items.as_slice() {
        let (rounds, name, at, step) = (run.rounds, name(item), &item.at, &item.step);
        steps.call(match tabled(item) {
            true => format!(
                "::mbd_runtime::__private::rounds_with(work, {}, {at:?}, {step:?}, {name}_at)",
                rows(0)
            ),
            false => format!(
                "::mbd_runtime::__private::rounds(work, {rounds}, {at:?}, {step:?}, {name}_at)"
            ),
        });
        return;
    }
    steps.end();
    // Rows of numbers, one a round, nested in pairs.
    let (mut over, mut pattern) = (format!("0..{}", run.rounds), "_".to_owned());
    let mut body = Steps::default();
    for (index, item) in run.items.iter().enumerate() {
        let (at, step) = (&item.at, &item.step);
        steps
            .text
            .push_str(&format!("let mut at_{index} = {at:?};\n"));
        let mut numbers = String::new();
        if tabled(item) {
            over = format!("::core::iter::Iterator::zip({over}, {})", rows(index));
            pattern = format!("({pattern}, numbers_{index})");
            numbers = format!(", numbers_{index}");
        }
        let place = format!("::mbd_runtime::__private::next(&mut at_{index}, {step:?})");
        body.call(format!("{}_at(work, {place}{numbers})", name(item)));
    }
    body.end();
    steps
        .text
        .push_str(&format!("for {pattern} in {over} {{\n{}}}\n", body.text));
}
