//! Points, lines and springs.

use mbd_scene::{
    Clamp, Detachable, Difference, Dimension, Formula, LineKind, NodeModel, Place, PointKind,
};

use super::fields::{Accept, ItemFields};
use super::{Instance, MayDependOn, Named, Resolver, Scope};
use crate::lexeme::{Bracket, Region};
use crate::messages::resolve as say;
use crate::syntax::{Cursor, Item, ValueSyntax, foreign, words};
use crate::units;

const FIELD: &str = "free_length";

impl Resolver<'_> {
    /// Fills the points; a massless one without a declared model is `static` until its lines are known.
    pub fn points(&mut self) {
        for instance in self.of("point") {
            self.poison(Named::Point(instance.slot), |this| this.point(&instance));
        }
    }

    fn point(&mut self, instance: &Instance<'_>) -> Option<()> {
        let name = self.scene.points.get(instance.slot)?.name.clone();
        let fields = self.fields(&instance.item.block, &["mass", "equilibrium", "start"]);
        let scope = instance.scope(MayDependOn::Fixed);
        let kind = match (fields.get("mass"), fields.get("equilibrium")) {
            (Some(_), Some(other)) => {
                return self.fail(say::mass_and_equilibrium(other.word.at.into(), &name));
            }
            (Some(mass), None) => {
                let value = mass.clause(":")?;
                let accept = Accept::Positive;
                PointKind::Mass(self.quantity(&name, "mass", value, units::MASS, accept, scope)?)
            }
            (None, Some(model)) => {
                let model = self.node_model(model.clause(":")?)?;
                self.chosen.insert(instance.slot);
                PointKind::Node(model)
            }
            (None, None) => PointKind::Node(NodeModel::Static),
        };
        self.scene.points.get_mut(instance.slot)?.kind = kind;
        (!fields.doubtful).then_some(())
    }

    /// `static`, `rate`, `stepwise`, or `stepwise { formula: euler, clamp: literal }`.
    fn node_model(&mut self, value: ValueSyntax<'_>) -> Option<NodeModel> {
        const MODELS: &[&str] = &["static", "stepwise", "rate"];
        let mut cursor = Cursor::new(value);
        let word = cursor.word();
        let model = match word.as_ref().map(|word| word.text.as_str()) {
            Some("static") => NodeModel::Static,
            Some("rate") => NodeModel::Rate,
            Some("stepwise") => {
                let block = cursor.group(Bracket::Brace).map(|group| self.block(group));
                self.stepwise(&block.unwrap_or_default())?
            }
            Some(other) => {
                return self.fail(say::unknown_word(value.at, "node model", other, MODELS));
            }
            None => return self.fail(cursor.expected("`static`, `stepwise` or `rate`")),
        };
        match cursor.finish("the end of the field") {
            Ok(()) => Some(model),
            Err(report) => self.fail(report),
        }
    }

    fn stepwise(&mut self, block: &[Item<'_>]) -> Option<NodeModel> {
        let fields = self.fields(block, &["formula", "clamp"]);
        let formula = match fields.value("formula") {
            None => Difference::default(),
            Some(value) => self.choice(
                value,
                "difference formula",
                &[("euler", Difference::Euler), ("bdf2", Difference::Bdf2)],
            )?,
        };
        let clamp = match fields.value("clamp") {
            None => Clamp::default(),
            Some(value) => self.choice(
                value,
                "clamp",
                &[("positive", Clamp::Positive), ("literal", Clamp::Literal)],
            )?,
        };
        Some(NodeModel::Stepwise { formula, clamp })
    }

    /// One word of a closed set.
    pub fn choice<T: Copy>(
        &mut self,
        value: ValueSyntax<'_>,
        what: &str,
        set: &[(&str, T)],
    ) -> Option<T> {
        let words: Vec<&str> = set.iter().map(|(word, _)| *word).collect();
        let mut cursor = Cursor::new(value);
        let Some(word) = cursor.word() else {
            let report = cursor.expected(&format!("one of {}", words.join(", ")));
            return self.fail(report);
        };
        if let Err(report) = cursor.finish("the end of the value") {
            return self.fail(report);
        }
        match set.iter().find(|(known, _)| *known == word.text) {
            Some((_, value)) => Some(*value),
            None => self.fail(say::unknown_word(word.at.into(), what, &word.text, &words)),
        }
    }

    /// Fills the lines and springs.
    pub fn lines(&mut self) {
        for kind in ["line", "spring"] {
            for instance in self.of(kind) {
                self.poison(Named::Line(instance.slot), |this| this.line(&instance));
            }
        }
    }

    fn line(&mut self, instance: &Instance<'_>) -> Option<()> {
        let item = instance.item;
        let name = self.scene.lines.get(instance.slot)?.name.clone();
        let scope = instance.scope(MayDependOn::Fixed);
        let from = item.clause("from").and_then(|v| self.place(v, scope));
        let to = item.clause("to").and_then(|v| self.place(v, scope));
        let known = words::find(&item.word.text, false)?.fields?;
        let fields = self.fields(&item.block, known);
        let kind = self.scene.lines.get(instance.slot)?.kind;
        // A damper between two things is a spring that has no stiffness: where it would be at rest means nothing then.
        let is_damper = kind == LineKind::Spring
            && fields.get("stiffness").is_none()
            && fields.get("damping").is_some();
        let length = match fields.value("free_length") {
            Some(value) => self.free_length(value, (&name, scope), [&from, &to]),
            None if is_damper => Some(Formula::Number(0.0)),
            None => {
                let field = ("free_length", units::LENGTH, Accept::NotNegative);
                self.line_number(&fields, item, &name, field, scope)
            }
        };
        let law = match fields.get("force") {
            Some(force) => match fields.get("stiffness") {
                Some(other) => self.fail(say::force_and_stiffness(other.word.at.into(), &name)),
                None => self
                    .force_table(&name, force.clause(":")?)
                    .map(|table| (LineKind::Table(table), Formula::Number(0.0))),
            },
            None if is_damper => Some((kind, Formula::Number(0.0))),
            None => {
                if let Some((at, table)) = fields.value("stiffness").and_then(|v| self.as_table(v))
                {
                    return self.fail(say::table_as_stiffness(at, &table));
                }
                // What pulls only is slack or taut by its stretch, which a force of none has not.
                let accept = match kind.is_unilateral() {
                    true => Accept::Positive,
                    false => Accept::NotNegative,
                };
                let field = ("stiffness", units::STIFFNESS, accept);
                let stiffness = self.line_number(&fields, item, &name, field, scope);
                stiffness.map(|stiffness| (kind, stiffness))
            }
        };
        let damping = match fields.get("damping") {
            None => Some(Formula::Number(0.0)),
            Some(_) => {
                let field = ("damping", units::DAMPING, Accept::NotNegative);
                self.line_number(&fields, item, &name, field, scope)
            }
        };
        let detached = fields.value("at_start").map_or(Some(false), |value| {
            let set = [("detached", true), ("attached", false)];
            self.choice(value, "start of a line", &set)
        });
        if detached? {
            self.starts_detached(Detachable::Line(instance.slot));
        }
        let (kind, stiffness) = law?;
        let (free_length, damping) = (length?, damping?);
        let entry = self.scene.lines.get_mut(instance.slot)?;
        entry.kind = kind;
        entry.free_length = free_length;
        entry.stiffness = stiffness;
        entry.damping = damping;
        (entry.from, entry.to) = (from?, to?);
        // A misspelt `damping` is none: what a line without one may not carry is not told of it.
        (!fields.doubtful).then_some(())
    }

    /// Tells lines whose rate of winding depends on itself: through their tension, where they are damped, or their stretch rate.
    pub fn windings(&mut self) {
        for (line, through) in crate::check::wound_by_themselves(&self.scene) {
            let lines = ["line", "spring"].map(|kind| self.of(kind));
            let instance = lines
                .iter()
                .flatten()
                .find(|instance| instance.slot == line);
            let at = instance.map_or(self.head, |instance| instance.item.name_at());
            if let Some(name) = self.scene.lines.get(line).map(|line| line.name.clone()) {
                self.messages
                    .push(say::wound_by_itself(at, &name, &through));
            }
        }
    }

    /// The free length: fixed, or of a line that is wound an expression of inputs, states and time, or that with its rate.
    fn free_length(
        &mut self,
        value: ValueSyntax<'_>,
        (name, scope): (&str, Scope<'_>),
        ends: [&Option<Place>; 2],
    ) -> Option<Formula> {
        let driven = Scope {
            stage: MayDependOn::Driven,
            ..scope
        };
        self.instead = Some(foreign::WOUND_BY_MOTION);
        let length = self.length_in_a_run(value, name, driven);
        self.instead = None;
        let Some(formula) = length? else {
            let accept = Accept::NotNegative;
            return self.quantity(name, FIELD, value, units::LENGTH, accept, scope);
        };
        for end in ends.into_iter().flatten() {
            if let Place::Point(point) = end
                && let Some(point) = self.scene.points.get(*point)
                && matches!(point.kind, PointKind::Node(_))
            {
                let report = say::wound_line_at_node(value.at, name, &point.name);
                return self.fail(report);
            }
        }
        Some(formula)
    }

    /// A free length that changes in a run, or that with its rate; nothing where it does not change.
    fn length_in_a_run(
        &mut self,
        value: ValueSyntax<'_>,
        name: &str,
        driven: Scope<'_>,
    ) -> Option<Option<Formula>> {
        let mut cursor = Cursor::new(value);
        let formula = if let Some(group) = cursor.group(Bracket::Square)
            && cursor.at_end()
        {
            let parts = Cursor::new(group).comma_separated();
            let [length, rate] = parts.as_slice() else {
                return self.fail(say::length_and_rate(value.at, name, parts.len()));
            };
            let length = self.value(*length, driven)?;
            let length = self.fits(length, FIELD, false, units::LENGTH)?;
            let rate = self.value(*rate, driven)?;
            let rate = self.fits(rate, "free_length rate", false, units::SPEED)?;
            Formula::Vector(vec![length, rate])
        } else {
            let typed = self.value(value, driven)?;
            if !self.changes(&typed.formula) {
                return Some(None);
            }
            self.fits(typed, FIELD, false, units::LENGTH)?
        };
        Some(Some(formula))
    }

    /// A number that every line or spring of its law has.
    fn line_number(
        &mut self,
        fields: &ItemFields<'_, '_>,
        item: &Item<'_>,
        name: &str,
        (field, dimension, accept): (&str, Dimension, Accept),
        scope: Scope<'_>,
    ) -> Option<Formula> {
        match fields.value(field) {
            Some(value) => self.quantity(name, field, value, dimension, accept, scope),
            None if fields.doubtful || item.broken => None,
            None => {
                let unit = units::si_text(dimension);
                let (kind, at) = (item.word.text.as_str(), item.name_at());
                self.fail(say::no_field(at, kind, name, field, &unit))
            }
        }
    }

    /// The place and the name of a table that a value consists of.
    fn as_table(&self, value: ValueSyntax<'_>) -> Option<(Region, String)> {
        let mut cursor = Cursor::new(value);
        let word = cursor.word().filter(|_| cursor.at_end())?;
        self.table(&word.text)?;
        Some((word.at.into(), word.text))
    }

    /// The name of a table of forces over stretch that begins at zero and rises.
    fn force_table(&mut self, line: &str, value: ValueSyntax<'_>) -> Option<usize> {
        let mut cursor = Cursor::new(value);
        let Some(word) = cursor.word() else {
            return self.fail(cursor.expected("the name of a table of forces over stretch"));
        };
        if let Err(report) = cursor.finish("the end of the field") {
            return self.fail(report);
        }
        let Some(index) = self.table(&word.text) else {
            let known = self
                .names
                .words_of(|named| matches!(named, Named::Table(_)));
            let report = say::unknown_word(word.at.into(), "table", &word.text, &known);
            return self.fail(report);
        };
        self.mention(Named::Table(index), word.at);
        if self.bad.contains(&Named::Table(index)) {
            return None;
        }
        let table = self.scene.tables.get(index)?;
        let found = [table.x_unit.dimension, table.y_unit.dimension];
        let rises = table
            .y
            .windows(2)
            .all(|pair| matches!(pair, [low, high] if low < high));
        let begins = table.x.first() == Some(&0.0) && table.y.first() == Some(&0.0);
        if table.smooth || table.second.is_some() {
            let report = say::force_table_kind(value.at, line, &word.text, table.smooth);
            return self.fail(report);
        }
        if found != [units::LENGTH, units::FORCE] {
            return self.fail(say::force_table_dimensions(
                value.at, line, &word.text, found,
            ));
        }
        if !(rises && begins) {
            return self.fail(say::force_table_rows(value.at, line, &word.text));
        }
        Some(index)
    }
}
