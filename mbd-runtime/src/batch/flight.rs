//! One case of a batch, flown: a fresh run of its own, so that nothing of one case is seen by another.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::Instant;

use mbd_scene::Model;

use super::case::{Case, Failed, Finished, Why};
use crate::compiled::Scalar;
use crate::error::{RunError, Statistics, StepError};
use crate::options::Options;
use crate::simulation::Simulation;
use crate::trajectory::Trajectory;

/// What the caller does with a fresh run before it begins.
pub(super) type Prepare<'b, T> =
    Box<dyn Fn(&Case<T>, &mut Simulation<T>) -> Result<(), RunError> + Sync + 'b>;

/// What all cases of a batch share.
pub(super) struct Flights<'b, T: Scalar> {
    pub model: Arc<dyn Model<T>>,
    pub options: Options,
    pub until: f64,
    pub prepare: Option<Prepare<'b, T>>,
}

impl<T: Scalar> Flights<'_, T> {
    /// Flies a case, and lets `judge` make something of its history; `None` where `go_on` said no.
    pub fn fly<R>(
        &self,
        case: &Case<T>,
        history: &mut Trajectory,
        judge: &impl Fn(&Case<T>, &Trajectory) -> R,
        go_on: &mut dyn FnMut(f64) -> bool,
    ) -> Option<Finished<R, T>> {
        let clock = Instant::now();
        history.clear();
        let mut run = None;
        let flown = catch_unwind(AssertUnwindSafe(|| {
            self.run(case, &mut run, history, go_on)?;
            Ok(judge(case, history))
        }));
        let result = match flown {
            Ok(result) => result,
            Err(words) => Err(Why::Panic(spoken(&*words))),
        };
        if let Err(Why::Run(error)) = &result
            && error.cause == StepError::Cancelled
        {
            return None;
        }
        let statistics = run
            .as_ref()
            .map_or(Statistics::default(), |run| run.statistics());
        let result = result.map_err(|why| Failed {
            why,
            time: run.as_ref().map_or(f64::NAN, Simulation::time),
            state: run.map_or(Vec::new(), |run| run.state().to_vec()),
        });
        Some(Finished {
            case: case.number,
            result,
            statistics,
            seconds: clock.elapsed().as_secs_f64(),
        })
    }

    /// Begins and runs a case; `run` keeps it, also where it stops.
    fn run(
        &self,
        case: &Case<T>,
        run: &mut Option<Simulation<T>>,
        history: &mut Trajectory,
        go_on: &mut dyn FnMut(f64) -> bool,
    ) -> Result<(), Why> {
        let own = match &case.params {
            Some(params) => self.model.with_params(params).map_err(Why::Params)?,
            None => self.model.clone(),
        };
        let fresh = Simulation::new(&*own, self.options).map_err(Why::Run)?;
        let run = run.insert(fresh);
        self.begin(case, run).map_err(Why::Run)?;
        let flown = run.run_while(self.until, Some(history), go_on);
        flown.map(|_| ()).map_err(Why::Run)
    }

    fn begin(&self, case: &Case<T>, run: &mut Simulation<T>) -> Result<(), RunError> {
        if let Some((time, state)) = &case.state {
            run.set_state(*time, state)?;
        }
        if !case.joints.is_empty() {
            let joints = case.joints.iter();
            let joints: Vec<(&str, f64)> = joints.map(|(name, x)| (name.as_str(), *x)).collect();
            run.set_joints(&joints)?;
        }
        if let Some(nodes) = &case.nodes {
            run.set_nodes(nodes)?;
        }
        if let Some(inputs) = &case.inputs {
            T::give_inputs(run, inputs.of, &inputs.numbers)?;
        }
        match &self.prepare {
            Some(prepare) => prepare(case, run),
            None => Ok(()),
        }
    }
}

/// The words of a panic.
fn spoken(words: &(dyn Any + Send)) -> String {
    let text = words.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = text.or_else(|| words.downcast_ref::<String>().cloned());
    text.unwrap_or_else(|| "without words".to_owned())
}
