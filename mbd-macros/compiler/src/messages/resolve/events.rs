//! Messages about events and what they do.

use mbd_scene::Unit;

use super::items::known_or_near;
use crate::lexeme::Region;
use crate::messages::{LexemeMessage, article};

pub fn event_without_value(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "this event has no crossing: write `crosses`, `rises` or `falls` and a value",
    )
}

/// `ours`: the passage that a field is meant for.
pub fn misspelt_passage(at: Region, field: &str, ours: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("unknown field `{field}`; did you mean `{ours}`?"),
    )
}

pub fn name_wanted(at: Region) -> LexemeMessage {
    LexemeMessage::new(at, "a name stands here, or several in brackets: `[a, b]`")
}

pub fn setting_wanted(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "what is set is written `name = value`, several in brackets: `[a = 1 m, b = 2 kg]`",
    )
}

pub fn event_names_twice(at: Region, name: &str, first: Region) -> LexemeMessage {
    LexemeMessage::new(at, format!("this event names `{name}` twice"))
        .also(first, "first named here")
}

pub fn no_line_of_event(at: Region, action: &str, word: &str, known: &[&str]) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "no line, spring or joint named `{word}` to {action}{}",
            known_or_near(word, known)
        ),
    )
}

pub fn not_a_line_of_event(at: Region, action: &str, word: &str, kind: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{word}` is {} {kind}; lines, springs and joints are what an event can {action}",
            article(kind)
        ),
    )
}

pub fn holds_nothing(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("the joint `{name}` holds nothing that could be detached"),
    )
}

pub fn stopped_joint_detached(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "the joint `{name}` has stops and cannot be detached: give the stops to a joint that stays, or leave them out"
        ),
    )
}

pub fn coupled_joint_detached(at: Region, name: &str, other: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{other}` couples coordinates of the joint `{name}`, which then cannot be detached: detach `{other}`, or couple others"
        ),
    )
}

pub fn nothing_to_set(at: Region, word: &str, known: &[&str]) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "no param or state named `{word}` to set{}",
            known_or_near(word, known)
        ),
    )
}

pub fn cannot_be_set(at: Region, word: &str, kind: &str) -> LexemeMessage {
    let why = match kind {
        "const" => format!("a const is folded into the code: declare it `param {word} = …`"),
        "event" => "an event is told by itself".to_owned(),
        "input" => format!(
            "inputs are given to a run: declare it `param {word} = …` where events change it"
        ),
        "let" => "a let says what follows from other numbers: set one of these".to_owned(),
        "body" | "point" => format!("a speed of it is `{word}.velocity` or `{word}.velocity.z`"),
        "joint" => {
            format!("a speed of it is the rate of a coordinate, such as `{word}.angle_rate`")
        }
        _ => "all else follows from these".to_owned(),
    };
    LexemeMessage::new(
        at,
        format!(
            "`{word}` is {} {kind}, and events set params, states and speeds; {why}",
            article(kind)
        ),
    )
}

pub fn moving_set(at: Region, path: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{path}` cannot be set: events set params, states and speeds, such as `rod.velocity.z`, `rod.omega_body` or `pin.angle_rate`; places stay, and all else follows"
        ),
    )
}

pub fn driven_speed_set(at: Region, path: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("`{path}` cannot be set: a motor drives it; set what the motor follows"),
    )
}

pub fn prescribed_speed_set(at: Region, path: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{path}` cannot be set: frames of the world move as they are declared; set what their declaration follows"
        ),
    )
}

pub fn node_speed_set(at: Region, path: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{path}` cannot be set: a point without mass moves as its lines balance; give it a mass, or set the speed of what it hangs on"
        ),
    )
}

pub fn attached_never_detached(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "nothing in this scene detaches `{name}`, so that to attach it changes nothing: give it `at_start: detached`, or let an event before `detach` it"
        ),
    )
    .about(name, None)
}

pub fn detached_for_good(at: Region, kind: &str, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "{kind} `{name}` begins detached and no event attaches it, so that it never acts: write `attach: {name}` in an event, or leave `at_start` out"
        ),
    )
    .about(name, None)
}

pub fn set_to_no_number(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(at, format!("`{name}` is set to what is no finite number"))
}

/// `unit`: in which the param is declared.
pub fn set_outside(
    at: Region,
    name: &str,
    found: f64,
    [low, high]: [f64; 2],
    unit: &Unit,
) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{name}` is set to {}, outside its range {} ..= {}",
            unit.told(found),
            unit.told(low),
            unit.told(high)
        ),
    )
}

pub fn event_twice(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("an event has one of `crosses`, `rises` and `falls`; {BOTH_AT_ONCE}"),
    )
}

/// How an event waits for two things at once.
pub const BOTH_AT_ONCE: &str = "that two things hold at once is `event NAME = if(a > b && c < d, 1, 0) rises 0.5`, with `||` for one of them";
