//! What an adaptive step overlooks, though its error passes: a pulse that lasts less than the time between two stages, an obstacle between two places.
//!
//! The error of a step compares what its stages saw. Where all of them saw the same the error is zero, the next step is five times as long, and what lies
//! between is never seen. So a step that passes its error test is looked at again:
//!
//! ```text
//! h |f(t, x) − f̂(t, x)|,    t where something of time and states is unseen, f̂ straight between the stages next to t    (1)
//! h |Δ⁴ f| / 8,             f along the step at looks that what changes is a tenth of its scale apart           (2)
//! ```
//!
//! Each is measured as an error of the step is. (1) is looked at in every step in which [`TimeFunctions::unseen`] finds such a time, declared states on the square of
//! time that begins as they do and ends where they end; (2) where the error
//! is so small that it says nothing or little about the next step, and what acts has places at which it changes quickly. Where either exceeds the tolerance
//! by more than the error of the step makes likely, the step ends there. Derived; the idea of looking at the rates between the stages: W. H. Enright,
//! *Analysis of error control strategies for continuous Runge–Kutta methods*, SIAM J. Numer. Anal. 26 (1989).

use mbd_scene::laws::of_time::TimeFunctions;
use mbd_scene::{Float, Formula, Function, Layout, Scene};

use super::{ModelRun, Pace};
use crate::error::StepError;
use crate::integrate::Rates;
use crate::moving::moving;

/// An error, in tolerances, that says nothing about what lies between the stages, and one that says little: a stage may have been at the foot of something.
const QUIET: f64 = 1e-3;
const SMALL: f64 = 0.1;
/// How much larger than the error of a step (1) and (2) are where nothing is overlooked, at most.
const LIKELY: f64 = 1e3;
/// The part of its scale by which places, speeds and states may change between two looks, the fewest and the most looks at a step, and the most where its error says
/// little.
const APART: f64 = 0.1;
const FEWEST: u32 = 8;
const MOST: u32 = 256;
const SOME: u32 = 32;
/// How many steps ahead a number of time alone is looked at: where it rises or falls all the way there is nothing to see.
const AHEAD: f64 = 8.0;
/// Δ⁴, the newest first, and the part of it that counts.
const DIFFERENCES: [f64; 5] = [1.0, -4.0, 6.0, -4.0, 1.0];
const PART: f64 = 0.125;

/// Room for looks at a step.
#[derive(Clone, Debug)]
pub(super) struct Overlooked<T> {
    /// Whether what acts has places at which it changes quickly.
    is_local: bool,
    /// The angles that are coordinates, in the state, unless all of them are prescribed, and whether there are declared states.
    pub(super) angles: Vec<usize>,
    pub(super) has_states: bool,
    /// From when until when each number of time alone rises, falls or stays [s].
    monotone: Vec<[f64; 2]>,
    /// Rates at the last five looks, in turn.
    rates: [Vec<T>; 5],
    difference: Vec<T>,
}

impl<T: Float> Overlooked<T> {
    /// Room for states of a length and so many numbers of time alone.
    pub(super) fn new((scene, layout): (&Scene, &Layout), length: usize, of_time: usize) -> Self {
        let room = || vec![T::zero(); length];
        // What is prescribed altogether is where it has to be, however long its steps.
        let is_free = layout.freedoms_at_start() > 0;
        let angles = moving(layout).filter(|part| is_free && !part.has_quaternion());
        Overlooked {
            angles: angles.flat_map(|part| part.attitude).collect(),
            has_states: layout.ns > 0,
            is_local: scene
                .acting_formulas()
                .any(|formula| is_local(scene, formula)),
            monotone: vec![[f64::NAN; 2]; of_time],
            rates: std::array::from_fn(|_| room()),
            difference: room(),
        }
    }

    /// Other params make other numbers of time alone.
    pub(super) fn forget(&mut self) {
        self.monotone.fill([f64::NAN; 2]);
    }

