//! Speeds that events set: by the impulse along them, which the joints hand on.
//!
//! ```text
//! M Δv = Φ_vᵀ μ + Cᵀ ν,   Φ_v Δv = 0,   C (v + Δv) = y            C: rows of the speeds that are set, y: what they are set to     (1)
//! ```
//!
//! the change of the speeds that is least in the metric of M. An impulse along a component of the velocity of a place acts there; one along the rate of a
//! joint's coordinate acts on child and parent. Source: Featherstone, Rigid Body Dynamics Algorithms, impulsive dynamics; [derived].

use mbd_scene::{At, Float, Formula, Quantity, Settable, plain};
use nalgebra::DMatrix;

use super::ModelRun;
use crate::basis::Basis;
use crate::error::StepError;

/// Part of what joints leave of a speed below which others decide it.
const LEAST: f64 = 1e-9;
/// A slope that is rounding of larger ones, over their size.
const ROUNDING: f64 = 1e-12;
/// The largest part of the speeds by which one that is held may be off what it is set to.
const SAME: f64 = 1e-9;

impl<T: Float> ModelRun<T> {
    /// Changes the speeds of a state whose joints hold, by (1). `set`: event, speed and value [SI] each.
    pub(super) fn set_speeds(&mut self, set: &[(usize, Settable, f64)]) -> Result<(), StepError> {
        if set.is_empty() {
            return Ok(());
        }
        let model = self.system.model.clone();
        let layout = model.layout();
        let (nq, nv) = (layout.nq, layout.nv);
        let own = self.state.get(..self.system.nx).unwrap_or_default();
        let mut list = |what: Quantity| {
            let mut out = vec![0.0; layout.len(what)];
            self.system.by_laws(what, self.time, own, &mut out);
            out
        };
        let mut basis = Basis::new(&list(Quantity::MassMatrix), nv);
        let rows = list(Quantity::ConstraintJacobian);
        basis.take_rows(&DMatrix::from_row_slice(layout.nc, nv, &rows));
        let rows = self.rows_of_speeds(set);
        let [at_rest, slopes @ ..] = rows.as_slice() else {
            return Ok(());
        };
        let mut speeds: Vec<f64> = self.state[nq..nq + nv].iter().map(|x| x.to_f64()).collect();
        // Of translations by themselves slopes are of size 1, of rotations an arm of the scene.
        let rounding = ROUNDING * self.sizes.length().max(1.0);
        let largest = speeds.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        for (number, (event, what, value)) in set.iter().enumerate() {
            let slopes = slopes.iter().map(|slope| slope[number] - at_rest[number]);
            let row: Vec<f64> = slopes
                .map(|x| if x.abs() > rounding { x } else { 0.0 })
                .collect();
            let along = |speeds: &[f64]| row.iter().zip(speeds).map(|(a, b)| a * b).sum::<f64>();
            let change = value - at_rest[number] - along(&speeds);
            if let Some(push) = basis.push(&row, change, LEAST) {
                speeds
                    .iter_mut()
                    .zip(&push)
                    .for_each(|(speed, x)| *speed += x);
            } else if change.abs() > SAME * largest.max(value.abs()) {
                let name = model.scene().settable_name(*what);
                let unit = model.scene().speed_unit(*what);
                let why = format!(
                    "it sets `{name}` to {} {unit}, and joints, locks, motors or what is set beside it hold it at {} {unit}",
                    plain(*value, 6),
                    plain(value - change, 6)
                );
                return Err(self.cannot_act(&[*event], why));
            }
        }
        for (to, speed) in self.state[nq..].iter_mut().zip(&speeds) {
            *to = T::from_f64(*speed);
        }
        Ok(())
    }

    /// What the speeds that are set are at rest, then at a unit of each speed of the state.
    fn rows_of_speeds(&mut self, set: &[(usize, Settable, f64)]) -> Vec<Vec<f64>> {
        let asked = set.iter().filter_map(|(_, what, _)| what.speed());
        let asked: Vec<Formula> = asked.collect();
        let layout = self.system.model.layout();
        let speeds = layout.nq..layout.nq + layout.nv;
        let mut rows = Vec::with_capacity(layout.nv + 1);
        let here = (self.time, &self.state[..]);
        self.system.by_laws_at(here, false, |laws, model, at| {
            laws.run(model, at, |scene, layout, numbers, at, scratch| {
                let mut state = at.state.to_vec();
                state[speeds.clone()].fill(0.0);
                for unit in std::iter::once(None).chain(speeds.map(Some)) {
                    if let Some(unit) = unit {
                        state[unit] = 1.0;
                    }
                    let at = At {
                        state: &state,
                        ..*at
                    };
                    let mut found = Vec::with_capacity(set.len());
                    let asked = &mut asked.iter();
                    mbd_scene::scalars(asked, scene, layout, numbers, &at, scratch, &mut found);
                    rows.push(found);
                    if let Some(unit) = unit {
                        state[unit] = 0.0;
                    }
                }
            });
        });
        rows
    }
}
