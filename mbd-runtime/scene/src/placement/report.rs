//! What placing bodies decided, and why they cannot be placed.

use crate::{Scene, plain};

/// What placing bodies by joint coordinates decided beyond what it was told.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlacementReport {
    /// The coordinates that are said to be about a value, in the order they were given, then declared ones that gave way to what was given.
    pub about: Vec<AboutStart>,
    /// Coordinates of loops that nothing said decides, joint and number, of the attitude of a ball its first: what is taken is near zero, or near
    /// what was taken before.
    pub undecided: Vec<(usize, usize)>,
}

impl PlacementReport {
    /// Coordinates that are about a value, or gave way, by their names, with what was said and what was taken [m or rad].
    #[must_use]
    pub fn told_about(&self, scene: &Scene) -> Vec<(String, f64, f64)> {
        let told = self.about.iter().map(|start| {
            let name = scene.coordinate_name(start.joint, start.coordinate);
            (name, start.said, start.taken)
        });
        told.collect()
    }

    /// The coordinates that nothing decides, by their names; an attitude, which is no number, by that of its joint.
    #[must_use]
    pub fn told_undecided(&self, scene: &Scene) -> Vec<String> {
        let name = |&(joint, coordinate): &(usize, usize)| match scene.coordinate(joint, coordinate)
        {
            Some(_) => scene.coordinate_name(joint, coordinate),
            None => scene.joints[joint].name.clone(),
        };
        let mut told: Vec<String> = self.undecided.iter().map(name).collect();
        told.dedup();
        told
    }
}

/// Where a coordinate starts that was said to be about a value, or gave way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AboutStart {
    /// The joint, by index.
    pub joint: usize,
    /// The coordinate, by number.
    pub coordinate: usize,
    /// The value that was said [m or rad].
    pub said: f64,
    /// The value that it has [m or rad].
    pub taken: f64,
}

/// Why bodies cannot be placed by joint coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlacementError {
    /// Where this joint's ends are is decided already, by other coordinates that are given, or by the bodies themselves, and not as its start says.
    Decided {
        /// The joint, by index.
        joint: usize,
    },
    /// A motor holds this coordinate elsewhere, or has it move otherwise, than its start says.
    Driven {
        /// The joint, by index.
        joint: usize,
        /// The coordinate, by number.
        coordinate: usize,
        /// Where the motor holds it, and how fast it moves it there [m or rad, and per second].
        held: [f64; 2],
    },
    /// A joint that is placed by others, or by the bodies it joins, moves at another rate than its own start says.
    Moving {
        /// The joint, by index.
        joint: usize,
    },
    /// The rates that are given contradict each other: no rates of the other joints keep the loops closed.
    Rates {
        /// The joint that would come apart fastest, by index.
        joint: usize,
    },
    /// No coordinates of the other joints close the loops.
    Open {
        /// The joint that is open most, by index.
        joint: usize,
        /// By how much, in `unit`.
        gap: f64,
        /// `m`, or `rad` of axes that are not where they belong.
        unit: &'static str,
    },
}

impl PlacementError {
    /// The joint and what is wrong with its start, as it follows its name.
    #[must_use]
    pub fn describe(&self, scene: &Scene) -> (String, String) {
        let (joint, why) = match *self {
            PlacementError::Decided { joint } => (
                joint,
                "is placed already, by other joint coordinates or by the bodies it joins, and not where its start says: leave out one of them, or say `about` before the start that may give way".to_owned(),
            ),
            PlacementError::Moving { joint } => (
                joint,
                "is placed already, by other joint coordinates or by the bodies it joins, and does not move there at the rate that its start says: a `start` of a body without `velocity` and `angular_velocity` is one at rest; say these there and leave out `start_rate`, or leave out the `start` of the body".to_owned(),
            ),
            PlacementError::Driven {
                joint,
                coordinate,
                held: [value, rate],
            } => {
                let name = scene.coordinate_name(joint, coordinate);
                let found = scene.coordinate(joint, coordinate);
                let unit = found.map_or("m", |(_, coordinate)| coordinate.unit());
                (
                    joint,
                    format!("has a motor, which holds `{name}` at {value:.6} {unit} and {rate:.6} {unit}/s at the start, and not where its start says: leave the start out; a motor behind a filter begins where the declaration has the `start` of its coordinate"),
                )
            }
            PlacementError::Rates { joint } => (
                joint,
                "comes apart: the rates that its loop starts with contradict each other; leave out one of them".to_owned(),
            ),
            PlacementError::Open { joint, gap, unit } => (
                joint,
                format!("stays open by {gap} {unit}: the starts that are given, and the lengths of its loop, let nothing close it; leave out a start there, say `about` before one that may give way, or change a length", gap = plain(gap, 2)),
            ),
        };
        let name = scene.joints.get(joint).map(|joint| joint.name.clone());
        (name.unwrap_or_default(), why)
    }
}
