//! How well a run kept its joints closed.

use mbd_runtime::Trajectory;
use mbd_runtime::scene::{Gravity, Scene};

/// The largest violations of a run, at the rows of its history.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// max |Φ|, rows without unit counted as metres [m]; `None` without joints.
    pub drift: Option<f64>,
    /// max |Φ̇| [m/s]; `None` without joints.
    pub drift_rate: Option<f64>,
}

impl Quality {
    /// Reads the history of a run.
    #[must_use]
    pub fn of(trajectory: &Trajectory) -> Quality {
        let most = |name: &str| trajectory.column(name).map(largest);
        Quality {
            drift: most("joint_drift"),
            drift_rate: most("joint_drift_rate"),
        }
    }
}

/// E − E(0) − work of loads, dampers and prescribed motions at every row [J]: the curve of what [`Simulation::imbalance`](mbd_runtime::Simulation::imbalance) follows at every step.
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
