//! Small dense matrices in tiles of 4 × 4: products and triangular solutions take four rows at a time, in loops of a length that the compiler knows.
//!
//! ```text
//! P M = L U,   l_ip = m_ip/u_pp,   M_ij −= l_ip u_pj                    column by column, the largest of a column as its pivot        (1)
//! x ← U⁻¹ L⁻¹ P x                                                                                                               (2)
//! ```
//!
//! Rows and columns are filled up with zeros to whole tiles. The numbers may be those of several matrices, a lane each: every lane takes its own rows as
//! pivots and leaves out its own zeros, so that it gets the numbers that it gets alone. Source: G. H. Golub, C. F. Van Loan, *Matrix Computations*, 3.4, outer products.

use mbd_scene::Real;

/// How many rows and columns a tile has.
pub(crate) const SIDE: usize = 4;
/// Four numbers of a vector.
pub(crate) type Four<T> = [T; SIDE];
/// A tile, column by column.
pub(crate) type Tile<T> = [Four<T>; SIDE];

/// A vector as long as some numbers, in fours.
pub(crate) fn fours<T: Real>(length: usize) -> Vec<Four<T>> {
    vec![[T::zero(); SIDE]; length.div_ceil(SIDE)]
}

/// A matrix.
#[derive(Clone, Debug)]
pub(crate) struct Tiles<T> {
    /// How many tiles stand beside each other.
    across: usize,
    /// Row by row.
    tiles: Vec<Tile<T>>,
}

impl<T: Real> Tiles<T> {
    /// A matrix of zeros.
    pub(crate) fn new(rows: usize, columns: usize) -> Self {
        let across = columns.div_ceil(SIDE);
        Tiles {
            across,
            tiles: vec![[[T::zero(); SIDE]; SIDE]; rows.div_ceil(SIDE) * across],
        }
    }

    /// Writes a row.
    pub(crate) fn set_row(&mut self, row: usize, values: &[T]) {
        let tiles = self.row_mut(row / SIDE);
        for (to, x) in tiles.as_flattened_mut().iter_mut().zip(values) {
            to[row % SIDE] = *x;
        }
    }

    /// Takes a number from every element of the diagonal.
    pub(crate) fn take_from_diagonal(&mut self, n: usize, x: T) {
        let across = self.across;
        for row in 0..n {
            if let Some(tile) = self.tiles.get_mut(row / SIDE * (across + 1)) {
                tile[row % SIDE][row % SIDE] -= x;
            }
        }
    }

    /// Adds a part of a column of another matrix with as many rows to one of this.
    pub(crate) fn add_column(&mut self, column: usize, (other, by, part): (&Self, usize, T)) {
        let nothing = is_zero(part);
        let holds = Holds::of::<T>(nothing);
        if holds == Holds::Everywhere {
            return;
        }
        let rows = self.tiles.chunks_exact_mut(self.across.max(1));
        for (own, other) in rows.zip(other.tiles.chunks_exact(other.across.max(1))) {
            let sum = &mut own[column / SIDE][column % SIDE];
            let before = *sum;
            add(sum, &other[by / SIDE][by % SIDE], part);
            if holds == Holds::Somewhere {
                keep(nothing, &before, sum);
            }
        }
    }

    /// A row of tiles.
    fn row_mut(&mut self, row: usize) -> &mut [Tile<T>] {
        let own = row * self.across..(row + 1) * self.across;
        self.tiles.get_mut(own).unwrap_or_default()
    }

    /// y += M x.
    pub(crate) fn add_product(&self, x: &[Four<T>], y: &mut [Four<T>]) {
        for (row, sum) in self.tiles.chunks_exact(self.across.max(1)).zip(y) {
            for (tile, x) in row.iter().zip(x) {
                add_tile(sum, tile, x);
            }
        }
    }

    /// Factors a square matrix in place, by (1). Without an inverse of the matrix its solutions are not finite.
    pub(crate) fn decompose(&mut self, factor: &mut Triangles<T>) {
        let n = factor.exchanges.len();
        let pivots = factor.exchanges.chunks_mut(SIDE).zip(&mut factor.inverse);
        let triangles = factor.lower.iter_mut().zip(&mut factor.upper);
        for (panel, ((exchanges, inverse), (lower, upper))) in pivots.zip(triangles).enumerate() {
            for (inside, (exchange, inverse)) in exchanges.iter_mut().zip(&mut *inverse).enumerate()
            {
                let pivot = panel * SIDE + inside;
                *exchange = self.largest_below(pivot, n);
                self.exchange(pivot, *exchange, n);
                *inverse = T::one() / self.at(pivot, pivot);
                self.eliminate(panel, inside, *inverse);
            }
            let diagonal = self.tiles[panel * (self.across + 1)];
            for (column, elements) in diagonal.iter().enumerate() {
                for (row, x) in elements.iter().enumerate() {
                    let (below, above) = (row > column, row < column);
                    lower[column][row] = if below { *x } else { T::zero() };
                    upper[column][row] = if above { *x * inverse[row] } else { T::zero() };
                }
            }
            self.update(panel, lower);
        }
    }

