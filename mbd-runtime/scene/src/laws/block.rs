//! Block LDLᵀ of the system of bodies and joints, in the order of [`Elimination`], on any scalar.
//!
//! ```text
//! K = L D Lᵀ,  D diagonal: positive for a body, negative for a joint          (1)
//! L y = b,  x = L⁻ᵀ D⁻¹ y                                                     (2)
//! ```
//!
//! Scalar by scalar inside the blocks, so that every structural zero of the mass matrix and of the rows is skipped: symbols drop it from the
//! code, numbers step over it. No pivoting: a pivot that vanishes (redundant rows) gives numbers that are not finite, never a panic.
//!
//! The pivot of a row is what other rows have left of its own element of −Φ_v M⁻¹ Φ_vᵀ:
//!
//! ```text
//! margin = min over rows of pivot / element before any row is taken out of it       (3)
//! ```
//!
//! a number without unit, whatever the masses: 1 for rows at right angles, sin² for two rows at an angle, eps or less for dependent ones.
//! Rows that leave by substitution have no pivot and do not count.

use super::articulated::last;
use crate::Real;
use crate::elimination::{Elimination, Part, Step};

/// The blocks and right-hand side of one system. Carries nothing from call to call.
#[derive(Clone, Debug)]
pub struct System<S: Real> {
    /// K, then L D below the diagonal (unscaled columns).
    pub(super) store: Vec<S>,
    /// L below the diagonal.
    pub(super) scaled: Vec<S>,
    /// 1 / D.
    pub(super) inverse: Vec<S>,
    /// b, then y, then x.
    pub(super) right: Vec<S>,
    /// Diagonal elements of joints before rows were taken out of them.
    whole: Vec<S>,
    /// Whether a diagonal element has grown since.
    grown: Vec<bool>,
}

impl<S: Real> System<S> {
    /// Room for one order of elimination.
    pub fn new(plan: &Elimination) -> Self {
        System {
            store: vec![S::zero(); plan.store],
            scaled: vec![S::zero(); plan.store],
            inverse: vec![S::zero(); plan.unknowns],
            right: vec![S::zero(); plan.unknowns],
            whole: vec![S::zero(); plan.unknowns],
            grown: vec![false; plan.unknowns],
        }
    }

    /// An empty system.
    pub fn clear(&mut self) {
        self.store.fill(S::zero());
        self.whole.fill(S::zero());
        self.grown.fill(false);
        self.right.fill(S::zero());
    }

    /// Sets element (`row`, `column`) of the diagonal block of a step, row ≥ column.
    pub fn set_diagonal(&mut self, plan: &Elimination, step: usize, at: (usize, usize), value: S) {
        if let Some(node) = plan.steps.get(step)
            && let Some(slot) = self.store.get_mut(node.diagonal + at.0 * node.size + at.1)
        {
            *slot = value;
        }
    }

    /// Sets the coefficient of unknown `speed` of the step `body` in equation `row` of the step `joint`.
    pub fn set_coupling(
        &mut self,
        plan: &Elimination,
        (joint, row): (usize, usize),
        (body, speed): (usize, usize),
        value: S,
    ) {
        let place = if joint > body {
            plan.block(joint, body)
                .map(|at| at + row * plan.steps[body].size + speed)
        } else {
            plan.block(body, joint)
                .map(|at| at + speed * plan.steps[joint].size + row)
        };
        if let Some(slot) = place.and_then(|place| self.store.get_mut(place)) {
            *slot = value;
        }
    }

    /// The right-hand side of a step; after [`System::solve`] its unknowns.
    pub fn unknowns_mut(&mut self, plan: &Elimination, step: usize) -> &mut [S] {
        match plan.steps.get(step) {
            Some(step) => &mut self.right[step.first..step.first + step.size],
            None => &mut [],
        }
    }

    /// The unknowns of a step.
    pub fn unknowns(&self, plan: &Elimination, step: usize) -> &[S] {
        match plan.steps.get(step) {
            Some(step) => &self.right[step.first..step.first + step.size],
            None => &[],
        }
    }

    /// Factorises K by (1). `enter` hears which part comes next.
    pub fn factor(&mut self, plan: &Elimination, enter: impl Fn(Part)) {
        for (index, step) in plan.steps.iter().enumerate() {
            if step.paired {
                continue;
            }
            enter(step.part);
            if step.carrying.is_some() {
                self.factor_pair(plan, index);
                let joint = plan.steps.get(index + 1);
                let both = step
                    .below
                    .iter()
                    .chain(joint.into_iter().flat_map(|joint| &joint.below));
                for target in both.filter_map(|below| plan.steps.get(below.step)) {
                    self.grown[target.first..target.first + target.size].fill(true);
                }
                continue;
            }
            let n = step.size;
            if matches!(step.part, Part::Joint(_)) {
                self.note(step);
            }
            for p in 0..n {
                let pivot = step.diagonal + p * n;
                let inverse = S::one() / self.store[pivot + p];
                self.inverse[step.first + p] = inverse;
                for column in p + 1..n {
                    let shared = self.store[step.diagonal + column * n + p];
                    let place = step.diagonal + column * n + p;
                    if shared.is_zero() {
                        self.scaled[place] = shared;
                        continue;
                    }
                    let factor = shared * inverse;
                    self.scaled[place] = factor;
                    for row in column..n {
                        self.reduce(step.diagonal + row * n, column, p, factor);
                    }
                    for below in &step.below {
                        for row in 0..plan.steps[below.step].size {
                            self.reduce(below.at + row * n, column, p, factor);
                        }
                    }
                }
                for below in &step.below {
                    for row in 0..plan.steps[below.step].size {
                        let at = below.at + row * n + p;
                        let value = self.store[at];
                        self.scaled[at] = if value.is_zero() {
                            value
                        } else {
                            value * inverse
                        };
                    }
                }
            }
            self.fill(plan, step);
        }
    }

