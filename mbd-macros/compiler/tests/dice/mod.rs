//! Random choices that can be repeated.

/// A small generator (xorshift64*), so that a failing case can be repeated from its number.
pub struct Dice(pub u64);

impl Dice {
    /// A number below `n`; zero where there is none.
    pub fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let mixed = self.0.wrapping_mul(0x2545_F491_4F6C_DD1D);
        (mixed >> 33) as usize % n.max(1)
    }
}
