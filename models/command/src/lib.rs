//! What the command line `mbd` is made of.

pub mod advice;
mod command;
pub mod describe;
pub mod extremes;
pub mod quantities;
pub mod run;
pub mod trade;

pub use command::main;
