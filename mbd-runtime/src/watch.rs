//! A fixed step that is too large is silent: the tension clamp turns instability into bounded chatter with worthless forces.
//!
//! The stages of RK4 show step times largest rate, hρ = 2 |k₃ − k₂| / |k₂ − k₁|. Five of the last fifty steps above 2.5 stop the run: the method is
//! stable up to about 2.8. The norm is |k|² = |v̇|² + ω² |q̇|², ω² = the largest ΣK/m of a body or point over its lines. In it the exchange of
//! kinetic and elastic energy is a rotation, and the ratio is bounded by the rates of the scene; in the plain sum of squares a step whose stages differ
//! mostly in velocity shows h K/m instead of h √(K/m). Stages that agree to 1e-3 of k₁ say nothing: on a smooth motion k₂ − k₁ can vanish in the slow
//! directions and leave any ratio (a smooth run with a 0.1 kg point, h = 1e-4 s and hρ = 1.8 shows 2.5 there), while an unstable run soon has
//! differences as large as the rates themselves.

/// What hρ may not exceed often.
const LIMIT: f64 = 2.5;
/// Differences of stages below this part of k₁ are not looked at.
pub(crate) const NEGLIGIBLE: f64 = 1e-3;
/// How many steps are remembered, and how many of them may exceed the limit.
const WINDOW: u32 = 50;
const ALLOWED: u32 = 5;

use mbd_scene::{Float, Model, Place, PointSlots};
use serde::{Deserialize, Serialize};

/// The last fifty steps of a fixed-step run, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Watch {
    above: u64,
}

impl Watch {
    /// Records one step; true when the run is unstable.
    pub(crate) fn sees(&mut self, stiffness: f64) -> bool {
        let kept = (1_u64 << WINDOW) - 1;
        self.above = ((self.above << 1) | u64::from(stiffness > LIMIT)) & kept;
        self.above.count_ones() >= ALLOWED
    }
}

/// The weight ω² of the norm above [1/s²], from the mass matrix (dense, row by row).
pub(crate) fn weight<T: Float, M: Model<T>>(model: &M, mass_matrix: &[T]) -> f64 {
    let (scene, layout) = (model.scene(), model.layout());
    let mass = |v: usize| {
        mass_matrix
            .get(v * (layout.nv + 1))
            .map_or(0.0, |m| m.to_f64())
    };
    let bodies = layout.bodies.iter().enumerate();
    let bodies = bodies.map(|(body, slots)| (slots.v, Owner::Body(body)));
    let points = layout.points.iter().enumerate();
    let points = points.filter_map(|(point, slots)| match slots {
        PointSlots::Mass(slots) => Some((slots.v, Owner::Point(point))),
        PointSlots::Node(_) => None,
    });
    let mut largest: f64 = 0.0;
    for (v, owner) in bodies.chain(points) {
        let attached = scene
            .lines
            .iter()
            .zip(model.lines())
            .filter(|(line, _)| owner.holds(line.from) || owner.holds(line.to));
        let stiffness: f64 = attached
            .map(|(_, numbers)| numbers.stiffness.to_f64())
            .sum();
        let rate = stiffness / mass(v);
        largest = if rate.is_finite() {
            largest.max(rate)
        } else {
            largest
        };
    }
    largest.max(1.0)
}

enum Owner {
    Body(usize),
    Point(usize),
}

impl Owner {
    fn holds(&self, place: Place) -> bool {
        match (self, place) {
            (Owner::Body(body), Place::Body(other, _)) => *body == other,
            (Owner::Point(point), Place::Point(other)) => *point == other,
            _ => false,
        }
    }
}

/// A step that should be stable, given the hρ seen at `step`: hρ = 2, with the rate taken no smaller than the limit implies.
pub(crate) fn suggestion(step: f64, stiffness: f64) -> f64 {
    step * 2.0 / stiffness.max(LIMIT)
}
