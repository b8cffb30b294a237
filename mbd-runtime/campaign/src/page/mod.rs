//! The page of a campaign: what was required and whether it is shown, columns over time, footprints, percentiles, histograms, drivers, chosen cases,
//! failures with the command that repeats them.

mod chosen;
mod failures;
mod metric;
mod over_time;
mod spread;

use std::io;
use std::path::Path;

use mbd_report::files::{FileNames, write_text};
use mbd_report::{Cell, Figure, Report, ReportTable};

use crate::campaign::CasePart;
use crate::envelopes::Envelope;
use crate::histories::{self, Chosen};
use crate::results::{CaseRow, Results};
use crate::sampling::CaseSampling;
use crate::summary::{CONFIDENCE, CampaignSummary, Told};
use crate::table::counted;
use spread::FootprintCurves;

/// The page of a campaign, beside what its results say.
#[derive(Clone, Copy)]
pub struct Page<'p> {
    /// The folder of results: pages of cases that are there are linked.
    pub folder: &'p Path,
    /// The command that repeats a case, without its number.
    pub replay: &'p str,
    /// The envelopes.
    pub envelopes: &'p [Envelope],
    /// The cases whose histories are kept.
    pub chosen: &'p [Chosen],
    /// The scenes that the nominal came to, or why it cannot be flown again here.
    pub nominal: Result<&'p [CasePart], &'p String>,
}

impl Page<'_> {
    /// Writes `report.html` into the folder, and every picture of columns over time and of footprints as a file of its own; the names of these.
    ///
    /// # Errors
    /// A file cannot be written whole; the error names it.
    pub fn write(&self, results: &Results, summary: &CampaignSummary) -> io::Result<Vec<String>> {
        let mut names: Vec<String> = Vec::new();
        let mut files = FileNames::default();
        let mut picture = |kind: &str, name: &str, figure: &Figure<'_>| {
            let file = files.next(&format!("{kind}_{name}"), "svg");
            write_text(&self.folder.join(&file), &figure.svg())?;
            names.push(file);
            Ok::<(), io::Error>(())
        };
        for envelope in self.envelopes {
            picture("envelope", &envelope.name, &over_time::figure(envelope))?;
        }
        for footprint in &results.manifest.told.footprints {
            if let Some(spread) = footprint.of(results) {
                let name = format!("{}_{}", footprint.x, footprint.y);
                picture("footprint", &name, &FootprintCurves::of(&spread).figure())?;
            }
        }
        self.html(results, summary)
            .write(self.folder.join("report.html"))?;
        Ok(names)
    }

    /// The page.
    #[must_use]
    pub fn html(&self, results: &Results, summary: &CampaignSummary) -> Report {
        let mut report =
            Report::new(format!("Campaign of {}", results.manifest.model)).section("Result");
        for told in &summary.metrics {
            if let Some(verdict) = &told.verdict {
                let sentence = verdict.sentence(&told.name, &told.unit);
                report = report.verdict(&sentence, verdict.holds());
            }
        }
        report = report.paragraph(&opening(summary));
        report = report.table(&overview(results, summary));
        let strongest = strongest(results, summary);
        if !strongest.is_empty() {
            report = report.table(&strongest);
        }
        report = self.moving(report);
        report = self.over_time(report, results);
        report = footprints(report, results);
        for told in &summary.metrics {
            report = metric::metric(report, results, told);
        }
        let of = (results, self.folder);
        report = chosen::chosen(report, of, self.chosen);
        if !summary.failures.is_empty() {
            report = report.section("Failures");
        }
        for kind in &summary.failures {
            report = failures::failed(report, of, kind, self.replay);
        }
        report
            .section("What was dispersed")
            .table(&dispersed(results))
            .paragraph("Case 0 is the nominal: it counts in no percentile. Any case is repeated, to the bit, by")
            .command(&format!("{} --case NUMBER", self.replay))
    }

    /// The nominal as it moves: what all of this is about.
    fn moving(&self, report: Report) -> Report {
        match self.nominal {
            Ok([]) => report,
            Ok(parts) => histories::with_motion(report, parts).paragraph("The nominal: case 0."),
            Err(why) => report.section("Motion").paragraph(&format!(
                "The nominal is not shown as it moves, because it cannot be flown again here: {why}"
            )),
        }
    }

    fn over_time(&self, report: Report, results: &Results) -> Report {
        if self.envelopes.is_empty() {
            return report;
        }
        let figures = self.envelopes.iter().map(over_time::figure);
        let report = figures.fold(report.section("Over time"), |report, figure| {
            report.figure(&figure)
        });
        let envelopes = results.manifest.envelopes.as_ref();
        match envelopes.and_then(|envelopes| envelopes.beyond(&results.rows)) {
            Some(text) => report.paragraph(&text),
            None => report,
        }
    }
}

