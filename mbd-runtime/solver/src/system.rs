//! One stage: inputs, then equilibrium points, then the state derivative.

use std::sync::Arc;

use mbd_scene::laws::breaks::{Break, breaks};
use mbd_scene::laws::of_time::TimeFunctions;
use mbd_scene::{Float, Model, Quantity, Work};

use crate::columns::{line_name, node_name};
use crate::commands::Commands;
use crate::error::{Source, Statistics, StepError, UnevenLines};
use crate::fallback::Fallback;
use crate::integrate::{FreeMotion, normalise};
use crate::laws::{Laws, params_of};
use crate::linearise::Jacobian;
use crate::locate::POINT;
use crate::node::{NodeError, NodeMemory, Nodes, Stage};
use crate::origin::Following;
use crate::projection::Projection;
use crate::supply::Law;
use crate::trajectory::{resolution, told_apart};
use crate::turns::Turning;
use crate::unilateral::Mode;
use crate::watch;

mod branches;
mod by_laws;
mod ends;
mod inertia;
mod known;
mod near_side;
mod no_number;
mod rates;
mod remembered;
mod spring_ends;
mod supplied;

use known::KnownAtEnd;
pub(crate) use known::{EndLooks, LINES, LISTS, OUTPUTS};
pub(crate) use near_side::GuardSide;
use near_side::NearSide;
pub(crate) use remembered::Remembered;
pub(crate) use spring_ends::SAME_PLACE;
pub(crate) use supplied::Controls;
pub use supplied::{External, NoLoads};

/// Integrals carried along behind the state: work of the loads, of the dampers and of prescribed motions [J].
pub(crate) const WORKS: usize = 3;

/// A model with everything it needs to be a right-hand side.
pub(crate) struct System<T: Float> {
    pub model: Arc<dyn Model<T>>,
    /// Functions of time and state that change what is held, in order.
    pub controls: Controls<T>,
    /// Numbers of the caller that hold until others are given.
    pub held: Vec<T>,
    /// Whether nobody has given what has no default: external loads and external gravity.
    pub unsupplied: bool,
    /// Node unknowns of the stage that was evaluated last.
    pub nodes: Nodes<T>,
    /// The same for looking inside a step, so that the end of the step stays untouched.
    pub probe: Nodes<T>,
    /// Whether the last look was at the end of the attempted step, whose nodes are those of the stage that was evaluated last.
    sees_end: bool,
    /// What the nodes and lines remember of the last accepted step.
    pub memory: NodeMemory<T>,
    /// Counters but those of the nodes.
    pub counters: Statistics,
    /// Largest | |q| − 1 | of a quaternion at the end of the last trial step, before it was normalised.
    pub drift: f64,
    /// Length of the state without the integrals behind it.
    pub nx: usize,
    /// The numbers of the stage that was evaluated last.
    pub inputs: Vec<T>,
    quaternions: Vec<usize>,
    /// Room for energy and power.
    pub energy: [T; 6],
    /// Scratch of the model.
    pub work: Work<T>,
    /// What keeps the state on the joints.
    pub projection: Projection<T>,
    /// How the rows are solved.
    pub fallback: Fallback,
    /// The laws themselves, once something asked for them.
    pub(crate) laws: Option<Laws>,
    /// Stages are not evaluated at a later time than this [s].
    pub latest: f64,
    /// And not behind events, where something jumps.
    near: Option<Box<NearSide<T>>>,
    /// Whether rates are the derivative at a state, inputs and modes and nothing else: no equilibrium point, no row, no work that is integrated, nothing
    /// that jumps.
    takes_derivative: bool,
    /// Whether rates are those of the model, where its rows are solved as emitted: no work that is integrated, nothing that jumps.
    takes_rates: bool,
    /// Whether the work of loads, dampers and prescribed motions is integrated along.
    works: bool,
    /// Derivatives of the rates, for a method that asks for them.
    jacobian: Option<Box<Jacobian<T>>>,
    /// Bodies and points that nothing acts on, for a method that asks for their motion.
    pub free_motion: FreeMotion,
    /// What motors that follow inputs were commanded.
    commands: Option<Commands>,
    /// Whether there are joints that may fold.
    may_fold: bool,
    /// The angles whose turns are counted.
    pub(crate) turning: Turning<T>,
    /// Room for a quantity by the laws themselves.
    wide: Vec<f64>,
    /// Room for joint coordinates.
    measured: Vec<T>,
    /// Work of the actions of events so far [J].
    pub action_work: f64,
    /// What is known of the end of a step that was tried beside those of other runs.
    pub known: KnownAtEnd<T>,
    /// The origin, where it follows something.
    pub following: Option<Following>,
    /// Room for a state in the world.
    world: Vec<T>,
    /// Times known beforehand on which steps end: where something has a kink or a jump, or where what acts jumps alone.
    breaks: Vec<Break>,
    passes_kinks: bool,
    /// What changes with time alone.
    pub of_time: Arc<TimeFunctions>,
}

