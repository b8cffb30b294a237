//! Advancing: try a step, test its error, look for events inside it, record, commit.

use std::f64::consts::PI;

use mbd_scene::laws::breaks::Break;
use mbd_scene::{Float, Quantity};

use super::offered::emitted;
use super::{Pace, Simulation, Stop};
use crate::accuracy::FINER_STEP;
use crate::balance::EnergyBalance;
use crate::error::{Collapse, RunError, StepError};
use crate::event::{Happening, Occurrence};
use crate::identity;
use crate::integrate::{Control, StiffnessTest, Verdict};
use crate::momentum::MomentumBalance;
use crate::row::RowPlace;
use crate::trajectory::{Trajectory, resolution};
use crate::watch::{Instability, Watch};

/// A step beyond this says nothing about a scene [s].
const LONGEST: f64 = 1e9;

/// What the tests of a step remember, as it was before the step.
struct Judgement {
    control: Option<Control>,
    watch: Watch,
    balance: Option<EnergyBalance>,
    momentum: Option<MomentumBalance>,
    stiffness: StiffnessTest,
}

/// A run on its way to a time.
#[derive(Clone, Copy, Debug, Default)]
pub struct Course {
    /// Where it ends [s].
    pub until: f64,
    /// Whether what is due at its start is done.
    pub opened: bool,
    /// Steps that were tried.
    pub(super) trials: u64,
}

impl<T: Float> Simulation<T> {
    /// What [`Simulation::step`] does.
    pub(crate) fn take_step(&mut self) -> Result<(), RunError> {
        self.whole(Self::step_now)
    }

    fn step_now(&mut self) -> Result<(), RunError> {
        self.enter()?;
        self.shown.forget();
        let steps = self.system.counters.steps;
        while self.system.counters.steps == steps {
            self.changes.stop = None;
            if let Err(mut cause) = self.advance(f64::INFINITY, &mut None, &mut |_| true) {
                self.go_back(&mut cause, &mut None)?;
                return Err(self.failed(cause));
            }
        }
        self.leave().map_err(|cause| self.failed(cause))
    }

    /// Starts a run that was not started. In one that was, functions of time and state may give something else than in the last call, and what is
    /// held may have changed: then the first stage is evaluated anew.
    #[inline]
    fn enter(&mut self) -> Result<(), RunError> {
        match self.started {
            false => self.begin(),
            true if !self.stale && !self.system.has_functions() => Ok(()),
            true => {
                let begun = self.compare_supplied().and_then(|()| self.refresh());
                begun.map_err(|cause| self.failed(cause))
            }
        }
    }

    /// What [`Simulation::run_while`] does.
    pub(crate) fn drive(
        &mut self,
        until: f64,
        mut trajectory: Option<&mut Trajectory>,
        go_on: &mut dyn FnMut(f64) -> bool,
    ) -> Result<Stop, RunError> {
        let mut course = self.set_course(until)?;
        loop {
            if let Some(stop) = self.follow(&mut course, &mut trajectory, go_on)? {
                return Ok(stop);
            }
        }
    }

    /// Begins to run until a time.
    pub(crate) fn set_course(&mut self, until: f64) -> Result<Course, RunError> {
        if !until.is_finite() {
            return Err(self.failed(StepError::InvalidInput {
                slot: "end time".into(),
                value: until,
            }));
        }
        if until < self.time - resolution(self.time) {
            let now = self.time;
            return Err(self.failed(StepError::Backwards { now, until }));
        }
        let periods = self.check_periods(until);
        periods.map_err(|cause| self.failed(cause))?;
        self.changes.stop = None;
        self.stays = false;
        self.whole(Self::enter)?;
        self.look_for_hidden(until);
        self.chatter.window = 1e-3 * (until - self.time);
        Ok(Course {
            until,
            opened: false,
            trials: 0,
        })
    }

    /// Looks whether something of time alone acts between the stages of fixed steps until a time.
    fn look_for_hidden(&mut self, until: f64) {
        if let (Pace::Fixed(step), None) = (&self.pace, self.hidden) {
            let (scene, span) = (self.system.model.scene(), [self.time, until]);
            self.hidden = self.system.of_time.hidden_from_steps(scene, span, *step);
        }
    }

