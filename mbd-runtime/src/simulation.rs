//! One run: a model, a method, a state and what the nodes remember, advanced step by step.
//!
//! One stage is: inputs → equilibrium points → state derivative. One step is: try, test the error, look for events, record, commit. Nothing is changed
//! before a step is accepted, so an error or a rejected trial leaves state and memory as they were, to the bit.

use mbd_scene::{Float, Model, NodeModel, Quantity};
use serde::{Deserialize, Serialize};

use crate::columns::{node_name, state_names};
use crate::error::{Collapse, Progress, RunError, Statistics, StepError};
use crate::event::{Happening, Margins, Occurrence};
use crate::integrate::{Control, ErrorNorm, Explicit, RK4, Rates, Scales, TSIT5, Verdict};
use crate::locate::Chatter;
use crate::node::{Mode, NodeMemory};
use crate::options::{Method, Options};
use crate::system::{External, NoLoads, System};
use crate::trajectory::{Trajectory, resolution};
use crate::watch::{Watch, suggestion};

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// At the asked time.
    Reached,
    /// On a declared event, by index, because [`Options::stop_at_events`] is set.
    Event(usize),
}

/// Everything a run needs to go on exactly as it would have: same model, same options, same bits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Snapshot<T> {
    time: f64,
    origin: f64,
    count: u64,
    state: Vec<T>,
    memory: NodeMemory<T>,
    control: Option<Control>,
    watch: Watch,
    flags: Vec<bool>,
    drift: f64,
}

/// How the size of the next step is found.
#[derive(Clone, Debug)]
enum Pace {
    Fixed(f64),
    Adaptive(Control, ErrorNorm),
}

/// A simulation of one model. `T` is the scalar of the state; time is always `f64`.
pub struct Simulation<'m, T: Float, M: Model<T>, E = NoLoads> {
    pub(crate) system: System<'m, T, M, E>,
    pub(crate) method: Explicit<T>,
    pub(crate) state: Vec<T>,
    pub(crate) time: f64,
    pub(crate) margins: Margins,
    pub(crate) chatter: Chatter,
    /// Room for guards, line quantities, outputs.
    pub(crate) scratch: Vec<T>,
    /// Room for a state inside a step.
    pub(crate) inside: Vec<T>,
    /// Room for which margins are passed.
    pub(crate) chosen: Vec<bool>,
    /// Room for the lines that switch together.
    pub(crate) switches: Vec<(usize, Mode)>,
    /// Room for which declared events happened.
    pub(crate) crossed: Vec<usize>,
    pace: Pace,
    watch: Watch,
    /// Fixed steps count from here, so that time does not accumulate rounding.
    origin: f64,
    count: u64,
    options: Options,
    guess: Option<Vec<T>>,
    started: bool,
    events: Vec<Occurrence>,
}

impl<'m, T: Float, M: Model<T>> Simulation<'m, T, M, NoLoads> {
    /// A simulation of a model without inputs, at rest at the origin until [`Simulation::set_state`].
    ///
    /// # Errors
    /// An option that cannot be used, or a combination of method and model that is not offered.
    pub fn new(model: &'m M, options: Options) -> Result<Self, RunError> {
        Simulation::with_loads(model, options, NoLoads)
    }
}

impl<'m, T: Float, M: Model<T>, E: External<T>> Simulation<'m, T, M, E> {
    /// A simulation of a model whose inputs and external loads come from `loads`.
    ///
    /// # Errors
    /// An option that cannot be used, or a combination of method and model that is not offered.
    pub fn with_loads(model: &'m M, options: Options, loads: E) -> Result<Self, RunError> {
        let refuse = |cause| RunError {
            cause,
            progress: Box::default(),
        };
        options.check().map_err(refuse)?;
        offered(model, &options, loads.supplies()).map_err(refuse)?;
        let scales = options.scales.unwrap_or_else(|| Scales::of(model));
        let mut system = System::new(model, loads, options.work);
        system.frozen(options.locate);
        let length = system.length();
        let (method, pace, tolerance) = match options.method {
            Method::Rk4 { step } => (Explicit::new(&RK4, length), Pace::Fixed(step), 1e-10),
            Method::Tsit5 { rtol, max_step } => {
                let method = Explicit::new(&TSIT5, length);
                let control = Control::new(0.0, max_step, method.exponent);
                let norm = ErrorNorm::new(model.layout(), scales, rtol);
                (method, Pace::Adaptive(control, norm), rtol)
            }
        };
        let tolerance = options.guard_tolerance.unwrap_or(tolerance * scales.length);
        let margins = Margins::new(
            model,
            options.locate,
            tolerance.max(16.0 * T::EPSILON.to_f64() * scales.length),
        );
        let layout = model.layout();
        let room = [
            Quantity::Guards,
            Quantity::Lines,
            Quantity::Outputs,
            Quantity::Energy,
        ]
        .map(|what| layout.len(what));
        let mut state = vec![T::zero(); length];
        for slots in &layout.bodies {
            if let Some(qw) = state.get_mut(slots.q + 3) {
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
            inside: vec![T::zero(); length],
            chosen: vec![false; margins.now.len()],
            switches: Vec::with_capacity(layout.lines.len()),
            crossed: Vec::with_capacity(layout.events),
            margins,
            pace,
            watch: Watch::default(),
            origin: 0.0,
            count: 0,
            options,
            guess: None,
            started: false,
            events: Vec::with_capacity(256),
        })
    }

