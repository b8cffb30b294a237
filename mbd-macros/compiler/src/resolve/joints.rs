//! Joints: kind, ends and fields. Which joints and fields there are, the laws themselves say.

use mbd_scene::joints::{Axis, Coupled, Field, Fields as Asks};
use mbd_scene::laws::is_discontinuous;
use mbd_scene::{Detachable, Dimension, Formula, JointLaw, Place, PointKind};

use super::fields::ItemFields;
use super::{Instance, MayDependOn, Named, Resolver, Scope, Typed, fold, joint_forces};
use crate::lexeme::{Bracket, Lexeme, Region};
use crate::messages::resolve as say;
use crate::syntax::words::{AT_START, LOCKED};
use crate::syntax::{Cursor, ValueSyntax, Word};
use crate::units;

/// The cosine between axes that still count as perpendicular.
const PERPENDICULAR: f64 = 1e-9;

/// The names of the fields a law asks for.
#[derive(Default)]
pub(super) struct LawFields(Vec<&'static str>);

impl Asks for LawFields {
    fn axis(&mut self, name: &'static str, default: Axis) -> Axis {
        self.0.push(name);
        default
    }
    fn axes(&mut self, name: &'static str, default: [Axis; 2], _: bool) -> [Axis; 2] {
        self.0.push(name);
        default
    }
    fn number(&mut self, field: &'static Field) -> Formula {
        self.0.push(field.name);
        Formula::Number(1.0)
    }
    fn coordinates(&mut self) -> [(usize, usize); 2] {
        Default::default()
    }
    fn coupled(&mut self, field: &'static Field, _: Coupled) -> Formula {
        self.number(field)
    }
}

/// What a joint of a declaration joins.
#[derive(Clone, Copy, Default)]
struct JoinedPlaces {
    /// Parent and child.
    places: Option<[Place; 2]>,
    /// Of a coupling the coordinates at `to` and at `from`.
    coordinates: Option<[(usize, usize); 2]>,
}

/// Answers a law from the fields between the braces of a joint.
struct Answers<'w, 'd, 'i, 'a> {
    resolver: &'w mut Resolver<'d>,
    fields: ItemFields<'i, 'a>,
    scope: Scope<'w>,
    keyword: &'w str,
    name: &'w str,
    at: Region,
    ends: JoinedPlaces,
    /// Whether an answer was wrong and has been reported.
    wrong: bool,
}

impl Answers<'_, '_, '_, '_> {
    /// The answer, or what stands in for one that is wrong.
    fn or<T>(&mut self, answer: Option<T>, instead: T) -> T {
        self.wrong |= answer.is_none();
        answer.unwrap_or(instead)
    }
}

impl Asks for Answers<'_, '_, '_, '_> {
    fn axis(&mut self, name: &'static str, default: Axis) -> Axis {
        let Some(value) = self.fields.value(name) else {
            return default;
        };
        let example = format!("{name}: {}", letter(default));
        let answer = match count(value) {
            Some(found) => {
                let report = say::one_axis(value.at, self.keyword, found, &example);
                self.resolver.fail(report)
            }
            None => self.resolver.axis(name, value, default, self.scope),
        };
        self.or(answer, default)
    }

    fn axes(&mut self, name: &'static str, default: [Axis; 2], perpendicular: bool) -> [Axis; 2] {
        let Some(value) = self.fields.value(name) else {
            return default;
        };
        let answer = self.two_axes(name, value, default, perpendicular);
        self.or(answer, default)
    }

    fn number(&mut self, field: &'static Field) -> Formula {
        let unit = match units::si_text(field.dimension) {
            // A number without dimension in a joint is an angle.
            unit if unit.is_empty() => "rad".to_owned(),
            unit => unit,
        };
        self.given(field, (field.dimension, &unit))
    }

    fn coordinates(&mut self) -> [(usize, usize); 2] {
        self.or(self.ends.coordinates, Default::default())
    }

    fn coupled(&mut self, field: &'static Field, measures: Coupled) -> Formula {
        if measures == Coupled::To && self.fields.value(field.name).is_none() {
            return Formula::Number(0.0);
        }
        let coordinates = self.ends.coordinates.and_then(|both| {
            let scene = &self.resolver.scene;
            let [to, from] = both.map(|(joint, index)| scene.coordinate(joint, index));
            Some([to?.1, from?.1])
        });
        match coordinates {
            Some(coordinates) => self.given(field, measures.of(&coordinates)),
            None => self.or(None, Formula::Number(1.0)),
        }
    }
}

impl Answers<'_, '_, '_, '_> {
    fn two_axes(
        &mut self,
        name: &'static str,
        value: ValueSyntax<'_>,
        default: [Axis; 2],
        perpendicular: bool,
    ) -> Option<[Axis; 2]> {
        let mut cursor = Cursor::new(value);
        let parts = match cursor.group(Bracket::Square) {
            Some(group) if cursor.at_end() => Cursor::new(group).comma_separated(),
            _ => vec![value],
        };
        let [first, second] = parts[..] else {
            let [a, b] = default.map(letter);
            let example = format!("{name}: [{a}, {b}]");
            let report = say::two_axes(value.at, self.keyword, parts.len(), &example);
            return self.resolver.fail(report);
        };
        let a = self.resolver.axis(name, first, default[0], self.scope);
        let b = self.resolver.axis(name, second, default[1], self.scope);
        let (a, b) = (a?, b?);
        let cosine: f64 = a.0.iter().zip(b.0).map(|(a, b)| a * b).sum();
        if perpendicular && cosine.abs() > PERPENDICULAR {
            let degrees = cosine.clamp(-1.0, 1.0).acos().to_degrees();
            let report = say::not_perpendicular(value.at, self.keyword, degrees);
            return self.resolver.fail(report);
        }
        Some([a, b])
    }

    /// A number that must be given, in this unit.
    fn given(&mut self, field: &'static Field, unit: (Dimension, &str)) -> Formula {
        let answer = match self.fields.value(field.name) {
            Some(value) => self.one_number(field, unit, value),
            None if self.fields.doubtful => None,
            None => {
                let report = say::no_number(self.at, self.keyword, self.name, (field.name, unit.1));
                self.resolver.fail(report)
            }
        };
        self.or(answer, Formula::Number(1.0))
    }

    fn one_number(
        &mut self,
        field: &'static Field,
        (dimension, unit): (Dimension, &str),
        value: ValueSyntax<'_>,
    ) -> Option<Formula> {
        let resolver = &mut *self.resolver;
        let typed = resolver.value(value, self.scope)?;
        let at = typed.at;
        if typed.angle < 0 && dimension == units::LENGTH {
            let written: Vec<String> = value.lexemes.iter().map(Lexeme::shown).collect();
            return resolver.fail(say::length_per_angle(at, field.name, &written.join(" ")));
        }
        let formula = resolver.fits(typed, field.name, false, dimension)?;
        match fold::at_defaults(&formula, &resolver.scene) {
            Some(found) if !field.rule.holds(found) => {
                resolver.fail(say::along_rule(at, self.name, field, unit, found))
            }
            _ => Some(formula),
        }
    }
}

impl Resolver<'_> {
    /// Fills the joints.
    pub fn joints(&mut self) {
        // Couplings last: they refer to coordinates of the others.
        let mut instances = self.of("joint");
        instances.sort_by_key(|instance| is_coupling(instance));
        for instance in instances {
            self.poison(Named::Joint(instance.slot), |this| this.joint(&instance));
        }
    }

    fn joint(&mut self, instance: &Instance<'_>) -> Option<()> {
        let item = instance.item;
        let name = self.scene.joints.get(instance.slot)?.name.clone();
        let scope = instance.scope(MayDependOn::Fixed);
        let keyword = item.clause(":").and_then(|value| self.joint_keyword(value));
        let ends = match &keyword {
            Some(keyword) if is_coupling(instance) => self.coupling_ends(instance, keyword),
            _ => {
                let ends = ["from", "to"].map(|end| {
                    item.clause(end)
                        .and_then(|value| self.joint_end(value, scope))
                });
                let [parent, child] = ends;
                JoinedPlaces {
                    places: parent.zip(child).map(|(parent, child)| [parent, child]),
                    ..JoinedPlaces::default()
                }
            }
        };
        let law =
            keyword.and_then(|keyword| self.joint_law(instance, &name, (&keyword, ends), scope));
        let (law, [parent, child]) = (law?, ends.places?);
        let [from, to] = ["from", "to"].map(|end| item.clause(end).map_or(item.at, |v| v.at));
        if law.rows() == 0 && matches!(parent, Place::Point(_)) {
            return self.fail(say::free_from_point(from));
        }
        if law.rows() == 0 && !matches!(child, Place::Body(..)) {
            return self.fail(say::free_to_world(to));
        }
        let owner = match (parent, child) {
            (Place::World(_), Place::World(_)) => Some("the world".to_string()),
            (Place::Body(a, _), Place::Body(b, _)) if a == b => {
                let body = self.scene.bodies.get(a)?;
                Some(format!("body `{}`", body.name))
            }
            (Place::Point(a), Place::Point(b)) if a == b => {
                let point = self.scene.points.get(a)?;
                Some(format!("point `{}`", point.name))
            }
            _ => None,
        };
        if let Some(owner) = owner {
            return self.fail(say::joint_to_itself(to, &name, &owner));
        }
        for (end, place, at) in [("from", parent, from), ("to", child, to)] {
            self.axes_at(&law, end, place, at)?;
        }
        let entry = self.scene.joints.get_mut(instance.slot)?;
        entry.law = law;
        entry.parent = parent;
        entry.child = child;
        entry.cut = item.marked.is_some();
        let entry = self.scene.joints.get(instance.slot)?;
        if is_discontinuous(&self.scene, entry) {
            let at = item.name_at();
            return self.fail(say::no_common_measure(at, entry.law.keyword(), &name));
        }
        Some(())
    }

    /// The coordinates of a coupling. It sits where the joint of the one at `to` does.
    fn coupling_ends(&mut self, instance: &Instance<'_>, keyword: &str) -> JoinedPlaces {
        let scope = instance.scope(MayDependOn::Fixed);
        let both = ["to", "from"].map(|end| {
            let value = instance.item.clause(end)?;
            self.coupled_coordinate(value, keyword, scope)
        });
        let [Some(to), Some(from)] = both else {
            return JoinedPlaces::default();
        };
        if to == from {
            let at = instance
                .item
                .clause("to")
                .map_or(instance.item.at, |v| v.at);
            let name = self.scene.coordinate(to.0, to.1);
            let name = name.map_or_else(String::new, |(joint, coordinate)| {
                format!("{}.{}", joint.name, coordinate.name)
            });
            self.messages.push(say::couples_itself(at, keyword, &name));
            return JoinedPlaces::default();
        }
        let joint = self.scene.joints.get(to.0);
        JoinedPlaces {
            places: joint.map(|joint| [joint.parent, joint.child]),
            coordinates: Some([to, from]),
        }
    }

    fn joint_keyword(&mut self, value: ValueSyntax<'_>) -> Option<String> {
        let mut cursor = Cursor::new(value);
        let Some(Word { text, at }) = cursor.word() else {
            return self.fail(cursor.expected("the kind of the joint, such as `hinge`"));
        };
        if let Err(report) = cursor.finish("`from`") {
            return self.fail(report);
        }
        match JointLaw::KEYWORDS.contains(&text.as_str()) {
            true => Some(text),
            false => self.fail(say::joint_law(at.into(), &text)),
        }
    }

    /// The law of a keyword, with its fields.
    fn joint_law(
        &mut self,
        instance: &Instance<'_>,
        name: &str,
        (keyword, ends): (&str, JoinedPlaces),
        scope: Scope<'_>,
    ) -> Option<JointLaw> {
        let (kind, names) = field_words(keyword)?;
        if let Some(lost) = joint_forces::without_coordinate(&kind, &instance.item.block) {
            let at = lost.word.at.into();
            let couples = !kind.couples().is_empty();
            let report = say::no_single_coordinate(at, keyword, &lost.word.text, couples);
            return self.fail(report);
        }
        let fields = self.fields(&instance.item.block, &names);
        if let Some(value) = fields.value("coordinates") {
            self.choice(value, "coordinates of an attitude", &[("quaternion", ())])?;
        }
        // What is locked is known when every joint is.
        let detached = fields.value(AT_START).map_or(Some(false), |value| {
            let set = [("detached", true), ("attached", false), (LOCKED, false)];
            self.choice(value, "start of a joint", &set)
        });
        if detached? {
            self.starts_detached(Detachable::Joint(instance.slot));
        }
        let mut answers = Answers {
            wrong: fields.doubtful || instance.item.broken,
            resolver: self,
            fields,
            scope,
            keyword,
            name,
            at: instance.item.name_at(),
            ends,
        };
        let law = JointLaw::read(keyword, &mut answers)?;
        (!answers.wrong).then_some(law)
    }

    fn joint_end(&mut self, value: ValueSyntax<'_>, scope: Scope<'_>) -> Option<Place> {
        let place = self.place(value, scope)?;
        if let Place::Point(point) = place {
            let point = self.scene.points.get(point)?;
            if matches!(point.kind, PointKind::Node(_)) {
                let report = say::joint_on_massless(value.at, &point.name);
                return self.fail(report);
            }
        }
        Some(place)
    }

    /// A point with mass has no axes; most joints need some.
    fn axes_at(
        &mut self,
        law: &JointLaw,
        end: &'static str,
        place: Place,
        at: Region,
    ) -> Option<()> {
        let Place::Point(point) = place else {
            return Some(());
        };
        let side = usize::from(end == "to");
        let without = |(_, axes): &&(&str, [bool; 2])| !axes[side];
        let fitting: Vec<&str> = JointLaw::AXES
            .iter()
            .filter(without)
            .map(|(keyword, _)| *keyword)
            .collect();
        if fitting.contains(&law.keyword()) {
            return Some(());
        }
        let name = self.scene.points.get(point)?.name.clone();
        self.fail(say::joint_without_axes(
            at,
            law.keyword(),
            end,
            &name,
            &fitting,
        ))
    }

    /// `x`, `-z`, or a vector of numbers and consts.
    fn axis(
        &mut self,
        field: &str,
        value: ValueSyntax<'_>,
        default: Axis,
        scope: Scope<'_>,
    ) -> Option<Axis> {
        if let Some(axis) = by_letter(value) {
            return Some(axis);
        }
        let mut behind = Cursor::new(value);
        behind.sign('-');
        if behind
            .peek_word()
            .is_some_and(|word| self.names.get(word).is_none())
        {
            return self.fail(match letter_meant(value) {
                Some((at, meant)) => say::axis_in_capitals(at, meant),
                None => say::axis_wanted(value.at, field, &letter(default)),
            });
        }
        let scope = Scope {
            stage: MayDependOn::Constant,
            ..scope
        };
        let typed = self.value(value, scope)?;
        if !typed.vector {
            return self.fail(say::axis_wanted(typed.at, field, &letter(default)));
        }
        self.axis_of_vector(typed, field)
    }

    /// The axis that a vector of numbers and consts behind `word` is.
    pub(super) fn axis_of_vector(&mut self, typed: Typed, word: &str) -> Option<Axis> {
        let at = typed.at;
        let formula = self.fits(typed, word, true, units::NONE)?;
        let components = fold::components(formula, &self.scene)
            .map(|part| fold::at_defaults(&part, &self.scene).unwrap_or(f64::NAN));
        match Axis::new(components) {
            Some(axis) => Some(axis),
            None => self.fail(say::zero_axis(at)),
        }
    }
}

