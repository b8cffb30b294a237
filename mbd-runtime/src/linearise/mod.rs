//! Linearisation of a model through its nodes: total derivatives of ẋ, of the node unknowns and of the outputs.
//!
//! ```text
//! ẋ = F(x, y, θ),   0 = G(x, y, θ),   o = O(x, y, θ)                      y: node positions (`static`, `stepwise`) or velocities (`rate`)
//! ∂y/∂x = −G_y⁻¹ G_x          A = F_x + F_y ∂y/∂x          C = O_x + O_y ∂y/∂x          the same with θ for x
//! ```
//!
//! F, G, O and their partial derivatives are the model's own; only the small solve with G_y, one network at a time, is done here.
//! Everything is finite at every state: where G_y is singular nothing pulls in the missing directions, and y follows its anchors there
//! (slack rule of `static` and `stepwise`: ∂p/∂p_i = 1/n; rules 3 and 4 of `rate`). Modes, the memory of stepwise nodes and the weights of rule 4 stay
//! fixed; at a switch these are the derivatives on one side.

mod matrix;
mod networks;

use std::fmt;

use mbd_scene::{At, Differentiated, Float, Layout, Model, Quantity, Variable, Work};

pub use matrix::Matrix;
use networks::Elimination;

use crate::slopes::{Effective, Slopes};

/// Total derivatives at one state, with the room to compute them again.
///
/// A = dẋ/dx and dẋ/dθ of the state x = [q | v | z] and the parameters θ, and the same of outputs and node unknowns; through the nodes where there are
/// any. Scenes with rows of joints are refused.
///
/// ```
/// use mbd_runtime::scene::Arguments;
/// use mbd_runtime::{Linearisation, Model, model};
///
/// model! {
///     /// A mass that is drawn to the origin.
///     model Oscillator {
///         gravity: none;
///         param k = 100 N/m in 1 N/m ..= 1 kN/m;
///         point bob { mass: 2.0 kg }
///         load pull on bob = -k * bob.position;
///     }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let oscillator = Oscillator::new(OscillatorParams::default())?;
/// // x = [position | velocity]; this scene has no nodes, lines or inputs.
/// let arguments = Arguments { state: vec![0.1, 0.0, 0.0, 0.0, 0.0, 0.0], ..Arguments::default() };
/// let mut linear = Linearisation::new(oscillator.layout());
/// linear.evaluate(&oscillator, &arguments.at(), &mut oscillator.work())?;
///
/// // d ẍ/dx = −k/m, so that ω² = 50 1/s²; d ẍ/dk = −x/m.
/// assert_eq!(linear.state().at(0, 3), 1.0);
/// assert!((linear.state().at(3, 0) + 50.0).abs() < 1e-12);
/// assert!((linear.parameter().at(3, 0) + 0.05).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Linearisation<T: Float> {
    layout: Layout,
    states: Total<T>,
    parameters: Total<T>,
    /// F_y, G_y, O_y.
    by_node: Partials<T>,
}

/// Derivatives by one variable, through the nodes.
#[derive(Clone, Debug)]
struct Total<T> {
    /// F, G, O by the variable at fixed nodes; F and O become total derivatives.
    partials: Partials<T>,
    /// ∂y by the variable.
    node: Matrix<T>,
}

#[derive(Clone, Debug)]
struct Partials<T> {
    derivative: Matrix<T>,
    balance: Matrix<T>,
    outputs: Matrix<T>,
}

impl<T: Float> Partials<T> {
    fn new(layout: &Layout, by: Variable) -> Self {
        let room =
            |of: Differentiated| Matrix::new(layout.len(of.quantity()), layout.variables(by));
        Partials {
            derivative: room(Differentiated::Derivative),
            balance: room(Differentiated::Balance),
            outputs: room(Differentiated::Outputs),
        }
    }

    fn each(&mut self) -> [(Differentiated, &mut Matrix<T>); 3] {
        [
            (Differentiated::Derivative, &mut self.derivative),
            (Differentiated::Balance, &mut self.balance),
            (Differentiated::Outputs, &mut self.outputs),
        ]
    }

    fn evaluate(&mut self, model: &dyn Model<T>, by: Variable, at: &At<'_, T>, work: &mut Work<T>) {
        for (of, matrix) in self.each() {
            matrix.values.fill(T::zero());
            if !matrix.values.is_empty() {
                model.evaluate(Quantity::Partial(of, by), at, work, &mut matrix.values);
            }
        }
    }
}

impl<T: Float> Total<T> {
    fn new(layout: &Layout, by: Variable) -> Self {
        Total {
            partials: Partials::new(layout, by),
            node: Matrix::new(3 * layout.nodes.len(), layout.variables(by)),
        }
    }

