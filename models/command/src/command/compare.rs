//! `mbd compare`: runs side by side on one page: what differs, both motions in one drawing, curves over each other and their differences.

use std::path::PathBuf;

use clap::{Args, Parser};
use mbd_report::files;
use mbd_report::{Cell, Compared, Report, ReportTable, significant};

use super::failure::CommandFailure;
use super::run::{FinishedRun, RunArgs, above, flown, unwritten};
use crate::describe::factor;
use crate::run::{Quality, metrics, shown, warning};

/// What to compare.
#[derive(Args, Debug)]
pub struct CompareArgs {
    /// Runs, each in quotes as it would be typed behind `mbd run`: "swing --tol 1e-6" "swing --tol 1e-10" "other.toml --set k=3N/m".
    #[arg(required = true, num_args = 2..=8, value_name = "RUN")]
    runs: Vec<String>,
    /// Folder for the page.
    #[arg(long, value_name = "DIR", default_value = "out/compare")]
    out: PathBuf,
}

/// A run as it is typed.
#[derive(Parser)]
#[command(name = "mbd run", no_binary_name = true)]
struct TypedRun {
    #[command(flatten)]
    run: RunArgs,
}

/// Numbers are shown with so many digits.
const DIGITS: usize = 8;

/// Runs everything and writes `compare.html`.
pub fn compare(args: &CompareArgs) -> Result<String, CommandFailure> {
    let (mut all, mut warned) = (Vec::new(), String::new());
    for text in &args.runs {
        let typed = TypedRun::try_parse_from(text.split_whitespace())
            .map_err(|error| CommandFailure::Usage(format!("in \"{text}\": {error}")))?;
        let run = flown(&typed.run)?;
        let moved = warning(&run.scene, &run.plan, &run.outcome);
        warned += &above(moved.map(|warning| format!("{}: {warning}", label(all.len()))));
        all.push((text.as_str(), run));
    }
    let table = differences(&all);
    let labels: Vec<String> = (0..all.len()).map(label).collect();
    let runs: Vec<_> = (labels.iter().zip(&all))
        .map(|(label, (_, run))| (label.as_str(), shown(&run.scene, &run.plan, &run.outcome)))
        .collect();
    let compared = Compared::new(&runs);
    let mut page = Report::new("Compared runs").table(&table);
    for (label, (_, run)) in labels.iter().zip(&all) {
        if let Some(error) = &run.outcome.error {
            page = page.paragraph(&format!("{label} stopped early: {error}"));
        }
    }
    let page = compared.with_histories(compared.with_motion(page));
    files::make_folder(&args.out).map_err(|error| unwritten(&error))?;
    let file = args.out.join("compare.html");
    page.write(&file).map_err(|error| unwritten(&error))?;
    let (table, file) = (table.text(), file.display());
    Ok(format!("{warned}{table}\nwritten to {file}\n"))
}

/// A, B, C, ….
fn label(index: usize) -> String {
    char::from_u32('A' as u32 + index as u32)
        .unwrap_or('?')
        .to_string()
}

