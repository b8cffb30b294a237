//! What a multibody scene is, and the laws of mechanics that hold in it.
//!
//! - [`Scene`] is everything a declaration says, resolved to indices and SI numbers.
//! - [`Layout`] says where everything lives in the state and in the other lists of numbers.
//! - [`Quantity`] is what a model can be asked for, [`At`] where.
//! - [`Real`] is the scalar of every law: the same function runs on `f64`, on dual numbers and on symbols.
//! - [`laws`] holds the laws, each written once.
//!
//! This crate knows no tokens and does no input or output.

mod columns;
mod direction;
pub mod double;
mod elimination;
mod evaluate;
mod event;
mod fingerprint;
mod held;
pub mod joints;
pub mod laws;
mod layout;
mod lines;
pub mod metrics;
mod model;
mod number;
mod packed;
mod params;
mod placement;
mod plan;
pub mod random;
mod redundancy;
pub mod rows;
mod scalar;
mod scene;
pub mod similar;
pub mod solids;
mod starts;
mod tree;
mod vocabulary;

pub use columns::each_column;
pub use direction::turns_direction;
pub use evaluate::{
    Handed, Scratch, ToldMotion, commands, evaluate, evaluate_with_multipliers, folded, handed,
    impulses, locked, masses, row_sizes, scalars, sensitivity,
};
pub use event::{
    Actions, Detachable, Direction, Event, MapSource, Mapped, Next, Settable, Setting,
};
pub use fingerprint::fingerprint;
pub use joints::{
    ConstantAngle, ConstantVelocity, Cylindrical, Distance, Free, Gear, Hinge, JointForces,
    JointLaw, Lock, Planar, PointOnLine, PointOnPlane, Prismatic, Rigid, Screw, Side, Spherical,
    Universal,
};
pub use layout::{
    Ambiguous, Anchor, Below, Carrying, Dependent, Elimination, EliminationStep, FromSolution,
    Grouped, HeldMotor, InputSlots, InputSource, JointSlots, Layout, LineEnd, LineSlots, Link,
    LinkAxes, Network, Node, Order, Plan, PointSlots, Redundancy, Repeat, Slots, StopSlots, Tree,
};
pub use lines::LineKind;
pub use model::{Model, StageInputs, StepEnd, StepStages, Work};
pub use number::{plain, significant};
pub use packed::Packed;
pub use params::{ParamError, check_params, check_tables, checked_numbers};
pub use placement::{
    AboutStart, BeyondReach, JointStart, PlacementError, PlacementReport, StartNumber,
    beyond_reach, place,
};
pub use redundancy::Apart;
#[doc(hidden)]
pub use scalar::orthogonal;
pub use scalar::{
    Dual, FUSES, Float, Jet, LARGEST_ANGLE, Real, TINY, elements, inverse, quaternion_rate,
    rotation, sin_cos_within, solve_regular, symmetric,
};
pub use scene::{
    Body, Clamp, Constant, CoordinateStart, Coordinates, Difference, Frame, Gravity, Inertia,
    Input, Joint, Let, Line, Load, LoadKind, NodeModel, Output, Parameter, PartStart, Point,
    PointKind, Scene, Starts, State, Triple,
};
pub use starts::{
    StartFrom, begin_next_to, declared_beside, declared_parts, place_bodies, place_declared,
    said_coordinates,
};
pub use tree::{set_bodies, to_relative};
pub use vocabulary::{
    AngularVelocity, Arguments, At, Axis, Coordinate, Cost, Differentiated, Dimension, Directions,
    EnergyKind, Field, Fields, Fixed, Formula, FrameMotion, Function, LINE_NUMBERS, Measure, Part,
    Place, Plane, Pose, Quantity, Relative, RowSet, Rule, SecondArgument, Table, Twist, Unit,
    Variable, twelve_digits,
};
