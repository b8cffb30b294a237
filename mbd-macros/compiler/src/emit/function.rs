//! One program as one function: arguments, named terms, one operation a `let`, results.

use std::collections::{HashMap, HashSet};

use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};

use super::kernel;
use super::literal::{number, whole};
use super::naming::register_names;
use crate::equations::{Equations, is_matrix};
use crate::kernels::Kernels;
use crate::lists::{Arguments, Group};
use crate::operation::{Binary, Comparison, Op, Unary};
use crate::program::{Program, Register};

/// The function of a program, which is number `index` of [`Equations::every_program`]: `fn name<T: Real>(lists it reads, out)`, or, for one in
/// pieces, `fn name<T: Real>(lists it reads, work, out) -> Option<()>`.
pub fn function(
    equations: &Equations,
    kernels: &Kernels,
    (index, program): (usize, &Program),
    name: &str,
    docs: &[String],
) -> TokenStream {
    let name = format_ident!("{name}");
    if let Some(Some(driver)) = kernels.drivers.get(index) {
        return kernel::driver(equations, program, (kernels, driver), &name, docs);
    }
    let body = Body::new(equations, program);
    let arguments = Arguments::of(program, &equations.layout);
    let taken = taken(equations, &arguments.0);
    let len = whole(program.len);
    let (lists, terms, results) = (body.lists(&arguments), body.flat(), body.results());
    quote! {
        #(#[doc = #docs])*
        #[inline(never)]
        fn #name<T: ::mbd_runtime::Real>(#(#taken,)* out: &mut [T; #len]) {
            #lists
            #terms
            #results
        }
    }
}

