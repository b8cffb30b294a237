//! Everything a run needs to go on exactly as it would have.

use mbd_scene::Float;
use serde::{Deserialize, Serialize};

use super::{ModelRun, Pace};
use crate::balance::EnergyBalance;
use crate::error::{RunError, StepError};
use crate::fallback::SavedStrategy;
use crate::identity;
use crate::integrate::{Control, StiffnessTest};
use crate::momentum::MomentumBalance;
use crate::node::NodeMemory;
use crate::origin::MovingOrigin;
use crate::rearm::Rearmed;
use crate::rounding::{StepRounding, TimeRounding};
use crate::state_rounding::StateRounding;
use crate::supply::{Sampler, check_numbers};
use crate::trajectory::resolution;
use crate::watch::Watch;

/// The rates that the next step begins with. They are those on one side of what jumps there, and the last stage of a step may have been evaluated before
/// an event that is close behind it: nothing else tells which.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct FirstStage<T> {
    rates: Vec<T>,
    /// All params, for which they are.
    params: Vec<T>,
    /// What functions of time and state gave at the end of the last call.
    supplied: Vec<T>,
    /// Whether what is held has changed since.
    stale: bool,
}

/// Everything a run needs to go on exactly as it would have: same model, same options, same bits.
///
/// The inputs that are held belong to it, and when each controller is called next. What functions of time and state and controllers remember does
/// not: give the run they are restored into the same ones, in the same order. Params are those of the run they are restored into, but for those that
/// events had set.
///
/// It can be written by whatever `serde` writes, and read in another process. A format must give back numbers as they were: `serde_json` does with its
/// feature `float_roundtrip`, and is off in the last digit without it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Snapshot<T> {
    scene: u64,
    time: f64,
    origin: f64,
    count: u64,
    /// Steps of the run: what is looked at now and then is looked at after the same ones.
    #[serde(default)]
    steps: u64,
    state: Vec<T>,
    /// Without rates in a snapshot that was written before they were kept.
    #[serde(default)]
    first: FirstStage<T>,
    /// What rounding took from the state, in single precision.
    #[serde(default = "Vec::new")]
    lost: Vec<T>,
    memory: NodeMemory<T>,
    control: Option<Control>,
    watch: Watch,
    stiffness: StiffnessTest,
    /// Whether the stiff method makes the steps.
    stiff: bool,
    watch_weights: Vec<T>,
    balance: Option<EnergyBalance>,
    momentum: Option<MomentumBalance>,
    sides: Vec<bool>,
    #[serde(default, alias = "turned_back")]
    rearmed: Vec<Rearmed>,
    /// Per margin what of a guard that the joints hold is rounding; empty in a snapshot that was written before it was kept.
    #[serde(default)]
    held_guards: Vec<Option<f64>>,
    /// Whether a switch happened at this time without a step.
    #[serde(default)]
    stalled: bool,
    /// The most that rounding of positions and of time made so far.
    #[serde(default)]
    rounded: f64,
    #[serde(default)]
    time_rounding: TimeRounding,
    #[serde(default)]
    step_rounding: StepRounding,
    #[serde(default)]
    state_rounding: StateRounding,
    drift: f64,
    rows: SavedStrategy,
    /// The inputs that are held, and whether that is nobody's gift.
    held: (Vec<T>, bool),
    /// Per controller the first sample [s] and the number of the next.
    samples: Vec<(f64, u64)>,
    /// Per controller the interval [s]; empty in a snapshot that was written before it was kept.
    #[serde(default)]
    periods: Vec<f64>,
    /// The params that events may set, in the order of their declaration, and what they are before an event sets them; the latter is empty in a snapshot
    /// that was written before it was kept.
    params: Vec<T>,
    #[serde(default = "Vec::new")]
    own_params: Vec<T>,
    /// Per event whether it has acted.
    done: Vec<bool>,
    /// Work of the actions so far [J].
    action_work: f64,
    /// Whether a closure of the caller had panicked.
    #[serde(default)]
    interrupted: bool,
    /// What the state is measured from, where the origin follows something.
    #[serde(default)]
    from: Option<MovingOrigin>,
}

