//! One case of a batch: what it starts with, and what became of it.

use std::fmt;

use mbd_scene::{Float, ParamError, Scene};

use crate::error::{RunError, Statistics};
use crate::supply::{Inputs, Params};

/// What one run of a batch starts with; what is not said is as the model has it.
///
/// ```
/// use mbd_runtime::Case;
/// let case = Case::new().params([2.5]).state(0.0, vec![0.0, 0.0, 10.0, 0.0, 0.0, 0.0]);
/// assert_eq!(case.number(), 0);
/// ```
#[derive(Clone, Debug, Default)]
pub struct Case<T = f64> {
    pub(super) number: usize,
    pub(super) params: Option<GivenParams<T>>,
    pub(super) inputs: Option<HeldInputs<T>>,
    pub(super) state: Option<(f64, Vec<T>)>,
    pub(super) joints: Vec<(String, f64)>,
    pub(super) nodes: Option<Vec<T>>,
}

/// Params: whether they are those of a scene, where that is known, and their values.
#[derive(Clone, Debug)]
pub(super) struct GivenParams<T> {
    pub check: fn(&Scene) -> Result<(), ParamError>,
    pub values: Vec<T>,
}

/// Inputs that are held: the model they belong to, where that is known, and their numbers.
#[derive(Clone, Debug)]
pub(super) struct HeldInputs<T> {
    pub of: Option<(&'static str, [usize; 2])>,
    pub numbers: Vec<T>,
}

impl<T: Float> Case<T> {
    /// The model as it is.
    #[must_use]
    pub fn new() -> Self {
        Case::default()
    }

    /// The parameters: those of a generated model, `StoneParams { … }`, or a list of them in declaration order [SI].
    #[must_use]
    pub fn params<P: Params<T>>(mut self, params: P) -> Self {
        self.params = Some(GivenParams {
            check: P::check_model,
            values: params.values().as_ref().to_vec(),
        });
        self
    }

    /// Inputs that are held over the whole run.
    #[must_use]
    pub fn inputs<I: Inputs<T>>(mut self, inputs: &I) -> Self {
        self.inputs = Some(HeldInputs {
            of: I::MODEL,
            numbers: inputs.numbers().as_ref().to_vec(),
        });
        self
    }

    /// Time [s] and state x = [q | v | z | s] of the start, as [`Simulation::set_state`](crate::Simulation::set_state) takes them.
    #[must_use]
    pub fn state(mut self, time: f64, state: impl Into<Vec<T>>) -> Self {
        self.state = Some((time, state.into()));
        self
    }

    /// A joint coordinate of the start, or its rate, by name [m or rad, and per second]: see
    /// [`Simulation::set_joints`](crate::Simulation::set_joints).
    #[must_use]
    pub fn joint(mut self, name: impl Into<String>, value: f64) -> Self {
        self.joints.push((name.into(), value));
        self
    }

    /// Where the search for the nodes begins [m], 3 numbers a node.
    #[must_use]
    pub fn nodes(mut self, guess: impl Into<Vec<T>>) -> Self {
        self.nodes = Some(guess.into());
        self
    }

    /// Its number in the batch, from [`Batch::numbered_from`](super::Batch::numbered_from) on, in the order of the iterator.
    #[must_use]
    pub fn number(&self) -> usize {
        self.number
    }
}

/// What became of a case.
#[derive(Clone, Debug, PartialEq)]
pub struct Finished<R, T = f64> {
    /// Its number.
    pub case: usize,
    /// What was made of its history, or why it did not reach its end.
    pub result: Result<R, Failed<T>>,
    /// What the run cost.
    pub statistics: Statistics,
    /// Energy that it made or lost over the energy that moved, as [`Simulation::imbalance`](crate::Simulation::imbalance) tells it; of several runs that go
    /// on from each other the most. `None` where none can tell it.
    pub imbalance: Option<f64>,
    /// Steps that were tried in lanes beside those of other cases; what is in the result does not depend on it.
    pub beside: u64,
    /// Time from its begin to its end on the clock [s], during which others may have been under way beside it. This and `beside` are the only numbers here
    /// that are others in another run.
    pub seconds: f64,
}

/// A case that did not reach its end.
#[derive(Clone, Debug, PartialEq)]
pub struct Failed<T = f64> {
    /// Why.
    pub why: Why,
    /// The time of its last accepted step [s]; NaN where no run was made.
    pub time: f64,
    /// The state there; empty where no run was made.
    pub state: Vec<T>,
}

/// Why a case did not reach its end.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Why {
    /// Its params cannot be run.
    Params(ParamError),
    /// Its run stopped.
    Run(RunError),
    /// The caller's own code panicked: a controller, or what reads the history. Its words.
    Panic(String),
}

impl Why {
    /// The name of this kind of failure in tables: `params`, `panic`, or that of a [`StepError`](crate::StepError::status).
    #[must_use]
    pub fn status(&self) -> &'static str {
        match self {
            Why::Params(_) => "params",
            Why::Run(error) => error.cause.status(),
            Why::Panic(_) => "panic",
        }
    }
}

impl fmt::Display for Why {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Why::Params(error) => error.fmt(f),
            Why::Run(error) => error.fmt(f),
            Why::Panic(words) => write!(f, "the code of the caller panicked: {words}"),
        }
    }
}

impl<T> fmt::Display for Failed<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.why.fmt(f)
    }
}

impl<T: fmt::Debug> std::error::Error for Failed<T> {}
