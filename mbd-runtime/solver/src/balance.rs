//! The balance of energy of a run: what its steps make or lose that nothing gave or took.
//!
//! ```text
//! imbalance = E(t) − E(0) − ∫ P dt,   P = power of loads, of dampers and friction, of prescribed motions         (1)
//! ```
//!
//! is zero for the exact motion, whatever it is: every error of a step shows in it, of what turns, swings, falls, bounces or is damped alike, and
//! relative to the energy that moved it has no unit. E is a function of the state; ∫ P is the work that the run integrates
//! along ([`Options::work`](crate::Options::work)) or else, at fixed steps, the integral of the cubic through the power at the last four step ends.
//! After anything that jumps (a switch, an input that changed) the cubic begins anew with the power in the middle of the step, without which a
//! first step from rest would count half of its damping as error.
//! Source: derived; the use as a watch: `E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration`, on energy as the invariant that shows
//! a wrong step first. Rejected: P at every stage (a fifth to a third of a step for a damped scene), a second run of doubled steps now and then
//! (its sampling beats with the period of the motion).

use serde::{Deserialize, Serialize};

use crate::trajectory::Trajectory;

/// Energies that are told apart: kinetic, gravitational, elastic.
pub(crate) const ENERGIES: usize = 3;
/// What of the sizes of the energies rounding may leave, in units of the precision.
const ROUNDING: f64 = 64.0;
/// How many roundings of the places of its ends the stretch of a line may be off by over a run.
const ROUNDED_ENDS: f64 = 8.0;

/// Steps that differ by less than this part are even.
const EVEN: f64 = 1e-6;
/// Powers closer to each other than this part of a step tell nothing of it.
const CLOSE: f64 = 0.1;

/// What a run made or lost of energy without a cause.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Imbalance {
    /// The largest |E − E(0) − work of loads, dampers and prescribed motions| at a step end [J].
    pub energy: f64,
    /// The energy that moved: the largest kinetic energy, change of a potential one or work [J]; where nothing has kinetic energy, as in a scene of nothing but
    /// equilibrium points, the largest energy.
    pub moved: f64,
    /// What of the first rounding explains, by the sizes of the energies [J].
    pub rounding: f64,
}

impl Imbalance {
    /// The imbalance over the energy that moved, without what rounding explains; zero where nothing moved.
    #[must_use]
    pub fn relative(&self) -> f64 {
        match self.moved > 0.0 && (self.energy.is_nan() || self.energy > self.rounding) {
            true => (self.energy - self.rounding) / self.moved,
            false => 0.0,
        }
    }
}

/// Energy and power at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EnergyReading {
    /// Kinetic, gravitational, elastic energy [J].
    pub energies: [f64; ENERGIES],
    /// Power of what gives and takes energy [W].
    pub power: f64,
}

impl EnergyReading {
    pub(crate) fn total(&self) -> f64 {
        self.energies.iter().sum()
    }
}

/// The smallest and the largest value so far, from zero on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct ValueRange {
    low: f64,
    high: f64,
}

impl ValueRange {
    fn widen(&mut self, value: f64) {
        self.low = self.low.min(value);
        self.high = self.high.max(value);
    }

    fn extent(&self) -> f64 {
        self.high - self.low
    }
}

/// (1) so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct EnergyBalance {
    /// Energies at the last step end [J].
    last: [f64; ENERGIES],
    /// Times before the last step end [s], the last one first, and the powers there [W].
    before: [(f64, f64); 3],
    /// How many of them there are since something jumped.
    known: usize,
    /// E − E(0) − ∫ P dt [J].
    surplus: f64,
    /// Changes of each energy since the start, without those that jumped, and the work.
    ranges: [ValueRange; ENERGIES + 1],
    /// Where these changes stand.
    changes: [f64; ENERGIES + 1],
    /// The largest kinetic energy, and the largest sum of the sizes of the energies [J].
    kinetic: f64,
    size: f64,
    most: f64,
    /// The sizes of the works that the run integrates along, added up over its steps [J]: each step rounds them, those of large ones that almost cancel, too.
    #[serde(default)]
    sums: f64,
    /// ½ ΣK L² of lines, whose ends have places as large as L [J]: what of it rounding of places makes is no change.
    #[serde(default)]
    lines: f64,
    /// What the works of the steps, together, may be off by through numbers that grow, as phases, and are rounded [J]: always to the same side, where the pattern of
    /// rounding beats with the motion.
    #[serde(default)]
    unsure: f64,
}

impl EnergyBalance {
    /// Takes up the energy after a start or after something jumped: what jumped counts neither as made nor as lost.
    pub(crate) fn take_up(&mut self, now: EnergyReading) {
        self.last = now.energies;
        self.before = [(0.0, now.power); 3];
        self.known = 1;
        self.widen(&now);
    }

