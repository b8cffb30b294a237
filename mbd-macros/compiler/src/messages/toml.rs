//! Messages of reading TOML: what the document does not say in the way a scene is written.

use super::{LexemeMessage, resolve, similar};
use crate::lexeme::Region;
use crate::syntax::foreign;
use crate::syntax::words::ItemWord;

/// `unquoted`: key and value, if the value only lacks its quotes.
pub fn parse(at: Region, error: &str, unquoted: Option<(&str, &str)>) -> LexemeMessage {
    let text = match unquoted {
        Some((key, value)) => {
            format!("write a value with its unit in quotes: `{key} = \"{value}\"`")
        }
        None => format!("this is no TOML: {}", error.trim()),
    };
    LexemeMessage::new(at, text)
}

pub fn bare_index(at: Region, name: &str, index: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("a name with an index stands in quotes as a key of TOML: `\"{name}[{index}]\"`"),
    )
}

pub fn boolean(at: Region, word: &str) -> LexemeMessage {
    LexemeMessage::new(at, format!("`{word}` is `true` or `false`"))
}

pub fn string(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "write this as a string in the language of `model!`, such as `\"2.0 kg\"`",
    )
}

/// A table where a setting has one value.
pub fn one_value(at: Region, item: &ItemWord) -> LexemeMessage {
    let (word, form) = (item.word, item.form.trim_end_matches(';'));
    let value = form.split_once(": ").map_or("…", |(_, value)| value);
    LexemeMessage::new(
        at,
        format!("`{word}` has one value, which is a string: `{word} = \"{value}\"`"),
    )
}

pub fn table(at: Region, item: &ItemWord) -> LexemeMessage {
    let head = if item.named {
        format!("[{}.NAME]", item.word)
    } else {
        format!("[{}]", item.word)
    };
    LexemeMessage::new(
        at,
        format!(
            "write this as a table `{head}` with the keys {}",
            keys(item)
        ),
    )
}

/// `other`: a key that was meant for it.
pub fn missing(at: Region, item: &ItemWord, key: &str, other: Option<&str>) -> LexemeMessage {
    let other = other.map_or_else(String::new, |other| {
        format!("; `{other}` is here called `{key}`")
    });
    let example = EXAMPLES
        .iter()
        .find(|(word, _)| *word == item.word)
        .map_or_else(String::new, |(_, example)| format!(": write `{example}`"));
    LexemeMessage::new(
        at,
        format!(
            "this {} has no `{key}`{other}{example}; its keys: {}",
            item.word,
            keys(item)
        ),
    )
}

/// How the items that people write otherwise stand in TOML.
const EXAMPLES: &[(&str, &str)] = &[
    ("const", "const.L = \"2.1 m\""),
    (
        "param",
        "param.m_tip = { value = \"761 kg\", in = \"600 kg ..= 900 kg\" }",
    ),
    (
        "input",
        "input.wind = { kind = \"speed\", value = \"[8, 0, 0] m/s\" }",
    ),
    (
        "state",
        "state.seen = { start = \"0 m\", rate = \"(bob.position.x - seen) / (20 ms)\" }",
    ),
    (
        "table",
        "table.rho = \"{ 0 km: 0.0145 kg/m^3, 10 km: 0.006 kg/m^3 }\"",
    ),
    ("let", "let.speed = \"norm(bob.velocity)\""),
    (
        "load",
        "load.push = { on = \"rod\", at = \"tip\", value = \"[0, 0, 5] N\" }",
    ),
    (
        "output",
        "output.bend = { value = \"pin.angle\", in = \"deg\" }",
    ),
    (
        "metric",
        "metric.highest = { value = \"max bob.position.z\", from = \"1 s\" }",
    ),
    (
        "joint",
        "joint.pin = { kind = \"hinge\", from = \"world\", to = \"rod.com\", axis = \"y\" }",
    ),
    (
        "line",
        "line.cord = { from = \"world\", to = \"bob\", free_length = \"1 m\", stiffness = \"2 kN/m\" }",
    ),
    (
        "spring",
        "spring.strut = { from = \"world\", to = \"bob\", free_length = \"1 m\", stiffness = \"2 kN/m\" }",
    ),
    (
        "event",
        "event.low = { value = \"bob.position.z\", falls = \"-1 m\" }",
    ),
];

/// The key that a word was meant for: another name of it, or one that is near.
pub fn meant<'k>(word: &str, known: &[&'k str]) -> Option<&'k str> {
    let ours = foreign::translated(foreign::FOREIGN_KEYS, word)
        .and_then(|ours| known.iter().copied().find(|known| *known == ours));
    ours.or_else(|| similar::nearest(word, known.iter().copied()))
}

/// Whether a word is another name of a key.
pub fn is_called(word: &str, key: &str) -> bool {
    foreign::translated(foreign::FOREIGN_KEYS, word) == Some(key)
}

pub fn unknown_key(at: Region, word: &str, known: &[&str]) -> LexemeMessage {
    match foreign::translated(foreign::FOREIGN_KEYS, word).filter(|ours| known.contains(ours)) {
        Some(ours) => LexemeMessage::new(
            at,
            format!(
                "unknown field `{word}`; here it is called `{ours}`. fields here: {}",
                known.join(", ")
            ),
        ),
        None => resolve::unknown_field(at, word, known),
    }
}

/// The keys of an item.
pub fn keys_of(item: &ItemWord) -> impl Iterator<Item = &'static str> {
    let clauses = item.clauses.iter().map(|clause| clause.key);
    clauses.chain(item.fields.unwrap_or(&[]).iter().copied())
}

fn keys(item: &ItemWord) -> String {
    keys_of(item).collect::<Vec<_>>().join(", ")
}

pub fn no_model(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "the scene has no name: add `model = \"Name\"` at its top",
    )
}
