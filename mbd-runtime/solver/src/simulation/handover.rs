//! Another model goes on where this one stands: stages that separate, parts that are jettisoned, a mechanism that is deployed.
//!
//! What has the same name is the same thing: bodies, points with mass, nodes that are states, declared states, inputs that are held, what is
//! detached. Positions and velocities are those of centres of mass. What the next model has not is dropped; what it has besides starts where it
//! is given, or declared.

mod map;
mod owned;
mod placed;
mod unkept;

use std::f64::consts::TAU;

use mbd_scene::similar::near_and_all;
use mbd_scene::{
    Detachable, Float, InputSource, Joint, Layout, Link, Model, Place, Quantity, Scene, StartFrom,
    Unit, place_bodies,
};

use super::ModelRun;
use super::moved::moved_body;
use crate::columns::body_name;
use crate::error::{RunError, StepError};
use crate::laws::params_of;
use crate::origin::{MeasuredFrom, MovingOrigin};
use crate::unilateral::Mode;
pub(super) use map::HandedBefore;
use map::HandoverMap;
use owned::{Owned, OwnerKind, owned};
use placed::place_held;
use unkept::{alike, detachables, unkept};

/// Coordinates of a joint that differ by less are those that it had [m or rad, or of the size of the coordinate].
const SAME: f64 = 1e-9;

/// What became of a run that another model took over: see [`Simulation::take_over`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Handover {
    /// Bodies, points and states that go on.
    pub carried: Vec<String>,
    /// Those that the next model has not.
    pub dropped: Vec<String>,
    /// Those that the last model had not.
    pub started: Vec<String>,
    /// Lines, springs and joints that were detached and hold in the next model, where no event detaches or attaches them.
    pub attached: Vec<String>,
    /// Coordinates that were locked, `pin.angle`, and move in the next model, where no event locks or frees them.
    pub freed: Vec<String>,
    /// Linear [kg m/s] and angular [kg m²/s] momentum about the world origin, before and after.
    pub momentum: [[f64; 6]; 2],
    /// Kinetic, gravitational and elastic energy [J], before and after; `None` where gravity is the caller's.
    pub energies: [Option<[f64; 3]>; 2],
}

/// What goes on in another model besides what has the same name there.
#[derive(Clone, Copy, Debug)]
pub struct Given<'a, T> {
    /// Names and numbers that the caller gives: see [`Simulation::take_over`].
    pub numbers: &'a [(&'a str, &'a [T])],
    /// The event of the last model whose map counts, by index.
    pub event: Option<usize>,
    /// Bodies and points that the state of this run places, as a declaration would.
    pub placed: &'a [String],
    /// Inputs that this run holds at its own numbers, whatever the last one held.
    pub held: &'a [String],
}

/// What became of the bodies of a tree.
#[derive(Clone, Debug, Default)]
struct AlongTree {
    /// Those that go on where joints of the tree carry them.
    carried: Vec<String>,
    /// Speeds of bodies that have their own in the state, and by how much the impulses of joints change them.
    pushed: Vec<(usize, f64)>,
    /// Per body of the scene its numbers as in absolute coordinates, in the world, before the joints; `None` where nothing says them.
    known: Vec<Option<Vec<f64>>>,
}

/// A body by name, with its numbers as in absolute coordinates.
type NamedBody = (String, Vec<f64>);

/// A state that goes on, what it is measured from, what became of everything, and where bodies of a tree were.
type StateAfter = (
    Vec<f64>,
    Option<MovingOrigin>,
    Handover,
    Vec<Option<Vec<f64>>>,
);

