//! Numbers and scenes as Rust text.

use proc_macro2::{Ident, Literal, Span, TokenStream};
use quote::quote;

/// A number without suffix; a negative one as a minus and a literal.
#[must_use]
pub fn number(value: f64) -> TokenStream {
    if value.is_nan() {
        return quote!(::core::primitive::f64::NAN);
    }
    let magnitude = value.abs();
    let literal = if magnitude.is_infinite() {
        quote!(::core::primitive::f64::INFINITY)
    } else {
        let literal = readable(magnitude);
        quote!(#literal)
    };
    if value.is_sign_negative() {
        quote!(-#literal)
    } else {
        literal
    }
}

/// Very small and very large numbers with an exponent.
fn readable(magnitude: f64) -> Literal {
    let usual = magnitude == 0.0 || (1e-4..1e9).contains(&magnitude);
    let exponential = (!usual)
        .then(|| format!("{magnitude:e}").parse().ok())
        .flatten();
    exponential.unwrap_or_else(|| Literal::f64_unsuffixed(magnitude))
}

/// A whole number without suffix.
#[must_use]
pub fn whole(value: usize) -> Literal {
    Literal::usize_unsuffixed(value)
}

/// A whole number without suffix, of either sign.
#[must_use]
pub fn signed(value: isize) -> Literal {
    Literal::isize_unsuffixed(value)
}

/// A name of the declaration as an identifier at its place; a name that is none in Rust is changed until it is.
#[must_use]
pub fn ident(name: &str, span: Span) -> Ident {
    if let Ok(mut ident) = syn::parse_str::<Ident>(name) {
        ident.set_span(span);
        return ident;
    }
    let changed = crate::names::identifier(name);
    match syn::parse_str::<Ident>(&changed) {
        Ok(mut ident) => {
            ident.set_span(span);
            ident
        }
        Err(_) => Ident::new(&format!("{changed}_"), span),
    }
}
