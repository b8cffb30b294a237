//! A TOML document as items.

use std::ops::Range;
use std::path::Path;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::declaration::entries;
use super::forms::{is_set, is_taken, only_law, unquoted};
use crate::lexeme::{
    Lexeme, LexemeIndex, LexemeKind, Lexer, LineStarts, Region, piece, without_mark,
};
use crate::messages::{Messages, syntax as say, toml as say_toml};
use crate::reading::{Reading, complete};
use crate::syntax::item::push_clause;
use crate::syntax::words::{self, ItemWord};
use crate::syntax::{Cursor, Item, ModelSyntax, NameSyntax, ValueSyntax, Word, model};

/// Reads a scene from TOML. A file that it names lies relative to the working directory.
#[must_use]
pub fn read_toml(text: &str) -> Reading {
    read_toml_in(text, Path::new(""))
}

/// Reads a scene from TOML. A file that it names lies relative to `folder`.
#[must_use]
pub fn read_toml_in(text: &str, folder: &Path) -> Reading {
    let text = without_mark(text);
    let mut reader = TomlReader {
        text,
        lines: LineStarts::new(text),
        lexer: Lexer::of_text(),
        messages: Messages::default(),
    };
    // The first place of all is the start of the document.
    reader.mark(0);
    let drafts = match DeTable::parse(text) {
        Ok(table) => reader.document(table.get_ref()),
        Err(error) => {
            let offset = error.span().map_or(0, |span| span.start);
            let at = reader.mark(offset);
            let report = match key_with_index(text, offset) {
                Some((name, index)) => say_toml::bare_index(at.into(), name, index),
                None => say_toml::parse(at.into(), error.message(), unquoted(text, offset)),
            };
            reader.messages.push(report);
            Document::default()
        }
    };
    let lexed = reader.messages.is_empty();
    let mut messages = reader.messages;
    let Lexer {
        lexemes, places, ..
    } = reader.lexer;
    let model = drafts.model(&lexemes, &mut messages);
    complete(model, places, messages, lexed, folder)
}

/// The name and the index of a key `frame.m[0]` on the line of a place where TOML could not go on.
fn key_with_index(text: &str, offset: usize) -> Option<(&str, &str)> {
    let begin = text.get(..offset)?.rfind('\n').map_or(0, |end| end + 1);
    let line = text.get(begin..)?.lines().next()?;
    let key = match line.trim_start().strip_prefix('[') {
        Some(header) => header.trim_end().strip_suffix(']')?,
        None => line.split_once('=')?.0.trim(),
    };
    let key = key.strip_suffix(']')?;
    let name = key.rsplit('.').find(|name| name.contains('['))?;
    let (name, index) = name.split_once('[')?;
    let bare = !key.contains(['"', '\'']) && !name.is_empty();
    bare.then_some((name, index))
}

/// A value: lexemes from here to there, and its place.
#[derive(Clone, Debug)]
pub(super) struct ValueLexemes {
    pub(super) range: Range<usize>,
    pub(super) at: LexemeIndex,
}

/// An item whose lexemes are still being collected.
#[derive(Clone, Debug)]
pub(super) struct ItemDraft {
    doc: String,
    word: Word,
    name: Option<ValueLexemes>,
    pub(super) clauses: Vec<(&'static str, ValueLexemes)>,
    block: Vec<ItemDraft>,
    spec: Option<&'static ItemWord>,
    /// `loop = true`, `smooth = true`
    marked: Option<LexemeIndex>,
    /// Whether one of its values could not be read.
    broken: bool,
}

/// The items of a document.
#[derive(Debug, Default)]
struct Document {
    doc: String,
    name: Option<ValueLexemes>,
    items: Vec<ItemDraft>,
}

pub(super) struct TomlReader<'t> {
    text: &'t str,
    pub(super) lines: LineStarts<'t>,
    pub(super) lexer: Lexer,
    messages: Messages,
}

