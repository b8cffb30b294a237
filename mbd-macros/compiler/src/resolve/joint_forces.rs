//! The fields of joint coordinates: spring, damper, friction, stops, force, motor; for one coordinate directly in the braces of the joint, for more
//! in a block named after the coordinate. A field outside the blocks holds for every coordinate if all have the same unit.

use std::collections::BTreeMap;

use mbd_scene::joints::{
    CommandFilter, Coordinate, FILTER, FORCE, JointForceField, MOTOR, MOTOR_ACCELERATION,
    MOTOR_RATE, NUMBERS, START, START_RATE, STOPS, in_order,
};
use mbd_scene::{CoordinateStart, Formula, Function, JointForces, JointLaw, State};

use super::fields::Accept;
use super::joints::LawFields;
use super::{Instance, MayDependOn, Named, Resolver, Scope, Typed, fold};
use crate::lexeme::Bracket;
use crate::messages::{resolve as say, syntax as say_syntax};
use crate::syntax::words::{ABOUT, AT_START};
use crate::syntax::{Cursor, Item, ValueSyntax, foreign, unit};
use crate::units;

/// The numbers that may follow time, inputs and states: a spring on a servo, a brake.
const MAY_CHANGE: [&str; 4] = ["stiffness", "rest", "damping", "friction"];

/// The keywords of the fields of a coordinate.
fn field_words() -> impl Iterator<Item = &'static str> {
    let names = |fields: &[&JointForceField]| -> Vec<&'static str> {
        fields.iter().map(|field| field.name).collect()
    };
    let numbers = NUMBERS.iter().map(|field| field.name);
    numbers
        .chain(names(&[&STOPS, &FORCE, &MOTOR]))
        .chain([FILTER])
        .chain(names(&[&START, &START_RATE]))
}

/// The keywords that the coordinates of a joint bring: their fields and their own names; none without coordinates.
pub fn words(law: &JointLaw) -> Vec<&'static str> {
    let names: Vec<&str> = law.measured().map(|coordinate| coordinate.name).collect();
    if names.is_empty() {
        return names;
    }
    field_words().chain(names).collect()
}

/// A field of a coordinate on a joint that has none.
pub fn without_coordinate<'i, 'a>(law: &JointLaw, block: &'i [Item<'a>]) -> Option<&'i Item<'a>> {
    let none = law.measured().next().is_none();
    let own = |item: &&Item<'_>| field_words().any(|word| word == item.word.text);
    block.iter().find(own).filter(|_| none)
}

/// The fields given for one coordinate.
type GivenFields<'i, 'a> = BTreeMap<&'static str, &'i Item<'a>>;

/// Whose fields are read.
struct FieldsOwner<'o> {
    /// The joint, or joint and coordinate where it has several.
    name: String,
    /// What a filter makes of a command: `pin.command`, `sleeve.angle_command`.
    command: String,
    coordinate: &'o Coordinate,
    scope: Scope<'o>,
}

