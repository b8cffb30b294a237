//! Formulas that are zero whatever their values: `x - x`, `2*x - x*2`, `(p - p).x`.
//!
//! What is made of sums, products and quotients alone is zero for two sets of unlike values, to the last bit, only if it is zero for all of them. What a run
//! changes, and every other function, is such a value; the same formula has the same.

use std::collections::BTreeMap;

use mbd_scene::{Fixed, Formula, Function, Scene};

use super::fold;

/// Whether a formula of one number is zero whatever its values.
pub fn vanishes(formula: &Formula, scene: &Scene) -> bool {
    [0.5, 0.8].into_iter().all(|first| {
        let mut values = UnlikeValues {
            scene,
            first,
            leaves: Vec::new(),
            lets: BTreeMap::new(),
        };
        values.of(formula).and_then(Fixed::scalar) == Some(0.0)
    })
}

/// Values for what a run changes, each between 1 and 2 and unlike the others.
struct UnlikeValues<'s> {
    scene: &'s Scene,
    first: f64,
    leaves: Vec<(Formula, Fixed)>,
    lets: BTreeMap<usize, Option<Fixed>>,
}

impl UnlikeValues<'_> {
    fn of(&mut self, formula: &Formula) -> Option<Fixed> {
        if let Some(known) = fold::known(formula, self.scene, false) {
            return Some(known);
        }
        match formula {
            Formula::Let(index) => {
                if let Some(value) = self.lets.get(index) {
                    return *value;
                }
                let scene = self.scene;
                let value = self.of(&scene.lets.get(*index)?.value);
                self.lets.insert(*index, value);
                value
            }
            Formula::Vector(parts) => {
                let mut values = [0.0; 3];
                for (value, part) in values.iter_mut().zip(parts) {
                    *value = self.of(part)?.scalar()?;
                }
                Some(Fixed::Vector(values))
            }
            Formula::Component(of, axis) => {
                let vector = self.of(of.first()?)?.vector()?;
                vector.get(*axis).copied().map(Fixed::Scalar)
            }
            Formula::Apply(
                function @ (Function::Add
                | Function::Sub
                | Function::Mul
                | Function::Div
                | Function::Neg
                | Function::Dot
                | Function::Cross),
                arguments,
            ) => {
                let values: Option<Vec<Fixed>> = arguments.iter().map(|it| self.of(it)).collect();
                fold::compute(*function, &values?)
            }
            leaf => Some(self.leaf(leaf)),
        }
    }

    /// A value of its own for a formula, a number or three.
    fn leaf(&mut self, formula: &Formula) -> Fixed {
        if let Some((_, value)) = self.leaves.iter().find(|(leaf, _)| leaf == formula) {
            return *value;
        }
        // Multiples of the golden ratio lie apart from each other.
        let golden = |k: usize| 1.0 + (self.first + 0.618_033_988_749_895 * k as f64).fract();
        let k = 3 * self.leaves.len();
        let value = match is_vector(formula, self.scene) {
            true => Fixed::Vector([golden(k), golden(k + 1), golden(k + 2)]),
            false => Fixed::Scalar(golden(k)),
        };
        self.leaves.push((formula.clone(), value));
        value
    }
}

/// Whether what a run changes has three numbers.
fn is_vector(formula: &Formula, scene: &Scene) -> bool {
    match formula {
        Formula::Position(_)
        | Formula::Velocity(_)
        | Formula::Axis(..)
        | Formula::AngularVelocityWorld(_)
        | Formula::AngularVelocityBody(_)
        | Formula::Orientation(_)
        | Formula::Acceleration(_)
        | Formula::AngularAcceleration(_)
        | Formula::ReactionForce(_)
        | Formula::ReactionTorque(_) => true,
        Formula::Input(index) => {
            let input = scene.inputs.get(*index);
            input.is_some_and(|input| input.components == 3)
        }
        Formula::Apply(Function::IfLess | Function::IfAtMost, parts) => {
            let first = parts.get(2);
            first.is_some_and(|first| is_vector(first, scene))
        }
        _ => false,
    }
}
