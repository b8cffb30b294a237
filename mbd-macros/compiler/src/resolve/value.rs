//! Values: an expression becomes a formula, checked for shape, dimension and what it may depend on.

use mbd_scene::{Dimension, Formula, Function, Unit};

use super::turns::Turns;
use super::vanishing::vanishes;
use super::{Resolver, fold};
use crate::describe;
use crate::lexeme::Region;
use crate::messages::{LexemeMessage, resolve as say};
use crate::syntax::expression::{self, Expression};
use crate::syntax::{ValueSyntax, Word, words};
use crate::units;

/// What an expression may depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum MayDependOn {
    /// Numbers and consts.
    Constant,
    /// Also params: known before a run.
    Fixed,
    /// Also time: a motion prescribed before a run. It is differentiated twice.
    Course,
    /// Also inputs and states: what a motor or a winch follows.
    Driven,
    /// Everything in the scene.
    Live,
    /// Also what follows from the accelerations: the efforts of motors.
    Result,
}

/// Where an expression stands.
#[derive(Clone, Copy, Debug)]
pub struct Scope<'s> {
    /// What it may depend on.
    pub stage: MayDependOn,
    /// The repetitions it is in, the outer one first: the name of each index and its value.
    pub indices: &'s [(String, i64)],
}

/// A formula with its shape and dimension.
#[derive(Clone, Debug)]
pub struct Typed {
    /// The formula.
    pub formula: Formula,
    /// Whether it is a vector.
    pub vector: bool,
    /// Its dimension; `None`: a bare zero, or a bare number under `units: si`, which fits everywhere.
    pub dimension: Option<Dimension>,
    /// The exponent of radians in its unit, for the header of a column.
    pub angle: i8,
    /// What in it counts turns: it has `Hz` in it, and nothing that makes radians of these.
    pub turns: Option<Turns>,
    /// Its text, if it is numbers without a unit.
    pub bare: Option<String>,
    /// Its size, or about what it comes to, if it is made of numbers without a unit alone, by their names, too; not of `pi`.
    pub without_unit: Option<f64>,
    /// Its place.
    pub at: Region,
}

impl Typed {
    /// A scalar or vector of the scene.
    pub fn of(formula: Formula, vector: bool, dimension: Dimension, at: Region) -> Self {
        Typed {
            formula,
            vector,
            dimension: Some(dimension),
            angle: 0,
            turns: None,
            bare: None,
            without_unit: None,
            at,
        }
    }

    /// Whether this is an angle or a rate of one, and the other a radius.
    fn turns_about(&self, radius: &Typed) -> bool {
        let turning = [units::NONE, units::RATE, units::ANGULAR_ACCELERATION];
        let angle = self.angle != 0 && self.dimension.is_some_and(|it| turning.contains(&it));
        angle && radius.angle == 0 && radius.dimension == Some(units::LENGTH)
    }

    /// Whether this is an angular rate and the other a speed, or both are accelerations.
    fn turns_per_way(&self, way: &Typed) -> bool {
        let both = (self.dimension, way.dimension);
        let alike = [
            (units::RATE, units::SPEED),
            (units::ANGULAR_ACCELERATION, units::ACCELERATION),
        ];
        let alike = alike.map(|(turning, way)| (Some(turning), Some(way)));
        self.angle != 0 && way.angle == 0 && alike.contains(&both)
    }

    /// Its SI unit; angles are told apart from pure numbers where that is known.
    pub fn unit(&self) -> Unit {
        // Numbers without a unit under `units: si` leave open what a product of them measures.
        let Some(dimension) = self.dimension else {
            return units::si("", units::NONE);
        };
        let text = match (self.angle, dimension) {
            (1, units::NONE) => "rad".to_string(),
            (1, units::RATE) => "rad/s".to_string(),
            (1, units::ANGULAR_ACCELERATION) => "rad/s^2".to_string(),
            _ => units::si_text(dimension),
        };
        let text = if dimension == units::NONE && self.angle != 1 {
            String::new()
        } else {
            text
        };
        units::si(&text, dimension)
    }
}

