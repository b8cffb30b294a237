//! The numbers of a run: as JSON for programs, as a table for people.

use std::collections::BTreeMap;
use std::io;

use mbd_campaign::run::RunPlan;
use mbd_report::{Cell, ReportTable, significant};
use mbd_runtime::scene::{Plane, Scene, plain};
use mbd_runtime::{Layout, MomentumImbalance};
use serde::Serialize;

use super::estimate::{Estimate, Unestimated};
use super::metrics::metrics;
use super::outcome::RunOutcome;
use super::quality::Quality;
use super::start::{moved, moved_text};

/// The numbers of a run, for programs.
#[derive(Debug, Serialize)]
struct RunNumbers<'a> {
    scene: &'a str,
    coordinates: &'static str,
    planar: Option<&'static str>,
    status: &'a str,
    message: Option<String>,
    method: &'static str,
    step_s: Option<f64>,
    tolerance: Option<f64>,
    until_s: f64,
    reached_s: f64,
    ended_by: Option<&'a str>,
    steps: u64,
    rejected: u64,
    rhs: u64,
    jacobians: u64,
    factors: u64,
    stiff_steps: u64,
    method_changes: u64,
    rhs_per_s: f64,
    node_solves: u64,
    newton_mean: f64,
    newton_max: u64,
    switches: u64,
    start_moved: Option<StartMoved<'a>>,
    start_about: Vec<StartAbout>,
    start_undecided: Vec<String>,
    joint_drift_m: Option<f64>,
    joint_drift_rate_m_s: Option<f64>,
    energy_imbalance_j: Option<f64>,
    energy_imbalance_relative: Option<f64>,
    momentum_imbalance: Option<MomentumImbalance>,
    momentum_imbalance_relative: Option<f64>,
    momentum_undefined: Option<String>,
    error_estimate: Option<ErrorEstimate<'a>>,
    error_not_estimated: Option<String>,
    rounding_relative: f64,
    freedoms: usize,
    freedoms_held: usize,
    rows: usize,
    rows_kept: usize,
    rows_strategy: u64,
    rows_chosen: u64,
    rows_regularised: u64,
    lost_digits: u64,
    undetermined_rows: u64,
    not_finite: Vec<NotFiniteColumn<'a>>,
    wall_s: f64,
    wall_s_per_s: f64,
    params: BTreeMap<&'a str, f64>,
    metrics: BTreeMap<String, Option<f64>>,
    last: BTreeMap<String, f64>,
    events: &'a [(f64, String)],
}

/// An output that is infinite or not a number in some rows of the history.
#[derive(Debug, Serialize)]
struct NotFiniteColumn<'a> {
    column: &'a str,
    from_s: f64,
    rows: usize,
}

/// The quantity that is off most, by a second, finer run.
#[derive(Debug, Serialize)]
pub(super) struct ErrorEstimate<'a> {
    column: &'a str,
    rms: f64,
    relative: f64,
}

impl<'a> From<&'a Estimate> for ErrorEstimate<'a> {
    fn from(it: &'a Estimate) -> Self {
        ErrorEstimate {
            column: &it.column,
            rms: it.error,
            relative: it.relative,
        }
    }
}

/// Of the bodies that the settings place the one that the start moved furthest.
#[derive(Debug, Serialize)]
struct StartMoved<'a> {
    name: &'a str,
    distance_m: f64,
    angle_rad: f64,
    velocity_m_s: f64,
    angular_velocity_rad_s: f64,
}

/// Where a coordinate starts that is said to be about a value [m or rad].
#[derive(Debug, Serialize)]
struct StartAbout {
    name: String,
    said: f64,
    taken: f64,
}

impl From<(String, f64, f64)> for StartAbout {
    fn from((name, said, taken): (String, f64, f64)) -> Self {
        StartAbout { name, said, taken }
    }
}

