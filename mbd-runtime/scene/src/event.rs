//! Events of a declaration: the instants that a run locates, and what they do.

use serde::{Deserialize, Serialize};

use crate::{Dimension, Formula, Place};

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
    /// The scene that goes on from here, where the run ends for that.
    #[serde(default)]
    pub next: Option<Next>,
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

/// A scene that goes on where an event ends a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Next {
    /// Its file as it is named, relative to the folder of the scene that names it.
    pub file: String,
    /// What it takes over under other names; the rest goes on under its own.
    pub map: Vec<Mapped>,
}

/// Something of the next scene, and what of the last one it begins with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mapped {
    /// Its name in the next scene.
    pub name: String,
    /// Where it begins.
    pub from: MapSource,
}

/// What something of the next scene begins with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum MapSource {
    /// A body or a point: at this place and moving with it; a body along the axes of the frame, too.
    Place(Place),
    /// A state or a param: this number.
    Value {
        /// The number just before the instant [SI].
        value: Formula,
        /// What it measures; `None` of a number that fits anything, zero.
        dimension: Option<Dimension>,
    },
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
    /// The rate of a coordinate of a joint: joint, number of the coordinate.
    CoordinateRate(usize, usize),
    /// A component of the velocity of a place, world axes.
    Velocity(Place, usize),
    /// A component of the angular velocity of a body, world axes.
    AngularVelocityWorld(usize, usize),
    /// A component of the angular velocity of a body, its own axes.
    AngularVelocityBody(usize, usize),
}

impl Settable {
    /// The speed that is set; `None` of a number that is no speed.
    #[must_use]
    pub fn speed(self) -> Option<Formula> {
        let (vector, axis) = match self {
            Settable::Param(_) | Settable::State(_) => return None,
            Settable::CoordinateRate(joint, coordinate) => {
                return Some(Formula::CoordinateRate(joint, coordinate));
            }
            Settable::Velocity(place, axis) => (Formula::Velocity(place), axis),
            Settable::AngularVelocityWorld(body, axis) => {
                (Formula::AngularVelocityWorld(body), axis)
            }
            Settable::AngularVelocityBody(body, axis) => (Formula::AngularVelocityBody(body), axis),
        };
        Some(Formula::Component(vec![vector], axis))
    }
}
