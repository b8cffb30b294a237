//! Methods with their steps and tolerances, and variants of a model, raced against references that must agree.

use std::fmt;

use mbd_scene::plain;

use super::{Answer, Deviation, Question, TradeError, Unanswered, Variant};
use crate::error::{Statistics, StepError};
use crate::options::{Method, Options};

/// A setting passes with this part of the error that is allowed: the rest is for what was not raced.
const MARGIN: f64 = 1.0 / 3.0;
/// References are this part of the wanted error apart at most.
const RESOLVED: f64 = 0.1;
/// The most steps of a reference, by itself and beside one that is there.
const LONGEST: u64 = 2_000_000;
const LONG: u64 = 400_000;
/// Runs are timed again until they took this together [s], at most so often.
const SHORT: f64 = 0.05;
const AGAIN: usize = 4;

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
            "{}, {}: error {} rms, {} at most; {steps} steps, {rhs} evaluations, {} s",
            self.name,
            self.method,
            plain(self.error.rms, 2),
            plain(self.error.largest, 2),
            plain(self.seconds, 4)
        )
    }
}

/// A setting that gave no answer.
#[derive(Clone, Debug)]
pub struct FailedSetting {
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
    /// The two runs that agree best, and how far they are apart. Errors below that mean nothing.
    pub references: [Method; 2],
    /// See [`Race::references`].
    pub apart: Deviation,
    /// What gave an answer, in the order of the race.
    pub entries: Vec<Entry>,
    /// What gave none.
    pub failed: Vec<FailedSetting>,
}

/// Races methods with their steps and tolerances over variants of a model. The references are runs of the first variant at the tightest
/// tolerances; the two that agree best count: of different methods, but where the stiff method alone reaches the end.
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

/// The tightest setting of each adaptive method. Where the stiff one is the only one that reaches the end, it is compared with itself at the last.
fn tightest() -> [Method; 4] {
    let max_step = f64::INFINITY;
    [
        Method::Rodas5P {
            rtol: 1e-10,
            max_step,
        },
        Method::Vern7 {
            rtol: 1e-12,
            max_step,
        },
        Method::Tsit5 {
            rtol: 1e-11,
            max_step,
        },
        Method::Rodas5P {
            rtol: 1e-8,
            max_step,
        },
    ]
}

/// The settings of each method, loose first.
fn families(question: &Question) -> [Vec<Method>; 5] {
    let until = question.window[1].abs();
    let tolerances = |from: i32, to: i32| (from..=to).map(|k| 10.0_f64.powi(-k));
    let max_step = f64::INFINITY;
    let steps = || (0..14).map(|k| until / f64::from(25 << k));
    [
        steps().map(|step| Method::Rk4 { step }).collect(),
        steps().map(|step| Method::Rattle { step }).collect(),
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
    for (index, method) in tightest().into_iter().enumerate() {
        if index + 1 == tightest().len() && answers.len() > 1 {
            break;
        }
        let options = Options {
            // Where the stiff method has an answer, nobody waits for what the others would need in a stiff scene.
            max_steps: if answers.is_empty() { LONGEST } else { LONG },
            ..Options::of(method)
        };
        match variant.answer(question, options, None) {
            Ok(answer) => answers.push((method, answer)),
            Err(Unanswered::Run(error)) => stopped = Some(error),
            Err(Unanswered::Column(known)) => {
                return Err(TradeError::Column(question.column.clone(), known));
            }
        }
    }
    // Of the two that agree, one of high order is the reference.
    let stiff = |method: &Method| matches!(method, Method::Rodas5P { .. });
    answers.sort_by_key(|(method, _)| stiff(method));
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
            let without = [i, j].iter().find_map(|index| answers[*index].1.without);
            if let Some(time) = without {
                let column = question.column.clone();
                return Err(TradeError::NotFinite { column, time });
            }
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
        match variant.answer(&self.question, options, None) {
            Ok(mut answer) => {
                let mut spent = answer.seconds;
                for _ in 0..AGAIN {
                    if spent > SHORT {
                        break;
                    }
                    if let Ok(again) = variant.answer(&self.question, options, None) {
                        answer.seconds = answer.seconds.min(again.seconds);
                        spent += again.seconds;
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
                self.failed.push(FailedSetting {
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
                "; `{}` in place of `{}` pays {:.1} times (the best there: {}, {} s)",
                self.choice.name,
                other.name,
                other.seconds / self.choice.seconds,
                other.method,
                plain(other.seconds, 4)
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
