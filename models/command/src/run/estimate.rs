//! The error of a run: by a second, finer one, and by the energy that it made or lost.

use std::fmt;

use mbd_campaign::LARGE_ERROR;
use mbd_campaign::run::{GoingRun, Phase, RunPlan, fly_in_turn};
use mbd_runtime::scene::metrics::Take;
use mbd_runtime::scene::{Formula, Function, Scene, plain};
use mbd_runtime::{
    Deviation, MetricValue, Model, RunError, Sampling, Simulation, StepSizes, Trajectory,
};

use super::outcome::{CONTENT, RunOutcome};
use super::phases::{PhasedRun, Segment};
use super::publish_phases::joined;

/// At most so many rows are compared.
const ROWS: usize = 400;
/// What is nothing in any unit, in a scene that is 1 m long or more; in a smaller one so much smaller.
const NOTHING: f64 = 1e-9;
/// A column that never is more than this part of the largest value of its unit, or of a radian, may be what rounding and tolerances leave of zero.
const SMALL_PART: f64 = 1e-6;
/// An error of the steps below this part of what they made of the energy does not explain it.
const UNEXPLAINED: f64 = 1e-3;

/// The error of the quantity that is off most, of its own size.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Its column, or the name of a metric.
    pub column: String,
    /// Whether it is a metric: one number of the run.
    pub is_metric: bool,
    /// Its unit.
    pub unit: String,
    /// Its error, of a column the root of the mean square over the run [its unit].
    pub error: f64,
    /// The same over the largest value of the column, or over a millionth of the largest of its unit, where that is more: of angles at least of a radian;
    /// torques are of the unit of energies here, and forces of that over the largest length.
    pub relative: f64,
    /// What it is over [its unit], where that is more than the largest value.
    pub over: Option<f64>,
}

impl Estimate {
    /// What the relative error is over, in words.
    pub(super) fn measure(&self) -> String {
        match (self.over, self.is_metric) {
            (Some(scale), _) => {
                let scale = format!("{} {}", plain(scale, 2), self.unit);
                format!("{}, which it is less than", scale.trim_end())
            }
            (None, true) => "its value".to_owned(),
            (None, false) => "its largest value".to_owned(),
        }
    }
}

/// Why the error of a run is not estimated.
#[derive(Clone, Debug, PartialEq)]
pub enum Unestimated {
    /// Its settings ask for no estimate.
    NotAsked,
    /// It did not reach its end.
    Stopped,
    /// It is a part of a run through several scenes, which is estimated as a whole.
    OfWhole,
    /// A second, finer run does not reach its end.
    Finer(Box<RunError>),
    /// A second, finer run goes through other scenes.
    OtherScenes,
    /// Nothing finer than its tolerance is told apart from rounding.
    Finest,
    /// Nothing that counts is ever more than zero.
    Nothing,
}

impl fmt::Display for Unestimated {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Unestimated::NotAsked => f.write_str("the settings ask for no second, finer run"),
            Unestimated::Stopped => f.write_str("the run did not reach its end"),
            Unestimated::OfWhole => f.write_str("told of the whole run through all scenes"),
            Unestimated::Finer(error) => {
                write!(f, "a second, finer run does not reach its end: {error}")
            }
            Unestimated::OtherScenes => {
                f.write_str("a second, finer run goes on in other scenes: whether an event happens hangs on the steps")
            }
            Unestimated::Finest => {
                f.write_str("nothing finer than the tolerance is told apart from rounding")
            }
            Unestimated::Nothing => {
                f.write_str("nothing that is asked for is ever more than zero")
            }
        }
    }
}

impl From<RunError> for Unestimated {
    fn from(error: RunError) -> Self {
        Unestimated::Finer(Box::new(error))
    }
}

