//! A dense matrix of derivatives.

use mbd_scene::Float;

/// A matrix, dense, row by row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Matrix<T> {
    rows: usize,
    columns: usize,
    pub(super) values: Vec<T>,
}

impl<T: Float> Matrix<T> {
    pub(super) fn new(rows: usize, columns: usize) -> Self {
        Matrix {
            rows,
            columns,
            values: vec![T::zero(); rows * columns],
        }
    }

    /// Takes another size; all elements are zero then.
    pub(super) fn reshape(&mut self, rows: usize, columns: usize) {
        (self.rows, self.columns) = (rows, columns);
        self.values.clear();
        self.values.resize(rows * columns, T::zero());
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// All elements, row by row.
    #[must_use]
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// One element; zero outside the matrix.
    #[must_use]
    pub fn at(&self, row: usize, column: usize) -> T {
        if column < self.columns {
            self.row(row).get(column).copied().unwrap_or_default()
        } else {
            T::zero()
        }
    }

    fn row(&self, row: usize) -> &[T] {
        self.values
            .get(row * self.columns..(row + 1) * self.columns)
            .unwrap_or(&[])
    }

    pub(super) fn row_mut(&mut self, row: usize) -> &mut [T] {
        self.values
            .get_mut(row * self.columns..(row + 1) * self.columns)
            .unwrap_or(&mut [])
    }

    /// Adds `left` · `right`.
    pub(super) fn add_product(&mut self, left: &Matrix<T>, right: &Matrix<T>) {
        for row in 0..self.rows {
            for (k, &factor) in left.row(row).iter().enumerate() {
                if factor != T::zero() {
                    for (target, &x) in self.row_mut(row).iter_mut().zip(right.row(k)) {
                        *target += factor * x;
                    }
                }
            }
        }
    }
}
