//! From a distribution as it is written to one in SI.

use std::collections::BTreeMap;
use std::num::ParseFloatError;
use std::path::{Component, Path, PathBuf};

use mbd_compiler::{mixes_turns, read_number};
use mbd_runtime::scene::Unit;
use toml::{Table, Value};

use super::name::Dispersible;
use super::written::{WrittenDistribution, meant};
use crate::run::names::{PlanError, wrong};
use crate::run::number::{not_bare, number};
use crate::run::{unknown_field, words};
use crate::sampling::Distribution;
use crate::table;

/// The distributions with their settings, and those whose numbers lie in a file.
const WORDS: [(&str, &[&str]); 7] = [
    ("normal", &["mean", "sigma", "three_sigma"]),
    (
        "truncated_normal",
        &["mean", "sigma", "three_sigma", "low", "high"],
    ),
    ("uniform", &["low", "high"]),
    ("triangular", &["low", "mode", "high"]),
    ("discrete", &["values", "weights"]),
    ("table", &["file", "column"]),
    ("grid", &["values"]),
];

/// Whether a table is a distribution, and not a table of them.
pub fn is_distribution(table: &Table) -> bool {
    table.contains_key("dist")
}

/// Whether a key is a setting of a distribution.
fn is_of_distribution(key: &str) -> bool {
    let mut settings = WORDS.iter().flat_map(|(_, settings)| *settings);
    settings.any(|known| *known == key)
}

/// A distribution that was read.
#[derive(Clone, Debug, PartialEq)]
pub struct Read {
    /// It.
    pub distribution: Distribution,
    /// The file its rows lie in: numbers of one file come from the same row.
    pub file: Option<String>,
    /// Whether it is a list of values of a grid.
    pub grid: bool,
}

/// Reads a distribution of something; files lie in `folder`.
pub fn read(
    setting: &str,
    table: &Table,
    known: &Dispersible,
    folder: &Path,
) -> Result<Read, PlanError> {
    let written: WrittenDistribution =
        Value::Table(table.clone())
            .try_into()
            .map_err(|error: toml::de::Error| {
                if let Some((word, ours)) = word_of_another_tool(&error) {
                    return wrong(setting, format!("there is no `{word}`: {ours}"));
                }
                let near = meant(&error);
                let stop = if near.is_empty() { "" } else { ". " };
                let told = format!("{}{stop}{}", error.message(), near.trim_end());
                wrong(setting, told)
            })?;
    let word = written.dist.as_str();
    let Some((_, allowed)) = WORDS.iter().find(|(known, _)| *known == word) else {
        if let Some(ours) = words::of_distribution(word) {
            let text = format!("there is no distribution `{word}`: {ours}");
            return Err(wrong(setting, text));
        }
        let words = WORDS.iter().map(|(word, _)| *word);
        let known = mbd_runtime::scene::similar::near_and_all(word, words);
        return Err(wrong(
            setting,
            format!("there is no distribution `{word}`{known}"),
        ));
    };
    let extra = table
        .keys()
        .find(|key| *key != "dist" && !allowed.contains(&key.as_str()));
    if let Some(extra) = extra {
        let text = format!(
            "`{extra}` is no setting of `{word}`, which takes: {}",
            allowed.join(", ")
        );
        return Err(wrong(setting, text));
    }
    let reader = DispersionReader {
        setting,
        known,
        written: &written,
    };
    let mut file = None;
    let distribution = match word {
        "normal" => reader.normal()?,
        "truncated_normal" => reader.truncated()?,
        "uniform" => {
            let [low, high] = reader.ends()?;
            Distribution::Uniform { low, high }
        }
        "triangular" => reader.triangular()?,
        "discrete" => reader.discrete()?,
        "grid" => Distribution::Listed(reader.values()?),
        _ => {
            // `./winds.csv` is `winds.csv`, and its rows are the same.
            let parts = written
                .file
                .iter()
                .flat_map(|file| Path::new(file).components());
            let parts = parts.filter(|part| *part != Component::CurDir);
            file = Some(parts.collect::<PathBuf>().display().to_string());
            Distribution::Listed(reader.rows(folder)?)
        }
    };
    Ok(Read {
        distribution,
        file,
        grid: word == "grid",
    })
}

/// How many percent a text says; `None` of what ends in no `%`.
fn percentage(value: &Value) -> Option<Result<f64, ParseFloatError>> {
    let text = value.as_str()?.trim().strip_suffix('%')?;
    Some(text.trim().parse())
}

