//! A serde value as the Rust expression that makes it: how `scene()` of a model returns the declaration as data.
//!
//! Types are named by serde and found flat in `::mbd_runtime::scene`. Strings become `.into()`, lists `vec!`, arrays `[…]`.

use std::fmt;

use proc_macro2::{Ident, Span, TokenStream};
use quote::quote;
use serde::ser::{self, Serialize};

use super::literal;

/// The expression that makes `value`.
///
/// # Errors
/// A map or raw bytes, which no scene holds.
pub fn constructor(value: &impl Serialize) -> Result<TokenStream, Unsupported> {
    value.serialize(Writer)
}

/// A kind of value that scenes do not hold.
#[derive(Debug)]
pub struct Unsupported(String);

impl fmt::Display for Unsupported {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Unsupported {}

impl ser::Error for Unsupported {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Unsupported(message.to_string())
    }
}

struct Writer;

/// The parts of a list, tuple or struct.
struct Parts {
    head: TokenStream,
    kind: Kind,
    parts: Vec<TokenStream>,
}

enum Kind {
    List,
    Array,
    Fields,
    Call,
}

fn path(name: &'static str) -> TokenStream {
    let name = Ident::new(name, Span::call_site());
    quote!(::mbd_runtime::scene::#name)
}

fn variant(name: &'static str, variant: &'static str) -> TokenStream {
    let (path, variant) = (path(name), Ident::new(variant, Span::call_site()));
    quote!(#path::#variant)
}

impl Parts {
    fn new(head: TokenStream, kind: Kind) -> Self {
        Parts {
            head,
            kind,
            parts: Vec::new(),
        }
    }

    fn push(&mut self, value: &(impl Serialize + ?Sized)) -> Result<(), Unsupported> {
        self.parts.push(value.serialize(Writer)?);
        Ok(())
    }

    fn push_field(
        &mut self,
        key: &'static str,
        value: &(impl Serialize + ?Sized),
    ) -> Result<(), Unsupported> {
        let (key, value) = (Ident::new(key, Span::call_site()), value.serialize(Writer)?);
        self.parts.push(quote!(#key: #value));
        Ok(())
    }

    fn finish(self) -> TokenStream {
        let Parts { head, kind, parts } = self;
        match kind {
            Kind::List => quote!(::std::vec![#(#parts),*]),
            Kind::Array => quote!([#(#parts),*]),
            Kind::Fields => quote!(#head { #(#parts),* }),
            Kind::Call => quote!(#head(#(#parts),*)),
        }
    }
}

macro_rules! whole {
    ($($method:ident $t:ty),*) => {$(
        fn $method(self, value: $t) -> Result<TokenStream, Unsupported> {
            let value = i128::from(value);
            let literal = proc_macro2::Literal::u128_unsuffixed(value.unsigned_abs());
            Ok(if value < 0 { quote!(-#literal) } else { quote!(#literal) })
        }
    )*};
}

impl ser::Serializer for Writer {
    type Ok = TokenStream;
    type Error = Unsupported;
    type SerializeSeq = Parts;
    type SerializeTuple = Parts;
    type SerializeTupleStruct = Parts;
    type SerializeTupleVariant = Parts;
    type SerializeMap = ser::Impossible<TokenStream, Unsupported>;
    type SerializeStruct = Parts;
    type SerializeStructVariant = Parts;

    whole!(
        serialize_i8 i8, serialize_i16 i16, serialize_i32 i32, serialize_i64 i64,
        serialize_u8 u8, serialize_u16 u16, serialize_u32 u32, serialize_u64 u64
    );

    fn serialize_bool(self, value: bool) -> Result<TokenStream, Unsupported> {
        Ok(quote!(#value))
    }
    fn serialize_f32(self, value: f32) -> Result<TokenStream, Unsupported> {
        self.serialize_f64(f64::from(value))
    }
    fn serialize_f64(self, value: f64) -> Result<TokenStream, Unsupported> {
        Ok(literal::number(value))
    }
    fn serialize_char(self, value: char) -> Result<TokenStream, Unsupported> {
        Ok(quote!(#value))
    }
    fn serialize_str(self, value: &str) -> Result<TokenStream, Unsupported> {
        Ok(quote!(#value.into()))
    }
    fn serialize_bytes(self, _: &[u8]) -> Result<TokenStream, Unsupported> {
        Err(Unsupported("bytes".to_owned()))
    }
    fn serialize_none(self) -> Result<TokenStream, Unsupported> {
        Ok(quote!(::core::option::Option::None))
    }
    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Result<TokenStream, Unsupported> {
        let value = value.serialize(Writer)?;
        Ok(quote!(::core::option::Option::Some(#value)))
    }
    fn serialize_unit(self) -> Result<TokenStream, Unsupported> {
        Ok(quote!(()))
    }
    fn serialize_unit_struct(self, name: &'static str) -> Result<TokenStream, Unsupported> {
        Ok(path(name))
    }
    fn serialize_unit_variant(
        self,
        name: &'static str,
        _: u32,
        of: &'static str,
    ) -> Result<TokenStream, Unsupported> {
        Ok(variant(name, of))
    }
    fn serialize_newtype_struct<T: Serialize + ?Sized>(
        self,
        name: &'static str,
        value: &T,
    ) -> Result<TokenStream, Unsupported> {
        let (path, value) = (path(name), value.serialize(Writer)?);
        Ok(quote!(#path(#value)))
    }
    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        name: &'static str,
        _: u32,
        of: &'static str,
        value: &T,
    ) -> Result<TokenStream, Unsupported> {
        let (path, value) = (variant(name, of), value.serialize(Writer)?);
        Ok(quote!(#path(#value)))
    }
    fn serialize_seq(self, _: Option<usize>) -> Result<Parts, Unsupported> {
        Ok(Parts::new(TokenStream::new(), Kind::List))
    }
    fn serialize_tuple(self, _: usize) -> Result<Parts, Unsupported> {
        Ok(Parts::new(TokenStream::new(), Kind::Array))
    }
    fn serialize_tuple_struct(self, name: &'static str, _: usize) -> Result<Parts, Unsupported> {
        Ok(Parts::new(path(name), Kind::Call))
    }
    fn serialize_tuple_variant(
        self,
        name: &'static str,
        _: u32,
        of: &'static str,
        _: usize,
    ) -> Result<Parts, Unsupported> {
        Ok(Parts::new(variant(name, of), Kind::Call))
    }
    fn serialize_map(self, _: Option<usize>) -> Result<Self::SerializeMap, Unsupported> {
        Err(Unsupported("a map".to_owned()))
    }
    fn serialize_struct(self, name: &'static str, _: usize) -> Result<Parts, Unsupported> {
        Ok(Parts::new(path(name), Kind::Fields))
    }
    fn serialize_struct_variant(
        self,
        name: &'static str,
        _: u32,
        of: &'static str,
        _: usize,
    ) -> Result<Parts, Unsupported> {
        Ok(Parts::new(variant(name, of), Kind::Fields))
    }
}

impl ser::SerializeSeq for Parts {
    type Ok = TokenStream;
    type Error = Unsupported;
    fn serialize_element<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Unsupported> {
        self.push(value)
    }
    fn end(self) -> Result<TokenStream, Unsupported> {
        Ok(self.finish())
    }
}

impl ser::SerializeTuple for Parts {
    type Ok = TokenStream;
    type Error = Unsupported;
    fn serialize_element<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Unsupported> {
        self.push(value)
    }
    fn end(self) -> Result<TokenStream, Unsupported> {
        Ok(self.finish())
    }
}

macro_rules! of_fields {
    ($($trait:ident $method:ident),*) => {$(
        impl ser::$trait for Parts {
            type Ok = TokenStream;
            type Error = Unsupported;
            fn $method<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Unsupported> {
                self.push(value)
            }
            fn end(self) -> Result<TokenStream, Unsupported> {
                Ok(self.finish())
            }
        }
    )*};
}

of_fields!(SerializeTupleStruct serialize_field, SerializeTupleVariant serialize_field);

macro_rules! of_named_fields {
    ($($trait:ident),*) => {$(
        impl ser::$trait for Parts {
            type Ok = TokenStream;
            type Error = Unsupported;
            fn serialize_field<T: Serialize + ?Sized>(
                &mut self,
                key: &'static str,
                value: &T,
            ) -> Result<(), Unsupported> {
                self.push_field(key, value)
            }
            fn end(self) -> Result<TokenStream, Unsupported> {
                Ok(self.finish())
            }
        }
    )*};
}

of_named_fields!(SerializeStruct, SerializeStructVariant);
