//! `mbd check`: what a scene file contains.

use std::path::Path;

use mbd_compiler::Equations;
use models::describe;
use models::report::Table;

use super::failure::Failure;
use super::scene_file::SceneFile;

/// Reads a scene and tells what is in it.
pub fn check(path: &Path) -> Result<String, Failure> {
    let file = SceneFile::find(path)?;
    let mut parts = vec![describe::counts(&file.scene).text()];
    parts.extend(describe::things(&file.scene).iter().map(Table::text));
    parts.push(describe::operations(&Equations::trace(&file.scene)).text());
    if !file.remarks.is_empty() {
        parts.push(file.remarks.join("\n") + "\n");
    }
    Ok(parts.join("\n"))
}