    /// The row from the diagonal on in which a column is largest.
    fn largest_below(&self, column: usize, n: usize) -> Exchange<T> {
        let (mut most, mut size, mut last) = (number(column), T::zero(), column);
        let rows = self.tiles.chunks_exact(self.across).enumerate();
        for (first, tiles) in rows.skip(column / SIDE) {
            let own = &tiles[column / SIDE][column % SIDE];
            for (row, x) in (first * SIDE..n).zip(own) {
                let larger = size.lt(x.abs());
                if row >= column && Holds::of::<T>(larger) != Holds::Nowhere {
                    most = T::select(larger, number(row), most);
                    size = T::select(larger, x.abs(), size);
                    last = row;
                }
            }
        }
        match most == number(last) {
            true => Exchange::One(last),
            false => Exchange::Own(most),
        }
    }

    fn at(&self, row: usize, column: usize) -> T {
        let tile = self.tiles.get(row / SIDE * self.across + column / SIDE);
        tile.map_or(T::zero(), |tile| tile[column % SIDE][row % SIDE])
    }

    /// Exchanges the row of a pivot with the one that was found for it.
    fn exchange(&mut self, pivot: usize, with: Exchange<T>, n: usize) {
        match with {
            Exchange::One(row) => self.swap(pivot, row),
            Exchange::Own(rows) => {
                for row in pivot + 1..n {
                    self.swap_where(is_zero(rows - number(row)), pivot, row);
                }
            }
        }
    }

    /// Exchanges rows in some lanes.
    fn swap_where(&mut self, mask: T::Mask, a: usize, b: usize) {
        if Holds::of::<T>(mask) == Holds::Nowhere {
            return;
        }
        for across in 0..self.across {
            let [one, other] = [a, b].map(|row| row / SIDE * self.across + across);
            for column in 0..SIDE {
                let above = self.tiles[one][column][a % SIDE];
                let below = self.tiles[other][column][b % SIDE];
                self.tiles[one][column][a % SIDE] = T::select(mask, below, above);
                self.tiles[other][column][b % SIDE] = T::select(mask, above, below);
            }
        }
    }

    fn swap(&mut self, a: usize, b: usize) {
        if a == b {
            return;
        }
        for across in 0..self.across {
            let [one, other] = [a, b].map(|row| row / SIDE * self.across + across);
            for column in 0..SIDE {
                let kept = self.tiles[one][column][a % SIDE];
                self.tiles[one][column][a % SIDE] = self.tiles[other][column][b % SIDE];
                self.tiles[other][column][b % SIDE] = kept;
            }
        }
    }

    /// Takes the row of a pivot out of those below it, in its column of tiles.
    fn eliminate(&mut self, panel: usize, inside: usize, inverse: T) {
        let rows = self.tiles.chunks_exact_mut(self.across).skip(panel);
        let mut along = [T::zero(); SIDE];
        for (number, row) in rows.enumerate() {
            let tile = &mut row[panel];
            if number == 0 {
                along = tile.map(|column| column[inside]);
            }
            let mut parts = [T::zero(); SIDE];
            for (row, (part, x)) in parts.iter_mut().zip(&mut tile[inside]).enumerate() {
                // In the tile of the diagonal the rows down to the pivot stay.
                if number > 0 || row > inside {
                    *x *= inverse;
                    *part = *x;
                }
            }
            for (column, along) in tile.iter_mut().zip(along).skip(inside + 1) {
                take(column, &parts, along);
            }
        }
    }

    /// Takes the rows of a column of tiles that is done out of all columns behind it; `lower` is L in its tile of the diagonal.
    fn update(&mut self, panel: usize, lower: &Tile<T>) {
        let (above, below) = self.tiles.split_at_mut((panel + 1) * self.across);
        let (_, own) = above.split_at_mut(panel * (self.across + 1) + 1);
        for column in own.as_flattened_mut() {
            for (number, elements) in lower.iter().enumerate() {
                let x = column[number];
                take(column, elements, x);
            }
        }
        for row in below.chunks_exact_mut(self.across) {
            let (done, rest) = row.split_at_mut(panel + 1);
            let parts = done[panel];
            // Most bodies do not see each other.
            let nothing = is_zero_tile(&parts);
            let holds = Holds::of::<T>(nothing);
            if holds == Holds::Everywhere {
                continue;
            }
            let columns = rest.as_flattened_mut().iter_mut();
            for (column, own) in columns.zip(own.as_flattened()) {
                let before = *column;
                take_tile(column, &parts, own);
                if holds == Holds::Somewhere {
                    keep(nothing, &before, column);
                }
            }
        }
    }

