//! Lexemes: the words, numbers and signs of a declaration, each with its place, from two sources.
//!
//! [`from_tokens`] reads the tokens of a macro call, [`from_text`] plain text; [`Lexer`] collects pieces of text that lie anywhere in one
//! file. Everything after this layer knows lexemes only, so there is one grammar for all of them.

mod scan;
mod text;
mod tokens;

use proc_macro2::Span;

use crate::messages::{LexemeMessage, Location, Messages, syntax as say};
use crate::syntax::words;

/// The place of a lexeme: index into a table of [`Places`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct LexemeIndex(u32);

#[cfg(feature = "format")]
impl LexemeIndex {
    /// The place in the order of lexemes. In one text without a mistake it is the number of the lexeme.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// From one lexeme to another, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// The first lexeme.
    pub first: LexemeIndex,
    /// The last lexeme.
    pub last: LexemeIndex,
}

impl Region {
    /// The first lexeme of the source.
    pub const START: Region = Region {
        first: LexemeIndex(0),
        last: LexemeIndex(0),
    };

    /// From the start of `self` to the end of `other`.
    pub fn to(self, other: Region) -> Region {
        Region {
            first: self.first,
            last: other.last,
        }
    }
}

impl From<LexemeIndex> for Region {
    fn from(at: LexemeIndex) -> Self {
        Region {
            first: at,
            last: at,
        }
    }
}

/// A pair of brackets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bracket {
    /// `( )`
    Round,
    /// `[ ]`
    Square,
    /// `{ }`
    Brace,
}

impl Bracket {
    /// The two signs.
    pub fn signs(self) -> (char, char) {
        match self {
            Bracket::Round => ('(', ')'),
            Bracket::Square => ('[', ']'),
            Bracket::Brace => ('{', '}'),
        }
    }

    /// The bracket that opens or closes with `sign`, and whether it opens.
    fn of(sign: char) -> Option<(Bracket, bool)> {
        [Bracket::Round, Bracket::Square, Bracket::Brace]
            .into_iter()
            .find_map(|bracket| {
                let (open, close) = bracket.signs();
                (sign == open || sign == close).then_some((bracket, sign == open))
            })
    }
}

/// What a lexeme is.
#[derive(Clone, Debug, PartialEq)]
pub enum LexemeKind {
    /// An identifier or keyword.
    Word(String),
    /// A number as written, without its unit.
    Number(String),
    /// A sign.
    Sign(char),
    /// An opening bracket and the distance to its closing one.
    Open(Bracket, usize),
    /// A closing bracket.
    Close(Bracket),
    /// One line of a doc comment.
    Doc(String),
    /// A string: the path of a file. Anywhere else it only appears in a message.
    Text(String),
}

/// A lexeme with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Lexeme {
    /// What it is.
    pub kind: LexemeKind,
    /// Where it is.
    pub at: LexemeIndex,
}

impl Lexeme {
    /// The lexeme as the user sees it.
    pub fn shown(&self) -> String {
        match &self.kind {
            LexemeKind::Word(text) | LexemeKind::Number(text) => text.clone(),
            LexemeKind::Sign(sign) => sign.to_string(),
            LexemeKind::Open(bracket, _) => bracket.signs().0.to_string(),
            LexemeKind::Close(bracket) => bracket.signs().1.to_string(),
            LexemeKind::Doc(_) => "///".to_string(),
            LexemeKind::Text(text) => format!("\"{text}\""),
        }
    }
}

/// Line and column in a text, both from 1; columns count characters. A text has as many of them as lexemes.
#[derive(Clone, Copy, Debug)]
pub struct TextPosition {
    line: u32,
    column: u32,
}

impl TextPosition {
    /// The first place of a text.
    const START: TextPosition = TextPosition { line: 1, column: 1 };

    fn new(line: usize, column: usize) -> Self {
        let [line, column] = [line, column].map(|n| u32::try_from(n).unwrap_or(u32::MAX));
        TextPosition { line, column }
    }

    fn pair(self) -> (usize, usize) {
        (self.line as usize, self.column as usize)
    }
}

/// Where every lexeme lies in its source.
#[derive(Clone, Debug)]
pub struct Places {
    source: DeclarationSource,
    /// A file that the declaration takes in; its lexemes come after those of the declaration.
    taken: Option<Taken>,
}

/// The source of a declaration.
#[derive(Clone, Debug)]
enum DeclarationSource {
    /// Tokens of a macro call.
    Tokens(Vec<Span>),
    /// Lines and columns of a text.
    Text(Vec<TextPosition>),
}