    /// Sets time [s] and state x = [q | v | z]; `rate` nodes are placed by [`Simulation::start`] where z is all zero. Quaternions are normalised.
    ///
    /// # Errors
    /// A number that is not finite, a quaternion off unit length by more than 1e-3, or a wrong length.
    pub fn set_state(&mut self, time: f64, state: &[T]) -> Result<(), RunError> {
        let invalid = |slot: String, value: f64| StepError::InvalidInput { slot, value };
        let names = || state_names(self.system.model.scene(), self.system.model.layout());
        let cause = if state.len() != self.system.nx {
            Some(invalid(
                format!("length of the state (this model has {})", self.system.nx),
                state.len() as f64,
            ))
        } else if !time.is_finite() {
            Some(invalid("time".into(), time))
        } else if let Some(at) = state
            .iter()
            .position(|x| !x.is_finite() || x.to_f64().abs() > 1e150)
        {
            let name = names()
                .into_iter()
                .nth(at)
                .map_or_else(String::new, |name| name.name);
            Some(invalid(
                name,
                state.get(at).map_or(f64::NAN, |x| x.to_f64()),
            ))
        } else {
            None
        };
        if let Some(cause) = cause {
            return Err(self.failed(cause));
        }
        let mut fresh = state.to_vec();
        self.system.settle(&mut fresh);
        if self.system.drift > 1e-3 {
            let cause = invalid(
                "deviation of a quaternion from unit length".into(),
                self.system.drift,
            );
            return Err(self.failed(cause));
        }
        for (to, from) in self
            .state
            .iter_mut()
            .zip(fresh.into_iter().chain([T::zero(); 2]))
        {
            *to = from;
        }
        self.time = time;
        self.started = false;
        Ok(())
    }

    /// Gives positions of the nodes (3 each) to start their search from.
    ///
    /// # Errors
    /// A number that is not finite, or a wrong length.
    pub fn set_nodes(&mut self, guess: &[T]) -> Result<(), RunError> {
        let expected = 3 * self.system.model.layout().nodes.len();
        let bad = guess.iter().find(|x| !x.is_finite());
        if guess.len() != expected || bad.is_some() {
            let value = bad.map_or(guess.len() as f64, |x| x.to_f64());
            let slot = format!("positions of the nodes ({expected} numbers)");
            return Err(self.failed(StepError::InvalidInput { slot, value }));
        }
        self.guess = Some(guess.to_vec());
        self.started = false;
        Ok(())
    }

    /// Makes the start consistent: places the nodes, decides the mode of every line, evaluates the first rates. [`Simulation::run`] does it when
    /// it was not done.
    ///
    /// # Errors
    /// No equilibrium of a node, or rates that are not finite.
    pub fn start(&mut self) -> Result<(), RunError> {
        self.started = true;
        self.origin = self.time;
        self.count = 0;
        self.watch = Watch::default();
        self.chatter = Chatter::new();
        let started = self.consistent_start();
        started.map_err(|cause| {
            self.started = false;
            self.failed(cause)
        })
    }

