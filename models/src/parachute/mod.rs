//! The main job: test cases 2 and 3 of AAS 03-163 (B. Raiszadeh, 2003), with every model of the confluence.

pub mod comparison;
pub mod figures;
pub mod motion;
pub mod prepare;
pub mod scene;
pub mod stability;
pub mod study;
pub mod summary;
pub mod variant;

use std::io;
use std::path::Path;

use crate::files;
use crate::report::{Cell, Report, ReportTable};
use study::Study;
use summary::ParachuteSummary;

/// Writes report, figures, histories and summary of a study into a folder.
///
/// # Errors
/// Those of the file system, with the name of the file. Every file is whole, and the summary is only there if all others are.
pub fn write(study: &Study, folder: &Path) -> io::Result<ParachuteSummary> {
    files::make_folder(folder)?;
    // The summary is written last: where it is, everything is.
    let place = folder.join("summary.json");
    files::remove(&place)?;
    let summary = ParachuteSummary::of(study);
    for run in &study.runs {
        let name = format!("case{}_{}.csv", run.case.number(), run.confluence.slug());
        files::write_whole(&folder.join(name), |to| run.flight.history.to_csv(to))?;
    }
    let figures = figures::figures(study);
    for named in &figures {
        let file = folder.join(format!("{}.svg", named.name));
        files::write_text(&file, &named.figure.svg())?;
    }
    let report = Report::new("A capsule under a parachute: the confluence as a point with mass and as an equilibrium point")
        .section("What was run")
        .paragraph(
            "Two rigid bodies, a canopy of 16 kg and a capsule of 761 kg, joined by a riser and three bridle legs that meet at one point, fall \
             on Mars. Earlier simulations gave that point a small mass; it then needs tiny steps and vibrates at frequencies no real line has. \
             B. Raiszadeh (AAS 03-163, 2003) replaced it by the point where the line forces balance. Both are flown here with RK4 at fixed steps, from \
             one declaration each, and measured against tight reference runs of the same model.",
        )
;
    let report = motion::motion(&study.moving).on(report);
    let mut report = report
        .section("What came out")
        .table(&summary::table(study))
        .table(&summary::ratios(study))
        .paragraph(&format!(
            "Steady riser force over the weight of the capsule: {:.6}. A point with mass adds its own weight.",
            summary.steady_over_weight
        ))
        .section("Figures");
    for named in &figures {
        report = report.figure(&named.figure);
    }
    let report = report
        .section("Where the numbers come from")
        .paragraph("The copy of the paper this work started from lost most digits of its tables; missing numbers are assumed and marked.")
        .table(&provenance())
        .section("Make it again")
        .command("cargo run --release");
    report.write(folder.join("report.html"))?;
    files::write_text(&place, &(serde_json::to_string_pretty(&summary)? + "\n"))?;
    Ok(summary)
}

fn provenance() -> ReportTable {
    let mut table = ReportTable::new("Numbers of the scene")
        .column("quantity", "")
        .column("value", "")
        .column("source", "");
    for row in scene::PROVENANCE {
        table.push(row.map(Cell::from));
    }
    table
}
