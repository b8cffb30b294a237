//! A function of time at an instant: value, rate and second derivative. How a prescribed motion becomes velocity and acceleration.
//!
//! The derivatives are those of nested dual numbers of time, so the law of formulas runs on them unchanged, and on symbols they record both.

use nalgebra::Vector3;

use crate::{Dual, Real};

/// A function of time at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet<S> {
    /// The value.
    pub value: S,
    /// Its first derivative [1/s].
    pub rate: S,
    /// Its second derivative [1/s²].
    pub curve: S,
}

/// A number that knows its first two derivatives by time.
pub type OfTime<S> = Dual<Dual<S, 1>, 1>;

impl<S: Real> Jet<S> {
    /// A number that stays.
    #[must_use]
    pub fn constant(value: S) -> Self {
        OfTime::still(value).into()
    }
}

impl<S: Real> OfTime<S> {
    /// A number that stays.
    #[must_use]
    pub fn still(value: S) -> Self {
        Dual::constant(Dual::constant(value))
    }

    /// Time itself.
    #[must_use]
    pub fn time(value: S) -> Self {
        Dual::variable(Dual::variable(value, 0), 0)
    }
}

impl<S: Real> From<OfTime<S>> for Jet<S> {
    fn from(Dual { value, slopes }: OfTime<S>) -> Self {
        let (
            [rate],
            [
                Dual {
                    slopes: [curve], ..
                },
            ],
        ) = (value.slopes, slopes);
        Jet {
            value: value.value,
            rate,
            curve,
        }
    }
}

/// Values, rates and second derivatives of three functions of time.
#[must_use]
pub fn split<S: Real>(functions: &Vector3<OfTime<S>>) -> [Vector3<S>; 3] {
    let jets: [Jet<S>; 3] = std::array::from_fn(|i| functions[i].into());
    [
        Vector3::from_fn(|i, _| jets[i].value),
        Vector3::from_fn(|i, _| jets[i].rate),
        Vector3::from_fn(|i, _| jets[i].curve),
    ]
}

#[cfg(test)]
mod tests {
    use super::{Jet, OfTime};
    use crate::Real;

    /// A function of time through every operation of [`Real`].
    fn course<S: Real>(t: S) -> S {
        let number = S::from_f64;
        let (sin, cos) = (number(2.0) * t).sin_cos();
        let root = (number(3.0) + sin * t).sqrt();
        let decay = (-(t / number(1.7))).exp();
        let angle = (sin - number(0.2)).atan2(cos + root);
        let larger = (sin * decay).max(cos).min(number(5.0) * t);
        let chosen = S::select(number(0.5).lt(t), (cos - t).abs(), root);
        let bounded = (number(2.0) + t).ln().tanh();
        (root * angle + larger / (number(2.0) + decay)) * chosen - (-t) * larger * bounded
    }

    #[test]
    fn both_derivatives_are_those_of_finite_differences() {
        for t in [0.2_f64, 0.8, 1.9, 3.1] {
            let (h, jet) = (1e-4, Jet::from(course(OfTime::time(t))));
            let [a, b, c] = [course(t - h), course(t), course(t + h)];
            assert_eq!(jet.value.to_bits(), b.to_bits());
            assert!((jet.rate - (c - a) / (2.0 * h)).abs() < 1e-6);
            assert!((jet.curve - (c - 2.0 * b + a) / (h * h)).abs() < 1e-5);
        }
    }

    #[test]
    fn a_root_that_touches_zero_stays_finite() {
        let root = (OfTime::time(0.0_f64) * OfTime::time(0.0)).sqrt();
        assert!(root.is_finite_all(), "{root:?}");
    }
}
