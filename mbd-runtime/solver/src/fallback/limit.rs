//! Limits at a singularity: accelerations and multipliers where rows lose rank, extrapolated from states on both sides along the motion, and
//! what is recorded there.
//!
//! Rows that lose rank for an instant leave some multipliers open there, but not before and after it, and λ runs through:
//!
//! ```text
//! λ̄(δ) = ½ (λ(t + δ) + λ(t − δ)),   λ(t) = (4 λ̄(δ) − λ̄(2δ))/3 + O(δ⁴),   v̇ likewise             (1)
//! x(t ± δ) = x ± δ ẋ, put on the joints; ẋ by rows chosen at x                                  (2)
//! ```
//!
//! What the chosen rows get wrong of v̇ lies along the rows that were not chosen, and putting the speeds on the joints takes it out. v̇ runs
//! through also where a multiplier grows without bound. Nothing is found where rows lose rank for longer, or where nothing moves: there
//! the multipliers have no value.
//! Source: derived. Rejected: the smallest multipliers at x, which differ from those before and after by a finite amount.

use mbd_scene::{Float, Quantity};

use super::dependent;
use super::limits::{POWER, WIDER};
use crate::laws::numbers_of;
use crate::moving::moving;
use crate::system::System;

/// Limits of multipliers and accelerations at a state where rows lose rank.
pub(super) struct SingularLimit {
    pub multipliers: Vec<f64>,
    pub accelerations: Vec<f64>,
}

impl<T: Float> System<T> {
    /// Takes the accelerations to their limit on the way through a state where rows lose rank: rows chosen there leave open how fast
    /// the motion bends away from other branches.
    pub(super) fn approach_limit(&mut self, time: f64, state: &[T]) {
        if self.fallback.lasting {
            return;
        }
        let chosen = self.fallback.dense.clone();
        let found = self.find_limit(time, state, &chosen.force);
        self.fallback.dense = chosen;
        let mut rows = std::mem::take(&mut self.fallback.held_mut().rows);
        match found {
            Some(limit) => {
                let model = self.model.clone();
                let layout = model.layout();
                let speeds = state.iter().skip(layout.nq).take(layout.nv);
                let speeds: Vec<f64> = speeds.map(|v| v.to_f64()).collect();
                let dense = &mut self.fallback.dense;
                dense.blend(&rows, &limit.accelerations, &speeds);
                dense.multipliers.copy_from_slice(&limit.multipliers);
            }
            None => {
                // Rows that are nearly dependent for good are all that holds here: fewer of them can be left out.
                self.fallback.lasting = true;
                self.read_dense(time, state);
                self.read_right(time, state);
                let dense = &mut self.fallback.dense;
                dense.choose(&mut rows);
                dense.factor(&rows);
                dense.accelerate(&rows);
            }
        }
        self.fallback.held_mut().rows = rows;
    }

    /// Energy and power of the stage that was evaluated last, where its multipliers are not those of the emitted elimination.
    pub(crate) fn power_anew(&mut self, time: f64, state: &[T]) {
        if !self.fallback.anew {
            return;
        }
        let mut found = self.fallback.dense.multipliers.clone();
        if self.fallback.regularised {
            let forced = self.fallback.dense.force.clone();
            found = self
                .find_limit(time, state, &forced)
                .map_or(found, |limit| limit.multipliers);
        }
        let mut energy = self.energy;
        self.by_multipliers(Quantity::Energy, (time, state), [&found, &[]], &mut energy);
        self.energy = energy;
    }