impl StartAbout {
    fn text(&self, scene: &Scene) -> String {
        let found = scene.joint_coordinate(&self.name);
        let found = found.and_then(|(joint, number, _)| scene.coordinate(joint, number));
        let (factor, unit) = match found.is_some_and(|(_, it)| it.is_angle()) {
            true => (1f64.to_degrees(), "deg"),
            false => (1.0, "m"),
        };
        let [said, taken] = [self.said, self.taken].map(|x| factor * x);
        let sign = if taken < said { '-' } else { '+' };
        let by = significant((taken - said).abs(), 2);
        format!(
            "`{}` at {taken:.6} {unit}, {sign}{by} {unit} from {said:.6} {unit}",
            self.name
        )
    }
}

/// The numbers of a run as JSON.
///
/// # Errors
/// Numbers that JSON cannot hold.
pub fn summary_json(scene: &Scene, plan: &RunPlan, outcome: &RunOutcome) -> io::Result<String> {
    let trajectory = &outcome.trajectory;
    let quality = Quality::of(trajectory);
    let layout = Layout::new(scene);
    let statistics = trajectory.statistics;
    let per_second = |count: f64| {
        if outcome.time > 0.0 {
            count / outcome.time
        } else {
            0.0
        }
    };
    let method = plan.options.method;
    let names = trajectory.names().iter();
    let last = names.filter_map(|name| {
        let value = trajectory.column(&name.name)?.last()?;
        value.is_finite().then(|| (name.name.clone(), *value))
    });
    let summary = RunNumbers {
        scene: &scene.name,
        coordinates: scene.coordinates.word(),
        planar: scene.planar.map(Plane::word),
        status: outcome
            .error
            .as_ref()
            .map_or("ok", |error| error.cause.status()),
        message: outcome.error.as_ref().map(ToString::to_string),
        method: method.word(),
        step_s: method.fixed_step(),
        tolerance: method.tolerance().map(|[rtol, _]| rtol),
        until_s: plan.until,
        reached_s: outcome.time,
        ended_by: outcome.ended_by.as_deref(),
        steps: statistics.steps,
        rejected: statistics.rejected,
        rhs: statistics.rhs,
        jacobians: statistics.jacobians,
        factors: statistics.factors,
        stiff_steps: statistics.stiff_steps,
        method_changes: statistics.method_changes,
        rhs_per_s: per_second(statistics.rhs as f64),
        node_solves: statistics.node_solves,
        newton_mean: statistics.node_iterations_mean(),
        newton_max: statistics.node_iterations_max,
        switches: statistics.switches,
        start_moved: moved(plan, outcome).map(|moved| StartMoved {
            name: &moved.name,
            distance_m: moved.distance,
            angle_rad: moved.angle,
            velocity_m_s: moved.velocity,
            angular_velocity_rad_s: moved.angular_velocity,
        }),
        start_about: plan
            .assembly
            .told_about(scene)
            .into_iter()
            .map(StartAbout::from)
            .collect(),
        start_undecided: plan.assembly.told_undecided(scene),
        joint_drift_m: quality.drift,
        joint_drift_rate_m_s: quality.drift_rate,
        energy_imbalance_j: outcome.imbalance.map(|it| it.energy),
        energy_imbalance_relative: outcome.imbalance.map(|it| it.relative()),
        momentum_imbalance: outcome.momentum,
        momentum_imbalance_relative: outcome.momentum.map(|it| it.relative()),
        momentum_undefined: held(scene),
        error_estimate: outcome.estimate.as_ref().ok().map(ErrorEstimate::from),
        error_not_estimated: outcome.estimate.as_ref().err().map(ToString::to_string),
        rounding_relative: outcome.rounding,
        freedoms: layout.freedoms_at_start(),
        freedoms_held: layout.freedoms(),
        rows: layout.nc,
        rows_kept: layout.rank(),
        rows_strategy: statistics.rows_strategy,
        rows_chosen: statistics.rows_chosen,
        rows_regularised: statistics.rows_regularised,
        lost_digits: statistics.lost_digits,
        undetermined_rows: trajectory.undetermined,
        not_finite: trajectory
            .not_finite()
            .into_iter()
            .map(|it| NotFiniteColumn {
                column: it.name,
                from_s: it.time,
                rows: it.rows,
            })
            .collect(),
        wall_s: outcome.wall_s,
        wall_s_per_s: per_second(outcome.wall_s),
        params: scene
            .params
            .iter()
            .map(|param| param.name.as_str())
            .zip(plan.params.iter().copied())
            .collect(),
        metrics: metrics(scene, outcome)
            .into_iter()
            .map(|told| (told.name, told.value.ok()))
            .collect(),
        last: last.collect(),
        events: &trajectory.events,
    };
    Ok(serde_json::to_string_pretty(&summary)? + "\n")
}

