//! How accurate runs are, measured: one question asked of runs with other methods, steps and tolerances, and of other models of the same thing.
//!
//! ```
//! use mbd_runtime::{PointState, Question, Simulation, Variant, model, trade};
//!
//! model! {
//!     /// A mass that is drawn to the origin: 10 rad/s.
//!     model Oscillator {
//!         gravity: none;
//!         point bob { mass: 1.0 kg }
//!         load pull on bob = -100 N/m * bob.position;
//!         output x = bob.position.x;
//!     }
//! }
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let oscillator = Oscillator::new(OscillatorParams::default())?;
//! let mut start = OscillatorState::at_origin();
//! start.set_bob(PointState { position: [0.1, 0.0, 0.0], velocity: [0.0; 3] });
//! let begin = move |run: &mut Simulation<f64>| run.set_state(0.0, &start.to_vec());
//!
//! let variants = [Variant::new("as declared", &oscillator, begin)];
//! let race = trade(&variants, &Question::new("x", [0.0, 2.0]))?;
//! let advice = race.advise(1e-6).expect("some setting is that good");
//! assert!(advice.choice.error.rms < 1e-6 / 3.0);
//! println!("{advice}");
//! # Ok(())
//! # }
//! ```

use std::fmt;
use std::time::Instant;

use mbd_scene::similar::near_and_all;
use mbd_scene::{Model, plain};

use crate::compiled::Scalar;
use crate::content::Content;
use crate::error::{RunError, Statistics};
use crate::options::Options;
use crate::simulation::Simulation;
use crate::step_sizes::StepSizes;
use crate::trajectory::{Sampling, Trajectory};

mod estimate;
mod race;

pub use estimate::Accurate;
pub(crate) use estimate::FINER_STEP;
pub use race::{Advice, Entry, FailedSetting, Race, trade};

/// Places in the window at which a run is compared.
const SAMPLES: usize = 200;
/// What is asked of every run: a column of its history over a window of time.
#[derive(Clone, Debug, PartialEq)]
pub struct Question {
    /// The column of a [`Trajectory`]: an output, `riser.tension`, a coordinate.
    pub column: String,
    /// From and to [s]; runs begin at their start, whatever the window.
    pub window: [f64; 2],
    /// At how many times, evenly spread, the ends among them.
    pub samples: usize,
}

impl Question {
    /// A column over a window [s], at 200 times.
    #[must_use]
    pub fn new(column: impl Into<String>, window: [f64; 2]) -> Self {
        Question {
            column: column.into(),
            window,
            samples: SAMPLES,
        }
    }

    fn times(&self) -> Vec<f64> {
        let [from, to] = self.window;
        let last = self.samples.max(2) - 1;
        let at = |index: usize| from + (to - from) * index as f64 / last as f64;
        (0..=last).map(at).collect()
    }

    fn check(&self) -> Result<(), TradeError> {
        let [from, to] = self.window;
        match from.is_finite() && to.is_finite() && from < to {
            true => Ok(()),
            false => Err(TradeError::Window(self.window)),
        }
    }
}

/// What flies a variant with options, finer than other steps where they are given, and keeps a history at these times.
type Fly<'a> = Box<dyn Fn(Options, Vec<f64>, Option<&StepSizes>) -> FlownVariant + 'a>;
/// The history, and how long its steps were.
type FlownVariant = Result<(Trajectory, StepSizes), RunError>;

/// A model of what is asked about, and how its runs begin: with another model of a node, another scalar, another mass.
pub struct Variant<'a> {
    name: String,
    fly: Fly<'a>,
}

impl<'a> Variant<'a> {
    /// A model with a name for tables; `begin` sets what a run of it starts from: its state, its inputs.
    pub fn new<T: Scalar>(
        name: impl Into<String>,
        model: &(impl Model<T> + ?Sized),
        begin: impl Fn(&mut Simulation<T>) -> Result<(), RunError> + 'a,
    ) -> Self {
        let model = model.share();
        let fly = move |options: Options, times: Vec<f64>, below: Option<&StepSizes>| {
            let content = Content {
                energy: false,
                reactions: false,
                ..Content::ALL
            };
            let until = times.last().copied().unwrap_or(0.0);
            let mut run = Simulation::new(&*model, options)?;
            begin(&mut run)?;
            if let Some(other) = below {
                run.refine(other);
            }
            let history = Trajectory::new(&*model, Sampling::At(times), content);
            let mut history = history.measure(&*model, &[]);
            run.record(until, &mut history)?;
            Ok((history, run.step_sizes().clone()))
        };
        Variant {
            name: name.into(),
            fly: Box::new(fly),
        }
    }

