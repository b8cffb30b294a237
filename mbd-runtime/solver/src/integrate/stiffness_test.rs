//! Whether a system is stiff: whether what bounds the steps of an explicit method is its stability and not the error of the steps.
//!
//! Two stages at the same time show step times largest rate, hρ = h |f(a) − f(b)| / |a − b|, in the norm of the energy as the watch of fixed steps
//! has it. A step with hρ above nine tenths of the limit of stability is at the limit; fifteen of twenty are stiffness. A run that takes a stiff
//! method for it goes back once twenty of its steps one after the other would have been stable twice over: hρ from powers of the Jacobian.
//!
//! Source: E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, IV.2, for the two stages.

use mbd_scene::Float;
use serde::{Deserialize, Serialize};

use crate::list::weighted_size;

/// How many steps are remembered, and how many of them at the limit are stiffness.
const WINDOW: u32 = 20;
const STIFF: u32 = 15;
/// Part of the limit of stability from which a step is at the limit, and below which a stiff step would do without its method.
const AT_LIMIT: f64 = 0.9;
const EASY: f64 = 0.5;
/// Powers of the Jacobian, and those of them that are still looking for the fastest direction.
const POWERS: i32 = 12;
const BLIND: i32 = 4;

/// The last twenty steps of an adaptive run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct StiffnessTest {
    /// Those at the limit, one bit each.
    above: u32,
    /// Steps of a stiff method that would have been stable without it, one after the other.
    easy: u32,
}

impl StiffnessTest {
    /// Records a step of an explicit method with hρ over its limit; true when the system is stiff.
    pub(crate) fn sees(&mut self, part: f64) -> bool {
        let kept = (1 << WINDOW) - 1;
        self.above = ((self.above << 1) | u32::from(part > AT_LIMIT)) & kept;
        self.is_stiff()
    }

    /// Whether the steps so far are those of a stiff system.
    pub(crate) fn is_stiff(self) -> bool {
        self.above.count_ones() >= STIFF
    }

    /// Records a step of a stiff method with hρ over the limit of the explicit one; true when it is not needed any more.
    pub(crate) fn eases(&mut self, part: f64) -> bool {
        self.easy = if part < EASY {
            self.easy.saturating_add(1)
        } else {
            0
        };
        self.easy >= WINDOW
    }
}

/// The largest rate of a linear system ẋ = A x, by powers of A; `x` and `y` are room for a state. |x|² = Σ weight x².
pub(crate) fn fastest<T: Float>(matrix: &[T], weights: &[T], x: &mut [T], y: &mut [T]) -> f64 {
    let length = x.len();
    let size = |x: &[T]| weighted_size(weights, x).to_f64().sqrt();
    x.fill(T::zero());
    for (index, (x, weight)) in x.iter_mut().zip(weights).enumerate() {
        // No direction is left out.
        let own = T::from_f64(1.0 + 0.3 * (index as f64).sin());
        if *weight > T::zero() {
            *x = own / weight.sqrt();
        }
    }
    let mut logarithm = 0.0;
    for power in 0..POWERS {
        let before = size(x);
        if before == 0.0 || !before.is_finite() {
            return 0.0;
        }
        x.iter_mut().for_each(|x| *x /= T::from_f64(before));
        for (y, row) in y.iter_mut().zip(matrix.chunks_exact(length.max(1))) {
            *y = row
                .iter()
                .zip(&*x)
                .fold(T::zero(), |sum, (a, x)| sum + *a * *x);
        }
        x.copy_from_slice(y);
        if power >= BLIND {
            logarithm += size(x).ln();
        }
    }
    (logarithm / f64::from(POWERS - BLIND)).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fifteen_of_twenty_steps_at_the_limit_are_stiffness() {
        let mut seen = StiffnessTest::default();
        let verdicts: Vec<bool> = (0..20)
            .map(|k| seen.sees(if k % 4 == 0 { 0.1 } else { 1.0 }))
            .collect();
        assert_eq!(verdicts.iter().position(|stiff| *stiff), Some(19));
        assert!((0..5).all(|_| seen.sees(1.0)));
        assert!((0..9).filter(|_| seen.sees(0.1)).count() < 9);
        assert!((0..19).all(|_| !seen.eases(0.1)) && !seen.eases(0.9));
        assert!((0..19).all(|_| !seen.eases(0.1)) && seen.eases(0.1));
    }

    #[test]
    fn the_largest_rate_is_the_largest_eigenvalue() {
        // A damped oscillator, ω = 3 and 300 rad/s, and a decay of 20 1/s.
        let a = [
            0.0, 0.0, 1.0, 0.0, 0.0, //
            0.0, 0.0, 0.0, 1.0, 0.0, //
            -9.0, 0.0, -0.1, 0.0, 0.0, //
            0.0, -9e4, 0.0, -3.0, 0.0, //
            0.0, 0.0, 0.0, 0.0, -20.0,
        ];
        let weights = [9e4, 9e4, 1.0, 1.0, 1.0];
        let (mut x, mut y) = ([0.0; 5], [0.0; 5]);
        let found = fastest(&a, &weights, &mut x, &mut y);
        assert!((found - 300.0).abs() < 15.0, "{found}");
    }
}
