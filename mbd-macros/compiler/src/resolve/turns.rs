//! Turns and radians: `Hz` is 1/s, and 2π is missing where an angle or its rate is meant.

use mbd_scene::{Formula, Function, Scene, Unit};

use super::value::angle_of;
use super::{Named, Resolver, Typed, fold};
use crate::lexeme::Region;
use crate::messages::resolve as say;
use crate::units;

/// Products are looked into so deep: `(a * 180) / pi`.
const FACTORS: usize = 4;

/// What counts turns in a value.
#[derive(Clone, Debug)]
pub struct Turns {
    /// It as it is written: `2 Hz`, or the name of what has the unit.
    text: String,
    /// The state of no unit that it is. Whether that counts turns is known with its rate.
    state: Option<usize>,
}

impl Turns {
    /// Those of a number with its unit.
    pub fn of_unit(number: &str, unit: &Unit) -> Option<Self> {
        counts_turns(unit).then(|| Turns {
            text: format!("{number} {}", unit.text),
            state: None,
        })
    }

    /// Those of a name.
    pub fn of_name(name: &str) -> Self {
        Turns {
            text: name.to_string(),
            state: None,
        }
    }
}

/// A state of no unit stands where radians are meant.
#[derive(Clone, Debug)]
pub struct RadiansOfState {
    state: usize,
    text: String,
    what: String,
    at: Region,
}

impl Typed {
    /// Whether a product with it makes radians of turns: an angle, or a whole multiple of π.
    pub fn makes_radians(&self, scene: &Scene) -> bool {
        let known = fold::known(&self.formula, scene, false).and_then(|known| known.scalar());
        let half_turns = known.map_or(0.0, |number| number / std::f64::consts::PI);
        let whole = (half_turns - half_turns.round()).abs() < 1e-9 * half_turns.abs();
        self.angle != 0 || half_turns != 0.0 && whole
    }

    /// Whether it is 2π, a turn in radians, without a unit.
    pub fn is_a_turn(&self, scene: &Scene) -> bool {
        let known = fold::known(&self.formula, scene, false).and_then(|known| known.scalar());
        let turn = std::f64::consts::TAU;
        let of_no_unit = self.angle == 0 && self.dimension.is_none_or(|it| it == units::NONE);
        of_no_unit && known.is_some_and(|number| (number.abs() - turn).abs() < 1e-9 * turn)
    }

    /// Whether it is an angle, or the rate of one.
    pub fn is_in_radians(&self) -> bool {
        self.angle == 1
    }
}

