//! Eigenvalues and eigenvectors of a symmetric 3 × 3 matrix by Jacobi's rotations: no allocation, accurate for small eigenvalues too.
//!
//! The only eigen solver of the runtime. A rate node asks for it at every stage: nalgebra's costs 18 % of the instructions of a step there.

use mbd_scene::Float;
use nalgebra::{Matrix3, Vector3};

/// Eigenvalues, largest first, with their unit vectors.
#[must_use]
pub fn eigen<T: Float>(matrix: &Matrix3<T>) -> [(T, Vector3<T>); 3] {
    let mut a = *matrix;
    let mut v = Matrix3::identity();
    for _ in 0..20 {
        let off = a[(0, 1)].abs() + a[(0, 2)].abs() + a[(1, 2)].abs();
        let size = a[(0, 0)].abs() + a[(1, 1)].abs() + a[(2, 2)].abs();
        if off <= T::EPSILON * T::EPSILON * size || !off.is_finite() {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            rotate(&mut a, &mut v, p, q);
        }
    }
    let mut found = [0, 1, 2].map(|k| (a[(k, k)], Vector3::new(v[(0, k)], v[(1, k)], v[(2, k)])));
    for (i, j) in [(0, 1), (1, 2), (0, 1)] {
        if found[i].0 < found[j].0 {
            found.swap(i, j);
        }
    }
    found
}

/// One rotation in the plane (p, q) that makes a_pq zero.
fn rotate<T: Float>(a: &mut Matrix3<T>, v: &mut Matrix3<T>, p: usize, q: usize) {
    let off = a[(p, q)];
    if off == T::zero() {
        return;
    }
    let one = T::one();
    let theta = (a[(q, q)] - a[(p, p)]) / (off + off);
    let size = one / (theta.abs() + (theta * theta + one).sqrt());
    let t = if theta < T::zero() { -size } else { size };
    let c = one / (t * t + one).sqrt();
    let s = t * c;
    // What vanishes is set to zero: rounding that is left there would be rotated again and again where two eigenvalues are alike.
    a[(p, p)] -= t * off;
    a[(q, q)] += t * off;
    (a[(p, q)], a[(q, p)]) = (T::zero(), T::zero());
    let r = 3 - p - q;
    let (x, y) = (a[(r, p)], a[(r, q)]);
    let (x, y) = (c * x - s * y, s * x + c * y);
    (a[(r, p)], a[(p, r)]) = (x, x);
    (a[(r, q)], a[(q, r)]) = (y, y);
    for k in 0..3 {
        let (x, y) = (v[(k, p)], v[(k, q)]);
        v[(k, p)] = c * x - s * y;
        v[(k, q)] = s * x + c * y;
    }
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
    fn the_direction_of_one_line_is_found_whatever_its_direction() {
        // One line has two directions of no damping; the vectors are those of a rotated axis, whatever its direction.
        for k in 1..200 {
            let u = Vector3::new(0.01 * f64::from(k), 0.3, (0.1 * f64::from(k)).sin()).normalize();
            let [(value, along), (zero, _), (nothing, _)] = eigen(&(u * u.transpose() * 600.0));
            assert!((value - 600.0).abs() < 1e-12 * 600.0);
            assert!(zero.abs() < 1e-13 * 600.0 && nothing.abs() < 1e-13 * 600.0);
            assert!((along.dot(&u).abs() - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn the_null_direction_of_two_lines_is_normal_to_both() {
        let (a, b) = (Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.6, 0.8, 0.0));
        let found: [(f64, Vector3<f64>); 3] = eigen(&(a * a.transpose() + b * b.transpose()));
        assert!(found[2].0.abs() < 1e-15);
        assert!((found[2].1.z.abs() - 1.0).abs() < 1e-15);
    }
}
