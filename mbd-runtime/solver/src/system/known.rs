//! What was evaluated elsewhere at the end of a step that is tried: guards and energy.

use mbd_scene::{Float, Layout, Quantity};

/// Guards and energy at the end of a step, as long as that is neither taken nor tried anew.
#[derive(Clone, Debug)]
pub(crate) struct KnownAtEnd<T> {
    /// When [s]; not a number where nothing is known.
    time: f64,
    guards: Vec<T>,
    has_guards: bool,
    energy: Option<[T; 6]>,
}

impl<T: Float> KnownAtEnd<T> {
    /// Nothing is known.
    pub(crate) fn new(layout: &Layout) -> Self {
        KnownAtEnd {
            time: f64::NAN,
            guards: vec![T::zero(); layout.len(Quantity::Guards)],
            has_guards: false,
            energy: None,
        }
    }

    /// Knows what was evaluated at a time [s]; `fill` writes the guards, or says that they are not known.
    pub(crate) fn learn(
        &mut self,
        time: f64,
        energy: Option<[T; 6]>,
        fill: impl FnOnce(&mut [T]) -> bool,
    ) {
        (self.time, self.energy) = (time, energy);
        self.has_guards = fill(&mut self.guards);
    }

    /// The end of another step comes next.
    pub(crate) fn forget(&mut self) {
        self.time = f64::NAN;
    }

    /// A quantity at a time, if it is the guards and they are known.
    pub(crate) fn guards(&self, what: Quantity, time: f64) -> Option<&[T]> {
        let known = what == Quantity::Guards && self.has_guards && self.time == time;
        known.then_some(&*self.guards)
    }

    /// Energy and powers at a time, if they are known.
    pub(crate) fn energy(&self, time: f64) -> Option<[T; 6]> {
        self.energy.filter(|_| self.time == time)
    }
}
