//! Another model goes on where this one stands: stages that separate, parts that are jettisoned, a mechanism that is deployed.
//!
//! What has the same name is the same thing: bodies, points with mass, nodes that are states, declared states, inputs that are held, what is
//! detached. Positions and velocities are those of centres of mass. What the next model has not is dropped; what it has besides starts where it
//! is given, or declared.

use std::ops::Range;

use mbd_scene::{Detachable, Float, InputSource, Layout, Model, Quantity, Scene};

use super::Simulation;
use crate::columns::{node_name, part_name};
use crate::error::{RunError, StepError};
use crate::moving::moving;
use crate::unilateral::Mode;

/// What became of a run that another model took over: see [`Simulation::take_over`].
#[derive(Clone, Debug, PartialEq)]
pub struct Handover {
    /// Bodies, points and states that go on.
    pub carried: Vec<String>,
    /// Those that the next model has not.
    pub dropped: Vec<String>,
    /// Those that the last model had not.
    pub started: Vec<String>,
    /// Linear [kg m/s] and angular [kg m²/s] momentum about the world origin, before and after.
    pub momentum: [[f64; 6]; 2],
    /// Kinetic, gravitational and elastic energy [J], before and after; `None` where gravity is the caller's.
    pub energies: [Option<[f64; 3]>; 2],
}

/// Something of a state that has a name.
struct Owned {
    name: String,
    /// Bodies are no points.
    kind: &'static str,
    /// Where its numbers are, in order; what it has not is empty.
    slots: [Range<usize>; 4],
    /// Whether the declaration says where it starts.
    placed: bool,
}

impl Owned {
    fn count(&self) -> usize {
        self.slots.iter().map(ExactSizeIterator::len).sum()
    }

    fn places(&self) -> impl Iterator<Item = usize> + '_ {
        self.slots.iter().cloned().flatten()
    }
}

/// Everything of a state, in its order: bodies, points, nodes, declared states.
fn owned(scene: &Scene, layout: &Layout) -> Vec<Owned> {
    let parts = moving(layout).map(|part| Owned {
        name: part_name(scene, part.part).to_owned(),
        kind: if part.spin.is_empty() {
            "point"
        } else {
            "body"
        },
        placed: scene
            .starts
            .parts
            .iter()
            .any(|start| start.part == part.part),
        slots: [part.position, part.attitude, part.velocity, part.spin],
    });
    let first = layout.nq + layout.nv;
    let nodes = layout.nodes.iter().filter_map(|node| {
        let at = first + node.z?;
        Some(Owned {
            name: node_name(scene, node.point).to_owned(),
            kind: "node",
            // The start finds it in balance.
            placed: true,
            slots: [at..at + 3, 0..0, 0..0, 0..0],
        })
    });
    let states = scene.states.iter().enumerate();
    let states = states.map(|(index, state)| Owned {
        name: state.name.clone(),
        kind: "state",
        placed: true,
        slots: [
            layout.states() + index..layout.states() + index + 1,
            0..0,
            0..0,
            0..0,
        ],
    });
    parts.chain(nodes).chain(states).collect()
}

impl<T: Float> Simulation<T> {
    /// What [`Simulation::take_over`] does.
    pub(crate) fn go_on_from(
        &mut self,
        last: &mut Self,
        given: &[(&str, &[T])],
    ) -> Result<Handover, RunError> {
        if !last.started {
            last.begin()?;
        }
        let (from, to) = (last.system.model.clone(), self.system.model.clone());
        same_axes(&*from, &*to).map_err(|cause| self.failed(cause))?;
        let olds = owned(from.scene(), from.layout());
        let news = owned(to.scene(), to.layout());
        if let Some((name, _)) = given
            .iter()
            .find(|(name, _)| !news.iter().any(|new| new.name == *name))
        {
            let why = format!("is nothing of `{}` that has a state", to.scene().name);
            let name = (*name).to_owned();
            return Err(self.failed(StepError::Unplaced { name, why }));
        }
        let mut state = self.state().to_vec();
        let (mut carried, mut started) = (Vec::new(), Vec::new());
        for new in &news {
            let own = given.iter().find(|(name, _)| new.name == *name);
            let old = olds
                .iter()
                .find(|old| old.name == new.name && old.kind == new.kind);
            let numbers: Vec<T> = match (own, old) {
                (Some((_, numbers)), _) if numbers.len() == new.count() => numbers.to_vec(),
                (Some((_, numbers)), _) => {
                    let slot = format!("length of `{}` ({} numbers)", new.name, new.count());
                    let value = numbers.len() as f64;
                    return Err(self.failed(StepError::InvalidInput { slot, value }));
                }
                (None, Some(old)) => {
                    let all = old.places();
                    all.filter_map(|at| last.state.get(at).copied()).collect()
                }
                (None, None) if new.placed => {
                    started.push(new.name.clone());
                    continue;
                }
                (None, None) => {
                    let why = format!(
                        "is new in `{}` and starts nowhere: declare where, or give it",
                        to.scene().name
                    );
                    let name = new.name.clone();
                    return Err(self.failed(StepError::Unplaced { name, why }));
                }
            };
            for (at, number) in new.places().zip(numbers) {
                if let Some(slot) = state.get_mut(at) {
                    *slot = number;
                }
            }
            match own {
                Some(_) => started.push(new.name.clone()),
                None => carried.push(new.name.clone()),
            }
        }
        let goes_on = |old: &&Owned| {
            news.iter()
                .any(|new| old.name == new.name && old.kind == new.kind)
        };
        let dropped = olds.iter().filter(|old| !goes_on(old));
        let dropped = dropped.map(|old| old.name.clone()).collect();
        let before = (last.momentum(), last.energies());
        self.give_state(last.time, &state)?;
        self.hold_the_same(last);
        self.detach_the_same(last);
        self.begin()?;
        let after = (self.momentum(), self.energies());
        Ok(Handover {
            carried,
            dropped,
            started,
            momentum: [before.0, after.0],
            energies: [before.1, after.1],
        })
    }

    fn momentum(&mut self) -> [f64; 6] {
        let state = self.state.get(..self.system.nx).unwrap_or_default();
        let mut momentum = [0.0; 6];
        self.system
            .by_laws(Quantity::Momentum, self.time, state, &mut momentum);
        momentum
    }

    /// Holds the inputs that the last run held under the same names.
    fn hold_the_same(&mut self, last: &Self) {
        let (from, to) = (&last.system.model, &self.system.model);
        let name = |model: &dyn Model<T>, source: InputSource| match source {
            InputSource::Input(index) => model
                .scene()
                .inputs
                .get(index)
                .map(|input| input.name.clone()),
            _ => None,
        };
        for slots in &to.layout().inputs {
            let wanted = name(&**to, slots.source);
            let mut olds = from.layout().inputs.iter();
            let old = olds.find(|old| {
                wanted.is_some() && old.len == slots.len && name(&**from, old.source) == wanted
            });
            let held = old.and_then(|old| last.system.held.get(old.at..old.at + old.len));
            for list in [&mut self.system.held, &mut self.system.inputs] {
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
        let all = |scene: &Scene| {
            let lines = (0..scene.lines.len()).map(Detachable::Line);
            let joints = (0..scene.joints.len()).map(Detachable::Joint);
            lines.chain(joints).collect::<Vec<_>>()
        };
        for new in all(to.scene()) {
            let name = to.scene().detachable_name(new);
            let mut olds = all(from.scene()).into_iter();
            let old = olds.find(|old| from.scene().detachable_name(*old) == name);
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
