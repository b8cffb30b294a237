//! Integrators: a method is one tableau, everything else is shared.

mod control;
mod explicit;
mod norm;
mod resolution;
mod rk4;
mod tableau;
mod tsit5;

use crate::error::StepError;

pub(crate) use control::{Control, Verdict};
pub(crate) use explicit::Explicit;
pub(crate) use norm::ErrorNorm;
pub use norm::Scales;
pub(crate) use resolution::Resolution;
pub(crate) use rk4::RK4;
pub(crate) use tsit5::TSIT5;

/// A system of ordinary differential equations ẋ = f(t, x), as an integrator sees it.
pub(crate) trait Rates<T> {
    /// Writes ẋ. `span` is the time since the last accepted step: models that difference against it need it.
    fn rates(&mut self, time: f64, span: f64, state: &[T], out: &mut [T]) -> Result<(), StepError>;

    /// A trial step begins.
    fn enter(&mut self) {}

    /// Puts a new state back on its manifold: unit quaternions, joints that hold.
    fn project_end(&mut self, time: f64, state: &mut [T]) -> Result<(), StepError>;
}