/// Flies the plan again with finer steps, and compares metrics, outputs and lines, or where there are none of these the motion of bodies and points.
///
/// # Errors
/// The finer run did not reach the end of the first; nothing finer is told apart from rounding, or nothing that counts is more than zero.
pub fn estimate(
    model: &dyn Model<f64>,
    plan: &RunPlan,
    first: &Trajectory,
    sizes: &StepSizes,
) -> Result<Estimate, Unestimated> {
    let options = plan.options.finer().ok_or(Unestimated::Finest)?;
    let rows = rows(first);
    let times = times(first, &rows);
    let Some(&last) = times.last() else {
        return Err(Unestimated::Nothing);
    };
    let until = if first.end().is_finite() {
        first.end().max(last)
    } else {
        last
    };
    let mut finer = Trajectory::new(model, Sampling::At(times), CONTENT);
    let mut run = Simulation::new(model, options)?;
    plan.begin(&mut run)?;
    run.refine(sizes);
    run.record(until, &mut finer)?;
    let scene = model.scene();
    let pairs: Vec<[usize; 2]> = rows
        .into_iter()
        .zip(0..)
        .map(|(own, other)| [own, other])
        .collect();
    let metrics = [first, &finer].map(|history| history.metrics(scene));
    worst(&[scene], [first, &finer], &pairs, (metrics, until))
}

/// Flies a run through several scenes again with finer steps, and compares it as one.
///
/// # Errors
/// As [`estimate`]; the finer run goes through other scenes.
pub fn estimate_phases(
    phases: &[Phase],
    plans: &[RunPlan],
    segments: &[Segment],
) -> Result<Estimate, Unestimated> {
    let finer: Option<Vec<RunPlan>> = plans
        .iter()
        .map(|plan| {
            let options = plan.options.finer()?;
            Some(RunPlan {
                options,
                ..plan.clone()
            })
        })
        .collect();
    let plans = finer.ok_or(Unestimated::Finest)?;
    let (Some(first), Some(plan)) = (phases.first(), plans.first()) else {
        return Err(Unestimated::Nothing);
    };
    let parts = segments.iter();
    let parts = parts.map(|segment| (segment.phase, &segment.outcome.trajectory));
    let parts: Vec<(usize, &Trajectory)> = parts.collect();
    let (one, metrics) = joined(phases, &parts, false);
    let rows = rows(&one);
    let sampling = Sampling::At(times(&one, &rows));
    let until = segments.last().map_or(0.0, |last| last.outcome.time);
    let mut run = Simulation::new(&*first.model, plan.options)?;
    plan.begin(&mut run)?;
    let begun = GoingRun {
        phase: 0,
        plan: plan.clone(),
        run,
        handover: None,
    };
    let mut flown: Vec<(usize, Trajectory)> = Vec::new();
    let of = |index: usize| Ok(plans.get(index).unwrap_or(plan).clone());
    fly_in_turn(phases, begun, &of, &mut |going| {
        if let Some(segment) = segments.get(flown.len()) {
            going.run.refine(&segment.sizes);
        }
        let model = going.run.model().clone();
        let sampling = sampling.clone().from_time(going.run.time());
        let mut history = Trajectory::new(&*model, sampling, CONTENT);
        let stop = going.run.record(until, &mut history);
        flown.push((going.phase, history));
        stop
    })?;
    let finer: Vec<(usize, &Trajectory)> = flown.iter().map(|(phase, it)| (*phase, it)).collect();
    let scenes = |parts: &[(usize, &Trajectory)]| -> Vec<usize> {
        parts.iter().map(|(phase, _)| *phase).collect()
    };
    if scenes(&finer) != scenes(&parts) {
        return Err(Unestimated::OtherScenes);
    }
    let (other, finer_metrics) = joined(phases, &finer, false);
    // Near a switch one of both may be in the scene before it yet.
    let place = |history: &Trajectory, row: usize| {
        let phase = history.column("phase").and_then(|phase| phase.get(row));
        Some((*phase?, *history.times().get(row)?))
    };
    let mut pairs = Vec::new();
    let mut next = 0;
    for row in rows {
        let own = place(&one, row);
        let mut others = next..other.len();
        if let Some(found) = others.find(|at| own.is_some() && place(&other, *at) == own) {
            pairs.push([row, found]);
            next = found + 1;
        }
    }
    let scenes: Vec<&Scene> = phases.iter().map(|phase| phase.model.scene()).collect();
    let metrics = [metrics, finer_metrics].map(|all| {
        all.into_iter()
            .map(|(metric, _)| metric)
            .collect::<Vec<_>>()
    });
    worst(&scenes, [&one, &other], &pairs, (metrics, until))
}

/// The times of rows [s].
fn times(history: &Trajectory, rows: &[usize]) -> Vec<f64> {
    let times = rows.iter().filter_map(|row| history.times().get(*row));
    times.copied().collect()
}

