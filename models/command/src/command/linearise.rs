//! `mbd linearise`: how a scene vibrates about its start, or about where it rests.

use std::path::PathBuf;

use clap::Args;
use mbd_compiler::read_number;
use mbd_report::{ReportTable, significant};
use mbd_runtime::nalgebra::DMatrix;
use mbd_runtime::scene::{Dimension, Scene};
use mbd_runtime::{
    Content, Generic, Kink, Model, Name, RunError, Sampling, Simulation, StateSpace, StepError,
    Trajectory, TrimError, Trimmed,
};
use serde_json::json;
use toml::Value;

use super::check::pretty;
use super::failure::CommandFailure;
use super::run::{Flag, INPUT, SET, above, assign, assigned, value};
use super::scene_file::SceneFile;
use crate::run::{PlanError, RunPlan, warning_of};

/// After this part of a radian of its fastest mode a linear system is looked at again; and how much of itself it may change in a whole one.
const MOMENT: f64 = 1e-3;
const NOTED: f64 = 1e-2;
/// Steps of the motion after which that moment is given up: where the fastest mode is rounding, as at a neutral place, it lies hours ahead.
const MOST_STEPS: u32 = 2000;
/// Accelerations that change by less while a coordinate goes on, of the terms that they are made of, belong to a steady motion; and the part of the
/// largest term that is rounding.
const STEADY: f64 = 1e-6;
const ROUNDING: f64 = 1e-12;
/// Rates of growth below this part of the largest eigenvalue are rounding: a root of multiplicity two has half the digits.
const GROWS: f64 = 1e-6;

/// Where and in which coordinates.
#[derive(Args, Debug)]
pub struct LineariseArgs {
    /// A ready scene (`mbd list`) or a scene file.
    scene: PathBuf,
    /// About the rest that is found from the start, instead of about the start.
    #[arg(long)]
    trim: bool,
    /// About where the run is at this time, `60s`; with --trim the rest that is found from there [default: the start].
    #[arg(long, value_name = "TIME")]
    after: Option<String>,
    /// A coordinate that is to be one of the linear system, `crank.angle`; may be repeated [default: joint coordinates in order of declaration].
    #[arg(long = "along", value_name = "COORDINATE")]
    along: Vec<String>,
    /// Where a coordinate of the rest begins that is looked for, `boom.angle=-20deg`; may be repeated [default: the start].
    #[arg(long = "guess", value_name = "NAME=VALUE", requires = "trim")]
    guess: Vec<String>,
    /// A coordinate of the rest that stays at a value, `boom.angle=-20deg`; may be repeated.
    #[arg(long = "fix", value_name = "NAME=VALUE", requires = "trim")]
    fix: Vec<String>,
    /// A coordinate that goes on at a constant rate where all others rest, `plane.x=55m/s` of a steady flight; may be repeated.
    #[arg(long = "rate", value_name = "NAME=VALUE", requires = "trim")]
    rate: Vec<String>,
    /// An input that is looked for, `thrust`, `wind.x`; may be repeated [default: inputs stay as they are].
    #[arg(long = "free", value_name = "INPUT", requires = "trim")]
    free: Vec<String>,
    /// A param with another value, `riser_k=50kN/m`; may be repeated.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    set: Vec<String>,
    /// An input that is held at another value, `push=5N`; may be repeated.
    #[arg(long = "input", value_name = "NAME=VALUE")]
    input: Vec<String>,
    /// A, B, C, D with the names of their rows and columns, and the eigenvalues, as JSON.
    #[arg(long)]
    json: bool,
}

