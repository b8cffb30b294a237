//! One run: a model, a method, a state and what the nodes remember, advanced step by step.
//!
//! One stage is: inputs → equilibrium points → state derivative. One step is: try, project on the joints, test the error, look for events, record, commit. Nothing is changed
//! before a step is accepted, so an error or a rejected trial leaves state and memory as they were, to the bit.

use std::cell::OnceCell;
use std::sync::Arc;

use mbd_scene::similar::near_and_all;
use mbd_scene::{Float, Model, ParamError, PlacementReport, Quantity, StartNumber};

use crate::balance::EnergyBalance;
use crate::chatter::Chatter;
use crate::dropped_here::DroppedHere;
use crate::error::{Progress, RunError, Statistics, StepError};
use crate::event::{Happening, Margins, Occurrence};
use crate::integrate::{Control, ErrorNorm, Stepper, StiffnessTest};
use crate::linearise::output_names;
use crate::momentum::MomentumBalance;
use crate::node::NodeMemory;
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
mod recording;
mod sizes;
mod snapshot;
mod space;
mod stability;
pub(crate) mod start;
mod stiffness;

pub use act::Acted;
use act::Changes;
pub use beyond_stops::PassedStop;
pub(crate) use drive::Course;
pub use handover::{Given, Handover};
pub use moved::Moved;
use offered::{emitted, told_by_state};
use overlooked::Overlooked;
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

/// A simulation of one model. `T` is the scalar of the state; time is always `f64`.
///
/// It owns its model and borrows nothing: it can be stored, returned, and moved to another thread.
///
/// ```
/// use mbd_runtime::{Options, PointState, Simulation, model};
///
/// model! {
///     /// A stone that falls.
///     model Stone {
///         gravity: [0.0, 0.0, -9.81] m/s^2;
///         emit: [derivative];
///         point stone { mass: 1.0 kg }
///     }
/// }
///
/// /// A stone at a height [m] that moves at 2 m/s along x.
/// fn thrown_from(height: f64) -> Result<Simulation<f64>, Box<dyn std::error::Error>> {
///     let stone = Stone::new(StoneParams::default())?;
///     let mut start = StoneState::at_origin();
///     start.set_stone(PointState { position: [0.0, 0.0, height], velocity: [2.0, 0.0, 0.0] });
///     let mut simulation = Simulation::new(&stone, Options::rk4(0.1))?;
///     simulation.set_state(0.0, &start.to_vec())?;
///     Ok(simulation)
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let mut simulation = thrown_from(10.0)?;
/// simulation.run(1.0)?;
///
/// // z = 10 m − ½ g t²; RK4 integrates a parabola exactly.
/// let end = StoneState::from_slice(simulation.state()).expect("the state of a stone").stone();
/// assert!((end.position[0] - 2.0).abs() < 1e-12);
/// assert!((end.position[2] - (10.0 - 0.5 * 9.81)).abs() < 1e-12);
/// assert_eq!(simulation.statistics().steps, 10);
/// # Ok(())
/// # }
/// ```
pub struct Simulation<T: Float> {
    pub(crate) system: DroppedHere<System<T>>,
    pub(crate) method: DroppedHere<Stepper<T>>,
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
    /// When what acts with time alone is hidden from fixed steps [s].
    hidden: Option<f64>,
    /// Whether the attempted step was one of those, and whether the last accepted one was, and nothing was changed since.
    pub(crate) beside: bool,
    stays: bool,
    /// Whether the attempted step was one of those, of which nothing but the end was taken over.
    lacks_stages: bool,
    /// Whether state, first stage and memory are kept elsewhere, after steps whose state was not read.
    is_elsewhere: bool,
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

impl<T: Float> Simulation<T> {
    /// What the start moved so that the joints hold, the largest distance first; empty where they held already. The state that is set says where
    /// bodies are wanted; where joints forbid it, [`Simulation::start`] takes the nearest state that they allow, weighted by mass.
    #[must_use]
    pub fn start_moved(&self) -> &[Moved] {
        &self.moved
    }

    /// Where joint coordinates start that the declaration or [`Simulation::set_joints`] says to be about a value, and declared ones that gave way to what
    /// that gives: name, what was said and what was taken [m or rad].
    #[must_use]
    pub fn started_about(&self) -> Vec<(String, f64, f64)> {
        self.assembly.told_about(self.system.model.scene())
    }