/// How close the times of two entries of a table are that are one jump [s].
fn one_instant<T: Float>(time: f64) -> f64 {
    told_apart::<T>(time).max(POINT)
}

fn stage<'a, T: Float>(
    model: &'a dyn Model<T>,
    time: f64,
    state: &'a [T],
    inputs: &'a [T],
) -> Stage<'a, T> {
    Stage {
        model,
        time: T::from_f64(time),
        state,
        inputs,
    }
}

impl<T: Float> System<T> {
    pub(crate) fn new(model: Arc<dyn Model<T>>, controls: Vec<Law<T>>, works: bool) -> Self {
        let layout = model.layout();
        let defaults = layout.default_inputs(model.scene());
        let held: Vec<T> = defaults.into_iter().map(T::from_f64).collect();
        let (near, nodes) = (NearSide::new(&*model), Nodes::new(layout));
        let projection = Projection::new(layout);
        let may_fold = model.scene().folding_joints().next().is_some();
        let measured = [Quantity::Coordinates, Quantity::Outputs, Quantity::Bodies];
        let measured = measured.map(|what| layout.len(what)).into_iter().max();
        let measured = measured.unwrap_or_default();
        System {
            takes_derivative: !nodes.has_networks()
                && !projection.any()
                && !works
                && near.is_none(),
            takes_rates: !works && near.is_none(),
            latest: f64::INFINITY,
            near,
            unsupplied: controls.is_empty() && layout.needs_caller(),
            controls: Controls::new(&*model, controls, measured),
            nodes,
            probe: Nodes::new(layout),
            sees_end: false,
            memory: NodeMemory::new(layout),
            counters: Statistics::default(),
            drift: 0.0,
            nx: layout.nx(),
            inputs: held.clone(),
            held,
            quaternions: layout.quaternions().collect(),
            energy: [T::zero(); 6],
            work: model.work(),
            projection,
            fallback: Fallback::default(),
            laws: None,
            works,
            jacobian: None,
            free_motion: FreeMotion::default(),
            commands: Commands::new(model.scene()),
            may_fold,
            turning: Turning::new(layout),
            wide: Vec::new(),
            measured: vec![T::zero(); measured],
            action_work: 0.0,
            known: KnownAtEnd::new(layout),
            following: Following::new(model.scene(), layout),
            world: Vec::new(),
            breaks: breaks(model.scene(), &params_of(model.params()), one_instant::<T>),
            passes_kinks: false,
            of_time: Arc::new(TimeFunctions::new(
                model.scene(),
                &params_of(model.params()),
            )),
            model,
        }
    }

    /// Steps end on jumps of what acts alone from here on.
    pub(crate) fn pass_kinks(&mut self) {
        self.passes_kinks = true;
        self.breaks.retain(|at| at.jumps && at.acts);
    }

