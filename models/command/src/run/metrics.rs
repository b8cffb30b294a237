//! The metrics that a scene declares, of one run.

use mbd_runtime::scene::{Scene, twelve_digits};
use mbd_runtime::{MetricValue, MissingMetric};

use super::RunPlan;
use super::outcome::RunOutcome;

/// The metrics of a run, in declaration order, then those of a campaign. A run that stopped early has none: what it did not reach may have changed each of them.
#[must_use]
pub fn metrics(scene: &Scene, outcome: &RunOutcome) -> Vec<MetricValue> {
    let mut told = outcome.trajectory.metrics(scene);
    told.extend(outcome.besides.iter().cloned());
    if outcome.error.is_some() {
        for metric in &mut told {
            metric.value = Err(MissingMetric::StoppedEarly);
        }
    }
    told
}

/// One sentence a metric whose window reaches beyond the end of a run that was flown, those of a campaign among them.
#[must_use]
pub fn cut_windows(scene: &Scene, plan: &RunPlan, outcome: &RunOutcome) -> Vec<String> {
    // An event may have ended it before.
    let mut told = windows(scene, plan.until.min(outcome.time));
    told.extend(outcome.partial.iter().map(|text| {
        format!(
            "warning: metric {text}; write an earlier `to`, or a later end of the run (`until`)"
        )
    }));
    told
}

/// One sentence a metric whose window reaches beyond the end of the run [s], the one that is planned or the one it came to.
#[must_use]
pub fn windows(scene: &Scene, until: f64) -> Vec<String> {
    // An end that an event made has rounding in its last digits.
    let until = twelve_digits(until);
    let told = scene.runs.metrics.iter().filter_map(|metric| {
        let name = &metric.name;
        match (metric.from, metric.to) {
            (Some(from), _) if from >= until => Some(format!(
                "warning: metric `{name}` counts from {from} s on, and the run ends at {until} s: it has no value; write an earlier `from`, or a later end of the run (`until`)"
            )),
            (_, Some(to)) if to > until => Some(format!(
                "warning: metric `{name}` counts up to {to} s, and the run ends at {until} s: it is told of what lies before; write an earlier `to`, or a later end of the run (`until`)"
            )),
            _ => None,
        }
    });
    told.collect()
}
