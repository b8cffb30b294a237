//! A quantity inside a part of a step: the polynomial through its values at n + 1 Chebyshev points, n = 1, 2, 4 or 8, or a constant. The points of
//! each are among those of the next.
//!
//!   p(s) = Σ c_k T_k(s),  −1 ≤ s ≤ 1,   values at s_j = −cos(π j / n)                                     (1)
//!   c_k = (2/n) Σ″ p(s_j) cos(π (n − j) k / n), the first and the last term of Σ″ halved, c_0 and c_n too   (2)
//!
//! The last two coefficients are about what a polynomial of two degrees less is off by; where the coefficients fall like powers, this one is off by
//! as much less as the last two are less than the two before. Source: Trefethen, Approximation Theory and Approximation Practice, chapters 3, 4 and 8.

/// The most values of a polynomial.
pub(super) const POINTS: usize = 9;
/// The degree of that polynomial.
pub(super) const DEGREE: usize = POINTS - 1;
/// Places among which the sign of the slope is looked at, for each degree.
const PLACES: usize = 4;
/// The least part of its last coefficients that a polynomial is taken to be off by, however fast they fall.
const LEAST_PART: f64 = 0.01;
/// cos(π j / 8) for j = 0 … 15.
const COSINES: [f64; 2 * DEGREE] = {
    let [a, b, c] = [
        0.923_879_532_511_286_7,
        std::f64::consts::FRAC_1_SQRT_2,
        0.382_683_432_365_089_8,
    ];
    [
        1.0, a, b, c, 0.0, -c, -b, -a, -1.0, -a, -b, -c, 0.0, c, b, a,
    ]
};
/// Places and weights of the quadrature of Gauss on −1 … 1 that is exact up to degree 17, so for the square of (1).
const GAUSS: [[f64; 2]; 9] = [
    [-0.968_160_239_507_626_1, 0.081_274_388_361_574_41],
    [-0.836_031_107_326_635_8, 0.180_648_160_694_857_4],
    [-0.613_371_432_700_590_4, 0.260_610_696_402_935_5],
    [-0.324_253_423_403_808_9, 0.312_347_077_040_002_84],
    [0.0, 0.330_239_355_001_259_8],
    [0.324_253_423_403_808_9, 0.312_347_077_040_002_84],
    [0.613_371_432_700_590_4, 0.260_610_696_402_935_5],
    [0.836_031_107_326_635_8, 0.180_648_160_694_857_4],
    [0.968_160_239_507_626_1, 0.081_274_388_361_574_41],
];

/// The polynomial (1).
#[derive(Clone, Copy, Debug)]
pub(super) struct Polynomial {
    coefficients: [f64; POINTS],
    /// How many of them there are; the rest are zero.
    count: usize,
}

impl Polynomial {
    /// Where the values of a polynomial with the most are, as parts of its interval, 0 … 1, rising.
    pub(super) fn places() -> [f64; POINTS] {
        std::array::from_fn(|j| 0.5 * (1.0 - COSINES[j]))
    }

    /// How far apart the points of a polynomial with so many values are among the most.
    pub(super) const fn stride(count: usize) -> usize {
        match count {
            0 | 1 => DEGREE,
            count => DEGREE / (count - 1),
        }
    }

    /// The places of its values on −1 … 1.
    pub(super) fn points(&self) -> impl Iterator<Item = f64> + use<> {
        let count = self.count;
        let stride = Self::stride(count);
        (0..count).map(move |j| -COSINES[j * stride])
    }

    /// That which has this value everywhere.
    pub(super) fn constant(value: f64) -> Self {
        let mut coefficients = [0.0; POINTS];
        coefficients[0] = value;
        Polynomial {
            coefficients,
            count: 1,
        }
    }

