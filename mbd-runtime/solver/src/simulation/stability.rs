//! Whether a run can be trusted: stages and energy of each step, the last good state, and the way back to it.

use mbd_scene::{Float, Gravity, Quantity};

use super::beside::Attempt;
use super::{ModelRun, Pace, Snapshot};
use crate::balance::{EnergyBalance, EnergyReading};
use crate::columns::part_name;
use crate::error::{Collapse, RunError, Source, StepError};
use crate::integrate::stiffness;
use crate::moving::moving;
use crate::rounding::{REFUSED, TimeRounding};
use crate::system::WORKS;
use crate::trajectory::Trajectory;
use crate::watch::{ENERGY, Instability, LIMIT, NEGLIGIBLE, Watch};

/// How many steps lie between two good states that are remembered, and between two looks at an energy that the laws must be asked for.
pub(super) const OFTEN: u64 = 10;
pub(super) const SELDOM: u64 = 50;
/// Step times largest rate that is suggested: what decays so fast is followed, and not only kept from growing.
const STABLE: f64 = 0.5;

/// How the energy of a run is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Meter {
    /// It is not.
    Nothing,
    /// By the model at every step; whether anything but motion, gravity and springs gives or takes it.
    Model { exchanges: bool },
    /// By the laws, now and then: the model was not asked to emit it, and nothing gives or takes it.
    Laws,
}

impl<T: Float> ModelRun<T> {
    /// Begins to watch a run at its start.
    pub(super) fn begin_watch(&mut self) -> Result<(), StepError> {
        self.watch = Watch::default();
        self.watch_weights = match &self.pace {
            Pace::Fixed(step) => self.system.watch_weights(self.time, &self.state, *step)?,
            Pace::Adaptive(_, norm) => {
                let (time, state) = (self.time, &self.state);
                let mut weights = self.system.watch_weights(time, state, norm.seconds())?;
                let layout = self.system.model.layout();
                norm.weigh_states(&mut weights, layout.nq..layout.nq + layout.nv);
                weights
            }
        };
        Ok(())
    }

    /// Begins to follow the energy of a run, once its first stage is evaluated.
    pub(super) fn begin_balance(&mut self) {
        self.meter = self.find_meter();
        let start = self.energy_behind();
        let places = moving(self.system.model.layout()).flat_map(|part| part.position);
        let places = places.filter_map(|place| self.state.get(place));
        let reach = places.fold(self.sizes.length(), |most, x| most.max(x.to_f64().abs()));
        self.balance = start.map(|start| {
            let mut balance =
                EnergyBalance::with_lines(0.5 * self.sizes.line_stiffness * reach * reach);
            balance.take_up(start);
            balance
        });
        self.good = self.watched.then(|| Box::new(self.kept()));
    }

    /// Goes on watching from a snapshot, once its first stage is evaluated.
    pub(super) fn resume_watch(&mut self, from: &Snapshot<T>) {
        self.meter = self.find_meter();
        if self.watched {
            self.good = Some(Box::new(from.clone()));
        }
    }

    fn find_meter(&mut self) -> Meter {
        self.judged = self.watched && !self.is_driven();
        let scene = self.system.model.scene();
        let exchanges = scene.exchanges_energy();
        let integrates = self.system.length() > self.system.nx;
        let tells = match self.pace {
            Pace::Fixed(_) => integrates || self.judged,
            Pace::Adaptive(..) => !exchanges || integrates,
        };
        let told = scene.gravity != Gravity::Field && scene.tells_node_work();
        if !self.options.watch || !tells || !told {
            return Meter::Nothing;
        }
        let model = Meter::Model { exchanges };
        match self.system.energy_and_power(model, self.time, &self.state) {
            Some(_) => model,
            None if exchanges => Meter::Nothing,
            None => Meter::Laws,
        }
    }

    /// Whether motions are prescribed: joints and frames that move put the run where it has to be, however long its steps, and what is wrong
    /// with the balance then is the work of what prescribes them.
    fn is_driven(&self) -> bool {
        let (scene, layout) = (self.system.model.scene(), self.system.model.layout());
        let moves = scene.world_frames.iter().any(|frame| frame.moves(scene));
        moves || layout.joints.iter().any(|slots| slots.driven)
    }

