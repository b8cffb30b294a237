//! Scenes as one short text, for generated code: a constructor of a hundred bodies costs a compiler more than their equations do.
//!
//! Items stand in declaration order, each ended by a space: numbers as Rust writes them (to the bit), `1` or `0` for true or false, texts after
//! their length, lists after their count, enums as the number of the variant and what it holds, options as `0`, or `1` and the value.
//! Nothing names what it is: only the version that wrote a text reads it.

use std::fmt::{self, Display, Write};

use serde::de::value::U32Deserializer;
use serde::de::{self, DeserializeSeed, IntoDeserializer, Visitor};
use serde::ser::{self, Serialize};
use serde::{Deserialize, Deserializer, Serializer};

use crate::{Plan, Scene};

/// What can be one text.
pub trait Packed: Serialize + de::DeserializeOwned {
    /// It as one text.
    #[must_use]
    fn packed(&self) -> String {
        packed(self)
    }

    /// What [`Packed::packed`] wrote; `None` of any other text.
    #[must_use]
    fn unpacked(text: &str) -> Option<Self> {
        unpacked(text)
    }
}

impl Packed for Scene {}
impl Packed for Plan {}

fn packed(value: &impl Serialize) -> String {
    let mut text = String::new();
    match value.serialize(Packer(&mut text)) {
        Ok(()) => text,
        // A map or bytes, which no scene holds: a text that unpacks to nothing.
        Err(_) => String::new(),
    }
}

fn unpacked<'de, T: Deserialize<'de>>(text: &'de str) -> Option<T> {
    let mut rest = Unpacker(text);
    let value = T::deserialize(&mut rest).ok()?;
    rest.0.is_empty().then_some(value)
}

/// Why something could not be packed or unpacked.
#[derive(Debug)]
struct Unfit(String);

impl Display for Unfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Unfit {}

impl ser::Error for Unfit {
    fn custom<T: Display>(message: T) -> Self {
        Unfit(message.to_string())
    }
}

impl de::Error for Unfit {
    fn custom<T: Display>(message: T) -> Self {
        Unfit(message.to_string())
    }
}

struct Packer<'t>(&'t mut String);

impl<'t> Packer<'t> {
    fn item(self, item: impl Display) -> Result<Self, Unfit> {
        write!(self.0, "{item} ").map_err(ser::Error::custom)?;
        Ok(self)
    }

    fn only(self, item: impl Display) -> Result<(), Unfit> {
        self.item(item).map(drop)
    }
}

macro_rules! pack_numbers {
    ($($method:ident $t:ty),*) => {$(
        fn $method(self, value: $t) -> Result<(), Unfit> {
            self.only(value)
        }
    )*};
}

impl<'t> Serializer for Packer<'t> {
    type Ok = ();
    type Error = Unfit;
    type SerializeSeq = Self;
    type SerializeTuple = Self;
    type SerializeTupleStruct = Self;
    type SerializeTupleVariant = Self;
    type SerializeMap = ser::Impossible<(), Unfit>;
    type SerializeStruct = Self;
    type SerializeStructVariant = Self;

    pack_numbers!(
        serialize_i8 i8, serialize_i16 i16, serialize_i32 i32, serialize_i64 i64,
        serialize_u8 u8, serialize_u16 u16, serialize_u32 u32, serialize_u64 u64,
        serialize_char char
    );

    fn serialize_bool(self, value: bool) -> Result<(), Unfit> {
        self.only(u8::from(value))
    }
    fn serialize_f32(self, value: f32) -> Result<(), Unfit> {
        self.only(format_args!("{value:?}"))
    }
    fn serialize_f64(self, value: f64) -> Result<(), Unfit> {
        self.only(format_args!("{value:?}"))
    }
    fn serialize_str(self, value: &str) -> Result<(), Unfit> {
        self.item(value.len())?.only(value)
    }
    fn serialize_bytes(self, _: &[u8]) -> Result<(), Unfit> {
        Err(ser::Error::custom("bytes"))
    }
    fn serialize_none(self) -> Result<(), Unfit> {
        self.only(0)
    }
    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Result<(), Unfit> {
        value.serialize(self.item(1)?)
    }
    fn serialize_unit(self) -> Result<(), Unfit> {
        Ok(())
    }
    fn serialize_unit_struct(self, _: &'static str) -> Result<(), Unfit> {
        Ok(())
    }
    fn serialize_unit_variant(
        self,
        _: &'static str,
        index: u32,
        _: &'static str,
    ) -> Result<(), Unfit> {
        self.only(index)
    }
    fn serialize_newtype_struct<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        value: &T,
    ) -> Result<(), Unfit> {
        value.serialize(self)
    }
    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        index: u32,
        _: &'static str,
        value: &T,
    ) -> Result<(), Unfit> {
        value.serialize(self.item(index)?)
    }
    fn serialize_seq(self, len: Option<usize>) -> Result<Self, Unfit> {
        let len = len.ok_or_else(|| -> Unfit { ser::Error::custom("a list of unknown length") })?;
        self.item(len)
    }
    fn serialize_tuple(self, _: usize) -> Result<Self, Unfit> {
        Ok(self)
    }
    fn serialize_tuple_struct(self, _: &'static str, _: usize) -> Result<Self, Unfit> {
        Ok(self)
    }
    fn serialize_tuple_variant(
        self,
        _: &'static str,
        index: u32,
        _: &'static str,
        _: usize,
    ) -> Result<Self, Unfit> {
        self.item(index)
    }
    fn serialize_map(self, _: Option<usize>) -> Result<Self::SerializeMap, Unfit> {
        Err(ser::Error::custom("a map"))
    }
    fn serialize_struct(self, _: &'static str, _: usize) -> Result<Self, Unfit> {
        Ok(self)
    }
    fn serialize_struct_variant(
        self,
        _: &'static str,
        index: u32,
        _: &'static str,
        _: usize,
    ) -> Result<Self, Unfit> {
        self.item(index)
    }
}

