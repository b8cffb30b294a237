//! Events of a declaration: the instants that a run locates, and what they do.

use serde::{Deserialize, Serialize};

use crate::Formula;

/// An instant the runtime locates.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// Name.
    pub name: String,
    /// Documentation.
    pub doc: String,
    /// A scalar that passes zero at the event.
    pub guard: Formula,
    /// The direction that counts.
    pub direction: Direction,
    /// What it does besides being told.
    #[serde(default)]
    pub actions: Actions,
}

/// Which zero passages of a guard count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Direction {
    /// Both.
    Crosses,
    /// From negative to positive.
    Rises,
    /// From positive to negative.
    Falls,
}

/// What an event does at its instant, all of it together.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Actions {
    /// Numbers that get other values, each at most once.
    pub set: Vec<Setting>,
    /// What holds and carries nothing from here on.
    pub detach: Vec<Detachable>,
    /// What holds and carries again.
    pub attach: Vec<Detachable>,
    /// Whether the run ends here, and may go on.
    pub stop: bool,
    /// Whether it acts the first time only.
    pub once: bool,
}

impl Actions {
    /// Whether the event is only told.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        !self.stop && !self.changes()
    }

    /// Whether it changes what is run.
    #[must_use]
    pub fn changes(&self) -> bool {
        !(self.set.is_empty() && self.detach.is_empty() && self.attach.is_empty())
    }
}

/// What an event can detach and attach.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Detachable {
    /// A line or a spring, by index.
    Line(usize),
    /// A joint, by index: all its rows, and what acts along its coordinates.
    Joint(usize),
}

/// A number that gets another value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Setting {
    /// Which.
    pub what: Settable,
    /// Its new value [SI], from what was just before the instant: what a load may read.
    pub value: Formula,
}

/// What an event can set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Settable {
    /// A param, by index.
    Param(usize),
    /// A declared state, by index.
    State(usize),
}
