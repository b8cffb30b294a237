//! Lays out a scene: one kind of thing after another gets its place.

use crate::event::Detachable;
use crate::joints::JointLaw;
use crate::layout::{
    Anchor, DetachableJoint, FromSolution, InputSlots, InputSource, JointSlots, Layout, LineEnd,
    LineSlots, Network, Node, PointSlots, Slots, StopSlots, Tree, turns,
};
use crate::scalar::Few;
use crate::scene::{Load, LoadKind, NodeModel, PointKind, Scene};
use crate::{Coordinates, Gravity, Part, Place, RowSet};

impl Layout {
    /// Everything but the system. `laws` tells of a scene without rows which rows of each joint's law count.
    pub(crate) fn places(scene: &Scene, laws: impl FnOnce(&Self) -> Vec<RowSet>) -> Self {
        let mut layout = Layout {
            np: scene.params.len(),
            ns: scene.states.len(),
            directions: scene.directions(),
            events: scene.events.len(),
            lets: scene.lets.len(),
            measured: scene
                .joints
                .iter()
                .map(|joint| joint.law.measured().count())
                .sum(),
            ..Layout::default()
        };
        layout.place_state(scene);
        layout.place_lines(scene);
        layout.place_loads(scene);
        layout.place_networks();
        layout.place_velocities(scene);
        layout.place_inputs(scene);
        let laws = laws(&layout);
        layout.place_rows(scene, laws);
        let stops = scene.stops().map(|(joint, forces, side)| StopSlots {
            joint,
            coordinate: forces.coordinate,
            side,
        });
        layout.stops = stops.collect();
        let joints = (0..scene.joints.len()).map(Detachable::Joint);
        let detachable = joints.filter(|&joint| scene.is_detachable(joint));
        for (number, joint) in detachable.enumerate() {
            let Detachable::Joint(index) = joint else {
                continue;
            };
            layout.detachable_joints.push(DetachableJoint {
                joint: index,
                detached: scene.starts.detached.contains(&joint),
            });
            layout.joints[index].switch = Some(layout.one_way() + number);
        }
        let locks = scene.joints.iter().enumerate();
        for (joint, _) in locks.filter(|(_, joint)| matches!(joint.law, JointLaw::Lock(_))) {
            layout.joints[joint].held = Some(layout.holds());
            layout.locks += 1;
        }
        layout.turns = turns::counted(scene, &layout);
        layout.asked = [
            FromSolution::by(scene, scene.outputs.iter().map(|output| &output.value)),
            FromSolution::by(scene, scene.events.iter().map(|event| &event.guard)),
        ];
        layout.columns = scene.outputs.iter().map(|output| output.components).sum();
        layout
    }

