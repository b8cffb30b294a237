//! One run: a model, a method, a state and what the nodes remember, advanced step by step.
//!
//! One stage is: inputs → equilibrium points → state derivative. One step is: try, project on the joints, test the error, look for events, record, commit. Nothing is changed
//! before a step is accepted, so an error or a rejected trial leaves state and memory as they were, to the bit.

use std::sync::Arc;

use mbd_scene::{Float, Model, ParamError, Quantity};

use crate::columns::stop_name;
use crate::compiled::Scalar;
use crate::error::{Progress, RunError, Statistics, StepError};
use crate::event::{Happening, Margins, Occurrence};
use crate::integrate::{Control, ErrorNorm, Explicit, RK4, Scales, TSIT5};
use crate::locate::Chatter;
use crate::node::{Mode, NodeMemory};
use crate::options::{Method, Options};
use crate::system::{External, NoLoads, System};
use crate::watch::Watch;

mod drive;
mod moved;
mod snapshot;
mod start;

pub use moved::Moved;
pub use snapshot::Snapshot;
use start::{offered, stepwise};

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// At the requested time.
    Reached,
    /// On a declared event, by index, because [`Options::stop_at_events`] is set.
    Event(usize),
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
    pub(crate) system: System<T>,
    pub(crate) method: Explicit<T>,
    pub(crate) state: Vec<T>,
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
    /// When a switch happened without a step [s].
    pub(crate) stalled: f64,
    pace: Pace,
    watch: Watch,
    watch_weights: Vec<T>,
    /// Whether the stability watch runs.
    watched: bool,
    /// Fixed steps count from here, so that time does not accumulate rounding.
    origin: f64,
    count: u64,
    options: Options,
    guess: Option<Vec<T>>,
    moved: Vec<Moved>,
    started: bool,
    events: Vec<Occurrence>,
}

impl<T: Scalar> Simulation<T> {
    /// A simulation of a model without inputs, at rest at the origin until [`Simulation::set_state`]. It owns what it runs: a [shared](Model::share)
    /// model.
    ///
    /// # Errors
    /// An option that cannot be used, or a combination of method and model that is not offered.
    pub fn new(model: &(impl Model<T> + ?Sized), options: Options) -> Result<Self, RunError> {
        T::make_simulation(model.share(), options, Box::new(NoLoads))
    }

    /// A simulation of a model whose inputs and external loads come from `loads`.
    ///
    /// # Errors
    /// An option that cannot be used, or a combination of method and model that is not offered.
    pub fn with_loads(
        model: &(impl Model<T> + ?Sized),
        options: Options,
        loads: impl External<T> + Send + 'static,
    ) -> Result<Self, RunError> {
        T::make_simulation(model.share(), options, Box::new(loads))
    }

    /// Changes the parameters of a run (declaration order, SI). Nothing is built anew: time and state stay, and [`Simulation::start`] makes them
    /// consistent with the new values before the next step: bodies back on their joints, nodes in balance, lines slack or taut.
    ///
    /// # Errors
    /// The first parameter that cannot be run; the run keeps the old ones.
    pub fn set_params(&mut self, params: &[T]) -> Result<(), ParamError> {
        T::give_params(self, params)
    }

    /// The name of an event: that of the declaration, or the line and what it became.
    #[must_use]
    pub fn event_name(&self, what: Happening) -> String {
        T::name_event(self, what)
    }

    /// Evaluates a quantity at the last accepted step; `out` has the length `Layout::len`. Of matrices only non-zeros are written.
    ///
    /// # Errors
    /// A slice of another length; no equilibrium of a node.
    pub fn evaluate(&mut self, what: Quantity, out: &mut [T]) -> Result<(), RunError> {
        T::look(self, what, out)
    }
}

impl<T: Float> Simulation<T> {
    /// What the start moved so that the joints hold, the largest distance first; empty where they held already. The state that is set says where
    /// bodies are wanted; where joints forbid it, [`Simulation::start`] takes the nearest state that they allow, weighted by mass.
    #[must_use]
    pub fn start_moved(&self) -> &[Moved] {
        &self.moved
    }

    /// The model that is run.
    #[must_use]
    pub fn model(&self) -> &Arc<dyn Model<T>> {
        &self.system.model
    }

