//! What the cases of a campaign say: percentiles with confidence, requirements, drivers, failures.

use std::collections::BTreeMap;

use mbd_runtime::MissingMetric;

use crate::manifest::ResultColumn;
use crate::metric::{Requirement, ends_before};
use crate::results::{CaseRow, ITS_SCENE, LEFT_BEFORE, Results, counts_up_to, no_value};
use crate::sampling::CaseSampling;
use crate::statistics::{
    Percentile, cases_needed, first_order, percentile, spearman, spearman_of_all,
};

/// The percentiles that are told.
pub const PARTS: [f64; 7] = [0.00135, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99865];
/// The confidence of their intervals.
pub const CONFIDENCE: f64 = 0.9;

/// Rank correlations of numbers that vary by themselves lie within so many standard deviations, of a thousand pairs nearly all.
const SIGNIFICANT: f64 = 5.0;
/// A smaller correlation moves no share of a variance by more than a hundredth.
const SMALL: f64 = 0.1;

/// A standard deviation below this part of the size of a metric is what rounding and steps scatter.
const ROUNDING: f64 = 1e-10;
/// One below this part of the largest metric of its unit is what rounding leaves of a metric that is zero, which has no size of its own.
const ROUNDING_OF_OTHERS: f64 = 1e-12;

/// A metric over all cases that reached their end.
#[derive(Clone, Debug, PartialEq)]
pub struct Told {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// In the nominal case; NaN where that has none.
    pub nominal: f64,
    /// The values, rising.
    pub sorted: Vec<f64>,
    /// Cases that failed, or that have no value.
    pub without: u64,
    /// Why they have none, each reason with how many they are.
    pub reasons: Vec<(MissingReason, u64)>,
    /// What the metric waits for, in words, and from when on a run counts [s].
    pub waits_for: (String, Option<f64>),
    /// What to know of its quantity, `not unique`; mostly empty.
    pub remark: String,
    /// Cases that have a value of a part of its window only; `None` where there are none.
    pub cut: Option<CutWindow>,
    /// Mean and standard deviation; NaN of fewer than two values.
    pub moments: [f64; 2],
    /// The cases of the smallest and the largest value.
    pub ends: Option<[u64; 2]>,
    /// Percentiles by order statistics; of a grid without intervals.
    pub percentiles: Vec<Percentile>,
    /// What is required, and what became of it.
    pub verdict: Option<RequirementVerdict>,
    /// Whether its spread is no more than what rounding and steps scatter.
    pub is_rounding: bool,
    /// What drives it, the strongest first; nothing where its spread is rounding.
    pub drivers: Vec<MetricDriver>,
}

/// Cases whose runs ended inside the window of a metric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutWindow {
    /// The end of the window [s].
    pub to: f64,
    /// How many they are.
    pub cases: u64,
    /// The first of them.
    pub first: u64,
    /// Whether it is the scene of the metric that ended, and the run went on, in some of them.
    pub in_a_scene: bool,
}

impl CutWindow {
    /// Of these cases.
    fn of(column: &ResultColumn, cases: &[(u64, f64)], in_a_scene: bool) -> Option<Self> {
        Some(CutWindow {
            to: column.to?,
            cases: cases.len() as u64,
            first: cases.first()?.0,
            in_a_scene,
        })
    }

    /// It in words.
    #[must_use]
    pub fn sentence(&self) -> String {
        let CutWindow {
            to, cases, first, ..
        } = self;
        let [one, all] = match self.in_a_scene {
            true => ["its scene ends", "its scene ends in them"],
            false => ["its run ends", "their runs end"],
        };
        let counted = match cases {
            1 => format!("1 case counts a part of the window only, case {first}: {one}"),
            _ => format!(
                "{cases} cases count a part of the window only, the first is case {first}: {all}"
            ),
        };
        format!("{counted} before {to} s")
    }
}

/// A dispersed number that another one varies together with, by its place, and their correlation; none of those that come from the same rows of a file.
pub type Companion = (usize, Option<f64>);

/// A dispersed number and what a metric has of it.
#[derive(Clone, Debug, PartialEq)]
pub struct MetricDriver {
    /// The dispersed number, by its place.
    pub number: usize,
    /// Spearman's rank correlation, −1 … 1.
    pub correlation: f64,
    /// The part of the variance that it explains alone, its first-order Sobol index; `None` where there are not enough cases, and of one that is correlated
    /// with others: alone it explains nothing that could be told from what they do.
    pub index: Option<f64>,
    /// The dispersed numbers that it is correlated with, by their places, and how; the most closely first. One without a number comes from the same rows of a
    /// file: one of them decides the other, whatever their correlation.
    pub together: Vec<Companion>,
    /// How much of the metric goes with it, 0 … 1: that of others is in it, too.
    strength: f64,
}

