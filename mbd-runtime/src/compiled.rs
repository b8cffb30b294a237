//! What is compiled once: the doors through which a user's crate enters the solvers of this one.
//!
//! A generic function is compiled again in every crate that calls it. What stands behind these doors is compiled here, for `f64` and `f32`,
//! so that a crate with a model compiles its equations and nothing else. A method that only reads a field needs no door.

use std::sync::Arc;

use mbd_scene::laws::LineNumbers;
use mbd_scene::{At, Float, Layout, Model, ParamError, Quantity, Scene, Work};

use crate::__private::Lines;
use crate::error::RunError;
use crate::event::Happening;
use crate::generic::Generic;
use crate::linearise::{Linearisation, LinearisationError};
use crate::options::Options;
use crate::simulation::{Simulation, Snapshot, Stop};
use crate::system::{External, NoLoads};
use crate::trajectory::Trajectory;

/// Declares every door once: the name that the public method calls, and the function behind it.
macro_rules! doors {
    ($(fn $name:ident($($argument:ident: $given:ty),*) -> $result:ty = $path:path;)*) => {
        /// A scalar that the solvers of this crate are compiled for: `f64` or `f32`.
        pub trait Scalar: Float {
            $(
                #[doc(hidden)]
                fn $name($($argument: $given),*) -> $result;
            )*
        }

        doors!(f64, $(fn $name($($argument: $given),*) -> $result = $path;)*);
        doors!(f32, $(fn $name($($argument: $given),*) -> $result = $path;)*);
    };
    ($scalar:ty, $(fn $name:ident($($argument:ident: $given:ty),*) -> $result:ty = $path:path;)*) => {
        impl Scalar for $scalar {
            $(
                #[inline(never)]
                fn $name($($argument: $given),*) -> $result {
                    $path($($argument),*)
                }
            )*
        }
    };
}

