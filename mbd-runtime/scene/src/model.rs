//! The trait behind which generic, interpreted and generated models are the same.

use crate::laws::LineNumbers;
use crate::{At, Float, Layout, Quantity, Scene};

/// A scene with parameters that can be evaluated: by running the laws (generic), by running the compiled program (interpreted), or by
/// the code `model!` emitted (generated). Everything that integrates, linearises or draws is written once over this trait.
pub trait Model<T: Float> {
    /// Scratch of an evaluation: carries nothing from call to call.
    type Work;

    /// Fresh scratch; the only allocation.
    fn work(&self) -> Self::Work;
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
    /// A slice of a wrong length leaves `out` untouched.
    fn evaluate(&self, what: Quantity, at: &At<'_, T>, work: &mut Self::Work, out: &mut [T]);
}