    /// Solves in place with the factors of a square matrix, by (2).
    pub(crate) fn substitute(&self, factor: &Triangles<T>, x: &mut [Four<T>]) {
        let list = x.as_flattened_mut();
        for (pivot, exchange) in factor.exchanges.iter().enumerate() {
            match *exchange {
                Exchange::One(row) => list.swap(pivot, row),
                Exchange::Own(rows) => swap_each(list, pivot, rows, factor.exchanges.len()),
            }
        }
        let rows = self.tiles.chunks_exact(self.across.max(1)).enumerate();
        for ((number, row), lower) in rows.clone().zip(&factor.lower) {
            let (done, rest) = x.split_at_mut(number);
            let Some(own) = rest.first_mut() else {
                return;
            };
            let mut solved = *own;
            for (tile, x) in row.iter().zip(done) {
                take_tile(&mut solved, tile, x);
            }
            for (column, elements) in lower.iter().enumerate() {
                let x = solved[column];
                take(&mut solved, elements, x);
            }
            *own = solved;
        }
        let diagonal = factor.upper.iter().zip(&factor.inverse);
        for ((number, row), (upper, inverse)) in rows.zip(diagonal).rev() {
            let (_, rest) = x.split_at_mut(number);
            let Some((own, done)) = rest.split_first_mut() else {
                return;
            };
            let mut solved = *own;
            for (tile, x) in row.iter().skip(number + 1).zip(done) {
                take_tile(&mut solved, tile, x);
            }
            for (x, inverse) in solved.iter_mut().zip(inverse) {
                *x *= *inverse;
            }
            for (column, elements) in upper.iter().enumerate().rev() {
                let x = solved[column];
                take(&mut solved, elements, x);
            }
            *own = solved;
        }
    }
}

/// The row that is taken for a pivot.
#[derive(Clone, Copy, Debug)]
enum Exchange<T> {
    /// The same in all lanes.
    One(usize),
    /// One a lane, by its number.
    Own(T),
}

/// What solutions need of a factored matrix beside its tiles.
#[derive(Clone, Debug)]
pub(crate) struct Triangles<T> {
    /// The row that is taken for each pivot.
    exchanges: Vec<Exchange<T>>,
    /// 1/u_pp.
    inverse: Vec<Four<T>>,
    /// L below the diagonal, and U above it with its rows over u_pp, in the tiles of the diagonal.
    lower: Vec<Tile<T>>,
    upper: Vec<Tile<T>>,
}

impl<T: Real> Triangles<T> {
    /// Those of n rows.
    pub(crate) fn new(n: usize) -> Self {
        let tiles = vec![[[T::zero(); SIDE]; SIDE]; n.div_ceil(SIDE)];
        Triangles {
            exchanges: vec![Exchange::One(0); n],
            inverse: fours(n),
            lower: tiles.clone(),
            upper: tiles,
        }
    }
}

/// y += M x of a tile.
pub(crate) fn add_tile<T: Real>(y: &mut Four<T>, tile: &Tile<T>, x: &Four<T>) {
    for (column, x) in tile.iter().zip(x) {
        add(y, column, *x);
    }
}

/// y −= M x of a tile.
fn take_tile<T: Real>(y: &mut Four<T>, tile: &Tile<T>, x: &Four<T>) {
    for (column, x) in tile.iter().zip(x) {
        take(y, column, *x);
    }
}

/// y += x a.
fn add<T: Real>(y: &mut Four<T>, x: &Four<T>, a: T) {
    for (y, x) in y.iter_mut().zip(x) {
        *y = x.fmadd(a, *y);
    }
}

/// y −= x a.
fn take<T: Real>(y: &mut Four<T>, x: &Four<T>, a: T) {
    for (y, x) in y.iter_mut().zip(x) {
        *y = x.fnmadd(a, *y);
    }
}

/// In which lanes a condition holds; a number has one.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Holds {
    Everywhere,
    Somewhere,
    Nowhere,
}

impl Holds {
    fn of<T: Real>(mask: T::Mask) -> Self {
        let one = T::select(mask, T::one(), T::zero());
        if one == T::zero() {
            Holds::Nowhere
        } else if one == T::one() {
            Holds::Everywhere
        } else {
            Holds::Somewhere
        }
    }
}

/// The number of a row.
fn number<T: Real>(row: usize) -> T {
    T::from_f64(row as f64)
}

/// Where a number is zero, of either sign.
fn is_zero<T: Real>(x: T) -> T::Mask {
    T::both(x.le(T::zero()), T::zero().le(x))
}

