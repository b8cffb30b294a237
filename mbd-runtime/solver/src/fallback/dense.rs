//! The equations of motion under joints without structure, for states at which the emitted solver loses its rows or its digits. In `f64`
//! whatever the scalar of the run.
//!
//! ```text
//! M = L Lᵀ,   Y = Φ_v L⁻ᵀ = R Q,  Q Qᵀ = I          rows chosen, R lower triangular                    (1)
//! w = z + Qᵀ c,  c = R⁻¹ γ − Q z,  z = L⁻¹ (f − h),  v̇ = L⁻ᵀ w,  λ = R⁻ᵀ c                              (2)
//! δ = −L⁻ᵀ Qᵀ R⁻¹ r                                                                                    (3)
//! ```
//!
//! (1) is Gram–Schmidt, each row twice: it loses the condition of Y, not its square as a factor of Φ_v M⁻¹ Φ_vᵀ would.
//! Where masses differ by many decades the symmetric form loses digits that the whole matrix keeps,
//!
//! ```text
//! [M  Φ_vᵀ] [ v̇]   [f − h]
//! [Φ_v   0] [−λ] = [  γ  ]     by elimination with row exchange, not scaled, residuals of the solution in twice the digits        (4)
//! ```
//!
//! and in the same way the move that goes along the normals at the start of a step and takes out rows at its end,
//!
//! ```text
//! [M      Φ_vᵀ] [ δ]   [ 0]
//! [Φ_v⁺     0 ] [−μ] = [−r]                                                                            (5)
//! ```

mod blend;
mod regularised;

use std::ops::Range;

use mbd_scene::orthogonal::{dot, subtract, take_out};

use super::limits::CORRECTIONS;

/// Room for one scene.
#[derive(Clone, Debug, Default)]
pub(crate) struct Dense {
    nv: usize,
    nc: usize,
    /// Part of a row that must be new for it to be chosen: a pivot of its square.
    pub new_from: f64,
    /// M (n_v × n_v).
    pub mass: Vec<f64>,
    /// For every speed the mass of the part it moves.
    pub weights: Vec<f64>,
    /// How large y is at least of a row that is not gone, squared (n_c) [1/kg, 1/(kg m²)]; zero where it cannot vanish.
    pub least: Vec<f64>,
    /// Φ_v (n_c × n_v).
    pub jacobian: Vec<f64>,
    /// Φ_v at the end of a step, for (5); empty otherwise.
    ahead: Vec<f64>,
    /// γ or r (n_c).
    pub right: Vec<f64>,
    /// f − h, then v̇ or δ (n_v).
    pub force: Vec<f64>,
    /// The largest acceleration without rows.
    free: f64,
    /// λ of the last accelerations (n_c); zero for rows that were not chosen.
    pub multipliers: Vec<f64>,
    lower: Vec<f64>,
    /// Where each row of L begins: what stands before is zero (n_v).
    begins: Vec<usize>,
    /// Q, a row a chosen row.
    units: Vec<f64>,
    /// Where the numbers of each row of Q lie that are not zero (n_c).
    spans: Vec<Range<usize>>,
    /// R, row by row (n_c × n_c).
    mix: Vec<f64>,
    /// Where each row of a factor in `mix` begins (n_c).
    mix_begins: Vec<usize>,
    /// R⁻¹ γ; what is left of rows.
    along: Vec<f64>,
    rest: Vec<f64>,
    /// What of y of every row is new against those chosen so far (n_c × n_v), and the size of y (n_c), zero of those that were chosen.
    news: Vec<f64>,
    sizes: Vec<f64>,
    /// The size of what is new over that of y (n_c).
    new_sizes: Vec<f64>,
    /// The speeds that the last direction has.
    moved: Vec<usize>,
    whole: Vec<f64>,
    unknowns: Vec<f64>,
    spare: Vec<f64>,
    exchange: Vec<usize>,
}

