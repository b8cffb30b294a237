//! The equations of a scene: its laws run on symbols, quantity by quantity, and put in order as programs.

use mbd_scene::Scratch;
use mbd_scene::laws::{Numbers, origin};
use mbd_scene::{At, Cost, Layout, Quantity, Redundancy, Scene, Variable};
use num_traits::Zero;

use crate::differentiate::{DerivativeVariable, jacobian};
use crate::directional::{MatrixColumns, directional};
use crate::expression::{Expr, Graph, Slot, Term, TermKind, recorded, session};
use crate::names;
use crate::operation::Op;
use crate::program::{Operand, Program, Register, TermPlaces};

/// The equations of one scene.
#[derive(Clone, Debug)]
pub struct SceneEquations {
    /// The declaration.
    pub scene: Scene,
    /// Where everything lives.
    pub layout: Layout,
    /// The terms of the parameters alone: run once per set of parameters, its results are the slots [`Slot::Derived`].
    pub derived: Program,
    /// q̇ = N(q) v alone: the first numbers of the state derivative.
    pub kinematics: Option<Program>,
    /// One program a quantity, in the order of [`Layout::quantities`].
    pub programs: Vec<(Quantity, Program)>,
    /// For each matrix that is differentiated in one direction at a time ([`Program::by_column`]), what does not depend on the direction.
    pub values: Vec<(Quantity, Program)>,
}

/// A traced quantity: its non-zeros and the terms it asked for.
struct Traced {
    what: Quantity,
    outputs: Vec<(usize, Expr)>,
    order: Vec<Term>,
    /// Of a matrix that is differentiated in one direction at a time what does not depend on the direction, and its columns.
    by_column: Option<(Vec<Expr>, MatrixColumns)>,
}

/// Lays out a scene, its accelerations by the algorithm of fewer operations: where a tree leaves it open which one that is, both are counted.
#[must_use]
pub fn lay_out(scene: &Scene) -> Layout {
    let layout = Layout::new(scene);
    let other = layout.with_other_algorithm();
    cheaper(scene, layout, other, &[(Quantity::Derivative, 1)])
}

/// The same with the factor by which derivatives by the state take fewer operations.
#[must_use]
pub fn lay_out_factor(scene: &Scene, layout: Layout) -> Layout {
    let solutions = 2 * layout.nv;
    let other = layout.with_other_factor();
    cheaper(
        scene,
        layout,
        other,
        &[(Quantity::Factor, 1), (Quantity::Solve, solutions)],
    )
}

/// Of two layouts the one in which some quantities, each so many times, take fewer operations.
fn cheaper(
    scene: &Scene,
    one: Layout,
    other: Option<Layout>,
    counted: &[(Quantity, usize)],
) -> Layout {
    let Some(other) = other else {
        return one;
    };
    let wanted: Vec<Quantity> = counted.iter().map(|(what, _)| *what).collect();
    let operations = |layout: &Layout| -> usize {
        let equations = SceneEquations::trace_in(scene, layout.clone(), &wanted);
        let each = counted
            .iter()
            .filter_map(|&(what, times)| Some(times * equations.program(what)?.cost().total()));
        each.sum()
    };
    match operations(&other) < operations(&one) {
        true => other,
        false => one,
    }
}

/// Entries of the largest mass matrix that is traced, of 4,096 speeds: no run needs it, and nearly all of it is zero.
const WIDEST: usize = 1 << 24;

impl SceneEquations {
    /// Traces every quantity the scene has a use for.
    #[must_use]
    pub fn trace(scene: &Scene) -> Self {
        let layout = lay_out(scene);
        let wanted = layout.quantities();
        Self::trace_in(scene, layout, &wanted)
    }

    /// The same, and what derivatives through the rows of joints are made of.
    #[must_use]
    pub fn trace_with_derivatives(scene: &Scene) -> Self {
        let layout = lay_out_factor(scene, lay_out(scene));
        let mut wanted = layout.quantities();
        wanted.extend(layout.derivatives());
        Self::trace_in(scene, layout, &wanted)
    }

    /// Traces some quantities.
    #[must_use]
    pub fn trace_only(scene: &Scene, wanted: &[Quantity]) -> Self {
        Self::trace_in(scene, lay_out(scene), wanted)
    }

