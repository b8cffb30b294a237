//! What runs models, compiled or not: integrators, equilibrium points, projection onto joints, events, batches, derivatives.
//!
//! Users depend on `mbd-runtime`, which hands out all of this beside `model!`. It is a crate of its own so that the compiler behind `model!` and it are compiled side
//! by side.
//!
//! One step of a run: `simulation` tries it (`integrate`: one tableau a method, checked when the crate is built) and puts it back on the joints (`projection`), looks for slack/taut switches and
//! declared events inside it (`event`, `locate`), records it (`trajectory`) and commits state and memory together.

#[doc(hidden)]
#[path = "private.rs"]
pub mod __private;
mod accuracy;
mod approach;
mod balance;
mod basis;
mod batch;
mod chatter;
mod columns;
mod commands;
mod compiled;
mod content;
mod dip;
mod displace;
mod dropped_here;
mod error;
mod event;
mod fallback;
mod far_guards;
mod generated;
mod generic;
mod held_guards;
mod identity;
mod integrate;
mod inverse;
mod lanes;
mod laws;
mod linearise;
mod list;
mod locate;
mod measure;
mod metric;
mod momentum;
mod moving;
#[doc(hidden)]
pub mod node;
mod options;
mod origin;
mod parts;
mod projection;
mod rearm;
mod resolving_looks;
mod rounding;
mod row;
mod simulation;
mod slopes;
mod state_rounding;
mod step_sizes;
mod stiffness;
mod supply;
mod system;
mod trajectory;
mod trim;
mod turns;
mod unilateral;
mod verify;
mod watch;

// A model, compiled or not.
pub use generic::Generic;
pub use mbd_scene as scene;
/// What a scene with parameters can be asked for, whoever runs its equations: code that takes `&dyn Model<f64>` works with all of them.
///
/// ```
/// use mbd_runtime::scene::Arguments;
/// use mbd_runtime::{Generic, Model, Quantity, model};
///
/// model! {
///     /// A stone that falls.
///     model Stone {
///         gravity: [0.0, 0.0, -9.81] m/s^2;
///         emit: [derivative, energy];
///         param mass = 2.0 kg in 1.0 kg ..= 5.0 kg;
///         point stone { mass: mass }
///     }
/// }
///
/// /// Kinetic and gravitational energy at a state [J].
/// fn energy(model: &dyn Model<f64>, state: &[f64]) -> [f64; 2] {
///     let arguments = Arguments { state: state.to_vec(), ..Arguments::default() };
///     let mut out = vec![0.0; model.layout().len(Quantity::Energy)];
///     model.evaluate(Quantity::Energy, &arguments.at(), &mut model.work(), &mut out);
///     [out[0], out[1]]
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let generated = Stone::new(StoneParams { mass: 3.0 })?;
/// let generic = Generic::new(Stone::scene(), &[3.0])?;
/// // 10 m high, 4 m/s: ½ m v² and m g z.
/// let state = [0.0, 0.0, 10.0, 4.0, 0.0, 0.0];
/// for model in [&generated as &dyn Model<f64>, &generic] {
///     let [kinetic, gravitational] = energy(model, &state);
///     assert!((kinetic - 24.0).abs() < 1e-12);
///     assert!((gravitational - 3.0 * 9.81 * 10.0).abs() < 1e-12);
/// }
/// # Ok(())
/// # }
/// ```
#[doc(inline)]
pub use mbd_scene::Model;
#[doc(inline)]
pub use mbd_scene::{At, Float, Layout, ParamError, Quantity, Real, StartNumber, StepStages, Work};

// Its state and what it hands out.
pub use generated::{CoordInfo, Costs, Energy, LineState, Momentum, ParamInfo, Reaction, Wrench};
#[doc(inline)]
pub use mbd_scene::Cost;
pub use parts::{BodyState, JointState, PlanarBodyState, PointState};

// A run.
pub use balance::Imbalance;
pub use compiled::{JointSetter, Scalar};
pub use integrate::Scales;
pub use momentum::MomentumImbalance;
pub use options::{Method, Options, Stabilise};
pub use rounding::CoarsePositions;
pub use simulation::{Acted, Handover, Moved, PassedStop, Simulation, Snapshot, Stop};
pub use state_rounding::CoarseState;
pub use step_sizes::StepSizes;
pub use supply::{InputNumbers, Inputs, Params, Sample};
pub use system::{External, NoLoads};

// Many runs.
pub use batch::{Batch, Case, Ended, Failed as FailedCase, Finished, Onward, Tally, Why};
pub use lanes::{
    Beside, Equations, Forms, InLanes, LaneParameters, Lanes, Lanes4, Lanes8, LockStep,
};

// What it leaves.
pub use columns::{Name, state_names};
pub use content::Content;
pub use error::{Collapse, Progress, RunError, Source, Statistics, StepError, Stiff, UnevenLines};
pub use event::{Happening, Occurrence};
pub use metric::{MetricReader, MetricValue, MissingMetric, NoMetric, SINGULAR_POSITION};
pub use node::NodeMemory;
pub use trajectory::{Joined, NotFinite, Sampling, Trajectory};
pub use unilateral::{Mode, switch_names, untold_switch};
pub use watch::Instability;

// Derivatives, and what is found by them.
pub use accuracy::{
    Accurate, Advice, Deviation, Entry, FailedSetting, Question, Race, TradeError, Variant, trade,
};
pub use compiled::{inverse_dynamics, linearise, linearise_along};
pub use inverse::Efforts;
pub use linearise::{Kink, Linearisation, LinearisationError, Matrix, StateSpace, Vibration};
pub use trim::{Trim, TrimError, Trimmed, trim};

/// What the matrices of [`StateSpace`] are made of, in this version.
#[doc(no_inline)]
pub use nalgebra;

// What generated code calls.
#[doc(hidden)]
pub use serde;
