//! Fields of a joint: how a joint asks its reader for them, and what their numbers must obey.

use crate::vocabulary::coupling::Coupled;
use crate::{Axis, Dimension, Formula};

/// A number among the fields of a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Field {
    /// The keyword of the field.
    pub name: &'static str,
    /// What it measures.
    pub dimension: Dimension,
    /// What it must obey.
    pub rule: Rule,
}

/// What a number must obey.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// Finite.
    Finite,
    /// Zero or above.
    NotNegative,
    /// Above zero.
    Positive,
    /// Not zero, either sign.
    NotZero,
    /// Strictly between 0 and π.
    OpenHalfTurn,
}

impl Rule {
    /// Whether a value obeys it.
    #[must_use]
    pub fn holds(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Rule::Finite => true,
                Rule::NotNegative => value >= 0.0,
                Rule::Positive => value > 0.0,
                Rule::NotZero => value != 0.0,
                Rule::OpenHalfTurn => value > 0.0 && value < std::f64::consts::PI,
            }
    }

    /// The rule in words, to follow "it must be".
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Rule::Finite => "finite",
            Rule::NotNegative => "zero or positive",
            Rule::Positive => "positive",
            Rule::NotZero => "finite and not zero",
            Rule::OpenHalfTurn => "between 0 and 180 degrees, both excluded",
        }
    }
}

/// Whoever reads a declaration hands a joint its fields through this. It reports what is missing or wrong itself and answers with
/// something usable, so that one reading reports every mistake.
pub trait Fields {
    /// A direction in joint axes; `default` if it is not given.
    fn axis(&mut self, name: &'static str, default: Axis) -> Axis;
    /// Two directions, the first fixed in the parent, the second in the child; `default` if not given. With `perpendicular` any other
    /// angle between them is a mistake of the declaration.
    fn axes(&mut self, name: &'static str, default: [Axis; 2], perpendicular: bool) -> [Axis; 2];
    /// A number that must be given.
    fn number(&mut self, field: &'static Field) -> Formula;
    /// The coordinates of other joints that a coupling relates: the one given at `to`, then the one at `from`.
    fn coordinates(&mut self) -> [(usize, usize); 2];
    /// A number of a coupling, which measures what these coordinates say; a field without a dimension of its own.
    fn coupled(&mut self, field: &'static Field, measures: Coupled) -> Formula;
}
