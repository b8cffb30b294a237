//! The lists of numbers that programs read.

use std::collections::BTreeSet;

use mbd_scene::Layout;

use crate::equations::{Equations, of_origin};
use crate::expression::Slot;
use crate::program::Program;

/// A list of numbers that a function takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Group {
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
    /// How the origin moves.
    Origin,
    /// Right-hand sides of rows.
    Rows,
    /// Accelerations and multipliers.
    Motion,
    /// A factor and right-hand sides.
    Factored,
    /// Live parameters.
    Params,
    /// Terms of the parameters.
    Derived,
}

impl Group {
    /// Every list, in the order of arguments.
    pub const ALL: [Group; 16] = [
        Group::Time,
        Group::Q,
        Group::V,
        Group::Z,
        Group::States,
        Group::Nodes,
        Group::Effective,
        Group::Hold,
        Group::Ends,
        Group::Inputs,
        Group::Origin,
        Group::Rows,
        Group::Motion,
        Group::Factored,
        Group::Params,
        Group::Derived,
    ];

    /// Its name as an argument.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Group::Time => "time",
            Group::Q => "q",
            Group::V => "v",
            Group::Z => "z",
            Group::States => "states",
            Group::Nodes => "nodes",
            Group::Effective => "effective",
            Group::Hold => "hold",
            Group::Ends => "ends",
            Group::Inputs => "inputs",
            Group::Origin => "origin",
            Group::Rows => "rows",
            Group::Motion => "motion",
            Group::Factored => "factored",
            Group::Params => "params",
            Group::Derived => "derived",
        }
    }

    /// The list of an evaluation's arguments that it is.
    #[must_use]
    pub fn argument(self) -> &'static str {
        match self {
            Group::Motion | Group::Factored => Group::Rows.name(),
            _ => self.name(),
        }
    }

    /// The list a number from outside is in, and its place there.
    #[must_use]
    pub fn of(slot: Slot, layout: &Layout) -> (Group, usize) {
        match slot {
            Slot::Time => (Group::Time, 0),
            Slot::State(i) if i < layout.nq => (Group::Q, i),
            Slot::State(i) if i < layout.nq + layout.nv => (Group::V, i - layout.nq),
            Slot::State(i) if i < layout.states() => (Group::Z, i - layout.nq - layout.nv),
            Slot::State(i) => (Group::States, i - layout.states()),
            Slot::Node(i) => (Group::Nodes, i),
            Slot::Effective(i) => (Group::Effective, i),
            Slot::Hold(i) => (Group::Hold, i),
            Slot::Ends(i) => (Group::Ends, i),
            Slot::Input(i) => (Group::Inputs, i),
            Slot::Origin { number, .. } => (Group::Origin, number),
            Slot::Row(i) => (Group::Rows, i),
            Slot::Motion(i) => (Group::Motion, i),
            Slot::Factored(i) => (Group::Factored, i),
            Slot::Param(i) => (Group::Params, i),
            Slot::Derived(i) => (Group::Derived, i),
        }
    }

    /// How many numbers it has.
    #[must_use]
    pub fn len(self, equations: &Equations) -> usize {
        let layout = &equations.layout;
        match self {
            Group::Time => 1,
            Group::Q => layout.nq,
            Group::V => layout.nv,
            Group::Z => layout.nz,
            Group::States => layout.ns,
            Group::Nodes => 3 * layout.nodes.len(),
            Group::Effective => 2 * layout.effective_lines,
            Group::Hold => layout.holds(),
            Group::Ends => layout.len(mbd_scene::Quantity::AnchorStates),
            Group::Inputs => layout.ni,
            Group::Origin => of_origin(&equations.scene),
            Group::Rows => layout.nc,
            Group::Motion => layout.nv + layout.nc,
            Group::Factored => {
                layout.len(mbd_scene::Quantity::Factor) + layout.len(mbd_scene::Quantity::Solve)
            }
            Group::Params => layout.np,
            Group::Derived => equations.derived.len,
        }
    }
}

/// The lists a program reads, in order.
pub struct Arguments(pub Vec<Group>);

impl Arguments {
    /// Those of a program.
    #[must_use]
    pub fn of(program: &Program, layout: &Layout) -> Self {
        let used: BTreeSet<Group> = program
            .slots
            .iter()
            .map(|&slot| Group::of(slot, layout).0)
            .collect();
        Arguments(used.into_iter().collect())
    }

    /// Whether a list is read.
    #[must_use]
    pub fn reads(&self, group: Group) -> bool {
        self.0.contains(&group)
    }
}
