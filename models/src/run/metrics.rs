//! The metrics that a scene declares, of one run.

use mbd_campaign::Metrics;
use mbd_campaign::run::Plan;
use mbd_runtime::scene::Scene;

use super::outcome::Outcome;
use crate::report::{Cell, Table};

/// A metric of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Told<'a> {
    /// Its name.
    pub name: &'a str,
    /// How it is taken.
    pub take: &'static str,
    /// Its value and its unit; nothing where the run has none: it stopped early, an event did not happen, a history has no row at an event.
    pub value: Option<(f64, String)>,
}

/// The metrics of a run, in declaration order.
#[must_use]
pub fn metrics<'a>(scene: &'a Scene, plan: &Plan, outcome: &Outcome) -> Vec<Told<'a>> {
    let history = &outcome.trajectory;
    let read = match outcome.error {
        None => Metrics::of_history(scene, history, plan.every.is_none()),
        Some(_) => Vec::new(),
    };
    let value = |name: &str| {
        let metric = read.iter().find(|metric| metric.name == name)?;
        let value = metric.read(history);
        value.is_finite().then(|| (value, metric.unit.clone()))
    };
    let told = scene.runs.metrics.iter().map(|metric| Told {
        name: &metric.name,
        take: metric.take.keyword(),
        value: value(&metric.name),
    });
    told.collect()
}

/// They as a table; `None` where the scene declares none.
pub(super) fn metric_table(scene: &Scene, plan: &Plan, outcome: &Outcome) -> Option<Table> {
    let told = metrics(scene, plan, outcome);
    if told.is_empty() {
        return None;
    }
    let mut table = Table::new("Metrics")
        .column("name", "")
        .column("taken", "")
        .number("value", "", 9)
        .column("unit", "");
    for metric in told {
        let (value, unit): (Cell, String) = match metric.value {
            Some((value, unit)) => (value.into(), unit),
            None => (Cell::Missing, String::new()),
        };
        table.push([
            metric.name.into(),
            metric.take.into(),
            value,
            unit.as_str().into(),
        ]);
    }
    Some(table)
}
