//! Random numbers by counting: the number of a name in a case is a function of seed, name and case, and of nothing else.
//!
//! Philox 4×32 with ten rounds (Salmon, Moraes, Dror, Shaw: Parallel random numbers: as easy as 1, 2, 3, SC11), keyed by seed and name. A further
//! name, other threads or other shards change no number of this one.

use mbd_runtime::scene::fingerprint;

const MULTIPLIERS: [u32; 2] = [0xD251_1F53, 0xCD9E_8D57];
const KEY_STEPS: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];

/// Ten rounds of Philox 4×32.
fn philox(mut counter: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    for round in 0..10 {
        if round > 0 {
            key = [0, 1].map(|k| key[k].wrapping_add(KEY_STEPS[k]));
        }
        let product = |k: usize| u64::from(MULTIPLIERS[k]) * u64::from(counter[2 * k]);
        let high = |k: usize| (product(k) >> 32) as u32;
        let low = |k: usize| product(k) as u32;
        counter = [
            high(1) ^ counter[1] ^ key[0],
            low(1),
            high(0) ^ counter[3] ^ key[1],
            low(0),
        ];
    }
    counter
}

/// The numbers of one name under one seed.
#[derive(Clone, Copy, Debug)]
pub struct Draws {
    key: [u32; 2],
}

impl Draws {
    /// Those of `name` under `seed`.
    #[must_use]
    pub fn new(seed: u64, name: &str) -> Self {
        let key = fingerprint(seed.to_le_bytes().into_iter().chain(name.bytes()));
        Draws {
            key: [key as u32, (key >> 32) as u32],
        }
    }

    /// 64 random bits for a case and an attempt.
    #[must_use]
    pub fn bits(&self, case: u64, attempt: u32) -> u64 {
        let counter = [case as u32, (case >> 32) as u32, attempt, 0];
        let [low, high, ..] = philox(counter, self.key);
        u64::from(high) << 32 | u64::from(low)
    }

    /// A number evenly distributed between 0 and 1, neither of them.
    #[must_use]
    pub fn uniform(&self, case: u64, attempt: u32) -> f64 {
        between_zero_and_one(self.bits(case, attempt))
    }
}

/// The middle of the cell of width 2⁻⁵² in which the bits lie: neither 0 nor 1.
#[must_use]
pub fn between_zero_and_one(bits: u64) -> f64 {
    ((bits >> 12) as f64 + 0.5) / (1_u64 << 52) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Known answers of the authors' library Random123.
    #[test]
    fn published_numbers_are_met() {
        let ones = u32::MAX;
        assert_eq!(
            philox([0; 4], [0; 2]),
            [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]
        );
        assert_eq!(
            philox([ones; 4], [ones; 2]),
            [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]
        );
        assert_eq!(
            philox(
                [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344],
                [0xa409_3822, 0x299f_31d0]
            ),
            [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1]
        );
    }

    #[test]
    fn numbers_are_evenly_distributed_and_of_two_names_independent() {
        let [a, b] = ["mass", "drag"].map(|name| Draws::new(7, name));
        let n = 100_000;
        let list = |draws: Draws| (1..=n).map(move |case| draws.uniform(case, 0));
        let mean = list(a).sum::<f64>() / n as f64;
        let square = list(a).map(|u| (u - 0.5).powi(2)).sum::<f64>() / n as f64;
        let mixed = list(a)
            .zip(list(b))
            .map(|(u, v)| (u - 0.5) * (v - 0.5))
            .sum::<f64>()
            / n as f64;
        // Four standard deviations of each estimate.
        let allowed = 4.0 / (n as f64).sqrt();
        assert!((mean - 0.5).abs() < allowed * (1.0_f64 / 12.0).sqrt());
        assert!((square - 1.0 / 12.0).abs() < allowed * (1.0_f64 / 180.0).sqrt());
        assert!(mixed.abs() < allowed / 12.0);
    }

    #[test]
    fn the_ends_are_never_drawn() {
        assert!(between_zero_and_one(0) > 0.0 && between_zero_and_one(u64::MAX) < 1.0);
    }
}
