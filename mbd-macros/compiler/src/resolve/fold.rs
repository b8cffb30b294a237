//! Arithmetic on formulas: what consists of numbers and consts becomes one number; a const that stands alone stays a const.

use std::collections::BTreeMap;

pub use mbd_scene::Fixed;
use mbd_scene::{Formula, Function, Scene};

/// A function of its arguments, folded if they are all known. `None`: the result is not finite.
pub fn apply(function: Function, arguments: Vec<Formula>, scene: &Scene) -> Option<Formula> {
    let known: Option<Vec<Fixed>> = arguments
        .iter()
        .map(|argument| known(argument, scene, false))
        .collect();
    match known.and_then(|known| compute(function, &known)) {
        Some(value) if value.is_finite() => Some(value.formula()),
        Some(_) => None,
        None => Some(Formula::Apply(function, arguments)),
    }
}

/// A component of a vector, taken out of it where the vector is written in components or is a const.
pub fn component(vector: Formula, axis: usize, scene: &Scene) -> Formula {
    match vector {
        Formula::Vector(parts) if axis < parts.len() => parts[axis].clone(),
        Formula::Const(index) => {
            let value = scene.consts.get(index).and_then(|c| c.value.vector());
            let part = value.and_then(|parts| parts.get(axis).copied());
            part.map_or(Formula::Component(vec![vector], axis), Formula::Number)
        }
        vector => Formula::Component(vec![vector], axis),
    }
}

/// The three components of a vector.
pub fn components(vector: Formula, scene: &Scene) -> [Formula; 3] {
    [0, 1, 2].map(|axis| component(vector.clone(), axis, scene))
}

/// The value of a formula of numbers, consts and (with `defaults`) params at their defaults.
pub fn known(formula: &Formula, scene: &Scene, defaults: bool) -> Option<Fixed> {
    let known = FoldContext {
        scene,
        defaults,
        time: None,
        lets: BTreeMap::new(),
    };
    { known }.of(formula)
}

/// The value of a scalar formula with all params at their defaults.
pub fn at_defaults(formula: &Formula, scene: &Scene) -> Option<f64> {
    known(formula, scene, true)?.scalar()
}

/// The value of a scalar formula at a time [s], with all params at their defaults.
pub fn at_time(formula: &Formula, scene: &Scene, time: f64) -> Option<f64> {
    let known = FoldContext {
        scene,
        defaults: true,
        time: Some(time),
        lets: BTreeMap::new(),
    };
    { known }.of(formula)?.scalar()
}

/// What is known beforehand, and the values of the lets that were asked for.
struct FoldContext<'s> {
    scene: &'s Scene,
    defaults: bool,
    time: Option<f64>,
    lets: BTreeMap<usize, Option<Fixed>>,
}

impl FoldContext<'_> {
    fn of(&mut self, formula: &Formula) -> Option<Fixed> {
        let scene = self.scene;
        match formula {
            Formula::Number(value) => Some(Fixed::Scalar(*value)),
            Formula::Const(index) => scene.consts.get(*index).map(|c| c.value),
            Formula::Param(index) if self.defaults => {
                scene.params.get(*index).map(|p| Fixed::Scalar(p.default))
            }
            Formula::Time => self.time.map(Fixed::Scalar),
            Formula::Let(index) => self.of_let(*index),
            Formula::Vector(parts) => {
                let mut values = [0.0; 3];
                for (value, part) in values.iter_mut().zip(parts) {
                    *value = self.of(part)?.scalar()?;
                }
                (parts.len() == 3).then_some(Fixed::Vector(values))
            }
            Formula::Component(of, axis) if self.defaults => {
                let vector = self.of(of.first()?)?.vector()?;
                vector.get(*axis).map(|value| Fixed::Scalar(*value))
            }
            Formula::Apply(function, arguments) if self.defaults => {
                let values: Option<Vec<Fixed>> = arguments.iter().map(|a| self.of(a)).collect();
                compute(*function, &values?)
            }
            Formula::Lookup(table, arguments) if self.defaults => {
                let mut at = [0.0; 2];
                for (value, argument) in at.iter_mut().zip(arguments) {
                    *value = self.of(argument)?.scalar()?;
                }
                let table = scene.tables.get(*table)?;
                let value = table.at(at.get(..arguments.len())?);
                Some(Fixed::Scalar(value))
            }
            _ => None,
        }
    }

    fn of_let(&mut self, index: usize) -> Option<Fixed> {
        if let Some(value) = self.lets.get(&index) {
            return *value;
        }
        let value = self.of(&self.scene.lets.get(index)?.value);
        self.lets.insert(index, value);
        value
    }
}

