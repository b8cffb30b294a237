//! The map of an event, with the numbers of its instant.

use mbd_scene::{AngularVelocity, Body, Directions, Float, Handed, MapSource, Next, Place, Scene};

use super::super::ModelRun;
use super::owned::{Owned, OwnerKind};
use crate::columns::{body_name, node_name};
use crate::error::{RunError, StepError};

/// What an event hands on.
#[derive(Clone, Debug, Default)]
pub struct HandoverMap {
    /// Per entry the name in the next model, what of the last one it takes, and how that moves, from the origin of the last run.
    entries: Vec<(String, Option<String>, Handed)>,
}

/// What the map of an event handed on before the actions at its instant.
#[derive(Clone, Debug)]
pub(in crate::simulation) struct HandedBefore<T> {
    event: usize,
    time: f64,
    /// The state that the actions left.
    left: Vec<T>,
    handed: Vec<Handed>,
}

impl<T: Float> HandedBefore<T> {
    /// The same where more has acted since.
    pub(in crate::simulation) fn at(self, state: &[T]) -> Self {
        let left = state.to_vec();
        HandedBefore { left, ..self }
    }

    /// Whether a run still stands where the actions left it.
    fn stands(&self, time: f64, state: &[T]) -> bool {
        self.time == time && self.left == state
    }
}

impl HandoverMap {
    /// The names in the next model, without its params.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.entries.iter().map(|(name, ..)| name.as_str())
    }

    /// Whether something of the next model is mapped.
    pub fn has(&self, name: &str) -> bool {
        self.names().any(|mapped| mapped == name)
    }

    /// The body or point of the last model that something of the next goes on from.
    pub fn taken(&self, name: &str) -> Option<&str> {
        let mut entries = self.entries.iter();
        let (_, taken, _) = entries.find(|(own, ..)| own == name)?;
        taken.as_deref()
    }

    /// Whether a body or a point of the last model goes on under another name.
    pub fn takes(&self, name: &str) -> bool {
        let mut entries = self.entries.iter();
        entries.any(|(_, taken, _)| taken.as_deref() == Some(name))
    }

    /// The numbers of something of the next model, from the origin of the last run; `None` where nothing is said of it.
    pub fn numbers(
        &self,
        new: &Owned,
        directions: Directions,
        components: AngularVelocity,
    ) -> Result<Option<Vec<f64>>, StepError> {
        let Some((.., handed)) = self.entries.iter().find(|(name, ..)| *name == new.name) else {
            return Ok(None);
        };
        let numbers = match (new.kind, handed) {
            (OwnerKind::State, Handed::Number(number)) => Some(vec![*number]),
            (OwnerKind::Body, motion) => motion.of_body(directions, components),
            (OwnerKind::Point, motion) => motion.of_point(directions),
            _ => None,
        };
        numbers.map(Some).ok_or_else(|| unfit(&new.name))
    }

    /// The numbers of a body of the next model, in the world: `origin` is where that of the last run is, and how fast it moves.
    pub fn body_in_world(
        &self,
        body: &Body,
        directions: Directions,
        components: AngularVelocity,
        origin: &[[f64; 3]; 2],
    ) -> Result<Option<Vec<f64>>, StepError> {
        let Some((.., handed)) = self.entries.iter().find(|(name, ..)| *name == body.name) else {
            return Ok(None);
        };
        let numbers = handed.of_body(directions, components);
        let mut numbers = numbers.ok_or_else(|| unfit(&body.name))?;
        for (at, from) in [0, directions.coordinates()].into_iter().zip(origin) {
            let places = numbers.iter_mut().skip(at).zip(directions.translations());
            places.for_each(|(slot, &axis)| *slot += from[axis]);
        }
        Ok(Some(numbers))
    }
}

fn unfit(name: &str) -> StepError {
    StepError::Unplaced {
        name: name.to_owned(),
        why: "is mapped from what is not of its kind: a body goes on from a frame of a body, a point from any place, a state or a param from a number".into(),
    }
}

