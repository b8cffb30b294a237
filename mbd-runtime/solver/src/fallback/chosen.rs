//! Runs that choose rows all along, since those kept are not enough: a joint that an event may detach holds what others repeat, or with these
//! parameters rows left out ask for more, or those kept are too many for the assembly that moves. The margin of the emitted elimination says nothing of rows that it leaves out: theirs is measured here.
//!
//! ```text
//! margin = (the smallest part that is new of a row chosen)²; 0 where fewer can be chosen than there are elsewhere        (1)
//! ```

use mbd_scene::{Float, Quantity};

use super::limit::SingularLimit;
use super::limits::MARGIN;
use crate::system::System;

/// How far beside a start rows are counted, over the reach of the joints and in radians: farther than any limit of them.
const BESIDE: f64 = 0.03;

impl<T: Float> System<T> {
    /// Number of independent rows away from singular positions: of the rows kept, or where rows are chosen all along of all of them, on the assembly
    /// that moves here. Rows that are kept for the sake of one that does not may be more.
    pub(super) fn full_rank(&self) -> usize {
        match self.fallback.most {
            most if most > 0 && self.solves_chosen() => most,
            _ => self.rank(),
        }
    }

    /// Counts independent rows at a state that rows begin with and beside it, as at the state itself they may be fewer than elsewhere.
    pub(crate) fn count_rows_anew(&mut self, time: f64, state: &[T]) {
        self.fallback.most = 0;
        if !self.solves_chosen() {
            return;
        }
        let here = self.count_rows(time, state);
        let inputs = self.inputs.clone();
        let beside = self.move_beside(time, state);
        let beside = beside.map_or(0, |beside| self.count_rows(time, &beside));
        self.inputs = inputs;
        self.fallback.most = here.max(beside);
    }

    /// Whether fewer rows are independent beside a state, where they lose rank, than are kept.
    #[cold]
    pub(crate) fn has_fewer_rows(&mut self, time: f64, state: &[T]) -> bool {
        let inputs = self.inputs.clone();
        let beside = self.move_beside(time, state);
        let fewer = beside.is_some_and(|beside| self.count_rows(time, &beside) < self.rank());
        self.inputs = inputs;
        fewer
    }

    /// How many rows are independent at a state.
    fn count_rows(&mut self, time: f64, state: &[T]) -> usize {
        let mut rows = std::mem::take(&mut self.fallback.kept);
        self.read_dense(time, state);
        self.fallback.dense.choose(&mut rows);
        let count = rows.len();
        self.fallback.kept = rows;
        count
    }

    /// A state that the joints allow a little beside one; `None` where none is found. What is driven goes back to where its time has it, and tells of that
    /// place alone.
    fn move_beside(&mut self, time: f64, state: &[T]) -> Option<Vec<T>> {
        let model = self.model.clone();
        let layout = model.layout();
        if layout.joints.iter().any(|slots| slots.driven) {
            return None;
        }
        let mut moved = state.to_vec();
        let speeds = moved.iter_mut().skip(layout.nq).take(layout.nv);
        for (index, speed) in speeds.enumerate() {
            *speed = T::from_f64((1.0 + 1.7 * index as f64).cos());
        }
        self.put_on_joints(time, &mut moved).ok()?;
        let mut rates = vec![0.0; layout.len(Quantity::Derivative)];
        self.by_laws(Quantity::Derivative, time, &moved, &mut rates);
        let speeds = moved.iter().skip(layout.nq).map(|v| v.to_f64());
        let step = BESIDE / self.crossings(&speeds.collect::<Vec<f64>>());
        if !step.is_finite() {
            return None;
        }
        for (x, rate) in moved.iter_mut().zip(&rates).take(layout.nq) {
            *x += T::from_f64(step * rate);
        }
        self.normalise(&mut moved);
        self.supply(time, &moved).ok()?;
        self.put_on_joints(time, &mut moved).ok()?;
        Some(moved)
    }

    /// (1) at a state, in the place of the margin of the emitted elimination.
    #[cold]
    pub(crate) fn measure_chosen(&mut self, time: f64, state: &[T]) {
        let mut rows = std::mem::take(&mut self.fallback.kept);
        self.read_dense(time, state);
        let dense = &mut self.fallback.dense;
        dense.new_from = MARGIN.max(T::EPSILON.to_f64()).sqrt();
        dense.choose(&mut rows);
        let least = dense.independence(&rows);
        self.fallback.margin = match rows.len() >= self.full_rank() {
            true => least * least,
            false => 0.0,
        };
        self.fallback.kept = rows;
    }

    /// λ and v̇ at a state whose margin was measured, by `rows` that are as many as there are, chosen here where they are not yet; `None` where
    /// they lose rank here, too.
    pub(super) fn by_all_rows(
        &mut self,
        time: f64,
        state: &[T],
        rows: &mut Vec<usize>,
    ) -> Option<SingularLimit> {
        if !self.is_regular() {
            return None;
        }
        self.read_dense(time, state);
        self.read_right(time, state);
        let full = self.full_rank();
        let dense = &mut self.fallback.dense;
        if rows.is_empty() {
            dense.choose(rows);
        }
        if rows.len() < full || !dense.are_independent(rows) {
            return None;
        }
        dense.factor(rows);
        dense.accelerate(rows);
        let (multipliers, accelerations) = (dense.multipliers.clone(), dense.force.clone());
        let mut all = multipliers.iter().chain(&accelerations);
        let found = all.all(|x| x.is_finite());
        found.then_some(SingularLimit {
            multipliers,
            accelerations,
        })
    }
}