    /// Joint coordinates that neither what was said of others nor their loops decide: where they start was chosen, near zero or near where they were.
    /// Only loops of which something is said are looked at; a coordinate in none is zero.
    #[must_use]
    pub fn start_undecided(&self) -> Vec<String> {
        self.assembly.told_undecided(self.system.model.scene())
    }

    /// Whether the start is a singular position of the joints: one where rows repeat each other that do nowhere else, as of bars in one line. More
    /// than one motion is possible from there, and which one a run takes is decided by rounding.
    #[must_use]
    pub fn starts_singular(&self) -> bool {
        self.singular_start
    }

    /// A time at which what acts with time alone does so between the stages of fixed steps, and none of them sees it, in the calls so far [s]: a pulse shorter
    /// than a step, a swing as fast as the steps. Adaptive steps end there.
    #[must_use]
    pub fn hidden_from_steps(&self) -> Option<f64> {
        self.hidden
    }

    /// The model that is run.
    #[must_use]
    pub fn model(&self) -> &Arc<dyn Model<T>> {
        &self.system.model
    }

    /// Time of the last accepted step [s].
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }

    /// State x = [q | v | z | s] of the last accepted step, in the world: of a scene whose origin follows something with as many digits as numbers have
    /// there. [`Simulation::near_origin`] has the rest.
    #[must_use]
    pub fn state(&self) -> &[T] {
        let own = self.state.get(..self.system.nx).unwrap_or(&[]);
        match self.system.following {
            None => own,
            Some(_) => self
                .shown
                .state
                .get_or_init(|| narrow(self.system.in_world(self.time, own))),
        }
    }

    /// Of a scene whose origin follows something: where the origin is [m] and how fast it moves [m/s], world axes, and the state with positions
    /// and velocities measured from it.
    #[must_use]
    pub fn near_origin(&self) -> Option<([[f64; 3]; 2], &[T])> {
        let origin = self.system.origin()?;
        let own = self.state.get(..self.system.nx).unwrap_or(&[]);
        Some((origin.at(self.time), own))
    }

    /// Work of the loads, of the dampers and of prescribed motions on bodies and points since the start [J], when [`Options::work`] asks for it.
    #[must_use]
    pub fn work(&self) -> Option<[f64; 3]> {
        match self.state.get(self.system.nx..)? {
            [loads, dampers, drives] => Some([loads, dampers, drives].map(|work| work.to_f64())),
            _ => None,
        }
    }

    /// What the nodes and lines remember of the last accepted step; places from the origin, where that follows something.
    #[must_use]
    pub fn memory(&self) -> &NodeMemory<T> {
        &self.system.memory
    }

    /// Node unknowns of the last stage evaluated, as in `At::nodes`, in the world.
    #[must_use]
    pub fn nodes(&self) -> &[T] {
        let own = self.system.nodes.nodes();
        match self.system.following {
            None => own,
            Some(_) => self
                .shown
                .nodes
                .get_or_init(|| narrow(self.system.nodes_in_world(self.time, own))),
        }
    }

    /// Rates ẋ at the last accepted step, once started; of positions against the origin, where that follows something.
    #[must_use]
    pub fn rates(&self) -> &[T] {
        self.method.first().get(..self.system.nx).unwrap_or(&[])
    }

    /// Counters since creation.
    #[must_use]
    pub fn statistics(&self) -> Statistics {
        self.system.statistics()
    }

    /// How long the steps of this run are, where they are adaptive.
    #[must_use]
    pub fn step_sizes(&self) -> &StepSizes {
        &self.step_sizes
    }

    /// Keeps adaptive steps below those of another run at the same time, by as much as a tenth of its tolerance makes them shorter: with
    /// [`Options::finer`](crate::Options::finer) the run that tells the error of that one, where events, samples and entries of tables end the steps
    /// of both.
    pub fn refine(&mut self, other: &StepSizes) {
        self.below = Some(other.clone());
    }

    /// Located events of this run, in order. [`Simulation::set_state`] and [`Simulation::set_joints`] begin another run, with an empty list.
    #[must_use]
    pub fn events(&self) -> &[Occurrence] {
        &self.events
    }

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
        let model = Arc::clone(self.model());
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
