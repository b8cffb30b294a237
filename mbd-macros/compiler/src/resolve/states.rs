//! States of the user's own: their unit and start before the scene is known, their rate when everything has a name.

use mbd_scene::{Formula, Unit};

use super::numbers::written_unit;
use super::{Instance, MayDependOn, Named, Resolver, fold};
use crate::lexeme::{Bracket, LexemeKind, Region};
use crate::messages::resolve as say;
use crate::syntax::{ValueSyntax, expression};
use crate::units;

impl Resolver<'_> {
    /// `: current = 0 A`, or the start alone: what it is measured in, and where it starts.
    pub fn state_start(&mut self, instance: &Instance<'_>) -> Option<()> {
        let item = instance.item;
        let in_brackets = |value: &ValueSyntax<'_>| {
            let first = value.lexemes.first().map(|lexeme| &lexeme.kind);
            matches!(first, Some(LexemeKind::Open(Bracket::Square, _)))
        };
        let kind = match item.clause(":") {
            Some(value) if in_brackets(&value) => {
                let name = self.scene.states.get(instance.slot)?.name.clone();
                return self.fail(say::state_of_three(value.at, &name));
            }
            Some(value) => Some(self.input_unit(value.lexemes, value.at)?),
            None => None,
        };
        let parsed = match expression::whole(item.clause("=")?) {
            Ok(parsed) => parsed,
            Err(report) => return self.fail(report),
        };
        let typed = self.read_either_way(&parsed, instance.scope(MayDependOn::Fixed))?;
        let unit = match &kind {
            Some(unit) => unit.clone(),
            None => match written_unit(&parsed).filter(|unit| unit.factor == 1.0) {
                Some(unit) => unit,
                None => typed.unit(),
            },
        };
        let at = typed.at;
        if let Some(unit) = &kind {
            self.turns_as_in(&typed, unit, "the start of a state")?;
        }
        self.remember_units(Named::State(instance.slot), &typed);
        let start = self.fits(typed, "start", false, unit.dimension)?;
        if fold::at_defaults(&start, &self.scene).is_none_or(|start| !start.is_finite()) {
            return self.fail(say::not_finite(at));
        }
        let entry = self.scene.states.get_mut(instance.slot)?;
        entry.start = start;
        entry.unit = unit;
        Some(())
    }

    /// Fills the rates.
    pub fn states(&mut self) {
        for instance in self.of("state") {
            self.poison(Named::State(instance.slot), |this| {
                this.state_rate(&instance)
            });
        }
    }

    fn state_rate(&mut self, instance: &Instance<'_>) -> Option<()> {
        let item = instance.item;
        let name = self.scene.states.get(instance.slot)?.name.clone();
        let fields = self.fields(&item.block, &["rate"]);
        let Some(value) = fields.value("rate") else {
            if fields.doubtful || item.broken {
                return None;
            }
            return self.fail(say::state_without_rate(item.name_at(), &name));
        };
        let typed = self.value(value, instance.scope(MayDependOn::Live))?;
        self.rate_in_turns(instance.slot, &typed)?;
        let rate = self.state_rate_fits(instance, typed)?;
        self.scene.states.get_mut(instance.slot)?.rate = rate;
        Some(())
    }

    /// The rate is measured in the unit of the state a second.
    fn state_rate_fits(&mut self, instance: &Instance<'_>, typed: super::Typed) -> Option<Formula> {
        let unit: Unit = self.scene.states.get(instance.slot)?.unit.clone();
        let at: Region = typed.at;
        let Some(wanted) = units::over(unit.dimension, units::TIME) else {
            return self.fail(say::dimension_range(at));
        };
        // Bare numbers under `units: si` leave open what they measure.
        let open = self.si && unit.text.is_empty();
        let bare = unit.text.is_empty() && instance.item.clause(":").is_none();
        match typed.dimension {
            Some(found) if found != wanted && !typed.vector => {
                let own = units::times(found, units::TIME);
                match own {
                    _ if open => Some(typed.formula),
                    Some(own) if bare => {
                        let name = &self.scene.states.get(instance.slot)?.name.clone();
                        self.fail(say::state_without_unit(at, name, own))
                    }
                    _ => self.fits(typed, "rate", false, wanted),
                }
            }
            _ => self.fits(typed, "rate", false, wanted),
        }
    }
}
