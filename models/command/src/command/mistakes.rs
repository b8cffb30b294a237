//! The mistakes of a scene file: each with its place, the line of the file and a caret under it.

use mbd_compiler::{Location, Message, MessagePlace};
use serde_json::{Value, json};

use crate::run::SettingsError;

/// Whether a text is coloured: for people in front of a terminal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Paint {
    /// Plain text.
    Plain,
    /// With the codes of a terminal.
    Coloured,
}

impl Paint {
    /// Colours where they are wanted.
    pub fn of(wanted: bool) -> Paint {
        match wanted {
            true => Paint::Coloured,
            false => Paint::Plain,
        }
    }

    /// A text in a colour of the terminal.
    fn with(self, code: &str, text: &str) -> String {
        match self {
            Paint::Plain => text.to_owned(),
            Paint::Coloured => format!("\x1b[{code}m{text}\x1b[0m"),
        }
    }
}

const BOLD: &str = "1";
const RED: &str = "1;31";
const BLUE: &str = "1;34";

/// What is wrong with a scene file.
#[derive(Debug)]
pub struct Mistakes {
    /// The name of the file.
    pub file: String,
    /// Its text.
    pub source: String,
    /// What is wrong with the scene.
    pub errors: Vec<Message>,
    /// What is wrong with the settings of its run.
    pub settings: Option<SettingsError>,
    /// How words were read that may be read otherwise: a mistake may come of it.
    pub notes: Vec<String>,
}

impl Mistakes {
    /// Every mistake as `file:line:column: text`, with the line and a caret; the notes, and the number of mistakes at the end.
    pub fn text(&self, paint: Paint) -> String {
        let shown = |message: &Message| {
            let places = message
                .places
                .iter()
                .map(|place| self.place(message, place, paint));
            places.collect::<Vec<_>>().join("\n")
        };
        let settings = self.setting().map(|message| shown(&message));
        let settings = settings.or_else(|| {
            let file = paint.with(BOLD, &format!("{}:", self.file));
            let error = self.settings.as_ref()?;
            Some(format!("{file} {}", error.text.trim_end()))
        });
        let all: Vec<String> = self.errors.iter().map(shown).chain(settings).collect();
        let count = match all.len() {
            1 => "1 error".to_owned(),
            count => format!("{count} errors"),
        };
        let notes = self.notes.iter().map(|note| format!("note: {note}\n"));
        let notes: String = notes.collect();
        format!("{}\n{notes}{}", all.join("\n"), paint.with(RED, &count))
    }

    /// What is wrong with a setting that stands in the file, at the key or the table on its line.
    fn setting(&self) -> Option<Message> {
        let error = self.settings.as_ref()?;
        let line = error.line?;
        let shown = self.source.lines().nth(line.checked_sub(1)?)?;
        let blanks = shown
            .chars()
            .take_while(|c| !(c.is_alphanumeric() || *c == '_'));
        let column = blanks.count() + 1;
        let text = error.text.trim_end().to_owned();
        Some(Message::new(text, Location::Text { line, column }))
    }

    fn place(&self, message: &Message, place: &MessagePlace, paint: Paint) -> String {
        let text = place.note.as_ref().unwrap_or(&message.text);
        let Location::Text { line, column } = place.location else {
            return format!("{}: {text}", self.file);
        };
        let head = paint.with(BOLD, &format!("{}:{line}:{column}:", self.file));
        let Some(shown) = self.source.lines().nth(line.saturating_sub(1)) else {
            return format!("{head} {text}");
        };
        // Tabs stay tabs, so that the caret stands under its sign.
        let before = shown.chars().take(column.saturating_sub(1));
        let indent: String = before.map(|c| if c == '\t' { c } else { ' ' }).collect();
        let rest: Vec<char> = shown.chars().skip(column.saturating_sub(1)).collect();
        let word = rest
            .iter()
            .take_while(|c| c.is_alphanumeric() || **c == '_');
        let carets = paint.with(RED, &"^".repeat(word.count().max(1)));
        let number = line.to_string();
        let [number, gap] = [&number, &" ".repeat(number.len())]
            .map(|margin| paint.with(BLUE, &format!(" {margin} |")));
        format!("{head} {text}\n{number} {shown}\n{gap} {indent}{carets}")
    }

    /// The mistakes for a program: file, line, column, text.
    pub fn json(&self) -> Vec<Value> {
        let settings = match self.setting() {
            Some(message) => listed(&[message], &self.file),
            None => (self.settings.iter())
                .map(|error| json!({ "file": self.file, "text": error.text.trim_end() }))
                .collect(),
        };
        let errors = listed(&self.errors, &self.file).into_iter();
        errors.chain(settings).collect()
    }
}

/// Messages for a program: file, line, column, text.
pub fn listed(messages: &[Message], file: &str) -> Vec<Value> {
    let places = messages
        .iter()
        .flat_map(|message| message.places.iter().map(move |place| (message, place)));
    let listed = places.map(|(message, place)| {
        let text = place.note.as_ref().unwrap_or(&message.text);
        match place.location {
            Location::Text { line, column } => {
                json!({ "file": file, "line": line, "column": column, "text": text })
            }
            Location::Tokens(..) => json!({ "file": file, "text": text }),
        }
    });
    listed.collect()
}