impl<T: Float> ModelRun<T> {
    /// What [`Simulation::take_over`] does.
    pub(crate) fn go_on_from(
        &mut self,
        last: &mut Self,
        given: Given<'_, T>,
    ) -> Result<Handover, RunError> {
        self.check_whole()?;
        last.check_whole()?;
        if !last.started {
            last.begin()?;
        }
        let before = (last.momentum(), last.energies());
        let map = last.map_of(given.event)?;
        let (state, origin, mut handover, placed) = self
            .state_after(last, given, &map)
            .map_err(|cause| self.failed(cause))?;
        self.put(last.time, origin, &state)?;
        self.hold_the_same(last, given.held);
        self.detach_the_same(last);
        [handover.attached, handover.freed] = unkept(last, self.system.model.scene());
        let (from, to) = (last.system.model.clone(), self.system.model.clone());
        let same = |joint: usize| same_joint(from.scene(), (to.scene(), joint), &map);
        self.system
            .count_on(&last.system, &same, &last.state, &mut self.state);
        self.system.remember_locked((self.time, &self.state));
        self.begin_after(true)?;
        if to.layout().tree.is_some() {
            // Joints of a tree hold whatever the state: what they moved is not in it.
            let names: Vec<String> = to.scene().bodies.iter().map(|it| it.name.clone()).collect();
            self.moved.retain(|moved| !names.contains(&moved.name));
            let bodies = self.bodies_in_world().into_iter().zip(placed);
            let directions = to.layout().directions;
            let carried =
                bodies.filter_map(|((name, now), was)| moved_body(name, directions, [&was?, &now]));
            self.moved.extend(carried);
            self.moved.sort_by(|a, b| b.distance.total_cmp(&a.distance));
        }
        let after = (self.momentum(), self.energies());
        handover.momentum = [before.0, after.0];
        handover.energies = [before.1, after.1];
        Ok(handover)
    }