    /// The next of the times known beforehand that a step ends on, of those that are later than the time of now by more than rounding [s].
    #[inline]
    pub(crate) fn next_break(&self, now: f64) -> Option<f64> {
        match self.breaks.is_empty() {
            true => None,
            false => {
                let later = now + resolution(now);
                let behind = self.breaks.partition_point(|at| at.time <= later);
                self.breaks.get(behind).map(|at| at.time)
            }
        }
    }

    /// Whether something jumps at a time, but for rounding: of what a step ends on by itself half as far before it as behind it [s].
    pub(crate) fn jumps_at(&self, time: f64) -> bool {
        let apart = resolution(time);
        let first = self
            .breaks
            .partition_point(|at| at.time < time - 0.5 * apart);
        let later = self.breaks.iter().skip(first);
        later
            .take_while(|at| at.time <= time + apart)
            .any(|at| at.jumps)
    }

    /// The times inside a span at which what acts jumps, in order [s].
    pub(crate) fn jumps_inside(&self, [from, to]: [f64; 2]) -> impl Iterator<Item = f64> {
        let all = self.breaks.iter().filter(|at| at.jumps);
        let inside = all.filter(move |at| from < at.time && at.time < to);
        inside.map(|at| at.time)
    }

    /// Runs the same scene with other parameters from here on.
    pub(crate) fn take(&mut self, model: Arc<dyn Model<T>>) {
        let params = params_of(model.params());
        self.breaks = breaks(model.scene(), &params, one_instant::<T>);
        if self.passes_kinks {
            self.pass_kinks();
        }
        Arc::make_mut(&mut self.of_time).set_params(params);
        self.model = model;
        self.laws = None;
        if self.jacobian.is_some() {
            self.provide_derivatives();
        }
        if !self.free_motion.is_empty() {
            self.provide_free_motion();
        }
        self.fallback = Fallback::default();
    }

    /// Looks up how bodies and points move that nothing acts on.
    pub(crate) fn provide_free_motion(&mut self) {
        self.free_motion = FreeMotion::new(&*self.model);
    }

    /// Makes room for derivatives of the rates.
    pub(crate) fn provide_derivatives(&mut self) {
        self.jacobian = Some(Box::new(Jacobian::new(&*self.model, self.works)));
    }

    /// Length of the state with the integrals behind it.
    pub(crate) fn length(&self) -> usize {
        self.nx + if self.works { WORKS } else { 0 }
    }

    /// Places the nodes and decides the modes of the lines, for the start of a run.
    pub(crate) fn start(
        &mut self,
        time: f64,
        state: &mut [T],
        guess: Option<&[T]>,
    ) -> Result<(), StepError> {
        let state = state.get_mut(..self.nx).unwrap_or_default();
        self.supply(time, state)?;
        let stage = stage(&*self.model, time, state, &self.inputs);
        let started = self
            .nodes
            .start_stage(stage, guess, &mut self.memory, &mut self.work);
        started.map_err(|error| self.node_error(time, error))?;
        self.nodes.place_in(state);
        Ok(())
    }

    /// Reads the inputs and solves the nodes at a state inside a step, without touching the stage that was evaluated last.
    pub(crate) fn look(&mut self, time: f64, span: f64, state: &[T]) -> Result<(), StepError> {
        let state = state.get(..self.nx).unwrap_or_default();
        self.sees_end = false;
        self.supply(time, state)?;
        let stage = stage(&*self.model, time, state, &self.inputs);
        let span = T::from_f64(span);
        let solved = self
            .probe
            .solve_stage(stage, span, &self.memory, &mut self.work);
        solved.map_err(|error| self.node_error(time, error))
    }

    /// The same at the end of the attempted step, whose nodes are solved already.
    pub(crate) fn look_at_end(&mut self, time: f64, state: &[T]) -> Result<(), StepError> {
        self.sees_end = true;
        self.supply(time, state)
    }

