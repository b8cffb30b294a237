//! Inverse dynamics: efforts along chosen coordinates for given accelerations of them.
//!
//! ```text
//! M v̇ + h = f + Φ_vᵀ λ + cᵀ τ,   Φ_v v̇ = γ,   c v̇ − γ_c = α                                                       (1)
//! all freedoms given:  K v̇ = [γ; α + γ_c],   τ = (K⁻ᵀ (M v̇ + h − f))_c          K = [Φ_v; c]                       (2)
//! some:  (c W) τ = α + γ_c − c v̇₀,   W = the accelerations of a unit of each effort, v̇₀ those without              (3)
//! ```
//!
//! (2) is linear in what is known and eliminates no mass; the multipliers drop out of it. In (3) what is not chosen moves freely.
//! Source: Featherstone, Rigid Body Dynamics Algorithms, hybrid dynamics; [derived] for loops.

use mbd_scene::{Float, Model, Quantity};
use nalgebra::{DMatrix, DVector};

use crate::linearise::LinearisationError;
use crate::linearise::chart::{Chart, ChartOrder};
use crate::linearise::moment::{SceneMoment, check_given};

/// What [`inverse_dynamics`](crate::inverse_dynamics) found.
#[derive(Clone, Debug, PartialEq)]
pub struct Efforts {
    /// The effort along each chosen coordinate, in their order [N or N m]: what a motor there would have to give, besides everything that acts already.
    pub efforts: Vec<f64>,
    /// v̇ under them.
    pub accelerations: Vec<f64>,
}

/// What [`inverse_dynamics`](crate::inverse_dynamics) does.
pub(crate) fn find<T: Float>(
    model: &dyn Model<T>,
    at: (f64, &[f64], &[f64]),
    given: &[(&str, f64)],
) -> Result<Efforts, LinearisationError> {
    let mut moment = SceneMoment::new(model, at)?;
    moment.balance_nodes(None)?;
    let names: Vec<&str> = given.iter().map(|(name, _)| *name).collect();
    let chart = Chart::choose(&mut moment, &names, ChartOrder::Places)?;
    check_given(given.iter().copied())?;
    let (count, held) = (given.len(), chart.kept.len());
    let (nq, nv, nc) = {
        let layout = moment.layout();
        (layout.nq, layout.nv, layout.nc)
    };
    let still = vec![0.0; nv];
    // −γ_c of every coordinate.
    let rest = chart.accelerations(&mut moment, &still);
    if count == chart.len() {
        let bias = moment.evaluate(Quantity::ConstraintBias, &[]);
        let mut right = DVector::zeros(nv);
        for (slot, &row) in right.iter_mut().zip(&chart.kept) {
            *slot = bias[row];
        }
        for (line, (_, value)) in given.iter().enumerate() {
            right[held + line] = value - rest[line];
        }
        let accelerations = &chart.inverse * right;
        let mut rows = accelerations.as_slice().to_vec();
        rows.resize(nv + nc, 0.0);
        let residual = moment.evaluate(Quantity::Residual, &rows);
        let residual = DVector::from_column_slice(&residual[nq..nq + nv]);
        let along = chart.inverse.tr_mul(&residual);
        return finite(
            along.rows(held, count).as_slice().to_vec(),
            accelerations.as_slice().to_vec(),
        );
    }
    moment.check_inertia()?;
    let free = moment.rates()?;
    let free = &free[nq..nq + nv];
    let now = chart.accelerations(&mut moment, free);
    let along = chart.rows.rows(held, count).into_owned();
    let unit = moment.solve(&along.transpose())?;
    let effort = (&along * &unit).lu();
    let wanted = DVector::from_fn(count, |line, _| given[line].1 - now[line]);
    let Some(efforts) = effort.solve(&wanted) else {
        let name = names.first().map(|name| (*name).to_owned());
        return Err(LinearisationError::DependentCoordinate {
            name: name.unwrap_or_default(),
        });
    };
    let accelerations = DVector::from_column_slice(free) + unit * &efforts;
    finite(
        efforts.as_slice().to_vec(),
        accelerations.as_slice().to_vec(),
    )
}

fn finite(efforts: Vec<f64>, accelerations: Vec<f64>) -> Result<Efforts, LinearisationError> {
    match efforts.iter().all(|x| x.is_finite()) {
        true => Ok(Efforts {
            efforts,
            accelerations,
        }),
        false => Err(LinearisationError::not_finite(Quantity::Residual)),
    }
}

impl SceneMoment {
    /// v̇ of forces alone, one column each: M x = b + Φ_vᵀ y, Φ_v x = 0.
    fn solve(&mut self, forces: &DMatrix<f64>) -> Result<DMatrix<f64>, LinearisationError> {
        let (nv, nc) = (self.layout().nv, self.layout().nc);
        if nc == 0 {
            let mass = self.evaluate(Quantity::MassMatrix, &[]);
            let factor = DMatrix::from_row_slice(nv, nv, &mass).cholesky();
            let factor = factor.ok_or(LinearisationError::not_finite(Quantity::MassMatrix))?;
            return Ok(factor.solve(forces));
        }
        let mut rows = self.evaluate(Quantity::Factor, &[]);
        let count = rows.len();
        let mut found = DMatrix::zeros(nv, forces.ncols());
        for (column, mut out) in forces.column_iter().zip(found.column_iter_mut()) {
            rows.truncate(count);
            rows.extend(column.iter());
            rows.resize(count + nv + nc, 0.0);
            let solution = self.evaluate(Quantity::Solve, &rows);
            out.copy_from_slice(&solution[..nv]);
        }
        Ok(found)
    }
}
