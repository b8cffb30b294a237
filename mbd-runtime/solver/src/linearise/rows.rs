//! Derivatives through the rows of joints: those of the equations of motion at fixed accelerations and multipliers, solved with the factor at hand.
//!
//! ```text
//! K [v̇; λ] = −r(0, 0)                                        the solution, refined once                             (1)
//! K [∂v̇; ∂λ] = −∂r,   K = [M −Φ_vᵀ; Φ_v 0]                   at fixed v̇, λ, whatever r is differentiated by         (2)
//! ```
//!
//! r, ∂r, the factor of K and the solution by it are the model's own where it was generated with `emit: [partial]`; else the laws run on duals.

use mbd_scene::{At, Differentiated, Float, Layout, Model, Quantity, Variable, Work};

use super::LinearisationError;
use super::matrix::Matrix;
use crate::laws::Laws;
use crate::slopes::{DerivativeBy, Effective, Slopes};

/// Part that other rows leave to a row below which rows depend on each other.
const DEPENDENT: f64 = 1e-9;

/// The room of one layout.
#[derive(Clone, Debug)]
pub(crate) struct ThroughRows<T> {
    /// The factor, then a right-hand side.
    factor: Vec<T>,
    /// v̇, then λ of the rows in the system.
    solution: Vec<T>,
    residual: Vec<T>,
    found: Vec<T>,
    partial: Matrix<T>,
}

/// The laws of a scene on numbers and on duals, with their room.
#[derive(Debug)]
pub(crate) struct Witness {
    laws: Laws,
    pub(super) slopes: Slopes,
    wide: Vec<f64>,
}

impl Witness {
    pub(crate) fn new<T: Float>(model: &dyn Model<T>) -> Self {
        let mut slopes = Slopes::new(model.scene(), model.layout(), model.params());
        slopes.reserve(
            model.layout(),
            &[
                Quantity::Derivative,
                Quantity::Residual,
                Quantity::Energy,
                Quantity::Balance,
                Quantity::AnchorStates,
            ],
        );
        Witness {
            laws: Laws::new(model),
            slopes,
            wide: Vec::new(),
        }
    }

    /// A derivative at fixed K_e and L_e, but by parameters, which they follow.
    pub(crate) fn differentiate<T: Float>(
        &mut self,
        model: &dyn Model<T>,
        (of, by): (Quantity, DerivativeBy),
        at: &At<'_, T>,
        out: &mut [T],
    ) {
        let effective = match by {
            DerivativeBy::Variable(Variable::Parameter) => Effective::Follows,
            _ => Effective::Fixed,
        };
        let scene = (model.scene(), model.layout());
        self.slopes
            .differentiate(scene, (of, by), effective, at, out);
    }
}

/// Who evaluates: the model itself, or the laws of its scene.
pub(crate) struct Evaluator<'a, T> {
    model: &'a dyn Model<T>,
    /// Scratch of the model; `None` where its laws are asked.
    work: Option<&'a mut Work<T>>,
    laws: &'a mut Option<Box<Witness>>,
}

impl<'a, T: Float> Evaluator<'a, T> {
    /// The model where it evaluates what derivatives through rows are made of, else its laws.
    pub(crate) fn new(
        model: &'a dyn Model<T>,
        at: &At<'_, T>,
        work: &'a mut Work<T>,
        laws: &'a mut Option<Box<Witness>>,
    ) -> Self {
        let layout = model.layout();
        let rows = vec![T::zero(); layout.nv + layout.nc];
        let mut probe = vec![T::from_f64(f64::NAN); layout.len(Quantity::Residual)];
        model.evaluate(
            Quantity::Residual,
            &At { rows: &rows, ..*at },
            work,
            &mut probe,
        );
        // A model leaves untouched what it does not know.
        let known = probe.iter().all(|x| x.is_finite());
        Self::known(model, known.then_some(work), laws)
    }

    /// The model with its scratch, or its laws.
    pub(crate) fn known(
        model: &'a dyn Model<T>,
        work: Option<&'a mut Work<T>>,
        laws: &'a mut Option<Box<Witness>>,
    ) -> Self {
        Evaluator { model, work, laws }
    }

    fn witness(&mut self) -> &mut Witness {
        let model = self.model;
        self.laws
            .get_or_insert_with(|| Box::new(Witness::new(model)))
    }

    fn evaluate(&mut self, what: Quantity, at: &At<'_, T>, out: &mut [T]) {
        let model = self.model;
        if let Some(work) = &mut self.work {
            out.fill(T::zero());
            model.evaluate(what, at, work, out);
            return;
        }
        let Witness { laws, wide, .. } = self.witness();
        wide.resize(out.len(), 0.0);
        laws.evaluate(model, what, at, wide);
        for (to, x) in out.iter_mut().zip(wide) {
            *to = T::from_f64(*x);
        }
    }

