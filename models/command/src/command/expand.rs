//! `mbd expand`: the Rust that `model!` makes of a scene.

use std::path::Path;

use super::failure::CommandFailure;
use super::scene_file::SceneFile;

/// The expansion as formatted text.
pub fn expand(path: &Path) -> Result<String, CommandFailure> {
    let file = SceneFile::find(path)?;
    mbd_compiler::expand(&file.reading).map_err(CommandFailure::Invalid)
}
