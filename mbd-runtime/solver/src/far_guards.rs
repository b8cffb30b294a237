//! Guards of declared events in scenes whose origin follows something: what refers to the world is rounded to the last digits of places there, and since
//! the place of the origin and what is measured from it are added, up and down. Right behind a passing such a guard may be back by that.
//!
//! ```text
//! r = Σ_k |g(x + 4 ε |p_k| e_k) − g(x)|        p_k the coordinates of places in the world                                     (1)
//! ```
//!
//! A guard that has passed is back once it is by more than r. Where things are near the world's origin r is less than a guard moves by in what is one
//! instant; a guard of what lies between things, or of time, has none.
//!
//! Source: derived. Rejected: a length of time in which nothing passes again, which what is fast does.

use mbd_scene::Float;

use crate::error::StepError;
use crate::moving::moving;
use crate::simulation::ModelRun;

/// By so many last places the sum of two places, and what is made of it, may be off.
const LAST_PLACES: f64 = 4.0;

impl<T: Float> ModelRun<T> {
    /// Lets events that are on another side than the one that was kept come back from there by more than (1) only.
    pub(crate) fn settle_far_guards(&mut self) -> Result<(), StepError> {
        if !self.margins.have_passed() {
            return Ok(());
        }
        let declared: Vec<(usize, usize)> = self.margins.declared().collect();
        for (index, at) in declared {
            if self.margins.has_passed(index) {
                let rounding = self.rounding_of_guard(at);
                self.margins.clear_rounding(index, rounding);
            }
        }
        self.resume_margins()
    }

    /// (1) of the guard at a place among the guards.
    fn rounding_of_guard(&mut self, at: usize) -> f64 {
        let state = self.state.clone();
        let world: Vec<f64> = self.system.in_world(self.time, &state).collect();
        let places = moving(self.system.model.layout());
        let numbers: Vec<usize> = places.flat_map(|moving| moving.position).collect();
        let guard = |guards: Option<Vec<f64>>| guards.and_then(|all| all.get(at).copied());
        let here = guard(self.guards_at(self.time, &state));
        let mut rounding = 0.0;
        for index in numbers {
            let mut beside = state.clone();
            if let (Some(x), Some(place)) = (beside.get_mut(index), world.get(index)) {
                *x += T::from_f64(LAST_PLACES * T::EPSILON.to_f64() * place.abs());
            }
            let there = guard(self.guards_at(self.time, &beside));
            let off = here.zip(there).map(|(here, there)| (there - here).abs());
            rounding += off.filter(|off| off.is_finite()).unwrap_or(0.0);
        }
        rounding
    }
}
