//! The error of a run: by a second, finer one, and by the energy that it made or lost.

use mbd_runtime::scene::{Formula, Function, Scene};
use mbd_runtime::{Model, Sampling, Simulation, Trajectory};

use super::outcome::{CONTENT, RunOutcome};
use mbd_campaign::run::RunPlan;

/// At most so many rows are compared.
const ROWS: usize = 400;
/// An angle that is nothing beside a turn [rad], and what is nothing in any unit.
const SMALL_ANGLE: f64 = 1e-3;
const NOTHING: f64 = 1e-9;
/// A column that never is more than this part of the largest value of its unit may be what rounding and tolerances leave of zero.
const SMALL_PART: f64 = 1e-6;
/// An error beyond this part of the size of what it is an error of is told.
const LARGE: f64 = 0.01;

/// The error of the quantity that is off most, of its own size.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Its column.
    pub column: String,
    /// Its unit.
    pub unit: String,
    /// Its error, the root of the mean square over the run [its unit].
    pub error: f64,
    /// The same over the largest value of the column, or over a millionth of the largest of its unit, where that is more; torques are of the unit of
    /// energies here, and forces of that over the largest length.
    pub relative: f64,
}

/// Flies the plan again with finer steps, and compares outputs and lines, or where there are none the motion of bodies and points.
pub fn estimate(model: &dyn Model<f64>, plan: &RunPlan, first: &Trajectory) -> Option<Estimate> {
    let rows = rows(first);
    let times: Vec<f64> = rows
        .iter()
        .filter_map(|row| first.times().get(*row))
        .copied()
        .collect();
    let until = *times.last()?;
    let mut finer = Trajectory::new(model, Sampling::At(times), CONTENT).measure(model, &[]);
    let mut run = Simulation::new(model, plan.options.finer()?).ok()?;
    plan.begin(&mut run).ok()?;
    run.record(until, &mut finer).ok()?;
    let outputs = model
        .scene()
        .outputs
        .iter()
        .map(|output| output.name.as_str());
    let lines = model.scene().lines.iter().map(|line| line.name.as_str());
    let bodies = model.scene().bodies.iter().map(|body| body.name.as_str());
    let points = model.scene().points.iter().map(|point| point.name.as_str());
    let mut asked: Vec<&str> = outputs.chain(lines).collect();
    if asked.is_empty() {
        asked.extend(bodies.chain(points));
    }
    let counts = |name: &str| {
        // An output or one of its components, or a line.
        let owner = name.split('.').next().unwrap_or(name);
        asked.contains(&name) || asked.contains(&owner)
    };
    let deviations = first.deviations(&rows, &finer, |column| turn(model.scene(), column));
    let largest = |unit: &str| {
        let same = first.names().iter().zip(&deviations);
        let sizes = same.filter(|(name, _)| name.unit == unit);
        sizes.map(|(_, (_, size))| *size).fold(0.0, f64::max)
    };
    let scale = |unit: &str, own: f64| {
        // Torques are measured by the energy that moves, and forces by that over the way: where nothing else has their unit, zero has a size.
        let other = match unit {
            "N m" => largest("J"),
            "N" => largest("J") / largest("m"),
            _ => 0.0,
        };
        let largest = largest(unit).max(if other.is_finite() { other } else { 0.0 });
        let scale = own.max(SMALL_PART * largest);
        match unit {
            "rad" => scale.max(SMALL_ANGLE),
            "deg" => scale.max(SMALL_ANGLE.to_degrees()),
            _ => scale,
        }
    };
    let all = first.names().iter().zip(&deviations);
    let told = all.filter(|(name, _)| counts(&name.name));
    let estimates = told.filter_map(|(name, (deviation, size))| {
        let scale = scale(&name.unit, *size);
        (scale > NOTHING).then(|| Estimate {
            column: name.name.clone(),
            unit: name.unit.clone(),
            error: deviation.rms,
            relative: deviation.rms / scale,
        })
    });
    estimates.max_by(|a, b| a.relative.total_cmp(&b.relative))
}

/// How much apart values of an output mean the same [its unit]: a turn, where it is an `atan2`.
fn turn(scene: &Scene, column: &str) -> Option<f64> {
    let output = scene.outputs.iter().find(|output| output.name == column)?;
    match scene.said(&output.value) {
        Formula::Apply(Function::Atan2, _) => Some(std::f64::consts::TAU / output.unit.factor),
        _ => None,
    }
}

/// Rows at increasing times, evenly chosen; none at the instant of an event or a switch: what jumps there has two values, and of two runs one may stand
/// before it and one behind.
fn rows(history: &Trajectory) -> Vec<usize> {
    let times = history.times();
    let alone = |row: usize| {
        let Some(own) = times.get(row) else {
            return false;
        };
        let mut jumps = history.events.iter().map(|(at, _)| at);
        !jumps.any(|at| (at - own).abs() <= NOTHING * own.abs().max(NOTHING))
    };
    let every = times.len().div_ceil(ROWS).max(1);
    let last = times.len().saturating_sub(1);
    let chosen = (0..times.len()).filter(|row| row % every == 0 || *row == last);
    let chosen = chosen.filter(|row| alone(*row));
    let mut rows: Vec<usize> = Vec::new();
    for row in chosen {
        let before = rows.last().and_then(|before| times.get(*before));
        if before.is_some_and(|before| times.get(row).is_none_or(|time| time <= before)) {
            rows.pop();
        }
        rows.push(row);
    }
    rows
}

/// What makes a run less accurate than it should be, and what to change; `None` where nothing does.
#[must_use]
pub fn doubt(scene: &Scene, plan: &RunPlan, outcome: &RunOutcome) -> Option<String> {
    let change = match plan.options.method.fixed_step() {
        Some(step) => format!("take a shorter step than {step} s"),
        None => "take a tighter tolerance".to_owned(),
    };
    let by_energy = outcome
        .imbalance
        .map(|it| it.relative())
        .filter(|part| *part > LARGE);
    let by_momentum = outcome
        .momentum
        .map(|it| it.relative())
        .filter(|part| *part > LARGE);
    let by_estimate = outcome.estimate.as_ref().filter(|it| it.relative > LARGE);
    let by_rounding = Some(outcome.rounding).filter(|part| *part > 1e-3);
    let doubts = [
        by_estimate.map(|it| {
            format!(
                "`{}` is off by about {:.1e} {}, {:.1} % of its largest value: {change}; where that does not help, the motion is chaotic over this time",
                it.column,
                it.error,
                it.unit,
                100.0 * it.relative
            )
        }),
        by_energy.map(|part| format!("the run made or lost {:.1} % of the energy that moved: {change}", 100.0 * part)),
        by_momentum.map(|part| format!("the run made or lost {:.1} % of the momentum that moved: {change}", 100.0 * part)),
        by_rounding.map(|part| {
            format!("rounding of positions makes {:.1} % of the forces: put the origin of the world near what moves", 100.0 * part)
        }),
    ];
    let doubts: Vec<String> = doubts.into_iter().flatten().collect();
    (!doubts.is_empty()).then(|| format!("warning: {}: {}", scene.name, doubts.join("; ")))
}
