//! The laws of mechanics, each written once over [`Real`](crate::Real): numbers run them, dual numbers differentiate them, symbols record them.

pub(crate) mod body;
pub mod breaks;
pub mod corners;
mod coupling;
pub(crate) mod energy;
pub(crate) mod evaluation;
pub(crate) mod forces;
pub(crate) mod formula;
pub(crate) mod gravity;
pub(crate) mod ground;
pub(crate) mod jacobian;
mod joint_ends;
pub(crate) mod joint_forces;
pub(crate) mod kinematics;
pub mod line;
pub(crate) mod mass;
pub(crate) mod measured;
pub(crate) mod node;
pub(crate) mod numbers;
pub mod of_time;
pub mod origin;
pub mod rate;
mod table;
pub(crate) mod turns;
mod winding;

pub use coupling::{Coupling, is_discontinuous};
pub use formula::norm;
pub use ground::ground;
pub(crate) use joint_ends::branch_of;
pub use joint_ends::{branch, out_of_plane, row_units};
pub use node::{Pulled, balance};
pub use numbers::{
    BodyNumbers, FrameNumbers, GravityNumbers, JointForceNumbers, LineNumbers, Numbers,
    OblateNumbers, constant, start_of, starts,
};
pub use winding::free_length;
