//! Eigenvalues and eigenvectors of a symmetric 3 × 3 matrix, in `f64` whatever the scalar of the run.

use mbd_scene::Float;
use nalgebra::{Matrix3, SymmetricEigen, Vector3};

/// How often a rotation is tried: a matrix that is not finite has no end.
const MOST: usize = 100;

/// Eigenvalues, largest first, with their unit vectors; zeros for a matrix that is not finite.
#[must_use]
pub fn eigen<T: Float>(matrix: &Matrix3<T>) -> [(T, Vector3<T>); 3] {
    let wide = matrix.map(|x| x.to_f64());
    let Some(found) = SymmetricEigen::try_new(wide, f64::EPSILON, MOST) else {
        return [(T::zero(), Vector3::zeros()); 3];
    };
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| found.eigenvalues[b].total_cmp(&found.eigenvalues[a]));
    order.map(|k| {
        let vector = found.eigenvectors.column(k).map(T::from_f64);
        (T::from_f64(found.eigenvalues[k]), vector)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigenvectors_rebuild_the_matrix() {
        let d = Matrix3::new(1784.0, 3.0, -7.0, 3.0, 113.0, 1e-4, -7.0, 1e-4, 1e-5);
        let mut rebuilt = Matrix3::zeros();
        for (value, vector) in eigen(&d) {
            rebuilt += vector * vector.transpose() * value;
        }
        assert!((rebuilt - d).abs().max() < 1e-12 * 1784.0);
    }

    #[test]
    fn the_null_direction_of_two_lines_is_normal_to_both() {
        let (a, b) = (Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.6, 0.8, 0.0));
        let found: [(f64, Vector3<f64>); 3] = eigen(&(a * a.transpose() + b * b.transpose()));
        assert!(found[2].0.abs() < 1e-15);
        assert!((found[2].1.z.abs() - 1.0).abs() < 1e-15);
    }
}
