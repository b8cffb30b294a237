//! Where everything lives in the state and in the other lists of numbers: derived from the scene, the same for every way to run it.

mod elimination;
mod joint_numbers;
mod places;
mod repeats;
mod sizes;
mod slots;
mod tree;
mod turns;

pub use elimination::{Below, Carrying, Dependent, Elimination, EliminationStep, Order};
pub use repeats::{Ambiguous, HeldMotor, Redundancy, Repeat};
pub use slots::{
    Anchor, DetachableJoint, FromSolution, InputSlots, InputSource, JointSlots, LineEnd, LineSlots,
    Network, Node, PointSlots, Slots, StopSlots,
};
pub use tree::{Grouped, Link, LinkAxes, Tree};

use serde::{Deserialize, Serialize};

use nalgebra::Vector3;

use crate::scalar::algebra::vector;
use crate::{Detachable, Directions, Part, Real, Scene};

/// Index ranges of a scene's state, lines, nodes and inputs.
///
/// State x = [q | v | z | s]: q per body x y z qw qx qy qz, per point with mass x y z; v per body vx vy vz (world axes, of the centre of mass)
/// wx wy wz (body or world axes, by declaration), per point vx vy vz; z per `rate` node its position; s the declared states. Items in declaration order,
/// bodies before points. In relative coordinates q and v hold the floating bodies, then the coordinates and speeds of the joints of the tree in declaration order, then
/// the points. In a planar scene q per body is two positions and the angle about the normal [rad, right-handed, not wrapped],
/// v two velocities and the angular velocity about the normal; per point two of each: see [`Directions`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layout {
    /// Number of coordinates.
    pub nq: usize,
    /// Number of speeds.
    pub nv: usize,
    /// Number of node states: 3 per `rate` node.
    pub nz: usize,
    /// Number of declared states.
    pub ns: usize,
    /// Number of live parameters.
    pub np: usize,
    /// The axes along which things move and about which bodies turn.
    pub directions: Directions,
    /// First coordinate and first speed of each body (7 and 6 long, in a plane 3 and 3), as offsets into q and v; `None` of one that a joint
    /// of the tree carries: relative coordinates.
    pub bodies: Vec<Option<Slots>>,
    /// The spanning tree of relative coordinates; `None` in absolute ones.
    pub tree: Option<Tree>,
    /// What each point owns.
    pub points: Vec<PointSlots>,
    /// The nodes, in the order of their points.
    pub nodes: Vec<Node>,
    /// Nodes joined by lines, solved together.
    pub networks: Vec<Network>,
    /// Each line's place among the node lines.
    pub lines: Vec<LineSlots>,
    /// Ends of node lines that are not nodes themselves.
    pub anchors: Vec<Anchor>,
    /// Number of lines with effective numbers (lines of static and stepwise nodes).
    pub effective_lines: usize,
    /// Length of [`At::effective`](crate::At::effective): two numbers of each of these, then three of each node with a velocity there.
    pub effective_numbers: usize,
    /// What the caller supplies at each evaluation.
    pub inputs: Vec<InputSlots>,
    /// Length of the list of inputs.
    pub ni: usize,
    /// Number of output columns.
    pub columns: usize,
    /// Number of measurable joint coordinates.
    pub measured: usize,
    /// Number of declared events.
    pub events: usize,
    /// Number of named expressions.
    pub lets: usize,
    /// Each joint's place among the rows.
    pub joints: Vec<JointSlots>,
    /// The stops of the joints, which follow the lines in [`At::hold`](crate::At::hold) and in the guards.
    pub stops: Vec<StopSlots>,
    /// The joints that a run may detach, which follow the stops in [`At::hold`](crate::At::hold).
    pub detachable_joints: Vec<DetachableJoint>,
    /// Number of locks, whose numbers come behind those of detachable joints in [`At::hold`](crate::At::hold).
    pub locks: usize,
    /// The angles whose full turns a run counts, by joint and number of the coordinate: what anything reads of joints that are no link of the tree.
    /// Their values at the last step come behind everything else in [`At::hold`](crate::At::hold) but the origin.
    pub turns: Vec<(usize, usize)>,
    /// Number of rows n_c of all joints.
    pub nc: usize,
    /// Which rows repeat others: those are left out of the system.
    pub redundancy: Redundancy,
    /// What of the solved system outputs, and what events, ask for.
    pub asked: [FromSolution; 2],
    /// The system of bodies and joints, and the order in which it is solved.
    pub elimination: Elimination,
    /// Length of [`Quantity::Factor`](crate::Quantity::Factor).
    pub factor: usize,
}

