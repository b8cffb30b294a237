//! Where the results of a folder are from, so that its cases can be flown again: `source.json`.

use std::fs;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::failure::Failure;
use mbd_report::files;

/// The name of its file.
const NAME: &str = "source.json";

/// Where the results of a folder are from. Files are named as they were typed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ResultSource {
    /// The command that repeats a case, without its number.
    pub command: String,
    /// The scene, where it is not the one model of the program.
    pub scene: Option<PathBuf>,
    /// The campaign file.
    pub campaign: PathBuf,
}

impl ResultSource {
    /// Puts it into a folder.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), Failure> {
        let text = serde_json::to_string_pretty(self)
            .map_err(|error| Failure::Usage(error.to_string()))?;
        files::write_shared(&folder.join(NAME), text + "\n")
            .map_err(|error| Failure::unwritten(&error))
    }

    /// That of a folder.
    ///
    /// # Errors
    /// There is none, or it cannot be read.
    pub fn read(folder: &Path) -> Result<Self, Failure> {
        let path = folder.join(NAME);
        let wrong = |why: String| Failure::Usage(format!("cannot read {}: {why}", path.display()));
        let text = fs::read_to_string(&path).map_err(|error| wrong(error.to_string()))?;
        serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))
    }
}
