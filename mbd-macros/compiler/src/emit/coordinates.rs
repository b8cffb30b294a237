//! The joint coordinates of a model and their rates, as one struct.

use mbd_scene::Quantity;
use proc_macro2::{Ident, Span, TokenStream};
use quote::{format_ident, quote};

use super::context::{EmitContext, docs};
use super::literal::{ident, whole};

/// One field: a coordinate or a rate of a joint, or of all joints of a repetition.
struct CoordinateField {
    name: Ident,
    /// What it was made of: the name of the joint without its index, and the word of the coordinate.
    of: (String, &'static str),
    doc: String,
    /// Places in the list of the quantity.
    places: Vec<Ident>,
    repeated: bool,
}

/// Whether the model has a struct of its joint coordinates: one with inputs, or one that was asked for them.
pub fn has_coordinates(context: &EmitContext) -> bool {
    let (layout, what) = (&context.equations.layout, Quantity::Coordinates);
    layout.len(what) > 0 && (layout.ni > 0 || context.equations.program(what).is_some())
}

/// The struct with a field for every coordinate and every rate.
pub fn coordinates(context: &EmitContext) -> TokenStream {
    if !has_coordinates(context) {
        return TokenStream::new();
    }
    let (name, vis) = (context.named("Coordinates"), &context.settings.visibility);
    let (t, declared, used) = (context.scalar(), context.declared(), context.used());
    let header = match context.settings.generic {
        true => quote!(<T>),
        false => quote!(),
    };
    let fields = fields(context);
    let declarations = fields.iter().map(|field| {
        let (doc, name, count) = (docs(&field.doc), &field.name, whole(field.places.len()));
        match field.repeated {
            true => quote!(#doc pub #name: [#t; #count]),
            false => quote!(#doc pub #name: #t),
        }
    });
    let values = fields.iter().map(|field| {
        let (name, places) = (&field.name, &field.places);
        match field.repeated {
            true => quote!(#name: [#(#places),*]),
            false => quote!(#name: #(#places)*),
        }
    });
    let len = context.equations.layout.len(Quantity::Coordinates);
    let all = (0..len).map(place);
    let len = whole(len);
    let doc = docs(&format!(
        "The joint coordinates of `{}` and their rates, as joints measure them: angles of hinges in (−π, π].",
        context.scene().name
    ));
    quote! {
        #doc
        #[derive(Clone, Copy, Debug, PartialEq)]
        #vis struct #name #declared { #(#declarations),* }

        impl #header #name #used {
            /// Coordinates from their numbers, in the order of `Quantity::Coordinates`.
            #[must_use]
            pub fn from_array(numbers: [#t; #len]) -> Self {
                let [#(#all),*] = numbers;
                #name { #(#values),* }
            }
        }
    }
}

fn place(index: usize) -> Ident {
    format_ident!("c{index}")
}

fn fields(context: &EmitContext) -> Vec<CoordinateField> {
    let mut fields: Vec<CoordinateField> = Vec::new();
    let mut next = 0;
    for joint in &context.scene().joints {
        let (base, repeated) = match joint.name.split_once('[') {
            Some((base, _)) => (base, true),
            None => (joint.name.as_str(), false),
        };
        for coordinate in joint.law.measured() {
            let unit = coordinate.unit();
            let rate = format!("{unit}/s");
            for (word, unit) in [(coordinate.name, unit), (coordinate.rate, rate.as_str())] {
                let of = (base.to_owned(), word);
                let known = fields.iter_mut();
                let known = known
                    .rev()
                    .find(|field| repeated && field.repeated && field.of == of);
                let at = place(next);
                next += 1;
                if let Some(field) = known {
                    field.places.push(at);
                    continue;
                }
                let mut name = ident(&format!("{base}_{word}"), Span::call_site());
                while fields.iter().any(|field| field.name == name) {
                    name = format_ident!("{name}_");
                }
                fields.push(CoordinateField {
                    name,
                    of,
                    doc: format!("`{}.{word}` \\[{unit}\\]", joint.name),
                    places: vec![at],
                    repeated,
                });
            }
        }
    }
    fields
}
