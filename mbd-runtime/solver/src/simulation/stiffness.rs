//! Stiff systems: seen by an explicit method, named where it cannot go on, and left to the stiff method in runs that have both.

use mbd_scene::{Float, Line, Part, Place};

use super::{ModelRun, Pace};
use crate::error::Stiff;
use crate::integrate::Rates;
use crate::list::weighted_size;

/// The part of the limit of stability at which steps are that it bounds.
const AT_LIMIT: f64 = 0.9;
/// Powers of the Jacobian, and those of them that are still looking for the fastest direction.
const POWERS: u32 = 12;
const BLIND: u32 = 4;
/// So many steps say nothing of what bounds the others.
const FEW: u64 = 20;
/// How far a state is moved for a difference, in steps.
const NEAR: f64 = 1e-3;

impl<T: Float> ModelRun<T> {
    /// Looks at the attempted step of an adaptive run before it is taken; true when the run goes on with its other method.
    #[inline]
    pub(super) fn sees_stiffness(&mut self, step: f64) -> bool {
        match self.pace {
            Pace::Fixed(_) => false,
            Pace::Adaptive(..) => self.compare_with_limit(step),
        }
    }

    fn compare_with_limit(&mut self, step: f64) -> bool {
        let part = self.method.part_of_limit(step, &self.watch_weights);
        let changes = match self.method.is_stiff() {
            true => self.stiffness.eases(part),
            false => self.stiffness.sees(part),
        };
        changes && self.method.has_both()
    }

    /// Goes on with the other method, from the step that was taken.
    pub(super) fn change_method(&mut self) {
        self.method.change();
        self.stiffness = Default::default();
        let counters = &mut self.system.counters;
        counters.method_changes = counters.method_changes.saturating_add(1);
        if let Pace::Adaptive(control, _) = &mut self.pace {
            control.retune([self.method.exponent(), self.method.memory()]);
        }
    }

    /// What makes the steps of an explicit method small, if it is stiffness, after so many of them.
    #[cold]
    pub(super) fn stiff(&mut self, steps: u64) -> Option<Box<Stiff>> {
        let Pace::Adaptive(control, norm) = &self.pace else {
            return None;
        };
        if self.method.is_stiff() {
            return None;
        }
        let (step, limit) = (control.step, self.method.limit());
        let (part, block) = match self.stiffness.is_stiff() {
            true => {
                let part = self.method.part_of_limit(step, &self.watch_weights);
                let block = norm.heaviest(&self.watch_weights, self.method.differences());
                (part, block)
            }
            false if steps < FEW => return None,
            false => {
                let (rate, fastest) = self.fastest_by_powers(step)?;
                let part = step * rate / limit;
                let Pace::Adaptive(_, norm) = &self.pace else {
                    return None;
                };
                (part > AT_LIMIT).then(|| (part, norm.heaviest(&self.watch_weights, &fastest)))?
            }
        };
        let Pace::Adaptive(_, norm) = &self.pace else {
            return None;
        };
        let (scene, lines) = (self.system.model.scene(), self.system.model.lines());
        let owner = norm.owner(block);
        // The line with the largest rate on this body or point, as a step sees it: C + K h.
        let held = |line: &&(usize, &Line)| owner.is_some_and(|part| holds(line.1, part));
        let rate = |index: usize| {
            let numbers = lines.get(index);
            numbers.map_or(0.0, |line| {
                line.damping.to_f64() + step * line.stiffness.to_f64()
            })
        };
        let all: Vec<(usize, &Line)> = scene.lines.iter().enumerate().collect();
        let line = all.iter().filter(held);
        let line = line.max_by(|a, b| rate(a.0).total_cmp(&rate(b.0)));
        Some(Box::new(Stiff {
            method: self.options.method.name(),
            rho: part * limit,
            limit,
            block: norm.name(block, scene),
            line: line.map(|(_, line)| line.name.clone()),
        }))
    }
}

impl<T: Float> ModelRun<T> {
    /// The largest rate of the scene as it stands [1/s], and the direction that changes so, by powers of ∂ẋ/∂x from differences of ẋ. Two stages at the same time
    /// show it where what is fast differs between them more than all else, and not where something light hangs on what is heavy and slow.
    #[cold]
    fn fastest_by_powers(&mut self, step: f64) -> Option<(f64, Vec<T>)> {
        let weights = self.watch_weights.clone();
        let size = |x: &[T]| weighted_size(&weights, x).to_f64().sqrt();
        let time = self.time + self.behind_jump();
        let mut begun = vec![T::zero(); self.state.len()];
        let rates = self.system.rates_inside(time, 0.0, &self.state, &mut begun);
        rates.ok()?;
        // As far as a part of a step: what is moved so far is not bent.
        let apart = NEAR * step * size(&begun);
        let mut direction = begun.clone();
        for (index, (x, weight)) in direction.iter_mut().zip(&weights).enumerate() {
            // No direction is left out.
            let own = T::from_f64(1.0 + 0.3 * (index as f64).sin());
            *x = match *weight > T::zero() {
                true => own / weight.sqrt(),
                false => T::zero(),
            };
        }
        let (mut moved, mut logarithm) = (begun.clone(), 0.0);
        for power in 0..POWERS {
            let scale = T::from_f64(apart / size(&direction));
            for (inside, (state, x)) in self
                .inside
                .iter_mut()
                .zip(self.state.iter().zip(&direction))
            {
                *inside = *state + scale * *x;
            }
            let rates = self
                .system
                .rates_inside(time, 0.0, &self.inside, &mut moved);
            rates.ok()?;
            for (x, (now, before)) in direction.iter_mut().zip(moved.iter().zip(&begun)) {
                *x = *now - *before;
            }
            let rate = size(&direction) / apart;
            if !(rate.is_finite() && rate > 0.0) {
                return None;
            }
            if power >= BLIND {
                logarithm += rate.ln();
            }
        }
        let rate = (logarithm / f64::from(POWERS - BLIND)).exp();
        Some((rate, direction))
    }
}

/// Whether a line ends on a body or a point.
fn holds(line: &Line, part: Part) -> bool {
    [line.from, line.to].iter().any(|end| match *end {
        Place::Body(body, _) => part == Part::Body(body),
        Place::Point(point) => part == Part::Point(point),
        Place::World(_) => false,
    })
}
