//! Locks: coordinates that events hold where they are, and free again. Each is a joint of its own behind those that are declared.

use mbd_scene::joints::{JointLaw, Lock, START_RATE};
use mbd_scene::{Detachable, Formula, Joint};

use super::events::listed;
use super::{Instance, MayDependOn, Named, Resolver};
use crate::lexeme::Region;
use crate::messages::resolve as say;
use crate::syntax::words::{AT_START, LOCKED};
use crate::syntax::{Cursor, Item, ValueSyntax, expression};

impl Resolver<'_> {
    /// `boom`, `boom.angle` or `[boom, arm.slide]`: the locks of these coordinates, each named once in the event.
    pub(super) fn locks(
        &mut self,
        item: &Item<'_>,
        instance: &Instance<'_>,
        named: &mut Vec<(Detachable, Region)>,
    ) -> Option<Vec<Detachable>> {
        let mut all = Some(Vec::new());
        for part in listed(item.clause(":")?) {
            let Some(found) = self.coordinates_to(&item.word.text, part, instance) else {
                all = None;
                continue;
            };
            for (joint, index) in found {
                let lock = self.lock_of(joint, index, part.at);
                let what = Detachable::Joint(lock);
                if let Some((_, first)) = named.iter().find(|(other, _)| *other == what) {
                    let name = self.scene.locked(what).unwrap_or_default();
                    self.messages
                        .push(say::event_names_twice(part.at, &name, *first));
                    all = None;
                    continue;
                }
                named.push((what, part.at));
                if item.word.text == "free" {
                    self.freed.push((lock, part.at));
                }
                if let Some(list) = all.as_mut() {
                    list.push(what);
                }
            }
        }
        all
    }

    /// Locks coordinates of a joint from the start: all of them by its own field, or each in its block.
    pub(super) fn locked_at_start(
        &mut self,
        joint: usize,
        item: &Item<'_>,
        blocks: &[Vec<Item<'_>>],
    ) -> Option<()> {
        let is_locked = |item: &Item<'_>| {
            let word = item.clause(":").and_then(|value| Cursor::new(value).word());
            word.is_some_and(|word| word.text == LOCKED)
        };
        let declared = self.scene.joints.get(joint)?;
        let (name, keyword) = (declared.name.clone(), declared.law.keyword());
        let known: Vec<&str> = declared.law.measured().map(|it| it.name).collect();
        let driven: Vec<usize> = declared.motors().map(|(index, _)| index).collect();
        let begins = |item: &&Item<'_>| item.word.text == AT_START;
        let whole = item.block.iter().rfind(begins).filter(|it| is_locked(it));
        if let (Some(field), true) = (whole, known.is_empty()) {
            let at = field.word.at.into();
            return self.fail(say::nothing_to_lock(at, &name, keyword));
        }
        for (index, coordinate) in known.iter().enumerate() {
            let own = blocks
                .get(index)
                .and_then(|block| block.iter().rfind(begins));
            if let Some(value) = own.and_then(|field| field.clause(":")) {
                self.choice(
                    value,
                    "start of a coordinate",
                    &[(LOCKED, ()), ("free", ())],
                )?;
            }
            let own = own.map(|field| (is_locked(field), field));
            let Some((true, field)) = own.or_else(|| whole.map(|field| (true, field))) else {
                continue;
            };
            let at: Region = field.word.at.into();
            if driven.contains(&index) {
                return self.fail(say::driven_coordinate_locked(at, &name, coordinate));
            }
            let mut starts = self.scene.starts.coordinates.iter();
            let start = starts.find(|it| (it.joint, it.coordinate) == (joint, index));
            let rate = start.and_then(|start| start.rate.as_ref());
            if rate.is_some_and(|rate| *rate != Formula::Number(0.0)) {
                let of_block = blocks.get(index).map(Vec::as_slice).unwrap_or_default();
                let mut fields = of_block.iter().chain(&item.block);
                let field = fields.find(|field| field.word.text == START_RATE.name);
                let at = field.map_or(at, |field| field.word.at.into());
                return self.fail(say::rate_of_locked(at, &name, coordinate));
            }
            let lock = self.lock_of(joint, index, at);
            let what = Detachable::Joint(lock);
            self.scene.starts.detached.retain(|other| *other != what);
        }
        Some(())
    }

    /// Tells of coordinates that events free, or whose locks are asked for, and none locks.
    pub(super) fn unlocked(&mut self) {
        let asked = std::mem::take(&mut self.asked_of_locks);
        let freed = std::mem::take(&mut self.freed);
        if self.any_bad("event") {
            // What an event with a mistake of its own would lock is not known.
            return;
        }
        let say: [fn(Region, &str) -> _; 2] = [say::freed_never_locked, say::asked_never_locked];
        let freed = freed.into_iter().map(|one| (one, say[0]));
        let asked = asked.into_iter().map(|one| (one, say[1]));
        for ((lock, at), say) in freed.chain(asked) {
            let what = Detachable::Joint(lock);
            let held = self.scene.joints.get(lock);
            let is_bad = |&(joint, _): &(usize, usize)| self.bad.contains(&Named::Joint(joint));
            if held.is_some_and(|held| held.law.couples().iter().any(is_bad)) {
                // Its own `at_start` may be what is wrong.
                continue;
            }
            let locks = |attach: &Vec<Detachable>| attach.contains(&what);
            let mut events = self.scene.events.iter();
            let from_the_start = !self.scene.starts.detached.contains(&what);
            if !from_the_start && !events.any(|event| locks(&event.actions.attach)) {
                let name = self.scene.locked(what).unwrap_or_default();
                self.messages.push(say(at, &name));
            }
        }
    }

    /// The coordinates that a name says, all of a joint or one of them.
    fn coordinates_to(
        &mut self,
        action: &str,
        value: ValueSyntax<'_>,
        instance: &Instance<'_>,
    ) -> Option<Vec<(usize, usize)>> {
        let steps = match expression::path(value) {
            Ok(steps) => steps,
            Err(report) => return self.fail(report),
        };
        let (first, rest) = steps.split_first()?;
        let (word, at) = (&first.word.text, first.word.at.into());
        let Some(entry) = self.names.get(word).cloned() else {
            let known = self
                .names
                .words_of(|named| matches!(named, Named::Joint(_)));
            let report = say::no_joint_to(at, action, word, &known);
            return self.fail_unless_broken(word, report);
        };
        let named = self.member(&entry, first, instance.scope(MayDependOn::Live))?;
        let Named::Joint(joint) = named else {
            return self.fail(say::not_a_joint_to(at, action, word, named.kind()));
        };
        if self.bad.contains(&named) {
            return None;
        }
        self.mention(named, first.word.at);
        let declared = self.scene.joints.get(joint)?;
        let (name, keyword) = (declared.name.clone(), declared.law.keyword());
        let known: Vec<&str> = declared.law.measured().map(|it| it.name).collect();
        let driven: Vec<usize> = declared.motors().map(|(index, _)| index).collect();
        let (at_start, joined) = (&self.scene.starts.detached, Detachable::Joint(joint));
        if at_start.contains(&joined) || self.scene.is_detachable(joined) {
            return self.fail(say::detachable_joint_locked(value.at, &name));
        }
        let chosen: Vec<usize> = match rest {
            [] if known.is_empty() => {
                return self.fail(say::nothing_to_lock(value.at, &name, keyword));
            }
            [] => (0..known.len()).collect(),
            [step] => match known.iter().position(|known| *known == step.word.text) {
                Some(index) => vec![index],
                None => {
                    let at = step.word.at.into();
                    let report = match known.is_empty() {
                        true => say::nothing_to_lock(at, &name, keyword),
                        false => say::no_coordinate_to(at, &name, &step.word.text, &known),
                    };
                    return self.fail(report);
                }
            },
            [_, extra, ..] => {
                let at = extra.word.at.into();
                return self.fail(say::after_place(at, &extra.word.text));
            }
        };
        if let Some(index) = chosen.iter().find(|index| driven.contains(index)) {
            let coordinate = known.get(*index).copied().unwrap_or_default();
            return self.fail(say::driven_coordinate_locked(value.at, &name, coordinate));
        }
        Some(chosen.into_iter().map(|index| (joint, index)).collect())
    }

    /// The lock of a coordinate, by its number among the joints; it is made where it is named first.
    pub(super) fn lock_of(&mut self, joint: usize, index: usize, at: Region) -> usize {
        if let Some(known) = self.scene.lock_of(joint, index) {
            return known;
        }
        let law = JointLaw::Lock(Lock {
            couples: [(joint, index)],
        });
        let place = self.scene.joints.len();
        if let Some((owner, coordinate)) = self.scene.coordinate(joint, index) {
            let lock = Joint {
                name: format!("{}.{}.lock", owner.name, coordinate.name),
                doc: String::new(),
                law,
                parent: owner.parent,
                child: owner.child,
                forces: Vec::new(),
                cut: false,
            };
            self.scene.joints.push(lock);
            self.declared.insert(Named::Joint(place), at);
            self.mentioned.insert(Named::Joint(place));
            self.starts_detached(Detachable::Joint(place));
        }
        place
    }
}
