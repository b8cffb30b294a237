//! What the parser says of single lexemes: which begin a clause, which are a unit, which index a name.

use mbd_scene::solids::Solid;

use crate::lexeme::{Bracket, Lexeme, LexemeKind, Region};
use crate::syntax::{Cursor, Item, ModelSyntax, ValueSyntax, unit, words};
use crate::units;

/// What a lexeme is to the lexemes beside it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mark {
    /// Nothing else than its kind says.
    #[default]
    Plain,
    /// A word or sign in front of a value, which is no part of that value: `from`, `=`, `at`.
    Before,
    /// The bracket of an index or of a repetition.
    Index,
    /// The first lexeme of a unit.
    Unit,
    /// A later lexeme of a unit.
    InUnit,
    /// `<T>` behind the name of the model.
    Scalar,
    /// A sign of the range of a repetition.
    Range,
}

/// The mark of every lexeme.
pub fn marks(lexemes: &[Lexeme], model: &ModelSyntax<'_>) -> Vec<Mark> {
    let mut marks = Marks {
        lexemes,
        of: vec![Mark::Plain; lexemes.len()],
    };
    marks.head(model);
    marks.items(&model.items, false);
    marks.units();
    marks.of
}

struct Marks<'a> {
    lexemes: &'a [Lexeme],
    of: Vec<Mark>,
}

impl Marks<'_> {
    fn set(&mut self, at: usize, mark: Mark) {
        if let Some(known) = self.of.get_mut(at) {
            *known = mark;
        }
    }

    fn kind(&self, at: usize) -> Option<&LexemeKind> {
        self.lexemes.get(at).map(|lexeme| &lexeme.kind)
    }

    fn word(&self, at: usize) -> Option<&str> {
        match self.kind(at) {
            Some(LexemeKind::Word(word)) => Some(word),
            _ => None,
        }
    }

    fn head(&mut self, model: &ModelSyntax<'_>) {
        if let (Some(name), true) = (&model.name, model.generic) {
            let at = name.at.index();
            (at + 1..=at + 3).for_each(|at| self.set(at, Mark::Scalar));
        }
    }

    fn items(&mut self, items: &[Item<'_>], inside: bool) {
        for item in items {
            if let Some(index) = item.name.as_ref().and_then(|name| name.index) {
                self.each(index.at, |marks, at| {
                    let sign = matches!(marks.kind(at), Some(LexemeKind::Sign('.' | '=')));
                    sign.then_some(Mark::Range)
                });
                self.set(index.at.first.index(), Mark::Index);
            }
            let spec = words::find(&item.word.text, inside);
            for given in &item.clauses {
                self.each(given.at, |_, _| Some(Mark::Before));
                let mut clauses = spec.iter().flat_map(|spec| spec.clauses);
                let is_kind = clauses.any(|known| known.sign == given.sign && known.key == "kind");
                if let (true, Some(first)) = (is_kind, given.value.lexemes.first()) {
                    // `m/s`, or `[m/s; 3]`.
                    let first = first.at.index();
                    let bracket = matches!(self.kind(first), Some(LexemeKind::Open(..)));
                    self.unit(first + usize::from(bracket));
                }
                let is_shape = item.word.text == "shape";
                self.each(given.value.at, |marks, at| marks.in_value(at, is_shape));
            }
            self.items(&item.block, true);
        }
    }

    fn each(&mut self, region: Region, mark: impl Fn(&Self, usize) -> Option<Mark>) {
        for at in region.first.index()..=region.last.index() {
            if let Some(mark) = mark(self, at) {
                self.set(at, mark);
            }
        }
    }

    /// Words inside a value that are no names.
    fn in_value(&self, at: usize, is_shape: bool) -> Option<Mark> {
        let word = self.word(at)?;
        let member = at > 0 && self.kind(at - 1) == Some(&LexemeKind::Sign('.'));
        let solid = is_shape && Solid::ALL.iter().any(|solid| solid.keyword() == word);
        let before = solid || ["at", "rotated", "else"].contains(&word);
        (before && !member).then_some(Mark::Before)
    }

    /// The units behind numbers, behind brackets and behind `in`.
    fn units(&mut self) {
        for at in 0..self.lexemes.len() {
            let before = match self.kind(at) {
                Some(LexemeKind::Number(_) | LexemeKind::Close(_)) => true,
                Some(LexemeKind::Word(word)) => word == "in" || word == "else",
                _ => false,
            };
            match (before, self.word(at)) {
                (true, Some("in")) => {
                    self.set(at, Mark::Before);
                    self.unit(at + 1);
                }
                (true, Some("else")) => self.set(at, Mark::Before),
                (true, None) if self.of.get(at) != Some(&Mark::InUnit) => self.unit(at + 1),
                _ => {}
            }
        }
    }

    /// Marks the unit that begins there, if one does.
    fn unit(&mut self, first: usize) {
        let begins = match (self.kind(first), self.kind(first + 1)) {
            (Some(LexemeKind::Word(word)), _) => units::find(word).is_some(),
            (Some(LexemeKind::Number(one)), Some(LexemeKind::Sign('/'))) => one == "1",
            // `2 (kN/m)`
            (Some(LexemeKind::Open(Bracket::Round, _)), _) => true,
            _ => false,
        };
        let Some(lexemes) = self.lexemes.get(first..).filter(|_| begins) else {
            return;
        };
        // A closing bracket of what is around ends the unit.
        let mut depth = 0usize;
        let end = lexemes.iter().position(|lexeme| match lexeme.kind {
            LexemeKind::Open(..) => {
                depth += 1;
                false
            }
            LexemeKind::Close(_) if depth == 0 => true,
            LexemeKind::Close(_) => {
                depth -= 1;
                false
            }
            _ => false,
        });
        let lexemes = &lexemes[..end.unwrap_or(lexemes.len())];
        let at = lexemes
            .first()
            .map_or(Region::START, |first| first.at.into());
        let start = Cursor::new(ValueSyntax { lexemes, at });
        let mut cursor = start;
        if let Ok(Some(_)) = unit::suffix(&mut cursor) {
            let length = cursor.since(start).lexemes.len();
            self.set(first, Mark::Unit);
            (first + 1..first + length).for_each(|at| self.set(at, Mark::InUnit));
        }
    }
}

/// Whether a lexeme opens this bracket.
pub fn opens(kind: &LexemeKind, bracket: Bracket) -> bool {
    matches!(kind, LexemeKind::Open(found, _) if *found == bracket)
}
