//! A case flown again, with everything in its history.

use std::ops::ControlFlow;
use std::sync::Arc;

use mbd_runtime::scene::Scene;
use mbd_runtime::{
    Content, Handover, MetricValue, MissingMetric, Model, RunError, Sampling, Simulation,
    StepSizes, Stop, Trajectory,
};

use super::{Campaign, Resources};
use crate::columns;
use crate::phases::FlownPart;
use crate::results::CaseRow;
use crate::run::names::wrong;
use crate::run::{GoingRun, PlanError, RunPlan, fly_in_turn};

/// What one case takes.
const ALONE: Resources = Resources {
    threads: 1,
    lanes: Some(1),
};

impl Campaign {
    /// Runs one case again, with everything in its history. The row is that of the campaign, to the bit.
    ///
    /// # Errors
    /// There is no such case.
    pub fn replay(&self, case: u64) -> Result<(CaseRow, Trajectory), PlanError> {
        let (row, parts) = self.replay_parts(case)?;
        Ok((row, self.whole(&parts)))
    }

    /// Runs one case again: its row, and the scenes that its run came to; none where it could not begin.
    pub(crate) fn replay_parts(&self, case: u64) -> Result<(CaseRow, Vec<CasePart>), PlanError> {
        self.check(case)?;
        let mut found = None;
        self.run(1, &|_| case, ALONE, |flown| {
            found = Some(flown.row);
            ControlFlow::Break(())
        });
        let row = found.ok_or_else(|| wrong("case", "its run was cancelled"))?;
        let mut parts = Vec::new();
        // What stops the run stands in the row.
        let _ = self.fly(case, &mut parts);
        Ok((row, parts))
    }

    /// The metrics of a case that none of its scenes declares, as a run tells its own, and a sentence on each of which only a part of its window was flown.
    ///
    /// # Errors
    /// There is no such case.
    pub fn besides(&self, case: u64) -> Result<(Vec<MetricValue>, Vec<String>), PlanError> {
        self.check(case)?;
        let scenes: Vec<&Scene> = self.phases.iter().map(|it| it.model.scene()).collect();
        let judge = |history: &Trajectory| {
            let partial = self.metrics.partial_besides(&scenes, history);
            (self.metrics.besides(&scenes, history), partial)
        };
        // A run that stops early has none: what it did not reach may have changed each of them.
        let nothing = Trajectory::new(&*self.model, Sampling::Steps, Content::TIME);
        let mut found = (self.metrics.besides(&scenes, &nothing), Vec::new());
        for metric in &mut found.0 {
            metric.value = Err(MissingMetric::StoppedEarly);
        }
        self.judged((1, &|_| case), ALONE, judge, |finished| {
            if let Ok(told) = finished.result {
                found = told;
            }
            ControlFlow::Break(())
        });
        Ok(found)
    }

    /// The history of a case over all of its parts.
    pub(crate) fn whole(&self, parts: &[CasePart]) -> Trajectory {
        let models: Vec<&dyn Model<f64>> = self.phases.iter().map(|it| &*it.model).collect();
        match parts {
            [alone] if models.len() == 1 => alone.history.clone(),
            [] if models.len() == 1 => Trajectory::new(&*self.model, Sampling::Steps, Content::ALL),
            parts => {
                let parts = parts.iter().map(|part| (part.phase, &part.history));
                columns::joined(&models, Content::ALL).join(&parts.collect::<Vec<_>>())
            }
        }
    }

    /// How long the steps of a case are, in each scene that it comes to; of one that stops early as far as it came.
    pub(super) fn step_sizes(&self, case: u64) -> Vec<StepSizes> {
        let mut sizes = Vec::new();
        // What stops the run is told with its row.
        let _ = self.fly_parts(case, &mut |going| {
            let stop = going.run.run(self.nominal.until);
            sizes.push(going.run.step_sizes().clone());
            stop
        });
        sizes
    }

    fn fly(&self, case: u64, parts: &mut Vec<CasePart>) -> Result<(), RunError> {
        self.fly_parts(case, &mut |going| {
            let mut part = CasePart::new(going);
            let stop = going.run.record(self.nominal.until, &mut part.history);
            part.until = going.run.time();
            if let Ok(Stop::Event(event)) = stop {
                part.ended_by = Some(event);
            }
            parts.push(part);
            stop
        })
    }

    /// Flies a case, each scene that it comes to by `fly`; one that cannot begin is not flown.
    fn fly_parts(
        &self,
        case: u64,
        fly: &mut dyn FnMut(&mut GoingRun) -> Result<Stop, RunError>,
    ) -> Result<(), RunError> {
        let begun = self.plan(case).ok().and_then(|plan| {
            let model = self.model.with_params(&plan.params).ok()?;
            Some((model, plan))
        });
        let Some((model, plan)) = begun else {
            return Ok(());
        };
        let mut run = Simulation::new(&*model, plan.options)?;
        plan.begin(&mut run)?;
        let first = GoingRun {
            phase: 0,
            plan,
            run,
            handover: None,
        };
        fly_in_turn(&self.phases, first, &|phase| self.plan_in(case, phase), fly)
    }
}

/// A part of a case, flown in one scene.
pub(crate) struct CasePart {
    /// Which phase, by index.
    pub phase: usize,
    /// How it was flown, with the params it had.
    pub plan: RunPlan,
    /// The model, with these params.
    pub model: Arc<dyn Model<f64>>,
    /// When it began and where it stands [s].
    pub from: f64,
    pub until: f64,
    /// What it took over; `None` of the first.
    pub handover: Option<Handover>,
    /// The event that ended it, by index in its scene.
    pub ended_by: Option<usize>,
    /// Everything in it.
    pub history: Trajectory,
}

impl CasePart {
    /// A part that begins where its run stands.
    fn new(going: &GoingRun) -> Self {
        let GoingRun { plan, run, .. } = going;
        let model = run.model().clone();
        let sampling = plan.every.map_or(Sampling::Steps, Sampling::Every);
        CasePart {
            phase: going.phase,
            history: Trajectory::new(&*model, sampling, Content::ALL),
            plan: plan.clone(),
            model,
            from: run.time(),
            until: run.time(),
            handover: going.handover.clone(),
            ended_by: None,
        }
    }

    /// It, as it is told.
    pub fn told(&self) -> FlownPart<'_> {
        FlownPart {
            scene: self.model.scene(),
            from: self.from,
            until: self.until,
            handover: self.handover.as_ref(),
            ended_by: self.ended_by,
        }
    }
}
