//! Hashing for tables that only this program fills: nobody attacks them, and expansions pay for every look-up, mostly in macros that nobody
//! optimises.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// A hash after one more word.
#[inline]
#[must_use]
pub fn mixed(hash: u64, word: u64) -> u64 {
    // The odd number nearest to 2⁶⁴ / golden ratio. A product mixes into the highest bits, tables look at the lowest.
    let product = (hash ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    product ^ product >> 32
}

/// A hash table with [`Mixer`].
pub type FastMap<K, V> = HashMap<K, V, BuildHasherDefault<Mixer>>;

/// Mixes word by word; the same on every run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mixer(u64);

impl Mixer {
    #[inline]
    fn mix(&mut self, word: u64) {
        self.0 = mixed(self.0, word);
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
        self.0
    }
}

/// Pairs of words in the order in which they were first asked for.
#[derive(Clone, Debug, Default)]
pub struct WordPairs {
    pairs: Vec<[u64; 2]>,
    /// Open addressing: one more than the place in `pairs`, zero where there is none. A power of two, at least twice as long as `pairs`.
    cells: Vec<u32>,
}

impl WordPairs {
    /// The place of a pair that has been asked for before.
    pub fn find(&self, pair: [u64; 2]) -> Option<usize> {
        let last = self.cells.len().checked_sub(1)?;
        let mut cell = hash(pair) as usize & last;
        while let Some(place) = (self.cells[cell] as usize).checked_sub(1) {
            if self.pairs[place] == pair {
                return Some(place);
            }
            cell = (cell + 1) & last;
        }
        None
    }

    /// The place of a pair in the order of first asking; a new one gets the next place.
    pub fn place(&mut self, pair: [u64; 2]) -> usize {
        if self.cells.len() < 2 * (self.pairs.len() + 1) {
            self.grow();
        }
        let (pairs, cells) = (self.pairs.as_slice(), self.cells.as_mut_slice());
        let last = cells.len() - 1;
        let mut cell = hash(pair) as usize & last;
        while cells[cell] != 0 {
            let place = cells[cell] as usize - 1;
            let known = &pairs[place];
            if known[0] == pair[0] && known[1] == pair[1] {
                return place;
            }
            cell = (cell + 1) & last;
        }
        self.pairs.push(pair);
        cells[cell] = self.pairs.len() as u32;
        self.pairs.len() - 1
    }

    fn grow(&mut self) {
        let last = (4 * self.pairs.len()).next_power_of_two().max(1024) - 1;
        let mut cells = vec![0; last + 1];
        for (place, &pair) in self.pairs.iter().enumerate() {
            let mut cell = hash(pair) as usize & last;
            while cells[cell] != 0 {
                cell = (cell + 1) & last;
            }
            cells[cell] = place as u32 + 1;
        }
        self.cells = cells;
    }
}

fn hash(pair: [u64; 2]) -> u64 {
    mixed(mixed(0, pair[0]), pair[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pair_keeps_the_place_at_which_it_was_first_asked_for() {
        let mut found = WordPairs::default();
        let pair = |index: u64| [index % 7, index << 40];
        assert_eq!(found.find(pair(0)), None);
        for index in 0..5000 {
            assert_eq!(found.find(pair(index)), None);
            assert_eq!(found.place(pair(index)), index as usize);
            assert_eq!(found.place(pair(index / 2)), index as usize / 2);
            assert_eq!(found.find(pair(index)), Some(index as usize));
        }
    }
}
