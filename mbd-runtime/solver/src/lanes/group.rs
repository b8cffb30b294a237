//! The steps of several runs tried beside each other, a run a lane, each with a clock and a step of its own.

use std::any::Any;
use std::convert::Infallible;
use std::sync::Arc;

use mbd_scene::{At, Float, Layout, Model, Quantity};

use super::form::{Beside, LaneParameters};
use super::lockstep::normalise;
use super::networks::Networks;
use super::{Lanes, Lanes4, Lanes8};
use crate::integrate::Explicit;
use crate::node::Nodes;
use crate::simulation::beside::{Attempt, Spent};
use crate::simulation::{Course, Simulation};
use crate::system::{EndLooks, LISTS};
use crate::trajectory::Trajectory;

/// With fewer runs than this nothing is gained.
const FEWEST: usize = 2;
/// The most lanes there are.
const MOST: usize = 8;

/// A run in a lane.
pub struct Lane<'r, T: Float> {
    /// The run.
    pub run: &'r mut Simulation<T>,
    /// Where it goes.
    pub course: &'r Course,
    /// What is recorded of it.
    pub history: &'r Trajectory,
    /// How many of its steps were tried beside those of others.
    pub count: &'r mut u64,
}

/// Tries the steps of several runs of one model at once.
pub trait Together<T: Float> {
    /// Tries the next step of every run that has one of this kind, and leaves it where the run takes it from.
    fn attempt(&mut self, runs: &mut dyn Runs<T>);
}

/// The runs that are tried beside each other.
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
    let layout = model.layout();
    let group: Box<dyn Together<f64>> = match width {
        4 => Box::new(LaneGroup::<Lanes4>::new(layout, forms.four())),
        8 => Box::new(LaneGroup::<Lanes8>::new(layout, forms.eight())),
        _ => return None,
    };
    let group: Box<dyn Any> = Box::new(group);
    group.downcast().ok().map(|group| *group)
}

/// The numbers of several runs beside each other.
struct LaneGroup<L> {
    form: Box<dyn LaneParameters<L>>,
    /// The method, once a run has shown it.
    method: Option<Explicit<L>>,
    /// The model of each lane, whose parameters the equations have.
    models: Vec<Option<Arc<dyn Model<f64>>>>,
    params: Vec<L>,
    state: Vec<L>,
    stages: Stages<L>,
    networks: Networks<L>,
    /// The sizes of the last steps [s], and the runs that took over their ends.
    sizes: L,
    taken: [bool; MOST],
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
        let layout = nodes.layout_of_rates();
        for [z, node] in layout.velocities() {
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
        let carries = |line: usize| {
            let hold = self.hold.get(line).copied();
            L::zero().lt(hold.unwrap_or_else(L::zero))
        };
        let holds = layout.holds(&rates, L::from_f64(f64::EPSILON), carries);
        self.rates = rates;
        L::select(holds, L::one(), L::zero())
    }
}

