//! The metrics of a run as a table.

use mbd_runtime::MetricValue;
use mbd_runtime::scene::plain;

use super::table::{Cell, ReportTable};

/// What a value is off by is told beyond this part of it: it has nine digits.
const TOLD: f64 = 1e-9;

/// The metrics of a run, from [`Trajectory::metrics`](mbd_runtime::Trajectory::metrics); without rows where there are none.
#[must_use]
pub fn metrics_table(told: &[MetricValue]) -> ReportTable {
    let mut table = ReportTable::new("Metrics")
        .column("name", "")
        .column("taken", "")
        .number("value", "", 9)
        .column("unit", "")
        .column("what", "");
    for metric in told {
        let (value, unit): (Cell, &str) = match metric.value {
            Ok(value) => (value.into(), &metric.unit),
            Err(_) => (Cell::Missing, ""),
        };
        table.push([
            metric.name.as_str().into(),
            metric.take.keyword().into(),
            value,
            unit.into(),
            metric.doc.trim().into(),
        ]);
    }
    let missing = told.iter().filter_map(|metric| {
        let why = metric.value.err()?;
        Some(format!("`{}` has no value: {why}", metric.name))
    });
    let rough = told.iter().filter_map(|metric| {
        let value = metric.value.ok()?;
        (metric.unresolved > TOLD * value.abs()).then(|| {
            format!(
                "`{}` may be off by {} {}: its quantity is noise, or changes faster than halves of steps resolve",
                metric.name,
                plain(metric.unresolved, 2),
                metric.unit
            )
        })
    });
    missing.chain(rough).fold(table, ReportTable::note)
}
