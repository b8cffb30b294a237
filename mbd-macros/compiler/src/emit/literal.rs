//! Numbers, scenes and documentation as Rust text.

use mbd_scene::turns_direction;
use proc_macro2::{Ident, Literal, Span, TokenStream};

use crate::syntax::words;

/// A number without suffix; a negative one as a minus and a literal.
#[must_use]
pub fn number(value: f64) -> TokenStream {
    number_text(value).parse().unwrap_or_default()
}

/// The same as text; very small and very large numbers with an exponent.
#[must_use]
pub fn number_text(value: f64) -> String {
    if value.is_nan() {
        return "::core::primitive::f64::NAN".to_owned();
    }
    let magnitude = value.abs();
    let usual = magnitude == 0.0 || (1e-4..1e9).contains(&magnitude);
    let text = match usual {
        _ if magnitude.is_infinite() => "::core::primitive::f64::INFINITY".to_owned(),
        true => format!("{magnitude:?}"),
        false => format!("{magnitude:e}"),
    };
    if value.is_sign_negative() {
        format!("-{text}")
    } else {
        text
    }
}

/// Writes a whole number.
pub fn digits(out: &mut String, value: usize) {
    out.push_str(&value.to_string());
}

/// A whole number without suffix.
#[must_use]
pub fn whole(value: usize) -> Literal {
    Literal::usize_unsuffixed(value)
}

/// A name of the declaration as an identifier at its place; a name that is none in Rust is changed until it is, a keyword by an underscore
/// behind it.
#[must_use]
pub fn ident(name: &str, span: Span) -> Ident {
    if words::is_keyword(name) {
        return Ident::new(&format!("{name}_"), span);
    }
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

/// A text of the declaration without characters that turn the direction of writing: rustc refuses them in what is printed, and a reader is misled.
pub fn readable(text: &str) -> String {
    let visible = |character| match turns_direction(character) {
        true => char::REPLACEMENT_CHARACTER,
        false => character,
    };
    text.chars().map(visible).collect()
}

/// A line of documentation.
pub fn document(out: &mut String, line: &str) {
    out.push_str("#[doc = ");
    out.push_str(&format!("{:?}", readable(line)));
    out.push_str("]\n");
}
