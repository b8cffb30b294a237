//! Metrics: numbers of a run, read from its history. Over time columns are taken as straight between rows.

use std::fmt;

use mbd_scene::Scene;
use mbd_scene::metrics::{Metric, Take};

use crate::columns::Name;
use crate::trajectory::{Sampling, Trajectory};

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
    /// The number, or why there is none.
    pub value: Result<f64, MissingMetric>,
}

/// Why a history does not tell a metric.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MissingMetric {
    /// The quantity is in no column.
    NotRecorded,
    /// A value at an event is asked of a history that has no row there.
    NeedsEveryStep,
    /// The run stopped before its end.
    StoppedEarly,
    /// The event did not happen, the level was not passed, nothing determines the quantity, or no row lies in the window.
    NoValue,
}

impl fmt::Display for MissingMetric {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            MissingMetric::NotRecorded => {
                "the history does not hold its quantity: record it with `Content::RESULTS` or `Content::ALL`"
            }
            MissingMetric::NeedsEveryStep => {
                "a value at an event needs a row at every step: record with `Sampling::Steps`, in `[run]` without `every`"
            }
            MissingMetric::StoppedEarly => "the run stopped before its end",
            MissingMetric::NoValue => {
                "its event did not happen, its level was not passed, or its quantity has no value there"
            }
        })
    }
}

impl std::error::Error for MissingMetric {}

impl Trajectory {
    /// The metrics that a declaration has, in its order, of the rows that this history holds: of a run that stopped early up to there.
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
        let every_step = *self.sampling() == Sampling::Steps;
        let metrics = scene.runs.metrics.iter();
        let told = metrics.map(|metric| {
            let reader = MetricReader::new(metric, scene, self.names(), every_step);
            let read = reader.map(|reader| reader.read(self));
            MetricValue {
                name: metric.name.clone(),
                doc: metric.doc.clone(),
                take: metric.take,
                unit: metric.unit(scene),
                value: read.and_then(|value| match value.is_finite() {
                    true => Ok(value),
                    false => Err(MissingMetric::NoValue),
                }),
            }
        });
        told.collect()
    }
}

/// How a metric is read from histories with the same columns.
#[derive(Clone, Debug, PartialEq)]
pub struct MetricReader {
    /// How the number is made.
    pub take: Take,
    /// The number of the column of its quantity; [`Take::TimeOf`] does not look at it.
    pub column: usize,
    /// The level of [`Take::has_level`], in the unit of the column.
    pub level: f64,
    /// The event of [`Take::Value`] and [`Take::TimeOf`], as histories name it.
    pub event: String,
    /// From when and up to when a run counts [s].
    pub window: [f64; 2],
}

impl MetricReader {
    /// That of a declared metric, for histories with these columns; `every_step` says whether they have a row at every step, and so at every event.
    ///
    /// # Errors
    /// Such a history does not hold what the metric is made of.
    pub fn new(
        metric: &Metric,
        scene: &Scene,
        names: &[Name],
        every_step: bool,
    ) -> Result<Self, MissingMetric> {
        let output = metric.output.and_then(|output| scene.outputs.get(output));
        let event = metric.event.and_then(|event| scene.events.get(event));
        let column = names.iter().position(|known| known.name == metric.name);
        if output.is_some() && column.is_none() {
            return Err(MissingMetric::NotRecorded);
        }
        if metric.take == Take::Value && !every_step {
            return Err(MissingMetric::NeedsEveryStep);
        }
        let factor = output.map_or(1.0, |output| output.unit.factor);
        Ok(MetricReader {
            take: metric.take,
            column: column.unwrap_or(0),
            level: metric.level.map_or(f64::NAN, |level| level / factor),
            event: event.map_or(String::new(), |event| event.name.clone()),
            window: [
                metric.from.unwrap_or(f64::NEG_INFINITY),
                metric.to.unwrap_or(f64::INFINITY),
            ],
        })
    }

    /// Its value in a history; NaN where it has none. Of a history of several models ([`Joined`](crate::Joined)) those count that have the quantity.
    #[must_use]
    pub fn read(&self, history: &Trajectory) -> f64 {
        match self.take {
            Take::TimeOf => self.first(history).unwrap_or(f64::NAN),
            Take::Value => self.value_at(history).unwrap_or(f64::NAN),
            _ => self.over_time(history),
        }
    }