impl<T> Snapshot<T> {
    /// Time of the snapshot [s].
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }
}

impl<T: Float> ModelRun<T> {
    /// What [`Simulation::snapshot`] does.
    pub(crate) fn save(&self) -> Snapshot<T> {
        Snapshot {
            interrupted: self.under_way,
            ..self.kept()
        }
    }

    /// The same in the middle of what the run does.
    pub(super) fn kept(&self) -> Snapshot<T> {
        let mut snapshot = Snapshot {
            scene: self.fingerprint(),
            ..Snapshot::default()
        };
        self.save_into(&mut snapshot);
        snapshot
    }

    /// Writes a snapshot of this run into the room of another one of it.
    pub(super) fn save_into(&self, to: &mut Snapshot<T>) {
        to.time = self.time;
        to.origin = self.origin;
        to.count = self.count;
        to.steps = self.steps_of_run();
        to.state.clone_from(&self.state);
        to.first.stale = self.stale;
        for (kept, own) in [
            (&mut to.first.rates, self.method.first()),
            (&mut to.first.params, self.system.model.params()),
            (&mut to.first.supplied, &self.left),
        ] {
            kept.clear();
            kept.extend_from_slice(own);
        }
        to.lost.clear();
        to.lost.extend_from_slice(self.method.lost());
        to.from = self.system.origin();
        to.memory.copy_from(&self.system.memory);
        to.control = match &self.pace {
            Pace::Fixed(_) => None,
            Pace::Adaptive(control, _) => Some(control.saved()),
        };
        to.watch = self.watch;
        (to.stiffness, to.stiff) = (self.stiffness, self.method.is_stiff());
        to.watch_weights.clone_from(&self.watch_weights);
        to.balance = self.balance;
        to.momentum = self.momentum;
        to.sides.clone_from(&self.margins.sides);
        to.rearmed.clone_from(&self.margins.rearmed);
        to.held_guards.clone_from(&self.margins.held);
        to.stalled = self.stalled == self.time;
        to.rounded = self.rounded;
        to.time_rounding.copy_from(&self.time_rounding);
        to.step_rounding = self.step_rounding;
        to.state_rounding.copy_from(&self.state_rounding);
        to.drift = self.system.drift;
        self.system.fallback.save(&mut to.rows);
        to.held.0.clone_from(&self.system.held);
        to.held.1 = self.system.unsupplied;
        let all = [self.system.model.params(), &self.changes.own];
        for (kept, all) in [&mut to.params, &mut to.own_params].into_iter().zip(all) {
            let settable = self.changes.settable.iter();
            kept.clear();
            kept.extend(settable.filter_map(|&param| all.get(param)));
        }
        to.done.clone_from(&self.changes.done);
        to.action_work = self.system.action_work;
        to.samples.clear();
        let samplers = self.samplers.iter();
        to.samples
            .extend(samplers.map(|sampler| (sampler.from, sampler.next)));
        to.periods.clear();
        let samplers = self.samplers.iter();
        to.periods.extend(samplers.map(|sampler| sampler.period));
    }