    /// What [`Simulation::with_loads`] does.
    pub(crate) fn make(
        model: Arc<dyn Model<T>>,
        options: Options,
        loads: Box<dyn External<T> + Send>,
    ) -> Result<Self, RunError> {
        let refuse = |cause| RunError {
            cause,
            progress: Box::default(),
        };
        options.check().map_err(refuse)?;
        offered(&*model, &options, loads.supplies()).map_err(refuse)?;
        let scales = options.scales.unwrap_or_else(|| Scales::of(&*model));
        let mut system = System::new(model.clone(), loads, options.work);
        system.frozen(options.locate);
        system.projection.stabilise = options.stabilise;
        system.projection.length = scales.length;
        let fixed = matches!(options.method, Method::Rk4 { .. });
        let length = system.length();
        let (method, pace, tolerance) = match options.method {
            Method::Rk4 { step } => (Explicit::new(&RK4, length), Pace::Fixed(step), 1e-10),
            Method::Tsit5 { rtol, max_step } => {
                let method = Explicit::new(&TSIT5, length);
                let control = Control::new(0.0, max_step, method.exponent);
                let norm = ErrorNorm::new(model.layout(), length, scales, rtol);
                (method, Pace::Adaptive(control, norm), rtol)
            }
        };
        let tolerance = options.guard_tolerance.unwrap_or(tolerance * scales.length);
        let margins = Margins::new(
            &*model,
            options.locate,
            tolerance.max(16.0 * T::EPSILON.to_f64() * scales.length),
        );
        let layout = model.layout();
        let room = [
            Quantity::Guards,
            Quantity::Lines,
            Quantity::Outputs,
            Quantity::Energy,
            Quantity::Constraint,
            Quantity::Reactions,
        ]
        .map(|what| layout.len(what));
        let mut state = vec![T::zero(); length];
        for qw in layout.quaternions() {
            if let Some(qw) = state.get_mut(qw) {
                *qw = T::one();
            }
        }
        Ok(Simulation {
            system,
            method,
            state,
            time: 0.0,
            chatter: Chatter::new(),
            scratch: vec![T::zero(); room.into_iter().max().unwrap_or(0)],
            guards: layout.len(Quantity::Guards),
            inside: vec![T::zero(); length],
            chosen: vec![false; margins.now.len()],
            switches: Vec::with_capacity(layout.unilateral()),
            crossed: Vec::with_capacity(layout.events),
            margins,
            noisy: fixed && options.guard_tolerance.is_none(),
            stalled: f64::NAN,
            pace,
            watch: Watch::default(),
            watch_weights: Vec::new(),
            watched: options.watch && fixed && stepwise(&*model).is_none(),
            origin: 0.0,
            count: 0,
            options,
            guess: None,
            moved: Vec::new(),
            started: false,
            events: Vec::with_capacity(256),
        })
    }

    /// Time of the last accepted step [s].
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }

    /// State x = [q | v | z] of the last accepted step.
    #[must_use]
    pub fn state(&self) -> &[T] {
        self.state.get(..self.system.nx).unwrap_or(&[])
    }

    /// Work of the loads, of the dampers and of prescribed motions on bodies and points since the start [J], when [`Options::work`] asks for it.
    #[must_use]
    pub fn work(&self) -> Option<[f64; 3]> {
        match self.state.get(self.system.nx..)? {
            [loads, dampers, drives] => Some([loads, dampers, drives].map(|work| work.to_f64())),
            _ => None,
        }
    }

    /// What the nodes and lines remember of the last accepted step.
    #[must_use]
    pub fn memory(&self) -> &NodeMemory<T> {
        &self.system.memory
    }

    /// Node unknowns of the last stage evaluated, as in `At::nodes`.
    #[must_use]
    pub fn nodes(&self) -> &[T] {
        self.system.nodes.nodes()
    }

    /// Rates ẋ at the last accepted step, once started.
    #[must_use]
    pub fn rates(&self) -> &[T] {
        self.method.first().get(..self.system.nx).unwrap_or(&[])
    }

    /// Counters since creation.
    #[must_use]
    pub fn statistics(&self) -> Statistics {
        self.system.statistics()
    }

    /// Located events, in order.
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
            Happening::Stop(stop, mode) => {
                let name = stop_name(scene, self.system.model.layout(), stop);
                format!("{name}: {}", crate::event::stop_word(mode))
            }
            Happening::Line(line, mode) => {
                format!("{}: {}", self.system.line(line), crate::event::word(mode))
            }
        }
    }

    /// What [`Simulation::evaluate`] does.
    pub(crate) fn look(&mut self, what: Quantity, out: &mut [T]) -> Result<(), RunError> {
        let expected = self.system.model.layout().len(what);
        if out.len() != expected {
            return Err(self.failed(StepError::InvalidInput {
                slot: format!("length of {what:?} (this model has {expected} numbers)"),
                value: out.len() as f64,
            }));
        }
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
    pub(crate) fn give_params(&mut self, params: &[T]) -> Result<(), ParamError> {
        let model = self.system.model.with_params(params)?;
        self.margins.read_lines(model.lines());
        self.system.take(model);
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
