//! The system of bodies and joints at one instant, and its solution in the order that was planned.

mod articulated;
mod assemble;
mod constraint;
mod factored;
mod reference;
mod system;

pub(crate) use articulated::{factored, sparse_dot};
pub(crate) use constraint::{Constraints, common_fall, enter, kept_parts, reaction};
pub(crate) use factored::factored_len;
pub(crate) use system::BlockSystem;
