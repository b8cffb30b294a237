//! Motors whose value, rate and acceleration are inputs: the three must tell one motion.
//!
//! ```text
//! |x₁ − x₀ − h (ẋ₀ + ẋ₁)/2| ≤ 0.1 max(|x₁ − x₀|, h |ẋ|, h² |ẍ|)          over a step h; the same for ẋ and ẍ, ẍ         (1)
//! ```
//!
//! A smooth command of which a step sees a sixth of a period or less satisfies (1): the trapezoid is off by h³ x‴/12. With h = 0 it says that neither
//! value nor rate may jump when inputs change. What breaks it would be put right by the projection, without a word: bodies would be carried where the
//! joints allow, and the accelerations would be those of another motion.

use mbd_scene::{Float, Scene};

use crate::error::StepError;

/// How far the two sides of (1) may differ [1].
const SHARE: f64 = 0.1;

/// What motors were commanded at the last accepted step, and room for the next.
#[derive(Clone, Debug)]
pub(crate) struct Commands {
    pub last: Vec<[f64; 3]>,
    pub now: Vec<[f64; 3]>,
}

impl Commands {
    /// Room for a scene; `None` where no motor follows inputs.
    pub(crate) fn new(scene: &Scene) -> Option<Self> {
        let count = scene.commanded().count();
        (count > 0).then(|| Commands {
            last: Vec::with_capacity(count),
            now: Vec::with_capacity(count),
        })
    }

    /// Whether what is commanded now goes on from the last step, `span` before [s], by (1).
    pub(crate) fn check<T: Float>(
        &self,
        scene: &Scene,
        (time, span): (f64, f64),
    ) -> Result<(), StepError> {
        for ((joint, index), (last, now)) in scene.commanded().zip(self.last.iter().zip(&self.now))
        {
            for (order, word) in ["value", "rate"].into_iter().enumerate() {
                let (before, after) = (last[order], now[order]);
                let slope = 0.5 * (last[order + 1] + now[order + 1]);
                let size = (0..3 - order).map(|k| {
                    let largest = last[order + k].abs().max(now[order + k].abs());
                    match k {
                        0 => (after - before).abs(),
                        k => span.powi(k as i32) * largest,
                    }
                });
                let rounding = 64.0 * T::EPSILON.to_f64() * before.abs().max(after.abs());
                let allowed = match span > 0.0 {
                    true => SHARE * size.fold(0.0, f64::max),
                    false => 0.0,
                };
                if (after - before - span * slope).abs() > allowed.max(rounding) {
                    let (joint, coordinate) = match scene.coordinate(joint, index) {
                        Some(found) => found,
                        None => continue,
                    };
                    return Err(StepError::Command {
                        motor: format!("{}.{}", joint.name, coordinate.name),
                        time,
                        what: word,
                        change: after - before,
                        expected: span * slope,
                    });
                }
            }
        }
        Ok(())
    }
}