    /// Where what depends on multipliers is not that of the emitted elimination at a state that is looked at, as rows lose rank there, or are not those
    /// of the run: what [`System::read_anew`] finds there.
    pub(crate) fn look_anew(&mut self, time: f64, state: &[T]) -> Option<[Vec<f64>; 3]> {
        if !self.projection.any() {
            return None;
        }
        let margin = std::mem::replace(&mut self.fallback.margin, f64::NAN);
        let before = std::mem::replace(&mut self.fallback.held_mut().outdone, false);
        self.measure(time, state);
        let (regular, outdone) = (self.is_regular(), self.is_outdone(time, state));
        self.fallback.margin = margin;
        self.fallback.held_mut().outdone = outdone;
        let anew = !regular || outdone || self.solves_chosen();
        let found = anew.then(|| self.read_anew(time, state, regular));
        self.fallback.held_mut().outdone = before;
        found
    }

    /// Multipliers at a state that is looked at: their limit there, or else by rows chosen there; the same with no numbers where
    /// they have no value, for joints whose rows take part in what repeats; and the accelerations, which have a value everywhere. The rows kept still
    /// have multipliers of their own where these are `regular`.
    #[cold]
    fn read_anew(&mut self, time: f64, state: &[T], regular: bool) -> [Vec<f64>; 3] {
        let model = self.model.clone();
        let layout = model.layout();
        self.read_dense(time, state);
        let mut rows = std::mem::take(&mut self.fallback.spare);
        self.fallback.dense.choose(&mut rows);
        self.read_right(time, state);
        let dense = &mut self.fallback.dense;
        dense.factor(&rows);
        dense.accelerate(&rows);
        let multipliers = dense.multipliers.clone();
        let mut determined = multipliers.clone();
        let forced = dense.force.clone();
        let new_from = dense.new_from;
        let found = dependent(&dense.jacobian, layout.nv, &dense.right, new_from);
        for slots in &layout.joints {
            let own = slots.row..slots.row + slots.len;
            if found.rows.iter().any(|row| own.contains(row)) {
                let own = determined.get_mut(own).unwrap_or_default();
                own.fill(f64::NAN);
            }
        }
        let tell_all = rows.len() >= self.full_rank();
        self.fallback.spare = rows;
        if tell_all && self.solves_chosen() {
            return [multipliers, determined, forced];
        }
        match self.find_limit(time, state, &forced) {
            // Of rows chosen all along some repeat others: how they share the load is one choice of many.
            Some(limit) if self.solves_chosen() => {
                [limit.multipliers, determined, limit.accelerations]
            }
            // Rows that are as many as there ever are leave nothing of v̇ open.
            Some(limit) if tell_all => [limit.multipliers.clone(), limit.multipliers, forced],
            Some(limit) => [
                limit.multipliers.clone(),
                limit.multipliers,
                limit.accelerations,
            ],
            None if regular && tell_all && !self.solves_chosen() => {
                let mut kept = vec![0.0; layout.nc];
                self.by_laws(Quantity::Multipliers, time, state, &mut kept);
                [kept.clone(), kept, forced]
            }
            None => [multipliers, determined, forced],
        }
    }

    /// Whether limits are ever taken.
    pub(super) fn has_limits(&self) -> bool {
        // Forces at equilibrium points do not follow a state that is only looked at.
        self.projection.any() && self.model.layout().nodes.is_empty()
    }

    /// λ and v̇ by (1), for accelerations `forced` by rows chosen at the state; `None` where they have no limit.
    #[cold]
    fn find_limit(&mut self, time: f64, state: &[T], forced: &[f64]) -> Option<SingularLimit> {
        let model = self.model.clone();
        let layout = model.layout();
        if !self.has_limits() {
            return None;
        }
        let mut rates = vec![0.0; layout.len(Quantity::Derivative)];
        self.by_laws(Quantity::Derivative, time, state, &mut rates);
        for (rate, forced) in rates.iter_mut().skip(layout.nq).zip(forced) {
            *rate = *forced;
        }
        let speeds = state.iter().skip(layout.nq).map(|v| v.to_f64());
        let speed = self.crossings(&speeds.collect::<Vec<f64>>());
        let bend = self.crossings(rates.get(layout.nq..).unwrap_or_default());
        let step = T::EPSILON.to_f64().powf(POWER) / speed.max(bend.sqrt());
        if !step.is_finite() || rates.iter().any(|rate| !rate.is_finite()) {
            return None;
        }
        let (margin, inputs) = (self.fallback.margin, self.inputs.clone());
        let found = WIDER
            .into_iter()
            .find_map(|wider| self.limit(time, wider * step, state, &rates));
        self.fallback.margin = margin;
        self.inputs = inputs;
        found
    }

