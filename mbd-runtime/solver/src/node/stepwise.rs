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
use nalgebra::Vector3;

use super::warm::carried;

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
    /// b h_prev/τ.
    earlier: T,
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
            earlier: before * step / tau,
        }
    }

    /// The velocity of a node by the same formula [m/s]: that of its anchors on the average, and against them w a_n − b (h_prev/τ) a_{n−1}, with how fast it moved
    /// against them since the last accepted step and in the step before; zero where that is not known: after a start, a switch or in a slack network.
    #[inline]
    pub(crate) fn velocity(
        &self,
        anchors: impl ExactSizeIterator<Item = Vector3<T>>,
        [now, before]: [Vector3<T>; 2],
    ) -> Vector3<T> {
        let (zero, one) = (T::zero(), T::one());
        let known = zero.lt(before.x.abs() + before.y.abs() + before.z.abs());
        let weight = T::select(known, self.now, one);
        let own = now.zip_map(&before, |now, before| weight * now - self.earlier * before);
        carried(own, anchors)
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
