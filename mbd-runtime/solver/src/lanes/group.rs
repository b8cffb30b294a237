//! The steps of several runs tried beside each other, a run a lane, each with a clock and a step of its own.

use std::any::Any;
use std::convert::Infallible;
use std::sync::Arc;

use mbd_scene::{AngularVelocity, At, Float, Layout, Model, Quantity};

use super::form::{Beside, LaneParameters};
use super::joints::Joints;
use super::lockstep::normalise;
use super::networks::Networks;
use super::{Lanes, Lanes4, Lanes8};
use crate::node::Nodes;
use crate::simulation::beside::Attempt;
use crate::simulation::{Course, ModelRun};
use crate::system::{EndLooks, LISTS};
use crate::trajectory::Trajectory;

mod lists;
mod method;
mod own;
mod steps;
mod stiff;

pub(super) use lists::{faults, get, set};
use method::LaneMethod;
use own::{OwnStart, OwnStep};
use steps::{MadeSteps, Upcoming};

/// With fewer runs than this nothing is gained.
const FEWEST: usize = 2;
/// The most lanes there are.
const MOST: usize = 8;

/// A run in a lane.
pub struct Lane<'r, T: Float> {
    /// The run.
    pub run: &'r mut ModelRun<T>,
    /// Where it goes.
    pub course: &'r mut Course,
    /// What is recorded of it.
    pub history: &'r mut Trajectory,
    /// How many of its steps were tried beside those of others.
    pub count: &'r mut u64,
}