    /// When an event happens for the first time in the window [s].
    fn first(&self, history: &Trajectory) -> Option<f64> {
        let mut events = history.events.iter();
        let [from, to] = self.window;
        events
            .find(|(time, name)| *name == self.event && (from..=to).contains(time))
            .map(|(time, _)| *time)
    }

    /// A column at the first row of an event: before anything jumps.
    fn value_at(&self, history: &Trajectory) -> Option<f64> {
        let time = self.first(history)?;
        let row = history.times().partition_point(|row| *row < time);
        history.values(self.column).get(row).copied()
    }

    fn over_time(&self, history: &Trajectory) -> f64 {
        let (times, values) = (history.times(), history.values(self.column));
        let pieces = history.pieces(self.column).map(|rows| {
            let (times, values) = (times.get(rows.clone()), values.get(rows));
            between(
                times.unwrap_or_default(),
                values.unwrap_or_default(),
                self.window,
            )
        });
        let pieces: Vec<(Vec<f64>, Vec<f64>)> =
            pieces.filter(|(times, _)| !times.is_empty()).collect();
        let values = || pieces.iter().flat_map(|(_, values)| values).copied();
        let Some(last) = values().last().filter(|_| !values().any(f64::is_nan)) else {
            return f64::NAN;
        };
        let span: f64 = pieces
            .iter()
            .map(|(times, _)| times[times.len() - 1] - times[0])
            .sum();
        // ∫ of a function that is a polynomial of the column between two rows.
        let integral = |of: &dyn Fn(f64, f64) -> f64| -> f64 {
            let rows = pieces
                .iter()
                .flat_map(|(times, values)| times.windows(2).zip(values.windows(2)));
            rows.map(|(t, x)| (t[1] - t[0]) * of(x[0], x[1])).sum()
        };
        let over_span = |sum: f64, alone: f64| if span > 0.0 { sum / span } else { alone };
        match self.take {
            Take::Max => values().fold(f64::NEG_INFINITY, f64::max),
            Take::Min => values().fold(f64::INFINITY, f64::min),
            Take::Mean => over_span(integral(&|a, b| 0.5 * (a + b)), last),
            Take::Rms => {
                over_span(integral(&|a, b| (a * a + a * b + b * b) / 3.0), last * last).sqrt()
            }
            Take::Integral => integral(&|a, b| 0.5 * (a + b)),
            Take::TimeAbove => integral(&|a, b| part_above(a, b, self.level)),
            Take::FirstAbove => {
                let mut found = pieces
                    .iter()
                    .map(|(times, values)| first_above(times, values, self.level));
                found.find(|time| !time.is_nan()).unwrap_or(f64::NAN)
            }
            _ => last,
        }
    }
}

/// The rows in a window; where it begins and ends between two rows, a column is straight.
fn between(times: &[f64], values: &[f64], [from, to]: [f64; 2]) -> (Vec<f64>, Vec<f64>) {
    let begin = times.partition_point(|time| *time < from);
    let end = times.partition_point(|time| *time <= to);
    // The value between the row before `next` and that row, if both are there.
    let inside = |time: f64, next: usize| -> Option<(f64, f64)> {
        let before = next.checked_sub(1)?;
        let (t, x) = (times.get(before..=next)?, values.get(before..=next)?);
        let part = (time - t[0]) / (t[1] - t[0]);
        (t[0] < time && time < t[1]).then(|| (time, x[0] + part * (x[1] - x[0])))
    };
    let rows = times.iter().copied().zip(values.iter().copied());
    let rows = rows.skip(begin).take(end.saturating_sub(begin));
    let first = inside(from, begin).into_iter();
    first.chain(rows).chain(inside(to, end)).unzip()
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
    fn a_window_ends_between_rows_as_well_as_at_them() {
        let (times, values) = ([0.0, 1.0, 3.0], [0.0, 2.0, 6.0]);
        let part = |from, to| between(&times, &values, [from, to]);
        assert_eq!(part(0.5, 2.0), (vec![0.5, 1.0, 2.0], vec![1.0, 2.0, 4.0]));
        assert_eq!(part(1.5, 2.5), (vec![1.5, 2.5], vec![3.0, 5.0]));
        assert_eq!(part(0.0, 1.0), (vec![0.0, 1.0], vec![0.0, 2.0]));
        assert_eq!(part(4.0, 5.0), (vec![], vec![]));
        let all = [f64::NEG_INFINITY, f64::INFINITY];
        assert_eq!(between(&times, &values, all).0, times);
    }
}
