//! What a caller supplies: inputs, external loads and external gravity, held or as functions of time and state.

use mbd_scene::{At, Float, Model, StageInputs, Work};

use super::System;
use crate::error::StepError;
use crate::list::all_finite;
use crate::supply::{Law, Moment, check_supplied};

/// Inputs, external loads and external gravity of a scene that is not compiled, in the order of `Layout::inputs`, as functions of time and state.
///
/// A pure function: it is called at trial states which may be rejected. For a model of `model!` use
/// [`Simulation::control`](crate::Simulation::control), whose numbers have names.
pub trait External<T> {
    /// Writes every number of `out` (SI, world axes).
    fn evaluate(&self, time: T, state: &[T], out: &mut [T]);

    /// False when there is nothing to supply: inputs keep their declared defaults, and a scene with external loads refuses to run.
    fn supplies(&self) -> bool {
        true
    }
}

/// No inputs and no external loads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NoLoads;

impl<T> External<T> for NoLoads {
    fn evaluate(&self, _time: T, _state: &[T], _out: &mut [T]) {}

    fn supplies(&self) -> bool {
        false
    }
}

impl<T, E: External<T>> External<T> for &E {
    fn evaluate(&self, time: T, state: &[T], out: &mut [T]) {
        (**self).evaluate(time, state, out);
    }

    fn supplies(&self) -> bool {
        (**self).supplies()
    }
}

impl<T: Float> System<T> {
    /// Holds these numbers from now on.
    pub(crate) fn hold(&mut self, numbers: &[T]) {
        self.held.copy_from_slice(numbers);
        self.inputs.copy_from_slice(numbers);
        self.unsupplied = false;
    }

    /// Writes a state as it is in the world, where that is something else.
    #[inline]
    fn show(&mut self, time: f64, state: &[T]) {
        if self.following.is_some() {
            self.show_in_world(time, state);
        }
    }

    fn show_in_world(&mut self, time: f64, state: &[T]) {
        let mut world = std::mem::take(&mut self.world);
        world.clear();
        world.extend(self.in_world(time, state).map(T::from_f64));
        self.world = world;
    }

    /// What functions and controllers are shown at a time and a state.
    pub(crate) fn moment<'a>(&'a mut self, time: f64, state: &'a [T]) -> Moment<'a, T> {
        self.show(time, state);
        let at = self.nodes.at(T::from_f64(time), state, &self.held);
        let state = self.following.as_ref().map_or(state, |_| &self.world);
        let room = (&mut self.work, &mut *self.measured);
        Moment::new((time, state), (&*self.model, at), room, false)
    }

    /// The same at a sample, where outputs can be asked for: inputs as they were up to it, nodes in balance.
    pub(crate) fn settled_moment<'a>(
        &'a mut self,
        time: f64,
        state: &'a [T],
    ) -> Result<Moment<'a, T>, StepError> {
        if self.model.layout().columns == 0 {
            return Ok(self.moment(time, state));
        }
        self.look(time, 0.0, state)?;
        self.show(time, state);
        let at = self.probe.at(T::from_f64(time), state, &self.inputs);
        let state = self.following.as_ref().map_or(state, |_| &self.world);
        let room = (&mut self.work, &mut *self.measured);
        Ok(Moment::new((time, state), (&*self.model, at), room, true))
    }

    /// Whether functions of time and state change what is held.
    #[inline]
    pub(crate) fn has_functions(&self) -> bool {
        !self.controls.is_empty() && !self.inputs.is_empty()
    }

    /// The inputs of a stage. Without functions of time and state they are those that are held.
    #[inline]
    pub(crate) fn supply(&mut self, time: f64, state: &[T]) -> Result<(), StepError> {
        match self.has_functions() {
            true => self.ask_functions(time, state),
            false => Ok(()),
        }
    }

    fn ask_functions(&mut self, time: f64, state: &[T]) -> Result<(), StepError> {
        let own = state.get(..self.nx).unwrap_or_default();
        self.show(time, own);
        let shown = self.following.as_ref().map_or(own, |_| &self.world);
        let at = self.nodes.at(T::from_f64(time), own, &self.held);
        let (model, inputs) = (&*self.model, &mut self.inputs);
        let mut functions = self.controls.functions(model, &self.held, inputs);
        functions.ask((time, shown), at);
        check_supplied(&*self.model, time, &self.inputs)
    }
}

/// Functions of time and state that change what is held, in the order in which they were given. They measure while the model makes stages: their scratch is
/// their own.
pub(crate) struct Controls<T: Float> {
    laws: Vec<Law<T>>,
    work: Work<T>,
    room: Vec<T>,
}

impl<T: Float> Controls<T> {
    /// Of a model; `room`: how many numbers they may measure.
    pub(super) fn new(model: &dyn Model<T>, laws: Vec<Law<T>>, room: usize) -> Self {
        let mut controls = Controls {
            laws: Vec::new(),
            work: Work::default(),
            room: vec![T::zero(); room],
        };
        for law in laws {
            controls.push(model, law);
        }
        controls
    }

    /// One more.
    pub(crate) fn push(&mut self, model: &dyn Model<T>, law: Law<T>) {
        if self.laws.is_empty() {
            self.work = model.work();
        }
        self.laws.push(law);
    }

    /// Whether there is none.
    #[inline]
    pub(crate) fn is_empty(&self) -> bool {
        self.laws.is_empty()
    }

    /// What changes the numbers that are `held` into `inputs`.
    #[inline]
    pub(super) fn functions<'a>(
        &'a mut self,
        model: &'a dyn Model<T>,
        held: &'a [T],
        inputs: &'a mut [T],
    ) -> Functions<'a, T> {
        Functions {
            controls: self,
            model,
            held,
            inputs,
            finite: true,
        }
    }
}

/// The functions of a run and what they change.
pub(super) struct Functions<'a, T: Float> {
    controls: &'a mut Controls<T>,
    model: &'a dyn Model<T>,
    held: &'a [T],
    inputs: &'a mut [T],
    /// Whether all numbers so far were finite.
    pub finite: bool,
}

impl<T: Float> Functions<'_, T> {
    /// Writes the inputs at a time [s] and a state as functions are shown it, measured at a stage whose inputs are those that are held.
    #[inline]
    fn ask(&mut self, (time, shown): (f64, &[T]), at: At<'_, T>) {
        self.inputs.copy_from_slice(self.held);
        let Controls { laws, work, room } = &mut *self.controls;
        let moment = Moment::new((time, shown), (self.model, at), (work, room), false);
        for law in laws {
            law(&moment, self.inputs);
        }
    }
}

impl<T: Float> StageInputs<T> for Functions<'_, T> {
    fn at_stage(&mut self, time: f64, at: &At<'_, T>) -> &[T] {
        self.ask((time, at.state), *at);
        self.finite &= all_finite(self.inputs);
        self.inputs
    }
}
