//! Multibody dynamics compiled from a declaration: the runtime that users depend on.

pub mod node;

pub use mbd_scene as scene;
