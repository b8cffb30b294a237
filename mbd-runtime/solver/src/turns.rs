//! Full turns of angles: what a run remembers beside the state, so that an angle goes on where attitudes begin again
//! (equation (1) of `mbd_scene::laws::turns`).

use mbd_scene::{Detachable, Float, JointStart, Layout, Quantity, begin_next_to, said_coordinates};

use crate::laws::Laws;
use crate::system::System;
use crate::unilateral::Mode;

/// The most that an angle turns over an adaptive step [rad]: beyond half a turn it would not be known which turn it is.
pub(crate) const MOST: f64 = 2.0;

/// The angles whose turns are counted, each with its rate: [`Quantity::CountedAngles`].
#[derive(Clone, Debug)]
pub(crate) struct Turning<T> {
    /// At the last accepted step, and at the step that was looked at [rad, rad/s].
    angles: [Vec<T>; 2],
    /// When that is [s].
    seen: f64,
}

impl<T: Float> Turning<T> {
    /// Nothing was looked at.
    pub(crate) fn new(layout: &Layout) -> Self {
        let numbers = || vec![T::zero(); layout.len(Quantity::CountedAngles)];
        Turning {
            angles: [numbers(), numbers()],
            seen: f64::NAN,
        }
    }
}

impl<T: Float> System<T> {
    /// Whether turns of any angle are counted.
    #[inline]
    pub(crate) fn counts_turns(&self) -> bool {
        !self.memory.turns.is_empty()
    }

    /// Counts turns from these values of the angles on [rad], in the order of [`Layout::turns`].
    pub(crate) fn count_turns_from(&mut self, angles: impl IntoIterator<Item = f64>) {
        for (last, angle) in self.memory.turns.iter_mut().zip(angles) {
            *last = T::from_f64(angle);
        }
        self.take_up_turns();
    }

    /// What a run remembers where it begins: the turns of angles, and where coordinates are that are locked from the start.
    pub(crate) fn remember_starts(&mut self, given: &[JointStart], at: (f64, &[T])) {
        self.count_turns_from_starts(given, at);
        let model = self.model.clone();
        self.hold_locks(at, |lock| !model.scene().starts.detached.contains(&lock));
    }

    /// What a run remembers where it goes on from another one, whose locks may have measured their coordinates from elsewhere: where its own are here that
    /// are locked.
    pub(crate) fn remember_locked(&mut self, at: (f64, &[T])) {
        let (model, modes) = (self.model.clone(), self.memory.modes().to_vec());
        let is_locked = |lock: Detachable| {
            let switch = model.layout().switch_of(lock);
            switch.is_some_and(|at| modes.get(at) != Some(&Mode::Detached))
        };
        self.hold_locks(at, is_locked);
    }

    /// Some locks hold their coordinates where these are.
    fn hold_locks(&mut self, at: (f64, &[T]), which: impl Fn(Detachable) -> bool) {
        if self.model.layout().locks == 0 {
            return;
        }
        let places = self.locked(at.0, at.1);
        let model = self.model.clone();
        let joints = (0..model.layout().joints.len()).map(Detachable::Joint);
        for lock in joints.filter(|&lock| which(lock)) {
            self.memory.hold_at(model.layout(), lock, &places);
        }
        self.nodes.hold_modes(&self.memory);
        self.probe.hold_modes(&self.memory);
    }

    /// Counts turns from these starts of joints on, else from where motors have them, else from those that the declaration gives, else from (−π, π] on.
    fn count_turns_from_starts(&mut self, given: &[JointStart], (time, state): (f64, &[T])) {
        if !self.counts_turns() {
            return;
        }
        let model = self.model.clone();
        let own = state.get(..self.nx).unwrap_or_default();
        let at = self.nodes.at(T::from_f64(time), own, &self.inputs);
        let laws = self.laws.get_or_insert_with(|| Laws::new(&*model));
        let mut starts = Vec::new();
        laws.run(&*model, &at, |scene, layout, numbers, at, scratch| {
            starts = said_coordinates((scene, layout), numbers, at, given, scratch);
        });
        let start = |&(joint, number): &(usize, usize)| {
            let own = starts
                .iter()
                .filter(|it| (it.joint, it.coordinate) == (joint, number));
            own.filter_map(|it| it.value).next()
        };
        let angles = model.layout().turns.iter();
        let angles: Vec<f64> = angles.map(|it| start(it).unwrap_or_default()).collect();
        self.count_turns_from(angles);
    }

