//! Tables of numbers.

use serde::{Deserialize, Serialize};

use crate::Unit;

/// A table: `y` over strictly increasing `x`, linear between rows, constant beyond them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// Name, used as a function of one argument.
    pub name: String,
    /// Documentation.
    pub doc: String,
    /// Arguments [SI].
    pub x: Vec<f64>,
    /// Values [SI].
    pub y: Vec<f64>,
    /// Unit of the argument.
    pub x_unit: Unit,
    /// Unit of the value.
    pub y_unit: Unit,
}
