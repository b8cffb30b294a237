//! The page of a case: what it was, how it ended, its run; of a run that came to several scenes, the way it took, and a page of each.

use mbd_report::{Cell, Report, ReportTable, Run, Views, with_run};
use mbd_runtime::Trajectory;

use super::choice::Chosen;
use super::{page_of, part_of};
use crate::campaign::{Campaign, CasePart};
use crate::phases;
use crate::results::CaseRow;

/// The pages of a case by the names of their files, from the folder of results: those of the scenes that it came to, where these are several, and its own last.
pub fn pages(
    campaign: &Campaign,
    (row, parts, history): (&CaseRow, &[CasePart], &Trajectory),
    chosen: &Chosen,
    replay: &str,
) -> Vec<(String, Report)> {
    let mut all = Vec::new();
    let title = format!(
        "Case {} of a campaign of {}",
        row.case,
        campaign.manifest().model
    );
    let mut own = opening(title, row, chosen)
        .table(&numbers(campaign, row))
        .paragraph("It is repeated, to the bit, by")
        .command(&format!("{replay} --case {}", row.case));
    match (campaign.phases(), parts) {
        (_, []) => {}
        ([_], [part]) => own = with_part(own, part),
        (_, parts) => {
            let told: Vec<phases::FlownPart<'_>> = parts.iter().map(CasePart::told).collect();
            own = own.table(&phases::table(&told));
            for (number, part) in (1..).zip(parts) {
                let name = &part.model.scene().name;
                let (title, file) = (format!("{number}. {name}"), part_of(row.case, number));
                let to = file.rsplit('/').next().unwrap_or_default();
                own = own.link(&format!("{title} alone"), to);
                let page = Report::new(format!("{title}: case {}", row.case));
                let back = page_of(row.case);
                let page = page.link(
                    "The whole case",
                    back.rsplit('/').next().unwrap_or_default(),
                );
                all.push((file, with_part(page, part)));
            }
            own = phases::with_histories(with_motion(own, parts), &told, history);
        }
    }
    all.push((page_of(row.case), own));
    all
}

fn opening(title: String, row: &CaseRow, chosen: &Chosen) -> Report {
    let end = match row.status.as_str() {
        CaseRow::OK => format!("It reached its end at {} s.", row.time),
        _ if row.reached_end() => format!("It reached its end at {} s, and {}.", row.time, row.why),
        status => format!(
            "It did not reach its end ({status}); the history goes up to its last accepted step at {} s: {}",
            row.time, row.why
        ),
    };
    Report::new(title)
        .link("All cases", "../report.html")
        .paragraph(&format!("{end} Chosen as {}.", chosen.why.join("; ")))
}

/// What was flown in one scene.
fn with_part(report: Report, part: &CasePart) -> Report {
    with_run(report, (&*part.model, &part.plan.options), &shown(part))
}

/// What was flown, as it moves.
pub(crate) fn with_motion(report: Report, parts: &[CasePart]) -> Report {
    let runs: Vec<Run<'_>> = parts.iter().map(shown).collect();
    match runs.as_slice() {
        [alone] => Views::new(alone).with_motion(report),
        several => phases::with_motion(report, several),
    }
}

fn shown(part: &CasePart) -> Run<'_> {
    Run {
        inputs: Some(&part.plan.inputs),
        instants: &part.plan.instants,
        figures: &part.plan.figures,
        ..Run::new(part.model.scene(), &part.plan.params, &part.history)
    }
}

/// What was dispersed, and the metrics, beside those of the nominal.
fn numbers(campaign: &Campaign, row: &CaseRow) -> ReportTable {
    let manifest = campaign.manifest();
    let mut table = ReportTable::new("Dispersed numbers and metrics")
        .column("name", "")
        .column("unit", "")
        .number("here", "", 6);
    let columns = manifest.dispersed.iter().chain(&manifest.metrics);
    for (column, value) in columns.zip(row.values.iter().chain(&row.metrics)) {
        let value = match value.is_nan() {
            true => Cell::Missing,
            false => Cell::Number(*value),
        };
        table.push([
            column.name.as_str().into(),
            column.unit.as_str().into(),
            value,
        ]);
    }
    table
}