    /// Tries the next step on a course, at first what is due at its start; `None` where there is more to come.
    pub(crate) fn follow(
        &mut self,
        course: &mut Course,
        trajectory: &mut Option<&mut Trajectory>,
        go_on: &mut dyn FnMut(f64) -> bool,
    ) -> Result<Option<Stop>, RunError> {
        self.whole(|run| run.follow_now(course, trajectory, go_on))
    }

    fn follow_now(
        &mut self,
        course: &mut Course,
        trajectory: &mut Option<&mut Trajectory>,
        go_on: &mut dyn FnMut(f64) -> bool,
    ) -> Result<Option<Stop>, RunError> {
        self.shown.forget();
        let mut outcome = match course.opened {
            true => self.try_next(course, trajectory, go_on),
            false => self.open(course, trajectory),
        };
        if let Ok(Some(_)) = outcome
            && let Err(cause) = self.record_end(trajectory).and_then(|()| self.leave())
        {
            outcome = Err(cause);
        }
        if let Err(cause) = &mut outcome {
            self.go_back(cause, trajectory)?;
            if let StepError::StepCollapse { time, .. } = *cause
                && let Some(lost) = self.system.vanishing_inertia(time, &self.state)
            {
                *cause = lost;
            }
            // What broke the run is told; where its last state cannot be measured, metrics of the end have no value.
            let _ = self.measure_instant(trajectory);
        }
        if let Some(trajectory) = trajectory
            && !matches!(outcome, Ok(None))
        {
            trajectory.statistics = self.system.statistics();
        }
        outcome.map_err(|cause| self.failed(cause))
    }

    /// What is due at the start of a course: samples, a row.
    fn open(
        &mut self,
        course: &mut Course,
        trajectory: &mut Option<&mut Trajectory>,
    ) -> Result<Option<Stop>, StepError> {
        course.opened = true;
        if let Some(trajectory) = trajectory {
            let model = &self.system.model;
            let own = || identity::of_columns(model.scene(), model.layout());
            trajectory.check(*self.columns.get_or_init(own), [self.time, course.until])?;
            trajectory.locates = self.options.locate;
            if trajectory.takes_outputs() {
                emitted(&**model, Quantity::Outputs)?;
            }
        }
        if course.until - self.time > resolution(self.time) {
            self.sample()?;
        }
        if let Some(event) = self.changes.stop.take() {
            return Ok(Some(Stop::Event(event)));
        }
        self.measure_instant(trajectory)?;
        if let Some(trajectory) = trajectory
            && trajectory.open(self.time)
        {
            trajectory.push(
                &mut self.system,
                (self.time, RowPlace::After(0.0)),
                &self.state,
                &mut self.scratch,
            )?;
        }
        Ok(None)
    }

    fn try_next(
        &mut self,
        course: &mut Course,
        trajectory: &mut Option<&mut Trajectory>,
        go_on: &mut dyn FnMut(f64) -> bool,
    ) -> Result<Option<Stop>, StepError> {
        let seen = self.events.len();
        if course.until - self.time <= resolution(self.time) {
            self.watch_end()?;
            let acted = self.happen_at_end()?;
            self.tell_events(seen, trajectory);
            if acted {
                self.record_step(trajectory)?;
            }
            let stopped = self.stopped(seen).map(Stop::Event);
            return Ok(stopped.or(Some(Stop::Reached)));
        }
        if course.trials >= self.options.max_steps {
            let stiff = self.stiff();
            return Err(StepError::TooManySteps {
                steps: course.trials,
                stiff,
            });
        }
        course.trials += 1;
        self.advance(course.until, trajectory, go_on)?;
        self.tell_events(seen, trajectory);
        if let Some(event) = self.stopped(seen) {
            return Ok(Some(Stop::Event(event)));
        }
        match go_on(self.time) {
            true => Ok(None),
            false => Err(StepError::Cancelled),
        }
    }

