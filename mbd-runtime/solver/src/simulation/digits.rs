//! Whether positions have the digits that the tolerance of a run asks for, and angles and declared states those that they are read for.

use mbd_scene::random::SplitMix64;
use mbd_scene::{Float, Part, Quantity};

use super::stability::OFTEN;
use super::{ModelRun, Pace};
use crate::columns::{output_name, state_names};
use crate::error::StepError;
use crate::integrate::ErrorNorm;
use crate::moving::moving;
use crate::rounding::{CoarseLook, ENOUGH};
use crate::state_rounding::{CoarseState, LookedStep, NumberKind, Suffers, WorstState};
use crate::system::System;

/// By so many numbers at most positions are moved where digits are looked at: two that are rounded to one each differ by about as much in the rates of all stages.
const NUMBERS: f64 = 2.5;
/// What an angle or a length suffers of which nothing else is known.
const ITSELF: &str = "what it tells by itself";
/// From this part on what rounding of a state makes is told.
const TOLD: f64 = 1e-3;

impl<T: Float> ModelRun<T> {
    /// Looks at what rounding of positions makes of the error of the next step.
    pub(super) fn watch_digits(&mut self) {
        if let Pace::Adaptive(control, norm) = &self.pace {
            let look = coarse_look(
                &mut self.system,
                (self.time, &self.state),
                (norm, control.step),
                &mut self.digit_room,
            );
            self.step_rounding.see(look);
        }
    }

    /// Begins to look at the digits of what grows.
    pub(super) fn begin_state_digits(&mut self) {
        let model = self.system.model.clone();
        let (scene, layout) = (model.scene(), model.layout());
        let from_world = scene.runs.origin.is_none();
        let parts = moving(layout).flat_map(|part| {
            let turns = !part.has_quaternion();
            let angles = part.attitude.zip(part.spin).filter(move |_| turns);
            let angles = angles.map(|(angle, rate)| (angle, NumberKind::Angle(rate)));
            let lengths = part.position.filter(move |_| from_world);
            angles.chain(lengths.map(|at| (at, NumberKind::Length)))
        });
        let declared = (layout.states()..layout.nx()).map(|at| (at, NumberKind::Declared));
        let numbers = parts.chain(declared);
        let state = &self.state;
        let numbers = numbers.filter_map(|(at, kind)| Some((at, kind, state.get(at)?.to_f64())));
        self.state_rounding.begin(numbers);
    }

    /// Looks at what rounding of angles and declared states makes of what follows them.
    ///
    /// # Errors
    /// A number that has no digits left of what it is read for.
    pub(super) fn watch_state_digits(&mut self) -> Result<(), StepError> {
        let looked = LookedStep {
            state: &self.state,
            rates: self.method.first(),
            step: self.attempted,
            weights: self.method.weights(),
            steps: OFTEN as f64,
            keeps: !self.method.lost().is_empty(),
        };
        if let Some((at, apart)) = self.state_rounding.see(looked) {
            self.move_number(at, apart);
        }
        self.state_rounding.see_turns(&self.system.memory.turns);
        self.state_rounding
            .is_refused()
            .map_or(Ok(()), |worst| Err(self.large_state(worst)))
    }

    /// Why no step is short enough here, if an angle or a declared state began with so few digits that its rounding makes at least such a part of what
    /// follows it: rates then jump from stage to stage.
    #[cold]
    pub(super) fn lacks_digits(&mut self, least: f64) -> Option<StepError> {
        let kept = self.state_rounding.clone();
        for (at, apart) in self.state_rounding.look_anew(&self.state) {
            let begun = self.state.get(at).copied();
            while self.state_rounding.needs_more(at) {
                self.move_number(at, apart);
                if let Some(x) = self.state.get_mut(at) {
                    *x += T::from_f64(apart);
                }
            }
            if let (Some(x), Some(begun)) = (self.state.get_mut(at), begun) {
                *x = begun;
            }
        }
        let looked = std::mem::replace(&mut self.state_rounding, kept);
        let worst = looked.worst_of_rates()?;
        (worst.share >= least).then(|| self.large_state(worst))
    }

    fn large_state(&self, worst: WorstState) -> StepError {
        let told = self.in_words(worst);
        StepError::LargeState {
            state: told.state,
            unit: told.unit,
            value: told.value,
            apart: told.apart,
            affected: told.affected,
            share: told.share,
        }
    }

