//! What tells one model from another: its names and sizes, not its params.

use mbd_scene::{Layout, Scene, fingerprint};

use crate::columns::state_names;

/// A number that another model does not have whose state, joints or lines have other names. Snapshots belong to it.
pub(crate) fn of_state(scene: &Scene, layout: &Layout) -> u64 {
    of_words(state_words(scene, layout))
}

/// The same of what a history has columns of: the outputs, too.
pub(crate) fn of_columns(scene: &Scene, layout: &Layout) -> u64 {
    let outputs = scene.outputs.iter();
    let outputs = outputs.map(|output| format!("{} {}", output.name, output.components));
    of_words(state_words(scene, layout).chain(outputs))
}

fn state_words(scene: &Scene, layout: &Layout) -> impl Iterator<Item = String> {
    let names = state_names(scene, layout).into_iter().map(|name| name.name);
    let joints = scene.joints.iter().map(|joint| joint.name.clone());
    let lines = scene.lines.iter().map(|line| line.name.clone());
    names.chain(joints).chain(lines)
}

fn of_words(words: impl Iterator<Item = String>) -> u64 {
    // No text contains the byte that ends a word.
    fingerprint(words.flat_map(|word| word.into_bytes().into_iter().chain([255])))
}
