//! The types that surround a model: parameters, state, outputs, inputs.

use mbd_scene::joints::Measured;
use mbd_scene::laws::starts;
use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use super::context::{EmitContext, docs, unit_text};
use super::coordinates::coordinates;
use super::inputs::inputs;
use super::literal::{number, whole};
use super::parts::parts;

/// Every companion type of a model.
pub fn companions(context: &EmitContext) -> TokenStream {
    let (params, state, start) = (params(context), state(context), start(context));
    let (outputs, coordinates) = (outputs(context), coordinates(context));
    let inputs = inputs(context);
    quote!(#params #state #start #outputs #coordinates #inputs)
}

fn params(context: &EmitContext) -> TokenStream {
    let (name, vis) = (context.named("Params"), &context.settings.visibility);
    let (t, declared, used, real) = (
        context.scalar(),
        context.declared(),
        context.used(),
        context.real(),
    );
    let fields = context.params();
    let declarations = context
        .scene()
        .params
        .iter()
        .zip(&fields)
        .map(|(param, field)| {
            let (unit, factor) = (unit_text(&param.unit.text), param.unit.factor);
            let shown = |x: f64| if factor > 0.0 { x / factor } else { x };
            let range = param
                .range
                .map(|[low, high]| format!(", {} ..= {} {unit}", shown(low), shown(high)))
                .unwrap_or_default();
            let si = if factor == 1.0 {
                String::new()
            } else {
                "; the field is in SI units".to_owned()
            };
            let doc = docs(format!("{} \\[{unit}\\]{range}{si}", param.doc.trim()).trim());
            quote!(#doc pub #field: #t)
        });
    let defaults = context
        .scene()
        .params
        .iter()
        .map(|param| number(param.default));
    let from = |value: TokenStream| {
        if context.settings.generic {
            quote!(T::from_f64(#value))
        } else {
            value
        }
    };
    let defaults: Vec<TokenStream> = defaults.map(from).collect();
    let count = whole(fields.len());
    // A struct without parameters still has to mention its scalar.
    let marker = (fields.is_empty() && context.settings.generic)
        .then(|| quote!(#[doc(hidden)] #[serde(skip)] pub scalar: ::core::marker::PhantomData<T>));
    let no_scalar = marker
        .as_ref()
        .map(|_| quote!(scalar: ::core::marker::PhantomData));
    let model = &context.scene().name;
    let doc = docs(&format!(
        "The live parameters of `{model}`, SI units. `default()` has the declared values."
    ));
    quote! {
        #doc
        #[derive(Clone, Debug, PartialEq, ::mbd_runtime::serde::Serialize, ::mbd_runtime::serde::Deserialize)]
        #[serde(crate = "::mbd_runtime::serde", deny_unknown_fields)]
        #vis struct #name #declared { #(#declarations,)* #marker }

        impl #real ::core::default::Default for #name #used {
            fn default() -> Self {
                #name { #(#fields: #defaults,)* #no_scalar }
            }
        }

        impl #real #name #used {
            /// The values in declaration order.
            #[must_use]
            pub fn to_array(&self) -> [#t; #count] {
                [#(self.#fields),*]
            }
            /// Parameters from values in declaration order.
            #[must_use]
            pub fn from_array(values: [#t; #count]) -> Self {
                let [#(#fields),*] = values;
                #name { #(#fields,)* #no_scalar }
            }
        }

        impl #real ::mbd_runtime::Params<#t> for #name #used {
            const MODEL: ::core::option::Option<&'static str> = ::core::option::Option::Some(#model);
            fn values(&self) -> impl ::core::convert::AsRef<[#t]> {
                self.to_array()
            }
        }
    }
}

fn state(context: &EmitContext) -> TokenStream {
    let (name, vis) = (context.named("State"), &context.settings.visibility);
    let (t, declared, used, real) = (
        context.scalar(),
        context.declared(),
        context.used(),
        context.real(),
    );
    let layout = &context.equations.layout;
    let (nq, nv, nz) = (whole(layout.nq), whole(layout.nv), whole(layout.nz));
    let nx = whole(layout.nx());
    let z = (layout.nz > 0).then(|| {
        quote! {
            /// Positions of the `rate` nodes \[m\].
            pub z: ::mbd_runtime::nalgebra::SVector<#t, #nz>
        }
    });
    let read_z = z.as_ref().map(|_| quote!(z: (*z).into()));
    let write_z = z.as_ref().map(|_| {
        quote! {
            out.extend_from_slice(self.z.as_slice());
        }
    });
    let zero_z = z
        .as_ref()
        .map(|_| quote!(z: ::mbd_runtime::nalgebra::SVector::zeros()));
    let s = (layout.ns > 0).then(|| {
        let ns = whole(layout.ns);
        quote! {
            /// Declared states, in declaration order: each has functions of its name.
            pub s: ::mbd_runtime::nalgebra::SVector<#t, #ns>,
        }
    });
    let after_z = (z.is_some() && s.is_some()).then(|| quote!(,));
    let read_s = s.as_ref().map(|_| quote!(#after_z s: (*s).into()));
    let write_s = s
        .as_ref()
        .map(|_| quote!(out.extend_from_slice(self.s.as_slice());));
    let starting_s = s.as_ref().map(|_| {
        let scene = context.scene();
        let defaults: Vec<f64> = scene.params.iter().map(|param| param.default).collect();
        let starts = starts(scene, &defaults).into_iter().map(|start| {
            let start = number(start);
            if context.settings.generic {
                quote!(T::from_f64(#start))
            } else {
                start
            }
        });
        quote!(#after_z s: ::mbd_runtime::nalgebra::SVector::from([#(#starts),*]))
    });
    let lists = if s.is_some() { "q, v, z, s" } else { "q, v, z" };
    let from = docs(&format!(
        "The state from the list {lists}; `None` if it has another length."
    ));
    let to = docs(&format!("The state as the list {lists}."));
    let split = if layout.ns > 0 {
        let ns = whole(layout.ns);
        quote!(let (q, v, z, s) = ::mbd_runtime::__private::split_with_states::<#t, #nq, #nv, #nz, #ns>(x)?;)
    } else {
        quote!(let (q, v, z) = ::mbd_runtime::__private::split::<#t, #nq, #nv, #nz>(x)?;)
    };
    let origin = docs(if layout.ns > 0 {
        "Everything at the world origin, at rest, along the axes of the world; declared states where they start with the declared parameters."
    } else {
        "Everything at the world origin, at rest, along the axes of the world."
    });
    let model = &context.scene().name;
    let meaning = match layout.directions.plane {
        None => {
            "`q` per body x y z qw qx qy qz, per point x y z; `v` per body vx vy vz (world axes, centre of mass) wx wy wz, per point vx vy vz."
                .to_owned()
        }
        Some(plane) => {
            let [a, b] = [0, 1].map(|k| ["x", "y", "z"][layout.directions.translations()[k]]);
            let normal = ["x", "y", "z"][plane.normal()];
            format!(
                "`q` per body {a} {b} and the angle about {normal} \\[rad\\], right-handed and not wrapped, per point {a} {b}; `v` per body v{a} v{b} (centre of mass) w{normal}, per point v{a} v{b}."
            )
        }
    };
    let doc = docs(&format!(
        "The state of `{model}`: items in declaration order, bodies before points.\n\n{meaning} Bodies and points have functions of their names."
    ));
    let (at_rest, parts) = (rest(context), parts(context));
    let coordinates = docs(match layout.directions.plane {
        None => "Coordinates \\[m, 1\\].",
        Some(_) => "Coordinates \\[m, rad\\].",
    });
    quote! {
        #doc
        #[derive(Clone, Debug, PartialEq)]
        #vis struct #name #declared {
            #coordinates
            pub q: ::mbd_runtime::nalgebra::SVector<#t, #nq>,
            /// Speeds \[m/s, rad/s\].
            pub v: ::mbd_runtime::nalgebra::SVector<#t, #nv>,
            #z
            #after_z
            #s
        }

        impl #real #name #used {
            #origin
            #[must_use]
            pub fn at_origin() -> Self {
                let mut state = #name {
                    q: ::mbd_runtime::nalgebra::SVector::zeros(),
                    v: ::mbd_runtime::nalgebra::SVector::zeros(),
                    #zero_z
                    #starting_s
                };
                #at_rest
                state
            }
            #from
            #[must_use]
            pub fn from_slice(x: &[#t]) -> ::core::option::Option<Self> {
                #split
                let _ = z;
                ::core::option::Option::Some(#name { q: (*q).into(), v: (*v).into(), #read_z #read_s })
            }
            #to
            #[must_use]
            pub fn to_vec(&self) -> ::std::vec::Vec<#t> {
                let mut out = ::std::vec::Vec::with_capacity(#nx);
                out.extend_from_slice(self.q.as_slice());
                out.extend_from_slice(self.v.as_slice());
                #write_z
                #write_s
                out
            }
            #parts
        }
    }
}

/// The joint coordinates at the start of a run, all at once and one by one; nothing where no joint has any.
fn start(context: &EmitContext) -> TokenStream {
    let (scene, names) = (context.scene(), context.scene().joint_coordinates());
    if names.is_empty() {
        return TokenStream::new();
    }
    let fields = context.joint_coordinates();
    let told = names.iter().map(|name| {
        let found = scene.joint_coordinate(name);
        let unit = found.and_then(|(joint, index, is_rate)| {
            let (_, coordinate) = scene.coordinate(joint, index)?;
            let measured = if is_rate {
                Measured::Rate
            } else {
                Measured::Value
            };
            Some(measured.unit(&coordinate))
        });
        format!("`{name}` \\[{}\\]", unit.unwrap_or_default())
    });
    let told: Vec<String> = told.collect();
    let declarations = told.iter().zip(&fields).map(|(told, field)| {
        let doc = docs(&format!("{told}."));
        quote!(#doc pub #field: ::core::option::Option<f64>)
    });
    let setters = names
        .iter()
        .zip(&told)
        .zip(&fields)
        .map(|((name, told), field)| {
            let (doc, setter) = (docs(&format!("Sets {told}.")), format_ident!("set_{field}"));
            quote! {
                #doc
                fn #setter(
                    &mut self,
                    said: impl ::core::convert::Into<::mbd_runtime::StartNumber>,
                ) -> ::core::result::Result<(), ::mbd_runtime::RunError> {
                    self.set_joint(#name, said.into())
                }
            }
        });
    let one_by_one = context.named("Joints");
    let one_by_one_doc = docs(&format!(
        "Sets joint coordinates of a run of `{}` one by one, where it stands before it moves: all that were set hold together, the others are as declared, zero where nothing is, or what closes the loops. What contradicts the others, and a loop that cannot close, is an error that names the joint; nothing is changed then.",
        scene.name
    ));
    let (name, vis) = (context.named("Start"), &context.settings.visibility);
    let doc = docs(&format!(
        "Joint coordinates of `{}` at the start of a run, for `Simulation::set_joints(&start.joints())`. `None`: as declared, zero where nothing is, or as other coordinates decide.",
        scene.name
    ));
    quote! {
        #doc
        #[derive(Clone, Debug, Default, PartialEq)]
        #vis struct #name { #(#declarations),* }

        #one_by_one_doc
        #[allow(dead_code, reason = "for those who place joints one by one")]
        #vis trait #one_by_one: ::mbd_runtime::JointSetter { #(#setters)* }

        impl<R: ::mbd_runtime::JointSetter> #one_by_one for R {}

        impl #name {
            /// The coordinates that are given, by their names.
            #[must_use]
            pub fn joints(&self) -> ::std::vec::Vec<(&'static str, f64)> {
                let all = [#((#names, self.#fields)),*];
                let given = all.into_iter().filter_map(|(name, value)| value.map(|value| (name, value)));
                given.collect()
            }
        }
    }
}

/// Unit quaternions for all bodies.
fn rest(context: &EmitContext) -> TokenStream {
    let mut quaternions = context.equations.layout.quaternions().peekable();
    if quaternions.peek().is_none() {
        return quote!(let _ = &mut state;);
    }
    let one = if context.settings.generic {
        quote!(T::one())
    } else {
        quote!(1.0)
    };
    let places = quaternions.map(whole);
    quote! {
        let [q] = &mut state.q.data.0;
        #(q[#places] = #one;)*
    }
}

fn outputs(context: &EmitContext) -> TokenStream {
    let scene = context.scene();
    let declared_outputs = &scene.outputs;
    if declared_outputs.is_empty() {
        return TokenStream::new();
    }
    let (name, vis) = (context.named("Outputs"), &context.settings.visibility);
    let (t, declared, used) = (context.scalar(), context.declared(), context.used());
    let header = if context.settings.generic {
        quote!(<T>)
    } else {
        quote!()
    };
    let fields = context.outputs();
    let declarations = declared_outputs.iter().zip(&fields).map(|(output, field)| {
        let unit = unit_text(&output.unit.text);
        let told = match scene.output_column(output) == output.name {
            true => output.doc.trim().to_owned(),
            false => format!("What the metric `{}` is taken of", output.name),
        };
        let doc = docs(format!("{told} \\[{unit}\\]").trim());
        let t = if output.components == 3 {
            quote!([#t; 3])
        } else {
            quote!(#t)
        };
        quote!(#doc pub #field: #t)
    });
    let columns = declared_outputs.iter().flat_map(|output| {
        let unit = output.unit.text.as_str();
        let names: Vec<String> = match output.components {
            3 => ["x", "y", "z"]
                .map(|axis| format!("{}_{axis}", output.name))
                .into(),
            _ => vec![scene.output_column(output)],
        };
        names.into_iter().map(move |name| quote!((#name, #unit)))
    });
    let numbered = (0..context.equations.layout.columns).map(|i| format_ident!("c{i}"));
    let mut next = 0;
    let values = declared_outputs.iter().zip(&fields).map(|(output, field)| {
        let parts: Vec<_> = (next..next + output.components)
            .map(|i| format_ident!("c{i}"))
            .collect();
        next += output.components;
        match parts.as_slice() {
            [one] => quote!(#field: #one),
            all => quote!(#field: [#(#all),*]),
        }
    });
    let count = whole(context.equations.layout.columns);
    let doc = docs(&format!("The outputs of `{}`.", context.scene().name));
    quote! {
        #doc
        #[derive(Clone, Debug, PartialEq)]
        #vis struct #name #declared { #(#declarations),* }

        impl #header #name #used {
            /// Name and unit of every column, in the order of `Quantity::Outputs`.
            pub const COLUMNS: &'static [(&'static str, &'static str)] = &[#(#columns),*];
            /// Outputs from their columns.
            #[must_use]
            pub fn from_array(columns: [#t; #count]) -> Self {
                let [#(#numbered),*] = columns;
                #name { #(#values),* }
            }
        }
    }
}
