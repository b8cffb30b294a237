//! The page of a campaign: what was required and whether it is shown, percentiles, histograms, drivers, failures with the command that repeats them.

use mbd_report::{Cell, Figure, Look, Report, Series, Table};

use crate::results::Results;
use crate::statistics::spearman;
use crate::summary::{CONFIDENCE, Failures, Summary, Told};

/// Failed cases of one kind that are listed with their commands.
const LISTED: usize = 5;
/// Drivers of a metric that are told.
const DRIVERS: usize = 8;

/// The page of a campaign; `replay` is the command that repeats a case, without its number.
#[must_use]
pub fn page(results: &Results, summary: &Summary, replay: &str) -> Report {
    let manifest = &results.manifest;
    let mut report = Report::new(format!("Campaign of {}", manifest.model))
        .section("Result")
        .paragraph(&opening(summary));
    for told in &summary.metrics {
        if let Some(verdict) = &told.verdict {
            report = report.paragraph(&verdict.sentence(&told.name, &told.unit));
        }
    }
    report = report.table(&overview(summary));
    for told in &summary.metrics {
        report = metric(report, results, told);
    }
    if !summary.failures.is_empty() {
        report = report.section("Failures");
    }
    for failures in &summary.failures {
        report = failed(report, results, failures, replay);
    }
    report
        .section("What was dispersed")
        .table(&dispersed(results))
        .paragraph("Case 0 is the nominal: it counts in no percentile. Any case is repeated, to the bit, by")
        .command(&format!("{replay} --case NUMBER"))
}

fn opening(summary: &Summary) -> String {
    let failed: usize = summary
        .failures
        .iter()
        .map(|kind| kind.cases.iter().filter(|case| **case > 0).count())
        .sum();
    let failures = match failed {
        0 => "all of them reached their end".to_owned(),
        1 => "1 of them did not reach its end".to_owned(),
        n => format!("{n} of them did not reach their end"),
    };
    format!(
        "{} cases beside the nominal; {failures}. Percentiles are order statistics of the cases that have a value, each with an interval that holds \
         that of the distribution with {:.0} % confidence; where there are not enough cases for an end of it, none is told.",
        summary.cases,
        100.0 * CONFIDENCE
    )
}

fn overview(summary: &Summary) -> Table {
    let mut table = Table::new("Metrics")
        .column("metric", "")
        .column("unit", "")
        .number("nominal", "", 5)
        .number("mean", "", 5)
        .number("standard deviation", "", 4)
        .number("smallest", "", 5)
        .number("largest", "", 5)
        .column("without a value", "cases");
    for told in &summary.metrics {
        let real = |x: f64| {
            if x.is_nan() {
                Cell::Missing
            } else {
                Cell::Number(x)
            }
        };
        let [mean, deviation] = told.moments;
        table.push([
            told.name.as_str().into(),
            told.unit.as_str().into(),
            real(told.nominal),
            real(mean),
            real(deviation),
            told.sorted.first().copied().into(),
            told.sorted.last().copied().into(),
            Cell::Count(told.without),
        ]);
    }
    table
}

fn metric(report: Report, results: &Results, told: &Told) -> Report {
    let report = report.section(&told.name);
    if told.sorted.is_empty() {
        return report.paragraph("No case has a value.");
    }
    let mut report = figures(report, told).table(&percentiles(told));
    if !told.drivers.is_empty() {
        report = report.table(&drivers(results, told));
    }
    report
}

