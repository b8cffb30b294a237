//! What is told of failures: kinds, commands that repeat them, where they lie.

use std::path::Path;

use mbd_report::{Cell, Report, ReportTable};

use super::chosen::case;
use crate::results::Results;
use crate::statistics::spearman;
use crate::summary::Failures;
use crate::table::counted;

/// Failed cases of one kind that are listed.
const LISTED: usize = 5;

/// Adds what failed in one way.
pub fn failed(
    report: Report,
    (results, folder): (&Results, &Path),
    failures: &Failures,
    replay: &str,
) -> Report {
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
            counted(failures.cases.len() as u64, "case"),
            failures.why
        ))
        .command(&commands.join("\n"))
        .table(&first(results, folder, failures));
    match deciles(results, failures) {
        Some(table) => report.table(&table),
        None => report,
    }
}

/// The first cases, with their pages where they have one.
fn first(results: &Results, folder: &Path, failures: &Failures) -> ReportTable {
    let mut table = ReportTable::new(format!("First cases of {}", failures.status))
        .column("case", "")
        .number("end", "s", 6)
        .column("why", "");
    let cases = failures.cases.iter().take(LISTED);
    let rows = cases.filter_map(|case| results.rows.get(usize::try_from(*case).ok()?));
    for row in rows {
        table.push([
            case(folder, row.case),
            Some(row.time).filter(|time| !time.is_nan()).into(),
            row.why.as_str().into(),
        ]);
    }
    table
}

/// How failures are spread over the deciles of the dispersed number that they follow most.
fn deciles(results: &Results, failures: &Failures) -> Option<ReportTable> {
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
    let mut table = ReportTable::new(format!("{} by deciles of {}", failures.status, column.name))
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
