//! Settings of the whole model: coordinates, units, gravity, what is generated.

use mbd_scene::joints::Axis;
use mbd_scene::{AngularVelocity, Coordinates, Dimension, Formula, Gravity, Place, Plane, Triple};

use super::fields::Accept;
use super::joints::by_letter;
use super::{Emitted, MayDependOn, Resolver, Scope, fold};
use crate::lexeme::{Bracket, Region};
use crate::messages::similar::nearest;
use crate::messages::{LexemeMessage, resolve as say, syntax as say_syntax};
use crate::syntax::expression::{self, Expression};
use crate::syntax::item::items;
use crate::syntax::{Cursor, Item, ModelSyntax, ValueSyntax, words};
use crate::units;

/// What may follow an emitted quantity.
const NEXT: &str = "`,` and the next quantity";

/// The quantity that may name what it is of.
const FRAME_JACOBIAN: &str = "frame_jacobian";

/// Settings are made of numbers, consts and params.
const FIXED: Scope<'static> = Scope {
    stage: MayDependOn::Fixed,
    indices: &[],
};

impl Resolver<'_> {
    /// Everything but gravity, which may use params.
    pub fn settings(&mut self, model: &ModelSyntax<'_>) {
        self.repeated_settings(model);
        for item in &model.items {
            let value = item.clause(":");
            match (item.word.text.as_str(), value) {
                ("verify", _) => self.asked.verify = true,
                ("units", Some(value)) => {
                    self.si = self
                        .choice(value, "system of units", &[("si", true)])
                        .is_some();
                }
                ("coordinates", Some(value)) => {
                    let set = [
                        ("absolute", Some(Coordinates::Absolute)),
                        ("relative", Some(Coordinates::Relative)),
                        ("auto", None),
                    ];
                    match self.choice(value, "kind of coordinates", &set) {
                        Some(Some(chosen)) => self.scene.coordinates = chosen,
                        Some(None) => self.asked.family = true,
                        None => {}
                    }
                }
                ("angular_velocity", Some(value)) => {
                    let set = [
                        ("body", AngularVelocity::Body),
                        ("world", AngularVelocity::World),
                    ];
                    if let Some(chosen) = self.choice(value, "angular velocity", &set) {
                        self.scene.angular_velocity = chosen;
                    }
                }
                ("planar", Some(value)) => {
                    let planes = Plane::WORDS.map(|(word, plane)| (word, Some(plane)));
                    let set: Vec<_> = planes.into_iter().chain([("auto", None)]).collect();
                    match self.choice(value, "plane", &set) {
                        Some(Some(plane)) => self.scene.planar = Some(plane),
                        Some(None) => self.asked.plane = true,
                        None => {}
                    }
                }
                _ => {}
            }
        }
    }

    /// Each setting at most once.
    fn repeated_settings(&mut self, model: &ModelSyntax<'_>) {
        for (k, item) in model.items.iter().enumerate() {
            let single = item.name.is_none()
                && words::find(&item.word.text, false).is_some_and(|spec| !spec.named);
            if !single {
                continue;
            }
            let mut earlier = model.items.iter().take(k);
            if let Some(first) = earlier.find(|other| other.word.text == item.word.text) {
                let (at, first) = (item.word.at.into(), first.word.at.into());
                self.messages
                    .push(say_syntax::repeated_clause(at, &item.word.text, first));
            }
        }
    }

    /// The fields between braces inside a value.
    pub fn block<'b>(&mut self, group: ValueSyntax<'b>) -> Vec<Item<'b>> {
        items(Cursor::new(group), true, &mut self.messages)
    }

    /// The acceleration of gravity; there is no default.
    pub fn gravity(&mut self, model: &ModelSyntax<'_>) {
        let item = model.items.iter().find(|item| item.word.text == "gravity");
        let Some(item) = item else {
            // One that is misspelt is told where it stands.
            let mut words = model.items.iter().map(|item| item.word.text.as_str());
            if !words.any(|word| {
                words::find(word, false).is_none() && nearest(word, ["gravity"]).is_some()
            }) {
                self.messages.push(say::no_gravity(self.head));
            }
            return;
        };
        if let Some(value) = item.clause(":")
            && let Some(gravity) = self.gravity_law(value)
        {
            self.scene.gravity = gravity;
        }
    }

    fn gravity_law(&mut self, value: ValueSyntax<'_>) -> Option<Gravity> {
        const LAWS: &[&str] = &["none", "field", "point_mass", "oblate"];
        let mut cursor = Cursor::new(value);
        let word = cursor.word();
        let law = match word.as_ref().map(|word| word.text.as_str()) {
            None => {
                if let Some(report) = one_number(value) {
                    return self.fail(report);
                }
                let acceleration = self.triple("gravity", value, units::ACCELERATION, FIXED)?;
                return Some(Gravity::Uniform { acceleration });
            }
            Some("none") => Gravity::None,
            Some("field") => Gravity::Field,
            Some("point_mass" | "oblate") => {
                let oblate = word.is_some_and(|word| word.text == "oblate");
                let Some(group) = cursor.group(Bracket::Brace) else {
                    return self.fail(cursor.expected("`{ mu: …, center: … }`"));
                };
                self.planet(group, oblate)?
            }
            Some(other) => return self.fail(say::unknown_gravity(value.at, other, LAWS)),
        };
        match cursor.finish("the end of the gravity") {
            Ok(()) => Some(law),
            Err(report) => self.fail(report),
        }
    }

    /// A point mass, or one with the J2 term.
    fn planet(&mut self, group: ValueSyntax<'_>, oblate: bool) -> Option<Gravity> {
        let known: &[&str] = if oblate {
            &["mu", "center", "radius", "j2", "axis"]
        } else {
            &["mu", "center"]
        };
        let block = self.block(group);
        let fields = self.fields(&block, known);
        if fields.doubtful {
            return None;
        }
        let mu = self.positive("mu", fields.value("mu"), units::GRAVITATIONAL, group.at);
        let center = self.vector_of("center", fields.value("center"), units::LENGTH, group.at);
        if !oblate {
            return Some(Gravity::PointMass {
                mu: mu?,
                center: center?,
            });
        }
        let radius = self.positive("radius", fields.value("radius"), units::LENGTH, group.at);
        let j2 = self.number_of("j2", fields.value("j2"), units::NONE, group.at);
        let axis = match fields.value("axis").and_then(by_letter) {
            Some(Axis(axis)) => Some(axis.map(Formula::Number)),
            None => self
                .vector_of("axis", fields.value("axis"), units::NONE, group.at)
                .and_then(|axis| self.direction(axis, fields.value("axis"))),
        };
        Some(Gravity::Oblate {
            mu: mu?,
            center: center?,
            radius: radius?,
            j2: j2?,
            axis: axis?,
        })
    }

    /// A unit vector, with all params at their defaults.
    fn direction(&mut self, axis: Triple, value: Option<ValueSyntax<'_>>) -> Option<Triple> {
        let parts: Vec<f64> = axis
            .iter()
            .filter_map(|part| fold::at_defaults(part, &self.scene))
            .collect();
        let square: f64 = parts.iter().map(|part| part * part).sum();
        match value {
            Some(value) if parts.len() == 3 && (square - 1.0).abs() > 1e-9 => {
                self.fail(say::no_direction(value.at, square.sqrt()))
            }
            _ => Some(axis),
        }
    }

    /// A positive number that the law needs.
    fn positive(
        &mut self,
        field: &str,
        value: Option<ValueSyntax<'_>>,
        wanted: Dimension,
        whole: Region,
    ) -> Option<Formula> {
        match value {
            Some(value) => self.quantity("gravity", field, value, wanted, Accept::Positive, FIXED),
            None => self.fail(say::gravity_field(whole, field, wanted)),
        }
    }

    fn vector_of(
        &mut self,
        field: &str,
        value: Option<ValueSyntax<'_>>,
        wanted: Dimension,
        whole: Region,
    ) -> Option<Triple> {
        match value {
            Some(value) => self.triple(field, value, wanted, FIXED),
            None => self.fail(say::gravity_field(whole, field, wanted)),
        }
    }

    /// A scalar that the law needs.
    fn number_of(
        &mut self,
        field: &str,
        value: Option<ValueSyntax<'_>>,
        wanted: Dimension,
        whole: Region,
    ) -> Option<Formula> {
        let Some(value) = value else {
            return self.fail(say::gravity_field(whole, field, wanted));
        };
        let typed = self.value(value, FIXED)?;
        self.fits(typed, field, false, wanted)
    }

    /// What is emitted: kinds of quantities, and Jacobians of frames by the place that they are of.
    pub fn emitted(&mut self, model: &ModelSyntax<'_>) {
        let item = model.items.iter().find(|item| item.word.text == "emit");
        let Some(value) = item.and_then(|item| item.clause(":")) else {
            return;
        };
        let Some(list) = Cursor::new(value).group(Bracket::Square) else {
            let wanted = "a list such as `[derivative, outputs]`";
            return self.messages.push(Cursor::new(value).expected(wanted));
        };
        let parts = Cursor::new(list).comma_separated().into_iter();
        let asked: Vec<Emitted> = parts
            .filter_map(|part| self.emitted_quantity(part))
            .collect();
        self.asked.emit = Some(asked);
    }

    fn emitted_quantity(&mut self, value: ValueSyntax<'_>) -> Option<Emitted> {
        let mut cursor = Cursor::new(value);
        let Some(word) = cursor.word() else {
            return self.fail(cursor.expected("a quantity such as `outputs`"));
        };
        if !words::EMITTED.contains(&word.text.as_str()) {
            let at = word.at.into();
            return self.fail(say::unknown_word(
                at,
                "quantity",
                &word.text,
                words::EMITTED,
            ));
        }
        if word.text == FRAME_JACOBIAN
            && let Some(place) = cursor.group(Bracket::Round)
        {
            if let Err(report) = cursor.finish(NEXT) {
                return self.fail(report);
            }
            return match self.place(place, FIXED)? {
                Place::Body(body, frame) => Some(Emitted::FrameJacobian(body, frame)),
                _ => self.fail(say::frame_of_a_body(place.at)),
            };
        }
        match cursor.finish(NEXT) {
            Ok(()) => Some(Emitted::Kind(word.text)),
            Err(report) => self.fail(report),
        }
    }
}

/// The report of a gravity that is one number, `9.81 m/s^2`, whatever stands behind it.
fn one_number(value: ValueSyntax<'_>) -> Option<LexemeMessage> {
    let parsed = expression::prefix(&mut Cursor::new(value)).ok()?;
    let number = match parsed {
        Expression::Negative(inner, _) => *inner,
        number => number,
    };
    match number {
        Expression::Number { text, unit, .. } => {
            let unit = unit.map_or_else(|| units::si_text(units::ACCELERATION), |unit| unit.text);
            Some(say::gravity_of_one(value.at, &text, &unit))
        }
        _ => None,
    }
}
