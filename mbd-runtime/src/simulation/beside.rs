//! A step that is tried beside those of other runs: which one it is, and what the run takes over of it.
//!
//! Only the stages of a step are evaluated elsewhere, with the operations of this run in their order. Everything else is done by the run itself, as of a
//! step that it tried alone: error, events, watch, rows, memory. Where a stage cannot be had that way nothing is taken over, and the run tries
//! the step alone.

use mbd_scene::Float;

use super::stability::Meter;
use super::{Course, Simulation};
use crate::node::Stage;
use crate::trajectory::resolution;

/// What a run takes over of an attempt that was made elsewhere.
pub(crate) struct Attempt<'a, T> {
    /// Start and size of the step [s].
    pub step: [f64; 2],
    /// Writes the rates of all stages after the first, and the state at the end.
    pub stages: &'a dyn Fn([&mut [T]; 2]),
    /// Writes [`Quantity::Rates`](mbd_scene::Quantity::Rates) at the end.
    pub rates: &'a dyn Fn(&mut [T]),
    /// Writes the guards at the end, where they are known.
    pub guards: Option<&'a dyn Fn(&mut [T])>,
    /// Energy and powers at the end, where they are known.
    pub energy: Option<[T; 6]>,
    /// The largest | |q| − 1 | of a quaternion at the end.
    pub drift: f64,
}

impl<T: Float> Simulation<T> {
    /// Start and size of the step that is tried next [s], where its stages may be evaluated elsewhere: an explicit step of a run without rows of joints
    /// and functions of time and state, whose nodes, if there are any, are found along with the rates.
    pub(crate) fn upcoming(&mut self, course: &Course) -> Option<[f64; 2]> {
        let now = resolution(self.time);
        let begins = course.opened && self.started && !self.stale && self.changes.stop.is_none();
        let due = self.next_sample() <= self.time + now || course.until - self.time <= now;
        if !begins || due || self.method.explicit().is_none() || !self.system.is_plain() {
            return None;
        }
        let (step, _) = self.propose(course.until.min(self.next_sample()));
        let state = self.state.get(..self.system.nx).unwrap_or_default();
        (step >= now && self.system.hold_plain(self.time, state)).then_some([self.time, step])
    }

    /// Whether the guards at the end of a step are looked at, and its energy by the model.
    pub(crate) fn looks_at(&self) -> [bool; 2] {
        let energy = self.balance.is_some() && matches!(self.meter, Meter::Model { .. });
        [!self.margins.is_empty(), energy]
    }

    /// Takes over an attempt at the upcoming step.
    pub(crate) fn receive(&mut self, attempt: &Attempt<'_, T>) {
        let Some(method) = self.method.explicit_mut() else {
            return;
        };
        (attempt.stages)(method.attempted_mut());
        let (next, stages) = (method.next(), method.count() - 1);
        if self.system.receive(next, stages, attempt) {
            self.received = Some(attempt.step);
        }
    }

    /// Whether the step from here on of a size was received; it is used once.
    pub(super) fn take_received(&mut self, step: f64) -> bool {
        let is_this = self.received.take() == Some([self.time, step]);
        match is_this {
            true => self.attempted = step,
            false => self.system.known.forget(),
        }
        is_this
    }
}

impl<T: Float> crate::system::System<T> {
    /// Whether a stage is inputs that are held, a state, and nodes that are found along with the rates, and nothing else.
    fn is_plain(&self) -> bool {
        let supplied = !self.controls.is_empty() && !self.inputs.is_empty();
        !supplied && !self.projection.any() && self.length() == self.nx
    }

    /// Holds elements in the modes of the memory; whether nodes, if there are any, may be found along with the rates.
    fn hold_plain(&mut self, time: f64, state: &[T]) -> bool {
        let stage = Stage {
            model: &*self.model,
            time: T::from_f64(time),
            state,
            inputs: &self.inputs,
        };
        if self.nodes.has_networks() {
            return self.nodes.hold_for_rates(stage, &self.memory);
        }
        self.nodes.hold_modes(&self.memory);
        true
    }

    /// Leaves everything as the stages of a step that ends with a state would have left it; `false` where the nodes of that state follow other rules.
    fn receive(&mut self, state: &[T], stages: usize, attempt: &Attempt<'_, T>) -> bool {
        let [time, step] = attempt.step;
        let end = time + step;
        let (stage, span) = (
            Stage {
                model: &*self.model,
                time: T::from_f64(end),
                state,
                inputs: &self.inputs,
            },
            T::from_f64(step),
        );
        let (nodes, memory) = (&mut self.nodes, &self.memory);
        let placed = match nodes.has_networks() {
            true => nodes.receive_rates(stage, span, memory, attempt.rates),
            false => nodes
                .solve_stage(stage, span, memory, &mut self.work)
                .is_ok(),
        };
        if !placed {
            return false;
        }
        self.nodes.count_solves(stages - 1);
        self.counters.rhs = self.counters.rhs.saturating_add(stages as u64);
        self.drift = attempt.drift;
        self.known.learn(end, attempt.energy, attempt.guards);
        true
    }
}
