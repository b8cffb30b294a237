//! What a run through several scenes leaves behind: one `history.csv`, `report.html` and `summary.json` over all of it, and a folder a part with everything
//! that a run of its scene leaves.

use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

use mbd_runtime::Trajectory;
use serde::Serialize;
use serde_json::Value;

use super::phases::{Phase, Segment};
use super::publish::publish;
use super::summary::summary_json;
use crate::files;
use crate::report::{Cell, Figure, Report, ReportTable, Series};

/// A part of the run, for programs.
#[derive(Serialize)]
struct PhaseSummary<'a> {
    from_s: f64,
    ended_by: Option<&'a str>,
    carried: &'a [String],
    dropped: &'a [String],
    started: &'a [String],
    momentum: Option<[[f64; 6]; 2]>,
    energies_j: Option<[Option<[f64; 3]>; 2]>,
    run: Value,
}

/// The event that ended a part.
fn ended_by<'a>(phase: &'a Phase<'_>, segment: &Segment) -> Option<&'a str> {
    let event = phase.scene.events.get(segment.ended_by?)?;
    Some(event.name.as_str())
}

/// The folder of a part in that of the run.
fn folder_of(index: usize, phase: &Phase<'_>) -> PathBuf {
    PathBuf::from(format!("{}_{}", index + 1, phase.scene.name))
}

/// Every part with its phase, in the order of the run.
fn told<'a, 'b>(
    phases: &'a [Phase<'b>],
    segments: &'a [Segment],
) -> impl Iterator<Item = (usize, &'a Phase<'b>, &'a Segment)> {
    let told = segments.iter().enumerate();
    told.filter_map(|(index, segment)| Some((index, phases.get(segment.phase)?, segment)))
}

/// The run as JSON.
///
/// # Errors
/// Numbers that JSON cannot hold.
pub fn summary(phases: &[Phase<'_>], segments: &[Segment]) -> io::Result<String> {
    let mut parts = Vec::with_capacity(segments.len());
    for (_, phase, segment) in told(phases, segments) {
        let run = summary_json(phase.scene, &segment.plan, &segment.outcome)?;
        let handover = segment.handover.as_ref();
        parts.push(PhaseSummary {
            from_s: segment.from,
            ended_by: ended_by(phase, segment),
            carried: handover.map_or(&[][..], |it| it.carried.as_slice()),
            dropped: handover.map_or(&[][..], |it| it.dropped.as_slice()),
            started: handover.map_or(&[][..], |it| it.started.as_slice()),
            momentum: handover.map(|it| it.momentum),
            energies_j: handover.map(|it| it.energies),
            run: serde_json::from_str(&run)?,
        });
    }
    let status = segments
        .last()
        .and_then(|segment| segment.outcome.error.as_ref());
    let whole = serde_json::json!({
        "status": status.map_or("ok", |error| error.cause.status()),
        "reached_s": segments.last().map(|segment| segment.outcome.time),
        "phases": parts,
    });
    Ok(serde_json::to_string_pretty(&whole)? + "\n")
}

/// Writes everything into a folder and gives the table of the run.
///
/// # Errors
/// The folder or a file cannot be written; the error names it. The summary is only there if all others are.
pub fn publish_phases(
    phases: &[Phase<'_>],
    segments: &[Segment],
    folder: &Path,
) -> io::Result<ReportTable> {
    files::make_folder(folder)?;
    let file = folder.join("summary.json");
    files::remove(&file)?;
    for (index, phase, segment) in told(phases, segments) {
        let own = folder.join(folder_of(index, phase));
        publish(phase.scene, &segment.plan, &segment.outcome, &own)?;
    }
    let parts: Vec<&Trajectory> = segments
        .iter()
        .map(|segment| &segment.outcome.trajectory)
        .collect();
    let joined = Trajectory::joined(&parts);
    files::write_whole(&folder.join("history.csv"), |to| joined.to_csv(to))?;
    let table = table(phases, segments);
    page(phases, segments, &joined, &table).write(folder.join("report.html"))?;
    files::write_text(&file, &summary(phases, segments)?)?;
    Ok(table)
}

/// The parts of the run, what ended them and what went on.
fn table(phases: &[Phase<'_>], segments: &[Segment]) -> ReportTable {
    let mut table = ReportTable::new("Phases")
        .column("scene", "")
        .number("from", "s", 9)
        .number("to", "s", 9)
        .column("ended by", "")
        .column("goes on", "")
        .column("left behind", "")
        .column("begins", "")
        .number("energy before", "J", 7)
        .number("energy after", "J", 7);
    let list = |names: &[String]| Cell::from(names.join(", ").as_str());
    for (_, phase, segment) in told(phases, segments) {
        let handover = segment.handover.clone().unwrap_or_default();
        let energy = |side: usize| handover.energies[side].map(|kinds| kinds.iter().sum::<f64>());
        table.push([
            phase.scene.name.as_str().into(),
            segment.from.into(),
            segment.outcome.time.into(),
            ended_by(phase, segment).unwrap_or("").into(),
            list(&handover.carried),
            list(&handover.dropped),
            list(&handover.started),
            energy(0).into(),
            energy(1).into(),
        ]);
    }
    table
}

/// The page over all parts; each has one of its own, which it links to.
fn page(
    phases: &[Phase<'_>],
    segments: &[Segment],
    joined: &Trajectory,
    table: &ReportTable,
) -> Report {
    let names: Vec<&str> = told(phases, segments)
        .map(|(_, phase, _)| phase.scene.name.as_str())
        .collect();
    let mut page = Report::new(names.join(" → ")).table(table);
    for (index, phase, segment) in told(phases, segments) {
        if let Some(error) = &segment.outcome.error {
            page = page.paragraph(&format!("The run stopped early: {error}"));
        }
        let to = folder_of(index, phase).join("report.html");
        let text = format!("{}. {}, with its motion", index + 1, phase.scene.name);
        page = page.link(&text, &to.to_string_lossy());
    }
    page = page.section("Histories");
    for name in joined.names() {
        let owner = name.name.split('.').next().unwrap_or_default();
        let is_output = phases.iter().any(|phase| {
            let mut outputs = phase.scene.outputs.iter();
            outputs.any(|output| output.name == owner)
        });
        let (true, Some(values)) = (
            is_output || name.name.ends_with(".tension"),
            joined.column(&name.name),
        ) else {
            continue;
        };
        let rows = rows_with(segments, &name.name, values.len());
        let (Some(times), Some(values)) = (joined.times().get(rows.clone()), values.get(rows))
        else {
            continue;
        };
        let figure = Figure::new(&name.name)
            .x("time", "s")
            .y(&name.name, &name.unit)
            .series(Series::new(&name.name, times, values));
        page = page.figure(&figure);
    }
    page
}

/// The rows from the first scene that has a column to the last one; all of them where it has another name in its own scene.
fn rows_with(segments: &[Segment], column: &str, all: usize) -> Range<usize> {
    let is_without = |segment: &&Segment| segment.outcome.trajectory.column(column).is_none();
    if segments.iter().all(|segment| is_without(&segment)) {
        return 0..all;
    }
    let rows = |segment: &Segment| segment.outcome.trajectory.len();
    let before: usize = segments.iter().take_while(is_without).map(rows).sum();
    let behind: usize = segments.iter().rev().take_while(is_without).map(rows).sum();
    before..all.saturating_sub(behind)
}
