//! The cases whose histories are kept.

use std::path::Path;

use mbd_report::{Cell, Report, ReportTable};

use crate::histories::{self, Chosen, history_of, is_there, page_of};
use crate::results::Results;

/// The number of a case, which leads to its page if there is one.
pub fn case(folder: &Path, case: u64) -> Cell {
    match is_there(folder, case) {
        true => Cell::Link {
            text: format!("case {case}"),
            to: page_of(case),
        },
        false => format!("case {case}").into(),
    }
}

/// Adds the section of the chosen cases.
pub fn chosen(report: Report, (results, folder): (&Results, &Path), chosen: &[Chosen]) -> Report {
    if chosen.is_empty() {
        return report;
    }
    let manifest = &results.manifest;
    let mut table = ReportTable::new("Chosen cases")
        .column("case", "")
        .column("chosen as", "")
        .column("status", "")
        .number("end", "s", 6);
    for metric in &manifest.metrics {
        table = table.number(&metric.name, &metric.unit, 5);
    }
    table = table.column("history", "");
    let number = |x: f64| Some(x).filter(|x| !x.is_nan()).into();
    for chosen in chosen {
        let at = usize::try_from(chosen.case).ok();
        let Some(row) = at.and_then(|at| results.rows.get(at)) else {
            continue;
        };
        let mut cells = vec![
            case(folder, row.case),
            chosen.why.join("; ").into(),
            row.status.as_str().into(),
            number(row.time),
        ];
        cells.extend(row.metrics.iter().copied().map(number));
        let to = history_of(row.case);
        cells.push(match is_there(folder, row.case) {
            true => Cell::Link {
                text: "as a table".to_owned(),
                to,
            },
            false if histories::can_be(results, row.case) => "missing".into(),
            false => "none: its run could not begin".into(),
        });
        table.push(cells);
    }
    report.section("Histories").table(&table)
}