impl Resolver<'_> {
    /// Reads a value as an expression.
    pub fn value(&mut self, value: ValueSyntax<'_>, scope: Scope<'_>) -> Option<Typed> {
        match expression::whole(value) {
            Ok(parsed) => self.read_either_way(&parsed, scope),
            Err(report) => self.fail(report),
        }
    }

    /// Reports and gives up.
    pub fn fail<T>(&mut self, report: LexemeMessage) -> Option<T> {
        self.messages.push(report);
        None
    }

    /// Reports a vector where one number is wanted, and gives up.
    pub fn fail_as_vector<T>(&mut self, found: &Typed, what: &str) -> Option<T> {
        let axis = self.axis_in(&found.formula);
        self.fail(say::scalar_wanted(found.at, what, axis.as_deref()))
    }

    /// The same of what an axis makes a vector: `-k * trunk.z`.
    fn axis_in(&self, formula: &Formula) -> Option<String> {
        use Function::{Add, Div, Mul, Neg, Sub};
        match formula {
            Formula::Apply(Add | Sub | Mul | Div | Neg, parts) => {
                parts.iter().find_map(|part| self.axis_in(part))
            }
            _ => self.axis_of_a_place(formula),
        }
    }

    /// What to say of `trunk.z`, an axis, where the place along it may be meant; `None` of anything else.
    pub fn axis_of_a_place(&self, formula: &Formula) -> Option<String> {
        let Formula::Axis(place, axis) = formula else {
            return None;
        };
        let letter = ["x", "y", "z"].get(*axis)?;
        let owner = describe::place(&self.scene, *place);
        // A body stands for its centre of mass.
        let owner = owner.strip_suffix(".com").unwrap_or(&owner);
        Some(say::axis_and_place(owner, letter))
    }

    /// A parsed expression with its shape and dimension.
    pub fn typed(&mut self, parsed: &Expression, scope: Scope<'_>) -> Option<Typed> {
        match parsed {
            Expression::Number {
                value,
                text,
                unit,
                at,
            } => {
                self.unit_alone(text, unit.as_ref(), *at, scope)?;
                Some(self.number(*value, text, unit.as_ref(), *at))
            }
            Expression::Vector { parts, unit, at } => {
                self.unit_alone("[…]", unit.as_ref(), *at, scope)?;
                self.vector(parts, unit.as_ref(), *at, scope)
            }
            Expression::Path(steps) => self.path(steps, parsed.at(), scope),
            Expression::Call {
                name,
                arguments,
                at,
            } => self.call(name, arguments, *at, scope),
            Expression::Component { of, axis } => {
                let of = self.typed(of, scope)?;
                self.component(of, axis)
            }
            Expression::Compare { .. } => self.fail(say::comparison_alone(parsed.at())),
            Expression::Negative(inner, at) => {
                let inner = self.typed(inner, scope)?;
                let bare = inner.bare.as_ref().map(|text| format!("-{text}"));
                let formula = self.apply(Function::Neg, vec![inner.formula], *at)?;
                Some(Typed {
                    formula,
                    bare,
                    at: *at,
                    ..inner
                })
            }
            Expression::Binary { sign, sides } => {
                if *sign == '/'
                    && let Some(number) = self.reciprocal(&sides[0], &sides[1], scope)
                {
                    return self.typed(&number, scope);
                }
                if *sign == '/'
                    && let Some(report) = self.number_per_thing(&sides[0], &sides[1])
                {
                    return self.fail(report);
                }
                let left = self.typed(&sides[0], scope);
                let right = self.typed(&sides[1], scope);
                self.binary(*sign, left?, right?, parsed.at())
            }
        }
    }

    /// A function of formulas, folded; an error when the result is not finite.
    pub fn apply(
        &mut self,
        function: Function,
        arguments: Vec<Formula>,
        at: Region,
    ) -> Option<Formula> {
        match fold::apply(function, arguments, &self.scene) {
            Some(formula) => Some(formula),
            None => self.fail(say::not_finite(at)),
        }
    }

    fn number(&self, value: f64, text: &str, unit: Option<&Unit>, at: Region) -> Typed {
        let free = unit.is_none() && (value == 0.0 || self.si);
        let dimension = unit.map_or(units::NONE, |unit| unit.dimension);
        Typed {
            formula: Formula::Number(value * unit.map_or(1.0, |unit| unit.factor)),
            vector: false,
            dimension: (!free).then_some(dimension),
            angle: unit.map_or(0, angle_of),
            turns: unit.and_then(|unit| Turns::of_unit(text, unit)),
            bare: unit.is_none().then(|| text.to_string()),
            without_unit: unit.is_none().then(|| value.abs()),
            at,
        }
    }

    fn vector(
        &mut self,
        parts: &[Expression],
        unit: Option<&Unit>,
        at: Region,
        scope: Scope<'_>,
    ) -> Option<Typed> {
        if parts.len() != 3 {
            return self.fail(say::three_components(at, parts.len()));
        }
        let typed: Vec<Option<Typed>> = parts.iter().map(|part| self.typed(part, scope)).collect();
        let typed: Vec<Typed> = typed.into_iter().collect::<Option<_>>()?;
        let bare = typed
            .iter()
            .filter(|part| part.dimension == Some(units::NONE));
        let numbers = bare.filter_map(|part| Some((part.bare.clone()?, part.at)));
        let numbers: Vec<(String, Region)> = numbers.collect();
        let mut formulas = Vec::with_capacity(3);
        let mut dimension: Option<Dimension> = unit.map(|unit| unit.dimension);
        let mut bare: Option<Vec<String>> = unit.is_none().then(Vec::new);
        let angle = unit.map_or(typed[0].angle, angle_of);
        let mut turns = unit.and_then(|unit| Turns::of_unit("[…]", unit));
        for part in typed {
            if part.vector {
                return self.fail_as_vector(&part, "a component");
            }
            if let Some(list) = bare.as_mut() {
                match part.bare {
                    Some(ref text) => list.push(text.clone()),
                    None => bare = None,
                }
            }
            let part = self.in_brackets(part, unit)?;
            turns = turns.or(part.turns);
            if let (Some(first), Some(this)) = (dimension, part.dimension)
                && first != this
            {
                let others = if first == units::NONE { this } else { first };
                return self.fail(match numbers.into_iter().next() {
                    Some((text, at)) => say::bare_component(at, &text, others),
                    None => say::mixed_components(part.at, first, this),
                });
            }
            dimension = dimension.or(part.dimension);
            formulas.push(part.formula);
        }
        Some(Typed {
            formula: Formula::Vector(formulas),
            vector: true,
            dimension,
            angle,
            turns,
            bare: bare.map(|list| format!("[{}]", list.join(", "))),
            without_unit: None,
            at,
        })
    }

    /// A value inside brackets, with the unit behind them. Without one, and where bare numbers are SI, a pure number fits there as a bare one does: it may
    /// have had its unit behind the brackets before it was written in SI.
    pub fn in_brackets(&mut self, typed: Typed, unit: Option<&Unit>) -> Option<Typed> {
        match unit {
            Some(unit) => self.with_unit(typed, unit),
            None if self.si => Some(Typed {
                dimension: typed.dimension.filter(|found| *found != units::NONE),
                ..typed
            }),
            None => Some(typed),
        }
    }

    /// A pure number is so many of the unit. What has the dimension of the unit already, beside such numbers, stands for itself: `[0, ground, 2] m`.
    fn with_unit(&mut self, typed: Typed, unit: &Unit) -> Option<Typed> {
        let angle = angle_of(unit);
        if typed.dimension.is_some_and(|d| d != units::NONE) || typed.angle != 0 {
            if typed.dimension == Some(unit.dimension) && typed.angle == angle {
                return Some(typed);
            }
            return self.fail(say::unit_twice(
                typed.at,
                &unit.text,
                unit.dimension,
                typed.dimension,
            ));
        }
        let formula = if unit.factor == 1.0 {
            typed.formula
        } else {
            let factor = Formula::Number(unit.factor);
            self.apply(Function::Mul, vec![typed.formula, factor], typed.at)?
        };
        Some(Typed {
            formula,
            dimension: Some(unit.dimension),
            angle,
            turns: Turns::of_unit("[…]", unit),
            bare: None,
            without_unit: None,
            ..typed
        })
    }

    /// A component `.x`, `.y`, `.z` of a vector.
    pub fn component(&mut self, of: Typed, axis: &Word) -> Option<Typed> {
        let index = match axis.text.as_str() {
            _ if !of.vector => return self.fail(say::no_components(axis.at.into(), &axis.text)),
            "x" => 0,
            "y" => 1,
            "z" => 2,
            _ => return self.fail(say::unknown_component(axis.at.into(), &axis.text)),
        };
        Some(Typed {
            formula: fold::component(of.formula, index, &self.scene),
            vector: false,
            bare: None,
            without_unit: None,
            at: of.at.to(axis.at.into()),
            ..of
        })
    }

    fn binary(&mut self, sign: char, a: Typed, b: Typed, at: Region) -> Option<Typed> {
        match sign {
            '+' | '-' => {
                let function = if sign == '+' {
                    Function::Add
                } else {
                    Function::Sub
                };
                self.alike(function, a, b, at)
            }
            '*' => {
                if a.vector && b.vector {
                    return self.fail(say::two_vectors(at));
                }
                self.product(Function::Mul, a, b, at)
            }
            '/' => {
                if b.vector {
                    return self.fail(say::divide_by_vector(b.at));
                }
                if vanishes(&b.formula, &self.scene) {
                    return self.fail(say::not_finite(at));
                }
                self.product(Function::Div, a, b, at)
            }
            '%' => self.remainder(a, b, at),
            _ => self.power(a, b, at),
        }
    }

    /// a − b ⌊a / b⌋: between zero and b, of negative a, too.
    pub fn remainder(&mut self, a: Typed, b: Typed, at: Region) -> Option<Typed> {
        if let Some(vector) = [&a, &b].into_iter().find(|side| side.vector) {
            return self.fail_as_vector(vector, "a side of `%`");
        }
        self.alike_in_turns(&a, &b)?;
        let ratio = self.product(Function::Div, a.clone(), b.clone(), at)?;
        let whole = self.apply(Function::Floor, vec![ratio.formula], at)?;
        let multiple = self.apply(Function::Mul, vec![b.formula.clone(), whole], at)?;
        let of_multiple = Typed {
            formula: multiple,
            ..b
        };
        self.alike(Function::Sub, a, of_multiple, at)
    }

    /// A function of two values of the same shape and dimension.
    pub fn alike(&mut self, function: Function, a: Typed, b: Typed, at: Region) -> Option<Typed> {
        if a.vector != b.vector {
            let vector = if a.vector { &a } else { &b };
            let axis = self.axis_of_a_place(&vector.formula);
            return self.fail(say::number_and_vector(at, axis.as_deref()));
        }
        if let (Some(first), Some(second)) = (a.dimension, b.dimension)
            && first != second
        {
            let needs_unit = a.bare.is_some() || b.bare.is_some();
            return self.fail(say::unlike(at, first, second, needs_unit));
        }
        self.alike_in_turns(&a, &b)?;
        let bare = a.bare.is_some() && b.bare.is_some();
        let angle = if a.angle == b.angle || b.dimension.is_none() {
            a.angle
        } else {
            0
        };
        let turns = a.turns.or(b.turns);
        let sizes = a.without_unit.zip(b.without_unit);
        let nothing = function == Function::Sub && !a.vector && a.formula == b.formula;
        let formula = if nothing {
            // A difference of the same thing: whoever divides by it divides by zero.
            Formula::Number(0.0)
        } else {
            self.apply(function, vec![a.formula, b.formula], at)?
        };
        Some(Typed {
            bare: bare.then(|| shown(&formula)).flatten(),
            without_unit: sizes.map(|(a, b)| size(&formula).unwrap_or(a.max(b))),
            formula,
            vector: a.vector,
            dimension: a.dimension.or(b.dimension),
            angle,
            turns,
            at,
        })
    }

    /// A product or a quotient.
    pub fn product(&mut self, function: Function, a: Typed, b: Typed, at: Region) -> Option<Typed> {
        let divide = function == Function::Div;
        let dimension = match (a.dimension, b.dimension) {
            (Some(first), Some(second)) => {
                let combined = if divide {
                    units::over(first, second)
                } else {
                    units::times(first, second)
                };
                match combined {
                    Some(dimension) => Some(dimension),
                    None => return self.fail(say::dimension_range(at)),
                }
            }
            _ => None,
        };
        let bare = a.bare.is_some() && b.bare.is_some();
        // Where bare numbers are SI, one may be an angle that was written with its unit before.
        let makes_radians = |typed: &Typed| {
            self.si && typed.dimension.is_none() || typed.makes_radians(&self.scene)
        };
        let turns = match (&a.turns, &b.turns) {
            (Some(turns), Some(_)) => (!divide).then_some(turns),
            (Some(turns), None) => (!makes_radians(&b)).then_some(turns),
            (None, Some(turns)) => (!makes_radians(&a)).then_some(turns),
            (None, None) => None,
        };
        let turns = turns.cloned();
        if divide
            && matches!(
                fold::known(&b.formula, &self.scene, false),
                Some(fold::Fixed::Scalar(0.0))
            )
        {
            return self.fail(say::not_finite(at));
        }
        // An angle over 2π, as over a turn, is a number of turns.
        let per_turn = divide && a.is_in_radians() && b.is_a_turn(&self.scene);
        // An angle times a radius is a length: what is made of that has no radians.
        let arc = !divide && (a.turns_about(&b) || b.turns_about(&a));
        let of_angle = a.is_in_radians() || b.is_in_radians();
        // An angular rate over a speed is one over a radius.
        let curvature = divide && a.turns_per_way(&b);
        let formula = self.apply(function, vec![a.formula, b.formula], at)?;
        // An angle over π/180 is a number of degrees.
        let in_degrees = of_angle && self.is_told_in_degrees(&formula);
        let sizes = a.without_unit.zip(b.without_unit);
        let sized =
            |(a, b): (f64, f64)| size(&formula).unwrap_or(if divide { a / b } else { a * b });
        Some(Typed {
            bare: bare.then(|| shown(&formula)).flatten(),
            without_unit: sizes.map(sized),
            formula,
            vector: a.vector || b.vector,
            dimension,
            angle: match divide {
                _ if per_turn || arc || curvature || in_degrees => 0,
                true => a.angle.saturating_sub(b.angle),
                false => a.angle.saturating_add(b.angle),
            },
            turns,
            at,
        })
    }

    fn power(&mut self, a: Typed, b: Typed, at: Region) -> Option<Typed> {
        if a.vector {
            return self.fail(say::power_of_vector(a.at));
        }
        let exponent = match fold::known(&b.formula, &self.scene, false) {
            Some(fold::Fixed::Scalar(n)) if (2.0 * n).fract() == 0.0 && n.abs() <= 20.0 => n,
            _ => return self.fail(say::whole_exponent(b.at)),
        };
        if b.dimension.is_some_and(|d| d != units::NONE) {
            return self.fail(say::whole_exponent(b.at));
        }
        // Of an exponent with a half: so many roots.
        let whole = exponent.fract() == 0.0;
        let (base, exponent) = match whole {
            true => (a.formula, exponent),
            false => {
                let root = self.apply(Function::Sqrt, vec![a.formula], at)?;
                (root, 2.0 * exponent)
            }
        };
        let of_base = match whole {
            true => a.dimension.map(Some),
            false => a.dimension.map(units::root),
        };
        let dimension = match of_base.map(|d| d.and_then(|d| units::power(d, exponent as i32))) {
            Some(None) => return self.fail(say::dimension_range(at)),
            Some(Some(dimension)) => Some(dimension),
            None => None,
        };
        let formula = match exponent {
            1.0 => base,
            _ => self.apply(Function::Power, vec![base, Formula::Number(exponent)], at)?,
        };
        Some(Typed {
            bare: a.bare.is_some().then(|| shown(&formula)).flatten(),
            without_unit: a.without_unit.and_then(|_| size(&formula)),
            formula,
            vector: false,
            dimension,
            angle: 0,
            turns: a.turns,
            at,
        })
    }

    /// Checks a value against what a field holds, and gives its formula.
    pub fn fits(
        &mut self,
        typed: Typed,
        field: &str,
        vector: bool,
        wanted: Dimension,
    ) -> Option<Formula> {
        let typed = self.reading(typed, &[wanted]);
        if typed.vector != vector {
            let what = format!("`{field}`");
            return match vector {
                true => self.fail(say::vector_wanted(typed.at, &what)),
                false => self.fail_as_vector(&typed, &what),
            };
        }
        match typed.dimension {
            Some(found) if found != wanted => {
                if let Some(report) = self.unit_misfit(typed.at) {
                    return self.fail(report);
                }
                if let Some((input, vector)) = self.input_of_bare_value(&typed) {
                    let report = say::input_without_unit(typed.at, (&input, vector), wanted);
                    return self.fail(report);
                }
                let report = match &typed.bare {
                    Some(text) if found == units::NONE => {
                        say::needs_unit(typed.at, field, wanted, text)
                    }
                    _ => say::wrong_dimension(typed.at, field, wanted, found),
                };
                self.fail(report)
            }
            _ => {
                self.unit_fits(typed.at);
                Some(typed.formula)
            }
        }
    }
}

