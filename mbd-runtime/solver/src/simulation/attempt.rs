//! Trying a step: how long it is, its stages, its error, and why it cannot be made.

use std::f64::consts::PI;

use mbd_scene::Float;

use super::{ModelRun, Pace};
use crate::accuracy::FINER_STEP;
use crate::error::{Collapse, StepError};
use crate::integrate::Verdict;
use crate::trajectory::{resolution, told_apart};
use crate::watch::Instability;

/// A step that is to be tried.
#[derive(Clone, Copy, Debug)]
pub(super) struct NextStep {
    /// Its size [s].
    pub size: f64,
    /// When it ends [s]: on what it lands on to the last digit, its start and its size but for rounding.
    pub end: f64,
    /// Whether it lands on something: fixed steps count from there.
    pub lands: bool,
    /// Whether what acts jumps at its end: its stages see what is before that.
    pub on_jump: bool,
}

/// The shortest step that is made on the way to where lines are drawn straight, over what times are told apart by.
const SHORTEST: f64 = 1e3;
/// A step beyond this says nothing about a scene [s].
const LONGEST: f64 = 1e9;

impl<T: Float> ModelRun<T> {
    /// Whether the error of a step decides the size of the next.
    pub(crate) fn is_adaptive(&self) -> bool {
        matches!(self.pace, Pace::Adaptive(..))
    }

    /// The step that is tried next, on the way to a time. It does not pass a sample of a controller, and no time known beforehand at which what acts
    /// jumps, nor adaptive ones a kink. A step of the grid that ends on a jump but for rounding is made as it is: it lands on nothing, and ends there.
    #[inline]
    pub(super) fn plan(&self, until: f64) -> NextStep {
        let until = until.min(self.next_sample());
        match self.system.next_break(self.time) {
            // What jumps at the end of a run or at a sample, but for rounding, is on the way there.
            Some(at) if at < until + resolution(until) => self.plan_to_break(until, at),
            _ => self.plan_to(until),
        }
    }

    fn plan_to(&self, until: f64) -> NextStep {
        let (size, lands) = self.propose(until);
        // The velocity of a node grows without bound where its lines are drawn straight, and no step passes that. The error test of the stiff method sees it
        // coming; where steps are cut short before it, their last stages reach just beyond, and none passes the test.
        if let Some(part) = self.system.memory.before_straight
            && !self.method.is_stiff()
            && size > part
            && part > SHORTEST * resolution(self.time)
        {
            return NextStep {
                size: part,
                end: self.time + part,
                lands: true,
                on_jump: false,
            };
        }
        let end = if lands { until } else { self.end_of(size) };
        NextStep {
            size,
            end,
            lands,
            on_jump: false,
        }
    }

    fn plan_to_break(&self, until: f64, at: f64) -> NextStep {
        let same = 0.5 * resolution(at);
        let is_on_the_way = at < until - same;
        let step = self.plan_to(if is_on_the_way { at } else { until });
        if let (Pace::Fixed(size), true) = (&self.pace, is_on_the_way)
            && (self.end_of(*size) - at).abs() <= same
        {
            return NextStep {
                size: *size,
                end: at,
                lands: false,
                on_jump: true,
            };
        }
        NextStep {
            on_jump: step.lands && self.system.jumps_at(step.end),
            ..step
        }
    }

    /// How much later than now the first stage of a step is evaluated, so that what jumps at the time of now has jumped [s]. Nothing moves in that time.
    pub(crate) fn behind_jump(&self) -> f64 {
        match self.system.jumps_at(self.time) {
            true => told_apart::<T>(self.time),
            false => 0.0,
        }
    }

    /// Evaluates the first stage on the far side of a jump that the last step ended on.
    pub(super) fn begin_behind_jump(&mut self) -> Result<(), StepError> {
        (self.stays, self.jumped) = (false, true);
        let from = self.time + self.behind_jump();
        self.method
            .begin(&mut self.system, from, 0.0, &self.state)?;
        self.jump_energy(from);
        Ok(())
    }

