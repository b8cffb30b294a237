//! A body whose point a joint holds, and some of whose turns: the components η of its angular speeds that the rows determine, and those they
//! leave free. See [`super::pair`] for the numbers of the equations.

use nalgebra::{Matrix3, Vector3};

use super::block::System;
use super::pair::{MOST, Pair, scale, sparse_dot};
use crate::Real;
use crate::elimination::Elimination;

impl<S: Real> System<S> {
    /// Sets E of the body of a step: its columns are the directions of η, body axes.
    pub fn set_directions(&mut self, plan: &Elimination, index: usize, e: &Matrix3<S>) {
        if let Some(pair) = Pair::new(plan, index).filter(Pair::turned) {
            // The joint has no diagonal block of its own, and at least 3 × 3 numbers of room.
            let room = self.store.iter_mut().skip(pair.joint.diagonal);
            for (slot, &value) in room.zip(e.transpose().iter()) {
                *slot = value;
            }
        }
    }

    pub(super) fn directions(&self, pair: &Pair<'_>) -> Option<Matrix3<S>> {
        let at = pair.joint.diagonal;
        pair.turned()
            .then(|| Matrix3::from_fn(|i, j| self.store[at + 3 * i + j]))
    }

    /// Writes the body's block and its couplings in the components η.
    pub(super) fn turn(
        &mut self,
        plan: &Elimination,
        pair: &Pair<'_>,
        e: &Matrix3<S>,
        mass: &mut [[S; MOST]; MOST],
    ) {
        turn_mass(mass, e);
        for below in pair.others() {
            for row in 0..plan.steps[below.step].size {
                self.turn_row(below.at + pair.speeds * row + 3, e);
            }
        }
    }

    /// Three numbers of the store, a row vector: times E.
    fn turn_row(&mut self, at: usize, e: &Matrix3<S>) {
        let old = Vector3::from_fn(|j, _| self.store[at + j]);
        for j in 0..3 {
            self.store[at + j] = sparse_dot((0..3).map(|r| (old[r], e[(r, j)])));
        }
    }

    /// Takes free speed `f` out, by (2).
    pub(super) fn free(
        &mut self,
        plan: &Elimination,
        pair: &Pair<'_>,
        f: usize,
        mass: &mut [[S; MOST]; MOST],
    ) {
        let inverse = S::one() / mass[f][f];
        self.inverse[pair.body.first + f] = inverse;
        for i in pair.left(f) {
            let shared = mass[i][f];
            let factor = scale(shared, inverse);
            self.scaled[pair.body.diagonal + pair.speeds * f + i] = factor;
            if factor.is_zero() {
                continue;
            }
            for j in pair.left(f).take_while(|&j| j <= i) {
                if !mass[j][f].is_zero() {
                    mass[i][j] -= factor * mass[j][f];
                    mass[j][i] = mass[i][j];
                }
            }
        }
        for below in pair.others() {
            for row in 0..plan.steps[below.step].size {
                let at = below.at + pair.speeds * row;
                let factor = scale(self.store[at + f], inverse);
                self.scaled[at + f] = factor;
                if factor.is_zero() {
                    continue;
                }
                for i in pair.left(f) {
                    if !mass[i][f].is_zero() {
                        self.store[at + i] -= factor * mass[i][f];
                    }
                }
            }
        }
        let factor = |system: &Self, at: usize| system.scaled[at + f];
        let shared = |system: &Self, at: usize| system.store[at + f];
        self.fill_others(plan, pair, factor, shared);
    }

    /// Takes the right-hand sides of the free speeds out of the others, in the components η.
    pub(super) fn carry_free(&mut self, plan: &Elimination, pair: &Pair<'_>) {
        let (first, n) = (pair.body.first, pair.held);
        if let Some(e) = self.directions(pair) {
            self.turn_right(first + 3, &e.transpose());
        }
        for f in n..pair.speeds {
            let value = self.right[first + f];
            if value.is_zero() {
                continue;
            }
            for i in pair.left(f) {
                self.carry(pair.body.diagonal + pair.speeds * f + i, first + i, value);
            }
            for below in pair.others() {
                let later = &plan.steps[below.step];
                for row in 0..later.size {
                    self.carry(below.at + pair.speeds * row + f, later.first + row, value);
                }
            }
        }
    }

