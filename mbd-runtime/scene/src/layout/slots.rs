//! What each thing of a scene owns among the lists of numbers.

use crate::joints::Side;
use crate::rows::MOST_ENDS;
use crate::scalar::Few;
use crate::scene::{NodeModel, Scene};
use crate::{Formula, Part, Place, RowSet};

/// A joint's place among the rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JointSlots {
    /// Its first row.
    pub row: usize,
    /// Number of its rows: 6 − freedoms, in a plane those of them that say something there, and one a motor; 0 where neither end moves,
    /// or an end is a massless point.
    pub len: usize,
    /// The rows of its law that count: all; in a plane those that say something there and do not repeat each other.
    pub law: RowSet,
    /// Whether it holds anything in space: it has two ends, at least one moves, and none is a massless point.
    pub holds: bool,
    /// Those of them that are in the system: all, unless some repeat rows of other joints.
    pub kept: RowSet,
    /// What its parent end and its child end sit on, and of a coupling those of the other joints that it couples; `None` for the world.
    pub ends: Few<Option<Part>, MOST_ENDS>,
    /// Its place in [`At::hold`](crate::At::hold), where a run may detach it.
    pub switch: Option<usize>,
    /// Of a lock the place in [`At::hold`](crate::At::hold) of the number that it holds its coordinate at.
    pub held: Option<usize>,
    /// Whether its rows depend on time: motors, or an end on a frame of the world that moves.
    pub driven: bool,
}

impl JointSlots {
    /// Whether every row of the joint is in the system.
    #[must_use]
    pub fn all_kept(&self) -> bool {
        self.kept.len() == self.len
    }
}

/// What of the solved system a quantity asks for: it follows from the accelerations, so that they come first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FromSolution {
    /// Multipliers: efforts of motors.
    pub multipliers: bool,
    /// Reactions of joints.
    pub reactions: bool,
    /// Accelerations v̇.
    pub accelerations: bool,
}

impl FromSolution {
    /// What some formulas ask for, and the lets that they name.
    #[must_use]
    pub fn by<'f>(scene: &Scene, formulas: impl Iterator<Item = &'f Formula>) -> Self {
        let mut asked = FromSolution::default();
        for formula in formulas {
            scene.walk(formula, &mut |part| match part {
                Formula::MotorEffort(..) => asked.multipliers = true,
                Formula::ReactionForce(_) | Formula::ReactionTorque(_) => asked.reactions = true,
                Formula::Acceleration(_)
                | Formula::AngularAcceleration(_)
                | Formula::CoordinateAcceleration(..) => asked.accelerations = true,
                _ => {}
            });
        }
        asked
    }

    /// Whether it asks for anything.
    #[must_use]
    pub fn any(self) -> bool {
        self.multipliers || self.reactions || self.accelerations
    }
}

/// A stop of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StopSlots {
    /// Its joint.
    pub joint: usize,
    /// The coordinate it ends.
    pub coordinate: usize,
    /// Which end.
    pub side: Side,
}

/// A joint that a run may detach.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DetachableJoint {
    /// The joint, by index.
    pub joint: usize,
    /// Whether it is detached at the start.
    pub detached: bool,
}

/// Offsets into q and into v.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slots {
    /// First coordinate.
    pub q: usize,
    /// First speed.
    pub v: usize,
}

/// What a point owns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointSlots {
    /// A point with mass: 3 coordinates and 3 speeds, in a plane 2 and 2.
    Mass(Slots),
    /// A node: index into [`Layout::nodes`](crate::Layout::nodes).
    Node(usize),
}

/// An equilibrium point.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Its point.
    pub point: usize,
    /// Its model.
    pub model: NodeModel,
    /// Its network.
    pub network: usize,
    /// Its position among the nodes of that network.
    pub local: usize,
    /// Its lines, by index.
    pub lines: Vec<usize>,
    /// Whether a declared load acts on it.
    pub loaded: bool,
    /// Where the rate of its load is in [`Quantity::AnchorStates`](crate::Quantity::AnchorStates), of a `rate` one whose load changes as its declaration
    /// tells: where one line or two carry it, it moves with its load.
    pub load_rate: Option<usize>,
    /// Offset of its position in z (`rate` only).
    pub z: Option<usize>,
    /// Where its velocity is in [`At::effective`](crate::At::effective), of a `stepwise` one with damped lines: it moves by what it remembers, too, and not
    /// by its anchors alone.
    pub velocity: Option<usize>,
}

/// Nodes joined by lines.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    /// Indices into [`Layout::nodes`](crate::Layout::nodes).
    pub nodes: Vec<usize>,
    /// Its lines, by index.
    pub lines: Vec<usize>,
    /// Its anchors: indices into [`Layout::anchors`](crate::Layout::anchors).
    pub anchors: Vec<usize>,
    /// Structural non-zero blocks of H, local node indices (row ≥ column): the diagonal first, then pairs joined by a line, sorted.
    pub blocks: Vec<(usize, usize)>,
    /// The model shared by its nodes.
    pub model: NodeModel,
}

/// Where a line ends, seen from the nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineEnd {
    /// On a body, the world or a point with mass, of a line that has no node at all.
    Plain,
    /// An anchor: index into [`Layout::anchors`](crate::Layout::anchors).
    Anchor(usize),
    /// A node: index into [`Layout::nodes`](crate::Layout::nodes).
    Node(usize),
}

/// Where a line lives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LineSlots {
    /// Its `from` end and its `to` end.
    pub ends: [LineEnd; 2],
    /// Its place in [`At::effective`](crate::At::effective) (two numbers each), for lines of static and stepwise nodes.
    pub effective: Option<usize>,
    /// Whether it pulls alone, and slackens: a spring does not.
    pub slackens: bool,
    /// Whether a run may detach it.
    pub detachable: bool,
    /// Whether it is detached at the start.
    pub detached: bool,
}

/// An end of a node line that is not a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Anchor {
    /// The line.
    pub line: usize,
    /// Its place.
    pub place: Place,
    /// The node at the other end: index into [`Layout::nodes`](crate::Layout::nodes).
    pub node: usize,
}

/// What a run of input numbers means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InputSlots {
    /// First number.
    pub at: usize,
    /// How many.
    pub len: usize,
    /// What it is.
    pub source: InputSource,
}

/// What the caller supplies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputSource {
    /// A declared input, by index.
    Input(usize),
    /// An external load, by index: force and couple (force only at a point), world axes.
    Load(usize),
    /// External gravity at a body, by index [m/s²].
    BodyGravity(usize),
    /// External gravity at a point with mass, by index [m/s²].
    PointGravity(usize),
}
