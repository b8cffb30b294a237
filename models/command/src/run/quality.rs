//! How well a run kept its joints closed.

use mbd_runtime::{SINGULAR_POSITION, Trajectory};

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

/// The most columns that a sentence names.
const NAMED: usize = 3;

/// One sentence where outputs have no finite value in rows of a history; `None` where all have.
#[must_use]
pub fn not_finite(trajectory: &Trajectory) -> Option<String> {
    let all = trajectory.not_finite();
    let named = all.iter().take(NAMED).map(|it| {
        let rows = trajectory.len();
        let from = match it.rows {
            1 => format!("at {} s", it.time),
            count => format!("in {count} of {rows} rows, from {} s on", it.time),
        };
        format!("`{}` is no finite number {from}", it.name)
    });
    let named: Vec<String> = named.collect();
    let others = match all.len().saturating_sub(NAMED) {
        0 => String::new(),
        1 => ", and one column more".to_owned(),
        others => format!(", and {others} columns more"),
    };
    let undetermined = all.iter().any(|it| it.undetermined);
    let undetermined = undetermined.then_some(SINGULAR_POSITION);
    let other = all.iter().any(|it| !it.undetermined).then_some("look there for a division by zero, a root or a logarithm; `if(…, …, …)` gives a value where there is none");
    let why: Vec<&str> = undetermined.into_iter().chain(other).collect();
    (!named.is_empty())
        .then(|| format!("{}{others}: {}", named.join(", "), why.join("; elsewhere ")))
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
