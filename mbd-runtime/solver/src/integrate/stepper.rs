//! The method of a run: an explicit one, a linearly implicit one, a symmetric one, or the first two, of which one is making the steps.

use mbd_scene::Float;

use super::{Explicit, Rates, Rattle, Reversible, Rosenbrock};
use crate::error::StepError;

/// A method of one family, with its storage.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant, reason = "a run has one or two of them")]
pub(crate) enum Family<T> {
    /// Runge–Kutta.
    Explicit(Explicit<T>),
    /// Linearly implicit, for stiff scenes.
    Implicit(Rosenbrock<T>),
    /// Symmetric in time, for long runs.
    Symmetric(Rattle<T>),
}

/// The methods of a run.
#[derive(Clone, Debug)]
pub(crate) struct Stepper<T> {
    /// The one that makes the steps.
    method: Family<T>,
    /// The one it may change to.
    other: Option<Family<T>>,
}

/// Calls the same of the method that makes the steps.
macro_rules! current {
    ($family:expr, $method:ident => $call:expr) => {
        match $family {
            Family::Explicit($method) => $call,
            Family::Implicit($method) => $call,
            Family::Symmetric($method) => $call,
        }
    };
}

impl<T: Float> Stepper<T> {
    /// The methods of a run; the first one begins.
    pub(crate) fn new(method: Family<T>, other: Option<Family<T>>) -> Self {
        Stepper { method, other }
    }

    /// Order of the error estimate plus one.
    pub(crate) fn exponent(&self) -> f64 {
        current!(&self.method, method => method.exponent)
    }

    /// The power of the error before in the controller.
    pub(crate) fn memory(&self) -> f64 {
        if self.is_stiff() { 0.3 } else { 0.4 }
    }

    /// The first stage: the rates at the start of a step, `span` after the last accepted one. Needed once, and again after anything jumped.
    pub(crate) fn begin(
        &mut self,
        system: &mut impl Reversible<T>,
        time: f64,
        span: f64,
        state: &[T],
    ) -> Result<(), StepError> {
        current!(&mut self.method, method => method.begin(system, time, span, state))
    }

