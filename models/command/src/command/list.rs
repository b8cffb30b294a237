//! `mbd list`: the scenes that come along, and what a scene can be asked.

use clap::{Args, Subcommand};
use mbd_compiler::nearest;
use mbd_report::ReportTable;
use mbd_runtime::scene::Scene;
use models::scenes;
use serde_json::{Value, json};

use super::SceneArgs;
use super::check::pretty;
use super::failure::CommandFailure;
use super::scene_file::SceneFile;
use crate::{describe, quantities};

/// A ready scene that is a file: the two forms a scene file can have.
#[derive(Clone, Copy, Debug)]
pub struct ReadyFile {
    /// Its name for `mbd run`.
    pub name: &'static str,
    /// What it is.
    pub what: &'static str,
    /// The scene file.
    pub text: &'static str,
    /// Whether it is TOML, or the text of a declaration.
    pub is_toml: bool,
}

/// The ready scenes that are files; they lie in `models/scenes`.
const WRITTEN: &[ReadyFile] = &[
    ReadyFile {
        name: "drop",
        what: "Capsule under a parachute, dropped with slack in the riser; a stepwise equilibrium point. A scene in TOML.",
        text: include_str!("../../../scenes/drop.toml"),
        is_toml: true,
    },
    ReadyFile {
        name: "swing",
        what: "Bob on a line that hangs from the knot of two others; a static equilibrium point. A scene as text.",
        text: include_str!("../../../scenes/swing.mbd"),
        is_toml: false,
    },
    ReadyFile {
        name: "linkage",
        what: "Four-bar with a weight on a line, everything in a plane. A scene as text.",
        text: include_str!("../../../scenes/linkage.mbd"),
        is_toml: false,
    },
    ReadyFile {
        name: "arm",
        what: "Arm of seven joints: motors carry its weight while an input moves it, then their power is cut and it falls. Joint coordinates.",
        text: include_str!("../../../scenes/arm.mbd"),
        is_toml: false,
    },
    ReadyFile {
        name: "quadruped",
        what: "Trunk that floats on four legs of three hinges, dropped into springs at its feet. Joint coordinates.",
        text: include_str!("../../../scenes/quadruped.mbd"),
        is_toml: false,
    },
    ReadyFile {
        name: "pendulums",
        what: "Chain of eight rods on hinges about crossed axes. Joint coordinates.",
        text: include_str!("../../../scenes/pendulums.mbd"),
        is_toml: false,
    },
    ReadyFile {
        name: "crank_rocker",
        what: "Four-bar in a plane in joint coordinates: the fourth hinge closes the loop by rows.",
        text: include_str!("../../../scenes/crank_rocker.mbd"),
        is_toml: false,
    },
];

/// A ready scene.
#[derive(Clone, Copy, Debug)]
pub enum ReadyEntry {
    /// Compiled with `model!`.
    Compiled(&'static scenes::Ready),
    /// A file, run without compilation.
    Written(&'static ReadyFile),
}

/// The names of the ready scenes.
pub fn names() -> impl Iterator<Item = &'static str> {
    let compiled = scenes::READY.iter().map(|ready| ready.name);
    compiled.chain(WRITTEN.iter().map(|ready| ready.name))
}

/// A ready scene by name.
pub fn ready(name: &str) -> Option<ReadyEntry> {
    let compiled = scenes::READY.iter().find(|ready| ready.name == name);
    let written = || WRITTEN.iter().find(|ready| ready.name == name);
    compiled
        .map(ReadyEntry::Compiled)
        .or_else(|| written().map(ReadyEntry::Written))
}

/// What to list: the ready scenes, if nothing is said.
#[derive(Args, Debug)]
pub struct ListArgs {
    #[command(subcommand)]
    what: Option<Listed>,
    /// Print the list as JSON.
    #[arg(long, global = true)]
    json: bool,
}

#[derive(Debug, Subcommand)]
enum Listed {
    /// What can be asked of a scene in outputs, metrics and events: names, units, meaning.
    Quantities(SceneArgs),
    /// The metrics that a scene declares: names, units, how they are taken.
    Metrics(SceneArgs),
}

/// Lists.
pub fn list(args: &ListArgs) -> Result<String, CommandFailure> {
    let scene = |args: &SceneArgs| SceneFile::find(&args.scene).map(|file| file.scene);
    match (&args.what, args.json) {
        (None, false) => Ok(ready_scenes()),
        (None, true) => {
            json_list(what_is_ready().map(|(name, what)| json!({ "name": name, "what": what })))
        }
        (Some(Listed::Quantities(args)), false) => Ok(quantities::table(&scene(args)?).text()),
        (Some(Listed::Quantities(args)), true) => json_list(
            quantities::asked(&scene(args)?)
                .iter()
                .map(quantities::RequestedQuantity::json),
        ),
        (Some(Listed::Metrics(args)), false) => Ok(metrics_of(&scene(args)?)),
        (Some(Listed::Metrics(args)), true) => {
            let scene = scene(args)?;
            let metrics = scene.runs.metrics.iter();
            json_list(metrics.map(|metric| describe::metric_json(metric, &scene)))
        }
    }
}

fn metrics_of(scene: &Scene) -> String {
    if scene.runs.metrics.is_empty() {
        return format!(
            "{} declares no metrics; one is declared as `metric peak = max rope.tension;`\n",
            scene.name
        );
    }
    describe::metrics(scene).text()
}

fn json_list(entries: impl Iterator<Item = Value>) -> Result<String, CommandFailure> {
    pretty(&Value::Array(entries.collect()))
}

/// Names of the ready scenes, and what they are.
fn what_is_ready() -> impl Iterator<Item = (&'static str, String)> {
    let compiled = scenes::READY.iter().map(|ready| {
        let doc = (ready.scene)().doc;
        (
            ready.name,
            doc.lines().next().unwrap_or_default().trim().to_owned(),
        )
    });
    compiled.chain(
        WRITTEN
            .iter()
            .map(|ready| (ready.name, ready.what.to_owned())),
    )
}

fn ready_scenes() -> String {
    let mut table = ReportTable::new("Ready scenes")
        .column("name", "")
        .column("what", "");
    for (name, what) in what_is_ready() {
        table.push([name.into(), what.into()]);
    }
    let about = "`mbd run NAME` runs one; check, expand and convert take its name, too. `mbd list metrics NAME` lists the metrics it declares, `mbd list quantities NAME` what can be \
         asked of it. The parachute with every model of its confluence is the main job: `mbd` without arguments, or `mbd parachute`.";
    format!("{}\n{about}\n", table.text())
}

/// No scene has this name.
pub fn unknown(name: &str) -> String {
    let hint =
        nearest(name, names()).map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
    format!("no ready scene and no file named `{name}`{hint} (`mbd list` shows the ready scenes)")
}
