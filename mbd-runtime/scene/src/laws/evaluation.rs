//! One evaluation: the scene at a state, seen by every law and every formula.

use std::sync::OnceLock;

use nalgebra::{Matrix3, Vector3};

use crate::laws::body::BodyMotion;
use crate::laws::energy;
use crate::laws::formula::{self, Context, Value, of_let};
use crate::laws::line;
use crate::laws::node;
use crate::laws::numbers::{FrameNumbers, Numbers};
use crate::laws::origin::Origin;
use crate::layout::Slots;
use crate::scalar::algebra::{labelled, vector, write};
use crate::tree::LinkMotion;
use crate::{
    AngularVelocity, At, Formula, FrameMotion, InputSource, Layout, NodeModel, Part, Place,
    PointSlots, Real, Scene,
};

/// The scene at a state. Bodies are read once; everything else is computed where it is asked for.
pub struct Evaluation<'a, S: Real> {
    pub scene: &'a Scene,
    pub layout: &'a Layout,
    pub numbers: &'a Numbers<S>,
    pub at: &'a At<'a, S>,
    pub motions: &'a [BodyMotion<S>],
    /// The links of the tree; empty in absolute coordinates.
    pub(crate) links: &'a [LinkMotion<S>],
    /// Per frame of the world its motion, if it moves.
    pub ground: &'a [Option<FrameMotion<S>>],
    /// Per static or stepwise network the velocities of its nodes, once something asks for them.
    pub networks: &'a [OnceLock<Vec<Vector3<S>>>],
    /// Per `let` its value, once something asks for it; empty where nothing asks twice.
    pub lets: &'a [OnceLock<Value<S>>],
    /// The multipliers, where something asks for the effort of a motor; empty elsewhere.
    pub multipliers: &'a [S],
    /// Force and torque of every joint on its child, where something asks for them; empty elsewhere, and where no joint has rows.
    pub reactions: &'a [S],
    /// v̇, where something asks for accelerations; empty elsewhere.
    pub accelerations: &'a [S],
    /// In relative coordinates those of every body, linear in world axes and angular in the components of the state; empty elsewhere.
    pub body_accelerations: &'a [[Vector3<S>; 2]],
    /// Per line its pull and its tension, where these were found with the velocity of its node; empty elsewhere.
    pub balanced: &'a [Option<[S; 2]>],
    /// The origin that positions and velocities are measured from; `None`: that of the world.
    pub origin: Option<Origin<S>>,
}

/// A line in motion.
#[derive(Clone, Copy, Debug)]
pub struct LineMotion<S: Real> {
    pub geometry: line::Geometry<S>,
    /// Rate of its length [m/s].
    pub rate: S,
    /// Tension [N].
    pub tension: S,
    /// f(s) + C ṡ, or K_e (d − L_e) for a line of a static or stepwise node [N].
    pub pull: S,
    /// Stiffness of the law that gave the tension.
    pub tangent: line::Tangent<S>,
}

impl<'a, S: Real> Evaluation<'a, S> {
    /// A position in the world, from one that is measured from the origin [m].
    pub fn in_world(&self, position: Vector3<S>) -> Vector3<S> {
        self.origin
            .map_or(position, |origin| origin.position + position)
    }

    /// A velocity in the world, from one that is measured from the origin [m/s].
    pub fn rate_in_world(&self, velocity: Vector3<S>) -> Vector3<S> {
        self.origin
            .map_or(velocity, |origin| origin.velocity + velocity)
    }

    /// A position from the origin, from one in the world [m].
    pub fn position_from_origin(&self, position: Vector3<S>) -> Vector3<S> {
        self.origin
            .map_or(position, |origin| position - origin.position)
    }

    /// A velocity against the origin, from one in the world [m/s].
    pub fn velocity_from_origin(&self, velocity: Vector3<S>) -> Vector3<S> {
        self.origin
            .map_or(velocity, |origin| velocity - origin.velocity)
    }

