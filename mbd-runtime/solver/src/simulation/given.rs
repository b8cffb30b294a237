//! What a program gives a run to start from: a state, joint coordinates, turns, guesses of nodes.

use mbd_scene::similar::near_and_all;
use mbd_scene::{Float, JointStart, PlacementReport, StartFrom, StartNumber, place_declared};

use super::ModelRun;
use super::start::{declared_start, misplaced};
use crate::columns::state_names;
use crate::error::{RunError, StepError};
use crate::laws::params_of;
use crate::origin::MovingOrigin;
use crate::system::WORKS;
use crate::trim::Trimmed;

/// The latest time of a state, and the earliest below zero [s].
const LATEST: f64 = 1e12;

impl<T: Float> ModelRun<T> {
    /// What [`Simulation::set_state`] does.
    pub(crate) fn give_state(&mut self, time: f64, state: &[T]) -> Result<(), RunError> {
        let checked = self.check_state(time, state);
        checked.map_err(|cause| self.failed(cause))?;
        let numbers: Vec<f64> = state.iter().map(|x| x.to_f64()).collect();
        self.put(time, None, &numbers)?;
        self.joints_set.clear();
        self.assembly = PlacementReport::default();
        Ok(())
    }

    /// What [`Simulation::set_rest`] does.
    pub(crate) fn give_rest(&mut self, rest: &Trimmed) -> Result<(), RunError> {
        let numbers = |list: &[f64]| -> Vec<T> { list.iter().map(|&x| T::from_f64(x)).collect() };
        let checked = self.check_state(self.time, &numbers(&rest.state));
        checked.map_err(|cause| self.failed(cause))?;
        self.give_inputs(None, &numbers(&rest.inputs))?;
        self.stand_at(self.time, None, &rest.state)?;
        self.system.recall(&rest.remembered);
        self.joints_set.clear();
        self.assembly = PlacementReport::default();
        match rest.nodes.is_empty() {
            true => Ok(()),
            false => self.give_nodes(&numbers(&rest.nodes)),
        }
    }

    /// Begins another run from a state that is measured from an origin, `None` that of the world; what actions changed is taken back.
    pub(super) fn put(
        &mut self,
        time: f64,
        origin: Option<MovingOrigin>,
        state: &[f64],
    ) -> Result<(), RunError> {
        self.stand_at(time, origin, state)?;
        self.take_back_actions()?;
        self.events.clear();
        self.changes.all.clear();
        self.system.remember_starts(&[], (time, &self.state));
        Ok(())
    }

    /// Takes a state, whatever is detached and locked.
    fn stand_at(
        &mut self,
        time: f64,
        origin: Option<MovingOrigin>,
        state: &[f64],
    ) -> Result<(), RunError> {
        let mut fresh = self.system.set_down(time, origin, state);
        let drift = self.system.normalise(&mut fresh);
        if let Some(refused) = StepError::quaternion(drift) {
            return Err(self.failed(refused));
        }
        self.shown.forget();
        self.system.drift = drift;
        for (to, from) in self
            .state
            .iter_mut()
            .zip(fresh.into_iter().chain([T::zero(); WORKS]))
        {
            *to = from;
        }
        self.time = time;
        self.as_declared = false;
        self.started = false;
        for sampler in &mut self.samplers {
            (sampler.from, sampler.next) = (time, 0);
        }
        Ok(())
    }

    /// After other params the declared start is another one, and so is one by joint coordinates, unless a state has been set or run.
    pub(crate) fn start_again(&mut self) -> Result<(), RunError> {
        if !self.as_declared {
            return Ok(());
        }
        let (time, inputs) = (self.time, self.inputs_now());
        let set = std::mem::take(&mut self.joints_set);
        if let Ok((start, assembly)) = declared_start(&*self.system.model, time, Some(&inputs)) {
            self.begin_at(start, assembly);
        }
        match set.is_empty() {
            true => Ok(()),
            false => self.set_again(&set),
        }
    }

    /// Joint coordinates that were set before.
    pub(super) fn set_again(&mut self, set: &[(String, StartNumber)]) -> Result<(), RunError> {
        let set: Vec<(&str, StartNumber)> =
            set.iter().map(|(name, x)| (name.as_str(), *x)).collect();
        self.give_joints(&set)
    }

    /// Stands at the declared start, in the world.
    pub(super) fn begin_at(&mut self, start: Vec<f64>, assembly: PlacementReport) {
        self.shown.forget();
        self.assembly = assembly;
        let start = self.system.set_down(self.time, None, &start);
        for (slot, value) in self.state.iter_mut().zip(start) {
            *slot = value;
        }
        self.system.remember_starts(&[], (self.time, &self.state));
    }

    /// The inputs of now [SI].
    pub(super) fn inputs_now(&self) -> Vec<f64> {
        self.system.inputs.iter().map(|x| x.to_f64()).collect()
    }

