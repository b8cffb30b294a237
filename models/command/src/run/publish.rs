//! What a run leaves behind: `history.csv`, drawings of the mechanism, a figure an output and a group of lines, `report.html`, `summary.json`.

use std::io;
use std::path::Path;

use mbd_campaign::run::RunPlan;
use mbd_report::files;
use mbd_report::{Report, ReportTable, Run, Views, gltf, metrics_table};
use mbd_runtime::scene::Scene;
use mbd_runtime::{Layout, Trajectory};

use super::metrics::{cut_windows, metrics};
use super::outcome::RunOutcome;
use super::quality::not_finite;
use super::summary::{summary_json, table};
use crate::describe;

/// Writes everything into a folder and gives the table of the run and that of its metrics, if it has any.
///
/// # Errors
/// The folder or a file cannot be written; the error names it. Every file is whole, and the summary is only there if all others are.
pub fn publish(
    scene: &Scene,
    plan: &RunPlan,
    outcome: &RunOutcome,
    folder: &Path,
) -> io::Result<Vec<ReportTable>> {
    files::make_folder(folder)?;
    // The summary is written last: where it is, everything is.
    let summary = folder.join("summary.json");
    files::remove(&summary)?;
    files::write_whole(&folder.join("history.csv"), |to| {
        outcome.trajectory.to_csv(to)
    })?;
    let table = table(scene, plan, outcome);
    let views = Views::new(&shown(scene, plan, outcome));
    views.write(folder)?;
    let mut report = Report::new(&scene.name);
    if !scene.doc.trim().is_empty() {
        report = report.paragraph(scene.doc.trim());
    }
    if let Some(error) = &outcome.error {
        report = report.paragraph(&format!("The run stopped early: {error}"));
    }
    report = views.with_histories(views.with_motion(report));
    report = report.section("The run").table(&table);
    let metrics = metrics_table(&metrics(scene, outcome));
    if !metrics.is_empty() {
        let short = cut_windows(scene, plan, outcome).into_iter();
        report = report.table(&short.fold(metrics.clone(), ReportTable::note));
    }
    if let Some(text) = not_finite(&outcome.trajectory) {
        report = report.paragraph(&text);
    }
    if let Some(text) = not_unique(scene) {
        report = report.paragraph(&text);
    }
    if !outcome.trajectory.events.is_empty() {
        report = report.table(&events(&outcome.trajectory));
    }
    report = report.section("The scene").table(&describe::counts(scene));
    for things in describe::things(scene) {
        report = report.table(&things);
    }
    report.write(folder.join("report.html"))?;
    files::write_text(&summary, &summary_json(scene, plan, outcome)?)?;
    let tables = [table, metrics].into_iter();
    Ok(tables.filter(|table| !table.is_empty()).collect())
}

/// What is shown of a run.
#[must_use]
pub fn shown<'a>(scene: &'a Scene, plan: &'a RunPlan, outcome: &'a RunOutcome) -> Run<'a> {
    Run {
        inputs: Some(&plan.inputs),
        instants: &plan.instants,
        figures: &plan.figures,
        ..Run::new(scene, &plan.params, &outcome.trajectory)
    }
}

/// Writes the run into a folder as `motion.glb`, an animated glTF file. Whether there is any motion to show.
///
/// # Errors
/// The file cannot be written whole; the error names it.
pub fn publish_gltf(
    scene: &Scene,
    plan: &RunPlan,
    outcome: &RunOutcome,
    folder: &Path,
) -> io::Result<bool> {
    let Some(bytes) = gltf(&shown(scene, plan, outcome)) else {
        return Ok(false);
    };
    files::write_whole(&folder.join("motion.glb"), |to| to.write_all(&bytes))?;
    Ok(true)
}

/// Which reactions of `history.csv` are one choice of many.
fn not_unique(scene: &Scene) -> Option<String> {
    let redundancy = Layout::new(scene).redundancy;
    let names = redundancy.ambiguous.iter().filter_map(|of| {
        let joint = scene.joints.get(of.joint)?;
        Some(format!("`{}` ({})", joint.name, of.named().join(", ")))
    });
    let names: Vec<String> = names.collect();
    (!names.is_empty()).then(|| {
        format!(
            "The reactions of {} are not unique, because rows of these joints repeat each other: those in the history belong to rows left out carrying nothing. The motion does not depend on it.",
            names.join(", ")
        )
    })
}

/// The first events of a run.
fn events(trajectory: &Trajectory) -> ReportTable {
    const SHOWN: usize = 40;
    let mut table = ReportTable::new("Events")
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
