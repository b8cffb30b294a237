//! Reference data in `tests/reference/`: numbers from independent tools, with their provenance beside them.

use std::path::PathBuf;

use serde_json::Value;

/// A file of `tests/reference/`, parsed.
///
/// # Panics
/// If the file is missing or is not JSON: the repository is incomplete.
#[must_use]
pub fn load(name: &str) -> Value {
    let path: PathBuf = [env!("CARGO_MANIFEST_DIR"), "..", "reference", name]
        .iter()
        .collect();
    let text = std::fs::read_to_string(&path)
        .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// All numbers of a value, in order, nested lists flattened.
#[must_use]
pub fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Number(x) => x.as_f64().into_iter().collect(),
        Value::Array(items) => items.iter().flat_map(numbers).collect(),
        _ => Vec::new(),
    }
}

/// The numbers of a field.
#[must_use]
pub fn field(value: &Value, name: &str) -> Vec<f64> {
    numbers(&value[name])
}

/// The joints of `joints/joint_*.json`.
pub const JOINTS: [&str; 7] = [
    "rigid",
    "hinge",
    "spherical",
    "universal",
    "prismatic",
    "cylindrical",
    "free",
];
