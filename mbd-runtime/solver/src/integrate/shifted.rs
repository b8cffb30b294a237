//! The linear systems of a stiff step, (w − A) U = b with A = ∂f/∂x, where positions are eliminated before anything is factored.
//!
//! ```text
//! q̇ = N(q) v:   (w − A_qq) U_q = b_q + N U_v            A_qq: zero, or ½Ω of the angular velocity, one 4×4 block a body     (1)
//! D⁻¹ = (w + ½Ω)/(w² + ¼ω²),   D = w − ½Ω               Ω² = −ω²                                                            (2)
//! (w − A_rr − A_rq D⁻¹ N) U_r = b_r + A_rq D⁻¹ b_q      r = [v | z | s]: what is left to factor                              (3)
//! ```
//!
//! Integrals behind the state, on which nothing depends, follow row by row. Factors by rows with row exchange; solutions take four rows at a time, whose sums
//! do not wait for each other.

use std::ops::Range;

use mbd_scene::Float;

/// How many rows are taken at a time.
const ROWS: usize = 4;

/// Coordinates whose rates are those of their own speeds.
#[derive(Clone, Debug)]
pub(crate) struct Attached {
    /// A position, an angle or a quaternion, in the state.
    pub at: Range<usize>,
    /// Its speeds.
    pub speeds: Range<usize>,
}

impl Attached {
    /// Whether it is a quaternion.
    fn turns(&self) -> bool {
        self.at.len() == 4 && self.speeds.len() == 3
    }
}

/// The factor of one matrix.
#[derive(Clone, Debug)]
pub(crate) struct Shifted<T> {
    length: usize,
    attached: Vec<Attached>,
    /// Where what is factored starts and ends.
    left: Range<usize>,
    shift: T,
    /// D⁻¹ N of every one of `attached`, row by row.
    carried: Vec<T>,
    /// L and U.
    factor: Vec<T>,
    /// A_rq, four rows at a time, filled up with zeros.
    by_coordinates: Vec<[T; ROWS]>,
    /// The same of L and U, but for the diagonal, and what its elements are divided by.
    triangles: Vec<[T; ROWS]>,
    inverse: Vec<T>,
    /// Which row was taken for each pivot.
    exchanges: Vec<usize>,
    made: bool,
    room: Vec<T>,
    /// Lengths of the quaternions of a stage.
    lengths: Vec<T>,
}

impl<T: Float> Shifted<T> {
    /// Room for matrices of a length, the last `behind` columns of which are zero.
    pub(crate) fn new(length: usize, attached: Vec<Attached>, behind: usize) -> Self {
        let first = attached.iter().map(|one| one.at.end).max().unwrap_or(0);
        let left = first..length - behind;
        let carried = attached.iter().map(|one| one.at.len() * one.speeds.len());
        Shifted {
            length,
            shift: T::zero(),
            carried: vec![T::zero(); carried.sum()],
            factor: vec![T::zero(); left.len() * left.len()],
            by_coordinates: vec![[T::zero(); ROWS]; left.len().div_ceil(ROWS) * left.start],
            triangles: vec![[T::zero(); ROWS]; left.len().div_ceil(ROWS) * left.len()],
            inverse: vec![T::zero(); left.len()],
            exchanges: vec![0; left.len()],
            made: false,
            room: vec![T::zero(); left.len().max(4)],
            lengths: vec![T::one(); attached.len()],
            attached,
            left,
        }
    }

    /// The matrix is another one.
    pub(crate) fn forget(&mut self) {
        self.made = false;
    }

    /// Makes the quaternions of a stage unit ones.
    pub(crate) fn shorten(&mut self, state: &mut [T]) {
        for (one, length) in self.attached.iter().zip(&mut self.lengths) {
            if !one.turns() {
                continue;
            }
            let quaternion = state.get_mut(one.at.clone()).unwrap_or_default();
            *length = dot(quaternion, quaternion).sqrt();
            quaternion.iter_mut().for_each(|x| *x /= *length);
        }
    }

    /// The rates of the quaternions as they were before.
    pub(crate) fn lengthen(&self, rates: &mut [T]) {
        for (one, length) in self.attached.iter().zip(&self.lengths) {
            let own = rates.get_mut(one.at.clone()).unwrap_or_default();
            own.iter_mut().for_each(|x| *x *= *length);
        }
    }

