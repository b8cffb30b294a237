//! The run itself: of a compiled model, or of the compiled equations of a scene, interpreted.

use std::time::Instant;

use mbd_campaign::Metrics;
use mbd_campaign::progress::ProgressLine;
use mbd_campaign::run::RunPlan;
use mbd_compiler::Interpreted;
use mbd_runtime::scene::{Scene, plain};
use mbd_runtime::{
    CoarsePositions, CoarseState, Content, Imbalance, MetricValue, Model, MomentumImbalance, Moved,
    Options, ParamError, PassedStop, RunError, Sampling, Simulation, Stop, Trajectory,
};

use super::estimate::{Estimate, Unestimated, estimate};

/// What a history holds.
pub(super) const CONTENT: Content = Content::ALL;

/// What a run gave, also when it stopped early.
#[derive(Clone, Debug)]
pub struct RunOutcome {
    /// The history up to the end or to the last accepted step.
    pub trajectory: Trajectory,
    /// Where the run stands [s].
    pub time: f64,
    /// Why it stopped before its end.
    pub error: Option<RunError>,
    /// The event that ended it.
    pub ended_by: Option<String>,
    /// What the start moved so that the joints hold, the largest distance first.
    pub moved: Vec<Moved>,
    /// The stops that the start is beyond.
    pub passed_stops: Vec<PassedStop>,
    /// Whether the start is a singular position of the joints.
    pub singular_start: bool,
    /// Energy that the run made or lost; `None` where it cannot be told.
    pub imbalance: Option<Imbalance>,
    /// Momentum that the run made or lost; `None` where the ground holds something, or nothing moved.
    pub momentum: Option<MomentumImbalance>,
    /// When what acts is hidden from fixed steps [s].
    pub hidden: Option<f64>,
    /// The most that rounding of positions made of forces.
    pub rounding: f64,
    /// Positions with fewer digits than the tolerance asks for.
    pub coarse: Option<CoarsePositions>,
    /// The angle or the declared state that has few digits left of what is read of it.
    pub coarse_state: Option<CoarseState>,
    /// The quantity that is off most, by a second, finer run, or why that is not told.
    pub estimate: Result<Estimate, Unestimated>,
    /// Metrics of a campaign file that the scene does not declare itself.
    pub besides: Vec<MetricValue>,
    /// What to say of those of them whose window reaches beyond its end.
    pub partial: Vec<String>,
    /// Time the run took on the clock [s].
    pub wall_s: f64,
}

/// Runs a scene as planned.
///
/// # Errors
/// Params that the scene cannot be run with. A run that stops early is an [`RunOutcome`] with its reason.
pub fn fly(
    scene: &Scene,
    plan: &RunPlan,
    progress: &mut ProgressLine,
) -> Result<RunOutcome, ParamError> {
    let model = Interpreted::<f64>::shared(scene.clone(), &plan.params)?;
    Ok(fly_model(&*model, plan, progress))
}

/// Runs a model as planned. A run that stops early has its reason.
#[must_use]
pub fn fly_model(
    model: &dyn Model<f64>,
    plan: &RunPlan,
    progress: &mut ProgressLine,
) -> RunOutcome {
    fly_measuring(model, plan, None, progress)
}

/// Runs a model as planned, and reads the metrics of a campaign, too.
pub fn fly_measuring(
    model: &dyn Model<f64>,
    plan: &RunPlan,
    metrics: Option<&Metrics>,
    progress: &mut ProgressLine,
) -> RunOutcome {
    let history = match metrics {
        // Those of the scene are among them.
        Some(metrics) => history(model, plan).measure(model, &metrics.readers()),
        None => history(model, plan),
    };
    let mut run = begun(model, plan);
    let begun = run.as_mut().map_err(|error| error.clone());
    let mut outcome = fly_on(begun, model, (plan, history), progress).outcome;
    if let Some(metrics) = metrics {
        let scene = [model.scene()];
        outcome.besides = metrics.besides(&scene, &outcome.trajectory);
        outcome.partial = metrics.partial_besides(&scene, &outcome.trajectory);
    }
    outcome.estimate = match (run, &outcome.error, plan.estimate) {
        (Ok(run), None, true) => estimate(model, plan, &outcome.trajectory, run.step_sizes()),
        (Ok(_), None, false) => Err(Unestimated::NotAsked),
        _ => Err(Unestimated::Stopped),
    };
    outcome
}

/// A run that may go on in another model.
pub(super) struct FlownPhase {
    /// What it gave; nothing is estimated.
    pub outcome: RunOutcome,
    /// Why it stands where it does.
    pub stop: Result<Stop, RunError>,
}

