//! Whether positions have the digits that the tolerance of a run asks for.

use mbd_scene::random::SplitMix64;
use mbd_scene::{Float, Part, Quantity};

use super::{Pace, Simulation};
use crate::integrate::ErrorNorm;
use crate::moving::moving;
use crate::rounding::{CoarseLook, CoarsePositions, ENOUGH};
use crate::system::System;

/// By so many numbers at most positions are moved where digits are looked at: two that are rounded to one each differ by about as much in the rates of all stages.
const NUMBERS: f64 = 2.5;
impl<T: Float> Simulation<T> {
    /// Looks at what rounding of positions makes of the error of the next step.
    pub(super) fn watch_digits(&mut self) {
        if let Pace::Adaptive(control, norm) = &self.pace {
            let look = coarse_look(
                &mut self.system,
                (self.time, &self.state),
                (norm, control.step),
                &mut self.digit_room,
            );
            self.step_rounding.see(look);
        }
    }

    /// Positions with fewer digits than the tolerance of this run asks for, so that rounding decided its adaptive steps for the most part: far from the origin
    /// of the world, or in single precision.
    #[must_use]
    pub fn coarse_positions(&self) -> Option<CoarsePositions> {
        let model = &self.system.model;
        let known = (model.scene(), model.layout());
        self.step_rounding.told::<T>(known, self.sizes.length())
    }
}

/// What rounding of positions at a state makes of the error of a step; `None` where they have more digits than its norm asks for.
fn coarse_look<T: Float>(
    system: &mut System<T>,
    (time, state): (f64, &[T]),
    (norm, step): (&ErrorNorm, f64),
    [moved, here, there]: &mut [Vec<T>; 3],
) -> Option<CoarseLook> {
    let model = system.model.clone();
    let layout = model.layout();
    let apart = norm.coarseness(state);
    if apart < ENOUGH {
        return None;
    }
    // By a few numbers, each by others, and by others at every look: what goes along moves apart.
    let mut random = SplitMix64(time.to_bits());
    moved.clear();
    moved.extend_from_slice(state);
    for at in moving(layout).flat_map(|part| part.position) {
        if let Some(x) = moved.get_mut(at) {
            *x += T::from_f64(NUMBERS * random.number()) * T::EPSILON * *x;
        }
    }
    let rates = layout.len(Quantity::Derivative);
    for (state, rates_there) in [(state, &mut *here), (moved, &mut *there)] {
        rates_there.clear();
        rates_there.resize(rates, T::zero());
        system.at_another_time(Quantity::Derivative, time, state, rates_there);
    }
    // The rates are rounded themselves, too.
    let step = T::from_f64(step);
    for (change, there) in here.iter_mut().zip(there) {
        *change = step * ((*there - *change).abs() + T::EPSILON * change.abs());
    }
    here.resize(state.len(), T::zero());
    let (share, block) = norm.largest(here, state, state);
    let parts = moving(layout).enumerate().map(|(part, own)| {
        let own_state = state.get(own.position).unwrap_or_default();
        let far = own_state.iter().map(|x| x.to_f64().abs());
        (part, own.part, far.fold(0.0, f64::max))
    });
    // That of the error, where it has a position of its own; else the furthest.
    let owner = norm.owner(block);
    let (part, _, distance) = parts.max_by(|a, b| {
        let key = |(_, part, far): &(usize, Part, f64)| (owner == Some(*part) && *far > 0.0, *far);
        let (a, b) = (key(a), key(b));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    })?;
    Some(CoarseLook {
        share,
        part,
        distance,
        apart: apart * norm.tolerance,
    })
}