    /// The energy at the last step end [J].
    pub(crate) fn energy(&self) -> f64 {
        self.last.iter().sum()
    }

    /// The elastic energy jumps by so much where nothing moves [J], the work of what jumps.
    pub(crate) fn jump(&mut self, by: f64) {
        let ([.., last], [.., elastic, work]) = (&mut self.last, &mut self.changes);
        for energy in [last, elastic, work] {
            *energy += by;
        }
        for (range, change) in self.ranges.iter_mut().zip(&self.changes) {
            range.widen(*change);
        }
    }

    /// A step ends with works of these sizes, together [J].
    pub(crate) fn add_up(&mut self, works: f64) {
        self.sums += works;
    }

    /// A step ends with a work that differs by so much between two numbers next to each other [J].
    pub(crate) fn doubt(&mut self, work: f64) {
        self.unsure += 0.5 * work.abs();
    }

    /// Whether the next step, of this size [s], needs the power in its middle: powers that are much closer to each other say nothing of a step so long, and
    /// what jumps between them would be taken for a slope.
    pub(crate) fn is_fresh(&self, step: f64) -> bool {
        let [_, (one, _), (two, _)] = self.before;
        self.known < 3 || (-one).min(one - two) < CLOSE * step
    }

    /// The work of a step [J] by the cubic through the powers at its ends, at those before, and `middle` in the middle of it where it is given.
    pub(crate) fn work(&self, step: f64, middle: Option<f64>, end: f64) -> f64 {
        let (_, start) = self.before[0];
        if let Some(middle) = middle {
            return step / 6.0 * (start + 4.0 * middle + end);
        }
        let [b, c, d] = self.before;
        let even = |(time, _): (f64, f64), steps: f64| (time + steps * step).abs() < EVEN * step;
        if even(c, 1.0) && even(d, 2.0) {
            // The same cubic at even steps (Adams–Moulton).
            return step / 24.0 * (9.0 * end + 19.0 * start - 5.0 * c.1 + d.1);
        }
        let points = [(step, end), b, c, d];
        // Two points of Gauss integrate a cubic exactly.
        let half = step / 2.0;
        let off = half / 3.0_f64.sqrt();
        half * (lagrange(&points, half - off) + lagrange(&points, half + off))
    }

    /// Takes a step that ended with `now` and in which `work` was done [J].
    pub(crate) fn take(&mut self, step: f64, work: f64, now: EnergyReading) {
        let before = self.energy();
        self.surplus += gained([before, now.total()], work);
        let energies = now
            .energies
            .iter()
            .zip(&self.last)
            .map(|(now, last)| now - last);
        for (change, by) in self.changes.iter_mut().zip(energies.chain([work])) {
            *change += by;
        }
        for (range, change) in self.ranges.iter_mut().zip(&self.changes) {
            range.widen(*change);
        }
        self.last = now.energies;
        let [b, c, _] = self.before;
        let moved = |(time, power): (f64, f64)| (time - step, power);
        self.before = [(0.0, now.power), moved(b), moved(c)];
        self.known = (self.known + 1).min(3);
        self.most = self.most.max(self.surplus.abs());
        if !self.surplus.is_finite() {
            self.most = f64::INFINITY;
        }
        self.widen(&now);
    }

    fn widen(&mut self, now: &EnergyReading) {
        let [kinetic, ..] = now.energies;
        self.kinetic = self.kinetic.max(kinetic);
        self.size = self
            .size
            .max(now.energies.iter().map(|part| part.abs()).sum());
    }

    /// Begins to follow lines with ½ ΣK L² [J].
    pub(crate) fn with_lines(lines: f64) -> Self {
        EnergyBalance {
            lines,
            ..EnergyBalance::default()
        }
    }

    /// What rounding makes at this precision: of the sums, of those of works by half a unit of their last place a step, and of the energy of lines that are
    /// straight or almost so, E = ½ K s² with s off by ε L.
    fn rounding(&self, precision: f64) -> f64 {
        let by_stretches = |ends: f64| ends * precision * self.lines.sqrt();
        let unstretched = by_stretches(ROUNDING).powi(2);
        let stretched = by_stretches(ROUNDED_ENDS) * self.moved().sqrt();
        let summed = 0.5 * precision * self.sums;
        ROUNDING * precision * self.size + summed + unstretched + stretched + self.unsure
    }

    /// What moved so far [J]. Lines whose equilibrium points turn with a load keep their energy: where there is no kinetic one, all of it counts.
    fn moved(&self) -> f64 {
        let changed = self.ranges.iter().map(ValueRange::extent);
        let known = if self.kinetic > 0.0 {
            self.kinetic
        } else {
            self.size
        };
        changed.fold(known, f64::max)
    }

