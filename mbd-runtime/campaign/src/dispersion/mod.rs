//! What is dispersed in a campaign, and the numbers of every case.

mod correlation;
mod name;
mod read;
mod written;

use std::path::Path;

use mbd_runtime::scene::similar::near_and_all;
use mbd_runtime::scene::{Scene, plain};
use mbd_runtime::{Layout, Moved, state_names};
use toml::Table;

use crate::run::names::{PlanError, unknown, wrong};
use crate::run::number::{not_bare, number};
use crate::run::{CampaignMistakes, RunPlan, Settings, words};
use crate::sampling::{CaseSampling, Distribution, UnitSamples};
use correlation::Correlation;
pub use name::{Dispersible, DispersionTarget, LaterScene};
pub use written::{
    CampaignFile, WrittenEnvelopes, WrittenFootprint, WrittenHistories, WrittenMetric,
    WrittenRequirement, meant,
};
use written::{WrittenConstraint, WrittenCorrelation};

/// The most cases.
const MOST_CASES: u64 = 100_000_000;
/// Draws of one case before it is given up.
const ATTEMPTS: u32 = 10_000;
/// What the start moves by more than this part of how far it is drawn from the nominal does not begin where it is drawn.
const MOVED: f64 = 1e-3;
/// What it moves by less, in SI units, is rounding.
const ROUNDING: f64 = 1e-9;

/// A number that is dispersed.
#[derive(Clone, Debug)]
pub struct Varied {
    /// What it is, with its nominal value.
    pub known: Dispersible,
    /// How it is distributed.
    pub distribution: Distribution,
    spread: UnitSamples,
    /// The file whose rows it comes from.
    file: Option<String>,
}

/// A sum that draws keep within bounds.
#[derive(Clone, Debug, PartialEq)]
struct Constraint {
    /// Factors of dispersed numbers, and what the others add.
    factors: Vec<(usize, f64)>,
    rest: f64,
    bounds: [f64; 2],
}

/// What is dispersed.
#[derive(Clone, Debug)]
pub struct Dispersions {
    /// What all random numbers come from.
    pub seed: u64,
    /// How many cases there are beside the nominal.
    pub cases: u64,
    /// How they are spread.
    pub sampling: CaseSampling,
    /// The numbers, in the order of their names.
    pub varied: Vec<Varied>,
    correlations: Vec<Correlation>,
    constraints: Vec<Constraint>,
}

