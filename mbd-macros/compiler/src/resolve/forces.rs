//! Loads and outputs: expressions over the moving scene.

use mbd_scene::{Formula, Function, LoadKind, Place, PointKind, Unit};

use super::{Instance, MayDependOn, Named, Resolver, Scope, Typed};
use crate::lexeme::{Lexeme, LexemeKind, Region};
use crate::messages::{LexemeMessage, resolve as say};
use crate::syntax::expression::{self, Expression};
use crate::syntax::{Cursor, ValueSyntax, unit};
use crate::units;

/// The numbers of an output that are no vector, two or more than three, and the unit behind them: `[left.angle, right.angle] in deg`.
pub(super) fn listed(value: ValueSyntax<'_>) -> Option<(Vec<Expression>, Option<Unit>)> {
    match expression::whole(value) {
        Ok(Expression::Vector { parts, unit, .. }) if ![0, 1, 3].contains(&parts.len()) => {
            Some((parts, unit))
        }
        _ => None,
    }
}

/// The report of a direction behind the place of a load: `on rod at tip along rod.z`.
fn along(place: ValueSyntax<'_>) -> Option<LexemeMessage> {
    let is_along = |lexeme: &Lexeme| lexeme.kind == LexemeKind::Word("along".into());
    let at = place.lexemes.iter().position(is_along)?;
    let (word, direction) = place.lexemes.get(at..)?.split_first()?;
    let direction: String = direction.iter().map(Lexeme::shown).collect();
    (at > 0).then(|| say::load_along(word.at.into(), &direction))
}

