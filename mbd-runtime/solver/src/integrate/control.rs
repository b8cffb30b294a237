//! The step size of an adaptive run: a proportional–integral controller.
//!
//! After an accepted step with error E (1: exactly at the tolerance) h ← h · clamp(0.9 E^(−0.7/k) E_prev^(b/k), 0.2, 5), after a rejected one
//! h ← h · max(0.1, 0.9 E^(−1/k)); k is the order of the error estimate plus one; b = 0.4 for explicit pairs, 0.3 for Rosenbrock methods. E_prev is floored at 1e-4.
//!
//! Source: E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, IV.2.

use serde::{Deserialize, Serialize};

/// Rejections in a row after which a step has collapsed.
const MOST_REJECTIONS: u32 = 10;
/// Trials in a row that may fail to evaluate.
const MOST_FAILURES: u32 = 3;

/// What becomes of a trial step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    Accepted,
    Rejected,
    /// Ten rejections or three failures in a row, or below the smallest step.
    Collapsed,
}

/// The controller's memory. All of it is part of a snapshot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Control {
    /// The step to try next [s].
    pub step: f64,
    /// The largest step [s]: an option of the run, which no snapshot brings along. It may be infinite, which JSON cannot write.
    #[serde(skip, default = "unbounded")]
    pub largest: f64,
    previous: f64,
    rejections: u32,
    failures: u32,
    exponent: f64,
    /// The power of the error before: 0.4 of explicit pairs, 0.3 of Rosenbrock methods.
    memory: f64,
}

/// A largest step that is none [s].
fn unbounded() -> f64 {
    f64::INFINITY
}

impl Control {
    pub(crate) fn new(step: f64, largest: f64, [exponent, memory]: [f64; 2]) -> Self {
        Control {
            step,
            largest,
            previous: 1.0,
            rejections: 0,
            failures: 0,
            exponent,
            memory,
        }
    }

    /// What a snapshot keeps.
    pub(crate) fn saved(&self) -> Self {
        Control {
            largest: unbounded(),
            ..self.clone()
        }
    }

    /// Goes on with the steps of a snapshot, as far as the options of this run let it.
    pub(crate) fn resume(&mut self, saved: &Self) {
        *self = Control {
            step: saved.step.min(self.largest),
            largest: self.largest,
            ..saved.clone()
        };
    }

    /// Whether they are steps that can be made (they may have been read from a file).
    pub(crate) fn check(&self) -> bool {
        let positive = |x: f64| x > 0.0 && x.is_finite();
        [self.step, self.previous, self.exponent]
            .into_iter()
            .all(positive)
            && self.memory.is_finite()
    }

    /// Goes on with the steps of another method.
    pub(crate) fn retune(&mut self, [exponent, memory]: [f64; 2]) {
        (self.exponent, self.memory) = (exponent, memory);
        self.previous = 1.0;
    }

    /// Judges a trial of size `tried` with error `error`, and sets the step to try next. `smallest` is what time resolves here.
    pub(crate) fn judge(&mut self, tried: f64, error: f64, smallest: f64) -> Verdict {
        if error <= 1.0 {
            let floored = error.max(1e-4);
            let factor = 0.9
                * floored.powf(-0.7 / self.exponent)
                * self.previous.powf(self.memory / self.exponent);
            // A step that was cut short by an event or by the end says little about the next one: never shrink because of it.
            let grown = tried * factor.clamp(0.2, 5.0);
            let proposed = if self.rejections > 0 {
                grown.min(tried)
            } else {
                grown
            };
            self.step = if tried < self.step {
                proposed.max(self.step)
            } else {
                proposed
            }
            .min(self.largest);
            self.previous = floored;
            self.rejections = 0;
            self.failures = 0;
            return Verdict::Accepted;
        }
        let factor = 0.9 * error.powf(-1.0 / self.exponent);
        // Rejected again: the error does not shrink with h to the k-th power here, as at a kink of an undamped line. Cut deeper.
        let factor = if self.rejections > 0 {
            0.3 * factor
        } else {
            factor
        };
        self.reject(
            tried
                * if factor.is_finite() {
                    factor.clamp(0.1, 0.9)
                } else {
                    0.1
                },
            smallest,
        )
    }