/// A file that a declaration takes in.
#[derive(Clone, Debug)]
struct Taken {
    /// Its name in messages.
    file: String,
    /// Where the declaration names it.
    named: Region,
    /// The index of its first lexeme.
    first: usize,
    /// Lines and columns of the file.
    positions: Vec<TextPosition>,
}

impl Places {
    fn of_tokens() -> Self {
        Places {
            source: DeclarationSource::Tokens(Vec::new()),
            taken: None,
        }
    }

    fn of_text() -> Self {
        Places {
            source: DeclarationSource::Text(Vec::new()),
            taken: None,
        }
    }

    fn len(&self) -> usize {
        let own = match &self.source {
            DeclarationSource::Tokens(spans) => spans.len(),
            DeclarationSource::Text(positions) => positions.len(),
        };
        own + self.taken.as_ref().map_or(0, |file| file.positions.len())
    }

    /// What follows lies in the file that the declaration names there.
    fn take(&mut self, file: String, named: Region) {
        self.taken = Some(Taken {
            file,
            named,
            first: self.len(),
            positions: Vec::new(),
        });
    }

    /// Line and column of a lexeme of a text or of a file.
    pub fn position(&self, at: LexemeIndex) -> (usize, usize) {
        match (self.in_file(at), &self.source) {
            (Some((_, line, column)), _) => (line, column),
            (None, DeclarationSource::Text(positions)) => {
                let known = positions.get(at.0 as usize).copied();
                known.unwrap_or(TextPosition::START).pair()
            }
            (None, DeclarationSource::Tokens(_)) => (1, 1),
        }
    }

    /// Whether a lexeme lies in a file that the declaration takes in.
    pub fn is_taken(&self, at: LexemeIndex) -> bool {
        let first = self.taken.as_ref().map(|file| file.first);
        first.is_some_and(|first| at.0 as usize >= first)
    }

    /// The lines and columns that are being added to: those of a text, or of the file that is taken in.
    fn positions(&mut self) -> Option<&mut Vec<TextPosition>> {
        match (&mut self.taken, &mut self.source) {
            (Some(file), _) => Some(&mut file.positions),
            (None, DeclarationSource::Text(positions)) => Some(positions),
            (None, DeclarationSource::Tokens(_)) => None,
        }
    }

    /// File, line and column of a lexeme that is taken in.
    pub fn in_file(&self, at: LexemeIndex) -> Option<(&str, usize, usize)> {
        let file = self.taken.as_ref()?;
        let index = (at.0 as usize).checked_sub(file.first)?;
        let known = file.positions.get(index).copied();
        let (line, column) = known.unwrap_or(TextPosition::START).pair();
        Some((&file.file, line, column))
    }

    /// The region itself, or where the declaration names the file in which it lies.
    fn declared(&self, region: Region) -> Region {
        match &self.taken {
            Some(file) if self.is_taken(region.first) => file.named,
            _ => region,
        }
    }

    /// The location of a region, for a message.
    pub fn location(&self, region: Region) -> Location {
        let region = self.declared(region);
        let (first, last) = (region.first.0 as usize, region.last.0 as usize);
        match &self.source {
            DeclarationSource::Tokens(spans) => {
                let get = |i: usize| spans.get(i).copied().unwrap_or_else(Span::call_site);
                Location::Tokens(get(first), get(last))
            }
            DeclarationSource::Text(positions) => {
                let known = positions.get(first).copied();
                let (line, column) = known.unwrap_or(TextPosition::START).pair();
                Location::Text { line, column }
            }
        }
    }

    /// A key that sorts lexemes by their place in the source.
    pub fn order(&self, at: LexemeIndex) -> (usize, usize) {
        let at = self.declared(at.into()).first;
        match &self.source {
            DeclarationSource::Tokens(_) => (at.0 as usize, 0),
            DeclarationSource::Text(positions) => {
                let known = positions.get(at.0 as usize);
                known.map_or((0, 0), |position| position.pair())
            }
        }
    }

    /// The span of a lexeme; of a text it is the call site.
    pub fn span(&self, at: LexemeIndex) -> Span {
        let at = self.declared(at.into()).first;
        match &self.source {
            DeclarationSource::Tokens(spans) => spans
                .get(at.0 as usize)
                .copied()
                .unwrap_or_else(Span::call_site),
            DeclarationSource::Text(_) => Span::call_site(),
        }
    }
}

/// A list of lexemes in the making.
#[derive(Debug)]
pub struct Lexer {
    /// The lexemes so far.
    pub lexemes: Vec<Lexeme>,
    /// Their places.
    pub places: Places,
    open: Vec<usize>,
}

