//! The trade between speed and accuracy of a scene: methods and tolerances, other models of its equilibrium points and the other family of
//! coordinates, raced over one question.

use std::io;
use std::path::Path;

use mbd_compiler::Interpreted;
use mbd_report::files::{make_folder, write_text};
use mbd_report::{Cell, Figure, Report, ReportTable, Run, Series, Views};
use mbd_runtime::scene::{Clamp, Coordinates, Difference, NodeModel, PointKind, Scene, plain};
use mbd_runtime::{
    Content, Entry, FailedSetting, Generic, ParamError, Question, Race, Sampling, TradeError,
    Trajectory, Variant, trade,
};

use crate::run::{PlanError, RunPlan, Settings};

/// Something to race: a scene with its plan.
struct SceneContender {
    name: &'static str,
    model: Interpreted<f64>,
    plan: RunPlan,
}

/// Why a scene could not be raced.
#[derive(Debug)]
pub enum RaceFailure {
    /// A setting that cannot be used.
    Plan(PlanError),
    /// Params outside their declaration.
    Params(ParamError),
    /// No trade was measured.
    Trade(TradeError),
}

impl std::fmt::Display for RaceFailure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            RaceFailure::Plan(error) => error.fmt(f),
            RaceFailure::Params(error) => error.fmt(f),
            RaceFailure::Trade(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for RaceFailure {}

/// The names of variants in the other family of coordinates.
const FAMILIES: [&str; 2] = ["relative coordinates", "absolute coordinates"];
/// So many times what the scene as declared is off, and this part of the column, are no error of the steps of a family.
const OTHER_MOTION: f64 = 1e3;
const SAME_MOTION: f64 = 1e-5;

/// Races a scene as declared, with every other model of its equilibrium points, in the other family of coordinates, and in single precision, all
/// interpreted. The window is the whole
/// run where none is given.
///
/// # Errors
/// Settings or params that cannot be used, or what [`trade`] says.
pub fn race(
    scene: &Scene,
    settings: &Settings,
    column: &str,
    window: Option<[f64; 2]>,
) -> Result<Race, RaceFailure> {
    let contenders = contenders(scene, settings)?;
    let until = contenders.first().map_or(0.0, |first| first.plan.until);
    let question = Question::new(column, window.unwrap_or([0.0, until]));
    let mut variants: Vec<Variant<'_>> = Vec::new();
    for one in &contenders {
        // What is advised is what `mbd run` does with it.
        let variant = Variant::new(one.name, &one.model, |run| one.plan.begin(run));
        variants.push(variant.with(one.plan.options));
    }
    // The numbers of params that f32 cannot hold are refused there; the scene is raced without it then.
    let single = contenders.first().and_then(|first| {
        let params: Vec<f32> = first.plan.params.iter().map(|x| *x as f32).collect();
        let model = Interpreted::<f32>::shared(scene.clone(), &params).ok()?;
        Some((model, &first.plan))
    });
    if let Some((model, plan)) = &single {
        let variant = Variant::new("single precision", &**model, |run| plan.begin(run));
        variants.push(variant.with(plan.options));
    }
    trade(&variants, &question).map_err(RaceFailure::Trade)
}

/// The scene as declared, then with each other model of its equilibrium points, where it has some and can be run so, and in the other family of
/// coordinates, where joints make a difference.
fn contenders(scene: &Scene, settings: &Settings) -> Result<Vec<SceneContender>, RaceFailure> {
    let of = |name, scene: Scene| -> Result<SceneContender, RaceFailure> {
        let plan = RunPlan::new(&scene, settings).map_err(RaceFailure::Plan)?;
        let model = Interpreted::new(scene, &plan.params).map_err(RaceFailure::Params)?;
        Ok(SceneContender { name, model, plan })
    };
    let mut all = vec![of("as declared", scene.clone())?];
    let stepwise = NodeModel::Stepwise {
        formula: Difference::default(),
        clamp: Clamp::default(),
    };
    for (name, model) in [
        ("node: rate", NodeModel::Rate),
        ("node: static", NodeModel::Static),
        ("node: stepwise", stepwise),
    ] {
        let mut other = scene.clone();
        for point in &mut other.points {
            if let PointKind::Node(declared) = &mut point.kind {
                *declared = model;
            }
        }
        if other != *scene {
            all.extend(of(name, other).ok());
        }
    }
    let [relative, absolute] = FAMILIES;
    let (name, other) = match scene.coordinates {
        Coordinates::Absolute => (relative, Coordinates::Relative),
        Coordinates::Relative => (absolute, Coordinates::Absolute),
    };
    if !scene.joints.is_empty() {
        all.extend(of(name, scene.in_coordinates(other)).ok());
    }
    Ok(all)
}

/// The unit of a column of the histories of a scene; empty for a pure number.
///
/// # Errors
/// There is no such column, or params are outside their declaration.
pub fn unit(scene: &Scene, column: &str) -> Result<String, RaceFailure> {
    let model = Generic::<f64>::with_defaults(scene.clone()).map_err(RaceFailure::Params)?;
    let history = Trajectory::new(&model, Sampling::Steps, Content::ALL);
    let found = history.names().iter().find(|name| name.name == column);
    found.map(|name| name.unit.clone()).ok_or_else(|| {
        let known = history.names().iter().map(|name| name.name.clone());
        RaceFailure::Trade(TradeError::Column(column.to_owned(), known.collect()))
    })
}

/// Every setting that gave an answer, with its error and what it cost; errors are in the unit of the column.
#[must_use]
pub fn table(race: &Race, unit: &str) -> ReportTable {
    let column = &race.question.column;
    let mut table = ReportTable::new(format!("What `{column}` costs"))
        .column("variant", "")
        .column("method", "")
        .column("steps", "")
        .column("evaluations", "")
        .column("Jacobians", "")
        .number("error, rms", unit, 2)
        .number("error, most", unit, 2)
        .number("time", "s", 2);
    for entry in &race.entries {
        table.push([
            entry.name.as_str().into(),
            entry.method.to_string().into(),
            Cell::Count(entry.statistics.steps),
            Cell::Count(entry.statistics.rhs),
            Cell::Count(entry.statistics.jacobians),
            entry.error.rms.into(),
            entry.error.largest.into(),
            entry.seconds.into(),
        ]);
    }
    let [first, second] = race.references;
    table = table.note(format!(
        "The references, {first} and {second} as declared, are {} apart (rms): errors below that mean nothing. Times are of interpreted equations.",
        plain(race.apart.rms, 2)
    ));
    if let Some((name, best)) = other_motion(race) {
        table = table.note(format!(
            "The {name} come to another motion than the scene as declared: {} apart (rms) at their best. Both families describe one motion, so that one of them is wrong, or the start leaves the motion open: trust neither before that is found, and report it.",
            plain(best, 2)
        ));
    }
    // What stopped a method is told once, of its finest setting that stopped.
    for (index, failed) in race.failed.iter().enumerate() {
        let of = |failed: &FailedSetting| (failed.name.clone(), failed.method.name());
        let next = race.failed.get(index + 1);
        if next.is_none_or(|next| of(next) != of(failed)) {
            let text = format!("{}, {}: {}", failed.name, failed.method, failed.cause);
            table = table.note(text);
        }
    }
    table
}

/// The other family of coordinates, where its best setting is further off than anything explains that the settings of the scene as declared show.
fn other_motion(race: &Race) -> Option<(&str, f64)> {
    let best = |of: &dyn Fn(&Entry) -> bool| {
        let own = race.entries.iter().filter(|entry| of(entry));
        own.map(|entry| entry.error.rms)
            .fold(f64::INFINITY, f64::min)
    };
    let is_family = |entry: &Entry| FAMILIES.contains(&entry.name.as_str());
    let name = race.entries.iter().find(|entry| is_family(entry))?;
    let (other, own) = (best(&is_family), best(&|entry| entry.variant == 0));
    let size = race
        .reference
        .iter()
        .fold(0.0_f64, |most, x| most.max(x.abs()));
    let explained = (OTHER_MOTION * own.max(race.apart.rms)).max(SAME_MOTION * size);
    (other > explained).then_some((name.name.as_str(), other))
}

/// Error against time: one curve a method as declared, and the best of every other variant.
fn figure<'a>(race: &Race, unit: &str, curves: &'a [(String, Vec<f64>, Vec<f64>)]) -> Figure<'a> {
    let [from, to] = race.question.window;
    let mut figure = Figure::new(format!("What accuracy of {} costs", race.question.column))
        .x("time of the run", "s")
        .y("error, rms", unit)
        .log_x()
        .log_y()
        .caption(format!(
            "Root mean square over {from} s to {to} s, against references that are {} apart. Lower left is better.",
            plain(race.apart.rms, 2)
        ));
    for (name, seconds, errors) in curves {
        figure = figure.series(Series::new(name.clone(), seconds, errors));
    }
    figure
}