    fn place_state(&mut self, scene: &Scene) {
        self.bodies = vec![None; scene.bodies.len()];
        self.tree = (scene.coordinates == Coordinates::Relative).then(|| Tree::span(scene));
        let carried = |tree: &Option<Tree>, body: usize| {
            let link = tree
                .as_ref()
                .and_then(|tree| tree.links.get(*tree.of_body.get(body)?));
            link.is_some_and(|link| link.joint.is_some())
        };
        for body in 0..scene.bodies.len() {
            if carried(&self.tree, body) {
                continue;
            }
            let slots = self.own(self.directions.coordinates(), self.directions.speeds());
            self.bodies[body] = Some(slots);
        }
        self.place_tree(scene);
        for (point, declared) in scene.points.iter().enumerate() {
            match declared.kind {
                PointKind::Mass(_) => {
                    let moves = self.directions.translations().len();
                    let slots = self.own(moves, moves);
                    self.points.push(PointSlots::Mass(slots));
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
                        loaded: false,
                        load_rate: None,
                        z,
                        velocity: None,
                    });
                }
            }
        }
    }

    /// The next coordinates and speeds.
    fn own(&mut self, coordinates: usize, speeds: usize) -> Slots {
        let slots = Slots {
            q: self.nq,
            v: self.nv,
        };
        self.nq += coordinates;
        self.nv += speeds;
        slots
    }

    /// Gives the links of the tree their coordinates: those of the joints in the order of declaration.
    fn place_tree(&mut self, scene: &Scene) {
        let Some(mut tree) = self.tree.take() else {
            return;
        };
        for link in &mut tree.links {
            if let Some(slots) = self.bodies[link.body] {
                link.slots = slots;
                (link.coordinates, link.speeds) =
                    (self.directions.coordinates(), self.directions.speeds());
                link.turns = self.directions.rotations().len();
            }
        }
        for (joint, link) in tree.of_joint.iter().enumerate() {
            if let Some(link) = link.and_then(|link| tree.links.get_mut(link)) {
                let law = &scene.joints[joint].law;
                (link.coordinates, link.speeds) = (law.coordinates(), law.freedoms());
                let angles = law
                    .measured()
                    .filter(|coordinate| coordinate.is_angle())
                    .count();
                link.turns = angles + if law.attitude().is_some() { 3 } else { 0 };
                link.slots = self.own(link.coordinates, link.speeds);
            }
        }
        self.tree = Some(tree);
    }

    fn place_rows(&mut self, scene: &Scene, laws: Vec<RowSet>) {
        let moving = |place: Place| match place {
            Place::World(frame) => scene
                .world_frames
                .get(frame)
                .is_some_and(|frame| frame.moves(scene)),
            _ => false,
        };
        for ((joint, law), index) in scene.joints.iter().zip(laws).zip(0..) {
            // A joint of the tree allows instead of forbidding: only its motors are rows.
            let in_tree = self.carried(index).is_some();
            let law = if in_tree { RowSet::default() } else { law };
            let places = scene.ends(joint);
            let mut ends = Few::new(None);
            ends.extend(places.clone().map(|place| match place {
                Place::World(_) => None,
                Place::Body(body, _) => Some(Part::Body(body)),
                Place::Point(point) => Some(Part::Point(point)),
            }));
            let massless = |part: &Part| matches!(*part, Part::Point(p) if !matches!(self.points.get(p), Some(PointSlots::Mass(_))));
            let apart = ends.iter().any(|end| Some(end) != ends.first());
            let holds = apart && !ends.iter().flatten().any(massless);
            let motors = joint.motors().count();
            let len = if holds { law.len() + motors } else { 0 };
            self.joints.push(JointSlots {
                row: self.nc,
                len,
                law,
                holds,
                kept: RowSet::all(len),
                ends,
                switch: None,
                held: None,
                driven: (len > 0 || in_tree) && (motors > 0 || places.clone().any(moving)),
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
            self.lines.push(LineSlots {
                ends,
                effective,
                slackens: line.kind.is_unilateral(),
                detachable: scene.is_detachable(Detachable::Line(index)),
                detached: scene.starts.detached.contains(&Detachable::Line(index)),
            });
        }
    }

    fn place_loads(&mut self, scene: &Scene) {
        for load in &scene.loads {
            if let Some(node) = self.node_at(load.at) {
                self.nodes[node].loaded = true;
            }
        }
        let mut next = 6 * self.anchors.len() + 3 * self.nodes.len();
        for node in &mut self.nodes {
            let moves = |load: &Load| {
                let own = load.at == Place::Point(node.point);
                matches!(&load.kind, LoadKind::Force(force) if own && scene.has_load_rate(force))
            };
            if node.model == NodeModel::Rate && scene.loads.iter().any(moves) {
                node.load_rate = Some(next);
                next += 3;
            }
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

    /// The velocities of nodes whose lines are damped by differences.
    fn place_velocities(&mut self, scene: &Scene) {
        self.effective_numbers = 2 * self.effective_lines;
        let is_damped = |&line: &usize| {
            let declared = scene.lines.get(line);
            declared.is_some_and(|line| !scene.is_zero(&line.damping))
        };
        for node in &mut self.nodes {
            let lines = self.networks.get(node.network).map(|it| &it.lines);
            let damped = lines.is_some_and(|lines| lines.iter().any(is_damped));
            if damped && matches!(node.model, NodeModel::Stepwise { .. }) {
                node.velocity = Some(self.effective_numbers);
                self.effective_numbers += 3;
            }
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
}
