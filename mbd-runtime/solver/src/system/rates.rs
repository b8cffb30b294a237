//! A model as a system of ordinary differential equations: the rates of a stage, their derivatives, and the way back onto the joints.

use mbd_scene::{Float, Node, NodeModel, Quantity, StageInputs};

use super::{System, stage};
use crate::columns::state_names;
use crate::error::{Source, StepError};
use crate::integrate::{INNER, Made, Rates, fastest};
use crate::linearise::{Jacobian, LinearisationError};
use crate::list::all_finite;
use crate::trajectory::told_apart;

/// Of longer states no matrix is made for a message.
const MOST_STATES: usize = 500;

impl<T: Float> System<T> {
    /// A derivative of the rates that is not finite: the first of them, by name.
    #[cold]
    fn no_slope(&self, time: f64, by_state: &[T], by_time: &[T]) -> StepError {
        let names = state_names(self.model.scene(), self.model.layout());
        let name = |index: usize| {
            let name = names.get(index);
            name.map_or_else(|| "work".to_owned(), |name| name.name.clone())
        };
        let columns = by_time.len().max(1);
        let fault = |list: &[T]| list.iter().position(|x| !x.is_finite());
        let (rate, by) = match fault(by_state) {
            Some(at) => (name(at / columns), name(at % columns)),
            None => {
                let at = fault(by_time).unwrap_or_default();
                (name(at), "time".to_owned())
            }
        };
        StepError::NonFinite {
            time,
            source: Source::Jacobian { rate, by },
        }
    }

    /// The largest rate of the linear system at an accepted state [1/s]; `None` where it has none that counts.
    #[cold]
    pub(crate) fn fastest_rate(&mut self, time: f64, state: &[T]) -> Option<f64> {
        let nodes = &self.model.layout().nodes;
        let by_steps = |node: &Node| matches!(node.model, NodeModel::Stepwise { .. });
        if self.nx > MOST_STATES || nodes.iter().any(by_steps) {
            return None;
        }
        let state = state.get(..self.nx).unwrap_or_default();
        self.supply(time, state).ok()?;
        let mut jacobian = Jacobian::new(&*self.model, false);
        let mut by_state = vec![T::zero(); self.nx * self.nx];
        let mut by_time = vec![T::zero(); self.nx];
        let at = self.nodes.at(T::from_f64(time), state, &self.inputs);
        let out = (&mut by_state[..], &mut by_time[..]);
        let found = jacobian.evaluate(&*self.model, &at, &mut self.work, out);
        found.ok()?;
        let (weights, mut x) = (vec![T::one(); self.nx], vec![T::zero(); self.nx]);
        let rate = fastest(&by_state, &weights, &mut x, &mut by_time);
        (rate > 0.0 && rate.is_finite()).then_some(rate)
    }

    #[cold]
    fn not_finite(&self, time: f64, index: usize) -> StepError {
        let names = state_names(self.model.scene(), self.model.layout());
        let name = names
            .into_iter()
            .nth(index)
            .map_or_else(|| "work".into(), |name| name.name);
        StepError::NonFinite {
            time,
            source: Source::State(name),
        }
    }
}

impl<T: Float> System<T> {
    /// Whether the derivatives of the rates are a partial derivative of the model and nothing else.
    pub(crate) fn differentiates_plainly(&self) -> bool {
        let jacobian = self.jacobian.as_ref();
        jacobian.is_some_and(|jacobian| jacobian.is_plain())
    }

    /// Puts the end of a step back on the joints, and decides how the rows of the step after it are solved.
    fn end_on_joints(&mut self, time: f64, state: &mut [T]) -> Result<(), StepError> {
        self.stay(time, state)?;
        let own = state.get(..self.nx).unwrap_or_default();
        self.measure(time, own);
        if self.changes_rows(time, own) {
            self.stay(time, state)?;
        }
        let own = state.get(..self.nx).unwrap_or_default();
        self.measure(time, own);
        self.pick(time, own);
        Ok(())
    }

