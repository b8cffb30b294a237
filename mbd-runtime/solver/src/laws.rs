//! The laws of a scene on numbers, whatever model runs: for the few states at which a run needs what a compiled model may not have been
//! asked to emit. In `f64` whatever the scalar of the run.

use std::sync::Arc;

use mbd_scene::Scratch;
use mbd_scene::laws::Numbers;
use mbd_scene::{Arguments, At, Float, Layout, Model, Quantity, Scene, double};

/// Numbers and scratch of one scene.
#[derive(Clone, Debug)]
pub(crate) struct Laws {
    numbers: Arc<Numbers<f64>>,
    scratch: Scratch<f64>,
    arguments: Arguments<f64>,
}

/// Params in `f64`.
pub(crate) fn params_of<T: Float>(params: &[T]) -> Vec<f64> {
    params.iter().map(|x| x.to_f64()).collect()
}

/// The numbers of the scene of a model, with its params.
pub(crate) fn numbers_of<T: Float>(model: &dyn Model<T>) -> Numbers<f64> {
    double::numbers(model.scene(), &params_of(model.params()))
}

impl Laws {
    /// Those of the scene of a model, with its parameters.
    pub(crate) fn new<T: Float>(model: &dyn Model<T>) -> Self {
        Laws {
            numbers: Arc::new(numbers_of(model)),
            scratch: double::scratch(model.layout()),
            arguments: Arguments::default(),
        }
    }

    /// Room for so many numbers in [`At::rows`].
    pub(crate) fn reserve_rows(&mut self, count: usize) {
        self.arguments.rows.reserve_exact(count);
    }

    /// The numbers of the scene.
    pub(crate) fn numbers(&self) -> &Arc<Numbers<f64>> {
        &self.numbers
    }

    /// Writes a quantity of the scene that `model` runs; entries of matrices that are always zero, too.
    pub(crate) fn evaluate<T: Float>(
        &mut self,
        model: &dyn Model<T>,
        what: Quantity,
        at: &At<'_, T>,
        out: &mut [f64],
    ) {
        out.fill(0.0);
        self.run(model, at, |scene, layout, numbers, at, scratch| {
            double::evaluate(what, scene, layout, numbers, at, scratch, out);
        });
    }

    /// The same for multipliers, and accelerations, that were found elsewhere: reactions, energy or outputs.
    pub(crate) fn evaluate_with_multipliers<T: Float>(
        &mut self,
        model: &dyn Model<T>,
        what: Quantity,
        at: &At<'_, T>,
        found: [&[f64]; 2],
        out: &mut [f64],
    ) {
        self.run(model, at, |scene, layout, numbers, at, scratch| {
            let at = (at, found);
            mbd_scene::evaluate_with_multipliers(what, scene, layout, numbers, at, scratch, out);
        });
    }

    /// Runs a law of the scene that `model` runs, at `at` on `f64`: one of those of [`mbd_scene`] that take these arguments.
    pub(crate) fn run<T: Float>(
        &mut self,
        model: &dyn Model<T>,
        at: &At<'_, T>,
        law: impl FnOnce(&Scene, &Layout, &Numbers<f64>, &At<'_, f64>, &mut Scratch<f64>),
    ) {
        self.arguments.read(at, T::to_f64);
        law(
            model.scene(),
            model.layout(),
            &self.numbers,
            &self.arguments.at(),
            &mut self.scratch,
        );
    }
}
