//! Metrics: one number a run, made of a quantity over time.

use serde::{Deserialize, Serialize};

use crate::{Output, Scene};

/// Columns that every table of results has: no metric has such a name.
pub const COLUMNS_OF_RESULTS: [&str; 4] = ["case", "status", "end", "why"];

/// How a number is made of a quantity over a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Take {
    /// The largest value.
    Max,
    /// The smallest value.
    Min,
    /// The value at the end.
    Final,
    /// The mean over time.
    Mean,
    /// The root of the mean square over time.
    Rms,
    /// The integral over time.
    Integral,
    /// How long the quantity is above a level.
    TimeAbove,
    /// When the quantity is above a level for the first time.
    FirstAbove,
    /// The value when an event happens for the first time.
    Value,
    /// When an event happens for the first time.
    TimeOf,
}

impl Take {
    /// All of them.
    pub const ALL: [Take; 10] = [
        Take::Max,
        Take::Min,
        Take::Final,
        Take::Mean,
        Take::Rms,
        Take::Integral,
        Take::TimeAbove,
        Take::FirstAbove,
        Take::Value,
        Take::TimeOf,
    ];

    /// Its word in declarations and in campaign files.
    #[must_use]
    pub const fn keyword(self) -> &'static str {
        match self {
            Take::Max => "max",
            Take::Min => "min",
            Take::Final => "final",
            Take::Mean => "mean",
            Take::Rms => "rms",
            Take::Integral => "integral",
            Take::TimeAbove => "time_above",
            Take::FirstAbove => "first_above",
            Take::Value => "value",
            Take::TimeOf => "time_of",
        }
    }

    /// The one of a word.
    #[must_use]
    pub fn of(word: &str) -> Option<Take> {
        Take::ALL.into_iter().find(|take| take.keyword() == word)
    }

    /// Whether it compares with a level.
    #[must_use]
    pub const fn has_level(self) -> bool {
        matches!(self, Take::TimeAbove | Take::FirstAbove)
    }

    /// Its unit, made of that of the quantity: s for times, `N s` for the integral of a force, `kJ` for that of `kW`.
    #[must_use]
    pub fn unit(self, of: &str) -> String {
        match self {
            Take::TimeAbove | Take::FirstAbove | Take::TimeOf => "s".to_owned(),
            Take::Integral if let Some((_, energy)) = POWERS.iter().find(|(it, _)| *it == of) => {
                (*energy).to_owned()
            }
            Take::Integral => match of.strip_suffix("/s") {
                Some("1") => String::new(),
                Some(of) => of.to_owned(),
                None if of.is_empty() => "s".to_owned(),
                None => format!("{of} s"),
            },
            _ => of.to_owned(),
        }
    }
}

/// Units of power, and those of what they make in a second.
const POWERS: [(&str, &str); 4] = [("W", "J"), ("mW", "mJ"), ("kW", "kJ"), ("MW", "MJ")];

/// The unit of what an integral in this unit is taken of: `W` of `J`, `m/s` of `m`.
#[must_use]
pub fn under_integral(unit: &str) -> String {
    match POWERS.iter().find(|(_, energy)| *energy == unit) {
        Some((power, _)) => (*power).to_owned(),
        None => format!("{unit}/s"),
    }
}

/// A number that is told of every run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Metric {
    /// Its name, and that of the output that holds its quantity.
    pub name: String,
    /// Documentation.
    pub doc: String,
    /// How it is made.
    pub take: Take,
    /// The output that holds its quantity; none of [`Take::TimeOf`].
    pub output: Option<usize>,
    /// The level of [`Take::has_level`], in SI.
    pub level: Option<f64>,
    /// The event of [`Take::Value`] and [`Take::TimeOf`].
    pub event: Option<usize>,
    /// From when on a run counts [s].
    pub from: Option<f64>,
    /// Up to when a run counts [s].
    pub to: Option<f64>,
}

impl Scene {
    /// What the columns of an output are called: as it is, or, where it holds the quantity of a metric, `peak.quantity`. The number of the metric is
    /// another one, most often in another unit.
    #[must_use]
    pub fn output_column(&self, output: &Output) -> String {
        let mut metrics = self.runs.metrics.iter();
        let column = metrics.find_map(|metric| {
            let of = self.outputs.get(metric.output?)?;
            (of.name == output.name).then(|| metric.column())
        });
        column.unwrap_or_else(|| output.name.clone())
    }
}

impl Metric {
    /// The column of a history that holds its quantity; of [`Take::TimeOf`] there is none.
    #[must_use]
    pub fn column(&self) -> String {
        format!("{}.quantity", self.name)
    }

    /// Its unit; empty for a pure number.
    #[must_use]
    pub fn unit(&self, scene: &Scene) -> String {
        let output = self.output.and_then(|output| scene.outputs.get(output));
        self.take
            .unit(output.map_or("", |output| output.unit.text.as_str()))
    }
}
