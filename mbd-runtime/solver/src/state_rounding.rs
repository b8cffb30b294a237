//! What rounding of numbers that grow makes of a run: angles count turns, declared states may be phases, distances and sums, and the larger a number is,
//! the further apart are those that it is told from.
//!
//! ```text
//! δ = Σ ((x ⊕ h b₁ f ⊕ …) ⊖ x) − h f  over the steps,      against   |x − x₀|           what rounding took from a number by steps    (1)
//! |f(x + max(ε x, |δ|)) − f(x)|    against   |f|                                     what follows it has of its digits            (2)
//! max(ε |φ|, |δ|)                  against   1 rad                                   the attitude of what turns by an angle φ      (3)
//! ```
//!
//! ⊕ and ⊖ round; b are the weights of the stages, added one after the other, here as if all had the same rate. A number that grows evenly is rounded to the same side at every step: (1) adds up one step of each look for all since the last, and each look is at one number, in turn. It is zero
//! where a method keeps what rounding takes. In (2) f are accelerations, rates of states, outputs and guards of events, each by the largest so far, and accelerations by that of
//! gravity at least. What brings a number back to where it was is left out: a stiff spring on an angle, a state that decays, feel rounding, and lose nothing by it.
//! A state that has neither doubled nor moved by a thousand of its roundings has the digits of its start.
//!
//! Source: derived; (1) from Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed., section 4.3.

use serde::{Deserialize, Serialize};

use crate::rounding::REFUSED;

/// A distance of two numbers below which nothing is looked at [the SI unit of the number].
const CLOSE: f64 = 1e-6;
/// What steps took from a number is more than its digits say from so many of its roundings on, and where it is so much of all that they took to either side:
/// what is rounded up as often as down, as a body at rest is, stays where it is.
const SEEN: f64 = 64.0;
const ONE_SIDED: f64 = 0.5;
/// From so many of its roundings on a declared state has moved: what its distance from the start makes has three digits.
const MOVED: f64 = 1e3;
/// So many looks at a number must agree before a run is refused: where what follows it is near zero, one says too much.
const LOOKS: u32 = 10;

/// An angle of a joint or a declared state that grew until numbers of the run have few digits of it left.
#[derive(Clone, Debug, PartialEq)]
pub struct CoarseState {
    /// The number of the state, by name: `pin.angle`, `phase`.
    pub state: String,
    /// Its unit; empty for a pure number.
    pub unit: String,
    /// What suffers by it: an acceleration, the rate of a state, an output, or the state itself.
    pub affected: String,
    /// The number.
    pub value: f64,
    /// How far apart numbers there are that the run tells apart, or what rounding took by many steps, if that is more.
    pub apart: f64,
    /// What that makes, as a part of what suffers.
    pub share: f64,
}

/// What suffers by a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Suffers {
    /// The attitude of what turns by it, or how far it got.
    Itself,
    /// The rate of a number of the state.
    Rate(usize),
    /// An output.
    Output(usize),
    /// When an event happens.
    Event(usize),
    /// Itself, an angle whose turns are counted beside the state: its place among them is the number.
    Turned,
}

/// What is worst so far.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct WorstState {
    /// The number of the state, of what is [`Suffers::Turned`] that among the angles.
    pub at: usize,
    pub suffers: Suffers,
    pub value: f64,
    pub apart: f64,
    pub share: f64,
}

/// A number that is watched.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct WatchedNumber {
    at: usize,
    kind: NumberKind,
    start: f64,
    /// The furthest that it was from its start.
    moved: f64,
    /// δ of (1), and the same without signs.
    taken: f64,
    #[serde(default)]
    either_way: f64,
    /// Of how many steps they are.
    #[serde(default)]
    samples: u32,
    looks: u32,
}

/// What a watched number is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum NumberKind {
    /// An angle that counts turns, with the number of its rate in the state.
    Angle(usize),
    /// A declared state.
    Declared,
    /// A length along an axis: it is looked at by (1) alone, the rest is said by [`Rounding`](crate::rounding::Rounding).
    Length,
}

/// A step as far as (1) needs it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LookedStep<'a, T> {
    pub state: &'a [T],
    pub rates: &'a [T],
    pub step: f64,
    /// The weights by which the method adds rates to the state, one after the other; none where it adds their sum.
    pub weights: &'a [T],
    /// How many steps there are between two looks.
    pub steps: f64,
    /// Whether the method adds what rounding takes in the next step.
    pub keeps: bool,
}

impl<T: mbd_scene::Float> LookedStep<'_, T> {
    /// What rounding took from a number in the steps since the last look, by (1).
    fn taken(&self, at: usize) -> f64 {
        let (Some(&x), Some(&rate)) = (self.state.get(at), self.rates.get(at)) else {
            return 0.0;
        };
        let h = T::from_f64(self.step);
        let added = h * rate;
        let end = match self.weights {
            [] => x + added,
            weights => weights
                .iter()
                .fold(x, |sum, weight| sum + h * *weight * rate),
        };
        let taken = (end - x - added).to_f64();
        if taken.is_finite() {
            self.steps * taken
        } else {
            0.0
        }
    }
}

