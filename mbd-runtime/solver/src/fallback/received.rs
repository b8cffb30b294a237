//! Steps that are made beside those of other runs: which they are, and what such a step leaves of how rows are solved.

use mbd_scene::Float;

use super::limits::{MARGIN, PASSING};
use super::{HeldRows, RowStrategy};
use crate::options::Stabilise;
use crate::system::System;

/// The margin from which on the emitted elimination is trusted in a run that passes singular states.
pub(crate) fn trusted_in_passing<T: Float>() -> f64 {
    MARGIN.max(T::EPSILON.to_f64() / PASSING)
}

impl<T: Float> System<T> {
    /// Whether the rows of the step to come, if there are any, are solved as emitted at every stage, and hold by projection.
    pub(crate) fn solves_beside(&self) -> bool {
        let HeldRows {
            strategy,
            near,
            wide,
            outdone,
            ..
        } = &self.fallback.now;
        let stays = self.projection.stabilise == Stabilise::Projection;
        let base = self.fallback.base == RowStrategy::Emitted && !self.fallback.lasting;
        let is_plain = *strategy == RowStrategy::Emitted && !near && !wide && !outdone;
        !self.projection.any() || stays && base && is_plain
    }

    /// Decides how the rows of the step after one are solved that was put on its joints elsewhere, with a margin of its last factor, as where it was put there
    /// here; `false` where that step takes other rows than the emitted ones.
    pub(crate) fn receive_rows(&mut self, time: f64, state: &[T], margin: f64) -> bool {
        if !self.projection.any() {
            return true;
        }
        self.fallback.enter();
        self.fallback.margin = margin;
        if self.changes_rows(time, state) || !self.keeps_emitted(time, state) {
            return false;
        }
        (self.fallback.anew, self.fallback.regularised) = (false, false);
        true
    }

    /// The same of a step whose state is not here, which is taken at once; `false` where the state is asked for, by this step or the one after it.
    pub(crate) fn pass_rows(&mut self, time: f64, margin: f64) -> bool {
        if !self.projection.any() {
            return true;
        }
        self.fallback.margin = margin;
        // Far from positions where rows lose rank nobody looks at the state.
        let passes =
            !self.is_close() && self.receive_rows(time, &[], margin) && !self.fallback.next.near;
        if passes {
            self.fallback.commit();
        }
        passes
    }
}
