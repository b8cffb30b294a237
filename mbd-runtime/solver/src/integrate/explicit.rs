//! One step of an explicit Runge–Kutta method.
//!
//! In single precision what a step adds may be no more than the distance of two numbers next to each other: h f vanishes below ε |x|. A number that grows
//! evenly, as the angle of a wheel, is rounded to the same side at every step. What rounding takes from the sum is therefore added in the next step,
//! so that the state is off by one rounding and not by one a step:
//!
//! ```text
//! d = c + h Σ b k,   x⁺ = x + d,   c⁺ = d − (x⁺ − x)                                                                   (1)
//! ```
//!
//! Source: Kahan, Further remarks on reducing truncation errors (1965). In double precision c is not kept: no step is so short.
//! What it would be of the steps of a run is estimated instead ([`crate::state_rounding`]).

use mbd_scene::{Float, Real};

use super::tableau::Tableau;
use super::{Made, RK4, Rates};
use crate::error::StepError;
use crate::list::{Combination, MOST_TERMS, combine, weighted_change, weighted_size};

/// Rounding units of rates below which two of them agree.
const ROUNDING: f64 = 1e4;
/// The distance of numbers next to 1 above which steps are summed by (1).
const SHORT: f64 = 1e-10;

/// A stage: its time c and the weights of the stages before it.
#[derive(Clone, Debug)]
struct StageRow<T> {
    c: f64,
    weights: Vec<T>,
    sum: Combination<T>,
}

/// A method with the storage of its stages. The rates at the new state are the last stage of a step and the first of the next.
#[derive(Clone, Debug)]
pub(crate) struct Explicit<T> {
    length: usize,
    rows: Vec<StageRow<T>>,
    /// How many of them a step has; those behind serve the interpolant.
    steps: usize,
    /// Weights b − b̂, empty for a method without an estimate.
    error: Vec<T>,
    /// Per stage the coefficients of b_i(θ).
    dense: Vec<Vec<T>>,
    /// Order of the error estimate plus one.
    pub exponent: f64,
    /// |hλ| on the negative real axis up to which a step is stable.
    pub stable: f64,
    /// Two stages at the same time.
    alike: [usize; 2],
    /// Whether this is RK4, whose stages inside a step a system may make at once.
    at_once: bool,
    /// Stages, one after the other.
    stages: Vec<T>,
    /// Whether the stages of the interpolant belong to the last attempt.
    complete: bool,
    trial: Vec<T>,
    next: Vec<T>,
    /// c of (1) at the start of the attempt and at its end; empty where it is not kept.
    lost: Vec<T>,
    loses: Vec<T>,
    /// Zero.
    nothing: Vec<T>,
}

/// x⁺ and c⁺ of (1), from d where x⁺ will be.
#[inline]
fn add_keeping<T: Real>(state: &[T], next: &mut [T], loses: &mut [T]) {
    for ((x, next), lost) in state.iter().zip(next).zip(loses) {
        let added = *next;
        *next = *x + added;
        *lost = added - (*next - *x);
    }
}

/// What [`Explicit::stiffness`] says of [`Explicit::squares`].
#[inline]
pub(crate) fn stiffness<T: Float>(squares: [T; 3], negligible: f64) -> f64 {
    let [below, size, above] = squares.map(T::to_f64);
    if below > 0.0 && above > negligible * negligible * size {
        2.0 * (above / below).sqrt()
    } else {
        0.0
    }
}

impl<T: Real> Explicit<T> {
    /// Storage for states of a given length.
    pub(crate) fn new<const S: usize, const N: usize, const D: usize>(
        tableau: &Tableau<S, N, D>,
        length: usize,
    ) -> Self {
        let number = |x: &f64| T::from_f64(*x);
        let rows = tableau
            .a
            .iter()
            .zip(&tableau.c)
            .enumerate()
            .map(|(i, (row, &c))| {
                let weights: Vec<T> = row.iter().take(i).map(number).collect();
                let sum = Combination::new(&weights);
                StageRow { c, weights, sum }
            })
            .collect();
        let error = if tableau.embedded > 0 {
            tableau.error.iter().map(number).collect()
        } else {
            Vec::new()
        };
        let dense = tableau.dense.iter();
        Explicit {
            length,
            rows,
            steps: S,
            error,
            dense: dense.map(|row| row.iter().map(number).collect()).collect(),
            exponent: (tableau.embedded + 1) as f64,
            stable: tableau.stable,
            alike: tableau.alike,
            at_once: false,
            stages: vec![T::zero(); N * length],
            complete: false,
            trial: vec![T::zero(); length],
            next: vec![T::zero(); length],
            lost: Vec::new(),
            loses: Vec::new(),
            nothing: vec![T::zero(); length],
        }
    }