    /// Position of a frame of the world in it [m].
    fn ground_position(&self, frame: usize) -> Option<Vector3<S>> {
        match self.moving(frame) {
            Some(motion) => Some(motion.position),
            None => Some(self.numbers.world_frames.get(frame)?.position),
        }
    }

    /// Velocity of a frame of the world in it [m/s].
    fn ground_velocity(&self, frame: usize) -> Vector3<S> {
        self.moving(frame)
            .map_or_else(Vector3::zeros, |motion| motion.velocity)
    }

    /// Position of a place from the origin [m], world axes.
    pub fn position_of(&self, place: Place) -> Option<Vector3<S>> {
        match place {
            Place::World(frame) => Some(self.position_from_origin(self.ground_position(frame)?)),
            Place::Body(body, frame) => {
                let (motion, frame) = self.frame(body, frame)?;
                let place = motion.position + motion.arm(&frame.position);
                Some(labelled(place, ["p_x", "p_y", "p_z"]))
            }
            Place::Point(point) => match *self.layout.points.get(point)? {
                PointSlots::Mass(slots) => {
                    Some(self.layout.directions.linear(self.at.state, slots.q))
                }
                PointSlots::Node(node) => Some(self.node_position(node)),
            },
        }
    }

    /// Velocity of a place against the origin [m/s], world axes. The velocity of a node without damping is Σ H⁻¹ J_i v_i.
    pub fn velocity_of(&self, place: Place) -> Option<Vector3<S>> {
        match place {
            Place::World(frame) => Some(self.velocity_from_origin(self.ground_velocity(frame))),
            Place::Body(body, frame) => {
                let (motion, frame) = self.frame(body, frame)?;
                Some(motion.velocity_of(&frame.position))
            }
            Place::Point(point) => match *self.layout.points.get(point)? {
                PointSlots::Mass(slots) => {
                    let at = self.layout.nq + slots.v;
                    Some(self.layout.directions.linear(self.at.state, at))
                }
                PointSlots::Node(node) => self.node_velocity(node),
            },
        }
    }

    /// Rate of the velocity of a place [m/s²], world axes: a + ω̇ × r + ω × (ω × r). A node has none.
    pub fn acceleration_of(&self, place: Place) -> Option<Vector3<S>> {
        match place {
            Place::World(frame) => Some(match self.moving(frame) {
                Some(motion) => motion.acceleration,
                None => Vector3::zeros(),
            }),
            Place::Body(body, frame) => {
                let [linear, spin] = self.acceleration_of_part(Part::Body(body))?;
                if frame == 0 {
                    return Some(linear);
                }
                let spin = self.spin_in_world(body, &spin)?;
                let (motion, frame) = self.frame(body, frame)?;
                let (arm, omega) = (motion.arm(&frame.position), motion.omega_world);
                Some(linear + spin.cross(&arm) + omega.cross(&omega.cross(&arm)))
            }
            Place::Point(point) => {
                let [linear, _] = self.acceleration_of_part(Part::Point(point))?;
                Some(linear)
            }
        }
    }

    /// v̇ of a body or a point with mass: linear in world axes, angular in the components of the state.
    fn acceleration_of_part(&self, part: Part) -> Option<[Vector3<S>; 2]> {
        let (directions, all) = (self.layout.directions, self.accelerations);
        if all.len() != self.layout.nv {
            return None;
        }
        match part {
            Part::Body(body) => {
                if self.layout.tree.is_some() {
                    return self.body_accelerations.get(body).copied();
                }
                let at = (*self.layout.bodies.get(body)?)?.v;
                Some([directions.linear(all, at), directions.angular(all, at)])
            }
            Part::Point(point) => match *self.layout.points.get(point)? {
                PointSlots::Mass(slots) => {
                    Some([directions.linear(all, slots.v), Vector3::zeros()])
                }
                PointSlots::Node(_) => None,
            },
            Part::Joint(_) | Part::Coordinates(_) => None,
        }
    }

    /// The place in the state of a coordinate of a joint of the tree, and of its rate.
    pub(crate) fn carried(&self, joint: usize, index: usize) -> Option<[usize; 2]> {
        let link = self.layout.carried(joint)?;
        Some([link.slots.q + index, self.layout.nq + link.slots.v + index])
    }

