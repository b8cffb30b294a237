//! Names in settings: dotted, misspelt, unknown.

use std::fmt;

use mbd_compiler::nearest;
use mbd_runtime::scene::Scene;
use toml::{Table, Value};

use super::settings::is_setting;

/// A setting that cannot be used: its name and what is wrong with it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlanError {
    /// The setting, `start.capsule.z`.
    pub setting: String,
    /// What is wrong, and what to write.
    pub text: String,
}

impl fmt::Display for PlanError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}`: {}", self.setting, self.text)
    }
}

impl std::error::Error for PlanError {}

/// A setting with what is wrong with it.
pub(crate) fn wrong(setting: impl Into<String>, text: impl Into<String>) -> PlanError {
    PlanError {
        setting: setting.into(),
        text: text.into(),
    }
}

/// Nested tables as dotted names, in the order of the names.
pub(crate) fn flat(table: &Table) -> Vec<(String, &Value)> {
    let mut list = Vec::new();
    for (name, value) in table {
        match value {
            Value::Table(inner) => {
                list.extend(
                    flat(inner)
                        .into_iter()
                        .map(|(rest, value)| (format!("{name}.{rest}"), value)),
                );
            }
            value => list.push((name.clone(), value)),
        }
    }
    list
}

/// Quantities of bodies and points by the names that the state has for their components, and their units.
pub(crate) const VECTORS: [(&str, &str, &str); 4] = [
    ("position", "", "m"),
    ("velocity", "v", "m/s"),
    ("omega_body", "omega_body_", "rad/s"),
    ("omega_world", "omega_world_", "rad/s"),
];

/// The name that the state has for a component: `bob.z` of `bob.position.z`, `bob.vx` of `bob.velocity.x`.
pub(crate) fn state_name(name: &str) -> Option<String> {
    let (quantity, axis) = name.rsplit_once('.')?;
    let (owner, word) = quantity.rsplit_once('.')?;
    let (_, prefix, _) = VECTORS.into_iter().find(|(found, ..)| *found == word)?;
    let is_axis = ["x", "y", "z"].contains(&axis);
    is_axis.then(|| format!("{owner}.{prefix}{axis}"))
}

/// A column of histories by the name that they give it, whichever of both is written.
pub(crate) fn column_name(name: &str) -> String {
    state_name(name).unwrap_or_else(|| name.to_owned())
}

/// What is said of a joint coordinate that is no column.
pub(crate) fn no_coordinate(column: &str) -> String {
    format!(
        "in absolute coordinates a history has joint coordinates where an output tells them: declare `output NAME = {column};`, and write its name here"
    )
}

/// What is said of a column that a history has not.
pub(crate) fn no_column<'a>(
    scene: &Scene,
    column: &str,
    known: impl Iterator<Item = &'a str>,
) -> String {
    if scene.joint_coordinate(column).is_some() {
        return no_coordinate(column);
    }
    match nearest(column, known) {
        Some(near) => format!("the history has no column `{column}`; did you mean `{near}`?"),
        None => {
            format!("the history has no column `{column}`; the header of history.csv names them")
        }
    }
}

/// What is said of a setting of the run that stands behind the header of one of its tables, `start.every`: there it is a name of that table.
pub(crate) fn setting_in_table(setting: &str, name: &str) -> Option<String> {
    let (table, _) = setting.split_once('.')?;
    is_setting(name).then(|| {
        format!("`{name}` is a setting of `[run]`, and here it belongs to `[run.{table}]`: write it in front of that line")
    })
}

/// What is said of a name that is not there: which is near, what there is.
pub(crate) fn unknown<'a>(
    setting: &str,
    name: &str,
    known: impl Iterator<Item = &'a str>,
) -> PlanError {
    if let Some(text) = setting_in_table(setting, name) {
        return wrong(setting, text);
    }
    let mut known: Vec<&str> = known.collect();
    // A coordinate of a tree is one of the state, too.
    let mut seen = std::collections::HashSet::new();
    known.retain(|name| seen.insert(*name));
    // Of a thing that is there, everything it has.
    let owner = name.rsplit_once('.').map(|(owner, _)| format!("{owner}."));
    let own = known.iter().copied();
    let own: Vec<&str> = own
        .filter(|known| owner.as_ref().is_some_and(|owner| known.starts_with(owner)))
        .collect();
    // Of a thing alone, `pin`, what it has.
    let inside = known.iter().copied().find(|known| {
        let rest = known.strip_prefix(name);
        rest.is_some_and(|rest| rest.starts_with('.'))
    });
    let near = inside.or_else(|| nearest(name, known.iter().copied()));
    let text = match near {
        _ if known.is_empty() => format!("this scene has no `{name}`, nor any other here"),
        Some(near) if own.is_empty() => {
            format!("this scene has no `{name}`; did you mean `{near}`?")
        }
        Some(near) => format!(
            "this scene has no `{name}`; did you mean `{near}`? it has {}",
            own.join(", ")
        ),
        None => {
            let list = if own.is_empty() { known } else { own };
            format!("this scene has no `{name}`; it has {}", list.join(", "))
        }
    };
    wrong(setting, text)
}
