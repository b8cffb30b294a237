//! The compact protocol of Apache Thrift, as far as the headers of Parquet need it: whole numbers, texts, lists, structs.
//!
//! A whole number is its zigzag code (0, −1, 1, −2 … are 0, 1, 2, 3 …) in bytes of seven bits, the lowest first, with the eighth bit on all but the last. A field of a struct
//! begins with its distance from the field before and its type; a byte of zero ends the struct. Source: Apache Thrift, "Thrift Compact protocol encoding".

/// Types of fields and of members of lists.
const WHOLE_32: u8 = 5;
const WHOLE_64: u8 = 6;
const TEXT: u8 = 8;
const LIST: u8 = 9;
const STRUCT: u8 = 12;

/// A struct under way: its bytes, and the number of its last field.
#[derive(Clone, Debug, Default)]
pub struct ThriftStruct {
    bytes: Vec<u8>,
    last: u8,
}

impl ThriftStruct {
    /// One without fields.
    pub fn new() -> Self {
        ThriftStruct::default()
    }

    /// A field of 32 bits.
    pub fn small(mut self, field: u8, value: i32) -> Self {
        self.begin(field, WHOLE_32);
        whole(&mut self.bytes, i64::from(value));
        self
    }

    /// A field of 64 bits.
    pub fn large(mut self, field: u8, value: u64) -> Self {
        self.begin(field, WHOLE_64);
        whole(&mut self.bytes, value as i64);
        self
    }

    /// A text.
    pub fn text(mut self, field: u8, value: &str) -> Self {
        self.begin(field, TEXT);
        text(&mut self.bytes, value);
        self
    }

    /// A struct.
    pub fn inner(mut self, field: u8, value: ThriftStruct) -> Self {
        self.begin(field, STRUCT);
        self.bytes.extend(value.end());
        self
    }

    /// A list of structs.
    pub fn structs(
        mut self,
        field: u8,
        values: impl ExactSizeIterator<Item = ThriftStruct>,
    ) -> Self {
        self.list(field, STRUCT, values.len());
        values.for_each(|value| self.bytes.extend(value.end()));
        self
    }

    /// A list of one text.
    pub fn one_text(mut self, field: u8, value: &str) -> Self {
        self.list(field, TEXT, 1);
        text(&mut self.bytes, value);
        self
    }

    /// A list of whole numbers of 32 bits.
    pub fn smalls(mut self, field: u8, values: &[i32]) -> Self {
        self.list(field, WHOLE_32, values.len());
        let bytes = &mut self.bytes;
        values
            .iter()
            .for_each(|value| whole(bytes, i64::from(*value)));
        self
    }

    /// Its bytes.
    pub fn end(mut self) -> Vec<u8> {
        self.bytes.push(0);
        self.bytes
    }

    /// Fields come in the order of their numbers, at most 15 apart.
    fn begin(&mut self, field: u8, kind: u8) {
        self.bytes.push((field - self.last) << 4 | kind);
        self.last = field;
    }

    fn list(&mut self, field: u8, kind: u8, count: usize) {
        self.begin(field, LIST);
        match count {
            0..15 => self.bytes.push((count as u8) << 4 | kind),
            _ => {
                self.bytes.push(0xf0 | kind);
                unsigned(&mut self.bytes, count as u64);
            }
        }
    }
}

/// A number without sign, in bytes of seven bits.
pub fn unsigned(bytes: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
}

fn whole(bytes: &mut Vec<u8>, value: i64) {
    unsigned(bytes, ((value << 1) ^ (value >> 63)) as u64);
}

fn text(bytes: &mut Vec<u8>, value: &str) {
    unsigned(bytes, value.len() as u64);
    bytes.extend(value.as_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_bytes_of_the_specification() {
        let coded = |value: i64| {
            let mut bytes = Vec::new();
            whole(&mut bytes, value);
            bytes
        };
        assert_eq!([0, -1, 1, -2].map(coded), [[0], [1], [2], [3]]);
        assert_eq!(coded(150), [0xac, 0x02]);
        assert_eq!(coded(i64::MIN), [[0xff; 9].as_slice(), &[1]].concat());
    }

    #[test]
    fn fields_tell_their_distance_and_long_lists_their_length() {
        let made = ThriftStruct::new().small(1, 3).text(4, "ab").large(6, 1);
        assert_eq!(made.end(), [0x15, 6, 0x38, 2, b'a', b'b', 0x26, 2, 0]);
        let long = ThriftStruct::new().smalls(2, &[0; 20]).end();
        assert_eq!((&long[..3], long.len()), (&[0x29, 0xf5, 20][..], 24));
    }
}
