//! Hashing for tables that only this program fills: nobody attacks them, and expansions pay for every look-up.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// A hash table with [`Mixer`].
pub type Map<K, V> = HashMap<K, V, BuildHasherDefault<Mixer>>;

/// Multiplies and rotates, word by word; the same on every run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mixer(u64);

impl Mixer {
    #[inline]
    fn mix(&mut self, word: u64) {
        // The odd number nearest to 2⁶⁴ / golden ratio.
        self.0 = (self.0.rotate_left(5) ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }
}

impl Hasher for Mixer {
    fn write(&mut self, bytes: &[u8]) {
        for chunk in bytes.chunks(8) {
            let word = chunk
                .iter()
                .rev()
                .fold(0, |word, &b| word << 8 | u64::from(b));
            self.mix(word);
        }
    }
    #[inline]
    fn write_u8(&mut self, word: u8) {
        self.mix(u64::from(word));
    }
    #[inline]
    fn write_u32(&mut self, word: u32) {
        self.mix(u64::from(word));
    }
    #[inline]
    fn write_u64(&mut self, word: u64) {
        self.mix(word);
    }
    #[inline]
    fn write_usize(&mut self, word: usize) {
        self.mix(word as u64);
    }
    #[inline]
    fn write_isize(&mut self, word: isize) {
        self.mix(word as u64);
    }
    #[inline]
    fn finish(&self) -> u64 {
        // The table looks at the lowest bits first, the product mixes into the highest.
        self.0.rotate_left(26)
    }
}
