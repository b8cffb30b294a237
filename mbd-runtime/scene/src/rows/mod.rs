//! Rows: the scalar equations that joints are built from, and what they are written in: the ends of a joint and its coordinates.

mod basic;
mod coordinate;
mod ends;
mod motor;

pub use basic::{Columns, MOST_ENDS, Row, Rows, WholeRow};
pub(crate) use basic::{couple, helix, perpendicular};
pub use ends::{End, Ends, Rotation, Spin};
