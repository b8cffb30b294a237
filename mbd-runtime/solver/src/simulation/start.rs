//! The start of a run: a state that can be used, nodes in balance, a mode for every line, a first step.

use std::cell::OnceCell;
use std::sync::Arc;

use mbd_scene::laws::starts;
use mbd_scene::{
    Float, Layout, Model, PlacementError, PlacementReport, Quantity, Scene, StartFrom,
    declared_beside, declared_parts, place_declared,
};

use super::act::Changes;
use super::moved::{Moved, moved};
use super::offered::{differentiable, offered, stepwise, unsupplied};
use super::overlooked::Overlooked;
use super::sizes::RunSizes;
use super::stability::Meter;
use super::{ModelRun, Pace, WorldState};
use crate::chatter::Chatter;
use crate::error::{RunError, StepError};
use crate::event::Margins;
use crate::integrate::{
    Attached, Control, Explicit, Family, RODAS5P, Rattle, Rosenbrock, Stepper, StiffnessTest,
    TSIT5, VERN7,
};
use crate::laws::params_of;
use crate::moving::moving;
use crate::options::{Method, Options};
use crate::rearm::Rearmed;
use crate::rounding::{StepRounding, TimeRounding};
use crate::state_rounding::StateRounding;
use crate::step_sizes::StepSizes;
use crate::supply::Law;
use crate::system::System;
use crate::watch::Watch;

/// Below this margin, the square of an angle between rows, a start is singular: rounding leaves 1e-20 there.
const SINGULAR: f64 = 1e-14;
/// The tolerance from which on `Auto` begins with Tsit5, below with Vern7.
const LOOSE: f64 = 1e-5;

