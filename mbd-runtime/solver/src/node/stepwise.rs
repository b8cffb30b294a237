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
    let before = history.before.unwrap_or((T::zero(), T::zero()));
    law(numbers, formula, clamp, tau, (history.last, before))
}

/// The same over any scalar: s_n, s_{n−1}, and h_prev [s], which is zero after a start or a change between slack and taut.
pub(crate) fn law<T: Real>(
    numbers: &LineNumbers<T>,
    formula: Difference,
    clamp: Clamp,
    tau: T,
    (last, (before, step)): (T, (T, T)),
) -> [T; 2] {
    let (zero, one) = (T::zero(), T::one());
    let stretch = |s: T| match clamp {
        Clamp::Positive => s.max(zero),
        Clamp::Literal => s,
    };
    let rate = numbers.damping / tau;
    let (weight, memory) = match formula {
        Difference::Bdf2 => {
            let known = zero.lt(step);
            let theta = tau / T::select(known, step, one);
            let sum = one + theta;
            let memory = sum * stretch(last) - theta * theta / sum * stretch(before);
            let weight = (one + theta + theta) / sum;
            (
                T::select(known, weight, one),
                T::select(known, memory, stretch(last)),
            )
        }
        Difference::Euler => (one, stretch(last)),
    };
    let stiffness = numbers.stiffness + weight * rate;
    let shift = rate * memory / stiffness;
    let free_length = match clamp {
        Clamp::Positive => numbers.free_length + shift.max(zero),
        Clamp::Literal => (numbers.free_length + shift).max(zero),
    };
    [stiffness, free_length]
}