    /// The size of a step that lands on nothing [s].
    pub(crate) fn step_ahead(&self) -> f64 {
        match &self.pace {
            Pace::Fixed(step) => *step,
            Pace::Adaptive(control, _) => {
                let step = control.step.min(control.largest).min(LONGEST);
                match &self.below {
                    Some(other) => step.min(FINER_STEP * other.at(self.time)),
                    None => step,
                }
            }
        }
    }

    /// The size of the next step, and whether it ends at `until`.
    #[inline]
    fn propose(&self, until: f64) -> (f64, bool) {
        let left = until - self.time;
        let step = self.step_ahead();
        if step >= left * (1.0 - 1e-9) {
            (left, true)
        } else {
            (step, false)
        }
    }

    /// When the next step ends, of a size, that does not land on anything [s].
    pub(super) fn end_of(&self, step: f64) -> f64 {
        match self.pace {
            Pace::Fixed(size) => self.origin + (self.count + 1) as f64 * size,
            Pace::Adaptive(..) => self.time + step,
        }
    }

    /// Fixed steps count from here on.
    pub(super) fn regrid(&mut self) {
        self.origin = self.time;
        self.count = 0;
    }

    /// Tries a step, which may end where something jumps that its stages see nothing of; false when it was rejected and the next trial is smaller.
    pub(super) fn attempt(&mut self, step: f64, on_jump: bool) -> Result<bool, StepError> {
        let smallest = resolution(self.time);
        if step < smallest {
            let jump = self.past_jump(step);
            return Err(jump.unwrap_or_else(|| self.collapse(step, Collapse::Resolution)));
        }
        let tried = match on_jump {
            true => self.make_step_before(step),
            false => self.make_step(step),
        };
        let swept = match &tried {
            Ok(()) => {
                let (end, next) = (self.time + step, self.method.next());
                self.system.angle_swept(step, end, next)
            }
            Err(_) => 0.0,
        };
        if !self.is_adaptive() {
            return match tried {
                Ok(()) if swept > PI => Err(self.unstable(step, Instability::Turn(swept))),
                Ok(()) => {
                    self.look_between_stages(step);
                    self.watch_states(step).map(|()| true)
                }
                Err(cause) => Err(self
                    .past_jump(step)
                    .unwrap_or_else(|| self.blame(step, cause))),
            };
        }
        let judged = tried.and_then(|()| {
            // A step that turns too far is shortened as one whose error is too large.
            let by_angle = (swept / self.options.max_angle).powf(self.method.exponent());
            let error = self.error_of(step).max(by_angle).max(self.beside_loads());
            let part = match error <= 1.0 {
                true => self.overlooks(step, error)?,
                false => None,
            };
            Ok((error, part))
        });
        let Pace::Adaptive(control, _) = &mut self.pace else {
            return Ok(true);
        };
        let (verdict, failure) = match judged {
            Ok((_, Some(part))) => (control.shorten(step, part, smallest), None),
            Ok((error, None)) => (control.judge(step, error, smallest), None),
            Err(cause) => (control.fail(step, smallest), Some(cause)),
        };
        if verdict == Verdict::Accepted {
            return Ok(true);
        }
        let counters = &mut self.system.counters;
        counters.rejected = counters.rejected.saturating_add(1);
        match (verdict, failure) {
            (Verdict::Rejected, None) => self.look_at_rows(step).map(|()| false),
            (Verdict::Rejected, _) => Ok(false),
            (_, Some(cause)) => Err(self.past_jump(step).unwrap_or(cause)),
            (_, None) => {
                let jump = self.past_jump(step);
                Err(jump.unwrap_or_else(|| self.collapse(step, Collapse::ErrorTest)))
            }
        }
    }

