//! A run through several scenes: where an event lets another scene go on, that one flies from there.

use std::sync::Arc;

use mbd_campaign::run::RunPlan;
use mbd_runtime::scene::Scene;
use mbd_runtime::{Handover, Model, ParamError, RunError, Simulation, StepError, Stop};

use super::outcome::{RunOutcome, fly_on};
use crate::progress::ProgressLine;

/// Scenes that let each other go on more often than this never come to an end.
const MOST: usize = 1000;

/// Makes a model with these params.
pub type Maker<'a> = dyn Fn(&[f64]) -> Result<Arc<dyn Model<f64>>, ParamError> + 'a;

/// A scene that a run may come to.
pub struct Phase<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// How it is flown; the end is that of the first phase.
    pub plan: RunPlan,
    /// Its model with these params.
    pub make: &'a Maker<'a>,
    /// Per event of the scene the phase that goes on after it, by index.
    pub next: Vec<Option<usize>>,
}

/// A part of a run, flown in one phase.
#[derive(Clone, Debug)]
pub struct Segment {
    /// Which phase, by index.
    pub phase: usize,
    /// How it was flown, with the params it had.
    pub plan: RunPlan,
    /// When it began [s].
    pub from: f64,
    /// What it took over; `None` of the first.
    pub handover: Option<Handover>,
    /// The event that ended it, by index in its scene.
    pub ended_by: Option<usize>,
    /// What came out.
    pub outcome: RunOutcome,
}

/// Flies the first phase, and what goes on from it, until the end that the first one plans.
#[must_use]
pub fn fly_phases(phases: &[Phase<'_>], progress: &mut ProgressLine) -> Vec<Segment> {
    let mut segments: Vec<Segment> = Vec::new();
    let mut last: Option<(Simulation<f64>, usize)> = None;
    let mut index = 0;
    let until = phases.first().map_or(0.0, |phase| phase.plan.until);
    while let Some(phase) = phases.get(index) {
        let mut plan = phase.plan.clone();
        plan.until = until;
        let from = last.as_ref().map_or(0.0, |(run, _)| run.time());
        let begun = match &mut last {
            Some((run, event)) => run.params_after(*event, phase.scene, &mut plan.params),
            None => Ok(()),
        };
        let made = begun.and_then(|()| {
            let made = (phase.make)(&plan.params);
            made.map_err(|error| unfit(phase, from, error.to_string()))
        });
        let model = match made {
            Ok(model) => model,
            Err(error) => {
                if let Some(segment) = segments.last_mut() {
                    segment.outcome.error = Some(error);
                }
                return segments;
            }
        };
        let mut handover = None;
        let flown = fly_on(&*model, &plan, progress, &mut |simulation| {
            if let Some((run, event)) = &mut last {
                handover = Some(simulation.take_over_at(run, *event, &plan.placed)?);
            }
            Ok(())
        });
        let mut outcome = flown.outcome;
        if outcome.trajectory.is_empty() {
            // It could not begin.
            outcome.time = from;
        }
        let (run, ended_by) = match flown.run {
            Some((run, Stop::Event(event))) => (Some(run), Some(event)),
            _ => (None, None),
        };
        segments.push(Segment {
            phase: index,
            from,
            handover,
            ended_by,
            outcome,
            plan,
        });
        let next = ended_by.and_then(|event| *phase.next.get(event)?);
        let (Some(run), Some(event), Some(next)) = (run, ended_by, next) else {
            return segments;
        };
        if segments.len() == MOST {
            let name = phase.scene.events.get(event);
            let endless = StepError::EventChatter {
                line: name.map_or_else(String::new, |event| event.name.clone()),
                count: MOST,
                window: run.time(),
            };
            if let Some(segment) = segments.last_mut() {
                segment.outcome.error = Some(failed(endless));
            }
            return segments;
        }
        (last, index) = (Some((run, event)), next);
    }
    segments
}

fn unfit(phase: &Phase<'_>, time: f64, why: String) -> RunError {
    failed(StepError::Action {
        event: phase.scene.name.clone(),
        time,
        why,
    })
}

fn failed(cause: StepError) -> RunError {
    RunError {
        cause,
        progress: Box::default(),
    }
}
