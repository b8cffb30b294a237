//! Cases of a batch, flown: each a fresh run of its own, so that nothing of one case is seen by another. Several may be under way at once, whose
//! steps are then tried beside each other.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::Instant;

use mbd_scene::{Float, Model};

use super::case::{Case, Failed, Finished, Why};
use super::queue::Desk;
use crate::compiled::Scalar;
use crate::content::Content;
use crate::error::{RunError, Statistics, StepError};
use crate::lanes::{Lane, Runs};
use crate::metric::MetricReader;
use crate::options::Options;
use crate::simulation::{Course, Simulation, Stop};
use crate::trajectory::{Joined, Sampling, Trajectory};

/// What the caller does with a fresh run before it begins.
pub(super) type Prepare<'b, T> =
    Box<dyn Fn(&Case<T>, &mut Simulation<T>) -> Result<(), RunError> + Sync + 'b>;

/// A run of a case that an event ended: what [`Batch::then`](super::Batch::then) is asked about.
pub struct Ended<'e, T: Float = f64> {
    /// Where it stands.
    pub run: &'e mut Simulation<T>,
    /// Which model it is of, by its index in the [`Joined`] columns; 0 is that of the batch.
    pub model: usize,
    /// The event, by its index in the scene of that model.
    pub event: usize,
    /// How many runs of this case came before it.
    pub before: usize,
}

/// The run that goes on with a case: see [`Batch::then`](super::Batch::then).
pub struct Onward<T: Float = f64> {
    /// Which model it is of, by its index in the [`Joined`] columns.
    pub model: usize,
    /// The run, which took over: [`Simulation::take_over`].
    pub run: Simulation<T>,
    /// Its history, with nothing in it.
    pub history: Trajectory,
}

/// What goes on after an event, by the caller, and the columns of all models.
pub(super) struct Then<'b, T: Scalar> {
    pub columns: &'b Joined,
    pub next: Box<FindOnward<'b, T>>,
}

/// Finds the run that goes on with a case, if one does.
pub(super) type FindOnward<'b, T> =
    dyn Fn(&Case<T>, Ended<'_, T>) -> Result<Option<Onward<T>>, RunError> + Sync + 'b;

/// What all cases of a batch share.
pub(super) struct Flights<'b, T: Scalar> {
    pub model: Arc<dyn Model<T>>,
    pub options: Options,
    pub until: f64,
    pub prepare: Option<Prepare<'b, T>>,
    pub then: Option<Then<'b, T>>,
    /// When a row of each history is written, and what it holds.
    pub record: (Sampling, Content),
    /// What it measures, where that is not what the model declares.
    pub measured: Option<Vec<MetricReader>>,
    /// The number of the first case.
    pub first: usize,
    /// The most cases that a thread has under way at once.
    pub beside: usize,
}

/// A case under way.
struct FlyingCase<T: Scalar> {
    case: Case<T>,
    /// Its run, once it has begun; it stays where it stops.
    run: Option<(Simulation<T>, Course)>,
    /// Which model the run is of: 0 is that of the batch.
    model: usize,
    history: Trajectory,
    /// The histories of the runs that this one goes on from, with their models, and what these cost.
    earlier: Vec<(usize, Trajectory)>,
    cost: Statistics,
    /// Energy that these made or lost, over the energy that moved: the most of them.
    unbalanced: Option<f64>,
    began: Instant,
    /// Steps that were tried beside those of other cases.
    beside: u64,
}

/// How a turn of a flight ended.
enum Advance {
    /// There is more to come.
    GoesOn,
    Ended(Result<(), Why>),
}

