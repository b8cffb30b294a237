//! What is asked of a scene: of its joints, its events and its formulas, with what their `let`s stand for.

use super::{Coordinates, Joint, Line, LoadKind, NodeModel, PointKind, Scene};
use crate::event::{Detachable, Event, Settable};
use crate::joints::{Fold, JointForces, JointLaw, Side};
use crate::{Ambiguous, Coordinate, Directions, Formula, Function, Layout, Part, Place, Plane};

impl Scene {
    /// The same scene in a family of coordinates.
    #[must_use]
    pub fn in_coordinates(&self, coordinates: Coordinates) -> Self {
        Scene {
            coordinates,
            ..self.clone()
        }
    }

    /// Whether a body may be without mass or moments of its own: its joints have the inertia of what it carries.
    #[must_use]
    pub fn is_carried(&self, body: usize) -> bool {
        self.coordinates == Coordinates::Relative && self.unchecked.contains(&body)
    }

    /// The name of a line.
    pub(crate) fn line_name(&self, line: usize) -> &str {
        let line = self.lines.get(line);
        line.map_or("line", |line| line.name.as_str())
    }

    /// A joint and its measurable coordinate number `index`; `None` if there is no such joint or coordinate.
    #[must_use]
    pub fn coordinate(&self, joint: usize, index: usize) -> Option<(&Joint, Coordinate)> {
        let joint = self.joints.get(joint)?;
        Some((joint, joint.law.coordinate(index)?))
    }

    /// What a coupling leads from and to, as a declaration names it: `motor.angle`, `wheel.angle`; `None` of a joint between two places.
    #[must_use]
    pub fn coupled(&self, joint: &Joint) -> Option<[String; 2]> {
        let &[to, from] = joint.law.couples() else {
            return None;
        };
        let name = |(of, index): (usize, usize)| {
            let (joint, coordinate) = self.coordinate(of, index)?;
            Some(format!("{}.{}", joint.name, coordinate.name))
        };
        Some([name(from)?, name(to)?])
    }

    /// Whether anything but motion, gravity and springs gives or takes energy: loads, dampers, friction, motors, winches, frames that move.
    #[must_use]
    pub fn exchanges_energy(&self) -> bool {
        let acts = |forces: &JointForces| {
            let springs_apart = [
                &forces.damping,
                &forces.friction,
                &forces.stop_damping,
                &forces.force,
                &forces.motor,
            ];
            springs_apart.iter().any(|field| field.is_some())
        };
        let gives = |line: &Line| !self.is_zero(&line.damping) || line.is_wound(self);
        !self.loads.is_empty()
            || self.lines.iter().any(gives)
            || self.joints.iter().flat_map(|joint| &joint.forces).any(acts)
            || self.world_frames.iter().any(|frame| frame.moves(self))
    }

    /// The formulas of what accelerates and of the rates of declared states: loads, what acts along joints, free lengths.
    pub fn acting_formulas(&self) -> impl Iterator<Item = &Formula> {
        let loads = self.loads.iter().filter_map(|load| load.kind.formula());
        let joints = self.joints.iter().flat_map(|joint| &joint.forces);
        let joints = joints.flat_map(JointForces::formulas);
        let lines = self.lines.iter().map(|line| &line.free_length);
        let states = self.states.iter().map(|state| &state.rate);
        loads.chain(joints).chain(lines).chain(states)
    }

    /// Whether something that acts chooses between values by what moves: it may jump where the motion stays.
    #[must_use]
    pub fn jumps_with_motion(&self) -> bool {
        let chooses = |part: &Formula| match part {
            Formula::Apply(Function::IfLess | Function::IfAtMost, parts) => {
                let mut compared = parts.iter().take(2);
                compared.any(|part| !self.is_of_time(part))
            }
            _ => false,
        };
        self.acting_formulas().any(|it| self.contains(it, chooses))
    }

