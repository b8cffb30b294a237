//! Messages about names: what a path or a place refers to.

use crate::lexeme::Region;
use crate::messages::similar::{did_you_mean, nearest};
use crate::messages::syntax::ended;
use crate::messages::{LexemeMessage, article};
use crate::syntax::expression::{Expression, PathStep};
use crate::syntax::foreign;
use crate::units;

pub fn not_constant(at: Region, what: &str) -> LexemeMessage {
    let instead = match what {
        _ if what == "time" || what.starts_with("the motion") || what.starts_with("the input") => {
            "; what changes in a run is named by `let`"
        }
        _ => "",
    };
    LexemeMessage::new(
        at,
        format!("only numbers and consts can stand here, {what} cannot{instead}"),
    )
}

/// `instead`: what to write where the param is right, and the item that names it is not.
pub fn param_not_constant(at: Region, instead: Option<&str>) -> LexemeMessage {
    let instead = instead.unwrap_or("make it a `const`");
    LexemeMessage::new(
        at,
        format!("only numbers and consts can stand here, a param cannot; {instead}"),
    )
}

/// `instead`: what to write, if there is something.
pub fn not_fixed(at: Region, what: &str, instead: Option<&str>) -> LexemeMessage {
    let instead = instead.map_or_else(String::new, |text| format!("; {text}"));
    LexemeMessage::new(
        at,
        format!(
            "this is fixed before a run: it can use numbers, consts and params, not {what}{instead}"
        ),
    )
}

pub fn not_prescribed(at: Region, what: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "a prescribed motion is a function of time alone: it can use numbers, consts, params and `time`, not {what}; what answers to the motion is a `force`"
        ),
    )
}

/// `instead`: what to write, if there is something better than a force.
pub fn not_driven(at: Region, what: &str, instead: Option<&str>) -> LexemeMessage {
    let instead =
        instead.unwrap_or("what answers to the motion is a `force`, or a `state` with a `rate`");
    LexemeMessage::new(
        at,
        format!(
            "this can use numbers, consts, params, `time`, inputs and states, not {what}; {instead}"
        ),
    )
}

pub fn not_a_quantity(at: Region, word: &str, kind: &str) -> LexemeMessage {
    let instead = match kind {
        "output" => ": name what it shows by `let`, and write that name in both places",
        _ => "",
    };
    LexemeMessage::new(
        at,
        format!(
            "`{word}` is the name of {} {kind} and has no value in an expression{instead}",
            article(kind)
        ),
    )
}

pub fn unknown_parameter(at: Region, word: &str, known: &[&str]) -> LexemeMessage {
    // `m/s2`: what stands behind the line was no unit and is taken for a name.
    let unit = units::foreign(word).map(str::to_owned);
    let unit = unit.or_else(|| units::run_together(word));
    let unit = unit.map(|unit| format!(", or write `{unit}` for the unit"));
    if let Some(answer) = foreign::translated(foreign::FOREIGN_NAMES, word) {
        return LexemeMessage::new(at, format!("nothing is named `{word}`; {answer}"));
    }
    let near = ended(did_you_mean(word, known.iter().copied()));
    let forms = || {
        format!(
            ": `const {word} = …;`, `param {word} = …;`, or `input {word}: …;` of what a run is given"
        )
    };
    let rest = unit.unwrap_or_else(|| {
        if near.contains('?') {
            String::new()
        } else {
            forms()
        }
    });
    LexemeMessage::new(
        at,
        format!("nothing is named `{word}`{near} declare it{rest}"),
    )
}

pub fn unknown_thing(at: Region, word: &str, known: &[&str]) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "no body, joint, point or line named `{word}`{}",
            at_rest_or_near(word, known)
        ),
    )
}

/// `owner`: what has a frame of this name, if something has.
pub fn unknown_place(at: Region, word: &str, known: &[&str], owner: Option<&str>) -> LexemeMessage {
    let near = match owner {
        Some(owner) => format!("; `{word}` is a frame of `{owner}`: write `{owner}.{word}`"),
        None => at_rest_or_near(word, known),
    };
    LexemeMessage::new(at, format!("no body or point named `{word}`{near}"))
}