    /// The largest imbalance so far, in numbers of this `precision`.
    pub(crate) fn imbalance(&self, precision: f64) -> Imbalance {
        Imbalance {
            energy: self.most,
            moved: self.moved(),
            rounding: self.rounding(precision),
        }
    }

    /// The most that was made (positive, if more is made than lost now) or lost, over the energy that moved, without what rounding at this `precision`
    /// explains.
    pub(crate) fn excess(&self, precision: f64) -> f64 {
        let over = (self.most - self.rounding(precision)).max(0.0);
        match (over > 0.0, self.moved()) {
            (false, _) => 0.0,
            (true, moved) if moved > 0.0 => over.copysign(self.surplus) / moved,
            _ => f64::INFINITY,
        }
    }
}

impl Trajectory {
    /// (1) at every row [J], of the columns of energy and of work where the run integrated it: the curve of what
    /// [`Simulation::imbalance`](crate::Simulation::imbalance) follows at every step. `None` of a history without energy. Where the caller supplies gravity,
    /// which has no energy then, it means nothing.
    #[must_use]
    pub fn energy_surplus(&self) -> Option<Vec<f64>> {
        let total = self.column("energy.total")?;
        let names = self.names().iter().map(|name| name.name.as_str());
        let works = names.filter(|name| name.starts_with("work."));
        let works: Vec<&[f64]> = works.filter_map(|name| self.column(name)).collect();
        // Work that is not integrated is not there: the column holds no number.
        let work = |row: usize| -> f64 {
            let done = works.iter().filter_map(|work| work.get(row));
            done.filter(|work| work.is_finite()).sum()
        };
        let mut surplus = 0.0;
        let mut before = (*total.first()?, work(0));
        let rows = total.iter().enumerate().map(|(row, total)| {
            let now = (*total, work(row));
            surplus += gained([before.0, now.0], now.1 - before.1);
            before = now;
            surplus
        });
        Some(rows.collect())
    }
}

/// (1) of a step or between two rows: what the energy changed by, less the work.
fn gained([before, after]: [f64; 2], work: f64) -> f64 {
    after - before - work
}

/// The polynomial through four points, at `x`.
fn lagrange(points: &[(f64, f64); 4], x: f64) -> f64 {
    let term = |(i, (at, value)): (usize, &(f64, f64))| {
        let others = points.iter().enumerate().filter(|(j, _)| *j != i);
        let weight: f64 = others
            .map(|(_, (other, _))| (x - other) / (at - other))
            .product();
        value * weight
    };
    points.iter().enumerate().map(term).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reading(energy: f64, power: f64) -> EnergyReading {
        EnergyReading {
            energies: [energy, 0.0, 0.0],
            power,
        }
    }

    /// The work of ∫ P over steps of uneven sizes; the error over the whole.
    fn error(power: impl Fn(f64) -> f64, integral: impl Fn(f64) -> f64, step: f64) -> f64 {
        let mut balance = EnergyBalance::default();
        balance.take_up(reading(0.0, power(0.0)));
        let (mut time, mut done) = (0.0, 0.0);
        for number in 0..(2.0 / step) as usize {
            let step = if number % 3 == 1 { 0.7 * step } else { step };
            let end = power(time + step);
            let middle = balance.is_fresh(step).then(|| power(time + 0.5 * step));
            let work = balance.work(step, middle, end);
            time += step;
            done += work;
            balance.take(step, work, reading(integral(time), end));
        }
        (done - integral(time)).abs()
    }

    #[test]
    fn the_work_of_a_cubic_power_is_exact() {
        let cubic = |t: f64| 1.0 - 2.0 * t + 3.0 * t * t - 4.0 * t.powi(3);
        let integral = |t: f64| t - t * t + t.powi(3) - t.powi(4);
        assert!(error(cubic, integral, 0.1) < 1e-13);
    }

    #[test]
    fn the_work_is_of_order_four() {
        let [coarse, fine] = [0.1, 0.05].map(|step| error(f64::cos, f64::sin, step));
        assert!((coarse / fine).log2() > 3.8, "{coarse} {fine}");
    }

    #[test]
    fn what_jumps_is_not_made_and_what_is_lost_counts() {
        let mut balance = EnergyBalance::default();
        balance.take_up(reading(10.0, 0.0));
        balance.take_up(reading(15.0, 0.0));
        balance.take(0.1, 0.0, reading(14.0, 0.0));
        assert_eq!(balance.imbalance(0.0).energy, 1.0);
        assert!((balance.excess(0.0) + 1.0 / 15.0).abs() < 1e-15);
    }
}
