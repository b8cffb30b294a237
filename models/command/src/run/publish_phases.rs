//! What a run through several scenes leaves behind: one `history.csv`, `report.html` and `summary.json` over all of it, and a folder a part with everything
//! that a run of its scene leaves.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

use mbd_campaign::phases::{FlownPart, shared_metrics, table, with_histories, with_motion};
use mbd_report::files::{self, file_name};
use mbd_report::{Report, ReportTable, metrics_table};
use mbd_runtime::scene::Scene;
use mbd_runtime::{Joined, MetricReader, MetricValue, MissingMetric, Sampling, Trajectory};
use serde::Serialize;
use serde_json::Value;

use super::Phase;
use super::metrics::WindowOfMetric;
use super::outcome::CONTENT;
use super::phases::{PhasedRun, Segment};
use super::publish::{publish, shown};
use super::summary::{ErrorEstimate, rows_of_estimate, summary_json};

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

/// The folder of a part in that of the run.
fn folder_of(index: usize, phase: &Phase) -> PathBuf {
    let title = format!("{}_{}", index + 1, phase.model.scene().name);
    PathBuf::from(file_name(&title))
}

/// Every part with its phase, in the order of the run.
fn told<'a>(
    phases: &'a [Phase],
    segments: &'a [Segment],
) -> impl Iterator<Item = (usize, &'a Phase, &'a Segment)> {
    let told = segments.iter().enumerate();
    told.filter_map(|(index, segment)| Some((index, phases.get(segment.phase)?, segment)))
}

/// The histories of all parts as one, and what each metric of the scenes is over those that declare it in the same words, with when the last of these ended [s].
/// Another one of a name that a scene before has is told by the number of its own scene, `top (2)`.
fn together(
    phases: &[Phase],
    segments: &[Segment],
) -> (Trajectory, Vec<(MetricValue, WindowOfMetric)>) {
    let parts = segments.iter();
    let parts = parts.map(|segment| (segment.phase, &segment.outcome.trajectory));
    let stopped = segments
        .iter()
        .any(|segment| segment.outcome.error.is_some());
    joined(phases, &parts.collect::<Vec<_>>(), stopped)
}

/// The same of parts of a run, each the history of a phase by its index; one that stopped early has no metrics.
pub(super) fn joined(
    phases: &[Phase],
    parts: &[(usize, &Trajectory)],
    stopped: bool,
) -> (Trajectory, Vec<(MetricValue, WindowOfMetric)>) {
    let empty = |phase: &Phase| Trajectory::new(&*phase.model, Sampling::Steps, CONTENT);
    let empty: Vec<Trajectory> = phases.iter().map(empty).collect();
    let columns = Joined::new(&empty.iter().collect::<Vec<_>>());
    let joined = columns.join(parts);
    let scenes: Vec<&Scene> = phases.iter().map(|phase| phase.model.scene()).collect();
    let mut told: Vec<(MetricValue, WindowOfMetric)> = Vec::new();
    for shared in shared_metrics(&scenes) {
        let (metric, scene) = (shared.metric, shared.scene);
        let counts = |phase: usize| shared.scenes.contains(&phase);
        let first = shared.scenes.first().copied().unwrap_or_default();
        let names = empty.get(first).map_or(&[][..], Trajectory::names);
        let reader = MetricReader::new(metric, scene, names);
        let reader = reader.map(|reader| columns.reader(first, &reader));
        let end = reader
            .as_ref()
            .map_or(f64::NAN, |it| joined.end_in(it, &counts));
        let read = match (reader, stopped) {
            (Err(missing), _) => Err(missing),
            (Ok(_), true) => Err(MissingMetric::StoppedEarly),
            (Ok(reader), false) => joined.measured_in(&reader, &counts),
        };
        let mut value = MetricValue::new(metric, scene, read);
        if told.iter().any(|(other, _)| other.name == value.name) {
            value.name = format!("{} ({})", value.name, first + 1);
        }
        let window = WindowOfMetric::new(metric, (end, end < joined.end()));
        told.push((value, window));
    }
    (joined, told)
}

/// One sentence a metric whose window reaches beyond the end of its scenes in a run that came to its end.
#[must_use]
pub fn cut_windows_of_all(phases: &[Phase], segments: &[Segment]) -> Vec<String> {
    let (_, told) = together(phases, segments);
    let told = told.iter().filter_map(|(value, window)| {
        let was_there = !matches!(
            value.value,
            Err(MissingMetric::StoppedEarly | MissingMetric::NotReached)
        );
        window.cut(&value.name).filter(|_| was_there)
    });
    told.collect()
}

