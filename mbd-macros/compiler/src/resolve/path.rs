//! Paths: `capsule.bridle[i].position`, `riser.tension`, `wind.x`, and the ends of lines and joints.

use mbd_scene::{Dimension, EnergyKind, Formula, Gravity, Unit};

use super::names::{Members, NameEntry};
use super::value::angle_of;
use super::{MayDependOn, Named, ResolvedSoFar, Resolver, Scope, Typed, fold};
use crate::lexeme::Region;
use crate::messages::{LexemeMessage, resolve as say};
use crate::syntax::expression::{self, PathStep};
use crate::syntax::quantities;
use crate::units;

impl Resolver<'_> {
    /// A path inside an expression.
    pub fn path(&mut self, steps: &[PathStep], at: Region, scope: Scope<'_>) -> Option<Typed> {
        let typed = self.path_value(steps, at, scope)?;
        let quantity =
            |step: &PathStep| quantities::BODY_QUANTITIES.contains(&step.word.text.as_str());
        let has_frames = steps.first().is_some_and(|first| {
            let word = first.word.text.as_str();
            let members = self.names.get(word).map(|entry| &entry.members);
            word == "world"
                || match members {
                    Some(Members::One(named)) => matches!(named, Named::Body(_)),
                    Some(Members::Many(all)) => all.values().any(|n| matches!(n, Named::Body(_))),
                    None => false,
                }
        });
        // Behind the thing itself only frames are repeated.
        let extra = steps.iter().enumerate().skip(1).find(|(place, step)| {
            step.index.is_some() && (*place > 1 || !has_frames || quantity(step))
        });
        match extra {
            Some((_, step)) => self.fail(say::no_index_of_value(step, typed.vector)),
            None => Some(typed),
        }
    }

    fn path_value(&mut self, steps: &[PathStep], at: Region, scope: Scope<'_>) -> Option<Typed> {
        let (first, rest) = steps.split_first()?;
        let word = first.word.text.as_str();
        let here = Region::from(first.word.at);
        if let Some((_, value)) = scope.indices.iter().find(|(name, _)| name == word) {
            let value = *value as f64;
            let index = Typed {
                without_unit: Some(value.abs()),
                ..Typed::of(Formula::Number(value), false, units::NONE, here)
            };
            return self.tail(index, rest);
        }
        if word == "time" {
            if ![MayDependOn::Course, MayDependOn::Driven].contains(&scope.stage) {
                self.live(scope, here, "time")?;
            }
            return self.tail(Typed::of(Formula::Time, false, units::TIME, here), rest);
        }
        if word == "world" {
            let (place, rest) = self.world_place(first, rest, scope)?;
            return self.frame_quantity(place, "world", rest, at, scope);
        }
        if word == "pi" && self.names.get(word).is_none() {
            let pi = Formula::Number(std::f64::consts::PI);
            return self.tail(Typed::of(pi, false, units::NONE, here), rest);
        }
        if word == quantities::ENERGY_WORD && self.is_free_for_energy(word) {
            return self.energy(first, rest, at, scope);
        }
        let named = self.find(first, scope, rest.is_empty())?;
        self.mention(named, first.word.at);
        let number = matches!(
            named,
            Named::Const(_) | Named::Param(_) | Named::Input(_) | Named::State(_) | Named::Table(_)
        );
        if number && self.bad.contains(&named) {
            return None;
        }
        match named {
            Named::Const(index) => {
                let declared = self.scene.consts.get(index)?;
                let (vector, dimension) =
                    (declared.value.vector().is_some(), declared.unit.dimension);
                self.tail(
                    self.declared(
                        Formula::Const(index),
                        vector,
                        dimension,
                        here,
                        (named, word),
                    ),
                    rest,
                )
            }
            Named::Param(index) => {
                if scope.stage == MayDependOn::Constant {
                    return self.fail(say::param_not_constant(at, self.instead));
                }
                let dimension = self.scene.params.get(index)?.unit.dimension;
                self.tail(
                    self.declared(Formula::Param(index), false, dimension, here, (named, word)),
                    rest,
                )
            }
            Named::Input(index) => {
                self.driven(scope, at, &format!("the input `{word}`"))?;
                let input = self.scene.inputs.get(index)?;
                let (vector, dimension) = (input.components == 3, input.unit.dimension);
                self.tail(
                    self.declared(
                        Formula::Input(index),
                        vector,
                        dimension,
                        here,
                        (named, word),
                    ),
                    rest,
                )
            }
            Named::Let(index) => {
                self.named_expression(index, here, scope)?;
                let named_here = self.scene.lets.get(index)?;
                let (vector, dimension) = (named_here.components == 3, named_here.unit.dimension);
                self.tail(
                    self.declared(Formula::Let(index), vector, dimension, here, (named, word)),
                    rest,
                )
            }
            Named::State(index) => {
                self.driven(scope, at, &format!("the state `{word}`"))?;
                let dimension = self.scene.states.get(index)?.unit.dimension;
                let state = Formula::State(index);
                let state = self.declared(state, false, dimension, here, (named, word));
                self.tail(state, rest)
            }
            Named::Body(body) => self.body_quantity(body, rest, at, scope),
            Named::Point(point) => {
                self.live(scope, at, &format!("the motion of `{word}`"))?;
                self.point_quantity(point, word, rest, at, scope)
            }
            Named::Line(line) => {
                self.live(scope, at, &format!("the state of `{word}`"))?;
                self.line_quantity(line, word, rest, at)
            }
            Named::Joint(joint) => {
                self.live(scope, at, &format!("the motion of `{word}`"))?;
                self.joint_quantity(joint, word, rest, at, scope)
            }
            Named::Table(index) => {
                let table = self.scene.tables.get(index);
                let arguments = table.map_or(1, |table| table.arguments());
                self.fail(say::table_without_argument(here, word, arguments))
            }
            Named::Output(_) if self.bad.contains(&named) => None,
            Named::Output(index)
                if self.known == ResolvedSoFar::Outputs && scope.stage == MayDependOn::Result =>
            {
                let shown = self.shown.get(&index)?.clone();
                self.tail(Typed { at, ..shown }, rest)
            }
            other => self.fail(say::not_a_quantity(here, word, other.kind())),
        }
    }

    /// Whether a word names nothing whose quantities could be asked: an output may be called `energy`, too.
    fn is_free_for_energy(&self, word: &str) -> bool {
        let of_results = |named: &Named| {
            matches!(
                named,
                Named::Output(_) | Named::Event(_) | Named::Metric(_) | Named::Load(_)
            )
        };
        match self.names.get(word).map(|entry| &entry.members) {
            Some(Members::One(named)) => of_results(named),
            Some(Members::Many(_)) => false,
            None => !self.broken.contains(word),
        }
    }

    /// An energy of the scene.
    fn energy(
        &mut self,
        first: &PathStep,
        rest: &[PathStep],
        at: Region,
        scope: Scope<'_>,
    ) -> Option<Typed> {
        let word = first.word.text.as_str();
        let Some((step, after)) = rest.split_first() else {
            return self.fail(say::energy_of_what(at));
        };
        let asked = step.word.text.as_str();
        let known = EnergyKind::ALL
            .into_iter()
            .find(|energy| energy.word() == asked);
        let Some(energy) = known else {
            let known = quantities::ENERGY_QUANTITIES;
            let report = say::unknown_quantity(step.word.at.into(), word, asked, known);
            return self.fail(report);
        };
        self.live(scope, at, "an energy")?;
        if scope.stage != MayDependOn::Result {
            return self.fail(say::energy_as_cause(at, asked));
        }
        if energy != EnergyKind::Kinetic && self.scene.gravity == Gravity::Field {
            return self.fail(say::energy_of_field(at, asked));
        }
        self.tail(
            Typed::of(Formula::Energy(energy), false, units::TORQUE, at),
            after,
        )
    }

    /// The unit of a named number.
    pub fn unit_of(&self, named: Named) -> Option<&Unit> {
        let scene = &self.scene;
        match named {
            Named::Const(i) => scene.consts.get(i).map(|c| &c.unit),
            Named::Param(i) => scene.params.get(i).map(|p| &p.unit),
            Named::Input(i) => scene.inputs.get(i).map(|i| &i.unit),
            Named::Let(i) => scene.lets.get(i).map(|l| &l.unit),
            Named::State(i) => scene.states.get(i).map(|s| &s.unit),
            _ => None,
        }
    }

    /// The typed value of something with a declared unit.
    fn declared(
        &self,
        formula: Formula,
        vector: bool,
        dimension: Dimension,
        at: Region,
        (named, word): (Named, &str),
    ) -> Typed {
        let unit = self.unit_of(named);
        let bare = unit.is_none_or(|unit| unit.text.is_empty());
        let free = self.si && bare && dimension == units::NONE;
        Typed {
            dimension: (!free).then_some(dimension),
            angle: unit.map_or(0, angle_of),
            turns: self.turns_of(named, word),
            without_unit: self.without_unit.get(&named).copied().filter(|_| bare),
            ..Typed::of(formula, vector, dimension, at)
        }
    }

    /// The components at the end of a path.
    pub fn tail(&mut self, typed: Typed, rest: &[PathStep]) -> Option<Typed> {
        let mut typed = typed;
        for step in rest {
            if step.index.is_some() {
                return self.fail(say::no_index_of_value(step, false));
            }
            typed = self.component(typed, &step.word)?;
        }
        Some(typed)
    }

    /// What changes during a run is an error before it.
    pub(super) fn live(&mut self, scope: Scope<'_>, at: Region, what: &str) -> Option<()> {
        match scope.stage {
            MayDependOn::Live | MayDependOn::Result => Some(()),
            MayDependOn::Fixed => self.fail(say::not_fixed(at, what, self.instead)),
            MayDependOn::Course => self.fail(say::not_prescribed(at, what)),
            MayDependOn::Driven => self.fail(say::not_driven(at, what, self.instead)),
            MayDependOn::Constant => self.fail(say::not_constant(at, what)),
        }
    }

    /// What changes during a run and does not depend on the motion at the same instant.
    fn driven(&mut self, scope: Scope<'_>, at: Region, what: &str) -> Option<()> {
        match scope.stage {
            MayDependOn::Driven => Some(()),
            _ => self.live(scope, at, what),
        }
    }

    /// What the first name of a path refers to.
    fn find(&mut self, step: &PathStep, scope: Scope<'_>, alone: bool) -> Option<Named> {
        let word = &step.word.text;
        match self.names.get(word).cloned() {
            Some(_) if self.broken.contains(word) => None,
            Some(entry) => self.member(&entry, step, scope),
            None if scope.stage == MayDependOn::Fixed && self.later.contains(word) => {
                let at = step.word.at.into();
                self.fail(say::not_fixed(at, &format!("`{word}`"), self.instead))
            }
            None => {
                let report = self.unknown(step, alone);
                self.fail_unless_broken(word, report)
            }
        }
    }

    fn unknown(&self, step: &PathStep, alone: bool) -> LexemeMessage {
        let word = &step.word.text;
        let at = step.word.at.into();
        if alone {
            let mut known = self.names.words_of(Named::is_value);
            known.extend(["time", "pi"]);
            say::unknown_parameter(at, word, &known)
        } else {
            let known = self.names.words_of(|n| {
                matches!(
                    n,
                    Named::Body(_)
                        | Named::Point(_)
                        | Named::Joint(_)
                        | Named::Line(_)
                        | Named::Input(_)
                        | Named::Let(_)
                        | Named::State(_)
                )
            });
            say::unknown_thing(at, word, &known)
        }
    }

    /// A report, unless the name belongs to an item whose own mistake has been reported.
    pub fn fail_unless_broken<T>(&mut self, word: &str, report: LexemeMessage) -> Option<T> {
        if self.broken.contains(word) {
            return None;
        }
        if self.later.contains(word) {
            return self.fail(say::not_constant(report.at, &format!("`{word}`")));
        }
        self.fail(report)
    }

    /// The member of a repeated name that an index picks.
    pub fn member(
        &mut self,
        entry: &NameEntry,
        step: &PathStep,
        scope: Scope<'_>,
    ) -> Option<Named> {
        let at = Region::from(step.word.at);
        match (&entry.members, &step.index) {
            (Members::One(named), None) => Some(*named),
            // What cannot be read may have been meant as many.
            (Members::One(named), Some(_)) if self.bad.contains(named) => None,
            (Members::One(_), Some(_)) => self.fail(say::no_index(at, &step.word.text)),
            (Members::Many(members), _) if members.is_empty() => {
                self.fail(say::no_member(at, &step.word.text, entry.at))
            }
            (Members::Many(members), None) => {
                let first = members.keys().next().copied().unwrap_or(0);
                self.fail(say::index_wanted(at, &step.word.text, first))
            }
            (Members::Many(members), Some(index)) => {
                let value = self.whole_number(index, scope)?;
                match members.get(&value) {
                    Some(named) => Some(*named),
                    None => {
                        let keys: Vec<i64> = members.keys().copied().collect();
                        let (at, word) = (index.at(), &step.word.text);
                        self.fail(say::index_range(at, word, value, &keys, scope.indices))
                    }
                }
            }
        }
    }

    /// An index: a whole number made of numbers, consts and the index of the repetition.
    pub fn whole_number(
        &mut self,
        parsed: &expression::Expression,
        scope: Scope<'_>,
    ) -> Option<i64> {
        let constant = Scope {
            stage: MayDependOn::Constant,
            ..scope
        };
        let typed = self.typed(parsed, constant)?;
        match fold::known(&typed.formula, &self.scene, false) {
            Some(fold::Fixed::Scalar(n)) if n.fract() == 0.0 && n.abs() < 1e15 => Some(n as i64),
            _ => self.fail(say::whole_index(parsed.at())),
        }
    }
}