impl Dense {
    pub(crate) fn new(nv: usize, nc: usize, new_from: f64) -> Self {
        let size = nv + nc;
        Dense {
            nv,
            nc,
            new_from,
            mass: vec![0.0; nv * nv],
            weights: vec![1.0; nv],
            least: vec![0.0; nc],
            jacobian: vec![0.0; nc * nv],
            ahead: Vec::new(),
            right: vec![0.0; nc],
            force: vec![0.0; nv],
            free: 0.0,
            multipliers: vec![0.0; nc],
            lower: vec![0.0; nv * nv],
            begins: vec![0; nv],
            units: vec![0.0; nc * nv],
            spans: vec![0..nv; nc],
            mix: vec![0.0; nc * nc],
            mix_begins: vec![0; nc],
            along: vec![0.0; nc],
            rest: vec![0.0; nv],
            news: vec![0.0; nc * nv],
            sizes: vec![0.0; nc],
            new_sizes: vec![0.0; nc],
            moved: Vec::with_capacity(nv),
            whole: Vec::new(),
            unknowns: vec![0.0; size],
            spare: vec![0.0; size],
            exchange: vec![0; size],
        }
    }

    fn row(&self, row: usize) -> &[f64] {
        self.jacobian
            .get(row * self.nv..(row + 1) * self.nv)
            .unwrap_or(&[])
    }

    /// Says that these speeds move one part; the first is a velocity of its centre of mass.
    pub(crate) fn set_mass(&mut self, speeds: Range<usize>) {
        let mass = self.mass.get(speeds.start * (self.nv + 1)).copied();
        let weights = self.weights.get_mut(speeds).unwrap_or_default();
        weights.fill(mass.unwrap_or(1.0));
    }

    /// The least size of y of a row as if every part had the mass 1; a tree has one for all.
    fn least(&self, row: usize) -> f64 {
        let weight = self.weights.first().copied().unwrap_or(1.0);
        (weight * self.least.get(row).copied().unwrap_or(0.0)).sqrt()
    }

    /// L of (1).
    fn factor_mass(&mut self) {
        self.lower.copy_from_slice(&self.mass);
        self.factor_lower();
    }

    /// L of (1) as if every part had the mass 1: whether rows are independent is a matter of lengths alone.
    fn factor_lengths(&mut self) {
        let n = self.nv;
        for (i, weight) in self.weights.iter().enumerate() {
            for j in 0..n {
                self.lower[i * n + j] = self.mass[i * n + j] / weight;
            }
        }
        self.factor_lower();
    }

    /// L in place; a row of it begins where the row of the matrix does.
    fn factor_lower(&mut self) {
        Self::begins(&mut self.begins, &self.lower, self.nv);
        Self::factor_square(&mut self.lower, &self.begins, self.nv);
    }

    /// Where each row of the lower half of a matrix begins: what stands before is zero, in its factor, too.
    fn begins(begins: &mut [usize], lower: &[f64], n: usize) {
        let rows = lower.chunks_exact(n.max(1));
        for (at, (begin, row)) in begins.iter_mut().zip(rows).enumerate() {
            *begin = row.iter().take(at).position(|x| *x != 0.0).unwrap_or(at);
        }
    }

    /// Cholesky of a symmetric matrix in place, from its lower half, of which each row is zero before it `begins`, where that is told.
    fn factor_square(lower: &mut [f64], begins: &[usize], n: usize) {
        let begin = |row: usize| begins.get(row).copied().unwrap_or(0);
        for i in 0..n {
            for j in begin(i)..=i {
                let mut total = lower[i * n + j];
                for k in begin(i).max(begin(j))..j {
                    total -= lower[i * n + k] * lower[j * n + k];
                }
                lower[i * n + j] = if i == j {
                    total.sqrt()
                } else {
                    total / lower[j * n + j]
                };
            }
        }
    }

