//! `mbd list`: the scenes that come along.

use mbd_compiler::nearest;
use models::report::Table;
use models::scenes;

/// A ready scene that is a file: the two forms a scene file can have.
#[derive(Clone, Copy, Debug)]
pub struct Written {
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
const WRITTEN: &[Written] = &[
    Written {
        name: "drop",
        what: "Capsule under a parachute, dropped with slack in the riser; a stepwise equilibrium point. A scene in TOML.",
        text: include_str!("../../scenes/drop.toml"),
        is_toml: true,
    },
    Written {
        name: "swing",
        what: "Bob on a line that hangs from the knot of two others; a static equilibrium point. A scene as text.",
        text: include_str!("../../scenes/swing.mbd"),
        is_toml: false,
    },
    Written {
        name: "linkage",
        what: "Four-bar with a weight on a line, everything in a plane. A scene as text.",
        text: include_str!("../../scenes/linkage.mbd"),
        is_toml: false,
    },
    Written {
        name: "arm",
        what: "Arm of seven joints: motors carry its weight while an input moves it, then their power is cut and it falls. Joint coordinates.",
        text: include_str!("../../scenes/arm.mbd"),
        is_toml: false,
    },
    Written {
        name: "quadruped",
        what: "Trunk that floats on four legs of three hinges, dropped into springs at its feet. Joint coordinates.",
        text: include_str!("../../scenes/quadruped.mbd"),
        is_toml: false,
    },
    Written {
        name: "pendulums",
        what: "Chain of eight rods on hinges about crossed axes. Joint coordinates.",
        text: include_str!("../../scenes/pendulums.mbd"),
        is_toml: false,
    },
    Written {
        name: "crank_rocker",
        what: "Four-bar in a plane in joint coordinates: the fourth hinge closes the loop by rows.",
        text: include_str!("../../scenes/crank_rocker.mbd"),
        is_toml: false,
    },
];

/// A ready scene.
#[derive(Clone, Copy, Debug)]
pub enum Ready {
    /// Compiled with `model!`.
    Compiled(&'static scenes::Ready),
    /// A file, run without compilation.
    Written(&'static Written),
}

/// The names of the ready scenes.
pub fn names() -> impl Iterator<Item = &'static str> {
    let compiled = scenes::READY.iter().map(|ready| ready.name);
    compiled.chain(WRITTEN.iter().map(|ready| ready.name))
}

/// A ready scene by name.
pub fn ready(name: &str) -> Option<Ready> {
    let compiled = scenes::READY.iter().find(|ready| ready.name == name);
    let written = || WRITTEN.iter().find(|ready| ready.name == name);
    compiled
        .map(Ready::Compiled)
        .or_else(|| written().map(Ready::Written))
}

/// The table of `mbd list`.
pub fn list() -> String {
    let mut table = Table::new("Ready scenes")
        .column("name", "")
        .column("what", "");
    for ready in scenes::READY {
        let doc = (ready.scene)().doc;
        let what = doc.lines().next().unwrap_or_default();
        table.push([ready.name.into(), what.into()]);
    }
    for ready in WRITTEN {
        table.push([ready.name.into(), ready.what.into()]);
    }
    let about = "`mbd run NAME` runs one; check, expand and convert take its name, too. The parachute with every model of its confluence is the main job: \
         `mbd` without arguments, or `mbd parachute`.";
    format!("{}\n{about}\n", table.text())
}

/// No scene has this name.
pub fn unknown(name: &str) -> String {
    let hint =
        nearest(name, names()).map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
    format!("no ready scene and no file named `{name}`{hint} (`mbd list` shows the ready scenes)")
}
