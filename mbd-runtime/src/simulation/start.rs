//! The start of a run: a state that can be used, nodes in balance, a mode for every line, a first step.

use mbd_scene::{Float, Model, NodeModel};

use super::moved::moved;
use super::{Pace, Simulation};
use crate::columns::{input_name, node_name, state_names};
use crate::compiled::Scalar;
use crate::error::{RunError, StepError};
use crate::integrate::Control;
use crate::locate::Chatter;
use crate::options::{Method, Options};
use crate::system::WORKS;
use crate::watch::Watch;

impl<T: Scalar> Simulation<T> {
    /// Sets time [s] and state x = [q | v | z]; `rate` nodes are placed by [`Simulation::start`] where z is all zero. Quaternions are normalised.
    ///
    /// # Errors
    /// A number that is not finite, a quaternion off unit length by more than 1e-3, or a wrong length.
    pub fn set_state(&mut self, time: f64, state: &[T]) -> Result<(), RunError> {
        T::give_state(self, time, state)
    }

    /// Gives positions of the nodes (3 each) to start their search from; those of `rate` nodes are taken as they are, whatever z is.
    ///
    /// # Errors
    /// A number that is not finite, or a wrong length.
    pub fn set_nodes(&mut self, guess: &[T]) -> Result<(), RunError> {
        T::give_nodes(self, guess)
    }

    /// Makes the start consistent: corrects bodies so that the joints hold (the state that was set chooses the branch), places the nodes, decides the
    /// mode of every line, evaluates the first rates. [`Simulation::run`] calls it when nobody has.
    ///
    /// # Errors
    /// Joints that cannot be satisfied together, or only on a branch they do not mean; no equilibrium of a node; rates that are not finite.
    pub fn start(&mut self) -> Result<(), RunError> {
        T::begin(self)
    }
}

impl<T: Float> Simulation<T> {
    /// What [`Simulation::set_state`] does.
    pub(crate) fn give_state(&mut self, time: f64, state: &[T]) -> Result<(), RunError> {
        let invalid = |slot: String, value: f64| StepError::InvalidInput { slot, value };
        let names = || state_names(self.system.model.scene(), self.system.model.layout());
        let cause = if state.len() != self.system.nx {
            Some(invalid(
                format!("length of the state (this model has {})", self.system.nx),
                state.len() as f64,
            ))
        } else if !time.is_finite() {
            Some(invalid("time".into(), time))
        } else if let Some(at) = state
            .iter()
            .position(|x| !x.is_finite() || x.to_f64().abs() > 1e150)
        {
            let name = names()
                .into_iter()
                .nth(at)
                .map_or_else(String::new, |name| name.name);
            Some(invalid(
                name,
                state.get(at).map_or(f64::NAN, |x| x.to_f64()),
            ))
        } else {
            None
        };
        if let Some(cause) = cause {
            return Err(self.failed(cause));
        }
        let mut fresh = state.to_vec();
        self.system.drift = self.system.normalise(&mut fresh);
        if self.system.drift > 1e-3 {
            let cause = invalid(
                "deviation of a quaternion from unit length".into(),
                self.system.drift,
            );
            return Err(self.failed(cause));
        }
        for (to, from) in self
            .state
            .iter_mut()
            .zip(fresh.into_iter().chain([T::zero(); WORKS]))
        {
            *to = from;
        }
        self.time = time;
        self.started = false;
        Ok(())
    }

    /// What [`Simulation::set_nodes`] does.
    pub(crate) fn give_nodes(&mut self, guess: &[T]) -> Result<(), RunError> {
        let expected = 3 * self.system.model.layout().nodes.len();
        let bad = guess.iter().find(|x| !x.is_finite());
        if guess.len() != expected || bad.is_some() {
            let value = bad.map_or(guess.len() as f64, |x| x.to_f64());
            let slot = format!("positions of the nodes ({expected} numbers)");
            return Err(self.failed(StepError::InvalidInput { slot, value }));
        }
        self.guess = Some(guess.to_vec());
        self.started = false;
        Ok(())
    }

    /// What [`Simulation::start`] does.
    pub(crate) fn begin(&mut self) -> Result<(), RunError> {
        self.started = true;
        self.origin = self.time;
        self.count = 0;
        self.watch = Watch::default();
        self.chatter = Chatter::new();
        self.stalled = f64::NAN;
        let started = self.consistent_start();
        started.map_err(|cause| {
            self.started = false;
            self.failed(cause)
        })
    }

    fn consistent_start(&mut self) -> Result<(), StepError> {
        let set = self.state.clone();
        let assembled = self.system.assemble(self.time, &mut self.state);
        let (model, nx) = (&self.system.model, self.system.nx);
        let scene = (model.scene(), model.layout());
        self.moved = moved(scene, &set[..nx], &self.state[..nx]);
        assembled?;
        self.system
            .start(self.time, &mut self.state, self.guess.as_deref())?;
        self.watch_weights = self.system.watch_weights(self.time, &self.state)?;
        self.method
            .begin(&mut self.system, self.time, 0.0, &self.state)?;
        self.system
            .check_conditioning(self.time, &self.state, self.method.first_mut())?;
        if let Pace::Adaptive(control, norm) = &mut self.pace {
            // The first step moves no block by more than a hundredth of its scale.
            let speed =
                norm.measure(self.method.first(), &self.state, &self.state) * norm.tolerance;
            let step = if speed > 0.0 { 0.01 / speed } else { 1e-3 };
            *control = Control::new(
                step.min(control.largest),
                control.largest,
                self.method.exponent,
            );
        }
        self.system.follow_angles(self.time, &self.state, true);
        self.begin_margins(&mut |_| ())
    }
}

/// Whether this combination of model, method and loads is offered.
pub(super) fn offered<T: Float>(
    model: &dyn Model<T>,
    options: &Options,
    supplies: bool,
) -> Result<(), StepError> {
    let (scene, layout) = (model.scene(), model.layout());
    if let (Some(point), Method::Tsit5 { .. }) = (stepwise(model), options.method) {
        return Err(StepError::Unsupported {
            what: format!(
                "an adaptive method with the `stepwise` node `{}`",
                node_name(scene, point)
            ),
            instead: "take Method::Rk4 with a fixed step, or declare the node `rate` or `static`"
                .into(),
        });
    }
    if layout.ni > 0 && !supplies {
        let names: Vec<String> = layout
            .inputs
            .iter()
            .map(|slots| input_name(scene, layout, slots.at))
            .collect();
        return Err(StepError::Unsupported {
            what: format!("a run without the inputs {}", names.join(", ")),
            instead: "give them: Simulation::with_loads(&model, options, loads)".into(),
        });
    }
    Ok(())
}

/// The first point with a `stepwise` node.
pub(super) fn stepwise<T: Float>(model: &dyn Model<T>) -> Option<usize> {
    let nodes = &model.layout().nodes;
    nodes
        .iter()
        .find(|node| matches!(node.model, NodeModel::Stepwise { .. }))
        .map(|node| node.point)
}
