//! What can go wrong in a run: typed, in the names of the declaration, with what to do about it.
//!
//! Nothing here resets or alters a state: after an error the simulation holds its last accepted step, equal to the bit to the same run stopped
//! there, and may go on after repair.

use std::error::Error;
use std::fmt;

/// Counters of a run so far. They only grow, and saturate instead of overflowing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Accepted steps.
    pub steps: u64,
    /// Rejected trial steps: error test, or a stage that was not finite or had no equilibrium.
    pub rejected: u64,
    /// Trial steps made to locate events.
    pub redone: u64,
    /// Evaluations of the state derivative, over all accepted and rejected steps.
    pub rhs: u64,
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
    /// Accepted steps in which an angle with a spring or a stop passed half a turn, where it jumps by a full turn, and the torque with it.
    pub angle_jumps: u64,
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
}

/// What is not finite.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Source {
    /// A value that the caller's loads supplied: the name of the input, load or gravity slot.
    Load(String),
    /// The rate of a coordinate of the state, by its column name.
    State(String),
    /// The position or velocity of an equilibrium point, by name.
    Node(String),
    /// The rows of a joint, by name: what prescribes its motion has no value.
    Joint(String),
}

/// Why a step shrank below what time can resolve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Collapse {
    /// The error test never passed.
    ErrorTest,
    /// An event could not be located.
    Event,
}

/// What went wrong in a step.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum StepError {
    /// A number from the caller that cannot be used, refused before any step.
    InvalidInput {
        /// Its name: a coordinate, an option, a line.
        slot: String,
        /// The number.
        value: f64,
    },
    /// A number that became infinite or NaN.
    NonFinite {
        /// When [s].
        time: f64,
        /// What.
        source: Source,
    },
    /// The balance of an equilibrium point was not found; no force was used.
    NoEquilibrium {
        /// The point.
        point: String,
        /// When [s].
        time: f64,
        /// What is left of the balance [N].
        residual_n: f64,
        /// Iterations spent.
        iterations: u64,
    },
    /// The step fell below what time can resolve, or ten trials in a row were rejected.
    StepCollapse {
        /// When [s].
        time: f64,
        /// The last step tried [s].
        step_size: f64,
        /// The part of the state with the largest error.
        block: String,
        /// Why.
        cause: Collapse,
    },
    /// A line switches between slack and taut without end.
    EventChatter {
        /// The line or the stop.
        line: String,
        /// Switches counted in the window.
        count: usize,
        /// The window [s].
        window: f64,
    },
    /// The fixed step is above the stability limit: positions stay plausible, forces do not.
    UnstableStep {
        /// The step [s].
        step_size: f64,
        /// Its product with the largest rate of the scene; RK4 is stable below about 2.8.
        rho: f64,
        /// A step that should do [s].
        suggestion: f64,
    },
    /// The step budget of one call is used up.
    TooManySteps {
        /// The budget.
        steps: u64,
    },
    /// The caller's `go on` said no, at a step boundary.
    Cancelled,
    /// The joints cannot be satisfied from the given state.
    InconsistentStart {
        /// The largest row that is left [m or 1].
        norm: f64,
        /// The joints furthest from holding, and by how much, largest first.
        rows: Vec<(String, f64)>,
    },
    /// The joints hold, but on a root of their rows that is not the joint: an axis points the other way, or axes are exchanged.
    WrongBranch {
        /// The joints.
        joints: Vec<String>,
    },
    /// Rows of joints repeat each other, for good or in this configuration: the forces in them are not determined.
    SingularConstraints {
        /// When [s].
        time: f64,
        /// Number of independent rows.
        rank: usize,
        /// Number of rows.
        rows: usize,
        /// The joints that take part; empty when the rows are independent but their system is too badly conditioned.
        joints: Vec<String>,
    },
    /// Masses so uneven that no way of solving the rows keeps three digits of the accelerations.
    IllConditioned {
        /// When [s].
        time: f64,
        /// Decimal digits lost.
        loss_digits: u64,
        /// The strategy they were lost on, as in [`Statistics::rows_strategy`].
        strategy: u64,
        /// The largest mass over the smallest.
        ratio: f64,
    },
    /// A step moved the joints so far apart that the projection did not bring them together.
    JointsApart {
        /// When [s].
        time: f64,
        /// The largest row that is left [m or 1].
        norm: f64,
        /// The joints furthest from holding, and by how much, largest first.
        rows: Vec<(String, f64)>,
    },
    /// A combination this runtime does not offer.
    Unsupported {
        /// What was asked for.
        what: String,
        /// What to take instead.
        instead: String,
    },
}

