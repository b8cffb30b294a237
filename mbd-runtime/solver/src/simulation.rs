//! One run: a model, a method, a state and what the nodes remember, advanced step by step.
//!
//! One stage is: inputs → equilibrium points → state derivative. One step is: try, project on the joints, test the error, look for events, record, commit. Nothing is changed
//! before a step is accepted, so an error or a rejected trial leaves state and memory as they were, to the bit.

use std::cell::OnceCell;
use std::sync::Arc;

use mbd_scene::similar::near_and_all;
use mbd_scene::{Float, ParamError, PlacementReport, Quantity, StartNumber};

use crate::balance::EnergyBalance;
use crate::chatter::Chatter;
use crate::error::{Progress, RunError, StepError};
use crate::event::{Happening, Margins, Occurrence};
use crate::integrate::{Control, ErrorNorm, Stepper, StiffnessTest};
use crate::linearise::output_names;
use crate::momentum::MomentumBalance;
use crate::options::Options;
use crate::rounding::{StepRounding, TimeRounding};
use crate::state_rounding::StateRounding;
use crate::step_sizes::StepSizes;
use crate::supply::Sampler;
use crate::system::System;
use crate::unilateral::{Mode, report};
use crate::watch::Watch;

mod act;
mod attempt;
mod behind;
pub(crate) mod beside;
mod beyond_stops;
mod control;
mod digits;
mod drive;
mod given;
mod handover;
mod impulse;
mod measure;
mod moved;
mod offered;
mod overlooked;
mod reach;
mod reading;
mod recording;
mod sizes;
mod snapshot;
mod space;
mod stability;
pub(crate) mod start;
mod steep_states;
mod stiffness;
mod unseen;

pub use act::Acted;
use act::Changes;
pub use beyond_stops::PassedStop;
pub(crate) use drive::Course;
pub use handover::{Given, Handover};
pub use moved::Moved;
use offered::{emitted, told_by_state};
use overlooked::Overlooked;
pub use reading::Simulation;
use sizes::RunSizes;
pub use snapshot::Snapshot;
use stability::Meter;

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// At the requested time.
    Reached,
    /// On a declared event, by index, because it says `then: stop`, or [`Options::stop_at_events`] is set.
    Event(usize),
}

/// The last accepted step in the world, once somebody has asked for it.
#[derive(Debug)]
struct WorldState<T> {
    state: OnceCell<Vec<T>>,
    nodes: OnceCell<Vec<T>>,
}

impl<T> WorldState<T> {
    fn new() -> Self {
        WorldState {
            state: OnceCell::new(),
            nodes: OnceCell::new(),
        }
    }

    /// The run goes on.
    fn forget(&mut self) {
        (self.state, self.nodes) = (OnceCell::new(), OnceCell::new());
    }
}

fn narrow<T: Float>(numbers: impl Iterator<Item = f64>) -> Vec<T> {
    numbers.map(T::from_f64).collect()
}

/// How the size of the next step is found.
#[derive(Clone, Debug)]
enum Pace {
    Fixed(f64),
    Adaptive(Control, ErrorNorm),
}

