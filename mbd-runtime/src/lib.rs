//! Multibody dynamics compiled from a declaration: the runtime that users depend on.

#[doc(hidden)]
#[path = "private.rs"]
pub mod __private;
mod columns;
mod error;
mod event;
mod generated;
mod generic;
mod integrate;
mod linearise;
mod locate;
pub mod node;
mod options;
mod simulation;
mod system;
mod trajectory;
mod verify;
mod watch;

pub use columns::{Name, state_names};
pub use error::{Collapse, Progress, RunError, Source, Statistics, StepError};
pub use event::{Happening, Occurrence};
pub use generated::{CoordInfo, Energy, LineState, Momentum, ParamInfo, Wrench};
pub use generic::{Generic, GenericWork};
pub use integrate::Scales;
pub use linearise::{Linearisation, Matrix};
pub use mbd_macros::model;
pub use mbd_scene as scene;
pub use mbd_scene::{At, Cost, Float, Layout, Model, ParamError, Quantity, Real};
pub use nalgebra;
pub use node::{Mode, NodeMemory};
pub use options::{Method, Options};
pub use serde;
pub use simulation::{Simulation, Snapshot, Stop};
pub use system::{External, NoLoads};
pub use trajectory::{Content, Sampling, Trajectory};
