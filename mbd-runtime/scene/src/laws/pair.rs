//! A body and the joint that carries it, taken out of the system together: substitution instead of pivots.
//!
//! ```text
//! [M_dd M_fdᵀ Nᵀ] [ d]   [r_d]      d, f: dependent and free speeds of the body (see [`Partition`])
//! [M_fd M_ff  0 ] [ f] = [r_f]      C_o, B_o: couplings of another node o to d and to λ
//! [N    0     0 ] [−λ]   [r_λ]                                                                                  (1)
//! free: pivots M_ff, with their fill into M_dd, C_o and the other nodes                                         (2)
//! dependent: d = ρ + Σ X_o o,  ρ = N⁻¹ r_λ,  X_o = −N⁻¹ B_oᵀ                                                    (3)
//! fill: K_oo′ += X_oᵀ P_o′ + C_o X_o′,  P_o = M_dd X_o + C_oᵀ;  r_o += X_oᵀ (r_d − M_dd ρ) − C_o ρ              (4)
//! −λ = N⁻ᵀ (r_d − M_dd d − Σ C_oᵀ o)                                                                            (5)
//! ```
//!
//! On a tree every C is zero and (2) to (4) are the articulated-body recursion: after (2), M_dd is the inertia that the joint hands inboard.
//! Rows make it exact off the constraints too. N′, the block of at most three attitude rows, is inverted in closed form. Two kinds:
//! - the rows hold the body's point and some of its turns (`turned.rs`): N = diag(I, N′), I as large as there are directions of motion;
//! - they lock it to its parent, up to ways that slide (`locked.rs`): d is all its speeds, as its parent's, X = I, and f the ways.
//!
//! Source: Featherstone, articulated-body algorithm.

use nalgebra::{Matrix3, Vector3};

use super::block::System;
use crate::elimination::{Below, Elimination, Step};
use crate::{Partition, Real};

/// Most speeds of a body.
pub(super) const MOST: usize = 6;

/// The steps of a body and of the joint that carries it.
#[derive(Clone, Copy)]
pub(super) struct Pair<'a> {
    pub(super) body: &'a Step,
    pub(super) joint: &'a Step,
    pub(super) partition: Partition,
    /// Number of speeds of the body.
    pub(super) speeds: usize,
    /// Number of directions of motion among them: the first ones.
    pub(super) moves: usize,
    /// Number of attitude rows.
    pub(super) turns: usize,
    /// Number of rows.
    pub(super) rows: usize,
    /// Number of dependent speeds: that of the rows, or all of the parent's.
    pub(super) held: usize,
}

impl<'a> Pair<'a> {
    pub(super) fn new(plan: &'a Elimination, index: usize) -> Option<Self> {
        let body = plan.steps.get(index)?;
        let joint = plan.steps.get(index + 1)?;
        let partition = body.partition?;
        Some(Pair {
            body,
            joint,
            partition,
            speeds: body.size,
            moves: if body.size == MOST { 3 } else { 2 },
            turns: partition.turns,
            rows: joint.size,
            held: partition.held(body.size),
        })
    }

    /// Number of ways that slide, where the joint locks the body to its parent.
    pub(super) fn ways(&self) -> Option<usize> {
        self.partition.locked.map(|ways| ways.free)
    }

    /// How many of the dependent speeds the rows tell as they are: N = I.
    fn plain(&self) -> usize {
        if self.partition.locked.is_some() {
            self.held
        } else {
            self.moves
        }
    }

    /// Couplings of the body to others than its joint, which is the next step and so the first of all.
    pub(super) fn others(&self) -> &'a [Below] {
        self.body.below.get(1..).unwrap_or_default()
    }

    /// The coupling of the body to a node, if there is one.
    fn coupling(&self, step: usize) -> Option<&'a Below> {
        self.others().iter().find(|below| below.step == step)
    }

    /// The speeds that are left when free speed `f` goes.
    pub(super) fn left(&self, f: usize) -> impl DoubleEndedIterator<Item = usize> + Clone + use<> {
        (0..self.held).chain(f + 1..self.speeds)
    }

    /// The place of element (i, j) of N′⁻¹.
    fn inverse_at(&self, i: usize, j: usize) -> usize {
        self.joint.diagonal + self.turns * i + j
    }

    /// Whether η are other components than those of ω′; in a plane there is one only.
    pub(super) fn turned(&self) -> bool {
        self.speeds == MOST && (self.turns == 1 || self.turns == 2)
    }
}

impl<S: Real> System<S> {
    /// Takes the pair of step `index` and the next one out of the matrix.
    pub(super) fn factor_pair(&mut self, plan: &Elimination, index: usize) {
        let Some(pair) = Pair::new(plan, index) else {
            return;
        };
        let directions = self.directions(&pair);
        let mut mass = self.mass_of(&pair);
        if let Some(e) = &directions {
            self.turn(plan, &pair, e, &mut mass);
        }
        let n = pair.speeds;
        for k in 0..pair.ways().unwrap_or(0) {
            self.slide(plan, &pair, k, &mut mass);
        }
        for f in pair.held..n {
            self.free(plan, &pair, f, &mut mass);
        }
        for (i, row) in mass.iter().enumerate().take(n) {
            let at = pair.body.diagonal + n * i;
            self.store[at..at + n].copy_from_slice(&row[..n]);
        }
        self.invert_rows(&pair, directions.as_ref());
        self.substitute(plan, &pair, &mass);
    }