impl StepError {
    /// The name of this kind of failure in tables: `non_finite`, `step_underflow`, ….
    #[must_use]
    pub fn status(&self) -> &'static str {
        match self {
            StepError::InvalidInput { .. } => "range",
            StepError::NonFinite { .. } => "non_finite",
            StepError::NoEquilibrium { .. } => "newton_not_converged",
            StepError::StepCollapse { .. } => "step_underflow",
            StepError::EventChatter { .. } => "event_limit",
            StepError::UnstableStep { .. } => "unstable_step",
            StepError::TooManySteps { .. } => "too_many_steps",
            StepError::Cancelled => "cancelled",
            StepError::InconsistentStart { .. } => "inconsistent_start",
            StepError::WrongBranch { .. } => "wrong_branch",
            StepError::SingularConstraints { .. } => "singular_constraints",
            StepError::IllConditioned { .. } => "ill_conditioned",
            StepError::JointsApart { .. } => "joints_apart",
            StepError::Unsupported { .. } => "unsupported",
        }
    }

    /// One sentence of advice.
    #[must_use]
    pub fn advice(&self) -> String {
        match self {
            StepError::InvalidInput { .. } => "give a finite number in the accepted range".into(),
            StepError::NonFinite {
                source: Source::Load(name),
                ..
            } => format!("look at what `{name}` returns at this time and state"),
            StepError::NonFinite {
                source: Source::Joint(_),
                ..
            } => {
                "look for a time at which its motor, or a frame of the world that moves it, has no value".into()
            }
            StepError::NonFinite { .. } => {
                "take a smaller step; if it stays, look for a division by zero or a root of a negative number in a load".into()
            }
            StepError::NoEquilibrium { .. } => {
                "take a smaller step, or bring the stiffnesses of the lines of this point closer together".into()
            }
            StepError::StepCollapse {
                cause: Collapse::ErrorTest,
                ..
            } => "loosen the tolerance, or look for a jump in a load and declare it as an event".into(),
            StepError::StepCollapse { .. } => "look for a load without a limit near this time".into(),
            StepError::EventChatter { .. } => {
                "the line or stop is too stiff for the mass that bounces on it: give it more damping, declare it rigid, or make the point massless".into()
            }
            StepError::UnstableStep { suggestion, .. } => {
                format!("take a fixed step of at most {suggestion:.3e} s, or an adaptive method")
            }
            StepError::TooManySteps { .. } => "raise the budget `max_steps`, or take a larger step".into(),
            StepError::Cancelled => "run again: the state is the last accepted step".into(),
            StepError::InconsistentStart { .. } => {
                "start closer to a state where all joints hold, or look for joints that contradict each other".into()
            }
            StepError::WrongBranch { .. } => {
                "turn the bodies at these joints so that the axes of both sides agree".into()
            }
            StepError::SingularConstraints { joints, .. } if joints.is_empty() => {
                "bring the masses closer together, or measure lengths in a unit of the size of the mechanism".into()
            }
            StepError::SingularConstraints { .. } => {
                "replace one of these joints by one that forbids less (a hinge by a spherical joint, a weld by nothing), or start away from this configuration".into()
            }
            StepError::IllConditioned { .. } => {
                "bring the masses closer together, leave out bodies that weigh nothing beside the others, or run in f64 where this is f32".into()
            }
            StepError::JointsApart { .. } => "take a smaller step".into(),
            StepError::Unsupported { instead, .. } => instead.clone(),
        }
    }
}

