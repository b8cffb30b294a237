//! What the equations of a scene cost.

use mbd_compiler::SceneEquations;
use mbd_runtime::scene::{Cost, Differentiated, Quantity, Variable};

use mbd_report::{Cell, ReportTable};

/// Operations of every quantity of the scene.
#[must_use]
pub fn operations(equations: &SceneEquations) -> ReportTable {
    let mut table = ReportTable::new("Operations of one evaluation")
        .column("quantity", "")
        .column("all", "")
        .column("+ −", "")
        .column("×", "")
        .column("÷", "")
        .column("√", "")
        .column("sin cos exp", "")
        .column("select", "");
    let mut add = |name: String, cost: Cost| {
        let kinds = [
            cost.total(),
            cost.adds,
            cost.muls,
            cost.divs,
            cost.sqrts,
            cost.trigs,
            cost.selects,
        ];
        table.push([Cell::from(name)].into_iter().chain(kinds.map(Cell::from)));
    };
    add(
        "terms of the params alone, once".to_string(),
        equations.derived.cost(),
    );
    for (what, program) in &equations.programs {
        add(quantity(*what), program.cost());
    }
    table
}

/// A quantity in words.
fn quantity(what: Quantity) -> String {
    let words = match what {
        Quantity::AnchorStates => "ends of the node lines",
        Quantity::Equilibrium(network) => {
            return format!("equilibrium of network {network}, one iteration");
        }
        Quantity::Derivative => "derivative of the state",
        Quantity::Rates => "derivative of the state with the velocities of its nodes",
        Quantity::Balance => "balance of the equilibrium points",
        Quantity::Guards => "guards of the events",
        Quantity::Outputs => "outputs",
        Quantity::Coordinates => "joint coordinates",
        Quantity::Energy => "energy",
        Quantity::Momentum => "momentum",
        Quantity::Bodies => "bodies as absolute coordinates have them",
        Quantity::MassMatrix => "mass matrix",
        Quantity::BiasForce => "bias force",
        Quantity::Forces => "applied forces",
        Quantity::InverseDynamics => "inverse dynamics",
        Quantity::GravityForce => "gravity force",
        Quantity::CentreOfMass => "centre of mass",
        Quantity::CentreOfMassJacobian => "its Jacobian",
        Quantity::FrameJacobian(..) => "Jacobian of a frame",
        Quantity::Lines => "lines and their stiffness",
        Quantity::Constraint => "constraints Φ of the joints",
        Quantity::ConstraintJacobian => "their Jacobian Φ_v",
        Quantity::ConstraintRate => "their rate Φ_v v",
        Quantity::ConstraintBias => "their bias γ",
        Quantity::Multipliers => "multipliers of the joints",
        Quantity::Reactions => "reactions of the joints",
        Quantity::ProjectionStep => "correction of the joints (projection)",
        Quantity::Residual => "equations of motion before their solution",
        Quantity::Factor => "factor of their system",
        Quantity::Solve => "solution by the factor",
        Quantity::JointCoordinates => "joint coordinates",
        Quantity::NodeByAnchor(network) => return format!("∂node/∂anchor of network {network}"),
        Quantity::CondensedStiffness(network) => {
            return format!("condensed stiffness of network {network}");
        }
        Quantity::Partial(of, by) => {
            let of = match of {
                Differentiated::Derivative => "derivative",
                Differentiated::Balance => "balance",
                Differentiated::Outputs => "outputs",
                Differentiated::Residual => "residual",
            };
            let by = match by {
                Variable::State => "state",
                Variable::Node => "node",
                Variable::Parameter => "params",
                Variable::Input => "inputs",
            };
            return format!("∂{of}/∂{by}");
        }
    };
    words.to_string()
}