impl Resolver<'_> {
    /// Fills the loads.
    pub fn loads(&mut self) {
        for instance in self.of("load") {
            self.poison(Named::Load(instance.slot), |this| this.load(&instance));
        }
    }

    fn load(&mut self, instance: &Instance<'_>) -> Option<()> {
        let item = instance.item;
        let scope = instance.scope(MayDependOn::Live);
        let place = self.load_place(instance, scope);
        let kind = match (item.given("="), item.given(":")) {
            (Some(_), Some(given)) => return self.fail(say::load_twice(given.at)),
            (None, None) if item.broken => return None,
            (None, None) => return self.fail(say::load_without_value(item.name_at())),
            (None, Some(given)) => {
                let value = given.value;
                let external = matches!(value.lexemes, [only] if only.kind == LexemeKind::Word("external".into()));
                if !external {
                    return self.fail(say::load_kind(value.at));
                }
                LoadKind::External
            }
            (Some(given), None) => {
                if let Some(axes) = self.axes_behind(item.clause("in")) {
                    let body = item.clause("on").and_then(|on| Cursor::new(on).word());
                    let body = body.map_or_else(String::new, |word| word.text);
                    return self.fail(say::load_axes(axes, &body));
                }
                let unit = self.in_unit(item.clause("in"));
                let typed = self.value(given.value, scope)?;
                // What is wrong with its kind may follow from what is wrong with its place.
                place?;
                let fits = [units::FORCE, units::TORQUE];
                let typed = self.reading(typed, &fits);
                if typed.dimension.is_some_and(|found| fits.contains(&found)) {
                    self.unit_fits(typed.at);
                } else if let Some(report) = self.unit_misfit(typed.at) {
                    return self.fail(report);
                }
                self.load_kind(typed, unit?.map(|(unit, _)| unit))?
            }
        };
        let place = place?;
        self.load_on_node(&kind, place, item.clause("=").map_or(item.at, |v| v.at))?;
        let entry = self.scene.loads.get_mut(instance.slot)?;
        entry.at = place;
        entry.kind = kind;
        Some(())
    }

    /// Where a word stands behind `in` that is no unit and says in which axes a load or an output is meant: `in body`.
    fn axes_behind(&self, value: Option<ValueSyntax<'_>>) -> Option<Region> {
        let mut cursor = Cursor::new(value?);
        let word = cursor.word()?;
        let named = self.names.is(&word.text, |it| matches!(it, Named::Body(_)));
        let axes = named || ["body", "local", "world", "frame"].contains(&word.text.as_str());
        axes.then(|| word.at.into())
    }

    /// `on body at frame`, `on point`.
    fn load_place(&mut self, instance: &Instance<'_>, scope: Scope<'_>) -> Option<Place> {
        let item = instance.item;
        let on = item.clause("on")?;
        if let Some(report) = along(on).or_else(|| along(item.clause("at")?)) {
            return self.fail(report);
        }
        let steps = match expression::path(on) {
            Ok(steps) => steps,
            Err(report) => return self.fail(report),
        };
        let (first, rest) = steps.split_first()?;
        if first.word.text == "world" {
            return self.fail(say::load_on_world(on.at));
        }
        let owner = self.place_owner(first, scope)?;
        if matches!(owner, Named::Joint(_)) {
            return self.fail(say::load_on_joint(on.at, &first.word.text));
        }
        match owner {
            Named::Body(body) => {
                // `on rod.tip` is `on rod at tip`.
                let at = match (rest, item.clause("at")) {
                    ([], at) => at,
                    ([step], None) => {
                        return Some(Place::Body(body, self.body_frame(body, step, scope)?));
                    }
                    ([step, ..], _) => {
                        let frame = &step.word.text;
                        return self.fail(say::load_on_frame(on.at, &first.word.text, frame));
                    }
                };
                let Some(at) = at else {
                    return Some(Place::Body(body, 0));
                };
                let steps = match expression::path(at) {
                    Ok(steps) => steps,
                    Err(report) => return self.fail(report),
                };
                match steps.as_slice() {
                    [step] => Some(Place::Body(body, self.body_frame(body, step, scope)?)),
                    _ => self.fail(say::load_at(at.at)),
                }
            }
            Named::Point(_) if let Some(step) = rest.first() => {
                self.fail(say::after_place(step.word.at.into(), &step.word.text))
            }
            Named::Point(point) => match item.given("at") {
                Some(at) => self.fail(say::load_at_point(at.at)),
                None => Some(Place::Point(point)),
            },
            other => self.fail(say::no_place(on.at, &first.word.text, other.kind())),
        }
    }

    /// A force or a couple, by its dimension.
    fn load_kind(&mut self, typed: Typed, unit: Option<Unit>) -> Option<LoadKind> {
        if !typed.vector {
            return self.fail(say::load_is_scalar(typed.at));
        }
        let wanted = unit.map(|unit| unit.dimension);
        if let (Some(wanted), Some(found)) = (wanted, typed.dimension)
            && wanted != found
        {
            return self.fail(say::wrong_dimension(typed.at, "in", wanted, found));
        }
        match wanted.or(typed.dimension) {
            None | Some(units::FORCE) => Some(LoadKind::Force(typed.formula)),
            Some(units::TORQUE) => Some(LoadKind::Torque(typed.formula)),
            Some(found) => match &typed.bare {
                _ if let Some((input, vector)) = self.input_of_bare_value(&typed) => {
                    let input = (input.as_str(), vector);
                    self.fail(say::input_without_unit(typed.at, input, units::FORCE))
                }
                Some(text) if found == units::NONE => {
                    self.fail(say::needs_unit(typed.at, "load", units::FORCE, text))
                }
                _ => self.fail(say::load_dimension(typed.at, found)),
            },
        }
    }

    /// The balance that gives a node its place cannot depend on that place, on its speed, or on what follows from them.
    fn load_on_node(&mut self, kind: &LoadKind, place: Place, at: Region) -> Option<()> {
        let Place::Point(point) = place else {
            return Some(());
        };
        let owner = self.scene.points.get(point)?;
        let name = owner.name.clone();
        let node = matches!(owner.kind, PointKind::Node(_));
        let (LoadKind::Force(formula), true) = (kind, node) else {
            let couple = matches!(kind, LoadKind::Torque(_));
            return if couple {
                self.fail(say::couple_on_point(at, &name))
            } else {
                Some(())
            };
        };
        let scene = &self.scene;
        let mut culprit: Option<String> = None;
        scene.walk(formula, &mut |part| {
            let found = match part {
                Formula::Position(Place::Point(p)) | Formula::Velocity(Place::Point(p))
                    if scene.is_node(Place::Point(*p)) =>
                {
                    scene.points.get(*p).map(|p| p.name.clone())
                }
                Formula::Tension(line)
                | Formula::Length(line)
                | Formula::Stretch(line)
                | Formula::StretchRate(line) => scene
                    .lines
                    .get(*line)
                    .filter(|line| scene.is_node(line.from) || scene.is_node(line.to))
                    .map(|line| line.name.clone()),
                _ => None,
            };
            culprit = culprit.take().or(found);
        });
        match culprit {
            Some(culprit) => self.fail(say::load_on_node(at, &name, &culprit)),
            None => Some(()),
        }
    }

    /// The unit after `in`, with its place.
    pub fn in_unit(&mut self, value: Option<ValueSyntax<'_>>) -> Option<Option<(Unit, Region)>> {
        let Some(value) = value else {
            return Some(None);
        };
        match unit::whole(Cursor::new(value)) {
            Ok(unit) => Some(Some((unit, value.at))),
            Err(report) => self.fail(report),
        }
    }

    /// Fills the outputs.
    pub fn outputs(&mut self) {
        for instance in self.of("output") {
            self.poison(Named::Output(instance.slot), |this| this.output(&instance));
        }
    }

    fn output(&mut self, instance: &Instance<'_>) -> Option<()> {
        let item = instance.item;
        let value = item.clause("=")?;
        let typed = match instance.part() {
            None => self.value(value, instance.scope(MayDependOn::Result))?,
            Some(part) => self.part_of_list(value, part)?,
        };
        if let Some(axes) = self.axes_behind(item.clause("in")) {
            let word = item.clause("in").and_then(|it| Cursor::new(it).word());
            let body = word.filter(|word| self.names.get(&word.text).is_some());
            let body = body.map_or("rod".to_owned(), |word| word.text);
            return self.fail(say::output_axes(axes, &body));
        }
        let asked = self.in_unit(item.clause("in"))?;
        let wanted = asked.as_ref().map(|(unit, _)| unit.dimension);
        let typed = self.reading_as(typed, wanted.as_slice());
        self.shown.insert(instance.slot, typed.clone());
        self.note_axis(instance.slot, &typed);
        let (value, components, unit) = self.column(typed, asked)?;
        let entry = self.scene.outputs.get_mut(instance.slot)?;
        entry.value = value;
        entry.components = components;
        entry.unit = unit;
        Some(())
    }

    /// Notes that an output is an axis of a body or a frame, which is seldom meant: of a point the same letter is its place.
    fn note_axis(&mut self, output: usize, shown: &Typed) {
        let axis = self.axis_of_a_place(&shown.formula);
        let output = self.scene.outputs.get(output);
        if let (Some(axis), Some(output)) = (axis, output) {
            let note = say::output_of_an_axis(&output.name, &axis);
            self.notes.push(note);
        }
    }

    /// One number of a list that is no vector.
    fn part_of_list(&mut self, value: ValueSyntax<'_>, part: usize) -> Option<Typed> {
        let (parts, unit) = listed(value)?;
        let scope = Scope {
            stage: MayDependOn::Result,
            indices: &[],
        };
        let typed = self.read_either_way(parts.get(part)?, scope)?;
        if typed.vector {
            return self.fail_as_vector(&typed, "one of several values");
        }
        self.in_brackets(typed, unit.as_ref())
    }

    /// A value in the unit that is asked for, how many components it has, and that unit.
    pub(super) fn column(
        &mut self,
        typed: Typed,
        asked: Option<(Unit, Region)>,
    ) -> Option<(Formula, usize, Unit)> {
        let (mut unit, components) = (typed.unit(), if typed.vector { 3 } else { 1 });
        let mut value = typed.formula.clone();
        if let Some((wanted, at)) = asked {
            if let Some(found) = typed.dimension
                && found != wanted.dimension
            {
                let report = say::cannot_be_told_in(at, &wanted.text, found);
                return self.fail(report);
            }
            self.turns_told_in(&typed, &wanted, at)?;
            unit = wanted;
        }
        if unit.factor != 1.0 {
            let arguments = vec![value, Formula::Number(unit.factor)];
            value = self.apply(Function::Div, arguments, typed.at)?;
        }
        Some((value, components, unit))
    }
}
