//! A run through several scenes: where an event lets another scene go on, that one flies from there.

use mbd_campaign::phases::FlownPart;
use mbd_campaign::progress::ProgressLine;
use mbd_campaign::run::{Phase, RunPlan, go_on};
use mbd_runtime::{Ended, Handover, Options, Stop};

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

/// Flies the first phase, whose model has the params of its plan, and what goes on from it, until the end that the first one plans.
#[must_use]
pub fn fly_phases(
    phases: &[Phase],
    plans: &[RunPlan],
    progress: &mut ProgressLine,
) -> Vec<Segment> {
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
    let until = plan.until;
    let (mut phase, mut plan, mut handover) = (0, told(plan), None);
    let mut next = begun(&*first.model, &plan);
    let mut from = 0.0;
    loop {
        let model = &phases.get(phase).unwrap_or(first).model;
        plan.until = until;
        let flown = fly_on(next, &**model, (&plan, history(&**model, &plan)), progress);
        let (mut run, ended_by) = match flown.run {
            Some((run, Stop::Event(event))) => (Some(run), Some(event)),
            _ => (None, None),
        };
        segments.push(Segment {
            phase,
            from,
            handover,
            ended_by,
            outcome: flown.outcome,
            plan,
        });
        let (Some(run), Some(event)) = (&mut run, ended_by) else {
            return segments;
        };
        let ended = Ended {
            run,
            model: phase,
            event,
            before: segments.len() - 1,
        };
        let of = |index: usize| Ok(told(plans.get(index).unwrap_or(&segments[0].plan)));
        match go_on(phases, ended, &of) {
            Ok(None) => return segments,
            Ok(Some(goes)) => {
                from = goes.run.time();
                (phase, plan, handover) = (goes.phase, goes.plan, Some(goes.handover));
                next = Ok(goes.run);
            }
            Err(error) => {
                if let Some(segment) = segments.last_mut() {
                    segment.outcome.error = Some(error);
                }
                return segments;
            }
        }
    }
}
