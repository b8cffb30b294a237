//! The equations of a model over lanes, and how a run comes to them.

use std::any::Any;
use std::fmt;
use std::sync::Arc;

use mbd_scene::laws::LineNumbers;
use mbd_scene::{At, Layout, Model, ParamError, Quantity, Real, Scene, Work};

use super::{Lanes, Lanes4, Lanes8};

/// The equations of a model over one scalar, without its declaration: what `model!` makes of one with `<T>`.
pub trait Equations<S: Real>: Sized {
    /// Those for parameters in declaration order [SI] that nobody checks; `None` for another count.
    fn with(params: &[S]) -> Option<Self>;
    /// Where everything lives in their lists.
    fn layout() -> &'static Layout;
    /// Length of the list that evaluations work on.
    fn room(&self) -> usize;
    /// Writes a quantity, as [`Model::evaluate`] does; `work` has the length of [`Equations::room`].
    fn evaluate(&self, what: Quantity, at: &At<'_, S>, work: &mut [S], out: &mut [S]);
}

/// A generated model whose cases can be run in lanes: `model Stone<T> { … }`.
///
/// ```
/// use mbd_runtime::{Batch, Case, InLanes, Options, model};
///
/// model! {
///     /// A stone that falls in air.
///     model Stone<T> {
///         gravity: [0.0, 0.0, -9.81] m/s^2;
///         param mass = 1.0 kg in 0.1 kg ..= 10.0 kg;
///         point stone { mass: mass, start at [0.0, 0.0, 100.0] m }
///         load air on stone = -0.02 kg/m * norm(stone.velocity) * stone.velocity;
///         output speed = norm(stone.velocity);
///     }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let stone = Stone::new(StoneParams::default())?.in_lanes();
/// let speeds = |lanes: usize| {
///     Batch::new(&stone, Options::tsit5(1e-8), 4.0)
///         .cases((1..=20).map(|k| Case::new().params([0.4 * f64::from(k)])))
///         .threads(1)
///         .lanes(lanes)
///         .run(|_, history| history.column("speed").and_then(|speed| speed.last().copied()))
/// };
/// // The same numbers, to the bit.
/// let (beside, alone) = (speeds(8), speeds(1));
/// assert!(beside.iter().zip(&alone).all(|(a, b)| a.result == b.result));
/// assert!(beside[0].beside > 0 && alone[0].beside == 0);
/// # Ok(())
/// # }
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` is of one scalar: its cases cannot be run in lanes",
    note = "declare it over any scalar: `model {Self}<T> {{ … }}`"
)]
pub trait InLanes: Model<f64> + Clone + Sized + 'static {
    /// Its equations over another scalar.
    type Over<S: Real>: Equations<S> + 'static;

    /// The same model, with its equations over lanes at hand: what a [`Batch`](crate::Batch) or a campaign of it runs beside each other.
    fn in_lanes(self) -> Beside {
        let forms = Makers {
            four: compiled::<Lanes4, Self::Over<Lanes4>>,
            eight: compiled::<Lanes8, Self::Over<Lanes8>>,
        };
        Beside::new(Arc::new(self), Arc::new(forms))
    }
}

/// Equations whose parameters differ from lane to lane.
pub trait LaneParameters<L> {
    /// Takes parameters, in declaration order [SI], that were checked lane by lane.
    fn take(&mut self, params: &[L]);
    /// Writes a quantity, as [`Model::evaluate`] does; what is not known to the equations is not a number.
    fn evaluate(&mut self, what: Quantity, at: &At<'_, L>, out: &mut [L]);
}

/// The equations of a model over lanes of each width, without parameters yet.
pub trait Forms: Send + Sync {
    /// Over four.
    fn four(&self) -> Box<dyn LaneParameters<Lanes4>>;
    /// Over eight.
    fn eight(&self) -> Box<dyn LaneParameters<Lanes8>>;
}

/// A model with its equations over lanes at hand.
#[derive(Clone)]
pub struct Beside {
    model: Arc<dyn Model<f64>>,
    forms: Arc<dyn Forms>,
}

impl Beside {
    /// A model, and its equations over lanes: the same operations in the same order.
    #[must_use]
    pub fn new(model: Arc<dyn Model<f64>>, forms: Arc<dyn Forms>) -> Self {
        Beside { model, forms }
    }

    /// The equations over lanes of a model that has them at hand.
    pub(super) fn of(model: &dyn Any) -> Option<Arc<dyn Forms>> {
        model.downcast_ref().cloned()
    }
}

impl fmt::Debug for Beside {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = &self.model.scene().name;
        f.debug_tuple("Beside").field(name).finish()
    }
}

impl Model<f64> for Beside {
    fn share(&self) -> Arc<dyn Model<f64>> {
        Arc::new(self.clone())
    }
    fn with_params(&self, params: &[f64]) -> Result<Arc<dyn Model<f64>>, ParamError> {
        let model = self.model.with_params(params)?;
        Ok(Arc::new(Beside::new(model, self.forms.clone())))
    }
    fn work(&self) -> Work<f64> {
        self.model.work()
    }
    fn scene(&self) -> &Scene {
        self.model.scene()
    }
    fn layout(&self) -> &Layout {
        self.model.layout()
    }
    fn params(&self) -> &[f64] {
        self.model.params()
    }
    fn lines(&self) -> &[LineNumbers<f64>] {
        self.model.lines()
    }
    fn evaluate(&self, what: Quantity, at: &At<'_, f64>, work: &mut Work<f64>, out: &mut [f64]) {
        self.model.evaluate(what, at, work, out);
    }
    fn beside(&self) -> Option<&(dyn Any + Send + Sync)> {
        Some(&self.forms)
    }
}

/// The equations of a generated model over one register.
struct Compiled<E, L> {
    equations: Option<E>,
    work: Vec<L>,
}

impl<L: Lanes, E: Equations<L>> LaneParameters<L> for Compiled<E, L> {
    fn take(&mut self, params: &[L]) {
        self.equations = E::with(params);
        let room = self.equations.as_ref().map_or(0, Equations::room);
        self.work.resize(room, L::zero());
    }

    fn evaluate(&mut self, what: Quantity, at: &At<'_, L>, out: &mut [L]) {
        match &self.equations {
            Some(equations) => equations.evaluate(what, at, &mut self.work, out),
            None => out.fill(L::from_f64(f64::NAN)),
        }
    }
}

/// Makes them.
struct Makers {
    four: fn() -> Box<dyn LaneParameters<Lanes4>>,
    eight: fn() -> Box<dyn LaneParameters<Lanes8>>,
}

impl Forms for Makers {
    fn four(&self) -> Box<dyn LaneParameters<Lanes4>> {
        (self.four)()
    }
    fn eight(&self) -> Box<dyn LaneParameters<Lanes8>> {
        (self.eight)()
    }
}

fn compiled<L: Lanes, E: Equations<L> + 'static>() -> Box<dyn LaneParameters<L>> {
    Box::new(Compiled::<E, L> {
        equations: None,
        work: Vec::new(),
    })
}
