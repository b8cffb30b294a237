//! What rounding of positions makes of forces: far from the origin the numbers next to each other are so far apart that a line's stretch, a stop's
//! depth or a joint's gap has no digits left.
//!
//! ```text
//! ε |p| K / m   against   a = max(|g|, |v̇|, V²/L)        what lines, springs and stops hold                     (1)
//! ε |p|         against   the longest arm of the joints                                                          (2)
//! ```
//!
//! ε of the scalar, |p| the largest coordinate of a body, ΣK/m of what holds it, V and L the scales of the run. Source: derived, from a stretch
//! d − L0 whose d comes from positions rounded to ε |p|.

use mbd_scene::{Float, Layout, Part};

use crate::integrate::Scales;
use crate::moving::{Moving, moving};
use crate::stiffness::Stiffness;

/// From this part of a on a run is refused, or ends: one digit is left.
pub(crate) const REFUSED: f64 = 0.1;

/// What is known of (1) and (2) before a run.
#[derive(Debug)]
pub(crate) struct Rounding {
    /// Bodies and points with what holds them over their mass [1/s²].
    parts: Vec<(Moving, f64)>,
    /// The least that an acceleration is measured against [m/s²].
    acceleration: f64,
    /// The longest arm of the joints [m]; `None` without rows.
    arm: Option<f64>,
}

/// The body or point that rounding hurts most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hurt {
    pub part: Part,
    /// Its largest coordinate [m].
    pub distance: f64,
    /// What rounding makes, as a part of what matters.
    pub share: f64,
}

impl Rounding {
    /// That of a model, whose joints reach `arm` far [m].
    pub(crate) fn new(
        layout: &Layout,
        stiffness: &Stiffness,
        scales: Scales,
        arm: Option<f64>,
    ) -> Self {
        let parts = moving(layout).map(|part| {
            let rate = stiffness.moving(&part, false) / stiffness.mass(&part);
            (part, if rate.is_finite() { rate } else { 0.0 })
        });
        let own = scales.speed * scales.speed / scales.length;
        Rounding {
            parts: parts.collect(),
            acceleration: own.max(stiffness.gravity()),
            arm,
        }
    }

    /// The worst of (1) and (2) at a state with its rates.
    pub(crate) fn worst<T: Float>(&self, state: &[T], rates: &[T]) -> Option<Hurt> {
        let precision = T::EPSILON.to_f64();
        let largest = |list: &[T], range: std::ops::Range<usize>| {
            let own = list.get(range).unwrap_or_default();
            own.iter()
                .fold(0.0, |most: f64, x| most.max(x.to_f64().abs()))
        };
        let hurts = self.parts.iter().map(|(part, rate)| {
            let distance = largest(state, part.position.clone());
            let acceleration = self.acceleration.max(largest(rates, part.velocity.clone()));
            let force = precision * distance * rate / acceleration;
            let gap = self.arm.map_or(0.0, |arm| precision * distance / arm);
            Hurt {
                part: part.part,
                distance,
                share: force.max(gap),
            }
        });
        hurts.max_by(|a, b| a.share.total_cmp(&b.share))
    }
}
