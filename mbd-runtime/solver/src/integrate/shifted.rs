//! The linear systems of a stiff step, (w − A) U = b with A = ∂f/∂x, where positions are eliminated before anything is factored.
//!
//! ```text
//! q̇ = N(q) v:   (w − A_qq) U_q = b_q + N U_v            A_qq: zero, or ½Ω of the angular velocity, one 4×4 block a body     (1)
//! D⁻¹ = (w + ½Ω)/(w² + ¼ω²),   D = w − ½Ω               Ω² = −ω²                                                            (2)
//! (w − A_rr − A_rq D⁻¹ N) U_r = b_r + A_rq D⁻¹ b_q      r = [v | z | s]: what is left to factor                              (3)
//! ```
//!
//! Integrals behind the state, on which nothing depends, follow row by row.

use std::ops::Range;

use mbd_scene::Real;

use super::tiles::{Four, SIDE, Tile, Tiles, Triangles, add_tile, fours};

/// Coordinates whose rates are those of their own speeds.
#[derive(Clone, Debug)]
pub(crate) struct Attached {
    /// A position, an angle or a quaternion, in the state.
    pub at: Range<usize>,
    /// Its speeds, three at most.
    pub speeds: Range<usize>,
}

impl Attached {
    /// Whether it is a quaternion.
    fn turns(&self) -> bool {
        self.at.len() == 4 && self.speeds.len() == 3
    }
}

/// What takes coordinates out.
#[derive(Clone, Copy, Debug)]
struct Eliminated<T> {
    /// D⁻¹.
    inverse: Tile<T>,
    /// D⁻¹ N, a column a speed.
    along: Tile<T>,
}

impl<T: Real> Eliminated<T> {
    fn none() -> Self {
        let none = [[T::zero(); SIDE]; SIDE];
        Eliminated {
            inverse: none,
            along: none,
        }
    }

    /// By (2), for A with rows of a length.
    fn new(one: &Attached, shift: T, (matrix, length): (&[T], usize)) -> Self {
        let mut eliminated = Self::none();
        let own = |row: usize, column: usize| {
            let row = line(matrix, length, one.at.start + row);
            row.get(column).copied().unwrap_or_else(T::zero)
        };
        let mut part = T::one() / shift;
        if one.turns() {
            // The first row of ½Ω is −½ω.
            let halves = (1..SIDE).map(|axis| own(0, one.at.start + axis));
            let square = halves.fold(shift * shift, |sum, half| sum + half * half);
            let over = T::one() / square;
            for (number, column) in eliminated.inverse.iter_mut().enumerate() {
                for (row, to) in column.iter_mut().enumerate() {
                    *to = own(row, one.at.start + number) * over;
                }
            }
            part = shift * over;
        }
        for number in 0..one.at.len() {
            eliminated.inverse[number][number] += part;
        }
        for (speed, to) in one.speeds.clone().zip(&mut eliminated.along) {
            let mut rates = [T::zero(); SIDE];
            for (row, rate) in rates.iter_mut().enumerate().take(one.at.len()) {
                *rate = own(row, speed);
            }
            add_tile(to, &eliminated.inverse, &rates);
        }
        eliminated
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
    /// How every one of `attached` is eliminated.
    eliminated: Vec<Eliminated<T>>,
    /// A_rq.
    by_coordinates: Tiles<T>,
    /// L and U of A_rr + A_rq D⁻¹ N − w.
    factor: Tiles<T>,
    triangles: Triangles<T>,
    made: bool,
    /// The coordinates and the rest of a right-hand side, in fours.
    right: [Vec<Four<T>>; 2],
    /// Lengths of the quaternions of a stage.
    lengths: Vec<T>,
}

impl<T: Real> Shifted<T> {
    /// Room for matrices of a length, the last `behind` columns of which are zero.
    pub(crate) fn new(length: usize, attached: Vec<Attached>, behind: usize) -> Self {
        let first = attached.iter().map(|one| one.at.end).max().unwrap_or(0);
        let left = first..length - behind;
        let n = left.len();
        Shifted {
            length,
            shift: T::zero(),
            eliminated: vec![Eliminated::none(); attached.len()],
            by_coordinates: Tiles::new(n, first),
            factor: Tiles::new(n, n),
            triangles: Triangles::new(n),
            made: false,
            right: [fours(first), fours(n)],
            lengths: vec![T::one(); attached.len()],
            attached,
            left,
        }
    }