/// Linearises a scene and tells its coordinates and eigenvalues.
pub fn linearise(args: &LineariseArgs) -> Result<String, CommandFailure> {
    let SceneFile {
        scene,
        mut settings,
        ..
    } = SceneFile::find(&args.scene)?;
    assign(&mut settings.params, SET, &args.set)?;
    assign(&mut settings.inputs, INPUT, &args.input)?;
    settings.until = match &args.after {
        Some(_) => value(&args.after),
        // Nothing runs: a scene need not say until when.
        None => settings.until.or(Some(Value::Float(1.0))),
    };
    let invalid = |error: &dyn std::fmt::Display| {
        CommandFailure::Invalid(format!("{}: {error}", args.scene.display()))
    };
    let plan = RunPlan::new(&scene, &settings).map_err(|error| match &args.after {
        Some(_) if error.setting == "until" => {
            let setting = "--after".to_owned();
            CommandFailure::Usage(PlanError { setting, ..error }.to_string())
        }
        _ => invalid(&error),
    })?;
    let model = Generic::new(scene, &plan.params).map_err(|error| invalid(&error))?;
    let mut run = Simulation::new(&model, plan.options).map_err(|e| invalid(&e))?;
    plan.begin(&mut run).map_err(|e| invalid(&e))?;
    run.start().map_err(|e| invalid(&e))?;
    let moved = above(warning_of(&run, &plan));
    if args.json {
        eprint!("{moved}");
    }
    if args.after.is_some() {
        run.run(plan.until).map_err(|e| invalid(&e))?;
    }
    let along: Vec<&str> = args.along.iter().map(String::as_str).collect();
    let numbers = |flag, list: &[String]| -> Result<Vec<_>, CommandFailure> {
        let each = list.iter();
        each.map(|written| number(model.scene(), flag, written))
            .collect()
    };
    let guesses = numbers(GUESS, &args.guess)?;
    let fixed = numbers(FIX, &args.fix)?;
    let rates = numbers(RATE, &args.rate)?;
    if !args.trim {
        let space = run.linearise(&along).map_err(|e| invalid(&e))?;
        if args.json {
            return json_of(&space, None);
        }
        let here = row_of(&mut run).map_err(|e| invalid(&e))?;
        let note = match turning(&here, &space) {
            note if note.is_empty() => changing(&mut run, &space, &along),
            note => note,
        };
        let place = match &args.after {
            Some(time) => format!("motion after {time}"),
            None => "start".to_owned(),
        };
        return Ok(format!(
            "{moved}{}{}{note}",
            told(&space, &place),
            kinked(&space, &place)
        ));
    }
    let begun = run.trim();
    let begun = along.iter().fold(begun, |it, name| it.along(name));
    let asked = args.free.iter().fold(begun, |it, name| it.free_input(name));
    let asked = guesses
        .iter()
        .fold(asked, |it, (name, value)| it.guess(name, *value));
    let asked = fixed
        .iter()
        .fold(asked, |it, (name, value)| it.fix(name, *value));
    let asked = rates
        .iter()
        .fold(asked, |it, (name, value)| it.rate(name, *value));
    let rest = asked.solve().map_err(|error| {
        let first = match (&error, &args.after) {
            (
                TrimError::Unbalanced {
                    slack, kink: None, ..
                },
                None,
            ) if slack.is_empty() => {
                "; what a run comes to by itself is searched from there: `--after 60s`"
            }
            _ => "",
        };
        invalid(&format!("{error}{first}"))
    })?;
    let there = there(&mut run, &rest).map_err(|e| invalid(&e))?;
    if args.json {
        return json_of(&rest.space, Some((&rest, &there)));
    }
    let passing = by_time(model.scene()).or_else(|| passing(&rest, &rates));
    let place = match (rates.is_empty(), &passing) {
        (_, Some(_)) => "instant",
        (true, None) => "rest",
        (false, None) => "steady motion",
    };
    Ok(format!(
        "{moved}{}{}\n{}\n{}{}{}",
        told_rest(&rest, place),
        passing.unwrap_or_default(),
        told_there(&there),
        told(&rest.space, place),
        [
            undamped(&rest.space),
            kinked(&rest.space, place),
            growing(&rest.space, place)
        ]
        .concat(),
        turning(&there, &rest.space)
    ))
}

/// Everything that a history holds of a rest: one row of it.
fn there(run: &mut Simulation<f64>, rest: &Trimmed) -> Result<Trajectory, RunError> {
    run.set_rest(rest)?;
    row_of(run)
}