/// What was asked and what came out, the rows in which the runs differ; the names of all runs above them.
fn differences(all: &[(&str, FinishedRun)]) -> ReportTable {
    let mut table = ReportTable::new("What differs").column("what", "");
    for index in 0..all.len() {
        table = table.number(&label(index), "", DIGITS);
    }
    let mut rows: Vec<(String, Vec<Cell>)> = vec![(
        "run".into(),
        all.iter().map(|(text, _)| Cell::from(*text)).collect(),
    )];
    let mut row = |what: &str, cell: &dyn Fn(&FinishedRun) -> Cell| {
        rows.push((what.into(), all.iter().map(|(_, run)| cell(run)).collect()));
    };
    row("scene", &|run| run.scene.name.as_str().into());
    row("method", &|run| run.plan.options.method.name().into());
    row("fixed step [s]", &|run| {
        run.plan.options.method.fixed_step().into()
    });
    row("relative tolerance", &|run| {
        let tolerance = run.plan.options.method.tolerance();
        tolerance.map(|[relative, _]| relative).into()
    });
    row("end reached [s]", &|run| run.outcome.time.into());
    row("steps", &|run| {
        Cell::Count(run.outcome.trajectory.statistics.steps)
    });
    row("rejected steps", &|run| {
        Cell::Count(run.outcome.trajectory.statistics.rejected)
    });
    row("right-hand sides", &|run| {
        Cell::Count(run.outcome.trajectory.statistics.rhs)
    });
    row("joints open by at most |Φ| [m]", &|run| {
        Quality::of(&run.outcome.trajectory).drift.into()
    });
    row("energy balance missed by at most [J]", &|run| {
        run.outcome
            .imbalance
            .map(|imbalance| imbalance.energy)
            .into()
    });
    for name in names(all, |run| {
        run.scene
            .params
            .iter()
            .map(|param| param.name.clone())
            .collect()
    }) {
        rows.push(measured(&format!("param {name}"), all, |run| {
            let mut params = run.scene.params.iter().zip(&run.plan.params);
            let (param, value) = params.find(|(param, _)| param.name == name)?;
            let unit = &param.unit;
            Some((Some(*value / factor(unit)), unit.text.clone()))
        }));
    }
    let declared = |run: &FinishedRun| {
        let metrics = run.scene.runs.metrics.iter();
        metrics.map(|metric| metric.name.clone()).collect()
    };
    for name in names(all, declared) {
        rows.push(measured(&format!("metric {name}"), all, |run| {
            let mut metrics = metrics(&run.scene, &run.outcome).into_iter();
            let metric = metrics.find(|metric| metric.name == name)?;
            Some((metric.value.ok(), metric.unit))
        }));
    }
    let columns = |run: &FinishedRun| -> Vec<String> {
        let names = run.outcome.trajectory.names().iter();
        let shown = names.filter(|name| {
            let owner = name.name.split('.').next().unwrap_or_default();
            name.name.ends_with(".tension")
                || run.scene.outputs.iter().any(|output| output.name == owner)
        });
        shown.map(|name| name.name.clone()).collect()
    };
    for name in names(all, columns) {
        rows.push(measured(&format!("last {name}"), all, |run| {
            let history = &run.outcome.trajectory;
            let column = history.names().iter().find(|column| column.name == name)?;
            let last = history.column(&name)?.last().copied();
            Some((last, column.unit.clone()))
        }));
    }
    for (index, (what, cells)) in rows.into_iter().enumerate() {
        let differs = cells.windows(2).any(|pair| pair[0] != pair[1]);
        if index == 0 || differs {
            table.push([Cell::from(what)].into_iter().chain(cells));
        }
    }
    table.note("Rows in which all runs agree to the last digit are left out.")
}

/// A row of numbers with their unit: beside the name where it is that of all runs, else beside each number.
fn measured(
    what: &str,
    all: &[(&str, FinishedRun)],
    of: impl Fn(&FinishedRun) -> Option<(Option<f64>, String)>,
) -> (String, Vec<Cell>) {
    let found: Vec<Option<(Option<f64>, String)>> = all.iter().map(|(_, run)| of(run)).collect();
    let mut units = found.iter().flatten().map(|(_, unit)| unit.as_str());
    let first = units.next().unwrap_or_default();
    let one = units.all(|unit| unit == first);
    let cell = |found: &Option<(Option<f64>, String)>| match found {
        Some((Some(value), unit)) if !one => {
            Cell::from(format!("{} {unit}", significant(*value, DIGITS)))
        }
        Some((value, _)) => (*value).into(),
        None => Cell::Missing,
    };
    let what = match first {
        unit if one && !matches!(unit, "" | "1") => format!("{what} [{unit}]"),
        _ => what.to_string(),
    };
    (what, found.iter().map(cell).collect())
}

/// Every name once, in the order in which they come.
fn names(all: &[(&str, FinishedRun)], of: impl Fn(&FinishedRun) -> Vec<String>) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for name in all.iter().flat_map(|(_, run)| of(run)) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}
