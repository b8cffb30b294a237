//! Messages: what is wrong, in the user's words, where, and what to write instead.
//!
//! The texts live in one file a stage: [`syntax`], [`resolve`], [`check`]; this file holds what a message is and how it is shown.

use std::fmt;

use proc_macro2::{Span, TokenStream};
use quote::{quote, quote_spanned};

pub use mbd_scene::similar;

use crate::lexeme::{Places, Region};

pub mod check;
pub mod resolve;
pub mod syntax;
#[cfg(feature = "toml")]
pub mod toml;
pub mod urdf;

/// Where a message points.
#[derive(Clone, Copy, Debug)]
pub enum Location {
    /// From one token of a macro call to another.
    Tokens(Span, Span),
    /// A line and a column of a text, both from 1.
    Text {
        /// The line.
        line: usize,
        /// The column, in characters.
        column: usize,
    },
}

/// One place of a message.
#[derive(Clone, Debug)]
pub struct MessagePlace {
    /// Where.
    pub location: Location,
    /// What to say there; the first place says the message itself.
    pub note: Option<String>,
}

/// An error or a warning with its places; it always has at least one.
#[derive(Clone, Debug)]
pub struct Message {
    /// What is wrong, what was expected, what to write.
    pub text: String,
    /// Where; further places carry a note of their own, such as "first used here".
    pub places: Vec<MessagePlace>,
    /// What a warning is about.
    pub about: Option<About>,
}

/// What a warning is about, so that the sentence of rustc around it names the thing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct About {
    /// Its name, the last of a path, without an index.
    pub name: String,
    /// Its kind, if the warning is that nothing uses it.
    pub unused: Option<&'static str>,
}

impl Message {
    /// A message with one place.
    #[must_use]
    pub fn new(text: String, location: Location) -> Self {
        Message {
            text,
            places: vec![MessagePlace {
                location,
                note: None,
            }],
            about: None,
        }
    }

    /// `compile_error!` calls: one a place, each underlining its tokens.
    #[must_use]
    pub fn to_compile_error(&self) -> TokenStream {
        self.places
            .iter()
            .map(|place| {
                let text = place.note.as_ref().unwrap_or(&self.text);
                let (first, last) = match place.location {
                    Location::Tokens(first, last) => (first, last),
                    Location::Text { .. } => (Span::call_site(), Span::call_site()),
                };
                let path = quote_spanned!(first=> ::core::compile_error);
                let call = quote_spanned!(last=> { #text });
                quote!(#path ! #call)
            })
            .collect()
    }

    /// The message for a reader of the file `name`: `scene.toml:12:7: text`, one line a place.
    #[must_use]
    pub fn in_file(&self, name: &str) -> String {
        let lines: Vec<String> = self
            .places
            .iter()
            .map(|place| {
                let text = place.note.as_ref().unwrap_or(&self.text);
                match place.location {
                    Location::Text { line, column } => format!("{name}:{line}:{column}: {text}"),
                    Location::Tokens(..) => format!("{name}: {text}"),
                }
            })
            .collect();
        lines.join("\n")
    }
}

impl fmt::Display for Message {
    /// `12:7: text`, or the text alone for tokens of a macro call.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.places.first().map(|place| place.location) {
            Some(Location::Text { line, column }) => write!(f, "{line}:{column}: {}", self.text),
            _ => f.write_str(&self.text),
        }
    }
}

/// A message whose places are still regions of lexemes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LexemeMessage {
    pub text: String,
    pub at: Region,
    pub also: Option<(String, Region)>,
    pub about: Option<About>,
}

impl LexemeMessage {
    /// A message with one place.
    pub fn new(at: Region, text: impl Into<String>) -> Self {
        LexemeMessage {
            text: text.into(),
            at,
            also: None,
            about: None,
        }
    }

    /// A warning about something: its name as in the text, and its kind, if nothing uses it.
    pub fn about(mut self, name: &str, unused: Option<&'static str>) -> Self {
        let last = name.rsplit('.').next().unwrap_or(name);
        let name = last.split('[').next().unwrap_or(last).to_owned();
        self.about = Some(About { name, unused });
        self
    }

    /// A second place with its own note.
    pub fn also(mut self, at: Region, note: impl Into<String>) -> Self {
        self.also = Some((note.into(), at));
        self
    }

    /// With locations instead of regions.
    pub fn located(self, places: &Places) -> Message {
        // Of a file that is taken in, the place is part of the text: the declaration only names it.
        let placed = |at: Region, text: String| match places.in_file(at.first) {
            Some((file, line, column)) => format!("{file}:{line}:{column}: {text}"),
            None => text,
        };
        let mut all = vec![MessagePlace {
            location: places.location(self.at),
            note: None,
        }];
        if let Some((note, at)) = self.also {
            all.push(MessagePlace {
                location: places.location(at),
                note: Some(placed(at, note)),
            });
        }
        Message {
            text: placed(self.at, self.text),
            places: all,
            about: self.about,
        }
    }
}

/// The messages of a stage: all of them, each once.
#[derive(Clone, Debug, Default)]
pub(crate) struct Messages {
    reports: Vec<LexemeMessage>,
}

/// Whether two texts are the same but for whole numbers: `bar[0]` and `bar[1]` of one repetition share their mistakes.
fn same(a: &str, b: &str) -> bool {
    fn words(text: &str) -> impl Iterator<Item = &str> {
        text.split(|c: char| c.is_ascii_digit())
            .filter(|part| !part.is_empty())
    }
    words(a).eq(words(b))
}

/// `a` or `an`.
fn article(word: &str) -> &'static str {
    match word.starts_with(['a', 'e', 'i', 'o', 'u']) && !word.starts_with("uni") {
        true => "an",
        false => "a",
    }
}

/// More messages than this help nobody.
const MOST: usize = 100;

impl Messages {
    /// Adds a message; the same text at the same place counts once, whichever instance of a repetition it is about.
    pub fn push(&mut self, report: LexemeMessage) {
        let known =
            |other: &LexemeMessage| other.at == report.at && same(&other.text, &report.text);
        if self.reports.len() < MOST && !self.reports.iter().any(known) {
            self.reports.push(report);
        }
    }

    /// Whether nothing is wrong.
    pub fn is_empty(&self) -> bool {
        self.reports.is_empty()
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.reports.len()
    }

    /// Forgets those that came after so many: what was read was read otherwise.
    pub fn forget_after(&mut self, count: usize) {
        self.reports.truncate(count);
    }

    /// Takes over the messages of another stage.
    pub fn extend(&mut self, other: Messages) {
        other
            .reports
            .into_iter()
            .for_each(|report| self.push(report));
    }

    /// With locations, in the order of the source.
    pub fn located(mut self, places: &Places) -> Vec<Message> {
        self.reports
            .sort_by_key(|report| places.order(report.at.first));
        self.reports
            .into_iter()
            .map(|report| report.located(places))
            .collect()
    }
}
