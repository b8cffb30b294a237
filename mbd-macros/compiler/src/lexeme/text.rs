//! Lexemes of plain text.

use std::cell::Cell;

use super::{At, Bracket, Kind, Lexed, Lexer, Places};
use crate::messages::{Messages, syntax as say};

/// Where the lines of a text start: byte offsets to line and column.
#[derive(Clone, Debug)]
pub struct Lines<'a> {
    text: &'a str,
    starts: Vec<usize>,
    /// The last answer, offset, line and column: questions come in order, and long lines are counted once.
    last: Cell<(usize, usize, usize)>,
}

impl<'a> Lines<'a> {
    /// The lines of `text`.
    pub fn new(text: &'a str) -> Self {
        let mut starts = vec![0];
        starts.extend(text.match_indices('\n').map(|(at, _)| at + 1));
        Lines {
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

/// The lexemes of a text in the language of `model!`.
pub fn from_text(text: &str) -> Lexed {
    let mut lexer = Lexer::new(Places::of_text());
    let mut messages = Messages::default();
    piece(&mut lexer, &Lines::new(text), text, Some(0), &mut messages);
    (lexer.lexemes, lexer.places, messages)
}

impl Lexer {
    /// A lexer of pieces of one text.
    pub fn of_text() -> Self {
        Lexer::new(Places::of_text())
    }

    /// A place that has no lexeme.
    pub fn place(&mut self, position: (usize, usize)) -> At {
        let at = self.next_at();
        if let Some(positions) = self.places.positions() {
            positions.push(position);
        }
        at
    }

    /// Adds a lexeme at a line and column.
    pub fn positioned(&mut self, kind: Kind, position: (usize, usize)) -> At {
        let at = self.next_at();
        if let Some(positions) = self.places.positions() {
            positions.push(position);
        }
        self.push(kind, at);
        at
    }
}

/// Reads `text` into the lexer. It starts at byte `base` of the file; without a base everything is placed at the last place so far.
pub fn piece(
    lexer: &mut Lexer,
    lines: &Lines<'_>,
    text: &str,
    base: Option<usize>,
    messages: &mut Messages,
) {
    let opened = lexer.open.len();
    let last = lexer.places.positions().and_then(|all| all.last().copied());
    let anchor = last.unwrap_or((1, 1));
    let place = |offset: usize| base.map_or(anchor, |base| lines.position(base + offset));
    let mut at = 0;
    while let Some(next) = text[at..].chars().next() {
        let rest = &text[at..];
        if next.is_whitespace() {
            at += next.len_utf8();
        } else if rest.starts_with("//") {
            let line = rest.split('\n').next().unwrap_or(rest);
            if line.starts_with("///") && !line.starts_with("////") {
                let doc = line[3..].trim_end_matches('\r').to_string();
                lexer.positioned(Kind::Doc(doc), place(at));
            }
            at += line.len();
        } else if rest.starts_with("/*") {
            match rest.find("*/") {
                Some(end) => at += end + 2,
                None => {
                    let begin = lexer.positioned(Kind::Sign('/'), place(at));
                    messages.push(say::open_comment(begin.into()));
                    break;
                }
            }
        } else if next.is_alphabetic() || next == '_' {
            let end = rest
                .find(|c: char| !(c.is_alphanumeric() || c == '_') || is_superscript(c))
                .unwrap_or(rest.len());
            lexer.positioned(Kind::Word(rest[..end].to_string()), place(at));
            at += end;
        } else if next.is_ascii_digit() {
            let end = number_end(rest);
            lexer.positioned(Kind::Number(rest[..end].to_string()), place(at));
            at += end;
        } else if next == '"' {
            let end = rest[1..].find('"').map_or(rest.len(), |end| end + 2);
            let shown = rest[..end].trim_matches('"').to_string();
            let (path, report) = (lexer.awaits_path(), lexer.string_after());
            let string = lexer.positioned(Kind::Text(shown), place(at));
            if !path {
                messages.push(report.unwrap_or_else(|| say::string(string.into())));
            }
            at += end;
        } else if let Some((bracket, opens)) = Bracket::of(next) {
            at += 1;
            if opens {
                lexer.positioned(Kind::Open(bracket, 0), place(at - 1));
            } else if lexer.open.len() > opened
                && lexer.waiting().is_some_and(|(open, _)| open == bracket)
            {
                lexer.positioned(Kind::Close(bracket), place(at - 1));
            } else {
                let waiting = (lexer.open.len() > opened)
                    .then(|| lexer.waiting())
                    .flatten();
                let stray = lexer.positioned(Kind::Sign(next), place(at - 1));
                messages.push(say::stray_bracket(next, stray.into(), waiting));
                break;
            }
        } else {
            let sign = lexer.positioned(Kind::Sign(next), place(at));
            if !next.is_ascii() {
                messages.push(say::foreign_sign(next, sign.into()));
            }
            at += next.len_utf8();
        }
    }
    close_all(lexer, opened, place(text.len()), messages);
}

fn is_superscript(c: char) -> bool {
    matches!(c, '²' | '³' | '¹' | '⁰'..='⁹')
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
        lexer.positioned(Kind::Close(bracket), end);
    }
}

/// How many bytes at the start of `text` are a number: digits, a fraction, an exponent; 0 when there is none.
pub(super) fn number_end(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digit = |i: usize| bytes.get(i).is_some_and(u8::is_ascii_digit);
    let digits = |mut i: usize| {
        while digit(i) || bytes.get(i) == Some(&b'_') {
            i += 1;
        }
        i
    };
    if !digit(0) {
        return 0;
    }
    let mut end = digits(0);
    // `0..3` is a range and `1.x` no number: a fraction needs a digit, or nothing that could belong to it.
    let after = bytes.get(end + 1);
    let fraction = bytes.get(end) == Some(&b'.')
        && after.is_none_or(|&b| {
            b.is_ascii_digit() || !(b == b'.' || b == b'_' || b.is_ascii_alphabetic() || b >= 128)
        });
    if fraction {
        end = digits(end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        if digit(end + 1 + sign) {
            end = digits(end + 1 + sign);
        }
    }
    end
}