    fn consistent_start(&mut self) -> Result<(), StepError> {
        self.system
            .start(self.time, &mut self.state, self.guess.as_deref())?;
        self.method
            .begin(&mut self.system, self.time, &self.state)?;
        if let Pace::Adaptive(control, norm) = &mut self.pace {
            // The first step moves no block by more than a hundredth of its scale.
            let speed =
                norm.measure(self.method.first(), &self.state, &self.state) * norm.tolerance;
            let step = if speed > 0.0 { 0.01 / speed } else { 1e-3 };
            *control = Control::new(
                step.min(control.largest),
                control.largest,
                self.method.exponent,
            );
        }
        self.begin_edges()?;
        self.begin_margins(&mut |_| ())
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

    /// Work of the loads and of the dampers on bodies and points since the start [J], when [`Options::work`] asks for it.
    #[must_use]
    pub fn work(&self) -> Option<[f64; 2]> {
        match self.state.get(self.system.nx..)? {
            [loads, dampers] => Some([loads.to_f64(), dampers.to_f64()]),
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

    /// The name of an event: that of the declaration, or the line and what it became.
    #[must_use]
    pub fn event_name(&self, what: Happening) -> String {
        let scene = self.system.model.scene();
        match what {
            Happening::Declared(event) => scene
                .events
                .get(event)
                .map_or_else(String::new, |event| event.name.clone()),
            Happening::Line(line, mode) => {
                format!("{}: {}", self.system.line(line), crate::event::word(mode))
            }
        }
    }

    /// Evaluates a quantity at the last accepted step; `out` has the length `Layout::len`. Of matrices only non-zeros are written.
    ///
    /// # Errors
    /// No equilibrium of a node.
    pub fn evaluate(&mut self, what: Quantity, out: &mut [T]) -> Result<(), RunError> {
        if !self.started {
            self.start()?;
        }
        match self.system.look(self.time, 0.0, &self.state) {
            Ok(()) => {
                self.system.seen(what, self.time, &self.state, out);
                Ok(())
            }
            Err(cause) => Err(self.failed(cause)),
        }
    }

    /// Everything needed to go on from here later, in this process or another.
    #[must_use]
    pub fn snapshot(&self) -> Snapshot<T> {
        Snapshot {
            time: self.time,
            origin: self.origin,
            count: self.count,
            state: self.state.clone(),
            memory: self.system.memory.clone(),
            control: match &self.pace {
                Pace::Fixed(_) => None,
                Pace::Adaptive(control, _) => Some(control.clone()),
            },
            watch: self.watch,
            flags: self.margins.flags().collect(),
            drift: self.system.drift,
        }
    }

    /// Continues from a snapshot of the same model with the same options: every later step is equal to the bit.
    ///
    /// # Errors
    /// A snapshot of another model or method; and what the first evaluation may return.
    pub fn restore(&mut self, snapshot: &Snapshot<T>) -> Result<(), RunError> {
        let fits = snapshot.state.len() == self.state.len()
            && snapshot.flags.len() == self.margins.flags().count()
            && snapshot.control.is_some() == matches!(self.pace, Pace::Adaptive(..));
        if !fits {
            return Err(self.failed(StepError::Unsupported {
                what: "a snapshot of another model or method".into(),
                instead: "restore it into a simulation made with the same model and options".into(),
            }));
        }
        self.time = snapshot.time;
        self.origin = snapshot.origin;
        self.count = snapshot.count;
        self.state.copy_from_slice(&snapshot.state);
        self.system.memory = snapshot.memory.clone();
        self.system.drift = snapshot.drift;
        self.watch = snapshot.watch;
        self.margins.set_flags(&snapshot.flags);
        if let (Pace::Adaptive(control, _), Some(saved)) = (&mut self.pace, &snapshot.control) {
            *control = saved.clone();
        }
        self.started = true;
        let begun = self.method.begin(&mut self.system, self.time, &self.state);
        let begun = begun.and_then(|()| self.begin_margins(&mut |_| ()));
        begun.map_err(|cause| self.failed(cause))
    }

    /// Runs until a time [s].
    ///
    /// # Errors
    /// What [`StepError`] lists; the state is the last accepted step.
    pub fn run(&mut self, until: f64) -> Result<Stop, RunError> {
        self.drive(until, None, &mut |_| true)
    }

    /// Runs until a time [s] and records rows; after an error the rows so far are kept.
    ///
    /// # Errors
    /// As [`Simulation::run`].
    pub fn record(&mut self, until: f64, trajectory: &mut Trajectory) -> Result<Stop, RunError> {
        self.drive(until, Some(trajectory), &mut |_| true)
    }

    /// Runs until a time [s] or until `go_on`, asked with the time of every accepted step, says no.
    ///
    /// # Errors
    /// As [`Simulation::run`], and [`StepError::Cancelled`].
    pub fn run_while(
        &mut self,
        until: f64,
        trajectory: Option<&mut Trajectory>,
        go_on: &mut dyn FnMut(f64) -> bool,
    ) -> Result<Stop, RunError> {
        self.drive(until, trajectory, go_on)
    }

    /// One accepted step.
    ///
    /// # Errors
    /// As [`Simulation::run`].
    pub fn step(&mut self) -> Result<(), RunError> {
        if !self.started {
            self.start()?;
        }
        let steps = self.system.counters.steps;
        while self.system.counters.steps == steps {
            let taken = self.advance(f64::INFINITY, &mut None);
            taken.map_err(|cause| self.failed(cause))?;
        }
        Ok(())
    }

    fn drive(
        &mut self,
        until: f64,
        mut trajectory: Option<&mut Trajectory>,
        go_on: &mut dyn FnMut(f64) -> bool,
    ) -> Result<Stop, RunError> {
        if !until.is_finite() {
            return Err(self.failed(StepError::InvalidInput {
                slot: "end time".into(),
                value: until,
            }));
        }
        if !self.started {
            self.start()?;
        }
        self.chatter.window = 1e-3 * (until - self.time);
        let outcome = self.drive_steps(until, &mut trajectory, go_on);
        if let Some(trajectory) = trajectory {
            trajectory.statistics = self.system.statistics();
        }
        outcome.map_err(|cause| self.failed(cause))
    }

    fn drive_steps(
        &mut self,
        until: f64,
        trajectory: &mut Option<&mut Trajectory>,
        go_on: &mut dyn FnMut(f64) -> bool,
    ) -> Result<Stop, StepError> {
        if let Some(trajectory) = trajectory
            && trajectory.open(self.time)?
        {
            trajectory.push(
                &mut self.system,
                self.time,
                0.0,
                &self.state,
                &mut self.scratch,
            )?;
        }
        let mut trials: u64 = 0;
        while until - self.time > resolution(self.time) {
            if trials >= self.options.max_steps {
                return Err(StepError::TooManySteps { steps: trials });
            }
            trials += 1;
            let seen = self.events.len();
            self.advance(until, trajectory)?;
            if self.options.stop_at_events
                && let Some(event) = self.declared_since(seen)
            {
                return Ok(Stop::Event(event));
            }
            if !go_on(self.time) {
                return Err(StepError::Cancelled);
            }
        }
        Ok(Stop::Reached)
    }

    /// Tries one step, and takes it if it passes.
    fn advance(
        &mut self,
        until: f64,
        trajectory: &mut Option<&mut Trajectory>,
    ) -> Result<(), StepError> {
        let (step, lands) = self.propose(until);
        if !self.attempt(step)? {
            return Ok(());
        }
        let Some(found) = self.find_event(step)? else {
            self.watch_step(step)?;
            self.record_inside(step, trajectory)?;
            self.count += 1;
            let end = match self.pace {
                _ if lands => until,
                Pace::Fixed(size) => self.origin + self.count as f64 * size,
                Pace::Adaptive(..) => self.time + step,
            };
            self.take(step, end)?;
            self.record_step(trajectory)?;
            if lands && until.is_finite() {
                self.regrid();
            }
            return Ok(());
        };
        if found.step > 0.0 {
            self.record_inside(found.step, trajectory)?;
            self.take(found.step, self.time + found.step)?;
        }
        self.regrid();
        let before = self.events.len();
        self.happen()?;
        self.record_step(trajectory)?;
        if let Some(trajectory) = trajectory {
            for occurrence in self.events.get(before..).unwrap_or(&[]) {
                trajectory
                    .events
                    .push((occurrence.time, self.event_name(occurrence.what)));
            }
        }
        Ok(())
    }

    /// The size of the next step, and whether it ends the run.
    fn propose(&self, until: f64) -> (f64, bool) {
        let left = until - self.time;
        let step = match &self.pace {
            Pace::Fixed(step) => *step,
            Pace::Adaptive(control, _) => control.step.min(control.largest),
        };
        if step >= left * (1.0 - 1e-9) {
            (left, true)
        } else {
            (step, false)
        }
    }

    /// Fixed steps count from here on.
    fn regrid(&mut self) {
        self.origin = self.time;
        self.count = 0;
    }

    /// Tries a step; false when it was rejected and the next trial is smaller.
    fn attempt(&mut self, step: f64) -> Result<bool, StepError> {
        let smallest = resolution(self.time);
        let tried = self
            .method
            .attempt(&mut self.system, self.time, step, &self.state);
        let Pace::Adaptive(control, norm) = &mut self.pace else {
            return tried.map(|()| true);
        };
        let (verdict, failure) = match tried {
            Ok(()) => {
                let (error, next) = self.method.estimate(step);
                let error = norm.measure(error, &self.state, next);
                (control.judge(step, error, smallest), None)
            }
            Err(cause) => (control.fail(step, smallest), Some(cause)),
        };
        if verdict == Verdict::Accepted {
            return Ok(true);
        }
        let counters = &mut self.system.counters;
        counters.rejected = counters.rejected.saturating_add(1);
        match (verdict, failure) {
            (Verdict::Rejected, _) => Ok(false),
            (_, Some(cause)) => Err(cause),
            (_, None) => Err(StepError::StepCollapse {
                time: self.time,
                step_size: step,
                block: norm.worst(self.system.model.scene()),
                cause: Collapse::ErrorTest,
            }),
        }
    }

    fn watch_step(&mut self, step: f64) -> Result<(), StepError> {
        if !self.options.watch || !matches!(self.pace, Pace::Fixed(_)) {
            return Ok(());
        }
        let stiffness = self.method.stiffness();
        if self.watch.sees(stiffness) {
            return Err(StepError::UnstableStep {
                step_size: step,
                rho: stiffness,
                suggestion: suggestion(step, stiffness),
            });
        }
        Ok(())
    }

    /// Takes the last attempt: memory, state and time move on together.
    fn take(&mut self, step: f64, end: f64) -> Result<(), StepError> {
        self.system.commit(step);
        self.method.accept(&mut self.state);
        self.time = end;
        let counters = &mut self.system.counters;
        counters.steps = counters.steps.saturating_add(1);
        if self.system.project(&mut self.state) {
            self.method.begin(&mut self.system, self.time, &self.state)?;
        }
        Ok(())
    }

    /// Rows due strictly inside the attempted step, or at its end.
    fn record_inside(
        &mut self,
        step: f64,
        trajectory: &mut Option<&mut Trajectory>,
    ) -> Result<(), StepError> {
        let Some(trajectory) = trajectory else {
            return Ok(());
        };
        let end = self.time + step;
        while let Some(due) = trajectory.due() {
            if due > end + resolution(end) {
                break;
            }
            self.inside_state(((due - self.time) / step).min(1.0), step);
            trajectory.push(
                &mut self.system,
                due,
                due - self.time,
                &self.inside,
                &mut self.scratch,
            )?;
        }
        Ok(())
    }

    /// A row at the accepted step, when every step is asked for.
    fn record_step(&mut self, trajectory: &mut Option<&mut Trajectory>) -> Result<(), StepError> {
        match trajectory {
            Some(trajectory) if trajectory.due().is_none() => trajectory.push(
                &mut self.system,
                self.time,
                0.0,
                &self.state,
                &mut self.scratch,
            ),
            _ => Ok(()),
        }
    }

    /// Puts the state at `theta` of the attempted step into `inside`.
    pub(crate) fn inside_state(&mut self, theta: f64, step: f64) {
        if theta >= 1.0 {
            self.inside.copy_from_slice(self.method.next());
        } else {
            self.method
                .interpolate(theta, step, &self.state, &mut self.inside);
            self.system.normalise(&mut self.inside);
        }
    }

    /// Notes a located event.
    pub(crate) fn note(&mut self, what: Happening) {
        self.events.push(Occurrence {
            time: self.time,
            what,
        });
    }

    fn declared_since(&self, first: usize) -> Option<usize> {
        self.events
            .get(first..)?
            .iter()
            .find_map(|occurrence| match occurrence.what {
                Happening::Declared(event) => Some(event),
                Happening::Line(..) => None,
            })
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

/// Whether this combination of model, method and loads is offered.
fn offered<T: Float, M: Model<T>>(
    model: &M,
    options: &Options,
    supplies: bool,
) -> Result<(), StepError> {
    let (scene, layout) = (model.scene(), model.layout());
    let stepwise = layout
        .nodes
        .iter()
        .find(|node| matches!(node.model, NodeModel::Stepwise { .. }));
    if let (Some(node), Method::Tsit5 { .. }) = (stepwise, options.method) {
        return Err(StepError::Unsupported {
            what: format!(
                "an adaptive method with the `stepwise` node `{}`",
                node_name(scene, node.point)
            ),
            instead: "take Method::Rk4 with a fixed step, or declare the node `rate` or `static`"
                .into(),
        });
    }
    if layout.ni > 0 && !supplies {
        let names: Vec<String> = layout
            .inputs
            .iter()
            .map(|slots| crate::columns::input_name(scene, layout, slots.at))
            .collect();
        return Err(StepError::Unsupported {
            what: format!("a run without the inputs {}", names.join(", ")),
            instead: "give them: Simulation::with_loads(&model, options, loads)".into(),
        });
    }
    Ok(())
}