    /// Events since so many in the history.
    fn tell_events(&self, seen: usize, trajectory: &mut Option<&mut Trajectory>) {
        let Some(trajectory) = trajectory else {
            return;
        };
        for new in self.events.get(seen..).unwrap_or(&[]) {
            let passed = match new.what {
                Happening::Declared(event) => self.passed_at(event, new.time),
                Happening::Switch(..) => new.time,
            };
            trajectory.tell([new.time, passed], self.name_event(new.what));
        }
    }

    /// The event that ends the run here, if one of those since so many does.
    fn stopped(&mut self, seen: usize) -> Option<usize> {
        let asked = self.changes.stop.take();
        asked.or_else(|| {
            let stops = self.options.stop_at_events;
            stops.then(|| self.declared_since(seen)).flatten()
        })
    }

    /// Tries one step, and takes it if it passes.
    fn advance(
        &mut self,
        until: f64,
        trajectory: &mut Option<&mut Trajectory>,
        go_on: &mut dyn FnMut(f64) -> bool,
    ) -> Result<(), StepError> {
        self.stays = false;
        self.sample()?;
        if self.changes.stop.is_some() {
            return Ok(());
        }
        let until = until.min(self.next_landing());
        let (step, lands) = self.propose(until);
        let on_jump = lands && self.jumps_at(until);
        // Nothing but a row inside the step can make it be taken back.
        let inside = trajectory
            .as_ref()
            .is_some_and(|it| it.is_due_inside([self.time, step]));
        let before = inside.then(|| self.judgement());
        if !self.attempt(step, on_jump)? {
            return Ok(());
        }
        let Some(found) = self.find_event(step)? else {
            let end = match lands {
                true => until,
                false => self.end_of(step),
            };
            self.system.check_end(end, step, self.method.next())?;
            self.watch_step(step)?;
            let changes = self.sees_stiffness(step);
            let acts = trajectory.is_some() && self.margins.acts_behind;
            if trajectory.is_some() {
                if acts {
                    self.see_before_end(step);
                }
                self.record_inside([step, end], trajectory, go_on, (acts, before))?;
                self.measure_step([step, end], trajectory)?;
            }
            self.take(step, end)?;
            if on_jump {
                self.begin_behind_jump()?;
            }
            if changes {
                self.stays = false;
                self.change_method();
            }
            if !acts {
                self.record_step(trajectory)?;
            }
            if lands && until.is_finite() {
                self.regrid();
            }
            return self.look_back();
        };
        let acts = self.margins.about_to_act();
        if found.step > 0.0 {
            let end = self.time + found.step;
            self.system.check_end(end, found.step, self.method.next())?;
            self.watch_step(found.step)?;
            // The last step ended on the same instant, and was seen from before it.
            let seen = acts && found.step <= self.one_instant(found.step);
            if seen {
                if let Some(trajectory) = trajectory {
                    trajectory.put_last_at(end);
                }
            } else {
                let size = [found.step, end];
                self.record_inside(size, trajectory, go_on, (acts, before))?;
                self.measure_step(size, trajectory)?;
            }
            let taken = self.take(found.step, end);
            self.regrid();
            taken?;
        }
        self.stays = false;
        self.regrid();
        self.happen()?;
        self.rebase();
        self.record_step(trajectory)
    }

    /// Whether the error of a step decides the size of the next.
    pub(crate) fn is_adaptive(&self) -> bool {
        matches!(self.pace, Pace::Adaptive(..))
    }

    /// The next time that a step does not pass: a sample of a controller, of adaptive steps a kink that is known beforehand [s].
    pub(super) fn next_landing(&self) -> f64 {
        let kink = self.next_break().map_or(f64::INFINITY, |it| it.time);
        self.next_sample().min(kink)
    }

    /// The next kink that adaptive steps end on.
    fn next_break(&self) -> Option<Break> {
        let now = self.time + resolution(self.time);
        self.is_adaptive()
            .then(|| self.system.next_break(now))
            .flatten()
    }