impl fmt::Display for StepError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            StepError::InvalidInput { slot, value } => write!(f, "`{slot}` cannot be {value:e}"),
            StepError::NonFinite { time, source } => {
                write!(f, "at {time:.9} s ")?;
                match source {
                    Source::Load(name) => write!(f, "`{name}` is not a finite number"),
                    Source::State(name) => write!(f, "the rate of `{name}` is not a finite number"),
                    Source::Node(name) => write!(f, "the point `{name}` is not at a finite place"),
                    Source::Joint(name) => {
                        write!(f, "the rows of joint `{name}` are not finite numbers")
                    }
                }
            }
            StepError::NoEquilibrium {
                point,
                time,
                residual_n,
                iterations,
            } => write!(
                f,
                "at {time:.9} s no equilibrium of `{point}` was found: {residual_n:.3e} N left after {iterations} iterations"
            ),
            StepError::StepCollapse {
                time,
                step_size,
                block,
                cause,
            } => {
                let why = match cause {
                    Collapse::ErrorTest => "the error test did not pass",
                    Collapse::Event => "an event could not be located",
                };
                write!(
                    f,
                    "at {time:.9} s the step shrank to {step_size:.3e} s: {why} (`{block}`)"
                )
            }
            StepError::EventChatter {
                line,
                count,
                window,
            } => write!(
                f,
                "`{line}` switched between slack and taut {count} times in {window:.3e} s"
            ),
            StepError::UnstableStep { step_size, rho, .. } => {
                write!(
                    f,
                    "the fixed step {step_size:.3e} s is unstable: step times rate is {rho:.2}"
                )
            }
            StepError::TooManySteps { steps } => write!(f, "{steps} steps were not enough"),
            StepError::Cancelled => write!(f, "the run was cancelled"),
            StepError::InconsistentStart { norm, rows } => {
                write!(f, "the joints do not hold at the start ({norm:.3e} left: ")?;
                list_rows(f, rows)?;
                write!(f, ")")
            }
            StepError::WrongBranch { joints } => write!(
                f,
                "at the start {} would hold only turned around",
                listed(joints)
            ),
            StepError::SingularConstraints {
                time,
                rank,
                rows,
                joints,
            } if joints.is_empty() => write!(
                f,
                "at {time:.9} s the joint forces cannot be solved ({rank} of {rows} rows are independent)"
            ),
            StepError::SingularConstraints {
                time,
                rank,
                rows,
                joints,
            } => write!(
                f,
                "at {time:.9} s {} repeat each other: {rank} of {rows} rows are independent",
                listed(joints)
            ),
            StepError::IllConditioned {
                time,
                loss_digits,
                ratio,
                ..
            } => write!(
                f,
                "at {time:.9} s the accelerations lose {loss_digits} digits: masses differ by a factor of {ratio:.1e}"
            ),
            StepError::JointsApart { time, norm, rows } => {
                write!(f, "at {time:.9} s the joints came apart ({norm:.3e} left: ")?;
                list_rows(f, rows)?;
                write!(f, ")")
            }
            StepError::Unsupported { what, .. } => write!(f, "{what} is not supported"),
        }
    }
}

impl Error for StepError {}

/// `a`, `b`, `c`.
fn listed(names: &[String]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    quoted.join(", ")
}

fn list_rows(f: &mut fmt::Formatter<'_>, rows: &[(String, f64)]) -> fmt::Result {
    for (index, (name, size)) in rows.iter().enumerate() {
        let comma = if index == 0 { "" } else { ", " };
        write!(f, "{comma}`{name}` {size:.3e}")?;
    }
    Ok(())
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
#[derive(Clone, Debug, PartialEq)]
pub struct RunError {
    /// What went wrong.
    pub cause: StepError,
    /// Where the run stands: at its last accepted step.
    pub progress: Box<Progress>,
}

impl fmt::Display for RunError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} (last accepted: step {} at {:.9} s, step size {:.3e} s); {}",
            self.cause,
            self.progress.statistics.steps,
            self.progress.time,
            self.progress.step_size,
            self.cause.advice()
        )
    }
}

impl Error for RunError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        Some(&self.cause)
    }
}