    /// K(row, column) −= K(row, p) · L(column, p).
    fn reduce(&mut self, row: usize, column: usize, p: usize, factor: S) {
        let shared = self.store[row + p];
        if !shared.is_zero() {
            self.store[row + column] -= shared * factor;
        }
    }

    /// Says how large the element of row `row` of a joint is at least before rows are taken out of it, where substitution hides its size.
    pub fn set_size(&mut self, plan: &Elimination, step: usize, row: usize, size: S) {
        if let Some(step) = plan.steps.get(step)
            && let Some(whole) = self.whole.get_mut(step.first + row)
        {
            *whole = -size;
        }
    }

    /// Notes the diagonal elements of a joint that have grown since the last note: rows are about to be taken out of them.
    fn note(&mut self, step: &Step) {
        for p in 0..step.size {
            let place = step.first + p;
            if std::mem::replace(&mut self.grown[place], false) {
                // Elements of joints are negative.
                let element = self.store[step.diagonal + p * step.size + p];
                let known = self.whole[place];
                self.whole[place] = if known.is_zero() {
                    element
                } else {
                    known.min(element)
                };
            }
        }
    }

    /// The smallest part of its element that other rows have left to the pivot of a row, after [`System::factor`], by (3).
    pub fn margin(&self, plan: &Elimination) -> S {
        let joints = plan.steps.iter();
        let joints = joints.filter(|step| matches!(step.part, Part::Joint(_)) && !step.paired);
        let mut least = S::one();
        for step in joints {
            for p in 0..step.size {
                let pivot = self.store[step.diagonal + p * step.size + p];
                least = least.min(pivot / self.whole[step.first + p]);
            }
        }
        least.label("margin")
    }

    /// Takes the products of a step's couplings out of the blocks they fill.
    fn fill(&mut self, plan: &Elimination, step: &Step) {
        let n = step.size;
        let joint = matches!(step.part, Part::Joint(_));
        for below in &step.below {
            let target = &plan.steps[below.step];
            if joint && matches!(target.part, Part::Joint(_)) {
                self.note(target);
            } else {
                self.grown[target.first..target.first + target.size].fill(true);
            }
        }
        for (i, below) in step.below.iter().enumerate() {
            let rows = plan.steps[below.step].size;
            for (other, &target) in step.below[..=i].iter().zip(&below.targets) {
                let columns = plan.steps[other.step].size;
                for row in 0..rows {
                    for column in 0..last(below, other, row, columns) {
                        let mut total = self.store[target + row * columns + column];
                        for p in 0..n {
                            let left = self.scaled[below.at + row * n + p];
                            let right = self.store[other.at + column * n + p];
                            if !left.is_zero() && !right.is_zero() {
                                total -= left * right;
                            }
                        }
                        self.store[target + row * columns + column] = total;
                    }
                }
            }
        }
    }

    /// Solves for the right-hand side by (2); the factor stays. `enter` hears which part comes next.
    pub fn solve(&mut self, plan: &Elimination, enter: impl Fn(Part)) {
        for (index, step) in plan.steps.iter().enumerate() {
            if step.paired {
                continue;
            }
            enter(step.part);
            if step.carrying.is_some() {
                self.carry_pair(plan, index);
                continue;
            }
            let n = step.size;
            for p in 0..n {
                let value = self.right[step.first + p];
                if value.is_zero() {
                    continue;
                }
                for row in p + 1..n {
                    self.carry(step.diagonal + row * n + p, step.first + row, value);
                }
                for below in &step.below {
                    let later = &plan.steps[below.step];
                    for row in 0..later.size {
                        self.carry(below.at + row * n + p, later.first + row, value);
                    }
                }
            }
        }
        for (index, step) in plan.steps.iter().enumerate().rev() {
            if step.paired {
                continue;
            }
            enter(step.part);
            if step.carrying.is_some() {
                self.find_pair(plan, index);
                continue;
            }
            let n = step.size;
            for p in (0..n).rev() {
                let mut total = self.right[step.first + p];
                if !total.is_zero() {
                    total *= self.inverse[step.first + p];
                }
                for below in &step.below {
                    let later = &plan.steps[below.step];
                    for row in 0..later.size {
                        let factor = self.scaled[below.at + row * n + p];
                        if !factor.is_zero() {
                            total -= factor * self.right[later.first + row];
                        }
                    }
                }
                for row in p + 1..n {
                    let factor = self.scaled[step.diagonal + row * n + p];
                    if !factor.is_zero() {
                        total -= factor * self.right[step.first + row];
                    }
                }
                self.right[step.first + p] = total;
            }
        }
    }

    /// Takes factor × value out of a row of the right-hand side.
    pub(super) fn carry(&mut self, factor: usize, row: usize, value: S) {
        let factor = self.scaled[factor];
        if !factor.is_zero() {
            self.right[row] -= factor * value;
        }
    }
}
