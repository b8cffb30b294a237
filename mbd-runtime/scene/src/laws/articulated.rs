//! A body and its parent joint, taken out of the system together: the articulated-body recursion, on the constraints and off them.
//!
//! ```text
//! V_c = Σ X_o V_o + ν + H u            o: the parent of the body, and others that it is coupled to            (1)
//! U = I_a h,  D = hᵀ U,  u = (hᵀ p − Uᵀ V − …)/D;   I_a −= U Uᵀ/D,  p −= U hᵀ p/D     for each column h of H   (2)
//! K_oo′ += X_oᵀ P_o′ + C_o X_o′,  P_o = I_a X_o + C_oᵀ                                                         (3)
//! p_o += X_oᵀ (p − I_a ν) − C_o ν                                                                              (4)
//! push = p − I_a V_c − Σ C_oᵀ V_o      what the joint pushes the body with                                     (5)
//! ```
//!
//! I_a is the block of the body, p its right-hand side, C_o its coupling to another node (zero on a tree), ν = N γ what the rows ask for.
//! X is that of the parent alone: a body that a joint lets turn is rigidly attached at the joint's point, up to H. After (2) I_a is the
//! inertia that the joint hands inboard, and I_a h is zero; where h is a unit vector its row and column are left out. All of this is in the
//! axes of the joint where it states some: the columns of T, ω = T ω_T.
//! Source: Featherstone, Rigid Body Dynamics Algorithms, articulated-body algorithm.

use nalgebra::Matrix3;

use super::block::System;
use crate::Real;
use crate::elimination::{Below, Elimination, Step};

/// Most speeds of a body.
pub(super) const MOST: usize = 6;

/// The steps of a body and of its parent joint.
#[derive(Clone, Copy)]
struct Pair<'a> {
    body: &'a Step,
    joint: &'a Step,
    /// Number of columns of H.
    free: usize,
    /// Number of speeds of the body.
    speeds: usize,
    /// Whether the joint states axes.
    axes: bool,
}

impl<'a> Pair<'a> {
    fn new(plan: &'a Elimination, index: usize) -> Option<Self> {
        let body = plan.steps.get(index)?;
        let carrying = body.carrying?;
        Some(Pair {
            body,
            joint: plan.steps.get(index + 1)?,
            free: carrying.free,
            speeds: body.size,
            axes: carrying.axes && body.size == MOST,
        })
    }

    /// Couplings of the body to others than its joint, which is the next step and so the first of all.
    fn others(&self) -> &'a [Below] {
        self.body.below.get(1..).unwrap_or_default()
    }

    /// The coupling of the body to a node, if there is one.
    fn coupling(&self, step: usize) -> Option<&'a Below> {
        self.others().iter().find(|below| below.step == step)
    }

    /// Where T is in the store.
    fn axes_at(&self) -> usize {
        self.joint.diagonal + (self.speeds + 1) * self.free
    }

    /// Where U/D of a column is in the scaled store.
    fn row(&self, column: usize) -> usize {
        self.body.diagonal + self.speeds * column
    }
}

impl<S: Real> System<S> {
    /// Sets element (i, j) of X of the body whose joint has this step, for the speeds j of its parent.
    pub fn set_transport(
        &mut self,
        plan: &Elimination,
        (joint, parent): (usize, usize),
        (i, j): (usize, usize),
        value: S,
    ) {
        let speeds = joint.checked_sub(1).and_then(|body| plan.steps.get(body));
        if let (Some(at), Some(body)) = (plan.block(parent, joint), speeds)
            && let Some(slot) = self.scaled.get_mut(at + body.size * j + i)
        {
            *slot = value;
        }
    }

    /// Sets a column of H of the body of a step, and what its pivot D is at least.
    pub fn set_free(
        &mut self,
        plan: &Elimination,
        body: usize,
        column: usize,
        values: impl Iterator<Item = S>,
        least: Option<S>,
    ) {
        if let Some(pair) = Pair::new(plan, body).filter(|pair| column < pair.free) {
            let at = pair.joint.diagonal + pair.speeds * column;
            for (slot, value) in self.store[at..at + pair.speeds].iter_mut().zip(values) {
                *slot = value;
            }
            let at = pair.joint.diagonal + pair.speeds * pair.free + column;
            self.store[at] = least.unwrap_or_else(S::zero);
        }
    }

