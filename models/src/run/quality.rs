//! How well a run kept what cannot change: joints closed, energy balanced.

use mbd_runtime::Trajectory;
use mbd_runtime::scene::{Gravity, Scene};

/// The largest violations of a run, at the rows of its history.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// max |Φ|, rows without unit counted as metres [m]; `None` without joints.
    pub drift: Option<f64>,
    /// max |Φ̇| [m/s]; `None` without joints.
    pub drift_rate: Option<f64>,
    /// max |E − E(0) − work of loads, dampers and prescribed motions| [J]; `None` where gravity comes from the caller, who alone knows its energy.
    pub imbalance: Option<f64>,
    /// The same over the energy that moved: the largest kinetic energy or change of a potential one.
    pub relative_imbalance: Option<f64>,
}

impl Quality {
    /// Reads the history of a run.
    #[must_use]
    pub fn of(scene: &Scene, trajectory: &Trajectory) -> Quality {
        let most = |name: &str| trajectory.column(name).map(largest);
        let balance = balance(scene, trajectory);
        let imbalance = balance.as_deref().map(largest);
        let part = |part: &str| trajectory.column(&format!("energy.{part}"));
        let moved = [
            part("kinetic").map(largest),
            part("gravitational").map(extent),
            part("elastic").map(extent),
        ];
        let moved = moved.into_iter().flatten().fold(0.0, f64::max);
        Quality {
            drift: most("joint_drift"),
            drift_rate: most("joint_drift_rate"),
            imbalance,
            relative_imbalance: imbalance.filter(|_| moved > 0.0).map(|most| most / moved),
        }
    }
}

/// E − E(0) − work of loads, dampers and prescribed motions at every row [J].
pub fn balance(scene: &Scene, trajectory: &Trajectory) -> Option<Vec<f64>> {
    if scene.gravity == Gravity::Field {
        return None;
    }
    let total = trajectory.column("energy.total")?;
    let names = trajectory.names().iter().map(|name| name.name.as_str());
    let works: Vec<&[f64]> = names
        .filter(|name| name.starts_with("work."))
        .filter_map(|name| trajectory.column(name))
        .collect();
    let first = *total.first()?;
    // Work that is not integrated is not there: the column holds no number.
    let work = |row: usize| -> f64 {
        let done = works.iter().filter_map(|work| work.get(row));
        done.filter(|work| work.is_finite()).sum()
    };
    Some(
        total
            .iter()
            .enumerate()
            .map(|(row, total)| total - first - work(row))
            .collect(),
    )
}

/// The largest size in a column; not a number, if one is not.
fn largest(column: &[f64]) -> f64 {
    column.iter().fold(0.0, |most, x| {
        if x.is_nan() || x.abs() > most {
            x.abs()
        } else {
            most
        }
    })
}

fn extent(column: &[f64]) -> f64 {
    let low = column.iter().copied().fold(f64::INFINITY, f64::min);
    let high = column.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if high > low { high - low } else { 0.0 }
}
