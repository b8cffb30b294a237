//! The linear system about where a run stands.

use mbd_scene::Float;

use super::ModelRun;
use crate::linearise::{LinearisationError, StateSpace};

impl<T: Float> ModelRun<T> {
    /// What [`Simulation::linearise`] does.
    pub(crate) fn space_here(&mut self, along: &[&str]) -> Result<StateSpace, LinearisationError> {
        let supplied = self.whole(|run| {
            let supplied = run.system.supply(run.time, &run.state);
            supplied.map_err(|cause| run.failed(cause))
        });
        supplied.map_err(|error| LinearisationError::Inputs(Box::new(error.cause)))?;
        let state: Vec<f64> = self.system.in_world(self.time, &self.state).collect();
        let wide = |list: &[T]| -> Vec<f64> { list.iter().map(|x| x.to_f64()).collect() };
        let inputs = wide(&self.system.inputs);
        let layout = self.system.model.layout();
        let unknowns = self.system.nodes.nodes();
        let unknowns: Vec<f64> = self.system.nodes_in_world(self.time, unknowns).collect();
        let nodes = layout.node_positions(&state, &unknowns);
        let remembered = self.system.remembered();
        let here = (
            self.time,
            state.get(..self.system.nx).unwrap_or_default(),
            &inputs[..],
        );
        StateSpace::make(
            &*self.system.model,
            here,
            Some((&nodes, &remembered)),
            along,
        )
    }
}
