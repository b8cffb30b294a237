//! What a document is made of: keys, strings, tables, values with units.

use std::fmt::Write;

use mbd_scene::Unit;

use crate::toml::formula::number;
use crate::units;

/// A string in quotes; one without escapes keeps its places when it is read.
pub(in crate::toml) fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => quoted.push_str("\\\""),
            '\\' => quoted.push_str("\\\\"),
            '\n' => quoted.push_str("\\n"),
            '\t' => quoted.push_str("\\t"),
            c if c.is_control() => {
                let _ = write!(quoted, "\\u{:04X}", u32::from(c));
            }
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}

/// A key, in quotes where it has an index.
pub(in crate::toml) fn key(name: &str) -> String {
    let plain = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if plain {
        name.to_string()
    } else {
        quoted(name)
    }
}

pub(super) fn entry(out: &mut String, name: &str, value: &str) {
    let _ = writeln!(out, "{name} = {}", quoted(value));
}

pub(super) fn doc(out: &mut String, doc: &str) {
    if !doc.is_empty() {
        entry(out, "doc", doc);
    }
}

pub(super) fn table(out: &mut String, word: &str, name: &str) {
    let _ = writeln!(out, "\n[{word}.{}]", key(name));
}

/// The unit of a value. What has none says so: of an angle SI would make radians.
pub(super) fn unit(out: &mut String, unit: &Unit) {
    match unit.text.as_str() {
        "" => entry(out, "in", "1"),
        text => entry(out, "in", text),
    }
}

/// A unit as the kind of an input or a state.
pub(super) fn unit_word(unit: &Unit) -> &str {
    match unit.text.as_str() {
        "" => "number",
        text => text,
    }
}

/// A number in the unit it was declared in; in SI where no decimal number of that unit gives it exactly.
pub(super) fn with_unit(value: f64, unit: &Unit) -> String {
    if unit.text.is_empty() {
        return number(value);
    }
    match inverse(value, |x| x * unit.factor, value / unit.factor) {
        Some(x) => format!("{} {}", number(x), unit.text),
        None => format!("{} {}", number(value), units::si_text(unit.dimension)),
    }
}

/// The number near `guess` whose image is `value`.
pub(super) fn inverse(value: f64, image: impl Fn(f64) -> f64, guess: f64) -> Option<f64> {
    let (mut up, mut down) = (guess, guess);
    for _ in 0..4 {
        for x in [up, down] {
            if image(x) == value {
                return Some(x);
            }
        }
        (up, down) = (up.next_up(), down.next_down());
    }
    None
}