    /// Puts N′⁻¹ r_λ in the place of the right-hand sides of the attitude rows.
    pub(super) fn turn_rows(&mut self, pair: &Pair<'_>) {
        let at = pair.joint.first + pair.moves;
        let attitude: [S; 3] = std::array::from_fn(|i| {
            let columns = 0..pair.turns;
            match i < pair.turns {
                true => sparse_dot(columns.map(|j| {
                    let right = self.right[at + j];
                    (self.inverse_row(pair, i, j), right)
                })),
                false => S::zero(),
            }
        });
        self.right[at..at + pair.turns].copy_from_slice(&attitude[..pair.turns]);
    }

    /// Writes −λ for what the joint pushes with, by (5).
    pub(super) fn turn_forces(&mut self, pair: &Pair<'_>, push: &[S; MOST]) {
        let rows = pair.joint.first;
        self.right[rows..rows + pair.moves].copy_from_slice(&push[..pair.moves]);
        for j in 0..pair.turns {
            let columns =
                (0..pair.turns).map(|i| (self.inverse_row(pair, i, j), push[pair.moves + i]));
            self.right[rows + pair.moves + j] = sparse_dot(columns);
        }
    }

    /// Finds the free speeds by the pivots of (2), and ω′ = E η.
    pub(super) fn find_free(&mut self, plan: &Elimination, pair: &Pair<'_>) {
        let (first, n) = (pair.body.first, pair.held);
        for f in (n..pair.speeds).rev() {
            let mut total = scale(self.right[first + f], self.inverse[first + f]);
            for i in pair.left(f) {
                let factor = self.scaled[pair.body.diagonal + pair.speeds * f + i];
                if !factor.is_zero() {
                    total -= factor * self.right[first + i];
                }
            }
            for below in pair.others() {
                let later = &plan.steps[below.step];
                for row in 0..later.size {
                    let factor = self.scaled[below.at + pair.speeds * row + f];
                    if !factor.is_zero() {
                        total -= factor * self.right[later.first + row];
                    }
                }
            }
            self.right[first + f] = total;
        }
        if let Some(e) = self.directions(pair) {
            self.turn_right(first + 3, &e);
        }
    }

    /// Three numbers of the right-hand side: turned by a matrix.
    fn turn_right(&mut self, at: usize, e: &Matrix3<S>) {
        let old = Vector3::from_fn(|j, _| self.right[at + j]);
        for i in 0..3 {
            self.right[at + i] = sparse_dot((0..3).map(|j| (old[j], e[(i, j)])));
        }
    }
}

/// A body's block in the components η: Eᵀ of the angular rows and E of the angular columns.
fn turn_mass<S: Real>(mass: &mut [[S; MOST]; MOST], e: &Matrix3<S>) {
    let turned: [[S; 3]; 3] = std::array::from_fn(|i| {
        std::array::from_fn(|j| sparse_dot((0..3).map(|r| (mass[i][3 + r], e[(r, j)]))))
    });
    for (i, row) in turned.iter().enumerate() {
        for (j, &value) in row.iter().enumerate() {
            mass[i][3 + j] = value;
            mass[3 + j][i] = value;
        }
    }
    let half: [[S; 3]; 3] = std::array::from_fn(|i| {
        std::array::from_fn(|j| sparse_dot((0..3).map(|r| (mass[3 + i][3 + r], e[(r, j)]))))
    });
    for i in 0..3 {
        for j in 0..=i {
            mass[3 + i][3 + j] = sparse_dot((0..3).map(|r| (half[r][j], e[(r, i)])));
            mass[3 + j][3 + i] = mass[3 + i][3 + j];
        }
    }
}