/// What is found once, when a scene is compiled: which rows repeat others, and in which order the system is solved.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// The rows that repeat others.
    pub redundancy: Redundancy,
    /// The order of elimination.
    pub order: Order,
}

impl Layout {
    /// What was found when the scene was laid out: what a compiled model carries.
    #[must_use]
    pub fn plan(&self) -> Plan {
        Plan {
            redundancy: self.redundancy.clone(),
            order: self.elimination.order.clone(),
        }
    }

    /// The link that a joint of the tree carries; `None` of another joint, and in absolute coordinates.
    #[must_use]
    pub fn carried(&self, joint: usize) -> Option<&Link> {
        self.tree.as_ref()?.carried(joint)
    }

    /// The coordinates and speeds that a body or a point has for itself; `None` where it has none.
    #[must_use]
    pub fn own_slots(&self, part: Part) -> Option<Slots> {
        match part {
            Part::Body(body) => *self.bodies.get(body)?,
            Part::Point(point) => match self.points.get(point)? {
                PointSlots::Mass(slots) => Some(*slots),
                PointSlots::Node(_) => None,
            },
            Part::Joint(_) | Part::Coordinates(_) => None,
        }
    }

    /// Where a node is [m]: a `rate` node has its place in the state, of another one it is what is solved for.
    pub(crate) fn node_position<S: Real>(
        &self,
        node: usize,
        state: &[S],
        unknowns: &[S],
    ) -> Vector3<S> {
        match self.nodes.get(node).and_then(|node| node.z) {
            Some(z) => vector(state, self.nq + self.nv + z),
            None => vector(unknowns, 3 * node),
        }
    }

    /// Where all nodes are, 3 each [m], at a state with these unknowns of the nodes ([`At::nodes`](crate::At::nodes)).
    #[must_use]
    pub fn node_positions<S: Real>(&self, state: &[S], unknowns: &[S]) -> Vec<S> {
        let nodes = 0..self.nodes.len();
        let places = nodes.map(|node| self.node_position(node, state, unknowns));
        places
            .flat_map(|place| [place.x, place.y, place.z])
            .collect()
    }