/// Where all elements of a tile are zero.
fn is_zero_tile<T: Real>(tile: &Tile<T>) -> T::Mask {
    let zero = is_zero(T::zero());
    let elements = tile.as_flattened().iter();
    elements.fold(zero, |all, x| T::both(all, is_zero(*x)))
}

/// Takes back what changed where a mask says so.
fn keep<T: Real>(mask: T::Mask, before: &Four<T>, now: &mut Four<T>) {
    for (now, before) in now.iter_mut().zip(before) {
        *now = T::select(mask, *before, *now);
    }
}

/// Exchanges a number of a list with another of the first `n`, which every lane says for itself.
fn swap_each<T: Real>(list: &mut [T], pivot: usize, rows: T, n: usize) {
    let Some((own, rest)) = list.get_mut(pivot..n).and_then(<[T]>::split_first_mut) else {
        return;
    };
    for (row, other) in (pivot + 1..).zip(rest) {
        let here = is_zero(rows - number(row));
        let (above, below) = (*own, *other);
        *own = T::select(here, below, above);
        *other = T::select(here, above, below);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{Lanes, Lanes4};

    /// Elements without a pattern, zero on the diagonal: pivots are found below it.
    fn element(row: usize, column: usize) -> f64 {
        match row == column {
            true => 0.0,
            false => ((7 * row * row + 3 * column + 1) as f64).sin(),
        }
    }

    #[test]
    fn solutions_obey_their_system_whatever_its_length() {
        for n in 2..14 {
            let mut matrix = Tiles::new(n, n);
            for row in 0..n {
                let values: Vec<f64> = (0..n).map(|column| element(row, column)).collect();
                matrix.set_row(row, &values);
            }
            let product = matrix.clone();
            let mut factor = Triangles::new(n);
            matrix.decompose(&mut factor);
            let mut x: Vec<Four<f64>> = fours(n);
            let right = |i: usize| (i as f64 + 0.5).cos();
            for (i, x) in x.as_flattened_mut().iter_mut().enumerate().take(n) {
                *x = right(i);
            }
            matrix.substitute(&factor, &mut x);
            let mut sums = fours(n);
            product.add_product(&x, &mut sums);
            for (i, sum) in sums.as_flattened().iter().enumerate().take(n) {
                let off = sum - right(i);
                assert!(off.abs() < 1e-12, "{n} rows, row {i}: {off:e}");
            }
            let filled = x.as_flattened().iter().skip(n);
            assert!(filled.into_iter().all(|x| *x == 0.0), "{n} rows");
        }
    }
    /// The matrix of a lane: others have their pivots elsewhere, and zeros, of a number and of a whole tile.
    fn element_of(lane: usize, row: usize, column: usize) -> f64 {
        let (tile, other) = (row / SIDE, column / SIDE);
        match lane {
            1 if tile != other => 0.0,
            2 if row == column + 1 => -0.0,
            3 if tile > other => -0.0,
            _ => element(row + lane * 5, column + lane * 2),
        }
    }

    /// A factored matrix after a part of one of its columns was added to another, and a solution, number by number.
    fn solved<T: Real>(n: usize, of: impl Fn(usize, usize) -> T, part: T) -> Vec<T> {
        let mut matrix = Tiles::new(n, n);
        for row in 0..n {
            let values: Vec<T> = (0..n).map(|column| of(row, column)).collect();
            matrix.set_row(row, &values);
        }
        let other = matrix.clone();
        matrix.add_column(n - 1, (&other, 0, part));
        let mut factor = Triangles::new(n);
        matrix.decompose(&mut factor);
        let mut x = fours(n);
        for (row, x) in x.as_flattened_mut().iter_mut().enumerate().take(n) {
            *x = of(row, n);
        }
        matrix.substitute(&factor, &mut x);
        let tiles = matrix.tiles.as_flattened().as_flattened().iter();
        tiles.chain(x.as_flattened()).copied().collect()
    }

    #[test]
    fn a_matrix_in_a_lane_has_the_factor_and_the_solution_that_it_has_alone() {
        let part = |lane: usize| if lane == 2 { 0.0 } else { 0.5 };
        for n in 2..14 {
            let beside = solved(
                n,
                |row, column| Lanes4::each(|lane| element_of(lane, row, column)),
                Lanes4::each(part),
            );
            for lane in 0..4 {
                let alone = solved(n, |row, column| element_of(lane, row, column), part(lane));
                for (at, (beside, alone)) in beside.iter().zip(&alone).enumerate() {
                    let own = beside.lane(lane);
                    let same = own.to_bits() == alone.to_bits() || own.is_nan() && alone.is_nan();
                    assert!(same, "{n} rows, lane {lane}, {at}: {own:e} {alone:e}");
                }
            }
        }
    }
}
