//! What a scene in relative coordinates must obey: it is in space, and its gravity does not come from the caller.

use mbd_scene::{Coordinates, Gravity, Scene};

use crate::messages::check as say;
use crate::resolve::Resolver;
use crate::syntax::Model;

/// Tells settings that relative coordinates do not go with.
pub fn check_relative(resolver: &mut Resolver<'_>, model: &Model<'_>) {
    if resolver.scene.coordinates != Coordinates::Relative {
        return;
    }
    let item = model
        .items
        .iter()
        .find(|item| item.word.text == "coordinates");
    let at = item
        .and_then(|item| item.clause(":"))
        .map_or(resolver.head, |value| value.at);
    if resolver.scene.planar.is_some() {
        resolver.messages.push(say::relative_in_a_plane(at));
    }
    if resolver.scene.gravity == Gravity::Field {
        resolver.messages.push(say::relative_in_a_field(at));
    }
}

/// The setting that relative coordinates do not go with, if there is one.
pub fn without_relative(scene: &Scene) -> Option<&'static str> {
    match (scene.planar, &scene.gravity) {
        (Some(_), _) => Some("planar"),
        (None, Gravity::Field) => Some("gravity: field"),
        _ => None,
    }
}