    /// Puts h Σ weight f into `difference`, over the looks from `newest` back.
    fn combine(&mut self, step: f64, newest: usize, weights: &[f64]) {
        self.difference.fill(T::zero());
        for (back, weight) in weights.iter().enumerate() {
            let own = &self.rates[(newest + 5 - back) % 5];
            let weight = T::from_f64(step * weight);
            for (sum, rate) in self.difference.iter_mut().zip(own) {
                *sum += weight * *rate;
            }
        }
    }
}

/// Whether a formula changes quickly at some places of a scene and hardly at others: tables, kinks, choices, quotients and what decays.
fn is_local(scene: &Scene, formula: &Formula) -> bool {
    use Function::{Abs, Atan2, Div, Exp, Floor, IfAtMost, IfLess, Ln, Max, Min, Power, Tanh};
    scene.contains(formula, |part| {
        let places = match part {
            Formula::Lookup(_, arguments) => &arguments[..],
            Formula::Apply(Div, arguments) => arguments.get(1..).unwrap_or(&[]),
            Formula::Apply(
                Abs | Atan2 | Exp | Floor | IfAtMost | IfLess | Ln | Max | Min | Power | Tanh,
                arguments,
            ) => arguments,
            _ => &[],
        };
        places.iter().any(|place| !scene.is_of_time(place))
    })
}

impl<T: Float> ModelRun<T> {
    /// The part of the attempted step, which passed its error test with this error, at which it overlooks something; `None` where it does not.
    ///
    /// # Errors
    /// Rates that cannot be had at a time that the step overlooks.
    pub(super) fn overlooks(&mut self, step: f64, error: f64) -> Result<Option<f64>, StepError> {
        self.looks = 0;
        let allowed = (LIKELY * error).max(1.0);
        for number in 0..self.system.of_time.acting() {
            let follows = self.system.of_time.follows_states(number);
            if !follows && self.is_monotone(number, step) {
                continue;
            }
            let Some(part) = self.unseen_part(number, step) else {
                continue;
            };
            let size = self.jumps_unseen(part, step, follows)?;
            if size.is_nan() || size > allowed {
                return Ok(Some(part));
            }
        }
        if error >= SMALL || error >= QUIET && !self.overlooked.is_local {
            return Ok(None);
        }
        let mut looks = self.looks_by_motion(step);
        match error < QUIET {
            true => self.looks = looks.unwrap_or_default(),
            false => looks = looks.map(|looks| looks.min(SOME)),
        }
        let looks = looks.filter(|_| self.overlooked.is_local);
        Ok(looks.and_then(|looks| self.bends_between(looks, step, allowed)))
    }

    /// Whether a number of time alone rises, falls or stays over the step.
    fn is_monotone(&mut self, number: usize, step: f64) -> bool {
        let (scene, functions) = (self.system.model.scene(), &self.system.of_time);
        let Some(span) = self.overlooked.monotone.get_mut(number) else {
            return false;
        };
        let (start, end) = (self.time, self.time + step);
        let is_inside = |span: &[f64; 2]| span[0] <= start && end <= span[1];
        if !is_inside(span) {
            let ahead = [start, start + AHEAD * step];
            if functions.is_monotone(scene, number, ahead) {
                *span = ahead;
            }
        }
        is_inside(span)
    }

    /// A declared state, by number, at a time of the step, and its rate.
    pub(super) fn course(&self, step: f64, state: usize, time: f64) -> [f64; 2] {
        let place = self.system.model.layout().states() + state;
        let lists = [&self.state[..], self.method.next(), self.method.first()];
        let own = |list: &[T]| list.get(place).map_or(f64::NAN, |x| x.to_f64());
        let [start, end, rate] = lists.map(own);
        let (part, moved) = ((time - self.time) / step, rate * step);
        let bend = end - start - moved;
        [
            start + (moved + bend * part) * part,
            rate + 2.0 * bend * part / step,
        ]
    }

