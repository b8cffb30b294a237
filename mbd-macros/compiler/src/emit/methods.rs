//! Typed methods: each quantity by name, with the arguments it reads and a value that says what it is.

use mbd_scene::Quantity;
use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use super::context::{EmitContext, docs, escaped};
use super::execution::quantity_path;
use super::literal::whole;
use super::quantity;
use crate::lists::{NumberList, ProgramArguments};
use crate::program::Program;

/// One method a quantity.
pub fn methods(context: &EmitContext) -> TokenStream {
    let (name, used, real) = (context.named(""), context.used(), context.real());
    let layout = &context.equations.layout;
    let mut quantities = layout.quantities();
    let requested = layout.on_request(&context.equations.scene);
    let emitted = |what: &Quantity| context.equations.program(*what).is_some();
    quantities.extend(requested.into_iter().filter(emitted));
    quantities.sort_by_key(|&what| order(what));
    let index = |what: Quantity| {
        let mut programs = context.equations.programs.iter();
        programs
            .position(|(known, _)| *known == what)
            .unwrap_or_default()
    };
    let methods = quantities
        .iter()
        .filter(|what| !matches!(what, Quantity::Partial(..)))
        .map(|&what| (what, context.equations.program(what)))
        // A quantity that is not emitted has no method; after an error every one has.
        .filter(|(what, program)| {
            program.is_some() || !layout.spells_out(*what) || context.equations.programs.is_empty()
        })
        .map(|(what, program)| method(context, (index(what), what), program));
    let kinematics = kinematics(context);
    let placement = quantities
        .contains(&Quantity::Bodies)
        .then(|| set_bodies(context));
    quote! {
        impl #real #name #used {
            #(#methods)*
            #kinematics
        }
        #placement
    }
}

