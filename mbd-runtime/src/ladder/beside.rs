//! States at which rows lose rank: what accelerations and multipliers tend to there, from states on both sides along the motion, and what is
//! recorded there.
//!
//! Rows that lose rank for an instant leave some multipliers open there, but not before and after it, and λ runs through:
//!
//! ```text
//! λ̄(δ) = ½ (λ(t + δ) + λ(t − δ)),   λ(t) = (4 λ̄(δ) − λ̄(2δ))/3 + O(δ⁴)                         (1)
//! x(t ± δ) = x ± δ ẋ, put on the joints; ẋ by rows chosen at x                                  (2)
//! ```
//!
//! What the chosen rows get wrong of v̇ lies along the rows that were not chosen, and putting the speeds on the joints takes it out. Nothing
//! is found where rows lose rank for longer, or where nothing moves: there the multipliers have no value.
//! Source: derived. Rejected: the smallest multipliers at x, which differ from those before and after by a finite amount.

use mbd_scene::{Float, Model, Quantity};

use crate::dense::NEW;
use crate::dependence::dependent;
use crate::system::{External, System};

/// The power of the rounding unit ε that δ is, over the time in which the fastest point crosses the scene, as it goes or from rest: what
/// rounding leaves grows with ε/δ³, what (1) neglects with δ⁴.
const POWER: f64 = 1.0 / 7.0;

impl<T: Float, M: Model<T>, E: External<T>> System<'_, T, M, E> {
    /// Takes the accelerations to what they tend to on the way through a state where rows lose rank: rows chosen there leave open how fast
    /// the motion bends away from other branches.
    pub(super) fn tend(&mut self, time: f64, state: &[T]) {
        if self.ladder.lasting {
            return;
        }
        let chosen = self.ladder.dense.clone();
        match self.multipliers_beside(time, state, &chosen.force) {
            Some(multipliers) => {
                self.read_dense(time, state);
                self.read_right(time, state);
                self.ladder.dense.push(&multipliers);
            }
            None => {
                self.ladder.lasting = true;
                self.ladder.dense = chosen;
            }
        }
    }

    /// Energy and power of the stage that was evaluated last, where its multipliers are not those of the emitted elimination.
    pub(crate) fn power_anew(&mut self, time: f64, state: &[T]) {
        if !self.ladder.anew {
            return;
        }
        let mut found = self.ladder.dense.multipliers.clone();
        if self.ladder.regularised {
            let forced = self.ladder.dense.force.clone();
            found = self
                .multipliers_beside(time, state, &forced)
                .unwrap_or(found);
        }
        let mut energy = self.energy;
        self.by_multipliers(Quantity::Energy, (time, state), &found, &mut energy);
        self.energy = energy;
    }

    /// Whether what depends on multipliers is to be read by [`System::read_anew`] at a state that is looked at: rows lose rank there, or
    /// the rows of the emitted elimination are not those of the run.
    pub(crate) fn needs_anew(&mut self, time: f64, state: &[T]) -> bool {
        if !self.projection.any() {
            return false;
        }
        let margin = std::mem::replace(&mut self.ladder.margin, f64::NAN);
        self.measure(time, state);
        let regular = self.is_regular();
        self.ladder.margin = margin;
        !regular || self.solves_chosen()
    }

    /// Multipliers at a state that is looked at: what they tend to there, or else by rows chosen there; and the same with no numbers where
    /// they have no value, for joints whose rows take part in what repeats.
    #[cold]
    pub(crate) fn read_anew(&mut self, time: f64, state: &[T]) -> [Vec<f64>; 2] {
        let layout = self.model.layout();
        self.read_dense(time, state);
        let mut rows = std::mem::take(&mut self.ladder.spare);
        self.ladder.dense.choose(&mut rows);
        self.read_right(time, state);
        let dense = &mut self.ladder.dense;
        dense.factor(&rows);
        dense.accelerate(&rows);
        let multipliers = dense.multipliers.clone();
        let mut determined = multipliers.clone();
        let forced = dense.force.clone();
        let found = dependent(&dense.jacobian, layout.nv, &dense.right, NEW);
        for slots in &layout.joints {
            let own = slots.row..slots.row + slots.len;
            if found.rows.iter().any(|row| own.contains(row)) {
                let own = determined.get_mut(own).unwrap_or_default();
                own.fill(f64::NAN);
            }
        }
        self.ladder.spare = rows;
        match self.multipliers_beside(time, state, &forced) {
            Some(limit) => [limit.clone(), limit],
            None => [multipliers, determined],
        }
    }

    /// λ by (1), for accelerations `forced` by rows chosen at the state; `None` where it tends to nothing.
    #[cold]
    fn multipliers_beside(&mut self, time: f64, state: &[T], forced: &[f64]) -> Option<Vec<f64>> {
        let layout = self.model.layout();
        // Forces at equilibrium points do not follow a state that is only looked at.
        if self.solves_chosen() || !layout.nodes.is_empty() {
            return None;
        }
        let mut rates = vec![0.0; layout.len(Quantity::Derivative)];
        self.by_laws(Quantity::Derivative, time, state, &mut rates);
        for (rate, forced) in rates.iter_mut().skip(layout.nq).zip(forced) {
            *rate = *forced;
        }
        let length = self.projection.length;
        let (positions, speeds) = rates.split_at(layout.nq.min(rates.len()));
        let most = |list: &[f64]| list.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let crossing = (length / most(positions)).min((length / most(speeds)).sqrt());
        let step = T::EPSILON.to_f64().powf(POWER) * crossing;
        if !step.is_finite() || rates.iter().any(|rate| !rate.is_finite()) {
            return None;
        }
        let (margin, inputs) = (self.ladder.margin, self.inputs.clone());
        let mean = |list: &mut Self, step: f64| {
            let mut sum = vec![0.0; layout.nc];
            for step in [step, -step] {
                let one = list.multipliers_after(time, step, state, &rates)?;
                sum.iter_mut().zip(&one).for_each(|(s, x)| *s += 0.5 * x);
            }
            Some(sum)
        };
        let means = [mean(self, step), mean(self, 2.0 * step)];
        self.ladder.margin = margin;
        self.inputs = inputs;
        let [Some(near), Some(far)] = means else {
            return None;
        };
        let both = near.iter().zip(&far);
        Some(both.map(|(near, far)| (4.0 * near - far) / 3.0).collect())
    }

    /// λ at (2).
    fn multipliers_after(
        &mut self,
        time: f64,
        step: f64,
        state: &[T],
        rates: &[f64],
    ) -> Option<Vec<f64>> {
        let time = time + step;
        let moved = state.iter().zip(rates);
        let mut moved: Vec<T> = moved
            .map(|(x, rate)| *x + T::from_f64(step * rate))
            .collect();
        self.normalise(&mut moved);
        self.supply(time, &moved).ok()?;
        self.put_on_joints(time, &mut moved).ok()?;
        self.ladder.margin = f64::NAN;
        self.measure(time, &moved);
        let mut multipliers = vec![0.0; self.model.layout().nc];
        self.by_laws(Quantity::Multipliers, time, &moved, &mut multipliers);
        let found = self.is_regular() && multipliers.iter().all(|x| x.is_finite());
        found.then_some(multipliers)
    }
}
