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

use crate::{Elimination, EliminationStep, Part, Real};

/// The blocks and right-hand side of one system. Carries nothing from call to call.
#[derive(Clone, Debug)]
pub struct BlockSystem<S: Real> {
    /// K, then L D below the diagonal (unscaled columns).
    pub(super) store: Vec<S>,
    /// L below the diagonal.
    pub(super) scaled: Vec<S>,
    /// D.
    pub(super) pivot: Vec<S>,
    /// 1 / D.
    pub(super) inverse: Vec<S>,
    /// b, then y, then x.
    pub(super) right: Vec<S>,
    /// What right-hand sides do along the free columns.
    pub(super) work: Vec<S>,
    /// What joints push the bodies with that they carry, at the unknowns of the joint.
    pub(super) push: Vec<S>,
    /// What couplings do along the free column that leaves, at the beginning of their rows.
    pub(super) along: Vec<S>,
    /// Diagonal elements of joints before rows were taken out of them.
    whole: Vec<S>,
    /// Whether a diagonal element has grown since.
    grown: Vec<bool>,
}

impl<S: Real> BlockSystem<S> {
    /// Room for one order of elimination.
    pub fn new(plan: &Elimination) -> Self {
        BlockSystem {
            store: vec![S::zero(); plan.store],
            scaled: vec![S::zero(); plan.store],
            pivot: vec![S::zero(); plan.unknowns],
            inverse: vec![S::zero(); plan.unknowns],
            work: vec![S::zero(); plan.unknowns],
            push: vec![S::zero(); plan.unknowns],
            along: vec![S::zero(); plan.store],
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

    /// The right-hand side of a step; after [`BlockSystem::solve`] its unknowns.
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

    /// Says how large the element of row `row` of a joint is at least before rows are taken out of it, where substitution hides its size.
    pub fn set_size(&mut self, plan: &Elimination, step: usize, row: usize, size: S) {
        if let Some(step) = plan.steps.get(step)
            && let Some(whole) = self.whole.get_mut(step.first + row)
        {
            *whole = -size;
        }
    }

    /// Says that a step is about to leave: what it fills grows, and rows that rows fill are noted before.
    pub(super) fn leave(&mut self, plan: &Elimination, index: usize) {
        let Some(step) = plan.steps.get(index) else {
            return;
        };
        let joint = matches!(step.part, Part::Joint(_));
        if joint {
            self.note(step);
        }
        let parent = plan
            .steps
            .get(index + 1)
            .filter(|_| step.carrying.is_some());
        let both = step
            .below
            .iter()
            .chain(parent.iter().flat_map(|joint| &joint.below));
        for target in both.filter_map(|below| plan.steps.get(below.step)) {
            if joint && matches!(target.part, Part::Joint(_)) {
                self.note(target);
            } else {
                self.grown[target.first..target.first + target.size].fill(true);
            }
        }
    }

    /// Notes the diagonal elements of a joint that have grown since the last note: rows are about to be taken out of them.
    fn note(&mut self, step: &EliminationStep) {
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

    /// The smallest part of its element that other rows have left to the pivot of a row, after [`BlockSystem::factor`], by (3).
    pub fn margin(&self, plan: &Elimination) -> S {
        let joints = plan.steps.iter();
        let joints = joints.filter(|step| matches!(step.part, Part::Joint(_)) && !step.paired);
        let mut least = S::one();
        for step in joints {
            for row in step.first..step.first + step.size {
                least = least.min(self.pivot[row] / self.whole[row]);
            }
        }
        least.label("margin")
    }
}
