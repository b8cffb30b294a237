//! Events: the passage of a value, and what happens then.

use mbd_scene::joints::{JointForces, JointLaw};
use mbd_scene::{
    Actions, Detachable, Direction, Formula, Function, Joint, Place, Settable, Setting, Unit,
};

use super::{Instance, MayDependOn, Named, Resolver, Scope, fold};
use crate::lexeme::{Bracket, Lexeme, LexemeKind, Region};
use crate::messages::similar::nearest;
use crate::messages::{LexemeMessage, resolve as say, syntax as say_syntax};
use crate::syntax::expression::{self, Expression, PathStep};
use crate::syntax::{Cursor, Item, ValueSyntax, Word, foreign, words};
use crate::units;

/// The words for a passage.
const PASSAGES: [(&str, Direction); 3] = [
    ("crosses", Direction::Crosses),
    ("rises", Direction::Rises),
    ("falls", Direction::Falls),
];

/// The field of an event that was meant for its passage, such as the key `fall` in TOML, and that passage.
fn passage_among_fields<'i>(item: &'i Item<'_>) -> Option<(&'i Word, &'static str)> {
    let known = || PASSAGES.map(|(word, _)| word);
    let mut words = item.block.iter().map(|field| &field.word);
    words.find_map(|word| Some((word, nearest(&word.text, known())?)))
}

/// What an event sets: a number, or the components of a vector.
struct EventTarget {
    what: Vec<Settable>,
    vector: bool,
    name: String,
    unit: Unit,
    range: Option<[f64; 2]>,
    at: Region,
}

