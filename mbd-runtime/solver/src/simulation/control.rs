//! Driving a run: inputs that are held, functions of time and state, controllers at samples.

use mbd_scene::Float;

use super::offered::differentiable;
use super::{ModelRun, Pace};
use crate::error::{RunError, StepError};
use crate::supply::{Law, Sampler, check_model, check_numbers, check_supplied};
use crate::trajectory::resolution;

/// More samples of a controller than this are no run that ends.
const MOST_SAMPLES: f64 = 1e9;

/// Refuses a sampling period that is none, that time does not resolve, or that asks for too many samples from one time to another [s].
fn check_period(period: f64, [from, to]: [f64; 2]) -> Result<(), StepError> {
    let (samples, resolved) = ((to - from) / period, resolution(from).max(resolution(to)));
    let why = if !(period > 0.0 && period.is_finite()) {
        String::new()
    } else if period <= resolved {
        format!(" (time resolves {resolved:.1e} s here)")
    } else if samples > MOST_SAMPLES {
        format!(" ({samples:.1e} samples until {to} s, of at most {MOST_SAMPLES:.0e})")
    } else {
        return Ok(());
    };
    Err(StepError::InvalidInput {
        slot: format!("sampling period{why}"),
        value: period,
    })
}

/// The part of the tolerance from which the error of a step on what dies away is one that counts: the rest of the motion adds to it.
const MATTERS: f64 = 0.1;