/// Everything that a history holds of a run where it stands.
fn row_of(run: &mut Simulation<f64>) -> Result<Trajectory, RunError> {
    let model = run.model().clone();
    let content = Content {
        energy: false,
        ..Content::ALL
    };
    let mut row = Trajectory::new(&*model, Sampling::Steps, content);
    run.record(run.time(), &mut row)?;
    Ok(row)
}

/// Names, units and values of the row of a rest; what its constraints are off by is no part of it.
fn columns(there: &Trajectory) -> impl Iterator<Item = (&Name, f64)> {
    let all = there.names().iter().filter_map(|name| {
        let value = there.column(&name.name)?.first().copied()?;
        Some((name, value))
    });
    all.filter(|(name, _)| name.name != "time" && !name.name.contains("_drift"))
}

const GUESS: Flag = ("--guess", "pin.angle=30deg");
const FIX: Flag = ("--fix", "pin.angle=30deg");
const RATE: Flag = ("--rate", "plane.x=55m/s");

/// A coordinate and its number, as they are written: with its unit, where it is not zero.
fn number(scene: &Scene, flag: Flag, written: &str) -> Result<(String, f64), CommandFailure> {
    let wrong = |why: String| CommandFailure::Usage(format!("{} `{written}`: {why}", flag.0));
    let (name, value) = assigned(flag, written)?;
    let (value, unit) = read_number(value).map_err(wrong)?;
    let as_rate = flag == RATE;
    let of_joint = |(joint, number, is_rate): (usize, usize, bool)| {
        let coordinate = scene.joints.get(joint)?.law.coordinate(number)?;
        Some(Dimension {
            length: if coordinate.is_angle() { 0 } else { 2 },
            time: if is_rate || as_rate { -2 } else { 0 },
            ..Dimension::default()
        })
    };
    let position = Dimension {
        length: 2,
        time: if as_rate { -2 } else { 0 },
        ..Dimension::default()
    };
    let is_position = |name: &str| {
        let (owner, axis) = name.rsplit_once('.').unwrap_or_default();
        let mut parts = scene.bodies.iter().map(|body| &body.name);
        let mut points = scene.points.iter().map(|point| &point.name);
        ["x", "y", "z"].contains(&axis)
            && (parts.any(|part| part == owner) || points.any(|point| point == owner))
    };
    let found = scene.joint_coordinate(name);
    let whole = match found {
        Some((joint, number, false)) => scene.coordinate_name(joint, number),
        _ => name.to_owned(),
    };
    let wanted = match found {
        Some(found) => of_joint(found),
        None if is_position(name) => Some(position),
        // What is neither, a turn among them, a trim refuses by name.
        None => return Ok((whole, value)),
    };
    let fits = !unit.text.is_empty() && wanted.is_none_or(|wanted| wanted == unit.dimension);
    match fits || value == 0.0 {
        true => Ok((whole, value)),
        false if as_rate => Err(wrong("give it in the unit of its rate, rad/s, deg/s or rpm of an angle, m/s of a slide or a position".into())),
        false => Err(wrong("give it in the unit of its coordinate, deg or rad of an angle, m of a slide or a position".into())),
    }
}