    /// The rates of a scene that is nothing but a state, inputs and modes.
    #[inline]
    fn derivative_as_rates(
        &mut self,
        time: f64,
        state: &[T],
        out: &mut [T],
    ) -> Result<(), StepError> {
        let time = time.min(self.latest);
        self.supply(time, state)?;
        self.nodes.hold_once(&self.memory);
        let at = self
            .nodes
            .at_no_node(T::from_f64(time), state, &self.inputs);
        self.model
            .evaluate(Quantity::Derivative, &at, &mut self.work, out);
        self.counters.rhs = self.counters.rhs.saturating_add(1);
        match all_finite(out) {
            true => Ok(()),
            false => Err(self.fault(time, state, out)),
        }
    }

    /// Whether the rates inside a step are those of the model at a state, its inputs, and modes that are held, whatever is made of them at its end.
    #[inline]
    fn takes_inner_stages(&self) -> bool {
        let solved = !self.projection.any() || self.solves_as_emitted();
        let shown = !self.has_functions() || self.following.is_none();
        self.takes_rates && solved && shown && self.latest == f64::INFINITY
    }

    /// The rates of a scene of any kind.
    fn rates_of_any(
        &mut self,
        time: f64,
        span: f64,
        state: &[T],
        out: &mut [T],
    ) -> Result<(), StepError> {
        let state = state.get(..self.nx).unwrap_or_default();
        let time = time.min(self.latest);
        self.supply(time, state)?;
        let stage = stage(&*self.model, time, state, &self.inputs);
        let (derivative, works) = out.split_at_mut(self.nx.min(out.len()));
        let solved = self.nodes.differentiate(
            stage,
            T::from_f64(span),
            &self.memory,
            &mut self.work,
            derivative,
        );
        if let Err(error) = solved {
            return Err(self.node_error(time, error));
        }
        self.counters.rhs = self.counters.rhs.saturating_add(1);
        if self.projection.any() {
            self.accelerate(time, state, derivative)?;
            self.pull_back(time, state, derivative)?;
        }
        if !works.is_empty() {
            self.read_energy(time, state);
            for (work, power) in works.iter_mut().zip(self.energy.iter().skip(3)) {
                *work = *power;
            }
        }
        match (all_finite(out), self.may_jump()) {
            (true, false) => Ok(()),
            (true, true) => self.keep_before(time, span, state, out),
            (false, _) => Err(self.fault(time, state, out)),
        }
    }

    /// Rates that are not finite: why, or the first of them.
    #[cold]
    fn fault(&mut self, time: f64, state: &[T], rates: &[T]) -> StepError {
        let fault = rates.iter().position(|x| !x.is_finite());
        if let Some(source) = self.without_number(time, state) {
            return StepError::NonFinite { time, source };
        }
        self.unsolvable(time, state)
            .unwrap_or_else(|| self.not_finite(time, fault.unwrap_or_default()))
    }
}

impl<T: Float> Rates<T> for System<T> {
    #[inline]
    fn rates(&mut self, time: f64, span: f64, state: &[T], out: &mut [T]) -> Result<(), StepError> {
        match self.takes_derivative {
            true => self.derivative_as_rates(time, state, out),
            false => self.rates_of_any(time, span, state, out),
        }
    }

