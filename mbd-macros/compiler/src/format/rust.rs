//! Formatting the declarations in a file of Rust.

use std::ops::Range;

use proc_macro2::{Delimiter, Group, TokenStream, TokenTree};

use super::layout::Margin;
use super::{EmbeddedDeclaration, line_end};
use crate::lexeme::{Bracket, LexemeKind, LineStarts, Region, from_tokens};
use crate::messages::{LexemeMessage, Location, Message, syntax as say};

/// A file of Rust whose declarations are formatted.
#[derive(Clone, Debug)]
pub struct FormattedRust {
    /// The file.
    pub text: String,
    /// The declarations that stay as they are, and why.
    pub left: Vec<Message>,
}

/// Formats what stands between the brackets of every `model! { … }`, `model!(…)` and `model![…]` of a file of Rust, and leaves all else as it is. What
/// has a `$` in it is a part of `macro_rules!`: it stays, and is told.
///
/// # Errors
/// What is wrong with one of the declarations, or where the file is no Rust.
pub fn format_rust(text: &str) -> Result<FormattedRust, Vec<Message>> {
    let (mark, code) = match text.strip_prefix('\u{feff}') {
        Some(code) => ("\u{feff}", code),
        None => ("", text),
    };
    let tokens = tokens(code)?;
    let mut calls = Vec::new();
    find(tokens, &mut calls);
    let (mut written, mut at) = (mark.to_owned(), 0);
    let (mut errors, mut left) = (Vec::new(), Vec::new());
    for call in &calls {
        if call.is_template {
            left.push(call.told(code, say::template));
            continue;
        }
        match call.formatted(code) {
            Ok(inside) => {
                written.push_str(&code[at..call.inside.start]);
                written.push_str(&inside.replace('\n', line_end(code)));
                at = call.inside.end;
            }
            Err(messages) => errors.extend(messages),
        }
    }
    written.push_str(&code[at..]);
    match errors.is_empty() {
        true => Ok(FormattedRust {
            text: written,
            left,
        }),
        false => Err(errors),
    }
}

/// A declaration in a file.
struct Call {
    /// The bytes between its brackets.
    inside: Range<usize>,
    /// Its tokens.
    tokens: TokenStream,
    /// Whether its brackets are braces.
    in_braces: bool,
    /// Whether it is a part of `macro_rules!`.
    is_template: bool,
}

impl Call {
    fn formatted(&self, code: &str) -> Result<String, Vec<Message>> {
        let line = code[..self.inside.start].rsplit('\n').next().unwrap_or("");
        let blanks = line.len() - line.trim_start().len();
        let part = EmbeddedDeclaration {
            text: code,
            start: self.inside.start,
            end: self.inside.end,
            margin: Margin::Call {
                blanks: line[..blanks].to_owned(),
                in_braces: self.in_braces,
            },
        };
        let written = part.formatted()?;
        // Rust divides a text in its own way; it has to find the same.
        match tokens(&written).map(said) {
            Ok(now) if now == said(self.tokens.clone()) => Ok(written),
            _ => Err(vec![self.told(code, say::would_change)]),
        }
    }

    /// What is said of it, at its first bracket.
    fn told(&self, code: &str, what: fn(Region) -> LexemeMessage) -> Message {
        let start = self.inside.start.saturating_sub(1);
        let (line, column) = LineStarts::new(code).position(start);
        Message::new(what(Region::START).text, Location::Text { line, column })
    }
}

/// The lexemes that Rust finds, but for commas before `]` and `}`.
fn said(tokens: TokenStream) -> Vec<LexemeKind> {
    let (lexemes, _, _) = from_tokens(tokens);
    let mut kinds: Vec<LexemeKind> = Vec::with_capacity(lexemes.len());
    for lexeme in lexemes {
        let closes = matches!(
            lexeme.kind,
            LexemeKind::Close(Bracket::Square | Bracket::Brace)
        );
        if closes && kinds.last() == Some(&LexemeKind::Sign(',')) {
            kinds.pop();
        }
        kinds.push(match lexeme.kind {
            // How far a bracket reaches depends on those commas.
            LexemeKind::Open(bracket, _) => LexemeKind::Open(bracket, 0),
            kind => kind,
        });
    }
    kinds
}

fn tokens(code: &str) -> Result<TokenStream, Vec<Message>> {
    code.parse().map_err(|error: proc_macro2::LexError| {
        let start = error.span().start();
        let location = Location::Text {
            line: start.line.max(1),
            column: start.column + 1,
        };
        let text = "this is no Rust: brackets, quotes or comments do not close from here on";
        vec![Message::new(text.to_owned(), location)]
    })
}

/// Adds every call of `model!`.
fn find(tokens: TokenStream, calls: &mut Vec<Call>) {
    let mut before = [false; 2];
    for token in tokens {
        let is_call = before == [true; 2];
        before = match &token {
            TokenTree::Ident(word) => [word == "model", false],
            TokenTree::Punct(sign) if sign.as_char() == '!' => [before[0], true],
            _ => [false; 2],
        };
        let TokenTree::Group(group) = token else {
            continue;
        };
        match is_call {
            true => calls.push(call(&group)),
            false => find(group.stream(), calls),
        }
    }
}

fn call(group: &Group) -> Call {
    fn is_template(tokens: TokenStream) -> bool {
        tokens.into_iter().any(|token| match token {
            TokenTree::Punct(sign) => sign.as_char() == '$',
            TokenTree::Group(group) => is_template(group.stream()),
            _ => false,
        })
    }
    let (open, close) = (
        group.span_open().byte_range(),
        group.span_close().byte_range(),
    );
    Call {
        inside: open.end..close.start,
        tokens: group.stream(),
        in_braces: group.delimiter() == Delimiter::Brace,
        is_template: is_template(group.stream()),
    }
}