impl<T: Scalar> Flights<'_, T> {
    /// Flies what the desk has until there is no more; `cancelled` says when to give up, `judge` makes something of each history.
    pub fn work<R>(
        &self,
        desk: &dyn Desk<Case<T>, Finished<R, T>>,
        judge: &impl Fn(&Case<T>, &Trajectory) -> R,
        cancelled: &dyn Fn() -> bool,
    ) {
        let mut together = match self.beside {
            1 => None,
            width => T::together(&*self.model, width),
        };
        let beside = if together.is_some() { self.beside } else { 1 };
        let mut flights: Vec<Option<FlyingCase<T>>> = (0..beside).map(|_| None).collect();
        // A history is as large as a run: each is used again.
        let mut histories: Vec<Trajectory> = Vec::with_capacity(beside);
        let mut go_on = |_| !(desk.stops() || cancelled());
        loop {
            for place in 0..beside {
                if flights.get(place).is_some_and(Option::is_some) {
                    continue;
                }
                let idle = flights.iter().all(Option::is_none);
                if let Some(empty) = flights.get_mut(place)
                    && let Some((number, case)) = desk.take(idle)
                {
                    *empty = Some(self.take_off((self.first + number, case), histories.pop()));
                }
            }
            if flights.iter().all(Option::is_none) {
                return;
            }
            if let Some(together) = &mut together {
                together.make_steps(&mut flights);
            }
            // What a case has to do is done before the next one's memory is touched.
            for (lane, slot) in flights.iter_mut().enumerate() {
                let Some(flight) = slot else { continue };
                let once = together.is_some();
                if together.as_ref().is_some_and(|it| it.goes_on(lane)) {
                    continue;
                }
                let left = match (&mut together, flight.lane()) {
                    (Some(together), Some(own)) => together.hand_over(lane, own),
                    _ => true,
                };
                let advanced = match left {
                    true => self.advance(flight, once, &mut go_on),
                    false => Advance::GoesOn,
                };
                let Advance::Ended(result) = advanced else {
                    if let (Some(together), Some(own)) = (&mut together, flight.lane()) {
                        together.take_up(lane, own);
                    }
                    continue;
                };
                if let Some(flight) = slot.take() {
                    let number = flight.case.number - self.first;
                    let columns = self.then.as_ref().map(|then| then.columns);
                    let (finished, history) = flight.land(result, columns, judge);
                    histories.push(history);
                    desk.give(number, finished);
                }
            }
        }
    }

    fn take_off(
        &self,
        (number, mut case): (usize, Case<T>),
        history: Option<Trajectory>,
    ) -> FlyingCase<T> {
        case.number = number;
        let (sampling, content) = &self.record;
        let fresh = || {
            let fresh = Trajectory::new(&*self.model, sampling.clone(), *content);
            match &self.measured {
                Some(readers) => fresh.measure(&*self.model, readers),
                None => fresh,
            }
        };
        let mut history = history.unwrap_or_else(fresh);
        history.clear();
        FlyingCase {
            case,
            run: None,
            model: 0,
            history,
            earlier: Vec::new(),
            cost: Statistics::default(),
            unbalanced: None,
            began: Instant::now(),
            beside: 0,
        }
    }

    /// Begins a flight, or tries its next step; all of them where it is alone.
    fn advance(
        &self,
        flight: &mut FlyingCase<T>,
        once: bool,
        go_on: &mut dyn FnMut(f64) -> bool,
    ) -> Advance {
        let advanced = catch_unwind(AssertUnwindSafe(|| -> Result<bool, Why> {
            if flight.run.is_none() {
                if !go_on(0.0) {
                    return Err(Why::Run(cancelled()));
                }
                self.begin(&flight.case, &mut flight.run)?;
            }
            while let Some((run, course)) = &mut flight.run {
                let history = &mut Some(&mut flight.history);
                let stop = T::follow(&mut run.run, course, history, go_on).map_err(Why::Run)?;
                let ended = match stop {
                    Some(stop) => !self.goes_on(flight, stop).map_err(Why::Run)?,
                    None => false,
                };
                if once || ended {
                    return Ok(ended);
                }
            }
            Ok(true)
        }));
        match advanced {
            Ok(Ok(false)) => Advance::GoesOn,
            Ok(Ok(true)) => Advance::Ended(Ok(())),
            Ok(Err(why)) => Advance::Ended(Err(why)),
            Err(words) => Advance::Ended(Err(Why::Panic(spoken(&*words)))),
        }
    }

    /// Begins a case; `run` keeps it, also where it stops.
    fn begin(&self, case: &Case<T>, run: &mut Option<(Simulation<T>, Course)>) -> Result<(), Why> {
        let own = match &case.params {
            Some(params) => (params.check)(self.model.scene())
                .and_then(|()| self.model.with_params(&params.values))
                .map_err(Why::Params)?,
            None => self.model.clone(),
        };
        let fresh = Simulation::new(&*own, self.options).map_err(Why::Run)?;
        let (run, course) = run.insert((fresh, Course::default()));
        self.prepare(case, run).map_err(Why::Run)?;
        *course = T::set_course(&mut run.run, self.until).map_err(Why::Run)?;
        Ok(())
    }

    /// Whether another run goes on with a case whose run stopped; that one is under way then.
    fn goes_on(&self, flight: &mut FlyingCase<T>, stop: Stop) -> Result<bool, RunError> {
        let (Stop::Event(event), Some(then), Some((run, _))) = (stop, &self.then, &mut flight.run)
        else {
            return Ok(false);
        };
        let (statistics, imbalance) = (run.statistics(), imbalance(run));
        let ended = Ended {
            run,
            model: flight.model,
            event,
            before: flight.earlier.len(),
        };
        let Some(onward) = (then.next)(&flight.case, ended)? else {
            return Ok(false);
        };
        let mut run = onward.run;
        let course = T::set_course(&mut run.run, self.until)?;
        let history = std::mem::replace(&mut flight.history, onward.history);
        flight.earlier.push((flight.model, history));
        flight.cost = flight.cost.and(statistics);
        flight.unbalanced = larger(flight.unbalanced, imbalance);
        flight.model = onward.model;
        flight.run = Some((run, course));
        Ok(true)
    }

    fn prepare(&self, case: &Case<T>, run: &mut Simulation<T>) -> Result<(), RunError> {
        if let Some((time, state)) = &case.state {
            run.set_state(*time, state)?;
        }
        if !case.joints.is_empty() {
            let joints = case.joints.iter();
            let joints: Vec<(&str, f64)> = joints.map(|(name, x)| (name.as_str(), *x)).collect();
            run.set_joints(&joints)?;
        }
        if let Some(nodes) = &case.nodes {
            run.set_nodes(nodes)?;
        }
        if let Some(inputs) = &case.inputs {
            T::give_inputs(&mut run.run, inputs.of, &inputs.numbers)?;
        }
        match &self.prepare {
            Some(prepare) => prepare(case, run),
            None => Ok(()),
        }
    }
}

