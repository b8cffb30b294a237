//! Other forms in which people write values in TOML: lists of strings, tables of what is set, a unit in one string with its value.

use std::borrow::Cow;

use mbd_scene::metrics::Take;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::declaration::entries;
use super::read::{ItemDraft, TomlReader, ValueLexemes};
use crate::lexeme::{Bracket, LexemeKind};
use crate::number::{read_number, read_vector};
use crate::syntax::words::ItemWord;

/// A value of a list, with its name if it has one.
pub(super) type NamedValue<'e, 't> = (Option<&'e Spanned<Cow<'t, str>>>, &'e Spanned<DeValue<'t>>);

/// Whether a key says what a metric takes: `max = "cord.tension"`, as in a campaign.
pub(super) fn is_taken(spec: &ItemWord, key: &str) -> bool {
    let clause = spec.clauses.iter().any(|clause| clause.key == key);
    spec.word == "metric" && !clause && Take::of(key).is_some()
}

/// Whether a key may have a table of what gets which value: `set = { m_tip = "2 kg" }`.
pub(super) fn is_set(spec: &ItemWord, key: &str) -> bool {
    spec.word == "event" && ["set", "map"].contains(&key)
}

/// The law of gravity that has a table of its own, `[gravity.point_mass]`, and that table.
pub(super) fn only_law<'e, 't>(
    spec: &ItemWord,
    table: &'e DeTable<'t>,
) -> Option<(&'e Spanned<Cow<'t, str>>, &'e DeTable<'t>)> {
    let (name, value) = table.iter().next()?;
    match value.get_ref() {
        DeValue::Table(fields) if spec.word == "gravity" && table.len() == 1 => {
            Some((name, fields))
        }
        _ => None,
    }
}

impl TomlReader<'_> {
    /// The lexemes of `name { key: value, other: value }` from a table of its fields.
    pub(super) fn law(
        &mut self,
        start: usize,
        name: &Spanned<Cow<'_, str>>,
        fields: &DeTable<'_>,
    ) -> Option<ValueLexemes> {
        let place = self.lines.position(start);
        let word = self.key(name);
        self.lexer
            .positioned(LexemeKind::Open(Bracket::Brace, 0), place);
        let mut read = true;
        for (key, value) in entries(fields) {
            let place = self.lines.position(value.span().start);
            self.key(key);
            self.lexer.positioned(LexemeKind::Sign(':'), place);
            read &= self.value(value).is_some();
            self.lexer.positioned(LexemeKind::Sign(','), place);
        }
        self.lexer
            .positioned(LexemeKind::Close(Bracket::Brace), place);
        read.then_some(ValueLexemes {
            range: word.range.start..self.lexer.lexemes.len(),
            at: word.at,
        })
    }

    /// The lexemes of `[a, b]`, or of `[name = a, other = b]`, from values that stand apart.
    pub(super) fn list(
        &mut self,
        start: usize,
        parts: &[NamedValue<'_, '_>],
    ) -> Option<ValueLexemes> {
        let place = self.lines.position(start);
        let at = self.mark(start);
        let first = self.lexer.lexemes.len();
        self.lexer
            .positioned(LexemeKind::Open(Bracket::Square, 0), place);
        let mut read = true;
        for (index, (name, part)) in parts.iter().enumerate() {
            let place = self.lines.position(part.span().start);
            if index > 0 {
                self.lexer.positioned(LexemeKind::Sign(','), place);
            }
            if let Some(name) = name {
                self.key(name);
                self.lexer.positioned(LexemeKind::Sign('='), place);
            }
            read &= self.value(part).is_some();
        }
        self.lexer
            .positioned(LexemeKind::Close(Bracket::Square), place);
        read.then_some(ValueLexemes {
            range: first..self.lexer.lexemes.len(),
            at,
        })
    }

    /// Takes `in kN` behind a value for the clause that it is: `"max cord.tension in kN"`.
    pub(super) fn unit_behind(&self, item: &mut ItemDraft, spec: &'static ItemWord) {
        const IN: &str = "in";
        let has = spec.clauses.iter().find(|clause| clause.sign == IN);
        let given = item.clauses.iter().any(|(sign, _)| *sign == IN);
        let value = item.clauses.iter_mut().find(|(sign, _)| *sign == "=");
        let (Some(clause), false, Some((_, value))) = (has, given, value) else {
            return;
        };
        let mut next = value.range.start;
        while let Some(lexeme) = self
            .lexer
            .lexemes
            .get(next)
            .filter(|_| next < value.range.end)
        {
            match &lexeme.kind {
                LexemeKind::Word(word) if word == IN => {
                    let unit = ValueLexemes {
                        range: next + 1..value.range.end,
                        at: lexeme.at,
                    };
                    value.range.end = next;
                    item.clauses.push((clause.sign, unit));
                    return;
                }
                LexemeKind::Open(_, distance) => next += (*distance).max(1),
                _ => next += 1,
            }
        }
    }
}

/// Key and value on the line of a place where TOML could not go on, if the value is a number with its unit.
pub(super) fn unquoted(text: &str, offset: usize) -> Option<(&str, &str)> {
    let begin = text.get(..offset)?.rfind('\n').map_or(0, |end| end + 1);
    let (key, value) = text.get(begin..)?.lines().next()?.split_once('=')?;
    let value = value.split('#').next()?.trim();
    let read = read_number(value).is_ok() || read_vector(value).is_ok();
    read.then_some((key.trim(), value))
}
