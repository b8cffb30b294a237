//! A declaration that takes in a URDF: its items stand where the declaration names the file, with what the declaration adds to them.

use std::path::Path;

use super::options::RobotOptions;
use super::{TakingIn, gravity, translate};
use crate::lexeme::{Lexeme, LexemeKind, Lexer, Places, Region};
use crate::messages::{Messages, urdf as say};
use crate::syntax::item::items as read_items;
use crate::syntax::{Cursor, Item, ModelSyntax, ValueSyntax, Word};

/// Fields that say more about another, and have no meaning without it: what is said for all joints leaves the others alone.
const ABOUT: [(&str, &str); 3] = [
    ("stop_stiffness", "stops"),
    ("stop_damping", "stops"),
    ("friction_rate", "friction"),
];

/// A file that a declaration names.
#[derive(Clone, Debug)]
pub struct File {
    /// Its path as written.
    pub path: String,
    /// Whether it could be read.
    pub found: bool,
    /// Whether it holds a robot without mistakes, taken in as it was meant: what the declaration says of the robot is to be blamed only then.
    pub whole: bool,
    /// The lexemes of its items.
    pub lexemes: Vec<Lexeme>,
    /// The name of the robot as that of a model.
    model: String,
    /// Choices that were made.
    pub notes: Vec<String>,
}

/// The file that the item `urdf` of a model names, read relative to `folder`; `None` without such an item.
pub fn take(
    model: &ModelSyntax<'_>,
    folder: &Path,
    places: &mut Places,
    messages: &mut Messages,
) -> Option<File> {
    let item = model.items.iter().find(|item| item.word.text == "urdf")?;
    let value = item.clause(":")?;
    let [
        Lexeme {
            kind: LexemeKind::Text(path),
            at,
        },
    ] = value.lexemes
    else {
        messages.push(say::no_path(value.at));
        return None;
    };
    let at = *at;
    let mut file = File {
        path: path.clone(),
        found: false,
        whole: false,
        lexemes: Vec::new(),
        model: String::new(),
        notes: Vec::new(),
    };
    // Mistakes in them are told where the fields are used, in `joined`.
    let mut unread = Messages::default();
    let options = RobotOptions::of(item, &mut unread);
    let how = TakingIn {
        free: options.free,
        unchecked: options.unchecked,
        unread: !unread.is_empty(),
    };
    let text = match text(&folder.join(path)) {
        Ok(text) => text,
        Err(why) => {
            messages.push(say::unreadable(at.into(), path, &why));
            return Some(file);
        }
    };
    file.found = true;
    let mut lexer = Lexer::of_file(places.clone(), path.clone(), at.into());
    let mut mistakes = Messages::default();
    let translated = translate(&text, &mut lexer, how, &mut mistakes);
    file.whole = mistakes.is_empty() && !how.unread;
    messages.extend(mistakes);
    if !model.items.iter().any(|item| item.word.text == "gravity") {
        file.notes.push(gravity(&mut lexer, at, messages));
    }
    file.notes.extend(translated.notes);
    file.model = translated.model;
    file.lexemes = lexer.lexemes;
    *places = lexer.places;
    Some(file)
}

/// The text of an ordinary file of the size of a robot.
fn text(path: &Path) -> Result<String, String> {
    let found = std::fs::metadata(path).map_err(|error| error.to_string())?;
    if !found.is_file() {
        return Err("it is no ordinary file".to_owned());
    }
    if found.len() > super::read::LARGEST as u64 {
        return Err(format!("{} bytes are no robot", found.len()));
    }
    std::fs::read_to_string(path).map_err(|error| error.to_string())
}

/// The items of a robot.
pub fn items<'a>(lexemes: &'a [Lexeme], messages: &mut Messages) -> Vec<Item<'a>> {
    let at = match (lexemes.first(), lexemes.last()) {
        (Some(first), Some(last)) => Region::from(first.at).to(last.at.into()),
        _ => Region::START,
    };
    read_items(Cursor::new(ValueSyntax { lexemes, at }), false, messages)
}

