//! What a multibody scene is, and the laws of mechanics that hold in it.
//!
//! - [`Scene`] is everything a declaration says, resolved to indices and SI numbers.
//! - [`Layout`] says where everything lives in the state and in the other lists of numbers.
//! - [`Quantity`] is what a model can be asked for, [`At`] where.
//! - [`Real`] is the scalar of every law: the same function runs on `f64`, on dual numbers and on symbols.
//! - [`laws`] holds the laws, each written once.
//!
//! This crate knows no tokens and does no input or output.

mod cost;
mod dual;
mod elimination;
mod few;
mod fingerprint;
mod formula;
mod jet;
pub mod joints;
pub mod laws;
mod layout;
mod lines;
mod model;
mod packed;
mod params;
mod plane;
mod quantity;
mod real;
mod redundancy;
mod scene;

pub use cost::Cost;
pub use dual::Dual;
pub use elimination::{Below, Carrying, Elimination, Order, Part, Step};
pub use fingerprint::fingerprint;
pub use formula::{Formula, Function, Place};
pub use jet::Jet;
pub use joints::{
    Along, Axis, ConstantAngle, ConstantVelocity, Cylindrical, Distance, Free, Gear, Hinge,
    JointLaw, Planar, PointOnLine, PointOnPlane, Prismatic, Rigid, Screw, Side, Spherical,
    Universal,
};
pub use layout::{
    Anchor, InputSlots, InputSource, JointSlots, Layout, LineEnd, LineSlots, Network, Node, Plan,
    PointSlots, Slots, StopSlots,
};
pub use lines::LineKind;
pub use model::{Model, Work};
pub use packed::Packed;
pub use params::{ParamError, check_params, checked_numbers};
pub use plane::{Directions, Plane};
pub use quantity::{Arguments, At, Differentiated, Quantity, Variable};
pub use real::{Float, Real, TINY};
pub use redundancy::{Apart, HeldMotor, Redundancy, Repeat, RowSet};
pub use scene::{
    AngularVelocity, Body, Clamp, Constant, Coordinates, Difference, Dimension, Direction, Event,
    Frame, Gravity, Inertia, Input, Joint, Line, Load, LoadKind, NodeModel, Output, Parameter,
    Point, PointKind, Scene, Table, Triple, Unit,
};