    /// Traces some quantities of a scene that has been laid out.
    #[must_use]
    pub fn trace_in(scene: &Scene, layout: Layout, wanted: &[Quantity]) -> Self {
        let wanted: Vec<Quantity> = wanted
            .iter()
            .copied()
            .filter(|&what| layout.spells_out(what))
            .filter(|&what| what != Quantity::MassMatrix || layout.len(what) <= WIDEST)
            .collect();
        let ((constants, traced), graph) = session(|| trace(scene, &layout, &[], &wanted));
        let derived = derived(&graph, &traced);
        let outputs: Vec<(usize, Expr)> = derived.iter().copied().enumerate().collect();
        let places = TermPlaces::new(&graph, &derived, Slot::Derived);
        let asked: Vec<Term> = traced.iter().fold(constants, |mut all, quantity| {
            all.extend(&quantity.order);
            all
        });
        let nothing = TermPlaces::default();
        let kinematics = traced
            .iter()
            .find(|t| t.what == Quantity::Derivative)
            .map(|t| {
                let rates: Vec<(usize, Expr)> = t
                    .outputs
                    .iter()
                    .copied()
                    .filter(|&(place, _)| place < layout.nq)
                    .collect();
                Program::build(&graph, None, &rates, layout.nq, &t.order, &places)
            });
        let (mut programs, mut values) = (Vec::new(), Vec::new());
        for traced in &traced {
            let (what, outputs, order) = (traced.what, &traced.outputs, &traced.order);
            let len = layout.len(what);
            match &traced.by_column {
                None => {
                    let own = Program::build(&graph, Some(what), outputs, len, order, &places);
                    programs.push((what, own));
                }
                Some((read, columns)) => {
                    let (own, known) = by_column(&graph, traced, (read, columns), (len, &places));
                    programs.push((what, own));
                    values.push((what, known));
                }
            }
        }
        SceneEquations {
            kinematics: kinematics.filter(|program| program.len > 0),
            derived: Program::build(&graph, None, &outputs, outputs.len(), &asked, &nothing),
            programs,
            values,
            scene: scene.clone(),
            layout,
        }
    }

    /// A scene without equations: what is left of a declaration after an error.
    #[must_use]
    pub fn none(scene: &Scene) -> Self {
        let graph = Graph::default();
        let derived = Program::build(&graph, None, &[], 0, &[], &TermPlaces::default());
        let layout = Layout::keeping(scene, Redundancy::default());
        SceneEquations {
            derived,
            kinematics: None,
            programs: Vec::new(),
            values: Vec::new(),
            scene: scene.clone(),
            layout,
        }
    }

    /// The program of a quantity.
    #[must_use]
    pub fn program(&self, what: Quantity) -> Option<&Program> {
        self.programs
            .iter()
            .find(|(known, _)| *known == what)
            .map(|(_, program)| program)
    }

    /// What the derivatives of a matrix that is differentiated in one direction at a time read that does not depend on the direction.
    #[must_use]
    pub fn values(&self, what: Quantity) -> Option<&Program> {
        let mut values = self.values.iter();
        let found = values.find(|(known, _)| *known == what);
        found.map(|(_, program)| program)
    }

    /// Every program: those of the quantities, that of the parameters' terms, that of q̇, those of values.
    pub fn every_program(&self) -> impl Iterator<Item = &Program> {
        let programs = self.programs.iter().map(|(_, program)| program);
        let values = self.values.iter().map(|(_, program)| program);
        let programs = programs.chain([&self.derived]).chain(&self.kinematics);
        programs.chain(values)
    }

    /// The number of the first of [`SceneEquations::values`] among all programs.
    #[must_use]
    pub fn first_of_values(&self) -> usize {
        self.programs.len() + 1 + usize::from(self.kinematics.is_some())
    }

    /// Operations of a quantity: of a matrix that is differentiated in one direction at a time those of all columns.
    #[must_use]
    pub fn cost_of(&self, what: Quantity) -> Option<Cost> {
        let program = self.program(what)?;
        let columns = program
            .by_column
            .as_ref()
            .map_or(1, |own| own.columns.len());
        let before = self.values(what).map_or_else(Cost::default, Program::cost);
        Some((0..columns).fold(before, |sum, _| sum + program.cost()))
    }

    /// The section that a term of the parameters belongs to: index into the sections of its program.
    #[must_use]
    pub fn derived_section(&self, index: usize) -> usize {
        let register = self
            .derived
            .outputs
            .get(index)
            .map(|&(_, register)| register);
        match register.map(|register| self.derived.operand(register)) {
            Some(Operand::Value(value)) => self
                .derived
                .instructions
                .get(value)
                .map_or(0, |instruction| instruction.section),
            _ => 0,
        }
    }