    /// Refuses a snapshot of something else, and numbers that no run can have had: it may have been read from a file.
    fn check_snapshot(&self, snapshot: &Snapshot<T>) -> Result<(), StepError> {
        let same = "restore it into a simulation made with the same model, options and controllers";
        let refuse = |what: &str, instead: &str| {
            let (what, instead) = (what.to_owned(), instead.to_owned());
            Err(StepError::Unsupported { what, instead })
        };
        let fits = snapshot.scene == self.fingerprint()
            && snapshot.state.len() == self.state.len()
            && (snapshot.lost.is_empty() || snapshot.lost.len() == self.state.len())
            && (snapshot.first.rates.is_empty() || snapshot.first.rates.len() == self.state.len())
            && snapshot.memory.check(self.system.model.layout()).is_ok()
            && snapshot.sides.len() == self.margins.sides.len()
            // One that was written before they were kept has none.
            && (snapshot.rearmed.is_empty() || snapshot.rearmed.len() == self.margins.rearmed.len())
            && (snapshot.held_guards.is_empty() || snapshot.held_guards.len() == self.margins.held.len())
            && snapshot.held.0.len() == self.system.held.len()
            && snapshot.params.len() == self.changes.settable.len()
            && (snapshot.own_params.is_empty() || snapshot.own_params.len() == snapshot.params.len())
            && snapshot.done.len() == self.changes.done.len()
            && snapshot.samples.len() == self.samplers.len()
            && snapshot.from.is_some() == self.system.following.is_some()
            && snapshot.control.is_some() == matches!(self.pace, Pace::Adaptive(..))
            && (self.method.has_both() || snapshot.stiff == self.method.is_stiff());
        if !fits {
            return refuse(
                "a snapshot of another model or method, or of other controllers",
                same,
            );
        }
        if snapshot.watch_weights.is_empty() && self.system.nx > 0 {
            let instead = "start the run before (`Simulation::start`), or make a new one";
            return refuse("a snapshot of a run that had not started", instead);
        }
        if snapshot.interrupted {
            return Err(StepError::Interrupted);
        }
        let kept = snapshot.periods.iter();
        let own = self.samplers.iter().map(|sampler| &sampler.period);
        if !snapshot.periods.is_empty() && !kept.eq(own) {
            return refuse("a snapshot of controllers with other periods", same);
        }
        let state = snapshot.state.get(..self.system.nx).unwrap_or_default();
        self.check_state(snapshot.time, state)?;
        check_numbers(&*self.system.model, &snapshot.held.0)?;
        let now = resolution(snapshot.time);
        let due = |(sampler, (from, next)): (&Sampler<T>, &(f64, u64))| {
            let left = from + *next as f64 * sampler.period - snapshot.time;
            left >= -now && left <= sampler.period + now
        };
        let whole = snapshot.watch_weights.len() == self.system.nx
            && [&snapshot.lost, &snapshot.first.rates]
                .into_iter()
                .flatten()
                .all(|x| x.is_finite())
            && self.samplers.iter().zip(&snapshot.samples).all(due)
            && snapshot.control.as_ref().is_none_or(Control::check);
        match whole {
            true => Ok(()),
            false => refuse(
                "a snapshot that has been changed",
                "take the one that was written",
            ),
        }
    }

    fn fingerprint(&self) -> u64 {
        let model = &self.system.model;
        let own = || identity::of_state(model.scene(), model.layout());
        *self.fingerprint.get_or_init(own)
    }

    /// Runs with what events had set; of the params that none had set each is that of this run.
    fn take_up_params(&mut self, snapshot: &Snapshot<T>) -> Result<(), StepError> {
        let mut params = self.system.model.params().to_vec();
        for (number, &param) in self.changes.settable.iter().enumerate() {
            let [now, before] = [&snapshot.params, &snapshot.own_params].map(|it| it.get(number));
            let value = match now == before {
                true => self.changes.own.get(param),
                false => now,
            };
            if let (Some(slot), Some(&value)) = (params.get_mut(param), value) {
                *slot = value;
            }
        }
        if params == self.system.model.params() {
            return Ok(());
        }
        let taken = self.take_params(&params);
        taken.map_err(|error| StepError::Unsupported {
            what: format!("a snapshot whose events had set what cannot be run ({error})"),
            instead: "restore it into a simulation made with the params it was made with".into(),
        })
    }

    /// Begins the next step with the rates of a snapshot. Those of other params are no rates of this run, which begins anew, on an event behind it.
    fn resume_first_stage(&mut self, first: &FirstStage<T>) -> Result<(), StepError> {
        if first.rates.is_empty() || first.params != self.system.model.params() {
            return self.begin_behind();
        }
        self.method.first_mut().copy_from_slice(&first.rates);
        self.left.extend_from_slice(&first.supplied);
        self.stale = first.stale;
        Ok(())
    }

    /// What [`Simulation::restore`] does.
    pub(crate) fn continue_from(&mut self, snapshot: &Snapshot<T>) -> Result<(), RunError> {
        self.whole(|run| run.take_up(snapshot))
    }