    /// Derivatives at a start, so that those of later steps find their room.
    pub(crate) fn prepare(
        &mut self,
        system: &mut impl Rates<T>,
        time: f64,
        state: &[T],
    ) -> Result<(), StepError> {
        match (&mut self.method, &mut self.other) {
            (Family::Implicit(method), _) => method.differentiate(system, time, state),
            (_, Some(Family::Implicit(other))) => {
                // The method that begins has no use for them yet.
                let _ = other.differentiate(system, time, state);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// The stiff method, where that makes the steps.
    pub(crate) fn implicit(&self) -> Option<&Rosenbrock<T>> {
        match &self.method {
            Family::Implicit(method) => Some(method),
            _ => None,
        }
    }

    /// It, where there is no other.
    pub(crate) fn only_implicit(&self) -> Option<&Rosenbrock<T>> {
        self.implicit().filter(|_| self.other.is_none())
    }

    /// The same to be changed.
    pub(crate) fn only_implicit_mut(&mut self) -> Option<&mut Rosenbrock<T>> {
        match (&mut self.method, &self.other) {
            (Family::Implicit(method), None) => Some(method),
            _ => None,
        }
    }

    /// ∂f/∂x · `change` at the start of the next step of a stiff method; `None` of other methods, and where there is no derivative.
    pub(crate) fn slope_along(
        &mut self,
        system: &mut impl Rates<T>,
        (time, state): (f64, &[T]),
        change: &[T],
    ) -> Option<&[T]> {
        let Family::Implicit(method) = &mut self.method else {
            return None;
        };
        method.differentiate(system, time, state).ok()?;
        Some(method.slope_along(change))
    }

    /// Tries a step from `state`; the result is [`Stepper::next`], and `state` is untouched.
    #[inline]
    pub(crate) fn attempt(
        &mut self,
        system: &mut impl Reversible<T>,
        time: f64,
        step: f64,
        state: &[T],
    ) -> Result<(), StepError> {
        current!(&mut self.method, method => method.attempt(system, time, step, state))
    }

    /// Ends the last attempt after a part of it already, of a method whose steps cost more than what they are evaluated with; `false`: nothing is done.
    pub(crate) fn end_early(
        &mut self,
        system: &mut impl Rates<T>,
        time: f64,
        step: f64,
        state: &[T],
    ) -> Result<bool, StepError> {
        match &mut self.method {
            Family::Implicit(method) => method.end_early(system, time, step, state),
            _ => Ok(false),
        }
    }

    /// When a stage of a step is that its error depends on, by their number, in parts of it; `None` behind the last.
    pub(crate) fn stage_time(&self, number: usize) -> Option<f64> {
        match &self.method {
            Family::Explicit(method) => method.stage_time(number),
            Family::Implicit(method) => method.stage_time(number),
            Family::Symmetric(_) => None,
        }
    }

    /// The explicit method, where that makes the steps.
    pub(crate) fn explicit(&self) -> Option<&Explicit<T>> {
        match &self.method {
            Family::Explicit(method) => Some(method),
            _ => None,
        }
    }

    /// The same to be changed.
    pub(crate) fn explicit_mut(&mut self) -> Option<&mut Explicit<T>> {
        match &mut self.method {
            Family::Explicit(method) => Some(method),
            _ => None,
        }
    }

    /// What rounding took from the accepted state; empty where it is not kept.
    pub(crate) fn lost(&self) -> &[T] {
        self.explicit().map_or(&[], Explicit::lost)
    }

    /// The weights by which an explicit method adds rates to the state over a step, one after the other; empty for others.
    pub(crate) fn weights(&self) -> &[T] {
        self.explicit().map_or(&[], Explicit::weights)
    }

    /// Goes on with what rounding took from another accepted state.
    pub(crate) fn set_lost(&mut self, lost: &[T]) {
        if let Some(method) = self.explicit_mut() {
            method.set_lost(lost);
        }
    }

    /// The state at the end of the last attempt.
    #[inline]
    pub(crate) fn next(&self) -> &[T] {
        current!(&self.method, method => method.next())
    }

    /// Takes the last attempt.
    #[inline]
    pub(crate) fn accept(&mut self, state: &mut [T]) {
        current!(&mut self.method, method => method.accept(state));
    }

    /// The estimate of the error of the last attempt, and the state at its end.
    pub(crate) fn estimate(&mut self, step: f64) -> (&[T], &[T]) {
        match &mut self.method {
            Family::Explicit(method) => method.estimate(step),
            Family::Implicit(method) => method.estimate(),
            Family::Symmetric(method) => method.estimate(),
        }
    }

    /// Evaluates what the interpolant of the last attempt, which started at `state`, needs beyond the stages of the step.
    pub(crate) fn complete(
        &mut self,
        system: &mut impl Rates<T>,
        time: f64,
        step: f64,
        state: &[T],
    ) -> Result<(), StepError> {
        match &mut self.method {
            Family::Explicit(method) => method.complete(system, time, step, state),
            _ => Ok(()),
        }
    }

    /// The state at `theta` (0 … 1) of the last attempt, which started at `state`, after [`Stepper::complete`].
    pub(crate) fn interpolate(&self, theta: f64, step: f64, state: &[T], out: &mut [T]) {
        match &self.method {
            Family::Explicit(method) => method.interpolate(theta, step, state, out),
            Family::Implicit(method) => method.interpolate(theta, step, state, out),
            Family::Symmetric(method) => method.interpolate(theta, step, state, out),
        }
    }

    /// What [`Explicit::stiffness`] or [`Rattle::stiffness`] says, of the first where it is above a limit; zero of a method that is stable whatever
    /// the step.
    #[inline]
    pub(crate) fn stiffness(&self, weights: &[T], [negligible, limit]: [f64; 2]) -> f64 {
        match &self.method {
            Family::Explicit(method) => method.stiffness(weights, [negligible, limit]),
            Family::Implicit(_) => 0.0,
            Family::Symmetric(method) => method.stiffness(weights, negligible),
        }
    }

    /// Whether the linearly implicit method makes the steps.
    #[inline]
    pub(crate) fn is_stiff(&self) -> bool {
        matches!(self.method, Family::Implicit(_))
    }

    /// Whether there are two methods.
    pub(crate) fn has_both(&self) -> bool {
        self.other.is_some()
    }

    /// Goes on with the other method from the accepted state.
    pub(crate) fn change(&mut self) {
        let Some(other) = &mut self.other else {
            return;
        };
        let first = current!(&self.method, method => method.first());
        match other {
            Family::Implicit(other) => other.take_over(first),
            Family::Explicit(other) => other.first_mut().copy_from_slice(first),
            Family::Symmetric(other) => other.first_mut().copy_from_slice(first),
        }
        std::mem::swap(&mut self.method, other);
        self.set_lost(&[]);
    }

    /// Takes the method that a run was on.
    pub(crate) fn resume(&mut self, stiff: bool) {
        if let Some(other) = &mut self.other
            && stiff != matches!(self.method, Family::Implicit(_))
        {
            std::mem::swap(&mut self.method, other);
        }
    }

    /// |hλ| on the negative real axis up to which the explicit method is stable; infinite without one.
    pub(crate) fn limit(&self) -> f64 {
        match (&self.method, &self.other) {
            (Family::Explicit(method), _) | (_, Some(Family::Explicit(method))) => method.stable,
            _ => f64::INFINITY,
        }
    }

    /// Step times the largest rate of the system in the last attempt, over the limit of the explicit method.
    pub(crate) fn part_of_limit(&mut self, step: f64, weights: &[T]) -> f64 {
        let limit = self.limit();
        let rho = match (&mut self.method, &self.other) {
            (Family::Explicit(method), _) => method.rate(weights),
            (Family::Implicit(method), Some(_)) => step * method.fastest(weights),
            _ => 0.0,
        };
        rho / limit
    }

    /// How the rates of two stages at the same time differ, after [`Stepper::part_of_limit`] of an explicit method.
    pub(crate) fn differences(&self) -> &[T] {
        match (&self.method, &self.other) {
            (Family::Explicit(method), _) | (_, Some(Family::Explicit(method))) => {
                method.differences()
            }
            _ => &[],
        }
    }

    /// The rates at the start of the step, to be changed.
    pub(crate) fn first_mut(&mut self) -> &mut [T] {
        current!(&mut self.method, method => method.first_mut())
    }

    /// The rates at the start of the step.
    pub(crate) fn first(&self) -> &[T] {
        current!(&self.method, method => method.first())
    }
}
