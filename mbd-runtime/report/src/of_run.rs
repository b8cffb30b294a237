//! The page of a run of a user's own model, in one call.

use mbd_runtime::scene::{Float, fingerprint};
use mbd_runtime::{Model, Options, Trajectory};

use super::html::Report;
use super::metrics::metrics_table;
use super::table::{Cell, ReportTable};
use super::views::{Run, Views};

/// The page of a run: the mechanism as it moves, the histories, and what made them: model, hash of its declaration, params, options.
///
/// What the history does not hold is not shown, and the page says so: record it with `Content::ALL`.
///
/// ```
/// use mbd_report::report;
/// use mbd_runtime::{Content, Options, Sampling, Simulation, Trajectory, model};
///
/// model! {
///     /// A stone that is thrown.
///     model Throw {
///         gravity: [0.0, 0.0, -10.0] m/s^2;
///         point stone { mass: 1.0 kg, start at [0.0, 0.0, 2.0] m velocity [3.0, 0.0, 10.0] m/s }
///         output height = stone.position.z;
///     }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let (throw, options) = (Throw::new(ThrowParams::default())?, Options::tsit5(1e-8));
/// let mut history = Trajectory::new(&throw, Sampling::Every(0.02), Content::ALL);
/// Simulation::new(&throw, options)?.record(2.0, &mut history)?;
/// let page = report(&throw, &options, &history);
/// assert!(page.html().contains("Throw"));
/// # let folder = std::env::temp_dir().join(format!("mbd_report_{}", std::process::id()));
/// page.write(&folder)?; // report.html in this folder
/// # assert!(folder.join("report.html").is_file());
/// # std::fs::remove_dir_all(folder)?;
/// # Ok(())
/// # }
/// ```
#[must_use]
pub fn report<T: Float>(
    model: &(impl Model<T> + ?Sized),
    options: &Options,
    history: &Trajectory,
) -> Report {
    let scene = model.scene();
    let params: Vec<f64> = model.params().iter().map(|param| param.to_f64()).collect();
    let mut page = Report::new(&scene.name);
    if !scene.doc.trim().is_empty() {
        page = page.paragraph(scene.doc.trim());
    }
    with_run(page, (model, options), &Run::new(scene, &params, history))
}

/// Adds what [`report`] shows of a run to a page of your own: the run as it moves, its plots, how it was run, its metrics, its params.
#[must_use]
pub fn with_run<T: Float>(
    page: Report,
    (model, options): (&(impl Model<T> + ?Sized), &Options),
    shown: &Run<'_>,
) -> Report {
    let views = Views::new(shown);
    let page = views.with_histories(views.with_motion(page));
    let table = run(model, options, shown.trajectory);
    let page = page.section("The run").table(&table);
    let page = match metrics_table(&shown.trajectory.metrics(model.scene())) {
        table if table.is_empty() => page,
        table => page.table(&table.note(covered(shown.trajectory))),
    };
    match params_of(model) {
        table if table.is_empty() => page,
        table => page.table(&table),
    }
}

/// What the metrics of a history are of: whether the run was to go on is not known here.
fn covered(history: &Trajectory) -> String {
    match history.times() {
        [first, .., last] => format!("Of the rows that the history holds, {first} s to {last} s."),
        [one] => format!("Of the one row that the history holds, at {one} s."),
        [] => "The history holds no row.".to_string(),
    }
}

fn run<T: Float>(
    model: &(impl Model<T> + ?Sized),
    options: &Options,
    history: &Trajectory,
) -> ReportTable {
    let statistics = history.statistics;
    let hash = fingerprint(format!("{:?}", model.scene()).into_bytes());
    let times = history.times();
    let method = options.method.name();
    let step = match (options.method.fixed_step(), options.method.tolerance()) {
        (Some(step), _) => format!("{method}, fixed step {step} s"),
        (None, Some([rtol, _])) => format!("{method}, relative tolerance {rtol:e}"),
        (None, None) => method.to_string(),
    };
    let located = if options.locate {
        "located"
    } else {
        "not located"
    };
    let rows: [(&str, Cell); 11] = [
        ("model", model.scene().name.as_str().into()),
        ("hash of its declaration", format!("{hash:016x}").into()),
        ("numbers", format!("{} bits", 8 * size_of::<T>()).into()),
        ("method", step.into()),
        ("slack/taut switches and events", located.into()),
        ("first row [s]", times.first().copied().into()),
        ("last row [s]", times.last().copied().into()),
        ("rows", times.len().into()),
        ("steps", Cell::Count(statistics.steps)),
        ("rejected steps", Cell::Count(statistics.rejected)),
        ("right-hand sides", Cell::Count(statistics.rhs)),
    ];
    let mut table = ReportTable::new("Run")
        .column("what", "")
        .column("value", "");
    for (what, value) in rows {
        table.push([what.into(), value]);
    }
    table
}

/// The params the model has, in SI.
fn params_of<T: Float>(model: &(impl Model<T> + ?Sized)) -> ReportTable {
    let mut table = ReportTable::new("Params, in SI units")
        .column("name", "")
        .number("value", "", 6)
        .column("what", "");
    for (param, value) in model.scene().params.iter().zip(model.params()) {
        let what = param.doc.trim();
        table.push([
            param.name.as_str().into(),
            value.to_f64().into(),
            what.into(),
        ]);
    }
    table
}