    /// The same in a run that goes back to where it was.
    pub(super) fn take_up(&mut self, snapshot: &Snapshot<T>) -> Result<(), RunError> {
        let checked = self.check_snapshot(snapshot);
        checked.map_err(|cause| self.failed(cause))?;
        self.take_up_params(snapshot)
            .map_err(|cause| self.failed(cause))?;
        self.shown.forget();
        self.joints_set.clear();
        self.system.take_up_origin(snapshot.from);
        self.changes.done.clone_from(&snapshot.done);
        self.changes.stop = None;
        self.system.action_work = snapshot.action_work;
        self.time = snapshot.time;
        // What happened later has not happened.
        self.events.retain(|it| it.time <= snapshot.time);
        self.changes.all.retain(|it| it.time <= snapshot.time);
        (self.origin, self.count) = (snapshot.origin, snapshot.count);
        self.steps_elsewhere = snapshot.steps.wrapping_sub(self.system.counters.steps);
        if let Pace::Fixed(size) = self.pace
            && (self.origin + self.count as f64 * size - self.time).abs() > resolution(self.time)
        {
            // Steps of another size count from here.
            (self.origin, self.count) = (self.time, 0);
        }
        self.state.copy_from_slice(&snapshot.state);
        self.system.memory = snapshot.memory.clone();
        self.system.memory.make_room();
        self.system.take_up_turns();
        self.system.drift = snapshot.drift;
        let (held, unsupplied) = &snapshot.held;
        self.system.hold(held);
        self.system.unsupplied = *unsupplied;
        self.stale = false;
        self.left.clear();
        for (sampler, saved) in self.samplers.iter_mut().zip(&snapshot.samples) {
            (sampler.from, sampler.next) = *saved;
        }
        self.watch = snapshot.watch;
        self.stiffness = snapshot.stiffness;
        self.method.resume(snapshot.stiff);
        self.method.set_lost(&snapshot.lost);
        self.balance = snapshot.balance;
        self.momentum = snapshot.momentum;
        self.margins.sides.copy_from_slice(&snapshot.sides);
        let rearmed = self.margins.rearmed.iter_mut();
        let saved = rearmed.zip(&snapshot.rearmed);
        saved.for_each(|(own, saved)| *own = *saved);
        self.margins.held.fill(None);
        let held = self.margins.held.iter_mut();
        let saved = held.zip(&snapshot.held_guards);
        saved.for_each(|(own, saved)| *own = *saved);
        self.stalled = match snapshot.stalled {
            true => snapshot.time,
            false => f64::NAN,
        };
        self.chatter.forget();
        self.rounded = snapshot.rounded;
        self.time_rounding.copy_from(&snapshot.time_rounding);
        self.step_rounding = snapshot.step_rounding;
        self.state_rounding.copy_from(&snapshot.state_rounding);
        if let (Pace::Adaptive(control, _), Some(saved)) = (&mut self.pace, &snapshot.control) {
            control.resume(saved);
        }
        self.started = true;
        self.as_declared = false;
        self.watch_weights.clone_from(&snapshot.watch_weights);
        self.system.fallback.resume(&snapshot.rows);
        let ahead = self.behind_jump();
        let begun = self
            .method
            .begin(&mut self.system, self.time + ahead, 0.0, &self.state);
        self.system.fallback.commit();
        self.resume_watch(snapshot);
        self.system.count_turns(self.time, &self.state);
        let commanded = self.system.follow_commands(self.time, None, &self.state);
        commanded.map_err(|cause| self.failed(cause))?;
        let begun = begun.and_then(|()| match snapshot.held_guards.is_empty() {
            true => self
                .begin_margins(&mut |_| ())
                .and_then(|()| self.find_held_guards()),
            // What is due, though its action could not be, stays due.
            false => self.resume_margins(),
        });
        let begun = begun.and_then(|()| self.resume_first_stage(&snapshot.first));
        begun.map_err(|cause| self.failed(cause))
    }
}
