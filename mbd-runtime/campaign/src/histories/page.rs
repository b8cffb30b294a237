//! The page of a case: what it was, how it ended, its run.

use mbd_report::{Cell, Report, ReportTable, Run, with_run};
use mbd_runtime::Trajectory;

use super::choice::Chosen;
use crate::campaign::Campaign;
use crate::results::CaseRow;
use crate::run::PlanError;

/// The page of a case with its row and its history.
pub fn page(
    campaign: &Campaign,
    (row, history): (&CaseRow, &Trajectory),
    chosen: &Chosen,
    replay: &str,
) -> Result<Report, PlanError> {
    let (model, plan) = campaign.flown(row.case)?;
    let scene = model.scene();
    let shown = Run {
        inputs: Some(&plan.inputs),
        instants: &plan.instants,
        figures: &plan.figures,
        ..Run::new(scene, &plan.params, history)
    };
    let end = match row.status.as_str() {
        "ok" => format!("It reached its end at {} s.", row.time),
        status => format!(
            "It did not reach its end ({status}); the history goes up to its last accepted step at {} s: {}",
            row.time, row.why
        ),
    };
    let report = Report::new(format!("Case {} of a campaign of {}", row.case, scene.name))
        .link("All cases", "../report.html")
        .paragraph(&format!("{end} Chosen as {}.", chosen.why.join("; ")))
        .table(&numbers(campaign, row))
        .paragraph("It is repeated, to the bit, by")
        .command(&format!("{replay} --case {}", row.case));
    Ok(with_run(report, (&*model, &plan.options), &shown))
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
