//! Runs that come to several scenes: where an event lets another scene go on, that one flies from there.

use std::sync::Arc;

use mbd_runtime::scene::Scene;
use mbd_runtime::{Ended, Handover, Model, Progress, RunError, Simulation, StepError, Stop};

use super::names::PlanError;
use super::plan::{RunPlan, repeated};
use super::settings::Settings;

/// Scenes that let each other go on more often than this never come to an end.
const MOST: usize = 1000;

/// A scene that a run may come to.
#[derive(Clone)]
pub struct Phase {
    /// Its model; params of its runs take the place of those it has.
    pub model: Arc<dyn Model<f64>>,
    /// How it is run.
    pub settings: Settings,
    /// Per event of the scene the phase that goes on after it, by index; empty where none does.
    pub next: Vec<Option<usize>>,
}

impl Phase {
    /// A scene that flies alone.
    #[must_use]
    pub fn alone(model: Arc<dyn Model<f64>>, settings: Settings) -> Self {
        Phase {
            model,
            settings,
            next: Vec::new(),
        }
    }
}

/// Settings that count in every scene of a run, because somebody gave them beside those of the scenes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct GivenSettings {
    /// The method, the step or the tolerance.
    pub method: bool,
    /// How often a row is kept.
    pub every: bool,
    /// The most steps.
    pub max_steps: bool,
    /// Params, by name.
    pub params: Vec<String>,
    /// Inputs, by name.
    pub inputs: Vec<String>,
}

/// A run that begins, or goes on from another one.
pub struct GoingRun {
    /// Which phase it is of, by index.
    pub phase: usize,
    /// How it is flown, with the params it has.
    pub plan: RunPlan,
    /// It, begun.
    pub run: Simulation<f64>,
    /// What it took over; `None` of the first.
    pub handover: Option<Handover>,
}

/// How each scene is run whose first one has settings with what was given in them: as its own settings say, until the end of the first; method and tolerance
/// are those of the first where it says none, and what was given counts before both.
#[must_use]
pub fn settings_of_all(
    first: &Settings,
    given: &GivenSettings,
    scenes: &[(&Scene, &Settings)],
) -> Vec<Settings> {
    let later = scenes.get(1..).unwrap_or_default();
    let all = scenes.iter().enumerate();
    let settled = all.map(|(index, (scene, own))| {
        if index > 0 {
            return after(first, own, given, scene);
        }
        // What a later scene alone has is nothing of the first.
        let mut settings = first.clone();
        let of_later = |given: &[String], name: &str, has: HasName| {
            let mut later = later.iter();
            let given = given.iter().any(|given| given == name);
            !has(scene, name) && given && later.any(|(later, _)| has(later, name))
        };
        let params = &mut settings.params;
        params.retain(|name, _| !of_later(&given.params, name, has_param));
        let inputs = &mut settings.inputs;
        inputs.retain(|name, _| !of_later(&given.inputs, name, has_input));
        settings
    });
    settled.collect()
}

/// Whether a scene has something of a name.
type HasName = fn(&Scene, &str) -> bool;

fn has_param(scene: &Scene, name: &str) -> bool {
    scene.params.iter().any(|param| param.name == name)
}

fn has_input(scene: &Scene, name: &str) -> bool {
    scene.inputs.iter().any(|input| input.name == name) || !repeated(scene, name).is_empty()
}

/// The settings of a scene that goes on from one with the settings `first`: of its params and inputs those that were given count here, too.
fn after(first: &Settings, own: &Settings, given: &GivenSettings, scene: &Scene) -> Settings {
    let mut settings = own.clone();
    settings.until.clone_from(&first.until);
    if given.method {
        (settings.step, settings.tolerance, settings.method) = (None, None, None);
    }
    if given.every {
        settings.every = None;
    }
    if given.max_steps {
        settings.max_steps = None;
    }
    if settings.step.is_none() && settings.tolerance.is_none() && settings.method.is_none() {
        settings.step.clone_from(&first.step);
        settings.tolerance.clone_from(&first.tolerance);
        settings.method.clone_from(&first.method);
    }
    settings.every = settings.every.or_else(|| first.every.clone());
    settings.max_steps = settings.max_steps.or(first.max_steps);
    settings.estimate = Some(false);
    let tables = [
        (
            &mut settings.params,
            &first.params,
            &given.params,
            has_param as HasName,
        ),
        (
            &mut settings.inputs,
            &first.inputs,
            &given.inputs,
            has_input,
        ),
    ];
    for (table, first, given, has) in tables {
        let counts = |name: &String| given.contains(name) && has(scene, name);
        for (name, value) in first.iter().filter(|(name, _)| counts(name)) {
            table.insert(name.clone(), value.clone());
        }
    }
    settings
}

