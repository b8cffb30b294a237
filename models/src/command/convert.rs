//! `mbd convert`: any scene as TOML.

use std::path::Path;

use mbd_compiler::write_toml;

use super::failure::Failure;
use super::scene_file::SceneFile;

/// The scene of a file as TOML, with the settings of its run.
pub fn convert(path: &Path) -> Result<String, Failure> {
    let file = SceneFile::find(path)?;
    let scene = write_toml(&file.scene);
    Ok(match file.run.as_str() {
        "" => scene,
        run => format!("{}\n\n{run}\n", scene.trim_end()),
    })
}