/// What a [`Simulation`] drives: model, method, state and all that is looked at on the way.
pub struct ModelRun<T: Float> {
    pub(crate) system: System<T>,
    pub(crate) method: Stepper<T>,
    pub(crate) state: Vec<T>,
    /// What the outside has been shown of them, where that is something else.
    shown: WorldState<T>,
    pub(crate) time: f64,
    pub(crate) margins: Margins,
    pub(crate) chatter: Chatter,
    /// Room for guards, line quantities, outputs.
    pub(crate) scratch: Vec<T>,
    /// Number of guards.
    pub(crate) guards: usize,
    /// Room for a state inside a step.
    pub(crate) inside: Vec<T>,
    /// Room for which margins are passed.
    pub(crate) chosen: Vec<bool>,
    /// Room for the lines that switch together.
    pub(crate) switches: Vec<(usize, Mode)>,
    /// Room for which declared events happened.
    pub(crate) crossed: Vec<usize>,
    /// Whether the guard tolerance follows the error of each step: fixed steps without a tolerance of their own.
    pub(crate) noisy: bool,
    /// The size of the last attempt; NaN where it failed [s].
    pub(crate) attempted: f64,
    /// Start and size of an attempt that was made beside those of other runs, until it is used [s].
    received: Option<[f64; 2]>,
    /// When what acts is hidden from fixed steps [s].
    hidden: Option<f64>,
    /// Whether the attempted step was one of those, and whether the last accepted one was, and nothing was changed since.
    pub(crate) beside: bool,
    stays: bool,
    /// Whether the attempted step was one of those, of which nothing but the end was taken over.
    lacks_stages: bool,
    /// Whether state, first stage and memory are kept elsewhere, after steps whose state was not read.
    is_elsewhere: bool,
    /// Why the run does not go on from the last of these.
    refused: Option<StepError>,
    /// Whether quantities are straight between the ends of steps, as the forces of a `stepwise` node.
    straight: bool,
    /// What the last attempt overlooks; how often it is looked into because its error says nothing.
    overlooked: Overlooked<T>,
    pub(crate) looks: u32,
    /// When a switch happened without a step [s].
    pub(crate) stalled: f64,
    pace: Pace,
    /// How long adaptive steps are along the run, and those of another one that its steps stay below.
    step_sizes: StepSizes,
    below: Option<StepSizes>,
    stiffness: StiffnessTest,
    watch: Watch,
    watch_weights: Vec<T>,
    /// Whether the stability watch runs.
    watched: bool,
    /// The balance of energy, where this run can tell it.
    balance: Option<EnergyBalance>,
    /// The balance of momentum, where it was asked for and the ground holds nothing.
    pub(crate) momentum: Option<MomentumBalance>,
    /// Whether fixed steps are judged by the balance of energy.
    judged: bool,
    /// How the energy is read.
    meter: Meter,
    /// What is small and what is stiff, for the params of now.
    sizes: RunSizes,
    /// The most that it made so far, as a part of what matters.
    rounded: f64,
    /// What rounding of time makes of what follows it, and whether anything does.
    time_rounding: TimeRounding,
    /// What rounding of positions makes of the errors of adaptive steps.
    step_rounding: StepRounding,
    /// What rounding of angles and declared states makes of what follows them.
    state_rounding: StateRounding,
    /// Room for the looks of both.
    digit_room: [Vec<T>; 7],
    reads_time: OnceCell<bool>,
    /// Where the bodies are, of relative coordinates, for it.
    bodies: Vec<T>,
    /// What tells the model from others, and its columns, once something asks for it.
    fingerprint: OnceCell<u64>,
    columns: OnceCell<u64>,
    /// The last good state, for fixed steps that turn out too long.
    good: Option<Box<Snapshot<T>>>,
    /// Steps that the run made elsewhere, before it was restored here; those that were made here and do not belong to it count back, modulo 2^64.
    steps_elsewhere: u64,
    /// Fixed steps count from here, so that time does not accumulate rounding.
    origin: f64,
    count: u64,
    pub(crate) options: Options,
    guess: Option<Vec<T>>,
    moved: Vec<Moved>,
    passed_stops: Vec<PassedStop>,
    /// The joint coordinates that were set since the run moved or was given a state.
    joints_set: Vec<(String, StartNumber)>,
    /// What placing bodies by joint coordinates decided.
    assembly: PlacementReport,
    singular_start: bool,
    /// Whether what is held has changed since the first stage of the next step was evaluated.
    stale: bool,
    /// What functions of time and state gave at the end of the last call; empty where that is not known.
    left: Vec<T>,
    samplers: Vec<Sampler<T>>,
    /// Room for what controllers give.
    given: Vec<T>,
    /// Whether something jumped since the last step that was measured.
    jumped: bool,
    /// Whether the state is still that of the declared start, but for the joint coordinates that were set.
    as_declared: bool,
    started: bool,
    /// Whether something is being done that asks closures of the caller; between calls: one of them panicked, and left the run in the middle of it.
    under_way: bool,
    events: Vec<Occurrence>,
    /// What events changed.
    changes: Changes<T>,
}

impl<T: Float> ModelRun<T> {
    pub(crate) fn name_event(&self, what: Happening) -> String {
        let scene = self.system.model.scene();
        match what {
            Happening::Declared(event) => scene
                .events
                .get(event)
                .map_or_else(String::new, |event| event.name.clone()),
            Happening::Switch(element, mode) => {
                report(scene, self.system.model.layout(), element, mode)
            }
        }
    }