/// A run where its plan begins, which tells of its momentum.
pub(super) fn begun(model: &dyn Model<f64>, plan: &RunPlan) -> Result<Simulation<f64>, RunError> {
    let options = Options {
        momentum: true,
        ..plan.options
    };
    let mut run = Simulation::new(model, options)?;
    plan.begin(&mut run)?;
    Ok(run)
}

/// The history of a run as its plan says, without a row.
pub(super) fn history(model: &dyn Model<f64>, plan: &RunPlan) -> Trajectory {
    let sampling = plan.every.map_or(Sampling::Steps, Sampling::Every);
    Trajectory::new(model, sampling, CONTENT)
}

/// After so many steps of a run it is seen how many all of it will take.
const PACE: u64 = 5000;

/// What is said of a run that will not come to its end within its budget of steps, where it goes on as it did for so many steps until `now` [s].
fn out_of_reach(name: &str, plan: &RunPlan, steps: u64, now: f64) -> Option<String> {
    let all = steps as f64 * plan.until / now;
    let most = plan.options.max_steps;
    let rows = match plan.every {
        Some(_) => "",
        None => ", each of them a row of the history (`every` keeps fewer)",
    };
    (now > 0.0 && all > most as f64).then(|| {
        format!(
            "note: {name}: after {steps} steps the run is at {} s, so that about {} steps lead to its end at {} s, and it is given up after {most}{rows}: ask for an earlier end (`until`), or stop it",
            plain(now, 4),
            plain(all, 2),
            plain(plan.until, 4),
        )
    })
}

/// Flies a run of a model that has begun, until the end of its plan, into a history.
pub(super) fn fly_on(
    run: Result<&mut Simulation<f64>, RunError>,
    model: &dyn Model<f64>,
    (plan, mut trajectory): (&RunPlan, Trajectory),
    progress: &mut ProgressLine,
) -> FlownPhase {
    let started = Instant::now();
    let (mut time, mut moved, mut singular_start) = (0.0, Vec::new(), false);
    let mut passed_stops = Vec::new();
    let (mut imbalance, mut momentum, mut rounding) = (None, None, 0.0);
    let (mut hidden, mut coarse, mut coarse_state) = (None, None, None);
    let mut fly = |simulation: &mut Simulation<f64>| {
        let mut steps = 0;
        let mut watch = |now: f64| {
            steps += 1;
            let name = &model.scene().name;
            if steps == PACE
                && let Some(note) = out_of_reach(name, plan, steps, now)
            {
                progress.note(&note);
            }
            progress.show(now / plan.until, name);
            true
        };
        let stop = simulation.run_while(plan.until, Some(&mut trajectory), &mut watch);
        time = simulation.time();
        moved = simulation.start_moved().to_vec();
        passed_stops = simulation.starts_beyond_stops().to_vec();
        singular_start = simulation.starts_singular();
        (imbalance, rounding) = (simulation.imbalance(), simulation.rounding());
        hidden = simulation.hidden_from_steps();
        coarse = simulation.coarse_positions();
        coarse_state = simulation.coarse_state();
        momentum = simulation.momentum_imbalance();
        stop
    };
    let stop = run.and_then(&mut fly);
    progress.clear();
    let ended_by = match &stop {
        Ok(Stop::Event(event)) => model.scene().events.get(*event),
        _ => None,
    };
    let outcome = RunOutcome {
        ended_by: ended_by.map(|event| event.name.clone()),
        imbalance: imbalance.filter(|it| it.moved > 0.0),
        momentum: momentum.filter(|it| it.linear_moved + it.angular_moved > 0.0),
        rounding,
        coarse,
        coarse_state,
        hidden,
        estimate: Err(Unestimated::OfWhole),
        besides: Vec::new(),
        partial: Vec::new(),
        time,
        error: stop.as_ref().err().cloned(),
        moved,
        passed_stops,
        singular_start,
        wall_s: started.elapsed().as_secs_f64(),
        trajectory,
    };
    FlownPhase { outcome, stop }
}

#[cfg(test)]
mod tests {
    use mbd_campaign::run::Settings;

    use super::*;

    #[test]
    fn a_run_that_its_steps_will_not_bring_to_its_end_is_told_so_on_its_way() {
        let read = mbd_compiler::read_text("model A { gravity: none; point bob { mass: 1 kg } }");
        let settings = Settings {
            until: Some(toml::Value::String("1e12 s".into())),
            ..Settings::default()
        };
        let plan = RunPlan::new(&read.scene.unwrap(), &settings).unwrap();
        let note = out_of_reach("A", &plan, 5000, 154.85).unwrap();
        assert!(
            note.contains("about 3.2e13 steps lead to its end at 1e12 s")
                && note.contains("given up after 1000000, each of them a row"),
            "{note}"
        );
        assert_eq!(out_of_reach("A", &plan, 5000, 1e10), None);
        assert_eq!(out_of_reach("A", &plan, 5000, 0.0), None);
    }
}