    /// Operations of all quantities together.
    #[must_use]
    pub fn cost(&self) -> Cost {
        let costs = self.programs.iter();
        let costs = costs.filter_map(|&(what, _)| self.cost_of(what));
        costs.fold(self.derived.cost(), |sum, cost| sum + cost)
    }
}

/// The program of a column of a matrix, and that of what does not depend on the direction, in the order in which it is computed.
fn by_column(
    graph: &Graph,
    traced: &Traced,
    (read, columns): (&[Expr], &MatrixColumns),
    (len, places): (usize, &TermPlaces),
) -> (Program, Program) {
    let order = &traced.order;
    let values: Vec<(usize, Expr)> = read.iter().copied().enumerate().collect();
    let mut known = Program::build(graph, None, &values, values.len(), order, places);
    let mut computed: Vec<(Register, usize)> = known
        .outputs
        .iter()
        .map(|&(at, register)| (register, at))
        .collect();
    computed.sort_unstable();
    let values: Vec<Expr> = computed.iter().map(|&(_, at)| read[at]).collect();
    let registers = computed.into_iter().map(|(register, _)| register);
    known.outputs = registers.enumerate().collect();
    let rows = len / columns.width.max(1);
    let places = TermPlaces::new(graph, &values, Slot::Value);
    let (what, outputs) = (Some(traced.what), &traced.outputs);
    let own = Program::build(graph, what, outputs, rows, order, &places);
    let own = Program {
        by_column: Some(columns.clone()),
        ..own
    };
    (own, known)
}

/// Whether a quantity is a matrix of which only the structural non-zeros are written.
#[must_use]
pub fn is_matrix(what: Quantity) -> bool {
    matches!(
        what,
        Quantity::MassMatrix
            | Quantity::ConstraintJacobian
            | Quantity::CentreOfMassJacobian
            | Quantity::FrameJacobian(..)
            | Quantity::NodeByAnchor(_)
            | Quantity::CondensedStiffness(_)
            | Quantity::Factor
            | Quantity::Partial(..)
    )
}

fn slots(count: usize, slot: impl Fn(usize) -> Slot) -> Vec<Expr> {
    (0..count).map(|index| Expr::slot(slot(index))).collect()
}

/// How many numbers say how the origin of a scene moves: none where it stays in the world.
#[must_use]
pub fn of_origin(scene: &Scene) -> usize {
    match scene.runs.origin {
        Some(_) => origin::NUMBERS,
        None => 0,
    }
}

/// Which numbers of the state derivative are zero wherever these numbers of the state are, whatever all others are.
#[must_use]
pub(crate) fn vanishing_rates(scene: &Scene, layout: &Layout, zero: &[usize]) -> Vec<bool> {
    let (rates, _) = session(|| {
        let (_, traced) = trace(scene, layout, zero, &[Quantity::Derivative]);
        let outputs = traced.into_iter().flat_map(|traced| traced.outputs);
        outputs.map(|(_, rate)| rate.is_structural_zero()).collect()
    });
    rates
}

