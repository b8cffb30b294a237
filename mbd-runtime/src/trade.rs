//! The trade between speed and accuracy, measured: one question asked of runs with other methods, steps and tolerances, and of other models of the
//! same thing, against references that must agree.
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

use mbd_scene::Model;

use crate::compiled::Scalar;
use crate::error::{RunError, Statistics, StepError};
use crate::options::{Method, Options};
use crate::simulation::Simulation;
use crate::trajectory::{Content, Sampling, Trajectory};

/// Places in the window at which a run is compared.
const SAMPLES: usize = 200;
/// A setting passes with this part of the error that is allowed: the rest is for what was not raced.
const MARGIN: f64 = 1.0 / 3.0;
/// References are this part of the wanted error apart at most.
const RESOLVED: f64 = 0.1;
/// The most steps of a reference.
const LONGEST: u64 = 2_000_000;
/// Runs shorter than this are timed again [s], so often.
const SHORT: f64 = 0.05;
const AGAIN: usize = 4;

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

/// What flies a variant with options, and keeps a history at these times.
type Fly<'a> = Box<dyn Fn(Options, Vec<f64>) -> Result<Trajectory, RunError> + 'a>;

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
        let fly = move |options: Options, times: Vec<f64>| {
            let content = Content {
                energy: false,
                reactions: false,
                ..Content::ALL
            };
            let until = times.last().copied().unwrap_or(0.0);
            let mut run = Simulation::new(&*model, options)?;
            begin(&mut run)?;
            let mut history = Trajectory::new(&*model, Sampling::At(times), content);
            run.record(until, &mut history)?;
            Ok(history)
        };
        Variant {
            name: name.into(),
            fly: Box::new(fly),
        }
    }

    /// The answer of a run with these options, its counters, and how long it took.
    fn answer(&self, question: &Question, options: Options) -> Result<Answer, Unanswered> {
        let clock = Instant::now();
        let history = (self.fly)(options, question.times()).map_err(Unanswered::Run)?;
        let seconds = clock.elapsed().as_secs_f64();
        let values = history.column(&question.column);
        let values = values.ok_or_else(|| Unanswered::Column(known(&history)))?;
        Ok(Answer {
            values: values.to_vec(),
            statistics: history.statistics,
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
    statistics: Statistics,
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

/// One setting of one variant, measured.
#[derive(Clone, Debug)]
pub struct Entry {
    /// The variant, by its place in the list that was raced.
    pub variant: usize,
    /// The name of the variant.
    pub name: String,
    /// The integrator with its step or tolerance.
    pub method: Method,
    /// Its error.
    pub error: Deviation,
    /// Its counters.
    pub statistics: Statistics,
    /// Time on the clock, the shortest of a few where it is short [s].
    pub seconds: f64,
}

impl fmt::Display for Entry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Statistics { steps, rhs, .. } = self.statistics;
        write!(
            f,
            "{}, {}: error {:.1e} rms, {:.1e} at most; {steps} steps, {rhs} evaluations, {:.3e} s",
            self.name, self.method, self.error.rms, self.error.largest, self.seconds
        )
    }
}

/// A setting that gave no answer.
#[derive(Clone, Debug)]
pub struct Failed {
    /// The name of the variant.
    pub name: String,
    /// The integrator with its step or tolerance.
    pub method: Method,
    /// What stopped it.
    pub cause: StepError,
}

/// Settings and variants, raced.
#[derive(Clone, Debug)]
pub struct Race {
    /// What was asked.
    pub question: Question,
    /// The answer of the reference at the times of the question.
    pub reference: Vec<f64>,
    /// The two runs that agree best, of different methods, and how far they are apart. Errors below that mean nothing.
    pub references: [Method; 2],
    /// See [`Race::references`].
    pub apart: Deviation,
    /// What gave an answer, in the order of the race.
    pub entries: Vec<Entry>,
    /// What gave none.
    pub failed: Vec<Failed>,
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
                "the history has no column `{column}`; there are: {}",
                known.join(", ")
            ),
            TradeError::NoReference(error) => {
                write!(f, "no two references ran to the end: {error}")
            }
            TradeError::Unresolved { apart, size } => write!(
                f,
                "unresolved: two references of different methods are {:.1e} apart (rms; values reach {size:.1e}). The motion is chaotic or not smooth: \
                 compare over a shorter window, or a quantity that does not follow every bounce",
                apart.rms
            ),
        }
    }
}

