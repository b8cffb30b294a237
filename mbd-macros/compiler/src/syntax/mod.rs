//! Reading: lexemes to a tree of items. Values stay lexemes; [`expression`] and [`unit`] parse them when their meaning is known.

pub mod chain;
pub mod cursor;
pub mod expression;
pub mod foreign;
pub mod item;
pub mod model;
pub mod quantities;
pub mod unit;
pub mod words;

pub use cursor::Cursor;
pub use model::{begins_with_item, model};

use crate::lexeme::{Lexeme, LexemeIndex, Region};
use crate::messages::{LexemeMessage, syntax as say};

/// A word with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Word {
    /// The word.
    pub text: String,
    /// Its place.
    pub at: LexemeIndex,
}

/// The lexemes of a value.
#[derive(Clone, Copy, Debug)]
pub struct ValueSyntax<'a> {
    /// The lexemes, balanced.
    pub lexemes: &'a [Lexeme],
    /// Where they are, or where they should be.
    pub at: Region,
}

/// A name, possibly repeated.
#[derive(Clone, Debug)]
pub struct NameSyntax<'a> {
    /// The word.
    pub word: Word,
    /// What stands in its brackets: `i in 0..3`, or an index.
    pub index: Option<ValueSyntax<'a>>,
}

impl NameSyntax<'_> {
    /// The report of an index where the name of an item stands once.
    pub fn refused_index(&self, spec: &words::ItemWord) -> Option<LexemeMessage> {
        let index = self.index.filter(|_| !spec.repeats)?;
        Some(say::not_repeated(index.at, spec, &self.word.text))
    }
}

/// The sign of a clause and its value.
#[derive(Clone, Debug)]
pub struct ClauseValue<'a> {
    /// The sign or word, as in [`words::Clause::sign`].
    pub sign: &'static str,
    /// Where the sign is.
    pub at: Region,
    /// Its value.
    pub value: ValueSyntax<'a>,
}

/// An item, a setting or a field: keyword, name, clauses, fields between braces.
#[derive(Clone, Debug)]
pub struct Item<'a> {
    /// Its documentation.
    pub doc: String,
    /// The word that marks it, before the keyword: `loop joint`, `smooth table`.
    pub marked: Option<LexemeIndex>,
    /// The keyword, or the name of the field.
    pub word: Word,
    /// The name.
    pub name: Option<NameSyntax<'a>>,
    /// The values outside the braces.
    pub clauses: Vec<ClauseValue<'a>>,
    /// The fields between the braces.
    pub block: Vec<Item<'a>>,
    /// From the first to the last lexeme of its head.
    pub at: Region,
    /// Whether it could not be read whole: what is missing has been reported.
    pub broken: bool,
}

impl<'a> Item<'a> {
    /// The value of a clause.
    pub fn clause(&self, sign: &str) -> Option<ValueSyntax<'a>> {
        self.given(sign).map(|given| given.value)
    }

    /// A clause.
    pub fn given(&self, sign: &str) -> Option<&ClauseValue<'a>> {
        self.clauses.iter().find(|given| given.sign == sign)
    }

    /// The name's place, or the keyword's.
    pub fn name_at(&self) -> Region {
        self.name
            .as_ref()
            .map_or(self.word.at, |name| name.word.at)
            .into()
    }
}

/// A model as written.
#[derive(Clone, Debug, Default)]
pub struct ModelSyntax<'a> {
    /// Its documentation.
    pub doc: String,
    /// Its name.
    pub name: Option<Word>,
    /// `pub`, `pub(crate)`, or nothing.
    pub visibility: String,
    /// Whether `<T>` is written.
    pub generic: bool,
    /// Its items.
    pub items: Vec<Item<'a>>,
    /// The first place in a file that it takes in; what such a file declares may stay unused.
    pub taken: Option<LexemeIndex>,
}
