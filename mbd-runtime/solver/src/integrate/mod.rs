//! Integrators: a method is one tableau, everything else is shared.

mod control;
mod explicit;
mod free_motion;
mod inner_stages;
mod norm;
mod quaternions;
mod rattle;
mod resolution;
mod rk4;
mod rodas5p;
mod rosenbrock;
mod shifted;
mod stepper;
mod stiffness_test;
mod tableau;
mod tiles;
mod trees;
mod tsit5;
mod vern7;

use crate::error::StepError;

pub(crate) use control::{Control, Verdict};
pub(crate) use explicit::{Explicit, stiffness};
pub(crate) use free_motion::FreeMotion;
pub(crate) use inner_stages::INNER;
pub use inner_stages::{inner_rates, inner_stages};
pub(crate) use norm::ErrorNorm;
pub use norm::Scales;
pub(crate) use quaternions::normalise;
pub(crate) use rattle::{Rattle, Reversible};
pub(crate) use resolution::Resolution;
pub(crate) use rk4::RK4;
pub(crate) use rodas5p::RODAS5P;
pub(crate) use rosenbrock::{Rosenbrock, StiffCount};
pub(crate) use shifted::Attached;
pub(crate) use stepper::{Family, Stepper};
pub(crate) use stiffness_test::{StiffnessTest, fastest};
pub(crate) use tsit5::TSIT5;
pub(crate) use vern7::VERN7;

/// What a system made of a step in one call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Made {
    /// Nothing.
    Nothing,
    /// The stages inside it and the state at its end, which is still to be put back on its manifold.
    Inside,
    /// The same, and it is there.
    End,
    /// The last stage, too.
    Whole,
}

/// A system of ordinary differential equations ẋ = f(t, x), as an integrator sees it.
pub(crate) trait Rates<T> {
    /// Writes ẋ. `span` is the time since the last accepted step: models that difference against it need it.
    fn rates(&mut self, time: f64, span: f64, state: &[T], out: &mut [T]) -> Result<(), StepError>;

    /// The same at a place inside a step that was tried, for its interpolant: what is known of the end of the step stays.
    fn rates_inside(
        &mut self,
        time: f64,
        span: f64,
        state: &[T],
        out: &mut [T],
    ) -> Result<(), StepError> {
        self.rates(time, span, state, out)
    }

    /// Evaluates the stages inside a step of RK4 in one call, from the rates at its start, and the state at its end; where it is asked `to_end` what it can
    /// of the last stage, too.
    fn stages_at_once(
        &mut self,
        _span: [f64; 2],
        _state: &[T],
        (_rates, _next): (&mut [T], &mut [T]),
        _to_end: bool,
    ) -> Made {
        Made::Nothing
    }

    /// Writes ∂f/∂x, dense, row by row, and ∂f/∂t at the start of a step, where the rates were evaluated last.
    fn differentiate(
        &mut self,
        time: f64,
        state: &[T],
        by_state: &mut [T],
        by_time: &mut [T],
    ) -> Result<(), StepError>;

    /// The same where it is counted already: it was made elsewhere, and is asked for after all.
    fn differentiate_again(
        &mut self,
        time: f64,
        state: &[T],
        (by_state, by_time): (&mut [T], &mut [T]),
    ) -> Result<(), StepError> {
        self.differentiate(time, state, by_state, by_time)
    }

    /// The matrix of a step was factored.
    fn factored(&mut self) {}

    /// A trial step begins.
    fn enter(&mut self) {}

    /// From here on nothing is accepted or switched between the rates that are asked for; until it is said that it may be again (`false`).
    fn hold(&mut self, _nothing_changes: bool) {}

    /// Puts a new state back on its manifold: unit quaternions, joints that hold.
    fn project_end(&mut self, time: f64, state: &mut [T]) -> Result<(), StepError>;
}
