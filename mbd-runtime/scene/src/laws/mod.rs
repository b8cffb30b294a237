//! The laws of mechanics, each written once over [`Real`].

use crate::{At, Layout, Quantity, Real, Scene};

mod numbers;

pub use numbers::{BodyNumbers, LineNumbers, Numbers};

/// Scratch of one evaluation: carries nothing from call to call.
#[derive(Clone, Debug)]
pub struct Scratch<S> {
    /// Placeholder of the lists the laws fill.
    pub forces: Vec<S>,
}

impl<S: Real> Scratch<S> {
    /// Room for one scene.
    #[must_use]
    pub fn new(_scene: &Scene, layout: &Layout) -> Self {
        Scratch {
            forces: vec![S::zero(); layout.nv],
        }
    }
}

/// Evaluates a quantity by running the laws on the scalar `S`.
///
/// `out` has the length [`Layout::len`] and **starts at zero**: only structural non-zeros are written.
/// [`Quantity::Partial`] is not a law: symbols differentiate their trace, numbers use [`crate::Real`] duals.
pub fn evaluate<S: Real>(
    what: Quantity,
    scene: &Scene,
    layout: &Layout,
    numbers: &Numbers<S>,
    at: &At<'_, S>,
    scratch: &mut Scratch<S>,
    out: &mut [S],
) {
    let _ = (what, scene, layout, numbers, at, scratch, out);
}