    /// Where (1) is to be looked at for a number of time and states, in parts of the step.
    fn unseen_part(&self, number: usize, step: f64) -> Option<f64> {
        let (scene, method, start) = (self.system.model.scene(), &self.method, self.time);
        let stages = (0..).map_while(|stage| method.stage_time(stage));
        let seen = stages.chain([0.0, 1.0]).map(|part| start + part * step);
        let functions: &TimeFunctions = &self.system.of_time;
        let course = |state, time| self.course(step, state, time);
        let found = functions.unseen(scene, number, &course, [start, start + step], seen)?;
        Some((found - start) / step)
    }

    /// (1) at a part of the step, in tolerances; whether declared states go on with time.
    fn jumps_unseen(&mut self, part: f64, step: f64, follows: bool) -> Result<f64, StepError> {
        self.inside_state(part, step)?;
        let stages = (0..).map_while(|stage| self.method.stage_time(stage));
        let (before, after) = stages
            .chain([0.0, 1.0])
            .fold((0.0, 1.0), |(low, high), at| match at <= part {
                true => (at.max(low), high),
                false => (low, at.min(high)),
            });
        for (look, at) in [before, after, part].into_iter().enumerate() {
            if follows {
                self.states_inside(at, step);
            }
            self.look_at_rates(look, at, [part, step])?;
        }
        let toward = (part - before) / (after - before);
        self.overlooked
            .combine(step, 2, &[1.0, -toward, toward - 1.0]);
        Ok(self.measure_difference())
    }

    /// Puts the declared states of a part of the step into the state inside.
    pub(super) fn states_inside(&mut self, part: f64, step: f64) {
        let (first, count) = {
            let layout = self.system.model.layout();
            (layout.states(), layout.ns)
        };
        for state in 0..count {
            let [value, _] = self.course(step, state, self.time + part * step);
            if let Some(own) = self.inside.get_mut(first + state) {
                *own = T::from_f64(value);
            }
        }
    }

    /// How many looks (2) takes; `None` where nothing gets far.
    fn looks_by_motion(&self, step: f64) -> Option<u32> {
        let Pace::Adaptive(_, norm) = &self.pace else {
            return None;
        };
        let (ends, rates) = ([&self.state[..], self.method.next()], self.method.first());
        let far = ends.map(|state| norm.motion(step, state, rates));
        let far = far[0].max(far[1]) / APART;
        (far >= 1.0).then(|| (far.min(f64::from(MOST)) as u32).clamp(FEWEST, MOST))
    }

    /// The first look at which (2) is more than `allowed`, in parts of the step.
    fn bends_between(&mut self, looks: u32, step: f64, allowed: f64) -> Option<f64> {
        self.overlooked.rates[0].copy_from_slice(self.method.first());
        for look in 1..=looks {
            let part = f64::from(look) / f64::from(looks);
            let place = look as usize % 5;
            let looked = self
                .inside_state(part, step)
                .and_then(|()| self.look_at_rates(place, part, [part, step]));
            if looked.is_err() {
                return Some(part);
            }
            if look >= 4 {
                let weights = DIFFERENCES.map(|weight| PART * weight);
                self.overlooked.combine(step, place, &weights);
                let size = self.measure_difference();
                if size.is_nan() || size > allowed {
                    return Some(part);
                }
            }
        }
        None
    }

    /// Puts the rates at the state `inside` of a part of the step, as they are at the time of another part, into the room of a look.
    fn look_at_rates(
        &mut self,
        look: usize,
        at: f64,
        [part, step]: [f64; 2],
    ) -> Result<(), StepError> {
        let Some(rates) = self.overlooked.rates.get_mut(look) else {
            return Ok(());
        };
        let time = self.time + at * step;
        self.system
            .rates_inside(time, part * step, &self.inside, rates)
    }

    fn measure_difference(&mut self) -> f64 {
        match &mut self.pace {
            Pace::Adaptive(_, norm) => {
                norm.size(&self.overlooked.difference, &self.state, self.method.next())
            }
            Pace::Fixed(_) => 0.0,
        }
    }
}