    /// What [`Simulation::output`] does.
    pub(crate) fn look_at_output(&mut self, name: &str) -> Result<T, RunError> {
        let model = Arc::clone(&self.system.model);
        let names = output_names(model.scene(), model.layout());
        let names = names.iter().map(|column| column.name.as_str());
        let no_output = |why: String| StepError::NoOutput {
            name: name.to_owned(),
            why,
        };
        let Some(index) = names.clone().position(|known| known == name) else {
            let why = match names.len() {
                0 => "is no output: this model declares none".into(),
                _ => format!("is no output{}", near_and_all(name, names)),
            };
            return Err(self.failed(no_output(why)));
        };
        let mut columns = vec![T::zero(); model.layout().len(Quantity::Outputs)];
        self.look(Quantity::Outputs, &mut columns)?;
        let found = columns.get(index).copied().filter(|it| it.is_finite());
        let why = || "has no number here: something divides by zero, or takes the direction, the angle or the root of nothing";
        found.ok_or_else(|| self.failed(no_output(why().into())))
    }

    /// Does what may ask closures of the caller. Where one of them panics the run stays under way, and is refused from then on.
    pub(crate) fn whole<R>(
        &mut self,
        act: impl FnOnce(&mut Self) -> Result<R, RunError>,
    ) -> Result<R, RunError> {
        self.check_whole()?;
        self.under_way = true;
        let outcome = act(self);
        self.under_way = false;
        outcome
    }

    /// Refuses a run that a panic left in the middle of something.
    pub(crate) fn check_whole(&self) -> Result<(), RunError> {
        match self.under_way {
            true => Err(self.failed(StepError::Interrupted)),
            false => Ok(()),
        }
    }

    /// What [`Simulation::evaluate`] does.
    pub(crate) fn look(&mut self, what: Quantity, out: &mut [T]) -> Result<(), RunError> {
        self.whole(|run| run.look_now(what, out))
    }

    fn look_now(&mut self, what: Quantity, out: &mut [T]) -> Result<(), RunError> {
        let model = &self.system.model;
        let expected = model.layout().len(what);
        if out.len() != expected {
            let measured = what == Quantity::Outputs && !model.scene().runs.metrics.is_empty();
            let with = if measured {
                ", with those that metrics measure"
            } else {
                ""
            };
            let wrong = StepError::length(&format!("{what}{with}"), out.len(), expected);
            return Err(self.failed(wrong));
        }
        let offered = told_by_state(what).and_then(|()| emitted(&**model, what));
        offered.map_err(|cause| self.failed(cause))?;
        if !self.started {
            self.begin()?;
        }
        match self.system.look(self.time, 0.0, &self.state) {
            Ok(()) => {
                self.system.seen(what, self.time, &self.state, out);
                Ok(())
            }
            Err(cause) => Err(self.failed(cause)),
        }
    }

    /// What [`Simulation::set_params`] does.
    pub(crate) fn give_params(
        &mut self,
        of: Result<(), ParamError>,
        params: &[T],
    ) -> Result<(), RunError> {
        let before = self.system.model.clone();
        let taken = of.and_then(|()| self.take_params(params));
        taken.map_err(|error| self.failed(error.into()))?;
        let own = std::mem::replace(&mut self.changes.own, params.to_vec());
        let start = (self.state.clone(), self.system.memory.clone());
        let said = (self.joints_set.clone(), self.assembly.clone());
        if let Err(error) = self.start_again() {
            self.changes.own = own;
            (self.state, self.system.memory) = start;
            (self.joints_set, self.assembly) = said;
            self.take_model(before);
            self.system.take_up_turns();
            self.shown.forget();
            return Err(error);
        }
        self.started = false;
        Ok(())
    }

    fn failed(&self, cause: StepError) -> RunError {
        RunError {
            cause,
            progress: Box::new(Progress {
                time: self.time,
                step_size: match &self.pace {
                    Pace::Fixed(step) => *step,
                    Pace::Adaptive(control, _) => control.step,
                },
                statistics: self.system.statistics(),
            }),
        }
    }
}
