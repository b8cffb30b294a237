//! Words of units that are names of values, too: `1.2 kg/m^3` beside a mass `m`, `1/s` where nothing is called `s`.

use std::collections::BTreeSet;

use mbd_scene::{Dimension, Unit};

use super::{Named, Resolver, Scope, Typed};
use crate::lexeme::Region;
use crate::messages::{LexemeMessage, resolve as say};
use crate::number::read_number;
use crate::syntax::Word;
use crate::syntax::expression::{Expression, PathStep};
use crate::units;

/// What is known of words of units that are names, too.
#[derive(Clone, Debug, Default)]
pub struct UnitWords {
    /// Those that were told. Where such a name has another one, all is clear.
    told: BTreeSet<String>,
    /// Those that may be units.
    open: Vec<OpenWord>,
    /// The value that is being read, if its dimension tells what such a word is: values are counted, as a `let` is read inside another.
    value: Option<usize>,
    /// How many values were read.
    values: usize,
    /// Consts whose numbers are not known yet: nothing is read with them.
    pub waiting: BTreeSet<usize>,
    /// Values as they are with words of their units as names, each with its place.
    by_name: Vec<(Region, Typed)>,
}

/// A word that may be a unit.
#[derive(Clone, Debug)]
struct OpenWord {
    word: String,
    of_unit: Dimension,
    /// The dimension of the whole unit.
    whole: Dimension,
    /// Where the number with the unit is.
    at: Region,
    /// The value it stands in, if that is told by its dimension.
    value: Option<usize>,
    /// Whether it is one only where the number fits what it stands for.
    has_to_fit: bool,
    /// It is a power: `s^2`.
    raised: bool,
    /// The name is that of the index of a repetition: a pure number.
    index: bool,
    /// Whether the number fits what is wanted where it stands, and whether it does with the name, too.
    fits: bool,
    fits_by_name: bool,
    /// Whether all of the value it stands in is a quantity that has a name only with the name: `3 N*m / J` beside an inertia `J`.
    quantity_by_name: bool,
    note: String,
    report: LexemeMessage,
}

impl UnitWords {
    /// Takes out words that may be units.
    fn taken(&mut self, which: impl Fn(&OpenWord) -> bool) -> Vec<OpenWord> {
        self.open.extract_if(.., |open| which(open)).collect()
    }
}

