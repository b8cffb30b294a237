//! Numbers that vary together: standard normal numbers with a correlation matrix R = L Lᵀ are y = L z of independent z (Gaussian copula). Numbers
//! that are normally distributed then have the correlations R; others have the rank correlations 6/π asin(R/2).

use mbd_runtime::scene::twelve_digits;

use crate::run::names::{PlanError, wrong};
use crate::sampling::normal;

/// A number of which the ones before leave less than this, as a part of its standard deviation, is decided by them.
const DECIDED: f64 = 1e-7;
/// A correlation that is off by less than this is that of the digits of the matrix.
const ROUNDING: f64 = 1e-6;

/// Dispersed numbers that vary together.
#[derive(Clone, Debug, PartialEq)]
pub struct Correlation {
    /// Which, by index.
    pub members: Vec<usize>,
    /// The rows of L.
    rows: Vec<Vec<f64>>,
}

impl Correlation {
    /// Of some numbers with a matrix.
    ///
    /// # Errors
    /// A matrix that no numbers have.
    pub fn new(setting: &str, members: Vec<usize>, matrix: &[Vec<f64>]) -> Result<Self, PlanError> {
        let n = members.len();
        if matrix.len() != n || matrix.iter().any(|row| row.len() != n) {
            return Err(wrong(
                setting,
                format!("the matrix needs {n} rows of {n} numbers"),
            ));
        }
        for (i, row) in matrix.iter().enumerate() {
            for (j, value) in row.iter().enumerate() {
                let expected = if i == j { 1.0 } else { matrix[j][i] };
                if *value != expected || !(-1.0..=1.0).contains(value) {
                    let text = "a correlation matrix is symmetric, has ones on its diagonal and numbers from -1 to 1 beside it";
                    return Err(wrong(setting, text));
                }
            }
        }
        let mut rows: Vec<Vec<f64>> = vec![vec![0.0; n]; n];
        for i in 0..n {
            for j in 0..=i {
                let known: f64 = (0..j).map(|k| rows[i][k] * rows[j][k]).sum();
                let rest = matrix[i][j] - known;
                // What the numbers before decide has nothing of its own: rounding, or a correlation that no number has which follows them so closely.
                let decided = rows[j][j] <= DECIDED;
                let is_none = match i == j {
                    true => rest < -1e-12,
                    false => decided && rest.abs() > ROUNDING,
                };
                if is_none {
                    let text = "no numbers have these correlations with each other: the matrix is not positive definite";
                    return Err(wrong(setting, text));
                }
                rows[i][j] = match i == j {
                    true => rest.max(0.0).sqrt(),
                    false if decided => 0.0,
                    false => rest / rows[j][j],
                };
            }
        }
        Ok(Correlation { members, rows })
    }

    /// Every two of them that have a correlation, and which.
    pub fn pairs(&self) -> impl Iterator<Item = ([usize; 2], f64)> + '_ {
        let members = self.members.iter().zip(&self.rows).enumerate();
        members.flat_map(move |(at, (member, row))| {
            let before = self.members.iter().zip(&self.rows).take(at);
            before.filter_map(move |(other, of)| {
                let r: f64 = row.iter().zip(of).map(|(a, b)| a * b).sum();
                // R = L Lᵀ but for rounding.
                let r = twelve_digits(r);
                (r.abs() > 1e-12).then_some(([*other, *member], r))
            })
        })
    }

    /// Replaces independent numbers in (0, 1) by correlated ones, and notes their normal quantiles.
    pub fn mix(&self, parts: &mut [f64], quantiles: &mut [Option<f64>]) {
        let independent: Vec<f64> = self
            .members
            .iter()
            .map(|at| normal::quantile(parts[*at]))
            .collect();
        for (at, row) in self.members.iter().zip(&self.rows) {
            let y: f64 = row.iter().zip(&independent).map(|(l, z)| l * z).sum();
            parts[*at] = normal::below(y);
            quantiles[*at] = Some(y);
        }
    }
}