    /// The stages of a step of size `h` from `state` after the first one: `rates` is told whether a stage is the last, when it is and how long after the start
    /// of the step (the time `from` and the step `over`, in a scalar of their own), and writes the rates at its state, which it may change at the last.
    ///
    /// # Errors
    /// The first of `rates`.
    pub(crate) fn stages<C: Real, E>(
        &mut self,
        [from, over]: [C; 2],
        h: T,
        state: &[T],
        mut rates: impl FnMut(bool, [C; 2], &mut [T], &mut [T]) -> Result<(), E>,
    ) -> Result<(), E> {
        self.complete = false;
        let Some(([_, inner @ ..], [last])) = self
            .rows
            .get(..self.steps)
            .and_then(|rows| rows.split_last_chunk())
        else {
            return Ok(());
        };
        let mut place = self.length;
        let mut stage = |row: &StageRow<T>, trial: &mut [T], is_last: bool| {
            let (done, rest) = self.stages.split_at_mut(place);
            place += self.length;
            if is_last && !self.lost.is_empty() {
                row.sum.add(&self.lost, h, done, trial);
                add_keeping(state, trial, &mut self.loses);
            } else {
                row.sum.add(state, h, done, trial);
            }
            let (stage, _) = rest.split_at_mut(self.length);
            let span = C::from_f64(row.c) * over;
            rates(is_last, [from + span, span], trial, stage)
        };
        for row in inner {
            stage(row, &mut self.trial, false)?;
        }
        stage(last, &mut self.next, true)
    }

    /// When a stage of a step is that its error depends on, by their number, in parts of it: what another stage sees the error does not.
    pub(crate) fn stage_time(&self, number: usize) -> Option<f64> {
        let judged = self.rows.iter().zip(&self.error);
        let mut judged = judged.filter(|(_, weight)| **weight != T::zero());
        judged.nth(number).map(|(row, _)| row.c)
    }

    /// The state at the end of the last attempt.
    pub(crate) fn next(&self) -> &[T] {
        &self.next
    }

    /// The rates at the start of the step, to be changed.
    pub(crate) fn first_mut(&mut self) -> &mut [T] {
        self.stages.get_mut(..self.length).unwrap_or_default()
    }

    /// The rates at the start of the step.
    pub(crate) fn first(&self) -> &[T] {
        self.stages.get(..self.length).unwrap_or(&[])
    }

    /// The rates of all stages, one after the other, and the state at the end of the last attempt.
    pub(crate) fn attempted(&self) -> [&[T]; 2] {
        [&self.stages, &self.next]
    }

    /// The same to be written: an attempt that was made elsewhere.
    pub(crate) fn attempted_mut(&mut self) -> [&mut [T]; 2] {
        self.complete = false;
        [&mut self.stages, &mut self.next]
    }

    /// The rates k₁, k₂ and k₃ of the first stages of the last attempt.
    #[inline]
    fn first_three(&self) -> Option<[&[T]; 3]> {
        let (first, rest) = self.stages.split_at_checked(self.length)?;
        let (second, rest) = rest.split_at_checked(self.length)?;
        Some([first, second, rest.get(..self.length)?])
    }

    /// |k₂ − k₁|², |k₁|² and |k₃ − k₂|² of the first stages of the last attempt, |k|² = Σ weight k².
    pub(crate) fn squares(&self, weights: &[T]) -> [T; 3] {
        match self.first_three() {
            Some([k1, k2, k3]) => [
                weighted_change(weights, k1, k2),
                weighted_size(weights, k1),
                weighted_change(weights, k2, k3),
            ],
            None => [T::zero(); 3],
        }
    }