    /// The names of what acts or drives and changes with time by itself: loads, joints, lines, declared states, frames of the world.
    #[must_use]
    pub fn changing_with_time(&self) -> Vec<String> {
        let changes = |formula: &Formula| self.depends_on_time(formula);
        let loads = self.loads.iter();
        let loads = loads.filter(|load| load.kind.formula().is_some_and(changes));
        let joints = self.joints.iter().filter(|joint| {
            let mut formulas = joint.forces.iter().flat_map(JointForces::formulas);
            formulas.any(changes)
        });
        let lines = self.lines.iter().filter(|line| changes(&line.free_length));
        let states = self.states.iter().filter(|state| changes(&state.rate));
        let frames = self.world_frames.iter().filter(|frame| frame.moves(self));
        let names = loads.map(|it| it.name.clone());
        let names = names.chain(joints.map(|it| it.name.clone()));
        let names = names.chain(lines.map(|it| it.name.clone()));
        let names = names.chain(states.map(|it| it.name.clone()));
        names
            .chain(frames.map(|it| format!("world.{}", it.name)))
            .collect()
    }

    /// Whether a motor is where inputs tell it to be.
    #[must_use]
    pub fn motors_follow_inputs(&self) -> bool {
        let mut motors = self.joints.iter().flat_map(Joint::motors);
        motors.any(|(_, course)| self.starts_by_inputs(course))
    }

    /// Whether what a motor follows begins where inputs tell it to.
    pub(crate) fn starts_by_inputs(&self, course: &Formula) -> bool {
        let input = |part: &Formula| matches!(part, Formula::Input(_));
        // Value, rate and acceleration: the last of a filter follows an input, and is no start.
        let started = match course {
            Formula::Vector(parts) => parts.get(..2).unwrap_or(parts),
            whole => std::slice::from_ref(whole),
        };
        started.iter().any(|part| self.contains(part, input))
    }

