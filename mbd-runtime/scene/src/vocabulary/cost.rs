//! What an evaluation costs: operations counted by kind.

use std::ops::Add;

/// Operations of one evaluation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Additions, subtractions and changes of sign.
    pub adds: usize,
    /// Multiplications.
    pub muls: usize,
    /// Divisions.
    pub divs: usize,
    /// Square roots.
    pub sqrts: usize,
    /// Sines, cosines, exponentials and angles.
    pub trigs: usize,
    /// Comparisons, selections, minima, maxima and absolute values.
    pub selects: usize,
}

impl Cost {
    /// All operations.
    #[must_use]
    pub const fn total(&self) -> usize {
        self.adds + self.muls + self.divs + self.sqrts + self.trigs + self.selects
    }
}

impl Add for Cost {
    type Output = Cost;
    fn add(self, other: Cost) -> Cost {
        Cost {
            adds: self.adds + other.adds,
            muls: self.muls + other.muls,
            divs: self.divs + other.divs,
            sqrts: self.sqrts + other.sqrts,
            trigs: self.trigs + other.trigs,
            selects: self.selects + other.selects,
        }
    }
}

impl std::fmt::Display for Cost {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{} operations ({} additions, {} multiplications, {} divisions, {} roots, {} trigonometric, {} selections)",
            self.total(),
            self.adds,
            self.muls,
            self.divs,
            self.sqrts,
            self.trigs,
            self.selects
        )
    }
}