    /// How many stages a step has.
    pub(crate) fn count(&self) -> usize {
        self.steps
    }

    /// The same where a mask says so.
    pub(crate) fn accept_where(&mut self, mask: T::Mask, state: &mut [T]) {
        for (x, next) in state.iter_mut().zip(&self.next) {
            *x = T::select(mask, *next, *x);
        }
        let (first, rest) = self.stages.split_at_mut(self.length);
        let last = rest.get((self.steps - 2) * self.length..);
        for (x, last) in first.iter_mut().zip(last.unwrap_or_default()) {
            *x = T::select(mask, *last, *x);
        }
    }

    /// Takes the last attempt: its last stage becomes the first of the next step.
    #[inline]
    pub(crate) fn accept(&mut self, state: &mut [T]) {
        state.copy_from_slice(&self.next);
        std::mem::swap(&mut self.lost, &mut self.loses);
        let last = (self.steps - 1) * self.length;
        self.stages.copy_within(last..last + self.length, 0);
    }
}

impl<T: Float> Explicit<T> {
    /// RK4, whose stages inside a step are made at once where a system does that.
    pub(crate) fn rk4(length: usize) -> Self {
        Explicit {
            at_once: true,
            ..Self::new(&RK4, length)
        }
    }

    /// It, keeping what rounding takes where the scalar is so short that it matters.
    pub(crate) fn keeping_digits(mut self) -> Self {
        if T::EPSILON > T::from_f64(SHORT) {
            self.lost = self.nothing.clone();
            self.loses = self.nothing.clone();
        }
        self
    }

    /// What rounding took from the accepted state; empty where it is not kept.
    pub(crate) fn lost(&self) -> &[T] {
        &self.lost
    }

    /// The weights by which rates are added to the state over a step, one after the other.
    pub(crate) fn weights(&self) -> &[T] {
        let last = self.rows.get(self.steps - 1);
        last.map_or(&[], |row| &row.weights)
    }

    /// Goes on with what rounding took from another accepted state, by itself nothing.
    pub(crate) fn set_lost(&mut self, lost: &[T]) {
        self.lost.fill(T::zero());
        for (own, lost) in self.lost.iter_mut().zip(lost) {
            *own = *lost;
        }
    }