impl<T: Float> ModelRun<T> {
    /// What [`Simulation::new`] and [`Simulation::with_loads`] do.
    pub(crate) fn make(
        model: Arc<dyn Model<T>>,
        options: Options,
        controls: Vec<Law<T>>,
    ) -> Result<Self, RunError> {
        let refuse = |cause| RunError {
            cause,
            progress: Box::default(),
        };
        options.check(T::EPSILON.to_f64()).map_err(refuse)?;
        offered(&*model, &options).map_err(refuse)?;
        if !controls.is_empty() {
            differentiable(&options).map_err(refuse)?;
        }
        let mut system = System::new(model.clone(), controls, options.work);
        system.frozen(options.locate);
        system.projection.stabilise = options.stabilise;
        let sizes = RunSizes::of(&mut system, &options);
        let fixed = options.method.fixed_step().is_some();
        if fixed {
            system.pass_kinks();
        }
        let length = system.length();
        let layout = model.layout();
        let noisy = fixed && options.guard_tolerance.is_none();
        let behind = length - system.nx;
        let explicit = |method: Explicit<T>| Family::Explicit(method.keeping_digits());
        let implicit = |system: &mut System<T>| {
            system.provide_derivatives();
            Family::Implicit(Rosenbrock::new(&RODAS5P, length, attached(layout), behind))
        };
        let method = match options.method {
            Method::Rk4 { .. } => Stepper::new(explicit(Explicit::rk4(length)), None),
            Method::Tsit5 { .. } => Stepper::new(explicit(Explicit::new(&TSIT5, length)), None),
            Method::Vern7 { .. } => Stepper::new(explicit(Explicit::new(&VERN7, length)), None),
            Method::Rodas5P { .. } => Stepper::new(implicit(&mut system), None),
            Method::Auto { rtol, .. } => {
                let begins = match rtol >= LOOSE {
                    true => Explicit::new(&TSIT5, length),
                    false => Explicit::new(&VERN7, length),
                };
                Stepper::new(explicit(begins), Some(implicit(&mut system)))
            }
            Method::Rattle { .. } => {
                system.provide_free_motion();
                let speeds = layout.nq..layout.nq + layout.nv;
                let asked = noisy && options.locate && layout.len(Quantity::Guards) > 0;
                let rattle = Rattle::new(length, speeds, behind, asked);
                Stepper::new(Family::Symmetric(rattle), None)
            }
        };
        let pace = match (options.method.fixed_step(), options.method.tolerance()) {
            (_, Some([rtol, max_step])) => {
                let control = Control::new(0.0, max_step, [method.exponent(), method.memory()]);
                Pace::Adaptive(control, sizes.error_norm(&system, rtol))
            }
            (step, None) => Pace::Fixed(step.unwrap_or(f64::NAN)),
        };
        let margins = Margins::new(&*model, options.locate, |acting| sizes.passing(acting));
        let room = [
            Quantity::Guards,
            Quantity::Lines,
            Quantity::Outputs,
            Quantity::Bodies,
            Quantity::Energy,
            Quantity::Constraint,
            Quantity::Reactions,
        ]
        .map(|what| layout.len(what));
        let bodies = layout.len(Quantity::Bodies);
        let mut state = vec![T::zero(); length];
        let (start, assembly) = declared_start(&*model, 0.0, None).map_err(refuse)?;
        for (slot, value) in state.iter_mut().zip(system.set_down(0.0, None, &start)) {
            *slot = value;
        }
        system.remember_starts(&[], (0.0, &state));
        let straight = stepwise(&*model).is_some();
        let overlooked = Overlooked::new(
            (model.scene(), model.layout()),
            length,
            system.of_time.acting(),
        );
        let changes = Changes {
            settable: model.scene().set_by_events(),
            own: model.params().to_vec(),
            done: vec![false; layout.events],
            stop: None,
            all: Vec::new(),
            handed: None,
        };
        Ok(ModelRun {
            system,
            method,
            state,
            shown: WorldState::new(),
            time: 0.0,
            chatter: Chatter::new(),
            scratch: vec![T::zero(); room.into_iter().max().unwrap_or(0)],
            guards: layout.len(Quantity::Guards),
            inside: vec![T::zero(); length],
            chosen: vec![false; margins.now.len()],
            switches: Vec::with_capacity(layout.one_way()),
            crossed: Vec::with_capacity(layout.events),
            margins,
            noisy,
            attempted: f64::NAN,
            received: None,
            beside: false,
            stays: false,
            lacks_stages: false,
            is_elsewhere: false,
            refused: None,
            straight,
            overlooked,
            looks: 0,
            stalled: f64::NAN,
            pace,
            step_sizes: StepSizes::default(),
            below: None,
            stiffness: StiffnessTest::default(),
            watch: Watch::default(),
            watch_weights: Vec::new(),
            watched: options.watch && fixed && !straight,
            balance: None,
            momentum: None,
            judged: false,
            meter: Meter::Nothing,
            fingerprint: OnceCell::new(),
            columns: OnceCell::new(),
            good: None,
            sizes,
            rounded: 0.0,
            steps_elsewhere: 0,
            time_rounding: TimeRounding::default(),
            step_rounding: StepRounding::default(),
            state_rounding: StateRounding::default(),
            digit_room: std::array::from_fn(|_| Vec::with_capacity(length)),
            reads_time: OnceCell::new(),
            bodies: vec![T::zero(); bodies],
            origin: 0.0,
            count: 0,
            options,
            guess: None,
            jumped: true,
            as_declared: true,
            started: false,
            under_way: false,
            stale: false,
            left: Vec::with_capacity(layout.ni),
            samplers: Vec::new(),
            given: vec![T::zero(); layout.ni],
            moved: Vec::new(),
            passed_stops: Vec::new(),
            hidden: None,
            joints_set: Vec::new(),
            assembly,
            singular_start: false,
            events: Vec::with_capacity(256),
            changes,
        })
    }

    /// What [`Simulation::start`] does.
    pub(crate) fn start_now(&mut self) -> Result<(), RunError> {
        self.whole(Self::begin)
    }

    /// Begins to run, in whatever asks for a run that has begun.
    pub(crate) fn begin(&mut self) -> Result<(), RunError> {
        self.begin_after(false)
    }

