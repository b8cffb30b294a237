//! Numbers of twice the digits, for answers that a condition of 1e18 must not touch: the sum of two `f64`.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// high + low, |low| ≤ half an ulp of high.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Double(pub f64, pub f64);

/// Sum and its error (Knuth).
fn two_sum(a: f64, b: f64) -> Double {
    let sum = a + b;
    let back = sum - a;
    Double(sum, (a - (sum - back)) + (b - back))
}

/// Product and its error.
fn two_product(a: f64, b: f64) -> Double {
    let product = a * b;
    Double(product, a.mul_add(b, -product))
}

impl From<f64> for Double {
    fn from(x: f64) -> Self {
        Double(x, 0.0)
    }
}

impl Add for Double {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (high, low) = (two_sum(self.0, other.0), two_sum(self.1, other.1));
        let first = two_sum(high.0, high.1 + low.0);
        two_sum(first.0, first.1 + low.1)
    }
}

impl Neg for Double {
    type Output = Self;
    fn neg(self) -> Self {
        Double(-self.0, -self.1)
    }
}

impl Sub for Double {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Double {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let product = two_product(self.0, other.0);
        let cross = self.0 * other.1 + self.1 * other.0;
        two_sum(product.0, product.1 + cross)
    }
}

impl Div for Double {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = Double::from(self.0 / other.0);
        let rest = self - first * other;
        let second = Double::from(rest.0 / other.0);
        let rest = rest - second * other;
        first + second + Double::from(rest.0 / other.0)
    }
}

/// Solves a small positive definite system by elimination without exchange.
///
/// # Panics
/// If the lists are shorter than the matrix says.
#[must_use]
pub fn solve(mut matrix: Vec<Vec<Double>>, mut right: Vec<Double>) -> Vec<Double> {
    let n = right.len();
    for k in 0..n {
        let (done, open) = matrix.split_at_mut(k + 1);
        let pivot = &done[k];
        let known = right[k];
        for (row, value) in open.iter_mut().zip(&mut right[k + 1..]) {
            let factor = row[k] / pivot[k];
            for (x, p) in row.iter_mut().zip(pivot).skip(k) {
                *x = *x - factor * *p;
            }
            *value = *value - factor * known;
        }
    }
    for i in (0..n).rev() {
        for j in i + 1..n {
            right[i] = right[i] - matrix[i][j] * right[j];
        }
        right[i] = right[i] / matrix[i][i];
    }
    right
}