impl Lexer {
    fn new(places: Places) -> Self {
        Lexer {
            lexemes: Vec::new(),
            places,
            open: Vec::new(),
        }
    }

    /// A lexer of a file that a declaration takes in where it is `named`.
    pub fn of_file(mut places: Places, file: String, named: Region) -> Self {
        places.take(file, named);
        Lexer::new(places)
    }

    /// Room for so many lexemes more: a text of a sign a byte needs no more memory than they take.
    fn reserve(&mut self, more: usize) {
        self.lexemes.reserve(more);
        if let Some(positions) = self.places.positions() {
            positions.reserve(more);
        }
    }

    /// Whether what comes next is the path of a file: `urdf: "robot.urdf"`, `then: scene "descent.mbd"`.
    fn awaits_path(&self) -> bool {
        let mut last = self.lexemes.iter().rev().map(|lexeme| &lexeme.kind);
        match last.next() {
            Some(LexemeKind::Sign(':' | '=')) => {
                matches!(last.next(), Some(LexemeKind::Word(word)) if word == "urdf")
            }
            Some(LexemeKind::Word(word)) => word == "scene",
            _ => false,
        }
    }

    fn next_at(&self) -> LexemeIndex {
        LexemeIndex(u32::try_from(self.places.len()).unwrap_or(u32::MAX))
    }

    fn push(&mut self, kind: LexemeKind, at: LexemeIndex) {
        match kind {
            LexemeKind::Open(..) => self.open.push(self.lexemes.len()),
            LexemeKind::Close(_) => {
                if let Some(open) = self.open.pop() {
                    let distance = self.lexemes.len() - open;
                    if let Some(LexemeKind::Open(_, skip)) =
                        self.lexemes.get_mut(open).map(|lexeme| &mut lexeme.kind)
                    {
                        *skip = distance;
                    }
                }
            }
            _ => {}
        }
        self.lexemes.push(Lexeme { kind, at });
    }

    /// What to say of a string behind the last word, if that word asks for another text: `include "common.mbd"`.
    fn string_after(&self) -> Option<LexemeMessage> {
        let last = self.lexemes.last()?;
        match &last.kind {
            LexemeKind::Word(word) => say::one_text(last.at.into(), word),
            LexemeKind::Sign('=') => {
                let item = self.lexemes.len().checked_sub(3);
                let item = item.and_then(|item| self.lexemes.get(item))?;
                let is_table = item.kind == LexemeKind::Word("table".into());
                is_table.then(|| say::table_of_a_file(last.at.into()))
            }
            _ => None,
        }
    }

    /// The brace that was probably left open inside the outermost open one, and the item behind it that stands between no braces but the model's.
    fn probably_open(&self, opened: usize) -> Option<(Bracket, LexemeIndex, (&str, LexemeIndex))> {
        let outer = *self.open.get(opened)?;
        let mut around: Vec<(Bracket, LexemeIndex)> = Vec::new();
        for (index, lexeme) in self.lexemes.iter().enumerate().skip(outer + 1) {
            match &lexeme.kind {
                LexemeKind::Open(bracket, _) => around.push((*bracket, lexeme.at)),
                LexemeKind::Close(_) => {
                    around.pop();
                }
                LexemeKind::Word(word) if words::is_outside(word) && self.is_word(index + 1) => {
                    if let Some(&(Bracket::Brace, at)) = around.last() {
                        return Some((Bracket::Brace, at, (word, lexeme.at)));
                    }
                }
                _ => {}
            }
        }
        None
    }

    fn is_word(&self, at: usize) -> bool {
        matches!(self.lexemes.get(at), Some(lexeme) if matches!(lexeme.kind, LexemeKind::Word(_)))
    }

    /// The bracket that waits to be closed.
    fn waiting(&self) -> Option<(Bracket, LexemeIndex)> {
        let lexeme = self.lexemes.get(*self.open.last()?)?;
        match lexeme.kind {
            LexemeKind::Open(bracket, _) => Some((bracket, lexeme.at)),
            _ => None,
        }
    }
}

#[cfg(any(feature = "format", feature = "toml"))]
pub use scan::{Scanned, scan};
pub use text::from_text;
#[cfg(any(feature = "format", feature = "toml"))]
pub use text::without_mark;
pub use text::{LineStarts, piece};
pub use tokens::from_tokens;

/// A source as lexemes: balanced brackets, numbers apart from their units.
pub(crate) type Lexed = (Vec<Lexeme>, Places, Messages);
