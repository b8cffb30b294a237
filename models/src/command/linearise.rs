//! `mbd linearise`: how a scene vibrates about its start, or about where it rests.

use std::path::PathBuf;

use clap::Args;
use mbd_compiler::read_number;
use mbd_runtime::{Generic, Simulation, StateSpace, Trimmed, linearise_along, trim};
use models::report::ReportTable;
use models::run::RunPlan;

use super::failure::CommandFailure;
use super::scene_file::SceneFile;

/// Where and in which coordinates.
#[derive(Args, Debug)]
pub struct LineariseArgs {
    /// A ready scene (`mbd list`) or a scene file.
    scene: PathBuf,
    /// About the rest that is found from the start, instead of about the start.
    #[arg(long)]
    trim: bool,
    /// A coordinate that is to be one of the linear system, `crank.angle`; may be repeated [default: joint coordinates in order of declaration].
    #[arg(long = "along", value_name = "COORDINATE")]
    along: Vec<String>,
    /// Where a coordinate of the rest begins that is looked for, `boom.angle=-20deg`; may be repeated [default: the start].
    #[arg(long = "guess", value_name = "NAME=VALUE", requires = "trim")]
    guess: Vec<String>,
    /// A param with another value, `riser_k=50kN/m`; may be repeated.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    set: Vec<String>,
}

/// Linearises a scene and tells its coordinates and eigenvalues.
pub fn linearise(args: &LineariseArgs) -> Result<String, CommandFailure> {
    let SceneFile {
        scene, settings, ..
    } = SceneFile::find(&args.scene)?;
    let invalid = |error: &dyn std::fmt::Display| {
        CommandFailure::Invalid(format!("{}: {error}", args.scene.display()))
    };
    let plan = RunPlan::new(&scene, &settings).map_err(|error| invalid(&error))?;
    let model = Generic::new(scene, &plan.params).map_err(|error| invalid(&error))?;
    let mut run = Simulation::new(&model, plan.options).map_err(|e| invalid(&e))?;
    plan.begin(&mut run).map_err(|e| invalid(&e))?;
    run.start().map_err(|e| invalid(&e))?;
    let along: Vec<&str> = args.along.iter().map(String::as_str).collect();
    let guesses = args.guess.iter().map(|guess| number(guess));
    let guesses = guesses.collect::<Result<Vec<_>, _>>()?;
    let rest = args.trim.then(|| {
        let begun = trim(&model)
            .state(run.state())
            .all_inputs(&plan.inputs)
            .nodes(run.nodes());
        let guessed = guesses.iter().fold(begun, |it, (name, value)| it.guess(name, *value));
        guessed.solve()
    });
    let rest = rest.transpose().map_err(|e| invalid(&e))?;
    let state = rest.as_ref().map_or(run.state(), |rest| &rest.state);
    let space = linearise_along(&model, 0.0, state, &plan.inputs, &along);
    let space = space.map_err(|error| invalid(&error))?;
    Ok(match &rest {
        Some(rest) => format!("{}\n{}", told_rest(rest), told(&space, "rest")),
        None => told(&space, "start"),
    })
}

/// A coordinate and its number, as they are written.
fn number(written: &str) -> Result<(String, f64), CommandFailure> {
    let wrong = |why: &str| {
        let form = "write it as NAME=VALUE, such as pin.angle=30deg";
        CommandFailure::Invalid(format!("--guess `{written}`{why}: {form}"))
    };
    let Some((name, value)) = written.split_once('=') else {
        return Err(wrong(""));
    };
    let (value, _) = read_number(value.trim()).map_err(|error| wrong(&format!(" ({error})")))?;
    Ok((name.trim().to_owned(), value))
}

/// Where the rest is.
fn told_rest(rest: &Trimmed) -> String {
    let mut table = ReportTable::new("Rest")
        .column("coordinate", "")
        .column("unit", "")
        .column("value", "")
        .column("", "");
    for (name, value) in rest.values() {
        let undecided = rest.undecided.contains(&name.name);
        table.push([
            name.name.as_str().into(),
            name.unit.as_str().into(),
            value.into(),
            undecided.then_some("undecided: it stayed where it began").into(),
        ]);
    }
    table.text()
}

/// The tables.
fn told(space: &StateSpace, place: &str) -> String {
    let count = space.states.len();
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
        let size = |share: &[f64; 2]| share[0].hypot(share[1]);
        let shares = one.shape.iter().take(coordinates).enumerate();
        let most = shares.max_by(|(_, a), (_, b)| size(a).total_cmp(&size(b)));
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
