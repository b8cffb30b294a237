//! What events do besides being told: the run that stands on their instant is changed, made consistent again, and goes on.
//!
//! Everything that happens at one instant acts together: what is set is evaluated just before the instant, applied in the order of the declaration
//! (the last value of a number counts), and made consistent once. Actions may let other events happen at the same instant: these act next.
//! The energy that jumps is the work of the action ([`Acted`]); it counts neither as made nor as lost by the steps.

use std::sync::Arc;

use mbd_scene::{Float, Gravity, Model, ParamError, Quantity, Settable, plain};

use super::handover::HandedBefore;
use super::{ModelRun, moved};
use crate::chatter::MOST_SWITCHES;
use crate::columns::body_name;
use crate::error::{RunError, StepError};
use crate::projection::APART;
use crate::unilateral::Mode;

/// What events did at an instant: see [`Simulation::actions`].
#[derive(Clone, Debug, PartialEq)]
pub struct Acted {
    /// When [s].
    pub time: f64,
    /// The events that acted together, by index in the declaration, in its order.
    pub events: Vec<usize>,
    /// By how much kinetic, gravitational and elastic energy jumped [J]; `None` where gravity is the caller's.
    pub energies: Option<[f64; 3]>,
}

impl Acted {
    /// The energy that the action gave (positive) or took [J].
    #[must_use]
    pub fn work(&self) -> Option<f64> {
        Some(self.energies?.iter().sum())
    }
}

/// What actions changed so far, beside the modes of elements.
#[derive(Clone, Debug, Default)]
pub(crate) struct Changes<T> {
    /// The params that events set, by index, rising.
    pub settable: Vec<usize>,
    /// All params as the caller gave them.
    pub own: Vec<T>,
    /// Per event whether it has acted.
    pub done: Vec<bool>,
    /// Whether an event has asked the run to end here, and which.
    pub stop: Option<usize>,
    /// Every action.
    pub all: Vec<Acted>,
    /// What the map of the event that ended the run hands on, from before anything acted.
    pub handed: Option<HandedBefore<T>>,
}

impl<T: Float> ModelRun<T> {
    /// Lets the events that have just happened act; whether that changed anything. After an error the run is as it was before, and the same
    /// events are due again.
    pub(crate) fn act(&mut self, crossed: &[usize]) -> Result<bool, StepError> {
        let model = self.system.model.clone();
        let events = &model.scene().events;
        let acts = |&event: &usize| events.get(event).is_some_and(|it| !it.actions.is_empty());
        if !crossed.iter().any(acts) {
            return Ok(false);
        }
        let done = self.changes.done.clone();
        let mut acting = Vec::new();
        for (index, event) in events.iter().enumerate() {
            let over = event.actions.once && self.changes.done.get(index) == Some(&true);
            if over || event.actions.is_empty() || !crossed.contains(&index) {
                continue;
            }
            acting.push(index);
            if event.actions.stop {
                self.changes.stop.get_or_insert(index);
            }
        }
        acting.iter().for_each(|&event| {
            if let Some(done) = self.changes.done.get_mut(event) {
                *done = true;
            }
        });
        acting.retain(|&index| events.get(index).is_some_and(|it| it.actions.changes()));
        if acting.is_empty() {
            return Ok(false);
        }
        let handed = self.handed_before(crossed);
        let before = (self.state.clone(), self.system.memory.clone());
        let changed = self.change_together(&acting);
        if changed.is_err() {
            (self.state, self.system.memory) = before;
            self.system.take_up_turns();
            (self.changes.done, self.changes.stop) = (done, None);
            self.take_model(model);
            for &event in crossed {
                if let Some(side) = self.margins.sides.get_mut(event) {
                    *side = !*side;
                }
            }
            self.stale = true;
            self.changes.handed = handed;
            return changed.map(|()| true);
        }
        self.changes.handed = handed.map(|handed| handed.at(&self.state));
        Ok(true)
    }

