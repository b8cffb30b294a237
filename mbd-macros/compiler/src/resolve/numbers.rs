//! Numbers of the declaration: consts, params and inputs.

use std::collections::BTreeSet;

use mbd_scene::metrics::{Metric, Take};
use mbd_scene::{
    Actions, Constant, Dimension, Direction, Event, Fixed, Formula, Input, Let, Output, Parameter,
    State, Table, Unit,
};

use super::{Instance, MayDependOn, Named, Resolver, Typed, fold};
use crate::lexeme::{Bracket, Lexeme, LexemeKind, Region};
use crate::messages::{resolve as say, syntax as say_syntax};
use crate::syntax::expression::{self, Expression};
use crate::syntax::{Cursor, ValueSyntax, unit};
use crate::units;

impl Resolver<'_> {
    /// Fills what is made of consts.
    pub fn numbers(&mut self) {
        for param in self.of("param") {
            self.poison(Named::Param(param.slot), |this| this.param(&param));
        }
        for input in self.of("input") {
            self.poison(Named::Input(input.slot), |this| this.input(&input));
        }
        for state in self.of("state") {
            self.poison(Named::State(state.slot), |this| this.state_start(&state));
        }
        for table in self.of("table") {
            self.poison(Named::Table(table.slot), |this| this.fill_table(&table));
        }
    }

    /// Runs a step; what it could not finish is not blamed on its users.
    pub fn poison(&mut self, named: Named, step: impl FnOnce(&mut Self) -> Option<()>) {
        if self.bad.contains(&named) || step(self).is_none() {
            self.bad.insert(named);
        }
    }

    /// Entries for the lists of numbers and results.
    pub fn number_placeholder(&mut self, word: &str, name: String, doc: String) {
        let scene = &mut self.scene;
        let unit = Unit {
            factor: 1.0,
            ..Unit::default()
        };
        match word {
            "const" => scene.consts.push(Constant {
                name,
                doc,
                value: Fixed::Scalar(0.0),
                unit,
            }),
            "param" => scene.params.push(Parameter {
                name,
                doc,
                default: 0.0,
                range: None,
                unit,
            }),
            "input" => scene.inputs.push(Input {
                name,
                doc,
                components: 1,
                unit,
                default: [0.0; 3],
            }),
            "state" => scene.states.push(State {
                name,
                doc,
                start: Formula::Number(0.0),
                unit,
                rate: Formula::Number(0.0),
            }),
            "table" => scene.tables.push(Table {
                name,
                doc,
                x: vec![0.0],
                y: vec![0.0],
                x_unit: unit.clone(),
                y_unit: unit,
                second: None,
                smooth: false,
            }),
            "output" => scene.outputs.push(Output {
                name,
                doc,
                value: Formula::Number(0.0),
                components: 1,
                unit,
            }),
            "let" => {
                self.lets.push(super::lets::LetProgress::default());
                scene.lets.push(Let {
                    name,
                    doc,
                    value: Formula::Number(0.0),
                    components: 1,
                    unit,
                });
            }
            "metric" => scene.runs.metrics.push(Metric {
                name,
                doc,
                take: Take::Final,
                output: None,
                level: None,
                event: None,
                from: None,
                to: None,
            }),
            _ => scene.events.push(Event {
                name,
                doc,
                guard: Formula::Number(1.0),
                direction: Direction::Crosses,
                actions: Actions::default(),
            }),
        }
    }

    /// Fills consts in the order of what they depend on.
    pub fn consts(&mut self) {
        let mut waiting: Vec<(Instance<'_>, Expression)> = Vec::new();
        for instance in self.of("const") {
            let named = Named::Const(instance.slot);
            let parsed = instance.item.clause("=").map(expression::whole);
            match parsed {
                Some(Ok(parsed)) if !self.bad.contains(&named) => waiting.push((instance, parsed)),
                Some(Err(report)) => {
                    self.messages.push(report);
                    self.bad.insert(named);
                }
                _ => {
                    self.bad.insert(named);
                }
            }
        }
        let mut open: BTreeSet<usize> = waiting.iter().map(|(i, _)| i.slot).collect();
        loop {
            let before = waiting.len();
            let mut later = Vec::new();
            for (instance, parsed) in waiting {
                let mut needs = BTreeSet::new();
                self.const_names(&parsed, &mut needs);
                if needs.is_disjoint(&open) {
                    open.remove(&instance.slot);
                    self.unit_words.waiting.clone_from(&open);
                    self.poison(Named::Const(instance.slot), |this| {
                        this.constant(&instance, &parsed)
                    });
                } else {
                    later.push((instance, parsed));
                }
            }
            waiting = later;
            if waiting.is_empty() || waiting.len() == before {
                break;
            }
        }
        self.unit_words.waiting.clear();
        for (instance, _) in waiting {
            let name = self.scene.consts.get(instance.slot).map(|c| c.name.clone());
            let report = say::circular(instance.item.name_at(), "const", &name.unwrap_or_default());
            self.messages.push(report);
            self.bad.insert(Named::Const(instance.slot));
        }
    }

    /// The consts an expression names.
    fn const_names(&self, parsed: &Expression, needs: &mut BTreeSet<usize>) {
        match parsed {
            Expression::Number { .. } => {}
            Expression::Vector { parts, .. } => {
                parts.iter().for_each(|part| self.const_names(part, needs));
            }
            Expression::Call { arguments, .. } => {
                arguments.iter().for_each(|a| self.const_names(a, needs));
            }
            Expression::Component { of, .. } => self.const_names(of, needs),
            Expression::Negative(inner, _) => self.const_names(inner, needs),
            Expression::Binary { sides, .. } | Expression::Compare { sides, .. } => {
                sides.iter().for_each(|side| self.const_names(side, needs));
            }
            Expression::Path(steps) => {
                let first = steps
                    .first()
                    .and_then(|step| self.names.get(&step.word.text));
                if let Some(super::names::Members::One(Named::Const(index))) =
                    first.map(|entry| &entry.members)
                {
                    needs.insert(*index);
                }
            }
        }
    }

    fn constant(&mut self, instance: &Instance<'_>, parsed: &Expression) -> Option<()> {
        self.instead = Some(say::LET_OF_PARAMS);
        let typed = self.read_either_way(parsed, instance.scope(MayDependOn::Constant));
        self.instead = None;
        let typed = typed?;
        let unit = written_unit(parsed).unwrap_or_else(|| typed.unit());
        let at = typed.at;
        self.remember_units(Named::Const(instance.slot), &typed);
        let value = match fold::known(&typed.formula, &self.scene, false) {
            Some(value) => value,
            None => return self.fail(say::not_constant(at, "this")),
        };
        let entry = self.scene.consts.get_mut(instance.slot)?;
        entry.value = value;
        entry.unit = unit;
        Some(())
    }

    /// The number of a constant scalar.
    pub fn constant_value(&mut self, typed: Typed) -> Option<f64> {
        if typed.vector {
            return self.fail(say::vector_param(typed.at));
        }
        match fold::known(&typed.formula, &self.scene, false) {
            Some(fold::Fixed::Scalar(value)) => Some(value),
            _ => self.fail(say::not_constant(typed.at, "this")),
        }
    }

    fn param(&mut self, instance: &Instance<'_>) -> Option<()> {
        let value = instance.item.clause("=")?;
        let parsed = match expression::whole(value) {
            Ok(parsed) => parsed,
            Err(report) => {
                let word = |lexeme: &&Lexeme| matches!(&lexeme.kind, LexemeKind::Word(word) if ["range", "from", "within", "between"].contains(&word.as_str()));
                return self.fail(match value.lexemes.iter().find(word) {
                    Some(word) => say::range_words(word.at.into(), &word.shown()),
                    None => report,
                });
            }
        };
        let typed = self.read_either_way(&parsed, instance.scope(MayDependOn::Constant))?;
        let unit = written_unit(&parsed).unwrap_or_else(|| typed.unit());
        let (at, dimension) = (typed.at, typed.dimension);
        let bare = typed.bare.clone();
        self.remember_units(Named::Param(instance.slot), &typed);
        let default = self.constant_value(typed)?;
        if let Some(entry) = self.scene.params.get_mut(instance.slot) {
            entry.default = default;
            entry.unit = unit.clone();
        }
        if let Some(range) = instance.item.clause("in") {
            let (ends, found) = self.range(range, instance, &unit)?;
            let name = self.scene.params.get(instance.slot)?.name.clone();
            if let (Some(wanted), Some(this)) = (dimension, found)
                && wanted != this
            {
                return self.fail(match bare {
                    Some(text) if wanted == units::NONE => say::needs_unit(at, &name, this, &text),
                    _ => say::wrong_range(range.at, &name, wanted, this),
                });
            }
            let [low, high] = ends;
            if low > high {
                return self.fail(say::empty_range(range.at, &name));
            }
            if default < low || default > high {
                return self.fail(say::default_outside(at, &name, range.at));
            }
            self.scene.params.get_mut(instance.slot)?.range = Some([low, high]);
        }
        Some(())
    }

    /// `600 kg ..= 900 kg`: both ends and their dimension. An end without a unit is told here, if the default has one.
    fn range(
        &mut self,
        value: ValueSyntax<'_>,
        instance: &Instance<'_>,
        unit: &Unit,
    ) -> Option<([f64; 2], Option<Dimension>)> {
        let mut cursor = Cursor::new(value);
        let low = match expression::prefix(&mut cursor) {
            Ok(low) => low,
            Err(report) => return self.fail(report),
        };
        if cursor.signs("..=").is_none() {
            let half = cursor.signs("..").is_some();
            return self.fail(if half {
                say_syntax::half_open_range(value.at)
            } else {
                say_syntax::value_range(value.at)
            });
        }
        let high = match expression::prefix(&mut cursor) {
            Ok(high) => high,
            Err(report) => return self.fail(report),
        };
        if let Err(report) = cursor.finish("the end of the range") {
            return self.fail(report);
        }
        let mut ends = [0.0; 2];
        let mut dimension = None;
        for (end, parsed) in ends.iter_mut().zip([low, high]) {
            let typed = self.typed(&parsed, instance.scope(MayDependOn::Constant))?;
            match (&typed.bare, typed.dimension) {
                (Some(text), Some(units::NONE)) if unit.dimension != units::NONE => {
                    return self.fail(say::needs_unit(typed.at, "in", unit.dimension, text));
                }
                (_, Some(found)) if dimension.is_some_and(|known| known != found) => {
                    let known = dimension.unwrap_or(found);
                    return self.fail(say::wrong_dimension(typed.at, "in", known, found));
                }
                (_, found) => dimension = dimension.or(found),
            }
            self.turns_as_in(&typed, unit, "the range of a param")?;
            *end = self.constant_value(typed)?;
        }
        Some((ends, dimension))
    }

    /// `wind: [speed; 3]`, `wind: speed = [1.0, 0.0, 0.0] m/s`, `thrust: force = 2 kN` or `voltage = 6 V`.
    fn input(&mut self, instance: &Instance<'_>) -> Option<()> {
        let Some(value) = instance.item.clause(":") else {
            return self.input_of_its_value(instance);
        };
        let mut cursor = Cursor::new(value);
        let (inner, components) = match cursor.group(Bracket::Square) {
            Some(group) => {
                if !cursor.at_end() {
                    return self.fail(say::input_type(value.at));
                }
                let [lexemes @ .., semicolon, count] = group.lexemes else {
                    return self.fail(say::input_type(value.at));
                };
                match (&semicolon.kind, &count.kind) {
                    (LexemeKind::Sign(';'), LexemeKind::Number(count)) if count == "3" => {}
                    (LexemeKind::Sign(';'), LexemeKind::Number(count)) => {
                        let name = self.scene.inputs.get(instance.slot)?.name.clone();
                        let kind: String = lexemes.iter().map(Lexeme::shown).collect();
                        let report = say::input_count(value.at, &name, &kind, count);
                        return self.fail(report);
                    }
                    _ => return self.fail(say::input_type(value.at)),
                }
                (lexemes, 3)
            }
            None => (value.lexemes, 1),
        };
        let equals = |lexeme: &Lexeme| lexeme.kind == LexemeKind::Sign('=');
        if let Some(sign) = inner.iter().find(|lexeme| equals(lexeme)) {
            return self.fail(say::input_in_one_text(sign.at.into()));
        }
        let unit = self.input_unit(inner, value.at)?;
        let dimension = unit.dimension;
        let entry = self.scene.inputs.get_mut(instance.slot)?;
        entry.components = components;
        entry.unit = unit;
        self.input_default(instance, components, dimension)
    }

    /// An input that says no kind is in the SI unit of its value.
    fn input_of_its_value(&mut self, instance: &Instance<'_>) -> Option<()> {
        let Some(given) = instance.item.clause("=") else {
            let name = self.scene.inputs.get(instance.slot)?.name.clone();
            return self.fail(say::input_of_no_kind(instance.item.name_at(), &name));
        };
        let parsed = match expression::whole(given) {
            Ok(parsed) => parsed,
            Err(report) => return self.fail(report),
        };
        let typed = self.read_either_way(&parsed, instance.scope(MayDependOn::Constant))?;
        let written = written_unit(&parsed).filter(|unit| unit.factor == 1.0);
        self.scene.inputs.get_mut(instance.slot)?.unit = written.unwrap_or_else(|| typed.unit());
        self.hold_at(instance.slot, 1, &typed)
    }

    /// What holds until the caller gives another value. A vector makes a vector of an input.
    fn input_default(
        &mut self,
        instance: &Instance<'_>,
        components: usize,
        wanted: Dimension,
    ) -> Option<()> {
        let Some(given) = instance.item.clause("=") else {
            return Some(());
        };
        let typed = self.value(given, instance.scope(MayDependOn::Constant))?;
        let name = self.scene.inputs.get(instance.slot)?.name.clone();
        match (&typed.bare, typed.dimension) {
            (Some(text), Some(units::NONE)) if wanted != units::NONE => {
                return self.fail(say::needs_unit(typed.at, &name, wanted, text));
            }
            (_, Some(found)) if found != wanted => {
                return self.fail(say::wrong_dimension(typed.at, &name, wanted, found));
            }
            _ => {}
        }
        let unit = self.scene.inputs.get(instance.slot)?.unit.clone();
        self.turns_as_in(&typed, &unit, &format!("the default of `{name}`"))?;
        self.hold_at(instance.slot, components, &typed)
    }

    /// Keeps the numbers of a default.
    fn hold_at(&mut self, input: usize, components: usize, typed: &Typed) -> Option<()> {
        self.remember_units(Named::Input(input), typed);
        let (components, default) = match fold::known(&typed.formula, &self.scene, false) {
            Some(fold::Fixed::Vector(value)) => (3, value),
            Some(fold::Fixed::Scalar(_)) if components == 3 => {
                let name = &self.scene.inputs.get(input)?.name;
                let report = say::vector_wanted(typed.at, &format!("`{name}`"));
                return self.fail(report);
            }
            Some(fold::Fixed::Scalar(value)) => (1, [value, 0.0, 0.0]),
            None => return self.fail(say::not_constant(typed.at, "this")),
        };
        let entry = self.scene.inputs.get_mut(input)?;
        entry.components = components;
        entry.default = default;
        Some(())
    }

    pub fn input_unit(&mut self, lexemes: &[Lexeme], at: Region) -> Option<Unit> {
        if let [only] = lexemes
            && let LexemeKind::Word(word) = &only.kind
        {
            if let Some(unit) = units::of_quantity(word) {
                return Some(unit);
            }
            if units::find(word).is_none() {
                return self.fail(say::unknown_input_type(only.at.into(), word));
            }
        } else if let Some(unit) = of_quantities(lexemes) {
            return Some(unit);
        }
        let unit = match unit::whole(Cursor::new(ValueSyntax { lexemes, at })) {
            Ok(unit) => unit,
            Err(report) => return self.fail(report),
        };
        if unit.factor != 1.0 {
            return self.fail(say::input_in_si(at, unit.dimension));
        }
        Some(unit)
    }
}

/// The SI unit of a product of quantities and units in which a quantity stands: `volume/s`.
fn of_quantities(lexemes: &[Lexeme]) -> Option<Unit> {
    let mut named = false;
    let text = lexemes.iter().map(|lexeme| match &lexeme.kind {
        LexemeKind::Word(word) if let Some(unit) = units::of_quantity(word) => {
            named = true;
            format!("({})", unit.text)
        }
        _ => lexeme.shown(),
    });
    let text: String = text.collect();
    let (lexemes, _, messages) = crate::lexeme::from_text(&text);
    let value = ValueSyntax {
        lexemes: &lexemes,
        at: Region::START,
    };
    let read = unit::whole(Cursor::new(value)).ok()?;
    let fits = named && messages.is_empty();
    fits.then(|| units::si(&units::si_text(read.dimension), read.dimension))
}

/// The unit of a value that is one number, or one vector.
pub fn written_unit(parsed: &Expression) -> Option<Unit> {
    match parsed {
        Expression::Number { unit, .. } | Expression::Vector { unit, .. } => unit.clone(),
        Expression::Negative(inner, _) => written_unit(inner),
        _ => None,
    }
}
