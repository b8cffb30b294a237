//! What a run leaves behind: `history.csv`, a figure an output and a group of lines, `report.html`, `summary.json`.

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, BufWriter};
use std::path::Path;

use mbd_runtime::scene::Scene;
use mbd_runtime::{Method, Trajectory};
use serde::Serialize;

use super::outcome::Outcome;
use super::plan::Plan;
use crate::describe;
use crate::report::{Cell, Figure, Report, Series, Table};

/// The numbers of a run, for programs.
#[derive(Debug, Serialize)]
struct Summary<'a> {
    scene: &'a str,
    status: &'a str,
    message: Option<String>,
    method: &'static str,
    step_s: Option<f64>,
    tolerance: Option<f64>,
    until_s: f64,
    reached_s: f64,
    steps: u64,
    rejected: u64,
    rhs: u64,
    rhs_per_s: f64,
    node_solves: u64,
    newton_mean: f64,
    newton_max: u64,
    switches: u64,
    wall_s: f64,
    wall_s_per_s: f64,
    params: BTreeMap<&'a str, f64>,
    last: BTreeMap<String, f64>,
    events: &'a [(f64, String)],
}

/// Curves that share a plot.
struct Group<'a> {
    name: String,
    file: String,
    unit: &'a str,
    curves: Vec<(&'a str, &'a [f64])>,
}

/// Writes everything into a folder and gives the table of the run.
///
/// # Errors
/// The folder or a file cannot be written.
pub fn publish(scene: &Scene, plan: &Plan, outcome: &Outcome, folder: &Path) -> io::Result<Table> {
    fs::create_dir_all(folder)?;
    let history = fs::File::create(folder.join("history.csv"))?;
    outcome.trajectory.to_csv(BufWriter::new(history))?;
    let summary = summary_json(scene, plan, outcome)?;
    fs::write(folder.join("summary.json"), summary)?;
    let table = table(plan, outcome);
    let mut report = Report::new(&scene.name);
    if !scene.doc.trim().is_empty() {
        report = report.paragraph(scene.doc.trim());
    }
    report = report.section("The run").table(&table);
    if let Some(error) = &outcome.error {
        report = report.paragraph(&format!("The run stopped early: {error}"));
    }
    if !outcome.trajectory.events.is_empty() {
        report = report.table(&events(&outcome.trajectory));
    }
    report = report.section("Histories");
    for group in groups(scene, &outcome.trajectory) {
        let figure = figure(&group, outcome.trajectory.times());
        fs::write(folder.join(&group.file), figure.svg())?;
        report = report.figure(&figure);
    }
    report = report.section("The scene").table(&describe::counts(scene));
    for things in describe::things(scene) {
        report = report.table(&things);
    }
    report.write(folder.join("report.html"))?;
    Ok(table)
}

/// The numbers of a run as JSON.
///
/// # Errors
/// Numbers that JSON cannot hold.
pub fn summary_json(scene: &Scene, plan: &Plan, outcome: &Outcome) -> io::Result<String> {
    let trajectory = &outcome.trajectory;
    let statistics = trajectory.statistics;
    let per_second = |count: f64| {
        if outcome.time > 0.0 {
            count / outcome.time
        } else {
            0.0
        }
    };
    let (method, step_s, tolerance) = match plan.options.method {
        Method::Rk4 { step } => ("rk4", Some(step), None),
        Method::Tsit5 { rtol, .. } => ("tsit5", None, Some(rtol)),
    };
    let names = trajectory.names().iter();
    let last = names.filter_map(|name| {
        let value = trajectory.column(&name.name)?.last()?;
        value.is_finite().then(|| (name.name.clone(), *value))
    });
    let summary = Summary {
        scene: &scene.name,
        status: outcome
            .error
            .as_ref()
            .map_or("ok", |error| error.cause.status()),
        message: outcome.error.as_ref().map(ToString::to_string),
        method,
        step_s,
        tolerance,
        until_s: plan.until,
        reached_s: outcome.time,
        steps: statistics.steps,
        rejected: statistics.rejected,
        rhs: statistics.rhs,
        rhs_per_s: per_second(statistics.rhs as f64),
        node_solves: statistics.node_solves,
        newton_mean: statistics.node_iterations_mean(),
        newton_max: statistics.node_iterations_max,
        switches: statistics.switches,
        wall_s: outcome.wall_s,
        wall_s_per_s: per_second(outcome.wall_s),
        params: scene
            .params
            .iter()
            .map(|param| param.name.as_str())
            .zip(plan.params.iter().copied())
            .collect(),
        last: last.collect(),
        events: &trajectory.events,
    };
    Ok(serde_json::to_string_pretty(&summary)? + "\n")
}

