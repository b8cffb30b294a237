//! Multibody dynamics compiled from a declaration: the runtime that users depend on.

#[doc(hidden)]
#[path = "private.rs"]
pub mod __private;
mod generated;
mod generic;
pub mod node;
mod verify;

pub use generated::{CoordInfo, Energy, LineState, Momentum, ParamInfo, Wrench};
pub use generic::{Generic, GenericWork};
pub use mbd_macros::model;
pub use mbd_scene as scene;
pub use mbd_scene::{At, Cost, Float, Layout, Model, ParamError, Quantity, Real};
pub use nalgebra;
pub use serde;
