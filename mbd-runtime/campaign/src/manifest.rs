//! What a folder of results belongs to: `manifest.json`. Whoever adds to the folder must have the same; what differs is told with both values.

use std::fs;
use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::failure::Failure;
use crate::metric::Requirement;
use mbd_report::files;

/// The name of its file.
const NAME: &str = "manifest.json";

/// A column of the results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// Its unit; empty for a pure number.
    pub unit: String,
    /// What it has to be, of a metric.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub require: Option<Requirement>,
}

/// What a folder of results belongs to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// The name of the model.
    pub model: String,
    /// What tells its declaration from others.
    pub declaration: String,
    /// What tells distributions, constraints and metrics from others, numbers of tables included.
    pub dispersions: String,
    /// What tells the settings of the runs from others.
    pub settings: String,
    /// The version of this program.
    pub version: String,
    /// The kind of machine: sines and roots may differ in the last bit on another.
    pub target: String,
    /// What all random numbers come from.
    pub seed: u64,
    /// All cases, with the nominal.
    pub cases: u64,
    /// So many of them share a file.
    pub block: u64,
    /// The dispersed numbers, in the order of the columns.
    pub dispersed: Vec<Column>,
    /// The metrics, in the order of the columns.
    pub metrics: Vec<Column>,
}

impl Manifest {
    /// That of a folder.
    ///
    /// # Errors
    /// There is none, or it cannot be read.
    pub fn read(folder: &Path) -> Result<Self, Failure> {
        let path = folder.join(NAME);
        let text = fs::read_to_string(&path).map_err(|error| {
            Failure::Usage(format!(
                "{} holds no campaign: cannot read {}: {error}",
                folder.display(),
                path.display()
            ))
        })?;
        serde_json::from_str(&text)
            .map_err(|error| Failure::Usage(format!("{}: {error}", path.display())))
    }

    /// Puts it into a folder, or finds the same there.
    ///
    /// # Errors
    /// Another one is there; it cannot be written.
    pub fn claim(&self, folder: &Path) -> Result<(), Failure> {
        let path = folder.join(NAME);
        match fs::read_to_string(&path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                let text = serde_json::to_string_pretty(self)
                    .map_err(|error| Failure::Usage(error.to_string()))?;
                files::write_shared(&path, &(text + "\n"))
                    .map_err(|error| Failure::unwritten(&error))?;
                // Whoever was there at the same moment has written the same, or is found here.
                self.compare(&Manifest::read(folder)?, folder)
            }
            _ => self.compare(&Manifest::read(folder)?, folder),
        }
    }

    fn compare(&self, there: &Manifest, folder: &Path) -> Result<(), Failure> {
        if self == there {
            return Ok(());
        }
        let [own, there] = [self, there].map(|it| serde_json::to_value(it).unwrap_or_default());
        let (Value::Object(own), Value::Object(there)) = (own, there) else {
            return Ok(());
        };
        let differing = own
            .iter()
            .filter(|(name, value)| there.get(*name) != Some(value));
        let told: Vec<String> = differing
            .map(|(name, value)| {
                let other = there.get(name).unwrap_or(&Value::Null);
                format!("  {name}: {other} there, {value} here")
            })
            .collect();
        Err(Failure::Invalid(format!(
            "{} holds another campaign; take another folder, or run what it was begun with\n{}",
            folder.display(),
            told.join("\n")
        )))
    }
}
