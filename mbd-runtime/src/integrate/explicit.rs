//! One step of an explicit Runge–Kutta method.

use mbd_scene::Float;

use super::Rates;
use super::tableau::{DEGREE, Tableau};
use crate::error::StepError;
use crate::list::weighted_squares;

/// A method with the storage of its stages. The rates at the new state are the last stage of a step and the first of the next.
#[derive(Clone, Debug)]
pub(crate) struct Explicit<T> {
    length: usize,
    /// Per stage: its time c and the weights of the stages before it.
    rows: Vec<(f64, Vec<T>)>,
    /// Weights b − b̂, empty for a method without an estimate.
    error: Vec<T>,
    /// Coefficients of b_i(θ).
    dense: Vec<[T; DEGREE]>,
    /// Order of the error estimate plus one.
    pub exponent: f64,
    /// Stages, one after the other.
    stages: Vec<T>,
    trial: Vec<T>,
    next: Vec<T>,
}

impl<T: Float> Explicit<T> {
    /// Storage for states of a given length.
    pub(crate) fn new<const S: usize>(tableau: &Tableau<S>, length: usize) -> Self {
        let number = |x: &f64| T::from_f64(*x);
        let rows = tableau
            .a
            .iter()
            .zip(&tableau.c)
            .enumerate()
            .map(|(i, (row, &c))| (c, row.iter().take(i).map(number).collect()))
            .collect();
        let error = if tableau.embedded > 0 {
            tableau.error.iter().map(number).collect()
        } else {
            Vec::new()
        };
        Explicit {
            length,
            rows,
            error,
            dense: tableau
                .dense
                .iter()
                .map(|row| row.map(T::from_f64))
                .collect(),
            exponent: (tableau.embedded + 1) as f64,
            stages: vec![T::zero(); S * length],
            trial: vec![T::zero(); length],
            next: vec![T::zero(); length],
        }
    }

    /// The first stage: the rates at the start of a step, `span` after the last accepted one. Needed once, and again after anything jumped.
    pub(crate) fn begin(
        &mut self,
        system: &mut impl Rates<T>,
        time: f64,
        span: f64,
        state: &[T],
    ) -> Result<(), StepError> {
        match self.stages.get_mut(..self.length) {
            Some(first) => system.rates(time, span, state, first),
            None => Ok(()),
        }
    }

    /// Tries a step from `state`; the result is [`Explicit::next`], and `state` is untouched.
    pub(crate) fn attempt(
        &mut self,
        system: &mut impl Rates<T>,
        time: f64,
        step: f64,
        state: &[T],
    ) -> Result<(), StepError> {
        let h = T::from_f64(step);
        let last = self.rows.len() - 1;
        system.enter();
        for (i, (c, row)) in self.rows.iter().enumerate().skip(1) {
            let (done, rest) = self.stages.split_at_mut(i * self.length);
            combine(state, h, row.iter().copied(), done, &mut self.trial);
            let span = c * step;
            if i == last {
                system.project_end(time + span, &mut self.trial)?;
                self.next.copy_from_slice(&self.trial);
            }
            let (stage, _) = rest.split_at_mut(self.length);
            system.rates(time + span, span, &self.trial, stage)?;
        }
        Ok(())
    }

    /// The state at the end of the last attempt.
    pub(crate) fn next(&self) -> &[T] {
        &self.next
    }

    /// Takes the last attempt: its last stage becomes the first of the next step.
    pub(crate) fn accept(&mut self, state: &mut [T]) {
        state.copy_from_slice(&self.next);
        let last = self.stages.len() - self.length;
        self.stages.copy_within(last.., 0);
    }

    /// The estimate h Σ (b_i − b̂_i) k_i of the error of the last attempt, and the state at its end.
    pub(crate) fn estimate(&mut self, step: f64) -> (&[T], &[T]) {
        self.trial.fill(T::zero());
        let h = T::from_f64(step);
        for (weight, stage) in self
            .error
            .iter()
            .zip(self.stages.chunks_exact(self.length.max(1)))
        {
            let scaled = h * *weight;
            for (sum, rate) in self.trial.iter_mut().zip(stage) {
                *sum += scaled * *rate;
            }
        }
        (&self.trial, &self.next)
    }

    /// The state at `theta` (0 … 1) of the last attempt, which started at `state`.
    pub(crate) fn interpolate(&self, theta: f64, step: f64, state: &[T], out: &mut [T]) {
        let t = T::from_f64(theta);
        let weights = self
            .dense
            .iter()
            .map(|[a, b, c, d]| (((*d * t + *c) * t + *b) * t + *a) * t);
        combine(state, T::from_f64(step), weights, &self.stages, out);
    }

