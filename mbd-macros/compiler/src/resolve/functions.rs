//! Functions in expressions: their arguments, shapes and dimensions.

use mbd_scene::{Dimension, Formula, Function};

use super::fold::{self, Fixed};
use super::{Named, Resolver, Scope, Typed};
use crate::lexeme::Region;
use crate::messages::resolve as say;
use crate::syntax::expression::Expression;
use crate::syntax::{Word, foreign};
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
        if name.text == "if" {
            return self.if_else(arguments, name, at, scope);
        }
        if self.table(&name.text).is_none()
            && foreign::translated(foreign::EXPECTED_FUNCTIONS, &name.text).is_some()
        {
            // What is written instead has other arguments: these are not looked at.
            return self.fail(say::unknown_function(name.at.into(), &name.text, &[]));
        }
        let typed: Vec<Option<Typed>> = arguments
            .iter()
            .map(|argument| self.typed(argument, scope))
            .collect();
        if let Some(found) = self.table(&name.text) {
            self.mention(Named::Table(found), name.at);
            if self.bad.contains(&Named::Table(found)) {
                return None;
            }
            return self.lookup(found, typed, at, scope);
        }
        match name.text.as_str() {
            "norm" => {
                let [a] = self.vectors(typed, name, at)?;
                let (dimension, turns) = (a.dimension, a.turns.clone());
                let norm = self.result(Function::Norm, [a], false, dimension, 0, at)?;
                Some(Typed { turns, ..norm })
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
                let mut typed = typed;
                let more = typed.split_off(typed.len().min(2));
                let [a, b] = self.scalars(typed, name, at)?;
                let function = if name.text == "min" {
                    Function::Min
                } else {
                    Function::Max
                };
                let mut found = self.alike(function, a, b, at)?;
                for next in more {
                    let [next] = self.scalars(vec![next], name, at)?;
                    found = self.alike(function, found, next, at)?;
                }
                Some(found)
            }
            "abs" => {
                let [a] = self.scalars(typed, name, at)?;
                let (dimension, angle, turns) = (a.dimension, a.angle, a.turns.clone());
                let size = self.result(Function::Abs, [a], false, dimension, angle, at)?;
                Some(Typed { turns, ..size })
            }
            "exp" | "sin" | "cos" | "tan" | "asin" | "acos" | "atan" | "sinh" | "cosh" | "tanh"
            | "ln" | "log10" | "floor" => {
                let [a] = self.scalars(typed, name, at)?;
                if a.dimension.is_some_and(|d| d != units::NONE) {
                    let found = a.dimension.unwrap_or(units::NONE);
                    return self.fail(say::pure_number_wanted(a.at, &name.text, found));
                }
                if ["sin", "cos", "tan"].contains(&name.text.as_str()) {
                    self.in_radians(&a, &format!("`{}`", name.text))?;
                }
                let angle = i8::from(matches!(name.text.as_str(), "asin" | "acos" | "atan"));
                Some(Typed {
                    formula: self.of_number(&name.text, a.formula, at)?,
                    vector: false,
                    dimension: Some(units::NONE),
                    angle,
                    turns: None,
                    bare: None,
                    without_unit: None,
                    at,
                })
            }
            "atan2" => {
                let [a, b] = self.scalars(typed, name, at)?;
                let ratio = self.alike(Function::Atan2, a, b, at)?;
                Some(Typed {
                    dimension: Some(units::NONE),
                    angle: 1,
                    turns: None,
                    bare: None,
                    without_unit: None,
                    ..ratio
                })
            }
            "sign" => {
                let [a] = self.scalars(typed, name, at)?;
                let zero = || Formula::Number(0.0);
                let [one, minus] = [1.0, -1.0].map(Formula::Number);
                let above = self.apply(
                    Function::IfLess,
                    vec![zero(), a.formula.clone(), one, zero()],
                    at,
                )?;
                let below = vec![a.formula, zero(), minus, above];
                let formula = self.apply(Function::IfLess, below, at)?;
                Some(Typed::of(formula, false, units::NONE, at))
            }
            "clamp" => {
                let [a, low, high] = self.scalars(typed, name, at)?;
                let known = [&low, &high].map(|end| fold::known(&end.formula, &self.scene, false));
                if let [Some(Fixed::Scalar(least)), Some(Fixed::Scalar(most))] = known
                    && least > most
                {
                    return self.fail(say::ends_exchanged(low.at.to(high.at)));
                }
                let above = self.alike(Function::Max, a, low, at)?;
                self.alike(Function::Min, above, high, at)
            }
            "smoothstep" => {
                let [low, high, a] = self.scalars(typed, name, at)?;
                self.smoothstep(low, high, a, at)
            }
            "sqrt" => {
                let [a] = self.scalars(typed, name, at)?;
                let dimension = match a.dimension.map(units::root) {
                    Some(None) => return self.fail(say::dimension_range(at)),
                    Some(Some(dimension)) => Some(dimension),
                    None => None,
                };
                let turns = a.turns.clone();
                let root = self.result(Function::Sqrt, [a], false, dimension, 0, at)?;
                Some(Typed { turns, ..root })
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
                let report = say::unknown_function(name.at.into(), other, &tables);
                self.fail_unless_broken(other, report)
            }
        }
    }

    /// `if(a < b, c, d)`: one of two values of the same shape and dimension.
    fn if_else(
        &mut self,
        arguments: &[Expression],
        name: &Word,
        at: Region,
        scope: Scope<'_>,
    ) -> Option<Typed> {
        let [condition, then, otherwise] = arguments else {
            return self.fail(say::argument_count(at, &name.text, 3, arguments.len()));
        };
        let condition = self.condition(condition, name, scope);
        let [then, otherwise] = [then, otherwise].map(|value| self.typed(value, scope));
        let ((function, a, b), then, otherwise) = (condition?, then?, otherwise?);
        let values = [then.formula.clone(), otherwise.formula.clone()];
        let like = self.alike(Function::Add, then, otherwise, at)?;
        let [then, otherwise] = values;
        Some(Typed {
            formula: self.apply(function, vec![a, b, then, otherwise], at)?,
            bare: None,
            without_unit: None,
            ..like
        })
    }

    /// The function that asks for a condition, and what it compares.
    fn condition(
        &mut self,
        condition: &Expression,
        name: &Word,
        scope: Scope<'_>,
    ) -> Option<(Function, Formula, Formula)> {
        let at = condition.at();
        let Expression::Compare { sign, sides } = condition else {
            return self.fail(say::condition_wanted(at));
        };
        let [left, right] = [&sides[0], &sides[1]];
        if ["&&", "||"].contains(sign) {
            // Each is 1 or 0. The right one counts where the left one does not decide, so that it may be no number elsewhere.
            let truth = [left, right].map(|side| {
                let (function, a, b) = self.condition(side, name, scope)?;
                let numbers = [1.0, 0.0].map(Formula::Number);
                self.apply(function, [a, b].into_iter().chain(numbers).collect(), at)
            });
            let [left, right] = truth;
            let (left, right, half) = (left?, right?, Formula::Number(0.5));
            let chosen = match *sign {
                "&&" => vec![half, left, right, Formula::Number(0.0)],
                _ => vec![half, left, Formula::Number(1.0), right],
            };
            let all = self.apply(Function::IfLess, chosen, at)?;
            return Some((Function::IfLess, Formula::Number(0.5), all));
        }
        let typed = [left, right].map(|side| self.typed(side, scope));
        let [a, b] = self.scalars(typed.into(), name, at)?;
        let sides = [a.formula.clone(), b.formula.clone()];
        // For what may be compared; its value is not used.
        self.alike(Function::Min, a, b, at)?;
        let [a, b] = sides;
        Some(match *sign {
            "<" => (Function::IfLess, a, b),
            ">" => (Function::IfLess, b, a),
            "<=" => (Function::IfAtMost, a, b),
            _ => (Function::IfAtMost, b, a),
        })
    }

    /// A function of one number by its name, put together from those that the laws know.
    fn of_number(&mut self, name: &str, a: Formula, at: Region) -> Option<Formula> {
        let one = || Formula::Number(1.0);
        let mut apply = |function, arguments| self.apply(function, arguments, at);
        match name {
            "exp" => apply(Function::Exp, vec![a]),
            "sin" => apply(Function::Sin, vec![a]),
            "cos" => apply(Function::Cos, vec![a]),
            "tanh" => apply(Function::Tanh, vec![a]),
            "ln" => apply(Function::Ln, vec![a]),
            "floor" => apply(Function::Floor, vec![a]),
            "tan" => {
                let sine = apply(Function::Sin, vec![a.clone()])?;
                let cosine = apply(Function::Cos, vec![a])?;
                apply(Function::Div, vec![sine, cosine])
            }
            "atan" => apply(Function::Atan2, vec![a, one()]),
            "asin" | "acos" => {
                // √((1 − a)(1 + a)) keeps the digits of 1 − a² near its ends.
                let less = apply(Function::Sub, vec![one(), a.clone()])?;
                let more = apply(Function::Add, vec![one(), a.clone()])?;
                let product = apply(Function::Mul, vec![less, more])?;
                let other = apply(Function::Sqrt, vec![product])?;
                let sides = if name == "asin" {
                    vec![a, other]
                } else {
                    vec![other, a]
                };
                apply(Function::Atan2, sides)
            }
            "log10" => {
                let natural = apply(Function::Ln, vec![a])?;
                apply(
                    Function::Mul,
                    vec![natural, Formula::Number(std::f64::consts::LOG10_E)],
                )
            }
            _ => {
                let minus = apply(Function::Neg, vec![a.clone()])?;
                let [up, down] = [a.clone(), minus].map(|a| apply(Function::Exp, vec![a]));
                let sum = apply(Function::Add, vec![up?, down?])?;
                let cosh = apply(Function::Mul, vec![sum, Formula::Number(0.5)])?;
                if name == "cosh" {
                    return Some(cosh);
                }
                // Near zero e^a − e^−a would lose what tanh a keeps.
                let tanh = apply(Function::Tanh, vec![a])?;
                apply(Function::Mul, vec![tanh, cosh])
            }
        }
    }

    /// t² (3 − 2 t) with t = (a − low)/(high − low) between 0 and 1: from 0 to 1 without a kink.
    fn smoothstep(&mut self, low: Typed, high: Typed, a: Typed, at: Region) -> Option<Typed> {
        for edge in [&low, &high] {
            self.alike_in_turns(&a, edge)?;
        }
        let width = self.alike(Function::Sub, high, low.clone(), at)?;
        let rise = self.alike(Function::Sub, a, low, at)?;
        let part = self.product(Function::Div, rise, width, at)?;
        let number = |value| Formula::Number(value);
        let above = self.apply(Function::Max, vec![part.formula, number(0.0)], at)?;
        let t = self.apply(Function::Min, vec![above, number(1.0)], at)?;
        let twice = self.apply(Function::Mul, vec![number(2.0), t.clone()], at)?;
        let rest = self.apply(Function::Sub, vec![number(3.0), twice], at)?;
        let square = self.apply(Function::Mul, vec![t.clone(), t], at)?;
        let formula = self.apply(Function::Mul, vec![square, rest], at)?;
        Some(Typed::of(formula, false, units::NONE, at))
    }

    /// The vector (r cos φ, r sin φ, h).
    fn polar(&mut self, r: Typed, phi: Typed, h: Typed, at: Region) -> Option<Typed> {
        if phi.dimension.is_some_and(|d| d != units::NONE) {
            let found = phi.dimension.unwrap_or(units::NONE);
            return self.fail(say::angle_wanted(phi.at, found));
        }
        self.in_radians(&phi, "the angle of `polar`")?;
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
            turns: None,
            bare: None,
            without_unit: None,
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
            turns: None,
            bare: None,
            without_unit: None,
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
                self.fail_as_vector(wrong, &what)
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
