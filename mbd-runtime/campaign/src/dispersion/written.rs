//! A campaign file as it is written.
//!
//! ```toml
//! seed = 7
//! cases = 1000              # beside the nominal, which is case 0
//! sampling = "latin"        # random (left out), latin, sobol, grid
//!
//! [params]
//! m_cap = { dist = "normal", sigma = "5 kg" }              # about its nominal value, unless `mean` is given
//! cd_s = { dist = "truncated_normal", three_sigma = "9 %", low = "90 %", high = "110 %" }
//!
//! [start]
//! capsule.vx = { dist = "uniform", low = "-2 m/s", high = "2 m/s" }
//!
//! [inputs]
//! wind.x = { dist = "table", file = "winds.csv", column = "east" }
//!
//! [[correlated]]
//! names = ["m_cap", "cd_s"]
//! matrix = [[1.0, 0.4], [0.4, 1.0]]
//!
//! [[constraint]]
//! sum = { m_cap = 1, m_shield = 1 }
//! at_most = "950 kg"
//!
//! [metrics]
//! peak = { max = "riser.tension", require = { below = "15 kN", share = 0.99865, confidence = 0.9 } }
//!
//! [histories]               # of which cases histories and pages are kept
//! worst = { peak = 5 }
//! failed = 20
//!
//! [envelopes]               # percentiles of columns over time
//! columns = ["riser.tension"]
//!
//! [[footprint]]             # two metrics together
//! x = "east"
//! y = "north"
//!
//! [run]                     # single settings in place of those of the scene
//! until = "70 s"
//! ```

use std::collections::BTreeMap;

use mbd_runtime::scene::similar::did_you_mean;
use serde::Deserialize;
use toml::{Table, Value};

/// What to write where a file cannot be read as one of a campaign; nothing after a mistake that says it.
pub fn meant(error: &toml::de::Error) -> String {
    let message = error.message();
    let what = match message.strip_prefix("invalid type: ") {
        Some("map, expected a sequence") => {
            "there can be several of these: write the name in double brackets, `[[constraint]]`"
        }
        Some("sequence, expected a map") => {
            "there is one of these: write the name in single brackets, `[metrics]`"
        }
        Some(kind) if kind.ends_with("expected a sequence") => {
            "write a list in brackets: [\"riser.tension\"]"
        }
        Some(kind) if kind.ends_with("expected a map") => {
            "write names with their values in braces: { peak = 5 }"
        }
        Some(_) => return String::new(),
        None => {
            let Some(names) = message.strip_prefix("unknown field ") else {
                return String::new();
            };
            let mut names = names.split('`').skip(1).step_by(2);
            let word = names.next().unwrap_or_default();
            let near = did_you_mean(word, names);
            return match near.is_empty() {
                true => String::new(),
                false => format!("`{word}`{near}\n"),
            };
        }
    };
    format!("{what}\n")
}

/// A campaign file.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct CampaignFile {
    /// What all random numbers come from.
    #[serde(default)]
    pub seed: u64,
    /// How many cases there are beside the nominal; of a grid as many as it has.
    pub cases: Option<u64>,
    /// `random`, `latin`, `sobol`, `grid`.
    pub sampling: Option<String>,
    /// So many cases share a file of results.
    pub block: Option<u64>,
    /// Distributions of params.
    #[serde(default)]
    pub params: Table,
    /// Distributions of what the start is said in.
    #[serde(default)]
    pub start: Table,
    /// Distributions of inputs.
    #[serde(default)]
    pub inputs: Table,
    /// Numbers that vary together.
    #[serde(default)]
    pub correlated: Vec<WrittenCorrelation>,
    /// What draws must obey.
    #[serde(default)]
    pub constraint: Vec<WrittenConstraint>,
    /// What is read from every history.
    #[serde(default)]
    pub metrics: BTreeMap<String, WrittenMetric>,
    /// Settings of the runs in place of those of the scene.
    #[serde(default)]
    pub run: Table,
    /// Which cases keep their histories.
    pub histories: Option<WrittenHistories>,
    /// What is told of columns over time.
    pub envelopes: Option<WrittenEnvelopes>,
    /// Pairs of metrics that are told together.
    #[serde(default)]
    pub footprint: Vec<WrittenFootprint>,
}

