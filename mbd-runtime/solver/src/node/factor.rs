//! Cholesky factor of a symmetric positive definite matrix of small square blocks, sparse by structure.
//!
//! ```text
//! P A Pᵀ = L Lᵀ,   L_jj L_jjᵀ = A_jj − Σ_k L_jk L_jkᵀ,   L_ij = (A_ij − Σ_k L_ik L_jkᵀ) L_jj⁻ᵀ
//! ```
//!
//! The elimination order (least degree, ties by index) and the fill are found once from the pattern; factor and solve then follow fixed
//! lists and allocate nothing. A pivot that is not positive is reported, never repaired here.

use mbd_scene::Float;

/// A block of `B` × `B` numbers, row by row.
pub type Block<T, const B: usize> = [[T; B]; B];

/// A block-sparse Cholesky factor with a fixed pattern.
#[derive(Clone, Debug)]
pub struct BlockCholesky<T, const B: usize> {
    /// Elimination step of each block row.
    place: Vec<usize>,
    /// Block row of each elimination step.
    order: Vec<usize>,
    /// First slot of each column of L: its diagonal block; then the blocks below, `columns[n]` ends the last.
    columns: Vec<usize>,
    /// Elimination step of the row of each slot.
    rows: Vec<usize>,
    /// (row, column) of each input block.
    pattern: Vec<(usize, usize)>,
    /// Per input block: its slot in L, and whether it is stored transposed there.
    sources: Vec<(usize, bool)>,
    /// Per column the updates (target slot, left slot, right slot) it causes; `updates_of[j]..updates_of[j + 1]` belong to column j.
    updates: Vec<(usize, usize, usize)>,
    updates_of: Vec<usize>,
    blocks: Vec<Block<T, B>>,
    right: Vec<[T; B]>,
}

impl<T: Float, const B: usize> BlockCholesky<T, B> {
    /// A factor for `size` block rows whose structural non-zero blocks are `pattern`, (row, column) in any order and either triangle;
    /// a diagonal that is not listed starts at zero. Entries outside the matrix are ignored.
    #[must_use]
    pub fn new(size: usize, pattern: &[(usize, usize)]) -> Self {
        let pattern: Vec<(usize, usize)> = pattern
            .iter()
            .copied()
            .filter(|&(row, column)| row < size && column < size)
            .collect();
        let (order, touched) = least_degree(size, &pattern);
        let mut place = vec![0; size];
        for (step, &row) in order.iter().enumerate() {
            place[row] = step;
        }
        let mut columns = Vec::with_capacity(size + 1);
        let mut rows = Vec::new();
        for (j, touched) in touched.iter().enumerate() {
            columns.push(rows.len());
            rows.push(j);
            let below = rows.len();
            rows.extend(touched.iter().map(|&row| place[row]));
            rows[below..].sort_unstable();
        }
        columns.push(rows.len());
        let slot = |i: usize, j: usize| {
            (columns[j]..columns[j + 1])
                .find(|&slot| rows[slot] == i)
                .unwrap_or(columns[j])
        };
        let sources = pattern
            .iter()
            .map(|&(row, column)| {
                let (i, j) = (place[row], place[column]);
                (slot(i.max(j), i.min(j)), i < j)
            })
            .collect();
        let (mut updates, mut updates_of) = (Vec::new(), vec![0]);
        for j in 0..size {
            for left in columns[j] + 1..columns[j + 1] {
                for right in columns[j] + 1..=left {
                    updates.push((slot(rows[left], rows[right]), left, right));
                }
            }
            updates_of.push(updates.len());
        }
        BlockCholesky {
            blocks: vec![[[T::zero(); B]; B]; rows.len()],
            right: vec![[T::zero(); B]; size],
            pattern,
            place,
            order,
            columns,
            rows,
            sources,
            updates,
            updates_of,
        }
    }

    /// Number of block rows.
    fn size(&self) -> usize {
        self.order.len()
    }

    /// (row, column) of each block of the pattern.
    #[must_use]
    pub fn pattern(&self) -> &[(usize, usize)] {
        &self.pattern
    }

    /// Number of blocks of L, fill included.
    #[must_use]
    pub fn stored(&self) -> usize {
        self.blocks.len()
    }

