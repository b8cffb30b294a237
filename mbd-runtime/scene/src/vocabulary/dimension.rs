//! Units and dimensions.

use serde::{Deserialize, Serialize};

/// A unit as written, with its meaning in SI.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Unit {
    /// The text of the unit, `kN/m`; empty for a pure number.
    pub text: String,
    /// SI value of one such unit.
    pub factor: f64,
    /// What it measures.
    pub dimension: Dimension,
}

/// Numbers that are told with all their digits; others have an exponent.
const SMALLEST: f64 = 1e-9;
const LARGEST: f64 = 1e15;

impl Unit {
    /// A number [SI] in this unit, as it is told.
    #[must_use]
    pub fn told(&self, value: f64) -> String {
        let number = twelve_digits(value / self.factor);
        // Not hundreds of zeros.
        let number = match number == 0.0 || (SMALLEST..LARGEST).contains(&number.abs()) {
            true => format!("{number}"),
            false => format!("{number:e}"),
        };
        format!("{number} {}", self.text).trim_end().to_owned()
    }
}

/// A number without the digits that a conversion of units or a located time leaves behind the twelfth.
#[must_use]
pub fn twelve_digits(value: f64) -> f64 {
    format!("{value:.11e}").parse().unwrap_or(value)
}

/// Exponents of mass, length, time and electric current, **doubled** so that square roots stay whole.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Dimension {
    /// Twice the exponent of mass.
    pub mass: i8,
    /// Twice the exponent of length.
    pub length: i8,
    /// Twice the exponent of time.
    pub time: i8,
    /// Twice the exponent of electric current.
    pub current: i8,
}

/// A pure number or an angle [rad].
pub const ANGLE: Dimension = Dimension {
    mass: 0,
    length: 0,
    time: 0,
    current: 0,
};

/// A dimension of length [m].
pub const LENGTH: Dimension = Dimension {
    mass: 0,
    length: 2,
    time: 0,
    current: 0,
};

#[cfg(test)]
mod tests {
    use super::Unit;

    #[test]
    fn a_number_is_told_with_its_digits_or_with_an_exponent_and_not_with_hundreds_of_zeros() {
        let unit = Unit {
            text: "kN".into(),
            factor: 1e3,
            ..Unit::default()
        };
        for (value, told) in [
            (1e308, "1e305 kN"),
            (-2.5e-300, "-2.5e-303 kN"),
            (f64::INFINITY, "inf kN"),
            (0.0, "0 kN"),
            (1234.5, "1.2345 kN"),
            (1e15, "1000000000000 kN"),
            (2e-4, "0.0000002 kN"),
        ] {
            assert_eq!(unit.told(value), told);
        }
    }
}