    /// The full block of the body.
    fn mass_of(&self, pair: &Pair<'_>) -> [[S; MOST]; MOST] {
        let (at, n) = (pair.body.diagonal, pair.speeds);
        let mut mass = [[S::zero(); MOST]; MOST];
        for (i, row) in mass.iter_mut().enumerate().take(n) {
            for (j, element) in row.iter_mut().enumerate().take(n) {
                *element = self.store[at + n * i.max(j) + i.min(j)];
            }
        }
        mass
    }

    /// N′⁻¹ of the attitude rows, from their columns in the body.
    fn invert_rows(&mut self, pair: &Pair<'_>, directions: Option<&Matrix3<S>>) {
        let (k, at) = (pair.turns, pair.body.below[0].at);
        let mut rows = [0; 3];
        for (slot, row) in rows.iter_mut().zip(pair.partition.attitude().rows()) {
            *slot = at + pair.speeds * row + pair.moves;
        }
        let n = |i: usize, j: usize| {
            let row = |r: usize| self.store[rows[i] + r];
            match directions {
                Some(e) => sparse_dot((0..3).map(|r| (row(r), e[(r, j)]))),
                None => row(j),
            }
        };
        let inverse = match k {
            0 => return,
            1 => Matrix3::from_diagonal_element(S::one() / n(0, 0)),
            2 => {
                let (a, b, c, d) = (n(0, 0), n(0, 1), n(1, 0), n(1, 1));
                let scale = S::one() / (a * d - b * c);
                let zero = S::zero();
                let (a, b, c, d) = (a * scale, b * scale, c * scale, d * scale);
                Matrix3::new(d, -b, zero, -c, a, zero, zero, zero, zero)
            }
            _ => {
                let row = |i: usize| Vector3::from_fn(|j, _| n(i, j));
                let (a, b, c) = (row(0), row(1), row(2));
                let (bc, ca, ab) = (b.cross(&c), c.cross(&a), a.cross(&b));
                let scale = S::one() / a.dot(&bc);
                Matrix3::from_columns(&[bc, ca, ab]).map(|x| x * scale)
            }
        };
        for i in 0..k {
            for j in 0..k {
                self.scaled[pair.inverse_at(i, j)] = inverse[(i, j)];
            }
        }
    }

    /// Element (i, j) of N′⁻¹.
    pub(super) fn inverse_row(&self, pair: &Pair<'_>, i: usize, j: usize) -> S {
        self.scaled[pair.inverse_at(i, j)]
    }

    /// Takes the dependent speeds and the rows out, by (3) and (4). Leaves X_oᵀ in `scaled`, P_oᵀ in `store`.
    fn substitute(&mut self, plan: &Elimination, pair: &Pair<'_>, mass: &[[S; MOST]; MOST]) {
        let n = pair.held;
        for below in &pair.joint.below {
            let coupling = pair.coupling(below.step);
            for row in 0..plan.steps[below.step].size {
                let at = below.at + n * row;
                let mut x = [S::zero(); MOST];
                for (i, x) in x.iter_mut().enumerate().take(n) {
                    *x = match i.checked_sub(pair.plain()) {
                        None => -self.store[at + i],
                        Some(i) => -sparse_dot((0..pair.turns).map(|j| {
                            let column = self.store[at + pair.moves + j];
                            (self.inverse_row(pair, i, j), column)
                        })),
                    };
                }
                let mut p = [S::zero(); MOST];
                for (e, &factor) in x.iter().enumerate().take(n) {
                    if !factor.is_zero() {
                        for (p, row) in p.iter_mut().zip(mass).take(n) {
                            *p += row[e] * factor;
                        }
                    }
                }
                if let Some(coupling) = coupling {
                    for (i, p) in p.iter_mut().enumerate().take(n) {
                        *p += self.store[coupling.at + pair.speeds * row + i];
                    }
                }
                self.scaled[at..at + n].copy_from_slice(&x[..n]);
                self.store[at..at + n].copy_from_slice(&p[..n]);
            }
        }
        for (i, below) in pair.joint.below.iter().enumerate() {
            let coupling = pair.coupling(below.step);
            for (other, &target) in pair.joint.below[..=i].iter().zip(&below.targets) {
                let columns = plan.steps[other.step].size;
                for row in 0..plan.steps[below.step].size {
                    let at = below.at + n * row;
                    for column in 0..last(below, other, row, columns) {
                        let from = other.at + n * column;
                        let mut total =
                            sparse_dot((0..n).map(|d| (self.scaled[at + d], self.store[from + d])));
                        if let Some(coupling) = coupling {
                            let own = coupling.at + pair.speeds * row;
                            total += sparse_dot(
                                (0..n).map(|d| (self.scaled[from + d], self.store[own + d])),
                            );
                        }
                        self.store[target + row * columns + column] += total;
                    }
                }
            }
        }
    }

