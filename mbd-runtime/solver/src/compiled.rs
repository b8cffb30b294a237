//! What is compiled once: the doors through which a user's crate enters the solvers of this one.
//!
//! A generic function is compiled again in every crate that calls it. What stands behind these doors is compiled here, for `f64` and (a feature) `f32`,
//! so that a crate with a model compiles its equations and nothing else. A method that only reads a field needs no door.

use std::sync::Arc;

use mbd_scene::laws::LineNumbers;
use mbd_scene::{At, Float, Layout, Model, ParamError, Quantity, Scene, StartNumber, Work};

use crate::__private::{Declared, Lines};
use crate::error::RunError;
use crate::event::Happening;
use crate::generic::Generic;
use crate::inverse::Efforts;
use crate::lanes::Together;
use crate::linearise::{Linearisation, LinearisationError, StateSpace};
use crate::options::Options;
use crate::simulation::{Course, Given, Handover, ModelRun, Simulation, Snapshot, Stop};
use crate::supply::{self, InputNumbers, Inputs, Law, Params, Sample};
use crate::system::External;
use crate::trajectory::Trajectory;
use crate::trim::{TrimError, TrimProblem, Trimmed};

/// Declares every door once: the name that the public method calls, and the function behind it.
macro_rules! doors {
    ($(fn $name:ident($($argument:ident: $given:ty),*) -> $result:ty = $path:expr;)*) => {
        /// A scalar that the solvers of this crate are compiled for: `f64`, and with the feature `f32` (on unless `default-features = false`) `f32`.
        #[diagnostic::on_unimplemented(
            message = "the solvers are not compiled for `{Self}`",
            note = "they are compiled for f64, and for f32 with the feature `f32` of mbd-runtime"
        )]
        pub trait Scalar: Float {
            $(
                #[doc(hidden)]
                fn $name($($argument: $given),*) -> $result;
            )*
        }

        doors!(f64, $(fn $name($($argument: $given),*) -> $result = $path;)*);
        #[cfg(feature = "f32")]
        doors!(f32, $(fn $name($($argument: $given),*) -> $result = $path;)*);
    };
    ($scalar:ty, $(fn $name:ident($($argument:ident: $given:ty),*) -> $result:ty = $path:expr;)*) => {
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
    fn make_simulation(model: Arc<dyn Model<Self>>, options: Options, controls: Vec<Law<Self>>) -> Result<Simulation<Self>, RunError> = Simulation::make;
    fn drive(run: &mut ModelRun<Self>, until: f64, trajectory: Option<&mut Trajectory>, go_on: &mut dyn FnMut(f64) -> bool) -> Result<Stop, RunError> = ModelRun::drive;
    fn set_course(run: &mut ModelRun<Self>, until: f64) -> Result<Course, RunError> = ModelRun::set_course;
    fn follow(run: &mut ModelRun<Self>, course: &mut Course, trajectory: &mut Option<&mut Trajectory>, go_on: &mut dyn FnMut(f64) -> bool) -> Result<Option<Stop>, RunError> = ModelRun::follow;
    fn together(model: &dyn Model<Self>, width: usize) -> Option<Box<dyn Together<Self>>> = crate::lanes::together;
    fn take_step(run: &mut ModelRun<Self>) -> Result<(), RunError> = ModelRun::take_step;
    fn begin(run: &mut ModelRun<Self>) -> Result<(), RunError> = ModelRun::start_now;
    fn look_at_output(run: &mut ModelRun<Self>, name: &str) -> Result<Self, RunError> = ModelRun::look_at_output;
    fn look(run: &mut ModelRun<Self>, what: Quantity, out: &mut [Self]) -> Result<(), RunError> = ModelRun::look;
    fn give_state(run: &mut ModelRun<Self>, time: f64, state: &[Self]) -> Result<(), RunError> = ModelRun::give_state;
    fn give_nodes(run: &mut ModelRun<Self>, guess: &[Self]) -> Result<(), RunError> = ModelRun::give_nodes;
    fn give_turns(run: &mut ModelRun<Self>, given: &[(&str, f64)]) -> Result<(), RunError> = ModelRun::give_turns;
    fn give_joints(run: &mut ModelRun<Self>, given: &[(&str, StartNumber)]) -> Result<(), RunError> = ModelRun::give_joints;
    fn give_joint(run: &mut ModelRun<Self>, name: &str, said: StartNumber) -> Result<(), RunError> = ModelRun::give_joint;
    fn give_params(run: &mut ModelRun<Self>, of: Result<(), ParamError>, params: &[Self]) -> Result<(), RunError> = ModelRun::give_params;
    fn give_inputs(run: &mut ModelRun<Self>, of: Option<(&'static str, [usize; 2])>, numbers: &[Self]) -> Result<(), RunError> = ModelRun::give_inputs;
    fn give_rest(run: &mut ModelRun<Self>, rest: &Trimmed) -> Result<(), RunError> = ModelRun::give_rest;
    fn add_control(run: &mut ModelRun<Self>, of: Option<(&'static str, [usize; 2])>, every: Option<f64>, law: Law<Self>) -> Result<(), RunError> = ModelRun::add_control;
    fn continue_from(run: &mut ModelRun<Self>, snapshot: &Snapshot<Self>) -> Result<(), RunError> = ModelRun::continue_from;
    fn go_on_from(run: &mut ModelRun<Self>, last: &mut ModelRun<Self>, given: Given<'_, Self>) -> Result<Handover, RunError> = ModelRun::go_on_from;
    fn hand_params(run: &mut ModelRun<Self>, event: usize, next: &Scene, params: &mut [Self]) -> Result<(), RunError> = ModelRun::hand_params;
    fn save(run: &ModelRun<Self>) -> Snapshot<Self> = ModelRun::save;
    fn name_event(run: &ModelRun<Self>, what: Happening) -> String = ModelRun::name_event;
    fn make_generic(scene: Scene, params: &[Self]) -> Result<Generic<Self>, ParamError> = Generic::make;
    fn change_generic(model: &Generic<Self>, params: &[Self]) -> Result<Generic<Self>, ParamError> = Generic::change;
    fn make_work(model: &Generic<Self>) -> Work<Self> = <Generic<Self>>::scratch;
    fn run_laws(model: &Generic<Self>, what: Quantity, at: &At<'_, Self>, work: &mut Work<Self>, out: &mut [Self]) -> () = <Generic<Self>>::run;
    fn linearise(total: &mut Linearisation<Self>, model: &dyn Model<Self>, at: &At<'_, Self>, work: &mut Work<Self>) -> Result<(), LinearisationError> = Linearisation::run_given;
    fn make_space(model: &dyn Model<Self>, at: (f64, &[f64], &[f64]), along: &[&str]) -> Result<StateSpace, LinearisationError> = StateSpace::of_model;
    fn space_here(run: &mut ModelRun<Self>, along: &[&str]) -> Result<StateSpace, LinearisationError> = ModelRun::space_here;
    fn find_trim(model: &dyn Model<Self>, asked: &TrimProblem) -> Result<Trimmed, TrimError> = crate::trim::find;
    fn find_efforts(model: &dyn Model<Self>, at: (f64, &[f64], &[f64]), given: &[(&str, f64)]) -> Result<Efforts, LinearisationError> = crate::inverse::find;
    fn set_bodies(declared: &Declared, from: (&[Self], Self, &[Self]), bodies: &[Self], state: &mut [Self]) -> () = crate::__private::set_bodies;
    fn prepare(scene: &Scene, params: &[Self]) -> Result<Lines<Self>, ParamError> = crate::__private::prepare;
}

/// Joint coordinates that are set one by one. A generated model `Rig` brings the trait `RigJoints`, with a function for each of them:
/// `run.set_pin_angle(0.5)`.
pub trait JointSetter {
    /// Places bodies by one more joint coordinate, or its rate, by its name [m or rad, and per second]: it holds together with those that were set since
    /// the run last moved or was given a state.
    ///
    /// # Errors
    /// As [`Simulation::set_joints`]; what was set before stays as it was.
    fn set_joint(&mut self, name: &str, said: StartNumber) -> Result<(), RunError>;
}

impl<T: Scalar> JointSetter for Simulation<T> {
    fn set_joint(&mut self, name: &str, said: StartNumber) -> Result<(), RunError> {
        T::give_joint(&mut self.run, name, said)
    }
}

impl<T: Scalar> Simulation<T> {
    /// A simulation of a model, at its declared start, which is at rest at the origin where nothing is declared,
    /// until [`Simulation::set_state`]; its inputs have their declared defaults until
    /// [`Simulation::set_inputs`], [`Simulation::control`] or [`Simulation::control_every`]. It owns what it runs: a [shared](Model::share) model.
    ///
    /// External loads and external gravity have no default: a run that nobody gives them does not start.
    ///
    /// # Errors
    /// An option that cannot be used, or a combination of method and model that is not offered.
    pub fn new(model: &(impl Model<T> + ?Sized), options: Options) -> Result<Self, RunError> {
        T::make_simulation(model.share(), options, Vec::new())
    }

    /// A simulation of a scene that is not compiled, with its inputs as functions of time and state.
    ///
    /// # Errors
    /// An option that cannot be used, or a combination of method and model that is not offered.
    pub fn with_loads(
        model: &(impl Model<T> + ?Sized),
        options: Options,
        loads: impl External<T> + Send + 'static,
    ) -> Result<Self, RunError> {
        let mut controls: Vec<Law<T>> = Vec::new();
        if loads.supplies() {
            controls.push(supply::external(loads));
        }
        T::make_simulation(model.share(), options, controls)
    }

    /// Holds inputs from now on, until others are given; the next step sees them from its first stage on. Controllers that are called later start from
    /// them.
    ///
    /// ```
    /// use mbd_runtime::{Options, Simulation, model};
    ///
    /// model! {
    ///     /// A mass that is pushed.
    ///     model Cart {
    ///         gravity: none;
    ///         emit: [derivative];
    ///         input push: force = 4 N;
    ///         point cart { mass: 2.0 kg }
    ///         load by_hand on cart = [push, 0.0, 0.0];
    ///     }
    /// }
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let cart = Cart::new(CartParams::default())?;
    /// let mut simulation = Simulation::new(&cart, Options::rk4(0.1))?;
    /// simulation.run(1.0)?; // the declared 4 N
    /// simulation.set_inputs(&CartInputs { push: -4.0 })?;
    /// simulation.run(2.0)?; // −4 N
    ///
    /// // 2 m/s² for 1 s, then −2 m/s²: at rest, 2 m further.
    /// let cart = CartState::from_slice(simulation.state()).expect("the state of a cart").cart();
    /// assert!(cart.velocity[0].abs() < 1e-12 && (cart.position[0] - 2.0).abs() < 1e-12);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// The inputs of another model; a list of another length; the first input that is not finite. The run keeps what it had.
    pub fn set_inputs<I: Inputs<T>>(&mut self, inputs: &I) -> Result<(), RunError> {
        T::give_inputs(&mut self.run, I::MODEL, inputs.numbers().as_ref())
    }

    /// Inputs as a function of time and state, for feedback without delay: it is handed what is held, and changes of it what it likes. Several are
    /// called in the order in which they were given.
    ///
    /// It is evaluated at every stage of a step, also at trial states that are rejected: it depends on nothing but its arguments.
    ///
    /// ```
    /// use mbd_runtime::{Options, PointState, Simulation, model};
    ///
    /// model! {
    ///     /// A mass that is pushed.
    ///     model Cart {
    ///         gravity: none;
    ///         emit: [derivative];
    ///         input push: force;
    ///         point cart { mass: 2.0 kg }
    ///         load by_hand on cart = [push, 0.0, 0.0];
    ///     }
    /// }
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let cart = Cart::new(CartParams::default())?;
    /// let mut simulation = Simulation::new(&cart, Options::tsit5(1e-10))?;
    /// let mut start = CartState::at_origin();
    /// start.set_cart(PointState { position: [1.0, 0.0, 0.0], velocity: [0.0; 3] });
    /// simulation.set_state(0.0, &start.to_vec())?;
    /// // A spring of 8 N/m made of feedback: ω = 2 rad/s.
    /// simulation.control(|sample, inputs: &mut CartInputs| {
    ///     inputs.push = -8.0 * sample.state().cart().position[0];
    /// })?;
    /// simulation.run(3.0)?;
    /// assert!((simulation.state()[0] - 6.0_f64.cos()).abs() < 1e-8);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// The inputs of another model; a model without inputs; a method that solves with derivatives of the rates, which a function has none of. A number
    /// that is not finite stops the run, by the name of its input.
    pub fn control<I: Inputs<T> + 'static>(
        &mut self,
        law: impl Fn(&Sample<'_, I, T>, &mut I) + Send + 'static,
    ) -> Result<(), RunError> {
        T::add_control(&mut self.run, I::MODEL, None, supply::law(law))
    }

    /// A controller with a sampling period [s]: it is called with the state at each sample, and what it gives is held until the next.
    ///
    /// The samples are at t0 + k·period for k = 0, 1, … to the bit, t0 the time of the start: that of [`Simulation::set_state`], or now in a run that
    /// is under way. The integrator lands on them; a fixed step that does not divide the period is cut short there, an adaptive one goes on with the
    /// size it had. At the end of a run that falls on a sample the controller is called when the run goes on. It is handed the inputs that are held,
    /// with what controllers given before it changed at the same instant. What it remembers is its own: a closure may own a filter or an observer.
    ///
    /// ```
    /// use mbd_runtime::{Options, PointState, Simulation, model};
    ///
    /// model! {
    ///     /// A mass that is pushed.
    ///     model Cart {
    ///         gravity: none;
    ///         emit: [derivative];
    ///         input push: force;
    ///         point cart { mass: 2.0 kg }
    ///         load by_hand on cart = [push, 0.0, 0.0];
    ///     }
    /// }
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let cart = Cart::new(CartParams::default())?;
    /// let mut simulation = Simulation::new(&cart, Options::rk4(1e-3))?;
    /// let mut start = CartState::at_origin();
    /// start.set_cart(PointState { position: [1.0, 0.0, 0.0], velocity: [0.0; 3] });
    /// simulation.set_state(0.0, &start.to_vec())?;
    /// // Deadbeat: two samples of 0.1 s take a mass of 2 kg to the origin and stop it.
    /// let period = 0.1;
    /// simulation.control_every(period, move |sample, inputs: &mut CartInputs| {
    ///     let cart = sample.state().cart();
    ///     inputs.push = -2.0 * (cart.position[0] / period + 1.5 * cart.velocity[0]) / period;
    /// })?;
    /// simulation.run(0.2)?;
    /// assert!(simulation.state()[0].abs() < 1e-12 && simulation.state()[3].abs() < 1e-11);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// The inputs of another model; a model without inputs; a period that is not positive, or shorter than time resolves (a run until a time refuses one
    /// that asks for more than 1e9 samples). A number that is not finite stops the run, by the name of
    /// its input.
    pub fn control_every<I: Inputs<T> + 'static>(
        &mut self,
        period: f64,
        law: impl FnMut(&Sample<'_, I, T>, &mut I) + Send + 'static,
    ) -> Result<(), RunError> {
        T::add_control(&mut self.run, I::MODEL, Some(period), supply::law(law))
    }

    /// Changes the parameters of a run: `simulation.set_params(&CartParams { mass: 2.0, ..Default::default() })`, or a list of them (declaration order, SI).
    /// Nothing is built anew: time and state stay, and [`Simulation::start`] makes them consistent with the new values before the next step: bodies back
    /// on their joints, nodes in balance, lines slack or taut. What has not begun, and was given no state, starts as the declaration and
    /// [`Simulation::set_joints`] say with the new values. From here on the run is the one that was made with them, to the bit, its tolerances included.
    ///
    /// # Errors
    /// [`StepError::Params`](crate::StepError::Params): the params of another model; the first parameter that cannot be run. Joint coordinates that were
    /// set and cannot be with the new values. The run keeps the old ones.
    pub fn set_params<P: Params<T> + ?Sized>(&mut self, params: &P) -> Result<(), RunError> {
        let checked = P::check_model(self.model().scene());
        T::give_params(&mut self.run, checked, params.values().as_ref())
    }

    /// The name of an event: that of the declaration, or the line and what it became.
    #[must_use]
    pub fn event_name(&self, what: Happening) -> String {
        T::name_event(&self.run, what)
    }

    /// Evaluates a quantity at the last accepted step; `out` has the length `Layout::len`. Of matrices only non-zeros are written.
    ///
    /// # Errors
    /// A slice of another length; what a generated model does not emit (`emit`); what does not follow from where the run stands, as inverse dynamics, which
    /// are asked with accelerations ([`At::rows`]); no equilibrium of a node.
    pub fn evaluate(&mut self, what: Quantity, out: &mut [T]) -> Result<(), RunError> {
        T::look(&mut self.run, what, out)
    }

    /// An output at the last accepted step by the name of its column, `bend`, `tip.x`, `both[0]`, in the unit that it is declared in.
    /// What it was on the way is a column of what [`Simulation::record`] records.
    ///
    /// # Errors
    /// A name that is no output; an output that is not emitted, or has no finite value here; no equilibrium of a node.
    ///
    /// ```
    /// use mbd_runtime::{Options, Simulation, model};
    ///
    /// model! {
    ///     /// A stone that falls.
    ///     model Stone {
    ///         gravity: [0.0, 0.0, -10.0] m/s^2;
    ///         emit: [derivative, outputs];
    ///         point stone { mass: 1.0 kg, start at [0.0, 0.0, 5.0] m }
    ///         output height = stone.position.z in mm;
    ///     }
    /// }
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let stone = Stone::new(StoneParams::default())?;
    /// let mut simulation = Simulation::new(&stone, Options::tsit5(1e-9))?;
    /// simulation.run(0.8)?;
    /// let height = simulation.output("height")?;
    /// assert!((height - 1800.0).abs() < 1e-9);
    /// let error = simulation.output("heigth").unwrap_err().to_string();
    /// assert!(error.contains("did you mean `height`?"), "{error}");
    /// # Ok(())
    /// # }
    /// ```
    pub fn output(&mut self, name: &str) -> Result<T, RunError> {
        T::look_at_output(&mut self.run, name)
    }

    /// Sets time [s] and state x = [q | v | z | s]: another run begins, without the [events](Simulation::events) and the
    /// [actions](Simulation::actions) of the one before. `rate` nodes are placed by [`Simulation::start`] where z is all zero. Quaternions are normalised.
    ///
    /// # Errors
    /// A number that is not finite, a quaternion off unit length by more than 1e-3, or a wrong length.
    pub fn set_state(&mut self, time: f64, state: &[T]) -> Result<(), RunError> {
        T::give_state(&mut self.run, time, state)
    }

    /// Places bodies by joint coordinates, by their names: `run.set_joints(&[("pin.angle", 0.5), ("pin.angle_rate", 1.0)])` [m or rad, and per second].
    /// As by [`Simulation::set_state`], another run begins. Bodies that no joint ties to the world, or to another body, stay where [`Simulation::set_state`] put them; coordinates that are not given are
    /// as the declaration starts them, else zero, those of motors what their courses say now, and where joints close loops what closes them: see
    /// [`place_declared`](mbd_scene::place_declared). A generated model `Rig` has a `RigStart` with a field for each coordinate.
    ///
    /// A number stands for [`StartNumber::Exact`]; where a loop need not close with it to the digit, `("hip.angle", StartNumber::About(1.7))` takes the
    /// nearest that it closes with. [`Simulation::started_about`] tells what that is, [`Simulation::start_undecided`] what nothing decides.
    ///
    /// # Errors
    /// A name that is no joint coordinate; one that others decide; loops that cannot close.
    pub fn set_joints<N: Into<StartNumber> + Copy>(
        &mut self,
        given: &[(&str, N)],
    ) -> Result<(), RunError> {
        let given: Vec<(&str, StartNumber)> =
            given.iter().map(|(name, x)| (*name, (*x).into())).collect();
        T::give_joints(&mut self.run, &given)
    }

    /// Says next to which values the angles of joints begin [rad], of those whose turns are counted and the state tells up to full turns:
    /// `run.set_turns(&[("pin.angle", 9.0)])`. [`Simulation::set_joints`] does it by itself, [`Simulation::set_state`] begins next to declared starts.
    ///
    /// # Errors
    /// A name that is no joint coordinate.
    pub fn set_turns(&mut self, given: &[(&str, f64)]) -> Result<(), RunError> {
        T::give_turns(&mut self.run, given)
    }

    /// The linear system about where the run stands, with its inputs and the turns that its angles have; `along` names coordinates that are to stand before all
    /// others. It does not change the run.
    ///
    /// # Errors
    /// As [`linearise`].
    pub fn linearise(&mut self, along: &[&str]) -> Result<StateSpace, LinearisationError> {
        T::space_here(&mut self.run, along)
    }

    /// Gives positions of the nodes (3 each) to start their search from; those of `rate` nodes are taken as they are, whatever z is.
    ///
    /// # Errors
    /// A number that is not finite, or a wrong length.
    pub fn set_nodes(&mut self, guess: &[T]) -> Result<(), RunError> {
        T::give_nodes(&mut self.run, guess)
    }

    /// Makes the start consistent: corrects bodies so that the joints hold (the state that was set chooses the branch), places the nodes, decides the
    /// mode of every line, evaluates the first rates. [`Simulation::run`] calls it when nobody has.
    ///
    /// # Errors
    /// Joints that cannot be satisfied together, or only on a branch they do not mean; no equilibrium of a node; rates that are not finite.
    pub fn start(&mut self) -> Result<(), RunError> {
        T::begin(&mut self.run)
    }

    /// Runs until a time [s].
    ///
    /// # Errors
    /// What [`StepError`] lists; the state is the last accepted step. A time before that of the state cannot be reached.
    pub fn run(&mut self, until: f64) -> Result<Stop, RunError> {
        T::drive(&mut self.run, until, None, &mut |_| true)
    }

    /// Runs until a time [s] and records rows; after an error the rows so far are kept. A history that has rows goes on from where its run ended; before
    /// another run [`clear`](Trajectory::clear) it.
    ///
    /// # Errors
    /// As [`Simulation::run`]; a history of another model, or of a run that ended later than this one stands.
    pub fn record(&mut self, until: f64, trajectory: &mut Trajectory) -> Result<Stop, RunError> {
        T::drive(&mut self.run, until, Some(trajectory), &mut |_| true)
    }

    /// Runs until a time [s] or until `go_on`, called with the time of every accepted step and of every row inside a step, returns false. A
    /// run that is cancelled at a row inside a step stands before that step, with the rows up to there.
    ///
    /// # Errors
    /// As [`Simulation::run`], and [`StepError::Cancelled`].
    pub fn run_while(
        &mut self,
        until: f64,
        trajectory: Option<&mut Trajectory>,
        go_on: &mut dyn FnMut(f64) -> bool,
    ) -> Result<Stop, RunError> {
        T::drive(&mut self.run, until, trajectory, go_on)
    }

    /// One accepted step.
    ///
    /// # Errors
    /// As [`Simulation::run`].
    pub fn step(&mut self) -> Result<(), RunError> {
        T::take_step(&mut self.run)
    }

    /// Goes on where a run of another model stands: bodies, points with mass, `rate` nodes and declared states of the same name are where they are,
    /// inputs are held and lines and joints are detached as there; what this model has not is dropped. What it has besides starts where `given` says
    /// (position, attitude, velocity, angular velocity of a body, in the order and the axes of the state), or where it is declared. Starts this run.
    ///
    /// ```
    /// use mbd_runtime::{Options, Simulation, model};
    ///
    /// model! {
    ///     /// A capsule with its heat shield.
    ///     model Both {
    ///         gravity: [0.0, 0.0, -9.81] m/s^2;
    ///         emit: [derivative];
    ///         point capsule { mass: 80 kg, start at [0.0, 0.0, 100.0] m }
    ///         point shield { mass: 20 kg, start at [0.0, 0.0, 99.0] m }
    ///         event separated = capsule.position.z falls 50 m { then: stop }
    ///     }
    /// }
    ///
    /// model! {
    ///     /// The capsule without it.
    ///     model Alone {
    ///         gravity: [0.0, 0.0, -9.81] m/s^2;
    ///         emit: [derivative];
    ///         point capsule { mass: 80 kg }
    ///     }
    /// }
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let (both, alone) = (Both::new(BothParams::default())?, Alone::new(AloneParams::default())?);
    /// let mut first = Simulation::new(&both, Options::rk4(0.1))?;
    /// first.run(10.0)?;
    /// let mut second = Simulation::new(&alone, Options::rk4(0.1))?;
    /// let handover = second.take_over(&mut first, &[])?;
    /// assert_eq!((handover.carried, handover.dropped), (vec!["capsule".to_owned()], vec!["shield".to_owned()]));
    /// assert!((second.state()[2] - 50.0).abs() < 1e-9);
    /// // 20 kg went with the velocity they had.
    /// let [before, after] = handover.momentum.map(|momentum| momentum[2]);
    /// assert!((after - 0.8 * before).abs() < 1e-9);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// A body or a point that is new and starts nowhere; a name or a count of `given` that does not fit; models in other planes, or with
    /// angular velocities in other axes; what a start may return.
    pub fn take_over(
        &mut self,
        last: &mut Simulation<T>,
        given: &[(&str, &[T])],
    ) -> Result<Handover, RunError> {
        let given = Given {
            numbers: given,
            event: None,
            placed: &[],
            held: &[],
        };
        T::go_on_from(&mut self.run, &mut last.run, given)
    }

    /// As [`Simulation::take_over`], after an event of the last model that names the scene of this one (`then: scene "…"`), by its index: what its
    /// `map` names begins where the map says. `placed` are the bodies and points that the state of this run places ([`Simulation::set_state`]), as a
    /// declaration would; `held` are the inputs that stay where this run holds them ([`Simulation::set_inputs`]), whatever the last one held.
    ///
    /// # Errors
    /// As [`Simulation::take_over`]; and a map that names what is not there, or of another kind.
    pub fn take_over_at(
        &mut self,
        last: &mut Simulation<T>,
        event: usize,
        placed: &[String],
        held: &[String],
    ) -> Result<Handover, RunError> {
        let given = Given {
            numbers: &[],
            event: Some(event),
            placed,
            held,
        };
        T::go_on_from(&mut self.run, &mut last.run, given)
    }

    /// Changes params of the scene that goes on after an event, in its declaration order [SI], as the `map` of the event says.
    ///
    /// # Errors
    /// A param that is mapped from a place; what the first evaluation may return.
    pub fn params_after(
        &mut self,
        event: usize,
        next: &Scene,
        params: &mut [T],
    ) -> Result<(), RunError> {
        T::hand_params(&mut self.run, event, next, params)
    }

    /// Everything needed to go on from here later, in this process or another. Of a run that has begun, by [`Simulation::start`] or a step: one of a run that
    /// stands at what was set has nothing to go on from, and is refused.
    #[must_use]
    pub fn snapshot(&self) -> Snapshot<T> {
        T::save(&self.run)
    }

    /// Continues from a snapshot of the same model with the same options: every later step is equal to the bit. What [`Simulation::events`] and
    /// [`Simulation::actions`] have of later than the snapshot is taken off these lists.
    ///
    /// # Errors
    /// A snapshot of another model or method, after which the run is as it was; and what the first evaluation may return.
    pub fn restore(&mut self, snapshot: &Snapshot<T>) -> Result<(), RunError> {
        T::continue_from(&mut self.run, snapshot)
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
        &self.lines
    }

    fn evaluate(&self, what: Quantity, at: &At<'_, T>, work: &mut Work<T>, out: &mut [T]) {
        T::run_laws(self, what, at, work, out);
    }
}

impl<T: Scalar> Linearisation<T> {
    /// Linearises at `at`, whose node unknowns solve the balance, as those of [`Simulation::nodes`](crate::Simulation::nodes) do.
    ///
    /// Derivatives by params are those of nodes that are put in balance anew: K_e and L_e of their lines vary as K, C and L0 do. What a `stepwise` node remembers
    /// of steps stays, and so does its velocity, which outputs may ask for.
    ///
    /// [`Nodes::at`](crate::node::Nodes::at) has all lists of `at`; of a scene without nodes [`At::of_state`] with [`Layout::holds`] zeros as [`At::hold`] is
    /// a state at which lines, stops and joints are as they are by themselves.
    ///
    /// # Errors
    /// [`LinearisationError`]; the numbers then mean nothing. A list of `at` that has another length than the scene reads.
    pub fn evaluate(
        &mut self,
        model: &dyn Model<T>,
        at: &At<'_, T>,
        work: &mut Work<T>,
    ) -> Result<(), LinearisationError> {
        T::linearise(self, model, at, work)
    }
}

/// The numbers of inputs, which are not those of another model.
fn own_inputs<T: Scalar, I: InputNumbers<T> + ?Sized>(
    model: &dyn Model<T>,
    inputs: &I,
) -> Result<Vec<f64>, LinearisationError> {
    let checked = supply::check_model(model, I::MODEL);
    checked.map_err(|cause| LinearisationError::Inputs(Box::new(cause)))?;
    Ok(wide(inputs.list().as_ref()))
}

/// A, B, C, D of a scene at a time [s], a state x = [q | v | z] and inputs (`ArmInputs`, or SI numbers in the order of [`Layout::inputs`]), in minimal coordinates: an
/// independent set of joint coordinates, positions and turns that is chosen and named in [`StateSpace::states`]. Nodes are put in balance; the state
/// should obey the joints and need not be at rest.
///
/// ```
/// use mbd_runtime::{linearise, model};
///
/// model! {
///     /// A pendulum of 0.5 m with a motor at its pin.
///     model Arm {
///         gravity: [0.0, 0.0, -9.81] m/s^2;
///         emit: [derivative];
///         input motor: torque;
///         body arm {
///             mass: 2.0 kg,
///             inertia: diag(0.1, 0.1, 0.01) kg*m^2,
///             frame top at [0.0, 0.0, 0.5] m,
///         }
///         joint pin: hinge from world to arm.top { axis: y, damping: 0.3 N*m*s, force: motor }
///     }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let arm = Arm::new(ArmParams::default())?;
/// // Hanging: x y z, a quaternion, six speeds.
/// let state = [0.0, 0.0, -0.5, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
/// let linear = linearise(&arm, 0.0, &state, &ArmInputs { motor: 0.0 })?;
///
/// // (I + m l²) θ̈ = −m g l θ − c θ̇ + u.
/// let inertia = 0.1 + 2.0 * 0.5 * 0.5;
/// assert_eq!(linear.states[0].name, "pin.angle");
/// assert!((linear.a[(1, 0)] + 2.0 * 9.81 * 0.5 / inertia).abs() < 1e-12);
/// assert!((linear.a[(1, 1)] + 0.3 / inertia).abs() < 1e-12);
/// assert!((linear.b[(1, 0)] - 1.0 / inertia).abs() < 1e-12);
/// let swing = &linear.vibrations()[0];
/// assert!((swing.frequency() - (9.81 / inertia).sqrt()).abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// [`LinearisationError`]: lists of another length, joints that lose rank there, nodes without a balance, bodies without mass that give a joint no inertia.
pub fn linearise<T: Scalar>(
    model: &dyn Model<T>,
    time: f64,
    state: &[T],
    inputs: &(impl InputNumbers<T> + ?Sized),
) -> Result<StateSpace, LinearisationError> {
    linearise_along(model, time, state, inputs, &[])
}

/// [`linearise`] with these coordinates before all others: `&["crank.angle"]`. Angles in absolute coordinates count turns from their declared starts and the
/// courses of their motors; [`Simulation::linearise`] knows those that a run made.
///
/// # Errors
/// As [`linearise`]; a name that is no coordinate, or that those before it decide.
pub fn linearise_along<T: Scalar>(
    model: &dyn Model<T>,
    time: f64,
    state: &[T],
    inputs: &(impl InputNumbers<T> + ?Sized),
    coordinates: &[&str],
) -> Result<StateSpace, LinearisationError> {
    let (state, inputs) = (wide(state), own_inputs(model, inputs)?);
    T::make_space(model, (time, &state, &inputs), coordinates)
}

/// Efforts [N or N m] along chosen coordinates that give them these accelerations [m/s² or rad/s²], at a time [s], a state and inputs; what is not
/// chosen moves freely. `inverse_dynamics(&model, 0.0, &state, &[], &[("pin.angle", 2.0)])`.
///
/// # Errors
/// [`LinearisationError`]; a name that is no coordinate, or that those before it decide.
pub fn inverse_dynamics<T: Scalar>(
    model: &dyn Model<T>,
    time: f64,
    state: &[T],
    inputs: &(impl InputNumbers<T> + ?Sized),
    accelerations: &[(&str, f64)],
) -> Result<Efforts, LinearisationError> {
    let (state, inputs) = (wide(state), own_inputs(model, inputs)?);
    T::find_efforts(model, (time, &state, &inputs), accelerations)
}

/// The numbers in `f64`.
fn wide<T: Scalar>(list: &[T]) -> Vec<f64> {
    list.iter().map(|x| x.to_f64()).collect()
}