impl Told {
    /// What is to be known of a quantity of which there are many, or whose spread is none.
    #[must_use]
    pub fn caution(&self) -> Option<String> {
        match (self.remark.is_empty(), self.is_rounding) {
            (false, _) => Some(
                "its reaction is not unique, because rows of joints repeat each other: what it shows is one choice of many".to_owned(),
            ),
            (true, true) => Some("its spread is rounding: nothing drives it".to_owned()),
            (true, false) => None,
        }
    }

    /// Rank correlations of numbers that drive nothing lie within this, 95 % of them.
    #[must_use]
    pub fn chance(&self) -> f64 {
        (2.0 / (self.sorted.len().max(2) as f64 - 1.0).sqrt()).min(1.0)
    }

    /// Why cases have no value; `None` where all have one.
    #[must_use]
    pub fn reason(&self) -> Option<String> {
        let told = self.reasons.iter();
        let mut told: Vec<String> = told
            .map(|(reason, cases)| self.words(*reason, *cases))
            .collect();
        let last = told.pop()?;
        Some(match told.is_empty() {
            true => last,
            false => format!("{} and {last}", told.join(", ")),
        })
    }

    fn words(&self, reason: MissingReason, cases: u64) -> String {
        let runs = if cases == 1 {
            "1 run"
        } else {
            &format!("{cases} runs")
        };
        let (waits_for, from) = &self.waits_for;
        match reason {
            MissingReason::NotFinite => format!("it or its quantity is no finite number in {runs}"),
            MissingReason::EndedBefore => format!(
                "the run ended before {} s, where its window begins, in {runs}",
                from.unwrap_or(0.0)
            ),
            MissingReason::SceneEndedBefore => format!(
                "its scene ended before {} s, where its window begins, in {runs}",
                from.unwrap_or(0.0)
            ),
            MissingReason::NotReached => {
                format!("no scene that has its quantity was reached in {runs}")
            }
            MissingReason::Waited => format!("{waits_for} in {runs}"),
            MissingReason::NothingCounts => format!("nothing of the run counts for it in {runs}"),
            MissingReason::Failed => format!("{runs} failed"),
        }
    }
}

/// Why a case has no value of a metric.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum MissingReason {
    /// It, or its quantity, is no finite number.
    NotFinite,
    /// The run reached its end before the window began.
    EndedBefore,
    /// Its scene ended before the window began, and the run went on.
    SceneEndedBefore,
    /// The run did not come to a scene that has it.
    NotReached,
    /// What it waits for did not happen: an event, a level.
    Waited,
    /// Nothing of the run lies where it counts.
    NothingCounts,
    /// The run failed.
    Failed,
}

impl MissingReason {
    fn of(column: &ResultColumn, row: &CaseRow) -> Self {
        let begin = no_value(&column.name);
        let why = row.why.split_once(&begin).map(|(_, why)| why);
        let not_reached = MissingMetric::NotReached.to_string();
        if !row.reached_end() {
            MissingReason::Failed
        } else if why.is_some_and(|why| why.starts_with(&not_reached)) {
            MissingReason::NotReached
        } else if why.is_some_and(|why| why.starts_with(LEFT_BEFORE)) {
            MissingReason::SceneEndedBefore
        } else if why.is_some() {
            MissingReason::NotFinite
        } else if column.from.is_some_and(|from| ends_before(from, row.time)) {
            MissingReason::EndedBefore
        } else if !column.waits_for.is_empty() {
            MissingReason::Waited
        } else {
            MissingReason::NothingCounts
        }
    }
}

impl MetricDriver {
    /// Which others it is correlated with, in words: `together with wind, with which it is correlated +0.80`; nothing of one that varies by itself.
    #[must_use]
    pub fn company(&self, dispersed: &[ResultColumn]) -> Option<String> {
        let named = self.together.iter().filter_map(|(number, correlation)| {
            let name = &dispersed.get(*number)?.name;
            Some(match correlation {
                Some(correlation) => {
                    format!("{name}, with which it is correlated {correlation:+.2}")
                }
                None => format!("{name}, which comes from the same rows of a file"),
            })
        });
        let named: Vec<String> = named.collect();
        (!named.is_empty()).then(|| format!("together with {}", named.join(", and with ")))
    }
}

/// What became of a requirement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RequirementVerdict {
    /// What is required.
    pub require: Requirement,
    /// Cases that do not meet it: failed ones and those without a value among them.
    pub missed: u64,
    /// Those of them that have no value.
    pub without: u64,
    /// Cases that meet it in the part of the window that they have flown.
    pub partial: u64,
    /// All cases but the nominal.
    pub of: u64,
    /// Whether its quantity is one choice of many, of which nothing can be shown.
    pub withheld: bool,
    /// Whether it is shown.
    pub shown: bool,
    /// How many cases can show it with so many misses; `None` of a grid.
    pub needed: Option<u64>,
}