/// Whether the kind of a joint couples coordinates of other joints.
fn is_coupling(instance: &Instance<'_>) -> bool {
    let keyword = instance
        .item
        .clause(":")
        .and_then(|value| Cursor::new(value).word());
    let law = keyword.and_then(|word| JointLaw::read(&word.text, &mut LawFields::default()));
    law.is_some_and(|law| !law.couples().is_empty())
}

/// A joint by its keyword, and the names of all its fields.
pub fn field_words(keyword: &str) -> Option<(JointLaw, Vec<&'static str>)> {
    let mut names = LawFields(Vec::new());
    let kind = JointLaw::read(keyword, &mut names)?;
    let mut names = names.0;
    if kind.coordinates() > kind.freedoms() {
        names.push("coordinates");
    }
    names.extend(joint_forces::words(&kind));
    names.push(AT_START);
    Some((kind, names))
}

/// An axis written as a letter, with or without a sign.
pub(super) fn by_letter(value: ValueSyntax<'_>) -> Option<Axis> {
    let mut cursor = Cursor::new(value);
    let sign = if cursor.sign('-').is_some() {
        -1.0
    } else {
        1.0
    };
    let Axis(axis) = match cursor.word()?.text.as_str() {
        "x" => Axis::X,
        "y" => Axis::Y,
        "z" => Axis::Z,
        _ => return None,
    };
    cursor.at_end().then_some(())?;
    Axis::new(axis.map(|component| sign * component))
}

