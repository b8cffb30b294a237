//! `impl Model`: the trait through which every execution of a scene is called.

use mbd_scene::Quantity;
use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use super::columns::{by_column, solutions};
use super::context::EmitContext;
use super::literal::whole;
use super::quantity;
use crate::equations::of_origin;
use crate::lists::{NumberList, ProgramArguments};
use crate::program::Program;

/// `impl Model`.
pub fn implementation(context: &EmitContext) -> TokenStream {
    let (name, used, float, t) = (
        context.named(""),
        context.used(),
        context.float(),
        context.scalar(),
    );
    let equations = context.equations;
    let (params, work) = (
        context.named("Params"),
        whole(context.kernels.work(equations)),
    );
    let programs = equations.programs.iter().enumerate();
    let arms = programs
        .filter(|(_, (_, program))| !program.outputs.is_empty())
        .map(|(index, (what, program))| arm(context, index, *what, program));
    let layout = &equations.layout;
    let on_numbers: Vec<TokenStream> = layout
        .quantities()
        .into_iter()
        .filter(|&what| equations.program(what).is_none() && !layout.spells_out(what))
        .map(quantity_path)
        .collect();
    let by_numbers = (!on_numbers.is_empty()).then(|| {
        quote! {
            #(#on_numbers)|* => {
                ::mbd_runtime::scene::sensitivity(what, &declared().layout, at, out);
            }
        }
    });
    // Matrices without structural non-zeros are left as they are.
    let zeros = equations.programs.iter();
    let zeros = zeros.filter(|(_, program)| program.outputs.is_empty());
    let zeros: Vec<TokenStream> = zeros.map(|(what, _)| quantity_path(*what)).collect();
    let zeros = (!zeros.is_empty()).then(|| quote!(#(#zeros)|* => {}));
    let nan = if context.settings.generic {
        quote!(T::from_f64(f64::NAN))
    } else {
        quote!(f64::NAN)
    };
    let evaluation = quote! {
        match what {
            #(#arms)*
            #by_numbers
            #zeros
            // Not emitted: loud, not silently zero.
            _ => out.fill(#nan),
        }
    };
    let beside = whole(context.kernels.work_beside(equations));
    let columns_beside = !context.settings.generic && context.kernels.work_beside(equations) > 0;
    let room = match columns_beside {
        true => quote!(::mbd_runtime::__private::work_with_columns(#work, #beside)),
        false => quote!(::mbd_runtime::Work::list(#work)),
    };
    let lists = match columns_beside {
        true => quote!(let (work, beside) = ::mbd_runtime::__private::work_and_columns(work);),
        false => quote!(let work = work.numbers.as_mut_slice();),
    };
    let own = quote! {
        #lists
        #evaluation
    };
    let (evaluate, over) = match context.settings.generic {
        true => (
            quote!(::mbd_runtime::Equations::evaluate(
                self,
                what,
                at,
                &mut work.numbers,
                out
            )),
            Some(over_any_scalar(context, &evaluation)),
        ),
        false => (own, None),
    };
    // A list of nothing has its value in every model; the skeleton of one that has mistakes has no equations at all.
    let present = equations.programs.iter().map(|(what, _)| *what);
    let present: Vec<TokenStream> = present.map(quantity_path).chain(on_numbers).collect();
    let emits = (!present.is_empty()).then(|| {
        quote! {
            fn emits(&self, what: ::mbd_runtime::Quantity) -> bool {
                ::core::matches!(what, #(#present)|*) || declared().layout.len(what) == 0
            }
        }
    });
    let inner_stages = inner_stages(context);
    quote! {
        #over
        impl #float ::mbd_runtime::Model<#t> for #name #used {
            fn share(&self) -> ::std::sync::Arc<dyn ::mbd_runtime::Model<#t>> {
                ::std::sync::Arc::new(self.clone())
            }
            fn with_params(
                &self,
                params: &[#t],
            ) -> ::core::result::Result<::std::sync::Arc<dyn ::mbd_runtime::Model<#t>>, ::mbd_runtime::ParamError> {
                let params = #params::from_array(::mbd_runtime::__private::counted(params)?);
                ::core::result::Result::Ok(::std::sync::Arc::new(Self::new(params)?))
            }
            fn work(&self) -> ::mbd_runtime::Work<#t> {
                #room
            }
            fn scene(&self) -> &::mbd_runtime::scene::Scene {
                &declared().scene
            }
            fn layout(&self) -> &::mbd_runtime::Layout {
                &declared().layout
            }
            fn params(&self) -> &[#t] {
                &self.values
            }
            fn lines(&self) -> &[::mbd_runtime::scene::laws::LineNumbers<#t>] {
                &self.lines
            }
            #emits
            #inner_stages
            fn evaluate(
                &self,
                what: ::mbd_runtime::Quantity,
                at: &::mbd_runtime::At<'_, #t>,
                work: &mut ::mbd_runtime::Work<#t>,
                out: &mut [#t],
            ) {
                #evaluate
            }
        }
    }
}

/// The stages inside a step in one call, of a model whose rates are its state derivative or are found along with its nodes.
fn inner_stages(context: &EmitContext) -> Option<TokenStream> {
    let (equations, t) = (context.equations, context.scalar());
    let layout = &equations.layout;
    let (length, inputs) = (whole(layout.nx()), layout.ni > 0);
    let (what, made) = match layout.nodes.is_empty() {
        true => {
            let made = quote!(inner_stages::<#t, #length, #inputs>);
            (Quantity::Derivative, made)
        }
        false => {
            let all = whole(layout.len(Quantity::Rates));
            let made = quote!(inner_rates::<#t, #length, #all, #inputs>);
            (Quantity::Rates, made)
        }
    };
    let program = equations.program(what)?;
    let reads = ProgramArguments::of(program, layout);
    // What they read of nodes would be that of another stage.
    let is_alone = !reads.reads(NumberList::Nodes) && !reads.reads(NumberList::Ends);
    let what = quantity_path(what);
    (is_alone && !program.outputs.is_empty()).then(|| {
        quote! {
            fn inner_stages(
                &self,
                step: ::mbd_runtime::StepStages<'_, #t>,
                work: &mut ::mbd_runtime::Work<#t>,
            ) -> bool {
                ::mbd_runtime::__private::#made(step, |at, rates| {
                    ::mbd_runtime::Model::evaluate(self, #what, at, work, rates)
                })
            }
        }
    })
}

/// The arm of `evaluate` for a quantity, whose program is number `index`.
fn arm(context: &EmitContext, index: usize, what: Quantity, program: &Program) -> TokenStream {
    let (equations, t) = (context.equations, context.scalar());
    let values = equations
        .values
        .iter()
        .position(|(known, _)| *known == what);
    let read = values.and_then(|index| equations.values.get(index));
    let read = read.map_or(program, |(_, values)| values);
    let reads = ProgramArguments::of(read, &equations.layout);
    let pattern = quantity_path(what);
    let name = quantity::name(&equations.scene, &equations.layout, what);
    let function = format_ident!("{name}");
    let passed: Vec<TokenStream> = reads.0.iter().map(|&group| passed(group)).collect();
    let call = match (values, &program.by_column) {
        (Some(values), Some(_)) => by_column(context, (index, program), (values, &passed), &name),
        _ => context.call(index, &function, &passed, Some(quote!(work)), &quote!(out)),
    };
    if what == Quantity::Solve {
        return solutions(context, (index, reads), &call);
    }
    let state = reads.reads_state();
    let own = equations.layout.ns > 0;
    let mut names = Vec::new();
    let mut values = Vec::new();
    if state && own {
        names.push(quote!((q, v, z, states)));
        values.push(quote!(::mbd_runtime::__private::split_with_states(
            at.state
        )));
    } else if state {
        names.push(quote!((q, v, z)));
        values.push(quote!(::mbd_runtime::__private::split(at.state)));
    }
    // Turns, and how the origin moves, stand behind the modes.
    let layout = &equations.layout;
    let more = of_origin(&equations.scene) + layout.turns.len() > 0;
    for group in [
        NumberList::Nodes,
        NumberList::Effective,
        NumberList::Hold,
        NumberList::Ends,
        NumberList::Inputs,
        NumberList::Rows,
        NumberList::Motion,
    ] {
        if reads.reads(group) {
            let list = format_ident!("{}", group.name());
            let given = format_ident!("{}", group.argument());
            names.push(quote!(#list));
            values.push(match group {
                NumberList::Hold if more => quote!(at.hold.first_chunk()),
                _ => quote!(::mbd_runtime::__private::fixed(at.#given)),
            });
        }
    }
    for (group, place) in [
        (NumberList::Turns, layout.holds()),
        (NumberList::Origin, layout.origin_at()),
    ] {
        if reads.reads(group) {
            let (list, place) = (format_ident!("{}", group.name()), whole(place));
            names.push(quote!(#list));
            values.push(quote! {
                ::core::option::Option::Some(&::mbd_runtime::__private::leading(
                    at.hold.get(#place..).unwrap_or_default()
                ))
            });
        }
    }
    // The lengths of lists that are not read follow from the sizes of this model.
    let sizes = state.then(|| {
        let layout = &equations.layout;
        let (nq, nv, nz) = (whole(layout.nq), whole(layout.nv), whole(layout.nz));
        let ns = whole(layout.ns);
        let states = own.then(|| quote!(let states: &[#t; #ns] = states;));
        quote! {
            let q: &[#t; #nq] = q;
            let v: &[#t; #nv] = v;
            let z: &[#t; #nz] = z;
            #states
        }
    });
    if program.by_column.is_none() {
        names.push(quote!(out));
        values.push(quote!(::mbd_runtime::__private::fixed_mut(out)));
    }
    quote! {
        #pattern => {
            if let (#(::core::option::Option::Some(#names)),*) = (#(#values),*) {
                #sizes
                #call
            }
        }
    }
}

/// `impl Equations` and `impl InLanes` of a model over any scalar.
fn over_any_scalar(context: &EmitContext, evaluation: &TokenStream) -> TokenStream {
    let (name, params) = (context.named(""), context.named("Params"));
    let work = whole(context.kernels.work(context.equations));
    quote! {
        impl<T: ::mbd_runtime::Real> ::mbd_runtime::Equations<T> for #name<T> {
            fn with(params: &[T]) -> ::core::option::Option<Self> {
                let params = ::mbd_runtime::__private::fixed(params)?;
                ::core::option::Option::Some(Self::unchecked(#params::from_array(*params)))
            }
            fn layout() -> &'static ::mbd_runtime::Layout {
                &declared().layout
            }
            fn room(&self) -> usize {
                #work
            }
            fn evaluate(
                &self,
                what: ::mbd_runtime::Quantity,
                at: &::mbd_runtime::At<'_, T>,
                work: &mut [T],
                out: &mut [T],
            ) {
                #evaluation
            }
        }
        impl ::mbd_runtime::InLanes for #name {
            type Over<T: ::mbd_runtime::Real> = #name<T>;
        }
    }
}

/// How the trait's method passes a list on.
fn passed(group: NumberList) -> TokenStream {
    let list = format_ident!("{}", group.name());
    match group {
        NumberList::Time => quote!(at.time),
        NumberList::Params => quote!(&self.values),
        NumberList::Derived => quote!(&self.derived),
        _ => quote!(#list),
    }
}

/// The pattern of a quantity.
pub(super) fn quantity_path(what: Quantity) -> TokenStream {
    let simple = |name: &str| {
        let name = format_ident!("{name}");
        quote!(::mbd_runtime::Quantity::#name)
    };
    match what {
        Quantity::Equilibrium(k) | Quantity::NodeByAnchor(k) | Quantity::CondensedStiffness(k) => {
            let k = whole(k);
            let name = match what {
                Quantity::Equilibrium(_) => simple("Equilibrium"),
                Quantity::NodeByAnchor(_) => simple("NodeByAnchor"),
                _ => simple("CondensedStiffness"),
            };
            quote!(#name(#k))
        }
        Quantity::FrameJacobian(body, frame) => {
            let (body, frame) = (whole(body), whole(frame));
            quote!(::mbd_runtime::Quantity::FrameJacobian(#body, #frame))
        }
        Quantity::Partial(of, by) => {
            let (of, by) = (format_ident!("{of:?}"), format_ident!("{by:?}"));
            quote! {
                ::mbd_runtime::Quantity::Partial(
                    ::mbd_runtime::scene::Differentiated::#of,
                    ::mbd_runtime::scene::Variable::#by,
                )
            }
        }
        other => simple(&format!("{other:?}")),
    }
}