    /// Takes up the energy anew after something jumped.
    pub(crate) fn rebase(&mut self) {
        self.jumped = true;
        if self.balance.is_none() {
            return;
        }
        if let (Some(now), Some(balance)) = (self.energy_behind(), &mut self.balance) {
            balance.take_up(now);
        }
    }

    /// Looks at the attempted step before it is taken: the stages of a fixed step, then the energy at its end.
    ///
    /// # Errors
    /// The step is too long.
    pub(super) fn watch_step(&mut self, step: f64) -> Result<(), StepError> {
        if self.watched {
            let rho = self
                .method
                .stiffness(&self.watch_weights, [NEGLIGIBLE, LIMIT]);
            if self.watch.sees(rho) {
                return Err(self.unstable(step, Instability::Stages(rho)));
            }
        }
        if self.momentum.is_some() {
            self.follow_momentum(step);
        }
        match self.meter {
            Meter::Nothing => Ok(()),
            // The step to be taken is not counted yet.
            Meter::Laws if !self.steps_of_run().wrapping_add(1).is_multiple_of(SELDOM) => Ok(()),
            _ => self.watch_energy(step),
        }
    }

    /// Looks at a run that ends here, before a step beyond the limit could show itself often enough.
    ///
    /// # Errors
    /// All its steps were too long.
    pub(super) fn watch_end(&mut self) -> Result<(), StepError> {
        // Without a doubt in its stages the energy needs no look.
        let Pace::Fixed(step) = self.pace else {
            return Ok(());
        };
        if !self.watched || self.watch.sees_end(f64::NAN).is_none() {
            return Ok(());
        }
        let excess = match (self.meter, self.balance) {
            (Meter::Laws, Some(mut balance)) => {
                let now = self
                    .system
                    .energy_and_power(self.meter, self.time, &self.state);
                match now {
                    Some(now) => balance.take(step, 0.0, now),
                    None => return Ok(()),
                }
                self.excess(&balance)
            }
            _ => self.excess_now(),
        };
        match self.watch.sees_end(excess) {
            None => Ok(()),
            // The steps are behind.
            Some(what) => Err(StepError::UnstableStep {
                time: self.time,
                step_size: step,
                what,
                suggestion: what.suggestion(step),
            }),
        }
    }

    /// What watch and balance are after a step that was made elsewhere; `None` where they have something to say of it, or look inside.
    pub(super) fn watch_received(
        &self,
        attempt: &dyn Attempt<T>,
    ) -> Option<(Watch, Option<EnergyBalance>)> {
        let mut watch = self.watch;
        if self.watched && watch.sees(stiffness(attempt.squares(), NEGLIGIBLE)) {
            return None;
        }
        // The laws are asked at steps that are looked at anyway.
        let (Meter::Model { exchanges }, Some(mut balance)) = (self.meter, self.balance) else {
            return Some((watch, self.balance));
        };
        let now = self.meter.reading(attempt.energy()?.map(T::to_f64))?;
        let [_, step] = attempt.step();
        let work = match exchanges {
            true if balance.is_fresh(step) => return None,
            true => balance.work(step, None, now.power),
            false => 0.0,
        };
        balance.take(step, work, now);
        match watch.sees_energy(self.excess(&balance), 1) {
            true => None,
            false => Some((watch, Some(balance))),
        }
    }

    /// Looks at the energy at the end of the attempted step.
    fn watch_energy(&mut self, step: f64) -> Result<(), StepError> {
        let Some(mut balance) = self.balance else {
            return Ok(());
        };
        // Where the step ends on an event, what jumps there has not jumped yet.
        let end = self.time + step;
        let now = match self.system.sees_before() {
            false => self
                .system
                .energy_and_power(self.meter, end, self.method.next()),
            true => {
                self.inside.copy_from_slice(self.method.next());
                let end = [end, step];
                let end = self.system.end_before(end, &self.state, &mut self.inside);
                self.system.energy_and_power(self.meter, end, &self.inside)
            }
        };
        let Some(now) = now else {
            // What has a motion but no energy has overflowed.
            return match self.judged {
                true => Err(self.unstable(step, Instability::Energy(f64::INFINITY))),
                false => Ok(()),
            };
        };
        let work = self.work_of(&balance, step, &now);
        balance.add_up(self.works(self.method.next()).map(f64::abs).sum());
        balance.doubt(work * self.state_rounding.share_of_rates());
        balance.take(step, work, now);
        let excess = self.excess(&balance);
        let steps = if self.meter == Meter::Laws { SELDOM } else { 1 };
        if self.watch.sees_energy(excess, steps) {
            return Err(self.unstable(step, Instability::Energy(excess)));
        }
        self.balance = Some(balance);
        Ok(())
    }

