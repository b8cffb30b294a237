//! Percentiles by order statistics: what is said of a distribution from its cases alone, without a fit.
//!
//! Of n independent cases the r-th smallest lies above the p-quantile with probability P(B ≤ r − 1), B binomial with n and p (David and Nagaraja:
//! Order Statistics, section 7.1). Nothing is extrapolated: where no case lies far enough out, there is no bound.

use super::binomial::at_most;

/// A percentile of some cases, with an interval that holds that of the distribution with a confidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Percentile {
    /// The part below it, 0 … 1.
    pub part: f64,
    /// The value of the cases: the smallest that at least that part of them does not exceed.
    pub value: f64,
    /// Not above the percentile of the distribution, with half of the doubt; `None`: not enough cases.
    pub low: Option<f64>,
    /// Not below it.
    pub high: Option<f64>,
}

/// The smallest of sorted values that at least this part of them does not exceed; `None` without values.
#[must_use]
pub fn quantile(sorted: &[f64], part: f64) -> Option<f64> {
    let rank = (part * sorted.len() as f64).ceil() as usize;
    sorted.get(rank.clamp(1, sorted.len().max(1)) - 1).copied()
}

/// The percentile of sorted values with a two-sided confidence; `None` without values.
#[must_use]
pub fn percentile(sorted: &[f64], part: f64, confidence: f64) -> Option<Percentile> {
    let n = sorted.len() as u64;
    let doubt = 0.5 * (1.0 - confidence);
    let at = |rank: Option<u64>| sorted.get(rank?.checked_sub(1)? as usize).copied();
    Some(Percentile {
        part,
        value: quantile(sorted, part)?,
        low: at(rank_below(n, part, 1.0 - doubt)),
        high: at(rank_above(n, part, 1.0 - doubt)),
    })
}

/// The smallest rank whose value is not below the `part`-quantile with a one-sided confidence; `None`: not enough cases.
#[must_use]
pub fn rank_above(n: u64, part: f64, confidence: f64) -> Option<u64> {
    if n == 0 || at_most(n - 1, n, part) < confidence {
        return None;
    }
    // The first r with P(B ≤ r − 1) ≥ confidence.
    let (mut low, mut high) = (1, n);
    while low < high {
        let middle = low + (high - low) / 2;
        match at_most(middle - 1, n, part) >= confidence {
            true => high = middle,
            false => low = middle + 1,
        }
    }
    Some(low)
}

/// The largest rank whose value is not above the `part`-quantile with a one-sided confidence; `None`: not enough cases.
#[must_use]
pub fn rank_below(n: u64, part: f64, confidence: f64) -> Option<u64> {
    // The mirror image: the largest values become the smallest.
    Some(n + 1 - rank_above(n, 1.0 - part, confidence)?)
}

/// Whether at most `failures` of `n` cases that miss a requirement show, with a confidence, that at least `share` of all meet it: such a result, or
/// a better one, would have a probability of at most 1 − confidence if they did not.
#[must_use]
pub fn shows(failures: u64, n: u64, share: f64, confidence: f64) -> bool {
    n > 0 && at_most(failures, n, 1.0 - share) <= 1.0 - confidence
}

/// The fewest cases that can show it with so many failures.
#[must_use]
pub fn cases_needed(failures: u64, share: f64, confidence: f64) -> u64 {
    let mut high = failures + 1;
    while !shows(failures, high, share, confidence) && high < 1 << 40 {
        high *= 2;
    }
    let mut low = failures;
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        match shows(failures, middle, share, confidence) {
            true => high = middle,
            false => low = middle,
        }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table of acceptance sampling at 10 % consumer risk: 0, 1, 2 failures.
    #[test]
    fn the_cases_needed_are_those_of_the_published_table() {
        let table = [
            (0.95, [45, 77, 105]),
            (0.99, [230, 388, 531]),
            (0.9973, [852, 1440, 1970]),
            (0.99865, [1705, 2880, 3941]),
        ];
        for (share, needed) in table {
            for (failures, needed) in needed.into_iter().enumerate() {
                let failures = failures as u64;
                assert_eq!(
                    cases_needed(failures, share, 0.9),
                    needed,
                    "{share} {failures}"
                );
                assert!(!shows(failures, needed - 1, share, 0.9));
            }
        }
    }

    /// Wilks: the largest of 59 cases is not below the 95 % quantile with 95 % confidence, that of 58 not so.
    #[test]
    fn the_largest_of_fifty_nine_bounds_the_95_percent_quantile() {
        assert_eq!(rank_above(59, 0.95, 0.95), Some(59));
        assert_eq!(rank_above(58, 0.95, 0.95), None);
        assert_eq!(rank_above(93, 0.95, 0.95), Some(92));
        assert_eq!(rank_below(59, 0.05, 0.95), Some(1));
    }

    #[test]
    fn an_interval_holds_the_quantile_as_often_as_it_says() {
        // Of 1000 sets of 200 numbers of a linear congruential sequence, evenly distributed.
        let mut state = 12345_u64;
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut held = 0;
        for _ in 0..1000 {
            let mut set: Vec<f64> = (0..200).map(|_| next()).collect();
            set.sort_by(f64::total_cmp);
            let found = percentile(&set, 0.9, 0.9).expect("200 values");
            let (Some(low), Some(high)) = (found.low, found.high) else {
                panic!("200 cases are enough");
            };
            held += u32::from(low <= 0.9 && 0.9 <= high);
        }
        // At least 90 %, less three standard deviations.
        assert!(held > 871, "{held}");
    }

    #[test]
    fn too_few_cases_have_a_value_and_no_bound() {
        let found = percentile(&[1.0, 2.0, 3.0], 0.99, 0.9).expect("values");
        assert_eq!((found.value, found.high), (3.0, None));
        assert_eq!(percentile(&[], 0.5, 0.9), None);
    }
}
