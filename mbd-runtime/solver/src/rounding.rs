//! What rounding of positions makes of forces: far from the origin the numbers next to each other are so far apart that a line's stretch, a stop's
//! depth or a joint's gap has no digits left.
//!
//! ```text
//! ε |p| K   against   m a,  a = max(|g|, |v̇|, V²/L)      what lines, springs and stops hold                     (1)
//! ε |p|         against   the longest arm of the joints                                                          (2)
//! ```
//!
//! ε of the scalar, |p| the largest coordinate of a body, one that a joint of the tree carries included, ΣK of what holds it, m the largest mass that it is tied to, V and L the scales of the run: a
//! light point passes on the forces between heavy bodies, and it is these that must have digits. So a light body that hangs on a heavy one is
//! measured against the heavy one, too. Source: derived, from a stretch d − L0 whose d comes from positions rounded to ε |p|.

use mbd_scene::{Directions, Float, Joint, Layout, Part};

use crate::integrate::Scales;
use crate::moving::{Moving, moving};
use crate::stiffness::Stiffness;

/// From this part of a on a run is refused, or ends: one digit is left.
pub(crate) const REFUSED: f64 = 0.1;

/// What is known of (1) and (2) before a run.
#[derive(Debug)]
pub(crate) struct Rounding {
    /// Bodies and points with what holds them over the largest mass that they are tied to [1/s²].
    parts: Vec<(Moving, f64)>,
    /// The least that an acceleration is measured against [m/s²].
    acceleration: f64,
    /// The longest arm of the joints [m]; `None` without rows.
    arm: Option<f64>,
    directions: Directions,
}

/// The body or point whose forces rounding changes most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Affected {
    pub part: Part,
    /// Its largest coordinate [m].
    pub distance: f64,
    /// What rounding makes, as a part of what matters.
    pub share: f64,
}

impl Rounding {
    /// That of a model, whose joints reach `arm` far [m].
    pub(crate) fn new(
        (layout, joints): (&Layout, &[Joint]),
        stiffness: &Stiffness,
        scales: Scales,
        arm: Option<f64>,
    ) -> Self {
        let parts: Vec<Moving> = moving(layout).collect();
        let tied = stiffness.heaviest_tied(joints, &parts);
        let rates = parts.iter().zip(tied).map(|(part, mass)| {
            let rate = stiffness.moving(part, false) / mass;
            if rate.is_finite() { rate } else { 0.0 }
        });
        let rates: Vec<f64> = rates.collect();
        let own = scales.speed * scales.speed / scales.length;
        Rounding {
            parts: parts.into_iter().zip(rates).collect(),
            acceleration: own.max(stiffness.gravity()),
            arm,
            directions: layout.directions,
        }
    }

    /// The worst of (1) and (2) at a state with its rates. `bodies`: [`Quantity::Bodies`](mbd_scene::Quantity::Bodies), empty in absolute coordinates.
    pub(crate) fn worst<T: Float>(
        &self,
        state: &[T],
        rates: &[T],
        bodies: &[T],
    ) -> Option<Affected> {
        let precision = T::EPSILON.to_f64();
        let largest = |list: &[T], range: std::ops::Range<usize>| {
            let own = list.get(range).unwrap_or_default();
            own.iter()
                .fold(0.0, |most: f64, x| most.max(x.to_f64().abs()))
        };
        let affected = self.parts.iter().map(|(part, rate)| {
            let carried = part.carried.map_or(0..0, |body| {
                let first = self.directions.motion() * body;
                first..first + self.directions.translations().len()
            });
            let distance = largest(state, part.position.clone()).max(largest(bodies, carried));
            let acceleration = self.acceleration.max(largest(rates, part.velocity.clone()));
            let force = precision * distance * rate / acceleration;
            let gap = self.arm.map_or(0.0, |arm| precision * distance / arm);
            Affected {
                part: part.part,
                distance,
                share: force.max(gap),
            }
        });
        affected.max_by(|a, b| a.share.total_cmp(&b.share))
    }
}
