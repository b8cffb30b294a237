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

    /// Why it is no table, and which number shows it: the first fault.
    ///
    /// # Errors
    /// The number, `x[2]` or `y`, and what it must be.
    pub fn check(&self) -> Result<(), (String, &'static str)> {
        let second = self.second.as_ref().map(|second| ("z", &second.z));
        let mut length = 1;
        for (name, arguments) in [("x", &self.x)].into_iter().chain(second) {
            if arguments.is_empty() {
                return Err((name.to_owned(), "a list of one number at least"));
            }
            let increases = |k: usize| k == 0 || arguments[k - 1] < arguments[k];
            let mut all = 0..arguments.len();
            if let Some(k) = all.find(|&k| !(arguments[k].is_finite() && increases(k))) {
                return Err((
                    format!("{name}[{k}]"),
                    "finite and more than the one before it",
                ));
            }
            length *= arguments.len();
        }
        if self.y.len() != length {
            return Err(("y".to_owned(), "a list of one value for every argument"));
        }
        match self.y.iter().position(|value| !value.is_finite()) {
            Some(k) => Err((format!("y[{k}]"), "finite")),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_table_is_told_by_the_number_that_shows_it() {
        let table = |x: &[f64], y: &[f64], z: Option<&[f64]>| Table {
            name: "wind".to_owned(),
            doc: String::new(),
            x: x.to_vec(),
            y: y.to_vec(),
            x_unit: Unit::default(),
            y_unit: Unit::default(),
            second: z.map(|z| SecondArgument {
                z: z.to_vec(),
                unit: Unit::default(),
            }),
            smooth: false,
        };
        let what = |table: Table| table.check().err().map(|(what, _)| what);
        assert_eq!(what(table(&[0.0, 1.0], &[2.0, 3.0], None)), None);
        assert_eq!(what(table(&[0.0], &[2.0, 3.0], Some(&[1.0, 2.0]))), None);
        for (x, y, z, named) in [
            (&[0.0, 0.0][..], &[2.0, 3.0][..], None, "x[1]"),
            (&[0.0, -1.0], &[2.0, 3.0], None, "x[1]"),
            (&[0.0, f64::INFINITY], &[2.0, 3.0], None, "x[1]"),
            (&[f64::NAN], &[2.0], None, "x[0]"),
            (&[], &[], None, "x"),
            (&[0.0, 1.0], &[2.0], None, "y"),
            (&[0.0, 1.0], &[2.0, f64::NAN], None, "y[1]"),
            (&[0.0], &[2.0, 3.0], Some(&[1.0, 1.0][..]), "z[1]"),
            (&[0.0], &[2.0], Some(&[1.0, 2.0]), "y"),
            (&[0.0], &[], Some(&[]), "z"),
        ] {
            assert_eq!(what(table(x, y, z)).as_deref(), Some(named));
        }
    }
}