/// `world` for another word of what is at rest, or the nearest name.
fn at_rest_or_near(word: &str, known: &[&str]) -> String {
    match foreign::FOREIGN_WORLD.contains(&word.to_lowercase().as_str()) {
        true => "; what is at rest is called `world`".to_owned(),
        false => did_you_mean(word, known.iter().copied()),
    }
}

pub fn no_index(at: Region, word: &str) -> LexemeMessage {
    LexemeMessage::new(at, format!("`{word}` is one thing and takes no index"))
}

/// Of a value with an index: `pin.angle [deg]`, `bob.position[2]`.
pub fn no_index_of_value(step: &PathStep, vector: bool) -> LexemeMessage {
    let (at, word) = (step.word.at.into(), &step.word.text);
    let text = match step.index.as_deref() {
        Some(Expression::Path(steps))
            if let [only] = steps.as_slice()
                && units::find(&only.word.text).is_some() =>
        {
            let unit = &only.word.text;
            format!("the unit of a result stands behind it: `in {unit}` instead of `[{unit}]`")
        }
        Some(Expression::Number { value, .. }) if vector => {
            let axis = match value {
                0.0 => "x",
                1.0 => "y",
                _ => "z",
            };
            format!("the components of a vector are `.x`, `.y` and `.z`: write `{word}.{axis}`")
        }
        _ => return no_index(at, word),
    };
    LexemeMessage::new(at, text)
}

pub fn index_wanted(at: Region, word: &str, first: i64) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("`{word}` is repeated: pick one, such as `{word}[{first}]`"),
    )
}

pub fn no_member(at: Region, word: &str, declared: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("there is no `{word}`: its repetition is empty; raise the end of its range, or repeat what refers to it, too"),
    )
    .also(declared, "declared here")
}

/// `indices`: those of the repetition around it, which say how the value came about.
pub fn index_range(
    at: Region,
    word: &str,
    value: i64,
    known: &[i64],
    indices: &[(String, i64)],
) -> LexemeMessage {
    let range = match known {
        [only] => format!("only `{word}[{only}]` exists"),
        [first, .., last] => format!("its indices are {first} to {last}"),
        [] => "it has no member".to_string(),
    };
    let here: Vec<String> = indices
        .iter()
        .map(|(name, value)| format!("{name} = {value}"))
        .collect();
    let here = match here.as_slice() {
        [] => String::new(),
        here => format!(" (here {})", here.join(", ")),
    };
    LexemeMessage::new(at, format!("`{word}` has no index {value}{here}; {range}"))
}

pub fn whole_index(at: Region) -> LexemeMessage {
    LexemeMessage::new(at, "an index is a whole number")
}

pub fn unknown_frame(at: Region, owner: &str, word: &str, frames: &[String]) -> LexemeMessage {
    let known = frames.iter().map(String::as_str);
    LexemeMessage::new(
        at,
        format!(
            "body `{owner}` has no frame `{word}`{} its frames: {}",
            ended(translated_or_near(word, known)),
            frames.join(", ")
        ),
    )
}

pub fn unknown_world_frame(at: Region, word: &str, frames: &[&str]) -> LexemeMessage {
    let list = if frames.is_empty() {
        "it has none: declare `world { frame NAME at [x, y, z] m }`".to_string()
    } else {
        format!("its frames: {}", frames.join(", "))
    };
    LexemeMessage::new(
        at,
        format!(
            "the world has no frame `{word}`{} {list}",
            ended(did_you_mean(word, frames.iter().copied()))
        ),
    )
}

pub fn unknown_body_quantity(
    at: Region,
    owner: &str,
    word: &str,
    frames: &[String],
    quantities: &[&str],
) -> LexemeMessage {
    if let Some(answer) = by_another_name(owner, word, quantities) {
        return LexemeMessage::new(at, answer);
    }
    let known = frames
        .iter()
        .map(String::as_str)
        .chain(quantities.iter().copied());
    LexemeMessage::new(
        at,
        format!(
            "body `{owner}` has no frame or quantity `{word}`{} its frames: {}; its quantities: {}",
            ended(translated_or_near(word, known)),
            frames.join(", "),
            quantities.join(", ")
        ),
    )
}

