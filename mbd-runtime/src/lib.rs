//! Multibody dynamics compiled from a declaration: the runtime that users depend on.

mod generic;

pub use generic::{Generic, GenericWork};
pub use mbd_scene as scene;
pub use mbd_scene::{At, Float, Layout, Model, ParamError, Quantity, Real};