    /// x ← L⁻¹ x. Of the parts of a row those are left out that are zero: before it `begins`, where that is told, and before x does.
    fn forward(lower: &[f64], begins: &[usize], x: &mut [f64]) {
        let n = x.len();
        let first = x.iter().position(|x| *x != 0.0).unwrap_or(n);
        for i in first..n {
            let begin = begins.get(i).map_or(first, |begin| first.max(*begin));
            let known: f64 = (begin..i).map(|k| lower[i * n + k] * x[k]).sum();
            x[i] = (x[i] - known) / lower[i * n + i];
        }
    }

    /// x ← L⁻ᵀ x.
    fn backward(lower: &[f64], x: &mut [f64]) {
        let n = x.len();
        for i in (0..n).rev() {
            let known: f64 = (i + 1..n).map(|k| lower[k * n + i] * x[k]).sum();
            x[i] = (x[i] - known) / lower[i * n + i];
        }
    }

    /// Writes y of a row less what rows so far have of it into `rest`, its parts into line `at` of R; the sizes before and after.
    fn reduce(&mut self, row: usize, at: usize) -> [f64; 2] {
        let nc = self.nc;
        let mut rest = std::mem::take(&mut self.rest);
        rest.copy_from_slice(self.row(row));
        Self::forward(&self.lower, &self.begins, &mut rest);
        let before = dot(&rest, &rest).sqrt();
        let line = &mut self.mix[at * nc..at * nc + at];
        line.fill(0.0);
        let units = units(&self.units, self.nv, &self.spans[..at]);
        take_out(&mut rest, units, |known, along| line[known] += along);
        let after = dot(&rest, &rest).sqrt();
        self.rest = rest;
        [before, after]
    }

    /// Takes `rest`, of this size, as the next direction.
    fn add(&mut self, at: usize, size: f64) {
        let (n, nc) = (self.nv, self.nc);
        self.mix[at * nc + at] = size;
        let unit = &mut self.units[at * n..(at + 1) * n];
        let numbers = unit.iter_mut().zip(&self.rest);
        numbers.for_each(|(u, x)| *u = x / size);
        self.spans[at] = span(unit);
    }

    /// Chooses rows: the one with most that is new first, until nothing is. From `mass`, `weights` and `jacobian`; (1) is to be factorised.
    pub(crate) fn choose(&mut self, chosen: &mut Vec<usize>) {
        self.factor_lengths();
        chosen.clear();
        self.new_of_rows();
        while let Some(row) = self.newest() {
            let at = chosen.len();
            let [_, after] = self.reduce(row, at);
            self.add(at, after);
            let unit = &self.units[at * self.nv..(at + 1) * self.nv];
            // Most directions have few speeds: the others change nothing.
            self.moved.clear();
            let speeds = unit.iter().enumerate().filter(|(_, x)| **x != 0.0);
            self.moved.extend(speeds.map(|(speed, _)| speed));
            // Nobody asks again what of a row that was chosen is new.
            self.sizes[row] = 0.0;
            let news = self.news.chunks_exact_mut(unit.len());
            let news = news.zip(&self.sizes).zip(&mut self.new_sizes);
            for ((new, size), new_size) in news.filter(|((_, size), _)| **size != 0.0) {
                let along: f64 = self.moved.iter().map(|&k| new[k] * unit[k]).sum();
                // Most rows have no speed in common.
                if along != 0.0 {
                    self.moved.iter().for_each(|&k| new[k] -= along * unit[k]);
                    *new_size = dot(new, new).sqrt() / size;
                }
            }
            chosen.push(row);
        }
    }

    /// Puts y of every row into `news`, its size into `sizes`: all of it is new as long as none is chosen.
    fn new_of_rows(&mut self) {
        self.news.copy_from_slice(&self.jacobian);
        for row in 0..self.nc {
            let new = &mut self.news[row * self.nv..(row + 1) * self.nv];
            Self::forward(&self.lower, &self.begins, new);
            let size = dot(new, new).sqrt();
            self.sizes[row] = size.max(self.least(row));
            self.new_sizes[row] = size / self.sizes[row];
        }
    }