/// The run in one table. The clock is left out: the same run gives the same report.
pub fn table(scene: &Scene, plan: &RunPlan, outcome: &RunOutcome) -> ReportTable {
    let statistics = outcome.trajectory.statistics;
    let quality = Quality::of(&outcome.trajectory);
    let layout = Layout::new(scene);
    let name = plan.options.method.name();
    let method = match plan.options.method.tolerance() {
        Some([rtol, _]) => format!("{name}, relative tolerance {rtol:e}"),
        None => {
            let step = plan.options.method.fixed_step().unwrap_or(f64::NAN);
            format!("{name}, fixed step {step} s")
        }
    };
    let within_nodes = layout.effective_lines > 0;
    let switches = match plan.options.locate {
        true if within_nodes => {
            "located, but for lines that end at `static` and `stepwise` nodes: these switch within the balance of the node"
        }
        true => "located",
        false => "not located",
    };
    let mut rows: Vec<(&str, Cell)> = vec![
        ("method", method.into()),
        ("slack/taut switches and events", switches.into()),
        ("end asked for [s]", plan.until.into()),
        ("end reached [s]", outcome.time.into()),
        ("steps", Cell::Count(statistics.steps)),
        ("rejected steps", Cell::Count(statistics.rejected)),
        ("right-hand sides", Cell::Count(statistics.rhs)),
    ];
    if let Some(event) = &outcome.ended_by {
        rows.insert(4, ("ended by the event", event.as_str().into()));
    }
    if scene.planar.is_some() || !scene.joints.is_empty() {
        rows.insert(0, ("coordinates", coordinates(scene).into()));
    }
    if statistics.factors > 0 {
        rows.push(("Jacobians", Cell::Count(statistics.jacobians)));
        rows.push(("factors", Cell::Count(statistics.factors)));
        rows.push((
            "steps of the stiff method",
            Cell::Count(statistics.stiff_steps),
        ));
        rows.push((
            "changes of the method",
            Cell::Count(statistics.method_changes),
        ));
    }
    if !layout.nodes.is_empty() {
        let mean = statistics.node_iterations_mean();
        let most = Cell::Count(statistics.node_iterations_max);
        rows.push(("Newton iterations a solve, mean", mean.into()));
        rows.push(("Newton iterations a solve, most", most));
    }
    if !scene.lines.is_empty() || !scene.events.is_empty() {
        rows.push((
            "located slack/taut switches",
            Cell::Count(statistics.switches),
        ));
    }
    if let Some(moved) = moved(plan, outcome) {
        rows.push((
            "moved at the start so that the joints hold",
            moved_text(moved).into(),
        ));
    }
    if layout.nc > 0 {
        let [start, held] = [layout.freedoms_at_start(), layout.freedoms()];
        let freedoms: Cell = match start == held {
            true => start.into(),
            false => format!("{start}, {held} while all locks and joints hold").into(),
        };
        rows.push(("freedoms", freedoms));
        rows.push(("rows of the joints", layout.nc.into()));
        rows.push((
            "rows that repeat others",
            (layout.nc - layout.rank()).into(),
        ));
        rows.push((
            "how the rows were solved",
            strategy(statistics.rows_strategy).into(),
        ));
        if statistics.rows_chosen > 0 {
            let chosen = Cell::Count(statistics.rows_chosen);
            rows.push(("times rows were chosen anew", chosen));
        }
        if statistics.rows_regularised > 0 {
            let stages = Cell::Count(statistics.rows_regularised);
            rows.push(("stages regularised, in steps of order two", stages));
        }
        if statistics.lost_digits > 0 {
            let digits = Cell::Count(statistics.lost_digits);
            rows.push(("digits that uneven masses cost at the start", digits));
        }
        if outcome.trajectory.undetermined > 0 {
            let undetermined = Cell::Count(outcome.trajectory.undetermined);
            rows.push(("rows with reactions that have no value", undetermined));
        }
        for about in plan
            .assembly
            .told_about(scene)
            .into_iter()
            .map(StartAbout::from)
        {
            rows.push((
                "starts about what was said, as its loop closes",
                about.text(scene).into(),
            ));
        }
        let undecided = plan.assembly.told_undecided(scene);
        if !undecided.is_empty() {
            let names = format!("`{}`", undecided.join("`, `"));
            rows.push((
                "starts that nothing decides: chosen, near zero",
                names.into(),
            ));
        }
        rows.push(("joints open by at most |Φ| [m]", quality.drift.into()));
        rows.push((
            "joints open at a rate of at most |dΦ/dt| [m/s]",
            quality.drift_rate.into(),
        ));
    }
    if let Some(imbalance) = outcome.imbalance {
        let missed = imbalance.energy;
        rows.push(("energy balance missed by at most [J]", missed.into()));
        // Of energies that are far larger than what moves nobody sees what was made or lost.
        rows.push((
            "the same over the energy that moved",
            match imbalance.rounding > imbalance.moved && imbalance.moved > 0.0 {
                true => "not told: below the rounding of the energies".into(),
                false => imbalance.relative().into(),
            },
        ));
    }
    if let Some(momentum) = outcome.momentum {
        let missed = format!(
            "{}, {}",
            plain(momentum.linear, 2),
            plain(momentum.angular, 2)
        );
        rows.push((
            "momentum balance missed by at most [kg m/s], [kg m²/s]",
            missed.into(),
        ));
        let share = momentum.relative();
        rows.push(("the same over the momentum that moved", share.into()));
    }
    if let Some(why) = held(scene) {
        rows.push(("momentum balance", why.into()));
    }
    let estimated = rows_of_estimate(&outcome.estimate);
    rows.extend(
        estimated
            .iter()
            .map(|(what, value)| (what.as_str(), value.clone())),
    );
    let mut table = ReportTable::new("Run")
        .column("what", "")
        .column("value", "");
    for (what, value) in rows {
        table.push([what.into(), value]);
    }
    table
}

