//! The binomial distribution: how likely so many of n independent cases are.

/// The probability of at most `k` successes among `n` cases, each with probability `p`: the sum of C(n, i) pⁱ (1 − p)ⁿ⁻ⁱ over i ≤ k.
#[must_use]
pub fn at_most(k: u64, n: u64, p: f64) -> f64 {
    if k >= n {
        return 1.0;
    }
    if p <= 0.0 {
        return 1.0;
    }
    if p >= 1.0 {
        return 0.0;
    }
    // Terms are summed from the largest of the sum downwards, by the ratio of neighbours, until they no longer count.
    let mode = (((n + 1) as f64 * p).floor() as u64).min(k);
    let (rises, whole) = ((1.0 - p) / p, n as f64);
    let first = term(mode, n, p);
    let (mut sum, mut down) = (first, first);
    for i in (1..=mode).rev() {
        down *= rises * i as f64 / (whole - i as f64 + 1.0);
        sum += down;
        if down < 1e-18 * sum {
            break;
        }
    }
    let mut up = first;
    for i in mode + 1..=k {
        up *= (whole - i as f64 + 1.0) / (rises * i as f64);
        sum += up;
        if up < 1e-18 * sum {
            break;
        }
    }
    sum.min(1.0)
}

/// C(n, k) pᵏ (1 − p)ⁿ⁻ᵏ.
fn term(k: u64, n: u64, p: f64) -> f64 {
    let factorial = |n: u64| libm::lgamma(n as f64 + 1.0);
    let chosen = factorial(n) - factorial(k) - factorial(n - k);
    (chosen + k as f64 * p.ln() + (n - k) as f64 * (-p).ln_1p()).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_sums_are_those_of_the_definition() {
        // Three coins: 1, 3, 3, 1 of 8.
        for (k, expected) in [(0, 0.125), (1, 0.5), (2, 0.875), (3, 1.0)] {
            assert!((at_most(k, 3, 0.5) - expected).abs() < 1e-15);
        }
        assert!((at_most(0, 45, 0.05) - 0.95_f64.powi(45)).abs() < 1e-15);
        assert_eq!(at_most(0, 10, 0.0), 1.0);
        assert_eq!(at_most(9, 10, 1.0), 0.0);
    }

    #[test]
    fn what_is_more_and_what_is_less_add_up_also_for_many_cases() {
        // P(X ≤ k; p) + P(n − X ≤ n − k − 1; 1 − p) = 1.
        for (k, n, p) in [
            (3, 20, 0.3),
            (49_900, 100_000, 0.5),
            (130, 100_000, 0.00135),
            (99_000, 100_000, 0.99),
        ] {
            let sum = at_most(k, n, p) + at_most(n - k - 1, n, 1.0 - p);
            assert!((sum - 1.0).abs() < 1e-9, "{k} {n} {p}: {sum}");
        }
    }
}