/// The body or point that a place is on.
fn owner(scene: &Scene, place: Place) -> Option<String> {
    match place {
        Place::Body(body, _) => Some(body_name(scene, body).to_owned()),
        Place::Point(point) => Some(node_name(scene, point).to_owned()),
        Place::World(_) => None,
    }
}

impl<T: Float> ModelRun<T> {
    /// Before events act, what the map of the one that ends the run hands on; or what one has handed on that acted at this instant already.
    pub(in crate::simulation) fn handed_before(
        &mut self,
        crossed: &[usize],
    ) -> Option<HandedBefore<T>> {
        let kept = self.changes.handed.take();
        if let Some(kept) = kept.filter(|it| it.stands(self.time, &self.state)) {
            return Some(kept);
        }
        let event = self.changes.stop.filter(|event| crossed.contains(event))?;
        next_of(self.system.model.scene(), event)?;
        // What has no value here is told where it is asked for.
        let handed = self.handed(event).ok()?;
        Some(HandedBefore {
            event,
            time: self.time,
            left: Vec::new(),
            handed,
        })
    }

    /// What the map of an event hands on, from just before its instant; params of the next scene are told apart by their names.
    fn handed(&mut self, event: usize) -> Result<Vec<Handed>, RunError> {
        if !self.started {
            self.begin()?;
        }
        let before = self.changes.handed.as_ref();
        let before = before.filter(|it| it.event == event && it.stands(self.time, &self.state));
        if let Some(before) = before {
            return Ok(before.handed.clone());
        }
        let state = self
            .state
            .get(..self.system.nx)
            .unwrap_or_default()
            .to_vec();
        let supplied = self.system.supply(self.time, &state);
        supplied.map_err(|cause| self.failed(cause))?;
        let mut handed = Vec::new();
        let now = (self.time, state.as_slice());
        self.system.by_laws_at(now, false, |laws, model, at| {
            laws.run(model, at, |scene, layout, numbers, at, scratch| {
                let scene = (scene, layout);
                mbd_scene::handed(event, scene, numbers, at, scratch, &mut handed);
            });
        });
        Ok(handed)
    }

    /// The map of an event, without what it says of params.
    pub(super) fn map_of(&mut self, event: Option<usize>) -> Result<HandoverMap, RunError> {
        let model = self.system.model.clone();
        let scene = model.scene();
        let Some((event, next)) = event.and_then(|event| Some((event, next_of(scene, event)?)))
        else {
            return Ok(HandoverMap::default());
        };
        let handed = self.handed(event)?;
        let entries = next.map.iter().zip(handed).map(|(mapped, handed)| {
            let taken = match mapped.from {
                MapSource::Place(place) => owner(scene, place),
                MapSource::Value { .. } => None,
            };
            (mapped.name.clone(), taken, handed)
        });
        Ok(HandoverMap {
            entries: entries.collect(),
        })
    }

    /// What [`Simulation::params_after`] does.
    pub(crate) fn hand_params(
        &mut self,
        event: usize,
        next: &Scene,
        params: &mut [T],
    ) -> Result<(), RunError> {
        let model = self.system.model.clone();
        let Some(said) = next_of(model.scene(), event) else {
            return Ok(());
        };
        let handed = self.handed(event)?;
        for (mapped, handed) in said.map.iter().zip(handed) {
            let param = next.params.iter().position(|it| it.name == mapped.name);
            let slot = param.and_then(|param| params.get_mut(param));
            match (slot, handed) {
                (None, _) => {}
                (Some(slot), Handed::Number(number)) => *slot = T::from_f64(number),
                (Some(_), Handed::Motion { .. }) => return Err(self.failed(unfit(&mapped.name))),
            }
        }
        Ok(())
    }
}

/// What an event says of the scene that goes on.
fn next_of(scene: &Scene, event: usize) -> Option<&Next> {
    scene.events.get(event)?.actions.next.as_ref()
}