impl Dispersions {
    /// Those of a file, for a scene that is run as planned and those that go on `later`; tables lie in `folder`.
    ///
    /// # Errors
    /// The settings that cannot be used.
    pub fn new(
        written: &CampaignFile,
        (scene, layout): (&Scene, &Layout),
        (run, later): ((&RunPlan, &Settings), &[LaterScene<'_>]),
        folder: &Path,
    ) -> Result<Self, CampaignMistakes> {
        let mut mistakes = CampaignMistakes::default();
        let sampling = mistakes.note(sampling(written));
        let known = name::known((scene, layout), run, later);
        let mut distributions = Vec::new();
        let parts = [
            ("", &written.params),
            ("start", &written.start),
            ("inputs", &written.inputs),
        ];
        for (part, table) in parts {
            for (name, table) in read::flat(part, table) {
                let setting = if part.is_empty() {
                    format!("params.{name}")
                } else {
                    name.clone()
                };
                let read = table.and_then(|table| {
                    let known = name::find(&known, &setting, &name)?;
                    name::is_one(known, &setting, (scene, run.0), later)?;
                    let read = read::read(&setting, &table, known, folder)?;
                    of_sampling(&setting, &read, sampling)?;
                    let mut before = distributions.iter();
                    if before.any(|(other, _): &(Dispersible, _)| other.name == known.name) {
                        return Err(wrong(setting.clone(), "is given twice"));
                    }
                    Ok((known.clone(), read))
                });
                distributions.extend(mistakes.note(read));
            }
        }
        let cases = sampling.and_then(|sampling| {
            let read = distributions.iter().map(|(_, read)| &read.distribution);
            let fits = fits(sampling, distributions.len());
            mistakes.note(fits.and_then(|()| cases(written, sampling, read)))
        });
        // What varies together, and what sums draws keep to, is asked of all that is dispersed.
        let (sampling, cases) = mistakes.unless(sampling.zip(cases))?;
        // Numbers of one file come from one row: they are drawn by one stream, and in one dimension.
        let mut streams: Vec<String> = Vec::new();
        let varied = distributions
            .into_iter()
            .enumerate()
            .map(|(place, (known, read))| {
                let file = read.file;
                let stream = file
                    .as_ref()
                    .map_or(known.name.clone(), |file| format!("file {file}"));
                let mut before = streams.iter();
                let dimension = before.position(|own| *own == stream).unwrap_or(place);
                streams.push(stream.clone());
                Varied {
                    spread: UnitSamples::new(sampling, written.seed, &stream, (dimension, cases)),
                    distribution: read.distribution,
                    known,
                    file,
                }
            });
        let mut dispersions = Dispersions {
            seed: written.seed,
            cases,
            sampling,
            varied: varied.collect(),
            correlations: Vec::new(),
            constraints: Vec::new(),
        };
        let mut mistakes = CampaignMistakes::default();
        for (number, correlated) in written.correlated.iter().enumerate() {
            let setting = format!("correlated[{number}]");
            let read = dispersions.correlation(setting, correlated);
            dispersions.correlations.extend(mistakes.note(read));
        }
        for (number, constraint) in written.constraint.iter().enumerate() {
            let setting = format!("constraint[{number}]");
            let read = dispersions.constraint(setting, constraint, &known);
            dispersions.constraints.extend(mistakes.note(read));
        }
        dispersions.order_rows();
        mistakes.unless(Some(dispersions))
    }

    /// Puts the rows of a file in the order of the number of it that is correlated with others: what lies below a part of the rows is then what a copula takes.
    fn order_rows(&mut self) {
        let members = self.correlations.iter().flat_map(|known| &known.members);
        let members: Vec<usize> = members.copied().collect();
        for member in members {
            let (file, Distribution::Listed(values)) =
                (&self.varied[member].file, &self.varied[member].distribution)
            else {
                continue;
            };
            let mut order: Vec<usize> = (0..values.len()).collect();
            order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
            let file = file.clone();
            for own in self.varied.iter_mut().filter(|own| own.file == file) {
                if let Distribution::Listed(rows) = &mut own.distribution {
                    *rows = order
                        .iter()
                        .filter_map(|row| rows.get(*row).copied())
                        .collect();
                }
            }
        }
    }

    fn index(&self, setting: &str, name: &str) -> Result<usize, PlanError> {
        let names = self.varied.iter().map(|varied| varied.known.name.as_str());
        let found = names.clone().position(|known| known == name);
        found.ok_or_else(|| {
            let mut error = unknown(setting, name, names);
            error.text = error
                .text
                .replace("this scene has no", "this file disperses no");
            error
        })
    }

    fn correlation(
        &self,
        setting: String,
        written: &WrittenCorrelation,
    ) -> Result<Correlation, PlanError> {
        if self.sampling == CaseSampling::Grid {
            return Err(wrong(
                setting,
                "the values of a grid are combined, not drawn: leave this out",
            ));
        }
        let members = written.names.iter().map(|name| self.index(&setting, name));
        let members: Vec<usize> = members.collect::<Result<_, _>>()?;
        let before = self.correlations.iter().flat_map(|known| &known.members);
        let twice = members.iter().enumerate().find(|(at, member)| {
            members[..*at].contains(member) || before.clone().any(|known| known == *member)
        });
        if let Some((_, member)) = twice {
            let text = format!(
                "`{}` is correlated twice: write one matrix",
                self.varied[*member].known.name
            );
            return Err(wrong(setting, text));
        }
        let of_file = |member: &usize| self.varied[*member].file.as_ref();
        let all: Vec<usize> = before.chain(&members).copied().collect();
        let shared = all.iter().enumerate().find_map(|(at, member)| {
            let file = of_file(member)?;
            let mut others = all[..at].iter();
            others
                .any(|other| of_file(other) == Some(file))
                .then_some(file)
        });
        if let Some(file) = shared {
            let text = format!(
                "numbers of {file} come from one of its rows, and vary together as these do: correlate one of them, and the others follow it"
            );
            return Err(wrong(setting, text));
        }
        Correlation::new(&setting, members, &written.matrix)
    }

    fn constraint(
        &self,
        setting: String,
        written: &WrittenConstraint,
        known: &[Dispersible],
    ) -> Result<Constraint, PlanError> {
        if self.sampling != CaseSampling::Random {
            return Err(wrong(
                setting,
                "draws that break a constraint are drawn again, which spoils the strata of `latin`, the evenness of `sobol` and the points of a grid: take `sampling = \"random\"`, or disperse numbers that keep it whatever they are, as shares of one sum",
            ));
        }
        let mut unit = None;
        let (mut factors, mut rest) = (Vec::new(), 0.0);
        for (name, factor) in &written.sum {
            if !factor.is_finite() {
                let text = format!("the factor of `{name}` is no finite number");
                return Err(wrong(setting, text));
            }
            let known = name::find(known, &setting, name)?;
            let first = unit.get_or_insert(known.unit.clone());
            if *first != known.unit {
                return Err(wrong(
                    setting,
                    format!(
                        "`{name}` is in {}, the first in {first}: only what has one unit adds up",
                        known.unit
                    ),
                ));
            }
            match self
                .varied
                .iter()
                .position(|varied| varied.known.name == *name)
            {
                Some(at) => factors.push((at, *factor)),
                None => rest += factor * known.nominal,
            }
        }
        let Some(unit) = unit.filter(|_| !factors.is_empty()) else {
            return Err(wrong(setting, "`sum` names nothing that is dispersed"));
        };
        let bound = |value: &Option<toml::Value>, free: f64| {
            let Some(value) = value else {
                return Ok(free);
            };
            not_bare(&setting, value, &unit)?;
            number(&setting, value, &unit)
        };
        let bounds = [
            bound(&written.at_least, f64::NEG_INFINITY)?,
            bound(&written.at_most, f64::INFINITY)?,
        ];
        if written.at_least.is_none() && written.at_most.is_none() {
            return Err(wrong(setting, "give `at_least` or `at_most`"));
        }
        if bounds[0] > bounds[1] {
            let text =
                "no sum is at least the one and at most the other: `at_most` is the larger of them";
            return Err(wrong(setting, text));
        }
        Ok(Constraint {
            factors,
            rest,
            bounds,
        })
    }

    /// The dispersed numbers of a case, in order [SI]; case 0 has the nominal ones.
    ///
    /// # Errors
    /// No draw of this case obeys the constraints.
    pub fn values(&self, case: u64) -> Result<Vec<f64>, PlanError> {
        if case == 0 {
            return Ok(self
                .varied
                .iter()
                .map(|varied| varied.known.nominal)
                .collect());
        }
        if self.sampling == CaseSampling::Grid {
            return Ok(self.combination(case - 1));
        }
        for attempt in 0..ATTEMPTS {
            let values = self.draw(case, attempt);
            if self
                .constraints
                .iter()
                .all(|constraint| constraint.holds(&values))
            {
                return Ok(values);
            }
        }
        let text = format!(
            "none of {ATTEMPTS} draws of case {case} keeps it: loosen it, or narrow the distributions"
        );
        Err(wrong("constraint", text))
    }

    fn draw(&self, case: u64, attempt: u32) -> Vec<f64> {
        let mut parts: Vec<f64> = self
            .varied
            .iter()
            .map(|varied| varied.spread.at(case, attempt))
            .collect();
        let mut quantiles = vec![None; parts.len()];
        for correlation in &self.correlations {
            correlation.mix(&mut parts, &mut quantiles);
        }
        for (member, own) in self.correlated_rows() {
            parts[own] = parts[member];
        }
        let drawn = self.varied.iter().zip(parts.iter().zip(quantiles));
        drawn
            .map(|(varied, (part, quantile))| varied.distribution.quantile(*part, quantile))
            .collect()
    }

    /// Each number from a file that is correlated, with every other one of the same rows, by their places.
    fn correlated_rows(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let members = self.correlations.iter().flat_map(|known| &known.members);
        members.flat_map(move |member| {
            let file = self.varied.get(*member).and_then(|own| own.file.as_ref());
            let all = self.varied.iter().enumerate();
            let alike = all.filter(move |(at, own)| {
                file.is_some() && own.file.as_ref() == file && at != member
            });
            alike.map(move |(at, _)| (*member, at))
        })
    }

    /// A combination of the values of a grid, the last fastest.
    fn combination(&self, mut index: u64) -> Vec<f64> {
        let mut values: Vec<f64> = Vec::new();
        for varied in self.varied.iter().rev() {
            let Distribution::Listed(list) = &varied.distribution else {
                continue;
            };
            let count = list.len() as u64;
            values.push(list[(index % count) as usize]);
            index /= count;
        }
        values.reverse();
        values
    }

    /// Those that are asked to vary together, two by two by their places, each with their correlation; none of those that come from the rows of one file.
    #[must_use]
    pub fn correlated(&self) -> Vec<([usize; 2], Option<f64>)> {
        let pairs = self.correlations.iter().flat_map(Correlation::pairs);
        let pairs = pairs.map(|(pair, correlation)| (pair, Some(correlation)));
        let varied = self.varied.iter().enumerate();
        let of_rows = varied.flat_map(|(at, own)| {
            let before = self.varied.iter().enumerate().take(at);
            let alike = before.filter(|(_, other)| own.file.is_some() && other.file == own.file);
            alike.map(move |(other, _)| ([other, at], None))
        });
        pairs.chain(of_rows).collect()
    }

    /// Dispersed numbers, each in the unit of its column.
    #[must_use]
    pub fn in_units(&self, values: &[f64]) -> Vec<f64> {
        let values = self.varied.iter().zip(values);
        values
            .map(|(varied, value)| value / varied.known.factor)
            .collect()
    }

    /// Whether it disperses numbers of the start.
    pub fn has_starts(&self) -> bool {
        let mut targets = self.varied.iter().map(|varied| &varied.known.target);
        targets.any(|target| matches!(target, DispersionTarget::Start(_)))
    }

    /// Whether it disperses what may begin elsewhere than it is drawn: a coordinate that is about a value, in place of which a loop may decide another, or a
    /// number of an attitude, of which all four make a unit quaternion.
    pub fn gives_way(&self, scene: &Scene, settings: &Settings) -> bool {
        let mut targets = self.varied.iter().map(|varied| &varied.known.target);
        targets.any(|target| match target {
            DispersionTarget::Start(at) => {
                is_of_attitude(at) || name::gives_way(scene, settings, at)
            }
            _ => false,
        })
    }

    /// Puts what was taken in place of what was drawn of such numbers: the row tells where the run begins.
    pub fn take(&self, (scene, layout): (&Scene, &Layout), plan: &RunPlan, values: &mut [f64]) {
        let about = plan.assembly.told_about(scene);
        let about = about.into_iter().map(|(name, _, taken)| (name, taken));
        let states = state_names(scene, layout).into_iter().zip(&plan.state);
        let attitudes = states.filter(|(name, _)| is_of_attitude(&name.name));
        let attitudes = attitudes.map(|(name, taken)| (name.name, *taken));
        let all: Vec<(String, f64)> = about.chain(attitudes).collect();
        for (varied, value) in self.varied.iter().zip(values) {
            let DispersionTarget::Start(at) = &varied.known.target else {
                continue;
            };
            let own = all.iter().find(|(name, _)| name == at);
            if let Some((_, taken)) = own.filter(|(_, taken)| (taken - *value).abs() > ROUNDING) {
                *value = *taken;
            }
        }
    }

    /// Refuses places and speeds that the start changed so that joints hold, of what these numbers put elsewhere than the nominal is, beyond what it changes
    /// there: the row would tell a start that the run does not have.
    ///
    /// # Errors
    /// The first such number, with how far off the run would begin.
    pub fn check_start(
        &self,
        values: &[f64],
        [moved, of_nominal]: [&[Moved]; 2],
    ) -> Result<(), PlanError> {
        for (varied, value) in self.varied.iter().zip(values) {
            let DispersionTarget::Start(at) = &varied.known.target else {
                continue;
            };
            let Some((owner, component)) = at.rsplit_once('.') else {
                continue;
            };
            let (how_far, unit, what): (fn(&Moved) -> f64, _, _) = match component {
                "x" | "y" | "z" => (|moved| moved.distance, "m", "its place"),
                "angle" | "qw" | "qx" | "qy" | "qz" => (|moved| moved.angle, "rad", "its attitude"),
                "vx" | "vy" | "vz" => (|moved| moved.velocity, "m/s", "its velocity"),
                _ if component.starts_with("omega") => {
                    let turned: fn(&Moved) -> f64 = |moved| moved.angular_velocity;
                    (turned, "rad/s", "its angular velocity")
                }
                _ => continue,
            };
            let own = |list: &[Moved]| {
                let found = list.iter().find(|moved| moved.name == owner);
                found.map_or(0.0, how_far)
            };
            let off = own(moved);
            // What is declared to some digits is moved by as much in every case.
            if off > own(of_nominal) + MOVED * (value - varied.known.nominal).abs() + ROUNDING {
                let text = format!(
                    "the joints of `{owner}` do not allow what is drawn, and {what} would be {} {unit} off: disperse what they leave free, such as a coordinate of a joint or its rate",
                    plain(off, 4)
                );
                return Err(wrong(&*varied.known.name, text));
            }
        }
        Ok(())
    }

    /// Sets the params among the dispersed numbers.
    pub fn set_params(&self, values: &[f64], params: &mut [f64]) {
        for (varied, value) in self.varied.iter().zip(values) {
            if let DispersionTarget::Param(at) = varied.known.target {
                params[at] = *value;
            }
        }
    }

    /// The plan of a case: that of the nominal with these numbers. What the settings say of the start has the names of the state and of joint coordinates.
    ///
    /// # Errors
    /// A start that cannot be.
    pub fn plan(
        &self,
        nominal: (&RunPlan, &Settings),
        (scene, layout): (&Scene, &Layout),
        values: &[f64],
    ) -> Result<RunPlan, PlanError> {
        let (plan, settings) = nominal;
        let mut plan = plan.clone();
        self.set_params(values, &mut plan.params);
        let mut start: Option<Table> = None;
        for (varied, value) in self.varied.iter().zip(values) {
            match &varied.known.target {
                DispersionTarget::Param(_) | DispersionTarget::LaterParam => {}
                DispersionTarget::Input(at) => plan.inputs[*at] = *value,
                DispersionTarget::Start(at) => {
                    let table = start.get_or_insert_with(|| settings.start.clone());
                    let value = name::dispersed(scene, settings, at, *value);
                    table.insert(at.clone(), value);
                }
            }
        }
        let same = plan.params == nominal.0.params && plan.inputs == nominal.0.inputs;
        if start.is_some() || !same {
            let start = start.unwrap_or_else(|| settings.start.clone());
            plan.place((scene, layout), &start)?;
        }
        Ok(plan)
    }

    /// The plan of a case in a scene that goes on: that of the nominal with the params of these numbers.
    ///
    /// # Errors
    /// A start of its own that cannot be.
    pub fn plan_later(
        &self,
        (plan, settings): (&RunPlan, &Settings),
        (scene, layout): (&Scene, &Layout),
        values: &[f64],
    ) -> Result<RunPlan, PlanError> {
        let mut plan = plan.clone();
        let mut changed = false;
        for (param, own) in scene.params.iter().zip(&mut plan.params) {
            let mut varied = self.varied.iter().zip(values);
            let found = varied.find(|(varied, _)| {
                let is_param = matches!(
                    varied.known.target,
                    DispersionTarget::Param(_) | DispersionTarget::LaterParam
                );
                is_param && varied.known.name == param.name
            });
            if let Some((_, value)) = found {
                changed |= value != own;
                *own = *value;
            }
        }
        if changed {
            plan.place((scene, layout), &settings.start)?;
        }
        Ok(plan)
    }
}

impl Constraint {
    fn holds(&self, values: &[f64]) -> bool {
        let parts = self.factors.iter().map(|(at, factor)| factor * values[*at]);
        let sum = self.rest + parts.sum::<f64>();
        let [low, high] = self.bounds;
        (low..=high).contains(&sum)
    }
}

/// Whether a number of a start is one of four of an attitude.
fn is_of_attitude(name: &str) -> bool {
    let component = name.rsplit_once('.').map(|(_, component)| component);
    matches!(component, Some("qw" | "qx" | "qy" | "qz"))
}

/// How the cases of a file are spread.
///
/// # Errors
/// There is no such sampling.
pub fn sampling(written: &CampaignFile) -> Result<CaseSampling, PlanError> {
    let Some(word) = &written.sampling else {
        return Ok(CaseSampling::Random);
    };
    let found = CaseSampling::WORDS.iter().find(|(known, _)| known == word);
    found.map(|(_, sampling)| *sampling).ok_or_else(|| {
        let words = CaseSampling::WORDS.map(|(word, _)| word);
        let all = match words::of_sampling(word) {
            Some(ours) => format!(": {ours}"),
            None => near_and_all(word, words),
        };
        wrong("sampling", format!("there is no sampling `{word}`{all}"))
    })
}

/// Refuses a list of a grid where cases are drawn, and what is drawn in a grid; a sampling that there is not was told.
fn of_sampling(
    setting: &str,
    read: &read::Read,
    sampling: Option<CaseSampling>,
) -> Result<(), PlanError> {
    match sampling {
        Some(sampling) if read.grid != (sampling == CaseSampling::Grid) => Err(wrong(
            setting,
            "`dist = \"grid\"` goes with `sampling = \"grid\"`, and nothing else does",
        )),
        _ => Ok(()),
    }
}

/// Refuses more numbers than a sampling has dimensions.
fn fits(sampling: CaseSampling, numbers: usize) -> Result<(), PlanError> {
    match sampling.most().filter(|most| numbers > *most) {
        None => Ok(()),
        Some(most) => {
            let text = format!(
                "a Sobol sequence has up to {most} dimensions, these are {numbers}: take `latin`"
            );
            Err(wrong("sampling", text))
        }
    }
}

fn cases<'d>(
    written: &CampaignFile,
    sampling: CaseSampling,
    distributions: impl Iterator<Item = &'d Distribution>,
) -> Result<u64, PlanError> {
    let cases = match (sampling, written.cases) {
        (CaseSampling::Grid, None) => {
            let mut counts = distributions.map(|distribution| match distribution {
                Distribution::Listed(list) => list.len() as u64,
                _ => 1,
            });
            let product = counts.try_fold(1_u64, u64::checked_mul);
            product.ok_or_else(|| wrong("sampling", "this grid has too many combinations"))?
        }
        (CaseSampling::Grid, Some(_)) => {
            return Err(wrong(
                "cases",
                "a grid has as many cases as combinations: leave this out",
            ));
        }
        (_, Some(cases)) => cases,
        (_, None) => {
            return Err(wrong(
                "cases",
                "say how many cases there are: `cases = 1000`",
            ));
        }
    };
    match cases <= MOST_CASES {
        true => Ok(cases),
        false => Err(wrong("cases", format!("at most {MOST_CASES}"))),
    }
}
