//! Messages about scenes that go on where an event ends a run.

use mbd_scene::Dimension;

use crate::lexeme::Region;
use crate::messages::LexemeMessage;
use crate::messages::similar::did_you_mean;
use crate::messages::syntax::ended;
use crate::units::{described, si_text};

pub fn scene_without_file(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "say which scene goes on by its file: `then: scene \"descent.mbd\"`, relative to this one",
    )
}

pub fn map_without_scene(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "a `map` says what another scene begins with, and none goes on here: write `then: scene \"descent.mbd\"` beside it",
    )
}

pub fn map_entry_wanted(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "write a name of the scene that goes on, `=`, and what of this one it begins with: `probe = capsule.tip` for a body or a point, `charge = 0.9 * soc` for a state or a param",
    )
}

/// `known`: the bodies, points and values of this scene.
pub fn no_source(at: Region, word: &str, known: &[&str]) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "no body, point or value named `{word}`{} a body or a point of the other scene begins at one of this, `probe = capsule.tip`, a state or a param with a value, `charge = 0.9 * soc`",
            ended(did_you_mean(word, known.iter().copied()))
        ),
    )
}

/// What is said of a map that does not fit the scene that goes on.
pub mod fit {
    use super::{Dimension, described, did_you_mean, si_text};

    pub fn unknown(scene: &str, name: &str, known: &[String]) -> String {
        let near = did_you_mean(name, known.iter().map(String::as_str));
        let all = match known {
            [] => "it has none".to_owned(),
            known => format!("it has {}", known.join(", ")),
        };
        format!(
            "the scene `{scene}` has no body, point with mass, state or param `{name}`{near} ({all})"
        )
    }

    pub fn not_a_place(scene: &str, name: &str, kind: &str) -> String {
        format!(
            "`{name}` is a {kind} in `{scene}` and begins at a place of this scene: a body, a frame, a point, not at a number"
        )
    }

    pub fn without_axes(scene: &str, name: &str) -> String {
        format!(
            "`{name}` is a body in `{scene}`, and a point has no axes that it could begin along: name a body or a frame, or declare `{name}` as a point there"
        )
    }

    pub fn not_a_number(scene: &str, name: &str, kind: &str) -> String {
        format!(
            "`{name}` is a {kind} in `{scene}` and begins with a number, not at a place: write one, such as `capsule.position.z`"
        )
    }

    pub fn dimension(scene: &str, name: &str, wanted: Dimension, found: Dimension) -> String {
        let wanted = match si_text(wanted).as_str() {
            "" => described(wanted),
            unit => format!("measured in {unit}"),
        };
        format!(
            "`{name}` is {wanted} in `{scene}`, this is {}",
            described(found)
        )
    }

    pub fn same_name(
        scene: &str,
        (kind, name): (&str, &str),
        [here, there]: [Dimension; 2],
    ) -> String {
        format!(
            "the {kind} `{name}` would go on under its name, but is {} here and {} in `{scene}`: give one of them another name, or say in the `map` what it begins with",
            described(here),
            described(there)
        )
    }

    pub fn nowhere(scene: &str, kind: &str, name: &str) -> String {
        format!(
            "the {kind} `{name}` of `{scene}` is not in this scene and starts nowhere: say in the `map` where, `map: [{name} = …]`, or there with `start at [x, y, z] m`"
        )
    }

    pub fn axes(scene: &str, what: &str) -> String {
        format!(
            "the scene `{scene}` has another `{what}`, so that its numbers are measured along other axes: declare both alike"
        )
    }
}

pub fn goes_on_in_rust(event: &str, file: &str) -> String {
    format!(
        "event `{event}` lets the scene file {file:?} go on, which `mbd run` does with scene files. in Rust write `then: stop`, declare the other model beside this one, and let it go on with `Simulation::take_over`"
    )
}