    /// Sets T, the axes of the joint of the body of a step.
    pub fn set_axes(&mut self, plan: &Elimination, body: usize, axes: &Matrix3<S>) {
        if let Some(pair) = Pair::new(plan, body) {
            let at = pair.axes_at();
            self.store[at..at + 9].copy_from_slice(axes.as_slice());
        }
    }

    /// T, where the joint states axes.
    fn axes(&self, pair: &Pair<'_>) -> Option<Matrix3<S>> {
        let at = pair.axes_at();
        pair.axes
            .then(|| Matrix3::from_column_slice(&self.store[at..at + 9]))
    }

    /// A column of H.
    fn column(&self, pair: &Pair<'_>, column: usize) -> [S; MOST] {
        let at = pair.joint.diagonal + pair.speeds * column;
        let inside = |i: usize| (i < pair.speeds).then(|| self.store[at + i]);
        std::array::from_fn(|i| inside(i).unwrap_or_else(S::zero))
    }

    /// The speed along which a column of H is the only one, and the column is of length one.
    fn unit(&self, pair: &Pair<'_>, column: usize) -> Option<usize> {
        let h = self.column(pair, column);
        let mut own = (0..pair.speeds).filter(|&i| !h[i].is_zero());
        let one = own.next().filter(|&i| h[i].is_one());
        one.filter(|_| own.next().is_none())
    }

    /// Takes the pair of step `index` and the next one out of the matrix.
    pub(super) fn factor_pair(&mut self, plan: &Elimination, index: usize) {
        let Some(pair) = Pair::new(plan, index) else {
            return;
        };
        let n = pair.speeds;
        let mut inertia = self.inertia_of(&pair);
        if let Some(axes) = self.axes(&pair) {
            turn_inertia(&mut inertia, &axes);
            for below in pair.others() {
                for row in 0..plan.steps[below.step].size {
                    turn(&mut self.store[below.at + n * row + 3..], &axes);
                }
            }
        }
        for k in 0..pair.free {
            self.release(plan, &pair, k, &mut inertia);
        }
        for (i, row) in inertia.iter().enumerate().take(n) {
            let at = pair.body.diagonal + n * i;
            self.store[at..at + n].copy_from_slice(&row[..n]);
        }
        self.hand_on(plan, &pair, &inertia);
    }

    /// The full block of the body.
    fn inertia_of(&self, pair: &Pair<'_>) -> [[S; MOST]; MOST] {
        let (at, n) = (pair.body.diagonal, pair.speeds);
        let mut inertia = [[S::zero(); MOST]; MOST];
        for (i, row) in inertia.iter_mut().enumerate().take(n) {
            for (j, element) in row.iter_mut().enumerate().take(n) {
                *element = self.store[at + n * i.max(j) + i.min(j)];
            }
        }
        inertia
    }

    /// Takes column k of H out, by (2): of I_a, of the couplings to others and of what these fill.
    fn release(
        &mut self,
        plan: &Elimination,
        pair: &Pair<'_>,
        k: usize,
        inertia: &mut [[S; MOST]; MOST],
    ) {
        let (n, h) = (pair.speeds, self.column(pair, k));
        let unit = self.unit(pair, k);
        let along = |row: &[S]| sparse_dot(row.iter().zip(&h).map(|(&x, &h)| (x, h)));
        let u: [S; MOST] = std::array::from_fn(|i| along(&inertia[i]).label(LABELS_U[i]));
        // Where much heavier bodies move the same way, rounding of what they leave may be more than all that is there.
        let least = self.store[pair.joint.diagonal + n * pair.free + k];
        let mut pivot = along(&u);
        if !least.is_zero() {
            pivot = pivot.max(least);
        }
        let inverse = (S::one() / pivot.label("D")).label("inverse_D");
        self.inverse[pair.body.first + k] = inverse;
        for i in 0..n {
            let factor = if unit == Some(i) {
                S::zero()
            } else {
                scale(u[i], inverse)
            };
            self.scaled[pair.row(k) + i] = factor;
            for j in 0..=i {
                if unit == Some(i) || unit == Some(j) {
                    inertia[i][j] = S::zero();
                } else if !factor.is_zero() && !u[j].is_zero() {
                    inertia[i][j] -= factor * u[j];
                }
                inertia[j][i] = inertia[i][j];
            }
        }
        let rows = |below: &Below| {
            let at = below.at;
            (0..plan.steps[below.step].size).map(move |row| at + n * row)
        };
        for below in pair.others() {
            for at in rows(below) {
                self.scaled[at + k] = along(&self.store[at..at + n]);
            }
        }
        self.fill_others(plan, pair, k, inverse);
        for below in pair.others() {
            for at in rows(below) {
                let factor = scale(self.scaled[at + k], inverse);
                self.scaled[at + k] = factor;
                for (i, &u) in u.iter().enumerate().take(n) {
                    if unit == Some(i) {
                        self.store[at + i] = S::zero();
                    } else if !factor.is_zero() && !u.is_zero() {
                        self.store[at + i] -= factor * u;
                    }
                }
            }
        }
    }

