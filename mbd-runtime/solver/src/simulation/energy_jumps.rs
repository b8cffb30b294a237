//! Energy that jumps where time alone prescribes it while nothing moves: that of the lines of a `static` node whose load jumps, of a line whose free
//! length does. Between balances it is the work of what jumps, and a step neither makes nor loses it.
//!
//! Adaptive steps end there and take the energy up behind it; fixed steps run over it, and the jump is
//!
//! ```text
//! E(t_b + ε, x(t_b)) − E(t_b − ε, x(t_b)).                                                                              (1)
//! ```
//!
//! Derived.

use mbd_scene::{Float, Quantity};

use super::{Pace, Simulation};

impl<T: Float> Simulation<T> {
    /// (1) of all such times in the attempted step, whose ends have these energies [J]: at its ends as far as they are on the other side.
    pub(super) fn energy_jumps(&mut self, step: f64, [first, last]: [f64; 2]) -> f64 {
        let Pace::Fixed(_) = self.pace else {
            return 0.0;
        };
        let (start, end) = (self.time, self.time + step);
        let apart = self.one_instant(step);
        let mut jumped = 0.0;
        let mut from = start - apart;
        while let Some(next) = self.system.next_break(from)
            && next.time <= end + apart
        {
            from = next.time;
            if !next.jumps {
                continue;
            }
            let at_start = next.time <= start + apart;
            let at_end = next.time >= end - apart;
            let before = match at_start {
                true => Some(first),
                false => self.energy_inside(next.time.min(end) - apart, step),
            };
            let after = match at_end {
                true => Some(last),
                false => self.energy_inside(next.time.max(start) + apart, step),
            };
            let by = before.zip(after).map(|(before, after)| after - before);
            jumped += by.filter(|by| by.is_finite()).unwrap_or(0.0);
        }
        jumped
    }

    /// Goes on behind what jumped at the end of the last step, with the energy at a time there [s].
    pub(super) fn jump_energy(&mut self, time: f64) {
        let now = self.system.energy_and_power(self.meter, time, &self.state);
        if let (Some(balance), Some(now)) = (&mut self.balance, now) {
            balance.jump(now.total() - balance.energy());
            balance.take_up(now);
        }
    }

    /// The energy at a time inside the attempted step [J].
    fn energy_inside(&mut self, time: f64, step: f64) -> Option<f64> {
        let span = time - self.time;
        self.inside_state(span / step, step).ok()?;
        self.system.look(time, span, &self.inside).ok()?;
        let mut energy = self.system.energy;
        self.system
            .seen(Quantity::Energy, time, &self.inside, &mut energy);
        let [kinetic, gravitational, elastic, ..] = energy.map(T::to_f64);
        Some(kinetic + gravitational + elastic)
    }
}