/// A distribution.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WrittenDistribution {
    /// Its word.
    pub dist: String,
    /// Mean; left out: the nominal value.
    pub mean: Option<Value>,
    /// Standard deviation.
    pub sigma: Option<Value>,
    /// Three standard deviations.
    pub three_sigma: Option<Value>,
    /// The smallest value.
    pub low: Option<Value>,
    /// The largest value.
    pub high: Option<Value>,
    /// The most likely value; left out: the nominal value.
    pub mode: Option<Value>,
    /// Values of a discrete distribution or a grid.
    pub values: Option<Vec<Value>>,
    /// How likely each is, up to a factor; left out: all the same.
    pub weights: Option<Vec<f64>>,
    /// A file of values, beside the campaign file.
    pub file: Option<String>,
    /// The column of it.
    pub column: Option<String>,
}

/// Numbers that vary together.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(
    deny_unknown_fields,
    expecting = "numbers with their matrix, `[[correlated]]`"
)]
pub struct WrittenCorrelation {
    /// Their names, as the columns of the results have them.
    pub names: Vec<String>,
    /// Their correlation matrix.
    pub matrix: Vec<Vec<f64>>,
}

/// A sum that draws keep within bounds.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(
    deny_unknown_fields,
    expecting = "a sum with its bounds, `[[constraint]]`"
)]
pub struct WrittenConstraint {
    /// Factors of params and dispersed numbers.
    pub sum: BTreeMap<String, f64>,
    /// The least it may be.
    pub at_least: Option<Value>,
    /// The most it may be.
    pub at_most: Option<Value>,
}

/// A number that is read from every history.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(
    deny_unknown_fields,
    expecting = "a metric in braces, `{ max = \"riser.tension\" }`"
)]
pub struct WrittenMetric {
    /// The largest value of a column.
    pub max: Option<String>,
    /// The smallest value of a column.
    pub min: Option<String>,
    /// The value of a column at the end.
    #[serde(rename = "final")]
    pub last: Option<String>,
    /// The mean of a column over time.
    pub mean: Option<String>,
    /// The root of the mean square of a column over time.
    pub rms: Option<String>,
    /// The integral of a column over time.
    pub integral: Option<String>,
    /// How long a column is above `level` [s].
    pub time_above: Option<String>,
    /// When a column is above `level` for the first time [s].
    pub first_above: Option<String>,
    /// The level of the two before.
    pub level: Option<Value>,
    /// The value of a column at the first `at`.
    pub value: Option<String>,
    /// An event.
    pub at: Option<String>,
    /// When an event happens for the first time [s].
    pub time_of: Option<String>,
    /// From when on the history counts.
    pub from: Option<Value>,
    /// Up to when it counts.
    pub to: Option<Value>,
    /// What it has to be.
    pub require: Option<WrittenRequirement>,
}

/// What a metric has to be, in how many of all cases, shown with which confidence.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(
    deny_unknown_fields,
    expecting = "what it has to be in braces, `{ below = \"15 kN\", share = 0.99865, confidence = 0.9 }`"
)]
pub struct WrittenRequirement {
    /// The largest value that is allowed.
    pub below: Option<Value>,
    /// The smallest value that is allowed.
    pub above: Option<Value>,
    /// The part of all cases, 0 … 1.
    pub share: f64,
    /// The confidence, 0 … 1; of a grid it says nothing, and may be left out.
    pub confidence: Option<f64>,
}

/// Which cases keep their histories.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, expecting = "a table `[histories]`")]
pub struct WrittenHistories {
    /// So many cases that are nearest to breaking what is required of a metric, or furthest beyond it.
    #[serde(default)]
    pub worst: BTreeMap<String, u64>,
    /// So many cases with the largest values of a metric.
    #[serde(default)]
    pub largest: BTreeMap<String, u64>,
    /// So many cases with the smallest values of a metric.
    #[serde(default)]
    pub smallest: BTreeMap<String, u64>,
    /// So many cases at random.
    #[serde(default)]
    pub random: u64,
    /// So many cases that failed, or `"all"`.
    pub failed: Option<Value>,
    /// Cases by their numbers.
    #[serde(default)]
    pub cases: Vec<u64>,
}

/// What is told of columns over time.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, expecting = "a table `[envelopes]`")]
pub struct WrittenEnvelopes {
    /// The columns, as the header of `history.csv` has them.
    pub columns: Vec<String>,
    /// The distance of the instants; left out: a hundredth of the run.
    pub every: Option<Value>,
}

/// Two metrics that are told together.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, expecting = "two metrics, `[[footprint]]`")]
pub struct WrittenFootprint {
    /// The metric across.
    pub x: String,
    /// The metric upwards.
    pub y: String,
    /// The parts of all cases that the ellipses would hold of normal numbers, 0 … 1; left out: those of one, two and three standard deviations.
    pub shares: Option<Vec<f64>>,
}
