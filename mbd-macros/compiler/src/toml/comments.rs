//! Comments of a scene file, kept where it is written in the other form: each stands above what it stood above, or beside.

use std::collections::BTreeMap;

use crate::lexeme::{LineStarts, Scanned, scan};

/// Line and column.
pub(super) type TextPlace = (usize, usize);

/// A comment as it was found.
struct FoundComment {
    at: TextPlace,
    /// Whether something stands before it on its line.
    beside: bool,
    text: String,
}

/// The comments of a file by what they belong to.
pub(super) struct Comments {
    found: Vec<FoundComment>,
    owned: BTreeMap<TextPlace, Vec<String>>,
    /// Those behind everything.
    rest: Vec<String>,
}

impl Comments {
    /// Those of the text of a declaration.
    pub(super) fn of_text(text: &str) -> Self {
        let starts = LineStarts::new(text);
        let (mut at, mut bare, mut found) = (0, true, Vec::new());
        while let Some((kind, length)) = scan(&text[at..]) {
            let part = &text[at..at + length];
            match kind {
                Scanned::Blank => bare |= part.contains('\n'),
                Scanned::Comment => found.push(FoundComment {
                    at: starts.position(at),
                    beside: !bare,
                    text: part.to_owned(),
                }),
                _ => bare = false,
            }
            at += length;
        }
        Self::new(found)
    }

    /// Those of a TOML document.
    pub(super) fn of_document(document: &str) -> Self {
        let starts = LineStarts::new(document);
        let (mut at, mut bare, mut found) = (0, true, Vec::new());
        while let Some(next) = document[at..].chars().next() {
            let rest = &document[at..];
            let length = match next {
                '#' => rest.find('\n').unwrap_or(rest.len()),
                '"' | '\'' => string_length(rest),
                _ => next.len_utf8(),
            };
            match next {
                '#' => found.push(FoundComment {
                    at: starts.position(at),
                    beside: !bare,
                    text: rest[..length].to_owned(),
                }),
                '\n' => bare = true,
                next => bare &= next.is_whitespace(),
            }
            at += length;
        }
        Self::new(found)
    }

    fn new(found: Vec<FoundComment>) -> Self {
        Comments {
            found,
            owned: BTreeMap::new(),
            rest: Vec::new(),
        }
    }

    /// Gives every comment to one of these places: beside something to the last place before it, else to the next one.
    pub(super) fn assign(mut self, mut places: Vec<TextPlace>) -> Self {
        places.sort_unstable();
        for comment in std::mem::take(&mut self.found) {
            let next = places.partition_point(|place| *place <= comment.at);
            let own = match comment.beside {
                true => places.get(next.saturating_sub(1)),
                false => places.get(next),
            };
            let lines = bare_lines(&comment.text);
            match own {
                Some(place) => self.owned.entry(*place).or_default().extend(lines),
                None => self.rest.extend(lines),
            }
        }
        self
    }

    /// What belongs to a place: lines without the sign of a comment.
    pub(super) fn of(&self, place: TextPlace) -> &[String] {
        self.owned.get(&place).map_or(&[], Vec::as_slice)
    }

    /// What stands behind everything.
    pub(super) fn rest(&self) -> &[String] {
        &self.rest
    }
}

/// The lines of a comment in either form, without its signs.
fn bare_lines(text: &str) -> Vec<String> {
    let block = text
        .strip_prefix("/*")
        .map(|text| text.trim_end_matches("*/"));
    let line = |line: &str| {
        let line = line.trim();
        let signs = ["//", "#", "*"];
        let sign = signs.iter().find_map(|sign| line.strip_prefix(sign));
        sign.unwrap_or(line).trim().to_owned()
    };
    let lines = block.unwrap_or(text).lines().map(line);
    lines.filter(|line| !line.is_empty()).collect()
}

/// The length of a string of TOML that begins here; to the end of the text where it does not end.
fn string_length(text: &str) -> usize {
    let quote = &text[..1];
    let triple = quote.repeat(3);
    let (sign, escapes) = match text.starts_with(&triple) {
        true => (triple.as_str(), quote == "\""),
        false => (quote, quote == "\""),
    };
    let mut at = sign.len();
    while let Some(next) = text[at..].chars().next() {
        if text[at..].starts_with(sign) {
            return at + sign.len();
        }
        at += next.len_utf8();
        if escapes && next == '\\' {
            at += text[at..].chars().next().map_or(0, char::len_utf8);
        }
    }
    text.len()
}