    /// Lets what is evaluated next see the turns that the memory has.
    pub(crate) fn take_up_turns(&mut self) {
        self.turning.seen = f64::NAN;
        if self.counts_turns() {
            self.nodes.set_turns(&self.memory.turns);
            self.probe.set_turns(&self.memory.turns);
        }
    }

    /// Another state comes at the time that was looked at: a step that is made again ends beside where it ended.
    #[inline]
    pub(crate) fn forget_angles(&mut self) {
        self.turning.seen = f64::NAN;
    }

    /// By how much the angle that turns most turns over a step that was tried, by the rates at its ends [rad].
    #[inline]
    pub(crate) fn angle_swept(&mut self, step: f64, end: f64, state: &[T]) -> f64 {
        match self.counts_turns() {
            true => self.find_swept(step, end, state),
            false => 0.0,
        }
    }

    fn find_swept(&mut self, step: f64, end: f64, state: &[T]) -> f64 {
        self.look_at_angles(end, state);
        let [last, now] = &self.turning.angles;
        let rates = last.iter().zip(now).skip(1).step_by(2);
        let sizes = rates.map(|(a, b)| a.to_f64().abs() + b.to_f64().abs());
        0.5 * step * sizes.fold(0.0, f64::max)
    }

    /// Takes the angles at an accepted step, next to those of the one before.
    #[inline]
    pub(crate) fn count_turns(&mut self, time: f64, state: &[T]) {
        if self.counts_turns() {
            self.take_angles(time, state);
        }
    }

    fn take_angles(&mut self, time: f64, state: &[T]) {
        if self.turning.seen != time {
            self.look_at_angles(time, state);
        }
        self.turning.angles.swap(0, 1);
        self.turning.seen = f64::NAN;
        let angles = self.turning.angles[0].iter().step_by(2);
        for (last, angle) in self.memory.turns.iter_mut().zip(angles) {
            if angle.to_f64().is_finite() {
                *last = *angle;
            }
        }
        self.take_up_turns();
    }

    /// The angles and their rates at a state.
    fn look_at_angles(&mut self, time: f64, state: &[T]) {
        let what = Quantity::CountedAngles;
        let [_, angles] = &mut self.turning.angles;
        match self.known.list(what, time) {
            Some(known) => angles.copy_from_slice(known),
            None => {
                let state = state.get(..self.nx).unwrap_or_default();
                let at = self.nodes.at(T::from_f64(time), state, &self.inputs);
                self.model.evaluate(what, &at, &mut self.work, angles);
            }
        }
        self.turning.seen = time;
    }

    /// Goes on with the turns of the joints that are the `same` in the model of the last run.
    pub(crate) fn count_on(
        &mut self,
        last: &Self,
        same: &dyn Fn(usize) -> Option<usize>,
        before: &[T],
        state: &mut [T],
    ) {
        let (from, to) = (last.model.clone(), self.model.clone());
        let counted = |joint: usize, number: usize| {
            last.counted_angle(from.layout(), same(joint)?, number, before)
        };
        let mut angles: Vec<f64> = self.memory.turns.iter().map(|x| x.to_f64()).collect();
        for (angle, &(joint, number)) in angles.iter_mut().zip(&to.layout().turns) {
            *angle = counted(joint, number).unwrap_or(*angle);
        }
        self.count_turns_from(angles);
        let mut numbers: Vec<f64> = state.iter().map(|x| x.to_f64()).collect();
        for (joint, declared) in to.scene().joints.iter().enumerate() {
            for number in 0..declared.law.measured().count() {
                if let Some(angle) = counted(joint, number) {
                    let scene = (to.scene(), to.layout());
                    begin_next_to(scene, (joint, number), angle, &mut numbers);
                }
            }
        }
        for (slot, number) in state.iter_mut().zip(numbers) {
            *slot = T::from_f64(number);
        }
    }

    /// An angle that counts turns, as a link of the tree or by the memory [rad].
    fn counted_angle(
        &self,
        layout: &Layout,
        joint: usize,
        number: usize,
        state: &[T],
    ) -> Option<f64> {
        if let Some(link) = layout.carried(joint) {
            return state.get(link.slots.q + number).map(|x| x.to_f64());
        }
        let place = layout.turn_of(joint, number)? - layout.holds();
        self.memory.turns.get(place).map(|x| x.to_f64())
    }
}