    /// That through so many values, 2, 3, 5 or 9, one after the other.
    pub(super) fn through(count: usize, value: impl Fn(usize) -> f64) -> Self {
        let mut coefficients = [0.0; POINTS];
        let (stride, degree) = (Self::stride(count), count - 1);
        for j in 0..count {
            let end = j == 0 || j == degree;
            let value = if end { 0.5 * value(j) } else { value(j) };
            for (k, coefficient) in coefficients.iter_mut().take(count).enumerate() {
                *coefficient += value * COSINES[stride * (degree - j) * k % COSINES.len()];
            }
        }
        let factor = 2.0 / degree as f64;
        let all = coefficients.iter_mut().take(count).enumerate();
        for (k, coefficient) in all {
            *coefficient *= if k == 0 || k == degree {
                0.5 * factor
            } else {
                factor
            };
        }
        Polynomial {
            coefficients,
            count,
        }
    }

    /// The sizes of its last two coefficients together; not finite where a value is not.
    pub(super) fn tail(&self) -> f64 {
        self.sizes(0)
    }

    /// What it is off by, about.
    pub(super) fn error(&self) -> f64 {
        let [tail, before] = [self.sizes(0), self.sizes(2)];
        if tail < before {
            tail * (tail / before).max(LEAST_PART)
        } else {
            tail
        }
    }

    /// The sizes of two coefficients together, so many before the last.
    fn sizes(&self, before: usize) -> f64 {
        let known = self.coefficients.iter().take(self.count).rev();
        known.skip(before).take(2).map(|x| x.abs()).sum()
    }

    /// Between what its values are, with several times what it may be off by.
    pub(super) fn bounds(&self) -> [f64; 2] {
        let [middle, rest @ ..] = self.coefficients;
        let half = rest.iter().map(|x| x.abs()).sum::<f64>() + 4.0 * self.tail();
        [middle - half, middle + half]
    }

    /// Its value at −1 … 1.
    pub(super) fn at(&self, s: f64) -> f64 {
        sum(self.coefficients.get(..self.count).unwrap_or_default(), s)
    }

    /// ∫ of a function of its value, of at most twice its degree, over a part of −1 … 1.
    pub(super) fn integral(&self, [low, high]: [f64; 2], of: impl Fn(f64) -> f64) -> f64 {
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        let terms = GAUSS
            .iter()
            .map(|[s, weight]| weight * of(self.at(middle + half * s)));
        half * terms.sum::<f64>()
    }

    /// Calls with a part of −1 … 1 cut where its slope changes sign, piece by piece, rising: within one it rises or falls.
    pub(super) fn monotone(&self, [low, high]: [f64; 2], mut part: impl FnMut([f64; 2])) {
        let slope = self.slope();
        let [middle, rest @ ..] = &slope;
        let slope = slope
            .get(..self.count.saturating_sub(1))
            .unwrap_or_default();
        if middle.abs() >= rest.iter().map(|x| x.abs()).sum() {
            return part([low, high]);
        }
        let mut start = low;
        let mut before = (low, sum(slope, low));
        let places = PLACES * self.count;
        for place in 1..=places {
            let s = low + (high - low) * place as f64 / places as f64;
            let now = (s, sum(slope, s));
            if (before.1 < 0.0) != (now.1 < 0.0) {
                let turn = cut([before.0, now.0], |s| sum(slope, s));
                part([start, turn]);
                start = turn;
            }
            before = now;
        }
        part([start, high]);
    }

    /// Where it passes a level between two places on the two sides of it.
    pub(super) fn passes(&self, level: f64, ends: [f64; 2]) -> f64 {
        cut(ends, |s| level - self.at(s))
    }

    /// The coefficients of its slope.
    fn slope(&self) -> [f64; POINTS] {
        let mut slope = [0.0; POINTS];
        for k in (1..POINTS).rev() {
            let above = if k + 1 < POINTS { slope[k + 1] } else { 0.0 };
            slope[k - 1] = above + 2.0 * k as f64 * self.coefficients[k];
        }
        slope[0] *= 0.5;
        slope
    }
}

/// Σ c_k T_k(s), by the recurrence of Clenshaw.
fn sum(coefficients: &[f64], s: f64) -> f64 {
    let [first, rest @ ..] = coefficients else {
        return 0.0;
    };
    let [mut last, mut before] = [0.0; 2];
    for coefficient in rest.iter().rev() {
        (last, before) = (coefficient + 2.0 * s * last - before, last);
    }
    first + s * last - before
}

