//! Which cases keep their histories: a function of the results and the seed, so that everyone who has these chooses the same.

use std::collections::BTreeMap;

use mbd_runtime::scene::similar::did_you_mean;
use serde::{Deserialize, Serialize};
use toml::Value;

use crate::dispersion::WrittenHistories;
use crate::metric::CampaignMetric;
use crate::results::{CaseRow, Results};
use crate::run::PlanError;
use crate::run::names::wrong;
use crate::sampling::Draws;

/// Which cases keep their histories.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Choice {
    worst: BTreeMap<String, u64>,
    largest: BTreeMap<String, u64>,
    smallest: BTreeMap<String, u64>,
    random: u64,
    /// The most failed cases.
    failed: u64,
    cases: Vec<u64>,
}

/// A case that keeps its history.
#[derive(Clone, Debug, PartialEq)]
pub struct Chosen {
    /// Its number.
    pub case: u64,
    /// Why it was chosen: `worst peak, 2 of 5`, `failed`, `random`, `by its number`.
    pub why: Vec<String>,
}

/// Which end of a metric is looked for.
#[derive(Clone, Copy, Debug)]
enum MetricEnd {
    Worst,
    Largest,
    Smallest,
}

impl Choice {
    /// As it is written, for a campaign with these metrics whose last case is `last`.
    ///
    /// # Errors
    /// The first setting that cannot be used.
    pub fn new(
        written: &WrittenHistories,
        metrics: &[CampaignMetric],
        last: u64,
    ) -> Result<Self, PlanError> {
        let ends = [
            ("worst", &written.worst),
            ("largest", &written.largest),
            ("smallest", &written.smallest),
        ];
        for (end, counts) in ends {
            for name in counts.keys() {
                let setting = format!("histories.{end}.{name}");
                let found = metrics.iter().find(|metric| metric.name == *name);
                let Some(metric) = found else {
                    let names = metrics.iter().map(|metric| metric.name.as_str());
                    let near = did_you_mean(name, names);
                    let text = format!("there is no metric `{name}`{near}");
                    return Err(wrong(setting, text));
                };
                if end == "worst" && metric.require.is_none() {
                    let text = format!(
                        "nothing is required of `{name}`, which would say what is bad: write `largest` or `smallest` in place of `worst`"
                    );
                    return Err(wrong(setting, text));
                }
            }
        }
        if let Some(case) = written.cases.iter().find(|case| **case > last) {
            let text = format!("there is no case {case}: the last is {last}");
            return Err(wrong("histories.cases", text));
        }
        Ok(Choice {
            worst: written.worst.clone(),
            largest: written.largest.clone(),
            smallest: written.smallest.clone(),
            random: written.random,
            failed: failed(written.failed.as_ref())?,
            cases: written.cases.clone(),
        })
    }

    /// The cases, in the order of their numbers.
    #[must_use]
    pub fn of(&self, results: &Results) -> Vec<Chosen> {
        let mut chosen: BTreeMap<u64, Vec<String>> = BTreeMap::new();
        let ends = [
            (MetricEnd::Worst, &self.worst),
            (MetricEnd::Largest, &self.largest),
            (MetricEnd::Smallest, &self.smallest),
        ];
        for (end, counts) in ends {
            for (name, count) in counts {
                let cases = end.cases(results, name, *count);
                let of = cases.len();
                for (rank, case) in (1..).zip(cases) {
                    let why = format!("{} {name}, {rank} of {of}", end.word());
                    chosen.entry(case).or_default().push(why);
                }
            }
        }
        // Where a window is longer than runs are, every case would be one.
        let kept = [CaseRow::OK, CaseRow::PARTIAL];
        let failed = results
            .rows
            .iter()
            .filter(|row| !kept.contains(&row.status.as_str()));
        for row in failed.take(usize::try_from(self.failed).unwrap_or(usize::MAX)) {
            let why = format!("failed: {}", row.status);
            chosen.entry(row.case).or_default().push(why);
        }
        for case in at_random(self.random, &results.manifest) {
            chosen.entry(case).or_default().push("random".to_owned());
        }
        for case in &self.cases {
            let why = "by its number".to_owned();
            chosen.entry(*case).or_default().push(why);
        }
        let chosen = chosen.into_iter();
        chosen.map(|(case, why)| Chosen { case, why }).collect()
    }
}

/// The most failed cases whose histories are kept.
fn failed(written: Option<&Value>) -> Result<u64, PlanError> {
    let count = match written {
        None => Some(0),
        Some(Value::Integer(count)) => u64::try_from(*count).ok(),
        Some(Value::String(word)) if word == "all" => Some(u64::from(u32::MAX)),
        Some(_) => None,
    };
    count.ok_or_else(|| {
        let text = "say how many, or `\"all\"`: failed = 50";
        wrong("histories.failed", text)
    })
}

/// So many cases at random, without the nominal: those with the smallest numbers of this name. One more leaves the others as they were.
fn at_random(count: u64, manifest: &crate::Manifest) -> Vec<u64> {
    if count == 0 {
        return Vec::new();
    }
    let draws = Draws::new(manifest.seed, "histories");
    let mut all: Vec<(u64, u64)> = (1..manifest.cases)
        .map(|case| (draws.bits(case, 0), case))
        .collect();
    all.sort_unstable();
    all.truncate(usize::try_from(count).unwrap_or(usize::MAX));
    all.into_iter().map(|(_, case)| case).collect()
}

impl MetricEnd {
    fn word(self) -> &'static str {
        match self {
            MetricEnd::Worst => "worst",
            MetricEnd::Largest => "largest",
            MetricEnd::Smallest => "smallest",
        }
    }

    /// So many cases with a value, from the end on; of equal values the earlier case first. The nominal is none of them.
    fn cases(self, results: &Results, name: &str, count: u64) -> Vec<u64> {
        let mut columns = results.manifest.metrics.iter();
        let Some(at) = columns.position(|column| column.name == name) else {
            return Vec::new();
        };
        let require = results.manifest.metrics[at].require;
        let far_out = |value: f64| match self {
            MetricEnd::Largest => -value,
            MetricEnd::Smallest => value,
            // How far it is inside; negative outside.
            MetricEnd::Worst => require.map_or(f64::NAN, |require| require.margin(value)),
        };
        let values = (1..).zip(results.metric(at));
        let mut all: Vec<(f64, u64)> = values
            .map(|(case, value)| (far_out(value), case))
            .filter(|(distance, _)| !distance.is_nan())
            .collect();
        all.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        all.truncate(usize::try_from(count).unwrap_or(usize::MAX));
        all.into_iter().map(|(_, case)| case).collect()
    }
}
