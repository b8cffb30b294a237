//! The rows of joints across a free motion: the speeds at its start, changed along the normals there, that make the joints hold at its end.
//!
//! ```text
//! Φ(x₁(u + δ)) = 0,  M δ = Φ_vᵀ(x₀) λ        by  Φ_v(x₀) δ = −Φ(x₁)/h,  x₁ anew, …                                          (3)
//! ```
//!
//! A solve of (3) uses the factor at the start; what it leaves is of the size of h times the change of the rows. Where it leaves more than a tenth
//! (masses that differ by many decades), [M −Φ_vᵀ(x₀); Φ_v(x₁) 0] is solved instead.

use mbd_scene::{Float, Quantity};

use crate::error::StepError;
use crate::integrate::Reversible;
use crate::list::largest;
use crate::system::System;

/// Most solves of (3).
const SOLVES: u32 = 40;
/// What may be left of rows, in rounding units of the largest number they are made of: it goes into the speeds over h.
const SETTLED: f64 = 0.5;
/// What a solve may leave of the rows before the matrix across the step is taken.
const SLOW: f64 = 0.1;

impl<T: Float> Reversible<T> for System<T> {
    fn is_conservative(&self) -> bool {
        let scene = self.model.scene();
        self.controls.is_empty() && scene.states.is_empty() && !scene.exchanges_energy()
    }

    fn move_freely(
        &mut self,
        [start, end]: [f64; 2],
        span: f64,
        state: &mut [T],
        moved: &mut [T],
    ) -> Result<(), StepError> {
        moved.copy_from_slice(state);
        self.free_motion.advance(span, moved);
        if !self.projection.any() {
            return Ok(());
        }
        let state = state.get_mut(..self.nx).unwrap_or_default();
        let moved = moved.get_mut(..self.nx).unwrap_or_default();
        let (mut before, mut slow) = (f64::INFINITY, false);
        for _ in 0..SOLVES {
            self.supply(end, moved)?;
            let norm = self.read_rows(Quantity::Constraint, end, moved);
            let settled = norm <= SETTLED * T::EPSILON.to_f64() * self.size(moved);
            // At the level of rounding another solve gains nothing.
            if settled || self.holds(norm, moved) && norm > 0.5 * before {
                return Ok(());
            }
            if !norm.is_finite() {
                break;
            }
            slow |= norm > SLOW * before && !self.holds(norm, moved);
            before = norm;
            let shorter = T::from_f64(1.0 / span);
            self.projection
                .rows
                .iter_mut()
                .for_each(|row| *row *= shorter);
            match slow {
                false => self.correct(start, state)?,
                true => self.solve_across([start, end], [state, moved])?,
            }
            let speeds = state.iter_mut().skip(self.model.layout().nq);
            for (speed, more) in speeds.zip(self.projection.moves()) {
                *speed += *more;
            }
            moved.copy_from_slice(state);
            self.free_motion.advance(span, moved);
        }
        let norm = self.read_rows(Quantity::Constraint, end, moved);
        Err(StepError::JointsApart {
            time: end,
            norm,
            rows: self.worst_joints((end, moved), ["m", "rad"]),
        })
    }

    fn without_turning(&self, state: &[T], rates: &mut [T]) {
        self.free_motion.take_out_of(state, rates);
    }

    fn hold_speeds(&mut self, time: f64, state: &mut [T]) -> Result<(), StepError> {
        match self.projection.any() {
            true => self.project_velocities(time, state.get_mut(..self.nx).unwrap_or_default()),
            false => Ok(()),
        }
    }
}

impl<T: Float> System<T> {
    /// Solves (3) with the rows of both ends.
    #[cold]
    fn solve_across(&mut self, times: [f64; 2], states: [&[T]; 2]) -> Result<(), StepError> {
        self.correct_by(|system, rows, moves| system.correct_across(times, states, rows, moves));
        if largest(self.projection.moves()).is_finite() {
            return Ok(());
        }
        let ([time, _], [state, _]) = (times, states);
        Err(self.singular(time, state))
    }
}