/// What two runs differ in most, over pairs of rows at the same times.
fn worst(
    scenes: &[&Scene],
    [first, finer]: [&Trajectory; 2],
    pairs: &[[usize; 2]],
    (metrics, until): ([Vec<MetricValue>; 2], f64),
) -> Result<Estimate, Unestimated> {
    let mut asked: Vec<&str> = Vec::new();
    for scene in scenes {
        asked.extend(scene.outputs.iter().map(|output| output.name.as_str()));
        asked.extend(scene.lines.iter().map(|line| line.name.as_str()));
    }
    if asked.is_empty() {
        for scene in scenes {
            asked.extend(scene.bodies.iter().map(|body| body.name.as_str()));
            asked.extend(scene.points.iter().map(|point| point.name.as_str()));
        }
    }
    let counts = |name: &str| {
        // An output or one of its components, or a line; of several scenes with the number of its own.
        let name = name.split(' ').next().unwrap_or(name);
        let owner = name.split('.').next().unwrap_or(name);
        asked.contains(&name) || asked.contains(&owner)
    };
    let turn = |column: &str| scenes.iter().find_map(|scene| turn(scene, column));
    let deviations = first.deviations(finer, pairs, turn);
    let sizes = Sizes::of(first, &deviations);
    let all = first.names().iter().zip(&deviations);
    let told = all.filter(|(name, _)| counts(&name.name));
    let estimates = told.filter_map(|(name, (deviation, size))| {
        let scale = sizes.scale(&name.unit, *size);
        (scale > sizes.nothing()).then(|| Estimate {
            column: name.name.clone(),
            is_metric: false,
            unit: name.unit.clone(),
            error: deviation.rms,
            relative: deviation.rms / scale,
            over: (scale > *size).then_some(scale),
        })
    });
    let all = estimates.chain(of_metrics(metrics, &sizes, until));
    let worst = all.max_by(|a, b| a.relative.total_cmp(&b.relative));
    worst.ok_or(Unestimated::Nothing)
}

/// The errors of metrics: one number each.
fn of_metrics([first, finer]: [Vec<MetricValue>; 2], sizes: &Sizes, until: f64) -> Vec<Estimate> {
    let told = first.iter().zip(finer).filter_map(|(here, finer)| {
        let (here_value, value) = (here.value.ok()?, finer.value.ok()?);
        let error = (value - here_value).abs();
        // What is taken over time is measured by the time, times what it is taken of, where that is known.
        let scale = match here.take {
            Take::TimeOf | Take::TimeAbove | Take::FirstAbove => {
                value.abs().max(SMALL_PART * until)
            }
            Take::Integral => {
                let of = here.unit.strip_suffix(" s").unwrap_or_default();
                value.abs().max(SMALL_PART * until * sizes.largest(of))
            }
            _ => sizes.scale(&here.unit, value.abs()),
        };
        (scale > sizes.nothing()).then(|| Estimate {
            column: here.name.clone(),
            is_metric: true,
            unit: here.unit.clone(),
            error,
            relative: error / scale,
            over: (scale > value.abs()).then_some(scale),
        })
    });
    told.collect()
}

/// The largest value of each column, with its unit: what errors are measured by.
struct Sizes(Vec<(String, f64)>);

impl Sizes {
    fn of(run: &Trajectory, deviations: &[(Deviation, f64)]) -> Self {
        let columns = run.names().iter().zip(deviations);
        Sizes(
            columns
                .map(|(name, (_, size))| (name.unit.clone(), *size))
                .collect(),
        )
    }

    /// Those of a run alone.
    fn of_run(run: &Trajectory) -> Self {
        let size = |column: &[f64]| {
            let finite = column.iter().filter(|x| x.is_finite());
            finite.fold(0.0, |most: f64, x| most.max(x.abs()))
        };
        let columns = run.names().iter();
        Sizes(
            columns
                .map(|name| (name.unit.clone(), run.column(&name.name).map_or(0.0, size)))
                .collect(),
        )
    }

    /// The largest value of a unit.
    fn largest(&self, unit: &str) -> f64 {
        let same = self.0.iter().filter(|(own, _)| own == unit);
        same.map(|(_, size)| *size).fold(0.0, f64::max)
    }

    /// What is nothing in this scene, in any unit.
    fn nothing(&self) -> f64 {
        match self.largest("m") {
            length if length > 0.0 => NOTHING * length.min(1.0),
            _ => NOTHING,
        }
    }

