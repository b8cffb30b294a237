//! Multibody dynamics compiled from a declaration: the runtime that users depend on.
//!
//! - [`model!`] turns a declaration into a type that implements [`Model`]; [`Generic`] runs the same scene by its laws, without compilation.
//! - [`Simulation`] integrates a model: [`Options`] choose the method, [`External`] supplies inputs and external loads, [`Trajectory`] records named
//!   columns with units, [`Snapshot`] continues a run to the bit, [`RunError`] says what went wrong in the names of the declaration.
//! - [`node`] solves the equilibrium points where lines meet; [`Linearisation`] carries derivatives through them.
//!
//! One step of a run: `simulation` tries it (`integrate`: one tableau a method, checked when the crate is built) and puts it back on the joints (`projection`), looks for slack/taut switches and
//! declared events inside it (`event`, `locate`), records it (`trajectory`) and commits state and memory together.

#[doc(hidden)]
#[path = "private.rs"]
pub mod __private;
mod columns;
mod compiled;
mod error;
mod event;
mod fallback;
mod generated;
mod generic;
mod integrate;
mod laws;
mod linearise;
mod list;
mod locate;
pub mod node;
mod options;
mod parts;
mod projection;
mod simulation;
mod system;
mod trajectory;
mod verify;
mod watch;

pub use columns::{Name, state_names};
pub use compiled::Scalar;
pub use error::{Collapse, Progress, RunError, Source, Statistics, StepError};
pub use event::{Happening, Occurrence};
pub use generated::{CoordInfo, Costs, Energy, LineState, Momentum, ParamInfo, Reaction, Wrench};
pub use generic::Generic;
pub use integrate::Scales;
pub use linearise::{Linearisation, LinearisationError, Matrix};
pub use mbd_macros::model;
pub use mbd_scene as scene;
pub use mbd_scene::{At, Cost, Float, Layout, Model, ParamError, Quantity, Real, Work};
pub use nalgebra;
pub use node::{Mode, NodeMemory};
pub use options::{Method, Options, Stabilise};
pub use parts::{BodyState, PlanarBodyState, PointState};
pub use serde;
pub use simulation::{Simulation, Snapshot, Stop};
pub use system::{External, NoLoads};
pub use trajectory::{Content, Sampling, Trajectory};
