//! Kept rows that lose rank where rows that repeat them elsewhere do not: these hold in their place for as long as the position is close.
//!
//! A kept row whose part that is new against the others goes with the angle δ from such a position, Φ = δ n + …, is off by rounding ε at
//! n = ε/δ; along the motion so are its rates, ṅ = ε/δ², n̈ = ε/δ³. Places and energy show nothing of it, accelerations are wrong long before the
//! pivot is gone. A row that is as far from the others as ever has n = ε.
//! Rejected: to judge by what the rows left out are off by. Rounding of one state may be zero by chance, and stages are off by more than it.

use mbd_scene::Float;

use super::limits::{AGAIN, BETTER, OUTDONE};
use super::{Fallback, RowStrategy};
use crate::error::StepError;
use crate::integrate::Rates;
use crate::system::System;

/// The margin below which other rows than those kept are looked for.
pub(super) fn outdone_from<T: Float>() -> f64 {
    T::EPSILON.to_f64().powf(OUTDONE)
}

impl<T: Float> System<T> {
    /// Looks for better rows than those kept, at the end of a step whose margin was measured. True if those of the step after it are others for
    /// that reason for the first time: the state is to be put on them.
    #[inline]
    pub(crate) fn changes_rows(&mut self, time: f64, state: &[T]) -> bool {
        (self.fallback.next.outdone, self.fallback.next.asked) = (false, 0.0);
        self.is_close() && self.changes_close_rows(time, state)
    }

    #[cold]
    fn changes_close_rows(&mut self, time: f64, state: &[T]) -> bool {
        let (asks, size) = (self.asks_for_rows(), self.margin_size());
        let outdone = asks && self.others_hold(time, state);
        let Fallback {
            now, next, at_end, ..
        } = &mut self.fallback;
        next.outdone = outdone;
        next.asked = match outdone {
            true => 0.0,
            false if asks => size,
            false => now.asked,
        };
        *at_end = true;
        outdone && !now.outdone
    }

    /// Whether the step that is tried takes other rows than those kept, since they are better.
    pub(crate) fn takes_other_rows(&self) -> bool {
        let now = &self.fallback.now;
        now.outdone && now.strategy == RowStrategy::Chosen
    }

    /// Derivatives of rates that are not those of the emitted elimination, by differences.
    #[cold]
    pub(crate) fn differentiate_anew(
        &mut self,
        time: f64,
        state: &[T],
        by_state: &mut [T],
        by_time: &mut [T],
    ) -> Result<(), StepError> {
        self.counters.jacobians = self.counters.jacobians.saturating_add(1);
        let (size, small) = (state.len(), T::EPSILON.to_f64().cbrt());
        let mut moved = state.to_vec();
        let mut ends = [vec![T::zero(); size], vec![T::zero(); size]];
        for column in 0..=size {
            let at = state.get(column).map_or(time, |x| x.to_f64());
            let off = small * at.abs().max(1.0);
            for (out, off) in ends.iter_mut().zip([off, -off]) {
                let time = match moved.get_mut(column) {
                    Some(x) => {
                        *x = T::from_f64(at + off);
                        time
                    }
                    None => time + off,
                };
                self.rates_inside(time, 0.0, &moved, out)?;
            }
            if let (Some(x), Some(here)) = (moved.get_mut(column), state.get(column)) {
                *x = *here;
            }
            let [ahead, behind] = &ends;
            let slopes = ahead.iter().zip(behind);
            let slopes = slopes.map(|(ahead, behind)| (*ahead - *behind) / T::from_f64(2.0 * off));
            for (row, slope) in slopes.enumerate() {
                let to = match column < size {
                    true => by_state.get_mut(row * size + column),
                    false => by_time.get_mut(row),
                };
                to.into_iter().for_each(|to| *to = slope);
            }
        }
        Ok(())
    }

    /// Forgets what was found of rows elsewhere.
    pub(crate) fn forget_rows(&mut self) {
        self.fallback.at_end = false;
        (self.fallback.now.outdone, self.fallback.now.asked) = (false, 0.0);
    }

    /// Whether rows that were left out tell the motion better than those kept, at a state whose margin was measured last.
    pub(super) fn is_outdone(&mut self, time: f64, state: &[T]) -> bool {
        self.is_close() && self.asks_for_rows() && self.others_hold(time, state)
    }

    /// Whether the margin is small enough to look for other rows.
    pub(super) fn is_close(&self) -> bool {
        // Also where there is none, at the position itself.
        let is_far = self.fallback.margin >= outdone_from::<T>();
        !is_far
    }

    /// √ of the margin.
    pub(super) fn margin_size(&self) -> f64 {
        self.fallback.margin.max(0.0).sqrt()
    }

    /// Whether the answer to what is asked of rows may be another one than that before.
    fn asks_for_rows(&self) -> bool {
        let asked = self.fallback.held().asked;
        asked == 0.0 || self.margin_size() <= AGAIN * asked
    }

    /// Whether rows chosen anew are as many as there ever are, and much farther from each other than those kept. Masses play no part in it.
    #[cold]
    fn others_hold(&mut self, time: f64, state: &[T]) -> bool {
        let is_emitted = self.fallback.base == RowStrategy::Emitted && !self.fallback.lasting;
        if !is_emitted || self.model.layout().redundancy.lost() == 0 {
            return false;
        }
        let rank = self.rank();
        let mut kept = std::mem::take(&mut self.fallback.kept);
        self.list_kept_rows(&mut kept);
        self.read_dense(time, state);
        let (dense, chosen) = (&mut self.fallback.dense, &mut self.fallback.spare);
        dense.new_from = outdone_from::<T>().sqrt();
        dense.choose(chosen);
        let hold =
            chosen.len() >= rank && dense.independence(chosen) > BETTER * dense.independence(&kept);
        self.fallback.kept = kept;
        hold
    }
}