/// Where a function becomes negative, or ceases to be, between two places at which it differs in that: the bracket is closed from both sides by false
/// position, by no more trials than halves would take and one. Source: Oliveira and Takahashi, An enhancement of the bisection method average
/// performance preserving minmax optimality (2020).
fn cut([mut low, mut high]: [f64; 2], value: impl Fn(f64) -> f64) -> f64 {
    let [mut at_low, mut at_high] = [low, high].map(&value);
    let was = at_low < 0.0;
    let first = high - low;
    let halves = (first / f64::EPSILON).log2().ceil().max(0.0) + 1.0;
    let mut room = 0.5 * f64::EPSILON * halves.exp2();
    while high - low > f64::EPSILON {
        let (width, middle) = (high - low, 0.5 * (low + high));
        let straight = (at_high * low - at_low * high) / (at_high - at_low);
        let to_middle = middle - straight;
        // Beyond what is straight by more than its error, so that the other end moves next.
        let shift = 0.2 / first * width * width;
        let nearer = match shift <= to_middle.abs() {
            true => straight + shift.copysign(to_middle),
            false => middle,
        };
        let radius = room - 0.5 * width;
        let trial = match (nearer - middle).abs() <= radius {
            true => nearer,
            false => middle - radius.copysign(to_middle),
        };
        // Also where it is an end but for rounding.
        let trial = trial.clamp(low + 0.5 * f64::EPSILON, high - 0.5 * f64::EPSILON);
        let now = value(trial);
        match (now < 0.0) == was {
            true => (low, at_low) = (trial, now),
            false => (high, at_high) = (trial, now),
        }
        room *= 0.5;
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 3 − s + 2 s² − s⁷ + s⁸ / 2.
    fn wave(s: f64) -> f64 {
        3.0 - s + 2.0 * s * s - s.powi(7) + 0.5 * s.powi(8)
    }

    fn through(count: usize, function: impl Fn(f64) -> f64) -> Polynomial {
        let places = Polynomial::places();
        let stride = Polynomial::stride(count);
        Polynomial::through(count, |j| function(2.0 * places[j * stride] - 1.0))
    }

    fn of(function: impl Fn(f64) -> f64) -> Polynomial {
        through(POINTS, function)
    }

    #[test]
    fn values_integrals_and_integrals_of_the_square_of_a_polynomial_are_exact() {
        let found = of(wave);
        for s in [-1.0, -0.9, -0.3, 0.0, 0.2, 0.77, 1.0] {
            assert!((found.at(s) - wave(s)).abs() < 1e-14, "{s}");
        }
        let exact = 2.0 * (3.0 + 2.0 / 3.0 + 0.5 / 9.0);
        assert!((found.integral([-1.0, 1.0], |x| x) - exact).abs() < 1e-14);
        // ∫ over −1 … 1 of (s⁸)² = 2/17.
        let square = of(|s| s.powi(8)).integral([-1.0, 1.0], |x| x * x);
        assert!((square - 2.0 / 17.0).abs() < 1e-15, "{square}");
    }

    #[test]
    fn a_polynomial_is_cut_where_it_turns_and_passes_a_level_once_between() {
        // 8 s⁴ − 8 s² + 1 turns at 0 and ±1/√2.
        let found = of(|s| 8.0 * s.powi(4) - 8.0 * s * s + 1.0);
        let mut turns = Vec::new();
        found.monotone([-1.0, 1.0], |[_, end]| turns.push(end));
        let expected = [-0.5_f64.sqrt(), 0.0, 0.5_f64.sqrt(), 1.0];
        assert_eq!(turns.len(), 4);
        for (turn, exact) in turns.iter().zip(expected) {
            assert!((turn - exact).abs() < 1e-14, "{turn} {exact}");
        }
        let zero = found.passes(0.0, [-0.5_f64.sqrt(), 0.0]);
        assert!(
            (zero + (std::f64::consts::PI / 8.0).sin()).abs() < 1e-14,
            "{zero}"
        );
    }

    #[test]
    fn the_tail_is_nothing_of_a_polynomial_and_large_at_a_corner() {
        assert!(of(|s| s.powi(6) - s).tail() < 1e-15);
        assert!(of(|s| (s - 0.1).abs()).tail() > 1e-3);
    }
}
