//! The damped line of a stepwise node as one elastic law T = K_e (d − L_e)₊.
//!
//! ```text
//! Euler                          K_e = K + C/τ              L_e = L0 + (C/τ) s⁺_n / K_e
//! BDF2, θ = τ/h_prev             K_e = K + w0 C/τ           L_e = L0 + max(0, (C/τ) m / K_e)
//!     w0 = (1 + 2θ)/(1 + θ),     m = (1 + θ) s⁺_n − θ²/(1 + θ) s⁺_{n−1}
//! ```
//!
//! τ = c h is the time since the last accepted step. With the literal clamp of AAS 03-163 the signed stretch s stands for s⁺: then a slack
//! line can pull; it is there for comparison only.

use mbd_scene::laws::LineNumbers;
use mbd_scene::{Clamp, Difference, Float, Real};

/// The stretches of one line at the last two accepted steps.
#[derive(Clone, Copy, Debug)]
pub struct History<T> {
    /// s_n, either sign [m].
    pub last: T,
    /// s_{n−1}, either sign [m], and h_prev [s]; `None` after a start or a change between slack and taut.
    pub before: Option<(T, T)>,
}

/// K_e [N/m] and L_e [m] at τ > 0 after the last accepted step.
#[must_use]
pub fn effective<T: Float>(
    numbers: &LineNumbers<T>,
    formula: Difference,
    clamp: Clamp,
    tau: T,
    history: History<T>,
) -> [T; 2] {
    let (before, step) = history.before.unwrap_or((T::zero(), T::zero()));
    RateFormula::new((formula, clamp), tau, step).law(numbers, [history.last, before])
}

/// The rate of a stretch at τ after the last accepted step, (w s − m)/τ with m = a s⁺_n − b s⁺_{n−1}: its weights are those of every line of a network.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RateFormula<T> {
    clamp: Clamp,
    tau: T,
    /// w, a and b.
    now: T,
    last: T,
    before: T,
}

impl<T: Real> RateFormula<T> {
    /// The weights where the step before had the size h_prev [s]; zero after a start or a change between slack and taut.
    #[inline]
    pub(crate) fn new((formula, clamp): (Difference, Clamp), tau: T, step: T) -> Self {
        let (zero, one) = (T::zero(), T::one());
        let [now, last, before] = match formula {
            Difference::Bdf2 => {
                let known = zero.lt(step);
                let theta = tau / T::select(known, step, one);
                let sum = one + theta;
                let weights = [
                    ((one + theta + theta) / sum, one),
                    (sum, one),
                    (theta * theta / sum, zero),
                ];
                weights.map(|(weight, without)| T::select(known, weight, without))
            }
            Difference::Euler => [one, one, zero],
        };
        RateFormula {
            clamp,
            tau,
            now,
            last,
            before,
        }
    }

    /// K_e [N/m] and L_e [m] of a line with the stretches s_n and s_{n−1}, either sign [m].
    #[inline]
    pub(crate) fn law(&self, numbers: &LineNumbers<T>, [last, before]: [T; 2]) -> [T; 2] {
        let zero = T::zero();
        let stretch = |s: T| match self.clamp {
            Clamp::Positive => s.max(zero),
            Clamp::Literal => s,
        };
        let rate = numbers.damping / self.tau;
        let memory = self.last * stretch(last) - self.before * stretch(before);
        let stiffness = numbers.stiffness + self.now * rate;
        let shift = rate * memory / stiffness;
        let free_length = match self.clamp {
            Clamp::Positive => numbers.free_length + shift.max(zero),
            Clamp::Literal => (numbers.free_length + shift).max(zero),
        };
        [stiffness, free_length]
    }
}
