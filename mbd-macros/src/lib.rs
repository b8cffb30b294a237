//! The procedural macro `model!`.

use proc_macro::TokenStream;

/// Compiles a declaration of bodies, points, lines, loads, events and outputs into a model: its types, its equations as Rust, its documentation.
///
/// `explain()` of the model says what was made of it.
///
#[doc = include_str!("../LANGUAGE.md")]
#[proc_macro]
pub fn model(declaration: TokenStream) -> TokenStream {
    mbd_compiler::compile(declaration.into()).into()
}