    /// The same method over another scalar, with room of its own.
    pub(crate) fn over<S: Real>(&self) -> Explicit<S> {
        let number = |x: &T| S::from_f64(x.to_f64());
        let list = |list: &Vec<T>| list.iter().map(number).collect();
        let room = |list: &Vec<T>| vec![S::zero(); list.len()];
        let rows = self.rows.iter();
        Explicit {
            length: self.length,
            rows: rows
                .map(|row| StageRow {
                    c: row.c,
                    weights: list(&row.weights),
                    sum: row.sum.map(number),
                })
                .collect(),
            steps: self.steps,
            error: list(&self.error),
            dense: self.dense.iter().map(list).collect(),
            exponent: self.exponent,
            stable: self.stable,
            alike: self.alike,
            at_once: false,
            stages: room(&self.stages),
            complete: false,
            trial: room(&self.trial),
            next: room(&self.next),
            lost: room(&self.lost),
            loses: room(&self.loses),
            nothing: room(&self.nothing),
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
        system.enter();
        system.hold(true);
        let made = match self.make_at_once(system, [time, step], state) {
            Made::Whole => Ok(()),
            Made::End => self.make_last_stage(system, [time, step]),
            Made::Inside => {
                let put_back = system.project_end(time + step, &mut self.next);
                put_back.and_then(|()| self.make_last_stage(system, [time, step]))
            }
            Made::Nothing => self.make_stages(system, [time, step], state),
        };
        system.hold(false);
        made
    }

    /// Makes what can be made of a step at once.
    #[inline]
    fn make_at_once(&mut self, system: &mut impl Rates<T>, span: [f64; 2], state: &[T]) -> Made {
        if !self.at_once {
            return Made::Nothing;
        }
        self.complete = false;
        let lists = (&mut self.stages[..], &mut self.next[..]);
        // What is kept of rounding is added before the last stage.
        let made = system.stages_at_once(span, state, lists, self.lost.is_empty());
        if made == Made::Inside
            && !self.lost.is_empty()
            && let Some(row) = self.rows.get(self.steps - 1)
        {
            let h = T::from_f64(span[1]);
            row.sum.add(&self.lost, h, &self.stages, &mut self.next);
            add_keeping(state, &mut self.next, &mut self.loses);
        }
        made
    }

    /// The last stage of a step, whose state is known.
    #[inline]
    fn make_last_stage(
        &mut self,
        system: &mut impl Rates<T>,
        [time, step]: [f64; 2],
    ) -> Result<(), StepError> {
        let last = (self.steps - 1) * self.length;
        let stage = self.stages.get_mut(last..last + self.length);
        system.rates(time + step, step, &self.next, stage.unwrap_or_default())
    }

    /// All stages of a step but the first, one by one.
    fn make_stages(
        &mut self,
        system: &mut impl Rates<T>,
        span: [f64; 2],
        state: &[T],
    ) -> Result<(), StepError> {
        let h = T::from_f64(span[1]);
        self.stages(span, h, state, |last, [time, span], trial, stage| {
            if last {
                system.project_end(time, trial)?;
            }
            system.rates(time, span, trial, stage)
        })
    }

    /// The estimate h Σ (b_i − b̂_i) k_i of the error of the last attempt, and the state at its end.
    pub(crate) fn estimate(&mut self, step: f64) -> (&[T], &[T]) {
        let h = T::from_f64(step);
        combine(&self.nothing, h, &self.error, &self.stages, &mut self.trial);
        (&self.trial, &self.next)
    }

    /// Evaluates the stages of the interpolant of the last attempt, which started at `state`, where it has any of its own and they are missing.
    pub(crate) fn complete(
        &mut self,
        system: &mut impl Rates<T>,
        time: f64,
        step: f64,
        state: &[T],
    ) -> Result<(), StepError> {
        if self.complete {
            return Ok(());
        }
        let h = T::from_f64(step);
        for (i, row) in self.rows.iter().enumerate().skip(self.steps) {
            let (done, rest) = self.stages.split_at_mut(i * self.length);
            row.sum.add(state, h, done, &mut self.trial);
            let span = row.c * step;
            let (stage, _) = rest.split_at_mut(self.length);
            system.rates_inside(time + span, span, &self.trial, stage)?;
        }
        self.complete = true;
        Ok(())
    }

    /// The state at `theta` (0 … 1) of the last attempt, which started at `state`, after [`Explicit::complete`].
    pub(crate) fn interpolate(&self, theta: f64, step: f64, state: &[T], out: &mut [T]) {
        let t = T::from_f64(theta);
        let mut weights = [T::zero(); MOST_TERMS];
        for (weight, powers) in weights.iter_mut().zip(&self.dense) {
            let powers = powers.iter().rev();
            *weight = powers.fold(T::zero(), |sum, power| sum * t + *power) * t;
        }
        combine(state, T::from_f64(step), &weights, &self.stages, out);
    }

    /// Whether the interpolant needs stages that the last attempt has not.
    pub(crate) fn is_incomplete(&self) -> bool {
        !self.complete && self.rows.len() > self.steps
    }

    /// The state at `theta` of the last attempt by the states and rates at its ends alone: the cubic of Hermite, of order four.
    pub(crate) fn interpolate_ends(&self, theta: f64, step: f64, state: &[T], out: &mut [T]) {
        let (t, rest) = (theta, 1.0 - theta);
        let [at_end, rate, rate_at_end] = [
            t * t * (3.0 - 2.0 * t),
            step * t * rest * rest,
            -step * t * t * rest,
        ]
        .map(T::from_f64);
        let last = self.stages.chunks_exact(self.length.max(1));
        let last = last.take(self.steps).next_back().unwrap_or(&[]);
        let ends = state.iter().zip(&self.next);
        let rates = self.first().iter().zip(last);
        for (out, ((a, b), (k, l))) in out.iter_mut().zip(ends.zip(rates)) {
            *out = *a + at_end * (*b - *a) + rate * *k + rate_at_end * *l;
        }
    }

    /// 2 |k₃ − k₂| / |k₂ − k₁|: step times the largest rate of the system, as the stages of RK4 show it; zero where the stages agree to
    /// `negligible` of k₁, and where it is no more than `limit`. |k|² = Σ weight k².
    #[inline]
    pub(crate) fn stiffness(&self, weights: &[T], [negligible, limit]: [f64; 2]) -> f64 {
        let Some([k1, k2, k3]) = self.first_three() else {
            return 0.0;
        };
        // Almost no step is above the limit: only then they are compared with k₁, and a root is taken.
        let below = weighted_change(weights, k1, k2).to_f64();
        let above = weighted_change(weights, k2, k3).to_f64();
        match 4.0 * above > limit * limit * below {
            true => stiffness(self.squares(weights), negligible),
            false => 0.0,
        }
    }

    /// h |f(a) − f(b)| / |a − b| of the two stages of the last attempt that are at the same time; zero where these agree to rounding.
    /// |k|² = Σ weight k². [`Explicit::differences`] is f(b) − f(a) afterwards.
    pub(crate) fn rate(&mut self, weights: &[T]) -> f64 {
        let [one, other] = self.alike;
        let (Some(a), Some(b)) = (self.rows.get(one), self.rows.get(other)) else {
            return 0.0;
        };
        // (b − a)/h.
        let mut apart = [T::zero(); MOST_TERMS];
        for (index, (apart, weight)) in apart.iter_mut().zip(&b.weights).enumerate() {
            *apart = *weight - a.weights.get(index).copied().unwrap_or_default();
        }
        combine(
            &self.nothing,
            T::one(),
            &apart,
            &self.stages,
            &mut self.trial,
        );
        let between = weighted_size(weights, &self.trial);
        let stage = |stage: usize| {
            let first = stage * self.length;
            let own = self.stages.get(first..first + self.length);
            own.unwrap_or_default()
        };
        let apart = weighted_change(weights, stage(one), stage(other));
        let size = weighted_size(weights, stage(one));
        let ends = stage(one).iter().zip(stage(other));
        for (slot, (a, b)) in self.trial.iter_mut().zip(ends) {
            *slot = *b - *a;
        }
        let (apart, size, between) = (apart.to_f64(), size.to_f64(), between.to_f64());
        let rounding = ROUNDING * T::EPSILON.to_f64();
        if between > 0.0 && apart > rounding * rounding * size {
            (apart / between).sqrt()
        } else {
            0.0
        }
    }

    /// What [`Explicit::rate`] left.
    pub(crate) fn differences(&self) -> &[T] {
        &self.trial
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrate::{TSIT5, VERN7};

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

        fn differentiate(
            &mut self,
            _: f64,
            _: &[f64],
            _: &mut [f64],
            _: &mut [f64],
        ) -> Result<(), StepError> {
            Ok(())
        }

        fn project_end(&mut self, _: f64, _: &mut [f64]) -> Result<(), StepError> {
            Ok(())
        }
    }

    /// The largest error at step ends and at seven places inside each step, over 4 s.
    fn errors<const S: usize, const N: usize, const D: usize>(
        tableau: &Tableau<S, N, D>,
        steps: usize,
    ) -> [f64; 2] {
        let h = 4.0 / steps as f64;
        let fine = 64;
        let mut method = Explicit::<f64>::new(tableau, 2);
        let mut exact = Explicit::<f64>::new(&VERN7, 2);
        let (mut x, mut y) = ([2.0, 0.0], [2.0, 0.0]);
        let mut worst = [0.0_f64; 2];
        method.begin(&mut Pendulum, 0.0, 0.0, &x).unwrap();
        exact.begin(&mut Pendulum, 0.0, 0.0, &y).unwrap();
        for i in 0..steps {
            let t = i as f64 * h;
            method.attempt(&mut Pendulum, t, h, &x).unwrap();
            method.complete(&mut Pendulum, t, h, &x).unwrap();
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
                    worst[1] = worst[1].max((inside[0] - y[0]).hypot(inside[1] - y[1]));
                }
            }
            method.accept(&mut x);
            worst[0] = worst[0].max((x[0] - y[0]).hypot(x[1] - y[1]));
        }
        worst
    }

    fn orders<const S: usize, const N: usize, const D: usize>(
        tableau: &Tableau<S, N, D>,
        steps: usize,
    ) -> [f64; 2] {
        let (coarse, fine) = (errors(tableau, steps), errors(tableau, 2 * steps));
        println!("{coarse:?} {fine:?}");
        [0, 1].map(|i| (coarse[i] / fine[i]).log2())
    }

    #[test]
    fn rk4_and_its_cubic_are_of_order_four() {
        let [ends, inside] = orders(&RK4, 40);
        assert!(ends > 3.85 && inside > 3.85, "{ends} {inside}");
    }

    #[test]
    fn tsit5_is_of_order_five_and_its_interpolant_at_least_of_order_four() {
        let [ends, inside] = orders(&TSIT5, 40);
        assert!(ends > 4.85 && inside > 4.0, "{ends} {inside}");
    }

    /// ẋ = x cos t, x = e^(sin t).
    struct Growth;

    impl Rates<f64> for Growth {
        fn rates(
            &mut self,
            time: f64,
            _: f64,
            state: &[f64],
            out: &mut [f64],
        ) -> Result<(), StepError> {
            if let ([x], [dx]) = (state, out) {
                *dx = *x * time.cos();
            }
            Ok(())
        }

        fn differentiate(
            &mut self,
            _: f64,
            _: &[f64],
            _: &mut [f64],
            _: &mut [f64],
        ) -> Result<(), StepError> {
            Ok(())
        }

        fn project_end(&mut self, _: f64, _: &mut [f64]) -> Result<(), StepError> {
            Ok(())
        }
    }

    #[test]
    fn vern7_is_of_order_seven_and_its_interpolant_and_estimate_of_order_six_at_least() {
        let errors = |steps: u32| {
            let h = 3.0 / f64::from(steps);
            let mut method = Explicit::<f64>::new(&VERN7, 1);
            let mut x = [1.0];
            method.begin(&mut Growth, 0.0, 0.0, &x).unwrap();
            let mut worst = [0.0_f64; 3];
            for i in 0..steps {
                let t = f64::from(i) * h;
                method.attempt(&mut Growth, t, h, &x).unwrap();
                method.complete(&mut Growth, t, h, &x).unwrap();
                // From the exact start, so that the error of the interpolant is that of one step.
                let from = t.sin().exp();
                for theta in [0.2, 0.5, 0.8] {
                    let mut inside = [0.0];
                    method.interpolate(theta, h, &x, &mut inside);
                    let exact = (t + theta * h).sin().exp() * x[0] / from;
                    worst[1] = worst[1].max((inside[0] - exact).abs());
                }
                worst[2] = worst[2].max(method.estimate(h).0[0].abs());
                method.accept(&mut x);
                worst[0] = worst[0].max((x[0] - (t + h).sin().exp()).abs());
            }
            worst
        };
        let (coarse, fine) = (errors(12), errors(24));
        let [ends, inside, estimate] = [0, 1, 2].map(|i| (coarse[i] / fine[i]).log2());
        println!("{coarse:?} {fine:?}");
        assert!((ends - 7.0).abs() < 0.15, "{ends}");
        // The errors of one step: a power more.
        assert!(inside > 6.65, "{inside}");
        assert!((estimate - 7.0).abs() < 0.35, "{estimate}");
    }

    #[test]
    fn no_shorter_step_grows_than_the_limit_of_stability() {
        fn look<const S: usize, const N: usize, const D: usize>(tableau: &Tableau<S, N, D>) {
            let steps = (1..1000).map(|part| -0.001 * f64::from(part) * tableau.stable);
            for z in steps {
                assert!(tableau.growth(z).abs() < 1.0, "{z}");
            }
        }
        look(&RK4);
        look(&TSIT5);
        look(&VERN7);
        // 1 + z + z²/2 + z³/6 + z⁴/24 = 1; the others are what is published of them.
        for (found, expected) in [
            (RK4.stable, 2.785),
            (TSIT5.stable, 3.507),
            (VERN7.stable, 4.64),
        ] {
            assert!((found - expected).abs() < 0.001, "{found} {expected}");
        }
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
