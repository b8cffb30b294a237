//! Derivatives through the rows of joints: those of the equations of motion at fixed accelerations and multipliers, solved with the factor at hand.
//!
//! ```text
//! K [v̇; λ] = −r(0, 0)                                        the solution, refined once where there are rows         (1)
//! K [∂v̇; ∂λ] = −∂r,   K = [M −Φ_vᵀ; Φ_v 0]                   at fixed v̇, λ, whatever r is differentiated by         (2)
//! ```
//!
//! r, ∂r, the factor of K and the solution by it are the model's own where it was generated with `emit: [partial]`; else the laws run on duals.

use std::ops::Range;

use mbd_scene::{At, Differentiated, Float, Layout, Model, Quantity, Variable, Work};

use super::LinearisationError;
use super::matrix::Matrix;
use crate::laws::Laws;
use crate::list::all_finite;
use crate::slopes::{DerivativeBy, Effective, Slopes};

/// Part that other rows leave to a row below which rows depend on each other.
const DEPENDENT: f64 = 1e-9;

/// The room of one layout.
#[derive(Clone, Debug)]
pub(crate) struct ThroughRows<T> {
    /// The factor, then right-hand sides.
    factor: Vec<T>,
    /// Numbers of the factor.
    count: usize,
    /// v̇, then λ of the rows in the system.
    solution: Vec<T>,
    residual: Vec<T>,
    found: Vec<T>,
    partial: Matrix<T>,
    /// Columns of it in which something changes.
    changed: Vec<usize>,
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
                Quantity::Lines,
            ],
        );
        let layout = model.layout();
        let beside = (layout.nv + layout.nc) * layout.variables(Variable::State);
        let mut laws = Laws::new(model);
        laws.reserve_rows(layout.factor + beside);
        Witness {
            laws,
            slopes,
            wide: Vec::with_capacity(beside),
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
    /// The model with its scratch, or its laws. Where the model does not know the equations of motion, its laws are asked, too.
    pub(crate) fn new(
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

    /// r; from here on by the laws of the scene where the model does not know it.
    fn begin(&mut self, at: &At<'_, T>, out: &mut [T]) {
        if let Some(work) = &mut self.work {
            // A model leaves untouched what it does not know.
            out.fill(T::from_f64(f64::NAN));
            self.model.evaluate(Quantity::Residual, at, work, out);
            if all_finite(out) {
                return;
            }
            self.work = None;
        }
        self.evaluate(Quantity::Residual, at, out);
    }

    /// ∂r, where `out` is zero.
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
        let (unknowns, count) = (layout.nv + layout.nc, layout.len(Quantity::Factor));
        let beside = unknowns * layout.variables(Variable::State);
        let mut factor = vec![T::zero(); count];
        factor.reserve_exact(beside);
        let mut found = vec![T::zero(); unknowns];
        found.reserve_exact(beside);
        ThroughRows {
            factor,
            count,
            solution: vec![T::zero(); unknowns],
            residual: vec![T::zero(); layout.len(Quantity::Residual)],
            found,
            partial: Matrix::new(0, 0),
            changed: Vec::with_capacity(layout.variables(Variable::State)),
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
        self.solution.fill(T::zero());
        let given = At {
            rows: &self.solution,
            ..*at
        };
        evaluator.begin(&given, &mut self.residual);
        self.factor.truncate(self.count);
        let factor = &mut self.factor[..];
        evaluator.evaluate(Quantity::Factor, at, factor);
        let margin = factor.last().map_or(0.0, |margin| margin.to_f64());
        if margin.abs() < DEPENDENT.max(16.0 * T::EPSILON.to_f64()) {
            return Err(LinearisationError::DependentRows { margin });
        }
        if !all_finite(factor) {
            return Err(LinearisationError::not_finite(Quantity::Factor));
        }
        self.correct(layout, evaluator, at);
        // Without rows M is positive definite, and its factor leaves rounding alone.
        if layout.nc > 0 {
            let given = At {
                rows: &self.solution,
                ..*at
            };
            evaluator.evaluate(Quantity::Residual, &given, &mut self.residual);
            self.correct(layout, evaluator, at);
        }
        match all_finite(&self.solution) {
            true => Ok(()),
            false => Err(LinearisationError::not_finite(Quantity::Derivative)),
        }
    }

    /// Takes what the residual asks for from the solution.
    fn correct(&mut self, layout: &Layout, evaluator: &mut Evaluator<'_, T>, at: &At<'_, T>) {
        self.factor.truncate(self.count);
        for rows in solved(layout) {
            self.factor.extend(self.residual[rows].iter().map(|x| -*x));
        }
        self.found.resize(layout.nv + layout.nc, T::zero());
        self.solve(evaluator, at);
        for (x, found) in self.solution.iter_mut().zip(&self.found) {
            *x += *found;
        }
    }

    /// Finds x and y for the right-hand sides behind the factor.
    fn solve(&mut self, evaluator: &mut Evaluator<'_, T>, at: &At<'_, T>) {
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
        let given = At {
            rows: &self.solution,
            ..*at
        };
        // Without rows there are as many equations as rates.
        if layout.nc == 0 {
            out.values.fill(T::zero());
            evaluator.differentiate(by, &given, &mut out.values);
            self.take_right(layout, columns, &out.values);
        } else {
            partial.reshape(layout.len(Quantity::Residual), columns);
            evaluator.differentiate(by, &given, &mut partial.values);
            let rates = layout.nx() * columns;
            out.values.copy_from_slice(&partial.values[..rates]);
            self.take_right(layout, columns, &partial.values);
        }
        self.partial = partial;
        let beside = self.changed.len();
        if beside == 0 {
            return;
        }
        self.found
            .resize((layout.nv + layout.nc) * beside, T::zero());
        self.solve(evaluator, at);
        let rates = layout.nq * columns..(layout.nq + layout.nv) * columns;
        let rates = &mut out.values[rates];
        if beside == columns {
            return rates.copy_from_slice(&self.found[..rates.len()]);
        }
        let rows = rates.chunks_exact_mut(columns);
        for (row, found) in rows.zip(self.found.chunks_exact(beside)) {
            for (&column, x) in self.changed.iter().zip(found) {
                row[column] = *x;
            }
        }
    }

    /// Puts −∂r behind the factor; where joints have rows only the columns in which something changes: there most positions change nothing.
    fn take_right(&mut self, layout: &Layout, columns: usize, partial: &[T]) {
        let changes = |column: &usize| {
            let mut rows = solved(layout).into_iter().flatten();
            rows.any(|row| partial[row * columns + column] != T::zero())
        };
        self.changed.clear();
        match layout.nc == 0 {
            true => self.changed.extend(0..columns),
            false => self.changed.extend((0..columns).filter(changes)),
        }
        self.factor.truncate(self.count);
        for rows in solved(layout) {
            let rows = &partial[rows.start * columns..rows.end * columns];
            if self.changed.len() == columns {
                let behind = self.factor.len();
                self.factor.resize(behind + rows.len(), T::zero());
                let right = self.factor[behind..].iter_mut().zip(rows);
                right.for_each(|(to, x)| *to = -*x);
                continue;
            }
            for row in rows.chunks_exact(columns) {
                let right = self.changed.iter().map(|&column| -row[column]);
                self.factor.extend(right);
            }
        }
    }
}

/// The rows of a residual that are solved for: the balances of the speeds, then those of the joints.
fn solved(layout: &Layout) -> [Range<usize>; 2] {
    let nx = layout.nx();
    [layout.nq..layout.nq + layout.nv, nx..nx + layout.nc]
}