    /// (1) for one δ; `None` where rows lose rank at the neighbouring states, too.
    fn limit(&mut self, time: f64, step: f64, state: &[T], rates: &[f64]) -> Option<SingularLimit> {
        let model = self.model.clone();
        let layout = model.layout();
        let (near, far) = (4.0 / 6.0, -1.0 / 6.0);
        let mut rows = Vec::new();
        let mut sum = SingularLimit {
            multipliers: vec![0.0; layout.nc],
            accelerations: vec![0.0; layout.nv],
        };
        for (step, weight) in [
            (step, near),
            (-step, near),
            (2.0 * step, far),
            (-2.0 * step, far),
        ] {
            let one = self.after(time, step, (state, rates), &mut rows)?;
            let add = |sum: &mut [f64], one: &[f64]| {
                sum.iter_mut().zip(one).for_each(|(s, x)| *s += weight * x);
            };
            add(&mut sum.multipliers, &one.multipliers);
            add(&mut sum.accelerations, &one.accelerations);
        }
        Some(sum)
    }

    /// The largest of speeds over the reach of the joints and of angular speeds over a radian [1/s]; of accelerations likewise [1/s²].
    pub(super) fn crossings(&mut self, speeds: &[f64]) -> f64 {
        let reach = self.reach();
        let mut most: f64 = 0.0;
        for part in moving(self.model.layout()) {
            let own = speeds.get(part.speeds()).unwrap_or_default();
            for (index, speed) in own.iter().enumerate() {
                let is_linear = index < part.velocity.len();
                most = most.max(speed.abs() / if is_linear { reach } else { 1.0 });
            }
        }
        most
    }

    /// Twice the largest distance of a joint's frame from the centre of mass of its body; without one the length of the scene [m].
    pub(crate) fn reach(&mut self) -> f64 {
        let (model, length) = (&self.model, self.projection.length);
        *self.fallback.reach.get_or_insert_with(|| {
            let reach = numbers_of(&**model).longest_arm(model.scene());
            if reach > 0.0 { 2.0 * reach } else { length }
        })
    }

    /// λ and v̇ at (2); where rows are chosen all along, by the same `rows` at all of these states, chosen at the first.
    fn after(
        &mut self,
        time: f64,
        step: f64,
        (state, rates): (&[T], &[f64]),
        rows: &mut Vec<usize>,
    ) -> Option<SingularLimit> {
        let model = self.model.clone();
        let layout = model.layout();
        let time = time + step;
        let moved = state.iter().zip(rates);
        let mut moved: Vec<T> = moved
            .map(|(x, rate)| *x + T::from_f64(step * rate))
            .collect();
        self.normalise(&mut moved);
        self.supply(time, &moved).ok()?;
        self.put_on_joints(time, &mut moved).ok()?;
        self.fallback.margin = f64::NAN;
        self.measure(time, &moved);
        if self.solves_chosen() {
            return self.by_all_rows(time, &moved, rows);
        }
        let mut multipliers = vec![0.0; layout.nc];
        self.by_laws(Quantity::Multipliers, time, &moved, &mut multipliers);
        let mut accelerations = vec![0.0; layout.len(Quantity::Derivative)];
        self.by_laws(Quantity::Derivative, time, &moved, &mut accelerations);
        accelerations.drain(..layout.nq.min(accelerations.len()));
        accelerations.truncate(layout.nv);
        let mut all = multipliers.iter().chain(&accelerations);
        let found = self.is_regular() && all.all(|x| x.is_finite());
        found.then_some(SingularLimit {
            multipliers,
            accelerations,
        })
    }
}
