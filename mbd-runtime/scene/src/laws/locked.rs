//! A body that a joint locks to its parent, up to ways that slide: taken out of the system together with the joint, as one body with the
//! parent. See [`super::pair`] for the numbers of the equations.
//!
//! ```text
//! y = y_p + H u + ρ,   H = [h_k ; 0]                 y, y_p: unknowns of the body and of its parent, same point, same axes      (6)
//! u_k = (h_kᵀ r − g_kᵀ y − …)/D_k,  g_k = M h_k,  D_k = h_kᵀ g_k,   M −= g_k g_kᵀ/D_k, likewise for the couplings of others     (7)
//! ρ = [Lᵀ r_L − Λ ρ_ω ; ρ_ω],   ρ_ω = N′⁻¹ r_N       L: point rows, in world axes; Λ ω: velocity of the joint's point           (8)
//! −λ_L = L p_v,   −λ_N = N′⁻ᵀ (p_ω − Λᵀ p_v)         p: what the joint pushes with, from (5) with N = I                         (9)
//! ```
//!
//! What is left of M is the inertia that the joint hands inboard, and it is added to the parent's as it is. The h_k are at right angles to
//! the rows of L, and these to each other and of length one; in a plane, where rows are what lies in it, L⁻¹ stands for Lᵀ.
//! Source: Featherstone, articulated-body algorithm; composite bodies for what does not slide.

use nalgebra::Vector3;

use super::block::System;
use super::pair::{MOST, Pair, scale, sparse_dot};
use crate::Real;
use crate::elimination::{Below, Elimination};

impl<S: Real> System<S> {
    /// Says that the unknowns of the body which rides out with the joint of a step follow those of its parent.
    pub fn set_carried(&mut self, plan: &Elimination, joint: usize, parent: usize) {
        let (Some(at), Some(step)) = (plan.block(parent, joint), plan.steps.get(parent)) else {
            return;
        };
        for k in 0..step.size {
            if let Some(slot) = self.store.get_mut(at + step.size * k + k) {
                *slot = -S::one();
            }
        }
    }

    /// Sets a number of h_k (k < 3, world axes) or of row k − 3 of Λ for the body of a step.
    pub fn set_way(
        &mut self,
        plan: &Elimination,
        body: usize,
        (k, number): (usize, usize),
        value: S,
    ) {
        if let Some(pair) = Pair::new(plan, body).filter(|pair| k < 6 && pair.ways().is_some())
            && let Some(slot) = self.store.get_mut(pair.joint.diagonal + 3 * k + number)
        {
            *slot = value;
        }
    }

    /// Says what D_k of (7) is at least for the body of a step.
    pub fn set_least(&mut self, plan: &Elimination, body: usize, k: usize, value: S) {
        if let Some(pair) = Pair::new(plan, body).filter(|pair| k < 3 && pair.ways().is_some())
            && let Some(slot) = self.store.get_mut(pair.joint.diagonal + 18 + k)
        {
            *slot = value;
        }
    }

    /// h_k, among the speeds of a body.
    fn way(&self, pair: &Pair<'_>, k: usize) -> [S; MOST] {
        let at = pair.joint.diagonal + 3 * k;
        let held = |i: usize| i < pair.moves;
        std::array::from_fn(|i| {
            if held(i) {
                self.store[at + i]
            } else {
                S::zero()
            }
        })
    }

    /// Element (k, j) of Λ.
    fn lever(&self, pair: &Pair<'_>, k: usize, j: usize) -> S {
        self.store[pair.joint.diagonal + 9 + 3 * k + j]
    }

    /// The linear columns of a row of the joint.
    fn linear(&self, pair: &Pair<'_>, row: usize) -> [S; 3] {
        let at = pair.body.below[0].at + pair.speeds * row;
        std::array::from_fn(|k| {
            if k < pair.moves {
                self.store[at + k]
            } else {
                S::zero()
            }
        })
    }

    /// Takes way k out, by (7).
    pub(super) fn slide(
        &mut self,
        plan: &Elimination,
        pair: &Pair<'_>,
        k: usize,
        mass: &mut [[S; MOST]; MOST],
    ) {
        let (n, h) = (pair.speeds, self.way(pair, k));
        let along = |row: &[S]| sparse_dot(row.iter().zip(&h).map(|(&x, &h)| (x, h)));
        let g: [S; MOST] = std::array::from_fn(|i| along(&mass[i]));
        // Where much heavier bodies slide the same way, rounding of what they leave may be more than all that is there.
        let least = self.store[pair.joint.diagonal + 18 + k];
        let inverse = S::one() / along(&g).max(least);
        self.inverse[pair.body.first + k] = inverse;
        for i in 0..n {
            let factor = scale(g[i], inverse);
            self.scaled[pair.body.diagonal + n * k + i] = factor;
            if factor.is_zero() {
                continue;
            }
            for j in 0..=i {
                if !g[j].is_zero() {
                    mass[i][j] -= factor * g[j];
                    mass[j][i] = mass[i][j];
                }
            }
        }
        let each = |below: &Below| (0..plan.steps[below.step].size).map(move |row| n * row);
        for below in pair.others() {
            for at in each(below).map(|row| below.at + row) {
                self.scaled[at + k] = along(&self.store[at..at + n]);
            }
        }
        let shared = |system: &Self, at: usize| system.scaled[at + k];
        let factor = |system: &Self, at: usize| scale(shared(system, at), inverse);
        self.fill_others(plan, pair, factor, shared);
        for below in pair.others() {
            for at in each(below).map(|row| below.at + row) {
                let factor = scale(self.scaled[at + k], inverse);
                self.scaled[at + k] = factor;
                if factor.is_zero() {
                    continue;
                }
                for (i, &g) in g.iter().enumerate().take(n) {
                    if !g.is_zero() {
                        self.store[at + i] -= factor * g;
                    }
                }
            }
        }
    }

