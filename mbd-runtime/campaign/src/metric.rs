//! Numbers that are read from the history of every case, and what they have to be.
//!
//! Over time columns are taken as straight between rows. A metric without a value (an event that did not happen, an effort that nothing determines)
//! is NaN here and an empty cell in the results; where something is required of it, it counts as not met.

use mbd_compiler::read_number;
use mbd_runtime::scene::Scene;
use mbd_runtime::scene::similar::did_you_mean;
use mbd_runtime::{Content, Model, Name, Sampling, Trajectory};
use serde::{Deserialize, Serialize};
use toml::Value;

use crate::dispersion::{WrittenMetric, WrittenRequirement};
use crate::run::names::{PlanError, wrong};
use crate::run::number::number;

/// How a number is read from a history.
#[derive(Clone, Debug, PartialEq)]
enum Take {
    Max(usize),
    Min(usize),
    Final(usize),
    Mean(usize),
    Rms(usize),
    Integral(usize),
    TimeAbove(usize, f64),
    FirstAbove(usize, f64),
    Value(usize, String),
    TimeOf(String),
}

/// A number that is read from the history of every case.
#[derive(Clone, Debug, PartialEq)]
pub struct Metric {
    /// Its name.
    pub name: String,
    /// Its unit; empty for a pure number.
    pub unit: String,
    /// What it has to be.
    pub require: Option<Requirement>,
    take: Take,
    window: [f64; 2],
}

/// What a metric has to be, in which part of all cases, shown with which confidence.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Requirement {
    /// The largest value that is allowed, in the unit of the metric.
    pub below: Option<f64>,
    /// The smallest value that is allowed.
    pub above: Option<f64>,
    /// The part of all cases, 0 … 1.
    pub share: f64,
    /// The confidence, 0 … 1.
    pub confidence: f64,
}

impl Requirement {
    /// Whether a value meets it; NaN does not.
    #[must_use]
    pub fn meets(&self, value: f64) -> bool {
        let below = self.below.is_none_or(|bound| value <= bound);
        let above = self.above.is_none_or(|bound| value >= bound);
        !value.is_nan() && below && above
    }
}

/// The metrics of a campaign with what a history must hold for them.
#[derive(Clone, Debug)]
pub struct Metrics {
    /// They, in the order of their names.
    pub list: Vec<Metric>,
    /// What a history must hold.
    pub content: Content,
}

const NOTHING: Content = Content {
    state: false,
    nodes: false,
    lines: false,
    reactions: false,
    outputs: false,
    energy: false,
};

/// The columns of histories with their contents, widest last.
fn groups() -> [Content; 6] {
    [
        Content {
            outputs: true,
            ..NOTHING
        },
        Content {
            lines: true,
            ..NOTHING
        },
        Content {
            nodes: true,
            ..NOTHING
        },
        Content {
            state: true,
            ..NOTHING
        },
        Content {
            reactions: true,
            ..NOTHING
        },
        Content {
            energy: true,
            ..NOTHING
        },
    ]
}

fn columns(model: &dyn Model<f64>, content: Content) -> Vec<Name> {
    Trajectory::new(model, Sampling::Steps, content)
        .names()
        .to_vec()
}

impl Metrics {
    /// Reads metrics; `every_step` says whether histories have a row at every step, and so at every event.
    ///
    /// # Errors
    /// The first that cannot be read from a history of this model.
    pub fn new<'m>(
        written: impl Iterator<Item = (&'m String, &'m WrittenMetric)> + Clone,
        model: &dyn Model<f64>,
        every_step: bool,
    ) -> Result<Self, PlanError> {
        let mut content = NOTHING;
        for (name, metric) in written.clone() {
            for column in metric.columns() {
                let group = groups().into_iter().find(|group| {
                    columns(model, *group)
                        .iter()
                        .any(|known| known.name == *column)
                });
                let Some(group) = group else {
                    let all = columns(model, Content::ALL);
                    let near = did_you_mean(column, all.iter().map(|it| it.name.as_str()));
                    let text = format!(
                        "histories have no column `{column}`{near} The header of the history.csv of `mbd run` names them all"
                    );
                    return Err(wrong(format!("metrics.{name}"), text));
                };
                content = Content {
                    state: content.state | group.state,
                    nodes: content.nodes | group.nodes,
                    lines: content.lines | group.lines,
                    reactions: content.reactions | group.reactions,
                    outputs: content.outputs | group.outputs,
                    energy: content.energy | group.energy,
                };
            }
        }
        let names = columns(model, content);
        let list = written.map(|(name, written)| {
            let reader = Reader {
                setting: format!("metrics.{name}"),
                name,
                written,
                names: &names,
            };
            reader.metric(model.scene(), every_step)
        });
        Ok(Metrics {
            list: list.collect::<Result<_, _>>()?,
            content,
        })
    }

    /// The metrics of a history.
    #[must_use]
    pub fn read(&self, history: &Trajectory) -> Vec<f64> {
        self.list
            .iter()
            .map(|metric| metric.read(history))
            .collect()
    }
}

