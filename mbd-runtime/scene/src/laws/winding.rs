//! The free length of a line that is wound in or paid out: an expression of inputs, states and time.
//!
//! ```text
//! L̇0 = ∂L0/∂t + Σ ∂L0/∂s ṡ                       s: declared states, ṡ their declared rates; inputs are held      [m/s]      (1)
//! s = d − L0,   ṡ = ḋ − L̇0                        what the damping of the line acts on                             [m/s]      (2)
//! P = −T L̇0                                       power of the winch: positive where it winds in against a pull     [W]       (3)
//! ```
//!
//! (3) closes the balance: the ends take −T ḋ, the elastic energy grows by f(s) ṡ, the damping loses (T − f) ṡ. Derived.
//!
//! The rate of a load on a node, Ẇ, follows in the same way, from places and coordinates, too: they move by their velocities.

use nalgebra::Vector3;

use crate::laws::evaluation::{Evaluation, declared_input};
use crate::laws::formula::{Context, Value, of_let, scalar, vector};
use crate::{At, Dual, Float, Formula, Layout, Line, Place, Real, Scene};

/// A number with its rate.
type WithRate<S> = Dual<S, 1>;

/// What a free length or a load on a node depends on, with the rates of (1).
struct Winding<'e, 'a, S: Real>(&'e Evaluation<'a, S>);

impl<S: Real> Context<WithRate<S>> for Winding<'_, '_, S> {
    fn scene(&self) -> &Scene {
        self.0.scene
    }

    fn param(&self, index: usize) -> Option<WithRate<S>> {
        self.0.param(index).map(Dual::constant)
    }

    fn named(&self, index: usize) -> Option<Value<WithRate<S>>> {
        of_let(index, self)
    }

    fn input(&self, index: usize) -> Option<Value<WithRate<S>>> {
        Some(match Context::input(self.0, index)? {
            Value::Scalar(a) => Value::Scalar(Dual::constant(a)),
            Value::Vector(a) => Value::Vector(a.map(Dual::constant)),
        })
    }

    fn state(&self, index: usize) -> Option<WithRate<S>> {
        let value = self.0.state(index)?;
        let rate = scalar(&self.0.scene.states.get(index)?.rate, self.0);
        Some(Dual {
            value,
            slopes: [rate],
        })
    }

    fn time(&self) -> Option<WithRate<S>> {
        Some(Dual::variable(self.0.at.time, 0))
    }

    fn position(&self, place: Place) -> Option<Vector3<WithRate<S>>> {
        let (position, velocity) = (self.0.position(place)?, self.0.velocity(place)?);
        let moves = |value, rate| Dual {
            value,
            slopes: [rate],
        };
        Some(position.zip_map(&velocity, moves))
    }

    fn coordinate(&self, joint: usize, index: usize) -> Option<WithRate<S>> {
        Some(Dual {
            value: self.0.coordinate(joint, index)?,
            slopes: [self.0.coordinate_rate(joint, index)?],
        })
    }
}

/// What a free length depends on, without bodies: in `f64` whatever the scalar of the run.
struct Driven<'a, T> {
    scene: &'a Scene,
    layout: &'a Layout,
    params: &'a [T],
    at: &'a At<'a, T>,
}

impl<T: Float> Context<f64> for Driven<'_, T> {
    fn scene(&self) -> &Scene {
        self.scene
    }

    fn param(&self, index: usize) -> Option<f64> {
        self.params.get(index).map(|x| x.to_f64())
    }

    fn named(&self, index: usize) -> Option<Value<f64>> {
        of_let(index, self)
    }

    fn input(&self, index: usize) -> Option<Value<f64>> {
        let inputs = self.at.inputs;
        declared_input((self.scene, self.layout), index, |at| {
            inputs.get(at).map(|x| x.to_f64())
        })
    }

    fn state(&self, index: usize) -> Option<f64> {
        let own = self.at.state.get(self.layout.states() + index);
        own.map(|x| x.to_f64())
    }

    fn time(&self) -> Option<f64> {
        Some(self.at.time.to_f64())
    }
}

/// The free length of a line at a time, for params, inputs and declared states [m], without a look at bodies.
#[must_use]
pub fn free_length<T: Float>(
    (scene, layout): (&Scene, &Layout),
    params: &[T],
    at: &At<'_, T>,
    line: &Line,
) -> f64 {
    let driven = Driven {
        scene,
        layout,
        params,
        at,
    };
    scalar(line.free_length_and_rate().0, &driven)
}

impl<S: Real> Evaluation<'_, S> {
    /// The rate of an expression of inputs, states, time, places and coordinates by (1).
    pub(crate) fn rate_of(&self, formula: &Formula) -> S {
        let [rate] = scalar(formula, &Winding(self)).slopes;
        rate
    }

    /// The same of a vector.
    pub(crate) fn rates_of(&self, formula: &Formula) -> Vector3<S> {
        vector(formula, &Winding(self)).map(|part| part.slopes[0])
    }

    /// The free length of a line that is wound [m]; `None` of one that is not.
    pub(crate) fn wound(&self, line: usize) -> Option<S> {
        let declared = self.scene.lines.get(line)?;
        if !declared.is_wound(self.scene) {
            return None;
        }
        S::section(&declared.name);
        let (length, _) = declared.free_length_and_rate();
        Some(scalar(length, self).label("free_length"))
    }

    /// Its rate by (1), or as declared [m/s]; `None` of a line that is not wound.
    pub(crate) fn rate_of_winding(&self, line: usize) -> Option<S> {
        let declared = self.scene.lines.get(line)?;
        if !declared.is_wound(self.scene) {
            return None;
        }
        S::section(&declared.name);
        let rate = match declared.free_length_and_rate() {
            (_, Some(rate)) => scalar(rate, self),
            (length, None) => self.rate_of(length),
        };
        Some(rate.label("winding"))
    }
}
