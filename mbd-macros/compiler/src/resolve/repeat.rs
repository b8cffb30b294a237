//! Repetition: what stands in the brackets of a declared name, and the names it makes.

use super::collect::MOST;
use super::{MayDependOn, Resolver, Scope};
use crate::lexeme::LexemeKind;
use crate::messages::{resolve as say, syntax as say_syntax};
use crate::syntax::{Cursor, NameSyntax, ValueSyntax, expression, words};

/// One instance of a name: its index, its label, and the index of the repetition with its value.
pub(super) type Labelled = (Option<i64>, String, Option<(String, i64)>);

/// What the index in the brackets of a name says.
enum Index {
    /// No brackets.
    None,
    /// `[0]`
    One(i64),
    /// `[i in 0..3]`
    Range(String, i64, i64),
}

impl Resolver<'_> {
    /// Index, label and the value of the repetition, for every instance of a name; `outer`: the repetition around it. None after a mistake.
    pub(super) fn expand(
        &mut self,
        name: &NameSyntax<'_>,
        outer: &[(String, i64)],
    ) -> Option<Vec<Labelled>> {
        let word = &name.word.text;
        let Some(index) = self.index(name, outer) else {
            self.whole = false;
            // A frame is lost on its own body only.
            if outer.is_empty() {
                self.broken.insert(word.clone());
            }
            return None;
        };
        Some(match index {
            Index::None => vec![(None, word.clone(), None)],
            Index::One(i) => vec![(Some(i), format!("{word}[{i}]"), None)],
            Index::Range(variable, first, end) => (first..end)
                .map(|i| (Some(i), format!("{word}[{i}]"), Some((variable.clone(), i))))
                .collect(),
        })
    }

    fn index(&mut self, name: &NameSyntax<'_>, outer: &[(String, i64)]) -> Option<Index> {
        let Some(value) = name.index else {
            return Some(Index::None);
        };
        let mut cursor = Cursor::new(value);
        let repeated = matches!(cursor.ahead(1).map(|l| &l.kind), Some(LexemeKind::Word(word)) if word == "in");
        if !repeated {
            return self.constant_index(value, outer).map(Index::One);
        }
        let Some(variable) = cursor.word() else {
            let (at, found) = (cursor.here(), cursor.peek().map(|lexeme| lexeme.shown()));
            let name = &name.word.text;
            return self.fail(say_syntax::no_index_name(
                at,
                name,
                &found.unwrap_or_default(),
            ));
        };
        if words::reserved(&variable.text).is_some() || self.names.get(&variable.text).is_some() {
            return self.fail(say_syntax::reserved_name(
                variable.at.into(),
                &variable.text,
            ));
        }
        if outer.iter().any(|(taken, _)| *taken == variable.text) {
            return self.fail(say::index_twice(variable.at.into(), &variable.text));
        }
        cursor.keyword("in")?;
        let (first, end) = self.bounds(cursor, value, outer)?;
        let count = end.saturating_sub(first);
        // `1..N` with N = 1 declares nothing; an end below its start is a slip.
        if count < 0 {
            return self.fail(say::reversed_repetition(value.at));
        }
        let found =
            usize::try_from(count).map_or(usize::MAX, |count| count.saturating_add(self.size()));
        if found > MOST {
            return self.fail(say::too_many(value.at, MOST, found));
        }
        Some(Index::Range(variable.text, first, end))
    }

    /// `0..3` or `0..=2`: first and one past the last.
    fn bounds(
        &mut self,
        mut cursor: Cursor<'_>,
        whole: ValueSyntax<'_>,
        outer: &[(String, i64)],
    ) -> Option<(i64, i64)> {
        let scope = Scope {
            stage: MayDependOn::Constant,
            indices: outer,
        };
        let first = match expression::prefix(&mut cursor) {
            Ok(first) => self.whole_number(&first, scope)?,
            Err(report) => return self.fail(report),
        };
        let inclusive = cursor.signs("..=").is_some();
        if !inclusive && cursor.signs("..").is_none() {
            return self.fail(say_syntax::range(whole.at));
        }
        let last = match expression::prefix(&mut cursor) {
            Ok(last) => self.whole_number(&last, scope)?,
            Err(report) => return self.fail(report),
        };
        if cursor.sign(',').is_some() {
            return self.fail(say_syntax::one_index(whole.at));
        }
        if let Err(report) = cursor.finish("`]`") {
            return self.fail(report);
        }
        Some((first, last.saturating_add(i64::from(inclusive))))
    }

    fn constant_index(&mut self, value: ValueSyntax<'_>, outer: &[(String, i64)]) -> Option<i64> {
        if value.lexemes.is_empty() {
            return self.fail(say_syntax::range(value.at));
        }
        let scope = Scope {
            stage: MayDependOn::Constant,
            indices: outer,
        };
        match expression::whole(value) {
            Ok(parsed) => self.whole_number(&parsed, scope),
            Err(_) => self.fail(say_syntax::range(value.at)),
        }
    }
}