    /// The state that this run begins with.
    fn state_after(
        &mut self,
        last: &mut Self,
        given: Given<'_, T>,
        map: &HandoverMap,
    ) -> Result<StateAfter, StepError> {
        let (from, to) = (last.system.model.clone(), self.system.model.clone());
        same_axes(&*from, &*to)?;
        let said = |name: &str| map.has(name) || given.numbers.iter().any(|(own, _)| *own == name);
        same_units(from.scene(), to.scene(), &said)?;
        let olds = owned(from.scene(), from.layout());
        let news = owned(to.scene(), to.layout());
        let known = |name: &str| {
            let mut bodies = to.scene().bodies.iter();
            let mut params = to.scene().params.iter();
            news.iter().any(|new| new.name == name)
                || bodies.any(|body| body.name == name)
                || params.any(|param| param.name == name)
        };
        let names = given.numbers.iter().map(|(name, _)| *name);
        let mut strangers = names.chain(map.names()).filter(|name| !known(name));
        if let Some(name) = strangers.next() {
            let owners = news.iter().map(|new| new.name.as_str());
            let params = to.scene().params.iter().map(|param| param.name.as_str());
            let known = near_and_all(name, owners.chain(params));
            let why = format!(
                "is nothing of `{}` that has a state{known}",
                to.scene().name
            );
            let name = name.to_owned();
            return Err(StepError::UnknownName { name, why });
        }
        let mut handover = Handover::default();
        // In the numbers of the run that ends, which are measured from where its origin is.
        let origin = last.system.origin();
        let place = origin.unwrap_or_default().at(last.time);
        let mut state: Vec<f64> = self.system.in_world(self.time, &self.state).collect();
        let bodies = last.bodies_in_world();
        let along_tree =
            self.put_along_tree(last, (map, &bodies, given), &mut state, &mut handover)?;
        let measured = MeasuredFrom::new(to.layout());
        measured.measure_from(&mut state, &place);
        let mut nowhere = Vec::new();
        for new in &news {
            let own = given.numbers.iter().find(|(name, _)| new.name == *name);
            let mapped = map.numbers(new, to.layout().directions, to.scene().angular_velocity)?;
            let same = |old: &&Owned| old.name == new.name && old.kind == new.kind;
            let old = olds.iter().find(same);
            // A body that a joint of a tree carried.
            let carried = bodies
                .iter()
                .find(|(name, _)| new.kind == OwnerKind::Body && *name == new.name);
            let in_world = |numbers: &mut dyn Iterator<Item = f64>| -> Vec<f64> {
                let places = numbers.zip(new.places());
                places.map(|(x, at)| x - measured.of(at, &place)).collect()
            };
            let numbers: Vec<f64> = match (own, mapped, old, carried) {
                (Some((_, numbers)), ..) if numbers.len() == new.count() => {
                    in_world(&mut numbers.iter().map(|x| x.to_f64()))
                }
                (Some((_, numbers)), ..) => {
                    let name = format!("`{}`", new.name);
                    return Err(StepError::length(&name, numbers.len(), new.count()));
                }
                // Measured from the same origin already.
                (None, Some(numbers), ..) => numbers,
                (None, None, Some(old), _) => {
                    let numbers = old.places().filter_map(|at| last.state.get(at));
                    numbers.map(|x| x.to_f64()).collect()
                }
                (None, None, None, Some((_, numbers))) => in_world(&mut numbers.iter().copied()),
                (None, None, None, None) if new.placed || given.placed.contains(&new.name) => {
                    handover.started.push(new.name.clone());
                    continue;
                }
                (None, None, None, None) => {
                    handover.started.push(new.name.clone());
                    nowhere.push(new);
                    continue;
                }
            };
            for (at, number) in new.places().zip(numbers) {
                if let Some(slot) = state.get_mut(at) {
                    *slot = number;
                }
            }
            match own {
                Some(_) => handover.started.push(new.name.clone()),
                None => handover.carried.push(new.name.clone()),
            }
        }
        self.put_on_joints(last.time, (&measured, &place), &nowhere, &mut state)?;
        // What joints of the tree push against a body that the state has itself.
        for &(at, change) in &along_tree.pushed {
            state[at] += change;
        }
        handover.carried.extend(along_tree.carried.iter().cloned());
        let goes_on = |name: &str| handover.carried.iter().any(|carried| carried == name);
        let old_bodies = bodies.iter().map(|(name, _)| name);
        let others = olds.iter().filter(|old| old.kind != OwnerKind::Body);
        let others = others.map(|old| &old.name);
        let mut dropped: Vec<String> = old_bodies.chain(others).cloned().collect();
        dropped.retain(|name| !goes_on(name) && !map.takes(name));
        handover.dropped = dropped;
        let checked: Vec<T> = state.iter().map(|&x| T::from_f64(x)).collect();
        self.check_state(last.time, &checked)?;
        Ok((state, origin, handover, along_tree.known))
    }

    /// Puts bodies that nothing else places where joints hold them, in absolute coordinates.
    ///
    /// # Errors
    /// [`StepError::StartsNowhere`] for the first that none holds.
    fn put_on_joints(
        &self,
        time: f64,
        (measured, origin): (&MeasuredFrom, &[[f64; 3]; 2]),
        nowhere: &[&Owned],
        state: &mut [f64],
    ) -> Result<(), StepError> {
        if nowhere.is_empty() {
            return Ok(());
        }
        let model = &self.system.model;
        let (scene, layout) = (model.scene(), model.layout());
        let body_of = |new: &&Owned| {
            let mut bodies = scene.bodies.iter();
            let body = bodies.position(|body| body.name == new.name);
            body.filter(|_| new.kind == OwnerKind::Body && layout.tree.is_none())
        };
        let bodies: Vec<usize> = nowhere.iter().filter_map(body_of).collect();
        // Joints to the world hold in the world.
        let own = state.iter().enumerate();
        let mut placed: Vec<f64> = own.map(|(at, x)| x + measured.of(at, origin)).collect();
        let params = params_of(model.params());
        let from = StartFrom::new(&params, time);
        let held = place_held(scene, layout, from, &bodies, &mut placed)?;
        for new in nowhere {
            if body_of(new).is_none_or(|body| !held.contains(&body)) {
                let (name, model) = (new.name.clone(), scene.name.clone());
                return Err(StepError::StartsNowhere { name, model });
            }
            for at in new.places() {
                state[at] = placed[at] - measured.of(at, origin);
            }
        }
        Ok(())
    }

