//! Motors whose value, rate and acceleration are inputs, and lines whose free length and its rate are: they must tell one motion.
//!
//! ```text
//! |x₁ − x₀ − h (ẋ₀ + ẋ₁)/2| ≤ 0.1 max(|x₁ − x₀|, h |ẋ|, h² |ẍ|)          over a step h; the same for ẋ and ẍ, ẍ         (1)
//! ```
//!
//! A smooth command of which a step sees a sixth of a period or less satisfies (1): the trapezoid is off by h³ x‴/12. With h = 0 it says that neither
//! value nor rate may jump when inputs change. What breaks it would be put right by the projection, without a word: bodies would be carried where the
//! joints allow, and the accelerations would be those of another motion. Of a line it would be in no balance: a winch does the work −T L̇0 with the
//! rate that is told. Nobody tells the acceleration of a line; in (1) it is the difference of the rates over the step. A rate that is wrong
//! by less than a tenth is not seen.

use mbd_scene::{Float, Scene};

use crate::columns::line_name;
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
    /// Room for a scene; `None` where nothing follows inputs.
    pub(crate) fn new(scene: &Scene) -> Option<Self> {
        let count = scene.commanded().count() + scene.commanded_lines().count();
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
        let mut pairs = self.last.iter().zip(&self.now);
        let told = |what, [change, expected]: [f64; 2], name: String| StepError::Command {
            motor: name,
            time,
            what,
            change,
            expected,
        };
        for ((joint, index), (last, now)) in scene.commanded().zip(pairs.by_ref()) {
            let Some((joint, coordinate)) = scene.coordinate(joint, index) else {
                continue;
            };
            for (order, word) in ["value", "rate"].into_iter().enumerate() {
                if let Some(changes) = contradiction::<T>(&last[order..], &now[order..], span) {
                    let name = format!("{}.{}", joint.name, coordinate.name);
                    return Err(told(word, changes, name));
                }
            }
        }
        for (line, (last, now)) in scene.commanded_lines().zip(pairs) {
            let curve = match span > 0.0 {
                true => (now[1] - last[1]) / span,
                false => 0.0,
            };
            let [last, now] = [last, now].map(|numbers| [numbers[0], numbers[1], curve]);
            if let Some(changes) = contradiction::<T>(&last, &now, span) {
                let name = format!("{}.free_length", line_name(scene, line));
                return Err(told("value", changes, name));
            }
        }
        Ok(())
    }
}

/// The change of a number over a step and that which its rate tells, where (1) does not hold. `last` and `now`: the number and its rates.
fn contradiction<T: Float>(last: &[f64], now: &[f64], span: f64) -> Option<[f64; 2]> {
    let ([before, rate_before, ..], [after, rate_after, ..]) = (last, now) else {
        return None;
    };
    let (change, expected) = (after - before, 0.5 * span * (rate_before + rate_after));
    let sizes = last.iter().zip(now).enumerate();
    let sizes = sizes.map(|(k, (last, now))| match k {
        0 => change.abs(),
        k => span.powi(k as i32) * last.abs().max(now.abs()),
    });
    let rounding = 64.0 * T::EPSILON.to_f64() * before.abs().max(after.abs());
    let allowed = match span > 0.0 {
        true => SHARE * sizes.fold(0.0, f64::max),
        false => 0.0,
    };
    ((change - expected).abs() > allowed.max(rounding)).then_some([change, expected])
}
