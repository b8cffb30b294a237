//! Rattle: symmetric, symplectic steps of order 4 in the coordinates of bodies and points, for long runs.
//!
//! ```text
//! u  = v₀ + ½ h (K(q₀) + M⁻¹ Φ_vᵀ(q₀) λ),   (q₁, w) = free motion of (q₀, u) for h,   Φ(q₁, t₁) = 0                        (1)
//! v₁ = w + ½ h (K(q₁) + M⁻¹ Φ_vᵀ(q₁) μ),    Φ_v(q₁) v₁ + Φ_t(q₁, t₁) = 0                                                   (2)
//! ```
//!
//! is of order 2; five of these with h p, h p, h (1 − 4p), h p, h p, p = 1/(4 − 4^⅓), make a step of order 4 [Suzuki 1990]. K = M⁻¹ (forces), without
//! what free rotation does by itself: that is in the free motion (`free_motion`). Whatever a solve of the accelerations adds to K along
//! M⁻¹ Φ_vᵀ is absorbed in λ and μ. Source: Andersen 1983; `E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration`, II.4, VII.1.4, VII.5.5.
//!
//! Where forces depend on speeds, inputs on the state, or a declared state has a rate of its own, the half step of (1) takes K(q₀, v₀) and that of (2)
//! K(q₁, v₁), found by iteration: each is the other one backwards, so that a step stays symmetric and of order 4. Where nothing depends on speeds
//! K is evaluated at rest, where a body without torque has none to the last bit.
//!
//! Inside a step the cubic through both ends and their rates is of order 4, as that of RK4. The estimate is what Simpson's rule leaves of a step,
//! x₁ − x₀ − h/6 (k₀ + 4 k_½ + k₁), with the rate of the cubic's middle: O(h⁵), evaluated only where somebody asks.

use std::ops::Range;

use mbd_scene::Float;

use super::Rates;
use crate::error::StepError;
use crate::list::{weighted_change, weighted_size};
use crate::watch::Instability;

/// 1/(4 − 4^⅓).
const PART: f64 = 0.414_490_771_794_375_7;
/// The parts of a step, and the times at which they end.
const PARTS: [(f64, f64); 5] = [
    (PART, PART),
    (PART, 2.0 * PART),
    (1.0 - 4.0 * PART, 1.0 - 2.0 * PART),
    (PART, 1.0 - PART),
    (PART, 1.0),
];
/// Most iterations for speeds that forces depend on.
const ITERATIONS: u32 = 60;
/// Rounding units within which these speeds are found.
const FOUND: f64 = 8.0;
/// The change of these speeds below which iterations that gain nothing have come down to rounding.
const ROUNDED: f64 = 1e-10;
/// The most that these iterations may leave of the change before, and how many of them one after the other may leave more.
const CONTRACTION: f64 = 0.7;
const PATIENCE: u32 = 3;

/// What the steps of [`Rattle`] ask of a system beside its rates.
pub(crate) trait Reversible<T>: Rates<T> {
    /// Whether the rates of speeds depend on positions and time alone.
    fn is_conservative(&self) -> bool;

    /// Moves a state freely for `span` seconds, from `times[0]` to `times[1]`, into `moved`; the speeds of `state` are changed along the normals of the
    /// joints where it is so that the joints hold in the end, the λ of (1).
    fn move_freely(
        &mut self,
        times: [f64; 2],
        span: f64,
        state: &mut [T],
        moved: &mut [T],
    ) -> Result<(), StepError>;

    /// Takes what free rotation does by itself out of rates.
    fn without_turning(&self, state: &[T], rates: &mut [T]);

    /// Changes speeds along the normals of the joints so that these go on holding, the μ of (2).
    fn hold_speeds(&mut self, time: f64, state: &mut [T]) -> Result<(), StepError>;
}

/// A step of order 2 inside one of order 4.
#[derive(Clone, Copy, Debug)]
struct Substep {
    /// When it starts and ends [s].
    times: [f64; 2],
    /// How long it is; negative in the middle one [s].
    span: f64,
    /// Its end after the start of the whole step, and the whole step [s].
    since: f64,
    step: f64,
}