/// Histogram and cumulated distribution, with the bounds of what is required.
fn figures(report: Report, told: &Told) -> Report {
    let (centres, shares) = histogram(&told.sorted);
    let n = told.sorted.len() as f64;
    let parts: Vec<f64> = (1..=told.sorted.len())
        .map(|rank| rank as f64 / n)
        .collect();
    let require = told.verdict.map(|verdict| verdict.require);
    let bounds: Vec<f64> = require
        .iter()
        .flat_map(|it| it.below.into_iter().chain(it.above))
        .collect();
    let top = shares.iter().copied().fold(0.0, f64::max);
    let lines: Vec<[Vec<f64>; 3]> = bounds
        .iter()
        .map(|bound| [vec![*bound; 2], vec![0.0, top], vec![0.0, 1.0]])
        .collect();
    let mut histogram = Figure::new(format!("{}: share of cases", told.name))
        .x(&told.name, &told.unit)
        .y("share", "")
        .series(Series::new("cases", &centres, &shares).look(Look::Solid));
    let mut cumulated = Figure::new(format!("{}: part of the cases at or below", told.name))
        .x(&told.name, &told.unit)
        .y("part", "")
        .series(Series::new("cases", &told.sorted, &parts).look(Look::Solid))
        .caption("The nominal case is not counted.");
    for [x, share, part] in &lines {
        histogram = histogram.series(Series::new("required", x, share).look(Look::Dashed));
        cumulated = cumulated.series(Series::new("required", x, part).look(Look::Dashed));
    }
    report.figure(&histogram).figure(&cumulated)
}

/// The polygon of a histogram: as many bins as the Freedman–Diaconis rule gives, 5 … 60.
fn histogram(sorted: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let (Some(low), Some(high)) = (sorted.first(), sorted.last()) else {
        return (Vec::new(), Vec::new());
    };
    let n = sorted.len();
    let quarter = sorted[3 * (n - 1) / 4] - sorted[(n - 1) / 4];
    let width = 2.0 * quarter / (n as f64).cbrt();
    let span = high - low;
    let bins = if width > 0.0 {
        (span / width).ceil().clamp(5.0, 60.0) as usize
    } else {
        5
    };
    // Cases that are all the same have a bin of some width, too.
    let width = if span > 0.0 {
        span / bins as f64
    } else {
        low.abs().max(1.0) * 1e-3
    };
    let mut counts = vec![0.0; bins];
    for value in sorted {
        counts[(((value - low) / width) as usize).min(bins - 1)] += 1.0 / n as f64;
    }
    let (mut x, mut y) = (vec![*low], vec![0.0]);
    for (bin, count) in counts.into_iter().enumerate() {
        x.extend([bin, bin + 1].map(|edge| low + edge as f64 * width));
        y.extend([count, count]);
    }
    x.push(*x.last().unwrap_or(low));
    y.push(0.0);
    (x, y)
}

fn percentiles(told: &Told) -> Table {
    let mut table = Table::new(format!("Percentiles of {}", told.name))
        .number("below lie", "%", 6)
        .number("value", &told.unit, 5)
        .column("from", &told.unit)
        .column("to", &told.unit);
    for percentile in &told.percentiles {
        let end = |end: Option<f64>| end.map_or(Cell::from("not enough cases"), Cell::Number);
        table.push([
            (100.0 * percentile.part).into(),
            percentile.value.into(),
            end(percentile.low),
            end(percentile.high),
        ]);
    }
    match told.ends {
        Some([low, high]) => table.note(format!(
            "The smallest is case {low}, the largest case {high}."
        )),
        None => table,
    }
}

fn drivers(results: &Results, told: &Told) -> Table {
    let mut table = Table::new(format!("What drives {}", told.name))
        .column("dispersed number", "")
        .number("rank correlation", "", 3)
        .number("share of the variance", "", 3);
    for driver in told.drivers.iter().take(DRIVERS) {
        let name = results
            .manifest
            .dispersed
            .get(driver.number)
            .map_or("", |column| &column.name);
        let share = driver.index.map_or(Cell::Missing, Cell::Number);
        table.push([name.into(), driver.correlation.into(), share]);
    }
    let doubt = 2.0 / (told.sorted.len().max(2) as f64 - 1.0).sqrt();
    table.note(format!(
        "Spearman; of numbers that drive nothing 95 % lie within ±{doubt:.2}. The share is the first-order Sobol index, from 100 cases on: what the number explains alone."
    ))
}