/// Cases of one kind of failure, those among them that reached their end with what is no finite number, not resolved, or of a part of its window.
#[derive(Clone, Debug, PartialEq)]
pub struct Failures {
    /// Its status.
    pub status: String,
    /// They.
    pub cases: Vec<u64>,
    /// What the first of them says.
    pub why: String,
}

/// What the cases of a campaign say.
#[derive(Clone, Debug, PartialEq)]
pub struct CampaignSummary {
    /// Cases but the nominal.
    pub cases: u64,
    /// The metrics.
    pub metrics: Vec<Told>,
    /// Failures by kind, the most frequent first; the nominal among them.
    pub failures: Vec<Failures>,
}

impl CampaignSummary {
    /// Of these results.
    #[must_use]
    pub fn of(results: &Results) -> Self {
        let companions = companions(results);
        let metrics = 0..results.manifest.metrics.len();
        let metrics = metrics.map(|at| told(results, &companions, at));
        CampaignSummary {
            cases: results.rows.len().saturating_sub(1) as u64,
            metrics: metrics.collect(),
            failures: failures(results),
        }
    }

    /// Whether every requirement is shown.
    #[must_use]
    pub fn passes(&self) -> bool {
        let mut verdicts = self.metrics.iter().filter_map(|told| told.verdict);
        verdicts.all(|verdict| verdict.shown)
    }
}

fn told(results: &Results, companions: &[Vec<Companion>], at: usize) -> Told {
    let column = &results.manifest.metrics[at];
    let values = results.metric(at);
    let numbers: Vec<(u64, f64)> = (1..)
        .zip(&values)
        .filter(|(_, x)| !x.is_nan())
        .map(|(case, x)| (case, *x))
        .collect();
    let mut sorted: Vec<f64> = numbers.iter().map(|(_, x)| *x).collect();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len() as f64;
    let mean = sorted.iter().sum::<f64>() / n;
    let square = sorted.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let moments = if n > 1.0 {
        [mean, square.sqrt()]
    } else {
        [f64::NAN; 2]
    };
    let smallest = numbers.iter().min_by(|a, b| a.1.total_cmp(&b.1));
    let largest = numbers
        .iter()
        .max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)));
    let of = values.len() as u64;
    let why_cut = |case: u64| cut_by(column, results.rows.get(usize::try_from(case).ok()?)?);
    let cut = numbers.iter().copied();
    let cut: Vec<(u64, f64)> = cut.filter(|(case, _)| why_cut(*case).is_some()).collect();
    let in_a_scene = cut
        .iter()
        .any(|(case, _)| why_cut(*case).is_some_and(|why| why.contains(ITS_SCENE)));
    let verdict = column.require.map(|require| {
        let missed = values
            .iter()
            .filter(|value| !require.meets(**value))
            .count() as u64;
        RequirementVerdict {
            require,
            missed,
            without: of - numbers.len() as u64,
            partial: cut
                .iter()
                .filter(|(_, value)| require.meets(*value))
                .count() as u64,
            of,
            withheld: !column.remark.is_empty(),
            shown: column.remark.is_empty() && require.is_shown(missed, of),
            needed: require
                .confidence
                .map(|confidence| cases_needed(missed, require.share, confidence)),
        }
    });
    let is_rounding = is_rounding(results, at, moments);
    Told {
        name: column.name.clone(),
        unit: column.unit.clone(),
        nominal: results.rows.first().map_or(f64::NAN, |row| row.metrics[at]),
        without: of - sorted.len() as u64,
        reasons: reasons(results, at),
        waits_for: (column.waits_for.clone(), column.from),
        remark: column.remark.clone(),
        cut: CutWindow::of(column, &cut, in_a_scene),
        moments,
        ends: smallest.zip(largest).map(|(low, high)| [low.0, high.0]),
        percentiles: percentiles(&sorted, results.manifest.sampling),
        sorted,
        verdict,
        is_rounding,
        // What rounding scatters follows no dispersed number, whatever the ranks say.
        drivers: match is_rounding {
            true => Vec::new(),
            false => drivers((results, companions), &values),
        },
    }
}

/// Whether the spread of a metric with this mean and standard deviation is no more than what rounding scatters.
fn is_rounding(results: &Results, at: usize, [mean, deviation]: [f64; 2]) -> bool {
    let columns = results.manifest.metrics.iter().enumerate();
    let unit = results.manifest.metrics.get(at).map(|own| &own.unit);
    // What has no unit may be anything.
    let alike = columns.filter(|(number, other)| {
        *number != at && !other.unit.is_empty() && Some(&other.unit) == unit
    });
    let size = |values: Vec<f64>| {
        let sizes = values.into_iter().filter(|x| x.is_finite()).map(f64::abs);
        sizes.fold(0.0, f64::max)
    };
    let own = size(results.metric(at)).max(mean.abs());
    let others = size(alike.flat_map(|(other, _)| results.metric(other)).collect());
    deviation > 0.0 && deviation <= (ROUNDING * own).max(ROUNDING_OF_OTHERS * others)
}

