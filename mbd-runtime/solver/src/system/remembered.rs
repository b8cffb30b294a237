//! What a run remembers of its mechanism beside time, state and inputs.

use mbd_scene::Float;

use super::System;
use crate::unilateral::Mode;

/// Turns of angles, what is detached, and where locks hold coordinates.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Remembered {
    /// The angles of [`Layout::turns`](mbd_scene::Layout::turns) [rad].
    turns: Vec<f64>,
    /// Whether each element of [`At::hold`](mbd_scene::At::hold) is detached.
    detached: Vec<bool>,
    /// What each lock holds its coordinate at [m or rad].
    held: Vec<f64>,
}

impl<T: Float> System<T> {
    /// What is remembered now.
    pub(crate) fn remembered(&self) -> Remembered {
        let wide = |list: &[T]| list.iter().map(|x| x.to_f64()).collect();
        let memory = &self.memory;
        Remembered {
            turns: wide(&memory.turns),
            detached: memory
                .modes
                .iter()
                .map(|mode| *mode == Mode::Detached)
                .collect(),
            held: wide(&memory.held),
        }
    }

    /// Goes on from what another run of the same scene remembers.
    pub(crate) fn recall(&mut self, remembered: &Remembered) {
        for (mode, detached) in self.memory.modes.iter_mut().zip(&remembered.detached) {
            *mode = match detached {
                true => Mode::Detached,
                false => Mode::Free,
            };
        }
        for (held, number) in self.memory.held.iter_mut().zip(&remembered.held) {
            *held = T::from_f64(*number);
        }
        self.count_turns_from(remembered.turns.iter().copied());
        self.nodes.hold_modes(&self.memory);
        self.probe.hold_modes(&self.memory);
    }
}