    /// Puts the joints of a tree where the bodies they carry are; says which bodies these are. A joint that is the same in both models goes on with its
    /// own coordinates, turns among them.
    fn put_along_tree(
        &self,
        last: &Self,
        (map, bodies, given): (&HandoverMap, &[NamedBody], Given<'_, T>),
        state: &mut [f64],
        handover: &mut Handover,
    ) -> Result<AlongTree, StepError> {
        let (from, to) = (&last.system.model, &self.system.model);
        let (scene, layout) = (to.scene(), to.layout());
        let mut along = AlongTree::default();
        if layout.tree.is_none() {
            return Ok(along);
        }
        let world = last.system.origin().unwrap_or_default().at(last.time);
        let mut known = Vec::with_capacity(scene.bodies.len());
        for body in &scene.bodies {
            if let Some((_, own)) = given.numbers.iter().find(|(name, _)| *name == body.name) {
                let motion = layout.directions.motion();
                if own.len() != motion {
                    let name = format!("`{}`", body.name);
                    return Err(StepError::length(&name, own.len(), motion));
                }
                known.push(Some(own.iter().map(|x| x.to_f64()).collect()));
                continue;
            }
            let mapped =
                map.body_in_world(body, layout.directions, scene.angular_velocity, &world)?;
            let old = bodies.iter().find(|(name, _)| *name == body.name);
            known.push(mapped.or_else(|| old.map(|(_, numbers)| numbers.clone())));
        }
        let params = params_of(to.params());
        place_bodies(
            scene,
            layout,
            StartFrom::new(&params, last.time),
            &known,
            state,
        );
        let speeds = layout.directions.speeds();
        for (body, slots) in layout.own_bodies() {
            let own = known.get(body).and_then(Option::as_ref);
            let had = own.and_then(|own| own.get(layout.directions.coordinates()..));
            let at = layout.nq + slots.v..layout.nq + slots.v + speeds;
            let changes = at.zip(had.unwrap_or_default());
            let changes = changes.map(|(at, had)| (at, state[at] - had));
            along
                .pushed
                .extend(changes.filter(|(_, change)| *change != 0.0));
        }
        let is_given = |name: &str| given.numbers.iter().any(|(own, _)| *own == name);
        for (joint, link) in layout.joint_links() {
            let name = body_name(scene, link.body).to_owned();
            match known.get(link.body) {
                Some(Some(_)) if !is_given(&name) => along.carried.push(name),
                _ => handover.started.push(name),
            }
            let same = same_link((from.scene(), from.layout()), (scene, joint));
            let elsewhere = |name: &str| map.has(name) || is_given(name);
            if let Some(old) = same.filter(|_| !elsewhere(body_name(scene, link.body))) {
                let pairs = [
                    (old.slots.q, link.slots.q, link.coordinates),
                    (
                        from.layout().nq + old.slots.v,
                        layout.nq + link.slots.v,
                        link.speeds,
                    ),
                ];
                let all = pairs
                    .into_iter()
                    .flat_map(|(at, to, count)| (at..at + count).zip(to..to + count));
                let all: Vec<(usize, f64)> = all
                    .filter_map(|(at, to)| Some((to, last.state.get(at)?.to_f64())))
                    .collect();
                // Where its frames or its parent are elsewhere, its bodies are where they were, and it is not.
                let holds = |(at, x): &(usize, f64)| {
                    let off = state.get(*at).map_or(f64::NAN, |found| found - x);
                    let number = at.checked_sub(link.slots.q);
                    let turns = match number.is_some_and(|number| is_angle(scene, joint, number)) {
                        true => TAU * (off / TAU).round(),
                        false => 0.0,
                    };
                    (off - turns).abs() <= SAME * (1.0 + x.abs())
                };
                if all.iter().all(holds) {
                    all.iter().for_each(|(at, x)| state[*at] = *x);
                }
            }
        }
        along.known = known;
        Ok(along)
    }

    /// Every body with its position, attitude, velocity and angular velocity as in absolute coordinates, in the world.
    fn bodies_in_world(&mut self) -> Vec<NamedBody> {
        let model = self.system.model.clone();
        let (scene, layout) = (model.scene(), model.layout());
        if layout.tree.is_none() {
            // The state has them.
            let state: Vec<f64> = self.system.in_world(self.time, &self.state).collect();
            let directions = layout.directions;
            let coordinates = directions.coordinates();
            let speeds = directions.motion() - coordinates;
            let own = layout.own_bodies().map(|(body, slots)| {
                let v = layout.nq + slots.v;
                let ranges = [slots.q..slots.q + coordinates, v..v + speeds];
                let numbers = ranges.into_iter().flatten();
                let numbers = numbers.filter_map(|at| state.get(at).copied());
                (body_name(scene, body).to_owned(), numbers.collect())
            });
            return own.collect();
        }
        let mut numbers = vec![0.0; layout.len(Quantity::Bodies)];
        let state = self.state.get(..self.system.nx).unwrap_or_default();
        self.system
            .by_laws(Quantity::Bodies, self.time, state, &mut numbers);
        let each = numbers.chunks_exact(layout.directions.motion());
        let names = scene.bodies.iter().map(|body| body.name.clone());
        names.zip(each.map(<[f64]>::to_vec)).collect()
    }

    fn momentum(&mut self) -> [f64; 6] {
        let state = self.state.get(..self.system.nx).unwrap_or_default();
        let mut momentum = [0.0; 6];
        self.system
            .by_laws(Quantity::Momentum, self.time, state, &mut momentum);
        momentum
    }

    /// Holds the inputs that the last run held under the same names, but for those that this run holds at its own numbers.
    fn hold_the_same(&mut self, last: &Self, own: &[String]) {
        let system = &mut self.system;
        let (from, to) = (&last.system.model, &system.model);
        let name = |model: &dyn Model<T>, source: InputSource| match source {
            InputSource::Input(index) => model
                .scene()
                .inputs
                .get(index)
                .map(|input| input.name.clone()),
            _ => None,
        };
        for slots in &to.layout().inputs {
            let wanted = name(&**to, slots.source).filter(|name| !own.contains(name));
            let mut olds = from.layout().inputs.iter();
            let old = olds.find(|old| {
                wanted.is_some() && old.len == slots.len && name(&**from, old.source) == wanted
            });
            let held = old.and_then(|old| last.system.held.get(old.at..old.at + old.len));
            for list in [&mut system.held, &mut system.inputs] {
                let own = list.get_mut(slots.at..slots.at + slots.len);
                if let (Some(own), Some(held)) = (own, held) {
                    own.copy_from_slice(held);
                }
            }
        }
    }

    /// Detaches what is detached under the same name.
    fn detach_the_same(&mut self, last: &Self) {
        let (from, to) = (last.system.model.clone(), self.system.model.clone());
        for new in detachables(to.scene()) {
            let name = to.scene().detachable_name(new);
            let old = detachables(from.scene())
                .find(|&old| alike(old, new) && from.scene().detachable_name(old) == name);
            let place = |layout: &Layout, what: Detachable| {
                layout
                    .switch_of(what)
                    .filter(|_| to.scene().is_detachable(new))
            };
            let mode = old
                .and_then(|old| place(from.layout(), old))
                .and_then(|at| last.system.modes().get(at).copied());
            if let (Some(at), Some(mode)) = (place(to.layout(), new), mode) {
                let mode = match mode {
                    Mode::Detached => Mode::Detached,
                    _ => Mode::Free,
                };
                self.system.memory.set_mode(at, mode);
            }
        }
    }
}

/// The link of the last tree whose joint is the same as this one: name, law, and the bodies it joins.
fn same_link<'a>(
    (from, layout): (&Scene, &'a Layout),
    (to, joint): (&Scene, usize),
) -> Option<&'a Link> {
    let new = to.joints.get(joint)?;
    let old = from.joints.iter().position(|old| {
        old.name == new.name && old.law == new.law && ends(from, old) == ends(to, new)
    })?;
    layout.carried(old)
}