    /// A trial that could not be evaluated: the step shrinks tenfold; three in a row and the cause is final.
    pub(crate) fn fail(&mut self, tried: f64, smallest: f64) -> Verdict {
        self.failures = self.failures.saturating_add(1);
        match self.reject(0.1 * tried, smallest) {
            Verdict::Rejected if self.failures >= MOST_FAILURES => {
                self.failures = 0;
                self.rejections = 0;
                Verdict::Collapsed
            }
            verdict => verdict,
        }
    }

    /// A trial that passed its error test but overlooked something at a part of the step: the next one ends there, or comes closer to it. That is none of the
    /// rejections of which ten in a row are a collapse.
    pub(crate) fn shorten(&mut self, tried: f64, part: f64, smallest: f64) -> Verdict {
        self.rejections = self.rejections.max(1);
        self.step = tried * part.clamp(0.1, 0.9);
        match self.step < smallest {
            true => self.reject(self.step, smallest),
            false => Verdict::Rejected,
        }
    }

    fn reject(&mut self, step: f64, smallest: f64) -> Verdict {
        self.rejections = self.rejections.saturating_add(1);
        self.step = step;
        if self.rejections >= MOST_REJECTIONS || step < smallest {
            // A later call starts with a clean count.
            self.rejections = 0;
            self.failures = 0;
            Verdict::Collapsed
        } else {
            Verdict::Rejected
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_cut_short_does_not_shrink_the_next_one() {
        let mut control = Control::new(0.1, 1.0, [5.0, 0.4]);
        assert_eq!(control.judge(1e-6, 0.5, 1e-15), Verdict::Accepted);
        assert!(control.step >= 0.1);
    }

    #[test]
    fn the_step_changes_by_at_most_a_factor_of_five_and_ten() {
        let mut control = Control::new(0.1, 10.0, [5.0, 0.4]);
        assert_eq!(control.judge(0.1, 0.0, 1e-15), Verdict::Accepted);
        assert!(control.step <= 0.5);
        assert_eq!(control.judge(0.5, 1e30, 1e-15), Verdict::Rejected);
        assert!((control.step - 0.05).abs() < 1e-12);
        assert_eq!(control.judge(0.05, f64::NAN, 1e-15), Verdict::Rejected);
        assert!((control.step - 0.005).abs() < 1e-12);
    }

    #[test]
    fn what_is_overlooked_shortens_a_step_as_often_as_it_takes() {
        let mut control = Control::new(1.0, 10.0, [5.0, 0.4]);
        for _ in 0..50 {
            assert_eq!(control.shorten(control.step, 0.5, 1e-18), Verdict::Rejected);
        }
        assert!(control.step < 1e-14);
        assert_eq!(control.shorten(control.step, 0.5, 1.0), Verdict::Collapsed);
        // The step behind it grows no further.
        let mut control = Control::new(1.0, 10.0, [5.0, 0.4]);
        assert_eq!(control.shorten(1.0, 0.3, 1e-15), Verdict::Rejected);
        assert_eq!(control.judge(0.3, 0.0, 1e-15), Verdict::Accepted);
        assert!((control.step - 0.3).abs() < 1e-15, "{}", control.step);
    }

    #[test]
    fn ten_rejections_or_three_failures_in_a_row_are_a_collapse() {
        let mut control = Control::new(0.1, 1.0, [5.0, 0.4]);
        let verdicts: Vec<Verdict> = (0..10)
            .map(|_| control.judge(control.step, 2.0, 0.0))
            .collect();
        assert_eq!(
            verdicts
                .iter()
                .filter(|verdict| **verdict == Verdict::Rejected)
                .count(),
            9
        );
        assert_eq!(verdicts.last(), Some(&Verdict::Collapsed));
        let verdicts: Vec<Verdict> = (0..3).map(|_| control.fail(control.step, 0.0)).collect();
        assert_eq!(
            verdicts,
            [Verdict::Rejected, Verdict::Rejected, Verdict::Collapsed]
        );
    }
}