impl<T: Scalar> Runs<T> for Vec<Option<FlyingCase<T>>> {
    fn lane(&mut self, lane: usize) -> Option<Lane<'_, T>> {
        self.get_mut(lane)?.as_mut()?.lane()
    }
}

impl<T: Scalar> FlyingCase<T> {
    /// Its run as one of several whose steps are made at once; `None` where it has none of the model of the batch.
    fn lane(&mut self) -> Option<Lane<'_, T>> {
        // What goes on is of another model.
        let is_first = self.earlier.is_empty();
        let (run, course) = self.run.as_mut().filter(|_| is_first)?;
        Some(Lane {
            run: &mut run.run,
            course,
            history: &mut self.history,
            count: &mut self.beside,
        })
    }

    /// The result of a flight that ended, `None` where it was given up, and its history in the model of the batch, to be used again.
    fn land<R>(
        self,
        ended: Result<(), Why>,
        columns: Option<&Joined>,
        judge: &impl Fn(&Case<T>, &Trajectory) -> R,
    ) -> (Option<Finished<R, T>>, Trajectory) {
        let FlyingCase {
            case,
            run,
            model,
            history,
            mut earlier,
            cost,
            unbalanced,
            began,
            beside,
        } = self;
        earlier.push((model, history));
        let whole = columns.filter(|_| ended.is_ok()).map(|columns| {
            let parts = earlier.iter().map(|(model, part)| (*model, part));
            columns.join(&parts.collect::<Vec<_>>())
        });
        let history = earlier.swap_remove(0).1;
        let result = ended.and_then(|()| {
            let whole = whole.as_ref().unwrap_or(&history);
            let judged = catch_unwind(AssertUnwindSafe(|| judge(&case, whole)));
            judged.map_err(|words| Why::Panic(spoken(&*words)))
        });
        if let Err(Why::Run(error)) = &result
            && error.cause == StepError::Cancelled
        {
            return (None, history);
        }
        let run = run.as_ref().map(|(run, _)| run);
        let finished = Finished {
            case: case.number,
            statistics: cost.and(run.map_or(Statistics::default(), Simulation::statistics)),
            imbalance: larger(unbalanced, run.and_then(imbalance)),
            result: result.map_err(|why| Failed {
                why,
                time: run.map_or(f64::NAN, Simulation::time),
                state: run.map_or(Vec::new(), |run| run.state().to_vec()),
            }),
            beside,
            seconds: began.elapsed().as_secs_f64(),
        };
        (Some(finished), history)
    }
}

/// Energy that a run made or lost over the energy that moved, where it can tell.
fn imbalance<T: Float>(run: &Simulation<T>) -> Option<f64> {
    run.imbalance().map(|it| it.relative())
}

/// The larger of what is known.
fn larger(one: Option<f64>, other: Option<f64>) -> Option<f64> {
    one.into_iter().chain(other).reduce(f64::max)
}

/// A run that is given up before it begins.
fn cancelled() -> RunError {
    RunError {
        cause: StepError::Cancelled,
        progress: Box::default(),
    }
}

/// The words of a panic.
fn spoken(words: &(dyn Any + Send)) -> String {
    let text = words.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = text.or_else(|| words.downcast_ref::<String>().cloned());
    text.unwrap_or_else(|| "without words".to_owned())
}
