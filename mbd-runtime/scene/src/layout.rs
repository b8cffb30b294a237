//! Where everything lives in the state and in the other lists of numbers: derived from the scene, the same for every way to run it.

use crate::Gravity;
use crate::elimination::{Elimination, Part};
use crate::formula::{Formula, Place};
use crate::joints::Side;
use crate::partition::Partition;
use crate::quantity::{Differentiated, Quantity, Variable};
use crate::redundancy::{Redundancy, RowSet};
use crate::scene::{Frame, LoadKind, NodeModel, PointKind, Scene};

/// Index ranges of a scene's state, lines, nodes and inputs.
///
/// State x = [q | v | z]: q per body x y z qw qx qy qz, per point with mass x y z; v per body vx vy vz (world axes, of the centre of mass)
/// wx wy wz (body or world axes, by declaration), per point vx vy vz; z per `rate` node its position. Items in declaration order,
/// bodies before points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layout {
    /// Number of coordinates.
    pub nq: usize,
    /// Number of speeds.
    pub nv: usize,
    /// Number of node states: 3 per `rate` node.
    pub nz: usize,
    /// Number of live parameters.
    pub np: usize,
    /// First coordinate and first speed of each body (7 and 6 long), as offsets into q and v.
    pub bodies: Vec<Slots>,
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
    /// What the caller supplies at each evaluation.
    pub inputs: Vec<InputSlots>,
    /// Length of the list of inputs.
    pub ni: usize,
    /// Number of output columns.
    pub columns: usize,
    /// Number of declared events.
    pub events: usize,
    /// Each joint's place among the rows.
    pub joints: Vec<JointSlots>,
    /// The stops of the joints, which follow the lines in [`At::hold`](crate::At::hold) and in the guards.
    pub stops: Vec<StopSlots>,
    /// Number of rows n_c of all joints.
    pub nc: usize,
    /// Which rows repeat others: those are left out of the system.
    pub redundancy: Redundancy,
    /// Whether outputs, and whether events, ask for the effort of a motor.
    pub efforts: [bool; 2],
    /// The system of bodies and joints, and the order in which it is solved.
    pub elimination: Elimination,
}

/// A joint's place among the rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JointSlots {
    /// Its first row.
    pub row: usize,
    /// Number of its rows: 6 − freedoms and one a motor; 0 where neither end moves, or an end is a massless point.
    pub len: usize,
    /// Those of them that are in the system: all, unless some repeat rows of other joints.
    pub kept: RowSet,
    /// What its parent end and its child end sit on; `None` for the world.
    pub ends: [Option<Part>; 2],
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
    /// A point with mass: 3 coordinates and 3 speeds.
    Mass(Slots),
    /// A node: index into [`Layout::nodes`].
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
    /// Offset of its position in z (`rate` only).
    pub z: Option<usize>,
}

/// Nodes joined by lines.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    /// Indices into [`Layout::nodes`].
    pub nodes: Vec<usize>,
    /// Its lines, by index.
    pub lines: Vec<usize>,
    /// Its anchors: indices into [`Layout::anchors`].
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
    /// An anchor: index into [`Layout::anchors`].
    Anchor(usize),
    /// A node: index into [`Layout::nodes`].
    Node(usize),
}

/// Where a line lives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LineSlots {
    /// Its `from` end and its `to` end.
    pub ends: [LineEnd; 2],
    /// Its place in [`At::effective`](crate::At::effective) (two numbers each), for lines of static and stepwise nodes.
    pub effective: Option<usize>,
}

/// An end of a node line that is not a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Anchor {
    /// The line.
    pub line: usize,
    /// Its place.
    pub place: Place,
    /// The node at the other end: index into [`Layout::nodes`].
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

impl Layout {
    /// Lays out a scene, and finds the rows of its joints that repeat others ([`Redundancy`]): a search at random states wherever joints
    /// close a loop. Where that has been done before, [`Layout::keeping`] takes its result.
    #[must_use]
    pub fn new(scene: &Scene) -> Self {
        let layout = Self::places(scene);
        let redundancy = Redundancy::find(scene, &layout);
        layout.kept(scene, redundancy)
    }

    /// Lays out a scene whose redundancy is known. The default one keeps every row.
    #[must_use]
    pub fn keeping(scene: &Scene, redundancy: Redundancy) -> Self {
        Self::places(scene).kept(scene, redundancy)
    }

