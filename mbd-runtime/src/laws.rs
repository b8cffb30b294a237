//! The laws of a scene on numbers, whatever model runs: for the few states at which a run needs what a compiled model may not have been
//! asked to emit. In `f64` whatever the scalar of the run.

use mbd_scene::Scratch;
use mbd_scene::laws::Numbers;
use mbd_scene::{Arguments, At, Float, Model, Quantity};

/// Numbers and scratch of one scene.
#[derive(Clone, Debug)]
pub(crate) struct Laws {
    numbers: Numbers<f64>,
    scratch: Scratch<f64>,
    arguments: Arguments<f64>,
}

impl Laws {
    /// Those of the scene of a model, with its parameters.
    pub(crate) fn new<T: Float>(model: &dyn Model<T>) -> Self {
        let params: Vec<f64> = model.params().iter().map(|x| x.to_f64()).collect();
        Laws {
            numbers: Numbers::new(model.scene(), &params),
            scratch: Scratch::new(model.layout()),
            arguments: Arguments::default(),
        }
    }

    /// Writes a quantity of the scene that `model` runs; entries of matrices that are always zero, too.
    pub(crate) fn evaluate<T: Float>(
        &mut self,
        model: &dyn Model<T>,
        what: Quantity,
        at: &At<'_, T>,
        out: &mut [f64],
    ) {
        self.arguments.read(at, |x| x.to_f64());
        out.fill(0.0);
        mbd_scene::evaluate(
            what,
            model.scene(),
            model.layout(),
            &self.numbers,
            &self.arguments.at(),
            &mut self.scratch,
            out,
        );
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
        self.arguments.read(at, |x| x.to_f64());
        mbd_scene::evaluate_with_multipliers(
            what,
            model.scene(),
            model.layout(),
            &self.numbers,
            (&self.arguments.at(), found),
            &mut self.scratch,
            out,
        );
    }

    /// Writes momentum, what gravity and loads give of it a second, and how much moves (14 numbers).
    pub(crate) fn impulses<T: Float>(
        &mut self,
        model: &dyn Model<T>,
        at: &At<'_, T>,
        out: &mut [f64],
    ) {
        self.arguments.read(at, |x| x.to_f64());
        mbd_scene::impulses(
            model.scene(),
            model.layout(),
            &self.numbers,
            &self.arguments.at(),
            &mut self.scratch,
            out,
        );
    }

    /// Writes the diagonal of the mass matrix.
    pub(crate) fn masses<T: Float>(
        &mut self,
        model: &dyn Model<T>,
        at: &At<'_, T>,
        out: &mut [f64],
    ) {
        self.arguments.read(at, |x| x.to_f64());
        mbd_scene::masses(
            model.scene(),
            model.layout(),
            &self.numbers,
            &self.arguments.at(),
            &mut self.scratch,
            out,
        );
    }

    /// Writes the angles in (−π, π] that something acts along which jumps with them.
    pub(crate) fn jumping_angles<T: Float>(
        &mut self,
        model: &dyn Model<T>,
        at: &At<'_, T>,
        out: &mut Vec<f64>,
    ) {
        self.arguments.read(at, |x| x.to_f64());
        out.clear();
        mbd_scene::jumping_angles(
            model.scene(),
            model.layout(),
            &self.numbers,
            &self.arguments.at(),
            &mut self.scratch,
            out,
        );
    }

    /// Writes value, rate and acceleration of the motors that follow inputs.
    pub(crate) fn commands<T: Float>(
        &mut self,
        model: &dyn Model<T>,
        at: &At<'_, T>,
        out: &mut Vec<[f64; 3]>,
    ) {
        self.arguments.read(at, |x| x.to_f64());
        out.clear();
        mbd_scene::commands(
            model.scene(),
            model.layout(),
            &self.numbers,
            &self.arguments.at(),
            &mut self.scratch,
            out,
        );
    }
}
