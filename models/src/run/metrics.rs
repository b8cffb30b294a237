//! The metrics that a scene declares, of one run.

use mbd_runtime::scene::Scene;
use mbd_runtime::{MetricValue, MissingMetric};

use super::outcome::RunOutcome;

/// The metrics of a run, in declaration order. A run that stopped early has none: what it did not reach may have changed each of them.
#[must_use]
pub fn metrics(scene: &Scene, outcome: &RunOutcome) -> Vec<MetricValue> {
    let mut told = outcome.trajectory.metrics(scene);
    if outcome.error.is_some() {
        for metric in &mut told {
            metric.value = Err(MissingMetric::StoppedEarly);
        }
    }
    told
}
