//! Functions in expressions: their arguments, shapes and dimensions; tables.

use mbd_scene::{Dimension, Formula, Function, Unit};

use super::value::angle_of;
use super::{Named, Resolver, Scope, Stage, Typed};
use crate::lexeme::Region;
use crate::messages::resolve as say;
use crate::syntax::expression::Expression;
use crate::syntax::{Word, words};
use crate::units;

impl Resolver<'_> {
    /// A function of the language, or a table.
    pub fn call(
        &mut self,
        name: &Word,
        arguments: &[Expression],
        at: Region,
        scope: Scope<'_>,
    ) -> Option<Typed> {
        let typed: Vec<Option<Typed>> = arguments
            .iter()
            .map(|argument| self.typed(argument, scope))
            .collect();
        if let Some(found) = self.table(&name.text) {
            self.mention(Named::Table(found), name.at);
            if self.bad.contains(&Named::Table(found)) {
                return None;
            }
            let [argument] = self.arguments(typed, name, at)?;
            return self.lookup(found, argument, at, scope);
        }
        match name.text.as_str() {
            "norm" => {
                let [a] = self.vectors(typed, name, at)?;
                let dimension = a.dimension;
                self.result(Function::Norm, [a], false, dimension, 0, at)
            }
            "dot" | "cross" => {
                let [a, b] = self.vectors(typed, name, at)?;
                let cross = name.text == "cross";
                let function = if cross {
                    Function::Cross
                } else {
                    Function::Dot
                };
                let product = self.product(function, a, b, at)?;
                Some(Typed {
                    vector: cross,
                    ..product
                })
            }
            "min" | "max" => {
                let [a, b] = self.scalars(typed, name, at)?;
                let function = if name.text == "min" {
                    Function::Min
                } else {
                    Function::Max
                };
                self.alike(function, a, b, at)
            }
            "abs" => {
                let [a] = self.scalars(typed, name, at)?;
                let (dimension, angle) = (a.dimension, a.angle);
                self.result(Function::Abs, [a], false, dimension, angle, at)
            }
            "exp" | "sin" | "cos" => {
                let [a] = self.scalars(typed, name, at)?;
                if a.dimension.is_some_and(|d| d != units::NONE) {
                    let found = a.dimension.unwrap_or(units::NONE);
                    return self.fail(say::pure_number_wanted(a.at, &name.text, found));
                }
                let function = match name.text.as_str() {
                    "exp" => Function::Exp,
                    "sin" => Function::Sin,
                    _ => Function::Cos,
                };
                self.result(function, [a], false, Some(units::NONE), 0, at)
            }
            "sqrt" => {
                let [a] = self.scalars(typed, name, at)?;
                let dimension = match a.dimension.map(units::root) {
                    Some(None) => return self.fail(say::dimension_range(at)),
                    Some(Some(dimension)) => Some(dimension),
                    None => None,
                };
                self.result(Function::Sqrt, [a], false, dimension, 0, at)
            }
            "angle" => {
                let [a, b] = self.vectors(typed, name, at)?;
                self.result(Function::Angle, [a, b], false, Some(units::NONE), 1, at)
            }
            "polar" => {
                let [radius, angle, height] = self.scalars(typed, name, at)?;
                self.polar(radius, angle, height, at)
            }
            other => {
                let tables = self.names.words_of(|n| matches!(n, Named::Table(_)));
                let known: Vec<&str> = words::FUNCTIONS.iter().copied().chain(tables).collect();
                let report = say::unknown_function(name.at.into(), other, &known);
                self.fail(report)
            }
        }
    }

    /// The vector (r cos φ, r sin φ, h).
    fn polar(&mut self, r: Typed, phi: Typed, h: Typed, at: Region) -> Option<Typed> {
        if phi.dimension.is_some_and(|d| d != units::NONE) {
            let found = phi.dimension.unwrap_or(units::NONE);
            return self.fail(say::angle_wanted(phi.at, found));
        }
        if let (Some(first), Some(second)) = (r.dimension, h.dimension)
            && first != second
        {
            return self.fail(say::mixed_components(h.at, first, second));
        }
        let cosine = self.apply(Function::Cos, vec![phi.formula.clone()], at)?;
        let sine = self.apply(Function::Sin, vec![phi.formula], at)?;
        let x = self.apply(Function::Mul, vec![r.formula.clone(), cosine], at)?;
        let y = self.apply(Function::Mul, vec![r.formula, sine], at)?;
        Some(Typed {
            formula: Formula::Vector(vec![x, y, h.formula]),
            vector: true,
            dimension: r.dimension.or(h.dimension),
            angle: 0,
            bare: None,
            at,
        })
    }

    fn lookup(
        &mut self,
        table: usize,
        argument: Typed,
        at: Region,
        scope: Scope<'_>,
    ) -> Option<Typed> {
        if scope.stage == Stage::Constant {
            return self.fail(say::not_constant(at, "a table"));
        }
        let declared = self.scene.tables.get(table)?.clone();
        if argument.vector {
            return self.fail(say::scalar_wanted(argument.at, "the argument of a table"));
        }
        let bare = |unit: &Unit| self.si && unit.text.is_empty();
        let (any_argument, any_value) = (bare(&declared.x_unit), bare(&declared.y_unit));
        if let Some(found) = argument.dimension
            && found != declared.x_unit.dimension
            && !any_argument
        {
            let wanted = declared.x_unit.dimension;
            return self.fail(say::argument_dimension(
                argument.at,
                &declared.name,
                wanted,
                found,
            ));
        }
        Some(Typed {
            formula: Formula::Lookup(table, vec![argument.formula]),
            vector: false,
            dimension: (!any_value).then_some(declared.y_unit.dimension),
            angle: angle_of(&declared.y_unit),
            bare: None,
            at,
        })
    }

    fn result<const N: usize>(
        &mut self,
        function: Function,
        arguments: [Typed; N],
        vector: bool,
        dimension: Option<Dimension>,
        angle: i8,
        at: Region,
    ) -> Option<Typed> {
        let arguments = arguments.into_iter().map(|a| a.formula).collect();
        Some(Typed {
            formula: self.apply(function, arguments, at)?,
            vector,
            dimension,
            angle,
            bare: None,
            at,
        })
    }

    fn arguments<const N: usize>(
        &mut self,
        typed: Vec<Option<Typed>>,
        name: &Word,
        at: Region,
    ) -> Option<[Typed; N]> {
        let count = typed.len();
        if count != N {
            return self.fail(say::argument_count(at, &name.text, N, count));
        }
        let all: Vec<Typed> = typed.into_iter().collect::<Option<_>>()?;
        all.try_into().ok()
    }

    fn scalars<const N: usize>(
        &mut self,
        typed: Vec<Option<Typed>>,
        name: &Word,
        at: Region,
    ) -> Option<[Typed; N]> {
        let all: [Typed; N] = self.arguments(typed, name, at)?;
        match all.iter().find(|a| a.vector) {
            Some(wrong) => {
                let what = format!("an argument of `{}`", name.text);
                self.fail(say::scalar_wanted(wrong.at, &what))
            }
            None => Some(all),
        }
    }

    fn vectors<const N: usize>(
        &mut self,
        typed: Vec<Option<Typed>>,
        name: &Word,
        at: Region,
    ) -> Option<[Typed; N]> {
        let all: [Typed; N] = self.arguments(typed, name, at)?;
        match all.iter().find(|a| !a.vector) {
            Some(wrong) => {
                let what = format!("an argument of `{}`", name.text);
                self.fail(say::vector_wanted(wrong.at, &what))
            }
            None => Some(all),
        }
    }
}