/// The method with its storage.
#[derive(Clone, Debug)]
pub(crate) struct Rattle<T> {
    /// The order plus one.
    pub exponent: f64,
    /// Where the speeds are in the state; before them are positions, behind them declared states, and integrals that nothing depends on.
    speeds: Range<usize>,
    integrals: usize,
    /// Whether K is evaluated at rest.
    at_rest: bool,
    /// Whether somebody asks for the error of steps.
    asked: bool,
    /// The rates at the start of a step, and at its end.
    first: Vec<T>,
    last: Vec<T>,
    /// K and the rates of what is behind the speeds at the start of a step, and where it has come to.
    begun: Vec<T>,
    force: Vec<T>,
    now: Vec<T>,
    trial: Vec<T>,
    next: Vec<T>,
    error: Vec<T>,
    /// K at the start of the last part of a step, and the speeds with which that part moved.
    pushed: Vec<T>,
    slid: Vec<T>,
    /// The step that was tried last [s].
    step: f64,
}

impl<T: Float> Rattle<T> {
    /// Storage for states of a given length with these speeds, of whose last nothing depends on `behind`; whether somebody will ask for the error of
    /// steps.
    pub(crate) fn new(length: usize, speeds: Range<usize>, behind: usize, asked: bool) -> Self {
        let room = || vec![T::zero(); length];
        Rattle {
            exponent: 5.0,
            speeds,
            integrals: length - behind,
            at_rest: false,
            asked,
            first: room(),
            last: room(),
            begun: room(),
            force: room(),
            now: room(),
            trial: room(),
            next: room(),
            error: room(),
            pushed: room(),
            slid: room(),
            step: 0.0,
        }
    }

    /// The rates at the start of a step, `span` after the last accepted one. Needed once, and again after anything jumped.
    pub(crate) fn begin(
        &mut self,
        system: &mut impl Reversible<T>,
        time: f64,
        span: f64,
        state: &[T],
    ) -> Result<(), StepError> {
        self.at_rest = system.is_conservative();
        self.now.copy_from_slice(state);
        if self.at_rest {
            self.push_at_rest(system, time, span)?;
        }
        system.rates(time, span, state, &mut self.first)?;
        if !self.at_rest {
            self.force.copy_from_slice(&self.first);
            self.leave_forces(system);
        }
        self.begun.copy_from_slice(&self.force);
        Ok(())
    }

    /// Tries a step from `state`; the result is [`Rattle::next`], and `state` is untouched.
    pub(crate) fn attempt(
        &mut self,
        system: &mut impl Reversible<T>,
        time: f64,
        step: f64,
        state: &[T],
    ) -> Result<(), StepError> {
        system.enter();
        self.now.copy_from_slice(state);
        self.force.copy_from_slice(&self.begun);
        let mut start = 0.0;
        for (part, end) in PARTS {
            let times = [time + start * step, time + end * step];
            let part = Substep {
                times,
                span: part * step,
                since: end * step,
                step,
            };
            self.make_part(system, part)?;
            start = end;
        }
        self.next.copy_from_slice(&self.now);
        system.rates(time + step, step, &self.next, &mut self.last)?;
        if !self.at_rest {
            self.force.copy_from_slice(&self.last);
            self.leave_forces(system);
        }
        if self.asked {
            self.find_error(system, time, step, state)?;
        }
        Ok(())
    }

    fn make_part(
        &mut self,
        system: &mut impl Reversible<T>,
        part: Substep,
    ) -> Result<(), StepError> {
        let [_, end] = part.times;
        let half = T::from_f64(0.5 * part.span);
        add(half, &self.force, &mut self.now);
        system.move_freely(part.times, part.span, &mut self.now, &mut self.trial)?;
        let is_last = part.since == part.step;
        if is_last {
            self.step = part.step;
            self.pushed.copy_from_slice(&self.force);
            self.slid.copy_from_slice(&self.now);
        }
        self.now.copy_from_slice(&self.trial);
        if is_last {
            system.project_end(end, &mut self.now)?;
        }
        if !self.at_rest {
            return self.push_with_speeds(system, part);
        }
        self.push_at_rest(system, end, part.since)?;
        add(half, &self.force, &mut self.now);
        system.hold_speeds(end, &mut self.now)
    }

