//! Linearisation of a model through its nodes: total derivatives of ẋ, of the node unknowns and of the outputs.
//!
//! ```text
//! ẋ = F(x, u, y, θ),   0 = G(x, u, y, θ),   o = O(x, u, y, θ)             y: node positions (`static`, `stepwise`) or velocities (`rate`)
//! ∂y/∂x = −G_y⁻¹ G_x          A = F_x + F_y ∂y/∂x          C = O_x + O_y ∂y/∂x          the same with u or θ for x
//! ```
//!
//! F, G, O and their partial derivatives are the model's own; only the small solve with G_y, one network at a time, is done here. Where joints
//! have rows, F is the solution of the constrained system and its derivatives are found in [`rows`], off the joints too. Derivatives by the
//! components of a quaternion mean something along unit quaternions.
//! Everything is finite at every state: where G_y is singular nothing pulls in the missing directions, and y follows its anchors there
//! (slack rule of `static` and `stepwise`: ∂p/∂p_i = 1/n; rules 3 and 4 of `rate`). Modes, the memory and the velocities of stepwise nodes stay
//! fixed; at a switch these are the derivatives on one side ([`StateSpace::kinks`] tells them).

pub(crate) mod chart;
mod jacobian;
mod kinks;
mod matrix;
pub(crate) mod moment;
mod networks;
mod rows;
mod space;
mod vibration;

use std::fmt;

use mbd_scene::similar::near_and_all;
use mbd_scene::{
    At, Differentiated, Float, Formula, Layout, Model, Network, Node, NodeModel, Quantity,
    Variable, Work,
};

pub(crate) use jacobian::Jacobian;
pub use kinks::Kink;
pub use matrix::Matrix;
use networks::NetworkElimination;
use rows::{Evaluator, ThroughRows};
pub use space::StateSpace;
pub(crate) use space::motors_follow;
pub(crate) use space::output_names;
pub use vibration::Vibration;

use crate::error::StepError;
use crate::list::all_finite;
use crate::slopes::{Effective, Slopes};

/// Total derivatives at one state, with the room to compute them again.
///
/// A = dẋ/dx, dẋ/du and dẋ/dθ of the state x = [q | v | z | s], the inputs u and the parameters θ, and the same of outputs and node unknowns; through the
/// nodes and the rows of joints where there are any.
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
    states: TotalDerivative<T>,
    parameters: TotalDerivative<T>,
    inputs: TotalDerivative<T>,
    rows: ThroughRows<T>,
    /// F_y, G_y, O_y.
    by_node: Partials<T>,
    /// What it has room for.
    sizes: [usize; 8],
}

/// The sizes that the lists of a linearisation follow from.
fn sizes(layout: &Layout) -> [usize; 8] {
    let [nodes, outputs] = [Quantity::Balance, Quantity::Outputs].map(|what| layout.len(what));
    let Layout { nv, nc, ni, np, .. } = *layout;
    [layout.nx(), nv, nc, nodes, ni, np, outputs, layout.factor]
}

/// Derivatives by one variable, through the nodes.
#[derive(Clone, Debug)]
struct TotalDerivative<T> {
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

    /// The model's own, and by its laws those that only its laws have: through rows of joints.
    fn evaluate(&mut self, model: &dyn Model<T>, by: Variable, at: &At<'_, T>, work: &mut Work<T>) {
        let layout = model.layout();
        for (of, matrix) in self.each() {
            let through_rows = layout.solves() && of == Differentiated::Derivative;
            if matrix.values.is_empty() || through_rows {
                continue;
            }
            matrix.values.fill(T::zero());
            if layout.asks_efforts(of.quantity()) {
                let mut slopes = Slopes::new(model.scene(), layout, model.params());
                let what = (of.quantity(), by);
                let scene = (model.scene(), layout);
                slopes.differentiate(scene, what, Effective::Fixed, at, &mut matrix.values);
            } else {
                model.evaluate(Quantity::Partial(of, by), at, work, &mut matrix.values);
            }
        }
    }
}

impl<T: Float> TotalDerivative<T> {
    fn new(layout: &Layout, by: Variable) -> Self {
        TotalDerivative {
            partials: Partials::new(layout, by),
            node: Matrix::new(3 * layout.nodes.len(), layout.variables(by)),
        }
    }