    /// Leaves repeated rows out of the system and orders its elimination.
    fn kept(mut self, scene: &Scene, redundancy: Redundancy) -> Self {
        for repeat in &redundancy.repeats {
            if let Some(slots) = self.joints.get_mut(repeat.joint) {
                // Motors follow the rows of the law: what they prescribe is never left out.
                let motors = RowSet::all(slots.len).0 & !RowSet::all(repeat.rows).0;
                slots.kept = RowSet(repeat.kept.within(repeat.rows).0 | motors);
            }
        }
        let joints = scene.joints.iter();
        let partitions: Vec<Option<Partition>> =
            joints.map(|joint| Partition::of(&joint.law)).collect();
        self.elimination = Elimination::new(
            self.bodies.len(),
            &self.points,
            &self.joints,
            &partitions,
            redundancy.closed,
        );
        self.redundancy = redundancy;
        self
    }

    /// Everything but the system.
    fn places(scene: &Scene) -> Self {
        let mut layout = Layout {
            np: scene.params.len(),
            events: scene.events.len(),
            ..Layout::default()
        };
        layout.place_state(scene);
        layout.place_lines(scene);
        layout.place_networks();
        layout.place_inputs(scene);
        layout.place_rows(scene);
        let stops = scene.stops().map(|(joint, along, side)| StopSlots {
            joint,
            coordinate: along.coordinate,
            side,
        });
        layout.stops = stops.collect();
        let effort =
            |formula: &Formula| formula.contains(|part| matches!(part, Formula::MotorEffort(..)));
        layout.efforts = [
            scene.outputs.iter().any(|output| effort(&output.value)),
            scene.events.iter().any(|event| effort(&event.guard)),
        ];
        layout.columns = scene.outputs.iter().map(|output| output.components).sum();
        layout
    }

    /// Number of independent rows: those that are kept.
    #[must_use]
    pub fn rank(&self) -> usize {
        self.joints.iter().map(|slots| slots.kept.len()).sum()
    }

    /// Freedoms: speeds that the joints leave.
    #[must_use]
    pub fn freedoms(&self) -> usize {
        self.nv.saturating_sub(self.rank())
    }

    /// Length of the state.
    #[must_use]
    pub fn nx(&self) -> usize {
        self.nq + self.nv + self.nz
    }

    /// Number of laws that act one way: lines, then stops.
    #[must_use]
    pub fn one_way(&self) -> usize {
        self.lines.len() + self.stops.len()
    }

    /// Length of a quantity.
    #[must_use]
    pub fn len(&self, what: Quantity) -> usize {
        match what {
            Quantity::Ends => 6 * self.anchors.len() + 3 * self.nodes.len(),
            Quantity::Equilibrium(k) => self
                .placed(k)
                .map_or(0, |n| 3 * n.nodes.len() + 6 * n.blocks.len() + 3),
            Quantity::Derivative => self.nx(),
            Quantity::Balance => 3 * self.nodes.len(),
            Quantity::Guards => 2 * self.one_way() + self.events,
            Quantity::Outputs => self.columns,
            Quantity::Energy => 6,
            Quantity::Momentum => 6,
            Quantity::MassMatrix => self.nv * self.nv,
            Quantity::BiasForce | Quantity::Forces => self.nv,
            Quantity::Lines => 10 * self.lines.len(),
            Quantity::NodeByAnchor(k) => self
                .placed(k)
                .map_or(0, |n| 9 * n.nodes.len() * n.anchors.len()),
            Quantity::CondensedStiffness(k) => self
                .placed(k)
                .map_or(0, |n| 9 * n.anchors.len() * n.anchors.len()),
            Quantity::Constraint
            | Quantity::ConstraintRate
            | Quantity::ConstraintBias
            | Quantity::Multipliers => self.nc,
            Quantity::ConstraintJacobian => self.nc * self.nv,
            Quantity::Reactions if self.nc > 0 => 6 * self.joints.len(),
            Quantity::Correction if self.nc > 0 => self.nv + 1,
            Quantity::Reactions | Quantity::Correction => 0,
            Quantity::Partial(of, by) => self.len(of.quantity()) * self.variables(by),
        }
    }

    /// Columns of a quantity that is a matrix; 1 for a list.
    #[must_use]
    pub fn columns_of(&self, what: Quantity) -> usize {
        match what {
            Quantity::MassMatrix | Quantity::ConstraintJacobian => self.nv,
            Quantity::NodeByAnchor(k) | Quantity::CondensedStiffness(k) => {
                self.placed(k).map_or(1, |n| 3 * n.anchors.len())
            }
            Quantity::Partial(_, by) => self.variables(by),
            _ => 1,
        }
    }

