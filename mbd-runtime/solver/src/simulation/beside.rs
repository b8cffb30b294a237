//! A step that is tried beside those of other runs: which one it is, and what the run takes over of it.
//!
//! Only the stages of a step are evaluated elsewhere, with the operations of this run in their order. Everything else is done by the run itself, as of a
//! step that it tried alone: error, events, watch, rows, memory. Where a stage cannot be had that way nothing is taken over, and the run tries
//! the step alone.

use mbd_scene::Float;

use super::stability::Meter;
use super::{Course, Simulation};
use crate::node::Stage;
use crate::system::EndLooks;
use crate::trajectory::{Trajectory, resolution};

/// An attempt at a step that was made elsewhere.
pub(crate) trait Attempt<T> {
    /// Start and size of the step [s].
    fn step(&self) -> [f64; 2];
    /// Writes the rates of all stages but the first, which the run has, and the state at the end.
    fn stages(&self, into: [&mut [T]; 2]);
    /// Writes [`Quantity::Rates`](mbd_scene::Quantity::Rates) at the end.
    fn rates(&self, into: &mut [T]);
    /// Writes anchors and loads, nodes, effective line numbers, stretches, and how fast nodes move against their anchors at the end; what the solves of all
    /// stages cost.
    fn nodes(&self, into: [&mut [T]; 5]) -> Spent;
    /// Writes one of the [`LISTS`](crate::system::LISTS) at the end, by its place there; `false` where it is not known.
    fn list(&self, place: usize, into: &mut [T]) -> bool;
    /// Energy and powers at the end, where they are known.
    fn energy(&self) -> Option<[T; 6]>;
    /// The largest | |q| − 1 | of a quaternion at the end, before it was normalised.
    fn drift(&self) -> f64;
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

impl<T: Float> Simulation<T> {
    /// Start and size of the step that is tried next [s], where its stages may be evaluated elsewhere: an explicit step of a run without rows of joints
    /// and functions of time and state, whose nodes, if there are any, are found along with the rates or each by a solve of its own.
    pub(crate) fn upcoming(&mut self, course: &Course) -> Option<[f64; 2]> {
        let now = resolution(self.time);
        let begins = course.opened && self.started && !self.stale && self.changes.stop.is_none();
        let due = self.next_sample() <= self.time + now || course.until - self.time <= now;
        if !begins || due || self.method.explicit().is_none() || !self.system.is_plain() {
            return None;
        }
        let (step, _) = self.propose(course.until.min(self.next_sample()));
        (step >= now && self.system.hold_plain()).then_some([self.time, step])
    }

    /// What is looked at at the end of every step of a run with this history.
    pub(crate) fn looks_at(&self, history: &Trajectory) -> EndLooks {
        let measured = history.looks_at();
        EndLooks {
            energy: self.balance.is_some() && matches!(self.meter, Meter::Model { .. }),
            lists: [!self.margins.is_empty(), measured.outputs, measured.lines],
        }
    }

    /// Whether the last step was received, and state, first stage and what nodes remember are those of its end and nothing else.
    pub(crate) fn goes_on_beside(&self) -> bool {
        self.stays
    }

    /// Takes over an attempt at the upcoming step.
    pub(crate) fn receive(&mut self, attempt: &dyn Attempt<T>) {
        let Some(method) = self.method.explicit_mut() else {
            return;
        };
        attempt.stages(method.attempted_mut());
        let (next, stages) = (method.next(), method.count() - 1);
        if self.system.receive(next, stages, attempt) {
            self.received = Some(attempt.step());
        }
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
        stays && !self.projection.any() && self.length() == self.nx
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
            (_, true) => {
                let mut spent = Spent::default();
                nodes.receive_warm(span, |into| spent = attempt.nodes(into));
                nodes.count_solves(stages);
                let statistics = &mut nodes.statistics;
                statistics.add(spent.iterations, spent.most, spent.slack);
            }
            _ => {
                if !nodes.receive_rates(stage, span, memory, |into| attempt.rates(into)) {
                    return false;
                }
                nodes.count_solves(stages - 1);
            }
        }
        self.counters.rhs = self.counters.rhs.saturating_add(stages as u64);
        self.drift = attempt.drift();
        self.known.learn(end, attempt.energy(), |place, into| {
            attempt.list(place, into)
        });
        true
    }
}
