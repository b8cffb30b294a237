//! A step that is tried beside those of other runs: which one it is, and what the run takes over of it.
//!
//! Only the stages of a step are evaluated elsewhere, and its end put back on the joints; of a step of the stiff method its derivatives and their factor, too;
//! with the operations of this run in their order. Everything else is done by the run itself, as of a step that it tried alone: error, events, watch, which
//! rows are solved next, memory. Where a stage cannot be had that way nothing is taken over, and the run tries the step alone.
//!
//! A step at whose end nothing is read but metrics leaves the state elsewhere, too: the run counts it, and fetches the state when it is read again.

use mbd_scene::Float;

use super::stability::{Meter, OFTEN};
use super::{Course, ModelRun};
use crate::error::StepError;
use crate::integrate::{Explicit, StiffCount};
use crate::node::{NodeMemory, Stage};
use crate::system::EndLooks;
use crate::trajectory::{Trajectory, resolution};

/// An attempt at a step that was made elsewhere.
pub(crate) trait Attempt<T> {
    /// Start and size of the step [s].
    fn step(&self) -> [f64; 2];
    /// Writes the rates of all stages but the first, which the run has, or of the last alone; and the state at the end.
    fn stages(&self, all: bool, into: [&mut [T]; 2]);
    /// Writes the state at the end, and the rates there.
    fn end(&self, into: [&mut [T]; 2]);
    /// Writes what [`Rosenbrock::attempted`](crate::integrate::Rosenbrock::attempted) is of a step of the stiff method.
    fn solved(&self, into: [&mut [T]; 4]);
    /// Writes [`Quantity::Rates`](mbd_scene::Quantity::Rates) at the end.
    fn rates(&self, into: &mut [T]);
    /// Writes anchors and loads, nodes, effective line numbers, stretches, and how fast nodes move against their anchors at the end.
    fn nodes(&self, into: [&mut [T]; 5]);
    /// What the solves of all stages cost.
    fn spent(&self) -> Spent;
    /// Writes one of the [`LISTS`](crate::system::LISTS) at the end, by its place there; `false` where it is not known.
    fn list(&self, place: usize, into: &mut [T]) -> bool;
    /// One number of such a list; not a number where it is not known.
    fn number(&self, place: usize, index: usize) -> T;
    /// Energy and powers at the end, where they are known.
    fn energy(&self) -> Option<[T; 6]>;
    /// [`Explicit::squares`] by the weights of the watch.
    fn squares(&self) -> [T; 3];
    /// The largest | |q| − 1 | of a quaternion at the end, before it was normalised.
    fn drift(&self) -> f64;
    /// What the last factor of the rows of joints left to its smallest pivot.
    fn margin(&self) -> f64;
}

/// The start of the next step of a run, which is kept elsewhere.
pub(crate) trait KeptStart<T> {
    /// Writes state and rates there.
    fn state(&self, into: [&mut [T]; 2]);
    /// Writes what nodes and lines remember of the step that ended there.
    fn memory(&self, into: &mut NodeMemory<T>);
}

/// What solves of nodes cost.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Spent {
    /// Newton steps.
    pub iterations: u64,
    /// The most of one solve.
    pub most: usize,
    /// Solves that ended with every line slack.
    pub slack: u64,
}

impl<T: Float> ModelRun<T> {
    /// Start and size of the step that is tried next [s], where its stages may be evaluated elsewhere: a step of a run without functions of time and state, an
    /// explicit one whose rows of joints, if there are any, are solved as emitted, and whose nodes are found along with the rates or each by a solve of its own,
    /// or one of the stiff method whose derivatives are a partial derivative of the model alone.
    pub(crate) fn upcoming(&mut self, course: &Course) -> Option<[f64; 2]> {
        let now = resolution(self.time);
        let begins = course.opened && self.started && !self.stale && self.changes.stop.is_none();
        let is_due = self.next_sample() <= self.time + now;
        if !begins || is_due || course.until - self.time <= now {
            return None;
        }
        let holds = self.holds_on() || {
            let (method, system) = (&self.method, &self.system);
            let of_model = system.differentiates_plainly() && !system.projection.any();
            let is_stiff = method.only_implicit().is_some() && of_model;
            let is_plain = (is_stiff || method.explicit().is_some()) && system.is_plain();
            is_plain && self.system.hold_plain()
        };
        let next = self.plan(course.until);
        // The stages of a step that ends where something jumps see what is before it alone: its run makes it.
        let is_offered = next.size >= now && holds && self.system.solves_beside() && !next.on_jump;
        is_offered.then_some([self.time, next.size])
    }

    /// Whether inputs and the modes of elements are those of the last step, which was received.
    pub(crate) fn holds_on(&self) -> bool {
        self.stays && !self.system.counts_turns()
    }