    fn change_together(&mut self, acting: &[usize]) -> Result<(), StepError> {
        self.count_actions(acting)?;
        let before = self.energies();
        let [_, rates, _] = self.guards_and_rates()?;
        if let Some(&event) = acting.iter().find(|event| self.moves_back(**event, &rates)) {
            return Err(self.acts_at_once(event));
        }
        let speeds = self.apply(acting)?;
        self.make_consistent(acting, &speeds)?;
        self.rearm(acting, &rates)?;
        let after = self.energies();
        let jump = |(before, after): ([f64; 3], [f64; 3])| [0, 1, 2].map(|k| after[k] - before[k]);
        let acted = Acted {
            time: self.time,
            events: acting.to_vec(),
            energies: before.zip(after).map(jump),
        };
        self.system.action_work += acted.work().unwrap_or(f64::NAN);
        self.changes.all.push(acted);
        Ok(())
    }

    fn count_actions(&mut self, acting: &[usize]) -> Result<(), StepError> {
        for &event in acting {
            if self.happens_at_once(event) {
                return Err(self.acts_at_once(event));
            }
            if self.chatter.sees(self.time) {
                return Err(StepError::EventChatter {
                    line: self.event_names(&[event]),
                    is_event: true,
                    count: MOST_SWITCHES,
                    window: self.chatter.window,
                });
            }
        }
        Ok(())
    }

    /// An event that its action armed again acts once more in no time.
    fn acts_at_once(&self, event: usize) -> StepError {
        let since = self.margins.rearmed_at(event);
        StepError::EventChatter {
            line: self.event_names(&[event]),
            is_event: true,
            count: 2,
            window: since.map_or(0.0, |[since, _]| self.time - since),
        }
    }

    /// `a`, or `a`, `b` for several.
    fn event_names(&self, events: &[usize]) -> String {
        let declared = &self.system.model.scene().events;
        let names = events.iter().filter_map(|&event| declared.get(event));
        let names: Vec<&str> = names.map(|event| event.name.as_str()).collect();
        names.join("`, `")
    }

    #[cold]
    pub(super) fn cannot_act(&self, acting: &[usize], why: String) -> StepError {
        StepError::Action {
            event: self.event_names(acting),
            time: self.time,
            why,
        }
    }

    /// Kinetic, gravitational and elastic energy [J], by the laws: a compiled model need not have been asked for them.
    pub(super) fn energies(&mut self) -> Option<[f64; 3]> {
        if self.system.model.scene().gravity == Gravity::Field {
            return None;
        }
        let state = self.state.get(..self.system.nx).unwrap_or_default();
        let mut energy = [0.0; 6];
        self.system
            .by_laws(Quantity::Energy, self.time, state, &mut energy);
        let [kinetic, gravitational, elastic, ..] = energy;
        Some([kinetic, gravitational, elastic])
    }

    /// Changes params, states and elements, and gives the speeds that are to be set.
    fn apply(&mut self, acting: &[usize]) -> Result<Vec<(usize, Settable, f64)>, StepError> {
        let model = self.system.model.clone();
        let (scene, layout) = (model.scene(), model.layout());
        let values = self.system.settings(self.time, &self.state)?;
        let places = self.system.locked(self.time, &self.state);
        let mut params = model.params().to_vec();
        let mut speeds: Vec<(usize, Settable, f64)> = Vec::new();
        let mut values = values.into_iter();
        for (index, event) in scene.events.iter().enumerate() {
            let acts = acting.contains(&index);
            let own = values.by_ref().take(event.actions.set.len());
            for (setting, value) in event.actions.set.iter().zip(own).filter(|_| acts) {
                let what = setting.what;
                let slot = match what {
                    Settable::Param(param) => params.get_mut(param),
                    Settable::State(state) => self.state.get_mut(layout.states() + state),
                    _ => {
                        speeds.retain(|(_, other, _)| *other != what);
                        speeds.push((index, what, value));
                        None
                    }
                };
                if let Some(slot) = slot {
                    *slot = T::from_f64(value);
                }
                // Values of params are checked with their ranges.
                if !value.is_finite() && !matches!(what, Settable::Param(_)) {
                    let kind = match what {
                        Settable::State(_) => "the state ",
                        _ => "",
                    };
                    let name = scene.settable_name(what);
                    let why = format!("it sets {kind}`{name}` to {value}");
                    return Err(self.cannot_act(&[index], why));
                }
            }
            let lists = [
                (&event.actions.detach, Mode::Detached),
                (&event.actions.attach, Mode::Free),
            ];
            for (list, mode) in lists {
                for &what in list.iter().filter(|_| acts) {
                    let memory = &mut self.system.memory;
                    if mode == Mode::Free {
                        memory.lock(layout, what, &places);
                    }
                    if let Some(at) = layout.switch_of(what) {
                        memory.set_mode(at, mode);
                    }
                }
            }
        }
        if params != model.params() {
            let before = self.system.placed_by_joints(self.time, &self.state);
            let changed = self.take_params(&params);
            changed.map_err(|error| self.cannot_act(acting, error.to_string()))?;
            self.check_places(acting, &before)?;
        }
        Ok(speeds)
    }

