//! Scalars: what every law is generic over, numbers that carry derivatives, and the small algebra on them.

pub(crate) mod algebra;
mod circular;
mod dual;
mod few;
mod jet;
#[doc(hidden)]
pub mod orthogonal;
mod range;
mod real;

pub use algebra::{elements, inverse, quaternion_rate, rotation, solve_regular, symmetric};
pub use circular::{LARGEST_ANGLE, sin_cos_within};
pub use dual::Dual;
pub(crate) use few::Few;
pub use jet::{Jet, OfTime, split};
pub(crate) use range::Range;
pub use real::{FUSES, Float, Real, TINY};