/// Runs the laws on symbols, some numbers of the state being zero. The first list holds the terms of the constants.
fn trace(
    scene: &Scene,
    layout: &Layout,
    zero: &[usize],
    wanted: &[Quantity],
) -> (Vec<Term>, Vec<Traced>) {
    let params = slots(layout.np, Slot::Param);
    let (numbers, constants) = recorded(|| Numbers::new(scene, &params));
    let mut state = slots(layout.nx(), Slot::State);
    for &place in zero {
        if let Some(number) = state.get_mut(place) {
            *number = Expr::zero();
        }
    }
    let nodes = slots(3 * layout.nodes.len(), Slot::Node);
    let effective = slots(layout.effective_numbers, Slot::Effective);
    let mut hold = slots(layout.holds(), Slot::Hold);
    hold.extend(slots(layout.turns.len(), |number| Slot::Turn {
        number,
        at: layout.holds() + number,
    }));
    hold.extend(slots(of_origin(scene), |number| Slot::Origin {
        number,
        at: layout.origin_at() + number,
    }));
    let ends = slots(layout.len(Quantity::AnchorStates), Slot::Ends);
    let inputs = slots(layout.ni, Slot::Input);
    let rows = slots(layout.nc, Slot::Row);
    let motion = slots(layout.nv + layout.nc, Slot::Motion);
    let at = At {
        time: Expr::slot(Slot::Time),
        state: &state,
        nodes: &nodes,
        effective: &effective,
        hold: &hold,
        ends: &ends,
        inputs: &inputs,
        rows: &rows,
    };
    let mut scratch = Scratch::new(layout);
    let mut factored: Vec<Expr> = Vec::new();
    let mut law = |what: Quantity| {
        let mut out = vec![Expr::zero(); layout.len(what)];
        let rows = match what {
            Quantity::Residual | Quantity::InverseDynamics => &motion,
            Quantity::Solve => &factored,
            _ => &rows,
        };
        let at = At { rows, ..at };
        let ((), order) = recorded(|| {
            mbd_scene::evaluate(what, scene, layout, &numbers, &at, &mut scratch, &mut out);
        });
        if what == Quantity::Factor {
            // What is known beforehand stays as it is: the solution skips its zeros.
            let known = |(index, expr): (usize, Expr)| match expr.is_live() {
                true => Expr::slot(Slot::Factored(index)),
                false => expr,
            };
            factored = out.iter().copied().enumerate().map(known).collect();
            let right = (0..layout.len(Quantity::Solve)).map(|number| Slot::Right {
                number,
                at: out.len() + number,
            });
            factored.extend(right.map(Expr::slot));
        }
        let keep = |&(_, expr): &(usize, Expr)| !is_matrix(what) || !expr.is_structural_zero();
        let outputs = out.into_iter().enumerate().filter(keep).collect();
        Traced {
            what,
            outputs,
            order,
            by_column: None,
        }
    };
    let mut traced: Vec<Traced> = Vec::new();
    if wanted.contains(&Quantity::Solve) && !wanted.contains(&Quantity::Factor) {
        law(Quantity::Factor);
    }
    for &what in wanted {
        let Quantity::Partial(of, by) = what else {
            traced.push(law(what));
            continue;
        };
        let known = traced.iter().position(|t| t.what == of.quantity());
        let base = known.map_or_else(
            || law(of.quantity()),
            |index| Traced {
                what: of.quantity(),
                outputs: traced[index].outputs.clone(),
                order: traced[index].order.clone(),
                by_column: None,
            },
        );
        traced.push(partial(scene, layout, what, by, base));
    }
    (constants, traced)
}

/// Differentiates a traced quantity. Its own terms come first, then the sweep of each variable, or the one of all directions.
fn partial(scene: &Scene, layout: &Layout, what: Quantity, by: Variable, base: Traced) -> Traced {
    let count = layout.variables(by);
    let variables: Vec<DerivativeVariable> = (0..count)
        .map(|index| {
            let slot = match by {
                Variable::State => Slot::State(index),
                Variable::Node => Slot::Node(index),
                Variable::Parameter => Slot::Param(index),
                Variable::Input => Slot::Input(index),
            };
            DerivativeVariable {
                slot,
                name: names::slot(scene, layout, slot),
            }
        })
        .collect();
    let mut order = base.order;
    if let Some(found) = directional(layout, &base.outputs, &variables, &order) {
        order.extend(found.order);
        return Traced {
            what,
            outputs: found.outputs,
            order,
            by_column: Some((found.values, found.columns)),
        };
    }
    let (entries, swept) = recorded(|| jacobian(&base.outputs, &variables));
    let outputs = entries
        .into_iter()
        .map(|(row, column, expr)| (row * count + column, expr))
        .collect();
    order.extend(swept);
    Traced {
        what,
        outputs,
        order,
        by_column: None,
    }
}

/// The terms of the parameters alone that live terms or results use, in the order of creation.
fn derived(graph: &Graph, traced: &[Traced]) -> Vec<Expr> {
    let mut found = Vec::new();
    let mut seen = vec![false; graph.len()];
    for quantity in traced {
        let mut open: Vec<Expr> = quantity.outputs.iter().map(|&(_, expr)| expr).collect();
        while let Some(expr) = open.pop() {
            let TermKind::Apply(op) = graph.node(expr) else {
                continue;
            };
            if std::mem::replace(&mut seen[expr.index()], true) {
                continue;
            }
            // A mask is no number: it is compared again where it is used.
            if graph.is_live(expr) || matches!(op, Op::Compare(..)) {
                for argument in op.arguments() {
                    open.push(argument);
                }
            } else {
                found.push(expr);
            }
        }
    }
    found.sort_unstable_by_key(|expr| expr.index());
    found
}
