//! The metrics that a scene declares.

use mbd_runtime::scene::Scene;
use mbd_runtime::scene::metrics::Metric;
use serde_json::{Value, json};

use mbd_report::ReportTable;

/// The metrics of a scene: what is taken of what over a run.
#[must_use]
pub fn metrics(scene: &Scene) -> ReportTable {
    let mut table = ReportTable::new("Metrics")
        .column("name", "")
        .column("taken", "")
        .column("unit", "")
        .column("at", "")
        .column("from", "s")
        .column("to", "s")
        .column("what", "");
    for metric in &scene.runs.metrics {
        let unit = metric.unit(scene);
        table.push([
            metric.name.as_str().into(),
            metric.take.keyword().into(),
            if unit.is_empty() { "1" } else { &unit }.into(),
            event(metric, scene).into(),
            metric.from.into(),
            metric.to.into(),
            metric.doc.trim().into(),
        ]);
    }
    table
}

/// A metric for a program; times in s, the level in SI.
#[must_use]
pub fn metric_json(metric: &Metric, scene: &Scene) -> Value {
    json!({
        "name": metric.name,
        "take": metric.take.keyword(),
        "unit": metric.unit(scene),
        "at": event(metric, scene),
        "level": metric.level,
        "from": metric.from,
        "to": metric.to,
        "doc": metric.doc.trim(),
    })
}

/// The event that it needs.
fn event<'s>(metric: &Metric, scene: &'s Scene) -> Option<&'s str> {
    let event = scene.events.get(metric.event?)?;
    Some(&event.name)
}