impl WrittenMetric {
    fn takes(&self) -> [(&'static str, &Option<String>); 10] {
        [
            ("max", &self.max),
            ("min", &self.min),
            ("final", &self.last),
            ("mean", &self.mean),
            ("rms", &self.rms),
            ("integral", &self.integral),
            ("time_above", &self.time_above),
            ("first_above", &self.first_above),
            ("value", &self.value),
            ("time_of", &self.time_of),
        ]
    }

    /// The columns it asks for.
    fn columns(&self) -> impl Iterator<Item = &String> {
        let takes = self
            .takes()
            .into_iter()
            .filter(|(word, _)| *word != "time_of");
        takes.filter_map(|(_, column)| column.as_ref())
    }
}

struct Reader<'r> {
    setting: String,
    name: &'r str,
    written: &'r WrittenMetric,
    names: &'r [Name],
}

impl Reader<'_> {
    fn wrong(&self, text: impl Into<String>) -> PlanError {
        wrong(&*self.setting, text)
    }

    fn metric(&self, scene: &Scene, every_step: bool) -> Result<Metric, PlanError> {
        let written = self.written;
        let takes = written.takes();
        let mut given = takes
            .iter()
            .filter_map(|(word, of)| Some((*word, of.as_deref()?)));
        let (Some((word, of)), None) = (given.next(), given.next()) else {
            let words: Vec<&str> = takes.iter().map(|(word, _)| *word).collect();
            return Err(self.wrong(format!(
                "say one thing to read: {} = \"riser.tension\"",
                words.join(", ")
            )));
        };
        let levelled = matches!(word, "time_above" | "first_above");
        if levelled != written.level.is_some() {
            return Err(
                self.wrong("`level` goes with `time_above` and `first_above`, and they need it")
            );
        }
        if (word == "value") != written.at.is_some() {
            return Err(
                self.wrong("`value` needs the event `at` which it is read, and nothing else does")
            );
        }
        let at = self.names.iter().position(|known| known.name == of);
        let own = at
            .and_then(|at| self.names.get(at))
            .map_or("", |name| &name.unit);
        let at = at.unwrap_or(0);
        let level = || self.in_unit("level", written.level.as_ref(), own);
        let take = match word {
            "max" => Take::Max(at),
            "min" => Take::Min(at),
            "final" => Take::Final(at),
            "mean" => Take::Mean(at),
            "rms" => Take::Rms(at),
            "integral" => Take::Integral(at),
            "time_above" => Take::TimeAbove(at, level()?.unwrap_or(f64::NAN)),
            "first_above" => Take::FirstAbove(at, level()?.unwrap_or(f64::NAN)),
            "value" => Take::Value(
                at,
                self.event(scene, written.at.as_deref().unwrap_or_default())?,
            ),
            _ => Take::TimeOf(self.event(scene, of)?),
        };
        if matches!(take, Take::Value(..)) && !every_step {
            return Err(self.wrong(
                "a value at an event needs a row at every step: leave out `every` under [run]",
            ));
        }
        let unit = match &take {
            Take::TimeAbove(..) | Take::FirstAbove(..) | Take::TimeOf(_) => "s".to_owned(),
            Take::Integral(_) if own.is_empty() => "s".to_owned(),
            Take::Integral(_) => format!("{own} s"),
            _ => own.to_owned(),
        };
        let second = |name: &str, value: &Option<Value>, free: f64| match value {
            Some(value) => number(&format!("{}.{name}", self.setting), value, "s"),
            None => Ok(free),
        };
        let window = [
            second("from", &written.from, f64::NEG_INFINITY)?,
            second("to", &written.to, f64::INFINITY)?,
        ];
        if window[0] >= window[1] {
            return Err(self.wrong("`from` must be before `to`"));
        }
        let require = written
            .require
            .as_ref()
            .map(|it| self.requirement(it, &unit))
            .transpose()?;
        Ok(Metric {
            name: self.name.to_owned(),
            unit,
            require,
            take,
            window,
        })
    }

    /// A number in a unit that a column has.
    fn in_unit(
        &self,
        name: &str,
        value: Option<&Value>,
        unit: &str,
    ) -> Result<Option<f64>, PlanError> {
        let Some(value) = value else {
            return Ok(None);
        };
        // `N s` of an integral is written `N*s`.
        let written = unit.replace(' ', "*");
        let factor = match written.as_str() {
            "" => 1.0,
            unit => read_number(&format!("1 {unit}")).map_or(1.0, |(factor, _)| factor),
        };
        Ok(Some(
            number(&format!("{}.{name}", self.setting), value, &written)? / factor,
        ))
    }

    fn requirement(
        &self,
        written: &WrittenRequirement,
        unit: &str,
    ) -> Result<Requirement, PlanError> {
        let inside = |x: f64| x > 0.0 && x < 1.0;
        if !inside(written.share) || !inside(written.confidence) {
            return Err(self.wrong("`share` and `confidence` of `require` lie between 0 and 1: share = 0.99865, confidence = 0.9"));
        }
        if written.below.is_none() && written.above.is_none() {
            return Err(self.wrong("`require` needs `below` or `above`"));
        }
        Ok(Requirement {
            below: self.in_unit("require.below", written.below.as_ref(), unit)?,
            above: self.in_unit("require.above", written.above.as_ref(), unit)?,
            share: written.share,
            confidence: written.confidence,
        })
    }

    /// An event as histories name it: a declared one, or `riser: taut`.
    fn event(&self, scene: &Scene, name: &str) -> Result<String, PlanError> {
        let declared = scene.events.iter().map(|event| event.name.as_str());
        let element = name.split_once(": ").map(|(element, _)| element);
        let line = element.is_some_and(|element| {
            let lines = scene.lines.iter().map(|line| line.name.as_str());
            let joints = scene.joints.iter().map(|joint| joint.name.as_str());
            lines
                .chain(joints)
                .any(|known| element == known || element.starts_with(&format!("{known}.")))
        });
        if line || declared.clone().any(|known| known == name) {
            return Ok(name.to_owned());
        }
        let near = did_you_mean(name, declared.clone());
        let all: Vec<&str> = declared.collect();
        let all = match all.is_empty() {
            true => "it declares none".to_owned(),
            false => format!("it has {}", all.join(", ")),
        };
        Err(self.wrong(format!("this scene has no event `{name}`{near} ({all}; a line that switches is `riser: taut` or `riser: slack`)")))
    }
}