    /// Derivatives by quaternions of rates that do not depend on their length: ∂f/∂q (1 − q qᵀ), but of q̇.
    pub(crate) fn along_units(&self, state: &[T], matrix: &mut [T]) {
        let rows = matrix.chunks_exact_mut(self.length.max(1));
        for row in rows.skip(self.left.start) {
            for one in self.attached.iter().filter(|one| one.turns()) {
                let quaternion = state.get(one.at.clone()).unwrap_or_default();
                let own = row.get_mut(one.at.clone()).unwrap_or_default();
                let along = dot(own, quaternion);
                for (slope, x) in own.iter_mut().zip(quaternion) {
                    *slope -= along * *x;
                }
            }
        }
    }

    /// Factors w − A, unless that is done; whether it was done now. A matrix without an inverse gives solutions that are not finite.
    pub(crate) fn factor(&mut self, shift: T, matrix: &[T]) -> bool {
        if self.made && shift == self.shift {
            return false;
        }
        let (first, n) = (self.left.start, self.left.len());
        if !self.made {
            let own = matrix.chunks_exact(self.length.max(1)).skip(first).take(n);
            let own = own.map(|row| row.get(..first).unwrap_or_default());
            by_rows(own, &mut self.by_coordinates);
        }
        (self.made, self.shift) = (true, shift);
        self.carry(matrix);
        for (row, out) in self.factor.chunks_exact_mut(n.max(1)).enumerate() {
            let whole = line(matrix, self.length, first + row);
            let own = whole.get(self.left.clone()).unwrap_or_default();
            for (to, from) in out.iter_mut().zip(own) {
                *to = -*from;
            }
            if let Some(diagonal) = out.get_mut(row) {
                *diagonal += shift;
            }
            let mut carried = self.carried.as_slice();
            for one in &self.attached {
                let (rows, rest) = carried.split_at(one.at.len() * one.speeds.len());
                carried = rest;
                let speeds = one.speeds.start - first..one.speeds.end - first;
                let by_coordinates = whole.get(one.at.clone()).unwrap_or_default();
                for (slope, along) in by_coordinates
                    .iter()
                    .zip(rows.chunks_exact(one.speeds.len().max(1)))
                {
                    if *slope == T::zero() {
                        continue;
                    }
                    let to = out.get_mut(speeds.clone()).unwrap_or_default();
                    for (to, along) in to.iter_mut().zip(along) {
                        *to -= *slope * *along;
                    }
                }
            }
        }
        decompose(n, &mut self.factor, &mut self.exchanges);
        by_rows(self.factor.chunks_exact(n.max(1)), &mut self.triangles);
        for (row, inverse) in self.inverse.iter_mut().enumerate() {
            let diagonal = self.factor.get(row * n + row);
            *inverse = T::one() / diagonal.copied().unwrap_or_default();
        }
        true
    }

    /// D⁻¹ N of all coordinates.
    fn carry(&mut self, matrix: &[T]) {
        let mut carried = self.carried.as_mut_slice();
        for one in &self.attached {
            let (own, rest) = carried.split_at_mut(one.at.len() * one.speeds.len());
            carried = rest;
            for (column, speed) in one.speeds.clone().enumerate() {
                let room = self.room.get_mut(..one.at.len()).unwrap_or_default();
                for (to, row) in room.iter_mut().zip(one.at.clone()) {
                    *to = at(matrix, self.length, row, speed);
                }
                unturn(one, self.shift, matrix, self.length, room);
                let rows = own.chunks_exact_mut(one.speeds.len().max(1));
                for (row, x) in rows.zip(room) {
                    row[column] = *x;
                }
            }
        }
    }