    /// The same with everything of these options but the method and the most steps: scales of errors, located switches, work that is integrated along
    /// change steps and what they cost.
    #[must_use]
    pub fn with(self, others: Options) -> Self {
        let fly = self.fly;
        let with = move |options: Options, times: Vec<f64>, below: Option<&StepSizes>| {
            let options = Options {
                method: options.method,
                max_steps: options.max_steps,
                ..others
            };
            fly(options, times, below)
        };
        Variant {
            name: self.name,
            fly: Box::new(with),
        }
    }

    /// The name for tables.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The answer of a run with these options, its counters, and how long it took.
    fn answer(
        &self,
        question: &Question,
        options: Options,
        below: Option<&StepSizes>,
    ) -> Result<Answer, Unanswered> {
        let clock = Instant::now();
        let flown = (self.fly)(options, question.times(), below);
        let (history, step_sizes) = flown.map_err(Unanswered::Run)?;
        let seconds = clock.elapsed().as_secs_f64();
        let values = history.column(&question.column);
        let values = values.ok_or_else(|| Unanswered::Column(known(&history)))?;
        let mut rows = history.times().iter().zip(values);
        let without = rows.find(|(_, value)| !value.is_finite());
        Ok(Answer {
            without: without.map(|(time, _)| *time),
            values: values.to_vec(),
            statistics: history.statistics,
            step_sizes,
            seconds,
        })
    }
}

/// The columns of a history.
fn known(history: &Trajectory) -> Vec<String> {
    let names = history.names().iter();
    names.map(|name| name.name.clone()).collect()
}

/// What a run says.
struct Answer {
    values: Vec<f64>,
    /// The first time at which there is no finite one [s].
    without: Option<f64>,
    statistics: Statistics,
    step_sizes: StepSizes,
    seconds: f64,
}

/// Why a run says nothing.
enum Unanswered {
    Run(RunError),
    Column(Vec<String>),
}

/// How far a run is from the reference, in the unit of the column.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviation {
    /// At the worst time of the window.
    pub largest: f64,
    /// The root of the mean square over the window.
    pub rms: f64,
}

impl Deviation {
    fn between(a: &[f64], b: &[f64]) -> Self {
        let count = a.len().min(b.len()).max(1) as f64;
        let differences = || a.iter().zip(b).map(|(a, b)| (a - b).abs());
        // What is not a number is off without bound.
        let infinite = |x: f64| if x.is_nan() { f64::INFINITY } else { x };
        Deviation {
            largest: differences().map(infinite).fold(0.0, f64::max),
            rms: infinite((differences().map(|d| d * d).sum::<f64>() / count).sqrt()),
        }
    }
}

/// Why no trade was measured.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum TradeError {
    /// Nothing to race.
    Nothing,
    /// A window without length [s].
    Window([f64; 2]),
    /// The history has no such column; there are these.
    Column(String, Vec<String>),
    /// Fewer than two references of different methods ran to the end: what stopped the last one.
    NoReference(Box<RunError>),
    /// The error that is wanted is none that a run can have: not a number, infinite, zero or below.
    Wanted(f64),
    /// The column is infinite or not a number in the window: nothing is compared there.
    NotFinite {
        /// The column.
        column: String,
        /// The first such time [s].
        time: f64,
    },
    /// No tolerance reaches the error that is wanted.
    Unreached {
        /// The error that is wanted.
        wanted: f64,
        /// The best that was reached.
        best: f64,
    },
    /// The references of the first variant disagree: by this, where the values of the column reach that.
    Unresolved {
        /// How far they are apart.
        apart: Deviation,
        /// The largest value of the column over the window.
        size: f64,
    },
}

impl fmt::Display for TradeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            TradeError::Nothing => write!(f, "there is no model to race"),
            TradeError::Window([from, to]) => write!(
                f,
                "the window {from} s to {to} s has no length: give its start and a later end"
            ),
            TradeError::Column(column, known) => write!(
                f,
                "the history has no column `{column}`{}",
                near_and_all(column, known.iter().map(String::as_str))
            ),
            TradeError::NoReference(error) => {
                write!(f, "no two references ran to the end: {error}")
            }
            TradeError::Wanted(error) => write!(
                f,
                "an error of {error} is wanted: give a finite number above zero, in the unit of the column"
            ),
            TradeError::NotFinite { column, time } => write!(
                f,
                "`{column}` has no finite value at {} s, and no error there: give a window in which it has one, or another column",
                plain(*time, 6)
            ),
            TradeError::Unreached { wanted, best } => write!(
                f,
                "no tolerance reaches an error of {}: the best is {}",
                plain(*wanted, 2),
                plain(*best, 2)
            ),
            TradeError::Unresolved { apart, size } => write!(
                f,
                "unresolved: two references of different methods are {} apart (rms; values reach {}). The motion is chaotic or not smooth: \
                 compare over a shorter window, or a quantity that does not follow every bounce",
                plain(apart.rms, 2),
                plain(*size, 2)
            ),
        }
    }
}

impl std::error::Error for TradeError {}