/// The reverse of `bodies`: relative coordinates of what absolute ones say.
fn set_bodies(context: &EmitContext) -> TokenStream {
    let (name, state) = (context.named(""), context.named("State"));
    let (t, used, float) = (context.scalar(), context.used(), context.float());
    let layout = &context.equations.layout;
    let len = whole(layout.len(Quantity::Bodies));
    let (time, at) = match context.scene().reads_time() {
        true => (Some(quote!(time: #t,)), quote!(time)),
        false => (None, context.zero()),
    };
    let inputs = context.named("Inputs");
    let (taken, given) = match layout.ni {
        0 => (None, quote!(&[])),
        _ => (
            Some(quote!(inputs: &#inputs #used,)),
            quote!(&inputs.to_array()),
        ),
    };
    quote! {
        impl #float #name #used {
            /// Sets the coordinates and speeds of joints in a state by where bodies are and how they move: the reverse of [`Self::bodies`]. Angles lie in
            /// (−π, π]; what the joints of the tree forbid is left out.
            pub fn set_bodies(
                &self,
                state: &mut #state #used,
                #time
                #taken
                bodies: &::mbd_runtime::nalgebra::SVector<#t, #len>,
            ) {
                let mut numbers = state.to_vec();
                let from = (self.values.as_slice(), #at, #given as &[#t]);
                <#t as ::mbd_runtime::Scalar>::set_bodies(declared(), from, bodies.as_slice(), &mut numbers);
                if let ::core::option::Option::Some(placed) = #state::from_slice(&numbers) {
                    *state = placed;
                }
            }
        }
    }
}

/// Methods in the order in which a user needs them, those that serve the runtime last.
fn order(what: Quantity) -> u8 {
    match what {
        Quantity::Derivative => 0,
        Quantity::Outputs => 1,
        what if serves_runtime(what) => 3,
        _ => 2,
    }
}

/// Whether a quantity is there for the solvers of the runtime: its method is not in the documentation.
fn serves_runtime(what: Quantity) -> bool {
    matches!(
        what,
        Quantity::AnchorStates
            | Quantity::Equilibrium(_)
            | Quantity::Rates
            | Quantity::Balance
            | Quantity::Guards
            | Quantity::CountedAngles
            | Quantity::ProjectionStep
    )
}

/// How a method takes what its function reads.
struct Signature {
    taken: Vec<TokenStream>,
    prepared: TokenStream,
    passed: Vec<TokenStream>,
}

fn signature(context: &EmitContext, what: Quantity, program: Option<&Program>) -> Signature {
    let equations = context.equations;
    let (t, used, state) = (context.scalar(), context.used(), context.named("State"));
    let reads = match program {
        Some(program) => ProgramArguments::of(program, &equations.layout),
        // Solved on numbers, from where the nodes and their anchors are.
        None if !equations.layout.spells_out(what) => ProgramArguments(vec![
            NumberList::Nodes,
            NumberList::Effective,
            NumberList::Ends,
        ]),
        None => ProgramArguments(
            NumberList::ALL
                .into_iter()
                .filter(|g| g.len(equations, None) > 0)
                .filter(|g| g.is_expected(what, &equations.scene))
                .collect(),
        ),
    };
    let state_read = reads.reads_state();
    let mut taken = Vec::new();
    let mut prepared = TokenStream::new();
    if reads.reads(NumberList::Time) {
        taken.push(quote!(time: #t));
    }
    if state_read {
        taken.push(quote!(state: &#state #used));
    }
    for group in [
        NumberList::Nodes,
        NumberList::Effective,
        NumberList::Hold,
        NumberList::Ends,
        NumberList::Rows,
        NumberList::Motion,
    ] {
        if reads.reads(group) {
            let (list, len) = (
                format_ident!("{}", group.name()),
                whole(group.len(equations, program)),
            );
            taken.push(quote!(#list: &[#t; #len]));
        }
    }
    for (group, field) in [
        (NumberList::Q, "q"),
        (NumberList::V, "v"),
        (NumberList::Z, "z"),
        (NumberList::States, "s"),
    ] {
        if reads.reads(group) {
            let (list, field) = (format_ident!("{}", group.name()), format_ident!("{field}"));
            prepared.extend(quote!(let [#list] = &state.#field.data.0;));
        }
    }
    if reads.reads(NumberList::Inputs) {
        let inputs = context.named("Inputs");
        taken.push(quote!(inputs: &#inputs #used));
        prepared.extend(quote!(let inputs = &inputs.to_array();));
    }
    // A state that is typed is one in the world, its angles in (−π, π].
    for group in [NumberList::Turns, NumberList::Origin] {
        if reads.reads(group) {
            let (zero, len) = (context.zero(), whole(group.len(equations, program)));
            let list = format_ident!("{}", group.name());
            prepared.extend(quote!(let #list = &[#zero; #len];));
        }
    }
    let passed = reads
        .0
        .iter()
        .map(|&group| {
            let list = format_ident!("{}", group.name());
            match group {
                NumberList::Params => quote!(&self.values),
                NumberList::Derived => quote!(&self.derived),
                _ => quote!(#list),
            }
        })
        .collect();
    Signature {
        taken,
        prepared,
        passed,
    }
}

fn method(
    context: &EmitContext,
    (index, what): (usize, Quantity),
    program: Option<&Program>,
) -> TokenStream {
    let equations = context.equations;
    let t = context.scalar();
    let zero = context.zero();
    let layout = &equations.layout;
    let function = format_ident!("{}", quantity::name(&equations.scene, layout, what));
    let [text, shape] = quantity::documentation(layout, what);
    let cost = program
        .map(|p| format!("\n{}.", p.cost()))
        .unwrap_or_default();
    let mut doc = docs(&escaped(&format!("{text}\n\n{shape}{cost}")));
    if serves_runtime(what) {
        doc.extend(quote!(#[doc(hidden)]));
    }
    let Signature {
        taken,
        prepared,
        passed,
    } = signature(context, what, program);
    let on_numbers = !layout.spells_out(what) && !equations.programs.is_empty();
    let len = whole(layout.len(what));
    let compute = match program {
        Some(program) if program.outputs.is_empty() => TokenStream::new(),
        Some(_) => context.call(index, &function, &passed, None, &quote!(out)),
        None if on_numbers => {
            let path = quantity_path(what);
            quote! {
                let at = ::mbd_runtime::At {
                    time: #zero,
                    state: &[],
                    nodes,
                    effective,
                    hold: &[],
                    ends,
                    inputs: &[],
                    rows: &[],
                };
                ::mbd_runtime::scene::sensitivity(#path, &declared().layout, &at, out);
            }
        }
        None => quote!(let _ = out;),
    };
    if matches!(what, Quantity::MassMatrix | Quantity::CondensedStiffness(_)) {
        let side = whole(layout.len(what).isqrt());
        return quote! {
            #doc
            ///
            /// Only structural non-zeros are written: `out` starts at zero.
            #[inline]
            pub fn #function(&self, #(#taken,)* out: &mut ::mbd_runtime::nalgebra::SMatrix<#t, #side, #side>) {
                #prepared
                // Symmetric: by rows and by columns are the same.
                if let ::core::option::Option::Some(out) =
                    ::mbd_runtime::__private::fixed_mut::<#t, #len>(out.as_mut_slice())
                {
                    #compute
                }
            }
        };
    }
    if matches!(what, Quantity::NodeByAnchor(_)) {
        return quote! {
            #doc
            ///
            /// Only structural non-zeros are written: `out` starts at zero.
            #[inline]
            pub fn #function(&self, #(#taken,)* out: &mut [#t; #len]) {
                #prepared
                #compute
            }
        };
    }
    let (result, value) = value(context, what);
    quote! {
        #doc
        #[must_use]
        #[inline]
        pub fn #function(&self, #(#taken),*) -> #result {
            #prepared
            let mut values = [#zero; #len];
            let out = &mut values;
            #compute
            #value
        }
    }
}

/// Type and expression of what a method returns, from its list `values`.
fn value(context: &EmitContext, what: Quantity) -> (TokenStream, TokenStream) {
    let (t, used) = (context.scalar(), context.used());
    let layout = &context.equations.layout;
    match what {
        Quantity::Derivative => {
            let state = context.named("State");
            (quote!(#state #used), split_state(context))
        }
        Quantity::Outputs => {
            let outputs = context.named("Outputs");
            (quote!(#outputs #used), quote!(#outputs::from_array(values)))
        }
        Quantity::Coordinates => {
            let coordinates = context.named("Coordinates");
            (
                quote!(#coordinates #used),
                quote!(#coordinates::from_array(values)),
            )
        }
        Quantity::Energy => (
            quote!(::mbd_runtime::Energy<#t>),
            quote! {
                let [kinetic, gravitational, elastic, load_power, damper_power, drive_power] = values;
                ::mbd_runtime::Energy { kinetic, gravitational, elastic, load_power, damper_power, drive_power }
            },
        ),
        Quantity::Momentum => (
            quote!(::mbd_runtime::Momentum<#t>),
            quote! {
                let [px, py, pz, lx, ly, lz] = values;
                ::mbd_runtime::Momentum { linear: [px, py, pz], angular: [lx, ly, lz] }
            },
        ),
        Quantity::Lines => {
            let count = whole(layout.lines.len());
            (
                quote!([::mbd_runtime::LineState<#t>; #count]),
                quote!(::mbd_runtime::__private::line_states(&values)),
            )
        }
        Quantity::Reactions => {
            let count = whole(layout.joints.len());
            (
                quote!([::mbd_runtime::Reaction<#t>; #count]),
                quote!(::mbd_runtime::__private::reactions(&values)),
            )
        }
        Quantity::ConstraintJacobian
        | Quantity::CentreOfMassJacobian
        | Quantity::FrameJacobian(..) => {
            let columns = layout.columns_of(what);
            let [rows, columns] = [layout.len(what) / columns, columns].map(whole);
            let matrix = quote!(::mbd_runtime::nalgebra::SMatrix<#t, #rows, #columns>);
            (
                matrix,
                quote!(::mbd_runtime::nalgebra::SMatrix::from_row_slice(&values)),
            )
        }
        _ => {
            let len = whole(layout.len(what));
            (
                quote!(::mbd_runtime::nalgebra::SVector<#t, #len>),
                quote!(::mbd_runtime::nalgebra::SVector::from(values)),
            )
        }
    }
}

/// The list [q̇ | v̇ | ż | ṡ] as a state.
fn split_state(context: &EmitContext) -> TokenStream {
    let state = context.named("State");
    let layout = &context.equations.layout;
    let all_z = (layout.nz > 0).then(|| quote!(z: z.into()));
    let t = context.scalar();
    let [nq, nv, nz, ns] = [layout.nq, layout.nv, layout.nz, layout.ns].map(whole);
    if layout.ns > 0 {
        let all_z = all_z.map_or_else(|| quote!(), |z| quote!(#z,));
        let unread = (layout.nz == 0).then(|| quote!(let _ = z;));
        return quote! {
            let (q, v, z, s): ([#t; #nq], [#t; #nv], [#t; #nz], [#t; #ns]) =
                ::mbd_runtime::__private::parts_with_states(&values);
            #unread
            #state { q: q.into(), v: v.into(), #all_z s: s.into() }
        };
    }
    quote! {
        let (q, v, z): ([#t; #nq], [#t; #nv], [#t; #nz]) = ::mbd_runtime::__private::parts(&values);
        #state { q: q.into(), v: v.into(), #all_z }
    }
}

/// q̇ = N(q) v.
fn kinematics(context: &EmitContext) -> TokenStream {
    let layout = &context.equations.layout;
    if layout.nq == 0 {
        return TokenStream::new();
    }
    let (t, len) = (context.scalar(), whole(layout.nq));
    let zero = context.zero();
    let program = context.equations.kinematics.as_ref();
    let Signature {
        taken,
        prepared,
        passed,
    } = signature(context, Quantity::Derivative, program);
    let compute = program.map(|_| {
        let index = context.equations.programs.len() + 1;
        let function = format_ident!("kinematics");
        context.call(index, &function, &passed, None, &quote!(&mut values))
    });
    quote! {
        /// Rates of the coordinates: `q̇ = N(q) v`. q̇ is not v: a quaternion has four rates, an angular velocity three.
        #[must_use]
        #[inline]
        pub fn kinematics(&self, #(#taken),*) -> ::mbd_runtime::nalgebra::SVector<#t, #len> {
            #prepared
            let mut values = [#zero; #len];
            #compute
            ::mbd_runtime::nalgebra::SVector::from(values)
        }
    }
}
