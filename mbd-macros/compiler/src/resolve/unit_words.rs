//! Words of units that are names of values, too: `1.2 kg/m^3` beside a mass `m`, `1/s` where nothing is called `s`.

use std::collections::BTreeSet;

use mbd_scene::{Dimension, Unit};

use super::{Named, Resolver, Scope};
use crate::lexeme::Region;
use crate::messages::{LexemeMessage, resolve as say};
use crate::syntax::expression::Expression;
use crate::units;

/// What is known of words of units that are names, too.
#[derive(Clone, Debug, Default)]
pub struct UnitWords {
    /// Those that were told. Where such a name has another one, all is clear.
    told: BTreeSet<String>,
    /// Those that may be units.
    open: Vec<OpenWord>,
    /// Whether what is read is a value that is one number with its unit, or three.
    literal: bool,
}

/// A word that may be a unit.
#[derive(Clone, Debug)]
struct OpenWord {
    word: String,
    of_unit: Dimension,
    /// Where the number with the unit is.
    at: Region,
    /// Whether it is one only where the number fits what it stands for.
    has_to_fit: bool,
    note: String,
    report: LexemeMessage,
}

impl Resolver<'_> {
    /// Refuses a unit in whose product, brackets apart, stands the name of a value: `3 m * N` with a const `N`.
    ///
    /// It is the unit, and a note says so, if what has the name has a dimension, and another one, and the word stands below the line or is a
    /// power, `1.2 kg/m^3` beside a mass `m`, or the number is all of a value and has the dimension that is wanted there: `damping: 2 N*m*s`.
    pub fn unit_alone(&mut self, number: &str, unit: Option<&Unit>, at: Region) -> Option<()> {
        let text = unit.map_or("", |unit| unit.text.as_str());
        for (place, word) in open_words(text).into_iter().skip(1) {
            if !self.names.is(word, Named::is_value) {
                continue;
            }
            let of_unit = units::find(word).map_or(units::NONE, |(_, dimension)| dimension);
            let entry = self.names.get(word);
            let named = entry.and_then(|entry| entry.first());
            let kind = named.map_or("name", Named::kind);
            let declared = (kind, entry.map(|entry| entry.at));
            let report = say::unit_or_name(at, (number, text), place, word, declared);
            let below = text[..place].ends_with('/');
            let raised = text[place + word.len()..].starts_with('^');
            if below || raised || self.unit_words.literal {
                self.unit_words.open.push(OpenWord {
                    word: word.to_owned(),
                    of_unit,
                    at,
                    has_to_fit: !below && !raised,
                    note: format!("`{word}` in `{text}` is the unit, not the {kind} `{word}`"),
                    report,
                });
            } else {
                if self.unit_words.told.insert(word.to_owned()) {
                    self.messages.push(report);
                }
                return None;
            }
        }
        Some(())
    }

    /// Remembers whether a value is one number with its unit, or three.
    pub fn reads_literal(&mut self, parsed: &Expression) {
        let inner = match parsed {
            Expression::Negative(inner, _) => inner,
            parsed => parsed,
        };
        self.unit_words.literal =
            matches!(inner, Expression::Number { .. } | Expression::Vector { .. });
    }

    /// No value is being read.
    pub fn literal_is_read(&mut self) {
        self.unit_words.literal = false;
    }

    /// A value has the dimension that is wanted where it stands: words in its unit are units.
    pub fn unit_fits(&mut self, at: Region) {
        let open = self.unit_words.open.iter_mut();
        open.filter(|open| open.at.last == at.last)
            .for_each(|open| open.has_to_fit = false);
    }

    /// A value has not the dimension that is wanted: what to say if a word in its unit may be a name.
    pub fn unit_misfit(&mut self, at: Region) -> Option<LexemeMessage> {
        let mut open = self.unit_words.open.iter();
        let found = open.position(|open| open.has_to_fit && open.at.last == at.last)?;
        let open = self.unit_words.open.remove(found);
        self.unit_words.told.insert(open.word);
        Some(open.report)
    }

    /// Decides, once all values are known, of the words that may be units.
    pub fn open_unit_words(&mut self) {
        let mut noted = BTreeSet::new();
        for open in std::mem::take(&mut self.unit_words.open) {
            if !open.has_to_fit && self.differs(&open.word, open.of_unit) {
                if noted.insert(open.word) {
                    self.notes.push(open.note);
                }
            } else if self.unit_words.told.insert(open.word) {
                self.messages.push(open.report);
            }
        }
    }

    /// Whether what has this name has a dimension, and another one than a unit. What has a mistake of its own does.
    fn differs(&self, word: &str, of_unit: Dimension) -> bool {
        let named = self.names.get(word).and_then(|entry| entry.first());
        let scene = &self.scene;
        let unit = match named {
            Some(named) if self.bad.contains(&named) => return true,
            Some(Named::Const(index)) => scene.consts.get(index).map(|it| &it.unit),
            Some(Named::Param(index)) => scene.params.get(index).map(|it| &it.unit),
            Some(Named::Input(index)) => scene.inputs.get(index).map(|it| &it.unit),
            Some(Named::State(index)) => scene.states.get(index).map(|it| &it.unit),
            Some(Named::Let(index)) => scene.lets.get(index).map(|it| &it.unit),
            _ => None,
        };
        unit.is_some_and(|unit| ![units::NONE, of_unit].contains(&unit.dimension))
    }

    /// `1/s`, `-2 / s^2`, `1/(m*s)`: the number with its unit, where no word below the line is a name.
    pub fn reciprocal(
        &self,
        above: &Expression,
        below: &Expression,
        scope: Scope<'_>,
    ) -> Option<Expression> {
        match above {
            Expression::Negative(inner, at) => {
                let number = self.reciprocal(inner, below, scope)?;
                Some(Expression::Negative(Box::new(number), *at))
            }
            Expression::Number {
                value,
                text,
                unit: None,
                at,
                ..
            } => {
                let (below, place) = (self.unit_of_words(below, scope)?, below.at());
                let unit = Unit {
                    text: match below.text.contains(['*', '/']) {
                        true => format!("1/({})", below.text),
                        false => format!("1/{}", below.text),
                    },
                    factor: 1.0 / below.factor,
                    dimension: units::over(units::NONE, below.dimension)?,
                };
                Some(Expression::Number {
                    value: *value,
                    text: text.clone(),
                    unit: Some(unit),
                    at: at.to(place),
                })
            }
            _ => None,
        }
    }

    /// An expression of words of units alone that are no names.
    fn unit_of_words(&self, parsed: &Expression, scope: Scope<'_>) -> Option<Unit> {
        match parsed {
            Expression::Path(steps) => {
                let [step] = steps.as_slice() else {
                    return None;
                };
                let word = step.word.text.as_str();
                let index = scope.indices.iter().any(|(name, _)| name == word);
                let taken = self.names.get(word).is_some()
                    || self.later.contains(word)
                    || self.broken.contains(word);
                if step.index.is_some() || index || taken {
                    return None;
                }
                let (factor, dimension) = units::find(word)?;
                Some(Unit {
                    text: word.to_owned(),
                    factor,
                    dimension,
                })
            }
            Expression::Binary { sign: '^', sides } => {
                let base = self.unit_of_words(&sides[0], scope)?;
                let Expression::Number {
                    value, unit: None, ..
                } = &sides[1]
                else {
                    return None;
                };
                let whole = value.fract() == 0.0 && (1.0..=9.0).contains(value);
                let exponent = whole.then_some(*value as i32)?;
                Some(Unit {
                    text: format!("{}^{exponent}", base.text),
                    factor: base.factor.powi(exponent),
                    dimension: units::power(base.dimension, exponent)?,
                })
            }
            Expression::Binary { sign: '*', sides } => {
                let first = self.unit_of_words(&sides[0], scope)?;
                let second = self.unit_of_words(&sides[1], scope)?;
                Some(Unit {
                    text: format!("{}*{}", first.text, second.text),
                    factor: first.factor * second.factor,
                    dimension: units::times(first.dimension, second.dimension)?,
                })
            }
            _ => None,
        }
    }
}

/// The words of a unit outside brackets, each with its place.
fn open_words(unit: &str) -> Vec<(usize, &str)> {
    let (mut depth, mut begin, mut words) = (0, None, Vec::new());
    for (place, c) in unit.char_indices() {
        depth += i32::from(c == '(') - i32::from(c == ')');
        match (depth == 0 && c.is_ascii_alphabetic(), begin) {
            (true, None) => begin = Some(place),
            (false, Some(first)) => {
                words.push((first, &unit[first..place]));
                begin = None;
            }
            _ => {}
        }
    }
    words.extend(begin.map(|first| (first, &unit[first..])));
    words
}
