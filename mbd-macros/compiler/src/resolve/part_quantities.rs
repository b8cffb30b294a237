//! What can be asked of bodies, frames, points and lines: `capsule.position`, `bob.vx`, `riser.tension`.

use mbd_scene::{Formula, Place, PointKind};

use super::places::behind_centre;
use super::{MayDependOn, Resolver, Scope, Typed, fold};
use crate::lexeme::Region;
use crate::messages::resolve as say;
use crate::syntax::expression::PathStep;
use crate::syntax::quantities;
use crate::units;

impl Resolver<'_> {
    pub(super) fn body_quantity(
        &mut self,
        body: usize,
        rest: &[PathStep],
        at: Region,
        scope: Scope<'_>,
    ) -> Option<Typed> {
        let owner = &self.scene.bodies.get(body)?.name.clone();
        self.live(scope, at, &format!("the motion of `{owner}`"))?;
        let Some((step, after)) = rest.split_first() else {
            return self.fail(say::body_without_quantity(at, owner));
        };
        let word = step.word.text.as_str();
        let angular = match word {
            "omega_body" => Some(Formula::AngularVelocityBody(body)),
            "omega_world" => Some(Formula::AngularVelocityWorld(body)),
            _ => None,
        };
        if let Some(formula) = angular {
            let omega = Typed {
                angle: 1,
                ..Typed::of(formula, true, units::RATE, at)
            };
            return self.tail(omega, after);
        }
        if word == "orientation" || word == "angle" {
            let turn = Formula::Orientation(body);
            let (formula, vector) = match (word, self.scene.planar) {
                ("angle", Some(plane)) => (Formula::Component(vec![turn], plane.normal()), false),
                ("angle", None) => {
                    let report = say::angle_in_space(step.word.at.into(), owner);
                    return self.fail(report);
                }
                _ => (turn, true),
            };
            let rotated = Typed {
                angle: 1,
                ..Typed::of(formula, vector, units::NONE, at)
            };
            return self.tail(rotated, after);
        }
        if word == "angular_acceleration" {
            self.follows(scope, step, owner)?;
            let formula = Formula::AngularAcceleration(body);
            let spin = Typed {
                angle: 1,
                ..Typed::of(formula, true, units::ANGULAR_ACCELERATION, at)
            };
            return self.tail(spin, after);
        }
        if word == "mass" {
            let mass = self.scene.bodies.get(body)?.mass.clone();
            return self.tail(Typed::of(mass, false, units::MASS, at), after);
        }
        let has_frame = self.frame_words(body).iter().any(|frame| frame == word);
        let along = !has_frame && quantities::component_of(word).is_some();
        if along || quantities::BODY_QUANTITIES.contains(&word) {
            return self.frame_quantity(Place::Body(body, 0), owner, rest, at, scope);
        }
        if !has_frame {
            let frames = self.frame_words(body);
            let (all, of_planes) = (quantities::BODY_QUANTITIES, quantities::PLANAR_BODY.len());
            let known = match self.scene.planar {
                Some(_) => all,
                None => all.get(..all.len() - of_planes).unwrap_or(all),
            };
            let at = step.word.at.into();
            let report = say::unknown_body_quantity(at, owner, word, &frames, known);
            let frame = format!("{owner}.{word}");
            return self.fail_unless_broken(&frame, report);
        }
        let frame = self.body_frame(body, step, scope)?;
        let name = format!("{owner}.{word}");
        self.frame_quantity(Place::Body(body, frame), &name, after, at, scope)
    }

    /// Position, velocity or an axis of a frame.
    pub(super) fn frame_quantity(
        &mut self,
        place: Place,
        owner: &str,
        rest: &[PathStep],
        at: Region,
        scope: Scope<'_>,
    ) -> Option<Typed> {
        self.live(scope, at, &format!("the motion of `{owner}`"))?;
        let Some((step, after)) = rest.split_first() else {
            return self.fail(say::frame_without_quantity(at, owner));
        };
        if let Some((quantity, axis)) = quantities::component_of(&step.word.text) {
            return self.place_component((place, quantity, axis), at, after);
        }
        let (formula, dimension) = match step.word.text.as_str() {
            "position" => (Formula::Position(place), units::LENGTH),
            "velocity" => (Formula::Velocity(place), units::SPEED),
            "acceleration" => {
                self.follows(scope, step, owner)?;
                (Formula::Acceleration(place), units::ACCELERATION)
            }
            "x" => (Formula::Axis(place, 0), units::NONE),
            "y" => (Formula::Axis(place, 1), units::NONE),
            "z" => (Formula::Axis(place, 2), units::NONE),
            word => {
                let known = quantities::FRAME_QUANTITIES;
                let report = say::unknown_quantity(step.word.at.into(), owner, word, known);
                return self.fail(report);
            }
        };
        self.tail(Typed::of(formula, true, dimension, at), after)
    }

    /// `bob.vx` as the state and its histories call it, `bob.velocity.x`.
    fn place_component(
        &mut self,
        (place, quantity, axis): (Place, &str, usize),
        at: Region,
        after: &[PathStep],
    ) -> Option<Typed> {
        let (of, dimension) = match quantity {
            "velocity" => {
                self.rates_asked.push((Formula::Velocity(place), at));
                (Formula::Velocity(place), units::SPEED)
            }
            _ => (Formula::Position(place), units::LENGTH),
        };
        let formula = fold::component(of, axis, &self.scene);
        self.tail(Typed::of(formula, false, dimension, at), after)
    }

    pub(super) fn point_quantity(
        &mut self,
        point: usize,
        owner: &str,
        rest: &[PathStep],
        at: Region,
        scope: Scope<'_>,
    ) -> Option<Typed> {
        let place = Place::Point(point);
        let known = quantities::POINT_QUANTITIES;
        let Some((step, after)) = behind_centre(rest).split_first() else {
            return self.fail(say::without_quantity(at, owner, "point", known));
        };
        let word = step.word.text.as_str();
        let along = quantities::component_of(word)
            .or_else(|| quantities::axis_of(word).map(|axis| ("position", axis)));
        if let Some((quantity, axis)) = along {
            return self.place_component((place, quantity, axis), at, after);
        }
        let (formula, dimension) = match step.word.text.as_str() {
            "position" => (Formula::Position(place), units::LENGTH),
            "velocity" => {
                self.rates_asked.push((Formula::Velocity(place), at));
                (Formula::Velocity(place), units::SPEED)
            }
            "acceleration" => {
                let here = step.word.at.into();
                if !matches!(self.scene.points.get(point)?.kind, PointKind::Mass(_)) {
                    return self.fail(say::massless_acceleration(here, owner));
                }
                self.follows(scope, step, owner)?;
                (Formula::Acceleration(place), units::ACCELERATION)
            }
            word => {
                let report = say::unknown_quantity(step.word.at.into(), owner, word, known);
                return self.fail(report);
            }
        };
        self.tail(Typed::of(formula, true, dimension, at), after)
    }

    /// What follows from the accelerations is an error in what they depend on.
    pub fn follows(&mut self, scope: Scope<'_>, step: &PathStep, owner: &str) -> Option<()> {
        if scope.stage == MayDependOn::Result {
            return Some(());
        }
        let (at, word) = (step.word.at.into(), &step.word.text);
        self.fail(say::motor_as_cause(at, owner, word))
    }

    pub(super) fn line_quantity(
        &mut self,
        line: usize,
        owner: &str,
        rest: &[PathStep],
        at: Region,
    ) -> Option<Typed> {
        let known = quantities::LINE_QUANTITIES;
        let Some((step, after)) = rest.split_first() else {
            return self.fail(say::without_quantity(at, owner, "line", known));
        };
        let (formula, dimension) = match step.word.text.as_str() {
            "tension" => (Formula::Tension(line), units::FORCE),
            "length" => (Formula::Length(line), units::LENGTH),
            "stretch" => (Formula::Stretch(line), units::LENGTH),
            "stretch_rate" => {
                self.rates_asked.push((Formula::StretchRate(line), at));
                (Formula::StretchRate(line), units::SPEED)
            }
            word => {
                let report = say::unknown_quantity(step.word.at.into(), owner, word, known);
                return self.fail(report);
            }
        };
        self.tail(Typed::of(formula, false, dimension, at), after)
    }
}