fn footprints(report: Report, results: &Results) -> Report {
    let footprints = &results.manifest.told.footprints;
    let all = footprints
        .iter()
        .filter_map(|footprint| footprint.of(results));
    let all: Vec<_> = all.collect();
    if all.is_empty() {
        return report;
    }
    all.iter().fold(report.section("Footprint"), |report, own| {
        spread::spread(report.figure(&FootprintCurves::of(own).figure()), own)
    })
}

fn opening(summary: &CampaignSummary) -> String {
    let told = CaseRow::DOUBTFUL;
    let count = |is_one: &dyn Fn(&str) -> bool| -> usize {
        let kinds = summary.failures.iter();
        let own = kinds.filter(|kind| is_one(&kind.status));
        own.map(|kind| kind.cases.iter().filter(|case| **case > 0).count())
            .sum()
    };
    let failed = count(&|status| !told.contains(&status));
    let failures = match failed {
        0 if summary.cases == 1 => "it reached its end".to_owned(),
        0 => "all of them reached their end".to_owned(),
        1 if summary.cases == 1 => "it did not reach its end".to_owned(),
        1 => "1 of them did not reach its end".to_owned(),
        n => format!("{n} of them did not reach their end"),
    };
    let said = [
        "a metric or an output is no finite number",
        "the steps made or lost energy",
        "a metric is not resolved",
        "a metric is that of a part of its window only",
    ];
    let doubtful =
        told.into_iter()
            .zip(said)
            .map(|(status, text)| match count(&|own| own == status) {
                0 => String::new(),
                n => format!("; in {n} {text}"),
            });
    let doubtful: String = doubtful.collect();
    format!(
        "{} beside the nominal; {failures}{doubtful}.",
        counted(summary.cases, "case")
    )
}

/// Drivers of a metric that stand beside it.
const DRIVERS: usize = 2;

fn overview(results: &Results, summary: &CampaignSummary) -> ReportTable {
    let mut table = ReportTable::new("Metrics")
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
    for told in &summary.metrics {
        if let Some(why) = told.reason() {
            table = table.note(format!("`{}` has no value where {why}.", told.name));
        }
        if let Some(caution) = told.caution() {
            table = table.note(format!("`{}`: {caution}.", told.name));
        }
        if let Some(cut) = &told.cut {
            table = table.note(format!("`{}`: {}.", told.name, cut.sentence()));
        }
    }
    table.note(match results.manifest.sampling {
        CaseSampling::Grid => "Percentiles, below, are shares of the points of the grid that have a value: a grid is no random sample, and has no confidence.".to_owned(),
        _ => format!(
            "Percentiles, below, are order statistics of the cases that have a value, each with an interval that holds that of the distribution with \
             {:.0} % confidence; where there are not enough cases for an end of it, none is told.",
            100.0 * CONFIDENCE
        ),
    })
}

/// The metrics that something drives, with the strongest of it.
fn strongest(results: &Results, summary: &CampaignSummary) -> ReportTable {
    let mut table = ReportTable::new("What drives them most")
        .column("metric", "")
        .column("dispersed numbers", "");
    for told in &summary.metrics {
        let drivers = driven(results, told);
        if !drivers.is_empty() {
            table.push([told.name.as_str().into(), drivers.as_str().into()]);
        }
    }
    table.note("With the share of the variance that each explains alone; where that is not known, or it is correlated with others, with its rank correlation.")
}

/// The strongest drivers of a metric; nothing that may as well drive nothing.
fn driven(results: &Results, told: &Told) -> String {
    let names = &results.manifest.dispersed;
    let doubt = told.chance();
    let drivers = told.drivers.iter().take(DRIVERS);
    let drivers = drivers.filter(|driver| match driver.index {
        Some(index) => index >= 0.05,
        None => driver.correlation.abs() > doubt,
    });
    let told = drivers.filter_map(|driver| {
        let name = &names.get(driver.number)?.name;
        Some(match (driver.index, driver.company(names)) {
            (_, Some(company)) => format!("{name} ({:+.2}, {company})", driver.correlation),
            (Some(index), _) => format!("{name} ({:.0} %)", 100.0 * index),
            _ => format!("{name} ({:+.2})", driver.correlation),
        })
    });
    told.collect::<Vec<_>>().join(", ")
}

fn dispersed(results: &Results) -> ReportTable {
    let mut table = ReportTable::new("Dispersed numbers")
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