/// The run as JSON; `besides`: metrics that no scene declares.
///
/// # Errors
/// Numbers that JSON cannot hold.
pub fn summary(
    (phases, run): (&[Phase], &PhasedRun),
    besides: &[MetricValue],
) -> io::Result<String> {
    let segments = run.segments.as_slice();
    let mut parts = Vec::with_capacity(segments.len());
    for (_, phase, segment) in told(phases, segments) {
        let run = summary_json(phase.model.scene(), &segment.plan, &segment.outcome)?;
        let handover = segment.handover.as_ref();
        parts.push(PhaseSummary {
            from_s: segment.from,
            ended_by: segment.told(phase).event(),
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
    let (_, metrics) = together(phases, segments);
    let metrics = metrics.into_iter();
    let metrics: BTreeMap<String, Option<f64>> = metrics
        .map(|(told, _)| told)
        .chain(besides.iter().cloned())
        .map(|told| (told.name, told.value.ok()))
        .collect();
    let whole = serde_json::json!({
        "status": status.map_or("ok", |error| error.cause.status()),
        "reached_s": segments.last().map(|segment| segment.outcome.time),
        "metrics": metrics,
        "error_estimate": run.estimate.as_ref().ok().map(ErrorEstimate::from),
        "error_not_estimated": run.estimate.as_ref().err().map(ToString::to_string),
        "phases": parts,
    });
    Ok(serde_json::to_string_pretty(&whole)? + "\n")
}

/// Writes everything into a folder and gives the table of the run and that of its metrics, if it has any; `besides`: those that no scene declares.
///
/// # Errors
/// The folder or a file cannot be written; the error names it. The summary is only there if all others are.
pub fn publish_phases(
    (phases, run): (&[Phase], &PhasedRun),
    besides: &[MetricValue],
    folder: &Path,
) -> io::Result<Vec<ReportTable>> {
    let segments = run.segments.as_slice();
    files::make_folder(folder)?;
    let file = folder.join("summary.json");
    files::remove(&file)?;
    for (index, phase, segment) in told(phases, segments) {
        let own = folder.join(folder_of(index, phase));
        publish(phase.model.scene(), &segment.plan, &segment.outcome, &own)?;
    }
    let (joined, metrics) = together(phases, segments);
    let metrics = metrics.into_iter().map(|(told, _)| told);
    let metrics: Vec<MetricValue> = metrics.chain(besides.iter().cloned()).collect();
    files::write_whole(&folder.join("history.csv"), |to| joined.to_csv(to))?;
    let parts = told(phases, segments).map(|(_, phase, segment)| segment.told(phase));
    let parts: Vec<FlownPart<'_>> = parts.collect();
    let mut error = ReportTable::new("Error")
        .column("what", "")
        .column("value", "");
    for (what, value) in rows_of_estimate(&run.estimate) {
        error.push([what.into(), value]);
    }
    let tables = [table(&parts), metrics_table(&metrics), error].into_iter();
    let tables: Vec<ReportTable> = tables.filter(|table| !table.is_empty()).collect();
    page(phases, segments, &tables, (&parts, &joined)).write(folder.join("report.html"))?;
    files::write_text(&file, &summary((phases, run), besides)?)?;
    Ok(tables)
}

/// The page over all parts; each has one of its own, which it links to.
fn page(
    phases: &[Phase],
    segments: &[Segment],
    tables: &[ReportTable],
    (parts, joined): (&[FlownPart<'_>], &Trajectory),
) -> Report {
    let names: Vec<&str> = told(phases, segments)
        .map(|(_, phase, _)| phase.model.scene().name.as_str())
        .collect();
    let page = Report::new(names.join(" → "));
    let page = tables.iter().fold(page, |page, table| page.table(table));
    let short = cut_windows_of_all(phases, segments).into_iter();
    let mut page = short.fold(page, |page, text| page.paragraph(&text));
    for (index, phase, segment) in told(phases, segments) {
        if let Some(error) = &segment.outcome.error {
            page = page.paragraph(&format!("The run stopped early: {error}"));
        }
        let to = folder_of(index, phase).join("report.html");
        let text = format!("{}. {} alone", index + 1, phase.model.scene().name);
        page = page.link(&text, &to.to_string_lossy());
    }
    let runs = told(phases, segments);
    let runs =
        runs.map(|(_, phase, segment)| shown(phase.model.scene(), &segment.plan, &segment.outcome));
    let page = with_motion(page, &runs.collect::<Vec<_>>());
    with_histories(page, parts, joined)
}