impl std::error::Error for TradeError {}

/// Races methods with their steps and tolerances over variants of a model. The references are runs of the first variant at the tightest
/// tolerances; the two of different methods that agree best count.
///
/// # Errors
/// [`TradeError`]: references that disagree by a tenth of the size of the column, among others.
pub fn trade(variants: &[Variant<'_>], question: &Question) -> Result<Race, TradeError> {
    let first = variants.first().ok_or(TradeError::Nothing)?;
    question.check()?;
    let (references, reference, apart) = find_reference(first, question)?;
    let size = reference
        .values
        .iter()
        .fold(0.0_f64, |most, x| most.max(x.abs()));
    if apart.rms > RESOLVED * size {
        return Err(TradeError::Unresolved { apart, size });
    }
    let mut race = Race {
        question: question.clone(),
        reference: reference.values,
        references,
        apart,
        entries: Vec::new(),
        failed: Vec::new(),
    };
    // A setting that takes more evaluations than the reference is not worth its wait.
    let most = reference.statistics.rhs;
    for (index, variant) in variants.iter().enumerate() {
        for family in families(question) {
            for method in family {
                if !race.run(index, variant, method, most) {
                    break;
                }
            }
        }
    }
    Ok(race)
}

/// The tightest setting of each adaptive method, best first.
fn tightest() -> [Method; 3] {
    let unlimited = f64::INFINITY;
    [
        Method::Vern7 {
            rtol: 1e-12,
            max_step: unlimited,
        },
        Method::Tsit5 {
            rtol: 1e-11,
            max_step: unlimited,
        },
        Method::Rodas5P {
            rtol: 1e-10,
            max_step: unlimited,
        },
    ]
}

/// The settings of each method, loose first.
fn families(question: &Question) -> [Vec<Method>; 4] {
    let until = question.window[1].abs();
    let tolerances = |from: i32, to: i32| (from..=to).map(|k| 10.0_f64.powi(-k));
    let max_step = f64::INFINITY;
    [
        (0..14)
            .map(|k| Method::Rk4 {
                step: until / f64::from(25 << k),
            })
            .collect(),
        tolerances(2, 9)
            .map(|rtol| Method::Tsit5 { rtol, max_step })
            .collect(),
        tolerances(3, 11)
            .map(|rtol| Method::Vern7 { rtol, max_step })
            .collect(),
        tolerances(2, 9)
            .map(|rtol| Method::Rodas5P { rtol, max_step })
            .collect(),
    ]
}

/// The two tight runs that agree best, the first of them, and how far they are apart.
fn find_reference(
    variant: &Variant<'_>,
    question: &Question,
) -> Result<([Method; 2], Answer, Deviation), TradeError> {
    let mut answers: Vec<(Method, Answer)> = Vec::new();
    let mut stopped = None;
    for method in tightest() {
        let options = Options {
            max_steps: LONGEST,
            ..Options::of(method)
        };
        match variant.answer(question, options) {
            Ok(answer) => answers.push((method, answer)),
            Err(Unanswered::Run(error)) => stopped = Some(error),
            Err(Unanswered::Column(known)) => {
                return Err(TradeError::Column(question.column.clone(), known));
            }
        }
    }
    let mut best: Option<([usize; 2], Deviation)> = None;
    for (i, (_, one)) in answers.iter().enumerate() {
        for (j, (_, other)) in answers.iter().enumerate().skip(i + 1) {
            let apart = Deviation::between(&one.values, &other.values);
            if best.as_ref().is_none_or(|(_, known)| apart.rms < known.rms) {
                best = Some(([i, j], apart));
            }
        }
    }
    match (best, stopped) {
        (Some(([i, j], apart)), _) => {
            let methods = [i, j].map(|index| answers[index].0);
            Ok((methods, answers.swap_remove(i).1, apart))
        }
        (None, Some(error)) => Err(TradeError::NoReference(Box::new(error))),
        (None, None) => Err(TradeError::Nothing),
    }
}

impl Race {
    /// Races one setting; false when finer ones of its method are not worth racing: it cost more than the reference.
    fn run(&mut self, index: usize, variant: &Variant<'_>, method: Method, most: u64) -> bool {
        let options = Options {
            // Every step evaluates the derivative several times.
            max_steps: (most / 2).max(1000),
            ..Options::of(method)
        };
        match variant.answer(&self.question, options) {
            Ok(mut answer) => {
                for _ in 0..AGAIN {
                    if answer.seconds > SHORT {
                        break;
                    }
                    if let Ok(again) = variant.answer(&self.question, options) {
                        answer.seconds = answer.seconds.min(again.seconds);
                    }
                }
                let worth = answer.statistics.rhs < most;
                self.entries.push(Entry {
                    variant: index,
                    name: variant.name.clone(),
                    method,
                    error: Deviation::between(&answer.values, &self.reference),
                    statistics: answer.statistics,
                    seconds: answer.seconds,
                });
                worth
            }
            Err(Unanswered::Run(error)) => {
                // A step that is too long is followed by shorter ones; a budget that is used up is not followed by a larger one.
                let worth = !matches!(
                    error.cause,
                    StepError::TooManySteps { .. } | StepError::Unsupported { .. }
                );
                self.failed.push(Failed {
                    name: variant.name.clone(),
                    method,
                    cause: error.cause,
                });
                worth
            }
            Err(Unanswered::Column(_)) => false,
        }
    }

    /// The entries that nothing beats in both error (rms) and time, the fastest first: of all, or of one variant.
    #[must_use]
    pub fn front(&self, variant: Option<usize>) -> Vec<&Entry> {
        let asked = |entry: &&Entry| variant.is_none_or(|variant| entry.variant == variant);
        let mut by_time: Vec<&Entry> = self.entries.iter().filter(asked).collect();
        by_time.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
        let mut best = f64::INFINITY;
        by_time.retain(|entry| {
            let better = entry.error.rms < best;
            best = best.min(entry.error.rms);
            better
        });
        by_time
    }

    /// The fastest entry whose error (rms) is at most a third of `error` [the unit of the column]; `None` where none is that good, or where the
    /// references are more than a tenth of it apart.
    #[must_use]
    pub fn advise(&self, error: f64) -> Option<Advice<'_>> {
        if self.apart.rms > RESOLVED * error {
            return None;
        }
        let passes = |entry: &&Entry| entry.error.rms <= MARGIN * error;
        let fastest = |of: &dyn Fn(&Entry) -> bool| {
            let passing = self.entries.iter().filter(passes).filter(|entry| of(entry));
            passing.min_by(|a, b| a.seconds.total_cmp(&b.seconds))
        };
        let choice = fastest(&|_| true)?;
        Some(Advice {
            choice,
            as_declared: fastest(&|entry| entry.variant == 0),
        })
    }
}

/// What to run.
#[derive(Clone, Copy, Debug)]
pub struct Advice<'r> {
    /// The cheapest setting that is good enough.
    pub choice: &'r Entry,
    /// The cheapest one of the first variant; `None` where it has none that is good enough.
    pub as_declared: Option<&'r Entry>,
}

impl fmt::Display for Advice<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "take {}", self.choice)?;
        match self.as_declared {
            Some(other) if other.variant != self.choice.variant => write!(
                f,
                "; `{}` in place of `{}` pays {:.1} times (the best there: {}, {:.3e} s)",
                self.choice.name,
                other.name,
                other.seconds / self.choice.seconds,
                other.method,
                other.seconds
            ),
            None if self.choice.variant != 0 => {
                write!(
                    f,
                    "; the first variant reaches it with no setting that was raced"
                )
            }
            _ => Ok(()),
        }
    }
}