    /// The row with the largest part that is new, the first of those that are as good.
    fn newest(&self) -> Option<usize> {
        let mut best: Option<(usize, f64)> = None;
        let rows = self.new_sizes.iter().zip(&self.sizes);
        for (row, (&new, size)) in rows.enumerate() {
            if *size == 0.0 {
                continue;
            }
            if new > self.new_from && best.is_none_or(|(_, most)| new > 1.25 * most) {
                best = Some((row, new));
            }
        }
        best.map(|(row, _)| row)
    }

    /// Whether rows that were chosen are still independent.
    pub(crate) fn are_independent(&mut self, chosen: &[usize]) -> bool {
        self.independence(chosen) > self.new_from
    }

    /// The smallest part of one of these rows that is new against those before it.
    pub(crate) fn independence(&mut self, rows: &[usize]) -> f64 {
        self.factor_lengths();
        self.span(rows, &|dense, row| dense.least(row))
    }

    /// Factorises (1) for rows that were chosen.
    pub(crate) fn factor(&mut self, chosen: &[usize]) {
        self.factor_mass();
        self.span(chosen, &|_, _| 0.0);
    }

    /// Q and R of rows; the smallest part of one that is new, of its size or of what that is `at_least`.
    fn span(&mut self, chosen: &[usize], at_least: &dyn Fn(&Self, usize) -> f64) -> f64 {
        let mut least = 1.0;
        for (at, &row) in chosen.iter().enumerate() {
            let [before, after] = self.reduce(row, at);
            let before = before.max(at_least(self, row));
            self.add(at, after);
            least = f64::min(least, if before > 0.0 { after / before } else { 0.0 });
        }
        least
    }

    /// R⁻¹ of the chosen right-hand sides.
    fn find_along(&mut self, chosen: &[usize]) {
        for (i, &row) in chosen.iter().enumerate() {
            let line = &self.mix[i * self.nc..];
            let known = dot(&line[..i], &self.along[..i]);
            self.along[i] = (self.right[row] - known) / line[i];
        }
    }

    /// v̇ by (2) into `force`.
    pub(crate) fn accelerate(&mut self, chosen: &[usize]) {
        self.find_along(chosen);
        Self::forward(&self.lower, &self.begins, &mut self.force);
        self.rest.copy_from_slice(&self.force);
        Self::backward(&self.lower, &mut self.rest);
        self.free = largest(&self.rest);
        let units = units(&self.units, self.nv, &self.spans[..chosen.len()]);
        for ((first, unit), along) in units.zip(&mut self.along) {
            let force = &mut self.force[first..];
            *along -= dot(unit, force);
            subtract(force, -*along, unit);
        }
        Self::backward(&self.lower, &mut self.force);
        self.multipliers.fill(0.0);
        for (i, &row) in chosen.iter().enumerate().rev() {
            let later = chosen.iter().enumerate().skip(i + 1);
            let known =
                later.map(|(k, &other)| self.mix[k * self.nc + i] * self.multipliers[other]);
            self.multipliers[row] =
                (self.along[i] - known.sum::<f64>()) / self.mix[i * self.nc + i];
        }
    }

    /// The largest |Φ_v v̇ − γ| of all rows over the largest terms, with and without rows, after [`Dense::accelerate`]; NaN where a number is.
    pub(crate) fn left(&self) -> f64 {
        let (mut left, mut scale) = (0.0, largest(&self.right));
        // Of a row that is all but gone the terms say nothing: a row as large as it is elsewhere would have these.
        let rates = self.mass.chunks_exact(self.nv).zip(&self.force);
        let square = rates.map(|(row, rate)| rate * dot(row, &self.force));
        let square = square.sum::<f64>();
        let rows = self.jacobian.chunks_exact(self.nv).zip(&self.least);
        for ((row, least), right) in rows.zip(&self.right) {
            let terms = row.iter().zip(&self.force);
            let terms = terms.map(|(a, b)| a.abs() * b.abs().max(self.free));
            scale = scale.max(terms.sum()).max((least * square).sqrt());
            let miss = (dot(row, &self.force) - right).abs();
            left = if miss <= left { left } else { miss };
        }
        if left == 0.0 { 0.0 } else { left / scale }
    }