/// The matrices by rows, with names and units, and the eigenvalues; with the rest, if they are about one.
fn json_of(
    space: &StateSpace,
    rest: Option<(&Trimmed, &Trajectory)>,
) -> Result<String, CommandFailure> {
    let names = |list: &[Name]| -> Vec<_> {
        let each = list.iter();
        each.map(|one| json!({ "name": one.name, "unit": one.unit }))
            .collect()
    };
    let rows = |matrix: &DMatrix<f64>| -> Vec<Vec<f64>> {
        let rows = matrix.row_iter();
        rows.map(|row| row.iter().copied().collect()).collect()
    };
    let vibrations = space.vibrations();
    let eigenvalues: Vec<_> = vibrations
        .iter()
        .map(|one| {
            json!({ "real": one.real, "imaginary": one.imaginary, "hertz": one.hertz(), "damping": one.damping(),
                "shape": one.shape, "participation": one.participation })
        })
        .collect();
    let rest = rest.map(|(rest, there)| {
        let value = |(name, value): (&Name, f64)| json!({ "name": name.name, "unit": name.unit, "value": value });
        json!({
            "coordinates": rest.values().map(value).collect::<Vec<_>>(),
            "there": columns(there).map(value).collect::<Vec<_>>(),
            "undecided": rest.undecided,
        })
    });
    let kinks: Vec<_> = space
        .kinks
        .iter()
        .map(|kink| {
            let of = match kink.is_rate {
                true => format!("rate of {}", kink.of.name),
                false => kink.of.name.clone(),
            };
            json!({ "of": of, "by": kink.by.name, "sides": kink.sides })
        })
        .collect();
    pretty(&json!({
        "rest": rest, "states": names(&space.states), "inputs": names(&space.inputs), "outputs": names(&space.outputs), "undamped": space.undamped, "kinks": kinks,
        "a": rows(&space.a), "b": rows(&space.b), "c": rows(&space.c), "d": rows(&space.d),
        "accelerations": space.accelerations.as_slice(), "eigenvalues": eigenvalues,
    }))
}

/// What is said where turns are measured about axes that turn themselves: frequencies are those seen from there.
fn turning(here: &Trajectory, space: &StateSpace) -> String {
    let sizes: Vec<f64> = space
        .vibrations()
        .iter()
        .map(|one| one.frequency())
        .collect();
    let fastest = sizes.iter().copied().fold(0.0, f64::max);
    let own = sizes.into_iter().filter(|size| *size > 1e-6 * fastest);
    let slowest = own.fold(f64::INFINITY, f64::min);
    if slowest.is_infinite() {
        return String::new();
    }
    let mut notes: Vec<String> = Vec::new();
    for (owner, _) in space
        .states
        .iter()
        .filter_map(|state| state.name.split_once(".turn_"))
    {
        let rate = |axis: char| {
            let names = ["omega_body", "omega"].map(|kind| format!("{owner}.{kind}_{axis}"));
            let mut columns = names.iter().filter_map(|name| here.column(name)?.first());
            columns.next().copied().unwrap_or(0.0)
        };
        let rate = ['x', 'y', 'z']
            .map(rate)
            .iter()
            .map(|x| x * x)
            .sum::<f64>()
            .sqrt();
        let note = format!("`{owner}`, at {} rad/s", significant(rate, 4));
        if rate > 0.0 && rate > NOTED * slowest && !notes.contains(&note) {
            notes.push(note);
        }
    }
    match notes.is_empty() {
        true => String::new(),
        false => format!(
            "\nNote: turns are about axes that turn with {}. Frequencies are those seen from there, and where forces do not turn with it the linear system changes along the motion and its eigenvalues are no frequencies of the motion. With `angular_velocity: world;` turns are about axes that stay.\n",
            notes.join(" and ")
        ),
    }
}

/// What is said where the linear system is another one a moment later, as with coordinates that turn with a part that spins: its eigenvalues are no
/// frequencies of the motion.
fn changing(run: &mut Simulation<f64>, space: &StateSpace, along: &[&str]) -> String {
    let sizes = space.vibrations().into_iter().map(|one| one.frequency());
    let fastest = sizes.fold(0.0, f64::max);
    let moment = MOMENT / fastest;
    let mut left = MOST_STEPS;
    let mut within = |_: f64| {
        left = left.saturating_sub(1);
        left > 0
    };
    let flown = run.run_while(run.time() + moment, None, &mut within);
    if flown
        .as_ref()
        .is_err_and(|error| error.cause == StepError::Cancelled)
    {
        return format!(
            "\nNote: whether this linear system stays along the motion is not known: its fastest mode takes {} s to turn by a radian, and the motion is faster by far. Its eigenvalues hold at this instant; a rest (`--trim`) has one that stays.\n",
            significant(1.0 / fastest, 3)
        );
    }
    let later = flown.ok().and_then(|_| run.linearise(along).ok());
    let Some(later) = later.filter(|later| later.a.shape() == space.a.shape()) else {
        return String::new();
    };
    // Places as they are, rates over the fastest frequency: systems alike but for their speed change alike.
    let rates = space.states.len() - space.accelerations.len();
    let scaled = |a: &DMatrix<f64>| {
        let unit = |index: usize| if index < rates { 1.0 } else { fastest };
        a.map_with_location(|row, column, x| x * unit(column) / unit(row))
            .norm()
    };
    let change = scaled(&(&later.a - &space.a)) / (MOMENT * scaled(&space.a));
    match change > NOTED {
        true => format!(
            "\nNote: along the motion this linear system changes, by {:.2} of itself while its fastest mode turns by a radian: its eigenvalues hold at this instant and are no frequencies of the motion. Coordinates that do not turn with a part that spins (`--along`), or a rest (`--trim`), may give one that stays.\n",
            change
        ),
        false => String::new(),
    }
}