    /// Adds what comes through the nodes.
    fn complete(&mut self, by_node: &Partials<T>) {
        if self.node.rows() == 0 {
            return;
        }
        let (partials, node) = (&mut self.partials, &self.node);
        partials.derivative.add_product(&by_node.derivative, node);
        partials.outputs.add_product(&by_node.outputs, node);
    }
}

/// Why there are no derivatives.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum LinearisationError {
    /// At this position rows of joints depend on each other that do not elsewhere: accelerations are not determined, nor their derivatives.
    DependentRows {
        /// The smallest part that other rows leave to a row [1].
        margin: f64,
    },
    /// A list has another length than the scene asks for.
    Length {
        /// Which list.
        what: &'static str,
        /// Its length.
        got: usize,
        /// What it should be.
        expected: usize,
    },
    /// A number that was given is not finite.
    Given {
        /// What it was given for: the name of a coordinate, of the state or an input, `nodes`, `time`.
        name: String,
        /// The number.
        value: f64,
    },
    /// The inputs cannot be used: they are those of another model, or what supplies them gives no numbers.
    Inputs(
        /// Why.
        Box<StepError>,
    ),
    /// Nodes have no balance there.
    Nodes(
        /// Why.
        Box<StepError>,
    ),
    /// Bodies without mass carry nothing there that gives one of their joints an inertia.
    Inertia(
        /// Which.
        Box<StepError>,
    ),
    /// No coordinate has this name.
    UnknownCoordinate {
        /// The name.
        name: String,
        /// Those that there are.
        known: String,
    },
    /// A coordinate that was asked for is held by joints, or decided by those asked for before it.
    DependentCoordinate {
        /// Its name.
        name: String,
    },
    /// Lines of a `stepwise` node are damped: by differences from step to step, which is a rule of whole steps and has no linear system.
    Stepwise {
        /// The node.
        node: String,
    },
    /// A line of a `stepwise` node has no damping now, and a param that gives it some: how much of it a step feels does not follow from what was given.
    NoDamping {
        /// The line.
        line: String,
    },
    /// Both ends of a spring are at the same place, where its damping, or the force that it has there, acts along no direction.
    NoDirection {
        /// The spring.
        spring: String,
    },
    /// Something rises, or falls, without bound at this state: the root of what is zero there.
    NoDerivative {
        /// What: a number of the state or an output column.
        of: String,
        /// Whether it is the rate of that.
        is_rate: bool,
        /// By what there is no derivative: a state or an input of [`StateSpace`].
        by: String,
    },
    /// The model has another layout than this room was made for.
    OtherModel,
    /// The equations, or their derivatives, are no finite numbers at this state.
    NotFinite {
        /// What was evaluated.
        what: Quantity,
        /// The first number of the state whose rate is not finite, by name; empty where that is not known.
        of: String,
    },
}

impl LinearisationError {
    /// Something that is not finite, of which nobody knows whose it is.
    pub(crate) fn not_finite(what: Quantity) -> Self {
        LinearisationError::NotFinite {
            what,
            of: String::new(),
        }
    }
}

