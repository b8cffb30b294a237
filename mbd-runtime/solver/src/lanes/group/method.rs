//! The method of a group: that of its runs, over lanes.

use mbd_scene::Real;

use super::super::Lanes;
use crate::integrate::{Explicit, Rosenbrock};
use crate::simulation::ModelRun;

/// A method whose steps are made in lanes.
#[allow(clippy::large_enum_variant, reason = "a group has one of them")]
pub(super) enum LaneMethod<L> {
    /// Runge–Kutta.
    Explicit(Explicit<L>),
    /// The stiff method, of runs that have no other.
    Stiff(Rosenbrock<L>),
}

/// Calls the same of either.
macro_rules! either {
    ($of:expr, $method:ident => $call:expr) => {
        match $of {
            LaneMethod::Explicit($method) => $call,
            LaneMethod::Stiff($method) => $call,
        }
    };
}

impl<L: Lanes> LaneMethod<L> {
    /// That of a run; `None` where its steps are not made in lanes.
    pub fn of(run: &ModelRun<f64>) -> Option<Self> {
        let explicit = || {
            let method = run.method.explicit()?;
            Some(LaneMethod::Explicit(method.over()))
        };
        let stiff = || {
            let method = run.method.only_implicit()?;
            Some(LaneMethod::Stiff(method.over()))
        };
        explicit().or_else(stiff)
    }

    /// Whether a run has it.
    pub fn is_that_of(&self, run: &ModelRun<f64>) -> bool {
        match self {
            LaneMethod::Explicit(_) => run.method.explicit().is_some(),
            LaneMethod::Stiff(_) => run.method.only_implicit().is_some(),
        }
    }

    /// The rates at the start of the step.
    pub fn first(&self) -> &[L] {
        either!(self, method => method.first())
    }

    /// The same to be written.
    pub fn first_mut(&mut self) -> &mut [L] {
        either!(self, method => method.first_mut())
    }

    /// The state at the end of the last attempt.
    pub fn next(&self) -> &[L] {
        either!(self, method => method.next())
    }

    /// Takes the last attempt where a mask says so.
    pub fn accept_where(&mut self, mask: <L as Real>::Mask, state: &mut [L]) {
        either!(self, method => method.accept_where(mask, state));
    }
}