    /// Takes column k of H out of the blocks of the nodes that the body is coupled to besides its joint.
    fn fill_others(&mut self, plan: &Elimination, pair: &Pair<'_>, k: usize, inverse: S) {
        let n = pair.speeds;
        for (i, below) in pair.others().iter().enumerate() {
            // The first target is that of the joint.
            let targets = below.targets.iter().skip(1);
            for (other, &target) in pair.others()[..=i].iter().zip(targets) {
                let columns = plan.steps[other.step].size;
                for row in 0..plan.steps[below.step].size {
                    let factor = scale(self.scaled[below.at + n * row + k], inverse);
                    if factor.is_zero() {
                        continue;
                    }
                    for column in 0..last(below, other, row, columns) {
                        let shared = self.scaled[other.at + n * column + k];
                        if !shared.is_zero() {
                            self.store[target + row * columns + column] -= factor * shared;
                        }
                    }
                }
            }
        }
    }

    /// Hands what is left of the body on to its parent and the others, by (3). Leaves P_oᵀ in `store`.
    fn hand_on(&mut self, plan: &Elimination, pair: &Pair<'_>, inertia: &[[S; MOST]; MOST]) {
        let n = pair.speeds;
        for below in &pair.joint.below {
            let coupling = pair.coupling(below.step);
            for row in 0..plan.steps[below.step].size {
                let at = below.at + n * row;
                let mut p = [S::zero(); MOST];
                for e in 0..n {
                    let factor = self.scaled[at + e];
                    if factor.is_zero() {
                        continue;
                    }
                    for (p, row) in p.iter_mut().zip(inertia).take(n) {
                        if !row[e].is_zero() {
                            *p += row[e] * factor;
                        }
                    }
                }
                if let Some(coupling) = coupling {
                    for (i, p) in p.iter_mut().enumerate().take(n) {
                        *p += self.store[coupling.at + n * row + i];
                    }
                }
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
                            let own = coupling.at + n * row;
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

    /// Carries the right-hand side of the pair of step `index` to the others, by (2) and (4). ν is that of the joint.
    pub(super) fn carry_pair(&mut self, plan: &Elimination, index: usize) {
        let Some(pair) = Pair::new(plan, index) else {
            return;
        };
        let (first, held, n) = (pair.body.first, pair.joint.first, pair.speeds);
        if let Some(axes) = self.axes(&pair) {
            turn(&mut self.right[first + 3..], &axes);
        }
        for k in 0..pair.free {
            let h = self.column(&pair, k);
            let value = sparse_dot((0..n).map(|i| (self.right[first + i], h[i])));
            self.right[held + n + k] = value;
            if let Some(unit) = self.unit(&pair, k) {
                self.right[first + unit] = S::zero();
                self.right[held + unit] = S::zero();
            }
            if value.is_zero() {
                continue;
            }
            for i in 0..n {
                self.carry(pair.row(k) + i, first + i, value);
            }
            for below in pair.others() {
                let later = &plan.steps[below.step];
                for row in 0..later.size {
                    self.carry(below.at + n * row + k, later.first + row, value);
                }
            }
        }
        for d in 0..n {
            let moved = (0..n).map(|e| (self.right[held + e], self.inertia_at(&pair, d, e)));
            let moved = sparse_dot(moved);
            if !moved.is_zero() {
                self.right[first + d] -= moved;
            }
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
                let at = below.at + n * row;
                let moved = sparse_dot((0..n).map(|d| (self.right[held + d], self.store[at + d])));
                self.right[later.first + row] -= moved;
            }
        }
    }

    /// Finds the unknowns of the body of step `index` from those of the others, by (1) and (2), and leaves (5) with the joint.
    pub(super) fn find_pair(&mut self, plan: &Elimination, index: usize) {
        let Some(pair) = Pair::new(plan, index) else {
            return;
        };
        let (first, held, n) = (pair.body.first, pair.joint.first, pair.speeds);
        let mut carried = [S::zero(); MOST];
        for below in &pair.joint.below {
            let later = &plan.steps[below.step];
            for row in 0..later.size {
                let value = self.right[later.first + row];
                let at = below.at + n * row;
                for (carried, &x) in carried.iter_mut().zip(&self.scaled[at..at + n]) {
                    if !x.is_zero() {
                        *carried += x * value;
                    }
                }
            }
        }
        for unit in (0..pair.free).filter_map(|k| self.unit(&pair, k)) {
            carried[unit] = S::zero();
        }
        let mut push = [S::zero(); MOST];
        for (d, push) in push.iter_mut().enumerate().take(n) {
            let moved = (0..n).map(|e| (carried[e], self.inertia_at(&pair, d, e)));
            *push = self.right[first + d] - sparse_dot(moved);
            for below in pair.others() {
                let later = &plan.steps[below.step];
                *push -= sparse_dot((0..later.size).map(|row| {
                    let factor = self.store[below.at + n * row + d];
                    (factor, self.right[later.first + row])
                }));
            }
        }
        for (d, &carried) in carried.iter().enumerate().take(n) {
            self.right[first + d] = self.right[held + d] + carried;
            self.right[held + d] = push[d];
        }
        for k in (0..pair.free).rev() {
            let value = self.right[held + n + k];
            let mut total = scale(value, self.inverse[first + k]);
            total -= sparse_dot((0..n).map(|i| {
                let factor = self.scaled[pair.row(k) + i];
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
            let total = total.label("u");
            if let Some(unit) = self.unit(&pair, k) {
                self.right[first + unit] = total;
                continue;
            }
            for (i, h) in self.column(&pair, k).into_iter().enumerate().take(n) {
                if !h.is_zero() {
                    self.right[first + i] += total * h;
                }
            }
        }
        if let Some(axes) = self.axes(&pair) {
            turn(&mut self.right[first + 3..], &axes.transpose());
        }
    }

    /// The unknowns of the joint of the pair of step `index`: ν, after [`System::solve`] (5).
    pub fn held_mut(&mut self, plan: &Elimination, index: usize) -> &mut [S] {
        match Pair::new(plan, index) {
            Some(pair) => &mut self.right[pair.joint.first..pair.joint.first + pair.speeds],
            None => &mut [],
        }
    }

    /// What the joint of the pair of step `index` pushes the body with, by (5).
    pub fn push(&self, plan: &Elimination, index: usize) -> &[S] {
        match Pair::new(plan, index) {
            Some(pair) => &self.right[pair.joint.first..pair.joint.first + pair.speeds],
            None => &[],
        }
    }

    /// Element of I_a after (2).
    fn inertia_at(&self, pair: &Pair<'_>, i: usize, j: usize) -> S {
        self.store[pair.body.diagonal + pair.speeds * i + j]
    }
}

/// The names of U, in the order of the speeds.
const LABELS_U: [&str; MOST] = ["U_vx", "U_vy", "U_vz", "U_wx", "U_wy", "U_wz"];

/// The first three numbers of a list, a row vector: times T.
fn turn<S: Real>(list: &mut [S], axes: &Matrix3<S>) {
    let old: [S; 3] = std::array::from_fn(|r| list[r]);
    for (j, slot) in list.iter_mut().enumerate().take(3) {
        *slot = sparse_dot((0..3).map(|r| (old[r], axes[(r, j)])));
    }
}

/// Tᵀ of the angular rows and T of the angular columns of a block.
fn turn_inertia<S: Real>(inertia: &mut [[S; MOST]; MOST], axes: &Matrix3<S>) {
    for row in inertia.iter_mut() {
        turn(&mut row[3..], axes);
    }
    for j in 0..MOST {
        let mut column = [inertia[3][j], inertia[4][j], inertia[5][j]];
        if j < 3 {
            column = [inertia[j][3], inertia[j][4], inertia[j][5]];
        } else {
            turn(&mut column, axes);
        }
        for (row, value) in column.into_iter().enumerate() {
            // The lower triangle repeats the upper one.
            if j < 3 || row <= j - 3 {
                inertia[3 + row][j] = value;
            }
        }
    }
    for i in 3..MOST {
        for j in 3..i {
            inertia[i][j] = inertia[j][i];
        }
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