    /// Adds what comes through the nodes.
    fn complete(&mut self, by_node: &Partials<T>) {
        let (partials, node) = (&mut self.partials, &self.node);
        partials.derivative.add_product(&by_node.derivative, node);
        partials.outputs.add_product(&by_node.outputs, node);
    }
}

/// Why there are no derivatives.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LinearisationError {
    /// The scene has rows of joints: derivatives through the multipliers are not there yet.
    Joints {
        /// Number of rows.
        rows: usize,
    },
    /// The model has another layout than this room was made for.
    OtherModel,
    /// A partial derivative is not a number here: the model was generated without it, or the state has none.
    NotFinite {
        /// The derivative.
        what: Quantity,
    },
}

impl fmt::Display for LinearisationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LinearisationError::Joints { rows } => write!(
                f,
                "the joints of this scene put {rows} rows into its equations, and derivatives of accelerations through rows are not offered: difference the state derivative, or describe the mechanism without joints"
            ),
            LinearisationError::OtherModel => write!(
                f,
                "the model has another layout than the linearisation: make one with `Linearisation::new(model.layout())`"
            ),
            LinearisationError::NotFinite { what } => write!(
                f,
                "{what:?} has no finite value here: emit it in the declaration, and look at the state"
            ),
        }
    }
}

impl std::error::Error for LinearisationError {}

impl<T: Float> Linearisation<T> {
    /// Room for a layout.
    #[must_use]
    pub fn new(layout: &Layout) -> Self {
        Linearisation {
            states: Total::new(layout, Variable::State),
            parameters: Total::new(layout, Variable::Parameter),
            by_node: Partials::new(layout, Variable::Node),
            layout: layout.clone(),
        }
    }

    /// What [`Linearisation::evaluate`] does.
    pub(crate) fn run(
        &mut self,
        model: &dyn Model<T>,
        at: &At<'_, T>,
        work: &mut Work<T>,
    ) -> Result<(), LinearisationError> {
        if *model.layout() != self.layout {
            return Err(LinearisationError::OtherModel);
        }
        if self.layout.nc > 0 {
            return Err(LinearisationError::Joints {
                rows: self.layout.nc,
            });
        }
        self.states
            .partials
            .evaluate(model, Variable::State, at, work);
        self.by_node.evaluate(model, Variable::Node, at, work);
        if self.layout.effective_lines > 0 {
            // A model's own derivatives hold K_e and L_e.
            let scene = (model.scene(), model.layout());
            let mut slopes = Slopes::new(scene.0, scene.1, model.params());
            for (of, matrix) in self.parameters.partials.each() {
                let of = (of.quantity(), Variable::Parameter);
                slopes.differentiate(scene, of, Effective::Follows, at, &mut matrix.values);
            }
        } else {
            let partials = &mut self.parameters.partials;
            partials.evaluate(model, Variable::Parameter, at, work);
        }
        for network in 0..self.layout.networks.len() {
            let Some(elimination) = Elimination::new(model, network, &self.by_node.balance) else {
                continue;
            };
            for (by, total) in [
                (Variable::State, &mut self.states),
                (Variable::Parameter, &mut self.parameters),
            ] {
                elimination.solve(model, at, by, &total.partials.balance, &mut total.node);
            }
        }
        self.states.complete(&self.by_node);
        self.parameters.complete(&self.by_node);
        self.check_finite()
    }

    fn check_finite(&mut self) -> Result<(), LinearisationError> {
        for (by, partials) in [
            (Variable::Node, &mut self.by_node),
            (Variable::State, &mut self.states.partials),
            (Variable::Parameter, &mut self.parameters.partials),
        ] {
            for (of, matrix) in partials.each() {
                if matrix.values.iter().any(|x| !x.is_finite()) {
                    let what = Quantity::Partial(of, by);
                    return Err(LinearisationError::NotFinite { what });
                }
            }
        }
        Ok(())
    }

    /// A = dẋ/dx, n_x × n_x.
    #[must_use]
    pub fn state(&self) -> &Matrix<T> {
        &self.states.partials.derivative
    }

    /// dẋ/dθ, n_x × n_p.
    #[must_use]
    pub fn parameter(&self) -> &Matrix<T> {
        &self.parameters.partials.derivative
    }

    /// dy/dx of the node unknowns, 3n × n_x.
    #[must_use]
    pub fn node_by_state(&self) -> &Matrix<T> {
        &self.states.node
    }

    /// dy/dθ of the node unknowns, 3n × n_p.
    #[must_use]
    pub fn node_by_parameter(&self) -> &Matrix<T> {
        &self.parameters.node
    }

    /// do/dx of the output columns.
    #[must_use]
    pub fn outputs_by_state(&self) -> &Matrix<T> {
        &self.states.partials.outputs
    }

    /// do/dθ of the output columns.
    #[must_use]
    pub fn outputs_by_parameter(&self) -> &Matrix<T> {
        &self.parameters.partials.outputs
    }
}
