//! Emission: equations become Rust that reads like a document.
//!
//! - `function` writes one program as one function, `kernel` a long one as calls of kernels that many share, `terms` what they compute,
//!   `naming` and `wording` name that.
//! - `interface` writes parameters, state and outputs, `inputs` what the caller supplies, `coordinates` what joints measure, `methods` the typed methods, `model` the struct, `execution` the
//!   trait.
//! - `columns` finds several columns of a matrix beside each other.
//! - `explain` says in words what was made.

mod columns;
mod context;
mod coordinates;
mod execution;
mod explain;
mod function;
mod inputs;
mod interface;
mod kernel;
pub(crate) mod literal;
mod methods;
mod model;
pub mod naming;
mod parts;
pub mod quantity;
mod scalars;
mod terms;
mod wording;

use proc_macro2::{Span, TokenStream};
use quote::quote;

pub use context::{EmitSettings, NameSpans};

use crate::equations::SceneEquations;
use crate::kernels::Kernels;
use crate::resolve::Named;
use context::EmitContext;

/// The Rust of a model: its companions, itself, its equations, and its tests if it wants them.
#[must_use]
pub fn emit_model(
    equations: &SceneEquations,
    spans: &NameSpans,
    settings: &EmitSettings,
) -> TokenStream {
    emit_with(equations, &Kernels::of(equations), spans, settings)
}

/// The same with kernels already found.
pub fn emit_with(
    equations: &SceneEquations,
    kernels: &Kernels,
    spans: &NameSpans,
    settings: &EmitSettings,
) -> TokenStream {
    let context = EmitContext {
        equations,
        spans,
        settings,
        kernels,
    };
    let (companions, model, tests) = (
        interface::companions(&context),
        model::model(&context),
        tests(&context),
    );
    quote!(#companions #model #tests)
}

/// Uses of the parameters' fields where the declaration uses their names: an editor finds and renames them together.
pub fn references(
    equations: &SceneEquations,
    spans: &NameSpans,
    settings: &EmitSettings,
    uses: &[(Named, Span)],
) -> TokenStream {
    let context = EmitContext {
        equations,
        spans,
        settings,
        kernels: &Kernels::default(),
    };
    let (fields, params) = (context.params(), context.named("Params"));
    let used = settings.generic.then(|| quote!(<f64>));
    let uses = uses.iter().filter_map(|&(named, span)| match named {
        Named::Param(index) => fields.get(index).map(|field| {
            let mut field = field.clone();
            field.set_span(span);
            quote!(let _ = &params.#field;)
        }),
        _ => None,
    });
    quote! {
        const _: () = {
            #[allow(dead_code, reason = "for editors")]
            fn references(params: &#params #used) {
                #(#uses)*
            }
        };
    }
}

/// `verify;`: a test module of the model.
fn tests(context: &EmitContext) -> TokenStream {
    if !context.settings.verify || context.equations.programs.is_empty() {
        return TokenStream::new();
    }
    let name = context.named("");
    let module = quote::format_ident!("{}_verify", crate::names::identifier(&name.to_string()));
    let params = context.named("Params");
    quote! {
        #[cfg(test)]
        mod #module {
            #[test]
            fn generated_code_agrees_with_the_laws() -> ::core::result::Result<(), ::std::string::String> {
                let params = <super::#params as ::core::default::Default>::default();
                let model = super::#name::new(params).map_err(|error| error.to_string())?;
                ::mbd_runtime::__private::verify(&model)
            }
        }
    }
}
