//! How far a run came: its counters, and the error with which it stopped.

use std::error::Error;
use std::fmt;

use mbd_scene::plain;

use super::StepError;

/// Counters of a run so far. They only grow, and saturate instead of overflowing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Accepted steps.
    pub steps: u64,
    /// Those of them that a stiff method made.
    pub stiff_steps: u64,
    /// How often a run with two methods took the other one.
    pub method_changes: u64,
    /// Rejected trial steps: error test, or a stage that was not finite or had no equilibrium.
    pub rejected: u64,
    /// Trial steps made to locate events.
    pub redone: u64,
    /// Evaluations of the state derivative, over all accepted and rejected steps.
    pub rhs: u64,
    /// Derivatives of the rates by the state, by methods that solve with them.
    pub jacobians: u64,
    /// Factors of the matrices of these methods.
    pub factors: u64,
    /// Solves of the equilibrium points.
    pub node_solves: u64,
    /// Newton iterations in those solves.
    pub node_iterations: u64,
    /// The most iterations one solve took.
    pub node_iterations_max: u64,
    /// The worst strategy a solve needed: 1 warm Newton, 2 stiffness homotopy, 3 slope search; 0 no solve yet.
    pub node_strategy: u64,
    /// Slack/taut switches located.
    pub switches: u64,
    /// The worst strategy the rows of joints needed: 1 as emitted, 2 rows chosen anew for a step, 3 the whole matrix, 4 a stage with all rows
    /// regularised; 0 no rows.
    pub rows_strategy: u64,
    /// Step boundaries at which rows were chosen anew.
    pub rows_chosen: u64,
    /// Stages solved with all rows regularised, because those held for their step lost rank inside it: such a step is of order two.
    pub rows_regularised: u64,
    /// Decimal digits of the accelerations that uneven masses cost at the start, on the strategy of the run; 0 for masses within three decades.
    pub lost_digits: u64,
}

impl Statistics {
    /// Mean Newton iterations of one solve; zero without solves.
    #[must_use]
    pub fn node_iterations_mean(&self) -> f64 {
        if self.node_solves == 0 {
            0.0
        } else {
            self.node_iterations as f64 / self.node_solves as f64
        }
    }

    /// Those of a run and of the one that went on from it, together.
    #[must_use]
    pub fn and(self, next: Self) -> Self {
        Statistics {
            steps: self.steps + next.steps,
            stiff_steps: self.stiff_steps + next.stiff_steps,
            method_changes: self.method_changes + next.method_changes,
            rejected: self.rejected + next.rejected,
            redone: self.redone + next.redone,
            rhs: self.rhs + next.rhs,
            jacobians: self.jacobians + next.jacobians,
            factors: self.factors + next.factors,
            node_solves: self.node_solves + next.node_solves,
            node_iterations: self.node_iterations + next.node_iterations,
            node_iterations_max: self.node_iterations_max.max(next.node_iterations_max),
            node_strategy: self.node_strategy.max(next.node_strategy),
            switches: self.switches + next.switches,
            rows_strategy: self.rows_strategy.max(next.rows_strategy),
            rows_chosen: self.rows_chosen + next.rows_chosen,
            rows_regularised: self.rows_regularised + next.rows_regularised,
            lost_digits: self.lost_digits.max(next.lost_digits),
        }
    }
}

/// Where a run stopped.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Progress {
    /// Time of the last accepted step [s].
    pub time: f64,
    /// The step that was tried, or would be tried next [s].
    pub step_size: f64,
    /// Counters.
    pub statistics: Statistics,
}

/// A run that stopped: the cause, and where.
#[derive(Clone, PartialEq)]
pub struct RunError {
    /// What went wrong.
    pub cause: StepError,
    /// Where the run stands: at its last accepted step.
    pub progress: Box<Progress>,
}

/// What `derive(Debug)` writes, compiled here alone.
impl fmt::Debug for RunError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RunError")
            .field("cause", &self.cause)
            .field("progress", &self.progress)
            .finish()
    }
}

impl fmt::Display for RunError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let time = plain(self.progress.time, 10);
        // The steps that made what shows the mistake were accepted, too, and taken back.
        let place = match self.cause {
            StepError::UnstableStep { .. } => {
                format!("the run went back to {time} s, where nothing had grown yet")
            }
            _ => format!(
                "last accepted: step {} at {time} s, step size {} s",
                self.progress.statistics.steps,
                plain(self.progress.step_size, 4)
            ),
        };
        write!(f, "{} ({place}); {}", self.cause, self.cause.advice())
    }
}

impl Error for RunError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        Some(&self.cause)
    }
}
