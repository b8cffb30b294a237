//! The metrics that a scene declares, of one run.

use mbd_runtime::scene::metrics::Metric;
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
    told.extend(outcome.partial.iter().map(|text| cut_of_campaign(text)));
    told
}

/// The same of a metric of a campaign, by what that says of it.
#[must_use]
pub fn cut_of_campaign(text: &str) -> String {
    format!("warning: metric {text}; write an earlier `to`, or a later end of the run (`until`)")
}

/// One sentence a metric whose window reaches beyond the end of the run [s], the one that is planned or the one it came to.
#[must_use]
pub fn windows(scene: &Scene, until: f64) -> Vec<String> {
    let metrics = scene.runs.metrics.iter();
    let told =
        metrics.filter_map(|metric| WindowOfMetric::new(metric, (until, false)).cut(&metric.name));
    told.collect()
}

/// The window of a metric, and what ends it at the latest: the run, or the scene that declares the metric in a run that goes on.
#[derive(Clone, Copy, Debug)]
pub struct WindowOfMetric {
    from: Option<f64>,
    to: Option<f64>,
    /// When that ends [s].
    end: f64,
    /// Whether it is the scene.
    is_scene: bool,
}

impl WindowOfMetric {
    /// That of a metric, with when the run or the scene ends [s].
    #[must_use]
    pub fn new(metric: &Metric, (end, is_scene): (f64, bool)) -> Self {
        WindowOfMetric {
            from: metric.from,
            to: metric.to,
            end,
            is_scene,
        }
    }

    /// What to say of the metric, by its name, where the end lies inside the window or before it.
    #[must_use]
    pub fn cut(&self, name: &str) -> Option<String> {
        // An end that an event made has rounding in its last digits.
        let end = twelve_digits(self.end);
        let [what, later] = match self.is_scene {
            true => ["its scene", ""],
            false => ["the run", ", or a later end of the run (`until`)"],
        };
        match (self.from, self.to) {
            (Some(from), _) if from >= end => Some(format!(
                "warning: metric `{name}` counts from {from} s on, and {what} ends at {end} s: it has no value; write an earlier `from`{later}"
            )),
            (_, Some(to)) if to > end => Some(format!(
                "warning: metric `{name}` counts up to {to} s, and {what} ends at {end} s: it is told of what lies before; write an earlier `to`{later}"
            )),
            _ => None,
        }
    }
}
