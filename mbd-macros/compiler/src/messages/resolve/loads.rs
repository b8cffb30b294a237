//! Messages about loads, and about gravity.

use mbd_scene::Dimension;

use super::items::{short, unknown_word};
use crate::lexeme::Region;
use crate::messages::LexemeMessage;
use crate::units::described;

pub fn load_twice(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "a load has a value after `=`, or is `: external`, not both",
    )
}

pub fn load_without_value(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "this load has no value: write `= expression`, or `: external`",
    )
}

pub fn load_kind(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "expected `external`; a load that is an expression is written with `=`",
    )
}

/// `in body` behind a load on a body of this name.
pub fn load_axes(at: Region, body: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "a load is given in the axes of the world, and `in` takes its unit; along the axes of a body it is written with them: `fx * {body}.x + fy * {body}.y + fz * {body}.z`"
        ),
    )
}

/// `in rod` behind an output.
pub fn output_axes(at: Region, body: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "a vector is told in the axes of the world, and `in` takes its unit; the components of a vector `v` along the axes of `{body}` are `[dot(v, {body}.x), dot(v, {body}.y), dot(v, {body}.z)]`, where a place seen from `{body}` is `let v = bob.position - {body}.position;`"
        ),
    )
}

/// `along rod.z` behind the place of a load.
pub fn load_along(at: Region, direction: &str) -> LexemeMessage {
    let direction = match direction {
        "" => "rod.z",
        direction => direction,
    };
    LexemeMessage::new(
        at,
        format!(
            "a load is a vector in the axes of the world: write `= 5 N * {direction}` instead of `along {direction}`"
        ),
    )
}

pub fn load_on_world(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "a load on the world moves nothing: name a body or a point",
    )
}

pub fn load_on_joint(at: Region, joint: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "a load acts on a body or a point, and `{joint}` is a joint; what acts along its coordinate is its field `force`, such as `{{ axis: y, force: 3 N*m }}`"
        ),
    )
}

pub fn load_on_frame(at: Region, body: &str, frame: &str) -> LexemeMessage {
    LexemeMessage::new(at, format!("write `on {body} at {frame}`"))
}

pub fn load_at(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "expected the name of a frame of the body, such as `at com`",
    )
}

pub fn load_at_point(at: Region) -> LexemeMessage {
    LexemeMessage::new(at, "a load on a point needs no `at`: remove it")
}

pub fn load_is_scalar(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "a load must be a vector, this is one number: multiply it by a direction, such as `body.z`",
    )
}

pub fn load_dimension(at: Region, found: Dimension) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "a load is a force (N) or a couple (N*m), this is {}",
            described(found)
        ),
    )
}

pub fn couple_on_point(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("`{name}` is a point and takes no couple (N*m): it does not rotate"),
    )
}

pub fn load_on_node(at: Region, node: &str, culprit: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "a load on the massless point `{node}` cannot depend on `{culprit}`: the place of a node follows from the balance of its forces. give the point a mass, or use the motion of a body"
        ),
    )
}

pub fn unknown_gravity(at: Region, word: &str, known: &[&str]) -> LexemeMessage {
    let report = unknown_word(at, "gravity", word, known);
    let text = report.text;
    LexemeMessage::new(
        at,
        format!(
            "{text}; where it is uniform it is a vector, such as `[0, 0, -9.81] m/s^2` where z points up"
        ),
    )
}

pub fn no_gravity(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "no gravity is declared: write `gravity: [0.0, 0.0, -9.81] m/s^2;`, or `gravity: none;` if there is none",
    )
}

pub fn gravity_of_one(at: Region, number: &str, unit: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("gravity has a direction: write `[0, 0, -{number}] {unit}` where z points up"),
    )
}

pub fn gravity_field(at: Region, field: &str, wanted: Dimension) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "this gravity has no `{field}`: add it, {}",
            described(wanted)
        ),
    )
}

pub fn no_direction(at: Region, length: f64) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`axis` must be a unit vector, this one has the length {}",
            short(length)
        ),
    )
}