    /// Whether a quantity asks for the effort of a motor, which takes the multipliers.
    #[must_use]
    pub fn asks_efforts(&self, what: Quantity) -> bool {
        match what {
            Quantity::Outputs => self.efforts[0],
            Quantity::Guards => self.efforts[1],
            _ => false,
        }
    }

    /// A network whose nodes are placed by the balance of forces at a position. A `rate` node is not: its balance is one of velocities.
    fn placed(&self, network: usize) -> Option<&Network> {
        let found = self.networks.get(network);
        found.filter(|network| network.model != NodeModel::Rate)
    }

    /// How many numbers a variable has.
    #[must_use]
    pub fn variables(&self, by: Variable) -> usize {
        match by {
            Variable::State => self.nx(),
            Variable::Node => 3 * self.nodes.len(),
            Variable::Parameter => self.np,
        }
    }

    /// Every quantity this scene has a use for, in a fixed order. Not the derivatives of ẋ where joints have rows: through the factor of the
    /// rows they take 187,000 operations for eight hinges; those of the rows' residual with the factor at hand are still to come.
    #[must_use]
    pub fn quantities(&self) -> Vec<Quantity> {
        let mut all = vec![Quantity::Ends];
        all.extend((0..self.networks.len()).map(Quantity::Equilibrium));
        all.extend([
            Quantity::Derivative,
            Quantity::Balance,
            Quantity::Guards,
            Quantity::Outputs,
            Quantity::Energy,
            Quantity::Momentum,
            Quantity::MassMatrix,
            Quantity::BiasForce,
            Quantity::Forces,
            Quantity::Lines,
            Quantity::Constraint,
            Quantity::ConstraintJacobian,
            Quantity::ConstraintRate,
            Quantity::ConstraintBias,
            Quantity::Multipliers,
            Quantity::Reactions,
            Quantity::Correction,
        ]);
        for k in 0..self.networks.len() {
            all.extend([Quantity::NodeByAnchor(k), Quantity::CondensedStiffness(k)]);
        }
        for of in [
            Differentiated::Derivative,
            Differentiated::Balance,
            Differentiated::Outputs,
        ] {
            for by in [Variable::State, Variable::Node, Variable::Parameter] {
                all.push(Quantity::Partial(of, by));
            }
        }
        let through_factor = |what| matches!(what, Quantity::Partial(of, _) if self.nc > 0 && (of == Differentiated::Derivative || self.asks_efforts(of.quantity())));
        all.retain(|&what| self.len(what) > 0 && !through_factor(what));
        all
    }

    fn place_state(&mut self, scene: &Scene) {
        for _ in &scene.bodies {
            self.bodies.push(Slots {
                q: self.nq,
                v: self.nv,
            });
            self.nq += 7;
            self.nv += 6;
        }
        for (point, declared) in scene.points.iter().enumerate() {
            match declared.kind {
                PointKind::Mass(_) => {
                    self.points.push(PointSlots::Mass(Slots {
                        q: self.nq,
                        v: self.nv,
                    }));
                    self.nq += 3;
                    self.nv += 3;
                }
                PointKind::Node(model) => {
                    self.points.push(PointSlots::Node(self.nodes.len()));
                    let z = (model == NodeModel::Rate).then_some(self.nz);
                    self.nz += if z.is_some() { 3 } else { 0 };
                    self.nodes.push(Node {
                        point,
                        model,
                        network: 0,
                        local: 0,
                        lines: Vec::new(),
                        z,
                    });
                }
            }
        }
    }

    fn place_rows(&mut self, scene: &Scene) {
        let moving = |place: Place| match place {
            Place::World(frame) => scene.world_frames.get(frame).is_some_and(Frame::moves),
            _ => false,
        };
        for joint in &scene.joints {
            let ends = [joint.parent, joint.child].map(|place| match place {
                Place::World(_) => None,
                Place::Body(body, _) => Some(Part::Body(body)),
                Place::Point(point) => Some(Part::Point(point)),
            });
            let massless = |part: &Part| matches!(*part, Part::Point(p) if !matches!(self.points.get(p), Some(PointSlots::Mass(_))));
            let holds = ends[0] != ends[1] && !ends.iter().flatten().any(massless);
            let motors = joint.motors().count();
            let len = if holds { joint.law.rows() + motors } else { 0 };
            self.joints.push(JointSlots {
                row: self.nc,
                len,
                kept: RowSet::all(len),
                ends,
                driven: len > 0
                    && (motors > 0 || [joint.parent, joint.child].into_iter().any(moving)),
            });
            self.nc += len;
        }
    }