    /// Solves in place for the matrix that was factored, which is given again.
    pub(crate) fn solve(&mut self, matrix: &[T], right: &mut [T]) {
        for one in &self.attached {
            let own = right.get_mut(one.at.clone()).unwrap_or_default();
            unturn(one, self.shift, matrix, self.length, own);
        }
        let (coordinates, rest) = right.split_at_mut(self.left.start);
        let (left, behind) = rest.split_at_mut(self.left.len());
        let blocks = self.by_coordinates.chunks_exact(coordinates.len().max(1));
        for (block, own) in blocks.zip(left.chunks_mut(ROWS)) {
            let sums = products(block, coordinates);
            own.iter_mut().zip(sums).for_each(|(x, sum)| *x += sum);
        }
        for (pivot, exchange) in self.exchanges.iter().enumerate() {
            left.swap(pivot, *exchange);
        }
        substitute(&self.triangles, &self.inverse, left);
        let mut carried = self.carried.as_slice();
        for one in &self.attached {
            let (rows, others) = carried.split_at(one.at.len() * one.speeds.len());
            carried = others;
            let first = one.speeds.start - self.left.start;
            let speeds = left.get(first..first + one.speeds.len()).unwrap_or(&[]);
            let own = coordinates.get_mut(one.at.clone()).unwrap_or_default();
            let rows = rows.chunks_exact(one.speeds.len().max(1));
            for (x, row) in own.iter_mut().zip(rows) {
                *x += dot(row, speeds);
            }
        }
        for (row, x) in behind.iter_mut().enumerate() {
            let by_state = line(matrix, self.length, self.left.end + row);
            let (by_coordinates, by_rest) = by_state.split_at(self.left.start);
            *x = (*x + dot(by_coordinates, coordinates) + dot(by_rest, left)) / self.shift;
        }
    }
}

/// x ← D⁻¹ x, by (2).
fn unturn<T: Float>(one: &Attached, shift: T, matrix: &[T], length: usize, x: &mut [T]) {
    let first = one.at.start;
    let ([w, i, j, k], true) = (&mut *x, one.turns()) else {
        let part = T::one() / shift;
        x.iter_mut().for_each(|x| *x *= part);
        return;
    };
    let own = [*w, *i, *j, *k];
    let rows = |row: usize| {
        let block = line(matrix, length, first + row).get(first..);
        block.and_then(<[T]>::first_chunk::<4>)
    };
    let Some([_, x, y, z]) = rows(0) else {
        return;
    };
    let part = T::one() / (shift * shift + *x * *x + *y * *y + *z * *z);
    for (row, to) in [w, i, j, k].into_iter().enumerate() {
        if let Some(elements) = rows(row) {
            *to = part * (shift * own[row] + dot(elements, &own));
        }
    }
}

fn line<T>(matrix: &[T], length: usize, row: usize) -> &[T] {
    matrix
        .get(row * length..(row + 1) * length)
        .unwrap_or_default()
}

fn at<T: Float>(matrix: &[T], length: usize, row: usize, column: usize) -> T {
    line(matrix, length, row)
        .get(column)
        .copied()
        .unwrap_or_default()
}

/// Σ a b over the shorter list.
fn dot<T: Float>(a: &[T], b: &[T]) -> T {
    a.iter().zip(b).fold(T::zero(), |sum, (a, b)| sum + *a * *b)
}

/// L U = P M in place, row by row, for a matrix of n rows; `exchanges` are the rows taken for the pivots.
fn decompose<T: Float>(n: usize, matrix: &mut [T], exchanges: &mut [usize]) {
    for (pivot, exchange) in exchanges.iter_mut().enumerate().take(n) {
        let size = |row: usize| matrix[row * n + pivot].abs();
        let mut most = pivot;
        for row in pivot + 1..n {
            if size(row) > size(most) {
                most = row;
            }
        }
        *exchange = most;
        if most != pivot {
            for column in 0..n {
                matrix.swap(pivot * n + column, most * n + column);
            }
        }
        let (above, below) = matrix.split_at_mut((pivot + 1) * n);
        let own = &above[pivot * n..];
        for row in below.chunks_exact_mut(n) {
            // Most bodies do not see each other.
            if row[pivot] == T::zero() {
                continue;
            }
            let part = row[pivot] / own[pivot];
            row[pivot] = part;
            for (x, y) in row[pivot + 1..].iter_mut().zip(&own[pivot + 1..]) {
                *x -= part * *y;
            }
        }
    }
}