impl Metric {
    /// Its value in a history; NaN where it has none.
    #[must_use]
    pub fn read(&self, history: &Trajectory) -> f64 {
        match &self.take {
            Take::TimeOf(event) => self.first(history, event).unwrap_or(f64::NAN),
            Take::Value(at, event) => self.value_at(history, *at, event).unwrap_or(f64::NAN),
            Take::Max(at)
            | Take::Min(at)
            | Take::Final(at)
            | Take::Mean(at)
            | Take::Rms(at)
            | Take::Integral(at)
            | Take::TimeAbove(at, _)
            | Take::FirstAbove(at, _) => self.over_time(history, *at),
        }
    }

    /// When an event happens for the first time in the window [s].
    fn first(&self, history: &Trajectory, event: &str) -> Option<f64> {
        let mut events = history.events.iter();
        let [from, to] = self.window;
        events
            .find(|(time, name)| name == event && (from..=to).contains(time))
            .map(|(time, _)| *time)
    }

    /// A column at the first row of an event: before anything jumps.
    fn value_at(&self, history: &Trajectory, at: usize, event: &str) -> Option<f64> {
        let time = self.first(history, event)?;
        let row = history.times().partition_point(|row| *row < time);
        column(history, at).get(row).copied()
    }

    fn over_time(&self, history: &Trajectory, at: usize) -> f64 {
        let [from, to] = self.window;
        let begin = history.times().partition_point(|time| *time < from);
        let end = history.times().partition_point(|time| *time <= to);
        let times = history.times().get(begin..end).unwrap_or(&[]);
        let values = column(history, at).get(begin..end).unwrap_or(&[]);
        if values.is_empty() || values.iter().any(|value| value.is_nan()) {
            return f64::NAN;
        }
        let span = times[times.len() - 1] - times[0];
        // ∫ of a function that is a polynomial of the column between two rows.
        let integral = |of: &dyn Fn(f64, f64) -> f64| -> f64 {
            let rows = times.windows(2).zip(values.windows(2));
            rows.map(|(t, x)| (t[1] - t[0]) * of(x[0], x[1])).sum()
        };
        let over_span = |sum: f64, alone: f64| if span > 0.0 { sum / span } else { alone };
        let last = values[values.len() - 1];
        match self.take {
            Take::Max(_) => values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            Take::Min(_) => values.iter().copied().fold(f64::INFINITY, f64::min),
            Take::Mean(_) => over_span(integral(&|a, b| 0.5 * (a + b)), last),
            Take::Rms(_) => {
                over_span(integral(&|a, b| (a * a + a * b + b * b) / 3.0), last * last).sqrt()
            }
            Take::Integral(_) => integral(&|a, b| 0.5 * (a + b)),
            Take::TimeAbove(_, level) => integral(&|a, b| part_above(a, b, level)),
            Take::FirstAbove(_, level) => first_above(times, values, level),
            _ => last,
        }
    }
}