/// A function of known values; `None` for shapes it does not take.
pub(super) fn compute(function: Function, values: &[Fixed]) -> Option<Fixed> {
    let scalar = |i: usize| values.get(i).copied().and_then(Fixed::scalar);
    let vector = |i: usize| values.get(i).copied().and_then(Fixed::vector);
    let (a, b) = (values.first().copied()?, values.get(1).copied());
    let result = match function {
        Function::Add => each(a, b?, |x, y| x + y)?,
        Function::Sub => each(a, b?, |x, y| x - y)?,
        Function::Mul => match (a, b?) {
            (Fixed::Vector(v), Fixed::Scalar(k)) | (Fixed::Scalar(k), Fixed::Vector(v)) => {
                Fixed::Vector(v.map(|x| k * x))
            }
            (Fixed::Scalar(x), Fixed::Scalar(y)) => Fixed::Scalar(x * y),
            _ => return None,
        },
        Function::Div => {
            let under = scalar(1)?;
            match a {
                Fixed::Scalar(x) => Fixed::Scalar(x / under),
                Fixed::Vector(v) => Fixed::Vector(v.map(|x| x / under)),
            }
        }
        Function::Neg => match a {
            Fixed::Scalar(x) => Fixed::Scalar(-x),
            Fixed::Vector(v) => Fixed::Vector(v.map(|x| -x)),
        },
        Function::Power => Fixed::Scalar(scalar(0)?.powi(scalar(1)? as i32)),
        Function::Norm => Fixed::Scalar(dot(vector(0)?, vector(0)?).sqrt()),
        Function::Dot => Fixed::Scalar(dot(vector(0)?, vector(1)?)),
        Function::Cross => Fixed::Vector(cross(vector(0)?, vector(1)?)),
        Function::Min => Fixed::Scalar(scalar(0)?.min(scalar(1)?)),
        Function::Max => Fixed::Scalar(scalar(0)?.max(scalar(1)?)),
        Function::Abs => Fixed::Scalar(scalar(0)?.abs()),
        Function::Exp => Fixed::Scalar(scalar(0)?.exp()),
        Function::Sqrt => Fixed::Scalar(scalar(0)?.sqrt()),
        Function::Sin => Fixed::Scalar(sin_cos(scalar(0)?).0),
        Function::Cos => Fixed::Scalar(sin_cos(scalar(0)?).1),
        Function::Atan2 => Fixed::Scalar(scalar(0)?.atan2(scalar(1)?)),
        Function::Tanh => Fixed::Scalar(scalar(0)?.tanh()),
        Function::Ln => Fixed::Scalar(scalar(0)?.ln()),
        Function::Floor => Fixed::Scalar(scalar(0)?.floor()),
        Function::IfLess if scalar(0)? < scalar(1)? => values.get(2).copied()?,
        Function::IfAtMost if scalar(0)? <= scalar(1)? => values.get(2).copied()?,
        Function::IfLess | Function::IfAtMost => values.get(3).copied()?,
        Function::Angle => {
            let (a, b) = (vector(0)?, vector(1)?);
            let c = cross(a, b);
            Fixed::Scalar(dot(c, c).sqrt().atan2(dot(a, b)))
        }
    };
    Some(result)
}

fn each(a: Fixed, b: Fixed, op: impl Fn(f64, f64) -> f64) -> Option<Fixed> {
    match (a, b) {
        (Fixed::Scalar(x), Fixed::Scalar(y)) => Some(Fixed::Scalar(op(x, y))),
        (Fixed::Vector(x), Fixed::Vector(y)) => Some(Fixed::Vector([
            op(x[0], y[0]),
            op(x[1], y[1]),
            op(x[2], y[2]),
        ])),
        _ => None,
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Sine and cosine, exact at whole quarter turns: an aligned axis has true zeros, which cost nothing later.
pub fn sin_cos(angle: f64) -> (f64, f64) {
    let turns = angle / std::f64::consts::FRAC_PI_2;
    let whole = turns.round();
    if (turns - whole).abs() <= 4.0 * f64::EPSILON * whole.abs().max(1.0) && whole.abs() < 1e6 {
        match (whole as i64).rem_euclid(4) {
            0 => (0.0, 1.0),
            1 => (1.0, 0.0),
            2 => (0.0, -1.0),
            _ => (-1.0, 0.0),
        }
    } else {
        angle.sin_cos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_have_true_zeros() {
        let turn = std::f64::consts::PI / 180.0;
        assert_eq!(sin_cos(90.0 * turn), (1.0, 0.0));
        assert_eq!(sin_cos(-180.0 * turn), (0.0, -1.0));
        assert_eq!(sin_cos(0.3), 0.3f64.sin_cos());
        assert_eq!(sin_cos(1e-9), 1e-9f64.sin_cos());
    }

    #[test]
    fn a_const_that_stands_alone_stays_and_arithmetic_folds() {
        let scene = Scene {
            consts: vec![mbd_scene::Constant {
                name: "A".into(),
                doc: String::new(),
                value: Fixed::Scalar(3.0),
                unit: mbd_scene::Unit::default(),
            }],
            ..Scene::default()
        };
        let product = apply(
            Function::Mul,
            vec![Formula::Number(2.0), Formula::Const(0)],
            &scene,
        );
        assert_eq!(product, Some(Formula::Number(6.0)));
        let live = apply(
            Function::Mul,
            vec![Formula::Param(0), Formula::Const(0)],
            &scene,
        );
        assert!(matches!(live, Some(Formula::Apply(..))));
    }
}