impl<'t> TomlReader<'t> {
    /// A place without a lexeme of its own.
    pub(super) fn mark(&mut self, offset: usize) -> LexemeIndex {
        let position = self.lines.position(offset);
        self.lexer.place(position)
    }

    fn document(&mut self, table: &DeTable<'_>) -> Document {
        let mut document = Document::default();
        let mut items: Vec<(usize, ItemDraft)> = Vec::new();
        for (key, value) in entries(table) {
            let word: &str = key.get_ref();
            let at = self.mark(key.span().start);
            match (word, words::find(word, false)) {
                ("model", _) => document.name = self.value(value),
                ("doc", _) => document.doc = self.doc(value),
                (_, None) => self.messages.push(say::unknown_item(at.into(), word)),
                ("verify", Some(spec)) => match value.get_ref() {
                    DeValue::Boolean(true) => {
                        items.push((key.span().start, draft(word, at, Some(spec))));
                    }
                    DeValue::Boolean(false) => {}
                    _ => self.messages.push(say_toml::boolean(at.into(), word)),
                },
                (_, Some(spec)) if spec.named => match value.get_ref() {
                    DeValue::Table(table) => {
                        for (name, value) in entries(table) {
                            if let Some(draft) = self.named(spec, name, value) {
                                items.push((name.span().start, draft));
                            }
                        }
                    }
                    _ => self.messages.push(say_toml::table(at.into(), spec)),
                },
                (_, Some(spec)) => {
                    if let Some(draft) = self.unnamed(spec, at, value) {
                        items.push((key.span().start, draft));
                    }
                }
            }
        }
        items.sort_by_key(|(start, _)| *start);
        document.items = items.into_iter().map(|(_, draft)| draft).collect();
        document
    }

    /// A setting, or the world.
    fn unnamed(
        &mut self,
        spec: &'static ItemWord,
        at: LexemeIndex,
        value: &Spanned<DeValue<'_>>,
    ) -> Option<ItemDraft> {
        let mut item = draft(spec.word, at, Some(spec));
        match value.get_ref() {
            DeValue::Table(table) if spec.fields.is_some() => self.fields(&mut item, spec, table),
            DeValue::String(path) if spec.clauses.iter().any(|c| c.key == words::FILE) => {
                let path = self.path(path, value.span().start);
                item.clauses.push((":", path));
            }
            _ if spec.fields.is_some() => {
                self.messages.push(say_toml::table(at.into(), spec));
                return None;
            }
            DeValue::Table(table) => match only_law(spec, table) {
                Some((name, fields)) => {
                    let value = self.law(value.span().start, name, fields)?;
                    item.clauses.push((":", value));
                }
                None => {
                    self.messages.push(say_toml::one_value(at.into(), spec));
                    return None;
                }
            },
            _ => item.clauses.push((":", self.value(value)?)),
        }
        Some(item)
    }

    /// An item with a name: a table, or its one value.
    fn named(
        &mut self,
        spec: &'static ItemWord,
        key: &Spanned<std::borrow::Cow<'_, str>>,
        value: &Spanned<DeValue<'_>>,
    ) -> Option<ItemDraft> {
        let at = self.mark(key.span().start);
        let mut item = draft(spec.word, at, Some(spec));
        item.name = Some(self.key(key));
        match value.get_ref() {
            DeValue::Table(table) => self.fields(&mut item, spec, table),
            _ => {
                let written = self.text.get(value.span()).unwrap_or("");
                match spec.alone(written) {
                    Some(only) => {
                        item.clauses.push((only.sign, self.value(value)?));
                        self.unit_behind(&mut item, spec);
                    }
                    None => {
                        self.messages.push(say_toml::table(at.into(), spec));
                        return None;
                    }
                }
            }
        }
        Some(item)
    }

