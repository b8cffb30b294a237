//! Numbers as text inside a page: arrays of fixed size, in base 64 (RFC 4648).

use serde::{Serialize, Serializer};

/// An array of numbers, little endian, as the page unpacks it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct PackedArray(Vec<u8>);

impl PackedArray {
    /// Numbers of 32 bits: seven digits.
    pub fn floats(numbers: impl IntoIterator<Item = f64>) -> Self {
        let bytes = numbers.into_iter().flat_map(|x| (x as f32).to_le_bytes());
        PackedArray(bytes.collect())
    }

    /// Shares from −1 to 1 in 16 bits.
    pub fn shares(numbers: impl IntoIterator<Item = f64>) -> Self {
        let share = |x: f64| (x.clamp(-1.0, 1.0) * f64::from(i16::MAX)).round() as i16;
        let bytes = numbers.into_iter().flat_map(|x| share(x).to_le_bytes());
        PackedArray(bytes.collect())
    }

    /// Yes and no.
    pub fn flags(flags: impl IntoIterator<Item = bool>) -> Self {
        PackedArray(flags.into_iter().map(u8::from).collect())
    }

    fn text(&self) -> String {
        const DIGITS: &[u8; 64] =
            b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        let mut text = String::with_capacity(self.0.len().div_ceil(3) * 4);
        for three in self.0.chunks(3) {
            let byte = |k: usize| u32::from(three.get(k).copied().unwrap_or(0));
            let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
            for k in 0..4 {
                let digit = DIGITS[(bits >> (18 - 6 * k)) as usize & 63];
                text.push(if k > three.len() {
                    '='
                } else {
                    char::from(digit)
                });
            }
        }
        text
    }
}

impl Serialize for PackedArray {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.text())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_test_vectors_of_the_standard_are_met() {
        for (bytes, text) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(PackedArray(bytes.as_bytes().to_vec()).text(), text);
        }
    }

    #[test]
    fn shares_keep_their_ends() {
        assert_eq!(
            PackedArray::shares([1.0, -1.0, 2.0]).0,
            [255, 127, 1, 128, 255, 127]
        );
    }
}
