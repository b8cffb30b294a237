//! What a fixed step overlooks because what acts turns as often as its stages come: an unbalanced rotor that makes a whole turn from stage to stage pushes the
//! same way at all of them, and at those of steps a quarter as long, too, if it makes four.
//!
//! ```text
//! f(t, x) beyond the hull of f at 0, h/2 and h,    at places inside a step that turns an angle by more than half a turn,    (1)
//!                                                  or where something of declared states is unseen
//! ```
//!
//! The first step is looked at, the second, the fourth and so on, and every fiftieth: what repeats itself with the steps does so in all of them, and what spins up
//! begins to in any. A look takes eight evaluations, where fifty steps take two hundred. Rejected: to refuse such a step, as where turns are counted; a wheel that
//! is in balance turns by any angle in it, and nothing follows.

use std::f64::consts::PI;

use mbd_scene::Float;

use super::stability::{OFTEN, SELDOM};
use super::{ModelRun, Pace};
use crate::error::StepError;
use crate::integrate::Rates;

/// Where stages of fixed steps are, in parts of the step, and where it is looked at besides: at no two places that are a turn apart.
const SEEN: [f64; 3] = [0.0, 0.5, 1.0];
const LOOKS: [f64; 5] = [0.11, 0.23, 0.37, 0.66, 0.89];
/// What is beyond the hull counts from this part of all that a rate is in the step on, and of its size: the rest is rounding.
const NOTICED: f64 = 0.1;
const ROUNDING: f64 = 1e-6;

impl<T: Float> ModelRun<T> {
    /// Looks into a fixed step that was tried, now and then, for what none of its stages sees.
    #[inline]
    pub(super) fn look_between_stages(&mut self, step: f64) {
        if self.may_hide() && self.is_looked_into(SELDOM) {
            self.find_between_stages(step);
        }
    }

    /// Whether something of the run may be hidden from its steps that is not known to be.
    fn may_hide(&self) -> bool {
        let turns = self.overlooked.has_states || !self.overlooked.angles.is_empty();
        turns && self.options.watch && self.hidden.is_none()
    }

    /// After how many steps from here on the run has to have its state, on the way to a time: one is looked into, or looked back at by more than its state and
    /// rates. [`SELDOM`] at most, so that a run that is cancelled hears of it.
    pub(super) fn unwatched_steps(&self, until: f64) -> u64 {
        let made = self.steps_of_run();
        let looks = self.may_hide() || self.watches_states();
        let every = match !looks && self.looks_back_plainly(until) {
            true => SELDOM,
            false => OFTEN,
        };
        let ahead = every - 1 - made % every;
        let mut early = (0..ahead).filter(|more| looks && (made + more + 1).is_power_of_two());
        early.next().unwrap_or(ahead)
    }

    #[cold]
    fn find_between_stages(&mut self, step: f64) {
        if !matches!(self.pace, Pace::Fixed(_)) {
            return;
        }
        let model = self.system.model.clone();
        let scene = model.scene();
        let turned = self.overlooked.angles.iter().filter_map(|&at| {
            let [from, to] = [&self.state[..], self.method.next()].map(|state| state.get(at));
            Some((to?.to_f64() - from?.to_f64()).abs())
        });
        let turned = turned.fold(0.0, f64::max);
        let (start, functions) = (self.time, self.system.of_time.clone());
        let course = |state, time| self.course(step, state, time);
        let unseen = (0..functions.acting())
            .filter(|number| functions.follows_states(*number))
            .find_map(|number| {
                let seen = SEEN.into_iter().map(|part| start + part * step);
                functions.unseen(scene, number, &course, [start, start + step], seen)
            });
        let unseen = unseen.map(|time| (time - start) / step);
        let looks = LOOKS.into_iter().filter(|_| turned > PI);
        let looks: Vec<f64> = looks.chain(unseen).collect();
        if looks.is_empty() {
            return;
        }
        // What is evaluated here is none of the work of the run.
        let counted = (self.system.counters, self.system.nodes.statistics);
        self.hidden = self.beyond_stages(&looks, step).unwrap_or_default();
        (self.system.counters, self.system.nodes.statistics) = counted;
    }

    /// (1): the first time that is looked at at which it is so [s].
    fn beyond_stages(&mut self, looks: &[f64], step: f64) -> Result<Option<f64>, StepError> {
        let model = self.system.model.clone();
        let layout = model.layout();
        let mut rates = vec![T::zero(); self.method.first().len()];
        let mut hull = vec![[f64::INFINITY, f64::NEG_INFINITY]; rates.len()];
        let places = layout.nq..layout.nq + layout.nv;
        let places: Vec<usize> = places.chain(layout.states()..layout.nx()).collect();
        for (number, part) in SEEN.iter().chain(looks).enumerate() {
            self.inside_state(*part, step)?;
            self.states_inside(*part, step);
            let time = self.time + part * step;
            let span = part * step;
            self.system
                .rates_inside(time, span, &self.inside, &mut rates)?;
            for &at in &places {
                let (Some(rate), Some([low, high])) = (rates.get(at), hull.get_mut(at)) else {
                    continue;
                };
                let rate = rate.to_f64();
                if number < SEEN.len() {
                    (*low, *high) = (low.min(rate), high.max(rate));
                    continue;
                }
                let out = (*low - rate).max(rate - *high);
                let size = low.abs().max(high.abs()).max(rate.abs());
                if out > (NOTICED * (*high - *low)).max(ROUNDING * size) {
                    return Ok(Some(time));
                }
            }
        }
        Ok(None)
    }
}