    /// Nodes where [`System::look`] or [`System::look_at_end`] looked last.
    pub(crate) fn seen_nodes(&self) -> &Nodes<T> {
        match self.sees_end {
            true => &self.nodes,
            false => &self.probe,
        }
    }

    /// A quantity at the state that was looked at last.
    pub(crate) fn seen(&mut self, what: Quantity, time: f64, state: &[T], out: &mut [T]) {
        let known = self.known.list(what, time).filter(|_| self.sees_end);
        if let Some(known) = known {
            out.copy_from_slice(known);
            return;
        }
        let state = state.get(..self.nx).unwrap_or_default();
        let nodes = match self.sees_end {
            true => &self.nodes,
            false => &self.probe,
        };
        let at = nodes.at(T::from_f64(time), state, &self.inputs);
        self.model.evaluate(what, &at, &mut self.work, out);
    }

    /// A quantity at the stage that was evaluated last: the end of a trial step, without another solve of the nodes.
    pub(crate) fn at_end(
        &mut self,
        what: Quantity,
        time: f64,
        state: &[T],
        out: &mut [T],
    ) -> Result<(), StepError> {
        if let Some(known) = self.known.list(what, time) {
            out.copy_from_slice(known);
            return Ok(());
        }
        let state = state.get(..self.nx).unwrap_or_default();
        self.supply(time, state)?;
        let at = self.nodes.at(T::from_f64(time), state, &self.inputs);
        self.model.evaluate(what, &at, &mut self.work, out);
        Ok(())
    }

    /// Puts energy and power at the stage that was evaluated last into `energy`.
    pub(crate) fn read_energy(&mut self, time: f64, state: &[T]) {
        if let Some(energy) = self.known.energy(time) {
            self.energy = energy;
            return;
        }
        let state = state.get(..self.nx).unwrap_or_default();
        let at = self.nodes.at(T::from_f64(time), state, &self.inputs);
        self.model
            .evaluate(Quantity::Energy, &at, &mut self.work, &mut self.energy);
        self.power_anew(time, state);
    }

    /// The weights of the stability watch's norm for steps of a size [s].
    pub(crate) fn watch_weights(
        &mut self,
        time: f64,
        state: &[T],
        step: f64,
    ) -> Result<Vec<T>, StepError> {
        let mut masses = vec![0.0; self.model.layout().nv];
        let state = state.get(..self.nx).unwrap_or_default();
        self.supply(time, state)?;
        let at = self.nodes.at(T::from_f64(time), state, &self.inputs);
        let laws = self.laws.get_or_insert_with(|| Laws::new(&*self.model));
        laws.run(&*self.model, &at, |scene, layout, numbers, at, scratch| {
            mbd_scene::masses(scene, layout, numbers, at, scratch, &mut masses);
        });
        let numbers = laws.numbers().clone();
        Ok(watch::weights((&*self.model, numbers), &masses, step))
    }

    /// Whether the modes of elements are kept between located events, or decided at every stage.
    pub(crate) fn frozen(&mut self, frozen: bool) {
        self.nodes.freeze(frozen);
        self.probe.freeze(frozen);
    }

    /// Takes up the modes that the memory has at an accepted state, before nodes are put in balance with them.
    pub(crate) fn read_modes(&mut self, time: f64, state: &[T]) -> Result<(), StepError> {
        let state = state.get(..self.nx).unwrap_or_default();
        self.supply(time, state)?;
        self.nodes.hold_modes(&self.memory);
        Ok(())
    }

    /// The mode of every element.
    pub(crate) fn modes(&self) -> &[Mode] {
        self.memory.modes()
    }