    /// The joint coordinates whose motors are told value, rate and acceleration without a filter between, with what they are told: joint, number of the
    /// coordinate.
    pub fn commanded(&self) -> impl Iterator<Item = ([usize; 2], &[Formula])> + '_ {
        let joints = self.joints.iter().enumerate();
        joints.flat_map(|(joint, declared)| {
            declared
                .forces
                .iter()
                .filter_map(move |forces| match (&forces.motor, &forces.filter) {
                    (Some(Formula::Vector(parts)), None) => {
                        Some(([joint, forces.coordinate], parts.as_slice()))
                    }
                    _ => None,
                })
        })
    }

    /// The lines whose rate is said beside their free length, with both.
    pub fn commanded_lines(&self) -> impl Iterator<Item = (usize, &[Formula])> + '_ {
        let lines = self.lines.iter().enumerate();
        lines.filter_map(|(index, line)| match &line.free_length {
            Formula::Vector(parts) => Some((index, parts.as_slice())),
            _ => None,
        })
    }

    /// Whether the rate of a formula of inputs, states and time follows from the declaration: without inputs, whose rates only the caller knows, and
    /// without tables, whose rows are rounded.
    #[must_use]
    pub fn tells_rate(&self, formula: &Formula) -> bool {
        let untold = |part: &Formula| matches!(part, Formula::Input(_) | Formula::Lookup(..));
        !self.contains(formula, untold)
    }

    /// Whether a place is an equilibrium point.
    #[must_use]
    pub fn is_node(&self, place: Place) -> bool {
        let Place::Point(point) = place else {
            return false;
        };
        let point = self.points.get(point);
        point.is_some_and(|point| matches!(point.kind, PointKind::Node(_)))
    }

    /// Whether the rate of a load on an equilibrium point follows from the state and the time: of a formula of places, coordinates, time, inputs, which
    /// count as held, and of declared states whose own rates do not ask for it.
    #[must_use]
    pub fn tells_load_rate(&self, formula: &Formula) -> bool {
        use Formula::{Apply, Component, Const, Coordinate, Input, Let, Lookup, Number, Param};
        use Formula::{Position, State, StretchRate, Time, Vector, Velocity};
        let asks = |part: &Formula| match part {
            Velocity(place) => self.is_node(*place),
            StretchRate(line) => self
                .lines
                .get(*line)
                .is_some_and(|line| self.is_node(line.from) || self.is_node(line.to)),
            _ => false,
        };
        let told = |part: &Formula| match part {
            Number(_) | Const(_) | Param(_) | Input(_) | Time => true,
            Let(_) | Vector(_) | Component(..) | Apply(..) | Lookup(..) => true,
            Position(_) | Coordinate(..) => true,
            State(state) => {
                let declared = self.states.get(*state);
                declared.is_some_and(|state| !self.contains(&state.rate, asks))
            }
            _ => false,
        };
        !self.contains(formula, |part| !told(part))
    }

    /// Whether a load on an equilibrium point has such a rate that is not zero throughout.
    #[must_use]
    pub fn has_load_rate(&self, formula: &Formula) -> bool {
        use Formula::{Coordinate, Position, State, Time};
        let moves = |part: &Formula| matches!(part, Time | State(_) | Position(_) | Coordinate(..));
        self.tells_load_rate(formula) && self.contains(formula, moves)
    }

    /// Whether nothing but time changes a formula during a run.
    #[must_use]
    pub fn is_of_time(&self, formula: &Formula) -> bool {
        self.is_of_time_and_states(formula)
            && !self.contains(formula, |part| matches!(part, Formula::State(_)))
    }

    /// Whether nothing but time and declared states changes a formula during a run.
    #[must_use]
    pub fn is_of_time_and_states(&self, formula: &Formula) -> bool {
        use Formula::{Apply, Component, Const, Let, Lookup, Number, Param, State, Time, Vector};
        let known = |part: &Formula| {
            let leaf = matches!(part, Number(_) | Const(_) | Param(_) | State(_) | Time);
            leaf || matches!(
                part,
                Let(_) | Vector(_) | Component(..) | Apply(..) | Lookup(..)
            )
        };
        !self.contains(formula, |part| !known(part))
    }

    /// The joints whose reactions a formula asks for and that are not unique, because rows of joints repeat each other there, with the components of
    /// these that it asks for and that are not: three of the force, three of the torque. Of a vector one component can be asked for.
    #[must_use]
    pub fn ambiguous_reactions(
        &self,
        layout: &Layout,
        formula: &Formula,
        component: Option<usize>,
    ) -> Vec<Ambiguous> {
        let mut found = Vec::new();
        let mut named = Vec::new();
        self.walk_reactions(formula, component, &mut named, &mut |joint, asked| {
            let ambiguous = layout.redundancy.ambiguous_components(joint);
            let both = std::array::from_fn(|k| ambiguous[k] && asked[k]);
            if both.contains(&true) {
                Ambiguous::add(&mut found, joint, both);
            }
        });
        found
    }

    /// The first joint of which an output or an event asks for parts of the reaction that are no motion's in a plane: the force along the normal, the
    /// torque about other axes.
    #[must_use]
    pub fn reaction_across(&self, plane: Plane) -> Option<usize> {
        let mut found = None;
        let normal = plane.normal();
        let outputs = self.outputs.iter().map(|output| &output.value);
        let guards = self.events.iter().map(|event| &event.guard);
        let settings = self.events.iter().flat_map(|event| &event.actions.set);
        let formulas = outputs
            .chain(guards)
            .chain(settings.map(|setting| &setting.value));
        for formula in formulas {
            self.walk_reactions(formula, None, &mut Vec::new(), &mut |joint, asked| {
                let is_across = |k: usize| (k % 3 == normal) == (k < 3);
                if (0..6).any(|k| asked[k] && is_across(k)) {
                    found = found.or(Some(joint));
                }
            });
        }
        found
    }

    /// Calls `visit` with every reaction in a formula and which of its six components count; `named`: the lets that have been looked at.
    fn walk_reactions(
        &self,
        formula: &Formula,
        component: Option<usize>,
        named: &mut Vec<(usize, Option<usize>)>,
        visit: &mut impl FnMut(usize, [bool; 6]),
    ) {
        use Function::{Add, Div, IfAtMost, IfLess, Mul, Neg, Sub};
        let of = |first: usize| {
            std::array::from_fn(|k| k / 3 == first && component.is_none_or(|c| k % 3 == c))
        };
        match formula {
            Formula::ReactionForce(joint) => visit(*joint, of(0)),
            Formula::ReactionTorque(joint) => visit(*joint, of(1)),
            Formula::Component(parts, index) => {
                for part in parts {
                    self.walk_reactions(part, Some(*index), named, visit);
                }
            }
            Formula::Vector(parts) => {
                let asked = |index: usize| component.is_none_or(|c| c == index);
                for (_, part) in parts.iter().enumerate().filter(|(index, _)| asked(*index)) {
                    self.walk_reactions(part, None, named, visit);
                }
            }
            Formula::Let(index) if !named.contains(&(*index, component)) => {
                named.push((*index, component));
                if let Some(declared) = self.lets.get(*index) {
                    self.walk_reactions(&declared.value, component, named, visit);
                }
            }
            Formula::Apply(function, parts) => {
                // These work on each component by itself.
                let apart = matches!(function, Add | Sub | Mul | Div | Neg | IfLess | IfAtMost);
                let component = component.filter(|_| apart);
                for part in parts {
                    self.walk_reactions(part, component, named, visit);
                }
            }
            Formula::Lookup(_, parts) => {
                for part in parts {
                    self.walk_reactions(part, None, named, visit);
                }
            }
            _ => (),
        }
    }

    /// Whether the work of loads on equilibrium points is told: these have a velocity of their own, or the loads change with time alone.
    #[must_use]
    pub fn tells_node_work(&self) -> bool {
        self.loads.iter().all(|load| {
            let Place::Point(point) = load.at else {
                return true;
            };
            let without_rate = self.points.get(point).is_some_and(
                |point| matches!(&point.kind, PointKind::Node(model) if *model != NodeModel::Rate),
            );
            match &load.kind {
                LoadKind::Force(force) if without_rate => self.is_of_time(force),
                _ => !without_rate,
            }
        })
    }

    /// The places at which a joint sits: its parent and its child, and of a coupling those of the other joints that it couples.
    pub fn ends<'a>(&'a self, joint: &'a Joint) -> impl Iterator<Item = Place> + Clone + 'a {
        let others = joint.law.couples().iter().skip(1);
        let others = others.filter_map(|&(of, _)| self.joints.get(of));
        let joints = std::iter::once(joint).chain(others);
        joints.flat_map(|joint| [joint.parent, joint.child])
    }

    /// The axes along which things move and about which bodies turn.
    #[must_use]
    pub fn directions(&self) -> Directions {
        Directions { plane: self.planar }
    }

    /// Every stop: joint, its entry of [`Joint::along`], side; in the order of their numbers.
    pub fn stops(&self) -> impl Iterator<Item = (usize, &JointForces, Side)> {
        let entries = self.joints.iter().enumerate();
        let entries = entries.flat_map(|(joint, declared)| {
            declared.forces.iter().map(move |forces| (joint, forces))
        });
        entries.flat_map(|(joint, forces)| {
            let sides = [Side::Low, Side::High].into_iter();
            sides
                .filter(|side| forces.stops[side.index()].is_some())
                .map(move |side| (joint, forces, side))
        })
    }

    /// Whether some event detaches or attaches it, or it is detached at the start.
    #[must_use]
    pub fn is_detachable(&self, what: Detachable) -> bool {
        let by_events = |event: &Event| {
            let actions = &event.actions;
            actions.detach.contains(&what) || actions.attach.contains(&what)
        };
        self.starts.detached.contains(&what) || self.events.iter().any(by_events)
    }

    /// The name of what an event detaches or attaches.
    #[must_use]
    pub fn detachable_name(&self, what: Detachable) -> &str {
        match what {
            Detachable::Line(index) => self.lines.get(index).map_or("", |line| &line.name),
            Detachable::Joint(index) => self.joints.get(index).map_or("", |joint| &joint.name),
        }
    }

    /// The coordinate that a lock holds, `boom.angle`; `None` of anything else.
    #[must_use]
    pub fn locked(&self, what: Detachable) -> Option<String> {
        let Detachable::Joint(joint) = what else {
            return None;
        };
        let JointLaw::Lock(lock) = &self.joints.get(joint)?.law else {
            return None;
        };
        let [(of, index)] = lock.couples;
        let (joint, coordinate) = self.coordinate(of, index)?;
        Some(format!("{}.{}", joint.name, coordinate.name))
    }

    /// The lock of a coordinate, by its number among the joints; `None` of one that nothing locks.
    #[must_use]
    pub fn lock_of(&self, joint: usize, coordinate: usize) -> Option<usize> {
        let holds = |law: &JointLaw| match law {
            JointLaw::Lock(lock) => lock.couples == [(joint, coordinate)],
            _ => false,
        };
        self.joints.iter().position(|joint| holds(&joint.law))
    }

    /// The SI unit of a speed that an event sets.
    #[must_use]
    pub fn speed_unit(&self, what: Settable) -> &'static str {
        match what {
            Settable::CoordinateRate(joint, number) => {
                let found = self.coordinate(joint, number);
                match found.is_some_and(|(_, coordinate)| coordinate.is_angle()) {
                    true => "rad/s",
                    false => "m/s",
                }
            }
            Settable::AngularVelocityWorld(..) | Settable::AngularVelocityBody(..) => "rad/s",
            _ => "m/s",
        }
    }

    /// The name of what an event sets.
    #[must_use]
    pub fn settable_name(&self, what: Settable) -> String {
        let axis = |axis: usize| ["x", "y", "z"].get(axis).copied().unwrap_or_default();
        let body = |body: usize| self.bodies.get(body).map_or("", |body| &body.name);
        match what {
            Settable::Param(index) => {
                let param = self.params.get(index);
                param.map_or_else(String::new, |param| param.name.clone())
            }
            Settable::State(index) => {
                let state = self.states.get(index);
                state.map_or_else(String::new, |state| state.name.clone())
            }
            Settable::CoordinateRate(joint, number) => {
                let name = self.coordinate_name(joint, number);
                format!("{name}_rate")
            }
            Settable::Velocity(place, component) => {
                let owner = match place {
                    Place::World(frame) => {
                        let frame = self.world_frames.get(frame);
                        format!("world.{}", frame.map_or("", |frame| &frame.name))
                    }
                    Place::Body(index, 0) => body(index).to_owned(),
                    Place::Body(index, frame) => {
                        let frames = self.bodies.get(index).map(|body| &body.frames);
                        let frame = frames.and_then(|frames| frames.get(frame));
                        format!("{}.{}", body(index), frame.map_or("", |frame| &frame.name))
                    }
                    Place::Point(point) => {
                        let point = self.points.get(point);
                        point.map_or_else(String::new, |point| point.name.clone())
                    }
                };
                format!("{owner}.velocity.{}", axis(component))
            }
            Settable::AngularVelocityWorld(index, component) => {
                format!("{}.omega_world.{}", body(index), axis(component))
            }
            Settable::AngularVelocityBody(index, component) => {
                format!("{}.omega_body.{}", body(index), axis(component))
            }
        }
    }

    /// The params that events set, by index, rising.
    #[must_use]
    pub fn set_by_events(&self) -> Vec<usize> {
        let all = self.events.iter().flat_map(|event| &event.actions.set);
        let params = all.filter_map(|setting| match setting.what {
            Settable::Param(param) => Some(param),
            _ => None,
        });
        let mut params: Vec<usize> = params.collect();
        params.sort_unstable();
        params.dedup();
        params
    }

    /// Whether a formula is zero by declaration: the number 0, or a `const` of value 0.
    #[must_use]
    pub fn is_zero(&self, formula: &Formula) -> bool {
        self.constant(formula) == Some(0.0)
    }

    /// The value of a formula that is a number, or the name of a scalar `const`.
    pub(crate) fn constant(&self, formula: &Formula) -> Option<f64> {
        match formula {
            Formula::Number(value) => Some(*value),
            Formula::Const(index) => self.consts.get(*index)?.value.scalar(),
            _ => None,
        }
    }

    /// Calls `visit` on a formula, on everything in it, and on everything in each `let` it names, once.
    pub fn walk(&self, formula: &Formula, visit: &mut impl FnMut(&Formula)) {
        let mut named = Vec::new();
        formula.walk(&mut |part| {
            visit(part);
            named.extend(let_of(part));
        });
        let mut next = 0;
        while let Some(&index) = named.get(next) {
            next += 1;
            let first = !named[..next - 1].contains(&index);
            if let (true, Some(declared)) = (first, self.lets.get(index)) {
                declared.value.walk(&mut |part| {
                    visit(part);
                    named.extend(let_of(part));
                });
            }
        }
    }

    /// What a formula that names a `let` stands for.
    #[must_use]
    pub fn said<'f>(&'f self, formula: &'f Formula) -> &'f Formula {
        let mut said = formula;
        // A `let` that names itself through others is refused where it is read.
        for _ in 0..self.lets.len() {
            match let_of(said).and_then(|index| self.lets.get(index)) {
                Some(declared) => said = &declared.value,
                None => break,
            }
        }
        said
    }

    /// Whether anything in a formula or in a `let` it names satisfies `test`.
    #[must_use]
    pub fn contains(&self, formula: &Formula, test: impl Fn(&Formula) -> bool) -> bool {
        let mut found = false;
        self.walk(formula, &mut |part| found |= test(part));
        found
    }

    /// The body, or else the point, of a name.
    #[must_use]
    pub fn part_named(&self, name: &str) -> Option<Part> {
        let body = self.bodies.iter().position(|body| body.name == name);
        let point = || self.points.iter().position(|point| point.name == name);
        body.map(Part::Body).or_else(|| point().map(Part::Point))
    }

    /// The joints that motion may take to another branch, and where.
    pub fn folding_joints(&self) -> impl Iterator<Item = (usize, Fold)> + '_ {
        let joints = self.joints.iter().enumerate();
        joints.filter_map(|(index, joint)| Some((index, joint.law.fold()?)))
    }

    /// Whether a formula, or a `let` it names, reads time.
    #[must_use]
    pub fn depends_on_time(&self, formula: &Formula) -> bool {
        self.contains(formula, |part| *part == Formula::Time)
    }

    /// Whether accelerations or rates of declared states follow time by themselves: what is only told, an output or an event, does not count.
    #[must_use]
    pub fn reads_time(&self) -> bool {
        let mut acting = self.acting_formulas();
        acting.any(|formula| self.depends_on_time(formula))
            || self.world_frames.iter().any(|frame| frame.moves(self))
    }
}

impl Scene {
    /// The formulas that change during a run: what acts, what is measured, what drives.
    pub(crate) fn read_by_runs(&self) -> impl Iterator<Item = &Formula> {
        self.told_by_runs().chain(self.acting_formulas())
    }

    /// Those of them that are no [`Scene::acting_formulas`].
    pub(crate) fn told_by_runs(&self) -> impl Iterator<Item = &Formula> {
        let lets = self.lets.iter().map(|named| &named.value);
        let outputs = self.outputs.iter().map(|output| &output.value);
        let guards = self.events.iter().map(|event| &event.guard);
        let settings = self.events.iter().flat_map(|event| &event.actions.set);
        let set = settings.map(|setting| &setting.value);
        lets.chain(outputs).chain(guards).chain(set)
    }
}

/// The `let` that a formula is.
fn let_of(formula: &Formula) -> Option<usize> {
    match formula {
        Formula::Let(index) => Some(*index),
        _ => None,
    }
}