    /// Factors A + shift · 1. `block(k)` gives the k-th block of the pattern. `false`: a pivot is not positive.
    #[must_use]
    pub fn factor(&mut self, shift: T, block: impl Fn(usize) -> Block<T, B>) -> bool {
        for target in &mut self.blocks {
            *target = [[T::zero(); B]; B];
        }
        for (k, &(slot, transposed)) in self.sources.iter().enumerate() {
            let value = block(k);
            for (a, row) in value.iter().enumerate() {
                for (b, &x) in row.iter().enumerate() {
                    let (a, b) = if transposed { (b, a) } else { (a, b) };
                    self.blocks[slot][a][b] += x;
                }
            }
        }
        for j in 0..self.size() {
            let diagonal = self.columns[j];
            for (a, row) in self.blocks[diagonal].iter_mut().enumerate() {
                row[a] += shift;
            }
            if !triangle(&mut self.blocks[diagonal]) {
                return false;
            }
            let pivot = self.blocks[diagonal];
            for slot in diagonal + 1..self.columns[j + 1] {
                for row in &mut self.blocks[slot] {
                    forward(&pivot, row);
                }
            }
            for &(target, left, right) in &self.updates[self.updates_of[j]..self.updates_of[j + 1]]
            {
                let (l, r) = (self.blocks[left], self.blocks[right]);
                for (row, l) in self.blocks[target].iter_mut().zip(&l) {
                    for (x, r) in row.iter_mut().zip(&r) {
                        *x -= dot(l, r);
                    }
                }
            }
        }
        true
    }

    /// Solves A x = b in place with the last factor. `x` holds b, `B` numbers a block row; a slice of a wrong length is left alone.
    pub fn solve(&mut self, x: &mut [T]) {
        if x.len() != B * self.size() {
            return;
        }
        for (row, values) in x.chunks_exact(B).enumerate() {
            self.right[self.place[row]].copy_from_slice(values);
        }
        for j in 0..self.size() {
            let mut known = self.right[j];
            forward(&self.blocks[self.columns[j]], &mut known);
            self.right[j] = known;
            for slot in self.columns[j] + 1..self.columns[j + 1] {
                let target = &mut self.right[self.rows[slot]];
                for (value, row) in target.iter_mut().zip(&self.blocks[slot]) {
                    *value -= dot(row, &known);
                }
            }
        }
        for j in (0..self.size()).rev() {
            let mut known = self.right[j];
            for slot in self.columns[j] + 1..self.columns[j + 1] {
                let from = self.right[self.rows[slot]];
                for (row, y) in self.blocks[slot].iter().zip(from) {
                    for (value, &x) in known.iter_mut().zip(row) {
                        *value -= x * y;
                    }
                }
            }
            backward(&self.blocks[self.columns[j]], &mut known);
            self.right[j] = known;
        }
        for (row, values) in x.chunks_exact_mut(B).enumerate() {
            values.copy_from_slice(&self.right[self.place[row]]);
        }
    }
}

/// Eliminates the row of least degree first, ties by index: the order, and the rows that each touches when it goes, fill included.
fn least_degree(size: usize, pattern: &[(usize, usize)]) -> (Vec<usize>, Vec<Vec<usize>>) {
    let mut joined = vec![vec![false; size]; size];
    for &(a, b) in pattern.iter().filter(|(a, b)| a != b) {
        (joined[a][b], joined[b][a]) = (true, true);
    }
    let mut left: Vec<usize> = (0..size).collect();
    let (mut order, mut touched) = (Vec::with_capacity(size), Vec::with_capacity(size));
    let degree = |joined: &[Vec<bool>], left: &[usize], row: usize| {
        left.iter().filter(|&&other| joined[row][other]).count()
    };
    while let Some(&next) = left
        .iter()
        .min_by_key(|&&row| (degree(&joined, &left, row), row))
    {
        left.retain(|&row| row != next);
        let own = left.iter().copied().filter(|&row| joined[row][next]);
        let own: Vec<usize> = own.collect();
        for &a in &own {
            own.iter().for_each(|&b| joined[a][b] |= a != b);
        }
        order.push(next);
        touched.push(own);
    }
    (order, touched)
}

fn dot<T: Float, const B: usize>(a: &[T; B], b: &[T; B]) -> T {
    let mut sum = T::zero();
    for (&x, &y) in a.iter().zip(b) {
        sum += x * y;
    }
    sum
}

/// Dense Cholesky of one block in its lower triangle.
fn triangle<T: Float, const B: usize>(a: &mut Block<T, B>) -> bool {
    for j in 0..B {
        for i in j..B {
            let mut sum = a[i][j];
            for (&x, &y) in a[i].iter().zip(&a[j]).take(j) {
                sum -= x * y;
            }
            if i > j {
                a[i][j] = sum / a[j][j];
            } else if sum > T::zero() && sum.is_finite() {
                a[j][j] = sum.sqrt();
            } else {
                return false;
            }
        }
    }
    true
}

/// x ← L⁻¹ x.
fn forward<T: Float, const B: usize>(l: &Block<T, B>, x: &mut [T; B]) {
    for i in 0..B {
        let mut sum = x[i];
        for (&l, &x) in l[i].iter().zip(x.iter()).take(i) {
            sum -= l * x;
        }
        x[i] = sum / l[i][i];
    }
}

/// x ← L⁻ᵀ x.
fn backward<T: Float, const B: usize>(l: &Block<T, B>, x: &mut [T; B]) {
    for i in (0..B).rev() {
        let mut sum = x[i];
        for k in i + 1..B {
            sum -= l[k][i] * x[k];
        }
        x[i] = sum / l[i][i];
    }
}
