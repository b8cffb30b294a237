//! The error of a run by a second, finer one, and a run that is tightened until its error is small enough.
//!
//! A quarter of a fixed step, or a tenth of a tolerance: what is left of the error then is little, or about a tenth, so that the difference of the two
//! runs is the error of the first. Rejected: half a fixed step, at which a run half sees what a whole one half sees, a pulse as short as a step, so that
//! the difference may tell an eighth of the error; the sum of the embedded errors of the steps, which knows nothing of how the motion carries an error
//! on (a pendulum forgets, a double pendulum multiplies by a thousand a second).

use super::{Answer, Deviation, Question, TradeError, Unanswered, Variant};
use crate::options::{Method, Options};
use crate::step_sizes::StepSizes;
use crate::trajectory::Trajectory;
use crate::turns;

/// The finest tolerance whose error a tenth of it can still tell: doubles hold 1e-16.
const FINEST: f64 = 1e-13;
/// How much finer a tolerance is.
const TENTH: f64 = 0.1;
/// How much finer a fixed step is.
const QUARTER: f64 = 0.25;
/// How many times as many steps a finer run may take.
const MORE_STEPS: u64 = 4;
/// Part of the wanted error that a tightened run aims at.
const AIM: f64 = 0.3;
/// Steps of a method of order five go with this power of the tolerance.
const STEP_BY_TOLERANCE: f64 = 0.2;
/// Steps of a tenth of the tolerance, by those of the tolerance: 0.1^0.2.
pub(crate) const FINER_STEP: f64 = 0.63;
/// How often a run is tightened.
const TRIES: usize = 12;

impl Options {
    /// The same with a quarter of the step, or a tenth of the tolerance; `None` where nothing finer is told apart from rounding. Where events, samples and entries
    /// of tables end adaptive steps a tighter tolerance alone would make the same ones again, and their error would be in both runs: give the
    /// second one the steps of the first, [`Simulation::refine`](crate::Simulation::refine).
    #[must_use]
    pub fn finer(self) -> Option<Options> {
        let finer = match (self.method.fixed_step(), self.method.tolerance()) {
            (Some(_), _) => self.tightened(QUARTER),
            (None, Some([rtol, _])) if rtol * TENTH >= FINEST => self.tightened(TENTH),
            (None, _) => return None,
        };
        Some(Options {
            max_steps: finer.max_steps.saturating_mul(MORE_STEPS),
            ..finer
        })
    }

    /// The same with its step, or its tolerance, times a factor. What bounds adaptive steps beside the tolerance changes with it: where that alone
    /// decides, a tighter tolerance would make the same steps again.
    fn tightened(self, factor: f64) -> Options {
        let mut options = self;
        let bound = factor.powf(STEP_BY_TOLERANCE);
        match &mut options.method {
            Method::Rk4 { step } | Method::Rattle { step } => *step *= factor,
            Method::Tsit5 { rtol, max_step }
            | Method::Vern7 { rtol, max_step }
            | Method::Rodas5P { rtol, max_step }
            | Method::Auto { rtol, max_step } => {
                *rtol *= factor;
                *max_step *= bound;
                options.max_angle = (options.max_angle * bound).min(turns::MOST);
            }
        }
        options
    }
}

/// A run that is accurate enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accurate {
    /// What to run it with.
    pub options: Options,
    /// Its error, by a finer run.
    pub error: Deviation,
}

