//! The trait behind which generic, interpreted and generated models are the same.

use std::any::Any;
use std::sync::Arc;

use crate::laws::LineNumbers;
use crate::{At, Float, Layout, ParamError, Quantity, Scene};

/// A scene with parameters that can be evaluated: by running the laws (generic), by running the compiled program (interpreted), or by
/// the code `model!` emitted (generated). Everything that integrates, linearises or draws is written once over `dyn Model`, so that it is
/// compiled once, whatever models there are.
pub trait Model<T: Float>: Send + Sync {
    /// The same model, shared: what a run owns. Costs a copy of the parameters, never one of the equations.
    fn share(&self) -> Arc<dyn Model<T>>;
    /// The same scene with other parameters (declaration order, SI).
    ///
    /// # Errors
    /// The first parameter that cannot be run.
    fn with_params(&self, params: &[T]) -> Result<Arc<dyn Model<T>>, ParamError>;
    /// Fresh scratch; the only allocation.
    fn work(&self) -> Work<T>;
    /// The declaration.
    fn scene(&self) -> &Scene;
    /// Where everything lives.
    fn layout(&self) -> &Layout;
    /// The live parameters, in declaration order [SI].
    fn params(&self) -> &[T];
    /// Stiffness, damping and free length of every line, then of every stop (no free length), for these parameters.
    fn lines(&self) -> &[LineNumbers<T>];
    /// Writes a quantity into `out`, whose length is [`Layout::len`]. Lists (`Derivative`, `Ends`, …) are written whole; of matrices
    /// (`MassMatrix`, `NodeByAnchor`, `CondensedStiffness`, `Partial`) only the structural non-zeros, so `out` starts at zero there.
    /// A slice of a wrong length, or the scratch of another model, leaves `out` untouched; what a compiled model was not asked to emit is not a number.
    fn evaluate(&self, what: Quantity, at: &At<'_, T>, work: &mut Work<T>, out: &mut [T]);
    /// Evaluates the stages inside a step of the classical method of order four in one call, and the last one where its end is asked for; `false`: they are
    /// evaluated one by one. A compiled model does it, to the bit, where the lengths of all lists are known.
    fn inner_stages(&self, _step: StepStages<'_, T>, _work: &mut Work<T>) -> bool {
        false
    }
    /// Whether a quantity has a value here; of a compiled model, whether it was asked to emit it.
    fn emits(&self, _what: Quantity) -> bool {
        true
    }
    /// What evaluates several cases of this model beside each other, for a runtime that knows its type; `None` where they are run one by one.
    fn beside(&self) -> Option<&(dyn Any + Send + Sync)> {
        None
    }
}

/// Inputs that are functions of time and state.
pub trait StageInputs<T> {
    /// The inputs at a stage, whose time [s] and numbers are given with the inputs that are held.
    fn at_stage(&mut self, time: f64, at: &At<'_, T>) -> &[T];
}

/// The stages of a step of the classical Runge–Kutta method of order four: rates k₁ … k₄ at and inside it, and the state that they lead to.
pub struct StepStages<'a, T> {
    /// Where the step starts, and what is held in it.
    pub at: At<'a, T>,
    /// What changes inputs inside the step; `None`: they are held.
    pub inputs: Option<&'a mut dyn StageInputs<T>>,
    /// Time at its start, and its size [s].
    pub span: [f64; 2],
    /// Rates, one after the other: k₁ is given.
    pub rates: &'a mut [T],
    /// The state at its end.
    pub next: &'a mut [T],
    /// What [`Quantity::Rates`] is at the three stages inside it, where nodes are found along with the rates; empty elsewhere.
    pub found: &'a mut [T],
    /// Whether the nodes of a stage hold that were found so: where they do not, other rules find them, and nothing is made behind them.
    pub holds: &'a dyn Fn(&[T]) -> bool,
    /// What its last stage k₅ takes; `None`: it is not made, and the end is left as the stages lead there.
    pub end: Option<StepEnd<'a, T>>,
}

/// The last stage of a step, at its end, where nothing but quaternions is put back before.
pub struct StepEnd<'a, T> {
    /// Where the quaternions begin in the state.
    pub quaternions: &'a [usize],
    /// By how much the length of a quaternion was off at most; written where they are put back.
    pub drift: &'a mut f64,
    /// As [`StepStages::found`], of this stage.
    pub found: &'a mut [T],
    /// Whether its rates are finite, and its nodes hold; written where they are evaluated.
    pub made: &'a mut bool,
}

/// Scratch of the evaluations of one model: carries nothing from call to call.
#[derive(Debug, Default)]
pub struct Work<T> {
    /// What generated code hands from kernel to kernel.
    pub numbers: Vec<T>,
    other: Option<Box<dyn Any + Send + Sync>>,
}

impl<T: Float> Work<T> {
    /// A list of so many numbers.
    #[must_use]
    pub fn list(count: usize) -> Self {
        Work {
            numbers: vec![T::zero(); count],
            other: None,
        }
    }

    /// A list of so many numbers, and scratch of another kind beside it.
    #[must_use]
    pub fn list_and(count: usize, other: impl Any + Send + Sync) -> Self {
        Work {
            other: Some(Box::new(other)),
            ..Self::list(count)
        }
    }

    /// The list, and the scratch beside it; `None` where that is of another kind.
    pub fn both<W: Any>(&mut self) -> (&mut [T], Option<&mut W>) {
        let other = self.other.as_mut();
        (
            &mut self.numbers,
            other.and_then(|other| other.downcast_mut()),
        )
    }

    /// Scratch of a kind of its own.
    #[must_use]
    pub fn of(other: impl Any + Send + Sync) -> Self {
        Work {
            numbers: Vec::new(),
            other: Some(Box::new(other)),
        }
    }

    /// The scratch of that kind; `None` where this is the scratch of another model.
    #[must_use]
    pub fn get<W: Any>(&mut self) -> Option<&mut W> {
        self.other.as_mut()?.downcast_mut()
    }
}
