//! The words of a scene that everything else is written in: places and parts, axes, dimensions, formulas, quantities.

mod angular_velocity;
mod axis;
mod coordinate;
mod cost;
mod coupling;
pub(crate) mod dimension;
mod field;
mod formula;
pub(crate) mod motion;
mod part;
mod plane;
mod quantity;
mod row_set;
mod table;

pub use angular_velocity::AngularVelocity;
pub use axis::Axis;
pub(crate) use coordinate::angle_about;
pub use coordinate::{Coordinate, Measure};
pub use cost::Cost;
pub use coupling::{Coupled, MOST_COUPLED, Relation};
pub use dimension::{Dimension, Unit, twelve_digits};
pub use field::{Field, Fields, Rule};
pub use formula::{EnergyKind, Fixed, Formula, Function, Place};
pub use motion::{FrameMotion, Pose, Relative, Twist};
pub use part::Part;
pub use plane::{Directions, Plane};
pub use quantity::{Arguments, At, Differentiated, LINE_NUMBERS, Quantity, Variable};
pub use row_set::RowSet;
pub use table::{SecondArgument, Table};