    /// Refuses a time or a state that cannot be run.
    pub(super) fn check_state(&self, time: f64, state: &[T]) -> Result<(), StepError> {
        let (model, nx) = (&self.system.model, self.system.nx);
        let bad = |x: &T| !x.is_finite() || x.to_f64().abs() > 1e150;
        if state.len() != nx {
            return Err(StepError::length("state", state.len(), nx));
        }
        let (slot, value) = if !time.is_finite() {
            ("time".into(), time)
        } else if time.abs() > LATEST {
            let slot = "time (beyond 1e12 s nothing shorter than 4 ms is resolved; let it begin near zero)";
            (slot.into(), time)
        } else if let Some(at) = state.iter().position(bad) {
            let name = state_names(model.scene(), model.layout())
                .into_iter()
                .nth(at);
            let name = name.map_or_else(String::new, |name| name.name);
            (name, state.get(at).map_or(f64::NAN, |x| x.to_f64()))
        } else {
            return Ok(());
        };
        Err(StepError::InvalidInput { slot, value })
    }

    /// What [`Simulation::set_joints`] does.
    pub(crate) fn give_joints(&mut self, given: &[(&str, StartNumber)]) -> Result<(), RunError> {
        let model = self.system.model.clone();
        let (scene, layout) = (model.scene(), model.layout());
        let starts = self.joint_starts(given)?;
        let params = params_of(model.params());
        let mut state: Vec<f64> = self.system.in_world(self.time, &self.state).collect();
        let inputs = self.inputs_now();
        let from = StartFrom::new(&params, self.time).with_inputs(&inputs);
        let assembly = place_declared(scene, layout, from, &starts, &[], &mut state)
            .map_err(|error| self.failed(misplaced(scene, error)))?;
        let numbers: Vec<T> = state.iter().map(|&x| T::from_f64(x)).collect();
        let checked = self.check_state(self.time, &numbers);
        checked.map_err(|cause| self.failed(cause))?;
        let as_declared = self.as_declared;
        self.put(self.time, None, &state)?;
        self.as_declared = as_declared;
        self.system
            .remember_starts(&starts, (self.time, &self.state));
        let set = given.iter().map(|(name, said)| ((*name).to_owned(), *said));
        self.joints_set = set.collect();
        self.assembly = assembly;
        Ok(())
    }

    /// What [`Simulation::set_joint`] does.
    pub(crate) fn give_joint(&mut self, name: &str, said: StartNumber) -> Result<(), RunError> {
        let set = self.joints_set.clone();
        let others = set.iter().filter(|(known, _)| known != name);
        let mut all: Vec<(&str, StartNumber)> =
            others.map(|(name, said)| (name.as_str(), *said)).collect();
        all.push((name, said));
        self.give_joints(&all)
    }

    /// What [`Simulation::set_turns`] does.
    pub(crate) fn give_turns(&mut self, given: &[(&str, f64)]) -> Result<(), RunError> {
        let exact: Vec<(&str, StartNumber)> =
            given.iter().map(|(name, x)| (*name, (*x).into())).collect();
        let starts = self.joint_starts(&exact)?;
        self.system
            .remember_starts(&starts, (self.time, &self.state));
        Ok(())
    }

    /// Starts of joints by the names of their coordinates.
    fn joint_starts(&self, given: &[(&str, StartNumber)]) -> Result<Vec<JointStart>, RunError> {
        let scene = self.system.model.scene();
        let mut all = given.iter();
        if let Some((name, said)) = all.find(|(_, said)| !said.number().is_finite()) {
            let (slot, value) = ((*name).to_owned(), said.number());
            return Err(self.failed(StepError::InvalidInput { slot, value }));
        }
        JointStart::by_name(scene, given.iter().copied()).map_err(|name| {
            let known = scene.joint_coordinates();
            let known = near_and_all(name, known.iter().map(String::as_str));
            let why = format!("is no joint coordinate{known}");
            let name = name.to_owned();
            self.failed(StepError::UnknownName { name, why })
        })
    }

    /// What [`Simulation::set_nodes`] does.
    pub(crate) fn give_nodes(&mut self, guess: &[T]) -> Result<(), RunError> {
        let expected = 3 * self.system.model.layout().nodes.len();
        if guess.len() != expected {
            let wrong = StepError::length("positions of the nodes", guess.len(), expected);
            return Err(self.failed(wrong));
        }
        if let Some(bad) = guess.iter().find(|x| !x.is_finite()) {
            let (slot, value) = ("positions of the nodes".into(), bad.to_f64());
            return Err(self.failed(StepError::InvalidInput { slot, value }));
        }
        self.guess = Some(self.system.near_origin(self.time, guess));
        self.started = false;
        Ok(())
    }
}
