//! One program as one function: arguments, named terms, one operation a `let`, results.

use std::collections::{BTreeSet, HashMap, HashSet};

use mbd_scene::Layout;
use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};

use super::literal::{number, whole};
use super::naming::{Unique, register_names};
use crate::equations::{Equations, is_matrix};
use crate::expression::Slot;
use crate::operation::{Binary, Comparison, Op, Unary};
use crate::outline::{Outline, Piece, outline};
use crate::program::{Operand, Program, Register};

/// A list of numbers that a function takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Group {
    /// Time.
    Time,
    /// Coordinates.
    Q,
    /// Speeds.
    V,
    /// Positions of `rate` nodes.
    Z,
    /// Node unknowns.
    Nodes,
    /// Effective stiffness and free length.
    Effective,
    /// Hold flags.
    Hold,
    /// Anchors and node loads.
    Ends,
    /// Inputs.
    Inputs,
    /// Right-hand sides of rows.
    Rows,
    /// Live parameters.
    Params,
    /// Terms of the parameters.
    Derived,
}

impl Group {
    /// Every list, in the order of arguments.
    pub const ALL: [Group; 12] = [
        Group::Time,
        Group::Q,
        Group::V,
        Group::Z,
        Group::Nodes,
        Group::Effective,
        Group::Hold,
        Group::Ends,
        Group::Inputs,
        Group::Rows,
        Group::Params,
        Group::Derived,
    ];

    /// Its name as an argument.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Group::Time => "time",
            Group::Q => "q",
            Group::V => "v",
            Group::Z => "z",
            Group::Nodes => "nodes",
            Group::Effective => "effective",
            Group::Hold => "hold",
            Group::Ends => "ends",
            Group::Inputs => "inputs",
            Group::Rows => "rows",
            Group::Params => "params",
            Group::Derived => "derived",
        }
    }

    fn of(slot: Slot, layout: &Layout) -> (Group, usize) {
        match slot {
            Slot::Time => (Group::Time, 0),
            Slot::State(i) if i < layout.nq => (Group::Q, i),
            Slot::State(i) if i < layout.nq + layout.nv => (Group::V, i - layout.nq),
            Slot::State(i) => (Group::Z, i - layout.nq - layout.nv),
            Slot::Node(i) => (Group::Nodes, i),
            Slot::Effective(i) => (Group::Effective, i),
            Slot::Hold(i) => (Group::Hold, i),
            Slot::Ends(i) => (Group::Ends, i),
            Slot::Input(i) => (Group::Inputs, i),
            Slot::Row(i) => (Group::Rows, i),
            Slot::Param(i) => (Group::Params, i),
            Slot::Derived(i) => (Group::Derived, i),
        }
    }

    /// How many numbers it has.
    #[must_use]
    pub fn len(self, equations: &Equations) -> usize {
        let layout = &equations.layout;
        match self {
            Group::Time => 1,
            Group::Q => layout.nq,
            Group::V => layout.nv,
            Group::Z => layout.nz,
            Group::Nodes => 3 * layout.nodes.len(),
            Group::Effective => 2 * layout.effective_lines,
            Group::Hold => layout.one_way(),
            Group::Ends => layout.len(mbd_scene::Quantity::Ends),
            Group::Inputs => layout.ni,
            Group::Rows => layout.nc,
            Group::Params => layout.np,
            Group::Derived => equations.derived.len,
        }
    }
}

/// The lists a program reads, in order.
pub struct Arguments(pub Vec<Group>);

impl Arguments {
    /// Those of a program.
    #[must_use]
    pub fn of(program: &Program, layout: &Layout) -> Self {
        let used: BTreeSet<Group> = program
            .slots
            .iter()
            .map(|&slot| Group::of(slot, layout).0)
            .collect();
        Arguments(used.into_iter().collect())
    }

    /// Whether a list is read.
    #[must_use]
    pub fn reads(&self, group: Group) -> bool {
        self.0.contains(&group)
    }
}