impl Resolver<'_> {
    /// Refuses a unit in whose product, brackets apart, stands the name of a value: `3 m * N` with a const `N`.
    ///
    /// It is the unit, and a note says so, if what has the name has a dimension, and another one, and the word stands below the line or is a
    /// power, `1.2 kg/m^3` beside a mass `m`, or the value has the dimension that is wanted there: `damping: 2 N*m*s`, `force: -2 N*m * pin.angle`; where
    /// none is wanted, if the number with the unit is a quantity that has a name, and with the value is none: `20 N*m` is a torque beside a mass `m`.
    /// Nor is it the unit below the line where none is wanted and only the name makes a quantity of the value: `3 N*m / J` beside an inertia `J`.
    /// Beside a pure number, as an index of a repetition is one, the dimension that is wanted decides alone.
    pub fn unit_alone(
        &mut self,
        number: &str,
        unit: Option<&Unit>,
        at: Region,
        scope: Scope<'_>,
    ) -> Option<()> {
        let text = unit.map_or("", |unit| unit.text.as_str());
        for (place, word) in open_words(text).into_iter().skip(1) {
            if !self.is_name_of_a_value(word, scope) {
                continue;
            }
            let index = is_index(word, scope);
            let of_unit = units::find(word).map_or(units::NONE, |(_, dimension)| dimension);
            let entry = self.names.get(word);
            let named = entry.and_then(|entry| entry.first());
            let kind = match index {
                true => "index",
                false => named.map_or("name", Named::kind),
            };
            let declared = (kind, entry.map(|entry| entry.at));
            let report = say::unit_or_name(at, (number, text), place, word, declared);
            let below = text[..place].ends_with('/');
            let raised = text[place + word.len()..].starts_with('^');
            let open = OpenWord {
                word: word.to_owned(),
                of_unit,
                whole: unit.map_or(units::NONE, |unit| unit.dimension),
                at,
                value: self.unit_words.value,
                has_to_fit: !below && !raised,
                raised,
                index,
                fits: false,
                fits_by_name: false,
                quantity_by_name: false,
                note: format!("`{word}` in `{text}` is the unit, not the {kind} `{word}`"),
                report,
            };
            if below || raised || self.unit_words.value.is_some() || self.is_a_quantity(&open) {
                self.unit_words.open.push(open);
            } else {
                if self.unit_words.told.insert(open.word) {
                    self.messages.push(open.report);
                }
                return None;
            }
        }
        Some(())
    }

    /// Reads a value. Where a word of a unit in it is a name, too, `9.81 m/s^2 * m` beside a mass `m`, it is read both ways, and the dimension that is
    /// wanted decides ([`reading`](Self::reading)); of two ways of which one fits together at all, that one is it.
    pub fn read_either_way(&mut self, parsed: &Expression, scope: Scope<'_>) -> Option<Typed> {
        let before = (self.messages.count(), self.bad.len());
        self.unit_words.values += 1;
        let value = Some(self.unit_words.values);
        let outer = std::mem::replace(&mut self.unit_words.value, value);
        let typed = self.typed(parsed, scope);
        self.unit_words.value = outer;
        let mut open = self.unit_words.open.iter();
        if !open.any(|open| open.value == value) {
            return typed;
        }
        let other = self.read_by_name(parsed, scope);
        match (typed, other) {
            (Some(typed), other) => {
                let by_name = other.as_ref().and_then(|other| other.dimension);
                let quantity_by_name = by_name.is_some_and(has_dimension_and_name)
                    && !typed.dimension.is_none_or(has_dimension_and_name);
                let open = self.unit_words.open.iter_mut();
                open.filter(|open| open.value == value).for_each(|open| {
                    (open.at, open.quantity_by_name) = (typed.at, quantity_by_name);
                });
                let other = other.map(|other| (typed.at, other));
                self.unit_words.by_name.extend(other);
                Some(typed)
            }
            (None, Some(other)) => {
                let (said, bad) = before;
                if bad == self.bad.len() {
                    self.messages.forget_after(said);
                }
                self.are_names(|open| open.value == value);
                Some(other)
            }
            (None, None) => {
                for open in self.unit_words.taken(|open| open.value == value) {
                    if self.too_early.is_none() && self.unit_words.told.insert(open.word) {
                        self.messages.push(open.report);
                    }
                }
                None
            }
        }
    }

    /// The value with words of its units as names, if it fits together so. What does not is told nowhere.
    fn read_by_name(&mut self, parsed: &Expression, scope: Scope<'_>) -> Option<Typed> {
        let by_name = self.by_name(parsed, scope)?;
        let (said, bad) = (self.messages.count(), self.bad.len());
        let outer = self.unit_words.value.take();
        let typed = self.typed(&by_name, scope);
        self.unit_words.value = outer;
        if bad == self.bad.len() {
            self.messages.forget_after(said);
        }
        typed
    }

    /// A value as it is where one of these dimensions is wanted: with words of its units as units, or as names where it fits only so.
    pub fn reading(&mut self, typed: Typed, wanted: &[Dimension]) -> Typed {
        let mut others = self.unit_words.by_name.iter();
        let Some(found) = others.rposition(|(at, _)| *at == typed.at) else {
            return typed;
        };
        let (at, other) = self.unit_words.by_name.remove(found);
        let fits = |read: &Typed| read.dimension.is_none_or(|it| wanted.contains(&it));
        if fits(&typed) || !fits(&other) {
            let open = self.unit_words.open.iter_mut();
            let open = open.filter(|open| open.at == at);
            open.for_each(|open| open.fits_by_name |= fits(&other));
            return typed;
        }
        self.are_names(|open| open.at == at);
        other
    }

    /// The same where dimensions may be wanted; where they are, words in units are units if the value has one of them.
    pub fn reading_as(&mut self, typed: Typed, wanted: &[Dimension]) -> Typed {
        if wanted.is_empty() {
            return typed;
        }
        let typed = self.reading(typed, wanted);
        if typed.dimension.is_none_or(|found| wanted.contains(&found)) {
            self.unit_fits(typed.at);
        }
        typed
    }

    /// These words are names.
    fn are_names(&mut self, which: impl Fn(&OpenWord) -> bool) {
        for open in self.unit_words.taken(which) {
            let note = format!(
                "`{}` behind a number is the name here, not the unit",
                open.word
            );
            if !self.notes.contains(&note) {
                self.notes.push(note);
            }
        }
    }

    /// An expression in which words of units are the names that they are, too, from the first such word on. `None` where that is no product with names.
    fn by_name(&self, parsed: &Expression, scope: Scope<'_>) -> Option<Expression> {
        let both = |sides: &[Expression; 2]| {
            Some(Box::new([
                self.by_name(&sides[0], scope)?,
                self.by_name(&sides[1], scope)?,
            ]))
        };
        let all = |parts: &[Expression]| -> Option<Vec<Expression>> {
            parts.iter().map(|part| self.by_name(part, scope)).collect()
        };
        Some(match parsed {
            Expression::Number {
                value,
                text,
                unit: Some(unit),
                at,
            } if let Some(place) = self.first_name(unit, scope) => {
                let number = |unit| Expression::Number {
                    value: *value,
                    text: text.clone(),
                    unit,
                    at: *at,
                };
                self.times_names(unit, place, *at, number, scope)?
            }
            Expression::Vector {
                parts,
                unit: Some(unit),
                at,
            } if let Some(place) = self.first_name(unit, scope) => {
                let vector = |unit| Expression::Vector {
                    parts: parts.clone(),
                    unit,
                    at: *at,
                };
                self.times_names(unit, place, *at, vector, scope)?
            }
            Expression::Number { .. } | Expression::Path(_) => parsed.clone(),
            Expression::Vector { parts, unit, at } => Expression::Vector {
                parts: all(parts)?,
                unit: unit.clone(),
                at: *at,
            },
            Expression::Call {
                name,
                arguments,
                at,
            } => Expression::Call {
                name: name.clone(),
                arguments: all(arguments)?,
                at: *at,
            },
            Expression::Component { of, axis } => Expression::Component {
                of: Box::new(self.by_name(of, scope)?),
                axis: axis.clone(),
            },
            Expression::Compare { sign, sides } => Expression::Compare {
                sign,
                sides: both(sides)?,
            },
            Expression::Negative(inner, at) => {
                Expression::Negative(Box::new(self.by_name(inner, scope)?), *at)
            }
            Expression::Binary { sign, sides } => {
                // `a / 2 m * N` divides by 2 m alone, if `N` is a name.
                let divides = ['/', '%', '^'].contains(sign);
                if let (
                    true,
                    Expression::Number {
                        unit: Some(unit), ..
                    },
                ) = (divides, &sides[1])
                    && self.first_name(unit, scope).is_some()
                {
                    return None;
                }
                Expression::Binary {
                    sign: *sign,
                    sides: both(sides)?,
                }
            }
        })
    }

    /// Where in a unit the first word stands that is the name of a value, behind the first word.
    fn first_name(&self, unit: &Unit, scope: Scope<'_>) -> Option<usize> {
        let words = open_words(&unit.text).into_iter().skip(1);
        let mut names = words.filter(|(_, word)| self.is_name_of_a_value(word, scope));
        names.next().map(|(place, _)| place)
    }

    /// Whether a word is the name of a value, or of the index of a repetition.
    fn is_name_of_a_value(&self, word: &str, scope: Scope<'_>) -> bool {
        is_index(word, scope) || self.names.is(word, Named::is_value)
    }

    /// `3 N*m/s` with the first word as unit and the others as names: `(3 N) * m / s`.
    fn times_names(
        &self,
        unit: &Unit,
        place: usize,
        at: Region,
        number: impl Fn(Option<Unit>) -> Expression,
        scope: Scope<'_>,
    ) -> Option<Expression> {
        let (before, names) = unit.text.split_at(place);
        let before = before.trim_end_matches(['*', '/']);
        let (_, before) = read_number(&format!("1 {before}")).ok()?;
        let mut product = number(Some(before));
        let mut sign = unit.text.get(..place)?.chars().next_back()?;
        for part in names.split_inclusive(['*', '/']) {
            let word = part.trim_end_matches(['*', '/']);
            let (word, exponent) = word.split_once('^').unwrap_or((word, "1"));
            let waits =
                |named| matches!(named, Named::Const(it) if self.unit_words.waiting.contains(&it));
            if !self.is_name_of_a_value(word, scope) || self.names.is(word, waits) {
                return None;
            }
            let step = PathStep {
                word: Word {
                    text: word.to_owned(),
                    at: at.last,
                },
                index: None,
            };
            let name = Expression::Path(vec![step]);
            let power = match exponent {
                "1" => name,
                exponent => {
                    let exponent = Expression::Number {
                        value: exponent.parse().ok()?,
                        text: exponent.to_owned(),
                        unit: None,
                        at,
                    };
                    Expression::Binary {
                        sign: '^',
                        sides: Box::new([name, exponent]),
                    }
                }
            };
            product = Expression::Binary {
                sign,
                sides: Box::new([product, power]),
            };
            sign = part.chars().next_back()?;
        }
        Some(product)
    }

    /// A value has the dimension that is wanted where it stands: words in its unit are units.
    pub fn unit_fits(&mut self, at: Region) {
        let open = self.unit_words.open.iter_mut();
        open.filter(|open| open.at.last == at.last)
            .for_each(|open| (open.has_to_fit, open.fits) = (false, true));
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
            let is_unit = match open.has_to_fit {
                true => self.is_a_quantity(&open),
                false => open.fits || !open.quantity_by_name,
            };
            let differs = self.differs(&open.word, open.of_unit);
            if is_unit && (differs || self.is_unit_beside_a_number(&open)) {
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
        match named {
            Some(named) if self.bad.contains(&named) => true,
            Some(named) => {
                let unit = self.unit_of(named);
                unit.is_some_and(|unit| ![units::NONE, of_unit].contains(&unit.dimension))
            }
            None => false,
        }
    }

    /// Whether a word that is the name of a pure number, too, is the unit: the value has the dimension that is wanted, and none with the number in
    /// place of the unit, or a power makes it a quantity that has a name, `9.81 m/s^2`.
    fn is_unit_beside_a_number(&self, open: &OpenWord) -> bool {
        let named = self.names.get(&open.word).and_then(|entry| entry.first());
        let unit = named.and_then(|named| self.unit_of(named));
        let pure = open.index || unit.is_some_and(|unit| unit.dimension == units::NONE);
        let wanted = open.fits && !open.fits_by_name;
        let quantity = open.raised && units::name(open.whole).is_some();
        pure && open.of_unit != units::NONE && (wanted || quantity)
    }

    /// Whether a number is a quantity that has a name where this word is the unit, and none where it is the value.
    fn is_a_quantity(&self, open: &OpenWord) -> bool {
        let named = self.names.get(&open.word).and_then(|entry| entry.first());
        let by_name = named.and_then(|named| {
            let rest = units::over(open.whole, open.of_unit)?;
            units::times(rest, self.unit_of(named)?.dimension)
        });
        let has_name = |dimension: Dimension| units::name(dimension).is_some();
        self.differs(&open.word, open.of_unit)
            && has_name(open.whole)
            && by_name.is_some_and(|it| !has_name(it))
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

    /// The report of `0.1/s` where `s` is a thing, such as a spring: it has no value, and the second is meant.
    pub fn number_per_thing(
        &self,
        above: &Expression,
        below: &Expression,
    ) -> Option<LexemeMessage> {
        let number = match above {
            Expression::Negative(inner, _) => inner,
            above => above,
        };
        let (
            Expression::Number {
                text, unit: None, ..
            },
            Expression::Path(steps),
        ) = (number, below)
        else {
            return None;
        };
        let [step] = steps.as_slice() else {
            return None;
        };
        let word = step.word.text.as_str();
        units::find(word).filter(|_| step.index.is_none())?;
        let named = self.names.get(word)?.first()?;
        let kind = match named {
            Named::Line(line) => self.scene.lines.get(line)?.kind.word(),
            Named::Body(_) | Named::Point(_) | Named::Joint(_) => named.kind(),
            _ => return None,
        };
        Some(say::unit_or_thing(step.word.at.into(), text, word, kind))
    }

    /// An expression of words of units alone that are no names.
    fn unit_of_words(&self, parsed: &Expression, scope: Scope<'_>) -> Option<Unit> {
        match parsed {
            Expression::Path(steps) => {
                let [step] = steps.as_slice() else {
                    return None;
                };
                let word = step.word.text.as_str();
                let index = is_index(word, scope);
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

/// Whether it is the dimension of a quantity that has a name, other than a pure number.
fn has_dimension_and_name(dimension: Dimension) -> bool {
    dimension != units::NONE && units::name(dimension).is_some()
}

/// Whether a word is the index of a repetition around.
fn is_index(word: &str, scope: Scope<'_>) -> bool {
    scope.indices.iter().any(|(name, _)| name == word)
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
