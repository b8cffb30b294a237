//! The few matrices every law needs.

use std::collections::BTreeSet;

use nalgebra::{DMatrix, Matrix3, Vector3};

use crate::Real;

/// The symmetric matrix with elements xx xy xz yy yz zz.
#[inline]
pub fn symmetric<S: Real>([xx, xy, xz, yy, yz, zz]: [S; 6]) -> Matrix3<S> {
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}

/// The elements xx xy xz yy yz zz of a symmetric matrix.
#[inline]
pub fn elements<S: Real>(m: &Matrix3<S>) -> [S; 6] {
    [
        m[(0, 0)],
        m[(0, 1)],
        m[(0, 2)],
        m[(1, 1)],
        m[(1, 2)],
        m[(2, 2)],
    ]
}

/// Inverse of a symmetric, positive definite 3 × 3 matrix by cofactors of A/tr A, symmetric to the bit: det A of an asteroid, or of a bead, is no number in single
/// precision. A diagonal matrix costs three divisions on symbols.
pub fn inverse<S: Real>(m: &Matrix3<S>) -> Matrix3<S> {
    let [xx, xy, xz, yy, yz, zz] = elements(m);
    let zero = S::zero();
    if xy == zero && xz == zero && yz == zero {
        // A structural fact of the declaration, not a branch on the state: inertia is constant.
        return Matrix3::from_diagonal(&Vector3::new(S::one() / xx, S::one() / yy, S::one() / zz));
    }
    let size = S::one() / (xx + yy + zz);
    let [xx, xy, xz, yy, yz, zz] = [xx, xy, xz, yy, yz, zz].map(|element| element * size);
    let (a, b, c) = (yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy);
    let scale = size / (xx * a + xy * b + xz * c);
    symmetric([
        a * scale,
        b * scale,
        c * scale,
        (xx * zz - xz * xz) * scale,
        (xy * xz - xx * yz) * scale,
        (xx * yy - xy * xy) * scale,
    ])
}

/// det A over (tr A)³ above which A certainly has full rank.
const FULL: f64 = 1e-5;

/// Solves A x = b for a symmetric, positive semidefinite 3 × 3 matrix with elements xx xy xz yy yz zz, by cofactors and one division. Also
/// det A − 1e-5 (tr A)³, which bounds λ_min/λ_max from below by 1e-5 where it is positive: A certainly has full rank there, elsewhere x means nothing.
pub fn solve_regular<S: Real>(
    [xx, xy, xz, yy, yz, zz]: [S; 6],
    right: &Vector3<S>,
) -> (Vector3<S>, S) {
    let (a, b, c) = (yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy);
    let (d, e, f) = (xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy);
    let determinant = (xx * a + xy * b + xz * c).label("det");
    let trace = xx + yy + zz;
    let full = S::from_f64(FULL) * (trace * trace * trace);
    let margin = (determinant - full).label("margin");
    // Finite also where it means nothing.
    let regular = S::zero().lt(margin);
    let scale = S::one() / S::select(regular, determinant, S::one());
    let adjugate = Vector3::new(
        a * right.x + b * right.y + c * right.z,
        b * right.x + d * right.y + e * right.z,
        c * right.x + e * right.y + f * right.z,
    );
    (adjugate.map(|x| scale * x), margin)
}

/// Rotation body → world of a unit quaternion w x y z.
///
/// Quadratic in the quaternion: off unit length, as inside a step, it gives |q|² R. That turns with the world's axes, so results do not
/// depend on where these lie; the form 1 − 2(y² + z²) does not.
pub fn rotation<S: Real>([w, x, y, z]: [S; 4]) -> Matrix3<S> {
    let (ww, xx) = ((w * w).label("q_ww"), (x * x).label("q_xx"));
    let (yy, zz) = ((y * y).label("q_yy"), (z * z).label("q_zz"));
    let (x2, y2, z2) = (x + x, y + y, z + z);
    let (xy, xz) = ((x2 * y).label("twice_q_xy"), (x2 * z).label("twice_q_xz"));
    let (yz, wx) = ((y2 * z).label("twice_q_yz"), (w * x2).label("twice_q_wx"));
    let (wy, wz) = ((w * y2).label("twice_q_wy"), (w * z2).label("twice_q_wz"));
    let (sum, difference) = (ww - xx, yy - zz);
    Matrix3::new(
        ((ww + xx) - (yy + zz)).label("r11"),
        (xy - wz).label("r12"),
        (xz + wy).label("r13"),
        (xy + wz).label("r21"),
        (sum + difference).label("r22"),
        (yz - wx).label("r23"),
        (xz - wy).label("r31"),
        (yz + wx).label("r32"),
        (sum - difference).label("r33"),
    )
}

/// ½ q ⊗ (0, ω) of a quaternion w x y z for ω in body axes (`in_body`), ½ (0, ω) ⊗ q for ω in world axes.
pub fn quaternion_rate<S: Real>([w, x, y, z]: [S; 4], omega: &Vector3<S>, in_body: bool) -> [S; 4] {
    // Halves of −ω: so written, no rate takes a sign of its own.
    let half = S::from_f64(-0.5);
    let omega = omega.map(|rate| half * rate);
    // The two products differ in the sign of the cross product.
    let sign = if in_body { S::one() } else { -S::one() };
    let swirl = Vector3::new(
        z * omega.y - y * omega.z,
        x * omega.z - z * omega.x,
        y * omega.x - x * omega.y,
    );
    [
        x * omega.x + y * omega.y + z * omega.z,
        sign * swirl.x - w * omega.x,
        sign * swirl.y - w * omega.y,
        sign * swirl.z - w * omega.z,
    ]
}