    /// Takes a speed of the body that is eliminated out of the blocks of the nodes it is coupled to besides the joint, by (2): the product of
    /// a `factor` and what is `shared`, each at the beginning of a row of a coupling.
    pub(super) fn fill_others(
        &mut self,
        plan: &Elimination,
        pair: &Pair<'_>,
        factor: impl Fn(&Self, usize) -> S,
        shared: impl Fn(&Self, usize) -> S,
    ) {
        let n = pair.speeds;
        for (i, below) in pair.others().iter().enumerate() {
            let rows = plan.steps[below.step].size;
            // The first target is that of the joint.
            let targets = below.targets.iter().skip(1);
            for (other, &target) in pair.others()[..=i].iter().zip(targets) {
                let columns = plan.steps[other.step].size;
                for row in 0..rows {
                    let factor = factor(self, below.at + n * row);
                    if factor.is_zero() {
                        continue;
                    }
                    for column in 0..last(below, other, row, columns) {
                        let shared = shared(self, other.at + n * column);
                        if !shared.is_zero() {
                            self.store[target + row * columns + column] -= factor * shared;
                        }
                    }
                }
            }
        }
    }

    /// Carries the right-hand side of the pair of step `index` to the others, by (4).
    pub(super) fn carry_pair(&mut self, plan: &Elimination, index: usize) {
        let Some(pair) = Pair::new(plan, index) else {
            return;
        };
        let (first, rows, n) = (pair.body.first, pair.joint.first, pair.held);
        self.carry_free(plan, &pair);
        self.carry_ways(plan, &pair);
        if pair.partition.locked.is_some() {
            self.place(&pair);
        } else {
            self.turn_rows(&pair);
        }
        for d in 0..n {
            let held = (0..n).map(|e| (self.right[rows + e], self.mass_at(&pair, d, e)));
            let held = sparse_dot(held);
            self.right[first + d] -= held;
        }
        for below in &pair.joint.below {
            let later = &plan.steps[below.step];
            for row in 0..later.size {
                let at = below.at + n * row;
                let push = sparse_dot((0..n).map(|d| (self.scaled[at + d], self.right[first + d])));
                self.right[later.first + row] += push;
            }
        }
        for below in pair.others() {
            let later = &plan.steps[below.step];
            for row in 0..later.size {
                let at = below.at + pair.speeds * row;
                let held = sparse_dot((0..n).map(|d| (self.right[rows + d], self.store[at + d])));
                self.right[later.first + row] -= held;
            }
        }
    }

    /// Finds the unknowns of the pair of step `index` from those of the others, by (3), (5) and the pivots of (2).
    pub(super) fn find_pair(&mut self, plan: &Elimination, index: usize) {
        let Some(pair) = Pair::new(plan, index) else {
            return;
        };
        let (first, rows, n) = (pair.body.first, pair.joint.first, pair.held);
        let mut shift = [S::zero(); MOST];
        for below in &pair.joint.below {
            let later = &plan.steps[below.step];
            for row in 0..later.size {
                let value = self.right[later.first + row];
                let at = below.at + n * row;
                for (shift, &x) in shift.iter_mut().zip(&self.scaled[at..at + n]) {
                    if !x.is_zero() {
                        *shift += x * value;
                    }
                }
            }
        }
        let mut push = [S::zero(); MOST];
        for (d, push) in push.iter_mut().enumerate().take(n) {
            let held = (0..n).map(|e| (shift[e], self.mass_at(&pair, d, e)));
            *push = self.right[first + d] - sparse_dot(held);
            for below in pair.others() {
                let later = &plan.steps[below.step];
                *push -= sparse_dot((0..later.size).map(|row| {
                    let factor = self.store[below.at + pair.speeds * row + d];
                    (factor, self.right[later.first + row])
                }));
            }
        }
        for (d, &shift) in shift.iter().enumerate().take(n) {
            self.right[first + d] = self.right[rows + d] + shift;
        }
        if pair.partition.locked.is_some() {
            self.force(&pair, &push);
        } else {
            self.turn_forces(&pair, &push);
        }
        self.find_ways(plan, &pair);
        self.find_free(plan, &pair);
    }

    /// Element of the body's block after (2), in the speeds [d ; f].
    fn mass_at(&self, pair: &Pair<'_>, i: usize, j: usize) -> S {
        self.store[pair.body.diagonal + pair.speeds * i + j]
    }
}

/// Σ a b over the products in which neither is zero.
pub(super) fn sparse_dot<S: Real>(products: impl Iterator<Item = (S, S)>) -> S {
    products
        .filter(|(a, b)| !a.is_zero() && !b.is_zero())
        .fold(S::zero(), |sum, (a, b)| sum + a * b)
}

/// a b, where a is not zero.
pub(super) fn scale<S: Real>(a: S, b: S) -> S {
    if a.is_zero() { a } else { a * b }
}

/// The columns of a row of a block: of a diagonal block those of the lower triangle.
pub(super) fn last(below: &Below, other: &Below, row: usize, columns: usize) -> usize {
    if below.step == other.step {
        row + 1
    } else {
        columns
    }
}
