//! How long the steps of an adaptive run are along its time, so that another run may take finer ones everywhere.
//!
//! Where events, samples and entries of tables end the steps a tighter tolerance alone makes the same steps again, and their error is in both runs. A bound by the
//! mean step does not help where much time goes by in few steps elsewhere.

use crate::trajectory::resolution;

/// So many times are kept at most: of a longer run every second, fourth, … step.
const MOST: usize = 1024;
/// A step that ends on an event may be as short as what times resolve; its neighbours tell how long steps are there.
const NEIGHBOURS: usize = 2;
/// A finer step resolves time by so much.
const RESOLVED: f64 = 64.0;

/// The sizes of the accepted steps of an adaptive run along its time; of a run of more than a thousand steps means of several in a row.
///
/// [`Simulation::refine`](crate::Simulation::refine) takes finer ones.
#[derive(Clone, Debug, PartialEq)]
pub struct StepSizes {
    /// Ends of steps, so many apart, the start first [s].
    times: Vec<f64>,
    apart: u32,
    /// Steps since the last of them.
    since: u32,
}

impl Default for StepSizes {
    fn default() -> Self {
        StepSizes {
            times: Vec::new(),
            apart: 1,
            since: 0,
        }
    }
}

impl StepSizes {
    /// Begins anew at a time [s].
    pub(crate) fn begin(&mut self, time: f64) {
        self.times.clear();
        self.times.reserve(MOST + 1);
        self.times.push(time);
        (self.apart, self.since) = (1, 0);
    }

    /// A step was accepted that ends then [s].
    #[inline]
    pub(crate) fn add(&mut self, end: f64) {
        self.since += 1;
        if self.since >= self.apart {
            self.keep(end);
        }
    }

    fn keep(&mut self, end: f64) {
        // A run that went back to a snapshot makes steps anew.
        while self.times.last().is_some_and(|last| *last > end) {
            self.times.pop();
        }
        self.times.push(end);
        self.since = 0;
        if self.times.len() > MOST {
            let mut place = 0;
            self.times.retain(|_| {
                place += 1;
                place % 2 == 1
            });
            self.apart = self.apart.saturating_mul(2);
        }
    }

    /// How long the steps at a time were, the longest mean around it [s]; infinite where none is known.
    #[must_use]
    pub fn at(&self, time: f64) -> f64 {
        let behind = self.times.partition_point(|end| *end <= time);
        let from = behind.saturating_sub(1 + NEIGHBOURS);
        let to = (behind + 1 + NEIGHBOURS).min(self.times.len());
        let around = self.times.get(from..to).unwrap_or(&[]);
        let steps = around.windows(2).map(|pair| match pair {
            [from, to] => (to - from) / f64::from(self.apart),
            _ => 0.0,
        });
        let longest = steps.fold(0.0, f64::max);
        match longest > 0.0 {
            true => longest.max(RESOLVED * resolution(time)),
            false => f64::INFINITY,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_those_of_the_steps_at_the_time_however_many_there_are() {
        for (ticks, share) in [(100, 1.0), (100_000, 0.999)] {
            let mut sizes = StepSizes::default();
            sizes.begin(0.0);
            for tick in 1..=ticks {
                sizes.add(1e-3 * f64::from(tick));
                // An event ends a step at once.
                sizes.add(1e-3 * f64::from(tick) + 1e-14);
            }
            let flown = 1e-3 * f64::from(ticks);
            (1..=20).for_each(|step| sizes.add(flown + 10.0 * f64::from(step)));
            assert!(sizes.times.len() <= MOST + 1);
            let ticking = sizes.at(0.5 * flown);
            // Means are over pairs of a tick and its end.
            assert!(
                ticking <= 1e-3 * 1.001 && ticking >= 0.5e-3 * share,
                "{ticking}"
            );
        }
        assert_eq!(StepSizes::default().at(1.0), f64::INFINITY);
    }
}