/// The axis whose capital letter a value is, and where that stands.
fn letter_meant(value: ValueSyntax<'_>) -> Option<(Region, &'static str)> {
    let mut cursor = Cursor::new(value);
    cursor.sign('-');
    let word = cursor.word().filter(|_| cursor.at_end())?;
    let mut axes = ["x", "y", "z"].into_iter();
    let meant = axes.find(|axis| word.text.eq_ignore_ascii_case(axis))?;
    Some((word.at.into(), meant))
}

/// How many axes a list of them has; `None`: it is one direction, if it is any.
fn count(value: ValueSyntax<'_>) -> Option<usize> {
    let mut cursor = Cursor::new(value);
    let parts = Cursor::new(cursor.group(Bracket::Square)?).comma_separated();
    let axes = |part: &ValueSyntax<'_>| {
        by_letter(*part).is_some() || Cursor::new(*part).group(Bracket::Square).is_some()
    };
    parts.iter().any(axes).then_some(parts.len())
}

/// An axis in the language: a letter where it is along one.
pub fn letter(axis: Axis) -> String {
    let Axis(components) = axis;
    for (name, Axis(unit)) in [("x", Axis::X), ("y", Axis::Y), ("z", Axis::Z)] {
        if components == unit {
            return name.to_string();
        }
        if components == unit.map(|component| -component) {
            return format!("-{name}");
        }
    }
    let [x, y, z] = components;
    format!("[{x:?}, {y:?}, {z:?}]")
}
