//! What is typed, and what comes of it.

use super::scene_file::SceneFile;
use super::*;

mod arguments;
mod campaign;
mod campaign_phases;
mod campaign_words;
mod checks;
mod compare;
mod conversion;
mod errors;
mod extremes;
mod files;
mod first_tries;
mod fmt;
mod histories;
mod immovable;
mod metrics;
mod newcomers;
mod phases;
mod pictures;
mod planes;
mod ready;
mod recipes;
mod robots;
mod slips;
mod starts;
mod steady;
mod stops;
mod trade;

fn run(arguments: &[&str]) -> Result<String, CommandFailure> {
    answer(["mbd"].iter().chain(arguments).map(OsString::from))
}

/// A folder of one test, taken away at its end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("mbd_{name}_{}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Folder(path)
    }

    fn file(&self, name: &str, text: &str) -> String {
        let path = self.0.join(name);
        std::fs::write(&path, text).unwrap();
        path.display().to_string()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
