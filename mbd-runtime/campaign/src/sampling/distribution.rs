//! The distributions of a number: each by where so much of it lies below, so that random numbers, strata, Sobol points and correlated numbers go
//! through the same function.

use super::normal;

/// How a number is distributed; everything in SI.
#[derive(Clone, Debug, PartialEq)]
pub enum Distribution {
    /// Normal.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation.
        sigma: f64,
    },
    /// Normal, cut off at both ends: what lies outside is drawn inside instead.
    TruncatedNormal {
        /// Mean before it is cut.
        mean: f64,
        /// Standard deviation before it is cut.
        sigma: f64,
        /// The smallest value.
        low: f64,
        /// The largest value.
        high: f64,
    },
    /// Even between two ends.
    Uniform {
        /// The smallest value.
        low: f64,
        /// The largest value.
        high: f64,
    },
    /// Rises from the low end to the mode and falls to the high end.
    Triangular {
        /// The smallest value.
        low: f64,
        /// The most likely value.
        mode: f64,
        /// The largest value.
        high: f64,
    },
    /// One of these values, with weights that add up to 1, summed up from the first.
    Discrete {
        /// The values.
        values: Vec<f64>,
        /// The sums of the weights up to each.
        up_to: Vec<f64>,
    },
    /// One of these rows, all equally likely, or in a grid one after the other.
    Listed(Vec<f64>),
}

impl Distribution {
    /// The value below which the part `u` of it lies, 0 < u < 1. A normal one takes `z`, the quantile of u, where that is known.
    #[must_use]
    pub fn quantile(&self, u: f64, z: Option<f64>) -> f64 {
        match self {
            Distribution::Normal { mean, sigma } => {
                mean + sigma * z.unwrap_or_else(|| normal::quantile(u))
            }
            Distribution::TruncatedNormal {
                mean,
                sigma,
                low,
                high,
            } => {
                let inside = truncated(u, [(low - mean) / sigma, (high - mean) / sigma]);
                (mean + sigma * inside).clamp(*low, *high)
            }
            Distribution::Uniform { low, high } => low + u * (high - low),
            Distribution::Triangular { low, mode, high } => {
                let (span, rise) = (high - low, mode - low);
                if u * span < rise {
                    low + (u * span * rise).sqrt()
                } else {
                    high - ((1.0 - u) * span * (high - mode)).sqrt()
                }
            }
            Distribution::Discrete { values, up_to } => {
                let at = up_to.partition_point(|sum| *sum <= u);
                values
                    .get(at)
                    .or(values.last())
                    .copied()
                    .unwrap_or(f64::NAN)
            }
            Distribution::Listed(values) => {
                let at = (u * values.len() as f64) as usize;
                values.get(at).copied().unwrap_or(f64::NAN)
            }
        }
    }
}

/// The standard normal number below which the part `u` of what lies between two ends is. Ends above the mean are mirrored, where the tail has digits.
fn truncated(u: f64, [low, high]: [f64; 2]) -> f64 {
    if low > 0.0 {
        return -truncated(1.0 - u, [-high, -low]);
    }
    let [from, to] = [low, high].map(normal::below);
    normal::quantile(from + u * (to - from))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean and variance by the midpoint rule over the parts.
    fn moments(distribution: &Distribution) -> [f64; 2] {
        let n = 200_000;
        let values =
            || (0..n).map(|k| distribution.quantile((f64::from(k) + 0.5) / f64::from(n), None));
        let mean = values().sum::<f64>() / f64::from(n);
        let square = values().map(|x| (x - mean).powi(2)).sum::<f64>() / f64::from(n);
        [mean, square]
    }

    #[test]
    fn means_and_variances_are_those_of_the_closed_forms() {
        let (a, b, c): (f64, f64, f64) = (-1.0, 0.5, 3.0);
        let cases = [
            (
                Distribution::Normal {
                    mean: 2.0,
                    sigma: 0.5,
                },
                [2.0, 0.25],
            ),
            (
                Distribution::Uniform { low: a, high: c },
                [1.0, 16.0 / 12.0],
            ),
            (
                Distribution::Triangular {
                    low: a,
                    mode: b,
                    high: c,
                },
                [
                    (a + b + c) / 3.0,
                    (a * a + b * b + c * c - a * b - a * c - b * c) / 18.0,
                ],
            ),
            (
                Distribution::Discrete {
                    values: vec![1.0, 4.0],
                    up_to: vec![0.25, 1.0],
                },
                [3.25, 0.25 * 2.25_f64.powi(2) + 0.75 * 0.75_f64.powi(2)],
            ),
            (Distribution::Listed(vec![1.0, 2.0, 6.0]), [3.0, 14.0 / 3.0]),
        ];
        for (distribution, [mean, variance]) in cases {
            let [m, v] = moments(&distribution);
            assert!((m - mean).abs() < 1e-4, "{distribution:?}: {m} for {mean}");
            assert!(
                (v - variance).abs() < 2e-4,
                "{distribution:?}: {v} for {variance}"
            );
        }
    }

    /// Mean of a normal distribution between a and b: μ + σ (φ(a) − φ(b)) / (Φ(b) − Φ(a)).
    #[test]
    fn a_truncated_normal_has_the_mean_of_its_closed_form_also_far_out() {
        let density = |z: f64| (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt();
        for (low, high) in [(-1.0, 2.0), (0.5, 0.7), (6.0, 7.0), (-8.0, -6.5)] {
            let distribution = Distribution::TruncatedNormal {
                mean: 0.0,
                sigma: 1.0,
                low,
                high,
            };
            let [a, b]: [f64; 2] = if low > 0.0 {
                [-high, -low]
            } else {
                [low, high]
            };
            let size = (density(a) - density(b)) / (normal::below(b) - normal::below(a));
            let expected = if low > 0.0 { -size } else { size };
            let [mean, _] = moments(&distribution);
            assert!(
                (mean - expected).abs() < 1e-5,
                "{low} {high}: {mean} for {expected}"
            );
            assert!(distribution.quantile(1e-15, None) >= low);
            assert!(distribution.quantile(1.0 - 1e-15, None) <= high);
        }
    }
}
