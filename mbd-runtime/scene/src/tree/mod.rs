//! Relative coordinates: bodies carried along a spanning tree by the coordinates of its joints.
//!
//! Everything here is in the axes of the links: the frame of a joint on the body that it carries, origin at the joint's point Q. A body that floats
//! has its own axes and its centre of mass. What a joint does is what its file says of it: `motion`, `subspace`, `bias`.

mod articulated;
mod articulated_factor;
mod assemble;
mod dependent;
mod factored;
mod grouped;
mod inertia;
mod kinematics;
mod link_axes;
mod maps;
mod reactions;
mod rows;
mod system;
mod turn;

pub(crate) use factored::factored_len;
pub(crate) use inertia::SpatialInertia;
pub(crate) use kinematics::{LinkMotion, read};
pub(crate) use link_axes::lay_axes;
pub(crate) use maps::Absolute;
pub use maps::{set_bodies, to_relative};
pub(crate) use system::TreeSystem;