/// The run that goes on after an event, if one does; `plan_of` says how a phase is flown, by its index.
///
/// # Errors
/// A plan or params that the next scene cannot be run with; what a start may return; scenes that let each other go on without end.
pub fn go_on(
    phases: &[Phase],
    ended: Ended<'_>,
    plan_of: &dyn Fn(usize) -> Result<RunPlan, PlanError>,
) -> Result<Option<GoingRun>, RunError> {
    let Ended {
        run: last,
        model,
        event,
        before,
    } = ended;
    let goes_on = phases.get(model).and_then(|phase| *phase.next.get(event)?);
    let next = goes_on.and_then(|next| Some((next, phases.get(next)?)));
    let Some((index, next)) = next else {
        return Ok(None);
    };
    let scene = next.model.scene();
    let events = &last.model().scene().events;
    let name = events.get(event).map(|event| event.name.clone());
    let name = name.unwrap_or_default();
    let progress = Progress {
        time: last.time(),
        statistics: last.statistics(),
        ..Progress::default()
    };
    let failed = |cause: StepError| RunError {
        cause,
        progress: Box::new(progress),
    };
    if before + 1 >= MOST {
        return Err(failed(StepError::EventChatter {
            line: name,
            is_event: true,
            count: MOST,
            window: progress.time,
        }));
    }
    let unfit = |why: String| {
        failed(StepError::Action {
            event: name.clone(),
            time: progress.time,
            why: format!("`{}` cannot go on: {why}", scene.name),
        })
    };
    let mut plan = plan_of(index).map_err(|error| unfit(error.to_string()))?;
    last.params_after(event, scene, &mut plan.params)?;
    let own = next.model.with_params(&plan.params);
    let own = own.map_err(|error| unfit(error.to_string()))?;
    let mut run = Simulation::new(&*own, plan.options)?;
    plan.begin(&mut run)?;
    let handover = run.take_over_at(last, event, &plan.placed, &plan.held)?;
    // What is carried moves as it did before, not as this scene would begin alone.
    plan.moving.clear();
    plan.turning.clear();
    Ok(Some(GoingRun {
        phase: index,
        plan,
        run,
        handover: Some(handover),
    }))
}

/// Flies a run that has begun, and those that go on from it; `plan_of` says how a phase is flown, by its index, and `fly` flies one of them and tells why it stopped.
///
/// # Errors
/// Those of `fly`, and of [`go_on`].
pub fn fly_in_turn(
    phases: &[Phase],
    mut going: GoingRun,
    plan_of: &dyn Fn(usize) -> Result<RunPlan, PlanError>,
    fly: &mut dyn FnMut(&mut GoingRun) -> Result<Stop, RunError>,
) -> Result<(), RunError> {
    for before in 0.. {
        let Stop::Event(event) = fly(&mut going)? else {
            break;
        };
        let ended = Ended {
            run: &mut going.run,
            model: going.phase,
            event,
            before,
        };
        match go_on(phases, ended, plan_of)? {
            Some(next) => going = next,
            None => break,
        }
    }
    Ok(())
}

/// The names that every event maps after which a phase goes on: what they are there is never what is planned.
pub(crate) fn always_mapped(phases: &[Phase], place: usize) -> Vec<&str> {
    let events = phases.iter().flat_map(|phase| {
        let events = phase.model.scene().events.iter().zip(&phase.next);
        events.filter(|(_, next)| **next == Some(place))
    });
    let mut maps = events.map(|(event, _)| {
        let next = event.actions.next.iter();
        let names = next
            .flat_map(|next| &next.map)
            .map(|entry| entry.name.as_str());
        names.collect::<Vec<_>>()
    });
    let first = maps.next().unwrap_or_default();
    maps.fold(first, |mut all, names| {
        all.retain(|name| names.contains(name));
        all
    })
}
