//! What is told of a run that came to several scenes: a table of its parts, histories over all of them, and metrics over those that each counts in.

use mbd_compiler::metric_text;
use mbd_report::{Cell, Figure, RecordedMotion, Report, ReportTable, Run, Series};
use mbd_runtime::scene::Scene;
use mbd_runtime::scene::metrics::Metric;
use mbd_runtime::{Handover, Trajectory};

/// A part of a run, flown in one scene.
#[derive(Clone, Copy, Debug)]
pub struct FlownPart<'p> {
    /// The scene.
    pub scene: &'p Scene,
    /// When it began [s].
    pub from: f64,
    /// Where it stands [s].
    pub until: f64,
    /// What it took over; `None` of the first.
    pub handover: Option<&'p Handover>,
    /// The event that ended it, by index in its scene.
    pub ended_by: Option<usize>,
}

impl<'p> FlownPart<'p> {
    /// The name of the event that ended it.
    #[must_use]
    pub fn event(&self) -> Option<&'p str> {
        let event = self.scene.events.get(self.ended_by?)?;
        Some(event.name.as_str())
    }
}

/// The parts of a run, what ended them and what went on.
#[must_use]
pub fn table(parts: &[FlownPart<'_>]) -> ReportTable {
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
    for part in parts {
        let handover = part.handover.cloned().unwrap_or_default();
        let energy = |side: usize| handover.energies[side].map(|kinds| kinds.iter().sum::<f64>());
        table.push([
            part.scene.name.as_str().into(),
            part.from.into(),
            part.until.into(),
            part.event().unwrap_or("").into(),
            list(&handover.carried),
            list(&handover.dropped),
            list(&handover.started),
            energy(0).into(),
            energy(1).into(),
        ]);
    }
    table
}

/// Adds the motion of all parts to a page: each is drawn while it lasts, with its number before its names.
#[must_use]
pub fn with_motion(page: Report, parts: &[Run<'_>]) -> Report {
    let labels: Vec<String> = (1..=parts.len()).map(|number| number.to_string()).collect();
    let labels = labels.iter().map(String::as_str);
    let parts: Vec<(&str, Run<'_>)> = labels.zip(parts.iter().copied()).collect();
    RecordedMotion::of_several(&parts).on(page)
}

/// Adds the histories over all parts to a page: outputs, and tensions of lines. `joined` is made of the histories of the parts.
#[must_use]
pub fn with_histories(page: Report, parts: &[FlownPart<'_>], joined: &Trajectory) -> Report {
    let mut page = page.section("Histories");
    for name in joined.names() {
        let owner = name.name.split(['.', ' ']).next().unwrap_or_default();
        let is_output = parts.iter().any(|part| {
            let mut outputs = part.scene.outputs.iter();
            outputs.any(|output| output.name == owner)
        });
        let told = is_output || name.name.ends_with(".tension");
        let Some(values) = joined.column(&name.name).filter(|_| told) else {
            continue;
        };
        // From the first to the last row of a scene that has it; nothing where the run did not come to one.
        let has = |value: &f64| !value.is_nan();
        let (Some(first), Some(last)) = (values.iter().position(has), values.iter().rposition(has))
        else {
            continue;
        };
        let rows = first..last + 1;
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

/// A metric with the scenes that declare it in the same words: it counts while one of these flies.
#[derive(Clone, Debug)]
pub struct SharedMetric<'s> {
    /// It, as the first of them has it.
    pub metric: &'s Metric,
    /// That scene.
    pub scene: &'s Scene,
    /// They, by index.
    pub scenes: Vec<usize>,
}

impl SharedMetric<'_> {
    /// What it takes, in the words of its scenes.
    #[must_use]
    pub fn text(&self) -> String {
        metric_text(self.scene, self.metric)
    }
}

/// The metrics that scenes declare, in the order of the scenes; those of one name that take something else, or the same of something else, each for itself.
#[must_use]
pub fn shared_metrics<'s>(scenes: &[&'s Scene]) -> Vec<SharedMetric<'s>> {
    let mut all: Vec<SharedMetric<'s>> = Vec::new();
    for (index, scene) in scenes.iter().enumerate() {
        for metric in &scene.runs.metrics {
            let text = metric_text(scene, metric);
            let alike = |known: &&mut SharedMetric<'s>| {
                known.metric.name == metric.name && known.text() == text
            };
            match all.iter_mut().find(alike) {
                Some(known) => known.scenes.push(index),
                None => all.push(SharedMetric {
                    metric,
                    scene,
                    scenes: vec![index],
                }),
            }
        }
    }
    all
}