/// Everything there.
fn told_there(there: &Trajectory) -> String {
    let mut table = ReportTable::new("There")
        .column("column", "")
        .column("unit", "")
        .column("value", "");
    for (name, value) in columns(there) {
        table.push([
            name.name.as_str().into(),
            name.unit.as_str().into(),
            value.into(),
        ]);
    }
    table.text()
}

/// Where the rest is.
fn told_rest(rest: &Trimmed, place: &str) -> String {
    let title = match place {
        "rest" => "Rest",
        "instant" => "Balance at this instant",
        _ => "Steady motion",
    };
    let mut table = ReportTable::new(title)
        .column("coordinate", "")
        .column("unit", "")
        .column("value", "");
    for (name, value) in rest.values() {
        let (name, unit) = (name.name.as_str(), name.unit.as_str());
        table.push([name.into(), unit.into(), value.into()]);
    }
    let undecided = rest.undecided.join("`, `");
    match undecided.is_empty() {
        true => table.text(),
        false => format!(
            "{}\nNothing decides `{undecided}`: what stayed where it began.\n",
            table.text()
        ),
    }
}

/// Says which damping is not in the linear system of a rest.
fn undamped(space: &StateSpace) -> String {
    match space.undamped.as_slice() {
        [] => String::new(),
        nodes => format!(
            "\nnote: the damping of {} is none of this linear system: differences from step to step (`equilibrium: stepwise`) have none, declare `equilibrium: rate`, or give the point a mass; nor has a spring where both its ends are at the same place.\n",
            nodes
                .iter()
                .map(|node| format!("`{node}`"))
                .collect::<Vec<_>>()
                .join(", ")
        ),
    }
}

/// Says what has another linear system on the other side of the place.
fn kinked(space: &StateSpace, place: &str) -> String {
    let told = |kink: &Kink| {
        let [one, other] = kink.sides.map(|side| significant(side, 4));
        let (of, by) = (&kink.of, &kink.by);
        let rate = if kink.is_rate { "the rate of " } else { "" };
        format!(
            "{rate}`{}` [{}] changes by {one} per {} of `{}` on one side and by {other} on the other",
            of.name, of.unit, by.unit, by.name
        )
    };
    match space.kinks.as_slice() {
        [] => String::new(),
        [first, rest @ ..] => format!(
            "\nnote: the {place} is at a kink, and this linear system holds on one side of it: {}{}. Linearise beside it, on the side that is meant.\n",
            told(first),
            match rest.len() {
                0 => String::new(),
                more => format!(" (and {more} more such derivatives)"),
            }
        ),
    }
}

/// A note where something that acts, or drives, changes with time by itself: what is in balance at one instant is not at the next.
fn by_time(scene: &Scene) -> Option<String> {
    let changing = scene.changing_with_time();
    let names = match changing.as_slice() {
        [] => return None,
        [one] => format!("`{one}` changes"),
        [first, .., last] => format!("`{first}` … `{last}` change"),
    };
    Some(format!(
        "\nNote: this balance holds at this instant alone: {names} with time. It is no rest; where it leads is told by a run.\n"
    ))
}

