//! Metrics: numbers of a run. The quantity of one is an output with its name, behind those that are declared.

use mbd_scene::metrics::{COLUMNS_OF_RESULTS, Take, under_integral};
use mbd_scene::{Formula, Output, Unit};

use super::{Instance, MayDependOn, Named, Resolver, Typed, fold};
use crate::lexeme::{LexemeKind, Region};
use crate::messages::resolve as say;
use crate::syntax::expression::{self, Expression};
use crate::syntax::{ValueSyntax, words};
use crate::units;

impl Resolver<'_> {
    /// Fills the metrics.
    pub fn metrics(&mut self) {
        for instance in self.of("metric") {
            self.poison(Named::Metric(instance.slot), |this| this.metric(&instance));
        }
    }

    fn metric(&mut self, instance: &Instance<'_>) -> Option<()> {
        let item = instance.item;
        let name = &self.scene.runs.metrics.get(instance.slot)?.name;
        if COLUMNS_OF_RESULTS.contains(&name.as_str()) {
            let told = say::metric_is_a_column(item.name_at(), name);
            return self.fail(told);
        }
        let known = words::find("metric", false)?.fields?;
        let fields = self.fields(&item.block, known);
        let (take, of) = self.take(item.clause("=")?)?;
        for (word, wanted) in [("level", take.has_level()), ("at", take == Take::Value)] {
            if let (Some(field), false) = (fields.get(word), wanted) {
                return self.fail(say::metric_needs_no(field.at, take, word));
            }
            if wanted && fields.get(word).is_none() && !fields.doubtful {
                return self.fail(say::metric_needs(item.name_at(), take, word));
            }
        }
        let second = |this: &mut Self, word: &str| match fields.value(word) {
            Some(value) => this
                .fixed_number(word, value, units::TIME, instance)
                .map(|(number, _)| Some(number)),
            None => Some(None),
        };
        let (from, to) = (second(self, "from")?, second(self, "to")?);
        if let (Some(from), Some(to), Some(field)) = (from, to, fields.get("to"))
            && from >= to
        {
            return self.fail(say::metric_window(field.at));
        }
        let event = match (take, fields.value("at")) {
            (Take::TimeOf, _) => Some(self.event_of(of, instance)?),
            (Take::Value, Some(at)) => Some(self.event_of(at, instance)?),
            _ => None,
        };
        let (mut output, mut level) = (None, None);
        if take == Take::TimeOf {
            if let Some(unit) = item.given("in") {
                return self.fail(say::metric_needs_no(unit.at, take, "in"));
            }
        } else {
            let typed = self.value(of, instance.scope(MayDependOn::Result))?;
            if typed.vector {
                return self.fail_as_vector(&typed, "a metric");
            }
            let mut asked = self.in_unit(item.clause("in"))?;
            if asked.is_none() {
                asked = self.told_in(of, instance);
            }
            let mut wanted = Vec::from_iter(asked.as_ref().map(|(unit, _)| unit.dimension));
            if take == Take::Integral {
                let rate = wanted.first().and_then(|it| units::over(*it, units::TIME));
                wanted.extend(rate);
            }
            let typed = self.reading_as(typed, &wanted);
            let (dimension, quantity) = (typed.dimension.unwrap_or(units::NONE), typed.clone());
            if take == Take::Integral
                && let Some((unit, _)) = &mut asked
                && units::times(dimension, units::TIME) == Some(unit.dimension)
            {
                // `in kJ` of a power: its column is in kW.
                unit.text = under_integral(&unit.text);
                unit.dimension = dimension;
            }
            let (value, components, unit) = self.column(typed, asked)?;
            if let Some(value) = fields.value("level") {
                let (number, typed) = self.fixed_number("level", value, dimension, instance)?;
                self.alike_in_turns(&quantity, &typed)?;
                self.bare_beside_output(of, &typed, instance)?;
                level = Some(number);
            }
            let metric = self.scene.runs.metrics.get(instance.slot)?;
            output = Some(self.scene.outputs.len());
            self.scene.outputs.push(Output {
                name: metric.name.clone(),
                doc: metric.doc.clone(),
                value,
                components,
                unit,
            });
            let slot = Named::Output(self.scene.outputs.len() - 1);
            self.declared.insert(slot, item.name_at());
        }
        let entry = self.scene.runs.metrics.get_mut(instance.slot)?;
        (entry.take, entry.output, entry.level) = (take, output, level);
        (entry.event, entry.from, entry.to) = (event, from, to);
        (!fields.doubtful).then_some(())
    }

    /// The unit of an output where a metric is of one alone, of its size, or of a sum or the larger of such: that of the column, as a campaign takes it.
    fn told_in(&mut self, of: ValueSyntax<'_>, instance: &Instance<'_>) -> Option<(Unit, Region)> {
        let parsed = expression::whole(of).ok()?;
        let unit = self.unit_kept(&parsed, instance)?;
        Some((unit, of.at))
    }

    /// The unit of the first output in an expression that has the unit of its parts.
    fn unit_kept(&mut self, of: &Expression, instance: &Instance<'_>) -> Option<Unit> {
        let path = match of {
            Expression::Path(path) => path,
            Expression::Negative(of, _) => return self.unit_kept(of, instance),
            Expression::Call {
                name, arguments, ..
            } if ["abs", "min", "max", "clamp"].contains(&name.text.as_str()) => {
                let mut each = arguments.iter();
                return each.find_map(|one| self.unit_kept(one, instance));
            }
            Expression::Binary {
                sign: '+' | '-',
                sides,
            } => {
                let mut each = sides.iter();
                return each.find_map(|one| self.unit_kept(one, instance));
            }
            _ => return None,
        };
        let first = path.first()?;
        let entry = self.names.get(&first.word.text)?.clone();
        let scope = instance.scope(MayDependOn::Constant);
        let Named::Output(output) = self.member(&entry, first, scope)? else {
            return None;
        };
        let unit = self.scene.outputs.get(output)?.unit.clone();
        (!unit.text.is_empty()).then_some(unit)
    }

    /// Refuses a number without a unit beside an output alone that is told in degrees: it would be radians.
    pub(super) fn bare_beside_output(
        &mut self,
        of: ValueSyntax<'_>,
        number: &Typed,
        instance: &Instance<'_>,
    ) -> Option<()> {
        let (Some(text), false) = (&number.bare, number.without_unit == Some(0.0)) else {
            return Some(());
        };
        match self.told_in(of, instance) {
            Some((unit, _)) if unit.dimension == units::NONE && unit.factor != 1.0 => {
                self.fail(say::unit_of_output(number.at, text, &unit.text))
            }
            _ => Some(()),
        }
    }

    /// The word in front, and what it is about.
    fn take<'v>(&mut self, value: ValueSyntax<'v>) -> Option<(Take, ValueSyntax<'v>)> {
        let (first, rest) = value.lexemes.split_first()?;
        let word = match &first.kind {
            LexemeKind::Word(word) => word.as_str(),
            _ => "",
        };
        let Some(take) = Take::of(word) else {
            return self.fail(say::metric_take(first.at.into(), &first.shown()));
        };
        let (Some(begin), Some(end)) = (rest.first(), rest.last()) else {
            return self.fail(say::metric_of_nothing(first.at.into(), take));
        };
        // `time_of max height`, `max a - min a`: a quantity of this name would be followed by a sign.
        let second = rest.windows(2).find_map(|pair| match pair {
            [word, next] if matches!(next.kind, LexemeKind::Word(_)) => {
                Some((word.at, Take::of(&word.shown())?))
            }
            _ => None,
        });
        if let Some((at, second)) = second {
            return self.fail(say::metric_of_two(at.into(), take, second));
        }
        let at = Region {
            first: begin.at,
            last: end.at,
        };
        Some((take, ValueSyntax { lexemes: rest, at }))
    }

    /// A number of numbers and consts, and what it is.
    fn fixed_number(
        &mut self,
        word: &str,
        value: ValueSyntax<'_>,
        wanted: mbd_scene::Dimension,
        instance: &Instance<'_>,
    ) -> Option<(f64, Typed)> {
        let typed = self.value(value, instance.scope(MayDependOn::Constant))?;
        let at = typed.at;
        let formula: Formula = self.fits(typed.clone(), word, false, wanted)?;
        match fold::at_defaults(&formula, &self.scene).filter(|number| number.is_finite()) {
            Some(number) => Some((number, typed)),
            None => self.fail(say::metric_number(at, word)),
        }
    }

    /// The event of a name.
    fn event_of(&mut self, value: ValueSyntax<'_>, instance: &Instance<'_>) -> Option<usize> {
        let is_event = |named| matches!(named, Named::Event(_));
        let scope = instance.scope(MayDependOn::Live);
        let (named, step) = self.thing(value, scope, &is_event, |at, name, known| {
            say::no_event(at, name, known)
        })?;
        match named {
            Named::Event(event) => {
                self.mention(named, step.word.at);
                Some(event)
            }
            other => {
                let at = step.word.at.into();
                self.fail(say::not_an_event(at, &step.word.text, other.kind()))
            }
        }
    }
}