    /// ∂r.
    fn differentiate(&mut self, by: DerivativeBy, at: &At<'_, T>, out: &mut [T]) {
        let model = self.model;
        // A model's own derivatives hold K_e and L_e, and none is by time.
        let own = match by {
            DerivativeBy::Time => None,
            DerivativeBy::Variable(Variable::Parameter) if model.layout().effective_lines > 0 => {
                None
            }
            DerivativeBy::Variable(variable) => Some(variable),
        };
        if let (Some(work), Some(by)) = (&mut self.work, own) {
            out.fill(T::zero());
            let what = Quantity::Partial(Differentiated::Residual, by);
            model.evaluate(what, at, work, out);
            return;
        }
        let what = (Quantity::Residual, by);
        self.witness().differentiate(model, what, at, out);
    }
}

impl<T: Float> ThroughRows<T> {
    pub(crate) fn new(layout: &Layout) -> Self {
        let unknowns = layout.nv + layout.nc;
        ThroughRows {
            factor: vec![T::zero(); layout.len(Quantity::Factor) + unknowns],
            solution: vec![T::zero(); unknowns],
            residual: vec![T::zero(); layout.len(Quantity::Residual)],
            found: vec![T::zero(); unknowns],
            partial: Matrix::new(0, 0),
        }
    }

    /// v̇ and λ, by (1); the factor stays.
    ///
    /// # Errors
    /// [`LinearisationError::DependentRows`] at a position at which rows lose rank, [`LinearisationError::NotFinite`].
    pub(crate) fn prepare(
        &mut self,
        layout: &Layout,
        evaluator: &mut Evaluator<'_, T>,
        at: &At<'_, T>,
    ) -> Result<(), LinearisationError> {
        let count = layout.len(Quantity::Factor);
        evaluator.evaluate(Quantity::Factor, at, &mut self.factor[..count]);
        let factor = &self.factor[..count];
        let margin = factor.last().map_or(0.0, |margin| margin.to_f64());
        if margin.abs() < DEPENDENT.max(16.0 * T::EPSILON.to_f64()) {
            return Err(LinearisationError::DependentRows { margin });
        }
        if factor.iter().any(|x| !x.is_finite()) {
            return Err(LinearisationError::not_finite(Quantity::Factor));
        }
        self.solution.fill(T::zero());
        for _ in 0..2 {
            let given = At {
                rows: &self.solution,
                ..*at
            };
            evaluator.evaluate(Quantity::Residual, &given, &mut self.residual);
            let residual = std::mem::take(&mut self.residual);
            self.solve(layout, evaluator, at, |row| residual[row]);
            self.residual = residual;
            for (x, found) in self.solution.iter_mut().zip(&self.found) {
                *x += *found;
            }
        }
        match self.solution.iter().all(|x| x.is_finite()) {
            true => Ok(()),
            false => Err(LinearisationError::not_finite(Quantity::Derivative)),
        }
    }

    /// Finds x and y for the right-hand side −r.
    fn solve(
        &mut self,
        layout: &Layout,
        evaluator: &mut Evaluator<'_, T>,
        at: &At<'_, T>,
        residual: impl Fn(usize) -> T,
    ) {
        let (count, nx) = (layout.len(Quantity::Factor), layout.nx());
        let rows = (layout.nq..layout.nq + layout.nv).chain(nx..nx + layout.nc);
        for (slot, row) in self.factor[count..].iter_mut().zip(rows) {
            *slot = -residual(row);
        }
        let given = At {
            rows: &self.factor,
            ..*at
        };
        evaluator.evaluate(Quantity::Solve, &given, &mut self.found);
    }

    /// Writes ∂ẋ by a variable, by (2), after [`ThroughRows::prepare`].
    pub(crate) fn differentiate(
        &mut self,
        layout: &Layout,
        evaluator: &mut Evaluator<'_, T>,
        (by, at): (DerivativeBy, &At<'_, T>),
        out: &mut Matrix<T>,
    ) {
        let columns = by.count(layout);
        let mut partial = std::mem::take(&mut self.partial);
        partial.reshape(layout.len(Quantity::Residual), columns);
        let given = At {
            rows: &self.solution,
            ..*at
        };
        evaluator.differentiate(by, &given, &mut partial.values);
        out.values
            .copy_from_slice(&partial.values[..layout.nx() * columns]);
        let rows = || (layout.nq..layout.nq + layout.nv).chain(layout.nx()..partial.rows());
        for column in 0..columns {
            // Positions often change nothing: only what pulls depends on them.
            if rows().all(|row| partial.at(row, column) == T::zero()) {
                for speed in 0..layout.nv {
                    out.values[(layout.nq + speed) * columns + column] = T::zero();
                }
                continue;
            }
            self.solve(layout, evaluator, at, |row| partial.at(row, column));
            for (speed, x) in self.found[..layout.nv].iter().enumerate() {
                out.values[(layout.nq + speed) * columns + column] = *x;
            }
        }
        self.partial = partial;
    }
}