    /// K at the state of now, as if it stood still.
    fn push_at_rest(
        &mut self,
        system: &mut impl Reversible<T>,
        time: f64,
        since: f64,
    ) -> Result<(), StepError> {
        self.trial.copy_from_slice(&self.now);
        self.trial[self.speeds.clone()].fill(T::zero());
        system.rates(time, since, &self.trial, &mut self.force)?;
        self.force[..self.speeds.start].fill(T::zero());
        Ok(())
    }

    /// What is left of rates at the state of now for K.
    fn leave_forces(&mut self, system: &impl Reversible<T>) {
        system.without_turning(&self.now, &mut self.force);
        self.force[..self.speeds.start].fill(T::zero());
    }

    /// The half step of (2) with K at the speeds that it leads to.
    fn push_with_speeds(
        &mut self,
        system: &mut impl Reversible<T>,
        part: Substep,
    ) -> Result<(), StepError> {
        let [_, time] = part.times;
        let half = T::from_f64(0.5 * part.span);
        // `trial` stays where the half step begins; `next` is free until the end of the step.
        self.trial.copy_from_slice(&self.now);
        let (mut before, mut kept, mut slow) = (f64::INFINITY, 0.0, 0);
        for _ in 0..ITERATIONS {
            system.rates(time, part.since, &self.now, &mut self.force)?;
            self.leave_forces(system);
            self.next.copy_from_slice(&self.trial);
            add(half, &self.force, &mut self.next);
            system.hold_speeds(time, &mut self.next)?;
            let (change, moved) = self.change(half);
            self.now.copy_from_slice(&self.next);
            let settled = change <= FOUND * T::EPSILON.to_f64();
            if settled || change <= ROUNDED && change > 0.5 * before {
                return Ok(());
            }
            kept = change / before;
            // The first changes may be those of numbers that were zero.
            slow = if kept > CONTRACTION { slow + 1 } else { 0 };
            if slow == PATIENCE {
                match self.is_rounding(system, (time, part.since), half, moved)? {
                    true => return Ok(()),
                    false => break,
                }
            }
            before = change;
        }
        // An iteration leaves ½ |span| times the rate of the change before it.
        let what = Instability::Stages(2.0 * kept * (part.step / part.span).abs());
        Err(StepError::UnstableStep {
            time,
            step_size: part.step,
            what,
            suggestion: what.suggestion(part.step),
        })
    }

    /// Whether speeds that change by so much from one iteration to the next do so because positions are rounded: at rest forces cancel, and what rounding leaves
    /// of them is much beside the speeds.
    #[cold]
    fn is_rounding(
        &self,
        system: &mut impl Reversible<T>,
        (time, since): (f64, f64),
        half: T,
        moved: f64,
    ) -> Result<bool, StepError> {
        let apart = T::one() + T::from_f64(FOUND) * T::EPSILON;
        let mut beside = self.now.clone();
        for position in beside.iter_mut().take(self.speeds.start) {
            *position *= apart;
        }
        let (mut force, mut own) = (self.force.clone(), self.force.clone());
        system.rates(time, since, &beside, &mut force)?;
        system.without_turning(&beside, &mut force);
        // The system stays at the state of now.
        system.rates(time, since, &self.now, &mut own)?;
        system.without_turning(&self.now, &mut own);
        let speeds = self.speeds.clone();
        let forces = force[speeds.clone()].iter().zip(&own[speeds]);
        let rounding = forces.map(|(a, b)| (half * (*a - *b)).abs().to_f64());
        Ok(moved <= rounding.fold(0.0, f64::max))
    }

