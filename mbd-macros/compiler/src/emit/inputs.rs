//! What the caller of a model supplies, as one struct: inputs, external loads and external gravity.

use mbd_scene::{InputSlots, InputSource, Layout, Part, PointSlots, Quantity};
use proc_macro2::{Ident, Span, TokenStream};
use quote::{format_ident, quote};

use super::context::{EmitContext, docs, unit_text};
use super::coordinates::has_coordinates;
use super::literal::{ident, number, whole};

/// One field: a thing, or those of a repetition.
struct InputField {
    name: Ident,
    doc: String,
    /// The numbers of each.
    each: InputShape,
    /// How many there are; `None` for one that is not repeated.
    count: Option<usize>,
}

/// What one thing is made of.
#[derive(Clone, Copy, PartialEq)]
enum InputShape {
    Scalar,
    Vector,
    Wrench,
}

impl InputShape {
    fn of(len: usize) -> Self {
        match len {
            1 => InputShape::Scalar,
            6 => InputShape::Wrench,
            _ => InputShape::Vector,
        }
    }

    fn kind(self, t: &TokenStream) -> TokenStream {
        match self {
            InputShape::Scalar => quote!(#t),
            InputShape::Vector => quote!([#t; 3]),
            InputShape::Wrench => quote!(::mbd_runtime::Wrench<#t>),
        }
    }

    /// One thing from its numbers, or the pattern that takes it apart.
    fn whole(self, numbers: &mut impl Iterator<Item = Ident>) -> TokenStream {
        let mut three = || {
            let list = numbers.by_ref().take(3);
            quote!([#(#list),*])
        };
        match self {
            InputShape::Scalar => {
                let one = numbers.next();
                quote!(#one)
            }
            InputShape::Vector => three(),
            InputShape::Wrench => {
                let (force, couple) = (three(), three());
                quote!(::mbd_runtime::Wrench { force: #force, couple: #couple })
            }
        }
    }
}

/// The struct with a field for everything that the caller supplies; nothing of a model without inputs.
pub fn inputs(context: &EmitContext) -> TokenStream {
    let layout = &context.equations.layout;
    let fields = fields(context);
    if fields.is_empty() {
        return TokenStream::new();
    }
    let (name, state, vis) = (
        context.named("Inputs"),
        context.named("State"),
        &context.settings.visibility,
    );
    let (t, declared, used, real) = (
        context.scalar(),
        context.declared(),
        context.used(),
        context.real(),
    );
    let declarations = fields.iter().map(|field| {
        let (doc, name, each) = (docs(&field.doc), &field.name, field.each.kind(&t));
        match field.count.map(whole) {
            None => quote!(#doc pub #name: #each),
            // serde knows arrays of up to 32.
            Some(count) => {
                let bound = context.settings.generic.then(|| {
                    quote!(, bound(
                        serialize = "T: ::mbd_runtime::serde::Serialize",
                        deserialize = "T: ::mbd_runtime::serde::Deserialize<'de>"
                    ))
                });
                quote! {
                    #doc
                    #[serde(with = "::mbd_runtime::__private::list" #bound)]
                    pub #name: [#each; #count]
                }
            }
        }
    });
    let mut numbers = (0..layout.ni).map(|i| format_ident!("n{i}"));
    let parts: Vec<TokenStream> = fields
        .iter()
        .map(|field| {
            let name = &field.name;
            match field.count {
                None => {
                    let one = field.each.whole(&mut numbers);
                    quote!(#name: #one)
                }
                Some(count) => {
                    let all = (0..count).map(|_| field.each.whole(&mut numbers));
                    quote!(#name: [#(#all),*])
                }
            }
        })
        .collect();
    let all: Vec<Ident> = (0..layout.ni).map(|i| format_ident!("n{i}")).collect();
    let defaults = layout.default_inputs(context.scene());
    let defaults = defaults.into_iter().map(|value| {
        let value = number(value);
        match context.settings.generic {
            true => quote!(T::from_f64(#value)),
            false => value,
        }
    });
    let [count, nx] = [layout.ni, layout.nx()].map(whole);
    let model = context.scene().name.as_str();
    let doc = docs(&format!(
        "What the caller of `{model}` supplies, SI units. `default()` has the declared values; external loads and external gravity are zero."
    ));
    let gravity = gravity(context, &fields);
    let (measured, read) = match has_coordinates(context) {
        true => {
            let coordinates = context.named("Coordinates");
            (
                quote!(#coordinates #used),
                quote!(#coordinates::from_array(::mbd_runtime::__private::leading(numbers))),
            )
        }
        false => (quote!(()), quote!(let _ = numbers;)),
    };
    let outputs = context.named("Outputs");
    let (outputs, columns) = match context.equations.program(Quantity::Outputs) {
        Some(_) => (
            quote!(#outputs #used),
            quote!(#outputs::from_array(::mbd_runtime::__private::leading(columns))),
        ),
        None => (quote!(()), quote!(let _ = columns;)),
    };
    let (sample, sample_doc) = (
        context.named("Sample"),
        docs(&format!("What a controller of `{model}` sees.")),
    );
    let (sample_declared, sample_scalar) = match context.settings.generic {
        true => (quote!(<'a, T = f64>), quote!(T)),
        false => (quote!(<'a>), quote!(f64)),
    };
    quote! {
        #doc
        #[derive(Clone, Copy, Debug, PartialEq, ::mbd_runtime::serde::Serialize, ::mbd_runtime::serde::Deserialize)]
        #[serde(crate = "::mbd_runtime::serde", deny_unknown_fields)]
        #vis struct #name #declared { #(#declarations),* }

        #sample_doc
        #[allow(dead_code, reason = "for controllers that are functions")]
        #vis type #sample #sample_declared = ::mbd_runtime::Sample<'a, #name #used, #sample_scalar>;

        impl #real ::core::default::Default for #name #used {
            fn default() -> Self {
                Self::from_array([#(#defaults),*])
            }
        }

        impl #real #name #used {
            /// The numbers in the order of `Layout::inputs`.
            #[must_use]
            pub fn to_array(&self) -> [#t; #count] {
                let #name { #(#parts),* } = *self;
                [#(#all),*]
            }
            /// Inputs from their numbers.
            #[must_use]
            pub fn from_array(numbers: [#t; #count]) -> Self {
                let [#(#all),*] = numbers;
                #name { #(#parts),* }
            }
            #gravity
        }

        impl #real ::mbd_runtime::Inputs<#t> for #name #used {
            const MODEL: ::core::option::Option<(&'static str, [usize; 2])> =
                ::core::option::Option::Some((#model, [#nx, #count]));
            type State = #state #used;
            type Coordinates = #measured;
            type Outputs = #outputs;
            fn from_numbers(numbers: &[#t]) -> ::core::option::Option<Self> {
                ::mbd_runtime::__private::fixed(numbers).copied().map(Self::from_array)
            }
            fn numbers(&self) -> impl ::core::convert::AsRef<[#t]> {
                self.to_array()
            }
            fn state(numbers: &[#t]) -> #state #used {
                #state::from_slice(numbers).unwrap_or_else(#state::at_origin)
            }
            fn coordinates(numbers: &[#t]) -> Self::Coordinates {
                #read
            }
            fn outputs(columns: &[#t]) -> Self::Outputs {
                #columns
            }
        }
    }
}

/// Everything that the caller supplies. External gravity at all bodies and points is one field.
fn fields(context: &EmitContext) -> Vec<InputField> {
    let layout = &context.equations.layout;
    let mut fields: Vec<InputField> = Vec::new();
    let mut last: Option<(&str, InputShape)> = None;
    for &slots in layout.inputs.iter().filter(|slots| !is_gravity(slots)) {
        let Some((label, doc, span)) = described(context, slots) else {
            continue;
        };
        let each = InputShape::of(slots.len);
        let base = label.split_once('[').map(|(base, _)| base);
        match (fields.last_mut(), base.map(|base| (base, each))) {
            (Some(field), Some(this)) if last == Some(this) => {
                field.count = field.count.map(|count| count + 1);
            }
            _ => fields.push(InputField {
                name: free(&fields, base.unwrap_or(label), span),
                doc,
                each,
                count: base.map(|_| 1),
            }),
        }
        last = base.map(|base| (base, each));
    }
    let places: Vec<String> = places(context)
        .map(|(name, _)| format!("`{name}`"))
        .collect();
    if !places.is_empty() {
        fields.push(InputField {
            name: free(&fields, "gravity", Span::call_site()),
            doc: format!(
                "Acceleration of gravity at {} \\[m/s²\\], world axes.",
                places.join(", ")
            ),
            each: InputShape::Vector,
            count: Some(places.len()),
        });
    }
    fields
}

/// A name that no field has.
fn free(fields: &[InputField], name: &str, span: Span) -> Ident {
    let mut free = ident(name, span);
    while fields.iter().any(|field| field.name == free) {
        free = format_ident!("{free}_", span = span);
    }
    free
}

fn is_gravity(slots: &InputSlots) -> bool {
    matches!(
        slots.source,
        InputSource::BodyGravity(_) | InputSource::PointGravity(_)
    )
}

/// Name, documentation and place of an input or an external load.
fn described<'c>(context: &'c EmitContext, slots: InputSlots) -> Option<(&'c str, String, Span)> {
    let scene = context.scene();
    let (name, doc, unit, span) = match slots.source {
        InputSource::Input(i) => {
            let input = scene.inputs.get(i)?;
            let unit = unit_text(&input.unit.text);
            let given = match (slots.len, input.default) {
                (_, [0.0, 0.0, 0.0]) => String::new(),
                (1, [x, ..]) => format!(", {x} by default"),
                (_, [x, y, z]) => format!(", {x}, {y}, {z} by default"),
            };
            let unit = format!("\\[{unit}\\]{given}");
            (&input.name, &input.doc, unit, context.spans.inputs.get(i))
        }
        InputSource::Load(i) => {
            let load = scene.loads.get(i)?;
            let unit = match slots.len {
                6 => "Force \\[N\\] and couple \\[N m\\], world axes.",
                _ => "Force \\[N\\], world axes.",
            };
            let span = context.spans.loads.get(i);
            (&load.name, &load.doc, unit.to_owned(), span)
        }
        _ => return None,
    };
    let doc = format!("{} {unit}", doc.trim()).trim().to_owned();
    Some((name, doc, span.copied().unwrap_or_else(Span::call_site)))
}

/// Where external gravity acts: the name of a body or a point, and the first of its coordinates.
fn places<'c>(context: &'c EmitContext) -> impl Iterator<Item = (&'c str, usize)> {
    let (scene, layout): (_, &Layout) = (context.scene(), &context.equations.layout);
    layout.inputs.iter().filter_map(|slots| match slots.source {
        InputSource::BodyGravity(body) => {
            let name = scene.bodies.get(body)?.name.as_str();
            Some((name, layout.own_slots(Part::Body(body))?.q))
        }
        InputSource::PointGravity(point) => match layout.points.get(point)? {
            PointSlots::Mass(slots) => Some((scene.points.get(point)?.name.as_str(), slots.q)),
            PointSlots::Node(_) => None,
        },
        _ => None,
    })
}

/// The function that fills in external gravity.
fn gravity(context: &EmitContext, fields: &[InputField]) -> TokenStream {
    let places: Vec<usize> = places(context).map(|(_, q)| q).collect();
    let Some(field) = fields.last().filter(|_| !places.is_empty()) else {
        return TokenStream::new();
    };
    let (t, used, state) = (context.scalar(), context.used(), context.named("State"));
    let (name, zero) = (&field.name, context.zero());
    let directions = context.equations.layout.directions;
    let positions = places.iter().map(|&q| {
        let mut place = [zero.clone(), zero.clone(), zero.clone()];
        for (offset, &axis) in directions.translations().iter().enumerate() {
            let at = whole(q + offset);
            place[axis] = quote!(q[#at]);
        }
        let [x, y, z] = place;
        quote!(field([#x, #y, #z]))
    });
    quote! {
        /// Gravity at every body and point with mass, from a field: the acceleration \[m/s²\] at a position \[m\], world axes.
        pub fn set_gravity(&mut self, state: &#state #used, field: impl Fn([#t; 3]) -> [#t; 3]) {
            let [q] = &state.q.data.0;
            self.#name = [#(#positions),*];
        }
    }
}
