//! ∂f/∂x and ∂f/∂t of the rates of a run, f = [ẋ | powers], again and again without allocation: what a stiff method asks for at every step.
//!
//! ```text
//! ∂f/∂x = F_x + F_y ∂y/∂x,   ∂y/∂x = −G_y⁻¹ G_x            y: node unknowns, in balance G = 0                             (1)
//! ```
//!
//! As in [`super`], through the rows of joints where there are any. Exact derivatives of the rates as they are evaluated, off the joints and by every
//! component of a quaternion, too. Partial derivatives are the model's own where it was generated with `emit: [partial]`, else the laws run on
//! duals; those by time and those of powers always do.

use mbd_scene::{At, Differentiated, Float, Model, Quantity, Variable, Work};

use super::LinearisationError;
use super::matrix::Matrix;
use super::networks::NetworkElimination;
use super::rows::{Evaluator, ThroughRows, Witness};
use crate::slopes::DerivativeBy;

/// Derivatives by one variable at fixed nodes, and of the node unknowns.
#[derive(Debug)]
struct PartialDerivatives<T> {
    by: DerivativeBy,
    derivative: Matrix<T>,
    balance: Matrix<T>,
    powers: Matrix<T>,
    node: Matrix<T>,
}

impl<T: Float> PartialDerivatives<T> {
    fn new(model: &dyn Model<T>, by: DerivativeBy, works: bool) -> Self {
        let layout = model.layout();
        let columns = by.count(layout);
        let rows = if works {
            layout.len(Quantity::Energy)
        } else {
            0
        };
        PartialDerivatives {
            by,
            derivative: Matrix::new(layout.nx(), columns),
            balance: Matrix::new(layout.len(Quantity::Balance), columns),
            powers: Matrix::new(rows, columns),
            node: Matrix::new(3 * layout.nodes.len(), columns),
        }
    }
}

/// The room of one run.
#[derive(Debug)]
pub(crate) struct Jacobian<T: Float> {
    state: PartialDerivatives<T>,
    /// `None` where the scene says nothing of time.
    time: Option<PartialDerivatives<T>>,
    node: PartialDerivatives<T>,
    rows: ThroughRows<T>,
    networks: Vec<NetworkElimination<T>>,
    /// Whether the model has partial derivatives of its own.
    own: bool,
    /// Whether ẋ is the solution of rows.
    through_rows: bool,
    laws: Option<Box<Witness>>,
}

impl<T: Float> Jacobian<T> {
    /// Room for a model, with the powers behind its state or without.
    pub(crate) fn new(model: &dyn Model<T>, works: bool) -> Self {
        let total = |by: DerivativeBy| PartialDerivatives::new(model, by, works);
        // What is measured from an origin that moves depends on time.
        let scene = model.scene();
        let timed = scene.runs.origin.is_some() || scene.reads_time();
        let own = differentiates(model);
        Jacobian {
            state: total(Variable::State.into()),
            time: timed.then(|| total(DerivativeBy::Time)),
            node: total(Variable::Node.into()),
            rows: ThroughRows::new(model.layout()),
            networks: (0..model.layout().networks.len())
                .filter_map(|network| NetworkElimination::new(model, network))
                .collect(),
            laws: (timed || works || !own || !model.layout().networks.is_empty())
                .then(|| Box::new(Witness::new(model))),
            own,
            through_rows: model.layout().solves(),
        }
    }

    /// Whether ∂f/∂x is the model's own partial derivative of ẋ and nothing else, and ∂f/∂t zero.
    pub(crate) fn is_plain(&self) -> bool {
        let alone = self.networks.is_empty() && !self.through_rows;
        self.own && self.time.is_none() && alone && self.state.powers.values.is_empty()
    }