    /// ω̇ of a body in world axes from that in the components of the state: d(R ω)/dt = R ω̇.
    fn spin_in_world(&self, body: usize, spin: &Vector3<S>) -> Option<Vector3<S>> {
        Some(match self.scene.angular_velocity {
            AngularVelocity::Body => self.motions.get(body)?.rotation * spin,
            AngularVelocity::World => *spin,
        })
    }

    /// The motion of a frame of the world, if it moves.
    pub fn moving(&self, frame: usize) -> Option<&FrameMotion<S>> {
        self.ground.get(frame)?.as_ref()
    }

    /// Position of a node [m].
    pub fn node_position(&self, node: usize) -> Vector3<S> {
        self.layout
            .node_position(node, self.at.state, self.at.nodes)
    }

    fn node_velocity(&self, node: usize) -> Option<Vector3<S>> {
        let declared = self.layout.nodes.get(node)?;
        if declared.model == NodeModel::Rate {
            return Some(vector(self.at.nodes, 3 * node));
        }
        if let Some(at) = declared.velocity {
            return Some(vector(self.at.effective, at));
        }
        let velocities = self.networks.get(declared.network)?;
        let velocities = velocities.get_or_init(|| node::velocities(self, declared.network));
        velocities.get(declared.local).copied()
    }

    fn frame(&self, body: usize, frame: usize) -> Option<(&BodyMotion<S>, &FrameNumbers<S>)> {
        Some((
            self.motions.get(body)?,
            self.numbers.bodies.get(body)?.frames.get(frame)?,
        ))
    }