fn failed(report: Report, results: &Results, failures: &Failures, replay: &str) -> Report {
    let commands = failures
        .cases
        .iter()
        .take(LISTED)
        .map(|case| format!("{replay} --case {case}"));
    let commands: Vec<String> = commands.collect();
    let report = report
        .paragraph(&format!(
            "{}: {}. The first says: {}",
            failures.status,
            counted(failures.cases.len()),
            failures.why
        ))
        .command(&commands.join("\n"));
    match deciles(results, failures) {
        Some(table) => report.table(&table),
        None => report,
    }
}

fn counted(cases: usize) -> String {
    match cases {
        1 => "1 case".to_owned(),
        n => format!("{n} cases"),
    }
}

/// How failures are spread over the deciles of the dispersed number that they follow most.
fn deciles(results: &Results, failures: &Failures) -> Option<Table> {
    let failing: Vec<f64> = results
        .rows
        .iter()
        .skip(1)
        .map(|row| f64::from(u8::from(row.status == failures.status)))
        .collect();
    let follows = |at: usize| Some((at, spearman(&results.dispersed(at), &failing)?));
    let all = (0..results.manifest.dispersed.len()).filter_map(follows);
    let (at, correlation) = all.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    let column = &results.manifest.dispersed[at];
    let mut pairs: Vec<(f64, f64)> = results
        .dispersed(at)
        .into_iter()
        .zip(failing)
        .filter(|(x, _)| !x.is_nan())
        .collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut table = Table::new(format!("{} by deciles of {}", failures.status, column.name))
        .number("from", &column.unit, 5)
        .number("to", &column.unit, 5)
        .column("failed", "cases")
        .column("of", "cases");
    let ends: Vec<usize> = (0..=10).map(|k| k * pairs.len() / 10).collect();
    for decile in ends.windows(2) {
        let Some(part) = pairs
            .get(decile[0]..decile[1])
            .filter(|part| !part.is_empty())
        else {
            continue;
        };
        let failed: f64 = part.iter().map(|(_, failed)| failed).sum();
        table.push([
            part[0].0.into(),
            part[part.len() - 1].0.into(),
            Cell::Count(failed as u64),
            part.len().into(),
        ]);
    }
    Some(table.note(format!(
        "Rank correlation {correlation:+.2}, the strongest of all dispersed numbers."
    )))
}

fn dispersed(results: &Results) -> Table {
    let mut table = Table::new("Dispersed numbers")
        .column("name", "")
        .column("unit", "")
        .number("nominal", "", 5)
        .number("smallest", "", 5)
        .number("mean", "", 5)
        .number("largest", "", 5);
    for (at, column) in results.manifest.dispersed.iter().enumerate() {
        let values: Vec<f64> = results
            .dispersed(at)
            .into_iter()
            .filter(|x| !x.is_nan())
            .collect();
        let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
        table.push([
            column.name.as_str().into(),
            column.unit.as_str().into(),
            results.rows.first().map(|row| row.values[at]).into(),
            values.iter().copied().reduce(f64::min).into(),
            (!values.is_empty()).then_some(mean).into(),
            values.iter().copied().reduce(f64::max).into(),
        ]);
    }
    let manifest = &results.manifest;
    table.note(format!(
        "Seed {}; declaration {}, dispersions {}, settings {}; mbd {} on {}.",
        manifest.seed,
        manifest.declaration,
        manifest.dispersions,
        manifest.settings,
        manifest.version,
        manifest.target
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_histogram_holds_every_case_once() {
        for values in [
            vec![1.0; 7],
            (0..1000).map(f64::from).collect(),
            vec![-2.0, 5.0],
            vec![0.0],
        ] {
            let (x, y) = histogram(&values);
            assert_eq!(x.len(), y.len());
            // Each bin is drawn by two points.
            let sum: f64 = y.iter().sum::<f64>() / 2.0;
            assert!((sum - 1.0).abs() < 1e-12, "{sum}");
            assert!(x.is_sorted());
        }
    }
}
