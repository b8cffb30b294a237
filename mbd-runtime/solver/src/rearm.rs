//! Events whose action sends their own guard back: of a ball that bounces, v := −e v where z falls 0. Such an event has not left the side that it came
//! from, and is armed again from there. Where it happens again within what is one time with the action it would do so without end: a ball that lies
//! there, whose bounces are shorter than times are told apart.
//!
//! ```text
//! ġ₊ towards where it came from, |ġ₊| > 1e-9 |ġ₋|;  or |ġ₊| ≤ 1e-9 |ġ₋| and g goes on beyond by its acceleration       (1)
//! ```
//!
//! An event that goes on beyond is there, where joints that are closed behind its action have its guard back by rounding, too: by less than it passes in
//! what is one instant. It has passed once.
//!
//! Rejected: to have it on the far side, where its guard is by rounding: once bounces are too short to be seen the ball falls through the floor; to
//! count actions alone, which end before they are many.

use mbd_scene::Float;
use serde::{Deserialize, Serialize};

use crate::error::StepError;
use crate::locate::{AT_REST, TOGETHER};
use crate::simulation::ModelRun;

/// Below this part of the rate before the action a rate is none; a guard within this time [s] of its value, by that rate, is at its value.
const NONE: f64 = 1e-9;

/// A guard that changes by so many times what rounding makes of it has a rate; it is looked for so much further each time, up to a time [s].
const RESOLVED: f64 = 64.0;
const FURTHER: f64 = 8.0;
const FURTHEST: f64 = 0.03;
/// Within so many roundings of its value a guard is at it.
const AT_VALUE: f64 = 4.0;

/// When an event was armed again by its own action, and where.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Rearmed {
    /// When last [s].
    pub time: Option<f64>,
    /// Below this the guard was at its value then.
    pub rounding: f64,
    /// The guard there, which counts as its value until an action lets it pass.
    pub value: f64,
    /// Within this its guard leaves its value by no more than rounding [s].
    #[serde(default)]
    pub instant: f64,
    /// Whether it went on beyond, and was back by rounding alone.
    #[serde(default)]
    pub beyond: bool,
}

impl Rearmed {
    /// Whether it waits on the side that it came from.
    pub(crate) fn is_armed(&self) -> bool {
        self.time.is_some() && !self.beyond
    }
}

impl<T: Float> ModelRun<T> {
    /// The guards here, their rates, and how far each is off where the numbers of the state are the next ones.
    pub(crate) fn guards_and_rates(&mut self) -> Result<[Vec<f64>; 3], StepError> {
        let state = self.state.clone();
        let here = self.guards_at(self.time, &state).unwrap_or_default();
        self.look_at_neighbours(0.0)?;
        let rounding: Vec<f64> = self.off(&here).iter().map(|off| off.abs()).collect();
        let (mut rates, mut ahead) = (vec![0.0; here.len()], AT_REST);
        loop {
            self.look_ahead(ahead)?;
            let mut resolved = true;
            for ((rate, off), rounding) in rates.iter_mut().zip(self.off(&here)).zip(&rounding) {
                // What is known already is not looked at from further away.
                if (*rate * ahead).abs() <= RESOLVED * rounding {
                    *rate = off / ahead;
                    resolved &= off.abs() >= RESOLVED * rounding;
                }
            }
            if resolved || ahead >= FURTHEST {
                return Ok([here, rates, rounding]);
            }
            ahead *= FURTHER;
        }
    }

    /// How far the guards of the last look are from some.
    fn off(&self, from: &[f64]) -> Vec<f64> {
        let guards = self.scratch.get(..self.guards).unwrap_or_default();
        let pairs = guards.iter().zip(from);
        pairs.map(|(guard, from)| guard.to_f64() - from).collect()
    }

    /// Events that have acted, whose guards had these rates before: those for which (1) holds are on the side that they came from.
    pub(crate) fn rearm(&mut self, acting: &[usize], before: &[f64]) -> Result<(), StepError> {
        let declared: Vec<(usize, usize)> = self.margins.declared().collect();
        let [here, after, rounded] = self.guards_and_rates()?;
        self.look_along(AT_REST)?;
        let along = self.off(&here);
        let instant = self.one_instant(0.0);
        for (index, at) in declared {
            let own = self.margins.event_of(index);
            let acted = own.filter(|event| acting.contains(event));
            let (Some(event), false) = (acted, self.margins.is_held(index)) else {
                continue;
            };
            let of = |list: &[f64]| list.get(at).copied().unwrap_or(f64::NAN);
            // What counts is the way back to where it came from.
            let beyond = self.margins.sides.get(event).copied().unwrap_or(false);
            let back = if beyond { -of(&after) } else { of(&after) };
            let goes_on = if beyond { of(&along) } else { -of(&along) };
            let none = NONE * of(before).abs();
            let returns = back > none || back.abs() <= none && goes_on > none * AT_REST;
            let guard = of(&here);
            // An event is located no closer than times inside its step are told apart.
            let located = self.one_instant(self.step_ahead()) * of(before).abs();
            let near = none.max(AT_VALUE * of(&rounded)).max(located);
            let last = self.margins.rearmed.get_mut(index);
            let Some(last) = last else { continue };
            let at = Rearmed {
                time: Some(self.time),
                rounding: near,
                value: guard,
                instant: match of(&rounded) > 0.0 {
                    true => AT_VALUE * of(&rounded) / back.abs(),
                    false => 0.0,
                },
                beyond: false,
            };
            if (guard - last.value).abs() > near || !returns {
                let rounding = instant * of(before).abs();
                let is_back = !returns && (guard > 0.0) != beyond && guard.abs() <= rounding;
                *last = match is_back {
                    true => Rearmed {
                        rounding,
                        beyond: true,
                        ..at
                    },
                    false => Rearmed {
                        value: 0.0,
                        ..*last
                    },
                };
                continue;
            }
            self.margins.rearm(index, at);
        }
        self.inside.copy_from_slice(&self.state);
        self.read_margins(self.time, 0.0)
    }

    /// Whether an event that its action armed again happens again while its guard moves back by these rates: it has not left its value by more than rounding, and an
    /// action that took it for a passage would send a ball that rises through the floor.
    pub(crate) fn moves_back(&self, event: usize, rates: &[f64]) -> bool {
        let mut declared = self.margins.declared();
        let own = declared.find(|(index, _)| self.margins.event_of(*index) == Some(event));
        let rate = own.and_then(|(_, at)| rates.get(at).copied());
        let beyond = self.margins.sides.get(event).copied().unwrap_or(false);
        let back = rate.is_some_and(|rate| if beyond { rate < 0.0 } else { rate > 0.0 });
        back && self.margins.rearmed_at(event).is_some()
    }

    /// Whether an event that its action armed again happens again within what is one time with that: in single precision that is a part of the step in which it
    /// would be located, and far from the origin what the guard takes to leave its value by more than rounding.
    pub(crate) fn happens_at_once(&self, event: usize) -> bool {
        let instant = TOGETHER.max(self.one_instant(self.step_ahead()));
        let since = self.margins.rearmed_at(event);
        since.is_some_and(|[since, own]| self.time - since <= instant.max(own))
    }
}