/// x ← U⁻¹ L⁻¹ x, by blocks of rows: what is behind or before a block at once, its own triangle one by one.
fn substitute<T: Float>(triangles: &[[T; ROWS]], inverse: &[T], x: &mut [T]) {
    let n = x.len();
    for (number, block) in triangles.chunks_exact(n.max(1)).enumerate() {
        let first = number * ROWS;
        let (done, rest) = x.split_at_mut(first);
        let (before, own) = block.split_at(first);
        let mut sums = products(before, done);
        for k in 0..ROWS.min(rest.len()) {
            let solved = rest[k] - sums[k];
            rest[k] = solved;
            add_column(&mut sums, &own[k], solved);
        }
    }
    for (number, block) in triangles.chunks_exact(n.max(1)).enumerate().rev() {
        let first = number * ROWS;
        let (_, rest) = x.split_at_mut(first);
        let (own, done) = rest.split_at_mut(ROWS.min(rest.len()));
        let (before, behind) = block.split_at(first + own.len());
        let mut sums = products(behind, done);
        for k in (0..own.len()).rev() {
            let solved = (own[k] - sums[k]) * inverse[first + k];
            own[k] = solved;
            add_column(&mut sums, &before[first + k], solved);
        }
    }
}

/// Writes rows of one length four at a time, column by column.
fn by_rows<'a, T: Float>(rows: impl Iterator<Item = &'a [T]>, out: &mut [[T; ROWS]]) {
    for (index, row) in rows.enumerate() {
        let block = out.get_mut(index / ROWS * row.len()..);
        let block = block.unwrap_or_default();
        for (to, x) in block.iter_mut().zip(row) {
            to[index % ROWS] = *x;
        }
    }
}

/// The products of four rows by a vector.
fn products<T: Float>(rows: &[[T; ROWS]], x: &[T]) -> [T; ROWS] {
    let mut sums = [T::zero(); ROWS];
    for (column, x) in rows.iter().zip(x) {
        add_column(&mut sums, column, *x);
    }
    sums
}

fn add_column<T: Float>(sums: &mut [T; ROWS], column: &[T; ROWS], x: T) {
    for (sum, element) in sums.iter_mut().zip(column) {
        *sum += *element * x;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A point and a turning body with arbitrary derivatives of their accelerations, and one integral behind.
    fn matrix() -> (Vec<f64>, Vec<Attached>) {
        let n = 14;
        let mut a = vec![0.0; n * n];
        let mut set = |row: usize, column: usize, x: f64| a[row * n + column] = x;
        let (omega, q) = ([0.7, -0.4, 1.1], [0.5, 0.5, -0.5, 0.5]);
        // q̇ = ½ q ∘ ω.
        let [x, y, z] = omega;
        let turn = [
            [0.0, -x, -y, -z],
            [x, 0.0, z, -y],
            [y, -z, 0.0, x],
            [z, y, -x, 0.0],
        ];
        let [s, i, j, k] = q;
        let along = [[-i, -j, -k], [s, -k, j], [k, s, -i], [-j, i, s]];
        for row in 0..4 {
            (0..4).for_each(|column| set(3 + row, 3 + column, 0.5 * turn[row][column]));
            (0..3).for_each(|column| set(3 + row, 10 + column, 0.5 * along[row][column]));
        }
        (0..3).for_each(|row| set(row, 7 + row, 1.0));
        for row in 7..14 {
            for column in 0..13 {
                set(row, column, ((7 * row + 3 * column) as f64).sin());
            }
        }
        let attached = vec![
            Attached {
                at: 0..3,
                speeds: 7..10,
            },
            Attached {
                at: 3..7,
                speeds: 10..13,
            },
        ];
        (a, attached)
    }

    #[test]
    fn the_solution_obeys_the_whole_system() {
        let (a, attached) = matrix();
        let n = 14;
        let mut shifted = Shifted::new(n, attached, 1);
        for shift in [0.3, 4.0, 250.0] {
            let right: Vec<f64> = (0..n).map(|i| (i as f64).cos()).collect();
            let mut x = right.clone();
            assert!(shifted.factor(shift, &a));
            assert!(!shifted.factor(shift, &a));
            shifted.solve(&a, &mut x);
            for row in 0..n {
                let sum = dot(line(&a, n, row), &x);
                let left = shift * x[row] - sum - right[row];
                assert!(left.abs() < 1e-12, "{shift} {row}: {left:e}");
            }
        }
    }

    #[test]
    fn a_matrix_without_an_inverse_shows() {
        let mut shifted = Shifted::new(2, Vec::new(), 0);
        let a = [1.0, 0.0, 0.0, 2.0];
        shifted.factor(1.0, &a);
        let mut x = [1.0, 1.0];
        shifted.solve(&a, &mut x);
        assert!(!x[0].is_finite());
    }
}