impl<L: Lanes> LaneGroup<L> {
    fn new(layout: &Layout, form: Box<dyn LaneParameters<L>>) -> Self {
        let list = |length: usize| vec![L::zero(); length];
        LaneGroup {
            form,
            method: None,
            models: vec![None; L::WIDTH],
            params: list(layout.np),
            state: list(layout.nx()),
            stages: Stages {
                nodes: list(3 * layout.nodes.len()),
                effective: list(2 * layout.effective_lines),
                hold: list(layout.holds()),
                ends: list(layout.len(Quantity::AnchorStates)),
                inputs: list(layout.ni),
                rates: list(layout.len(Quantity::Rates)),
            },
            networks: Networks::new(layout),
            sizes: L::zero(),
            taken: [false; MOST],
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
        if nodes.are_single() {
            let (stages, size) = (&self.stages, self.sizes);
            self.networks.go_on(mask, nodes, stages, size);
        }
    }

    /// Takes what is held over a step into a lane.
    fn load_held(&mut self, lane: usize, run: &Simulation<f64>) {
        set(lane, &mut self.stages.inputs, &run.system.inputs);
        set(lane, &mut self.stages.hold, run.system.nodes.hold());
    }

    /// Takes the start of a step into a lane; whether its parameters are others than those that the equations have.
    fn load(&mut self, lane: usize, run: &Simulation<f64>) -> bool {
        let Some(own) = run.method.explicit() else {
            return false;
        };
        let method = self.method.get_or_insert_with(|| own.over());
        set(lane, &mut self.state, &run.state);
        set(lane, method.first_mut(), own.first());
        self.networks.load(lane, run);
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
    fn has_model_of(&self, lane: usize, run: &Simulation<f64>) -> bool {
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

/// Writes a list into a lane.
pub(super) fn set<L: Lanes>(lane: usize, lanes: &mut [L], list: &[f64]) {
    for (numbers, x) in lanes.iter_mut().zip(list) {
        if let Some(number) = numbers.numbers_mut().get_mut(lane) {
            *number = *x;
        }
    }
}

/// Reads a list out of a lane.
fn get<L: Lanes>(lane: usize, lanes: &[L], list: &mut [f64]) {
    // By reference: a register is not copied for one of its numbers.
    for (x, numbers) in list.iter_mut().zip(lanes) {
        if let Some(number) = numbers.numbers().get(lane) {
            *x = *number;
        }
    }
}

impl<L: Lanes> Together<f64> for LaneGroup<L> {
    fn attempt(&mut self, runs: &mut dyn Runs<f64>) {
        let Some(tried) = self.gather(runs) else {
            return;
        };
        let Some(first) = runs.lane(tried.first) else {
            return;
        };
        let Some(end) = self.make_step(&tried, &first.run.system.nodes) else {
            return;
        };
        for lane in (0..L::WIDTH).filter(|lane| tried.has(*lane) && end.is_usable(*lane)) {
            if let Some(own) = runs.lane(lane) {
                own.run.receive(&Tries {
                    lane,
                    group: self,
                    tried: &tried,
                    end: &end,
                });
                self.taken[lane] = true;
                *own.count += 1;
            }
        }
    }
}

/// The steps that are tried.
struct Tried {
    /// Start and size of each lane's [s]; not a number where none is tried.
    steps: [[f64; 2]; MOST],
    /// The first lane with one.
    first: usize,
    /// What some run looks at at the end.
    looks: EndLooks,
}

impl Tried {
    fn has(&self, lane: usize) -> bool {
        self.steps
            .get(lane)
            .is_some_and(|[time, _]| time.is_finite())
    }

    /// Times at the start, or sizes; idle lanes have those of the first that is not.
    fn lanes<L: Lanes>(&self, which: usize) -> L {
        L::each(|lane| match self.has(lane) {
            true => self.steps[lane][which],
            false => self.steps[self.first][which],
        })
    }
}

/// What is known at the end of steps that were tried.
struct TriedEnd<L> {
    energy: [L; 6],
    drift: L,
    /// One in a lane whose nodes were found along with the rates.
    holds: L,
    /// Zero in a lane in which every rate is finite.
    faults: L,
}

impl<L: Lanes> TriedEnd<L> {
    fn is_usable(&self, lane: usize) -> bool {
        self.holds.lane(lane) == 1.0 && self.faults.lane(lane) == 0.0
    }
}

impl<L: Lanes> LaneGroup<L> {
    /// Takes the starts of the next steps into the lanes; `None` where there are too few.
    fn gather(&mut self, runs: &mut dyn Runs<f64>) -> Option<Tried> {
        let mut tried = Tried {
            steps: [[f64::NAN; 2]; MOST],
            first: 0,
            looks: EndLooks::default(),
        };
        let (mut count, mut changed) = (0, false);
        let mut goes_on = [false; MOST];
        for (lane, goes_on) in goes_on.iter_mut().enumerate().take(L::WIDTH) {
            let Some(Lane {
                run,
                course,
                history,
                ..
            }) = runs.lane(lane)
            else {
                continue;
            };
            let Some(step) = run.upcoming(course) else {
                continue;
            };
            if count == 0 {
                tried.first = lane;
            }
            tried.steps[lane] = step;
            count += 1;
            self.load_held(lane, run);
            *goes_on = self.taken[lane] && run.goes_on_beside() && self.has_model_of(lane, run);
            tried.looks = tried.looks.and(run.looks_at(history));
        }
        if goes_on.contains(&true)
            && let Some(first) = runs.lane(tried.first)
        {
            self.go_on(goes_on, &first.run.system.nodes);
        }
        for lane in (0..L::WIDTH).filter(|lane| tried.has(*lane) && !goes_on[*lane]) {
            if let Some(Lane { run, .. }) = runs.lane(lane) {
                changed |= self.load(lane, run);
            }
        }
        if changed {
            self.spread(tried.first);
            self.form.take(&self.params);
        }
        (count >= FEWEST).then_some(tried)
    }

    /// Makes the steps; what of the [`LISTS`] is looked at is in `lists`.
    fn make_step(&mut self, tried: &Tried, nodes: &Nodes<f64>) -> Option<TriedEnd<L>> {
        let (time, step): (L, L) = (tried.lanes(0), tried.lanes(1));
        let LaneGroup {
            form,
            method,
            state,
            stages,
            networks,
            sizes,
            taken,
            lists,
            quaternions,
            ..
        } = self;
        (*sizes, *taken) = (step, [false; MOST]);
        let method = method.as_mut()?;
        let mut end = TriedEnd {
            energy: [L::zero(); 6],
            drift: L::zero(),
            holds: L::one(),
            faults: L::zero(),
        };
        networks.begin();
        let Ok(()) = method.stages(
            [time, step],
            step,
            state,
            |last, [time, span], trial, rates| {
                if last {
                    end.drift = normalise(quaternions, trial);
                }
                if nodes.has_networks() && !nodes.are_single() {
                    end.holds *= stages.find_rates(&mut **form, nodes, (time, trial), rates);
                } else {
                    end.holds *= networks.solve(&mut **form, nodes, stages, (time, span, trial));
                    form.evaluate(Quantity::Derivative, &stages.at(time, trial), rates);
                }
                // 0 x is zero for a finite number and NaN for others.
                let faults = rates.iter().map(|x| L::zero() * *x);
                end.faults = faults.fold(end.faults, |sum, fault| sum + fault);
                Ok::<(), Infallible>(())
            },
        );
        if nodes.are_single() {
            networks.find_stretches(nodes, stages);
        }
        let [_, next] = method.attempted();
        let at = stages.at(time + step, next);
        for ((what, list), looked_at) in LISTS.iter().zip(lists).zip(tried.looks.lists) {
            if looked_at {
                form.evaluate(*what, &at, list);
            }
        }
        if tried.looks.energy {
            form.evaluate(Quantity::Energy, &at, &mut end.energy);
        }
        Some(end)
    }
}

/// The attempt of a lane.
struct Tries<'a, L> {
    lane: usize,
    group: &'a LaneGroup<L>,
    tried: &'a Tried,
    end: &'a TriedEnd<L>,
}

impl<L: Lanes> Attempt<f64> for Tries<'_, L> {
    fn step(&self) -> [f64; 2] {
        let step = self.tried.steps.get(self.lane).copied();
        step.unwrap_or([f64::NAN; 2])
    }

    fn stages(&self, [stages, end]: [&mut [f64]; 2]) {
        let Some(method) = &self.group.method else {
            return;
        };
        let [all, next] = method.attempted();
        let first = next.len();
        if let (Some(from), Some(to)) = (all.get(first..), stages.get_mut(first..)) {
            get(self.lane, from, to);
        }
        get(self.lane, next, end);
    }

    fn rates(&self, into: &mut [f64]) {
        get(self.lane, &self.group.stages.rates, into);
    }

    fn nodes(&self, [ends, nodes, effective, stretch, against]: [&mut [f64]; 5]) -> Spent {
        let stages = &self.group.stages;
        get(self.lane, &stages.ends, ends);
        get(self.lane, &stages.nodes, nodes);
        get(self.lane, &stages.effective, effective);
        let networks = &self.group.networks;
        get(self.lane, networks.stretches(), stretch);
        get(self.lane, networks.motion(), against);
        self.group.networks.spent(self.lane)
    }

    fn list(&self, place: usize, into: &mut [f64]) -> bool {
        let looked_at = self.tried.looks.lists.get(place) == Some(&true);
        match self.group.lists.get(place).filter(|_| looked_at) {
            Some(list) => {
                get(self.lane, list, into);
                true
            }
            None => false,
        }
    }

    fn energy(&self) -> Option<[f64; 6]> {
        self.tried
            .looks
            .energy
            .then(|| self.end.energy.map(|x| x.lane(self.lane)))
    }

    fn drift(&self) -> f64 {
        self.end.drift.lane(self.lane)
    }
}