fn column(history: &Trajectory, at: usize) -> &[f64] {
    let name = history.names().get(at).map_or("", |name| &name.name);
    history.column(name).unwrap_or(&[])
}

/// The part of a straight line from a to b that is above a level.
fn part_above(a: f64, b: f64, level: f64) -> f64 {
    match (a > level, b > level) {
        (true, true) => 1.0,
        (false, false) => 0.0,
        (true, false) => (a - level) / (a - b),
        (false, true) => (b - level) / (b - a),
    }
}

/// When straight lines between rows are above a level for the first time; NaN where they never are.
fn first_above(times: &[f64], values: &[f64], level: f64) -> f64 {
    if values.first().is_some_and(|first| *first > level) {
        return times[0];
    }
    let mut rows = times.windows(2).zip(values.windows(2));
    let crossing = rows.find(|(_, x)| x[1] > level);
    crossing.map_or(f64::NAN, |(t, x)| {
        t[0] + (t[1] - t[0]) * (level - x[0]) / (x[1] - x[0])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_is_above_half_its_height_for_half_of_its_time() {
        let (times, values) = ([0.0, 1.0, 4.0], [0.0, 2.0, 0.0]);
        let above: f64 = times
            .windows(2)
            .zip(values.windows(2))
            .map(|(t, x)| (t[1] - t[0]) * part_above(x[0], x[1], 1.0))
            .sum();
        assert!((above - 2.0).abs() < 1e-15);
        assert!((first_above(&times, &values, 1.0) - 0.5).abs() < 1e-15);
        assert!(first_above(&times, &values, 3.0).is_nan());
        assert_eq!(first_above(&times, &values, -1.0), 0.0);
    }

    #[test]
    fn a_requirement_is_not_met_by_what_has_no_value() {
        let require = Requirement {
            below: Some(3.0),
            above: Some(1.0),
            share: 0.9,
            confidence: 0.9,
        };
        assert!(require.meets(1.0) && require.meets(3.0) && !require.meets(3.1));
        assert!(!require.meets(0.9) && !require.meets(f64::NAN));
    }
}
