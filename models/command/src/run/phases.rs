//! A run through several scenes: where an event lets another scene go on, that one flies from there.

use mbd_campaign::phases::FlownPart;
use mbd_campaign::progress::ProgressLine;
use mbd_campaign::run::{GoingRun, Phase, RunPlan, fly_in_turn};
use mbd_runtime::{Handover, Options, StepSizes, Stop};

use super::estimate::{Estimate, Unestimated, estimate_phases};
use super::outcome::{RunOutcome, begun, fly_on, history};

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
    /// How long its steps were.
    pub sizes: StepSizes,
    /// What came out.
    pub outcome: RunOutcome,
}

impl Segment {
    /// It, as it is told.
    #[must_use]
    pub fn told<'s>(&'s self, phase: &'s Phase) -> FlownPart<'s> {
        FlownPart {
            scene: phase.model.scene(),
            from: self.from,
            until: self.outcome.time,
            handover: self.handover.as_ref(),
            ended_by: self.ended_by,
        }
    }
}

/// A run through several scenes.
#[derive(Clone, Debug)]
pub struct PhasedRun {
    /// Its parts, in order.
    pub segments: Vec<Segment>,
    /// The quantity of all of it that is off most, by a second, finer run, or why that is not told.
    pub estimate: Result<Estimate, Unestimated>,
}

/// Flies the first phase, whose model has the params of its plan, and what goes on from it, until the end that the first one plans, and again with finer steps.
#[must_use]
pub fn fly_phases(phases: &[Phase], plans: &[RunPlan], progress: &mut ProgressLine) -> PhasedRun {
    let segments = fly_segments(phases, plans, progress);
    let stopped = segments.last().is_none_or(|it| it.outcome.error.is_some());
    let asked = plans.first().is_some_and(|plan| plan.estimate);
    PhasedRun {
        estimate: match (stopped, asked) {
            (true, _) => Err(Unestimated::Stopped),
            (false, false) => Err(Unestimated::NotAsked),
            (false, true) => estimate_phases(phases, plans, &segments),
        },
        segments,
    }
}

fn fly_segments(phases: &[Phase], plans: &[RunPlan], progress: &mut ProgressLine) -> Vec<Segment> {
    let mut segments: Vec<Segment> = Vec::new();
    let (Some(first), Some(plan)) = (phases.first(), plans.first()) else {
        return segments;
    };
    // What a run tells of itself asks for its momentum.
    let told = |plan: &RunPlan| RunPlan {
        options: Options {
            momentum: true,
            ..plan.options
        },
        ..plan.clone()
    };
    let (until, plan) = (plan.until, told(plan));
    let of = |index: usize| Ok(told(plans.get(index).unwrap_or(&plan)));
    let flown = begun(&*first.model, &plan).and_then(|run| {
        let begun = GoingRun {
            phase: 0,
            plan: plan.clone(),
            run,
            handover: None,
        };
        fly_in_turn(phases, begun, &of, &mut |going| {
            let model = &phases.get(going.phase).unwrap_or(first).model;
            let plan = RunPlan {
                until,
                ..going.plan.clone()
            };
            let (from, history) = (going.run.time(), history(&**model, &plan));
            let flown = fly_on(Ok(&mut going.run), &**model, (&plan, history), progress);
            segments.push(Segment {
                phase: going.phase,
                plan,
                from,
                handover: going.handover.clone(),
                ended_by: match flown.stop {
                    Ok(Stop::Event(event)) => Some(event),
                    _ => None,
                },
                sizes: going.run.step_sizes().clone(),
                outcome: flown.outcome,
            });
            flown.stop
        })
    });
    match (flown, segments.last_mut()) {
        (Ok(()), _) => {}
        (Err(error), Some(segment)) => segment.outcome.error = Some(error),
        (Err(error), None) => {
            let history = history(&*first.model, &plan);
            let unflown = fly_on(Err(error), &*first.model, (&plan, history), progress);
            segments.push(Segment {
                phase: 0,
                plan,
                from: 0.0,
                handover: None,
                ended_by: None,
                sizes: StepSizes::default(),
                outcome: unflown.outcome,
            });
        }
    }
    segments
}
