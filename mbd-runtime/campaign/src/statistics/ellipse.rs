//! Pairs of numbers in a plane: mean, covariance, and the ellipses that hold a part of them if they are normal.
//!
//! Of a bivariate normal distribution with mean m and covariance S the part 1 − exp(−k²/2) lies inside (x − m)ᵀ S⁻¹ (x − m) ≤ k²: the square is
//! chi-square distributed with two degrees of freedom. So the ellipse of a part p has the half axes k √λ along the eigenvectors of S, k² = −2 ln(1 − p).

/// Mean and covariance of pairs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// The mean.
    pub mean: [f64; 2],
    /// Variances of both, and their covariance: xx, yy, xy.
    pub covariance: [f64; 3],
}

/// The ellipse that holds a part of pairs, if they are normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipse {
    /// The part, 0 … 1.
    pub part: f64,
    /// Half axes, the longer first.
    pub half_axes: [f64; 2],
    /// The direction of the longer one from x towards y [rad], −π/2 … π/2.
    pub direction: f64,
    /// How many of the pairs lie inside.
    pub inside: u64,
}

impl Spot {
    /// Of some pairs; `None` of fewer than three, and where they lie on a line: no ellipse holds a part of them.
    #[must_use]
    pub fn of(pairs: &[[f64; 2]]) -> Option<Self> {
        let n = pairs.len() as f64;
        if pairs.len() < 3 {
            return None;
        }
        let mean = [0, 1].map(|k| pairs.iter().map(|pair| pair[k]).sum::<f64>() / n);
        let product = |i: usize, j: usize| {
            let sum: f64 = pairs
                .iter()
                .map(|x| (x[i] - mean[i]) * (x[j] - mean[j]))
                .sum();
            sum / (n - 1.0)
        };
        let covariance = [product(0, 0), product(1, 1), product(0, 1)];
        let [xx, yy, xy] = covariance;
        // A correlation of ±1 up to rounding.
        let spread = xx * yy * (1.0 - 1e-12);
        (xx > 0.0 && yy > 0.0 && xy * xy < spread).then_some(Spot { mean, covariance })
    }

    /// The square of the distance of a pair from the mean, in standard deviations: (x − m)ᵀ S⁻¹ (x − m).
    #[must_use]
    pub fn distance(&self, pair: [f64; 2]) -> f64 {
        let [dx, dy] = [0, 1].map(|k| pair[k] - self.mean[k]);
        let [xx, yy, xy] = self.covariance;
        (yy * dx * dx - 2.0 * xy * dx * dy + xx * dy * dy) / (xx * yy - xy * xy)
    }

    /// The ellipse of a part, with the number of pairs inside.
    #[must_use]
    pub fn ellipse(&self, part: f64, pairs: &[[f64; 2]]) -> Ellipse {
        let square = -2.0 * (-part).ln_1p();
        let [xx, yy, xy] = self.covariance;
        let (middle, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        let radius = half.hypot(xy);
        // The product of both is the determinant: no digits are lost in a thin ellipse.
        let long = middle + radius;
        let short = (xx * yy - xy * xy) / long;
        let inside = pairs.iter().filter(|pair| self.distance(**pair) <= square);
        Ellipse {
            part,
            half_axes: [long, short].map(|eigenvalue| (square * eigenvalue).sqrt()),
            direction: 0.5 * xy.atan2(half),
            inside: inside.count() as u64,
        }
    }
}

impl Ellipse {
    /// Places on it, around once.
    #[must_use]
    pub fn places(&self, mean: [f64; 2], count: usize) -> Vec<[f64; 2]> {
        let (sin, cos) = self.direction.sin_cos();
        let [a, b] = self.half_axes;
        let place = |k: usize| {
            let angle = k as f64 / count as f64 * std::f64::consts::TAU;
            let (across, along) = (b * angle.sin(), a * angle.cos());
            [
                mean[0] + along * cos - across * sin,
                mean[1] + along * sin + across * cos,
            ]
        };
        (0..=count).map(place).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Draws, normal};

    /// Pairs with standard deviations 3 and 1 and the correlation 0.6, about (10, −2).
    fn pairs(count: u64) -> Vec<[f64; 2]> {
        let [a, b] = ["a", "b"].map(|name| Draws::new(1, name));
        let pair = |case| {
            let [u, v] = [a, b].map(|draws| normal::quantile(draws.uniform(case, 0)));
            [10.0 + 3.0 * u, -2.0 + 0.6 * u + 0.8 * v]
        };
        (1..=count).map(pair).collect()
    }

    /// Closed forms of a bivariate normal distribution: S = [9 1.8; 1.8 1], eigenvalues 5 ± √(16 + 1.8²), direction ½ atan(3.6/8); the parts
    /// 1 − exp(−k²/2) inside. Four standard errors each.
    #[test]
    fn ellipses_of_normal_pairs_are_those_of_the_closed_form() {
        let pairs = pairs(20_000);
        let n = pairs.len() as f64;
        let spot = Spot::of(&pairs).expect("a spread");
        let near = |found: f64, expected: f64, error: f64| {
            assert!(
                (found - expected).abs() < 4.0 * error,
                "{found} for {expected}"
            );
        };
        near(spot.mean[0], 10.0, 3.0 / n.sqrt());
        near(spot.mean[1], -2.0, 1.0 / n.sqrt());
        near(spot.covariance[0], 9.0, 9.0 * (2.0 / n).sqrt());
        near(spot.covariance[1], 1.0, (2.0 / n).sqrt());
        near(spot.covariance[2], 1.8, ((9.0 + 1.8 * 1.8) / n).sqrt());
        let root = (16.0 + 1.8_f64 * 1.8).sqrt();
        for k in [1.0_f64, 2.0, 3.0] {
            let part = 1.0 - (-0.5 * k * k).exp();
            let ellipse = spot.ellipse(part, &pairs);
            let [long, short] = ellipse.half_axes.map(|axis| axis / k);
            near(
                long,
                (5.0 + root).sqrt(),
                (5.0 + root).sqrt() / (2.0 * n).sqrt(),
            );
            near(
                short,
                (5.0 - root).sqrt(),
                (5.0 - root).sqrt() / (2.0 * n).sqrt(),
            );
            near(
                ellipse.direction,
                0.5 * (3.6_f64 / 8.0).atan(),
                1.0 / n.sqrt(),
            );
            near(
                ellipse.inside as f64 / n,
                part,
                (part * (1.0 - part) / n).sqrt(),
            );
            for place in ellipse.places(spot.mean, 12) {
                assert!((spot.distance(place) / (k * k) - 1.0).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn an_ellipse_stands_upright_where_the_spread_does() {
        let pairs = [[0.0, 3.0], [0.0, -3.0], [1.0, 0.0], [-1.0, 0.0]];
        let ellipse = Spot::of(&pairs).expect("a spread").ellipse(0.5, &pairs);
        assert!((ellipse.direction - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        assert!((ellipse.half_axes[0] / ellipse.half_axes[1] - 3.0).abs() < 1e-12);
    }

    #[test]
    fn pairs_on_a_line_have_no_ellipse() {
        let line: Vec<[f64; 2]> = (0..9).map(|k| [f64::from(k), 0.3 * f64::from(k)]).collect();
        assert_eq!(Spot::of(&line), None);
        assert_eq!(Spot::of(&[[1.0, 2.0]; 9]), None);
        assert_eq!(Spot::of(&[[0.0, 0.0], [1.0, 2.0]]), None);
    }
}