fn curves(race: &Race) -> Vec<(String, Vec<f64>, Vec<f64>)> {
    let mut curves: Vec<(String, Vec<f64>, Vec<f64>)> = Vec::new();
    let declared = race.entries.iter().filter(|entry| entry.variant == 0);
    let last = race.entries.iter().map(|entry| entry.variant).max();
    let others = (1..=last.unwrap_or(0)).flat_map(|variant| race.front(Some(variant)));
    for entry in declared.chain(others) {
        let name = match entry.variant {
            0 => format!("{}, {}", entry.name, entry.method.name()),
            _ => format!("{}, the best", entry.name),
        };
        if curves.last().is_none_or(|(last, ..)| *last != name) {
            curves.push((name, Vec::new(), Vec::new()));
        }
        if let Some((_, seconds, errors)) = curves.last_mut() {
            seconds.push(entry.seconds);
            errors.push(entry.error.rms);
        }
    }
    curves
}

/// One sentence: the cheapest setting that meets a wanted error, and the modelling switch that pays most; or why there is none.
#[must_use]
pub fn advice(race: &Race, unit: &str, wanted: f64) -> String {
    let gap = if unit.is_empty() { "" } else { " " };
    let error = wanted;
    let wanted = plain(error, 2);
    match race.advise(error) {
        Some(advice) => format!(
            "for {} within {wanted}{gap}{unit}: {advice}",
            race.question.column
        ),
        None if race.apart.rms > 0.1 * error => format!(
            "no advice for {} within {wanted}{gap}{unit}: the references are {}{gap}{unit} apart, and must agree ten times better than what is wanted",
            race.question.column,
            plain(race.apart.rms, 2)
        ),
        None => format!(
            "no setting that was raced has {} within {wanted}{gap}{unit}",
            race.question.column
        ),
    }
}

