//! What the equations of motion are about: bodies, points with mass, joints.

use serde::{Deserialize, Serialize};

/// What a node of the system is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Part {
    /// The speeds of a body: six, in a plane three.
    Body(usize),
    /// The speeds of a point with mass: three, in a plane two.
    Point(usize),
    /// The rows of a joint.
    Joint(usize),
    /// The speeds of a joint of the tree: relative coordinates.
    Coordinates(usize),
}
