//! What is told of a metric: percentiles, histogram, cumulated distribution, drivers.

use mbd_report::{Cell, Figure, Look, Report, ReportTable, Series};

use crate::results::Results;
use crate::sampling::CaseSampling;
use crate::summary::Told;
use crate::table::percent;

/// Drivers of a metric that are told.
const DRIVERS: usize = 8;

/// Adds the section of a metric.
pub fn metric(report: Report, results: &Results, told: &Told) -> Report {
    let report = report.section(&told.name);
    if told.sorted.is_empty() {
        return report.paragraph("No case has a value.");
    }
    let mut report = figures(report, told).table(&percentiles(told, results.manifest.sampling));
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
        .series(
            Series::new("cases", &centres, &shares)
                .look(Look::Solid)
                .unmarked(),
        );
    let mut cumulated = Figure::new(format!("{}: part of the cases at or below", told.name))
        .x(&told.name, &told.unit)
        .y("part", "")
        .series(Series::new("cases", &told.sorted, &parts).look(Look::Solid))
        .caption("The nominal case is not counted.");
    for [x, share, part] in &lines {
        histogram = histogram.series(
            Series::new("required", x, share)
                .look(Look::Dashed)
                .unmarked(),
        );
        cumulated = cumulated.series(
            Series::new("required", x, part)
                .look(Look::Dashed)
                .unmarked(),
        );
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

fn percentiles(told: &Told, sampling: CaseSampling) -> ReportTable {
    let is_sample = sampling != CaseSampling::Grid;
    let mut table = ReportTable::new(format!("Percentiles of {}", told.name))
        .column("below lie", "%")
        .number("value", &told.unit, 5);
    if is_sample {
        table = table.column("from", &told.unit).column("to", &told.unit);
    }
    for percentile in &told.percentiles {
        let end = |end: Option<f64>| end.map_or(Cell::from("not enough cases"), Cell::Number);
        let part = percent(percentile.part, 4);
        let value = [part.as_str().into(), percentile.value.into()];
        let interval = [percentile.low, percentile.high].map(end);
        table.push(
            value
                .into_iter()
                .chain(interval.into_iter().filter(|_| is_sample)),
        );
    }
    match told.ends {
        Some([low, high]) => table.note(format!(
            "The smallest is case {low}, the largest case {high}."
        )),
        None => table,
    }
}

fn drivers(results: &Results, told: &Told) -> ReportTable {
    let dispersed = &results.manifest.dispersed;
    let shown = || told.drivers.iter().take(DRIVERS);
    let is_accompanied = shown().any(|driver| !driver.together.is_empty());
    let mut table = ReportTable::new(format!("What drives {}", told.name))
        .column("dispersed number", "")
        .number("rank correlation", "", 3)
        .number("share of the variance", "", 3);
    if is_accompanied {
        table = table.column("not alone", "");
    }
    for driver in shown() {
        let name = dispersed
            .get(driver.number)
            .map_or("", |column| &column.name);
        let share = driver.index.map_or(Cell::Missing, Cell::Number);
        let company = driver.company(dispersed).unwrap_or_default();
        let cells = [name.into(), driver.correlation.into(), share];
        let company = is_accompanied.then(|| company.as_str().into());
        table.push(cells.into_iter().chain(company));
    }
    let chance = match results.manifest.sampling {
        CaseSampling::Grid => String::new(),
        _ => format!(
            "; of numbers that drive nothing 95 % lie within ±{:.2}",
            told.chance()
        ),
    };
    let company = match is_accompanied {
        true => {
            " Numbers that are correlated with each other have none, and each shows what the others do, too."
        }
        false => "",
    };
    table.note(format!(
        "Spearman{chance}. The share is the first-order Sobol index, from 100 cases on: what the number explains alone.{company}"
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
