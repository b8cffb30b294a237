//! Formatting: the same lexemes and comments with other blanks between them.
//!
//! A text is divided by [`scan`], and read by the parser of the language; nothing is known here of the grammar but what the parser found.
//! [`spacing`] says which neighbours on a line have a blank between them, [`layout`] where lines end. What comes out is divided again and
//! compared with what came in: a text that would change is refused.

mod layout;
mod marks;
mod rust;
mod spacing;
mod tokens;
mod values;

use crate::lexeme::{LexemeKind, Lexer, LineStarts, Region, piece, without_mark};
use crate::messages::{Message, Messages, syntax as say};
use crate::syntax::model;
use layout::{DeclarationLayout, Margin};
use tokens::Tokens;

pub use rust::{FormattedRust, format_rust};

/// The longest line, in characters.
const WIDTH: usize = 100;
/// Blanks a level.
const LEVEL: usize = 4;

/// Formats the text of a declaration: four blanks a level, an item a line, fields in braces on one line where they fit in 100 columns and were not
/// written one a line, otherwise one a line. Comments stay, and one empty line where there were some. Lines end as the first one does.
///
/// # Errors
/// What is wrong with the text, if it cannot be read; names and units are not looked at.
pub fn format_text(text: &str) -> Result<String, Vec<Message>> {
    let text = without_mark(text);
    let whole = EmbeddedDeclaration {
        text,
        start: 0,
        end: text.len(),
        margin: Margin::File,
    };
    Ok(whole.formatted()?.replace('\n', line_end(text)))
}

/// A declaration in a text.
struct EmbeddedDeclaration<'a> {
    /// The whole text.
    text: &'a str,
    /// Where the declaration begins [byte].
    start: usize,
    /// Where it ends [byte].
    end: usize,
    /// What is around it.
    margin: Margin,
}

/// Comments inside values may move more than once until they stay where they are.
const PASSES: usize = 8;

impl EmbeddedDeclaration<'_> {
    /// The declaration with other blanks.
    fn formatted(&self) -> Result<String, Vec<Message>> {
        let source = self.text.get(self.start..self.end).unwrap_or("");
        let mut written = self.pass(source, &LineStarts::new(self.text), self.start)?;
        for _ in 0..PASSES {
            let again = self.pass(&written, &LineStarts::new(&written), 0)?;
            if again == written {
                break;
            }
            written = again;
        }
        Ok(written)
    }

    /// The text of the declaration, which begins at a byte of these lines, formatted once.
    fn pass(
        &self,
        source: &str,
        lines: &LineStarts<'_>,
        start: usize,
    ) -> Result<String, Vec<Message>> {
        let mut lexer = Lexer::of_text();
        let mut messages = Messages::default();
        piece(&mut lexer, lines, source, Some(start), &mut messages);
        let (lexemes, places) = (lexer.lexemes, lexer.places);
        let whole = match messages.is_empty() {
            true => model::model(&lexemes, &mut messages),
            false => None,
        };
        let Some(model) = whole.filter(|_| messages.is_empty()) else {
            if messages.is_empty() {
                messages.push(say::no_model(Region::START));
            }
            return Err(messages.located(&places));
        };
        let tokens = Tokens::divided(source);
        let layout = (tokens.list.len() == lexemes.len())
            .then(|| DeclarationLayout::new(&tokens, &lexemes, &model, self.margin.clone()));
        match layout.map(DeclarationLayout::written) {
            Some(written) if Tokens::divided(&written).says_the_same(&tokens) => Ok(written),
            _ => {
                let head = lexemes
                    .first()
                    .map_or(Region::START, |first| first.at.into());
                let told = say::would_change(head);
                Err(vec![told.located(&places)])
            }
        }
    }
}

/// Whether a lexeme is this sign.
fn is_sign(kind: &LexemeKind, sign: char) -> bool {
    *kind == LexemeKind::Sign(sign)
}

/// The end of lines of a text, from its first one.
fn line_end(text: &str) -> &'static str {
    match text.find('\n') {
        Some(end) if text[..end].ends_with('\r') => "\r\n",
        _ => "\n",
    }
}
