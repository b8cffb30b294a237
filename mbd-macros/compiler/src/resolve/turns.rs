//! Turns and radians: `Hz` is 1/s, and 2π is missing where an angle or its rate is meant.

use mbd_scene::{Scene, Unit};

use super::{Resolver, Typed, fold};
use crate::messages::resolve as say;

impl Typed {
    /// Whether a product with it makes radians of turns: an angle, or a whole multiple of π.
    pub fn makes_radians(&self, scene: &Scene) -> bool {
        let known = fold::known(&self.formula, scene, false).and_then(|known| known.scalar());
        let half_turns = known.map_or(0.0, |number| number / std::f64::consts::PI);
        let whole = (half_turns - half_turns.round()).abs() < 1e-9 * half_turns.abs();
        self.angle != 0 || half_turns != 0.0 && whole
    }
}

impl Resolver<'_> {
    /// Refuses turns where an angle in radians, or its rate, is meant: `2 Hz` would be 2 rad/s without a word.
    pub fn in_radians(&mut self, typed: &Typed, what: &str) -> Option<()> {
        match typed.turns {
            true => self.fail(say::turns_for_radians(typed.at, what)),
            false => Some(()),
        }
    }
}

/// Whether a unit counts turns: `Hz`, `m*Hz`.
pub fn counts_turns(unit: &Unit) -> bool {
    let mut words = unit.text.split(|c: char| !c.is_ascii_alphabetic());
    words.any(|word| word == "Hz")
}
