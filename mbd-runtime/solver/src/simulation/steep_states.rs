//! Whether fixed steps are too long for declared states: energy knows nothing of them, and the norm of the [watch](crate::watch) is that of energy.
//!
//! ```text
//! hρ = 2 |k₃ − k₂| / |k₂ − k₁| over the declared states alone, at a step now and then      (1)
//! h |λ|,  λ the largest eigenvalue of ∂ṡ/∂s by differences, where (1) is above the limit    (2)
//! ```
//!
//! A step behind which a state is remembered as good is looked at, so that the run goes back to before the growth. (1) alone would call a turning point unstable: where a state is the integral of what swings, k₂ − k₁ passes zero there. (2) alone would refuse what stays where it is.

use mbd_scene::Float;

use super::stability::OFTEN;
use super::{ModelRun, Pace};
use crate::error::StepError;
use crate::integrate::{Rates, fastest};
use crate::watch::{Instability, LIMIT, NEGLIGIBLE};

/// The part of a state, and of what a step changes of it, by which it is moved.
const MOVED: f64 = 1e-6;

impl<T: Float> ModelRun<T> {
    /// Looks now and then whether a fixed step that was tried is too long for the declared states.
    ///
    /// # Errors
    /// It is.
    #[inline]
    pub(super) fn watch_states(&mut self, step: f64) -> Result<(), StepError> {
        if !self.watches_states() {
            return Ok(());
        }
        match self.is_looked_into(OFTEN) {
            true => self.look_at_states(step),
            false => Ok(()),
        }
    }

    /// Whether there are declared states to look at.
    pub(super) fn watches_states(&self) -> bool {
        self.overlooked.has_states && self.watched
    }

    /// Where a step could not be made: whether it is too long for the declared states where it begins.
    pub(super) fn growing_states(&mut self, step: f64) -> Option<Instability> {
        if !self.watches_states() || self.method.explicit().is_none() {
            return None;
        }
        let layout = self.system.model.layout();
        let own = layout.states()..layout.nx();
        Instability::beyond(step * self.fastest_state(own, step).ok()?)
    }

    #[cold]
    fn look_at_states(&mut self, step: f64) -> Result<(), StepError> {
        if !matches!(self.pace, Pace::Fixed(_)) || self.method.explicit().is_none() {
            return Ok(());
        }
        if self.lacks_stages {
            self.make_stages(step)?;
        }
        let layout = self.system.model.layout();
        let own = layout.states()..layout.nx();
        // The room for a state takes the weights: nothing is allocated on the way.
        for at in 0..self.inside.len() {
            let weight = match own.contains(&at) {
                true => self.size_of_state(at, step).powi(-2),
                false => 0.0,
            };
            if let Some(slot) = self.inside.get_mut(at) {
                *slot = T::from_f64(weight);
            }
        }
        let limits = [NEGLIGIBLE, LIMIT];
        if self.method.stiffness(&self.inside, limits) <= LIMIT {
            return Ok(());
        }
        // What is evaluated here is none of the work of the run.
        let counted = (self.system.counters, self.system.nodes.statistics);
        let rate = self.fastest_state(own, step);
        (self.system.counters, self.system.nodes.statistics) = counted;
        match Instability::beyond(step * rate?) {
            Some(what) => Err(self.unstable(step, what)),
            None => Ok(()),
        }
    }

    /// What a number of the state is, or what a step changes of it, if that is more; never zero.
    fn size_of_state(&self, at: usize, step: f64) -> f64 {
        let number = |list: &[T]| list.get(at).map_or(0.0, |x| x.to_f64().abs());
        let size = number(&self.state).max(step * number(self.method.first()));
        match size > 0.0 && size.is_finite() {
            true => size,
            false => 1.0,
        }
    }

    /// λ of (2) [1/s].
    fn fastest_state(&mut self, own: std::ops::Range<usize>, step: f64) -> Result<f64, StepError> {
        let count = own.len();
        let time = self.time + self.behind_jump();
        let mut begun = vec![T::zero(); self.state.len()];
        let mut moved = begun.clone();
        self.system
            .rates_inside(time, 0.0, &self.state, &mut begun)?;
        let mut matrix = vec![T::zero(); count * count];
        for (column, at) in own.clone().enumerate() {
            let apart = T::from_f64(
                MOVED.max(8.0 * T::EPSILON.to_f64().sqrt()) * self.size_of_state(at, step),
            );
            self.inside.copy_from_slice(&self.state);
            if let Some(x) = self.inside.get_mut(at) {
                *x += apart;
            }
            self.system
                .rates_inside(time, 0.0, &self.inside, &mut moved)?;
            let changes = moved.iter().zip(&begun).skip(own.start).take(count);
            let places = matrix.iter_mut().skip(column).step_by(count);
            for (place, (now, before)) in places.zip(changes) {
                *place = (*now - *before) / apart;
            }
        }
        let weights = vec![T::one(); count];
        let (mut x, mut y) = (weights.clone(), weights.clone());
        Ok(fastest(&matrix, &weights, &mut x, &mut y))
    }
}