impl Resolver<'_> {
    /// The input that is this value, or a component of it, and whose kind is that of a bare number; whether it is a vector.
    pub(super) fn input_of_bare_value(&self, typed: &Typed) -> Option<(String, bool)> {
        let parts = match &typed.formula {
            Formula::Vector(parts) => parts.as_slice(),
            one => std::slice::from_ref(one),
        };
        let inputs = self.of(words::INPUT);
        let bare = parts.iter().find_map(|part| match part {
            Formula::Input(slot) => inputs.iter().find(|input| {
                let unit = self.scene.inputs.get(*slot).map(|input| &input.unit);
                input.slot == *slot
                    && input.item.clause(":").is_none()
                    && unit.is_some_and(|unit| unit.text.is_empty())
            }),
            _ => None,
        });
        let bare = bare?;
        let vector = self.scene.inputs.get(bare.slot)?.components == 3;
        let name = bare.item.name.as_ref()?;
        Some((name.word.text.clone(), vector))
    }
}

/// The text of a folded number.
fn shown(formula: &Formula) -> Option<String> {
    match formula {
        Formula::Number(value) => Some(value.to_string()),
        _ => None,
    }
}

/// The size of a folded number.
fn size(formula: &Formula) -> Option<f64> {
    match formula {
        Formula::Number(value) => Some(value.abs()),
        _ => None,
    }
}

/// The exponent of radians in a unit as written.
pub fn angle_of(unit: &Unit) -> i8 {
    let text = unit.text.trim_start_matches('(');
    let (above, below) = text.split_once('/').unwrap_or((text, ""));
    let is_angle = |text: &str| {
        let mut words = text.split(|c: char| !c.is_ascii_alphabetic());
        let first = words.find(|word| !word.is_empty());
        first.is_some_and(|word| units::ANGLES.contains(&word))
    };
    i8::from(is_angle(above)) - i8::from(above != "1" && is_angle(below))
}
