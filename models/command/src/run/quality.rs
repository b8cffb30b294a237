//! How well a run kept its joints closed.

use mbd_runtime::Trajectory;

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