macro_rules! pack_parts {
    ($($trait:ident $method:ident ($($key:ident)?),)*) => {$(
        impl ser::$trait for Packer<'_> {
            type Ok = ();
            type Error = Unfit;
            fn $method<T: Serialize + ?Sized>(
                &mut self,
                $($key: &'static str,)?
                value: &T,
            ) -> Result<(), Unfit> {
                value.serialize(Packer(self.0))
            }
            fn end(self) -> Result<(), Unfit> {
                Ok(())
            }
        }
    )*};
}

pack_parts!(
    SerializeSeq serialize_element (),
    SerializeTuple serialize_element (),
    SerializeTupleStruct serialize_field (),
    SerializeTupleVariant serialize_field (),
    SerializeStruct serialize_field (_key),
    SerializeStructVariant serialize_field (_key),
);

/// What is left of a text.
struct Unpacker<'de>(&'de str);

impl<'de> Unpacker<'de> {
    fn item(&mut self) -> Result<&'de str, Unfit> {
        let (item, rest) = self.0.split_once(' ').ok_or_else(ends)?;
        self.0 = rest;
        Ok(item)
    }

    fn number<N: std::str::FromStr<Err: Display>>(&mut self) -> Result<N, Unfit> {
        self.item()?.parse().map_err(de::Error::custom)
    }

    fn text(&mut self) -> Result<&'de str, Unfit> {
        let len: usize = self.number()?;
        let (text, rest) = self.0.split_at_checked(len).ok_or_else(ends)?;
        self.0 = rest.strip_prefix(' ').ok_or_else(ends)?;
        Ok(text)
    }
}

fn ends() -> Unfit {
    de::Error::custom("the text ends early")
}

macro_rules! unpack_numbers {
    ($($method:ident $visit:ident),*) => {$(
        fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unfit> {
            visitor.$visit(self.number()?)
        }
    )*};
}

impl<'de> Deserializer<'de> for &mut Unpacker<'de> {
    type Error = Unfit;

    unpack_numbers!(
        deserialize_i8 visit_i8, deserialize_i16 visit_i16, deserialize_i32 visit_i32, deserialize_i64 visit_i64,
        deserialize_u8 visit_u8, deserialize_u16 visit_u16, deserialize_u32 visit_u32, deserialize_u64 visit_u64,
        deserialize_f32 visit_f32, deserialize_f64 visit_f64, deserialize_char visit_char
    );

    fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Unfit> {
        Err(de::Error::custom("nothing says what comes next"))
    }
    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unfit> {
        visitor.visit_bool(self.number::<u8>()? != 0)
    }
    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unfit> {
        visitor.visit_borrowed_str(self.text()?)
    }
    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unfit> {
        self.deserialize_str(visitor)
    }
    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unfit> {
        match self.number::<u8>()? {
            0 => visitor.visit_none(),
            _ => visitor.visit_some(self),
        }
    }
    fn deserialize_unit<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unfit> {
        visitor.visit_unit()
    }
    fn deserialize_unit_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, Unfit> {
        visitor.visit_unit()
    }
    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, Unfit> {
        visitor.visit_newtype_struct(self)
    }
    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unfit> {
        let left = self.number()?;
        visitor.visit_seq(Items { from: self, left })
    }
    fn deserialize_tuple<V: Visitor<'de>>(
        self,
        left: usize,
        visitor: V,
    ) -> Result<V::Value, Unfit> {
        visitor.visit_seq(Items { from: self, left })
    }
    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        left: usize,
        visitor: V,
    ) -> Result<V::Value, Unfit> {
        visitor.visit_seq(Items { from: self, left })
    }
    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Unfit> {
        self.deserialize_tuple(fields.len(), visitor)
    }
    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Unfit> {
        visitor.visit_enum(self)
    }

    serde::forward_to_deserialize_any! { bytes byte_buf map identifier ignored_any }
}

/// The items of a list, or of anything whose count is known.
struct Items<'r, 'de> {
    from: &'r mut Unpacker<'de>,
    left: usize,
}

impl<'de> de::SeqAccess<'de> for Items<'_, 'de> {
    type Error = Unfit;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Unfit> {
        // What says nothing at the end of all is not written.
        if self.left == 0 || (self.left == 1 && self.from.0.is_empty()) {
            return Ok(None);
        }
        self.left -= 1;
        seed.deserialize(&mut *self.from).map(Some)
    }
}

impl<'de> de::EnumAccess<'de> for &mut Unpacker<'de> {
    type Error = Unfit;
    type Variant = Self;

    fn variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<(T::Value, Self), Unfit> {
        let index: U32Deserializer<Unfit> = self.number::<u32>()?.into_deserializer();
        Ok((seed.deserialize(index)?, self))
    }
}

impl<'de> de::VariantAccess<'de> for &mut Unpacker<'de> {
    type Error = Unfit;

    fn unit_variant(self) -> Result<(), Unfit> {
        Ok(())
    }
    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, Unfit> {
        seed.deserialize(self)
    }
    fn tuple_variant<V: Visitor<'de>>(self, len: usize, visitor: V) -> Result<V::Value, Unfit> {
        self.deserialize_tuple(len, visitor)
    }
    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Unfit> {
        self.deserialize_tuple(fields.len(), visitor)
    }
}
