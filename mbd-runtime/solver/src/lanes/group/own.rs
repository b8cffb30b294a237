//! What a run takes out of its lane.

use super::super::Lanes;
use super::LaneGroup;
use super::lists::get;
use super::method::LaneMethod;
use super::steps::MadeSteps;
use crate::node::NodeMemory;
use crate::simulation::beside::{Attempt, KeptStart, Spent};

/// The start of the next step of a lane.
pub(super) struct OwnStart<'a, L> {
    pub lane: usize,
    pub group: &'a LaneGroup<L>,
}

impl<L: Lanes> KeptStart<f64> for OwnStart<'_, L> {
    fn state(&self, [state, rates]: [&mut [f64]; 2]) {
        get(self.lane, &self.group.state, state);
        if let Some(method) = &self.group.method {
            get(self.lane, method.first(), rates);
        }
    }

    fn memory(&self, into: &mut NodeMemory<f64>) {
        self.group.networks.unload(self.lane, into);
    }
}

/// The step of a lane.
pub(super) struct OwnStep<'a, L> {
    pub lane: usize,
    pub group: &'a LaneGroup<L>,
    pub made: &'a MadeSteps<L>,
}

impl<L: Lanes> Attempt<f64> for OwnStep<'_, L> {
    fn step(&self) -> [f64; 2] {
        let step = self.made.steps.steps.get(self.lane).copied();
        step.unwrap_or([f64::NAN; 2])
    }

    fn stages(&self, all: bool, [stages, end]: [&mut [f64]; 2]) {
        let Some(LaneMethod::Explicit(method)) = &self.group.method else {
            return;
        };
        let [of_all, next] = method.attempted();
        let length = next.len();
        let from = match all {
            true => length,
            false => (method.count() - 1) * length,
        };
        let own = from..method.count() * length;
        if let (Some(from), Some(to)) = (of_all.get(own.clone()), stages.get_mut(own)) {
            get(self.lane, from, to);
        }
        get(self.lane, next, end);
    }

    fn end(&self, [state, rates]: [&mut [f64]; 2]) {
        let Some(LaneMethod::Explicit(method)) = &self.group.method else {
            return;
        };
        let [of_all, next] = method.attempted();
        get(self.lane, next, state);
        let last = of_all.get((method.count() - 1) * next.len()..);
        get(self.lane, last.unwrap_or_default(), rates);
    }

    fn solved(&self, into: [&mut [f64]; 4]) {
        let Some(LaneMethod::Stiff(method)) = &self.group.method else {
            return;
        };
        for (to, from) in into.into_iter().zip(method.attempted()) {
            get(self.lane, from, to);
        }
    }

    fn rates(&self, into: &mut [f64]) {
        get(self.lane, &self.group.stages.rates, into);
    }

    fn nodes(&self, [ends, nodes, effective, stretch, against]: [&mut [f64]; 5]) {
        let stages = &self.group.stages;
        get(self.lane, &stages.ends, ends);
        get(self.lane, &stages.nodes, nodes);
        get(self.lane, &stages.effective, effective);
        let networks = &self.group.networks;
        get(self.lane, networks.stretches(), stretch);
        get(self.lane, networks.motion(), against);
    }

    fn spent(&self) -> Spent {
        self.group.networks.spent(self.lane)
    }

    fn list(&self, place: usize, into: &mut [f64]) -> bool {
        let looked_at = self.made.steps.looks.lists.get(place) == Some(&true);
        match self.group.lists.get(place).filter(|_| looked_at) {
            Some(list) => {
                get(self.lane, list, into);
                true
            }
            None => false,
        }
    }

    fn number(&self, place: usize, index: usize) -> f64 {
        let list = self.group.lists.get(place);
        let number = list.and_then(|list| list.get(index));
        number.map_or(f64::NAN, |number| number.lane(self.lane))
    }

    fn energy(&self) -> Option<[f64; 6]> {
        let looked_at = self.made.steps.looks.energy;
        looked_at.then(|| self.made.energy.map(|x| x.lane(self.lane)))
    }

    fn squares(&self) -> [f64; 3] {
        self.made.squares.map(|x| x.lane(self.lane))
    }

    fn drift(&self) -> f64 {
        self.made.drift.lane(self.lane)
    }

    fn margin(&self) -> f64 {
        self.group.joints.margin().lane(self.lane)
    }
}
