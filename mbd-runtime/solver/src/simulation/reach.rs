//! Why no step goes on where a motor drives a loop to a dead centre: accelerations grow beyond all bounds before it, and behind it joints come apart.

use mbd_scene::{Float, StartFrom, beyond_reach};

use super::ModelRun;
use crate::error::StepError;
use crate::laws::params_of;

/// How far ahead of the time that failed the motors are looked at, in parts of it: the loop is open there by far more than rounding.
const AHEAD: f64 = 1e-6;

impl<T: Float> ModelRun<T> {
    /// The motors that have driven a loop as far as it reaches, where a run ended for what looks like a step, rows or a tolerance.
    #[cold]
    pub(super) fn beyond_reach(&self, cause: &StepError) -> Option<StepError> {
        let time = match *cause {
            StepError::JointsApart { time, .. }
            | StepError::SingularConstraints { time, .. }
            | StepError::StepCollapse { time, .. }
            | StepError::UnstableStep { time, .. } => time,
            _ => return None,
        };
        let model = &self.system.model;
        let (params, inputs) = (params_of(model.params()), self.inputs_now());
        let at = |time| StartFrom::new(&params, time).with_inputs(&inputs);
        let state: Vec<f64> = self.system.in_world(self.time, &self.state).collect();
        let times = [at(self.time), at(time + AHEAD * time.abs())];
        let reached = beyond_reach(model.scene(), model.layout(), times, &state)?;
        Some(StepError::BeyondReach {
            time,
            motors: reached.motors,
            joint: reached.joint,
        })
    }
}