/// The bodies that a joint joins, by name; no name of the world.
fn ends<'a>(scene: &'a Scene, joint: &Joint) -> [&'a str; 2] {
    [joint.parent, joint.child].map(|place| match place {
        Place::Body(body, _) => body_name(scene, body),
        _ => "",
    })
}

/// The joint of the last model whose turns one of the next goes on with: of its name and law, else the only one of its law between the bodies that go
/// on as those it joins.
fn same_joint(from: &Scene, (to, joint): (&Scene, usize), map: &HandoverMap) -> Option<usize> {
    let new = to.joints.get(joint)?;
    let named = |old: &Joint| (&old.name, &old.law) == (&new.name, &new.law);
    if let Some(old) = from.joints.iter().position(named) {
        return Some(old);
    }
    let joined = ends(to, new).map(|name| map.taken(name).unwrap_or(name));
    let olds = from.joints.iter().enumerate();
    let mut alike = olds.filter(|(_, old)| old.law == new.law && ends(from, old) == joined);
    let (old, _) = alike.next()?;
    alike.next().is_none().then_some(old)
}

/// Whether a coordinate of a joint is an angle, which counts turns.
fn is_angle(scene: &Scene, joint: usize, number: usize) -> bool {
    let joint = scene.joints.get(joint);
    let coordinate = joint.and_then(|joint| joint.law.coordinate(number));
    coordinate.is_some_and(|coordinate| coordinate.is_periodic())
}

