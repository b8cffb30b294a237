//! Advancing on a course: try a step, look for events inside it, record, take it.

use mbd_scene::{Float, Quantity};

use super::attempt::NextStep;
use super::offered::emitted;
use super::{ModelRun, Pace, Stop};
use crate::error::{RunError, StepError};
use crate::event::{Happening, Occurrence};
use crate::identity;
use crate::row::RowPlace;
use crate::trajectory::{Trajectory, resolution};

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

impl<T: Float> ModelRun<T> {
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
            let ends: Vec<f64> = self.system.jumps_inside(span).collect();
            let of_time = &self.system.of_time;
            self.hidden = of_time.hidden_from_steps(scene, span, *step, &ends);
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
        if !course.opened {
            let admitted = self.admit(course, trajectory);
            admitted.map_err(|cause| self.failed(cause))?;
        }
        let mut outcome = match self.refused.take() {
            Some(cause) => Err(cause),
            None if course.opened => self.try_next(course, trajectory, go_on),
            None => self.open(course, trajectory),
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
            if let Some(reached) = self.beyond_reach(cause) {
                *cause = reached;
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

    /// Refuses a history that cannot go on with a course: it stays as it is.
    fn admit(
        &self,
        course: &Course,
        trajectory: &mut Option<&mut Trajectory>,
    ) -> Result<(), StepError> {
        let Some(trajectory) = trajectory else {
            return Ok(());
        };
        let model = &self.system.model;
        let own = || identity::of_columns(model.scene(), model.layout());
        trajectory.check(*self.columns.get_or_init(own), [self.time, course.until])?;
        match trajectory.takes_outputs() {
            true => emitted(&**model, Quantity::Outputs),
            false => Ok(()),
        }
    }

    /// What is due at the start of a course: samples, a row.
    fn open(
        &mut self,
        course: &mut Course,
        trajectory: &mut Option<&mut Trajectory>,
    ) -> Result<Option<Stop>, StepError> {
        course.opened = true;
        if let Some(trajectory) = trajectory {
            trajectory.locates = self.options.locate;
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
            let stiff = self.stiff(course.trials);
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
        let NextStep {
            size: step,
            end,
            lands,
            on_jump,
        } = self.plan(until);
        // Nothing but a row inside the step can make it be taken back.
        let inside = trajectory
            .as_ref()
            .is_some_and(|it| it.is_due_inside([self.time, step]));
        let before = inside.then(|| self.judgement());
        if !self.attempt(step, on_jump)? {
            return Ok(());
        }
        let Some(found) = self.find_event(step)? else {
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
            if lands {
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
        if self.system.keep_up(end, length, &mut self.state) {
            self.stays = false;
            self.method.begin(&mut self.system, end, 0.0, &self.state)?;
        }
        // Lines that span space are far from straight.
        match self.system.nodes.has_networks() && !self.system.nodes.spanned {
            true => self.straighten(),
            false => Ok(()),
        }
    }

    /// Puts nodes where their lines are about to be drawn straight without force, which are slack there, and starts again from there.
    fn straighten(&mut self) -> Result<(), StepError> {
        let mut switches = std::mem::take(&mut self.switches);
        switches.clear();
        let changed = self.system.straighten(&mut self.state, &mut switches);
        let switched = self.switch(&switches);
        self.switches = switches;
        switched?;
        if changed {
            self.stays = false;
            self.begin_switched()?;
        }
        Ok(())
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
