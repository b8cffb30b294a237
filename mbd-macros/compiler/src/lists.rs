//! The lists of numbers that programs read.

use std::collections::BTreeSet;

use mbd_scene::{Differentiated, Layout, Quantity, Scene};

use crate::equations::{SceneEquations, of_origin};
use crate::expression::Slot;
use crate::program::Program;

/// A list of numbers that a function takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum NumberList {
    /// The direction in which is differentiated.
    Direction,
    /// What does not depend on it.
    Values,
    /// Time.
    Time,
    /// Coordinates.
    Q,
    /// Speeds.
    V,
    /// Positions of `rate` nodes.
    Z,
    /// Declared states.
    States,
    /// Node unknowns.
    Nodes,
    /// Effective stiffness and free length.
    Effective,
    /// Hold flags.
    Hold,
    /// Anchors and node loads.
    Ends,
    /// Inputs.
    Inputs,
    /// Last values of angles whose turns are counted.
    Turns,
    /// How the origin moves.
    Origin,
    /// Right-hand sides of rows.
    Rows,
    /// Accelerations and multipliers.
    Motion,
    /// A factor.
    Factored,
    /// What is solved for by the factor.
    Right,
    /// Live parameters.
    Params,
    /// Terms of the parameters.
    Derived,
}

impl NumberList {
    /// Every list, in the order of arguments.
    pub const ALL: [NumberList; 20] = [
        NumberList::Direction,
        NumberList::Values,
        NumberList::Time,
        NumberList::Q,
        NumberList::V,
        NumberList::Z,
        NumberList::States,
        NumberList::Nodes,
        NumberList::Effective,
        NumberList::Hold,
        NumberList::Ends,
        NumberList::Inputs,
        NumberList::Turns,
        NumberList::Origin,
        NumberList::Rows,
        NumberList::Motion,
        NumberList::Factored,
        NumberList::Right,
        NumberList::Params,
        NumberList::Derived,
    ];

    /// Whether it stands in the working list before a function in blocks is called, so that every column finds it there.
    #[must_use]
    pub fn is_in_place(self) -> bool {
        matches!(self, NumberList::Direction | NumberList::Values)
    }