    /// Whether bodies that joint coordinates place are where they were before params changed.
    fn check_places(&mut self, acting: &[usize], before: &[f64]) -> Result<(), StepError> {
        let after = self.system.placed_by_joints(self.time, &self.state);
        let layout = self.system.model.layout();
        let moved = moved::furthest(layout.directions, before, &after);
        let Some((body, [distance, angle])) = moved else {
            return Ok(());
        };
        let allowed = APART * self.system.projection.length;
        let by = match [distance > allowed, angle > APART] {
            [true, _] => format!("{} m", plain(distance, 4)),
            [false, true] => format!("{} deg", plain(angle.to_degrees(), 4)),
            [false, false] => return Ok(()),
        };
        let name = body_name(self.system.model.scene(), body);
        let why = format!("it moves `{name}` by {by}: bodies would have to jump");
        Err(self.cannot_act(acting, why))
    }

    /// Runs the same scene with these params from here on.
    pub(super) fn take_params(&mut self, params: &[T]) -> Result<(), ParamError> {
        let model = self.system.model.with_params(params)?;
        self.take_model(model);
        Ok(())
    }

    /// The same of the model with its params.
    pub(super) fn take_model(&mut self, model: Arc<dyn Model<T>>) {
        self.system.take(model);
        self.take_sizes();
        self.overlooked.forget();
    }

    /// Makes the changed run consistent: joints hold, speeds that are set jump, nodes in balance from where they are, every element in its mode, the first
    /// stage anew.
    fn make_consistent(
        &mut self,
        acting: &[usize],
        speeds: &[(usize, Settable, f64)],
    ) -> Result<(), StepError> {
        self.system.read_modes(self.time, &self.state)?;
        let held = self.system.hold_again(self.time, &mut self.state);
        held.map_err(|error| match error {
            StepError::JointsApart { rows, .. } => {
                let apart = rows.iter();
                let apart =
                    apart.map(|(name, by, unit)| format!("`{name}` by {} {unit}", plain(*by, 4)));
                let apart = apart.collect::<Vec<_>>().join(", ");
                let why = format!("it takes apart {apart}: bodies would have to jump");
                self.cannot_act(acting, why)
            }
            other => other,
        })?;
        self.set_speeds(speeds)?;
        self.inside.copy_from_slice(self.method.first());
        let nodes = self.system.memory.nodes().to_vec();
        self.system
            .start(self.time, &mut self.state, Some(&nodes))?;
        self.begin_watch()?;
        let ahead = self.behind_jump();
        self.method
            .begin(&mut self.system, self.time + ahead, 0.0, &self.state)?;
        self.method
            .prepare(&mut self.system, self.time, &self.state)?;
        self.limit_pace();
        self.system.count_turns(self.time, &self.state);
        self.system
            .follow_commands(self.time, Some(0.0), &self.state)?;
        self.find_held_guards()?;
        self.rebase();
        self.rebase_momentum();
        Ok(())
    }

    /// Takes back what actions changed, for another run.
    pub(super) fn take_back_actions(&mut self) -> Result<(), RunError> {
        let layout = self.system.model.layout().clone();
        self.system.memory.forget_modes(&layout);
        self.changes.done.fill(false);
        self.changes.stop = None;
        self.system.action_work = 0.0;
        if self.changes.own == self.system.model.params() {
            return Ok(());
        }
        let own = self.changes.own.clone();
        let taken = self.take_params(&own);
        taken.map_err(|error| {
            let why = error.to_string();
            self.failed(self.cannot_act(&[], why))
        })
    }
}
