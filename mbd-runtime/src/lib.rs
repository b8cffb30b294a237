//! Multibody dynamics compiled from a declaration: the runtime that users depend on.

mod columns;
mod error;
mod event;
mod generic;
mod integrate;
mod linearise;
mod locate;
pub mod node;
mod options;
mod simulation;
mod system;
mod trajectory;
mod watch;

pub use columns::{Name, state_names};
pub use error::{Collapse, Progress, RunError, Source, Statistics, StepError};
pub use event::{Happening, Occurrence};
pub use integrate::Scales;
pub use linearise::{Linearisation, Matrix};
pub use node::{Mode, NodeMemory};
pub use options::{Method, Options};
pub use simulation::{Simulation, Snapshot, Stop};
pub use system::{External, NoLoads};
pub use trajectory::{Content, Sampling, Trajectory};

pub use generic::{Generic, GenericWork};
pub use mbd_scene as scene;
pub use mbd_scene::{At, Float, Layout, Model, ParamError, Quantity, Real};