/// The run in one table. The clock is left out: the same run gives the same report.
fn table(plan: &Plan, outcome: &Outcome) -> Table {
    let statistics = outcome.trajectory.statistics;
    let method = match plan.options.method {
        Method::Rk4 { step } => format!("RK4, fixed step {step} s"),
        Method::Tsit5 { rtol, .. } => format!("Tsit5, relative tolerance {rtol:e}"),
    };
    let switches = if plan.options.locate {
        "located"
    } else {
        "not located"
    };
    let rows: [(&str, Cell); 10] = [
        ("method", method.into()),
        ("slack/taut switches and events", switches.into()),
        ("end asked for [s]", plan.until.into()),
        ("end reached [s]", outcome.time.into()),
        ("steps", Cell::Count(statistics.steps)),
        ("rejected steps", Cell::Count(statistics.rejected)),
        ("right-hand sides", Cell::Count(statistics.rhs)),
        (
            "Newton iterations a solve, mean",
            statistics.node_iterations_mean().into(),
        ),
        (
            "Newton iterations a solve, most",
            Cell::Count(statistics.node_iterations_max),
        ),
        ("located switches", Cell::Count(statistics.switches)),
    ];
    let mut table = Table::new("Run").column("what", "").column("value", "");
    for (what, value) in rows {
        table.push([what.into(), value]);
    }
    table
}

/// The first events of a run.
fn events(trajectory: &Trajectory) -> Table {
    const SHOWN: usize = 40;
    let mut table = Table::new("Events")
        .number("time", "s", 9)
        .column("what", "");
    for (time, what) in trajectory.events.iter().take(SHOWN) {
        table.push([(*time).into(), what.as_str().into()]);
    }
    match trajectory.events.len() {
        all if all > SHOWN => table.note(format!("{} more are in summary.json", all - SHOWN)),
        _ => table,
    }
}

/// One plot for each output and for the tensions of each line, repeated lines together.
fn groups<'a>(scene: &'a Scene, trajectory: &'a Trajectory) -> Vec<Group<'a>> {
    let outputs = scene
        .outputs
        .iter()
        .map(|output| (output.name.as_str(), "", false));
    let lines = scene.lines.iter().map(|line| {
        let base = line.name.split('[').next().unwrap_or(&line.name);
        (base, "tension", true)
    });
    let mut groups: Vec<Group<'a>> = Vec::new();
    for (owner, what, is_line) in outputs.chain(lines) {
        let title = [owner, what].join(" ").trim().to_string();
        if groups.iter().any(|group| group.name == title) {
            continue;
        }
        let belongs = |name: &str| match name.rsplit_once('.') {
            Some((line, "tension")) if is_line => line.split('[').next() == Some(owner),
            Some((output, _)) => !is_line && output == owner,
            None => !is_line && name == owner,
        };
        let columns: Vec<_> = trajectory
            .names()
            .iter()
            .filter(|name| belongs(&name.name))
            .collect();
        let curves = columns
            .iter()
            .filter_map(|name| Some((name.name.as_str(), trajectory.column(&name.name)?)));
        groups.push(Group {
            file: format!(
                "{}.svg",
                title.replace(|c: char| !c.is_ascii_alphanumeric(), "_")
            ),
            name: title,
            unit: columns.first().map_or("", |name| &name.unit),
            curves: curves.collect(),
        });
    }
    groups
}

fn figure<'a>(group: &Group<'a>, times: &'a [f64]) -> Figure<'a> {
    let what = group.name.rsplit(' ').next().unwrap_or_default();
    let figure = Figure::new(&group.name).x("time", "s").y(what, group.unit);
    group.curves.iter().fold(figure, |figure, (name, values)| {
        figure.series(Series::new(*name, times, values))
    })
}
