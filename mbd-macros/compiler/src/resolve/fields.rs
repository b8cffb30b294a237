//! Fields between braces: which are known, which are given, what they hold.

use mbd_scene::{Dimension, Formula};

use super::{Resolver, Scope, fold};
use crate::lexeme::Region;
use crate::messages::{resolve as say, syntax as say_syntax};
use crate::syntax::{Item, ValueSyntax, foreign};

/// The fields of an item: each at most once.
#[derive(Debug)]
pub struct ItemFields<'i, 'a> {
    given: Vec<(&'i str, &'i Item<'a>)>,
    /// Whether something in the braces was not understood: what seems missing may be that.
    pub doubtful: bool,
}

impl<'i, 'a> ItemFields<'i, 'a> {
    /// A field, if it is given.
    pub fn get(&self, word: &str) -> Option<&'i Item<'a>> {
        self.given
            .iter()
            .find(|(known, _)| *known == word)
            .map(|(_, item)| *item)
    }

    /// The value of a field.
    pub fn value(&self, word: &str) -> Option<ValueSyntax<'a>> {
        self.get(word)?.clause(":")
    }
}

/// Which values of a number make sense.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Accept {
    /// > 0
    Positive,
    /// ≥ 0
    NotNegative,
}

impl Resolver<'_> {
    /// Sorts the fields of an item; unknown and repeated ones are errors.
    pub fn fields<'i, 'a>(&mut self, block: &'i [Item<'a>], known: &[&str]) -> ItemFields<'i, 'a> {
        let mut fields = ItemFields {
            given: Vec::new(),
            doubtful: false,
        };
        for item in block {
            let word = item.word.text.as_str();
            let at = Region::from(item.word.at);
            let placed = word == "start" && item.clause(":").is_none();
            if placed && known.contains(&word) {
                fields.doubtful |= item.broken;
            } else if word == "frame" && known.contains(&word) {
                fields.doubtful |= item.broken && item.name.is_none();
            } else if item.broken {
                fields.doubtful = true;
            } else if !known.contains(&word) {
                self.messages.push(say::unknown_field(at, word, known));
                fields.doubtful = true;
            } else if let Some(first) = fields.get(word) {
                let first = Region::from(first.word.at);
                self.messages
                    .push(say_syntax::repeated_clause(at, word, first));
            } else {
                fields.given.push((word, item));
            }
        }
        fields
    }

    /// A scalar field of a known dimension; checked for its sign with all params at their defaults.
    pub fn quantity(
        &mut self,
        owner: &str,
        field: &str,
        value: ValueSyntax<'_>,
        wanted: Dimension,
        accept: Accept,
        scope: Scope<'_>,
    ) -> Option<Formula> {
        self.instead = foreign::translated(foreign::NOT_CHANGING, field);
        let typed = self.value(value, scope);
        self.instead = None;
        let typed = typed?;
        let at = typed.at;
        let formula = self.fits(typed, field, false, wanted)?;
        if let Formula::Param(param) = formula
            && let Some(param) = self.scene.params.get(param)
            && let Some([low, _]) = param.range.filter(|[low, _]| *low < 0.0)
        {
            let name = param.name.clone();
            return self.fail(say::range_of_sign(at, (owner, field), &name, low, wanted));
        }
        let found = fold::at_defaults(&formula, &self.scene);
        let wrong = found.is_some_and(|x| {
            !x.is_finite()
                || match accept {
                    Accept::Positive => x <= 0.0,
                    Accept::NotNegative => x < 0.0,
                }
        });
        if wrong {
            let (found, positive) = (found.unwrap_or(f64::NAN), accept == Accept::Positive);
            return self.fail(say::sign(at, owner, field, found, wanted, positive));
        }
        Some(formula)
    }

    /// A vector field of a known dimension, in components.
    pub fn triple(
        &mut self,
        field: &str,
        value: ValueSyntax<'_>,
        wanted: Dimension,
        scope: Scope<'_>,
    ) -> Option<[Formula; 3]> {
        let typed = self.value(value, scope)?;
        let formula = self.fits(typed, field, true, wanted)?;
        Some(fold::components(formula, &self.scene))
    }
}