    /// Clauses, fields and inner items of an item.
    fn fields(&mut self, item: &mut ItemDraft, spec: &'static ItemWord, table: &DeTable<'_>) {
        let mut unknown = Vec::new();
        for (key, value) in entries(table) {
            let word: &str = key.get_ref();
            let at = self.mark(key.span().start);
            let clause = spec.clauses.iter().find(|clause| clause.key == word);
            let inner = words::find(word, true).filter(|_| spec.fields.is_some());
            match (clause, inner, value.get_ref()) {
                (Some(clause), _, DeValue::String(path)) if clause.key == words::FILE => {
                    let path = self.path(path, value.span().start);
                    item.clauses.push((clause.sign, path));
                }
                (Some(clause), ..) => {
                    let value = self.value(value);
                    item.broken |= value.is_none();
                    item.clauses.extend(value.map(|value| (clause.sign, value)));
                }
                (None, Some(inner), DeValue::Table(table)) if !inner.named => {
                    let mut start = draft(word, at, Some(inner));
                    self.fields(&mut start, inner, table);
                    item.block.push(start);
                }
                (None, Some(inner), _) if !inner.named => {
                    let field = self.field(word, at, value);
                    item.block.push(field);
                }
                (None, Some(inner), DeValue::Table(table)) => {
                    for (name, value) in entries(table) {
                        let draft = self.named(inner, name, value);
                        item.block.extend(draft);
                    }
                }
                (None, Some(inner), _) => self.messages.push(say_toml::table(at.into(), inner)),
                (None, None, _) if word == "doc" => item.doc = self.doc(value),
                (None, None, DeValue::Boolean(marked)) if spec.mark == Some(word) => {
                    item.marked = marked.then_some(at);
                }
                // The fields of a joint coordinate.
                (None, None, DeValue::Table(table)) if spec.word == "joint" => {
                    let mut block = draft(word, at, None);
                    for (key, value) in entries(table) {
                        let at = self.mark(key.span().start);
                        let field = self.field(key.get_ref(), at, value);
                        block.block.push(field);
                    }
                    item.block.push(block);
                }
                // `max = "cord.tension"`, as in a campaign.
                (None, None, _) if is_taken(spec, word) => {
                    let taken = self.key(key);
                    let value = self.value(value);
                    item.broken |= value.is_none();
                    item.clauses.extend(value.map(|value| {
                        let range = taken.range.start..value.range.end;
                        (
                            "=",
                            ValueLexemes {
                                range,
                                at: taken.at,
                            },
                        )
                    }));
                }
                // `set = { m_tip = "2 kg" }`
                (None, None, DeValue::Table(table)) if is_set(spec, word) => {
                    let parts = entries(table).into_iter();
                    let parts: Vec<_> = parts.map(|(name, value)| (Some(name), value)).collect();
                    let mut field = draft(word, at, None);
                    match self.list(value.span().start, &parts) {
                        Some(value) => field.clauses.push((":", value)),
                        None => field.broken = true,
                    }
                    item.block.push(field);
                }
                (None, None, _) if spec.fields.is_none() => unknown.push((at, word)),
                (None, None, DeValue::Table(_))
                    if say_toml::keys_of(spec).all(|key| key != word) =>
                {
                    unknown.push((at, word));
                }
                (None, None, _) => {
                    let field = self.field(word, at, value);
                    item.block.push(field);
                }
            }
        }
        self.unit_behind(item, spec);
        self.unknown_keys(item, spec, &unknown);
    }

    /// Tells of keys that an item does not have. Where one that it needs is missing, that is what is told, unless a key was meant for it.
    fn unknown_keys(
        &mut self,
        item: &mut ItemDraft,
        spec: &'static ItemWord,
        unknown: &[(LexemeIndex, &str)],
    ) {
        let given = |sign: &str| item.clauses.iter().any(|(own, _)| *own == sign);
        let missing = spec.lacks(given).is_some();
        let known: Vec<&str> = say_toml::keys_of(spec).collect();
        for (at, word) in unknown {
            let meant = say_toml::meant(word, &known).is_some();
            if meant || !missing {
                let report = say_toml::unknown_key((*at).into(), word, &known);
                self.messages.push(report);
                item.broken = true;
            }
        }
    }