/// A setting of a distribution that another tool calls so, and what it is called here.
fn word_of_another_tool(error: &toml::de::Error) -> Option<(String, &'static str)> {
    let word = unknown_field(error.message())?;
    Some((word.to_owned(), words::of_distribution_setting(word)?))
}

struct DispersionReader<'r> {
    setting: &'r str,
    known: &'r Dispersible,
    written: &'r WrittenDistribution,
}

impl DispersionReader<'_> {
    fn wrong(&self, text: impl Into<String>) -> PlanError {
        wrong(self.setting, text)
    }

    /// A value, or so many percent of the nominal one.
    fn number(&self, name: &str, value: &Value) -> Result<f64, PlanError> {
        let setting = format!("{}.{name}", self.setting);
        match percentage(value) {
            None => {
                not_bare(&setting, value, &self.known.unit)?;
                number(&setting, value, &self.known.unit)
            }
            Some(Ok(percent)) if percent.is_finite() => {
                if self.known.nominal == 0.0 {
                    return Err(wrong(
                        setting,
                        "percent of the nominal value, which is zero: give a number with its unit",
                    ));
                }
                Ok(0.01 * percent * self.known.nominal)
            }
            Some(_) => Err(wrong(setting, "is no percentage: write it as \"5 %\"")),
        }
    }

    fn needed(&self, name: &str, value: &Option<Value>) -> Result<f64, PlanError> {
        match value {
            Some(value) => self.number(name, value),
            None => Err(self.wrong(format!("`{}` needs `{name}`", self.written.dist))),
        }
    }

    fn or_nominal(&self, name: &str, value: &Option<Value>) -> Result<f64, PlanError> {
        value
            .as_ref()
            .map_or(Ok(self.known.nominal), |value| self.number(name, value))
    }

    fn sigma(&self) -> Result<f64, PlanError> {
        let (name, value, times) = match (&self.written.sigma, &self.written.three_sigma) {
            (Some(sigma), None) => ("sigma", sigma, 1.0),
            (None, Some(three)) => ("three_sigma", three, 3.0),
            _ => return Err(self.wrong("give either `sigma` or `three_sigma`")),
        };
        let given = self.number(name, value)? / times;
        let is_percentage = value.as_str().is_some_and(|text| text.contains('%'));
        // A percentage of a negative number.
        let sigma = match is_percentage {
            true => given * self.known.nominal.signum(),
            false => given,
        };
        match sigma > 0.0 {
            true => Ok(sigma),
            false => Err(self.wrong(format!("`{name}` must be positive"))),
        }
    }

    fn normal(&self) -> Result<Distribution, PlanError> {
        let mean = self.or_nominal("mean", &self.written.mean)?;
        Ok(Distribution::Normal {
            mean,
            sigma: self.sigma()?,
        })
    }

    fn ends(&self) -> Result<[f64; 2], PlanError> {
        let ends = [
            self.needed("low", &self.written.low)?,
            self.needed("high", &self.written.high)?,
        ];
        let percent = |value: &Option<Value>| percentage(value.as_ref()?)?.ok();
        if let [Some(low), Some(high)] = [&self.written.low, &self.written.high].map(percent)
            && low < 100.0
            && high < 100.0
        {
            return Err(self.wrong(format!(
                "`low` and `high` are percent of the nominal value, and {low} % to {high} % of it does not contain it: for a spread about it write `low = \"{} %\"`, `high = \"{} %\"`; for what is meant, numbers with their unit",
                100.0 + low,
                100.0 + high
            )));
        }
        match ends {
            [low, high] if low < high => Ok(ends),
            [low, high] => Err(self.wrong(format!("`low` ({low}) must be below `high` ({high})"))),
        }
    }

    fn truncated(&self) -> Result<Distribution, PlanError> {
        let mean = self.or_nominal("mean", &self.written.mean)?;
        let (sigma, [low, high]) = (self.sigma()?, self.ends()?);
        // Further out than this the tail has no digits left.
        if low > mean + 30.0 * sigma || high < mean - 30.0 * sigma {
            return Err(self.wrong("nothing of this distribution lies between `low` and `high`"));
        }
        Ok(Distribution::TruncatedNormal {
            mean,
            sigma,
            low,
            high,
        })
    }

    fn triangular(&self) -> Result<Distribution, PlanError> {
        let [low, high] = self.ends()?;
        let mode = self.or_nominal("mode", &self.written.mode)?;
        match (low..=high).contains(&mode) {
            true => Ok(Distribution::Triangular { low, mode, high }),
            false => Err(self.wrong(format!(
                "`mode` ({mode}) must lie between `low` ({low}) and `high` ({high})"
            ))),
        }
    }

    fn values(&self) -> Result<Vec<f64>, PlanError> {
        let values = self.written.values.as_deref().unwrap_or_default();
        if values.is_empty() {
            return Err(self.wrong(format!("`{}` needs `values`, a list", self.written.dist)));
        }
        values
            .iter()
            .map(|value| self.number("values", value))
            .collect()
    }

    fn discrete(&self) -> Result<Distribution, PlanError> {
        let values = self.values()?;
        let weights = self.written.weights.clone();
        let weights = weights.unwrap_or_else(|| vec![1.0; values.len()]);
        let total: f64 = weights.iter().sum();
        let usable =
            weights.iter().all(|weight| *weight >= 0.0) && total > 0.0 && total.is_finite();
        if weights.len() != values.len() || !usable {
            return Err(self.wrong("`weights` needs a number that is not negative for each of `values`, not all of them zero"));
        }
        // What lies below a part of them are the smallest: a correlation with another number is one of values, in whatever order they are written.
        let mut pairs: Vec<(f64, f64)> = values.into_iter().zip(weights).collect();
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut sum = 0.0;
        let up_to = pairs.iter().map(|(_, weight)| {
            sum += weight / total;
            sum
        });
        Ok(Distribution::Discrete {
            up_to: up_to.collect(),
            values: pairs.iter().map(|(value, _)| *value).collect(),
        })
    }

    fn rows(&self, folder: &Path) -> Result<Vec<f64>, PlanError> {
        let (Some(file), Some(column)) = (&self.written.file, &self.written.column) else {
            return Err(self.wrong("`table` needs `file` and `column`"));
        };
        let (values, unit) =
            table::column(&folder.join(file), column).map_err(|text| self.wrong(text))?;
        let factor = match unit.as_str() {
            "" if self.known.unit.is_empty() => 1.0,
            "" => {
                return Err(self.wrong(format!(
                    "column `{column}` of {file} has no unit: write one behind its name there, `{column} [{}]`",
                    self.known.unit
                )));
            }
            given => {
                let measured = |unit: &str| read_number(&format!("1 {unit}")).ok();
                let fits = |unit: &Unit| {
                    measured(&self.known.unit).is_some_and(|(_, own)| {
                        own.dimension == unit.dimension && !mixes_turns(&own, unit)
                    })
                };
                match measured(given) {
                    Some((factor, unit)) if fits(&unit) => factor,
                    _ => {
                        return Err(self.wrong(format!(
                            "column `{column}` of {file} is in `{given}`: expected {}",
                            self.known.unit
                        )));
                    }
                }
            }
        };
        Ok(values.into_iter().map(|value| value * factor).collect())
    }
}

