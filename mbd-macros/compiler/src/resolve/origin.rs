//! The origin of positions: that of the world, or one that follows a body or a point with mass.

use mbd_scene::{Detachable, Part, Place, PointKind};

use super::{MayDependOn, Named, Resolver, Scope};
use crate::lexeme::Region;
use crate::messages::resolve as say;
use crate::syntax::{Cursor, ModelSyntax, ValueSyntax, expression};

impl Resolver<'_> {
    /// What the origin follows, once everything that moves is known, and what holds it.
    pub fn origin(&mut self, model: &ModelSyntax<'_>) {
        let item = model.items.iter().find(|item| item.word.text == "origin");
        if let Some(value) = item.and_then(|item| item.clause(":"))
            && let Some(part) = self.followed(value)
            && self.goes_far(part, value.at)
        {
            self.scene.runs.origin = Some(part);
        }
    }

    fn followed(&mut self, value: ValueSyntax<'_>) -> Option<Part> {
        const FORM: &str = "`follows` and the name of a body or a point with mass";
        let mut cursor = Cursor::new(value);
        if cursor.keyword("follows").is_none() || cursor.at_end() {
            return self.fail(cursor.expected(FORM));
        }
        let start = cursor;
        while cursor.take().is_some() {}
        let of = cursor.since(start);
        let steps = match expression::path(of) {
            Ok(steps) => steps,
            Err(report) => return self.fail(report),
        };
        let (first, rest) = steps.split_first()?;
        let word = first.word.text.as_str();
        if word == "world" {
            return self.fail(say::origin_of_the_world(of.at));
        }
        const FIXED: Scope<'static> = Scope {
            stage: MayDependOn::Fixed,
            indices: &[],
        };
        let owner = self.place_owner(first, FIXED)?;
        if let Some(extra) = rest.first() {
            let (at, extra) = (extra.word.at.into(), &extra.word.text);
            return self.fail(say::origin_follows_a_whole(at, word, extra));
        }
        match owner {
            Named::Body(body) => Some(Part::Body(body)),
            Named::Point(point) => {
                let declared = self.scene.points.get(point);
                match declared.map(|point| &point.kind) {
                    Some(PointKind::Node(_)) => self.fail(say::origin_without_mass(of.at, word)),
                    _ => Some(Part::Point(point)),
                }
            }
            other => self.fail(say::origin_of(of.at, word, other.kind())),
        }
    }

    /// Whether no joint that lasts holds to the world what is followed, or what it hangs together with; `free` ones hold nothing.
    fn goes_far(&mut self, followed: Part, at: Region) -> bool {
        let part = |place: Place| match place {
            Place::World(_) => None,
            Place::Body(body, _) => Some(Part::Body(body)),
            Place::Point(point) => Some(Part::Point(point)),
        };
        let lasting = self
            .scene
            .joints
            .iter()
            .enumerate()
            .filter(|(index, joint)| {
                let holds = joint.law.rows() > 0 || !joint.forces.is_empty();
                let holds = holds && joint.law.couples().is_empty();
                holds && !self.scene.is_detachable(Detachable::Joint(*index))
            });
        let ends = lasting.map(|(_, joint)| (joint, [joint.parent, joint.child].map(part)));
        let ends: Vec<_> = ends.collect();
        let mut together = vec![followed];
        let mut next = 0;
        while let Some(&part) = together.get(next) {
            next += 1;
            for (joint, [a, b]) in &ends {
                let other = match (*a, *b) {
                    (Some(own), other) | (other, Some(own)) if own == part => other,
                    _ => continue,
                };
                match other {
                    None => {
                        let report = say::origin_tied(at, &joint.name);
                        self.messages.push(report);
                        return false;
                    }
                    Some(other) if !together.contains(&other) => together.push(other),
                    Some(_) => {}
                }
            }
        }
        true
    }
}
