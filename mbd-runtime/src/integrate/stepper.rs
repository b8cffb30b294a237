//! The method of a run: an explicit one, a linearly implicit one, or both of which one is making the steps.

use mbd_scene::Float;

use super::{Explicit, Rates, Rosenbrock};
use crate::error::StepError;

/// The methods of a run.
#[derive(Clone, Debug)]
pub(crate) struct Stepper<T> {
    explicit: Option<Explicit<T>>,
    implicit: Option<Rosenbrock<T>>,
    /// Whether the linearly implicit one makes the steps.
    stiff: bool,
}

/// Calls the same of the method that makes the steps.
macro_rules! current {
    ($self:ident, $borrow:ident, $method:ident => $call:expr, or $none:expr) => {
        if $self.stiff {
            $self
                .implicit
                .$borrow()
                .map_or_else(|| $none, |$method| $call)
        } else {
            $self
                .explicit
                .$borrow()
                .map_or_else(|| $none, |$method| $call)
        }
    };
}

impl<T: Float> Stepper<T> {
    /// The methods of a run; where both are there, the explicit one begins.
    pub(crate) fn new(explicit: Option<Explicit<T>>, implicit: Option<Rosenbrock<T>>) -> Self {
        Stepper {
            stiff: explicit.is_none(),
            explicit,
            implicit,
        }
    }

    /// Order of the error estimate plus one.
    pub(crate) fn exponent(&self) -> f64 {
        current!(self, as_ref, method => method.exponent, or 1.0)
    }

    /// The power of the error before in the controller.
    pub(crate) fn memory(&self) -> f64 {
        if self.stiff { 0.3 } else { 0.4 }
    }

    /// The first stage: the rates at the start of a step, `span` after the last accepted one. Needed once, and again after anything jumped.
    pub(crate) fn begin(
        &mut self,
        system: &mut impl Rates<T>,
        time: f64,
        span: f64,
        state: &[T],
    ) -> Result<(), StepError> {
        current!(self, as_mut, method => method.begin(system, time, span, state), or Ok(()))
    }

    /// Tries a step from `state`; the result is [`Stepper::next`], and `state` is untouched.
    pub(crate) fn attempt(
        &mut self,
        system: &mut impl Rates<T>,
        time: f64,
        step: f64,
        state: &[T],
    ) -> Result<(), StepError> {
        current!(self, as_mut, method => method.attempt(system, time, step, state), or Ok(()))
    }

    /// The state at the end of the last attempt.
    pub(crate) fn next(&self) -> &[T] {
        current!(self, as_ref, method => method.next(), or Default::default())
    }

    /// Takes the last attempt.
    pub(crate) fn accept(&mut self, state: &mut [T]) {
        current!(self, as_mut, method => method.accept(state), or ());
    }

    /// The estimate of the error of the last attempt, and the state at its end.
    pub(crate) fn estimate(&mut self, step: f64) -> (&[T], &[T]) {
        if self.stiff {
            let method = self.implicit.as_ref();
            method.map_or((&[], &[]), Rosenbrock::estimate)
        } else {
            let method = self.explicit.as_mut();
            method.map_or((&[], &[]), |method| method.estimate(step))
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
        match &mut self.explicit {
            Some(method) if !self.stiff => method.complete(system, time, step, state),
            _ => Ok(()),
        }
    }

    /// The state at `theta` (0 … 1) of the last attempt, which started at `state`, after [`Stepper::complete`].
    pub(crate) fn interpolate(&self, theta: f64, step: f64, state: &[T], out: &mut [T]) {
        match (&self.explicit, &self.implicit) {
            (Some(method), _) if !self.stiff => method.interpolate(theta, step, state, out),
            (_, Some(method)) => method.interpolate(theta, state, out),
            _ => {}
        }
    }

    /// What [`Explicit::stiffness`] says of an explicit method.
    pub(crate) fn stiffness(&self, weights: &[T], negligible: f64) -> f64 {
        let method = self.explicit.as_ref();
        method.map_or(0.0, |method| method.stiffness(weights, negligible))
    }

    /// Whether the linearly implicit method makes the steps.
    pub(crate) fn is_stiff(&self) -> bool {
        self.stiff
    }

    /// Whether there are two methods.
    pub(crate) fn has_both(&self) -> bool {
        self.explicit.is_some() && self.implicit.is_some()
    }

    /// Goes on with the other method from the accepted state.
    pub(crate) fn change(&mut self) {
        let (Some(explicit), Some(implicit)) = (&mut self.explicit, &mut self.implicit) else {
            return;
        };
        if self.stiff {
            explicit.first_mut().copy_from_slice(implicit.first());
        } else {
            implicit.take_over(explicit.first());
        }
        self.stiff = !self.stiff;
    }

    /// Takes the method that a run was on.
    pub(crate) fn resume(&mut self, stiff: bool) {
        self.stiff = stiff;
    }

    /// |hλ| on the negative real axis up to which the explicit method is stable; infinite without one.
    pub(crate) fn limit(&self) -> f64 {
        self.explicit
            .as_ref()
            .map_or(f64::INFINITY, |method| method.stable)
    }

    /// Step times the largest rate of the system in the last attempt, over the limit of the explicit method.
    pub(crate) fn part_of_limit(&mut self, step: f64, weights: &[T]) -> f64 {
        let limit = self.limit();
        let rho = match (&mut self.explicit, &mut self.implicit) {
            (Some(method), _) if !self.stiff => method.rate(weights),
            (Some(_), Some(method)) => step * method.fastest(weights),
            _ => 0.0,
        };
        rho / limit
    }

    /// How the rates of two stages at the same time differ, after [`Stepper::part_of_limit`] of an explicit method.
    pub(crate) fn differences(&self) -> &[T] {
        let method = self.explicit.as_ref();
        method.map_or(&[], Explicit::differences)
    }

    /// The rates at the start of the step, to be changed.
    pub(crate) fn first_mut(&mut self) -> &mut [T] {
        if self.stiff {
            let method = self.implicit.as_mut();
            method.map_or(&mut [], Rosenbrock::first_mut)
        } else {
            let method = self.explicit.as_mut();
            method.map_or(&mut [], Explicit::first_mut)
        }
    }

    /// The rates at the start of the step.
    pub(crate) fn first(&self) -> &[T] {
        current!(self, as_ref, method => method.first(), or Default::default())
    }
}