    /// Takes the right-hand sides of the ways out of the others.
    pub(super) fn carry_ways(&mut self, plan: &Elimination, pair: &Pair<'_>) {
        let (first, n) = (pair.body.first, pair.speeds);
        for k in 0..pair.ways().unwrap_or(0) {
            let h = self.way(pair, k);
            let value = sparse_dot((0..n).map(|i| (self.right[first + i], h[i])));
            self.right[pair.joint.first + n + k] = value;
            if value.is_zero() {
                continue;
            }
            for i in 0..n {
                self.carry(pair.body.diagonal + n * k + i, first + i, value);
            }
            for below in pair.others() {
                let later = &plan.steps[below.step];
                for row in 0..later.size {
                    self.carry(below.at + n * row + k, later.first + row, value);
                }
            }
        }
    }

    /// Puts ρ in the place of the right-hand sides of the rows, by (8).
    pub(super) fn place(&mut self, pair: &Pair<'_>) {
        let first = pair.joint.first;
        let mut given = [S::zero(); MOST];
        given[..pair.rows].copy_from_slice(&self.right[first..first + pair.rows]);
        let turned: [S; 3] = std::array::from_fn(|i| {
            let rows = (0..pair.turns).zip(pair.partition.attitude().rows());
            match i < pair.turns {
                true => sparse_dot(rows.map(|(j, row)| (self.inverse_row(pair, i, j), given[row]))),
                false => S::zero(),
            }
        });
        let held = self.held(pair, |row| given[row]);
        for k in 0..pair.moves {
            let shift = sparse_dot((0..pair.turns).map(|j| (self.lever(pair, k, j), turned[j])));
            self.right[first + k] = held[k] - shift;
        }
        for (j, &turned) in turned.iter().enumerate().take(pair.turns) {
            self.right[first + pair.moves + j] = turned;
        }
    }

    /// Lᵀ r for the point rows: in a plane L⁻¹ r.
    fn held(&self, pair: &Pair<'_>, right: impl Fn(usize) -> S) -> Vector3<S> {
        let mut held = Vector3::zeros();
        for (row, inverse) in self.inverse_points(pair) {
            let value = right(row);
            for (k, &x) in inverse.iter().enumerate() {
                if !x.is_zero() && !value.is_zero() {
                    held[k] += x * value;
                }
            }
        }
        held
    }

    /// The columns of Lᵀ, in a plane of L⁻¹, with the rows they belong to.
    fn inverse_points(&self, pair: &Pair<'_>) -> impl Iterator<Item = (usize, [S; 3])> + use<S> {
        let mut rows = pair.partition.points.rows();
        let mut columns = [None; 3];
        for (column, row) in columns.iter_mut().zip(&mut rows) {
            *column = Some((row, self.linear(pair, row)));
        }
        if pair.moves == 2 {
            let zero = S::zero();
            match columns {
                [Some((first, [a, b, _])), Some((second, [c, d, _])), _] => {
                    let scale = S::one() / (a * d - b * c);
                    columns[0] = Some((first, [d * scale, -(c * scale), zero]));
                    columns[1] = Some((second, [-(b * scale), a * scale, zero]));
                }
                [Some((first, [a, b, _])), ..] => {
                    let scale = S::one() / (a * a + b * b);
                    columns[0] = Some((first, [a * scale, b * scale, zero]));
                }
                _ => {}
            }
        }
        columns.into_iter().flatten()
    }

    /// Writes −λ for what the joint pushes with, by (9).
    pub(super) fn force(&mut self, pair: &Pair<'_>, push: &[S; MOST]) {
        let first = pair.joint.first;
        for (row, inverse) in self.inverse_points(pair) {
            let pushed = (0..pair.moves).map(|k| (inverse[k], push[k]));
            self.right[first + row] = sparse_dot(pushed);
        }
        let left: [S; 3] = std::array::from_fn(|j| {
            let levers = (0..pair.moves).filter(|_| j < pair.turns);
            let lever = sparse_dot(levers.map(|k| (self.lever(pair, k, j), push[k])));
            push.get(pair.moves + j).copied().unwrap_or_else(S::zero) - lever
        });
        for (j, row) in pair.partition.attitude().rows().enumerate() {
            let columns = (0..pair.turns).map(|i| (self.inverse_row(pair, i, j), left[i]));
            self.right[first + row] = sparse_dot(columns);
        }
    }

    /// Adds what slides to the unknowns of the body, by (7), the way taken out last first.
    pub(super) fn find_ways(&mut self, plan: &Elimination, pair: &Pair<'_>) {
        let (first, n) = (pair.body.first, pair.speeds);
        for k in (0..pair.ways().unwrap_or(0)).rev() {
            let value = self.right[pair.joint.first + n + k];
            let mut total = scale(value, self.inverse[first + k]);
            total -= sparse_dot((0..n).map(|i| {
                let factor = self.scaled[pair.body.diagonal + n * k + i];
                (factor, self.right[first + i])
            }));
            for below in pair.others() {
                let later = &plan.steps[below.step];
                for row in 0..later.size {
                    let factor = self.scaled[below.at + n * row + k];
                    if !factor.is_zero() {
                        total -= factor * self.right[later.first + row];
                    }
                }
            }
            for (i, h) in self.way(pair, k).into_iter().enumerate().take(n) {
                if !h.is_zero() {
                    self.right[first + i] += total * h;
                }
            }
        }
    }
}