    /// Compares rates, outputs and guards where a number of the state is and where it is moved by what rounding makes of it.
    #[cold]
    fn move_number(&mut self, at: usize, apart: f64) {
        let model = self.system.model.clone();
        let layout = model.layout();
        let tells = layout.columns > 0 && model.emits(Quantity::Outputs);
        let columns = if tells {
            layout.len(Quantity::Outputs)
        } else {
            0
        };
        let events = match self.margins.declares() {
            true => self.guards,
            false => 0,
        };
        let lengths = [layout.len(Quantity::Derivative), columns, events];
        let [
            moved,
            rates,
            rates_there,
            outputs,
            outputs_there,
            guards,
            guards_there,
        ] = &mut self.digit_room;
        moved.clear();
        moved.extend_from_slice(&self.state);
        let Some(x) = moved.get_mut(at) else {
            return;
        };
        let value = x.to_f64();
        *x += T::from_f64(apart.copysign(value));
        let lists = [
            (&self.state, [&mut *rates, &mut *outputs, &mut *guards]),
            (
                &*moved,
                [&mut *rates_there, &mut *outputs_there, &mut *guards_there],
            ),
        ];
        for (state, lists) in lists {
            let asked = [Quantity::Derivative, Quantity::Outputs, Quantity::Guards];
            let asked = asked.into_iter().zip(lengths);
            for ((what, length), list) in asked.zip(lists) {
                list.clear();
                list.resize(length, T::zero());
                if length > 0 {
                    self.system.at_another_time(what, self.time, state, list);
                }
            }
        }
        let speeds = layout.nq..layout.nq + layout.nv;
        let acceleration = self.sizes.rounding.acceleration;
        self.state_rounding.compare(
            (at, value, apart),
            [
                [rates.as_slice(), rates_there],
                [outputs.as_slice(), outputs_there],
                [guards.as_slice(), guards_there],
            ],
            |rate| {
                if speeds.contains(&rate) {
                    acceleration
                } else {
                    0.0
                }
            },
            |guard| {
                let mut declared = self.margins.declared();
                let own = declared.find(|(_, at)| *at == guard);
                own.and_then(|(index, _)| self.margins.event_of(index))
            },
        );
    }

    /// What [`Simulation::coarse_state`](super::Simulation::coarse_state) tells.
    pub(super) fn coarse_state(&self) -> Option<CoarseState> {
        let told = self.state_rounding.told();
        Some(self.in_words(told.filter(|worst| worst.share >= TOLD)?))
    }

    /// What is worst, by names.
    fn in_words(&self, worst: WorstState) -> CoarseState {
        let model = &self.system.model;
        let (scene, layout) = (model.scene(), model.layout());
        let names = state_names(scene, layout);
        let name = |at: usize| names.get(at).map_or("", |name| &name.name);
        let affected = match worst.suffers {
            Suffers::Itself | Suffers::Turned => ITSELF.to_owned(),
            Suffers::Rate(at) => format!("the rate of `{}`", name(at)),
            Suffers::Output(column) => format!("the output `{}`", output_name(scene, column)),
            Suffers::Event(event) => {
                let name = scene.events.get(event).map_or("", |event| &event.name);
                format!("when `{name}` happens")
            }
        };
        let turned = layout
            .turns
            .get(worst.at)
            .filter(|_| worst.suffers == Suffers::Turned);
        let angle = turned.and_then(|&(joint, number)| scene.coordinate(joint, number));
        let (state, unit) = match (angle, names.get(worst.at)) {
            (Some((joint, angle)), _) => {
                (format!("{}.{}", joint.name, angle.name), "rad".to_owned())
            }
            (None, Some(own)) => (own.name.clone(), own.unit.clone()),
            (None, None) => Default::default(),
        };
        CoarseState {
            state,
            unit,
            affected,
            value: worst.value,
            apart: worst.apart,
            share: worst.share,
        }
    }
}

/// What rounding of positions at a state makes of the error of a step; `None` where they have more digits than its norm asks for.
fn coarse_look<T: Float>(
    system: &mut System<T>,
    (time, state): (f64, &[T]),
    (norm, step): (&ErrorNorm, f64),
    [moved, here, there, ..]: &mut [Vec<T>; 7],
) -> Option<CoarseLook> {
    let model = system.model.clone();
    let layout = model.layout();
    let apart = norm.coarseness(state);
    if apart < ENOUGH {
        return None;
    }
    // By a few numbers, each by others, and by others at every look: what goes along moves apart.
    let mut random = SplitMix64(time.to_bits());
    moved.clear();
    moved.extend_from_slice(state);
    for at in moving(layout).flat_map(|part| part.position) {
        if let Some(x) = moved.get_mut(at) {
            *x += T::from_f64(NUMBERS * random.number()) * T::EPSILON * *x;
        }
    }
    let rates = layout.len(Quantity::Derivative);
    for (state, rates_there) in [(state, &mut *here), (moved, &mut *there)] {
        rates_there.clear();
        rates_there.resize(rates, T::zero());
        system.at_another_time(Quantity::Derivative, time, state, rates_there);
    }
    // The rates are rounded themselves, too.
    let step = T::from_f64(step);
    for (change, there) in here.iter_mut().zip(there) {
        *change = step * ((*there - *change).abs() + T::EPSILON * change.abs());
    }
    here.resize(state.len(), T::zero());
    let (share, block) = norm.largest(here, state, state);
    let parts = moving(layout).enumerate().map(|(part, own)| {
        let own_state = state.get(own.position).unwrap_or_default();
        let far = own_state.iter().map(|x| x.to_f64().abs());
        (part, own.part, far.fold(0.0, f64::max))
    });
    // That of the error, where it has a position of its own; else the furthest.
    let owner = norm.owner(block);
    let (part, _, distance) = parts.max_by(|a, b| {
        let key = |(_, part, far): &(usize, Part, f64)| (owner == Some(*part) && *far > 0.0, *far);
        let (a, b) = (key(a), key(b));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    })?;
    Some(CoarseLook {
        share,
        part,
        distance,
        apart: apart * norm.tolerance,
    })
}
