//! Tables of numbers.

use serde::{Deserialize, Serialize};

use crate::Unit;

/// A table of one or two arguments: straight or smooth between its entries, constant beyond them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// Name, used as a function of its arguments.
    pub name: String,
    /// Documentation.
    pub doc: String,
    /// First argument [SI], strictly increasing.
    pub x: Vec<f64>,
    /// Values [SI]: one for each of `x`; with a second argument the values at `x[0]` first, then those at `x[1]` and so on.
    pub y: Vec<f64>,
    /// Unit of the first argument.
    pub x_unit: Unit,
    /// Unit of the value.
    pub y_unit: Unit,
    /// The second argument, if it has one.
    pub second: Option<SecondArgument>,
    /// Whether its slope is continuous.
    pub smooth: bool,
}

/// The second argument of a table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SecondArgument {
    /// Its numbers [SI], strictly increasing.
    pub z: Vec<f64>,
    /// Its unit.
    pub unit: Unit,
}

impl Table {
    /// How many arguments it takes.
    #[must_use]
    pub fn arguments(&self) -> usize {
        1 + usize::from(self.second.is_some())
    }

    /// Units of the arguments.
    pub fn argument_units(&self) -> impl Iterator<Item = &Unit> {
        let second = self.second.iter().map(|second| &second.unit);
        std::iter::once(&self.x_unit).chain(second)
    }

    /// The value at entry `i` of the first argument and `j` of the second (0 without one); NaN beyond the entries.
    #[must_use]
    pub fn entry(&self, i: usize, j: usize) -> f64 {
        let width = self.second.as_ref().map_or(1, |second| second.z.len());
        self.y.get(i * width + j).copied().unwrap_or(f64::NAN)
    }
}
