//! Behind what a step ended on to the last digit: what jumps there is what it is on the side that the motion goes to, for the first stage and for the energy.

use mbd_scene::Float;

use super::ModelRun;
use super::stability::Meter;
use crate::balance::EnergyReading;
use crate::error::StepError;
use crate::locate::AT_REST;

/// How much later the first stage is evaluated where an event starts at its value, the shortest at which it is behind [s].
const AHEAD: [f64; 3] = [1e-12, 1e-9, AT_REST];

impl<T: Float> ModelRun<T> {
    /// Evaluates the first stage a little later, where events start at their value, or a step ended on it to the last digit: what jumps there,
    /// `if(v < 0 m/s, …)` from rest, is what it is on the side that the motion goes to.
    pub(crate) fn begin_behind(&mut self) -> Result<(), StepError> {
        if !self.system.may_jump() {
            return Ok(());
        }
        for ahead in AHEAD {
            if !self.margins.are_at_value() {
                break;
            }
            self.look_ahead(ahead)?;
            self.begin_at_look(ahead)?;
        }
        if self.margins.are_at_value() {
            self.look_at_neighbours(AT_REST)?;
            self.begin_at_look(AT_REST)?;
        }
        self.inside.copy_from_slice(&self.state);
        self.read_margins(self.time, 0.0)
    }

    /// Evaluates the first stage at what was looked at, so much later [s].
    fn begin_at_look(&mut self, ahead: f64) -> Result<(), StepError> {
        let ahead = ahead.max(self.behind_jump());
        let (from, inside) = (self.time + ahead, &self.inside);
        self.method.begin(&mut self.system, from, ahead, inside)
    }

    /// Energy and power here; where the first stage was evaluated behind an event ([`Simulation::begin_behind`]) those behind it, too: a power that jumps there
    /// is no work of the next step.
    pub(crate) fn energy_behind(&mut self) -> Option<EnergyReading> {
        self.inside.copy_from_slice(&self.state);
        let mut from = self.time + self.behind_jump();
        if self.system.may_jump() && self.margins.are_at_value() {
            for ahead in AHEAD {
                if self.margins.are_at_value() {
                    self.look_ahead(ahead).ok()?;
                    from = from.max(self.time + ahead);
                }
            }
            if self.margins.are_at_value() {
                self.look_at_neighbours(AT_REST).ok()?;
            }
        }
        let reading = self.system.energy_and_power(self.meter, from, &self.inside);
        if from > self.time {
            self.inside.copy_from_slice(&self.state);
            self.read_margins(self.time, 0.0).ok()?;
        }
        reading
    }

    /// Goes on behind what jumped at the end of the last step, with the energy at a time there [s]: where nothing moves time alone lets the energy of lines jump, of a
    /// `static` node whose load jumps, of a free length that does. Between balances that is the work of what jumps, and a step neither makes nor loses it.
    pub(super) fn jump_energy(&mut self, time: f64) {
        // What the laws are asked for now and then is given and taken by nothing.
        if self.meter == Meter::Laws {
            return;
        }
        let now = self.system.energy_and_power(self.meter, time, &self.state);
        if let (Some(balance), Some(now)) = (&mut self.balance, now) {
            balance.jump(now.total() - balance.energy());
            balance.take_up(now);
        }
    }

    /// Reads the margins where the rates of now lead in a time [s], and at least to the next number: what is far from zero moves by less than numbers tell apart.
    pub(crate) fn look_at_neighbours(&mut self, ahead: f64) -> Result<(), StepError> {
        let step = T::from_f64(ahead);
        for ((x, from), rate) in self
            .inside
            .iter_mut()
            .zip(&self.state)
            .zip(self.method.first())
        {
            let by = step * *rate;
            *x = *from + by;
            if *x == *from && *rate != T::zero() {
                let least = T::EPSILON * from.abs();
                *x += if *rate > T::zero() { least } else { -least };
            }
        }
        self.read_margins(self.time + ahead, ahead)
    }
}