/// A unit quaternion w x y z of a rotation, from the largest of its four elements, without a branch. Source: Shepperd, Quaternion from rotation
/// matrix, 1978.
pub fn quaternion_of<S: Real>(r: &Matrix3<S>) -> [S; 4] {
    let one = S::one();
    let [a, b, c] = [r[(0, 0)], r[(1, 1)], r[(2, 2)]];
    // Four times the square of each element, and four times its products with all of them.
    let squares = [
        one + a + b + c,
        one + a - b - c,
        one - a + b - c,
        one - a - b + c,
    ];
    let [wx, wy, wz] = [(2, 1), (0, 2), (1, 0)].map(|(i, j)| r[(i, j)] - r[(j, i)]);
    let [xy, yz, zx] = [(1, 0), (2, 1), (0, 2)].map(|(i, j)| r[(i, j)] + r[(j, i)]);
    let products = [
        [squares[0], wx, wy, wz],
        [wx, squares[1], xy, zx],
        [wy, xy, squares[2], yz],
        [wz, zx, yz, squares[3]],
    ];
    let (mut most, mut best) = (squares[0], products[0]);
    for (square, product) in squares.into_iter().zip(products).skip(1) {
        let larger = most.lt(square);
        best = std::array::from_fn(|k| S::select(larger, product[k], best[k]));
        most = S::select(larger, square, most);
    }
    let scale = S::from_f64(0.5) / most.sqrt();
    best.map(|x| scale * x)
}

/// Names the three components of a vector.
#[inline]
pub fn labelled<S: Real>(v: Vector3<S>, names: [&'static str; 3]) -> Vector3<S> {
    Vector3::new(
        v.x.label(names[0]),
        v.y.label(names[1]),
        v.z.label(names[2]),
    )
}

/// A vector from the first three numbers of a slice from `at`; NaN where the slice is too short.
pub fn vector<S: Real>(slice: &[S], at: usize) -> Vector3<S> {
    let read = |i: usize| {
        slice
            .get(at + i)
            .copied()
            .unwrap_or_else(|| S::from_f64(f64::NAN))
    };
    Vector3::new(read(0), read(1), read(2))
}

/// Writes three numbers into a slice from `at`, as far as it is long enough.
pub fn write<S: Real>(out: &mut [S], at: usize, v: &Vector3<S>) {
    for (i, &component) in v.iter().enumerate() {
        if let Some(slot) = out.get_mut(at + i) {
            *slot = component;
        }
    }
}

/// Solves A X = B in place for a symmetric positive definite A of 3 × 3 blocks, by LDLᵀ without pivoting, in the order of the blocks.
///
/// `coupled` lists for each block the later ones that it shares a block of the factor with ([`fill`]); no other is touched, so a chain takes
/// operations in proportion to its length. `a` and `b` are square n × n and n × k. A singular A gives numbers that are not finite, never a panic.
pub fn solve_coupled<S: Real>(coupled: &[Vec<usize>], a: &mut DMatrix<S>, b: &mut DMatrix<S>) {
    let n = a.nrows().min(a.ncols()).min(b.nrows());
    let later = |pivot: usize| {
        let others = coupled.get(pivot / 3).into_iter().flatten();
        let others = others.flat_map(|&block| 3 * block..3 * block + 3);
        (pivot + 1..(3 * (pivot / 3 + 1)).min(n)).chain(others)
    };
    for pivot in 0..n {
        let inverse = S::one() / a[(pivot, pivot)];
        for row in later(pivot) {
            let factor = a[(row, pivot)] * inverse;
            for column in later(pivot).take_while(|column| *column <= row) {
                let shared = a[(column, pivot)];
                a[(row, column)] -= factor * shared;
            }
            for column in 0..b.ncols() {
                let shared = b[(pivot, column)];
                b[(row, column)] -= factor * shared;
            }
        }
    }
    for pivot in (0..n).rev() {
        let inverse = S::one() / a[(pivot, pivot)];
        for column in 0..b.ncols() {
            let mut total = b[(pivot, column)];
            for row in later(pivot) {
                total -= a[(row, pivot)] * b[(row, column)];
            }
            b[(pivot, column)] = total * inverse;
        }
    }
}

/// Per block the later blocks it shares a block of the factor with, in order, from the blocks (row, column), row ≥ column, of the matrix.
pub fn fill(blocks: usize, pairs: &[(usize, usize)]) -> Vec<Vec<usize>> {
    let mut coupled = vec![BTreeSet::new(); blocks];
    for &(row, column) in pairs.iter().filter(|(row, column)| row > column) {
        if let Some(later) = coupled.get_mut(column) {
            later.insert(row);
        }
    }
    for block in 0..blocks {
        let later: Vec<usize> = coupled[block].iter().copied().collect();
        for (k, &first) in later.iter().enumerate() {
            coupled[first].extend(&later[k + 1..]);
        }
    }
    let lists = coupled.into_iter().map(|later| later.into_iter().collect());
    lists.collect()
}