    /// Whether somebody looks between the ends of the step from here on: at every step, or because a row is due.
    fn looks_inside(&self, step: [f64; 2], history: &Trajectory) -> bool {
        let measured = history.measures_steps() && !self.straight;
        let judged = self.is_adaptive() || self.momentum.is_some();
        judged || measured || !self.margins.is_empty() || history.is_due_inside(step)
    }

    /// What is looked at at the end of every step of a run with this history.
    pub(crate) fn looks_at(&self, history: &Trajectory) -> EndLooks {
        let measured = history.looks_at();
        EndLooks {
            energy: self.balance.is_some() && matches!(self.meter, Meter::Model { .. }),
            lists: [
                !self.margins.is_empty(),
                measured.outputs,
                measured.lines,
                self.system.counts_turns(),
            ],
        }
    }

    /// The weights of the watch, where it looks at stages.
    pub(crate) fn weights_of_stages(&self) -> Option<&[T]> {
        self.watched.then_some(&self.watch_weights)
    }

    /// How many steps from the upcoming one on, received from elsewhere, end where nobody reads but what is measured of the lists that are known there:
    /// then the run need not have its state. Rows, events and whatever a step lands on read it, and so does what is done every tenth step where it is more than a
    /// look at state and rates.
    pub(crate) fn unread_steps(
        &self,
        course: &Course,
        [time, step]: [f64; 2],
        history: &Trajectory,
    ) -> u64 {
        let counted = self.unwatched_steps(course.until);
        if counted == 0 {
            return 0;
        }
        let next = self.plan(course.until);
        let is_this = !next.lands && !next.on_jump && [self.time, next.size] == [time, step];
        let inside = self.looks_inside([time, step], history);
        let system = &self.system;
        let held = !system.counts_turns() && system.needs_no_ends();
        let nodes = !system.nodes.has_networks() || system.nodes.are_single();
        let anew = history.measures_steps() && self.jumped;
        let recorded = history.reads_end_of([time, step]) || anew;
        if !is_this || inside || !held || !nodes || recorded {
            return 0;
        }
        let tried = self.options.max_steps.saturating_sub(course.trials);
        // The step before the last that ends before the next instant that counts does so by more than rounding.
        let row = history.due().unwrap_or(f64::INFINITY);
        let jump = system.next_break(time).unwrap_or(f64::INFINITY);
        let until = course.until.min(self.next_sample()).min(jump);
        let ahead = (until.min(row) - time) / step - 2.0;
        counted.min(tried).min((ahead as u64).max(1))
    }

    /// Takes the upcoming step, [whose state is not read](Self::unread_steps), counts and measures it; `false`, and nothing happened, where the watch
    /// looks closer, or what the last step was looked back at with is to be told.
    pub(crate) fn pass(
        &mut self,
        attempt: &dyn Attempt<T>,
        course: &mut Course,
        history: &mut Trajectory,
    ) -> bool {
        if self.refused.is_some() {
            return false;
        }
        let [time, step] = attempt.step();
        match self.watch_received(attempt) {
            Some(after) if self.system.pass_rows(time + step, attempt.margin()) => {
                (self.watch, self.balance) = after;
            }
            _ => return false,
        }
        let stages = self.method.explicit().map_or(1, Explicit::count) - 1;
        self.system.count_received(stages, attempt.spent());
        let end = self.end_of(step);
        let measured = self.measured_step([step, end]);
        history.measure_received(measured, &*self.system.model, attempt);
        course.trials += 1;
        self.count += 1;
        self.time = end;
        let counters = &mut self.system.counters;
        counters.steps = counters.steps.saturating_add(1);
        self.shown.forget();
        (self.stays, self.is_elsewhere) = (true, true);
        if self.steps_of_run().is_multiple_of(OFTEN) {
            // Nobody reads them before they are fetched.
            attempt.end([&mut self.state, self.method.first_mut()]);
            self.attempted = step;
            self.refused = self.look_back().err();
        }
        true
    }

    /// Takes the state back that was kept elsewhere.
    pub(crate) fn fetch(&mut self, kept: &dyn KeptStart<T>) {
        if std::mem::take(&mut self.is_elsewhere) {
            kept.state([&mut self.state, self.method.first_mut()]);
            kept.memory(&mut self.system.memory);
        }
    }

    /// Whether the last step was received, and state, first stage and what nodes remember are those of its end and nothing else.
    pub(crate) fn goes_on_beside(&self) -> bool {
        self.stays
    }

