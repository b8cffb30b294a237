//! What every part of an emission needs to know.

use mbd_scene::Scene;
use proc_macro2::{Ident, Span, TokenStream};
use quote::{format_ident, quote};

use super::literal::{ident, readable, whole};
use crate::equations::SceneEquations;
use crate::kernels::Kernels;

/// Where the names of a declaration stand; a missing one stands at the call of the macro.
#[derive(Clone, Debug)]
pub struct NameSpans {
    /// The name of the model.
    pub model: Span,
    /// Per parameter.
    pub params: Vec<Span>,
    /// Per input.
    pub inputs: Vec<Span>,
    /// Per load.
    pub loads: Vec<Span>,
    /// Per output.
    pub outputs: Vec<Span>,
}

impl Default for NameSpans {
    fn default() -> Self {
        NameSpans {
            model: Span::call_site(),
            params: Vec::new(),
            inputs: Vec::new(),
            loads: Vec::new(),
            outputs: Vec::new(),
        }
    }
}

/// How a declaration wants to be emitted.
#[derive(Clone, Debug)]
pub struct EmitSettings {
    /// Generic over the scalar (`pub model Name<T>`), or `f64` only.
    pub generic: bool,
    /// Emit a test module.
    pub verify: bool,
    /// Visibility of the model and its companions.
    pub visibility: TokenStream,
    /// What the reader of the declaration has to say (chosen node models, cut loops).
    pub notes: Vec<String>,
}

impl Default for EmitSettings {
    fn default() -> Self {
        EmitSettings {
            generic: true,
            verify: false,
            visibility: quote!(pub),
            notes: Vec::new(),
        }
    }
}

/// One model being emitted.
pub struct EmitContext<'a> {
    /// Its equations; without programs after an error in the declaration.
    pub equations: &'a SceneEquations,
    /// Where its names stand.
    pub spans: &'a NameSpans,
    /// How it wants to be emitted.
    pub settings: &'a EmitSettings,
    /// Its kernels and who calls them.
    pub kernels: &'a Kernels,
}

impl EmitContext<'_> {
    /// The declaration.
    pub fn scene(&self) -> &Scene {
        &self.equations.scene
    }

    /// The model's name with a suffix: `ParachuteParams`.
    pub fn named(&self, suffix: &str) -> Ident {
        let model = ident(&self.scene().name, self.spans.model);
        Ident::new(&format!("{model}{suffix}"), self.spans.model)
    }

    /// The scalar: `T`, or `f64` of a model that is not generic.
    pub fn scalar(&self) -> TokenStream {
        if self.settings.generic {
            quote!(T)
        } else {
            quote!(f64)
        }
    }

    /// The number zero.
    pub fn zero(&self) -> TokenStream {
        if self.settings.generic {
            quote!(T::zero())
        } else {
            quote!(0.0)
        }
    }

    /// The call of the function of program `index` of [`SceneEquations::every_program`]. One in blocks works on `work`, or on a list of its own.
    pub fn call(
        &self,
        index: usize,
        function: &Ident,
        lists: &[TokenStream],
        work: Option<TokenStream>,
        out: &TokenStream,
    ) -> TokenStream {
        let Some(Some(driver)) = self.kernels.drivers.get(index) else {
            return quote!(#function(#(#lists,)* #out););
        };
        let work = work.unwrap_or_else(|| {
            let (zero, len) = (self.zero(), whole(driver.work));
            quote!(&mut [#zero; #len])
        });
        quote!(let _ = #function(#(#lists,)* #work, #out);)
    }

    /// Whether a quantity is one function, without scratch.
    pub fn is_whole(&self, index: usize) -> bool {
        !matches!(self.kernels.drivers.get(index), Some(Some(_)))
    }

    /// `<T = f64>` of a type, or nothing.
    pub fn declared(&self) -> TokenStream {
        if self.settings.generic {
            quote!(<T = f64>)
        } else {
            quote!()
        }
    }

    /// `<T>` where a type is used, or nothing.
    pub fn used(&self) -> TokenStream {
        if self.settings.generic {
            quote!(<T>)
        } else {
            quote!()
        }
    }

    /// `<T: Real>` of an implementation, or nothing.
    pub fn real(&self) -> TokenStream {
        if self.settings.generic {
            quote!(<T: ::mbd_runtime::Real>)
        } else {
            quote!()
        }
    }

    /// `<T: Scalar>` of an implementation, or nothing.
    pub fn float(&self) -> TokenStream {
        if self.settings.generic {
            quote!(<T: ::mbd_runtime::Scalar>)
        } else {
            quote!()
        }
    }

    /// Parameters as fields.
    pub fn params(&self) -> Vec<Ident> {
        let names = self.scene().params.iter().map(|param| param.name.as_str());
        fields(names, &self.spans.params)
    }

    /// Outputs as fields.
    pub fn outputs(&self) -> Vec<Ident> {
        let names = self
            .scene()
            .outputs
            .iter()
            .map(|output| output.name.as_str());
        fields(names, &self.spans.outputs)
    }

    /// Joint coordinates and their rates as fields, in the order of `Scene::joint_coordinates`.
    pub fn joint_coordinates(&self) -> Vec<Ident> {
        let names = self.scene().joint_coordinates();
        let names: Vec<String> = names
            .iter()
            .map(|name| crate::names::identifier(name))
            .collect();
        fields(names.iter().map(String::as_str), &[])
    }
}

/// A unit for the reader; a pure number has 1.
pub fn unit_text(unit: &str) -> &str {
    if unit.is_empty() { "1" } else { unit }
}

/// Text with units in brackets as documentation: rustdoc would take `[kg]` for a link.
pub fn escaped(text: &str) -> String {
    text.replace('[', "\\[").replace(']', "\\]")
}

/// Names as fields of one struct, each different.
fn fields<'n>(names: impl Iterator<Item = &'n str>, spans: &[Span]) -> Vec<Ident> {
    let mut fields: Vec<Ident> = Vec::new();
    for (index, name) in names.enumerate() {
        let span = spans.get(index).copied().unwrap_or_else(Span::call_site);
        let mut field = ident(name, span);
        while fields.contains(&field) {
            field = format_ident!("{field}_", span = span);
        }
        fields.push(field);
    }
    fields
}

/// One `#[doc]` a line.
pub fn docs(text: &str) -> TokenStream {
    let text = readable(text);
    let lines = text.lines().map(|line| {
        if line.is_empty() {
            String::new()
        } else {
            format!(" {line}")
        }
    });
    quote!(#(#[doc = #lines])*)
}
