//! A program in pieces: kernels that many share, and the function that calls them.
//!
//! The working list belongs to the caller. A kernel splits it where its own block begins: what is before is read, the block is written. No
//! place can be wrong, since operations only use earlier ones; should the list be too short, a call gives `None` and nothing more is written.

use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};

use super::function::{Terms, taken};
use super::literal::{number, signed, whole};
use super::naming::{Unique, local_name};
use crate::cycles::Cycle;
use crate::equations::Equations;
use crate::kernels::{Driver, Kernel, Kernels, Results};
use crate::outline::Piece;
use crate::program::{Operand, Program, Register};

/// Every kernel of a model. `users` says what a program is called.
pub fn kernels(equations: &Equations, kernels: &Kernels) -> TokenStream {
    let programs: Vec<&Program> = equations.every_program().collect();
    let all = kernels.kernels.iter().enumerate();
    let all = all.filter_map(|(index, found)| {
        let (program, piece) = found.first;
        let driver = kernels.drivers.get(program)?.as_ref()?;
        let (program, piece) = (programs.get(program)?, driver.pieces.get(piece)?);
        Some(kernel(equations, program, found, piece, &name(index)))
    });
    quote!(#(#all)*)
}

fn name(kernel: usize) -> Ident {
    format_ident!("part_{kernel}")
}

fn kernel(
    equations: &Equations,
    program: &Program,
    kernel: &Kernel,
    piece: &Piece,
    function: &Ident,
) -> TokenStream {
    let begins: Vec<Ident> = (0..kernel.windows.len())
        .map(|index| format_ident!("from_{index}"))
        .collect();
    let mut unique = Unique::for_kernel(&begins);
    let mut names: Vec<Option<Ident>> = vec![None; program.registers()];
    let first = program.constants.len() + program.slots.len();
    let values = piece
        .instructions
        .iter()
        .map(|&i| Register((first + i) as u32));
    let shared = kernel.users > 1;
    let registers = piece.given.iter().chain(&piece.constants).copied();
    for register in registers.chain(values) {
        let known = matches!(program.operand(register), Operand::Constant(_));
        let base = match known && kernel.tabled {
            true => "number".to_owned(),
            false => local_name(equations, program, register, shared),
        };
        names[register.index()] = Some(unique.name(&base));
    }
    let name = |register: Register| &names[register.index()];
    let windows = kernel.windows.iter().zip(&begins).map(|(window, begin)| {
        let mut pattern: Vec<TokenStream> = vec![quote!(_); window.len];
        for &(place, given) in &window.given {
            let name = piece.given.get(given).map(|&register| name(register));
            if let (Some(slot), Some(name)) = (pattern.get_mut(place), name) {
                *slot = quote!(#name);
            }
        }
        quote!(let &[#(#pattern),*] = ::mbd_runtime::__private::window(known, #begin)?;)
    });
    let (table, constants) = if kernel.tabled {
        let count = whole(piece.constants.len());
        let constants = piece.constants.iter().map(|&register| name(register));
        (
            quote!(, numbers: &[f64; #count]),
            quote!(let [#(#constants),*] = numbers.map(T::from_f64);),
        )
    } else {
        let lets = piece.constants.iter().filter_map(|&register| {
            let Operand::Constant(value) = program.operand(register) else {
                return None;
            };
            let (name, value) = (name(register), number(value));
            Some(quote!(let #name = T::from_f64(#value);))
        });
        (TokenStream::new(), quote!(#(#lets)*))
    };
    let terms = Terms {
        program,
        names: &names,
    }
    .lets(&piece.instructions);
    let results = piece.results.iter().filter_map(|&result| {
        let value = piece.instructions.get(result)?;
        Some(name(Register((first + value) as u32)))
    });
    let count = whole(1 + kernel.windows.len());
    let doc = documentation(program, kernel, piece);
    quote! {
        #[doc = #doc]
        #[inline(never)]
        fn #function<T: ::mbd_runtime::Real>(
            work: &mut [T], [begin, #(#begins),*]: [usize; #count] #table
        ) -> ::core::option::Option<()> {
            let (known, own) = work.split_at_mut_checked(begin)?;
            #(#windows)*
            #constants
            #terms
            *own.first_chunk_mut()? = [#(#results),*];
            ::core::option::Option::Some(())
        }
    }
}

fn documentation(program: &Program, kernel: &Kernel, piece: &Piece) -> String {
    let mut things: Vec<&str> = Vec::new();
    for &index in &piece.instructions {
        let section = program.instructions[index].section;
        let thing = program.sections.get(section).map_or("", String::as_str);
        if !thing.is_empty() && !things.contains(&thing) {
            things.push(thing);
        }
    }
    let operations = piece.instructions.len();
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

/// The function of a program in pieces.
pub fn driver(
    equations: &Equations,
    program: &Program,
    (kernels, driver): (&Kernels, &Driver),
    function: &Ident,
    docs: &[String],
) -> TokenStream {
    let taken = taken(equations, &driver.lists);
    let len = whole(program.len);
    let entered = driver.lists.iter().map(|group| {
        let list = format_ident!("{}", group.name());
        let list = match group {
            crate::lists::Group::Time => quote!(&[#list]),
            _ => quote!(#list),
        };
        quote!(let rest = ::mbd_runtime::__private::enter(rest, #list)?;)
    });
    let kept = (!driver.kept.is_empty()).then(|| {
        let values = driver.kept.iter().filter_map(|&r| constant(program, r));
        quote!(::mbd_runtime::__private::enter(rest, &[#(T::from_f64(#values)),*])?;)
    });
    let calls = driver
        .calls
        .iter()
        .map(|cycle| calls(program, kernels, driver, cycle));
    let results = results(&driver.results);
    quote! {
        #(#[doc = #docs])*
        #[inline(never)]
        fn #function<T: ::mbd_runtime::Real>(
            #(#taken,)* work: &mut [T], out: &mut [T; #len]
        ) -> ::core::option::Option<()> {
            let rest = &mut *work;
            #(#entered)*
            #kept
            #(#calls)*
            #results
        }
    }
}

/// Hands the results over.
fn results(results: &Results) -> TokenStream {
    let stretches = match results {
        Results::All(places) => {
            let (len, places) = (
                whole(places.len()),
                places.iter().map(|&place| whole(place)),
            );
            return quote! {
                /// Places of the results in `work`.
                const RESULTS: &[usize; #len] = &[#(#places),*];
                ::mbd_runtime::__private::take(work, out, RESULTS)
            };
        }
        Results::Some(stretches) => stretches,
    };
    let stretches = stretches.iter().map(|cycle| {
        let rounds = whole(cycle.rounds);
        let items = cycle.items.iter().map(|item| {
            let len = whole(item.key);
            let ends = item.at.iter().zip(&item.step).map(|(&at, &step)| {
                let (at, step) = (whole(at), signed(step));
                quote!((#at, #step))
            });
            quote!((#len, #(#ends),*))
        });
        quote!((#rounds, &[#(#items),*]))
    });
    quote! {
        /// Structural non-zeros: rounds of (count, (place in `out`, step), (place in `work`, step)).
        const RESULTS: &[::mbd_runtime::__private::Copies] = &[#(#stretches),*];
        ::mbd_runtime::__private::copy(work, out, RESULTS)
    }
}

fn constant(program: &Program, register: Register) -> Option<TokenStream> {
    match program.operand(register) {
        Operand::Constant(value) => Some(number(value)),
        _ => None,
    }
}

/// A call, or a loop of calls.
fn calls(program: &Program, kernels: &Kernels, driver: &Driver, cycle: &Cycle) -> TokenStream {
    let tabled = |item: usize| {
        let key = cycle.items.get(item).map(|item| item.key);
        key.and_then(|key| kernels.kernels.get(key))
            .is_some_and(|kernel| kernel.tabled)
    };
    let row = |round: usize, item: usize| {
        let piece = driver.piece(cycle, round, item);
        let constants = piece.into_iter().flat_map(|piece| &piece.constants);
        let numbers = constants.filter_map(|&c| constant(program, c));
        quote!([#(#numbers),*])
    };
    if cycle.rounds == 1 {
        let calls = cycle.items.iter().enumerate().map(|(index, item)| {
            let (kernel, at) = (name(item.key), item.at.iter().map(|&at| whole(at)));
            let table = tabled(index).then(|| {
                let row = row(0, index);
                quote!(, &#row)
            });
            quote!(#kernel(work, [#(#at),*] #table)?;)
        });
        return quote!(#(#calls)*);
    }
    let (mut begins, mut bodies, mut tables, mut rows) = (vec![], vec![], vec![], vec![]);
    for (index, item) in cycle.items.iter().enumerate() {
        let (kernel, place) = (name(item.key), format_ident!("at_{index}"));
        let at = item.at.iter().map(|&at| whole(at));
        let steps = item.step.iter().map(|&step| signed(step));
        begins.push(quote!(let mut #place = [#(#at),*];));
        let numbers = tabled(index).then(|| {
            let numbers = format_ident!("numbers_{index}");
            let all = (0..cycle.rounds).map(|round| row(round, index));
            tables.push(quote!(&[#(#all),*]));
            rows.push(numbers.clone());
            quote!(, #numbers)
        });
        bodies.push(quote! {
            #kernel(work, #place #numbers)?;
            #place = ::mbd_runtime::__private::advanced(#place, [#(#steps),*]);
        });
    }
    let rounds = whole(cycle.rounds);
    // Rows of numbers, one a round, nested in pairs.
    let (mut over, mut pattern) = (quote!(0..#rounds), quote!(_));
    for (table, row) in tables.into_iter().zip(rows) {
        over = quote!(::core::iter::Iterator::zip(#over, #table));
        pattern = quote!((#pattern, #row));
    }
    quote! {
        #(#begins)*
        for #pattern in #over { #(#bodies)* }
    }
}