/// The function of a program: `fn name<T: Real>(lists it reads, out)`.
pub fn function(
    equations: &Equations,
    program: &Program,
    name: &str,
    docs: &[String],
) -> TokenStream {
    let body = Body::new(equations, program);
    let name = format_ident!("{name}");
    let arguments = Arguments::of(program, &equations.layout);
    let taken = arguments.0.iter().map(|&group| {
        let (list, len) = (
            format_ident!("{}", group.name()),
            whole(group.len(equations)),
        );
        match group {
            Group::Time => quote!(#list: T),
            _ => quote!(#list: &[T; #len]),
        }
    });
    let len = whole(program.len);
    let (kernels, terms) = match outline(program) {
        None => (TokenStream::new(), body.flat()),
        Some(outline) => body.pieces(&outline, &name),
    };
    let (lists, results) = (body.lists(&arguments), body.results());
    quote! {
        #kernels
        #(#[doc = #docs])*
        #[inline(never)]
        fn #name<T: ::mbd_runtime::Real>(#(#taken,)* out: &mut [T; #len]) {
            #lists
            #terms
            #results
        }
    }
}

struct Body<'a> {
    equations: &'a Equations,
    program: &'a Program,
    /// One name a register.
    names: Vec<Ident>,
}

impl<'a> Body<'a> {
    fn new(equations: &'a Equations, program: &'a Program) -> Self {
        Body {
            equations,
            program,
            names: register_names(equations, program),
        }
    }

    fn name(&self, register: Register) -> &Ident {
        &self.names[register.index()]
    }

    fn value(&self, instruction: usize) -> Register {
        let first = self.program.constants.len() + self.program.slots.len();
        Register((first + instruction) as u32)
    }