    /// What is prescribed jumps inside a step that cannot be made, or right behind its start.
    #[cold]
    fn past_jump(&mut self, step: f64) -> Option<StepError> {
        let within = step.max(4.0 * resolution(self.time));
        self.system.prescribed_jump(self.time, within)
    }

    /// The error of the last attempt, in tolerances.
    fn error_of(&mut self, step: f64) -> f64 {
        match &mut self.pace {
            Pace::Adaptive(_, norm) => {
                let (error, next) = self.method.estimate(step);
                norm.measure(error, &self.state, next)
            }
            Pace::Fixed(_) => 0.0,
        }
    }

    /// How far the last attempt left rate nodes beside where their lines carry their loads, in tolerances.
    fn beside_loads(&mut self) -> f64 {
        if !self.system.nodes.carries_by_place() {
            return 0.0;
        }
        self.inside.copy_from_slice(self.method.next());
        self.system.project(&mut self.inside);
        for (place, next) in self.inside.iter_mut().zip(self.method.next()) {
            *place -= *next;
        }
        match &self.pace {
            Pace::Adaptive(_, norm) => norm.size(&self.inside, &self.state, self.method.next()),
            Pace::Fixed(_) => 0.0,
        }
    }

    /// Makes a trial step, of any size, from the last accepted one.
    pub(crate) fn make_step(&mut self, step: f64) -> Result<(), StepError> {
        self.system.see_all();
        if self.take_received(step) {
            return Ok(());
        }
        self.make_own_step(step)
    }

    /// The same where the step ends on events: its stages see what is before them, so that what jumps there jumps behind the step.
    pub(crate) fn make_step_before(&mut self, step: f64) -> Result<(), StepError> {
        self.see_before_end(step);
        self.system.known.forget();
        self.make_own_step(step)
    }

    /// What is evaluated from here on sees nothing of what is behind the end of the step of a size.
    pub(super) fn see_before_end(&mut self, step: f64) {
        let rounding = 2.0 * T::EPSILON.to_f64() * (self.time.abs() + step);
        let apart = rounding.max(3.0 * self.resolved(step));
        let latest = self.time + (step - apart).max(0.0);
        self.system
            .see_before(latest, self.margins.sides_of_events());
    }

    pub(super) fn make_own_step(&mut self, step: f64) -> Result<(), StepError> {
        let (time, state) = (self.time, &self.state);
        (self.attempted, self.beside, self.lacks_stages) = (f64::NAN, false, false);
        self.system.forget_angles();
        if let Err(cause) = self.method.attempt(&mut self.system, time, step, state) {
            self.attempt_again(step, cause)?;
        }
        self.attempted = step;
        Ok(())
    }

    /// A stage came too close to a state where rows repeat each other: the step is made with rows chosen at its start.
    #[cold]
    fn attempt_again(&mut self, step: f64, cause: StepError) -> Result<(), StepError> {
        let (time, state) = (self.time, &self.state);
        match cause {
            StepError::SingularConstraints { .. } if self.system.escalate(time, state) => {
                self.method.attempt(&mut self.system, time, step, state)
            }
            cause => Err(cause),
        }
    }

    /// The last attempt, of this size, did not pass the error test: what it may see near a state where rows lose rank is not the step's.
    fn look_at_rows(&mut self, step: f64) -> Result<(), StepError> {
        let (time, state) = (self.time, &self.state);
        let ends = [state, self.method.next()];
        match self.system.widen([time, time + step], ends) {
            true => self.method.begin(&mut self.system, time, 0.0, state),
            false => Ok(()),
        }
    }

    #[cold]
    pub(crate) fn collapse(&self, step: f64, cause: Collapse) -> StepError {
        let block = match &self.pace {
            Pace::Fixed(_) => "state".into(),
            Pace::Adaptive(_, norm) => norm.worst(self.system.model.scene()),
        };
        StepError::StepCollapse {
            time: self.time,
            step_size: step,
            block,
            cause,
        }
    }
}