    /// What the error of something of a unit is measured by, that is itself never more than `own`.
    fn scale(&self, unit: &str, own: f64) -> f64 {
        // Torques are measured by the energy that moves, and forces by that over the way: where nothing else has their unit, zero has a size.
        let other = match unit {
            "N*m" => self.largest("J"),
            "N" => self.largest("J") / self.largest("m"),
            "rad" => self.largest("deg").to_radians().max(1.0),
            "deg" => self.largest("rad").max(1.0).to_degrees(),
            _ => 0.0,
        };
        let largest = self
            .largest(unit)
            .max(if other.is_finite() { other } else { 0.0 });
        own.max(SMALL_PART * largest)
    }
}

/// How much apart values of an output mean the same [its unit]: a turn, where it is an `atan2`.
fn turn(scene: &Scene, column: &str) -> Option<f64> {
    let mut outputs = scene.outputs.iter();
    let output = outputs.find(|output| scene.output_column(output) == column)?;
    match scene.said(&output.value) {
        Formula::Apply(Function::Atan2, _) => Some(std::f64::consts::TAU / output.unit.factor),
        _ => None,
    }
}

/// Rows at increasing times, evenly chosen; none at the instant of an event or a switch: what jumps there has two values, and of two runs one may stand
/// before it and one behind.
fn rows(history: &Trajectory) -> Vec<usize> {
    let times = history.times();
    let alone = |row: usize| {
        let Some(own) = times.get(row) else {
            return false;
        };
        let mut jumps = history.events.iter().map(|(at, _)| at);
        !jumps.any(|at| (at - own).abs() <= NOTHING * own.abs().max(NOTHING))
    };
    let apart: Vec<usize> = (0..times.len()).filter(|row| alone(*row)).collect();
    // Where an event is at every row, both runs have the row before it.
    let all = match apart.len() > 1 {
        true => apart,
        false => (0..times.len()).collect(),
    };
    let every = all.len().div_ceil(ROWS).max(1);
    let last = all.len().saturating_sub(1);
    let numbered = all.into_iter().enumerate();
    let chosen = numbered.filter(|(number, _)| number % every == 0 || *number == last);
    let chosen = chosen.map(|(_, row)| row);
    let mut rows: Vec<usize> = Vec::new();
    for row in chosen {
        let before = rows.last().and_then(|before| times.get(*before));
        if before.is_some_and(|before| times.get(row).is_none_or(|time| time <= before)) {
            rows.pop();
        }
        rows.push(row);
    }
    rows
}

/// The metric that is resolved worst, with the part of its size that it may be off by, where that is large.
fn unresolved(scene: &Scene, run: &Trajectory) -> Option<(MetricValue, f64)> {
    let sizes = Sizes::of_run(run);
    let parts = run.metrics(scene).into_iter().filter_map(|metric| {
        let scale = sizes.scale(&metric.unit, metric.value.ok()?.abs());
        let part = metric.unresolved / scale;
        (scale > sizes.nothing() && part > LARGE_ERROR).then_some((metric, part))
    });
    parts.max_by(|a, b| a.1.total_cmp(&b.1))
}

/// What makes steps finer, in words.
fn change(plan: &RunPlan) -> String {
    match plan.options.method.fixed_step() {
        Some(step) => format!("take a shorter step than {step} s"),
        None => "take a tighter tolerance".to_owned(),
    }
}

/// What a second, finer run says against a run of a scene, or of several one after the other, and what to change; `None` where it says nothing.
fn off(
    scenes: &[&Scene],
    plan: &RunPlan,
    estimate: &Result<Estimate, Unestimated>,
) -> Option<String> {
    let it = match estimate {
        Ok(it) if it.relative > LARGE_ERROR => it,
        Err(why @ (Unestimated::Finer(_) | Unestimated::OtherScenes)) => {
            return Some(format!("how far it is off is not known, because {why}"));
        }
        _ => return None,
    };
    let jumps = match scenes.iter().any(|scene| scene.jumps_with_motion()) {
        true => {
            "a force that an `if` lets jump is where the motion stays (let it be zero there), or "
        }
        false => "",
    };
    Some(format!(
        "`{}` is off by about {}, {:.1} % of {}: {}; where that does not help, {jumps}the motion is chaotic over this time",
        it.column,
        format!("{} {}", plain(it.error, 2), it.unit).trim_end(),
        100.0 * it.relative,
        it.measure(),
        change(plan)
    ))
}