/// A thousandth of the size of what was asked.
#[must_use]
pub fn usual(race: &Race) -> f64 {
    1e-3 * race
        .reference
        .iter()
        .fold(0.0_f64, |most, x| most.max(x.abs()))
}

/// Writes `trade.csv`, `trade.svg` and `trade.html` into a folder; the page shows a run as it moves.
///
/// # Errors
/// The folder or a file cannot be written.
pub fn publish(
    race: &Race,
    (advice, unit): (&str, &str),
    shown: &Run<'_>,
    folder: &Path,
) -> io::Result<()> {
    make_folder(folder)?;
    let table = table(race, unit);
    write_text(&folder.join("trade.csv"), &table.csv())?;
    let curves = curves(race);
    let figure = figure(race, unit, &curves);
    write_text(&folder.join("trade.svg"), &figure.svg())?;
    let report = Report::new(format!("Speed and accuracy of {}", race.question.column))
        .paragraph(advice)
        .figure(&figure)
        .table(&table);
    let report = Views::new(shown).with_motion(report);
    write_text(&folder.join("trade.html"), &report.html())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_family_that_comes_to_another_motion_is_told() {
        let text = "model Swing { gravity: [0, 0, -9.81] m/s^2;
            body a { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0, 0, 0.5] m }
            joint p: hinge from world to a.top { axis: y, start: 0.5 rad }
            output bend = p.angle; }";
        let scene = mbd_compiler::read_text(text).scene.expect("a pendulum");
        let settings = Settings::read("[run]\nuntil = 1\n").expect("settings");
        let mut race = race(&scene, &settings, "bend", None).expect("a race");
        let told = |race: &Race| table(race, "rad").text();
        assert!(!told(&race).contains("another motion"));
        for entry in &mut race.entries {
            if entry.name == "relative coordinates" {
                entry.error.rms = 0.01;
            }
        }
        assert!(told(&race).contains("The relative coordinates come to another motion"));
    }
}