/// The nearest word, or our word for another tool's.
fn translated_or_near<'a>(word: &str, known: impl Iterator<Item = &'a str> + Clone) -> String {
    if nearest(word, known.clone()).is_none()
        && let Some(ours) = foreign::translated(foreign::FOREIGN_QUANTITIES, word)
        && known.clone().any(|k| k == ours)
    {
        return format!("; here it is called `{ours}`.");
    }
    did_you_mean(word, known)
}

pub fn body_without_quantity(at: Region, owner: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("`{owner}` is a body: ask for a quantity, such as `{owner}.velocity`"),
    )
}

pub fn frame_without_quantity(at: Region, owner: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("`{owner}` is a frame: ask for a quantity, such as `{owner}.position`"),
    )
}

pub fn without_quantity(at: Region, owner: &str, kind: &str, known: &[&str]) -> LexemeMessage {
    let example = known.first().copied().unwrap_or_default();
    LexemeMessage::new(
        at,
        format!("`{owner}` is a {kind}: ask for a quantity, such as `{owner}.{example}`"),
    )
}

pub fn unknown_quantity(at: Region, owner: &str, word: &str, known: &[&str]) -> LexemeMessage {
    if let Some(answer) = by_another_name(owner, word, known) {
        return LexemeMessage::new(at, answer);
    }
    LexemeMessage::new(
        at,
        format!(
            "`{owner}` has no quantity `{word}`{} known: {}",
            ended(translated_or_near(word, known.iter().copied())),
            known.join(", ")
        ),
    )
}

/// What to write for `bob.speed`, and of a joint with one coordinate for `pin.rate`.
fn by_another_name(owner: &str, word: &str, known: &[&str]) -> Option<String> {
    if word == "speed" && known.contains(&"velocity") {
        return Some(format!(
            "`{owner}` has a velocity, which is a vector: its speed is `norm({owner}.velocity)`"
        ));
    }
    if word == "energy" || word == "kinetic_energy" {
        return Some(format!(
            "`{owner}` has no quantity `{word}`; {}",
            foreign::ENERGY
        ));
    }
    if word == "power" {
        return Some(power(owner, known));
    }
    let mut rates = known.iter().filter_map(|known| known.strip_suffix("_rate"));
    let (Some(coordinate), None) = (rates.next(), rates.next()) else {
        return None;
    };
    match word {
        _ if !known.contains(&coordinate) => None,
        "rate" | "speed" | "velocity" | "omega" | "angular_velocity" => Some(format!(
            "`{owner}` has no quantity `{word}`: that is `{owner}.{coordinate}_rate`"
        )),
        "position" | "value" | "coordinate" | "q" => Some(format!(
            "`{owner}` has no quantity `{word}`: that is `{owner}.{coordinate}`"
        )),
        _ => None,
    }
}

/// How the power of what acts on a thing is written.
fn power(owner: &str, known: &[&str]) -> String {
    let has = |word: &str| known.contains(&word);
    let coordinate = known.iter().find_map(|it| it.strip_suffix("_rate"));
    let motor = known.iter().find(|word| word.starts_with("motor_"));
    let none = format!("`{owner}` has no quantity `power`: ");
    let text = match (coordinate, motor) {
        (_, _) if has("tension") => format!(
            "what it gives to its ends is `-{owner}.tension * {owner}.stretch_rate` where nothing winds it"
        ),
        (Some(coordinate), Some(motor)) => {
            format!("that of its motor is `{owner}.{motor} * {owner}.{coordinate}_rate`")
        }
        (Some(coordinate), None) if has(coordinate) => format!(
            "that of its field `force` is the same expression times `{owner}.{coordinate}_rate`"
        ),
        _ => format!("that of a force F is `dot(F, {owner}.velocity)`"),
    };
    none + &text
}

pub fn frame_of_a_body(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "a Jacobian is of a frame of a body, such as `frame_jacobian(hand.tip)`, or `hand.com` for its centre of mass".to_string(),
    )
}

pub fn no_place(at: Region, word: &str, kind: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "`{word}` is a {kind}: expected a frame of a body, a point, or a frame of the world"
        ),
    )
}

pub fn after_place(at: Region, word: &str) -> LexemeMessage {
    LexemeMessage::new(at, format!("a place ends before `.{word}`: remove it"))
}
