//! Masses that differ by decades: what they cost on the emitted strategy, and whether the whole matrix takes over for a run.

use mbd_scene::Float;

use super::chain::{HeldRows, RowStrategy};
use super::limits::{LOSS, RATIO, TOO_MUCH};
use crate::error::StepError;
use crate::system::System;

impl<T: Float> System<T> {
    /// At a start: whether masses cost digits, by comparison with the whole matrix. Rates are those of the start.
    ///
    /// # Errors
    /// [`StepError::IllConditioned`] where no strategy keeps three digits.
    #[cold]
    pub(crate) fn check_conditioning(
        &mut self,
        time: f64,
        state: &[T],
        rates: &mut [T],
    ) -> Result<(), StepError> {
        let state = state.get(..self.nx).unwrap_or_default();
        let (nq, nv) = (self.model.layout().nq, self.model.layout().nv);
        if self.model.layout().nc == 0 || self.fallback.now.strategy != RowStrategy::Emitted {
            return Ok(());
        }
        let ratio = self.mass_ratio();
        if ratio.is_nan() || ratio <= RATIO {
            return Ok(());
        }
        let mut rows = std::mem::take(&mut self.fallback.spare);
        self.read_dense(time, state);
        // The emitted elimination solves them all here: none of them is left out that can be told from the others.
        self.fallback.dense.new_from = self.trusted_from(true).sqrt();
        self.fallback.dense.choose(&mut rows);
        let unsettled = self.accelerate_whole(time, state, &rows);
        let precise = self.fallback.dense.force.clone();
        let emitted = rates.get(nq..nq + nv).unwrap_or_default();
        let emitted = difference(emitted.iter().map(|x| x.to_f64()), &precise);
        // What rounding of the state itself changes: no way to solve the rows is better.
        let nudge = |(index, x): (usize, &T)| {
            let sign = if index.count_ones() % 2 == 0 {
                1.0
            } else {
                -1.0
            };
            *x * (T::one() + T::from_f64(sign) * T::EPSILON)
        };
        let nudged: Vec<T> = state.iter().enumerate().map(nudge).collect();
        self.read_dense(time, &nudged);
        self.accelerate_whole(time, &nudged, &rows);
        let sensitive = difference(self.fallback.dense.force.iter().copied(), &precise);
        let mut loss = emitted.max(sensitive);
        let epsilon = T::EPSILON.to_f64();
        let promised = LOSS * (1e-5 * ratio).clamp(1.0, 1e4);
        let promised = promised.max(64.0 * epsilon);
        // Where the whole matrix does not settle either, it is no witness.
        if emitted > 0.5 * promised && unsettled < 0.1 * emitted {
            loss = unsettled.max(sensitive);
            self.fallback.base = RowStrategy::Whole;
            self.fallback.worst = RowStrategy::Whole;
            self.fallback.next = HeldRows {
                strategy: RowStrategy::Whole,
                rows,
                whole_step: true,
                ..self.fallback.now
            };
            self.fallback.commit();
            self.accelerate(time, state, rates)?;
        } else {
            self.fallback.spare = rows;
        }
        let digits = (loss / epsilon).log10().ceil();
        self.fallback.lost_digits = digits.clamp(0.0, -epsilon.log10()) as u64;
        if loss <= TOO_MUCH {
            return Ok(());
        }
        Err(StepError::IllConditioned {
            time,
            loss_digits: self.fallback.lost_digits,
            strategy: self.statistics().rows_strategy,
            ratio,
        })
    }

    /// v̇ of the whole matrix under these rows, after [`System::read_dense`]; how far its last correction was from nothing, relative.
    fn accelerate_whole(&mut self, time: f64, state: &[T], rows: &[usize]) -> f64 {
        self.read_right(time, state);
        self.fallback.dense.accelerate_whole(rows)
    }

    /// The largest mass of a body or a point over the smallest.
    fn mass_ratio(&mut self) -> f64 {
        let numbers = self.numbers();
        let bodies = numbers.bodies.iter().map(|body| body.mass);
        let points = numbers.points.iter().map(|(mass, _)| *mass);
        let masses = bodies.chain(points).filter(|mass| *mass > 0.0);
        let (least, most) = masses.fold((f64::INFINITY, 0.0), |(least, most): (f64, f64), mass| {
            (least.min(mass), most.max(mass))
        });
        most / least
    }
}

/// The largest difference of two lists over the largest number; infinite where one is not a number.
fn difference(list: impl Iterator<Item = f64>, precise: &[f64]) -> f64 {
    let scale = precise.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let off = list.zip(precise).fold(0.0, |most: f64, (a, b)| {
        let off = (a - b).abs();
        if off <= most { most } else { off }
    });
    match off / scale {
        _ if off == 0.0 => 0.0,
        loss if loss.is_nan() => f64::INFINITY,
        loss => loss,
    }
}