impl File {
    /// The model with the items of the file, and what it adds to them.
    pub fn joined<'a>(
        &'a self,
        model: ModelSyntax<'a>,
        messages: &mut Messages,
    ) -> ModelSyntax<'a> {
        let mut model = model;
        let mut robot = items(&self.lexemes, messages);
        let place = model.items.iter().position(|item| item.word.text == "urdf");
        let place = place.unwrap_or(0);
        let item = model.items.remove(place);
        let options = RobotOptions::of(&item, messages);
        for joint in robot.iter_mut().filter(|item| item.word.text == "joint") {
            let kind = joint.clause(":").and_then(|kind| kind.lexemes.first());
            let kind = kind.map(Lexeme::shown);
            let fields = match kind.as_deref() {
                Some("hinge") => &options.angle,
                Some("prismatic") => &options.slide,
                _ => continue,
            };
            let given = |word: &str| joint.block.iter().any(|field| field.word.text == word);
            let fields: Vec<Item<'a>> = (fields.iter())
                .filter(|field| {
                    let about = ABOUT.iter().find(|(word, _)| *word == field.word.text);
                    about.is_none_or(|(_, what)| given(what))
                })
                .cloned()
                .collect();
            set(joint, &fields);
        }
        let (added, mut own): (Vec<Item<'a>>, Vec<Item<'a>>) = std::mem::take(&mut model.items)
            .into_iter()
            .partition(|item| item.word.text == "extend");
        for extension in added.iter().filter(|_| self.whole) {
            extend(&mut robot, extension, messages);
        }
        without_stops(&mut robot);
        // There is one world.
        if let Some(world) = own.iter_mut().find(|item| item.word.text == "world") {
            let (of_robot, rest) = robot
                .into_iter()
                .partition::<Vec<_>, _>(|item| item.word.text == "world");
            robot = rest;
            let frames = of_robot.into_iter().flat_map(|item| item.block);
            world.block.extend(frames);
        }
        let place = place.min(own.len());
        own.splice(place..place, robot);
        model.items = own;
        model.taken = self.lexemes.first().map(|lexeme| lexeme.at);
        if model.name.is_none() && !self.model.is_empty() {
            model.name = Some(Word {
                text: self.model.clone(),
                at: item.word.at,
            });
        }
        model
    }
}

/// Refuses what adds to a robot where there is none.
pub fn nothing_to_extend(model: &mut ModelSyntax<'_>, messages: &mut Messages) {
    for item in model.items.iter().filter(|item| item.word.text == "extend") {
        messages.push(say::nothing_to_extend(item.name_at()));
    }
    model.items.retain(|item| item.word.text != "extend");
}

/// Adds the fields of `extension` to the item of the robot that it names.
fn extend<'a>(robot: &mut [Item<'a>], extension: &Item<'a>, messages: &mut Messages) {
    let Some(name) = &extension.name else {
        return;
    };
    let called = |item: &Item<'_>| {
        let own = item.name.as_ref();
        own.is_some_and(|own| own.word.text == name.word.text)
    };
    match robot.iter_mut().find(|item| called(item)) {
        Some(item) => set(item, &extension.block),
        None => {
            let names = robot.iter().filter_map(|item| item.name.as_ref());
            let names = names.map(|name| name.word.text.as_str());
            messages.push(say::no_such_item(
                name.word.at.into(),
                &name.word.text,
                names,
            ));
        }
    }
}

/// Adds fields; they stand in for those of the same name that were there before. Frames and starts of bodies are never the same field.
fn set<'a>(item: &mut Item<'a>, fields: &[Item<'a>]) {
    let new = |own: &Item<'a>| {
        let named = |field: &Item<'a>| field.word.text == own.word.text;
        own.clause(":").is_none() || !fields.iter().any(named)
    };
    item.block.retain(new);
    item.block.extend(fields.iter().cloned());
}

/// Takes the stops away where nobody says how stiff they are: limits of a URDF are no law.
pub fn without_stops(items: &mut [Item<'_>]) {
    for item in items.iter_mut().filter(|item| item.word.text == "joint") {
        let given = |word: &str| item.block.iter().any(|field| field.word.text == word);
        if !given("stop_stiffness") {
            item.block
                .retain(|field| field.word.text != "stops" || field.word.at < item.word.at);
        }
    }
}