    /// `let [canopy_x, canopy_y, …] = *q;` for every list that is read.
    fn lists(&self, arguments: &Arguments) -> TokenStream {
        let layout = &self.equations.layout;
        let mut patterns: HashMap<Group, Vec<Option<&Ident>>> = HashMap::new();
        for (index, &slot) in self.program.slots.iter().enumerate() {
            let (group, place) = Group::of(slot, layout);
            let len = group.len(self.equations);
            let pattern = patterns.entry(group).or_insert_with(|| vec![None; len]);
            pattern[place] = Some(&self.names[self.program.constants.len() + index]);
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

    fn constants(&self, registers: impl Iterator<Item = Register>) -> TokenStream {
        let lets = registers.filter_map(|register| match self.program.operand(register) {
            Operand::Constant(value) => {
                let (name, value) = (self.name(register), number(value));
                Some(quote!(let #name = T::from_f64(#value);))
            }
            _ => None,
        });
        quote!(#(#lets)*)
    }

    fn all_constants(&self) -> TokenStream {
        self.constants((0..self.program.constants.len()).map(|i| Register(i as u32)))
    }

    fn flat(&self) -> TokenStream {
        let constants = self.all_constants();
        let all: Vec<usize> = (0..self.program.instructions.len()).collect();
        let terms = self.terms(&all, &self.names);
        quote!(#constants #terms)
    }

    /// One `let` an operation; sine and cosine of one angle are one.
    fn terms(&self, instructions: &[usize], names: &[Ident]) -> TokenStream {
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
                let [sin, cos] = [sin, cos].map(|i| &names[self.value(i).index()]);
                let a = &names[a.index()];
                return quote!(let (#sin, #cos) = #a.sin_cos(););
            }
            let name = &names[self.value(index).index()];
            let value = operation(op.map(|register| &names[register.index()]));
            quote!(let #name = #value;)
        });
        quote!(#(#lets)*)
    }

    /// Kernels and their calls.
    fn pieces(&self, outline: &Outline, name: &Ident) -> (TokenStream, TokenStream) {
        let kernels = outline
            .shapes
            .iter()
            .enumerate()
            .map(|(shape, &(first, tabled))| {
                let users = outline
                    .pieces
                    .iter()
                    .filter(|piece| piece.shape == shape)
                    .count();
                self.kernel(
                    &outline.pieces[first],
                    &format_ident!("{name}_part_{shape}"),
                    users,
                    tabled,
                )
            });
        let calls = outline.pieces.iter().map(|piece| {
            let kernel = format_ident!("{name}_part_{}", piece.shape);
            let given = piece.given.iter().map(|&register| self.name(register));
            let results = piece
                .results
                .iter()
                .map(|&index| self.name(self.value(index)));
            let (_, tabled) = outline.shapes[piece.shape];
            let table = tabled.then(|| {
                let numbers =
                    piece
                        .constants
                        .iter()
                        .filter_map(|&c| match self.program.operand(c) {
                            Operand::Constant(value) => Some(number(value)),
                            _ => None,
                        });
                quote!(, &[#(#numbers),*])
            });
            quote!(let [#(#results),*] = #kernel::<T>(&[#(#given),*] #table);)
        });
        let kept = self.program.outputs.iter().map(|&(_, register)| register);
        let kept: BTreeSet<Register> = kept
            .filter(|&r| matches!(self.program.operand(r), Operand::Constant(_)))
            .collect();
        let constants = self.constants(kept.into_iter());
        (quote!(#(#kernels)*), quote!(#constants #(#calls)*))
    }

    fn kernel(&self, piece: &Piece, kernel: &Ident, users: usize, tabled: bool) -> TokenStream {
        // A kernel of several things names no one of them.
        let shared = (users > 1).then(|| self.local_names(piece));
        let names = shared.as_deref().unwrap_or(&self.names);
        let name = |register: Register| &names[register.index()];
        let (takes, gives) = (whole(piece.given.len()), whole(piece.results.len()));
        let given = piece.given.iter().map(|&register| name(register));
        let results = piece.results.iter().map(|&index| name(self.value(index)));
        let (table, constants) = if tabled {
            let count = whole(piece.constants.len());
            let constants = piece.constants.iter().map(|&register| name(register));
            (
                Some(quote!(, numbers: &[f64; #count])),
                quote!(let [#(#constants),*] = numbers.map(T::from_f64);),
            )
        } else {
            let lets = piece.constants.iter().filter_map(|&register| {
                match self.program.operand(register) {
                    Operand::Constant(value) => {
                        let (name, value) = (name(register), number(value));
                        Some(quote!(let #name = T::from_f64(#value);))
                    }
                    _ => None,
                }
            });
            (None, quote!(#(#lets)*))
        };
        let terms = self.terms(&piece.instructions, names);
        let doc = self.kernel_doc(piece, users);
        quote! {
            #[doc = #doc]
            #[inline(never)]
            fn #kernel<T: ::mbd_runtime::Real>(given: &[T; #takes] #table) -> [T; #gives] {
                let [#(#given),*] = *given;
                #constants
                #terms
                [#(#results),*]
            }
        }
    }

    fn kernel_doc(&self, piece: &Piece, users: usize) -> String {
        let mut things: Vec<&str> = Vec::new();
        for &index in &piece.instructions {
            let section = self.program.instructions[index].section;
            let thing = self
                .program
                .sections
                .get(section)
                .map_or("", String::as_str);
            if !thing.is_empty() && !things.contains(&thing) {
                things.push(thing);
            }
        }
        let operations = piece.instructions.len();
        let what = if things.len() > 6 {
            format!("{} … {}", things[..3].join(", "), things[things.len() - 1])
        } else {
            things.join(", ")
        };
        match users {
            1 => format!(" Terms of {what}: {operations} operations."),
            _ => format!(
                " Terms of {what}, and of {} more alike: {operations} operations.",
                users - 1
            ),
        }
    }

    /// Names without the thing they belong to.
    fn local_names(&self, piece: &Piece) -> Vec<Ident> {
        let mut names = self.names.clone();
        let mut unique = Unique::default();
        for (index, &register) in piece.given.iter().enumerate() {
            names[register.index()] = unique.name(&format!("given_{index}"));
        }
        for (index, &register) in piece.constants.iter().enumerate() {
            names[register.index()] = unique.name(&format!("number_{index}"));
        }
        for &index in &piece.instructions {
            let label = self.program.instructions[index].name.unwrap_or("t");
            names[self.value(index).index()] = unique.name(label);
        }
        names
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

fn operation(op: Op<&Ident>) -> TokenStream {
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