/// The percentiles of sorted values; those of a grid are shares of its points, and have no intervals.
fn percentiles(sorted: &[f64], sampling: CaseSampling) -> Vec<Percentile> {
    let all = PARTS
        .iter()
        .filter_map(|part| percentile(sorted, *part, CONFIDENCE));
    match sampling {
        CaseSampling::Grid => all
            .map(|own| Percentile {
                low: None,
                high: None,
                ..own
            })
            .collect(),
        _ => all.collect(),
    }
}

/// What drives a metric with these values.
fn drivers(
    (results, companions): (&Results, &[Vec<Companion>]),
    values: &[f64],
) -> Vec<MetricDriver> {
    let dispersed = 0..results.manifest.dispersed.len();
    let drivers = dispersed.filter_map(|number| {
        let drawn = results.dispersed(number);
        let correlation = spearman(&drawn, values)?;
        let index = first_order(&drawn, values);
        let square = correlation.powi(2);
        let together = companions.get(number).cloned().unwrap_or_default();
        Some(MetricDriver {
            number,
            correlation,
            index: index.filter(|_| together.is_empty()),
            together,
            // A rank correlation misses what rises and falls again.
            strength: index.map_or(square, |index| index.max(square)),
        })
    });
    let mut drivers: Vec<MetricDriver> = drivers.collect();
    drivers.sort_by(|a, b| {
        let stronger = b.strength.total_cmp(&a.strength);
        stronger.then(a.number.cmp(&b.number))
    });
    drivers
}

/// Of every dispersed number those that it is correlated with, the most closely first: as the campaign file asks for, or as the cases have it, by rows of one
/// file, by a constraint.
fn companions(results: &Results) -> Vec<Vec<Companion>> {
    let manifest = &results.manifest;
    let drawn = (0..manifest.dispersed.len()).map(|at| results.dispersed(at));
    let drawn: Vec<Vec<f64>> = drawn.collect();
    let cases = results.rows.len().max(3) as f64 - 2.0;
    let chance = (SIGNIFICANT / cases.sqrt()).max(SMALL);
    let mut all = vec![Vec::new(); drawn.len()];
    let asked = |pair: &[usize; 2]| {
        let mut asked = manifest.correlated.iter();
        let found = asked.find(|(own, _)| own.iter().all(|number| pair.contains(number)));
        found.map(|(_, correlation)| *correlation)
    };
    for (pair, found) in spearman_of_all(&drawn) {
        let shown = (found.abs() > chance).then_some(found);
        let correlation = match asked(&pair) {
            Some(asked) => asked.or(shown),
            None if shown.is_some() => shown,
            None => continue,
        };
        let [a, b] = pair;
        all[a].push((b, correlation));
        all[b].push((a, correlation));
    }
    for own in &mut all {
        let size = |of: &Companion| of.1.map_or(0.0, f64::abs);
        own.sort_by(|a, b| size(b).total_cmp(&size(a)).then(a.0.cmp(&b.0)));
    }
    all
}

/// Why cases have no value of a metric, and how many.
fn reasons(results: &Results, at: usize) -> Vec<(MissingReason, u64)> {
    let column = &results.manifest.metrics[at];
    let rows = results.rows.iter().skip(1);
    let mut counts: BTreeMap<MissingReason, u64> = BTreeMap::new();
    for row in rows.filter(|row| row.metrics[at].is_nan()) {
        *counts.entry(MissingReason::of(column, row)).or_default() += 1;
    }
    counts.into_iter().collect()
}

/// What a case says of a metric that is that of a part of its window; `None` of another.
fn cut_by<'r>(column: &ResultColumn, row: &'r CaseRow) -> Option<&'r str> {
    let (_, told) = row.why.split_once(&counts_up_to(&column.name))?;
    let (own, _) = told.split_once("; ").unwrap_or((told, ""));
    row.reached_end().then_some(own)
}

fn failures(results: &Results) -> Vec<Failures> {
    let mut kinds: BTreeMap<&str, Failures> = BTreeMap::new();
    for row in results.rows.iter().filter(|row| row.status != CaseRow::OK) {
        let kind = kinds.entry(&row.status).or_insert_with(|| Failures {
            status: row.status.clone(),
            cases: Vec::new(),
            why: row.why.clone(),
        });
        kind.cases.push(row.case);
    }
    let mut kinds: Vec<Failures> = kinds.into_values().collect();
    kinds.sort_by_key(|kind| std::cmp::Reverse(kind.cases.len()));
    kinds
}
