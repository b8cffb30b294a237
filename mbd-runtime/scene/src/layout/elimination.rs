//! The order in which the system of bodies and joints is solved, and where its blocks live.

use serde::{Deserialize, Serialize};

use crate::{Part, RowSet};

/// A node of the system at its place in the order.
#[derive(Clone, Debug, PartialEq)]
pub struct EliminationStep {
    /// What it is.
    pub part: Part,
    /// First unknown.
    pub first: usize,
    /// Number of unknowns.
    pub size: usize,
    /// In relative coordinates the places in v of its unknowns; empty for rows.
    pub speeds: Vec<usize>,
    /// Where its diagonal block starts in the store (size × size, row by row, lower triangle used).
    pub diagonal: usize,
    /// Later nodes it is coupled to, in order.
    pub below: Vec<Below>,
    /// A body that leaves together with its parent joint, the next step: how that joint carries it.
    pub carrying: Option<Carrying>,
    /// A joint that leaves together with its child, the step before.
    pub paired: bool,
}

/// A coupling to a later node.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Below {
    /// The later node: index into [`Elimination::steps`].
    pub step: usize,
    /// Where the block starts in the store (size of the later node × size of this one, row by row).
    pub at: usize,
    /// Where the products with the couplings up to and including this one go, one a coupling.
    pub targets: Vec<usize>,
}

/// A speed of the tree that a motor or a coupling of joints of the tree gives, from time and other speeds: it leaves the system with that row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Dependent {
    /// Its place in v.
    pub speed: usize,
    /// The joint that drives it, or the coupling.
    pub joint: usize,
    /// The row that gives it.
    pub row: usize,
    /// Which coordinate of the coupling it is; 0 of a motor.
    pub number: usize,
    /// The other speeds of the coupling, each with the number of its coordinate.
    pub sources: Vec<(usize, usize)>,
}

/// The order in which the nodes of a system leave it: found once, by counting, when a scene is compiled.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Order {
    /// The nodes, first eliminated first.
    pub parts: Vec<Part>,
    /// Whether each body that a joint carries leaves together with that joint.
    pub articulated: bool,
    /// Whether the factor that derivatives are solved by is that of articulated bodies: of a tree without rows.
    pub articulated_factor: bool,
    /// Estimated operations of the candidates: least degree, least cost, articulated bodies.
    pub candidates: [usize; 3],
}

/// The order of elimination of a scene, and where its blocks live.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Elimination {
    /// The nodes, first eliminated first.
    pub steps: Vec<EliminationStep>,
    /// Number of unknowns.
    pub unknowns: usize,
    /// Length of the store of blocks.
    pub store: usize,
    /// The step of each body; `None` where no joint holds it.
    pub bodies: Vec<Option<usize>>,
    /// The step of each point.
    pub points: Vec<Option<usize>>,
    /// The step of each joint; `None` where it has no rows.
    pub joints: Vec<Option<usize>>,
    /// The step of the speeds of each joint of a tree; `None` of another joint.
    pub coordinates: Vec<Option<usize>>,
    /// The parent joint of each body, which carries it out of the system; `None` where none does.
    pub parent_joints: Vec<Option<usize>>,
    /// The order it was laid out in.
    pub order: Order,
    /// In relative coordinates the speeds that are no unknowns; each is none that one before it names.
    pub dependents: Vec<Dependent>,
}

/// How a joint carries its child.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carrying {
    /// Number of columns of H, coordinates that motors drive left out.
    pub free: usize,
    /// Number of columns of H that turn the child.
    pub turns: usize,
    /// Whether the child's unknowns are along its own components.
    pub own: bool,
    /// Whether they are rotated to axes of the joint where the child leaves: see [`Carried::axes`].
    pub axes: bool,
    /// Whether the child's unknowns are those of the parent: same axes, same point.
    pub shared: bool,
    /// Whether the joint points coincide: see [`Carried::meets`].
    pub meets: bool,
    /// In a plane, the rows that hold the point.
    pub points: RowSet,
}

impl Carrying {
    /// Whether its unknowns may be along other components than its own, because what it carries is.
    pub(crate) fn may_turn(&self) -> bool {
        self.own && self.turns < 2
    }

    /// The same for a child that carries nothing: its inertia is constant in its own components.
    #[must_use]
    pub fn of_leaf(self) -> Self {
        Carrying {
            own: self.turns > 0,
            ..self
        }
    }
}

impl Elimination {
    /// How the parent joint of a body carries it, and which joint that is; `None` where none does.
    #[must_use]
    pub fn carrying(&self, body: usize) -> Option<(usize, Carrying)> {
        let joint = (*self.parent_joints.get(body)?)?;
        let step = self.step_of(Part::Body(body))?;
        Some((joint, self.steps.get(step)?.carrying?))
    }

    /// The child that a joint carries out of the system, and how; `None` where it carries none.
    #[must_use]
    pub fn child_of(&self, joint: usize) -> Option<(usize, Carrying)> {
        // The two leave as a pair, the body first.
        let leaving = self
            .steps
            .get(self.step_of(Part::Joint(joint))?.checked_sub(1)?)?;
        let Part::Body(body) = leaving.part else {
            return None;
        };
        let (parent, carrying) = self.carrying(body)?;
        (parent == joint).then_some((body, carrying))
    }

    /// The step of a part; `None` if the system has no such part.
    #[must_use]
    pub fn step_of(&self, part: Part) -> Option<usize> {
        match part {
            Part::Body(body) => self.bodies.get(body).copied().flatten(),
            Part::Point(point) => self.points.get(point).copied().flatten(),
            Part::Joint(joint) => self.joints.get(joint).copied().flatten(),
            Part::Coordinates(joint) => self.coordinates.get(joint).copied().flatten(),
        }
    }

    /// The row that gives a speed; `None` of an independent one.
    #[must_use]
    pub fn gives(&self, speed: usize) -> Option<usize> {
        let own = |dependent: &&Dependent| dependent.speed == speed;
        self.dependents.iter().find(own).map(|own| own.row)
    }

    /// The dependent speed that a joint couples to others; `None` of a joint that couples nothing, or whose row stays in the system.
    #[must_use]
    pub fn coupled_by(&self, joint: usize) -> Option<&Dependent> {
        let own = |dependent: &&Dependent| dependent.joint == joint;
        let found = self.dependents.iter().find(own)?;
        (!found.sources.is_empty()).then_some(found)
    }

    /// Where the block of two nodes starts, rows of the later one.
    #[must_use]
    pub fn block(&self, row: usize, column: usize) -> Option<usize> {
        let step = self.steps.get(column)?;
        if row == column {
            return Some(step.diagonal);
        }
        let below = step.below.binary_search_by_key(&row, |below| below.step);
        Some(step.below.get(below.ok()?)?.at)
    }
}