impl Resolver<'_> {
    /// Refuses turns where an angle in radians, or its rate, is meant, and numbers without a unit that are degrees: `2 Hz` would be 2 rad/s, and
    /// `80` would be 80 rad, without a word.
    pub fn in_radians(&mut self, typed: &Typed, what: &str) -> Option<()> {
        self.no_bare_degrees(typed, what)?;
        if typed.angle == 0 {
            let settable = self.settable_multiple(&typed.formula, FACTORS);
            self.radians_of_settables.extend(settable);
        }
        match &typed.turns {
            Some(Turns { text, state: None }) => {
                self.fail(say::turns_for_radians(typed.at, text, what))
            }
            Some(Turns {
                text,
                state: Some(state),
            }) => {
                self.radians_of_states.push(RadiansOfState {
                    state: *state,
                    text: text.clone(),
                    what: what.to_string(),
                    at: typed.at,
                });
                Some(())
            }
            None => Some(()),
        }
    }

    /// The param or input of which a formula is a whole multiple or part, `2 * a`, also behind a name: what is an angle of it is one.
    fn settable_multiple(&self, formula: &Formula, depth: usize) -> Option<Named> {
        let is_whole = |factor: &Formula| {
            let known = fold::known(factor, &self.scene, false).and_then(|known| known.scalar());
            let whole = |number: f64| number != 0.0 && number.fract() == 0.0;
            known.is_some_and(|known| whole(known) || whole(1.0 / known))
        };
        let deeper = depth.checked_sub(1)?;
        match formula {
            Formula::Param(index) => Some(Named::Param(*index)),
            Formula::Input(index) => Some(Named::Input(*index)),
            Formula::Let(index) => {
                let named = self.scene.lets.get(*index)?;
                self.settable_multiple(&named.value, deeper)
            }
            Formula::Apply(function, arguments) => match (function, arguments.as_slice()) {
                (Function::Neg, [a]) => self.settable_multiple(a, deeper),
                (Function::Mul, [factor, a]) if is_whole(factor) => {
                    self.settable_multiple(a, deeper)
                }
                (Function::Mul | Function::Div, [a, factor]) if is_whole(factor) => {
                    self.settable_multiple(a, deeper)
                }
                _ => None,
            },
            _ => None,
        }
    }

    /// Refuses a number without a unit that would be an angle of more than a full turn, unless bare numbers are declared to be SI.
    fn no_bare_degrees(&mut self, typed: &Typed, what: &str) -> Option<()> {
        let size = typed.without_unit.filter(|_| !typed.vector && !self.si);
        match size {
            Some(size) if size > std::f64::consts::TAU => {
                let known = fold::at_defaults(&typed.formula, &self.scene);
                let literal = typed.bare.is_some();
                let angle = known.unwrap_or(size);
                self.fail(say::angle_without_unit(typed.at, angle, literal, what))
            }
            _ => Some(()),
        }
    }

    /// Refuses a sum, a difference or a comparison of turns, or of degrees without their unit, with radians.
    pub fn alike_in_turns(&mut self, a: &Typed, b: &Typed) -> Option<()> {
        for (angle, other) in [(a, b), (b, a)] {
            if angle.is_in_radians() {
                self.no_bare_degrees(other, "the angle beside it")?;
            }
        }
        let mixed = [(a, b), (b, a)]
            .into_iter()
            .find_map(|(turns, other)| match &turns.turns {
                Some(Turns { text, state: None }) if other.is_in_radians() => {
                    Some((turns.at, text))
                }
                _ => None,
            });
        match mixed {
            Some((at, text)) => self.fail(say::radians_beside_turns(at, text)),
            None => Some(()),
        }
    }

    /// Refuses turns in a unit of radians, and the reverse: `what` has this unit.
    pub fn turns_as_in(&mut self, typed: &Typed, unit: &Unit, what: &str) -> Option<()> {
        if typed.is_in_radians() && counts_turns(unit) {
            return self.fail(say::turns_wanted(typed.at, what));
        }
        match angle_of(unit) {
            1 => self.in_radians(typed, what),
            _ => Some(()),
        }
    }

    /// Whether the constant factor of a product is 180/π, which makes degrees of radians.
    pub fn is_told_in_degrees(&self, formula: &Formula) -> bool {
        let degrees = 1f64.to_degrees();
        let factor = self.constant_factor(formula, FACTORS);
        (factor.abs() - degrees).abs() < 1e-9 * degrees
    }

    /// The product of the first constant factors of a formula; 1 of one without.
    fn constant_factor(&self, formula: &Formula, depth: usize) -> f64 {
        let (function, arguments) = match formula {
            _ if depth == 0 => return 1.0,
            Formula::Apply(function, arguments) => (function, arguments),
            Formula::Let(index) => {
                let named = self.scene.lets.get(*index);
                return named.map_or(1.0, |it| self.constant_factor(&it.value, depth - 1));
            }
            _ => return 1.0,
        };
        let of = |side: &Formula| {
            let known = fold::known(side, &self.scene, false).and_then(|known| known.scalar());
            known.unwrap_or_else(|| self.constant_factor(side, depth - 1))
        };
        match (function, arguments.as_slice()) {
            (Function::Mul, [a, b]) => of(a) * of(b),
            (Function::Div, [a, b]) => of(a) / of(b),
            (Function::Neg, [a]) => -of(a),
            _ => 1.0,
        }
    }

    /// The same for the unit behind `in`, which stands at `at`.
    pub fn turns_told_in(&mut self, typed: &Typed, unit: &Unit, at: Region) -> Option<()> {
        if unit.text == "deg" && self.is_told_in_degrees(&typed.formula) {
            return self.fail(say::degrees_in_degrees(at));
        }
        if typed.is_in_radians() && counts_turns(unit) {
            return self.fail(say::radians_in_turns(at));
        }
        self.turns_as_in(typed, unit, &format!("`in {}`", unit.text))
    }

    /// Keeps that a name counts turns, or is made of numbers without a unit: a product of numbers loses its unit as it was written.
    pub fn remember_units(&mut self, named: Named, typed: &Typed) {
        if let Some(size) = typed.without_unit {
            self.without_unit.insert(named, size);
        }
        if let Some(turns) = &typed.turns {
            self.turning.insert(named, turns.clone());
        }
    }

    /// What counts turns behind a name.
    pub fn turns_of(&self, named: Named, word: &str) -> Option<Turns> {
        let unit = self.unit_of(named);
        let state = match (named, unit) {
            (Named::State(state), Some(unit))
                if unit.text.is_empty() && unit.dimension == units::NONE =>
            {
                Some(state)
            }
            _ => self.turning.get(&named).and_then(|turns| turns.state),
        };
        let counts =
            state.is_some() || self.turning.contains_key(&named) || unit.is_some_and(counts_turns);
        counts.then(|| Turns {
            state,
            ..Turns::of_name(word)
        })
    }

    /// Refuses turns as the rate of a state in radians, and of a state of no unit whose value is taken for radians.
    pub fn rate_in_turns(&mut self, state: usize, typed: &Typed) -> Option<()> {
        let Some(Turns { text, state: None }) = &typed.turns else {
            return Some(());
        };
        let declared = self.scene.states.get(state)?;
        if angle_of(&declared.unit) == 1 {
            let report = say::state_in_turns(typed.at, text, &declared.name);
            return self.fail(report);
        }
        if declared.unit.dimension == units::NONE {
            self.turning
                .insert(Named::State(state), Turns::of_name(&declared.name));
        }
        Some(())
    }

    /// Gives params and inputs of no unit that stand where radians are meant theirs: what a run sets them to is held to it, so that `90` is not 90 rad.
    pub fn settables_in_radians(&mut self) {
        for named in std::mem::take(&mut self.radians_of_settables) {
            let unit = match named {
                Named::Param(index) => self.scene.params.get_mut(index).map(|it| &mut it.unit),
                Named::Input(index) => self.scene.inputs.get_mut(index).map(|it| &mut it.unit),
                _ => None,
            };
            if let Some(unit) = unit
                && unit.text.is_empty()
                && unit.dimension == units::NONE
                && !self.si
            {
                unit.text = "rad".to_owned();
            }
        }
    }

    /// Tells of the states that count turns and stand where radians are meant, when all rates are known.
    pub fn states_in_radians(&mut self) {
        for found in std::mem::take(&mut self.radians_of_states) {
            if self.turning.contains_key(&Named::State(found.state)) {
                let report = say::turns_for_radians(found.at, &found.text, &found.what);
                self.messages.push(report);
            }
        }
    }
}

/// Whether one of two units counts turns and the other one is of radians: 1 Hz is 2π rad/s.
#[must_use]
pub fn mixes_turns(a: &Unit, b: &Unit) -> bool {
    let mixed = |turns: &Unit, other: &Unit| counts_turns(turns) && angle_of(other) == 1;
    mixed(a, b) || mixed(b, a)
}

/// Whether a unit counts turns: `Hz`, `m*Hz`.
pub fn counts_turns(unit: &Unit) -> bool {
    let mut words = unit.text.split(|c: char| !c.is_ascii_alphabetic());
    words.any(|word| word == "Hz")
}
