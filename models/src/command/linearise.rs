//! `mbd linearise`: how a scene vibrates about its start, or about where it rests.

use std::path::PathBuf;

use clap::Args;
use mbd_runtime::{Generic, Simulation, StateSpace, linearise_along, trim};
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
    let (state, place) = match args.trim {
        true => {
            let found = trim(&model)
                .state(run.state())
                .all_inputs(&plan.inputs)
                .nodes(run.nodes())
                .solve();
            (found.map_err(|e| invalid(&e))?.state, "rest")
        }
        false => (run.state().to_vec(), "start"),
    };
    let space = linearise_along(&model, 0.0, &state, &plan.inputs, &along);
    let space = space.map_err(|error| invalid(&error))?;
    Ok(told(&space, place))
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