    /// Room for as large matrices over another scalar.
    pub(crate) fn over<S: Real>(&self) -> Shifted<S> {
        let behind = self.length - self.left.end;
        Shifted::new(self.length, self.attached.clone(), behind)
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
        let rows = || matrix.chunks_exact(self.length.max(1)).skip(first).take(n);
        if !self.made {
            for (number, row) in rows().enumerate() {
                let by_coordinates = row.get(..first).unwrap_or_default();
                self.by_coordinates.set_row(number, by_coordinates);
            }
        }
        for (number, row) in rows().enumerate() {
            let own = row.get(self.left.clone()).unwrap_or_default();
            self.factor.set_row(number, own);
        }
        self.factor.take_from_diagonal(n, shift);
        for (one, eliminated) in self.attached.iter().zip(&mut self.eliminated) {
            *eliminated = Eliminated::new(one, shift, (matrix, self.length));
            for (speed, along) in one.speeds.clone().zip(&eliminated.along) {
                for (coordinate, part) in one.at.clone().zip(along) {
                    let by = (&self.by_coordinates, coordinate, *part);
                    self.factor.add_column(speed - first, by);
                }
            }
        }
        self.factor.decompose(&mut self.triangles);
        (self.made, self.shift) = (true, shift);
        true
    }

    /// Solves in place for the matrix that was factored, which is given again.
    pub(crate) fn solve(&mut self, matrix: &[T], right: &mut [T]) {
        let (coordinates, rest) = right.split_at_mut(self.left.start);
        let (left, behind) = rest.split_at_mut(self.left.len());
        let [by, solved] = &mut self.right;
        let part = T::one() / self.shift;
        for (one, eliminated) in self.attached.iter().zip(&self.eliminated) {
            let own = coordinates.get_mut(one.at.clone()).unwrap_or_default();
            if let (Ok(own), true) = (<&mut Four<T>>::try_from(&mut *own), one.turns()) {
                let quaternion = *own;
                *own = [T::zero(); SIDE];
                add_tile(own, &eliminated.inverse, &quaternion);
            } else {
                own.iter_mut().for_each(|x| *x *= part);
            }
        }
        write(by, coordinates);
        write(solved, left);
        self.by_coordinates.add_product(by, solved);
        self.factor.substitute(&self.triangles, solved);
        for (x, solved) in left.iter_mut().zip(solved.as_flattened()) {
            *x = -*solved;
        }
        for (one, eliminated) in self.attached.iter().zip(&self.eliminated) {
            let own = coordinates.get_mut(one.at.clone()).unwrap_or_default();
            let speeds = left.get(one.speeds.start - self.left.start..);
            for (speed, column) in speeds
                .unwrap_or_default()
                .iter()
                .zip(&eliminated.along)
                .take(one.speeds.len())
            {
                for (x, along) in own.iter_mut().zip(column) {
                    *x += *along * *speed;
                }
            }
        }
        for (row, x) in behind.iter_mut().enumerate() {
            let by_state = line(matrix, self.length, self.left.end + row);
            let (by_coordinates, by_rest) = by_state.split_at(self.left.start);
            *x = (*x + dot(by_coordinates, coordinates) + dot(by_rest, left)) / self.shift;
        }
    }
}

/// Writes a list in fours.
fn write<T: Real>(to: &mut [Four<T>], list: &[T]) {
    let to = to.as_flattened_mut().iter_mut();
    to.zip(list).for_each(|(to, x)| *to = *x);
}

fn line<T>(matrix: &[T], length: usize, row: usize) -> &[T] {
    matrix
        .get(row * length..(row + 1) * length)
        .unwrap_or_default()
}

/// Σ a b over the shorter list.
fn dot<T: Real>(a: &[T], b: &[T]) -> T {
    a.iter().zip(b).fold(T::zero(), |sum, (a, b)| sum + *a * *b)
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
        let mut x: [f64; 2] = [1.0, 1.0];
        shifted.solve(&a, &mut x);
        assert!(!x[0].is_finite());
    }
}
