//! Latin hypercube: of N cases every parameter has exactly one in each of N strata of equal probability.
//!
//! The strata are dealt out by a permutation that is computed for one case alone: a Feistel network over the next even number of bits, walked along
//! its cycle until it falls below N (Black and Rogaway: Ciphers with arbitrary finite domains, 2002).

use super::philox::Draws;

/// Where in (0, 1) the parameter of these draws lies in case `index` (from 0) of `count`.
#[must_use]
pub fn latin(draws: Draws, index: u64, count: u64) -> f64 {
    let stratum = permuted(draws, index, count);
    (stratum as f64 + draws.uniform(index + 1, 0)) / count as f64
}

/// The place of `index` in a random order of 0 … count − 1.
fn permuted(draws: Draws, index: u64, count: u64) -> u64 {
    let bits = (u64::BITS - count.saturating_sub(1).leading_zeros()).max(2);
    let half = bits.div_ceil(2);
    let mask = (1_u64 << half) - 1;
    let mut place = index;
    loop {
        let (mut left, mut right) = (place >> half, place & mask);
        for round in 1..=6 {
            // Attempts above 2³¹ are used by nothing else.
            let mixed = draws.bits(right, (1 << 31) + round);
            (left, right) = (right, left ^ (mixed & mask));
        }
        place = left << half | right;
        if place < count {
            return place;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stratum_has_one_case() {
        for count in [1, 2, 3, 7, 100, 1000, 1024] {
            let draws = Draws::new(3, "mass");
            let strata = (0..count).map(|index| (latin(draws, index, count) * count as f64) as u64);
            let mut strata: Vec<u64> = strata.collect();
            strata.sort_unstable();
            assert_eq!(strata, (0..count).collect::<Vec<_>>(), "{count}");
        }
    }

    /// The mean of a linear function of one parameter: its variance falls as N⁻³, not as N⁻¹.
    #[test]
    fn what_is_linear_is_averaged_far_better_than_by_plain_numbers() {
        let (draws, n) = (Draws::new(3, "mass"), 1000);
        let mean = (0..n).map(|index| latin(draws, index, n)).sum::<f64>() / n as f64;
        let sigma = (1.0 / 12.0_f64).sqrt() * (n as f64).powf(-1.5);
        assert!((mean - 0.5).abs() < 4.0 * sigma);
    }
}
