//! Named expressions: `let lift = 0.5 * RHO * S * speed^2;`. Each is resolved when its name is met first, so that they may name each other in
//! any order; what it depends on decides where it may stand.

use mbd_scene::Formula;

use super::{Instance, MayDependOn, Named, ResolvedSoFar, Resolver, Scope};
use crate::describe;
use crate::lexeme::Region;
use crate::messages::resolve as say;
use crate::units;

/// A `let` may be this deep, everything it names counted: evaluating it takes as many calls inside each other.
const DEEPEST: usize = 300;
/// So many lets may be resolved inside each other, each naming the next before that one is declared.
const NESTED: usize = 30;
/// A `let` in a course of time, which is worked out anew wherever it stands, may have so many operations.
const LONGEST: usize = 10_000;

/// What is known of a `let`.
#[derive(Clone, Debug, Default)]
pub(super) struct LetProgress {
    state: LetState,
    /// What it depends on at most, and by which part of it.
    reach: Option<(MayDependOn, String)>,
    /// Operations inside each other.
    depth: usize,
    /// Operations with every `let` in it written out.
    length: usize,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum LetState {
    #[default]
    Waiting,
    Open,
    Done,
}

impl Resolver<'_> {
    /// Resolves every `let`.
    pub fn lets(&mut self) {
        for index in 0..self.lets.len() {
            self.resolve_let(index);
        }
    }

    /// A `let` is named here: resolves it, and checks that it may stand here.
    pub fn named_expression(&mut self, index: usize, at: Region, scope: Scope<'_>) -> Option<()> {
        let name = self.scene.lets.get(index)?.name.clone();
        if self.known < ResolvedSoFar::Names {
            return self.fail(say::not_constant(at, &format!("the let `{name}`")));
        }
        if self.nested == 0 {
            // In their order, so that a long row of lets each naming the one before is no deep recursion.
            for earlier in 0..index {
                self.resolve_let(earlier);
            }
            self.too_early = None;
        }
        self.resolve_let(index);
        if let Some(on) = &self.too_early {
            let on = on.clone();
            if self.nested == 0 {
                self.too_early = None;
                return self.out_of_reach(&name, &on, at, scope);
            }
            return None;
        }
        if self.bad.contains(&Named::Let(index)) {
            return None;
        }
        let progress = self.lets.get(index)?;
        if let Some((stage, on)) = progress.reach.clone()
            && stage > scope.stage
        {
            return self.out_of_reach(&name, &on, at, scope);
        }
        if [MayDependOn::Course, MayDependOn::Driven].contains(&scope.stage)
            && progress.length > LONGEST
        {
            return self.fail(say::deep_let(at, &name, DEEPEST));
        }
        Some(())
    }

    /// Whether a `let` is being resolved.
    pub fn in_let(&self) -> bool {
        self.nested > 0
    }

    /// Something that a `let` names is not known yet; whoever names the `let` cannot depend on it.
    pub fn not_yet<T>(&mut self, what: &str) -> Option<T> {
        self.too_early.get_or_insert_with(|| what.to_string());
        None
    }

    fn out_of_reach(&mut self, name: &str, on: &str, at: Region, scope: Scope<'_>) -> Option<()> {
        let what = say::let_of(name, on);
        self.fail(match scope.stage {
            MayDependOn::Constant => say::not_constant(at, &what),
            MayDependOn::Fixed => say::not_fixed(at, &what, self.instead),
            MayDependOn::Course => say::not_prescribed(at, &what),
            MayDependOn::Driven => say::not_driven(at, &what, self.instead),
            MayDependOn::Live | MayDependOn::Result => say::let_as_cause(at, name, on),
        })
    }

    /// Resolves a `let` unless that has been done.
    fn resolve_let(&mut self, index: usize) {
        let state = self.lets.get(index).map(|progress| progress.state);
        let instances = self.instances.get("let");
        let instance = instances.and_then(|all| all.get(index)).cloned();
        let (Some(state), Some(instance)) = (state, instance) else {
            return;
        };
        let named = Named::Let(index);
        let at = instance.item.name_at();
        let name = self.scene.lets.get(index).map(|l| l.name.clone());
        let name = name.unwrap_or_default();
        if state == LetState::Open {
            self.messages.push(say::circular(at, "let", &name));
            self.bad.insert(named);
        }
        if state != LetState::Waiting || self.bad.contains(&named) {
            return;
        }
        if self.nested >= NESTED {
            self.messages.push(say::deep_let(at, &name, DEEPEST));
            self.bad.insert(named);
            return;
        }
        self.state_of(index, LetState::Open);
        self.nested += 1;
        let good = self.fill_let(&instance).is_some();
        self.nested -= 1;
        if self.too_early.is_some() {
            self.state_of(index, LetState::Waiting);
            return;
        }
        self.state_of(index, LetState::Done);
        if !good {
            self.bad.insert(named);
        }
    }