    fn node_at(&self, place: Place) -> Option<usize> {
        match place {
            Place::Point(point) => match self.points.get(point) {
                Some(PointSlots::Node(node)) => Some(*node),
                _ => None,
            },
            _ => None,
        }
    }

    fn place_lines(&mut self, scene: &Scene) {
        for (index, line) in scene.lines.iter().enumerate() {
            let places = [line.from, line.to];
            let nodes = places.map(|place| self.node_at(place));
            let mut ends = [LineEnd::Plain; 2];
            for end in 0..2 {
                ends[end] = match (nodes[end], nodes[1 - end]) {
                    (Some(node), _) => LineEnd::Node(node),
                    (None, Some(node)) => {
                        self.anchors.push(Anchor {
                            line: index,
                            place: places[end],
                            node,
                        });
                        LineEnd::Anchor(self.anchors.len() - 1)
                    }
                    (None, None) => LineEnd::Plain,
                };
            }
            let mut effective = None;
            for node in nodes.into_iter().flatten() {
                let node = &mut self.nodes[node];
                if node.lines.last() != Some(&index) {
                    node.lines.push(index);
                }
                if node.model != NodeModel::Rate {
                    effective = Some(self.effective_lines);
                }
            }
            self.effective_lines += usize::from(effective.is_some());
            self.lines.push(LineSlots { ends, effective });
        }
    }

    /// Nodes joined by lines fall into networks, numbered by their first node.
    fn place_networks(&mut self) {
        let mut leader: Vec<usize> = (0..self.nodes.len()).collect();
        loop {
            let mut settled = true;
            for line in &self.lines {
                if let [LineEnd::Node(a), LineEnd::Node(b)] = line.ends {
                    let low = leader[a].min(leader[b]);
                    settled &= leader[a] == low && leader[b] == low;
                    leader[a] = low;
                    leader[b] = low;
                }
            }
            if settled {
                break;
            }
        }
        for (node, &first) in leader.iter().enumerate() {
            let network = if first == node {
                self.networks.push(Network {
                    nodes: Vec::new(),
                    lines: Vec::new(),
                    anchors: Vec::new(),
                    blocks: Vec::new(),
                    model: self.nodes[node].model,
                });
                self.networks.len() - 1
            } else {
                self.nodes[first].network
            };
            self.nodes[node].network = network;
            self.nodes[node].local = self.networks[network].nodes.len();
            self.networks[network].nodes.push(node);
        }
        for network in 0..self.networks.len() {
            let nodes = self.networks[network].nodes.clone();
            let mut lines: Vec<usize> = nodes
                .iter()
                .flat_map(|&node| self.nodes[node].lines.iter().copied())
                .collect();
            lines.sort_unstable();
            lines.dedup();
            let mut pairs: Vec<(usize, usize)> = Vec::new();
            for &line in &lines {
                if let [LineEnd::Node(a), LineEnd::Node(b)] = self.lines[line].ends {
                    let (a, b) = (self.nodes[a].local, self.nodes[b].local);
                    pairs.push((a.max(b), a.min(b)));
                }
            }
            pairs.retain(|(a, b)| a != b);
            pairs.sort_unstable();
            pairs.dedup();
            let anchors = (0..self.anchors.len())
                .filter(|&a| self.nodes[self.anchors[a].node].network == network)
                .collect();
            let target = &mut self.networks[network];
            target.blocks = (0..nodes.len())
                .map(|node| (node, node))
                .chain(pairs)
                .collect();
            target.lines = lines;
            target.anchors = anchors;
        }
    }

    fn place_inputs(&mut self, scene: &Scene) {
        for (index, input) in scene.inputs.iter().enumerate() {
            self.input(input.components, InputSource::Input(index));
        }
        for (index, load) in scene.loads.iter().enumerate() {
            if load.kind == LoadKind::External {
                let len = if matches!(load.at, Place::Point(_)) {
                    3
                } else {
                    6
                };
                self.input(len, InputSource::Load(index));
            }
        }
        if scene.gravity == Gravity::Field {
            for body in 0..scene.bodies.len() {
                self.input(3, InputSource::BodyGravity(body));
            }
            for point in 0..scene.points.len() {
                if matches!(self.points[point], PointSlots::Mass(_)) {
                    self.input(3, InputSource::PointGravity(point));
                }
            }
        }
    }

    fn input(&mut self, len: usize, source: InputSource) {
        self.inputs.push(InputSlots {
            at: self.ni,
            len,
            source,
        });
        self.ni += len;
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