    /// How far `next` is from now: speeds over the largest of them, a declared state over itself and what a half step changes of it; and by how much the speeds
    /// are.
    fn change(&self, half: T) -> (f64, f64) {
        let (mut moved, mut fastest, mut most) = (0.0_f64, 0.0_f64, 0.0_f64);
        let numbers = self.now.iter().zip(&self.next).zip(&self.force);
        let numbers = numbers.take(self.integrals);
        for (index, ((now, next), force)) in numbers.enumerate().skip(self.speeds.start) {
            let change = (*next - *now).abs().to_f64();
            let size = next.abs().to_f64() + (half * *force).abs().to_f64();
            if !change.is_finite() {
                return (f64::INFINITY, f64::INFINITY);
            }
            if self.speeds.contains(&index) {
                (moved, fastest) = (moved.max(change), fastest.max(size));
            } else if change > 0.0 {
                most = most.max(change / size);
            }
        }
        if moved > 0.0 {
            most = most.max(moved / fastest);
        }
        (most, moved)
    }

    /// The estimate of the error of the attempt.
    fn find_error(
        &mut self,
        system: &mut impl Reversible<T>,
        time: f64,
        step: f64,
        state: &[T],
    ) -> Result<(), StepError> {
        let mut middle = std::mem::take(&mut self.trial);
        self.interpolate(0.5, step, state, &mut middle);
        let since = 0.5 * step;
        let found = system.rates_inside(time + since, since, &middle, &mut self.error);
        self.trial = middle;
        found?;
        let (four, sixth) = (T::from_f64(4.0), T::from_f64(step / 6.0));
        for (index, error) in self.error.iter_mut().enumerate() {
            let rates = self.first[index] + four * *error + self.last[index];
            *error = self.next[index] - state[index] - sixth * rates;
        }
        Ok(())
    }

    /// The state at the end of the last attempt.
    pub(crate) fn next(&self) -> &[T] {
        &self.next
    }

    /// Takes the last attempt.
    pub(crate) fn accept(&mut self, state: &mut [T]) {
        state.copy_from_slice(&self.next);
        std::mem::swap(&mut self.first, &mut self.last);
        std::mem::swap(&mut self.begun, &mut self.force);
    }

    /// The estimate of the error of the last attempt, zero where nobody asked for it, and the state at its end.
    pub(crate) fn estimate(&self) -> (&[T], &[T]) {
        (&self.error, &self.next)
    }

    /// The state at `theta` (0 … 1) of the last attempt, which started at `state`, by the cubic.
    pub(crate) fn interpolate(&self, theta: f64, step: f64, state: &[T], out: &mut [T]) {
        let left = 1.0 - theta;
        let toward = T::from_f64(theta * theta * (1.0 + 2.0 * left));
        let [start, end] =
            [theta * left * left, -theta * theta * left].map(|part| T::from_f64(step * part));
        let rates = self.first.iter().zip(&self.last);
        let ends = state.iter().zip(&self.next).zip(rates);
        for (out, ((from, to), (first, last))) in out.iter_mut().zip(ends) {
            *out = *from + toward * (*to - *from) + start * *first + end * *last;
        }
    }

    /// h √(|ΔK| / |Δx|) over the last part of the last attempt: step times the largest rate of the system, as forces change along the motion; zero where
    /// they change by less than `negligible` of themselves. |k|² = Σ weight k² over the speeds.
    pub(crate) fn stiffness(&self, weights: &[T], negligible: f64) -> f64 {
        let lists: [&[T]; 4] = [weights, &self.pushed, &self.force, &self.slid];
        let [weights, before, after, moved] =
            lists.map(|list| list.get(self.speeds.clone()).unwrap_or_default());
        let changed = weighted_change(weights, before, after);
        let [size, moved] = [before, moved].map(|list| weighted_size(weights, list));
        let (changed, size, moved) = (changed.to_f64(), size.to_f64(), moved.to_f64());
        if moved > 0.0 && changed > negligible * negligible * size {
            (self.step * (changed / moved).sqrt() / PART).sqrt()
        } else {
            0.0
        }
    }

    /// The rates at the start of the step, to be changed.
    pub(crate) fn first_mut(&mut self) -> &mut [T] {
        &mut self.first
    }

    /// The rates at the start of the step.
    pub(crate) fn first(&self) -> &[T] {
        &self.first
    }
}

/// state += time × rates.
fn add<T: Float>(time: T, rates: &[T], state: &mut [T]) {
    for (sum, rate) in state.iter_mut().zip(rates) {
        *sum += time * *rate;
    }
}