    /// 2 |k₃ − k₂| / |k₂ − k₁|: step times the largest rate of the system, as the stages of RK4 show it; zero where the stages agree to
    /// `negligible` of k₁. |k|² = Σ weight k².
    pub(crate) fn stiffness(&self, weights: &[T], negligible: f64) -> f64 {
        let mut stages = self.stages.chunks_exact(self.length.max(1));
        let (Some(k1), Some(k2), Some(k3)) = (stages.next(), stages.next(), stages.next()) else {
            return 0.0;
        };
        let [below, size] = weighted_squares(weights, k1, k2);
        let [above, _] = weighted_squares(weights, k2, k3);
        let (above, below, size) = (above.to_f64(), below.to_f64(), size.to_f64());
        if below > 0.0 && above > negligible * negligible * size {
            2.0 * (above / below).sqrt()
        } else {
            0.0
        }
    }

    /// The rates at the start of the step, to be changed.
    pub(crate) fn first_mut(&mut self) -> &mut [T] {
        self.stages.get_mut(..self.length).unwrap_or_default()
    }

    /// The rates at the start of the step.
    pub(crate) fn first(&self) -> &[T] {
        self.stages.get(..self.length).unwrap_or(&[])
    }
}

/// out = state + h Σ w_i k_i, stages one after the other.
fn combine<T: Float>(
    state: &[T],
    h: T,
    weights: impl Iterator<Item = T>,
    stages: &[T],
    out: &mut [T],
) {
    out.copy_from_slice(state);
    for (weight, stage) in weights.zip(stages.chunks_exact(state.len().max(1))) {
        if weight == T::zero() {
            continue;
        }
        let scaled = h * weight;
        for (sum, rate) in out.iter_mut().zip(stage) {
            *sum += scaled * *rate;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrate::{RK4, TSIT5};

    /// A pendulum, q̈ = −sin q, with a reference from tiny steps.
    struct Pendulum;

    impl Rates<f64> for Pendulum {
        fn rates(
            &mut self,
            time: f64,
            _: f64,
            state: &[f64],
            out: &mut [f64],
        ) -> Result<(), StepError> {
            if let ([q, v], [dq, dv]) = (state, out) {
                *dq = *v;
                *dv = -q.sin() + 0.3 * time.cos();
            }
            Ok(())
        }

        fn project_end(&mut self, _: f64, _: &mut [f64]) -> Result<(), StepError> {
            Ok(())
        }
    }

    /// The largest error at step ends and at seven places inside each step, over 4 s.
    fn errors<const S: usize>(tableau: &Tableau<S>, steps: usize) -> [f64; 2] {
        let h = 4.0 / steps as f64;
        let fine = 64;
        let mut method = Explicit::<f64>::new(tableau, 2);
        let mut exact = Explicit::<f64>::new(&TSIT5, 2);
        let (mut x, mut y) = ([2.0, 0.0], [2.0, 0.0]);
        let mut worst = [0.0_f64; 2];
        method.begin(&mut Pendulum, 0.0, 0.0, &x).unwrap();
        exact.begin(&mut Pendulum, 0.0, 0.0, &y).unwrap();
        for i in 0..steps {
            let t = i as f64 * h;
            method.attempt(&mut Pendulum, t, h, &x).unwrap();
            for k in 0..fine {
                let small = h / fine as f64;
                exact
                    .attempt(&mut Pendulum, t + k as f64 * small, small, &y)
                    .unwrap();
                exact.accept(&mut y);
                if k % 8 == 7 {
                    let theta = (k + 1) as f64 / fine as f64;
                    let mut inside = [0.0; 2];
                    method.interpolate(theta, h, &x, &mut inside);
                    worst[1] = worst[1].max((inside[0] - y[0]).abs());
                }
            }
            method.accept(&mut x);
            worst[0] = worst[0].max((x[0] - y[0]).abs());
        }
        worst
    }

    fn orders<const S: usize>(tableau: &Tableau<S>) -> [f64; 2] {
        let (coarse, fine) = (errors(tableau, 40), errors(tableau, 80));
        println!("{coarse:?} {fine:?}");
        [0, 1].map(|i| (coarse[i] / fine[i]).log2())
    }

    #[test]
    fn rk4_and_its_cubic_are_of_order_four() {
        let [ends, inside] = orders(&RK4);
        assert!(ends > 3.85 && inside > 3.85, "{ends} {inside}");
    }

    #[test]
    fn tsit5_is_of_order_five_and_its_interpolant_at_least_of_order_four() {
        let [ends, inside] = orders(&TSIT5);
        assert!(ends > 4.85 && inside > 4.0, "{ends} {inside}");
    }

    #[test]
    fn the_last_stage_is_the_first_of_the_next_step() {
        let mut method = Explicit::<f64>::new(&TSIT5, 2);
        let mut x = [2.0, 0.0];
        method.begin(&mut Pendulum, 0.0, 0.0, &x).unwrap();
        method.attempt(&mut Pendulum, 0.0, 0.1, &x).unwrap();
        method.accept(&mut x);
        let carried = method.first().to_vec();
        method.begin(&mut Pendulum, 0.1, 0.0, &x).unwrap();
        assert_eq!(carried, method.first());
    }
}
