//! Metrics: numbers of a run, measured while it is recorded, by the interpolant of its method.

use std::fmt;

use mbd_scene::Scene;
use mbd_scene::metrics::{Metric, Take};
use mbd_scene::similar::near_and_all;

use crate::columns::Name;
use crate::trajectory::Trajectory;

/// A metric of a declaration and its value in a run, from [`Trajectory::metrics`].
#[derive(Clone, Debug, PartialEq)]
pub struct MetricValue {
    /// Its name.
    pub name: String,
    /// Documentation.
    pub doc: String,
    /// How it is taken.
    pub take: Take,
    /// Its unit; empty for a pure number.
    pub unit: String,
    /// The number, or why there is none. It is as accurate as the run, whatever rows its history has: extremes, passings of a level and integrals are
    /// those of the interpolant of the method inside its steps.
    pub value: Result<f64, MissingMetric>,
    /// About what the number may be off by where the quantity changes faster than halves of steps resolve, or is noise [its unit]; zero where it
    /// is resolved.
    pub unresolved: f64,
}

/// Why a reaction has no value, and what to do.
pub const SINGULAR_POSITION: &str = "rows of joints lose rank in this position (bars in one line, say), and nothing determines how they share the load; begin beside it, or ask for what the position does not leave open";

/// Why a history does not tell a metric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MissingMetric {
    /// The quantity is in no column, or nobody asked for it before the run.
    NotRecorded,
    /// The run stopped before its end.
    StoppedEarly,
    /// The run did not come to its scene.
    NotReached,
    /// The event did not happen.
    NoEvent,
    /// The run does not locate events, and sees none happen.
    NotLocated,
    /// The level was not passed.
    NotPassed,
    /// Nothing of the run lies in the window.
    NothingInWindow,
    /// The quantity is not a number where the metric needs it: 0/0, or nothing determines it.
    NotANumber {
        /// When first [s].
        time: f64,
    },
    /// The quantity is made of what joints carry, and nothing determines that: rows of joints lose rank.
    Undetermined {
        /// When first [s].
        time: f64,
    },
    /// It is beyond the largest number: the square of 1e200.
    TooLarge,
    /// The run was taken back to before what had been measured.
    TakenBack,
}

impl MissingMetric {
    /// Whether its quantity, or it, is no finite number, rather than that the run did not come to it.
    #[must_use]
    pub fn is_not_finite(self) -> bool {
        matches!(
            self,
            MissingMetric::NotANumber { .. }
                | MissingMetric::Undetermined { .. }
                | MissingMetric::TooLarge
        )
    }
}

impl fmt::Display for MissingMetric {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Nine decimals, as errors tell times, without those that say nothing.
        let told = |time: &f64| {
            let time = format!("{time:.9}");
            let time = time.trim_end_matches('0').trim_end_matches('.');
            time.to_owned()
        };
        f.write_str(match self {
            MissingMetric::NotANumber { time } => {
                return write!(f, "its quantity is not a number at {} s", told(time));
            }
            MissingMetric::Undetermined { time } => {
                return write!(
                    f,
                    "what joints carry has no value at {} s: {SINGULAR_POSITION}",
                    told(time)
                );
            }
            MissingMetric::NotRecorded => {
                "the history does not hold its quantity: record it with `Content::RESULTS` or `Content::ALL`"
            }
            MissingMetric::StoppedEarly => "the run stopped before its end",
            MissingMetric::NotReached => "the run did not come to its scene",
            MissingMetric::NoEvent => {
                "its event did not happen, or not between its `from` and `to`"
            }
            MissingMetric::NotLocated => {
                "its event is not located in this run (`locate = false`)"
            }
            MissingMetric::NotPassed => {
                "its level was not passed, or not between its `from` and `to`"
            }
            MissingMetric::NothingInWindow => "nothing of the run lies between its `from` and `to`",
            MissingMetric::TooLarge => "it is beyond the largest number",
            MissingMetric::TakenBack => {
                "the run was taken back to before what had been measured"
            }
        })
    }
}

impl std::error::Error for MissingMetric {}

impl Trajectory {
    /// The metrics that a declaration has, in its order, of the run that was recorded: of one that stopped early up to there.
    ///
    /// ```
    /// use mbd_runtime::{Content, Model, Options, Sampling, Simulation, Trajectory, model};
    ///
    /// model! {
    ///     model Throw {
    ///         gravity: [0.0, 0.0, -10.0] m/s^2;
    ///         point stone { mass: 1.0 kg, start at [0.0, 0.0, 0.0] m velocity [3.0, 0.0, 10.0] m/s }
    ///         metric highest = max stone.position.z;
    ///     }
    /// }
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let throw = Throw::new(ThrowParams::default())?;
    /// let mut history = Trajectory::new(&throw, Sampling::Every(0.1), Content::RESULTS);
    /// Simulation::new(&throw, Options::rk4(0.1))?.record(2.0, &mut history)?;
    /// let metrics = history.metrics(throw.scene());
    /// assert!((metrics[0].value? - 5.0).abs() < 1e-12);
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn metrics(&self, scene: &Scene) -> Vec<MetricValue> {
        let metrics = scene.runs.metrics.iter();
        let told = metrics.map(|metric| {
            let reader = MetricReader::new(metric, scene, self.names());
            let read = reader.and_then(|reader| self.measured(&reader));
            MetricValue::new(metric, scene, read)
        });
        told.collect()
    }