    /// The joints of the tree with the links they carry, in the order of declaration, which is that of their coordinates.
    pub fn joint_links(&self) -> impl Iterator<Item = (usize, &Link)> + '_ {
        let joints = self.tree.iter().flat_map(|tree| 0..tree.of_joint.len());
        joints.filter_map(|joint| Some((joint, self.carried(joint)?)))
    }

    /// The link that carries a body's tree: its joint is one to the world, or there is none, and it floats. `None` in absolute coordinates.
    #[must_use]
    pub fn root_link(&self, body: usize) -> Option<&Link> {
        let tree = self.tree.as_ref()?;
        let mut link = tree.links.get(*tree.of_body.get(body)?)?;
        while let Some(inboard) = link.inboard {
            link = tree.links.get(inboard)?;
        }
        Some(link)
    }

    /// The bodies that have coordinates of their own: all in absolute coordinates, those that float in relative ones.
    pub fn own_bodies(&self) -> impl Iterator<Item = (usize, Slots)> + '_ {
        let bodies = self.bodies.iter().enumerate();
        bodies.filter_map(|(body, slots)| Some((body, (*slots)?)))
    }

    /// Whether accelerations come out of a system that is solved: rows of joints, or a tree.
    #[must_use]
    pub fn solves(&self) -> bool {
        self.nc > 0
            || self
                .tree
                .as_ref()
                .is_some_and(|tree| !tree.links.is_empty())
    }

    /// Number of independent rows: those that are kept.
    #[must_use]
    pub fn rank(&self) -> usize {
        self.rank_where(|_| true)
    }

    /// Number of independent rows, at least, of the joints that hold.
    #[must_use]
    pub fn rank_where(&self, holds: impl Fn(usize) -> bool) -> usize {
        let all = self.joints.iter().enumerate();
        let held = all.filter(|(joint, _)| holds(*joint));
        held.map(|(_, slots)| slots.kept.len()).sum()
    }

    /// Freedoms: speeds that the joints leave, where all locks hold and no joint is detached.
    #[must_use]
    pub fn freedoms(&self) -> usize {
        self.nv.saturating_sub(self.rank())
    }

    /// Freedoms at the start, where no lock holds, nor a joint that is detached then.
    #[must_use]
    pub fn freedoms_at_start(&self) -> usize {
        let rank = self.rank_where(|joint| self.starts_joined(joint));
        self.nv.saturating_sub(rank)
    }

    /// Length of the state.
    #[must_use]
    pub fn nx(&self) -> usize {
        self.nq + self.nv + self.nz + self.ns
    }

    /// Where in the state the declared states start.
    #[must_use]
    pub fn states(&self) -> usize {
        self.nq + self.nv + self.nz
    }

    /// Where in the state each quaternion starts; a planar scene has none.
    pub fn quaternions(&self) -> impl Iterator<Item = usize> + '_ {
        let bodies = self
            .own_bodies()
            .filter(|_| self.directions.plane.is_none());
        let bodies = bodies.map(|(_, slots)| slots.q + self.directions.translations().len());
        let joints = self
            .joint_links()
            .filter(|(_, link)| link.attitude().is_some());
        bodies.chain(joints.filter_map(|(_, link)| Some(link.attitude()?.start)))
    }

    /// Number of laws that act one way: lines, then stops.
    #[must_use]
    pub fn one_way(&self) -> usize {
        self.lines.len() + self.stops.len()
    }

    /// How many numbers [`At::hold`](crate::At::hold) begins with and always has: laws that act one way, joints that may be detached, what locks hold their
    /// coordinates at. Behind them are the angles of [`Layout::turns`], up to [`Layout::origin_at`].
    #[must_use]
    pub fn holds(&self) -> usize {
        self.one_way() + self.detachable_joints.len() + self.locks
    }

    /// The place in [`At::hold`](crate::At::hold) of the last value of an angle whose turns are counted.
    #[must_use]
    pub fn turn_of(&self, joint: usize, coordinate: usize) -> Option<usize> {
        let number = self.turns.iter().position(|it| *it == (joint, coordinate));
        number.map(|number| self.holds() + number)
    }

    /// Where [`At::hold`](crate::At::hold) says how the origin moves: behind everything else.
    #[must_use]
    pub fn origin_at(&self) -> usize {
        self.holds() + self.turns.len()
    }

    /// Whether what has a place in [`At::hold`](crate::At::hold) is detached at the start, in its order.
    pub fn start_detached(&self) -> impl Iterator<Item = bool> + '_ {
        let lines = self.lines.iter().map(|slots| slots.detached);
        let stops = self.stops.iter().map(|_| false);
        let joints = self.detachable_joints.iter().map(|it| it.detached);
        let locks = (0..self.locks).map(|_| false);
        lines.chain(stops).chain(joints).chain(locks)
    }

    /// Whether a joint holds at the start: it has rows and is not detached.
    #[must_use]
    pub fn starts_joined(&self, joint: usize) -> bool {
        let detached = |it: &DetachableJoint| it.joint == joint && it.detached;
        let rows = self.joints.get(joint).is_some_and(|slots| slots.len > 0);
        rows && !self.detachable_joints.iter().any(detached)
    }

    /// The place in [`At::hold`](crate::At::hold) of what an event detaches or attaches; `None` of a joint that holds nothing.
    #[must_use]
    pub fn switch_of(&self, what: Detachable) -> Option<usize> {
        match what {
            Detachable::Line(line) => Some(line),
            Detachable::Joint(joint) => self.joints.get(joint)?.switch,
        }
    }

    /// The number of a lock among the locks.
    #[must_use]
    pub fn held_of(&self, what: Detachable) -> Option<usize> {
        match what {
            Detachable::Line(_) => None,
            Detachable::Joint(joint) => {
                let held = self.joints.get(joint)?.held?;
                held.checked_sub(self.holds() - self.locks)
            }
        }
    }

    /// The numbers of the inputs that hold until the caller gives others: declared defaults; zero for external loads and external gravity.
    #[must_use]
    pub fn default_inputs(&self, scene: &Scene) -> Vec<f64> {
        let mut numbers = vec![0.0; self.ni];
        for slots in &self.inputs {
            if let InputSource::Input(index) = slots.source
                && let Some(input) = scene.inputs.get(index)
                && let Some(to) = numbers.get_mut(slots.at..slots.at + slots.len)
            {
                for (to, from) in to.iter_mut().zip(input.default) {
                    *to = from;
                }
            }
        }
        numbers
    }

    /// Whether something has no default and must come from the caller: an external load, external gravity.
    #[must_use]
    pub fn needs_caller(&self) -> bool {
        let mut sources = self.inputs.iter().map(|slots| slots.source);
        sources.any(|source| !matches!(source, InputSource::Input(_)))
    }

    /// Where the numbers of a source start.
    #[must_use]
    pub fn input_at(&self, source: InputSource) -> Option<usize> {
        self.inputs
            .iter()
            .find(|slots| slots.source == source)
            .map(|slots| slots.at)
    }
}
