//! Scenes that go on where an event ends a run: their file, and what they take over under other names.

use mbd_scene::{MapSource, Mapped, Next, Place};

use super::events::{listed, piece};
use super::fields::ItemFields;
use super::{Instance, MayDependOn, Named, Resolver, Scope};
use crate::lexeme::{Lexeme, LexemeKind, Region};
use crate::messages::resolve as say;
use crate::syntax::ValueSyntax;
use crate::syntax::expression::{self, Expression};

/// Where an event names a scene that goes on.
#[derive(Clone, Debug)]
pub struct NextSceneRegion {
    /// The event, by index.
    pub event: usize,
    /// Where the file stands.
    pub file: Region,
    /// Per entry of the map where its name stands, and its value.
    pub map: Vec<[Region; 2]>,
}

impl Resolver<'_> {
    /// `then: stop` is no scene, `then: scene "descent.mbd"` is one, with its `map`.
    pub(super) fn end_of_event(
        &mut self,
        fields: &ItemFields<'_, '_>,
        instance: &Instance<'_>,
    ) -> Option<Option<Next>> {
        let file = match fields.value("then") {
            Some(value) => self.next_file(value)?,
            None => None,
        };
        let Some((file, at)) = file else {
            return match fields.get("map") {
                Some(item) => self.fail(say::map_without_scene(item.word.at.into())),
                None => Some(None),
            };
        };
        let mut going = NextSceneRegion {
            event: instance.slot,
            file: at,
            map: Vec::new(),
        };
        let map = match fields.value("map") {
            Some(value) => self.map(value, instance, &mut going.map),
            None => Some(Vec::new()),
        };
        self.going.push(going);
        Some(Some(Next { file, map: map? }))
    }

    /// The file of `scene "descent.mbd"`, and where it stands; nothing of `stop`.
    fn next_file(&mut self, value: ValueSyntax<'_>) -> Option<Option<(String, Region)>> {
        let is_scene = |lexeme: &Lexeme| lexeme.kind == LexemeKind::Word("scene".into());
        match value.lexemes {
            [
                word,
                Lexeme {
                    kind: LexemeKind::Text(file),
                    at,
                },
            ] if is_scene(word) => match file.trim().is_empty() {
                true => self.fail(say::scene_without_file(value.at)),
                false => Some(Some((file.clone(), (*at).into()))),
            },
            [word, ..] if is_scene(word) => self.fail(say::scene_without_file(value.at)),
            _ => {
                // `scene` is read above.
                let known = [("stop", ()), ("scene", ())];
                self.choice(value, "end of an event", &known).map(|()| None)
            }
        }
    }

    /// `probe = capsule.tip`, or `[probe = capsule.tip, charge = 0.9 * soc]`.
    fn map(
        &mut self,
        value: ValueSyntax<'_>,
        instance: &Instance<'_>,
        places: &mut Vec<[Region; 2]>,
    ) -> Option<Vec<Mapped>> {
        let mut map: Option<Vec<Mapped>> = Some(Vec::new());
        let mut firsts: Vec<(String, Region)> = Vec::new();
        for part in listed(value) {
            let Some((mapped, at)) = self.mapped(part, instance) else {
                map = None;
                continue;
            };
            if let Some((_, first)) = firsts.iter().find(|(name, _)| *name == mapped.name) {
                let report = say::event_names_twice(at[0], &mapped.name, *first);
                self.messages.push(report);
                map = None;
                continue;
            }
            firsts.push((mapped.name.clone(), at[0]));
            places.push(at);
            if let Some(list) = map.as_mut() {
                list.push(mapped);
            }
        }
        map
    }

    fn mapped(
        &mut self,
        part: ValueSyntax<'_>,
        instance: &Instance<'_>,
    ) -> Option<(Mapped, [Region; 2])> {
        let mut signs = part.lexemes.iter();
        let Some(sign) = signs.position(|lexeme| lexeme.kind == LexemeKind::Sign('=')) else {
            return self.fail(say::map_entry_wanted(part.at));
        };
        let [left, right] = [&part.lexemes[..sign], &part.lexemes[sign + 1..]];
        let [Some(left), Some(right)] = [left, right].map(piece) else {
            return self.fail(say::map_entry_wanted(part.at));
        };
        // A name of the other scene, which is not read yet.
        match expression::path(left) {
            Ok(steps) if steps.len() == 1 => {}
            Ok(_) => return self.fail(say::map_entry_wanted(left.at)),
            Err(report) => return self.fail(report),
        }
        let name = left.lexemes.iter().map(Lexeme::shown).collect();
        let from = self.map_source(right, instance)?;
        Some((Mapped { name, from }, [left.at, right.at]))
    }

    /// A body, a frame, a point or a place of the world; else a number.
    fn map_source(&mut self, value: ValueSyntax<'_>, instance: &Instance<'_>) -> Option<MapSource> {
        let scope = instance.scope(MayDependOn::Live);
        if let Ok(Expression::Path(steps)) = expression::whole(value)
            && let Some((first, rest)) = steps.split_first()
        {
            let word = first.word.text.as_str();
            let entry = self.names.get(word).cloned();
            let named = entry.and_then(|entry| entry.first());
            match (named, rest) {
                (Some(Named::Body(_)), []) => {
                    let Named::Body(body) = self.place_owner(first, scope)? else {
                        return None;
                    };
                    return Some(MapSource::Place(Place::Body(body, 0)));
                }
                (Some(Named::Body(body)), [frame]) if self.has_frame(body, &frame.word.text) => {
                    return self.place(value, scope).map(MapSource::Place);
                }
                (Some(Named::Point(_)), []) => {
                    return self.place(value, scope).map(MapSource::Place);
                }
                (None, []) if first.index.is_none() && self.is_unknown(word, scope) => {
                    let is_source = |named: Named| {
                        named.is_value() || matches!(named, Named::Body(_) | Named::Point(_))
                    };
                    let known = self.names.words_of(is_source);
                    let report = say::no_source(first.word.at.into(), word, &known);
                    return self.fail_unless_broken(word, report);
                }
                _ if word == "world" => return self.place(value, scope).map(MapSource::Place),
                _ => {}
            }
        }
        let typed = self.value(value, scope)?;
        if typed.vector {
            return self.fail_as_vector(&typed, "what a state or a param goes on with");
        }
        Some(MapSource::Value {
            dimension: typed.dimension,
            value: typed.formula,
        })
    }

    /// Whether a word is none that every scene has, and no index.
    fn is_unknown(&self, word: &str, scope: Scope<'_>) -> bool {
        let index = scope.indices.iter().any(|(name, _)| name == word);
        !index && !["time", "pi", "world", "energy"].contains(&word)
    }

    fn has_frame(&self, body: usize, word: &str) -> bool {
        let frames = self.frames.get(body);
        frames.is_some_and(|frames| frames.get(word).is_some())
    }
}