    /// Its name as an argument.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            NumberList::Direction => "direction",
            NumberList::Values => "values",
            NumberList::Time => "time",
            NumberList::Q => "q",
            NumberList::V => "v",
            NumberList::Z => "z",
            NumberList::States => "states",
            NumberList::Nodes => "nodes",
            NumberList::Effective => "effective",
            NumberList::Hold => "hold",
            NumberList::Ends => "ends",
            NumberList::Inputs => "inputs",
            NumberList::Turns => "turns",
            NumberList::Origin => "origin",
            NumberList::Rows => "rows",
            NumberList::Motion => "motion",
            NumberList::Factored => "factored",
            NumberList::Right => "right",
            NumberList::Params => "params",
            NumberList::Derived => "derived",
        }
    }

    /// The list of an evaluation's arguments that it is.
    #[must_use]
    pub fn argument(self) -> &'static str {
        match self {
            NumberList::Motion | NumberList::Factored | NumberList::Right => {
                NumberList::Rows.name()
            }
            _ => self.name(),
        }
    }

    /// The list a number from outside is in, and its place there.
    #[must_use]
    pub fn of(slot: Slot, layout: &Layout) -> (NumberList, usize) {
        match slot {
            Slot::Time => (NumberList::Time, 0),
            Slot::State(i) if i < layout.nq => (NumberList::Q, i),
            Slot::State(i) if i < layout.nq + layout.nv => (NumberList::V, i - layout.nq),
            Slot::State(i) if i < layout.states() => (NumberList::Z, i - layout.nq - layout.nv),
            Slot::State(i) => (NumberList::States, i - layout.states()),
            Slot::Node(i) => (NumberList::Nodes, i),
            Slot::Effective(i) => (NumberList::Effective, i),
            Slot::Hold(i) => (NumberList::Hold, i),
            Slot::Ends(i) => (NumberList::Ends, i),
            Slot::Input(i) => (NumberList::Inputs, i),
            Slot::Turn { number, .. } => (NumberList::Turns, number),
            Slot::Origin { number, .. } => (NumberList::Origin, number),
            Slot::Row(i) => (NumberList::Rows, i),
            Slot::Motion(i) => (NumberList::Motion, i),
            Slot::Factored(i) => (NumberList::Factored, i),
            Slot::Right { number, .. } => (NumberList::Right, number),
            Slot::Direction(i) => (NumberList::Direction, i),
            Slot::Value(i) => (NumberList::Values, i),
            Slot::Param(i) => (NumberList::Params, i),
            Slot::Derived(i) => (NumberList::Derived, i),
        }
    }

    /// Whether a function of this quantity is expected to read it, as far as that is known without equations.
    #[must_use]
    pub fn is_expected(self, what: Quantity, scene: &Scene) -> bool {
        let of_masses = matches!(
            what,
            Quantity::MassMatrix
                | Quantity::GravityForce
                | Quantity::CentreOfMass
                | Quantity::CentreOfMassJacobian
                | Quantity::FrameJacobian(..)
                | Quantity::Momentum
                | Quantity::Bodies
        );
        match self {
            NumberList::Q | NumberList::V => true,
            NumberList::Time => scene.reads_time(),
            NumberList::Ends => matches!(
                what,
                Quantity::Equilibrium(_)
                    | Quantity::NodeByAnchor(_)
                    | Quantity::CondensedStiffness(_)
            ),
            NumberList::Rows => what == Quantity::ProjectionStep,
            NumberList::Motion => matches!(
                what,
                Quantity::InverseDynamics
                    | Quantity::JointCoordinates
                    | Quantity::Residual
                    | Quantity::Partial(Differentiated::Residual, _)
            ),
            NumberList::Factored | NumberList::Right => what == Quantity::Solve,
            _ => !of_masses,
        }
    }

    /// How many numbers it has for a program.
    #[must_use]
    pub fn len(self, equations: &SceneEquations, program: Option<&Program>) -> usize {
        let layout = &equations.layout;
        let columns = program.and_then(|program| program.by_column.as_ref());
        match self {
            NumberList::Direction => columns.map_or(0, |own| own.columns.len()),
            NumberList::Values => columns.map_or(0, |own| own.values),
            NumberList::Time => 1,
            NumberList::Q => layout.nq,
            NumberList::V => layout.nv,
            NumberList::Z => layout.nz,
            NumberList::States => layout.ns,
            NumberList::Nodes => 3 * layout.nodes.len(),
            NumberList::Effective => layout.effective_numbers,
            NumberList::Hold => layout.holds(),
            NumberList::Ends => layout.len(Quantity::AnchorStates),
            NumberList::Inputs => layout.ni,
            NumberList::Turns => layout.turns.len(),
            NumberList::Origin => of_origin(&equations.scene),
            NumberList::Rows => layout.nc,
            NumberList::Motion => layout.nv + layout.nc,
            NumberList::Factored => layout.len(Quantity::Factor),
            NumberList::Right => layout.len(Quantity::Solve),
            NumberList::Params => layout.np,
            NumberList::Derived => equations.derived.len,
        }
    }
}

/// The lists a program reads, in order.
pub struct ProgramArguments(pub Vec<NumberList>);

impl ProgramArguments {
    /// Those of a program.
    #[must_use]
    pub fn of(program: &Program, layout: &Layout) -> Self {
        let used: BTreeSet<NumberList> = program
            .slots
            .iter()
            .map(|&slot| NumberList::of(slot, layout).0)
            .collect();
        ProgramArguments(used.into_iter().collect())
    }

    /// Whether a number of the state is read.
    #[must_use]
    pub fn reads_state(&self) -> bool {
        let parts = [
            NumberList::Q,
            NumberList::V,
            NumberList::Z,
            NumberList::States,
        ];
        parts.into_iter().any(|part| self.reads(part))
    }

    /// Whether a list is read.
    #[must_use]
    pub fn reads(&self, group: NumberList) -> bool {
        self.0.contains(&group)
    }
}