    /// Takes over an attempt at the upcoming step.
    pub(crate) fn receive(&mut self, attempt: &dyn Attempt<T>, history: &Trajectory) {
        if self.refused.is_some() {
            return;
        }
        if self.method.is_stiff() {
            return self.receive_stiff(attempt);
        }
        let all = self.watched || self.looks_inside(attempt.step(), history);
        let Some(method) = self.method.explicit_mut() else {
            return;
        };
        attempt.stages(all, method.attempted_mut());
        self.lacks_stages = !all;
        let (next, stages) = (method.next(), method.count() - 1);
        if self.system.receive(next, stages, attempt) {
            self.received = Some(attempt.step());
        }
    }

    /// The same of a step of the stiff method.
    fn receive_stiff(&mut self, attempt: &dyn Attempt<T>) {
        let [_, step] = attempt.step();
        let Some(method) = self.method.only_implicit_mut() else {
            return;
        };
        let count = method.receive(step, |into| attempt.solved(into));
        self.lacks_stages = false;
        // Where the run makes the step alone all the same, it does not count them again.
        self.system.count_stiff(count);
        if self.system.receive(method.next(), count.rates, attempt) {
            self.received = Some(attempt.step());
        }
    }

    /// Makes the attempted step of a size alone, of which the end was taken over and its stages are asked for after all: the same numbers, and counted
    /// already.
    #[cold]
    pub(super) fn make_stages(&mut self, step: f64) -> Result<(), StepError> {
        let counted = (self.system.counters, self.system.nodes.statistics);
        let made = self.make_own_step(step);
        (self.system.counters, self.system.nodes.statistics) = counted;
        made
    }

    /// Whether the step from here on of a size was received; it is used once.
    #[inline]
    pub(super) fn take_received(&mut self, step: f64) -> bool {
        let is_this = self.received.is_some() && self.received.take() == Some([self.time, step]);
        self.beside = is_this;
        match is_this {
            true => self.attempted = step,
            false => self.system.known.forget(),
        }
        is_this
    }
}

impl<T: Float> crate::system::System<T> {
    /// Whether a stage is inputs that are held, a state in the world, and nodes, and nothing else.
    fn is_plain(&self) -> bool {
        let stays = self.following.is_none() && !self.has_functions();
        stays && self.length() == self.nx
    }

    /// Counts derivatives and factor of a step of the stiff method that was made elsewhere.
    fn count_stiff(&mut self, count: StiffCount) {
        let counters = &mut self.counters;
        let add = |counter: &mut u64, one: bool| *counter = counter.saturating_add(u64::from(one));
        add(&mut counters.jacobians, count.jacobian);
        add(&mut counters.factors, count.factor);
    }

    /// Holds elements in the modes of the memory; whether nodes, if there are any, may be found elsewhere.
    fn hold_plain(&mut self) -> bool {
        let (nodes, memory) = (&mut self.nodes, &self.memory);
        match (nodes.has_networks(), nodes.are_single()) {
            (false, _) => {
                nodes.hold_modes(memory);
                true
            }
            (_, true) => nodes.hold_for_warm(memory),
            _ => nodes.hold_for_rates(memory),
        }
    }

    /// Counts the stages of a step that was made elsewhere.
    fn count_received(&mut self, stages: usize, spent: Spent) {
        self.counters.rhs = self.counters.rhs.saturating_add(stages as u64);
        let nodes = &mut self.nodes;
        match nodes.are_single() {
            true => {
                nodes.count_solves(stages);
                let statistics = &mut nodes.statistics;
                statistics.add(spent.iterations, spent.most, spent.slack);
            }
            // The last was counted where it was received.
            false => nodes.count_solves(stages - 1),
        }
    }

    /// Leaves everything as the stages of a step that ends with a state would have left it; `false` where the nodes of that state follow other rules.
    fn receive(&mut self, state: &[T], stages: usize, attempt: &dyn Attempt<T>) -> bool {
        let [time, step] = attempt.step();
        let (end, span) = (time + step, T::from_f64(step));
        let stage = Stage {
            model: &*self.model,
            time: T::from_f64(end),
            state,
            inputs: &self.inputs,
        };
        let (nodes, memory) = (&mut self.nodes, &self.memory);
        match (nodes.has_networks(), nodes.are_single()) {
            (false, _) => {
                if nodes
                    .solve_stage(stage, span, memory, &mut self.work)
                    .is_err()
                {
                    return false;
                }
            }
            (_, true) => nodes.receive_warm(span, |into| attempt.nodes(into)),
            _ => {
                if !nodes.receive_rates(stage, span, |into| attempt.rates(into)) {
                    return false;
                }
            }
        }
        if !self.receive_rows(end, state, attempt.margin()) {
            return false;
        }
        self.count_received(stages, attempt.spent());
        self.drift = attempt.drift();
        self.known.learn(end, attempt.energy(), |place, into| {
            attempt.list(place, into)
        });
        true
    }
}