    /// The path of a file, which is no language.
    fn path(&mut self, path: &str, offset: usize) -> ValueLexemes {
        let position = self.lines.position(offset);
        let first = self.lexer.lexemes.len();
        let at = self
            .lexer
            .positioned(LexemeKind::Text(path.to_owned()), position);
        ValueLexemes {
            range: first..self.lexer.lexemes.len(),
            at,
        }
    }

    /// A field with a value.
    fn field(&mut self, word: &str, at: LexemeIndex, value: &Spanned<DeValue<'_>>) -> ItemDraft {
        let mut field = draft(word, at, None);
        match self.value(value) {
            Some(value) => field.clauses.push((":", value)),
            None => field.broken = true,
        }
        field
    }

    /// A string of documentation.
    fn doc(&mut self, value: &Spanned<DeValue<'_>>) -> String {
        match value.get_ref() {
            DeValue::String(text) => text.trim_end().to_string(),
            _ => {
                let at = self.mark(value.span().start);
                self.messages.push(say_toml::string(at.into()));
                String::new()
            }
        }
    }

    /// A key with its repetition.
    pub(super) fn key(&mut self, key: &Spanned<std::borrow::Cow<'_, str>>) -> ValueLexemes {
        let raw = self.text.get(key.span()).unwrap_or("");
        let quoted = raw.starts_with(['"', '\'']);
        let start = key.span().start + usize::from(quoted);
        self.piece(key.get_ref(), key.span().start, start, raw.contains('\\'))
    }

    /// The lexemes of a value.
    pub(super) fn value(&mut self, value: &Spanned<DeValue<'_>>) -> Option<ValueLexemes> {
        let span = value.span();
        let raw = self.text.get(span.clone()).unwrap_or("");
        match value.get_ref() {
            DeValue::String(text) => {
                let quotes = if raw.starts_with("\"\"\"") || raw.starts_with("'''") {
                    3
                } else {
                    1
                };
                let escaped = raw.starts_with('"') && raw.contains('\\');
                // A line break right after three quotes belongs to them.
                let body = raw.get(quotes..).unwrap_or("");
                let skipped = match (quotes, body.starts_with("\r\n"), body.starts_with('\n')) {
                    (3, true, _) => 2,
                    (3, _, true) => 1,
                    _ => 0,
                };
                Some(self.piece(text, span.start, span.start + quotes + skipped, escaped))
            }
            DeValue::Array(parts) if parts.iter().any(|part| part.get_ref().is_str()) => {
                let parts: Vec<_> = parts.iter().map(|part| (None, part)).collect();
                self.list(span.start, &parts)
            }
            DeValue::Integer(_) | DeValue::Float(_) | DeValue::Array(_) => {
                Some(self.piece(raw, span.start, span.start, false))
            }
            DeValue::Boolean(_) | DeValue::Datetime(_) | DeValue::Table(_) => {
                let at = self.mark(span.start);
                self.messages.push(say_toml::string(at.into()));
                None
            }
        }
    }

    /// Lexes a piece that lies at `start` of the document; an escaped one is placed at `begin` as a whole.
    fn piece(&mut self, text: &str, begin: usize, start: usize, escaped: bool) -> ValueLexemes {
        let at = self.mark(begin);
        let first = self.lexer.lexemes.len();
        let base = (!escaped).then_some(start);
        piece(&mut self.lexer, &self.lines, text, base, &mut self.messages);
        ValueLexemes {
            range: first..self.lexer.lexemes.len(),
            at,
        }
    }
}