impl Resolver<'_> {
    /// Fills the events.
    pub fn events(&mut self) {
        for instance in self.of("event") {
            self.poison(Named::Event(instance.slot), |this| this.event(&instance));
        }
    }

    fn event(&mut self, instance: &Instance<'_>) -> Option<()> {
        let item = instance.item;
        let scope = instance.scope(MayDependOn::Result);
        let guard = item.clause("=")?;
        let mut lexemes = guard.lexemes.iter();
        let compared = lexemes.find_map(|lexeme| match lexeme.kind {
            LexemeKind::Sign('<') => Some(("<", lexeme.at)),
            LexemeKind::Sign('>') => Some((">", lexeme.at)),
            LexemeKind::Sign('=') => Some(("==", lexeme.at)),
            _ => None,
        });
        let conditional = guard
            .lexemes
            .iter()
            .any(|l| l.kind == LexemeKind::Word("if".into()));
        if let (Some((sign, at)), false) = (compared, conditional) {
            let joins = |pair: &[Lexeme]| {
                let signs = ['&', '|'].map(LexemeKind::Sign);
                matches!(pair, [a, b] if a.kind == b.kind && signs.contains(&a.kind))
            };
            let word = |lexeme: &Lexeme| ["and", "or"].contains(&lexeme.shown().as_str());
            let several = guard.lexemes.windows(2).any(joins) || guard.lexemes.iter().any(word);
            return self.fail(say_syntax::event_compares(at.into(), sign, several));
        }
        if let [word, number, rest @ ..] = guard.lexemes
            && let (LexemeKind::Word(at), LexemeKind::Number(_)) = (&word.kind, &number.kind)
            && ["at", "when", "after"].contains(&at.as_str())
        {
            let time: Vec<String> = [number]
                .into_iter()
                .chain(rest)
                .map(Lexeme::shown)
                .collect();
            return self.fail(say_syntax::event_at_time(guard.at, &time.join(" ")));
        }
        if let Some(report) = passage_in_value(&guard) {
            return self.fail(report);
        }
        let left = self.value(guard, scope);
        let mut passages = PASSAGES
            .into_iter()
            .filter_map(|(sign, direction)| item.given(sign).map(|given| (given, direction)));
        let Some((given, direction)) = passages.next() else {
            if item.broken || left.is_none() {
                return None;
            }
            return self.fail(match passage_among_fields(item) {
                Some((field, ours)) if field.text == ours => say_syntax::clause_behind_braces(
                    field.at.into(),
                    words::find("event", false)?,
                    ours,
                ),
                Some((field, ours)) => say::misspelt_passage(field.at.into(), &field.text, ours),
                None => say::event_without_value(item.name_at()),
            });
        };
        if let Some((extra, _)) = passages.next() {
            return self.fail(say::event_twice(extra.at));
        }
        let second = given.value.lexemes.first().zip(given.value.lexemes.get(1));
        if let Some((word, _)) = second
            && let LexemeKind::Word(text) = &word.kind
            && ["below", "above", "under", "over", "through", "to"].contains(&text.as_str())
            && self.names.get(text).is_none()
        {
            return self.fail(say_syntax::word_behind_passage(
                word.at.into(),
                given.sign,
                text,
            ));
        }
        let right = self.value(given.value, scope)?;
        let left = left?;
        if left.vector {
            return self.fail_as_vector(&left, "an event");
        }
        if let (Some(wanted), Some(found)) = (left.dimension, right.dimension)
            && wanted != found
        {
            return self.fail(match &right.bare {
                Some(text) if found == units::NONE => {
                    say::needs_unit(right.at, given.sign, wanted, text)
                }
                _ => say::wrong_dimension(right.at, given.sign, wanted, found),
            });
        }
        self.bare_beside_output(guard, &right, instance)?;
        let guard = if right.formula == Formula::Number(0.0) {
            left.formula
        } else {
            let at = left.at.to(right.at);
            self.alike(Function::Sub, left, right, at)?.formula
        };
        let actions = self.actions(instance);
        let entry = self.scene.events.get_mut(instance.slot)?;
        entry.guard = guard;
        entry.direction = direction;
        entry.actions = actions?;
        Some(())
    }

    /// What stands between the braces of an event.
    fn actions(&mut self, instance: &Instance<'_>) -> Option<Actions> {
        let known = words::find("event", false)?.fields?;
        let fields = self.fields(&instance.item.block, known);
        let set = fields
            .get("set")
            .map(|item| self.set_numbers(item, instance));
        let mut named: Vec<(Detachable, Region)> = Vec::new();
        let [detach, attach] = ["detach", "attach"].map(|word| {
            let item = fields.get(word);
            item.map_or(Some(Vec::new()), |item| {
                self.detachables(item, instance, &mut named)
            })
        });
        let [free, lock] = ["free", "lock"].map(|word| {
            let item = fields.get(word);
            item.map_or(Some(Vec::new()), |item| {
                self.locks(item, instance, &mut named)
            })
        });
        let end = self.end_of_event(&fields, instance);
        let once = fields.value("acts").map_or(Some(false), |value| {
            let set = [("once", true), ("always", false)];
            self.choice(value, "count of an event", &set)
        });
        let actions = Actions {
            set: set.unwrap_or(Some(Vec::new()))?,
            detach: [detach?, free?].concat(),
            attach: [attach?, lock?].concat(),
            stop: fields.get("then").is_some(),
            next: end?,
            once: once?,
        };
        (!fields.doubtful).then_some(actions)
    }

    /// Remembers that something is detached at the start.
    pub fn starts_detached(&mut self, what: Detachable) {
        let starts = &mut self.scene.starts.detached;
        let place = starts.partition_point(|other| *other < what);
        starts.insert(place, what);
    }

    /// Tells of joints that start detached and cannot be.
    pub fn detached_starts(&mut self) {
        for what in self.scene.starts.detached.clone() {
            if let Detachable::Joint(joint) = what
                && let Some(at) = self.declared.get(&Named::Joint(joint)).copied()
            {
                self.detachable_joint(joint, at);
            }
        }
    }

    /// Tells of what events attach although nothing detaches it, and of what begins detached and no event attaches. Scenes that go on may hand over what
    /// is detached.
    pub fn never_detached(&mut self) {
        let attached = std::mem::take(&mut self.attached);
        if self.any_bad("event") || self.dropped.contains("event") {
            return;
        }
        let (scene, starts) = (&self.scene, &self.scene.starts.detached);
        let detaches = |what| {
            let mut events = scene.events.iter();
            events.any(|event| event.actions.detach.contains(&what))
        };
        let never = attached
            .into_iter()
            .filter(|(what, _)| !starts.contains(what) && !detaches(*what));
        let mut reports: Vec<_> = never
            .map(|(what, at)| say::attached_never_detached(at, scene.detachable_name(what)))
            .collect();
        let goes_on = scene.events.iter().any(|event| event.actions.stop);
        for &what in starts.iter().filter(|_| !goes_on) {
            let named = match what {
                Detachable::Line(line) => Named::Line(line),
                Detachable::Joint(joint) => Named::Joint(joint),
            };
            let mut events = scene.events.iter();
            let attaches = events.any(|event| event.actions.attach.contains(&what));
            let at = self
                .declared
                .get(&named)
                .filter(|_| !self.bad.contains(&named));
            if let (Some(&at), false, None) = (at, attaches, scene.locked(what)) {
                let kind = match what {
                    Detachable::Line(line) => {
                        scene.lines.get(line).map_or("line", |it| it.kind.word())
                    }
                    Detachable::Joint(_) => "joint",
                };
                let name = scene.detachable_name(what);
                reports.push(say::detached_for_good(at, kind, name));
            }
        }
        reports
            .into_iter()
            .for_each(|report| self.warnings.push(report));
    }

    /// Refuses joints that are not bare enough to be detached.
    fn detachable_joint(&mut self, joint: usize, at: Region) -> Option<()> {
        let declared = self.scene.joints.get(joint)?;
        let name = declared.name.clone();
        let holds = declared.law.rows() > 0 || declared.motors().next().is_some();
        let stops = |forces: &JointForces| forces.stops.iter().any(Option::is_some);
        let stopped = declared.forces.iter().any(stops);
        let mut joints = self.scene.joints.iter();
        let couples = |other: &&Joint| other.law.couples().iter().any(|(of, _)| *of == joint);
        let coupled = joints.find(couples);
        let locked = |law: &JointLaw| matches!(law, JointLaw::Lock(_));
        let is_lock = coupled.is_some_and(|other| locked(&other.law));
        let coupled = coupled.map(|other| other.name.clone());
        match (holds, stopped, coupled) {
            (.., Some(_)) if is_lock => self.fail(say::detachable_joint_locked(at, &name)),
            (false, ..) => self.fail(say::holds_nothing(at, &name)),
            (_, true, _) => self.fail(say::stopped_joint_detached(at, &name)),
            (.., Some(other)) => self.fail(say::coupled_joint_detached(at, &name, &other)),
            _ => Some(()),
        }
    }

    /// `reef`, or `[reef, leg[0]]`: lines, springs and joints, each named once in the event.
    fn detachables(
        &mut self,
        item: &Item<'_>,
        instance: &Instance<'_>,
        named: &mut Vec<(Detachable, Region)>,
    ) -> Option<Vec<Detachable>> {
        let mut all = Some(Vec::new());
        for part in listed(item.clause(":")?) {
            let found = self.detachable(part, &item.word.text, instance.scope(MayDependOn::Live));
            let (Some(found), Some(list)) = (found, all.as_mut()) else {
                all = None;
                continue;
            };
            if let Some((_, first)) = named.iter().find(|(other, _)| *other == found) {
                let name = self.scene.detachable_name(found);
                let report = say::event_names_twice(part.at, name, *first);
                self.messages.push(report);
                all = None;
                continue;
            }
            named.push((found, part.at));
            if item.word.text == "attach" {
                self.attached.push((found, part.at));
            }
            list.push(found);
        }
        all
    }

    /// One line, spring or joint by its name.
    fn detachable(
        &mut self,
        value: ValueSyntax<'_>,
        word: &str,
        scope: Scope<'_>,
    ) -> Option<Detachable> {
        let known = |named| matches!(named, Named::Line(_) | Named::Joint(_));
        let (named, step) = self.thing(value, scope, &known, |at, name, words| {
            say::no_line_of_event(at, word, name, words)
        })?;
        match named {
            Named::Line(line) => {
                self.mention(named, step.word.at);
                Some(Detachable::Line(line))
            }
            Named::Joint(joint) => {
                self.mention(named, step.word.at);
                self.detachable_joint(joint, step.word.at.into())?;
                Some(Detachable::Joint(joint))
            }
            other => {
                let (at, name) = (step.word.at.into(), &step.word.text);
                self.fail(say::not_a_line_of_event(at, word, name, other.kind()))
            }
        }
    }

    /// What a name alone stands for, with its index if it is repeated; `unknown` tells of a name that nothing of a kind has.
    pub(super) fn thing(
        &mut self,
        value: ValueSyntax<'_>,
        scope: Scope<'_>,
        kind: &dyn Fn(Named) -> bool,
        unknown: impl Fn(Region, &str, &[&str]) -> LexemeMessage,
    ) -> Option<(Named, PathStep)> {
        let parsed = match expression::whole(value) {
            Ok(parsed) => parsed,
            Err(report) => return self.fail(report),
        };
        let step = match parsed {
            Expression::Path(mut steps) if steps.len() == 1 => steps.pop()?,
            _ => return self.fail(say::name_wanted(value.at)),
        };
        let word = &step.word.text;
        if self.broken.contains(word) {
            return None;
        }
        let Some(entry) = self.names.get(word).cloned() else {
            let report = unknown(step.word.at.into(), word, &self.names.words_of(kind));
            return self.fail(report);
        };
        let named = self.member(&entry, &step, scope)?;
        (!self.bad.contains(&named)).then_some((named, step))
    }

    /// `cd_s = 82 m^2`, or `[cd_s = 82 m^2, phase = 2]`.
    fn set_numbers(&mut self, item: &Item<'_>, instance: &Instance<'_>) -> Option<Vec<Setting>> {
        let mut settings: Option<Vec<Setting>> = Some(Vec::new());
        let mut firsts: Vec<(Settable, Region)> = Vec::new();
        for part in listed(item.clause(":")?) {
            let Some((target, own)) = self.setting(part, instance) else {
                settings = None;
                continue;
            };
            let known = |(what, _): &&(Settable, Region)| target.what.contains(what);
            if let Some((_, first)) = firsts.iter().find(known) {
                let report = say::event_names_twice(target.at, &target.name, *first);
                self.messages.push(report);
                settings = None;
                continue;
            }
            firsts.extend(target.what.iter().map(|what| (*what, target.at)));
            if let Some(list) = settings.as_mut() {
                list.extend(own);
            }
        }
        settings
    }

    fn setting(
        &mut self,
        part: ValueSyntax<'_>,
        instance: &Instance<'_>,
    ) -> Option<(EventTarget, Vec<Setting>)> {
        let scope = instance.scope(MayDependOn::Live);
        let mut signs = part.lexemes.iter();
        let Some(sign) = signs.position(|lexeme| lexeme.kind == LexemeKind::Sign('=')) else {
            return self.fail(say::setting_wanted(part.at));
        };
        let [left, right] = [&part.lexemes[..sign], &part.lexemes[sign + 1..]];
        if let [name @ .., operator] = left
            && let LexemeKind::Sign(operator @ ('+' | '-' | '*' | '/')) = operator.kind
        {
            let name: String = name.iter().map(Lexeme::shown).collect();
            return self.fail(say_syntax::assigned_sum(part.at, &name, operator));
        }
        let [Some(left), Some(right)] = [left, right].map(piece) else {
            return self.fail(say::setting_wanted(part.at));
        };
        let target = self.target(left, scope);
        let typed = self.value(right, scope);
        let (target, typed) = (target?, typed?);
        let at = typed.at;
        self.turns_as_in(&typed, &target.unit, &format!("`{}`", target.name))?;
        let value = self.fits(typed, &target.name, target.vector, target.unit.dimension)?;
        let constant = fold::known(&value, &self.scene, false).and_then(|it| it.scalar());
        match (constant, target.range) {
            (Some(found), _) if !found.is_finite() => {
                return self.fail(say::set_to_no_number(at, &target.name));
            }
            (Some(found), Some(range)) if !(range[0]..=range[1]).contains(&found) => {
                return self.fail(say::set_outside(
                    at,
                    &target.name,
                    found,
                    range,
                    &target.unit,
                ));
            }
            _ => {}
        }
        let parts = match (target.vector, value) {
            (false, value) => vec![value],
            (true, Formula::Vector(parts)) => parts,
            (true, value) => {
                let component = |axis| Formula::Component(vec![value.clone()], axis);
                [0, 1, 2].map(component).to_vec()
            }
        };
        let each = target.what.iter().zip(parts);
        let settings = each.map(|(&what, value)| Setting { what, value });
        let settings = settings.collect();
        Some((target, settings))
    }

    /// A speed on the left of a setting.
    fn speed(
        &mut self,
        path: &str,
        value: ValueSyntax<'_>,
        scope: Scope<'_>,
    ) -> Option<EventTarget> {
        let typed = self.value(value, scope)?;
        let (unit, vector) = (typed.unit(), typed.vector);
        let (of, axes) = match &typed.formula {
            Formula::Component(parts, axis) => (parts.first()?, *axis..*axis + 1),
            whole => (whole, 0..3),
        };
        let what: Vec<Settable> = match *of {
            Formula::CoordinateRate(joint, number) => {
                let declared = self.scene.joints.get(joint)?;
                if declared.motors().any(|(driven, _)| driven == number) {
                    return self.fail(say::driven_speed_set(value.at, path));
                }
                vec![Settable::CoordinateRate(joint, number)]
            }
            Formula::Velocity(Place::World(_)) => {
                return self.fail(say::prescribed_speed_set(value.at, path));
            }
            Formula::Velocity(place) if self.scene.is_node(place) => {
                return self.fail(say::node_speed_set(value.at, path));
            }
            Formula::Velocity(place) => axes.map(|axis| Settable::Velocity(place, axis)).collect(),
            Formula::AngularVelocityWorld(body) => {
                let each = axes.map(|axis| Settable::AngularVelocityWorld(body, axis));
                each.collect()
            }
            Formula::AngularVelocityBody(body) => {
                let each = axes.map(|axis| Settable::AngularVelocityBody(body, axis));
                each.collect()
            }
            _ => return self.fail(say::moving_set(value.at, path)),
        };
        let (name, at, range) = (path.to_owned(), value.at, None);
        Some(EventTarget {
            what,
            vector,
            name,
            unit,
            range,
            at,
        })
    }

    /// What stands on the left of a setting: a param, a state or a speed.
    fn target(&mut self, value: ValueSyntax<'_>, scope: Scope<'_>) -> Option<EventTarget> {
        if let Ok(Expression::Path(steps)) = expression::whole(value)
            && steps.len() > 1
        {
            let path: Vec<&str> = steps.iter().map(|step| step.word.text.as_str()).collect();
            return self.speed(&path.join("."), value, scope);
        }
        let settable = |named| matches!(named, Named::Param(_) | Named::State(_));
        let (named, step) = self.thing(value, scope, &settable, say::nothing_to_set)?;
        let at = Region::from(step.word.at);
        let (what, name, unit, range) = match named {
            Named::Param(index) => {
                let param = self.scene.params.get(index)?;
                let what = Settable::Param(index);
                (what, param.name.clone(), &param.unit, param.range)
            }
            Named::State(index) => {
                let state = self.scene.states.get(index)?;
                (
                    Settable::State(index),
                    state.name.clone(),
                    &state.unit,
                    None,
                )
            }
            other => {
                let report = say::cannot_be_set(at, &step.word.text, other.kind());
                return self.fail(report);
            }
        };
        let unit = unit.clone();
        self.mention(named, step.word.at);
        Some(EventTarget {
            what: vec![what],
            vector: false,
            name,
            unit,
            range,
            at,
        })
    }
}