    /// δ by (3) into `force`.
    pub(crate) fn correct(&mut self, chosen: &[usize]) {
        self.find_along(chosen);
        self.force.fill(0.0);
        let units = units(&self.units, self.nv, &self.spans[..chosen.len()]);
        for ((first, unit), along) in units.zip(&self.along) {
            subtract(&mut self.force[first..], *along, unit);
        }
        Self::backward(&self.lower, &mut self.force);
    }

    /// v̇ by (4) into `force`; the size of the last correction over that of the solution.
    pub(crate) fn accelerate_whole(&mut self, chosen: &[usize]) -> f64 {
        let (n, size) = (self.nv, self.nv + chosen.len());
        let mut whole = std::mem::take(&mut self.whole);
        // Most runs never come here: its room is made at the first use.
        whole.resize(size * size, 0.0);
        for i in 0..size {
            for j in 0..size {
                whole[i * size + j] = self.element(chosen, i, j);
            }
        }
        self.eliminate(&mut whole, size);
        self.unknowns.fill(0.0);
        for _ in 0..=CORRECTIONS {
            for i in 0..size {
                let right = match i.checked_sub(n) {
                    None => self.force[i],
                    Some(row) => self.right[chosen[row]],
                };
                let products = (0..size).map(|j| (-self.element(chosen, i, j), self.unknowns[j]));
                self.spare[i] = precise(right, products);
            }
            self.solve(&whole, size);
            let news = self.unknowns.iter_mut().zip(&self.spare);
            news.take(size).for_each(|(x, more)| *x += more);
        }
        self.whole = whole;
        self.force.copy_from_slice(&self.unknowns[..n]);
        self.multipliers.fill(0.0);
        for (&row, unknown) in chosen.iter().zip(&self.unknowns[n..]) {
            self.multipliers[row] = -unknown;
        }
        match largest(&self.spare[..n]) / largest(&self.force) {
            settled if settled.is_finite() => settled,
            _ if self.force.iter().all(|x| *x == 0.0) => 0.0,
            _ => f64::INFINITY,
        }
    }

    /// δ by (5) into `force`; Φ_v⁺ is in `ahead` (n_c × n_v), r in `right`.
    pub(crate) fn correct_across(&mut self, chosen: &[usize], ahead: &mut Vec<f64>) {
        std::mem::swap(&mut self.ahead, ahead);
        self.force.fill(0.0);
        self.right.iter_mut().for_each(|row| *row = -*row);
        self.accelerate_whole(chosen);
        std::mem::swap(&mut self.ahead, ahead);
    }

    /// Element of the matrix of (4), or of (5).
    fn element(&self, chosen: &[usize], i: usize, j: usize) -> f64 {
        let n = self.nv;
        match (i.checked_sub(n), j.checked_sub(n)) {
            (None, None) => self.mass[i * n + j],
            (Some(row), None) => {
                let ends = [&self.ahead, &self.jacobian];
                ends[usize::from(self.ahead.is_empty())][chosen[row] * n + j]
            }
            (None, Some(row)) => self.jacobian[chosen[row] * n + i],
            (Some(_), Some(_)) => 0.0,
        }
    }

    /// L U with row exchange, in place.
    fn eliminate(&mut self, whole: &mut [f64], size: usize) {
        for k in 0..size {
            let largest = (k..size).fold(k, |best, i| {
                let larger = whole[i * size + k].abs() > whole[best * size + k].abs();
                if larger { i } else { best }
            });
            self.exchange[k] = largest;
            if largest != k {
                for j in 0..size {
                    whole.swap(k * size + j, largest * size + j);
                }
            }
            for i in k + 1..size {
                let factor = whole[i * size + k] / whole[k * size + k];
                whole[i * size + k] = factor;
                if factor != 0.0 {
                    for j in k + 1..size {
                        whole[i * size + j] -= factor * whole[k * size + j];
                    }
                }
            }
        }
    }