/// Tries the steps of several runs of one model at once: every run's next step is taken up, all are made, and every run takes over its own.
pub trait Together<T: Float> {
    /// Takes the start of the next step of a run into a lane, if it is of the kind that is made here.
    fn take_up(&mut self, lane: usize, of: Lane<'_, T>);
    /// Makes the steps that were taken up, by the networks of one of their runs.
    fn make_steps(&mut self, runs: &mut dyn Runs<T>);
    /// Whether the run of a lane took its step, and its next one is taken up, without its state being read: there is nothing else to be done for it.
    fn goes_on(&self, lane: usize) -> bool;
    /// Leaves the step of a lane, if one was made, where its run takes it from; `false` where the run took it already, because its state is not read.
    fn hand_over(&mut self, lane: usize, to: Lane<'_, T>) -> bool;
}

/// The runs whose steps are made at once.
pub trait Runs<T: Float> {
    /// That of a lane, if there is one.
    fn lane(&mut self, lane: usize) -> Option<Lane<'_, T>>;
}

/// What tries the steps of so many runs of a model at once; `None` where there is no such thing: another width than 4 and 8, a model that does not have its
/// equations over lanes [at hand](crate::InLanes), another scalar than `f64`.
pub(crate) fn together<T: Float>(
    model: &dyn Model<T>,
    width: usize,
) -> Option<Box<dyn Together<T>>> {
    let forms = Beside::of(model.beside()?)?;
    let of = (model.layout(), model.scene().angular_velocity);
    let group: Box<dyn Together<f64>> = match width {
        4 => Box::new(LaneGroup::<Lanes4>::new(of, forms.four())),
        8 => Box::new(LaneGroup::<Lanes8>::new(of, forms.eight())),
        _ => return None,
    };
    let group: Box<dyn Any> = Box::new(group);
    group.downcast().ok().map(|group| *group)
}

/// The numbers of several runs beside each other.
struct LaneGroup<L> {
    form: Box<dyn LaneParameters<L>>,
    /// The method, once a run has shown it.
    method: Option<LaneMethod<L>>,
    /// The model of each lane, whose parameters the equations have.
    models: Vec<Option<Arc<dyn Model<f64>>>>,
    params: Vec<L>,
    state: Vec<L>,
    /// The weights of the watch, and whether a run has one.
    weights: Vec<L>,
    watched: bool,
    stages: Stages<L>,
    networks: Networks<L>,
    joints: Joints<L>,
    /// The steps that were taken up, and the lanes in which they go on from the ends of the last ones.
    upcoming: Upcoming,
    goes_on: [bool; MOST],
    /// Whether parameters of a lane are not yet those that the equations have.
    changed: bool,
    /// The steps that were made.
    made: Option<MadeSteps<L>>,
    /// The sizes of the last steps [s], the runs that took over their ends, and those that took them without reading their state, which is here.
    sizes: L,
    taken: [bool; MOST],
    passed: [bool; MOST],
    /// How many more steps of each lane are read by nobody, and what is looked at at their ends.
    unread: [u64; MOST],
    looks: [EndLooks; MOST],
    /// Each of the [`LISTS`] at the end of the step.
    lists: [Vec<L>; LISTS.len()],
    quaternions: Vec<usize>,
}

/// What the stages read and write beside their states.
pub(super) struct Stages<L> {
    pub nodes: Vec<L>,
    pub effective: Vec<L>,
    hold: Vec<L>,
    pub ends: Vec<L>,
    inputs: Vec<L>,
    rates: Vec<L>,
}

impl<L: Lanes> Stages<L> {
    pub fn at<'a>(&'a self, time: L, state: &'a [L]) -> At<'a, L> {
        At {
            time,
            state,
            nodes: &self.nodes,
            effective: &self.effective,
            hold: &self.hold,
            ends: &self.ends,
            inputs: &self.inputs,
            rows: &[],
        }
    }

    /// Nodes and rates at a stage, both at once; one in every lane where they hold, zero where nodes follow other rules.
    fn find_rates(
        &mut self,
        form: &mut dyn LaneParameters<L>,
        nodes: &Nodes<f64>,
        (time, state): (L, &[L]),
        out: &mut [L],
    ) -> L {
        let mut rates = std::mem::take(&mut self.rates);
        form.evaluate(Quantity::Rates, &self.at(time, state), &mut rates);
        for [z, node] in nodes.velocities_in_rates() {
            if let (Some(to), Some(from)) =
                (self.nodes.get_mut(node..node + 3), rates.get(z..z + 3))
            {
                to.copy_from_slice(from);
            }
        }
        let (own, rest) = rates.split_at(out.len());
        out.copy_from_slice(own);
        let (ends, _) = rest.split_at(self.ends.len());
        self.ends.copy_from_slice(ends);
        let epsilon = L::from_f64(f64::EPSILON);
        let holds = nodes.certificates().hold_beside(&rates, epsilon);
        self.rates = rates;
        L::select(holds, L::one(), L::zero())
    }
}

impl<L: Lanes> LaneGroup<L> {
    fn new(
        (layout, components): (&Layout, AngularVelocity),
        form: Box<dyn LaneParameters<L>>,
    ) -> Self {
        let list = |length: usize| vec![L::zero(); length];
        LaneGroup {
            form,
            method: None,
            models: vec![None; L::WIDTH],
            params: list(layout.np),
            state: list(layout.nx()),
            weights: list(layout.nx()),
            watched: false,
            stages: Stages {
                nodes: list(3 * layout.nodes.len()),
                effective: list(layout.effective_numbers),
                // With the angles whose turns are counted; an origin that follows something is not flown in lanes.
                hold: list(layout.origin_at()),
                ends: list(layout.len(Quantity::AnchorStates)),
                inputs: list(layout.ni),
                rates: list(layout.len(Quantity::Rates)),
            },
            networks: Networks::new(layout),
            joints: Joints::new(layout, components),
            upcoming: Upcoming::NONE,
            goes_on: [false; MOST],
            changed: false,
            made: None,
            sizes: L::zero(),
            taken: [false; MOST],
            passed: [false; MOST],
            unread: [0; MOST],
            looks: [EndLooks::NOTHING; MOST],
            lists: LISTS.map(|what| list(layout.len(what))),
            quaternions: layout.quaternions().collect(),
        }
    }

    /// Goes on from the ends of the last steps in these lanes.
    fn go_on(&mut self, lanes: [bool; MOST], nodes: &Nodes<f64>) {
        let Some(method) = &mut self.method else {
            return;
        };
        let goes_on = L::each(|lane| if lanes[lane] { 1.0 } else { 0.0 });
        let mask = L::zero().lt(goes_on);
        method.accept_where(mask, &mut self.state);
        self.networks.count(mask, self.sizes);
        if nodes.are_single() {
            let (stages, size) = (&self.stages, self.sizes);
            self.networks.go_on(mask, nodes, stages, size);
        }
    }

    /// Takes what is held over a step into a lane.
    fn load_held(&mut self, lane: usize, run: &ModelRun<f64>) {
        set(lane, &mut self.stages.inputs, &run.system.inputs);
        set(lane, &mut self.stages.hold, run.system.nodes.hold());
    }

    /// Takes the start of a step into a lane; whether its parameters are others than those that the equations have.
    fn load(&mut self, lane: usize, run: &ModelRun<f64>) -> bool {
        let Some(method) = &mut self.method else {
            return false;
        };
        set(lane, &mut self.state, &run.state);
        set(lane, method.first_mut(), run.method.first());
        if let Some(weights) = run.weights_of_stages() {
            set(lane, &mut self.weights, weights);
            self.watched = true;
        }
        self.networks.load(lane, run);
        self.joints.load(lane, run);
        if self.has_model_of(lane, run) {
            return false;
        }
        let Some(model) = self.models.get_mut(lane) else {
            return false;
        };
        set(lane, &mut self.params, run.system.model.params());
        self.networks.load_lines(lane, run.system.model.lines());
        *model = Some(run.system.model.clone());
        true
    }

    /// Whether a lane has the parameters of a run.
    fn has_model_of(&self, lane: usize, run: &ModelRun<f64>) -> bool {
        let own = self.models.get(lane).and_then(Option::as_ref);
        own.is_some_and(|model| Arc::ptr_eq(model, &run.system.model))
    }

    /// Fills lanes that have no parameters yet with those of one that has.
    fn spread(&mut self, from: usize) {
        for lane in (0..L::WIDTH).filter(|lane| self.models.get(*lane).is_some_and(Option::is_none))
        {
            for list in [&mut self.params, &mut self.state, &mut self.stages.inputs] {
                for numbers in list {
                    let numbers = numbers.numbers_mut();
                    numbers[lane] = numbers[from];
                }
            }
        }
    }
}

impl<L: Lanes> Together<f64> for LaneGroup<L> {
    fn take_up(&mut self, lane: usize, of: Lane<'_, f64>) {
        let Lane {
            run,
            course,
            history,
            ..
        } = of;
        let passed = std::mem::take(&mut self.passed[lane]);
        self.goes_on[lane] = passed;
        let (Some(step), true) = (run.upcoming(course), lane < L::WIDTH) else {
            return;
        };
        if self.method.is_none() {
            self.method = LaneMethod::of(run);
        }
        let method = self.method.as_ref();
        if !method.is_some_and(|method| method.is_that_of(run)) {
            return;
        }
        self.looks[lane] = run.looks_at(history);
        self.upcoming.add(lane, step, self.looks[lane]);
        if passed {
            return;
        }
        let goes_on = self.taken[lane] && run.goes_on_beside() && self.has_model_of(lane, run);
        self.goes_on[lane] = goes_on;
        if !(goes_on && run.holds_on()) {
            self.load_held(lane, run);
        }
        if !goes_on {
            self.changed |= self.load(lane, run);
        }
    }

    fn make_steps(&mut self, runs: &mut dyn Runs<f64>) {
        let upcoming = std::mem::replace(&mut self.upcoming, Upcoming::NONE);
        let goes_on = std::mem::take(&mut self.goes_on);
        self.made = None;
        if let Some(first) = goes_on.iter().position(|goes_on| *goes_on)
            && let Some(first) = runs.lane(first)
        {
            self.go_on(goes_on, &first.run.system.nodes);
        }
        let Some(first) = runs.lane(upcoming.first) else {
            return;
        };
        let nodes = &first.run.system.nodes;
        if std::mem::take(&mut self.changed) {
            self.spread(upcoming.first);
            self.form.take(&self.params);
        }
        if upcoming.count >= FEWEST {
            self.made = self.make(upcoming, nodes);
        } else {
            self.taken = [false; MOST];
        }
        self.pass(runs);
    }

    fn goes_on(&self, lane: usize) -> bool {
        self.goes_on.get(lane) == Some(&true)
    }

    fn hand_over(&mut self, lane: usize, to: Lane<'_, f64>) -> bool {
        if self.passed[lane] {
            return false;
        }
        to.run.fetch(&OwnStart { lane, group: self });
        if let Some(made) = self.made.as_ref().filter(|made| made.has(lane)) {
            let own = OwnStep {
                lane,
                group: self,
                made,
            };
            to.run.receive(&own, to.history);
            self.taken[lane] = true;
            *to.count += 1;
        }
        true
    }
}

impl<L: Lanes> LaneGroup<L> {
    /// The runs that read nothing of the ends of their steps take them.
    fn pass(&mut self, runs: &mut dyn Runs<f64>) {
        let mut unread = std::mem::take(&mut self.unread);
        for (lane, left) in unread.iter_mut().enumerate().take(L::WIDTH) {
            let made = self.made.as_ref().filter(|made| made.has(lane));
            let (Some(made), Some(of)) = (made, runs.lane(lane)) else {
                *left = 0;
                continue;
            };
            let own = OwnStep {
                lane,
                group: self,
                made,
            };
            if *left == 0 {
                *left = of.run.unread_steps(of.course, own.step(), of.history);
            }
            if *left > 0 && of.run.pass(&own, of.course, of.history) {
                *of.count += 1;
                *left -= 1;
                let next = *left > 0;
                (self.passed[lane], self.goes_on[lane]) = (!next, next);
                if next {
                    let step = [of.run.time, self.sizes.lane(lane)];
                    self.upcoming.add(lane, step, self.looks[lane]);
                }
            } else {
                *left = 0;
            }
        }
        self.unread = unread;
    }
}

impl<L: Lanes> LaneGroup<L> {
    /// Makes steps; what of the [`LISTS`] is looked at is in `lists`.
    fn make(&mut self, steps: Upcoming, nodes: &Nodes<f64>) -> Option<MadeSteps<L>> {
        let (time, step): (L, L) = (steps.lanes(0), steps.lanes(1));
        let LaneGroup {
            form,
            method,
            state,
            weights,
            watched,
            stages,
            networks,
            joints,
            sizes,
            taken,
            lists,
            quaternions,
            ..
        } = self;
        (*sizes, *taken) = (step, [false; MOST]);
        let method = method.as_mut()?;
        let mut made = MadeSteps {
            steps,
            energy: [L::zero(); 6],
            drift: L::zero(),
            holds: L::one(),
            faults: L::zero(),
            squares: [L::zero(); 3],
        };
        networks.begin();
        match method {
            LaneMethod::Explicit(method) => {
                joints.begin(|lane| made.steps.has(lane));
                let Ok(()) = method.stages(
                    [time, step],
                    step,
                    state,
                    |last, [time, span], trial, rates| {
                        if last {
                            made.drift = normalise(quaternions, trial);
                            let by = (&mut **form, &*stages, &quaternions[..]);
                            made.holds *= joints.put_on(by, time, trial);
                        }
                        if nodes.has_networks() && !nodes.are_single() {
                            let at = (time, &*trial);
                            made.holds *= stages.find_rates(&mut **form, nodes, at, rates);
                        } else {
                            let at = (time, span, &*trial);
                            made.holds *= networks.solve(&mut **form, nodes, stages, at);
                            form.evaluate(Quantity::Derivative, &stages.at(time, trial), rates);
                        }
                        made.faults += faults(rates);
                        Ok::<(), Infallible>(())
                    },
                );
                if *watched {
                    made.squares = method.squares(weights);
                }
                if nodes.are_single() {
                    networks.find_stretches(nodes, stages);
                }
            }
            LaneMethod::Stiff(method) => {
                let ends = stiff::make(
                    method,
                    (&mut **form, stages),
                    [time, step],
                    state,
                    quaternions,
                );
                (made.drift, made.faults) = (ends.drift, ends.faults);
            }
        }
        let at = stages.at(time + step, method.next());
        for ((what, list), looked_at) in LISTS.iter().zip(lists).zip(made.steps.looks.lists) {
            if looked_at {
                form.evaluate(*what, &at, list);
            }
        }
        if made.steps.looks.energy {
            form.evaluate(Quantity::Energy, &at, &mut made.energy);
        }
        Some(made)
    }
}
