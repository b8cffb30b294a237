//! `mbd list`: the scenes that come along.

use mbd_compiler::nearest;
use models::report::Table;

/// A scene that comes along.
#[derive(Debug)]
pub struct Ready {
    /// Its name for `mbd run`.
    pub name: &'static str,
    /// What it is.
    pub what: &'static str,
    /// The scene file.
    pub text: &'static str,
    /// Whether it is TOML, or the text of a declaration.
    pub is_toml: bool,
}

/// The ready scenes; the file of each is in `models/scenes`.
pub const READY: &[Ready] = &[
    Ready {
        name: "drop",
        what: "a capsule under a parachute, dropped with slack in the riser; a stepwise equilibrium point",
        text: include_str!("../../scenes/drop.toml"),
        is_toml: true,
    },
    Ready {
        name: "swing",
        what: "a bob on a line that hangs from the knot of two others; a static equilibrium point",
        text: include_str!("../../scenes/swing.mbd"),
        is_toml: false,
    },
];

/// A ready scene by name.
pub fn ready(name: &str) -> Option<&'static Ready> {
    READY.iter().find(|ready| ready.name == name)
}

/// The table of `mbd list`.
pub fn list() -> String {
    let mut table = Table::new("Ready scenes")
        .column("name", "")
        .column("what", "");
    table.push([
        "parachute".into(),
        "the main job: `mbd` without arguments, or `mbd parachute`".into(),
    ]);
    for ready in READY {
        table.push([ready.name.into(), ready.what.into()]);
    }
    table.text()
}

/// No scene has this name.
pub fn unknown(name: &str) -> String {
    let near = nearest(name, READY.iter().map(|ready| ready.name));
    let hint = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
    format!("no ready scene and no file named `{name}`{hint} (`mbd list` shows the ready scenes)")
}