    /// Changes the modes of elements at an accepted state, where the margins that vanish there are known to `within` [m or rad], and of what hangs on them.
    pub(crate) fn switch(
        &mut self,
        time: f64,
        state: &[T],
        (switches, within): (&[(usize, Mode)], f64),
    ) -> Result<(), StepError> {
        let state = state.get(..self.nx).unwrap_or_default();
        self.supply(time, state)?;
        let stage = stage(&*self.model, time, state, &self.inputs);
        let switches = (switches, T::from_f64(within));
        let switched = self
            .nodes
            .switch(stage, switches, &mut self.memory, &mut self.work);
        switched.map_err(|error| self.node_error(time, error))
    }

    /// Puts nodes back on the line or plane that balance keeps them on; true when the state changed.
    #[inline]
    pub(crate) fn project(&self, state: &mut [T]) -> bool {
        self.nodes.has_networks()
            && self
                .nodes
                .project(state.get_mut(..self.nx).unwrap_or_default())
    }

    /// Puts nodes on the line or plane that their lines are about to be drawn into without force, and lists the lines that are slack there; true when the
    /// state changed.
    pub(crate) fn straighten(&self, state: &mut [T], slack: &mut Vec<(usize, Mode)>) -> bool {
        let state = state.get_mut(..self.nx).unwrap_or_default();
        self.nodes.straighten(state, slack)
    }

    /// The last solve was at the end of a step that is accepted.
    #[inline]
    pub(crate) fn commit(&mut self, step: f64) {
        if !self.nodes.is_idle() {
            self.nodes.accept(T::from_f64(step), &mut self.memory);
        }
        if self.projection.any() {
            self.fallback.commit();
        }
    }

    /// Makes every quaternion a unit quaternion; returns the largest | |q| − 1 | there was. A zero quaternion stays.
    #[inline]
    pub(crate) fn normalise(&self, state: &mut [T]) -> f64 {
        normalise(state, &self.quaternions)
    }

    #[cold]
    fn node_error(&self, time: f64, error: NodeError) -> StepError {
        let (scene, layout) = (self.model.scene(), self.model.layout());
        let name = |node: usize| {
            let point = layout.nodes.get(node).map_or(usize::MAX, |node| node.point);
            node_name(scene, point).to_owned()
        };
        match error {
            NodeError::NotConverged {
                node,
                residual_n,
                iterations,
                uneven,
            } => StepError::NoEquilibrium {
                point: name(node),
                time,
                residual_n,
                iterations: iterations as u64,
                uneven: uneven.map(|pair| {
                    Box::new(UnevenLines {
                        softest: line_name(scene, pair.softest).to_owned(),
                        stiffest: line_name(scene, pair.stiffest).to_owned(),
                        ratio: pair.ratio,
                    })
                }),
            },
            NodeError::InvalidLine { line, what, value } => StepError::InvalidInput {
                slot: format!("{what} of line {}", line_name(scene, line)),
                value,
            },
            NodeError::LineAtNode { line, why } => StepError::Unsupported {
                what: format!("line `{}` at a point without mass,", line_name(scene, line)),
                instead: format!("{why}, or give the point a mass"),
            },
            NodeError::NotFinite { .. } => StepError::NonFinite {
                time,
                source: Source::Node(name(0)),
            },
            NodeError::Unsupported { node, why } => StepError::Unsupported {
                what: format!("the node model of `{}`", name(node)),
                instead: why.to_owned(),
            },
            NodeError::Shape {
                what,
                found,
                expected,
            } => StepError::length(what, found, expected),
        }
    }

    /// Counters, those of the node solver included.
    pub(crate) fn statistics(&self) -> Statistics {
        let nodes = self.nodes.statistics();
        Statistics {
            node_solves: nodes.solves,
            node_iterations: nodes.iterations,
            node_iterations_max: nodes.most as u64,
            node_strategy: match nodes.solves {
                0 => 0,
                _ => nodes.strategy as u64 + 1,
            },
            rows_strategy: match self.projection.any() {
                false => 0,
                true => self.fallback.worst as u64 + 1,
            },
            lost_digits: self.fallback.lost_digits,
            ..self.counters
        }
    }
}
