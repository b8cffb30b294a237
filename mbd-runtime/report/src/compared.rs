//! Runs over each other: one drawing of all motions, their curves, and how far these are apart.

use mbd_runtime::{Name, Trajectory};

use super::figure::Figure;
use super::html::Report;
use super::motion::RecordedMotion;
use super::plots::period;
use super::series::Series;
use super::views::Run;

/// More columns than this help nobody.
const COLUMNS: usize = 40;

/// Runs over each other, each with its label.
#[derive(Clone, Debug)]
pub struct Compared<'a> {
    motion: RecordedMotion,
    curves: Vec<ComparedCurves<'a>>,
    left_out: usize,
}

/// A column of the first run with those of the others that have it, too.
#[derive(Clone, Debug)]
struct ComparedCurves<'a> {
    name: &'a Name,
    runs: Vec<(&'a str, &'a [f64], &'a [f64])>,
    /// Of the runs behind the first: times, and how far they are from it there.
    apart: Vec<(&'a str, Vec<f64>, Vec<f64>)>,
}

impl<'a> Compared<'a> {
    /// Runs with their labels, the one that others are compared with first.
    #[must_use]
    pub fn new(runs: &[(&'a str, Run<'a>)]) -> Self {
        let columns = runs
            .first()
            .map(|(_, first)| columns(first))
            .unwrap_or_default();
        let shared = columns.into_iter().filter_map(|name| curves(name, runs));
        let mut curves: Vec<ComparedCurves<'_>> = shared.collect();
        let left_out = curves.len().saturating_sub(COLUMNS);
        curves.truncate(COLUMNS);
        Compared {
            motion: RecordedMotion::of_several(runs),
            curves,
            left_out,
        }
    }

    /// A page with all motions in one drawing.
    #[must_use]
    pub fn with_motion(&self, report: Report) -> Report {
        self.motion.on(report)
    }

    /// A page with the curves that the runs share, and their differences from the first.
    #[must_use]
    pub fn with_histories(&self, report: Report) -> Report {
        let mut report = report.section("Histories");
        if self.curves.is_empty() {
            report = report.paragraph("The runs share no output and no tension.");
        }
        for curves in &self.curves {
            let Name { name, unit, .. } = curves.name;
            let over = Figure::new(name).x("time", "s").y(name, unit);
            let over = curves
                .runs
                .iter()
                .fold(over, |figure, (label, times, values)| {
                    let series = Series::new(*label, times, values);
                    figure.series(match period(unit, values) {
                        Some(period) => series.periodic(period),
                        None => series,
                    })
                });
            let difference = "difference";
            let apart = Figure::new(format!("{name}: difference"))
                .x("time", "s")
                .y(difference, unit);
            let apart = curves
                .apart
                .iter()
                .fold(apart, |figure, (label, times, values)| {
                    let first = curves.runs.first().map_or("", |(label, ..)| label);
                    figure.series(Series::new(format!("{label} − {first}"), times, values))
                });
            let apart = apart
                .caption("At the rows of the first run; the others are straight between theirs.");
            report = report.figure(&over).figure(&apart);
        }
        match self.left_out {
            0 => report,
            more => report.paragraph(&format!("{more} more columns are shared and not shown.")),
        }
    }
}

/// The outputs and tensions of a run.
fn columns<'a>(run: &Run<'a>) -> Vec<&'a Name> {
    let outputs = |name: &str| {
        let mut outputs = run.scene.outputs.iter();
        outputs.any(|output| {
            let rest = name.strip_prefix(output.name.as_str());
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        })
    };
    let tension = |name: &str| {
        let line = name.strip_suffix(".tension");
        line.is_some_and(|line| run.scene.lines.iter().any(|known| known.name == line))
    };
    let names = run.trajectory.names().iter();
    names
        .filter(|name| outputs(&name.name) || tension(&name.name))
        .collect()
}

/// A column in all runs that have it in the same unit; `None` where only the first does.
fn curves<'a>(name: &'a Name, runs: &[(&'a str, Run<'a>)]) -> Option<ComparedCurves<'a>> {
    let has = |trajectory: &'a Trajectory| {
        let mut names = trajectory.names().iter();
        let same = names.find(|known| known.name == name.name)?;
        let column = trajectory.column(&name.name)?;
        (same.unit == name.unit).then_some((trajectory.times(), column))
    };
    let runs: Vec<(&str, &[f64], &[f64])> = runs
        .iter()
        .filter_map(|(label, run)| {
            has(run.trajectory).map(|(times, column)| (*label, times, column))
        })
        .collect();
    let [(_, times, first), others @ ..] = runs.as_slice() else {
        return None;
    };
    let shared_period = others
        .iter()
        .chain([&runs[0]])
        .find_map(|(.., values)| period(&name.unit, values));
    let apart = others.iter().map(|(label, own, values)| {
        let common = times.iter().zip(*first).filter_map(|(time, reference)| {
            let mut apart = at(own, values, *time)? - reference;
            // Of angles the shorter way.
            if let Some(period) = shared_period {
                apart -= period * (apart / period).round();
            }
            Some((*time, apart))
        });
        let (times, apart) = common.unzip();
        (*label, times, apart)
    });
    let apart: Vec<_> = apart.collect();
    (!apart.is_empty()).then_some(ComparedCurves { name, runs, apart })
}

/// A column at a time, straight between its rows; `None` beyond its ends.
fn at(times: &[f64], values: &[f64], time: f64) -> Option<f64> {
    let (first, last) = (*times.first()?, *times.last()?);
    let slack = 1e-9 * (last - first).abs();
    if time < first - slack || time > last + slack {
        return None;
    }
    let next = times.partition_point(|t| *t < time).min(times.len() - 1);
    let before = next.saturating_sub(1);
    let [a, b] = [before, next].map(|row| values[row]);
    let span = times[next] - times[before];
    let share = if span > 0.0 {
        (time - times[before]) / span
    } else {
        1.0
    };
    Some(if share >= 1.0 { b } else { a + share * (b - a) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_rows_a_column_is_straight_and_beyond_them_it_is_not() {
        let (times, values) = ([0.0, 1.0, 1.0, 3.0], [0.0, 2.0, 5.0, 1.0]);
        assert_eq!(at(&times, &values, 0.5), Some(1.0));
        assert_eq!(at(&times, &values, 2.0), Some(3.0));
        assert_eq!(at(&times, &values, 3.0), Some(1.0));
        assert_eq!(at(&times, &values, 3.1), None);
        assert_eq!(at(&[], &[], 0.0), None);
    }
}