/// The lists a function takes, as arguments.
pub fn taken(equations: &Equations, lists: &[Group]) -> Vec<TokenStream> {
    let argument = |&group: &Group| {
        let list = format_ident!("{}", group.name());
        let len = whole(group.len(equations));
        match group {
            Group::Time => quote!(#list: T),
            _ => quote!(#list: &[T; #len]),
        }
    };
    lists.iter().map(argument).collect()
}

/// Operations as `let`s.
pub struct Terms<'a> {
    /// What they are operations of.
    pub program: &'a Program,
    /// One name a register; none for those that do not occur.
    pub names: &'a [Option<Ident>],
}

impl Terms<'_> {
    fn name(&self, register: Register) -> Option<&Ident> {
        self.names.get(register.index())?.as_ref()
    }

    /// One `let` an operation; sine and cosine of one angle are one.
    pub fn lets(&self, instructions: &[usize]) -> TokenStream {
        let first = self.program.constants.len() + self.program.slots.len();
        let value = |index: usize| self.name(Register((first + index) as u32));
        let mut turned: HashMap<Register, [Option<usize>; 2]> = HashMap::new();
        for &index in instructions {
            match self.program.instructions[index].op {
                Op::Unary(Unary::Sin, a) => turned.entry(a).or_default()[0] = Some(index),
                Op::Unary(Unary::Cos, a) => turned.entry(a).or_default()[1] = Some(index),
                _ => {}
            }
        }
        let mut done = HashSet::new();
        let lets = instructions.iter().map(|&index| {
            let op = self.program.instructions[index].op;
            if let Op::Unary(Unary::Sin | Unary::Cos, a) = op
                && let Some(&[Some(sin), Some(cos)]) = turned.get(&a)
            {
                if !done.insert(a) {
                    return TokenStream::new();
                }
                let [sin, cos] = [sin, cos].map(value);
                let a = self.name(a);
                return quote!(let (#sin, #cos) = #a.sin_cos(););
            }
            let name = value(index);
            let value = operation(op.map(|register| self.name(register)));
            quote!(let #name = #value;)
        });
        quote!(#(#lets)*)
    }
}

struct Body<'a> {
    equations: &'a Equations,
    program: &'a Program,
    /// One name a register.
    names: Vec<Option<Ident>>,
}

impl<'a> Body<'a> {
    fn new(equations: &'a Equations, program: &'a Program) -> Self {
        let names = register_names(equations, program);
        Body {
            equations,
            program,
            names: names.into_iter().map(Some).collect(),
        }
    }

    fn name(&self, register: Register) -> Option<&Ident> {
        self.names.get(register.index())?.as_ref()
    }

    /// `let [canopy_x, canopy_y, …] = *q;` for every list that is read.
    fn lists(&self, arguments: &Arguments) -> TokenStream {
        let layout = &self.equations.layout;
        let mut patterns: HashMap<Group, Vec<Option<&Ident>>> = HashMap::new();
        for (index, &slot) in self.program.slots.iter().enumerate() {
            let (group, place) = Group::of(slot, layout);
            let len = group.len(self.equations);
            let pattern = patterns.entry(group).or_insert_with(|| vec![None; len]);
            pattern[place] = self.names[self.program.constants.len() + index].as_ref();
        }
        let lists = arguments
            .0
            .iter()
            .filter(|&&group| group != Group::Time)
            .map(|group| {
                let list = format_ident!("{}", group.name());
                let items = patterns
                    .get(group)
                    .into_iter()
                    .flatten()
                    .map(|item| match item {
                        Some(name) => quote!(#name),
                        None => quote!(_),
                    });
                quote!(let [#(#items),*] = *#list;)
            });
        quote!(#(#lists)*)
    }

    fn flat(&self) -> TokenStream {
        let constants = self.program.constants.iter().zip(&self.names);
        let constants = constants.map(|(&value, name)| {
            let value = number(value);
            quote!(let #name = T::from_f64(#value);)
        });
        let all: Vec<usize> = (0..self.program.instructions.len()).collect();
        let terms = Terms {
            program: self.program,
            names: &self.names,
        }
        .lets(&all);
        quote!(#(#constants)* #terms)
    }

    /// `*out = […]` for a list, one assignment a non-zero for a matrix.
    fn results(&self) -> TokenStream {
        let named = self
            .program
            .outputs
            .iter()
            .map(|&(_, register)| self.name(register));
        if self.program.what.is_some_and(is_matrix) {
            let places = self.program.outputs.iter().map(|&(place, _)| whole(place));
            quote!(#(out[#places] = #named;)*)
        } else {
            quote!(*out = [#(#named),*];)
        }
    }
}

fn operation(op: Op<Option<&Ident>>) -> TokenStream {
    match op {
        Op::Unary(Unary::Neg, a) => quote!(-#a),
        Op::Unary(Unary::Sqrt, a) => quote!(#a.sqrt()),
        Op::Unary(Unary::Sin, a) => quote!(#a.sin_cos().0),
        Op::Unary(Unary::Cos, a) => quote!(#a.sin_cos().1),
        Op::Unary(Unary::Exp, a) => quote!(#a.exp()),
        Op::Unary(Unary::Abs, a) => quote!(#a.abs()),
        Op::Binary(Binary::Add, a, b) => quote!(#a + #b),
        Op::Binary(Binary::Sub, a, b) => quote!(#a - #b),
        Op::Binary(Binary::Mul, a, b) => quote!(#a * #b),
        Op::Binary(Binary::Div, a, b) => quote!(#a / #b),
        Op::Binary(Binary::Atan2, a, b) => quote!(#a.atan2(#b)),
        Op::Binary(Binary::Min, a, b) => quote!(#a.min(#b)),
        Op::Binary(Binary::Max, a, b) => quote!(#a.max(#b)),
        Op::Compare(Comparison::Lt, a, b) => quote!(#a.lt(#b)),
        Op::Compare(Comparison::Le, a, b) => quote!(#a.le(#b)),
        Op::Compare(Comparison::Both, a, b) => quote!(T::both(#a, #b)),
        Op::Select(mask, a, b) => quote!(T::select(#mask, #a, #b)),
    }
}