    /// Solves L U x = `spare` in place.
    fn solve(&mut self, whole: &[f64], size: usize) {
        let x = &mut self.spare;
        for k in 0..size {
            x.swap(k, self.exchange[k]);
        }
        for i in 0..size {
            x[i] -= dot(&whole[i * size..i * size + i], &x[..i]);
        }
        for i in (0..size).rev() {
            let known = dot(&whole[i * size + i + 1..(i + 1) * size], &x[i + 1..size]);
            x[i] = (x[i] - known) / whole[i * size + i];
        }
    }
}

/// Where the numbers of a list lie that are not zero.
fn span(list: &[f64]) -> Range<usize> {
    let first = list.iter().position(|x| *x != 0.0);
    let last = list.iter().rposition(|x| *x != 0.0);
    first
        .zip(last)
        .map_or(0..0, |(first, last)| first..last + 1)
}

/// Rows of Q as far as they are not zero, each with the place of its first number.
fn units<'a>(
    numbers: &'a [f64],
    nv: usize,
    spans: &'a [Range<usize>],
) -> impl Iterator<Item = (usize, &'a [f64])> + Clone {
    let rows = numbers.chunks_exact(nv.max(1)).zip(spans);
    rows.map(|(row, span)| (span.start, &row[span.clone()]))
}

/// The largest size; NaN where a number is.
fn largest(list: &[f64]) -> f64 {
    list.iter()
        .fold(0.0, |most, x| if x.abs() <= most { most } else { x.abs() })
}

/// first + Σ a b with twice the digits: errors of sums and of products are summed beside (Ogita, Rump, Oishi 2005, Dot2).
fn precise(first: f64, products: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (mut sum, mut low) = (first, 0.0);
    for (a, b) in products {
        let product = a * b;
        let error = a.mul_add(b, -product);
        let total = sum + product;
        let back = total - sum;
        low += (sum - (total - back)) + (product - back) + error;
        sum = total;
    }
    sum + low
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_that_cancel_keep_their_digits() {
        let products = [(1e16, 1.0), (1.0, 1.0), (-1e16, 1.0)];
        assert_eq!(precise(0.0, products.into_iter()), 1.0);
    }

    /// A body of mass 2 and one of mass 3 that two rows tie to each other, one of them twice.
    pub(super) fn pair() -> Dense {
        let mut dense = Dense::new(2, 2, 1e-5);
        dense.mass = vec![2.0, 0.0, 0.0, 3.0];
        dense.weights = vec![2.0, 3.0];
        dense.jacobian = vec![1.0, -1.0, 2.0, -2.0];
        dense.right = vec![0.5, 1.0];
        dense.force = vec![10.0, 0.0];
        dense
    }

    #[test]
    fn a_row_that_repeats_another_is_not_chosen_and_both_forms_agree() {
        let mut dense = pair();
        let mut chosen = Vec::new();
        dense.choose(&mut chosen);
        assert_eq!(chosen, [0]);
        dense.factor(&chosen);
        dense.accelerate(&chosen);
        let (a, b) = (dense.force[0], dense.force[1]);
        assert!((a - b - 0.5).abs() < 1e-14 && (2.0 * a + 3.0 * b - 10.0).abs() < 1e-13);
        // The row pushes the second body: 3 b = −λ.
        let push = dense.multipliers.clone();
        assert!(
            (3.0 * b + push[0]).abs() < 1e-13 && push[1] == 0.0,
            "{push:?}"
        );
        let mut whole = pair();
        whole.accelerate_whole(&chosen);
        assert!((whole.force[0] - a).abs() < 1e-14 && (whole.force[1] - b).abs() < 1e-14);
        assert!((whole.multipliers[0] - push[0]).abs() < 1e-13);
        let mut moved = pair();
        moved.factor(&chosen);
        moved.correct(&chosen);
        // Momentum is kept, the row gives −0.5.
        let (a, b) = (moved.force[0], moved.force[1]);
        assert!((a - b + 0.5).abs() < 1e-14 && (2.0 * a + 3.0 * b).abs() < 1e-14);
    }
}