    /// A line with its law and its constants.
    pub fn element(&self, index: usize) -> Option<line::Element<'_, S>> {
        let declared = self.scene.lines.get(index)?;
        let mut numbers = *self.numbers.lines.get(index)?;
        if let Some(length) = self.wound(index) {
            numbers.free_length = length;
        }
        Some(line::Element {
            kind: declared.kind,
            tables: &self.scene.tables,
            numbers,
            damped: !self.scene.is_zero(&declared.damping),
        })
    }

    /// From the `from` end of a line to its `to` end [m].
    fn between_ends(&self, index: usize) -> Option<Vector3<S>> {
        let declared = self.scene.lines.get(index)?;
        S::section(&declared.name);
        let vector = self.position_of(declared.to)? - self.position_of(declared.from)?;
        S::section(&declared.name);
        Some(vector)
    }

    /// Length, rate and tension of a line at this state.
    pub fn line_motion(&self, index: usize) -> Option<LineMotion<S>> {
        let slots = self.layout.lines.get(index)?;
        let vector = self.between_ends(index)?;
        if let Some(effective) = slots.effective {
            let read = |item: usize| self.at.effective.get(2 * effective + item).copied();
            let (stiffness, free_length) = (read(0)?, read(1)?);
            let geometry = line::geometry(&vector, free_length);
            let pull = (stiffness * geometry.stretch).label("pull");
            let tension = line::effective_tension(stiffness, geometry.stretch);
            return Some(LineMotion {
                geometry,
                rate: S::zero(),
                tension,
                pull,
                tangent: line::Tangent::linear(stiffness, free_length),
            });
        }
        let element = self.element(index)?;
        let geometry = line::geometry(&vector, element.numbers.free_length);
        let rate = if element.damped {
            self.rate(index, &geometry.direction)?
        } else {
            S::zero()
        };
        let winding = match element.damped {
            true => self.rate_of_winding(index),
            false => None,
        };
        let stretching = winding.map_or(rate, |winding| rate - winding);
        let hold = self.at.hold.get(index).copied()?;
        let balanced = self.balanced.get(index).copied().flatten();
        let [pull, tension] = balanced.unwrap_or_else(|| {
            let pull = element.pull(geometry.stretch, stretching);
            [pull, element.tension_of(pull, geometry.stretch, hold)]
        });
        let tangent = element.tangent(geometry.stretch);
        Some(LineMotion {
            geometry,
            rate,
            tension: self.where_attached(index, tension),
            pull,
            tangent: line::Tangent {
                slope: self.where_attached(index, tangent.slope),
                secant: self.where_attached(index, tangent.secant),
                ..tangent
            },
        })
    }

    /// A number of a line or a spring; zero while it is detached.
    pub fn where_attached(&self, line: usize, number: S) -> S {
        let slots = self.layout.lines.get(line);
        let switch = slots.filter(|slots| slots.detachable).map(|_| line);
        self.unless_detached(switch, number)
    }

    /// The same of a joint.
    pub fn where_joined(&self, joint: usize, number: S) -> S {
        let slots = self.layout.joints.get(joint);
        self.unless_detached(slots.and_then(|slots| slots.switch), number)
    }

    /// A number of what has a place in the holds; zero while that says that it is detached.
    fn unless_detached(&self, switch: Option<usize>, number: S) -> S {
        match switch.and_then(|at| self.at.hold.get(at).copied()) {
            Some(hold) => {
                // Half way between what is slack and what is not there.
                let detached = hold.lt(S::from_f64(0.5 * (line::DETACHED - 1.0)));
                S::select(detached, S::zero(), number)
            }
            None => number,
        }
    }

    /// 1 while a joint holds, 0 while it is detached; `None` of one that is never detached.
    pub fn joined(&self, joint: usize) -> Option<S> {
        self.layout.joints.get(joint)?.switch?;
        Some(self.where_joined(joint, S::one()).label("joined"))
    }

    /// Writes q̇ = N(q) v of a body.
    pub fn write_body_rate(&self, body: usize, slots: Slots, out: &mut [S]) {
        let (directions, motion) = (self.layout.directions, &self.motions[body]);
        directions.write_linear(out, slots.q, &motion.velocity);
        let attitude = slots.q + directions.translations().len();
        let components = self.scene.angular_velocity;
        motion.write_attitude_rate(out, attitude, directions, components);
    }

    /// Writes q̇ = v of a point with mass.
    pub fn write_point_rate(&self, slots: Slots, out: &mut [S]) {
        let directions = self.layout.directions;
        let velocity: Vector3<S> = directions.linear(self.at.state, self.layout.nq + slots.v);
        directions.write_linear(out, slots.q, &velocity);
    }

    /// Writes ż, the velocities of the `rate` nodes, and ṡ of the states that the scene declares.
    pub fn write_other_rates(&self, out: &mut [S]) {
        let first = self.layout.nq + self.layout.nv;
        for (index, node) in self.layout.nodes.iter().enumerate() {
            if let Some(z) = node.z {
                write(out, first + z, &vector(self.at.nodes, 3 * index));
            }
        }
        let first = self.layout.states();
        for (slot, state) in out.iter_mut().skip(first).zip(&self.scene.states) {
            S::section(&state.name);
            *slot = formula::scalar(&state.rate, self);
        }
    }

    /// Rate of a line's length [m/s].
    pub fn rate(&self, index: usize, direction: &Vector3<S>) -> Option<S> {
        let declared = self.scene.lines.get(index)?;
        let velocity = self.velocity_of(declared.to)? - self.velocity_of(declared.from)?;
        S::section(&declared.name);
        Some(direction.dot(&velocity).label("rate"))
    }

    /// Three input numbers of a source; zero where the scene has none.
    pub fn input(&self, source: InputSource, offset: usize) -> Vector3<S> {
        match self.layout.input_at(source) {
            Some(at) => vector(self.at.inputs, at + offset),
            None => Vector3::zeros(),
        }
    }
}

/// A declared input, `number` one of those of all by its place.
pub(super) fn declared_input<S: Real>(
    (scene, layout): (&Scene, &Layout),
    index: usize,
    number: impl Fn(usize) -> Option<S>,
) -> Option<Value<S>> {
    let at = layout.input_at(InputSource::Input(index))?;
    Some(match scene.inputs.get(index)?.components {
        1 => Value::Scalar(number(at)?),
        _ => Value::Vector(Vector3::new(number(at)?, number(at + 1)?, number(at + 2)?)),
    })
}