    /// Whether something jumps at a time that the next step ends on.
    pub(super) fn jumps_at(&self, end: f64) -> bool {
        self.next_break()
            .is_some_and(|it| it.jumps && it.time == end)
    }

    /// Evaluates the first stage on the far side of a jump that the last step ended on.
    fn begin_behind_jump(&mut self) -> Result<(), StepError> {
        self.stays = false;
        let ahead = resolution(self.time);
        let from = self.time + ahead;
        self.method
            .begin(&mut self.system, from, ahead, &self.state)?;
        self.jump_energy(from);
        Ok(())
    }

    /// The size of the next step, and whether it ends at `until`.
    pub(super) fn propose(&self, until: f64) -> (f64, bool) {
        let left = until - self.time;
        let step = match &self.pace {
            Pace::Fixed(step) => *step,
            Pace::Adaptive(control, _) => {
                let step = control.step.min(control.largest).min(LONGEST);
                match &self.below {
                    Some(other) => step.min(FINER_STEP * other.at(self.time)),
                    None => step,
                }
            }
        };
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
    fn regrid(&mut self) {
        self.origin = self.time;
        self.count = 0;
    }

    /// Tries a step, which may end where something jumps that its stages see nothing of; false when it was rejected and the next trial is smaller.
    fn attempt(&mut self, step: f64, on_jump: bool) -> Result<bool, StepError> {
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
                Ok(()) => Ok(true),
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
    fn see_before_end(&mut self, step: f64) {
        let rounding = 2.0 * T::EPSILON.to_f64() * (self.time.abs() + step);
        let apart = rounding.max(3.0 * self.resolved(step));
        let latest = self.time + (step - apart).max(0.0);
        self.system
            .see_before(latest, self.margins.sides_of_events());
    }

    pub(super) fn make_own_step(&mut self, step: f64) -> Result<(), StepError> {
        let (time, state) = (self.time, &self.state);
        (self.attempted, self.beside, self.lacks_stages) = (f64::NAN, false, false);
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

    /// Takes the last attempt: state, memory and time move on together.
    fn take(&mut self, step: f64, end: f64) -> Result<(), StepError> {
        self.system.take_commands();
        self.system.known.forget();
        self.method.accept(&mut self.state);
        self.system.see_all();
        // Not before: a step that is refused is none of the grid.
        self.time = end;
        self.count += 1;
        let counters = &mut self.system.counters;
        counters.steps = counters.steps.saturating_add(1);
        if self.method.is_stiff() {
            counters.stiff_steps = counters.stiff_steps.saturating_add(1);
        }
        if let Pace::Adaptive(..) = self.pace {
            self.step_sizes.add(end);
        }
        let projected = self.system.project(&mut self.state);
        let begun = match projected {
            true => self.method.begin(&mut self.system, end, step, &self.state),
            false => Ok(()),
        };
        self.system.commit(step);
        self.system.count_turns(end, &self.state);
        begun?;
        self.stays = self.beside && !projected;
        self.lacks_stages = false;
        if projected {
            self.begin_noting()?;
        }
        let length = self.sizes.length();
        match self.system.keep_up(end, length, &mut self.state) {
            true => {
                self.stays = false;
                self.method.begin(&mut self.system, end, 0.0, &self.state)
            }
            false => Ok(()),
        }
    }

    /// Rows due strictly inside the attempted step, of a size and with this end [s], or at its end, which is seen from before where events act there: then
    /// it is a row as well when every step is asked for. Between two rows the run may be cancelled: the step then is not taken, and
    /// its rows are dropped, so that a run that goes on writes them as if nothing had been.
    fn record_inside(
        &mut self,
        [step, told]: [f64; 2],
        trajectory: &mut Option<&mut Trajectory>,
        go_on: &mut dyn FnMut(f64) -> bool,
        (acts, before): (bool, Option<Judgement>),
    ) -> Result<(), StepError> {
        let Some(trajectory) = trajectory else {
            return Ok(());
        };
        if acts && trajectory.due().is_none() {
            self.inside_state(1.0, step)?;
            let place = self.place_before(step);
            return trajectory.push(
                &mut self.system,
                (told, place),
                &self.inside,
                &mut self.scratch,
            );
        }
        let end = self.time + step;
        let instant = match acts {
            true => self.one_instant(step),
            false => resolution(end),
        };
        while let Some(due) = trajectory.due() {
            if due > end + resolution(end) {
                break;
            }
            let theta = match end - due > instant {
                true => (due - self.time) / step,
                false => 1.0,
            };
            self.inside_state(theta, step)?;
            if theta < 1.0 {
                self.system.stay(due, &mut self.inside)?;
            }
            let place = match theta >= 1.0 {
                true if acts => self.place_before(step),
                true if !self.system.sees_before() => RowPlace::End,
                _ => RowPlace::After(due - self.time),
            };
            trajectory.push(
                &mut self.system,
                (due, place),
                &self.inside,
                &mut self.scratch,
            )?;
            if theta < 1.0 && !go_on(due) {
                trajectory.cut(self.time);
                if let Some(before) = before {
                    self.judge_anew(before);
                }
                return Err(StepError::Cancelled);
            }
        }
        Ok(())
    }

    /// What a step changes before it is taken.
    fn judgement(&self) -> Judgement {
        Judgement {
            control: match &self.pace {
                Pace::Fixed(_) => None,
                Pace::Adaptive(control, _) => Some(control.clone()),
            },
            watch: self.watch,
            balance: self.balance,
            momentum: self.momentum,
            stiffness: self.stiffness,
        }
    }

    /// Takes back what an attempted step changed: it will be made again.
    #[cold]
    fn judge_anew(&mut self, before: Judgement) {
        if let (Pace::Adaptive(control, _), Some(before)) = (&mut self.pace, before.control) {
            *control = before;
        }
        (self.watch, self.balance) = (before.watch, before.balance);
        self.momentum = before.momentum;
        self.stiffness = before.stiffness;
    }

    /// A row at the accepted step, when every step is asked for.
    #[inline]
    fn record_step(&mut self, trajectory: &mut Option<&mut Trajectory>) -> Result<(), StepError> {
        match trajectory {
            Some(trajectory) if trajectory.due().is_none() => trajectory.push(
                &mut self.system,
                (self.time, RowPlace::After(0.0)),
                &self.state,
                &mut self.scratch,
            ),
            _ => Ok(()),
        }
    }

    /// Puts the state at `theta` of the attempted step into `inside`.
    pub(crate) fn inside_state(&mut self, theta: f64, step: f64) -> Result<(), StepError> {
        if theta >= 1.0 {
            self.inside.copy_from_slice(self.method.next());
        } else {
            if self.lacks_stages {
                self.make_stages(step)?;
            }
            let (time, state) = (self.time, &self.state);
            self.method.complete(&mut self.system, time, step, state)?;
            self.method
                .interpolate(theta, step, state, &mut self.inside);
            self.system.normalise(&mut self.inside);
        }
        Ok(())
    }

    /// The same by the ends of the step alone, where the interpolant needs stages of its own that nobody asked for yet; whether it is that.
    pub(crate) fn inside_by_ends(&mut self, theta: f64, step: f64) -> bool {
        let method = self.method.explicit();
        let Some(method) = method.filter(|method| theta < 1.0 && method.is_incomplete()) else {
            return false;
        };
        method.interpolate_ends(theta, step, &self.state, &mut self.inside);
        self.system.normalise(&mut self.inside);
        true
    }

    /// Notes a located event.
    pub(crate) fn note(&mut self, what: Happening) {
        self.events.push(Occurrence {
            time: self.time,
            what,
        });
    }

    pub(crate) fn event_count(&self) -> usize {
        self.events.len()
    }

    /// Takes back the last events: they are due again.
    pub(crate) fn forget_events(&mut self, count: usize) {
        self.events.truncate(count);
    }

    fn declared_since(&self, first: usize) -> Option<usize> {
        self.events
            .get(first..)?
            .iter()
            .find_map(|occurrence| match occurrence.what {
                Happening::Declared(event) => Some(event),
                Happening::Switch(..) => None,
            })
    }
}