/// The same of a run through several scenes.
#[must_use]
pub fn doubt_of_all(phases: &[Phase], run: &PhasedRun) -> Option<String> {
    let scenes: Vec<&Scene> = phases.iter().map(|phase| phase.model.scene()).collect();
    let first = run.segments.first()?;
    let names: Vec<&str> = scenes.iter().map(|scene| scene.name.as_str()).collect();
    let doubt = off(&scenes, &first.plan, &run.estimate)?;
    Some(format!("warning: {}: {doubt}", names.join(" → ")))
}

/// What makes a run less accurate than it should be, and what to change; `None` where nothing does.
#[must_use]
pub fn doubt(scene: &Scene, plan: &RunPlan, outcome: &RunOutcome) -> Option<String> {
    let change = change(plan);
    let by_energy = outcome
        .imbalance
        .map(|it| it.relative())
        .filter(|part| *part > LARGE_ERROR);
    let by_momentum = outcome
        .momentum
        .map(|it| it.relative())
        .filter(|part| *part > LARGE_ERROR);
    let rough = unresolved(scene, &outcome.trajectory);
    let of_state = outcome.coarse_state.as_ref();
    let told = of_state.map_or(1e-3, |state| state.share.max(1e-3));
    let by_rounding = Some(outcome.rounding).filter(|part| *part > told);
    let doubts = [
        off(&[scene], plan, &outcome.estimate),
        outcome.hidden.map(|time| {
            format!(
                "what acts changes at {} s in less than a step, and no stage of a step sees it: {change}, or an adaptive method",
                plain(time, 9)
            )
        }),
        rough.map(|(metric, part)| {
            format!("{}; take shorter steps (`--dt`)", metric.off_by(part))
        }),
        by_energy.map(|part| {
            let lost = format!("the run made or lost {:.1} % of the energy that moved", 100.0 * part);
            match &outcome.estimate {
                // Steps that get so much of the energy wrong get the motion wrong.
                Ok(estimate) if estimate.relative < UNEXPLAINED * part => format!(
                    "{lost}, and a second, finer run comes to the same motion: no step or tolerance changes that, what the forces of the scene do and what its energy counts disagree; compare it in the other `coordinates`, and report it"
                ),
                _ => format!("{lost}: {change}"),
            }
        }),
        by_momentum.map(|part| format!("the run made or lost {:.1} % of the momentum that moved: {change}", 100.0 * part)),
        by_rounding.map(|part| {
            format!("rounding of positions makes {:.1} % of the forces: put the origin of the world near what moves", 100.0 * part)
        }),
        of_state.map(|it| {
            format!(
                "`{}` is {}, known to {} there, which makes {:.1} % of {}: let it stay small, set back by an event (`set: phase = phase - 2 * pi`), or take longer steps",
                it.state,
                format!("{} {}", plain(it.value, 3), it.unit).trim_end(),
                plain(it.apart, 2),
                100.0 * it.share,
                it.affected
            )
        }),
    ];
    let doubts: Vec<String> = doubts.into_iter().flatten().collect();
    (!doubts.is_empty()).then(|| format!("warning: {}: {}", scene.name, doubts.join("; ")))
}

/// What to say of positions with fewer digits than the tolerance asks for: the run is as exact as they are, and takes more steps than that needs.
#[must_use]
pub fn short_of_digits(scene: &Scene, plan: &RunPlan, outcome: &RunOutcome) -> Option<String> {
    let coarse = outcome.coarse.as_ref()?;
    let [rtol, _] = plan.options.method.tolerance()?;
    let follows = coarse.to_follow.as_ref();
    let follows = follows.map(|name| format!("declare `origin: follows {name};`"));
    // A tolerance that is looser than runs take is none.
    let looser = coarse.tolerance.map_or_else(
        || "take a fixed step".to_owned(),
        |tolerance| format!("take `--tol {}` or a larger one", plain(tolerance, 1)),
    );
    let remedy = follows.into_iter().chain([looser]).collect::<Vec<_>>();
    Some(format!(
        "warning: {}: a tolerance of {} asks for more digits than the positions of `{}` have, which are {} m apart at {} m from the origin: rounding decides how short steps are, and nothing is gained by them; {}",
        scene.name,
        plain(rtol, 3),
        coarse.part,
        plain(coarse.apart, 2),
        plain(coarse.distance, 3),
        remedy.join(", or "),
    ))
}