fn draft(word: &str, at: LexemeIndex, spec: Option<&'static ItemWord>) -> ItemDraft {
    ItemDraft {
        doc: String::new(),
        word: Word {
            text: word.to_string(),
            at,
        },
        name: None,
        clauses: Vec::new(),
        block: Vec::new(),
        spec,
        marked: None,
        broken: false,
    }
}

impl ValueLexemes {
    fn value<'a>(&self, lexemes: &'a [Lexeme]) -> ValueSyntax<'a> {
        let lexemes = lexemes.get(self.range.clone()).unwrap_or(&[]);
        let at = match (lexemes.first(), lexemes.last()) {
            (Some(first), Some(last)) => Region {
                first: first.at,
                last: last.at,
            },
            _ => self.at.into(),
        };
        ValueSyntax { lexemes, at }
    }
}

impl Document {
    /// The model, once all lexemes are there.
    fn model<'a>(&self, lexemes: &'a [Lexeme], messages: &mut Messages) -> ModelSyntax<'a> {
        let mut read = ModelSyntax {
            doc: self.doc.clone(),
            ..ModelSyntax::default()
        };
        match &self.name {
            Some(piece) => {
                let mut cursor = Cursor::new(piece.value(lexemes));
                let name = model::name(&mut cursor, &mut read)
                    .and_then(|()| cursor.finish("the end of the name"));
                if let Err(report) = name {
                    messages.push(report);
                }
            }
            None if messages.is_empty() => messages.push(say_toml::no_model(Region::START)),
            None => {}
        }
        for draft in &self.items {
            let item = draft.item(lexemes, messages);
            read.items.push(item);
        }
        read
    }
}

impl ItemDraft {
    fn item<'a>(&self, lexemes: &'a [Lexeme], messages: &mut Messages) -> Item<'a> {
        let mut item = Item {
            doc: self.doc.clone(),
            marked: self.marked,
            word: self.word.clone(),
            name: None,
            clauses: Vec::new(),
            block: Vec::new(),
            at: self.word.at.into(),
            broken: false,
        };
        let mut reports = Vec::new();
        if let (Some(piece), Some(spec)) = (&self.name, self.spec) {
            let value = piece.value(lexemes);
            match name(value, spec) {
                Ok(name) => {
                    reports.extend(name.refused_index(spec));
                    item.name = Some(name);
                }
                Err(report) => reports.push(report),
            }
        }
        for (sign, piece) in &self.clauses {
            let value = piece.value(lexemes);
            reports.extend(push_clause(&mut item, sign, piece.at.into(), value).err());
        }
        let missing = self.spec.and_then(|spec| {
            let clause = spec.lacks(|sign| item.given(sign).is_some())?;
            Some((spec, clause))
        });
        if let (Some((spec, clause)), false) = (missing, self.broken) {
            // A key that was meant for it tells more.
            let mut fields = self.block.iter();
            let other = fields.find(|field| {
                field.spec.is_none() && say_toml::is_called(&field.word.text, clause.key)
            });
            let other = other.map(|field| field.word.text.as_str());
            reports.push(say_toml::missing(item.name_at(), spec, clause.key, other));
        }
        for field in &self.block {
            item.block.push(field.item(lexemes, messages));
        }
        item.broken =
            self.broken || !reports.is_empty() || item.block.iter().any(|field| field.broken);
        reports.into_iter().for_each(|report| messages.push(report));
        item
    }
}

/// A name from a key: `leg`, `leg[0]`, `leg[i in 0..3]`.
fn name<'a>(
    value: ValueSyntax<'a>,
    spec: &'static ItemWord,
) -> Result<NameSyntax<'a>, crate::messages::LexemeMessage> {
    let mut cursor = Cursor::new(value);
    let word = cursor.word().ok_or_else(|| say::no_name(value.at, spec))?;
    let index = cursor.group(crate::lexeme::Bracket::Square);
    cursor.finish("the end of the name")?;
    Ok(NameSyntax { word, index })
}