    /// The works behind a state [J]; none in a run that does not integrate them.
    fn works(&self, state: &[T]) -> impl Iterator<Item = f64> {
        let behind = state.iter().skip(self.system.nx).take(WORKS);
        behind.map(|work| work.to_f64())
    }

    /// Work of what gives and takes energy in the attempted step [J].
    fn work_of(&mut self, balance: &EnergyBalance, step: f64, end: &EnergyReading) -> f64 {
        if self.system.length() > self.system.nx {
            let sum = |state: &[T]| self.works(state).sum::<f64>();
            return sum(self.method.next()) - sum(&self.state);
        }
        if !matches!(self.meter, Meter::Model { exchanges: true }) {
            return 0.0;
        }
        let middle = match balance.is_fresh(step) {
            true => self.power_inside(0.5, step),
            false => None,
        };
        balance.work(step, middle, end.power)
    }

    /// The power inside the attempted step [W].
    fn power_inside(&mut self, theta: f64, step: f64) -> Option<f64> {
        self.inside_state(theta, step).ok()?;
        let span = theta * step;
        let time = self.time + span;
        self.system.look(time, span, &self.inside).ok()?;
        let mut energy = self.system.energy;
        self.system
            .seen(Quantity::Energy, time, &self.inside, &mut energy);
        let power = energy.iter().skip(3).map(|power| power.to_f64()).sum();
        f64::is_finite(power).then_some(power)
    }

    /// The accepted steps of the run, wherever they were made: what is done now and then follows them.
    pub(super) fn steps_of_run(&self) -> u64 {
        let made = self.system.counters.steps;
        made.wrapping_add(self.steps_elsewhere)
    }

    /// Whether the step that is tried is one of those that are looked into: the first, the second, the fourth and so on, and one of `every` so many.
    pub(super) fn is_looked_into(&self, every: u64) -> bool {
        let number = self.steps_of_run().wrapping_add(1);
        number.is_power_of_two() || number.is_multiple_of(every)
    }

    /// After an accepted step, now and then: what rounding makes of forces there, and a state in which nothing grows is remembered.
    ///
    /// # Errors
    /// Positions so far from the origin that forces have no digits left.
    #[inline]
    pub(super) fn look_back(&mut self) -> Result<(), StepError> {
        // What is done more seldom is done at one of these steps, too.
        match self.steps_of_run().is_multiple_of(OFTEN) {
            true => self.look_back_now(),
            false => Ok(()),
        }
    }

    /// Whether looks back until a time ask for nothing but accepted states and their rates: no equations, and no good state to be remembered.
    pub(super) fn looks_back_plainly(&self, until: f64) -> bool {
        let remembers = self.watched || self.meter == Meter::Laws;
        let is_plain = !remembers && self.bodies.is_empty();
        let latest = self.time.abs().max(until.abs());
        is_plain && self.state_rounding.sees_lengths() && self.time_apart_at(latest).is_none()
    }

    fn look_back_now(&mut self) -> Result<(), StepError> {
        self.watch_rounding()?;
        self.watch_digits();
        self.watch_state_digits()?;
        self.watch_time()?;
        self.judge_time()?;
        self.remember_good();
        Ok(())
    }

    /// How far apart times are that formulas tell apart [s]; `None` where that is close enough, or nothing reads time.
    fn time_apart(&self) -> Option<f64> {
        self.time_apart_at(self.time)
    }

    fn time_apart_at(&self, time: f64) -> Option<f64> {
        let apart = TimeRounding::coarseness::<T>(time)?;
        let scene = self.system.model.scene();
        let says = self.reads_time.get_or_init(|| scene.reads_time());
        says.then_some(apart)
    }

