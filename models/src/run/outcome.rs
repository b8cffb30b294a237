//! The run itself: of a compiled model, or of the compiled equations of a scene, interpreted.

use std::time::Instant;

use mbd_compiler::Interpreted;
use mbd_runtime::scene::Scene;
use mbd_runtime::{Content, Model, Moved, ParamError, RunError, Sampling, Simulation, Trajectory};

use super::plan::Plan;
use crate::progress::Progress;

/// What a run gave, also when it stopped early.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The history up to the end or to the last accepted step.
    pub trajectory: Trajectory,
    /// Where the run stands [s].
    pub time: f64,
    /// Why it stopped before its end.
    pub error: Option<RunError>,
    /// What the start moved so that the joints hold, the largest distance first.
    pub moved: Vec<Moved>,
    /// Time the run took on the clock [s].
    pub wall_s: f64,
}

/// Runs a scene as planned.
///
/// # Errors
/// Params that the scene cannot be run with. A run that stops early is an [`Outcome`] with its reason.
pub fn fly(scene: &Scene, plan: &Plan, progress: &mut Progress) -> Result<Outcome, ParamError> {
    let model = Interpreted::<f64>::new(scene.clone(), &plan.params)?;
    Ok(fly_model(&model, plan, progress))
}

/// Runs a model as planned. A run that stops early has its reason.
#[must_use]
pub fn fly_model(model: &dyn Model<f64>, plan: &Plan, progress: &mut Progress) -> Outcome {
    let sampling = plan.every.map_or(Sampling::Steps, Sampling::Every);
    let mut trajectory = Trajectory::new(model, sampling, Content::ALL);
    let started = Instant::now();
    let (mut time, mut moved) = (0.0, Vec::new());
    let mut run = || {
        let mut simulation = Simulation::new(model, plan.options)?;
        plan.begin(&mut simulation)?;
        let mut watch = |now: f64| {
            progress.show(now / plan.until, &model.scene().name);
            true
        };
        let stop = simulation.run_while(plan.until, Some(&mut trajectory), &mut watch);
        time = simulation.time();
        moved = simulation.start_moved().to_vec();
        stop
    };
    let error = run().err();
    progress.clear();
    Outcome {
        time,
        error,
        moved,
        wall_s: started.elapsed().as_secs_f64(),
        trajectory,
    }
}