    /// The same of a run that goes on from another one (`goes_on`), which has seen what happens at this time.
    pub(super) fn begin_after(&mut self, goes_on: bool) -> Result<(), RunError> {
        let within = std::mem::replace(&mut self.under_way, true);
        let begun = self.begin_now(goes_on);
        self.under_way = within;
        begun
    }

    fn begin_now(&mut self, goes_on: bool) -> Result<(), RunError> {
        if !goes_on {
            self.place_by_inputs()?;
        }
        self.started = true;
        self.as_declared = false;
        self.hidden = None;
        self.joints_set.clear();
        self.shown.forget();
        self.origin = self.time;
        self.count = 0;
        if self.is_adaptive() {
            self.step_sizes.begin(self.time);
        }
        self.chatter = Chatter::new();
        self.stiffness = StiffnessTest::default();
        self.stalled = f64::NAN;
        self.method.set_lost(&[]);
        let started = self.consistent_start(goes_on);
        started.map_err(|cause| {
            self.started = false;
            self.failed(cause)
        })
    }

    /// Motors that inputs tell where to be take along what hangs on them: a start that the declaration or joint coordinates say is placed again with the
    /// inputs that the run begins with.
    fn place_by_inputs(&mut self) -> Result<(), RunError> {
        let model = self.system.model.clone();
        let (scene, layout) = (model.scene(), model.layout());
        let placed = self.as_declared || !self.joints_set.is_empty();
        if !placed || !scene.motors_follow_inputs() {
            return Ok(());
        }
        let (time, state) = (self.time, self.state.clone());
        let supplied = self.system.supply(time, &state);
        supplied.map_err(|cause| self.failed(cause))?;
        let inputs = self.inputs_now();
        if inputs == layout.default_inputs(scene) {
            return Ok(());
        }
        let set = std::mem::take(&mut self.joints_set);
        if !set.is_empty() {
            return self.set_again(&set);
        }
        let declared = declared_start(&*model, time, Some(&inputs));
        let (start, assembly) = declared.map_err(|cause| self.failed(cause))?;
        self.begin_at(start, assembly);
        Ok(())
    }

    /// In relative coordinates joints hold whatever the state: bodies and points that are not where the declaration puts them, in a run that
    /// begins as declared (`set`).
    fn displaced(&self, set: &[T]) -> Vec<Moved> {
        let model = &*self.system.model;
        let (scene, layout) = (model.scene(), model.layout());
        let numbers = |list: &[T]| -> Vec<f64> { list.iter().map(|x| x.to_f64()).collect() };
        let (params, state) = (numbers(model.params()), numbers(&self.state[..set.len()]));
        let inputs = self.inputs_now();
        let from = StartFrom::new(&params, self.time).with_inputs(&inputs);
        let Some((scene, layout, [here, declared])) = declared_beside(scene, layout, from, &state)
        else {
            return Vec::new();
        };
        let (start, _) = declared_start(model, self.time, Some(&inputs)).unwrap_or_default();
        match start
            .iter()
            .map(|x| T::from_f64(*x))
            .eq(set.iter().copied())
        {
            true => moved((&scene, &layout), &declared, &here),
            false => Vec::new(),
        }
    }