    /// Looks at what follows time, here and at the next time that its formulas tell apart.
    pub(super) fn watch_time(&mut self) -> Result<(), StepError> {
        let Some(apart) = self.time_apart() else {
            return Ok(());
        };
        let layout = self.system.model.layout();
        let what = Quantity::Derivative;
        let (nodes, states) = (layout.nq + layout.nv, layout.states());
        let each = (states..layout.nx()).map(|at| at..at + 1);
        let parts: Vec<_> = [layout.nq..nodes, nodes..states]
            .into_iter()
            .chain(each)
            .collect();
        let mut here = vec![T::zero(); layout.len(what)];
        let mut next = here.clone();
        self.system
            .at_end(what, self.time, &self.state, &mut here)?;
        self.system
            .at_another_time(what, self.time + apart, &self.state, &mut next);
        self.time_rounding.see(
            parts
                .into_iter()
                .map(|part| [&here, &next].map(|list| list.get(part.clone()).unwrap_or_default())),
        );
        Ok(())
    }

    /// Refuses a run in which rounding of time makes a tenth of what follows it: once that is sure, or where adaptive steps, which resolve what moves,
    /// are shorter than what is between two times.
    fn judge_time(&self) -> Result<(), StepError> {
        let Some(apart) = self.time_apart() else {
            return Ok(());
        };
        let stands = match &self.pace {
            Pace::Fixed(_) => false,
            Pace::Adaptive(control, _) => control.step < apart,
        };
        match self.time_rounding.is_refused(stands) {
            true => Err(StepError::LateTime {
                time: self.time,
                apart,
                share: self.time_rounding.share(),
            }),
            false => Ok(()),
        }
    }

    pub(super) fn watch_rounding(&mut self) -> Result<(), StepError> {
        if !self.bodies.is_empty() {
            let (time, state) = (self.time, &self.state);
            self.system
                .at_end(Quantity::Bodies, time, state, &mut self.bodies)?;
        }
        let rates = self.method.first();
        let origin = self.system.origin().map_or(0.0, |origin| {
            let [position, _] = origin.at(self.time);
            position.iter().fold(0.0, |most, x| x.abs().max(most))
        });
        let worst = self
            .sizes
            .rounding
            .worst(&self.state, rates, &self.bodies, origin);
        let Some(affected) = worst else {
            return Ok(());
        };
        self.rounded = self.rounded.max(affected.share);
        if affected.share < REFUSED {
            return Ok(());
        }
        let scene = self.system.model.scene();
        Err(StepError::FarFromOrigin {
            part: part_name(scene, affected.part).to_owned(),
            distance: affected.distance,
            share: affected.share,
        })
    }

    /// Remembers a state in which nothing grows, now and then.
    fn remember_good(&mut self) {
        let every = if self.meter == Meter::Laws {
            SELDOM
        } else {
            OFTEN
        };
        if !self.watched || !self.steps_of_run().is_multiple_of(every) {
            return;
        }
        if self.watch.is_calm(self.excess_now()) {
            let mut good = self.good.take().unwrap_or_default();
            self.save_into(&mut good);
            self.good = Some(good);
        }
    }

    /// What steps that are too long made (positive) or lost of the energy that moved; zero in a run that is not judged by it.
    fn excess(&self, balance: &EnergyBalance) -> f64 {
        match self.judged {
            true => balance.excess(T::EPSILON.to_f64()),
            false => 0.0,
        }
    }

    /// The same at the last accepted step.
    fn excess_now(&self) -> f64 {
        let balance = self.balance.as_ref();
        balance.map_or(0.0, |balance| self.excess(balance))
    }

