//! Lexemes of plain text.

use std::cell::Cell;

use super::scan::{Scanned, scan};
use super::{Lexed, LexemeIndex, LexemeKind, Lexer, Places, TextPosition};
use crate::messages::{Messages, syntax as say};

/// Where the lines of a text start: byte offsets to line and column.
#[derive(Clone, Debug)]
pub struct LineStarts<'a> {
    text: &'a str,
    starts: Vec<usize>,
    /// The last answer, offset, line and column: questions come in order, and long lines are counted once.
    last: Cell<(usize, usize, usize)>,
}

impl<'a> LineStarts<'a> {
    /// The lines of `text`.
    pub fn new(text: &'a str) -> Self {
        let mut starts = vec![0];
        starts.extend(text.match_indices('\n').map(|(at, _)| at + 1));
        LineStarts {
            text,
            starts,
            last: Cell::new((0, 1, 1)),
        }
    }

    /// Line and column of a byte offset, both from 1; columns count characters.
    pub fn position(&self, offset: usize) -> (usize, usize) {
        let line = self.starts.partition_point(|&start| start <= offset);
        let start = self.starts.get(line.wrapping_sub(1)).copied().unwrap_or(0);
        let (from, column) = match self.last.get() {
            (last, same, column) if same == line && last <= offset => (last, column),
            _ => (start, 1),
        };
        let between = self.text.get(from..offset).unwrap_or("");
        let column = column + between.chars().count();
        self.last.set((offset, line, column));
        (line, column)
    }
}

/// A text without the byte order mark that some editors of Windows write in front of it.
pub fn without_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

/// The lexemes of a text in the language of `model!`.
pub fn from_text(text: &str) -> Lexed {
    let text = without_mark(text);
    let mut lexer = Lexer::new(Places::of_text());
    let mut messages = Messages::default();
    lexer.reserve(count(text));
    piece(
        &mut lexer,
        &LineStarts::new(text),
        text,
        Some(0),
        &mut messages,
    );
    (lexer.lexemes, lexer.places, messages)
}

impl Lexer {
    /// A lexer of pieces of one text.
    pub fn of_text() -> Self {
        Lexer::new(Places::of_text())
    }

    /// A place that has no lexeme.
    pub fn place(&mut self, (line, column): (usize, usize)) -> LexemeIndex {
        let at = self.next_at();
        if let Some(positions) = self.places.positions() {
            positions.push(TextPosition::new(line, column));
        }
        at
    }

    /// Adds a lexeme at a line and column.
    pub fn positioned(&mut self, kind: LexemeKind, position: (usize, usize)) -> LexemeIndex {
        let at = self.place(position);
        self.push(kind, at);
        at
    }
}

/// How many lexemes a text has, or some more. Each bracket that opens is closed in the end.
fn count(text: &str) -> usize {
    let (mut at, mut count) = (0, 0);
    while let Some((scanned, length)) = scan(&text[at..]) {
        at += length;
        count += match scanned {
            Scanned::Blank | Scanned::Comment | Scanned::Close(_) => 0,
            Scanned::Open(_) => 2,
            _ => 1,
        };
    }
    count
}

/// Reads `text` into the lexer. It starts at byte `base` of the file; without a base everything is placed at the last place so far.
pub fn piece(
    lexer: &mut Lexer,
    lines: &LineStarts<'_>,
    text: &str,
    base: Option<usize>,
    messages: &mut Messages,
) {
    let opened = lexer.open.len();
    let last = lexer.places.positions().and_then(|all| all.last().copied());
    let anchor = last.unwrap_or(TextPosition::START).pair();
    let place = |offset: usize| base.map_or(anchor, |base| lines.position(base + offset));
    let mut at = 0;
    while let Some((scanned, length)) = scan(&text[at..]) {
        let (found, start) = (&text[at..at + length], at);
        at += length;
        match scanned {
            Scanned::Blank | Scanned::Comment => {}
            Scanned::OpenComment => {
                let begin = lexer.positioned(LexemeKind::Sign('/'), place(start));
                messages.push(say::open_comment(begin.into()));
                break;
            }
            Scanned::Doc => {
                let doc = found[3..].trim_end_matches('\r').to_string();
                lexer.positioned(LexemeKind::Doc(doc), place(start));
            }
            Scanned::Word => {
                lexer.positioned(LexemeKind::Word(found.to_string()), place(start));
            }
            Scanned::Number => {
                lexer.positioned(LexemeKind::Number(found.to_string()), place(start));
            }
            Scanned::Text => {
                let shown = found.trim_matches('"').to_string();
                let (path, report) = (lexer.awaits_path(), lexer.string_after());
                let string = lexer.positioned(LexemeKind::Text(shown), place(start));
                if !path {
                    messages.push(report.unwrap_or_else(|| say::string(string.into())));
                }
            }
            Scanned::Open(bracket) => {
                lexer.positioned(LexemeKind::Open(bracket, 0), place(start));
            }
            Scanned::Close(bracket) => {
                let waiting = (lexer.open.len() > opened)
                    .then(|| lexer.waiting())
                    .flatten();
                if waiting.is_some_and(|(open, _)| open == bracket) {
                    lexer.positioned(LexemeKind::Close(bracket), place(start));
                } else {
                    let sign = bracket.signs().1;
                    let stray = lexer.positioned(LexemeKind::Sign(sign), place(start));
                    messages.push(say::stray_bracket(sign, stray.into(), waiting));
                    break;
                }
            }
            Scanned::Sign(sign) => {
                let here = lexer.positioned(LexemeKind::Sign(sign), place(start));
                if sign == '#' && !text[at..].starts_with(['[', '!']) {
                    messages.push(say::hash_comment(here.into()));
                    at += text[at..].find('\n').unwrap_or(text.len() - at);
                } else if !sign.is_ascii() {
                    messages.push(say::foreign_sign(sign, here.into()));
                }
            }
        }
    }
    close_all(lexer, opened, place(text.len()), messages);
}

/// Closes what the text left open, so that every later stage sees balanced brackets.
fn close_all(lexer: &mut Lexer, opened: usize, end: (usize, usize), messages: &mut Messages) {
    while lexer.open.len() > opened {
        let Some((bracket, at)) = lexer.waiting() else {
            break;
        };
        if messages.is_empty() {
            let report = match lexer.probably_open(opened) {
                Some((bracket, at, next)) => say::open_bracket(bracket, at.into(), Some(next)),
                None => say::open_bracket(bracket, at.into(), None),
            };
            messages.push(report);
        }
        lexer.positioned(LexemeKind::Close(bracket), end);
    }
}