    /// Writes ∂f/∂x, row by row, and ∂f/∂t at a state whose nodes are in balance.
    ///
    /// # Errors
    /// [`LinearisationError::DependentRows`] at a position at which rows lose rank, [`LinearisationError::NotFinite`] of the equations themselves.
    /// Derivatives that are not finite are written as they are.
    pub(crate) fn evaluate(
        &mut self,
        model: &dyn Model<T>,
        at: &At<'_, T>,
        work: &mut Work<T>,
        (by_state, by_time): (&mut [T], &mut [T]),
    ) -> Result<(), LinearisationError> {
        let layout = model.layout();
        let through_rows = self.through_rows;
        if through_rows {
            let own = self.own.then_some(&mut *work);
            let mut evaluator = Evaluator::new(model, own, &mut self.laws);
            self.rows.prepare(layout, &mut evaluator, at)?;
            let totals = [&mut self.state, &mut self.node];
            for total in totals.into_iter().chain(self.time.as_mut()) {
                if !total.derivative.values.is_empty() {
                    let out = &mut total.derivative;
                    self.rows
                        .differentiate(layout, &mut evaluator, (total.by, at), out);
                }
            }
        }
        let totals = [&mut self.state, &mut self.node];
        for total in totals.into_iter().chain(self.time.as_mut()) {
            for (of, out) in [
                (Some(Differentiated::Derivative), &mut total.derivative),
                (Some(Differentiated::Balance), &mut total.balance),
                (None, &mut total.powers),
            ] {
                let done = through_rows && of == Some(Differentiated::Derivative);
                if done || out.values.is_empty() {
                    continue;
                }
                match (of, total.by) {
                    (Some(of), DerivativeBy::Variable(by)) if self.own => {
                        out.values.fill(T::zero());
                        model.evaluate(Quantity::Partial(of, by), at, work, &mut out.values);
                    }
                    _ => {
                        let of = of.map_or(Quantity::Energy, Differentiated::quantity);
                        let laws = self
                            .laws
                            .get_or_insert_with(|| Box::new(Witness::new(model)));
                        laws.differentiate(model, (of, total.by), at, &mut out.values);
                    }
                }
            }
        }
        self.through_nodes(model, at);
        write(&self.state, by_state);
        match &self.time {
            Some(time) => write(time, by_time),
            None => by_time.fill(T::zero()),
        }
        Ok(())
    }

    /// Adds what comes through the nodes.
    fn through_nodes(&mut self, model: &dyn Model<T>, at: &At<'_, T>) {
        for elimination in &mut self.networks {
            elimination.read(model, &self.node.balance);
            let laws = self
                .laws
                .get_or_insert_with(|| Box::new(Witness::new(model)));
            for total in [&mut self.state].into_iter().chain(self.time.as_mut()) {
                let (balance, node) = (&total.balance, &mut total.node);
                elimination.solve((model, &mut laws.slopes), at, total.by, balance, node);
            }
        }
        for total in [&mut self.state].into_iter().chain(self.time.as_mut()) {
            total
                .derivative
                .add_product(&self.node.derivative, &total.node);
            total.powers.add_product(&self.node.powers, &total.node);
        }
    }
}

/// Writes [∂ẋ; ∂powers], of which energies come first, into rows that are as long as the state with its integrals.
fn write<T: Float>(total: &PartialDerivatives<T>, out: &mut [T]) {
    let columns = total.derivative.columns().max(1);
    let (states, powers) = (total.derivative.rows(), total.powers.rows() / 2);
    let width = out.len() / (states + powers).max(1);
    let energies = powers * columns;
    let derivative = total.derivative.values().chunks_exact(columns);
    let powers = total.powers.values().get(energies..).unwrap_or_default();
    let mut rows = derivative.chain(powers.chunks_exact(columns));
    for to in out.chunks_exact_mut(width.max(1)) {
        let row = rows.next().unwrap_or_default();
        let (own, behind) = to.split_at_mut(row.len().min(to.len()));
        own.iter_mut().zip(row).for_each(|(to, x)| *to = *x);
        behind.fill(T::zero());
    }
}

/// Whether a model evaluates partial derivatives of its own: it leaves untouched what it does not know, and ∂q̇/∂v is never zero.
fn differentiates<T: Float>(model: &dyn Model<T>) -> bool {
    let layout = model.layout();
    let of = match layout.nc {
        0 => Differentiated::Derivative,
        _ => Differentiated::Residual,
    };
    let what = Quantity::Partial(of, Variable::State);
    let mut probe = vec![T::from_f64(f64::NAN); layout.len(what)];
    let zeros = |length: usize| vec![T::zero(); length];
    let mut state = zeros(layout.nx());
    for upright in layout.quaternions() {
        state[upright] = T::one();
    }
    let (nodes, inputs) = (zeros(3 * layout.nodes.len()), zeros(layout.ni));
    let at = At {
        time: T::zero(),
        state: &state,
        nodes: &nodes,
        effective: &zeros(layout.effective_numbers),
        hold: &zeros(layout.origin_at()),
        ends: &[],
        inputs: &inputs,
        rows: &zeros(layout.nv + layout.nc),
    };
    model.evaluate(what, &at, &mut model.work(), &mut probe);
    probe.iter().any(|x| x.is_finite())
}