    /// Why a step cannot be made: where a fixed-step run has begun to grow, or a step is far beyond what the linear system where it starts allows, its
    /// step is too long, though joints come apart or numbers overflow first.
    #[cold]
    pub(super) fn blame(&mut self, step: f64, cause: StepError) -> StepError {
        let may_be_growth = matches!(
            cause,
            StepError::JointsApart { .. }
                | StepError::NonFinite {
                    source: Source::State(_) | Source::Declared(_),
                    ..
                }
        );
        if !self.watched || !may_be_growth {
            return cause;
        }
        // The energy that a step makes of a force that jumps inside it leads nowhere: where a law has no number stages grow, or the number is missing.
        let grows = match cause {
            StepError::NonFinite {
                source: Source::Declared(_),
                ..
            } => self.watch.sees_stages(),
            _ => self.watch.sees_growth(self.excess_now()),
        };
        let growth = grows.or_else(|| {
            let rate = self.system.fastest_rate(self.time, &self.state)?;
            Instability::beyond(rate * step)
        });
        // Energy knows nothing of declared states.
        let growth = growth.or_else(|| self.growing_states(step));
        match growth {
            Some(what) => self.unstable(step, what),
            None => cause,
        }
    }

    #[cold]
    pub(super) fn unstable(&self, step_size: f64, what: Instability) -> StepError {
        // Where formulas see time stand still over a step, or nearly so, a shorter one makes it worse.
        if let (Instability::Energy(part), Some(apart)) = (what, self.time_apart())
            && apart > 0.1 * step_size
            && self.time_rounding.share() > 0.0
        {
            return StepError::LateTime {
                time: self.time,
                apart,
                share: part.abs(),
            };
        }
        StepError::UnstableStep {
            time: self.time + step_size,
            step_size,
            what,
            suggestion: what.suggestion(step_size),
        }
    }

    /// After a step that is too long: back to the last good state, and what was recorded since is dropped. A step that grows at the state where it
    /// goes on from is not suggested: what stages show of a rate far above the step is less than it is. Where rounding of a large number makes rates jump, no
    /// step is short enough, and that is the cause.
    #[cold]
    pub(super) fn go_back(
        &mut self,
        cause: &mut StepError,
        trajectory: &mut Option<&mut Trajectory>,
    ) -> Result<(), RunError> {
        if let StepError::StepCollapse {
            cause: Collapse::ErrorTest,
            ..
        } = cause
            && let Some(large) = self.lacks_digits(ENERGY)
        {
            *cause = large;
        }
        let StepError::UnstableStep { what, .. } = *cause else {
            return Ok(());
        };
        if !self.watched {
            return Ok(());
        }
        let good = self.good.take().unwrap_or_default();
        let back = self.take_up(&good);
        self.good = Some(good);
        let time = self.time;
        self.events.retain(|event| event.time <= time);
        self.changes.all.retain(|acted| acted.time <= time);
        if let Some(trajectory) = trajectory {
            trajectory.cut(time);
        }
        if let Some(large) = self.lacks_digits(what.least_rounding()) {
            *cause = large;
        }
        if let StepError::UnstableStep { suggestion, .. } = cause
            && let Some(rate) = self.system.fastest_rate(time, &self.state)
        {
            *suggestion = suggestion.min(STABLE / rate);
        }
        back
    }
}

impl<T: Float> crate::system::System<T> {
    /// Energy and power at the stage that was evaluated last; `None` where one of them is not a number.
    pub(super) fn energy_and_power(
        &mut self,
        meter: Meter,
        time: f64,
        state: &[T],
    ) -> Option<EnergyReading> {
        let mut energy = [0.0; 6];
        match meter {
            Meter::Nothing => return None,
            Meter::Laws => self.by_laws(Quantity::Energy, time, state, &mut energy),
            Meter::Model { .. } => {
                self.supply(time, state.get(..self.nx).unwrap_or_default())
                    .ok()?;
                self.read_energy(time, state);
                for (to, from) in energy.iter_mut().zip(&self.energy) {
                    *to = from.to_f64();
                }
            }
        }
        meter.reading(energy)
    }
}

impl Meter {
    /// Energy and power of these numbers; `None` where one of them is not a number.
    fn reading(self, energy: [f64; 6]) -> Option<EnergyReading> {
        let [kinetic, gravitational, elastic, powers @ ..] = energy;
        let power = match self {
            Meter::Model { exchanges: true } => powers.iter().sum(),
            _ => 0.0,
        };
        let reading = EnergyReading {
            energies: [kinetic, gravitational, elastic],
            power,
        };
        let all = reading.energies.iter().chain([&reading.power]);
        all.fold(0.0, |sum, x| sum + x)
            .is_finite()
            .then_some(reading)
    }
}
