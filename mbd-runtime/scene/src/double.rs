//! The laws on `f64`, compiled once: a generic function is compiled again in every crate that calls it.

use crate::laws::Numbers;
use crate::{At, Layout, Quantity, Scene, Scratch};

/// [`evaluate`](crate::evaluate()) on numbers.
pub fn evaluate(
    what: Quantity,
    scene: &Scene,
    layout: &Layout,
    numbers: &Numbers<f64>,
    at: &At<'_, f64>,
    scratch: &mut Scratch<f64>,
    out: &mut [f64],
) {
    crate::evaluate(what, scene, layout, numbers, at, scratch, out);
}

/// The [numbers](Numbers) of a scene for these params [SI].
#[must_use]
pub fn numbers(scene: &Scene, params: &[f64]) -> Numbers<f64> {
    Numbers::new(scene, params)
}

/// Room for the scene of a layout.
#[must_use]
pub fn scratch(layout: &Layout) -> Scratch<f64> {
    Scratch::new(layout)
}