/// (1) to (3) so far.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct StateRounding {
    numbers: Vec<WatchedNumber>,
    /// Looks so far: numbers are looked at by (1) in turn.
    seen: usize,
    /// The number that is moved next.
    next: usize,
    /// Whether numbers were found that have few digits.
    coarse: bool,
    /// Of every rate of the state, then of every output and every guard, the largest so far.
    largest: Vec<f64>,
    /// What ends a run, and what is told alone.
    refused: Option<WorstState>,
    told: Option<WorstState>,
}

impl StateRounding {
    /// Begins with these numbers of a state.
    pub(crate) fn begin(&mut self, numbers: impl Iterator<Item = (usize, NumberKind, f64)>) {
        self.numbers.clear();
        self.numbers
            .extend(numbers.map(|(at, kind, start)| WatchedNumber {
                at,
                kind,
                start,
                moved: 0.0,
                taken: 0.0,
                either_way: 0.0,
                samples: 0,
                looks: 0,
            }));
        (self.seen, self.next, self.coarse) = (0, 0, false);
        self.largest.clear();
        (self.refused, self.told) = (None, None);
    }

    /// Copies another one into the room of this one.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.numbers.clone_from(&other.numbers);
        self.largest.clone_from(&other.largest);
        (self.seen, self.next, self.coarse) = (other.seen, other.next, other.coarse);
        (self.refused, self.told) = (other.refused, other.told);
    }

    /// Whether nothing but lengths is watched, which are never moved.
    pub(crate) fn sees_lengths(&self) -> bool {
        let mut numbers = self.numbers.iter();
        numbers.all(|number| number.kind == NumberKind::Length)
    }

    /// Takes in a step by (1) and (3); a number that is to be moved by (2), and by how much.
    pub(crate) fn see<T: mbd_scene::Float>(
        &mut self,
        step: LookedStep<'_, T>,
    ) -> Option<(usize, f64)> {
        let precision = T::EPSILON.to_f64();
        let count = self.numbers.len();
        let place = self.seen % count.max(1);
        self.seen = self.seen.wrapping_add(1);
        let since = if self.seen > place + 1 {
            count
        } else {
            place + 1
        };
        if let Some(number) = self.numbers.get_mut(place)
            && let Some(x) = step.state.get(number.at)
        {
            let value = x.to_f64();
            number.moved = number.moved.max((value - number.start).abs());
            if !step.keeps {
                let taken = since as f64 * step.taken(number.at);
                number.taken += taken;
                number.either_way += taken.abs();
                number.samples = number.samples.saturating_add(1);
            }
            let number = *number;
            let apart = number.apart(precision * value.abs());
            if apart >= CLOSE {
                // Lengths are never moved.
                self.coarse |= number.kind != NumberKind::Length;
                self.keep_coarse(&number, (value, precision * value.abs()), apart);
            }
        }
        match self.coarse {
            true => self.pick(precision, step.state),
            false => None,
        }
    }

    /// Takes in what a number with few digits makes of itself, by (1) and (3).
    #[cold]
    fn keep_coarse(&mut self, number: &WatchedNumber, (value, rounding): (f64, f64), apart: f64) {
        let worst = |share| WorstState {
            at: number.at,
            suffers: Suffers::Itself,
            value,
            apart,
            share,
        };
        if let NumberKind::Angle(_) = number.kind {
            keep(&mut self.told, worst(apart));
        }
        // All of what stays where it is, too.
        if number.is_taken(rounding) {
            let share = number.taken.abs() / number.moved.max(number.taken.abs());
            keep(&mut self.told, worst(share));
            keep(&mut self.refused, worst(share));
        }
    }

    /// The next number in turn that is to be moved by (2).
    fn pick<T: mbd_scene::Float>(&mut self, precision: f64, state: &[T]) -> Option<(usize, f64)> {
        let count = self.numbers.len();
        let from = self.next;
        let turns = (0..count).map(|place| (from + place) % count);
        let (place, apart) = turns.into_iter().find_map(|place| {
            let number = self.numbers.get(place)?;
            let value = state.get(number.at)?.to_f64();
            let grown = match number.kind {
                NumberKind::Angle(_) => true,
                NumberKind::Declared => {
                    let far = number.moved >= MOVED * precision * value.abs();
                    far || value.abs() > 2.0 * number.start.abs()
                }
                NumberKind::Length => false,
            };
            let apart = number.apart(precision * value.abs());
            (grown && apart >= CLOSE).then_some((place, apart))
        })?;
        self.next = place + 1;
        let number = self.numbers.get_mut(place)?;
        number.looks = number.looks.saturating_add(1);
        Some((number.at, apart))
    }

    /// Takes in (3) of the angles whose turns are counted beside the state.
    pub(crate) fn see_turns<T: mbd_scene::Float>(&mut self, angles: &[T]) {
        for (at, angle) in angles.iter().enumerate() {
            let value = angle.to_f64();
            let apart = T::EPSILON.to_f64() * value.abs();
            if apart >= CLOSE {
                let worst = WorstState {
                    at,
                    suffers: Suffers::Turned,
                    value,
                    apart,
                    share: apart,
                };
                keep(&mut self.told, worst);
            }
        }
    }

    /// Takes in (2): what moving a number by some makes of rates, outputs and guards. `least`: what an acceleration of the state is measured against at least;
    /// `event`: the one that a guard belongs to.
    pub(crate) fn compare<T: mbd_scene::Float>(
        &mut self,
        (at, value, apart): (usize, f64, f64),
        [rates, outputs, guards]: [[&[T]; 2]; 3],
        least: impl Fn(usize) -> f64,
        event: impl Fn(usize) -> Option<usize>,
    ) {
        let length = rates[0].len();
        let told = length + outputs[0].len();
        self.largest.resize(told + guards[0].len(), 0.0);
        let Some(number) = self.numbers.iter().find(|number| number.at == at).copied() else {
            return;
        };
        let [here, there] = [0, 1].map(|which| {
            rates[which]
                .iter()
                .chain(outputs[which])
                .chain(guards[which])
        });
        for (index, (here, there)) in here.zip(there).enumerate() {
            let change = (*there - *here).to_f64();
            let size = here.to_f64().abs();
            let Some(largest) = self.largest.get_mut(index) else {
                return;
            };
            if !change.is_finite() {
                continue;
            }
            *largest = largest.max(size);
            let brings_back = number.own_rate() == index && change < 0.0;
            if change == 0.0 || brings_back {
                continue;
            }
            let (suffers, least) = if index < length {
                (Suffers::Rate(index), least(index))
            } else if index < told {
                (Suffers::Output(index - length), 0.0)
            } else if let Some(event) = event(index - told) {
                (Suffers::Event(event), 0.0)
            } else {
                continue;
            };
            let share = change.abs() / largest.max(least).max(change.abs());
            let worst = WorstState {
                at,
                suffers,
                value,
                apart,
                share,
            };
            if number.looks >= LOOKS {
                keep(&mut self.told, worst);
                if index < length {
                    keep(&mut self.refused, worst);
                }
            }
        }
    }

    /// Forgets what was seen, to look anew at the angles and declared states with few digits at a state, whether they grew or began so: each of them, with how far
    /// apart numbers are there.
    pub(crate) fn look_anew<T: mbd_scene::Float>(&mut self, state: &[T]) -> Vec<(usize, f64)> {
        self.largest.clear();
        self.refused = None;
        let mut all = Vec::new();
        for number in &mut self.numbers {
            number.looks = 0;
            let value = state.get(number.at).map_or(0.0, |x| x.to_f64());
            let apart = T::EPSILON.to_f64() * value.abs();
            if number.kind != NumberKind::Length && apart >= CLOSE {
                all.push((number.at, apart));
            }
        }
        all
    }

    /// Counts a look at a number; whether more are needed before it says something.
    pub(crate) fn needs_more(&mut self, at: usize) -> bool {
        let Some(number) = self.numbers.iter_mut().find(|number| number.at == at) else {
            return false;
        };
        number.looks = number.looks.saturating_add(1);
        number.looks <= 2 * LOOKS
    }

    /// The worst so far.
    pub(crate) fn told(&self) -> Option<WorstState> {
        self.told
    }

    /// The largest part of accelerations and rates of states that rounding makes.
    pub(crate) fn share_of_rates(&self) -> f64 {
        self.refused.map_or(0.0, |worst| worst.share)
    }

    /// What makes most of accelerations and rates of states.
    pub(crate) fn worst_of_rates(&self) -> Option<WorstState> {
        self.refused
    }

    /// What a run is to be refused for.
    pub(crate) fn is_refused(&self) -> Option<WorstState> {
        self.refused.filter(|worst| worst.share >= REFUSED)
    }
}

impl WatchedNumber {
    /// max(ε |x|, |δ|), of ε |x|.
    fn apart(&self, rounding: f64) -> f64 {
        rounding.max(self.taken.abs())
    }

    /// Whether steps took more from it than its digits, of ε |x| each, say.
    fn is_taken(&self, rounding: f64) -> bool {
        let taken = self.taken.abs();
        let sure = self.samples >= LOOKS && taken > ONE_SIDED * self.either_way;
        sure && taken > CLOSE.max(SEEN * rounding)
    }

    /// The rate that brings it back: its own, of an angle that of its speed.
    fn own_rate(&self) -> usize {
        match self.kind {
            NumberKind::Angle(speed) => speed,
            NumberKind::Declared | NumberKind::Length => self.at,
        }
    }
}

/// The worse of two.
fn keep(worst: &mut Option<WorstState>, new: WorstState) {
    if new.share > worst.map_or(0.0, |old| old.share) {
        *worst = Some(new);
    }
}
