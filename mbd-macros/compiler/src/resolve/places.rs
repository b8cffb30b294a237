//! Places: the ends of joints and lines, the frames of bodies and of the world.

use mbd_scene::Place;

use super::{Named, Resolver, Scope};
use crate::lexeme::Region;
use crate::messages::{check as say_check, resolve as say};
use crate::syntax::expression::{self, PathStep};
use crate::syntax::{ValueSyntax, quantities};

impl Resolver<'_> {
    /// A frame of the world, and what follows it.
    pub(super) fn world_place<'s>(
        &mut self,
        first: &PathStep,
        rest: &'s [PathStep],
        scope: Scope<'_>,
    ) -> Option<(Place, &'s [PathStep])> {
        if first.index.is_some() {
            return self.fail(say::no_index(first.word.at.into(), "world"));
        }
        let Some((step, after)) = rest.split_first() else {
            return Some((Place::World(0), rest));
        };
        if let Some(entry) = self.world.get(&step.word.text).cloned() {
            let named = self.member(&entry, step, scope)?;
            self.mention(named, step.word.at);
            if let Named::WorldFrame(index) = named {
                return Some((Place::World(index), after));
            }
        }
        if quantities::FRAME_QUANTITIES.contains(&step.word.text.as_str()) {
            return Some((Place::World(0), rest));
        }
        let frames: Vec<&str> = self.world.words().collect();
        let report = say::unknown_world_frame(step.word.at.into(), &step.word.text, &frames);
        self.fail(report)
    }

    /// A frame of a body by its step.
    pub fn body_frame(&mut self, body: usize, step: &PathStep, scope: Scope<'_>) -> Option<usize> {
        let word = &step.word.text;
        if word == "com" && step.index.is_none() {
            return Some(0);
        }
        if let Some(entry) = self.frames.get(body).and_then(|f| f.get(word)).cloned() {
            let named = self.member(&entry, step, scope)?;
            self.mention(named, step.word.at);
            return match named {
                Named::Frame(_, frame) => Some(frame),
                _ => None,
            };
        }
        let owner = self.scene.bodies.get(body)?.name.clone();
        if self.broken.contains(&format!("{owner}.{word}")) {
            return None;
        }
        let frames = self.frame_words(body);
        let report = say::unknown_frame(step.word.at.into(), &owner, word, &frames);
        self.fail(report)
    }

    /// The frames of a body in the user's words, `com` last.
    pub(super) fn frame_words(&self, body: usize) -> Vec<String> {
        let mut words: Vec<String> = self
            .frames
            .get(body)
            .map(|frames| frames.words().map(str::to_string).collect())
            .unwrap_or_default();
        words.push("com".to_string());
        words
    }

    /// A place where a line or joint ends: `body.frame`, a point, `world`, `world.frame`.
    pub fn place(&mut self, value: ValueSyntax<'_>, scope: Scope<'_>) -> Option<Place> {
        let steps = match expression::path(value) {
            Ok(steps) => steps,
            Err(report) => return self.fail(report),
        };
        let (first, rest) = steps.split_first()?;
        let word = first.word.text.as_str();
        let place = if word == "world" {
            let (place, rest) = self.world_place(first, rest, scope)?;
            (place, rest)
        } else {
            match self.place_owner(first, scope)? {
                Named::Body(body) => {
                    let frame = match rest.first() {
                        Some(step) => self.body_frame(body, step, scope)?,
                        None => {
                            self.warn_of_body_as_place(body, (value.at, word));
                            0
                        }
                    };
                    let after = rest.get(1..).unwrap_or_default();
                    (Place::Body(body, frame), after)
                }
                Named::Point(point) => (Place::Point(point), behind_centre(rest)),
                other => return self.fail(say::no_place(value.at, word, other.kind())),
            }
        };
        match place.1.first() {
            None => Some(place.0),
            Some(extra) => self.fail(say::after_place(extra.word.at.into(), &extra.word.text)),
        }
    }

    /// A body stands for its centre of mass, as in a load; where it has frames of its own, one of them may be meant.
    fn warn_of_body_as_place(&mut self, body: usize, (at, word): (Region, &str)) {
        let mut frames = self.frame_words(body);
        frames.retain(|frame| frame != "com");
        if !frames.is_empty() {
            let report = say_check::body_as_place(at, word, &frames);
            self.warnings.push(report);
        }
    }

    /// What alone has a frame of this name.
    fn owner_of_frame(&self, word: &str) -> Option<String> {
        let world = self.world.get(word).map(|_| "world".to_owned());
        let bodies = self.scene.bodies.iter().zip(&self.frames);
        let of_bodies = bodies
            .filter(|(_, frames)| frames.get(word).is_some())
            .map(|(body, _)| body.name.clone());
        let mut owners = world.into_iter().chain(of_bodies);
        owners.next().filter(|_| owners.next().is_none())
    }

    /// The body or point at the start of a place.
    pub fn place_owner(&mut self, step: &PathStep, scope: Scope<'_>) -> Option<Named> {
        let word = &step.word.text;
        let Some(entry) = self.names.get(word).cloned() else {
            let mut known = self
                .names
                .words_of(|n| matches!(n, Named::Body(_) | Named::Point(_)));
            known.push("world");
            let owner = self.owner_of_frame(word);
            let report = say::unknown_place(step.word.at.into(), word, &known, owner.as_deref());
            return self.fail_unless_broken(word, report);
        };
        if self.broken.contains(word) {
            return None;
        }
        let named = self.member(&entry, step, scope)?;
        self.mention(named, step.word.at);
        Some(named)
    }
}

/// The steps behind the centre of mass of a point, which is the point.
pub(super) fn behind_centre(steps: &[PathStep]) -> &[PathStep] {
    match steps.split_first() {
        Some((first, rest)) if first.word.text == "com" && first.index.is_none() => rest,
        _ => steps,
    }
}