impl Resolver<'_> {
    /// Fills what acts along the coordinates of joints, when every joint is known.
    pub fn along_joints(&mut self) {
        for instance in self.of("joint") {
            if self.along_joint(&instance).is_none() {
                self.bad.insert(Named::Joint(instance.slot));
            }
        }
    }

    fn along_joint(&mut self, instance: &Instance<'_>) -> Option<()> {
        let item = instance.item;
        let keyword = Cursor::new(item.clause(":")?).word()?.text;
        let law = JointLaw::read(&keyword, &mut LawFields::default())?;
        let measured: Vec<Coordinate> = law.measured().collect();
        let blocks = self.blocks(item, &measured)?;
        let mut given: Vec<GivenFields<'_, '_>> = vec![GivenFields::new(); measured.len()];
        for (fields, block) in given.iter_mut().zip(&blocks) {
            for field in block.iter().filter(|field| field.word.text != AT_START) {
                let word = field_words().find(|word| *word == field.word.text);
                self.give(fields, word, field)?;
            }
        }
        let alike = measured
            .windows(2)
            .all(|pair| pair[0].is_angle() == pair[1].is_angle());
        for field in &item.block {
            let Some(word) = field_words().find(|word| *word == field.word.text) else {
                continue;
            };
            if !alike {
                let at = field.word.at.into();
                return self.fail(say::which_coordinate(at, &keyword, word, &measured));
            }
            for fields in &mut given {
                self.give(fields, Some(word), field)?;
            }
        }
        let name = self.scene.joints.get(instance.slot)?.name.clone();
        let mut entries = Some(Vec::new());
        for (index, (coordinate, fields)) in measured.iter().zip(&given).enumerate() {
            let owner = FieldsOwner {
                name: match measured.len() {
                    1 => name.clone(),
                    _ => format!("{name}.{}", coordinate.name),
                },
                command: format!("{name}.{}", law.command_word(coordinate)),
                coordinate,
                scope: instance.scope(MayDependOn::Fixed),
            };
            let forces = self.forces(index, fields, &owner).map(|forces| {
                forces.with_changing_terms_as_force(instance.slot, |number| self.changes(number))
            });
            if let (Some(entries), Some(forces)) = (entries.as_mut(), forces.as_ref()) {
                entries.extend((!forces.is_empty()).then(|| forces.clone()));
            }
            if forces.is_none() {
                entries = None;
            }
            let start = self.coordinate_start((instance.slot, index), fields, &owner);
            match start {
                Some(start) => self.scene.starts.coordinates.extend(start),
                None => entries = None,
            }
        }
        self.scene.joints.get_mut(instance.slot)?.forces = entries?;
        self.locked_at_start(instance.slot, item, &blocks)
    }

    /// The fields in the blocks named after coordinates.
    fn blocks<'a>(
        &mut self,
        item: &Item<'a>,
        measured: &[Coordinate],
    ) -> Option<Vec<Vec<Item<'a>>>> {
        let known: Vec<&str> = field_words().chain([AT_START]).collect();
        let mut blocks = Some(Vec::new());
        for coordinate in measured {
            let mut fields = item.block.iter();
            let last = fields.rfind(|field| field.word.text == coordinate.name);
            let block = match last {
                None => Some(Vec::new()),
                Some(field) => self.coordinate_block(field, coordinate),
            };
            let block = block.filter(|block| !self.fields(block, &known).doubtful);
            if let (Some(blocks), Some(block)) = (blocks.as_mut(), block.as_ref()) {
                blocks.push(block.clone());
            }
            if block.is_none() {
                blocks = None;
            }
        }
        blocks
    }

    fn coordinate_block<'a>(
        &mut self,
        field: &Item<'a>,
        coordinate: &Coordinate,
    ) -> Option<Vec<Item<'a>>> {
        let Some(value) = field.clause(":") else {
            return (!field.broken).then(|| field.block.clone());
        };
        let mut cursor = Cursor::new(value);
        match cursor.group(Bracket::Brace) {
            Some(group) if cursor.at_end() => Some(self.block(group)),
            _ => self.fail(say::coordinate_block(value.at, coordinate)),
        }
    }

    /// Adds a field to those of a coordinate: each at most once.
    fn give<'i, 'a>(
        &mut self,
        fields: &mut GivenFields<'i, 'a>,
        word: Option<&'static str>,
        item: &'i Item<'a>,
    ) -> Option<()> {
        let word = word?;
        if item.broken {
            // What is wrong with it is told.
            return None;
        }
        match fields.insert(word, item) {
            Some(first) => {
                let (at, first) = (item.word.at.into(), first.word.at.into());
                self.fail(say_syntax::repeated_clause(at, word, first))
            }
            None => Some(()),
        }
    }

    /// What acts along one coordinate.
    fn forces(
        &mut self,
        index: usize,
        given: &GivenFields<'_, '_>,
        owner: &FieldsOwner<'_>,
    ) -> Option<JointForces> {
        let mut forces = JointForces {
            coordinate: index,
            ..JointForces::default()
        };
        let mut whole = true;
        for field in NUMBERS.iter().chain([&STOPS]) {
            let Some(item) = given.get(field.name) else {
                continue;
            };
            if let Some(needed) = field.needs.filter(|needed| !given.contains_key(needed)) {
                let example = example(needed, owner.coordinate);
                let at = item.word.at.into();
                self.messages
                    .push(say::needs_field(at, &owner.name, field.name, &example));
                whole = false;
            }
        }
        for (field, slot) in NUMBERS.iter().zip(forces.numbers_mut()) {
            let value = given.get(field.name).and_then(|item| item.clause(":"));
            if let Some(value) = value {
                *slot = self.along_number(field, value, owner);
                whole &= slot.is_some();
            }
        }
        if let Some(value) = given.get(STOPS.name).and_then(|item| item.clause(":")) {
            let stops = self.stops(value, owner);
            whole &= stops.is_some();
            forces.stops = stops.unwrap_or_default();
        }
        if let Some(value) = given.get(FORCE.name).and_then(|item| item.clause(":")) {
            let scope = Scope {
                stage: MayDependOn::Live,
                ..owner.scope
            };
            let typed = self.value(value, scope);
            forces.force = typed.and_then(|typed| self.along_fits(typed, &FORCE, owner));
            whole &= forces.force.is_some();
        }
        if let Some(value) = given.get(MOTOR.name).and_then(|item| item.clause(":")) {
            let filter = given.get(FILTER).copied();
            let motor = self.motor(value, filter, given, owner);
            whole &= motor.is_some();
            if let Some((motor, filter)) = motor {
                (forces.motor, forces.filter) = (Some(motor), filter);
            }
        } else if let Some(item) = given.get(FILTER) {
            let (at, example) = (item.word.at.into(), "motor: command");
            let report = say::needs_field(at, &owner.name, FILTER, example);
            self.messages.push(report);
            whole = false;
        }
        whole.then_some(forces)
    }

    /// Where a coordinate starts, and at which rate; nothing where neither is given.
    fn coordinate_start(
        &mut self,
        (joint, coordinate): (usize, usize),
        given: &GivenFields<'_, '_>,
        owner: &FieldsOwner<'_>,
    ) -> Option<Option<CoordinateStart>> {
        let mut start = CoordinateStart {
            joint,
            coordinate,
            value: None,
            rate: None,
            about: false,
        };
        for (field, slot) in [(&START, &mut start.value), (&START_RATE, &mut start.rate)] {
            let Some(item) = given.get(field.name) else {
                continue;
            };
            let at = item.word.at.into();
            if given.contains_key(FILTER) {
                // The filter starts there: see `filtered`.
                continue;
            }
            if given.contains_key(MOTOR.name) {
                return self.fail(say::start_of_motor(at, &owner.name, field.name));
            }
            let (about, value) = self.start_value(field, item, owner)?;
            *slot = Some(value);
            start.about |= about;
        }
        let any = start.value.is_some() || start.rate.is_some();
        Some(any.then_some(start))
    }

    /// The value of `start` or `start_rate`, and whether it is `about` that.
    fn start_value(
        &mut self,
        field: &'static JointForceField,
        item: &Item<'_>,
        owner: &FieldsOwner<'_>,
    ) -> Option<(bool, Formula)> {
        let Some(value) = item.clause(":") else {
            if item.broken {
                // What is wrong with it is told.
                return None;
            }
            let (at, unit) = (item.word.at.into(), field.measured.unit(owner.coordinate));
            return self.fail(say::start_of_coordinate(at, &owner.name, unit));
        };
        let mut cursor = Cursor::new(value);
        let about = cursor.keyword(ABOUT).filter(|_| !cursor.at_end());
        let value = if about.is_some() {
            cursor.rest()
        } else {
            value
        };
        if let (Some(at), true) = (about, field.name == START_RATE.name) {
            return self.fail(say::rate_about(at.into(), &owner.name));
        }
        let typed = self.value(value, owner.scope)?;
        let value = self.along_fits(typed, field, owner)?;
        Some((about.is_some(), value))
    }

    /// The course of a coordinate, which may count turns: a function of time with two derivatives, the coordinate with its rate and its
    /// acceleration, or a command behind a filter.
    fn motor(
        &mut self,
        value: ValueSyntax<'_>,
        filter: Option<&Item<'_>>,
        given: &GivenFields<'_, '_>,
        owner: &FieldsOwner<'_>,
    ) -> Option<(Formula, Option<CommandFilter>)> {
        let scope = Scope {
            stage: MayDependOn::Driven,
            ..owner.scope
        };
        let mut cursor = Cursor::new(value);
        if let Some(group) = cursor.group(Bracket::Square)
            && cursor.at_end()
        {
            if let Some(filter) = filter {
                let at = filter.word.at.into();
                return self.fail(say::filter_and_rates(at, &owner.name));
            }
            let parts = Cursor::new(group).comma_separated();
            if parts.len() != 3 {
                return self.fail(say::motor_of_three(value.at, &owner.name, parts.len()));
            }
            let mut course = Vec::new();
            for (part, field) in parts.iter().zip([&MOTOR, &MOTOR_RATE, &MOTOR_ACCELERATION]) {
                let typed = self.value(*part, scope)?;
                course.push(self.along_fits(typed, field, owner)?);
            }
            return Some((Formula::Vector(course), None));
        }
        let typed = self.value(value, scope)?;
        let at = typed.at;
        let formula = self.along_fits(typed, &MOTOR, owner)?;
        if let Some(item) = filter {
            let time = item.clause(":")?;
            let accept = Accept::Positive;
            let scope = owner.scope;
            let time = self.quantity(&owner.name, FILTER, time, units::TIME, accept, scope)?;
            let mut start = [formula.clone(), Formula::Number(0.0)];
            for (field, start) in [&START, &START_RATE].into_iter().zip(&mut start) {
                if let Some(item) = given.get(field.name) {
                    let (about, value) = self.start_value(field, item, owner)?;
                    if about {
                        let at = item.word.at.into();
                        return self.fail(say::command_about(at, &owner.name));
                    }
                    *start = value;
                }
            }
            let (course, filter) = self.filtered(formula, time, start, owner);
            return Some((course, Some(filter)));
        }
        let follows = |part: &Formula| matches!(part, Formula::Input(_) | Formula::State(_));
        if self.scene.contains(&formula, follows) {
            let text = match formula {
                Formula::Input(_) | Formula::State(_) => {
                    crate::describe::text(&self.scene, &formula)
                }
                _ => "command".to_owned(),
            };
            let units = [&MOTOR_RATE, &MOTOR_ACCELERATION]
                .map(|field| field.measured.unit(owner.coordinate));
            return self.fail(say::motor_without_rates(at, &owner.name, &text, units));
        }
        self.two_derivatives(std::slice::from_ref(&formula), at, false)?;
        Some((formula, None))
    }

    /// Makes the two states of a filter, which start at a value and a rate; the course that they are, by the equations of [`CommandFilter`].
    fn filtered(
        &mut self,
        command: Formula,
        time: Formula,
        [start, start_rate]: [Formula; 2],
        owner: &FieldsOwner<'_>,
    ) -> (Formula, CommandFilter) {
        let state = self.scene.states.len();
        let [now, rate] = [state, state + 1].map(Formula::State);
        let apply = |function, a: &Formula, b: &Formula| {
            Formula::Apply(function, vec![a.clone(), b.clone()])
        };
        let left = apply(Function::Sub, &command, &now);
        let wanted = apply(Function::Div, &left, &time);
        let twice = apply(Function::Mul, &Formula::Number(2.0), &rate);
        let lacking = apply(Function::Sub, &wanted, &twice);
        let curve = apply(Function::Div, &lacking, &time);
        let unit = |field: &JointForceField| {
            let text = field.measured.unit(owner.coordinate);
            units::si(text, field.measured.of(owner.coordinate))
        };
        self.scene.states.push(State {
            name: owner.command.clone(),
            doc: format!("What the motor of `{}` follows.", owner.name),
            start,
            unit: unit(&MOTOR),
            rate: rate.clone(),
        });
        self.scene.states.push(State {
            name: format!("{}_rate", owner.command),
            doc: format!("The rate of what the motor of `{}` follows.", owner.name),
            start: start_rate,
            unit: unit(&MOTOR_RATE),
            rate: curve.clone(),
        });
        let filter = CommandFilter {
            command,
            time,
            state,
        };
        (Formula::Vector(vec![now, rate, curve]), filter)
    }

    /// Whether a formula that no motion stands in changes in a run.
    pub fn changes(&self, formula: &Formula) -> bool {
        let changing =
            |part: &Formula| matches!(part, Formula::Time | Formula::Input(_) | Formula::State(_));
        self.scene.contains(formula, changing)
    }

    fn along_number(
        &mut self,
        field: &JointForceField,
        value: ValueSyntax<'_>,
        owner: &FieldsOwner<'_>,
    ) -> Option<Formula> {
        self.instead = Some(foreign::NOT_PROPORTIONAL);
        let stage = match MAY_CHANGE.contains(&field.name) {
            true => MayDependOn::Driven,
            false => owner.scope.stage,
        };
        let typed = self.value(
            value,
            Scope {
                stage,
                ..owner.scope
            },
        );
        self.instead = None;
        self.obeying(typed?, field, owner)
    }

    /// The formula of a value that fits a field and obeys its rule with all params at their defaults.
    fn obeying(
        &mut self,
        typed: Typed,
        field: &JointForceField,
        owner: &FieldsOwner<'_>,
    ) -> Option<Formula> {
        let at = typed.at;
        let formula = self.along_fits(typed, field, owner)?;
        let held = field.of(owner.coordinate);
        match fold::at_defaults(&formula, &self.scene) {
            Some(found) if !held.rule.holds(found) => {
                let unit = field.measured.unit(owner.coordinate);
                self.fail(say::along_rule(at, &owner.name, &held, unit, found))
            }
            _ => Some(formula),
        }
    }

    fn along_fits(
        &mut self,
        typed: Typed,
        field: &JointForceField,
        owner: &FieldsOwner<'_>,
    ) -> Option<Formula> {
        let held = field.of(owner.coordinate);
        let typed = self.reading(typed, &[held.dimension]);
        let wrong = typed.dimension.filter(|found| *found != held.dimension);
        match wrong {
            Some(found) if !typed.vector => {
                if let Some(report) = self.unit_misfit(typed.at) {
                    return self.fail(report);
                }
                let unit = field.measured.unit(owner.coordinate);
                let name = &owner.name;
                let found = match &typed.bare {
                    Some(text) if found == units::NONE => Err(text.as_str()),
                    _ => Ok(found),
                };
                self.fail(say::along_unit(typed.at, name, field.name, unit, found))
            }
            _ => {
                let turning = [units::NONE, units::RATE].contains(&held.dimension);
                if owner.coordinate.is_angle() && turning {
                    self.in_radians(&typed, &format!("`{}` of `{}`", field.name, owner.name))?;
                }
                self.fits(typed, field.name, false, held.dimension)
            }
        }
    }

    /// `[low, high]`, a unit behind the bracket if it is not inside, `none` for a side left open.
    fn stops(
        &mut self,
        value: ValueSyntax<'_>,
        owner: &FieldsOwner<'_>,
    ) -> Option<[Option<Formula>; 2]> {
        let unit_word = STOPS.measured.unit(owner.coordinate);
        let mut cursor = Cursor::new(value);
        let parts = cursor
            .group(Bracket::Square)
            .map(|group| Cursor::new(group).comma_separated());
        let Some([low, high]) = parts.as_deref() else {
            return self.fail(say::two_stops(value.at, unit_word));
        };
        let unit = match cursor.at_end() {
            true => None,
            false => match unit::whole(cursor) {
                Ok(unit) => Some(unit),
                Err(report) => return self.fail(report),
            },
        };
        let mut read = |part: &ValueSyntax<'_>| -> Option<Option<Formula>> {
            let mut cursor = Cursor::new(*part);
            if cursor.keyword("none").is_some() && cursor.at_end() {
                return Some(None);
            }
            let typed = self.value(*part, owner.scope)?;
            let typed = self.in_brackets(typed, unit.as_ref())?;
            self.obeying(typed, &STOPS, owner).map(Some)
        };
        let (low, high) = (read(low), read(high));
        let stops = [low?, high?];
        if stops.iter().all(Option::is_none) {
            return self.fail(say::two_stops(value.at, unit_word));
        }
        let places = stops.each_ref().map(|stop| {
            let place = stop.as_ref();
            place.and_then(|place| fold::at_defaults(place, &self.scene))
        });
        if !in_order(places) {
            return self.fail(say::stops_in_order(
                value.at,
                &owner.name,
                places,
                unit_word,
            ));
        }
        Some(stops)
    }
}

/// How a field that must be added is written.
fn example(word: &str, coordinate: &Coordinate) -> String {
    let field = NUMBERS.iter().find(|field| field.name == word);
    match field {
        Some(field) => format!("{word}: 1.0 {}", field.measured.unit(coordinate)),
        None => format!("{word}: [-1.0, 1.0] {}", STOPS.measured.unit(coordinate)),
    }
}