doors! {
    fn make_simulation(model: Arc<dyn Model<Self>>, options: Options, loads: Box<dyn External<Self> + Send>) -> Result<Simulation<Self>, RunError> = Simulation::make;
    fn drive(run: &mut Simulation<Self>, until: f64, trajectory: Option<&mut Trajectory>, go_on: &mut dyn FnMut(f64) -> bool) -> Result<Stop, RunError> = Simulation::drive;
    fn take_step(run: &mut Simulation<Self>) -> Result<(), RunError> = Simulation::take_step;
    fn begin(run: &mut Simulation<Self>) -> Result<(), RunError> = Simulation::begin;
    fn look(run: &mut Simulation<Self>, what: Quantity, out: &mut [Self]) -> Result<(), RunError> = Simulation::look;
    fn give_state(run: &mut Simulation<Self>, time: f64, state: &[Self]) -> Result<(), RunError> = Simulation::give_state;
    fn give_nodes(run: &mut Simulation<Self>, guess: &[Self]) -> Result<(), RunError> = Simulation::give_nodes;
    fn give_joints(run: &mut Simulation<Self>, given: &[(&str, f64)]) -> Result<(), RunError> = Simulation::give_joints;
    fn give_params(run: &mut Simulation<Self>, params: &[Self]) -> Result<(), ParamError> = Simulation::give_params;
    fn continue_from(run: &mut Simulation<Self>, snapshot: &Snapshot<Self>) -> Result<(), RunError> = Simulation::continue_from;
    fn save(run: &Simulation<Self>) -> Snapshot<Self> = Simulation::save;
    fn name_event(run: &Simulation<Self>, what: Happening) -> String = Simulation::name_event;
    fn make_generic(scene: Scene, params: &[Self]) -> Result<Generic<Self>, ParamError> = Generic::make;
    fn change_generic(model: &Generic<Self>, params: &[Self]) -> Result<Generic<Self>, ParamError> = Generic::change;
    fn make_work(model: &Generic<Self>) -> Work<Self> = Generic::scratch;
    fn run_laws(model: &Generic<Self>, what: Quantity, at: &At<'_, Self>, work: &mut Work<Self>, out: &mut [Self]) -> () = Generic::run;
    fn linearise(total: &mut Linearisation<Self>, model: &dyn Model<Self>, at: &At<'_, Self>, work: &mut Work<Self>) -> Result<(), LinearisationError> = Linearisation::run;
    fn prepare(scene: &Scene, params: &[Self]) -> Result<Lines<Self>, ParamError> = crate::__private::prepare;
}

impl<T: Scalar> Simulation<T> {
    /// A simulation of a model without inputs, at its declared start, which is at rest at the origin where nothing is declared, until [`Simulation::set_state`]. It owns what it runs: a [shared](Model::share)
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

    /// Sets time [s] and state x = [q | v | z]; `rate` nodes are placed by [`Simulation::start`] where z is all zero. Quaternions are normalised.
    ///
    /// # Errors
    /// A number that is not finite, a quaternion off unit length by more than 1e-3, or a wrong length.
    pub fn set_state(&mut self, time: f64, state: &[T]) -> Result<(), RunError> {
        T::give_state(self, time, state)
    }

    /// Places bodies by joint coordinates, by their names: `run.set_joints(&[("pin.angle", 0.5), ("pin.angle_rate", 1.0)])` [m or rad, and per second].
    /// Bodies that no joint ties to the world, or to another body, stay where [`Simulation::set_state`] put them; coordinates that are not given are
    /// as the declaration starts them, else zero, those of motors what their courses say now, and where joints close loops what closes them: see
    /// [`place_declared`](mbd_scene::place_declared). A generated model `Rig` has a `RigStart` with a field for each coordinate.
    ///
    /// # Errors
    /// A name that is no joint coordinate; one that others decide; loops that cannot close.
    pub fn set_joints(&mut self, given: &[(&str, f64)]) -> Result<(), RunError> {
        T::give_joints(self, given)
    }

    /// Gives positions of the nodes (3 each) to start their search from; those of `rate` nodes are taken as they are, whatever z is.
    ///
    /// # Errors
    /// A number that is not finite, or a wrong length.
    pub fn set_nodes(&mut self, guess: &[T]) -> Result<(), RunError> {
        T::give_nodes(self, guess)
    }

    /// Makes the start consistent: corrects bodies so that the joints hold (the state that was set chooses the branch), places the nodes, decides the
    /// mode of every line, evaluates the first rates. [`Simulation::run`] calls it when nobody has.
    ///
    /// # Errors
    /// Joints that cannot be satisfied together, or only on a branch they do not mean; no equilibrium of a node; rates that are not finite.
    pub fn start(&mut self) -> Result<(), RunError> {
        T::begin(self)
    }

    /// Runs until a time [s].
    ///
    /// # Errors
    /// What [`StepError`] lists; the state is the last accepted step. A time before that of the state cannot be reached.
    pub fn run(&mut self, until: f64) -> Result<Stop, RunError> {
        T::drive(self, until, None, &mut |_| true)
    }

    /// Runs until a time [s] and records rows; after an error the rows so far are kept.
    ///
    /// # Errors
    /// As [`Simulation::run`].
    pub fn record(&mut self, until: f64, trajectory: &mut Trajectory) -> Result<Stop, RunError> {
        T::drive(self, until, Some(trajectory), &mut |_| true)
    }

    /// Runs until a time [s] or until `go_on`, called with the time of every accepted step, returns false.
    ///
    /// # Errors
    /// As [`Simulation::run`], and [`StepError::Cancelled`].
    pub fn run_while(
        &mut self,
        until: f64,
        trajectory: Option<&mut Trajectory>,
        go_on: &mut dyn FnMut(f64) -> bool,
    ) -> Result<Stop, RunError> {
        T::drive(self, until, trajectory, go_on)
    }

    /// One accepted step.
    ///
    /// # Errors
    /// As [`Simulation::run`].
    pub fn step(&mut self) -> Result<(), RunError> {
        T::take_step(self)
    }

    /// Everything needed to go on from here later, in this process or another.
    #[must_use]
    pub fn snapshot(&self) -> Snapshot<T> {
        T::save(self)
    }

    /// Continues from a snapshot of the same model with the same options: every later step is equal to the bit.
    ///
    /// # Errors
    /// A snapshot of another model or method, after which the run is as it was; and what the first evaluation may return.
    pub fn restore(&mut self, snapshot: &Snapshot<T>) -> Result<(), RunError> {
        T::continue_from(self, snapshot)
    }
}

impl<T: Scalar> Generic<T> {
    /// A model of `scene` with `params` (SI, declaration order).
    ///
    /// # Errors
    /// The first parameter that cannot be run.
    pub fn new(scene: Scene, params: &[T]) -> Result<Self, ParamError> {
        T::make_generic(scene, params)
    }

    /// A model of `scene` with the declared defaults.
    ///
    /// # Errors
    /// The first parameter that cannot be run.
    pub fn with_defaults(scene: Scene) -> Result<Self, ParamError> {
        let params: Vec<T> = scene
            .params
            .iter()
            .map(|param| T::from_f64(param.default))
            .collect();
        Self::new(scene, &params)
    }
}

impl<T: Scalar> Model<T> for Generic<T> {
    fn share(&self) -> Arc<dyn Model<T>> {
        Arc::new(self.clone())
    }

    fn with_params(&self, params: &[T]) -> Result<Arc<dyn Model<T>>, ParamError> {
        Ok(Arc::new(T::change_generic(self, params)?))
    }

    fn work(&self) -> Work<T> {
        T::make_work(self)
    }

    fn scene(&self) -> &Scene {
        &self.scene
    }

    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn params(&self) -> &[T] {
        &self.params
    }

    fn lines(&self) -> &[LineNumbers<T>] {
        &self.numbers.lines
    }

    fn evaluate(&self, what: Quantity, at: &At<'_, T>, work: &mut Work<T>, out: &mut [T]) {
        T::run_laws(self, what, at, work, out);
    }
}

impl<T: Scalar> Linearisation<T> {
    /// Linearises at `at`, whose node unknowns solve the balance, as those of [`Simulation::nodes`](crate::Simulation::nodes) do.
    ///
    /// Parameters of node lines enter K_e and L_e as they enter K and L0.
    ///
    /// # Errors
    /// [`LinearisationError`]; the numbers then mean nothing.
    pub fn evaluate(
        &mut self,
        model: &dyn Model<T>,
        at: &At<'_, T>,
        work: &mut Work<T>,
    ) -> Result<(), LinearisationError> {
        T::linearise(self, model, at, work)
    }
}