impl fmt::Display for LinearisationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LinearisationError::DependentRows { margin } => write!(
                f,
                "the joints lose rank at this position (other rows leave {margin:.1e} of one): accelerations have no derivatives here; move the mechanism out of it"
            ),
            LinearisationError::Length {
                what,
                got,
                expected,
            } => write!(
                f,
                "{got} numbers were given as {what}, and this scene has {expected}"
            ),
            LinearisationError::Given { name, value } => {
                write!(f, "`{name}` cannot be {value}: give a finite number")
            }
            LinearisationError::Inputs(cause) | LinearisationError::Nodes(cause) => {
                write!(f, "{cause}")
            }
            LinearisationError::Inertia(cause) => write!(f, "{cause}; {}", cause.advice()),
            LinearisationError::UnknownCoordinate { name, known } => {
                let known = near_and_all(name, known.split(", "));
                write!(f, "`{name}` is no coordinate of this scene{known}")
            }
            LinearisationError::DependentCoordinate { name } => write!(
                f,
                "`{name}` is held by joints, or follows from the coordinates named before it: leave it out, or name it first"
            ),
            LinearisationError::Stepwise { node } => write!(
                f,
                "the lines of `{node}` are damped by differences from step to step (`equilibrium: stepwise`), which has no linear system: declare `equilibrium: rate`, give the point a mass, or look for a rest, which damping does not move"
            ),
            LinearisationError::NoDamping { line } => write!(
                f,
                "the damping of `{line}` is zero, and a param decides it: what its `stepwise` node feels of it in a step, and the derivative by the param with it, is not known; give it a damping above zero, however small, or make it a `const`"
            ),
            LinearisationError::NoDirection { spring } => write!(
                f,
                "both ends of `{spring}` are at the same place, where its damping, or its force, has no direction and there is no linear system: linearise where they are apart, or let a load act in its place, `-c * bob.velocity`"
            ),
            LinearisationError::NoDerivative { of, is_rate, by } => {
                let rate = if *is_rate { "the rate of " } else { "" };
                write!(
                    f,
                    "{rate}`{of}` has no derivative by `{by}` at this state: beside it that grows without bound, as that of a root does towards zero; choose a state that is not there, or give a law that is smooth there"
                )
            }
            LinearisationError::OtherModel => write!(
                f,
                "the model has another layout than the linearisation: make one with `Linearisation::new(model.layout())`"
            ),
            LinearisationError::NotFinite { what, of } => {
                match of.as_str() {
                    "" => write!(f, "{what}: some numbers have")?,
                    of => write!(f, "the rate of `{of}` has")?,
                }
                write!(
                    f,
                    " no finite value at this state: something divides by zero there, or takes the direction, the angle or the root of nothing"
                )
            }
        }
    }
}

impl std::error::Error for LinearisationError {}

/// Refuses lists that are not as long as the scene reads them: what reads a number that is not there leaves what it makes as it was, or takes it for another.
fn check_arguments<T: Float>(layout: &Layout, at: &At<'_, T>) -> Result<(), LinearisationError> {
    let is_rate = |node: &Node| node.model == NodeModel::Rate;
    let ends = match layout.nodes.iter().any(is_rate) {
        true => layout.len(Quantity::AnchorStates),
        false => 0,
    };
    let nodes = 3 * layout.nodes.len();
    let lists = [
        ("At::state", at.state.len(), layout.nx()),
        ("At::inputs", at.inputs.len(), layout.ni),
        ("At::nodes", at.nodes.len(), nodes),
        (
            "At::effective",
            at.effective.len(),
            layout.effective_numbers,
        ),
        // Turns and the motion of the origin may be left out.
        (
            "At::hold",
            at.hold.len().min(layout.holds()),
            layout.holds(),
        ),
        ("At::ends", at.ends.len().min(ends), ends),
    ];
    let wrong = lists.into_iter().find(|(_, got, expected)| got != expected);
    wrong.map_or(Ok(()), |(what, got, expected)| {
        Err(LinearisationError::Length {
            what,
            got,
            expected,
        })
    })
}

/// Refuses lines of `stepwise` nodes whose damping is zero by a param.
fn check_damping<T: Float>(model: &dyn Model<T>) -> Result<(), LinearisationError> {
    let (scene, layout) = (model.scene(), model.layout());
    let is_stepwise = |network: &&Network| matches!(network.model, NodeModel::Stepwise { .. });
    let networks = layout.networks.iter().filter(is_stepwise);
    for &line in networks.flat_map(|network| &network.lines) {
        let (Some(declared), Some(numbers)) = (scene.lines.get(line), model.lines().get(line))
        else {
            continue;
        };
        let by_param = |part: &Formula| matches!(part, Formula::Param(_));
        if numbers.damping == T::zero() && scene.contains(&declared.damping, by_param) {
            return Err(LinearisationError::NoDamping {
                line: declared.name.clone(),
            });
        }
    }
    Ok(())
}

impl<T: Float> Linearisation<T> {
    /// Room for a layout.
    #[must_use]
    pub fn new(layout: &Layout) -> Self {
        Linearisation {
            states: TotalDerivative::new(layout, Variable::State),
            parameters: TotalDerivative::new(layout, Variable::Parameter),
            inputs: TotalDerivative::new(layout, Variable::Input),
            rows: ThroughRows::new(layout),
            by_node: Partials::new(layout, Variable::Node),
            sizes: sizes(layout),
        }
    }

