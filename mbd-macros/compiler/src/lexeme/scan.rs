//! What stands at the start of a text: the one division of a text into words, numbers, signs, comments and blanks.

use super::Bracket;

/// What stands at the start of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scanned {
    /// One blank or the end of a line.
    Blank,
    /// `// …` up to the end of its line, or `/* … */`.
    Comment,
    /// `/*` without its end.
    OpenComment,
    /// `/// …` up to the end of its line.
    Doc,
    /// An identifier or keyword.
    Word,
    /// A number without its unit.
    Number,
    /// `"…"`
    Text,
    /// An opening bracket.
    Open(Bracket),
    /// A closing bracket.
    Close(Bracket),
    /// Any other sign.
    Sign(char),
}

/// What stands at the start of `text`, and its length in bytes; `None` at the end.
pub fn scan(text: &str) -> Option<(Scanned, usize)> {
    let next = text.chars().next()?;
    Some(if next.is_whitespace() {
        (Scanned::Blank, next.len_utf8())
    } else if next.is_alphabetic() || next == '_' {
        (Scanned::Word, word_end(text))
    } else if next.is_ascii_digit() {
        (Scanned::Number, number_end(text))
    } else if text.starts_with("//") {
        let doc = text.starts_with("///") && !text.starts_with("////");
        let line = text.split('\n').next().unwrap_or(text);
        (
            if doc { Scanned::Doc } else { Scanned::Comment },
            line.len(),
        )
    } else if text.starts_with("/*") {
        match comment_end(text) {
            Some(end) => (Scanned::Comment, end),
            None => (Scanned::OpenComment, text.len()),
        }
    } else if next == '"' {
        let end = text[1..].find('"').map_or(text.len(), |end| end + 2);
        (Scanned::Text, end)
    } else {
        let kind = match Bracket::of(next) {
            Some((bracket, true)) => Scanned::Open(bracket),
            Some((bracket, false)) => Scanned::Close(bracket),
            None => Scanned::Sign(next),
        };
        (kind, next.len_utf8())
    })
}

/// Where the comment at the start of `text` ends. Comments nest, as in Rust.
fn comment_end(text: &str) -> Option<usize> {
    let bytes = text.as_bytes();
    let (mut at, mut depth) = (0, 0usize);
    while let Some(two) = bytes.get(at..at + 2) {
        match two {
            b"/*" => depth += 1,
            b"*/" => depth -= 1,
            _ => {
                at += 1;
                continue;
            }
        }
        at += 2;
        if depth == 0 {
            return Some(at);
        }
    }
    None
}

/// Where the word at the start of `text` ends.
fn word_end(text: &str) -> usize {
    let is_plain = |b: &u8| b.is_ascii_alphanumeric() || *b == b'_';
    let plain = text.bytes().position(|b| !is_plain(&b));
    match plain {
        // A letter that takes several bytes may go on with it.
        Some(end) if !text.as_bytes()[end].is_ascii() => {
            let ends = |c: char| !(c.is_alphanumeric() || c == '_') || is_superscript(c);
            text[end..].find(ends).map_or(text.len(), |more| end + more)
        }
        Some(end) => end,
        None => text.len(),
    }
}

fn is_superscript(c: char) -> bool {
    matches!(c, '²' | '³' | '¹' | '⁰'..='⁹')
}

/// How many bytes at the start of `text` are a number: digits, a fraction, an exponent; 0 when there is none.
pub fn number_end(text: &str) -> usize {
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