/// The report of a passage inside a value: `pin.angle reaches 10 deg`, and `pin.angle rises 10 deg` in one string of TOML.
fn passage_in_value(guard: &ValueSyntax<'_>) -> Option<LexemeMessage> {
    // What stands first is a name of the user's own.
    guard.lexemes.windows(2).find_map(|pair| {
        let [before, lexeme] = pair else {
            return None;
        };
        let LexemeKind::Word(word) = &lexeme.kind else {
            return None;
        };
        let operand = matches!(
            before.kind,
            LexemeKind::Word(_) | LexemeKind::Number(_) | LexemeKind::Close(_)
        );
        let at = Region::from(lexeme.at);
        let own = ["crosses", "rises", "falls"].contains(&word.as_str());
        match foreign::translated(foreign::PASSAGES, word) {
            _ if !operand => None,
            _ if own => Some(say_syntax::event_in_one_text(at, word)),
            Some(ours) => Some(say_syntax::event_passage(at, word, ours)),
            None => None,
        }
    })
}

/// The parts of `[a, b]`, or the one value.
pub(super) fn listed(value: ValueSyntax<'_>) -> Vec<ValueSyntax<'_>> {
    let mut cursor = Cursor::new(value);
    match cursor.group(Bracket::Square) {
        Some(group) if cursor.at_end() => Cursor::new(group).comma_separated(),
        _ => vec![value],
    }
}

/// Some lexemes of a value as one of their own.
pub(super) fn piece(lexemes: &[crate::lexeme::Lexeme]) -> Option<ValueSyntax<'_>> {
    let (first, last) = (lexemes.first()?.at, lexemes.last()?.at);
    let at = Region { first, last };
    Some(ValueSyntax { lexemes, at })
}