/// A note where a motion at constant rates is in balance at this instant alone: as coordinates go on at their rates, accelerations change.
fn passing(rest: &Trimmed, rates: &[(String, f64)]) -> Option<String> {
    let space = &rest.space;
    let first = space.states.len() - space.accelerations.len();
    let names = || space.states.iter().take(first).enumerate();
    let values: Vec<f64> = names()
        .map(|(_, state)| rest.value(&state.name).map_or(0.0, f64::abs))
        .collect();
    let going: Vec<(usize, f64)> = names()
        .filter_map(|(index, state)| {
            let (_, rate) = rates.iter().find(|(name, _)| *name == state.name)?;
            Some((index, *rate))
        })
        .collect();
    let fastest = going
        .iter()
        .fold(0.0_f64, |most, (_, rate)| most.max(rate.abs()));
    let (row, _) = (first..space.states.len())
        .map(|row| {
            let change: f64 = going
                .iter()
                .map(|(at, rate)| space.a[(row, *at)] * rate)
                .sum();
            (row, change / fastest)
        })
        .find(|&(row, change)| {
            let terms = values.iter().enumerate();
            let size: f64 = terms
                .map(|(at, value)| (space.a[(row, at)] * value).abs())
                .sum();
            change.abs() > STEADY * size && change.abs() > ROUNDING * space.a.amax()
        })?;
    let goes: Vec<String> = rates.iter().map(|(name, _)| format!("`{name}`")).collect();
    Some(format!(
        "\nNote: this balance holds at this instant alone: as {} goes on, `{}` begins to change. It is no steady motion; where it leads is told by a run.\n",
        goes.join(", "),
        space.states[row].name
    ))
}

/// A note where the motion leaves a rest by itself.
fn growing(space: &StateSpace, place: &str) -> String {
    let all = space.vibrations();
    let fastest = all.iter().map(|one| one.frequency()).fold(0.0, f64::max);
    let rate = all.iter().map(|one| one.real).fold(0.0, f64::max);
    match rate > GROWS * fastest {
        true => format!(
            "\nnote: this {place} is unstable: what leaves it grows by a factor of e in {} s. Another one is found from another `--guess`, or `--after` a run that comes to it.\n",
            significant(1.0 / rate, 3)
        ),
        false => String::new(),
    }
}

/// The tables.
fn told(space: &StateSpace, place: &str) -> String {
    let count = space.states.len();
    if count == 0 {
        return format!(
            "Linear system about the {place}: nothing moves there, joints, locks and motors hold every coordinate\n"
        );
    }
    let mut states = ReportTable::new(format!("Linear system about the {place}"))
        .column("state", "")
        .column("unit", "")
        .column("acceleration", "");
    // Coordinates, then their rates, then what stands behind the speeds.
    let coordinates = count - space.accelerations.len();
    for (index, name) in space.states.iter().enumerate() {
        let own = index.checked_sub(coordinates);
        let own = own.and_then(|index| space.accelerations.get(index).copied());
        states.push([
            name.name.as_str().into(),
            name.unit.as_str().into(),
            own.into(),
        ]);
    }
    let mut vibrations = ReportTable::new("Eigenvalues")
        .column("frequency", "Hz")
        .column("|λ|", "rad/s")
        .column("damping", "")
        .column("Re λ", "1/s")
        .column("Im λ", "rad/s")
        .column("moves most", "");
    for one in space.vibrations() {
        let share = |index: usize| one.participation.get(index).copied().unwrap_or(0.0);
        // A coordinate takes part with its rate, which stands behind all coordinates.
        let shares = (0..count).filter_map(|index| match index {
            index if index < coordinates => {
                Some((index, share(index) + share(coordinates + index)))
            }
            index if index < 2 * coordinates => None,
            index => Some((index, share(index))),
        });
        let most = shares.max_by(|(_, a), (_, b)| a.total_cmp(b));
        let most = most.and_then(|(index, _)| space.states.get(index));
        vibrations.push([
            one.hertz().into(),
            one.frequency().into(),
            one.damping().into(),
            one.real.into(),
            one.imaginary.into(),
            most.map(|name| name.name.as_str()).into(),
        ]);
    }
    format!("{}\n{}", states.text(), vibrations.text())
}