impl<T: Float> ModelRun<T> {
    /// What [`Simulation::set_inputs`] does.
    pub(crate) fn give_inputs(
        &mut self,
        of: Option<(&'static str, [usize; 2])>,
        numbers: &[T],
    ) -> Result<(), RunError> {
        let model = &*self.system.model;
        let checked = check_model(model, of).and_then(|()| check_numbers(model, numbers));
        checked.map_err(|cause| self.failed(cause))?;
        self.system.hold(numbers);
        self.stale = true;
        Ok(())
    }

    /// What [`Simulation::control`] and [`Simulation::control_every`] do.
    pub(crate) fn add_control(
        &mut self,
        of: Option<(&'static str, [usize; 2])>,
        every: Option<f64>,
        law: Law<T>,
    ) -> Result<(), RunError> {
        let model = &*self.system.model;
        let checked = check_model(model, of).and_then(|()| {
            if model.layout().ni == 0 {
                return Err(StepError::Unsupported {
                    what: format!(
                        "a controller of `{}`, which has no inputs,",
                        model.scene().name
                    ),
                    instead: "declare one: `input push: force;`".into(),
                });
            }
            match every {
                Some(period) => check_period(period, [self.time; 2]),
                None => differentiable(&self.options),
            }
        });
        checked.map_err(|cause| self.failed(cause))?;
        self.system.unsupplied = false;
        self.stale = true;
        match every {
            None => {
                let system = &mut self.system;
                system.controls.push(&*system.model, law);
            }
            Some(period) => {
                self.samplers.push(Sampler {
                    period,
                    from: self.time,
                    next: 0,
                    law,
                });
                // A run that goes back does not go back to where it had fewer controllers.
                if self.started && self.watched {
                    self.good = Some(Box::new(self.kept()));
                }
            }
        }
        Ok(())
    }

    /// Whether every controller can be asked at each of its samples until a time [s].
    pub(super) fn check_periods(&self, until: f64) -> Result<(), StepError> {
        let mut periods = self.samplers.iter().map(|sampler| sampler.period);
        periods.try_for_each(|period| check_period(period, [self.time, until]))
    }

    /// Calls the controllers whose sample is now. After an error what is held is what it was, and the same sample is due again.
    #[inline]
    pub(super) fn sample(&mut self) -> Result<(), StepError> {
        match self.samplers.is_empty() {
            true => self.refresh(),
            false => self.ask_controllers(),
        }
    }

    fn ask_controllers(&mut self) -> Result<(), StepError> {
        let now = self.time + resolution(self.time);
        let due = |sampler: &Sampler<T>| sampler.instant() <= now;
        if self.samplers.iter().any(due) {
            self.given.copy_from_slice(&self.system.held);
            let state = self.state.get(..self.system.nx).unwrap_or_default();
            let model = self.system.model.clone();
            for sampler in self.samplers.iter_mut().filter(|sampler| due(sampler)) {
                let time = sampler.instant();
                let moment = self.system.settled_moment(time, state)?;
                (sampler.law)(&moment, &mut self.given);
                check_supplied(&*model, time, &self.given)?;
            }
            for sampler in self.samplers.iter_mut().filter(|sampler| due(sampler)) {
                sampler.next += 1;
            }
            if self.given != self.system.held {
                self.system.hold(&self.given);
                self.stale = true;
            }
        }
        self.refresh()
    }

    /// When the next sample of a controller is [s]; infinity where there is none.
    #[inline]
    pub(super) fn next_sample(&self) -> f64 {
        if self.samplers.is_empty() {
            return f64::INFINITY;
        }
        let instants = self.samplers.iter().map(Sampler::instant);
        instants.fold(f64::INFINITY, f64::min)
    }

    /// Keeps what functions of time and state give at the end of a call, which the first stage of the next step was evaluated with.
    #[inline]
    pub(super) fn leave(&mut self) -> Result<(), StepError> {
        match !self.stale && self.system.has_functions() {
            true => self.keep_supplied(),
            false => Ok(()),
        }
    }

    fn keep_supplied(&mut self) -> Result<(), StepError> {
        self.system.supply(self.time, &self.state)?;
        self.left.clear();
        self.left.extend_from_slice(&self.system.inputs);
        Ok(())
    }

    /// Whether functions of time and state give the same at the start of the next call; otherwise the first stage is stale.
    #[inline]
    pub(super) fn compare_supplied(&mut self) -> Result<(), StepError> {
        match !self.stale && self.system.has_functions() {
            true => self.compare_left(),
            false => Ok(()),
        }
    }

    fn compare_left(&mut self) -> Result<(), StepError> {
        self.system.supply(self.time, &self.state)?;
        self.stale = self.left != self.system.inputs;
        self.left.clear();
        Ok(())
    }

    /// The first stage and the margins of the next step, for what is supplied now, where that has changed.
    #[inline]
    pub(super) fn refresh(&mut self) -> Result<(), StepError> {
        match self.stale {
            true => self.begin_anew(),
            false => Ok(()),
        }
    }

    #[cold]
    fn begin_anew(&mut self) -> Result<(), StepError> {
        self.system
            .follow_commands(self.time, Some(0.0), &self.state)?;
        self.inside.copy_from_slice(self.method.first());
        let ahead = self.behind_jump();
        self.method
            .begin(&mut self.system, self.time + ahead, 0.0, &self.state)?;
        self.limit_pace();
        self.rebase();
        self.begin_noting()?;
        self.stale = false;
        Ok(())
    }

    /// After a jump of the rates from those in `inside` an adaptive step is at most one in which the jump moves no block by more than a hundredth of
    /// its scale: what the method has learned about smooth motion says nothing about it.
    pub(super) fn limit_pace(&mut self) {
        let Pace::Adaptive(control, norm) = &mut self.pace else {
            return;
        };
        for (jump, now) in self.inside.iter_mut().zip(self.method.first()) {
            *jump = *now - *jump;
        }
        let speed = norm.measure(&self.inside, &self.state, &self.state) * norm.tolerance;
        if speed > 0.0 {
            control.step = control.step.min(0.01 / speed);
        }
    }

    /// The same for a stiff method, which knows how fast a jump g of the rates dies away, λ = |A g|/|g|, from a = |g|/λ in tolerances: where e, the error
    /// of a step on ẏ = −λ y, does not allow the step that is next, it is one whose error is no more than the tolerance,
    ///
    /// ```text
    /// a e(hλ) > 0.1:   h = (c a)^(−1/k)/λ,   e(z) = c zᵏ + …        e is small again where z is large: a step may pass over what dies away
    /// ```
    ///
    /// which some rejected steps, a factor each, would find out.
    pub(crate) fn limit_stiff_pace(&mut self) {
        if !self.method.is_stiff() {
            return;
        }
        let Pace::Adaptive(control, norm) = &mut self.pace else {
            return;
        };
        for (jump, now) in self.inside.iter_mut().zip(self.method.first()) {
            *jump = *now - *jump;
        }
        let at = (self.time, self.state.as_slice());
        let slope = self.method.slope_along(&mut self.system, at, &self.inside);
        let Some(slope) = slope else {
            return;
        };
        let [jump, change] =
            [&self.inside, slope].map(|list| norm.size(list, &self.state, &self.state));
        let rate = change / jump;
        let amplitude = jump / rate;
        if let Some(method) = self.method.implicit()
            && amplitude * method.error_of_decay(control.step * rate) > MATTERS
        {
            let part = (method.error_constant() * amplitude).powf(-1.0 / method.exponent);
            control.step = control.step.min(part / rate);
        }
    }
}