    /// A metric that the declaration has, by its name, of the run that was recorded; its unit is that of the declaration, or of the output it is made of.
    ///
    /// ```
    /// use mbd_runtime::{Content, Options, Sampling, Simulation, Trajectory, model};
    ///
    /// model! {
    ///     model Throw {
    ///         gravity: [0.0, 0.0, -10.0] m/s^2;
    ///         point stone { mass: 1.0 kg, start at [0.0, 0.0, 0.0] m velocity [3.0, 0.0, 10.0] m/s }
    ///         output height = stone.position.z in mm;
    ///         metric highest = max height;
    ///     }
    /// }
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let throw = Throw::new(ThrowParams::default())?;
    /// let mut history = Trajectory::new(&throw, Sampling::Every(0.1), Content::RESULTS);
    /// Simulation::new(&throw, Options::rk4(0.1))?.record(2.0, &mut history)?;
    /// assert!((history.metric("highest")? - 5000.0).abs() < 1e-9);
    /// let error = history.metric("higest").unwrap_err().to_string();
    /// assert!(error.contains("did you mean `highest`?"), "{error}");
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// A name that is no metric; one that has no value, as [`MissingMetric`] says.
    pub fn metric(&self, name: &str) -> Result<f64, NoMetric> {
        let no_metric = |why: String| NoMetric {
            name: name.to_owned(),
            why,
        };
        let names = || self.declared.iter().map(|(known, _)| known.as_str());
        let Some((_, reader)) = self.declared.iter().find(|(known, _)| known == name) else {
            return Err(no_metric(match names().len() {
                0 => "is no metric: this model declares none".to_owned(),
                _ => format!("is no metric{}", near_and_all(name, names())),
            }));
        };
        let read = reader.as_ref().map_err(|why| *why);
        let read = read.and_then(|reader| self.measured(reader));
        let value = read.map(|[value, _]| value);
        value.map_err(|why| no_metric(format!("has no value: {why}")))
    }
}

/// A metric that cannot be told: [`Trajectory::metric`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NoMetric {
    /// The name that was asked for.
    pub name: String,
    /// Why there is no number.
    pub why: String,
}

impl fmt::Display for NoMetric {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` {}", self.name, self.why)
    }
}

impl std::error::Error for NoMetric {}

impl MetricValue {
    /// A metric of a scene, as [`Trajectory::measured`] read it.
    #[must_use]
    pub fn new(metric: &Metric, scene: &Scene, read: Result<[f64; 2], MissingMetric>) -> Self {
        MetricValue {
            name: metric.name.clone(),
            doc: metric.doc.clone(),
            take: metric.take,
            unit: metric.unit(scene),
            value: read.map(|[value, _]| value),
            unresolved: read.map_or(0.0, |[_, unresolved]| unresolved),
        }
    }
}

impl MetricValue {
    /// The part of its value that it may be off by [1]; `None` where it has none, or is zero.
    #[must_use]
    pub fn unresolved_part(&self) -> Option<f64> {
        let value = self.value.ok().filter(|value| *value != 0.0)?;
        Some(self.unresolved / value.abs())
    }

    /// What to say of one that is off by a part of its value [1].
    #[must_use]
    pub fn off_by(&self, part: f64) -> String {
        format!(
            "`{}` is off by about {:.1} % of its value: what it measures changes faster than it can be followed inside a step, or is noise",
            self.name,
            100.0 * part
        )
    }
}

/// How a metric is measured in histories with the same columns: [`Trajectory::measure`].
#[derive(Clone, Debug, PartialEq)]
pub struct MetricReader {
    /// How the number is made.
    pub take: Take,
    /// The number of the column of its quantity; [`Take::TimeOf`] does not look at it.
    pub column: usize,
    /// The level of [`Take::has_level`], in the unit of the column.
    pub level: Option<f64>,
    /// The event of [`Take::Value`] and [`Take::TimeOf`], as histories name it.
    pub event: String,
    /// From when and up to when a run counts [s].
    pub window: [f64; 2],
}

impl MetricReader {
    /// Whether it hangs on the quantity at nothing but the last instant of a run.
    pub(crate) fn is_of_the_end(&self) -> bool {
        self.take == Take::Final && self.window[1] == f64::INFINITY
    }

    /// From when and up to when it hangs on the quantity [s].
    pub(crate) fn span(&self) -> [f64; 2] {
        match self.take {
            Take::Final => [self.window[1]; 2],
            _ => self.window,
        }
    }

    /// Whether it hangs on the quantity before that.
    pub(crate) fn is_over_time(&self) -> bool {
        self.take != Take::TimeOf && !self.is_of_the_end()
    }

    /// That of a declared metric, for histories with these columns.
    ///
    /// # Errors
    /// Such a history does not hold what the metric is made of.
    pub fn new(metric: &Metric, scene: &Scene, names: &[Name]) -> Result<Self, MissingMetric> {
        let output = metric.output.and_then(|output| scene.outputs.get(output));
        let event = metric.event.and_then(|event| scene.events.get(event));
        let held = metric.column();
        let column = names.iter().position(|known| known.name == held);
        if output.is_some() && column.is_none() {
            return Err(MissingMetric::NotRecorded);
        }
        let factor = output.map_or(1.0, |output| output.unit.factor);
        Ok(MetricReader {
            take: metric.take,
            column: column.unwrap_or(0),
            level: metric.level.map(|level| level / factor),
            event: event.map_or(String::new(), |event| event.name.clone()),
            window: [
                metric.from.unwrap_or(f64::NEG_INFINITY),
                metric.to.unwrap_or(f64::INFINITY),
            ],
        })
    }
}
