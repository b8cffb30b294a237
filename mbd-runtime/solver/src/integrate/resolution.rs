//! How finely positions and attitudes are resolved: what counts as one unit of error of each.

use mbd_scene::Layout;

use super::Scales;
use crate::event::Acting;
use crate::moving::{Moving, Owners, moving};
use crate::stiffness::Stiffness;

/// What counts as one unit of error of the position [m] and of the attitude [rad] of each body and point: the scales of the run, and where lines and
/// stops that act one way hold it, no more than the amplitude V/ω at which it swings on them at the speed scale V. An error of a position is an
/// error K δ of their forces: so it is a part of the force V √(K m) of a stop at that speed, however stiff they are.
#[derive(Debug)]
pub(crate) struct Resolution {
    scales: Scales,
    sizes: Vec<[f64; 2]>,
    owners: Owners,
}

impl Resolution {
    pub(crate) fn new(layout: &Layout, stiffness: &Stiffness, scales: Scales) -> Self {
        let size = |part: &Moving| {
            let [moving, turning] = stiffness.rates(part);
            [
                scales.length.min(scales.speed / moving),
                scales.angle.min(scales.rate / turning),
            ]
        };
        Resolution {
            scales,
            sizes: moving(layout).map(|part| size(&part)).collect(),
            owners: Owners::of(layout),
        }
    }

    /// Of a body or a point: length [m] and angle [rad].
    pub(crate) fn of(&self, part: &Moving) -> [f64; 2] {
        let own = self.owners.place_of(part);
        let own = own.and_then(|at| self.sizes.get(at).copied());
        own.unwrap_or([self.scales.length, self.scales.angle])
    }

    /// Of the stretch of an element, or of its depth [m or rad]: that of the finer resolved of the two that it acts between, and what their velocities
    /// add to K s + C ṡ, over K. A line at an equilibrium point, whose place follows from all its lines, is resolved as lengths are.
    pub(crate) fn between(&self, acting: &Acting) -> f64 {
        let (scale, rate) = match acting.angle {
            true => (self.scales.angle, self.scales.rate),
            false => (self.scales.length, self.scales.speed),
        };
        match acting.at_node {
            true => scale,
            false => scale.min(self.finest(acting) + acting.delay * rate),
        }
    }

    /// V/ω of the finer resolved of the two that an element acts between, at most the scale [m or rad].
    fn finest(&self, acting: &Acting) -> f64 {
        let angle = usize::from(acting.angle);
        let ends = acting.ends.iter();
        let held = ends.filter_map(|end| self.sizes.get(self.owners.at(*end)?));
        let scale = [self.scales.length, self.scales.angle][angle];
        held.map(|sizes| sizes[angle]).fold(scale, f64::min)
    }

    /// A stretch, or K s + C ṡ over K, times how long it lasts, by which the element changes a velocity by its scale V: V/ω² [m s or rad s]; without bound at an
    /// equilibrium point.
    pub(crate) fn lasting(&self, acting: &Acting) -> f64 {
        let rate = match acting.angle {
            true => self.scales.rate,
            false => self.scales.speed,
        };
        match acting.at_node {
            true => f64::INFINITY,
            false => self.finest(acting).powi(2) / rate,
        }
    }
}