/// What a run is off by, or why that is not told, as rows of a table.
pub(super) fn rows_of_estimate(found: &Result<Estimate, Unestimated>) -> Vec<(String, Cell)> {
    let estimate = match found {
        Ok(estimate) => estimate,
        // What stopped the run stands in its place.
        Err(Unestimated::Stopped | Unestimated::OfWhole) => return Vec::new(),
        Err(why) => {
            let why = format!("not estimated: {why}");
            return vec![("error".to_owned(), why.as_str().into())];
        }
    };
    let unit = match estimate.unit.as_str() {
        "" => String::new(),
        unit => format!(" {unit}"),
    };
    let how = if estimate.is_metric { "" } else { " (rms)" };
    let off = format!(
        "`{}`, {}{unit}{how}",
        estimate.column,
        plain(estimate.error, 2)
    );
    vec![
        ("off most, by a second, finer run".to_owned(), off.into()),
        (
            format!("the same over {}", estimate.measure()),
            estimate.relative.into(),
        ),
    ]
}

/// The family of coordinates and the plane that a scene was compiled for, whether it was declared or found.
fn coordinates(scene: &Scene) -> String {
    let family = scene.coordinates.word();
    match scene.planar {
        Some(plane) => format!("{family}, in the plane {}", plane.word()),
        None => family.to_owned(),
    }
}

/// Why a run has no balance of momentum; `None` where it has.
fn held(scene: &Scene) -> Option<String> {
    let [by, part] = scene.held_by_ground()?;
    Some(format!(
        "not defined: `{part}` is held by the ground (`{by}`)"
    ))
}

/// The last strategy of the fallback chain in words: `Statistics::rows_strategy`.
fn strategy(strategy: u64) -> &'static str {
    match strategy {
        0 | 1 => "in the order fixed beforehand",
        2 => "at worst, some rows chosen anew for a step",
        3 => "at worst, by the whole matrix with pivots",
        _ => "at worst, a stage with all rows regularised",
    }
}
