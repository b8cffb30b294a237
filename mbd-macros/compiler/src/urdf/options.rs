//! What a declaration says of the file that it takes in: `urdf: "robot.urdf" { base: free, … };`.

use crate::lexeme::Bracket;
use crate::messages::{LexemeMessage, Messages, resolve as say_resolve, urdf as say};
use crate::syntax::item::items;
use crate::syntax::words;
use crate::syntax::{Cursor, Item, ValueSyntax};

/// What is said of a robot beside its file.
#[derive(Debug, Default)]
pub struct RobotOptions<'a> {
    /// `base: free`
    pub free: bool,
    /// `inertias: unchecked`
    pub unchecked: bool,
    /// `angle: { … }`: fields for every hinge.
    pub angle: Vec<Item<'a>>,
    /// `slide: { … }`: fields for every prismatic joint.
    pub slide: Vec<Item<'a>>,
}

impl<'a> RobotOptions<'a> {
    /// Reads the fields of the item `urdf`.
    pub fn of(item: &Item<'a>, messages: &mut Messages) -> RobotOptions<'a> {
        let mut options = RobotOptions::default();
        let known = words::find("urdf", false).and_then(|spec| spec.fields);
        for field in &item.block {
            let at = field.word.at.into();
            let Some(value) = field.clause(":") else {
                continue;
            };
            match field.word.text.as_str() {
                "base" => {
                    let chosen = choice(value, ["fixed", "free"]);
                    options.free = told(chosen, messages) == Some(1);
                }
                "inertias" => {
                    let chosen = choice(value, ["checked", "unchecked"]);
                    options.unchecked = told(chosen, messages) == Some(1);
                }
                "angle" => options.angle = block(value, messages),
                "slide" => options.slide = block(value, messages),
                word => {
                    messages.push(say_resolve::unknown_field(at, word, known.unwrap_or(&[])));
                }
            }
        }
        options
    }
}

fn told<T>(result: Result<T, LexemeMessage>, messages: &mut Messages) -> Option<T> {
    result.map_err(|report| messages.push(report)).ok()
}

/// Which of the words a value is.
fn choice(value: ValueSyntax<'_>, words: [&str; 2]) -> Result<usize, LexemeMessage> {
    let mut cursor = Cursor::new(value);
    let found = cursor.word();
    let index = found.and_then(|found| words.iter().position(|word| *word == found.text));
    match index {
        Some(index) if cursor.at_end() => Ok(index),
        _ => Err(say::choice(value.at, words)),
    }
}

/// The fields between braces.
fn block<'a>(value: ValueSyntax<'a>, messages: &mut Messages) -> Vec<Item<'a>> {
    let mut cursor = Cursor::new(value);
    match cursor.group(Bracket::Brace) {
        Some(group) if cursor.at_end() => items(Cursor::new(group), true, messages),
        _ => {
            messages.push(say::block(value.at));
            Vec::new()
        }
    }
}
