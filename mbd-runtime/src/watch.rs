//! A fixed step that is too large is silent: the tension clamp turns instability into bounded chatter with worthless forces.
//!
//! The stages of RK4 show step times largest rate, hρ = 2 |k₃ − k₂| / |k₂ − k₁|. Five of the last fifty steps above 2.5 stop the run: the method is
//! stable up to about 2.8.

/// What hρ may not exceed often.
const LIMIT: f64 = 2.5;
/// How many steps are remembered, and how many of them may exceed the limit.
const WINDOW: u32 = 50;
const ALLOWED: u32 = 5;

use serde::{Deserialize, Serialize};

/// The last fifty steps of a fixed-step run, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Watch {
    above: u64,
}

impl Watch {
    /// Records one step; true when the run is unstable.
    pub(crate) fn sees(&mut self, stiffness: f64) -> bool {
        let kept = (1_u64 << WINDOW) - 1;
        self.above = ((self.above << 1) | u64::from(stiffness > LIMIT)) & kept;
        self.above.count_ones() >= ALLOWED
    }
}

/// A step that should be stable, given the hρ seen at `step`: hρ = 2, with the rate taken no smaller than the limit implies.
pub(crate) fn suggestion(step: f64, stiffness: f64) -> f64 {
    step * 2.0 / stiffness.max(LIMIT)
}