impl<S: Real> Context<S> for Evaluation<'_, S> {
    fn scene(&self) -> &Scene {
        self.scene
    }

    fn param(&self, index: usize) -> Option<S> {
        self.numbers.params.get(index).copied()
    }

    fn named(&self, index: usize) -> Option<Value<S>> {
        let declared = self.scene.lets.get(index)?;
        let kept = self.lets.get(index);
        if let Some(value) = kept.and_then(OnceLock::get) {
            return Some(*value);
        }
        S::section(&declared.name);
        let value = match of_let(index, self)? {
            Value::Scalar(a) => Value::Scalar(a.label("value")),
            Value::Vector(a) => Value::Vector(labelled(a, ["x", "y", "z"])),
        };
        Some(kept.map_or(value, |kept| *kept.get_or_init(|| value)))
    }

    fn input(&self, index: usize) -> Option<Value<S>> {
        let inputs = self.at.inputs;
        declared_input((self.scene, self.layout), index, |at| {
            inputs.get(at).copied()
        })
    }

    fn state(&self, index: usize) -> Option<S> {
        self.at.state.get(self.layout.states() + index).copied()
    }

    fn time(&self) -> Option<S> {
        Some(self.at.time)
    }

    fn position(&self, place: Place) -> Option<Vector3<S>> {
        match place {
            Place::World(frame) => self.ground_position(frame),
            _ => Some(self.in_world(self.position_of(place)?)),
        }
    }

    fn velocity(&self, place: Place) -> Option<Vector3<S>> {
        match place {
            Place::World(frame) => Some(self.ground_velocity(frame)),
            _ => Some(self.rate_in_world(self.velocity_of(place)?)),
        }
    }

    fn apart(&self, [a, b]: [&Formula; 2]) -> Option<Value<S>> {
        self.origin?;
        match [a, b].map(|formula| self.scene.said(formula)) {
            [Formula::Position(a), Formula::Position(b)] => {
                Some(Value::Vector(self.position_of(*a)? - self.position_of(*b)?))
            }
            [Formula::Velocity(a), Formula::Velocity(b)] => {
                Some(Value::Vector(self.velocity_of(*a)? - self.velocity_of(*b)?))
            }
            [Formula::Component(a, i), Formula::Component(b, j)] if i == j => {
                match self.apart([a.first()?, b.first()?])? {
                    Value::Vector(apart) => Some(Value::Scalar(*apart.get(*i)?)),
                    Value::Scalar(_) => None,
                }
            }
            _ => None,
        }
    }

    fn axis(&self, place: Place, axis: usize) -> Option<Vector3<S>> {
        if axis > 2 {
            return None;
        }
        let unit = Vector3::from_fn(|i, _| if i == axis { S::one() } else { S::zero() });
        let of = |rotation: Option<Matrix3<S>>| {
            rotation.map_or(unit, |rotation| rotation.column(axis).into_owned())
        };
        match place {
            Place::World(frame) => Some(match self.moving(frame) {
                Some(motion) => of(motion.rotation),
                None => of(self.numbers.world_frames.get(frame)?.rotation),
            }),
            Place::Body(body, frame) => {
                let (motion, frame) = self.frame(body, frame)?;
                Some(motion.rotation * of(frame.rotation))
            }
            Place::Point(_) => None,
        }
    }

    fn omega_world(&self, body: usize) -> Option<Vector3<S>> {
        self.motions.get(body).map(|motion| motion.omega_world)
    }

    fn omega_body(&self, body: usize) -> Option<Vector3<S>> {
        self.motions.get(body).map(|motion| motion.omega_body)
    }

    fn orientation(&self, body: usize) -> Option<Vector3<S>> {
        let motion = self.motions.get(body)?;
        Some(motion.orientation(self.layout.directions))
    }

    fn energies(&self) -> Option<[S; 2]> {
        let mut all = [S::zero(); 6];
        energy::energy(self, S::zero(), &mut all);
        let [kinetic, gravity, elastic, ..] = all;
        Some([kinetic, gravity + elastic])
    }

    fn coordinate(&self, joint: usize, index: usize) -> Option<S> {
        if let Some([value, _]) = self.carried(joint, index) {
            return self.at.state.get(value).copied();
        }
        let (declared, coordinate) = self.scene.coordinate(joint, index)?;
        S::section(&declared.name);
        let ends = self.ends(joint, AngularVelocity::Body)?;
        Some(self.with_turns(joint, index, ends.value(&coordinate)))
    }

    fn motor_effort(&self, joint: usize, index: usize) -> Option<S> {
        let (declared, slots) = (
            self.scene.joints.get(joint)?,
            self.layout.joints.get(joint)?,
        );
        let motor = declared.motors().position(|(driven, _)| driven == index)?;
        let row = slots.row + slots.law.len() + motor;
        self.multipliers.get(row).copied()
    }

    fn acceleration(&self, place: Place) -> Option<Vector3<S>> {
        self.acceleration_of(place)
    }

    fn angular_acceleration(&self, body: usize) -> Option<Vector3<S>> {
        let [_, spin] = self.acceleration_of_part(Part::Body(body))?;
        self.spin_in_world(body, &spin)
    }

    fn coordinate_acceleration(&self, joint: usize, index: usize) -> Option<S> {
        if let Some([_, rate]) = self.carried(joint, index) {
            // For no accelerations at all what velocities alone do, as of other joints: nothing.
            return match self.accelerations {
                [] => Some(S::zero()),
                all => all.get(rate - self.layout.nq).copied(),
            };
        }
        let (declared, coordinate) = self.scene.coordinate(joint, index)?;
        S::section(&declared.name);
        let ends = self.ends(joint, self.scene.angular_velocity)?;
        let row = ends.second_rate(&coordinate);
        let slots = self.layout.joints.get(joint)?;
        let rates = row
            .whole()
            .parts(&slots.ends)
            .filter_map(|(part, columns)| {
                let accelerations = self.acceleration_of_part(part)?;
                Some(columns.rate(&accelerations))
            });
        let rate = rates.reduce(|sum, rate| sum + rate);
        Some(rate.map_or(-row.bias, |rate| rate - row.bias))
    }

    fn reaction(&self, joint: usize) -> Option<[Vector3<S>; 2]> {
        self.scene.joints.get(joint)?;
        // Where nobody asked nothing is at hand.
        Some(match self.reactions.get(6 * joint..6 * joint + 6) {
            Some(own) => [vector(own, 0), vector(own, 3)],
            None => [Vector3::zeros(); 2],
        })
    }

    fn coordinate_rate(&self, joint: usize, index: usize) -> Option<S> {
        if let Some([_, rate]) = self.carried(joint, index) {
            return self.at.state.get(rate).copied();
        }
        let (declared, coordinate) = self.scene.coordinate(joint, index)?;
        S::section(&declared.name);
        let ends = self.ends(joint, AngularVelocity::Body)?;
        Some(ends.rate(&coordinate))
    }

    fn line_length(&self, index: usize) -> Option<[S; 2]> {
        let vector = self.between_ends(index)?;
        let free_length = self.element(index)?.numbers.free_length;
        let geometry = line::geometry(&vector, free_length);
        Some([geometry.length, geometry.stretch])
    }

    fn line(&self, index: usize) -> Option<[S; 4]> {
        let motion = self.line_motion(index)?;
        let element = self.element(index)?;
        // A static or stepwise node has no rate of its own; the rate is that of the moving balance.
        let located = self.layout.lines.get(index)?.effective.is_none();
        let located = located && element.kind.is_unilateral();
        let rate = match located && element.damped {
            true => motion.rate,
            false => self.rate(index, &motion.geometry.direction)?,
        };
        let [length, stretch] = self.line_length(index)?;
        // A mode lasts until its switch is located, where the pull has passed zero by the tolerance of that.
        let tension = match located {
            true => motion.tension.max(S::zero()),
            false => motion.tension,
        };
        Some([tension, length, stretch, rate])
    }

    fn winding(&self, index: usize) -> Option<S> {
        self.rate_of_winding(index)
    }
}