    /// What [`Linearisation::evaluate`] does.
    pub(crate) fn run_given(
        &mut self,
        model: &dyn Model<T>,
        at: &At<'_, T>,
        work: &mut Work<T>,
    ) -> Result<(), LinearisationError> {
        if self.sizes != sizes(model.layout()) {
            return Err(LinearisationError::OtherModel);
        }
        check_arguments(model.layout(), at)?;
        check_damping(model)?;
        self.run(model, at, work)
    }

    /// The same in the room of this model and at arguments of its scene; by a param that makes the damping of a line zero as if it stayed that.
    pub(crate) fn run(
        &mut self,
        model: &dyn Model<T>,
        at: &At<'_, T>,
        work: &mut Work<T>,
    ) -> Result<(), LinearisationError> {
        let layout = model.layout();
        self.states
            .partials
            .evaluate(model, Variable::State, at, work);
        self.inputs
            .partials
            .evaluate(model, Variable::Input, at, work);
        self.by_node.evaluate(model, Variable::Node, at, work);
        if layout.effective_lines > 0 {
            // A model's own derivatives hold K_e and L_e.
            let scene = (model.scene(), model.layout());
            let mut slopes = Slopes::new(scene.0, scene.1, model.params());
            for (of, matrix) in self.parameters.partials.each() {
                if layout.solves() && of == Differentiated::Derivative {
                    continue;
                }
                let of = (of.quantity(), Variable::Parameter);
                slopes.differentiate(scene, of, Effective::Follows, at, &mut matrix.values);
            }
        } else {
            let partials = &mut self.parameters.partials;
            partials.evaluate(model, Variable::Parameter, at, work);
        }
        if layout.solves() {
            self.through_rows(model, at, work)?;
        }
        for network in 0..layout.networks.len() {
            let Some(mut elimination) = NetworkElimination::new(model, network) else {
                continue;
            };
            elimination.read(model, &self.by_node.balance);
            let slopes = &mut Slopes::new(model.scene(), model.layout(), model.params());
            for (by, total) in [
                (Variable::State, &mut self.states),
                (Variable::Parameter, &mut self.parameters),
                (Variable::Input, &mut self.inputs),
            ] {
                let (balance, node) = (&total.partials.balance, &mut total.node);
                elimination.solve((model, slopes), at, by, balance, node);
            }
        }
        self.states.complete(&self.by_node);
        self.parameters.complete(&self.by_node);
        self.inputs.complete(&self.by_node);
        self.check_finite()
    }

    /// ∂ẋ at fixed nodes, where joints have rows.
    fn through_rows(
        &mut self,
        model: &dyn Model<T>,
        at: &At<'_, T>,
        work: &mut Work<T>,
    ) -> Result<(), LinearisationError> {
        let layout = model.layout();
        let mut laws = None;
        let evaluator = &mut Evaluator::new(model, Some(work), &mut laws);
        self.rows.prepare(layout, evaluator, at)?;
        for (by, partials) in [
            (Variable::State, &mut self.states.partials),
            (Variable::Parameter, &mut self.parameters.partials),
            (Variable::Input, &mut self.inputs.partials),
            (Variable::Node, &mut self.by_node),
        ] {
            let out = &mut partials.derivative;
            if !out.values.is_empty() {
                self.rows
                    .differentiate(layout, evaluator, (by.into(), at), out);
            }
        }
        Ok(())
    }

    fn check_finite(&mut self) -> Result<(), LinearisationError> {
        for (by, partials) in [
            (Variable::Node, &mut self.by_node),
            (Variable::State, &mut self.states.partials),
            (Variable::Parameter, &mut self.parameters.partials),
            (Variable::Input, &mut self.inputs.partials),
        ] {
            for (of, matrix) in partials.each() {
                if !all_finite(&matrix.values) {
                    let what = Quantity::Partial(of, by);
                    return Err(LinearisationError::not_finite(what));
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

    /// dẋ/du, n_x × n_u, columns in the order of [`Layout::inputs`](mbd_scene::Layout::inputs).
    #[must_use]
    pub fn input(&self) -> &Matrix<T> {
        &self.inputs.partials.derivative
    }

    /// do/du of the output columns.
    #[must_use]
    pub fn outputs_by_input(&self) -> &Matrix<T> {
        &self.inputs.partials.outputs
    }

    /// dy/du of the node unknowns, 3n × n_u.
    #[must_use]
    pub fn node_by_input(&self) -> &Matrix<T> {
        &self.inputs.node
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