    fn consistent_start(&mut self, goes_on: bool) -> Result<(), StepError> {
        self.stale = false;
        self.left.clear();
        if self.system.unsupplied {
            return Err(unsupplied(&*self.system.model));
        }
        if matches!(self.options.method, Method::Rodas5P { .. }) && !self.system.controls.is_empty()
        {
            return Err(StepError::Unsupported {
                what: format!(
                    "{} with inputs that are functions of time and state",
                    self.options.method.name()
                ),
                instead: "these have no derivatives: hold inputs (`set_inputs`), sample them (`control_every`), declare what they follow in the model, or take an explicit method".into(),
            });
        }
        let own = self.state.get(..self.system.nx).unwrap_or_default();
        self.check_state(self.time, own)?;
        let set = self.state.clone();
        self.system.read_modes(self.time, &self.state)?;
        let assembled = self.system.assemble(self.time, &mut self.state);
        self.system.count_turns(self.time, &self.state);
        let (model, nx) = (&self.system.model, self.system.nx);
        let scene = (model.scene(), model.layout());
        self.moved = moved(scene, &set[..nx], &self.state[..nx]);
        let displaced = self.displaced(&set[..nx]);
        self.moved.extend(displaced);
        assembled?;
        self.singular_start =
            self.system.projection.any() && self.system.fallback.margin < SINGULAR;
        self.system
            .start(self.time, &mut self.state, self.guess.as_deref())?;
        self.system
            .check_spring_ends(self.time, &self.state, self.sizes.length())?;
        self.find_passed_stops()?;
        self.begin_watch()?;
        self.method
            .begin(&mut self.system, self.time, 0.0, &self.state)?;
        self.method
            .prepare(&mut self.system, self.time, &self.state)?;
        self.system
            .check_conditioning(self.time, &self.state, self.method.first_mut())?;
        if let Pace::Adaptive(control, norm) = &mut self.pace {
            // The first step moves no block by more than a hundredth of its scale.
            let speed =
                norm.measure(self.method.first(), &self.state, &self.state) * norm.tolerance;
            let step = if speed > 0.0 { 0.01 / speed } else { 1e-3 };
            *control = Control::new(
                step.min(control.largest),
                control.largest,
                [self.method.exponent(), self.method.memory()],
            );
        }
        self.system.follow_commands(self.time, None, &self.state)?;
        self.margins.rearmed.fill(Rearmed::default());
        self.begin_margins(&mut |_| ())?;
        let clocks = match goes_on {
            true => Vec::new(),
            false => self.clocks(),
        };
        self.settle_sides(&|index| !clocks.contains(&index))?;
        self.settle_clocks(&clocks)?;
        self.begin_behind()?;
        self.find_held_guards()?;
        self.rounded = 0.0;
        self.time_rounding = TimeRounding::default();
        self.step_rounding = StepRounding::default();
        self.begin_state_digits();
        self.watch_rounding()?;
        self.watch_time()?;
        self.begin_balance();
        self.begin_momentum();
        Ok(())
    }
}

/// The state in the world at the declared start, with these inputs or their defaults, and what was decided for it: joint coordinates of which no start is declared are zero, what flies is where it flies from, at rest,
/// unturned there; declared states where they begin.
pub(crate) fn declared_start<T: Float>(
    model: &dyn Model<T>,
    time: f64,
    inputs: Option<&[f64]>,
) -> Result<(Vec<f64>, PlacementReport), StepError> {
    let (scene, layout) = (model.scene(), model.layout());
    let mut state = vec![0.0; layout.nx()];
    for qw in layout.quaternions() {
        if let Some(qw) = state.get_mut(qw) {
            *qw = 1.0;
        }
    }
    let params = params_of(model.params());
    let own = state.iter_mut().skip(layout.states());
    own.zip(starts(scene, &params))
        .for_each(|(state, start)| *state = start);
    let from = StartFrom {
        inputs,
        ..StartFrom::new(&params, time)
    };
    declared_parts(scene, layout, from, &mut state);
    let assembly = place_declared(scene, layout, from, &[], &[], &mut state)
        .map_err(|error| misplaced(scene, error))?;
    let own = state.iter_mut().skip(layout.states());
    own.zip(starts(scene, model.params()))
        .for_each(|(state, start)| *state = start.to_f64());
    Ok((state, assembly))
}

pub(super) fn misplaced(scene: &Scene, error: PlacementError) -> StepError {
    let (name, why) = error.describe(scene);
    StepError::Unplaced { name, why }
}

/// The coordinates of a scene, each with its speeds.
fn attached(layout: &Layout) -> Vec<Attached> {
    let parts = moving(layout).flat_map(|part| {
        let place = (part.position, part.velocity);
        [place, (part.attitude, part.spin)]
    });
    let parts = parts.filter(|(at, _)| !at.is_empty());
    parts.map(|(at, speeds)| Attached { at, speeds }).collect()
}