    #[inline]
    fn stages_at_once(
        &mut self,
        span: [f64; 2],
        state: &[T],
        out: (&mut [T], &mut [T]),
        to_end: bool,
    ) -> Made {
        if !self.takes_inner_stages() {
            return Made::Nothing;
        }
        let functions = self.has_functions();
        let memory = &self.memory;
        let held = stage(&*self.model, span[0], state, &self.held);
        let mut inputs = functions.then(|| {
            self.controls
                .functions(&*self.model, &self.held, &mut self.inputs)
        });
        let supplied = inputs
            .as_mut()
            .map(|inputs| inputs as &mut dyn StageInputs<T>);
        // Functions are asked at the end itself, which may stand on joints.
        let alone = to_end && !functions && !self.projection.any();
        let mut drift = f64::NAN;
        let end = alone.then_some((&self.quaternions[..], &mut drift));
        let start = (held, supplied);
        let made = self
            .nodes
            .make_stages(start, span, memory, &mut self.work, out, end);
        if inputs.is_some_and(|inputs| !inputs.finite) {
            return Made::Nothing;
        }
        let stages = match made {
            Made::Nothing => return made,
            Made::Inside | Made::End => INNER,
            Made::Whole => INNER + 1,
        };
        if made != Made::Inside {
            (self.drift, self.fallback.margin) = (drift, f64::NAN);
        }
        self.counters.rhs = self.counters.rhs.saturating_add(stages as u64);
        self.nodes.count_solves(INNER);
        made
    }

    fn rates_inside(
        &mut self,
        time: f64,
        span: f64,
        state: &[T],
        out: &mut [T],
    ) -> Result<(), StepError> {
        // The nodes of the end of the step stay where they are, and its rows as they were picked.
        std::mem::swap(&mut self.nodes, &mut self.probe);
        let end = self.fallback.leave_end();
        self.nodes.enter(&self.memory);
        let found = self.rates(time, span, state, out);
        self.fallback.come_back(end);
        std::mem::swap(&mut self.nodes, &mut self.probe);
        found
    }

    fn differentiate(
        &mut self,
        time: f64,
        state: &[T],
        by_state: &mut [T],
        by_time: &mut [T],
    ) -> Result<(), StepError> {
        if self.takes_other_rows() {
            return self.differentiate_anew(time, state, by_state, by_time);
        }
        // As its rates are: on the far side of what jumps where a step begins.
        let time = match self.jumps_at(time) {
            true => time + told_apart::<T>(time),
            false => time,
        };
        let state = state.get(..self.nx).unwrap_or_default();
        self.supply(time, state)?;
        let Some(jacobian) = &mut self.jacobian else {
            return Ok(());
        };
        let at = self.nodes.at(T::from_f64(time), state, &self.inputs);
        self.counters.jacobians = self.counters.jacobians.saturating_add(1);
        let found = jacobian.evaluate(&*self.model, &at, &mut self.work, (by_state, by_time));
        match found {
            Ok(()) if all_finite(by_state) && all_finite(by_time) => Ok(()),
            Ok(()) => Err(self.no_slope(time, by_state, by_time)),
            Err(LinearisationError::DependentRows { .. }) => Err(self.singular(time, state)),
            // The rates themselves have a value here, their equations have none.
            Err(_) => Err(self
                .unsolvable(time, state)
                .unwrap_or_else(|| self.singular(time, state))),
        }
    }

    #[cold]
    fn differentiate_again(
        &mut self,
        time: f64,
        state: &[T],
        (by_state, by_time): (&mut [T], &mut [T]),
    ) -> Result<(), StepError> {
        let counted = self.counters;
        let found = self.differentiate(time, state, by_state, by_time);
        self.counters = counted;
        found
    }

    fn factored(&mut self) {
        self.counters.factors = self.counters.factors.saturating_add(1);
    }

    #[inline]
    fn enter(&mut self) {
        self.fallback.enter();
        self.nodes.enter(&self.memory);
    }

    #[inline]
    fn hold(&mut self, nothing_changes: bool) {
        self.nodes.keep(nothing_changes);
    }

    #[inline]
    fn project_end(&mut self, time: f64, state: &mut [T]) -> Result<(), StepError> {
        let time = time.min(self.latest);
        self.drift = self.normalise(state);
        self.fallback.margin = f64::NAN;
        match self.projection.any() {
            true => self.end_on_joints(time, state),
            false => Ok(()),
        }
    }
}