    fn state_of(&mut self, index: usize, state: LetState) {
        if let Some(progress) = self.lets.get_mut(index) {
            progress.state = state;
        }
    }

    fn fill_let(&mut self, instance: &Instance<'_>) -> Option<()> {
        let item = instance.item;
        let typed = self.value(item.clause("=")?, instance.scope(MayDependOn::Result))?;
        let asked = self.in_unit(item.clause("in"))?;
        let wanted = asked.as_ref().map(|(unit, _)| unit.dimension);
        let typed = self.reading_as(typed, wanted.as_slice());
        let (mut unit, components) = (typed.unit(), if typed.vector { 3 } else { 1 });
        if let Some((wanted, at)) = asked {
            if let Some(found) = typed.dimension
                && found != wanted.dimension
            {
                return self.fail(say::cannot_be_told_in(at, &wanted.text, found));
            }
            if wanted.factor != 1.0 {
                let si = match wanted.dimension {
                    units::NONE => "rad".to_string(),
                    dimension => units::si_text(dimension),
                };
                return self.fail(say::let_in_si(at, &si));
            }
            self.turns_told_in(&typed, &wanted, at)?;
            unit = wanted;
        }
        self.remember_units(Named::Let(instance.slot), &typed);
        let (depth, length) = self.extent(&typed.formula);
        let entry = self.scene.lets.get_mut(instance.slot)?;
        entry.value = typed.formula;
        entry.components = components;
        entry.unit = unit;
        if depth > DEEPEST {
            let (at, name) = (item.name_at(), entry.name.clone());
            return self.fail(say::deep_let(at, &name, DEEPEST));
        }
        let reach = self.reach(instance.slot);
        let progress = self.lets.get_mut(instance.slot)?;
        (progress.depth, progress.length, progress.reach) = (depth, length, reach);
        Some(())
    }

    /// How deep a formula is and how many operations it has, lets written out.
    fn extent(&self, formula: &Formula) -> (usize, usize) {
        match formula {
            Formula::Let(index) => {
                let progress = self.lets.get(*index);
                progress.map_or((1, 1), |l| (l.depth + 1, l.length))
            }
            Formula::Vector(parts)
            | Formula::Apply(_, parts)
            | Formula::Component(parts, _)
            | Formula::Lookup(_, parts) => {
                let parts = parts.iter().map(|part| self.extent(part));
                parts.fold((1, 1), |(deep, long), (depth, length)| {
                    (deep.max(depth + 1), usize::saturating_add(long, length))
                })
            }
            _ => (1, 1),
        }
    }

    /// What a `let` depends on at most, and which part of it does.
    fn reach(&self, index: usize) -> Option<(MayDependOn, String)> {
        let scene = &self.scene;
        let mut furthest: Option<(MayDependOn, Formula)> = None;
        scene.walk(&Formula::Let(index), &mut |part| {
            let stage = match part {
                Formula::Number(_)
                | Formula::Const(_)
                | Formula::Let(_)
                | Formula::Vector(_)
                | Formula::Component(..)
                | Formula::Apply(..) => MayDependOn::Constant,
                Formula::Param(_) | Formula::Lookup(..) => MayDependOn::Fixed,
                Formula::Time => MayDependOn::Course,
                Formula::Input(_) | Formula::State(_) => MayDependOn::Driven,
                Formula::Energy(_)
                | Formula::MotorEffort(..)
                | Formula::Acceleration(_)
                | Formula::AngularAcceleration(_)
                | Formula::CoordinateAcceleration(..)
                | Formula::ReactionForce(_)
                | Formula::ReactionTorque(_) => MayDependOn::Result,
                _ => MayDependOn::Live,
            };
            if furthest.as_ref().is_none_or(|(known, _)| stage > *known) {
                furthest = Some((stage, part.clone()));
            }
        });
        furthest.map(|(stage, part)| (stage, describe::text(scene, &part)))
    }
}
