//! Directions of the speeds that are held or chosen, orthonormal in the metric of the mass matrix (Gram and Schmidt, twice against rounding).
//!
//! ```text
//! M = L Lᵀ,   a row r of speeds stands as L⁻¹ rᵀ,   δv = L⁻ᵀ u                                                       (1)
//! ```

use nalgebra::{DMatrix, DVector};

/// Part of a row of a joint below which it repeats others.
const REPEATS: f64 = 1e-9;

/// Directions that are held or chosen.
pub(crate) struct Basis {
    /// L of M = L Lᵀ, inverted.
    scale: DMatrix<f64>,
    directions: Vec<DVector<f64>>,
    /// How many of them the joints hold.
    held: usize,
    /// The largest part that a row which was passed over had left.
    pub passed: f64,
}

impl Basis {
    /// Of a mass matrix, row by row.
    pub(crate) fn new(mass: &[f64], speeds: usize) -> Self {
        let mass = DMatrix::from_row_slice(speeds, speeds, mass);
        let scale = mass.cholesky().and_then(|factor| factor.l().try_inverse());
        Basis {
            scale: scale.unwrap_or_else(|| DMatrix::identity(speeds, speeds)),
            directions: Vec::new(),
            held: 0,
            passed: 0.0,
        }
    }

    /// What is new in a row beside the first directions, and its part of the row.
    fn new_in(&self, row: &DVector<f64>, count: usize) -> (DVector<f64>, f64) {
        let whole = row.norm();
        let mut left = row.clone();
        for _ in 0..2 {
            for direction in &self.directions[..count] {
                let along = direction.dot(&left);
                left.axpy(-along, direction, 1.0);
            }
        }
        let part = if whole > 0.0 {
            left.norm() / whole
        } else {
            0.0
        };
        (left, part)
    }

    /// A row as it stands in (1).
    fn scaled(&self, row: &[f64]) -> DVector<f64> {
        &self.scale * DVector::from_column_slice(row)
    }

    /// Takes a row of which those before it leave at least a part of what the joints leave.
    pub(crate) fn take(&mut self, row: &[f64], least: f64) -> bool {
        let row = self.scaled(row);
        let (free, movable) = self.new_in(&row, self.held);
        let (left, _) = self.new_in(&row, self.directions.len());
        let new = movable > REPEATS && left.norm() > least * free.norm();
        if new {
            let length = left.norm();
            self.directions.push(left / length);
        }
        new
    }

    /// Takes the independent ones of the rows of the joints, those with most that is new first.
    pub(crate) fn take_rows(&mut self, rows: &DMatrix<f64>) -> Vec<usize> {
        let mut open: Vec<(usize, DVector<f64>, f64)> = Vec::new();
        for row in 0..rows.nrows() {
            let own = &self.scale * rows.row(row).transpose();
            let whole = own.norm().max(f64::MIN_POSITIVE);
            open.push((row, own, whole));
        }
        let part = |(_, left, whole): &(usize, DVector<f64>, f64)| left.norm() / whole;
        let mut kept = Vec::new();
        while let Some(most) =
            (0..open.len()).max_by(|&a, &b| part(&open[a]).total_cmp(&part(&open[b])))
        {
            let new = part(&open[most]);
            if new.is_nan() || new <= REPEATS {
                self.passed = new;
                break;
            }
            let (row, left, _) = open.swap_remove(most);
            // Once more, against the rounding of many subtractions.
            let (left, _) = self.new_in(&left, self.directions.len());
            let direction = &left / left.norm();
            for (_, left, _) in &mut open {
                let along = direction.dot(left);
                left.axpy(-along, &direction, 1.0);
            }
            self.directions.push(direction);
            kept.push(row);
        }
        self.held = kept.len();
        kept.sort_unstable();
        kept
    }

    /// The least change of the speeds, in the metric of M, that changes a number with this row by so much and no row that was taken before. `None` of a row
    /// that those before it hold.
    pub(crate) fn push(&mut self, row: &[f64], change: f64, least: f64) -> Option<DVector<f64>> {
        if !self.take(row, least) {
            return None;
        }
        let direction = self.directions.last()?;
        let size = change / self.scaled(row).dot(direction);
        Some(self.scale.tr_mul(direction) * size)
    }
}