impl Variant<'_> {
    /// The error of a run with these options, by a finer one; where nothing finer is told apart from rounding, the error of ten times the tolerance,
    /// which is more.
    ///
    /// # Errors
    /// A run that does not reach its end, an unknown column, or one without a finite value somewhere in the window.
    pub fn error(&self, question: &Question, options: Options) -> Result<Deviation, TradeError> {
        question.check()?;
        let one = self.reference(question, options, None)?;
        let other = match options.finer() {
            Some(finer) => self.reference(question, finer, Some(&one.step_sizes))?,
            None => self.reference(question, options.tightened(1.0 / TENTH), None)?,
        };
        compare(question, &one, &other)
    }

    /// How far a run with these options is from one with others.
    ///
    /// # Errors
    /// As [`Variant::error`].
    pub fn against(
        &self,
        question: &Question,
        options: Options,
        others: Options,
    ) -> Result<Deviation, TradeError> {
        question.check()?;
        let (one, other) = (
            self.reference(question, options, None)?,
            self.reference(question, others, None)?,
        );
        compare(question, &one, &other)
    }

    /// What a run says that others are compared with.
    fn reference(
        &self,
        question: &Question,
        options: Options,
        below: Option<&StepSizes>,
    ) -> Result<Answer, TradeError> {
        self.answer(question, options, below)
            .map_err(|why| match why {
                Unanswered::Run(error) => TradeError::NoReference(Box::new(error)),
                Unanswered::Column(known) => TradeError::Column(question.column.clone(), known),
            })
    }

    /// Tightens a run until its error (rms over the window) is at most `error`, in the unit of the column.
    ///
    /// # Errors
    /// As [`Variant::error`], [`TradeError::Wanted`] of an error that no run can have, or [`TradeError::Unreached`] with the best that was reached.
    pub fn accurate_to(
        &self,
        question: &Question,
        error: f64,
        options: Options,
    ) -> Result<Accurate, TradeError> {
        if !(error.is_finite() && error > 0.0) {
            return Err(TradeError::Wanted(error));
        }
        let mut options = options;
        let mut best = f64::INFINITY;
        let mut failed = None;
        for _ in 0..TRIES {
            let found = match self.error(question, options) {
                Ok(found) => found,
                // A step that is too long says nothing but that, and its error may be what leaves an output without a value.
                Err(other) if options.finer().is_some() && may_be_coarse(&other, &failed) => {
                    options = options.tightened(0.25);
                    failed = Some(other);
                    continue;
                }
                Err(other) => return Err(other),
            };
            if found.rms <= error {
                return Ok(Accurate {
                    options,
                    error: found,
                });
            }
            best = best.min(found.rms);
            let ratio = AIM * error / found.rms;
            let factor = match options.method.fixed_step() {
                Some(_) => ratio.powf(0.25).clamp(0.05, 0.7),
                None => ratio.clamp(1e-3, 0.3),
            };
            let tighter = options.tightened(factor);
            options = match tighter.method.tolerance() {
                Some([rtol, _]) if rtol < FINEST => break,
                _ => tighter,
            };
        }
        match failed {
            Some(failed) if best == f64::INFINITY => Err(failed),
            _ => Err(TradeError::Unreached {
                wanted: error,
                best,
            }),
        }
    }
}

/// How far two runs are apart.
fn compare(question: &Question, one: &Answer, other: &Answer) -> Result<Deviation, TradeError> {
    match one.without.or(other.without) {
        Some(time) => Err(TradeError::NotFinite {
            column: question.column.clone(),
            time,
        }),
        None => Ok(Deviation::between(&one.values, &other.values)),
    }
}

/// Whether a finer run may do what this one failed at, after another failed so: what has no value at the same time again has none there.
fn may_be_coarse(failed: &TradeError, before: &Option<TradeError>) -> bool {
    match (failed, before) {
        (TradeError::NotFinite { time, .. }, Some(TradeError::NotFinite { time: last, .. })) => {
            time != last
        }
        (TradeError::NotFinite { .. } | TradeError::NoReference(_), _) => true,
        _ => false,
    }
}

impl Trajectory {
    /// How far this history is from a finer one of the same run at the same times, column by column, with the largest value of the column in either: what is
    /// zero in the finer one may be anything in this. What is not a number in both is left out.
    ///
    /// `rows` are pairs of a row of this history and the one of the other at the same time; `turn` says how much apart values of a column mean the same [its unit], as those of `atan2`
    /// do that are a turn apart, by its name.
    #[must_use]
    pub fn deviations(
        &self,
        finer: &Trajectory,
        rows: &[[usize; 2]],
        turn: impl Fn(&str) -> Option<f64>,
    ) -> Vec<(Deviation, f64)> {
        let names = self.names().iter();
        let columns = names.map(|name| {
            let [own, other] =
                [self, finer].map(|history| history.column(&name.name).unwrap_or_default());
            let pairs = rows
                .iter()
                .filter_map(|[row, same]| Some((own.get(*row)?, other.get(*same)?)));
            let known = pairs.filter(|(a, b)| !(a.is_nan() && b.is_nan()));
            let turn = turn(&name.name);
            let nearest =
                |a: f64, b: f64| turn.map_or(a, |turn| a - turn * ((a - b) / turn).round());
            let (own, other): (Vec<f64>, Vec<f64>) =
                known.map(|(a, b)| (nearest(*a, *b), *b)).unzip();
            let values = own.iter().chain(&other);
            let size = values.fold(0.0_f64, |most, x| most.max(x.abs()));
            (Deviation::between(&own, &other), size)
        });
        columns.collect()
    }
}
