//! Decompositions of small dense matrices, compiled once and optimised: tests ask for them thousands of times.

use nalgebra::{DMatrix, DVector};

/// The largest singular value of a symmetric matrix over its smallest: they are the sizes of its eigenvalues, which take a fourth of the work.
///
/// # Panics
/// For a matrix without numbers.
#[must_use]
pub fn symmetric_condition(matrix: DMatrix<f64>) -> f64 {
    let sizes = matrix.symmetric_eigenvalues().abs();
    sizes.max() / sizes.min()
}

/// The part of `any` that `rows` do not see: any − rows⁺ rows any, singular values below 1e-9 taken for zero.
///
/// # Panics
/// For a list that is not as long as a row.
#[must_use]
pub fn unseen(rows: &DMatrix<f64>, any: DVector<f64>) -> DVector<f64> {
    let found = rows.clone().svd(true, true).solve(&(rows * &any), 1e-9);
    any - found.expect("asked for both sides")
}

/// The pseudo-inverse, singular values below 1e-9 taken for zero.
///
/// # Panics
/// Never: the bound is positive.
#[must_use]
pub fn pseudo_inverse(matrix: DMatrix<f64>) -> DMatrix<f64> {
    matrix.pseudo_inverse(1e-9).expect("a positive bound")
}