/// Distributions with their dotted names, in the order of the names, and what stands there and is none, or is there twice.
pub fn flat(part: &str, table: &Table) -> BTreeMap<String, Result<Table, PlanError>> {
    let mut all: BTreeMap<String, Result<Table, PlanError>> = BTreeMap::new();
    for (name, value) in table {
        let full = match part {
            "" => name.clone(),
            part => format!("{part}.{name}"),
        };
        let found = match value {
            Value::Table(inner) if is_distribution(inner) => {
                BTreeMap::from([(full, Ok(inner.clone()))])
            }
            Value::Table(inner) if inner.keys().any(|key| is_of_distribution(key)) => {
                let text = "does not say which distribution it has: dist = \"normal\"";
                BTreeMap::from([(full.clone(), Err(wrong(full, text)))])
            }
            Value::Table(inner) => flat(&full, inner),
            _ => {
                let text = "give a distribution: { dist = \"normal\", sigma = \"5 %\" }";
                BTreeMap::from([(full.clone(), Err(wrong(full, text)))])
            }
        };
        // `"pin.angle"` in quotation marks is `pin.angle`.
        for (full, read) in found {
            let read = match all.contains_key(&full) {
                true => Err(wrong(full.clone(), "is given twice")),
                false => read,
            };
            all.insert(full, read);
        }
    }
    all
}