/// Refuses states and inputs of the same name that measure something else, where nothing else is `said` of a state.
fn same_units(from: &Scene, to: &Scene, said: &dyn Fn(&str) -> bool) -> Result<(), StepError> {
    let states = |scene: &Scene| -> Vec<(String, Unit)> {
        let own = scene.states.iter();
        let states = own.map(|state| (state.name.clone(), state.unit.clone()));
        let inputs = scene.inputs.iter();
        let inputs = inputs.map(|input| (input.name.clone(), input.unit.clone()));
        states.chain(inputs).collect()
    };
    let olds = states(from);
    for (name, unit) in states(to) {
        let old = olds.iter().find(|(old, _)| *old == name);
        let is_state = to.states.iter().any(|state| state.name == name);
        let unlike = |old: &&(String, Unit)| old.1.dimension != unit.dimension;
        if let Some((_, old)) = old.filter(|old| unlike(old) && !(is_state && said(&name))) {
            let why = format!(
                "is measured in `{}` in `{}` and in `{}` in `{}`: give one of them another name",
                old.text, from.name, unit.text, to.name
            );
            return Err(StepError::Unplaced { name, why });
        }
    }
    Ok(())
}

/// Refuses models whose states are written along other axes.
fn same_axes<T: Float>(from: &dyn Model<T>, to: &dyn Model<T>) -> Result<(), StepError> {
    let (a, b) = (from.scene(), to.scene());
    let what = match (
        a.planar == b.planar,
        a.angular_velocity == b.angular_velocity,
    ) {
        (true, true) => return Ok(()),
        (false, _) => "another plane, or none",
        (true, false) => "angular velocities in other axes",
    };
    Err(StepError::Unsupported {
        what: format!(
            "a run of `{}` that goes on from one of `{}` with {what},",
            b.name, a.name
        ),
        instead: "declare both alike (`planar`, `angular_velocity`)".into(),
    })
}
