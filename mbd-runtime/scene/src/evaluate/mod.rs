//! What a model can be asked for, by running the laws on a scalar.

mod derivative;
mod handed;
mod residual;
mod solver;
mod with_multipliers;

pub use handed::{Handed, handed};
pub use with_multipliers::evaluate_with_multipliers;

use nalgebra::Vector3;

use crate::columns::each_column;
use crate::joints::Fold;
use crate::laws::{
    branch_of, energy,
    evaluation::Evaluation,
    forces::{self, AppliedForces},
    formula, jacobian,
    kinematics::Kinematics,
    mass, measured, node,
    numbers::Numbers,
    rate,
};
use crate::scalar::algebra::write;
use crate::tree::SpatialInertia;
use crate::{At, Formula, JointStart, Layout, Quantity, Real, Scene};
use solver::MotionSolver;

/// Scratch of one evaluation: carries nothing from call to call.
#[derive(Clone, Debug)]
pub struct Scratch<S: Real> {
    kinematics: Kinematics<S>,
    multipliers: Vec<S>,
    reactions: Vec<S>,
    rates: Vec<S>,
    bodies: Vec<[Vector3<S>; 2]>,
    nodes: Vec<S>,
    balanced: Vec<Option<[S; 2]>>,
    still: Vec<S>,
    residual: Vec<S>,
    columns: Vec<S>,
    moments: Vec<SpatialInertia<S>>,
    assembly: AppliedForces<S>,
    solver: MotionSolver<S>,
}

impl<S: Real> Scratch<S> {
    /// Room for the scene of a layout.
    #[must_use]
    pub fn new(layout: &Layout) -> Self {
        Scratch {
            kinematics: Kinematics::new(layout),
            multipliers: Vec::new(),
            reactions: Vec::new(),
            rates: Vec::new(),
            bodies: Vec::new(),
            nodes: Vec::new(),
            balanced: Vec::new(),
            still: Vec::new(),
            residual: Vec::new(),
            columns: Vec::new(),
            moments: Vec::new(),
            assembly: AppliedForces::new(layout),
            solver: MotionSolver::new(layout),
        }
    }
}

/// Evaluates a quantity by running the laws on the scalar `S`.
///
/// Lists are written whole; of matrices only structural non-zeros are written, so `out` **starts at zero** there.
/// [`Quantity::Partial`] is not a law: symbols differentiate their trace, numbers run on duals. A slice of a wrong length leaves `out` untouched.
pub fn evaluate<S: Real>(
    what: Quantity,
    scene: &Scene,
    layout: &Layout,
    numbers: &Numbers<S>,
    at: &At<'_, S>,
    scratch: &mut Scratch<S>,
    out: &mut [S],
) {
    if what == Quantity::Solve && out.len() > layout.len(what) {
        let mut columns = std::mem::take(&mut scratch.columns);
        let matrices = (at.rows, out);
        each_column(layout.len(what), matrices, &mut columns, |rows, out| {
            let at = At { rows, ..*at };
            evaluate(what, scene, layout, numbers, &at, scratch, out);
        });
        scratch.columns = columns;
        return;
    }
    if out.len() != layout.len(what) {
        return;
    }
    match what {
        Quantity::Equilibrium(network) => {
            return node::equilibrium(layout, at, network, |line| scene.line_name(line), out);
        }
        Quantity::NodeByAnchor(_) | Quantity::CondensedStiffness(_) => {
            return sensitivity(what, layout, at, out);
        }
        Quantity::GravityForce => {
            let mut still = std::mem::take(&mut scratch.still);
            still.clear();
            still.extend_from_slice(at.state);
            let speeds = still.get_mut(layout.nq..layout.nq + layout.nv);
            speeds.unwrap_or_default().fill(S::zero());
            let at = At {
                state: &still,
                ..*at
            };
            evaluate(
                Quantity::BiasForce,
                scene,
                layout,
                numbers,
                &at,
                scratch,
                out,
            );
            scratch.still = still;
            return;
        }
        Quantity::Partial(..) => return,
        _ => {}
    }
    let Scratch {
        kinematics,
        multipliers,
        reactions,
        rates,
        bodies,
        nodes,
        balanced,
        still: _,
        residual,
        columns: _,
        moments,
        assembly,
        solver,
    } = scratch;
    let evaluation = kinematics.read(scene, layout, numbers, at);
    let asked = layout.asked(what);
    let evaluation = if asked.any() {
        assembly.collect(&evaluation);
        solver.accelerate(&evaluation, assembly);
        // What acts along coordinates pushes where no row holds anything, too.
        let pushed = 6 * layout.joints.len();
        for (asked, forces, count, list) in [
            (
                asked.multipliers,
                Quantity::Multipliers,
                layout.nc,
                &mut *multipliers,
            ),
            (
                asked.reactions,
                Quantity::Reactions,
                pushed,
                &mut *reactions,
            ),
        ] {
            list.clear();
            if asked {
                list.resize(count, S::zero());
                solver.write_solved(forces, &evaluation, assembly, list);
            }
        }
        rates.clear();
        if asked.accelerations {
            rates.resize(layout.nx(), S::zero());
            solver.write_derivative(&evaluation, assembly, rates);
            let own = rates.get(layout.nq..layout.nq + layout.nv);
            solver.body_accelerations(&evaluation, own.unwrap_or_default(), bodies);
        }
        Evaluation {
            multipliers,
            reactions,
            accelerations: rates
                .get(layout.nq..layout.nq + layout.nv)
                .unwrap_or_default(),
            body_accelerations: bodies,
            ..evaluation
        }
    } else if what == Quantity::JointCoordinates
        && let Some(given @ [_, ..]) = at.rows.get(..layout.nv)
    {
        // Joints that close loops are measured on the bodies that those of the tree move.
        solver.body_accelerations(&evaluation, given, bodies);
        Evaluation {
            accelerations: given,
            body_accelerations: bodies,
            ..evaluation
        }
    } else {
        evaluation
    };
    match what {
        Quantity::AnchorStates => measured::ends(&evaluation, out),
        Quantity::Derivative | Quantity::Rates => {
            let (rates, rest) = out.split_at_mut(layout.nx());
            nodes.clear();
            nodes.extend_from_slice(at.nodes);
            balanced.clear();
            if what == Quantity::Rates {
                let (ends, certificates) = rest.split_at_mut(layout.len(Quantity::AnchorStates));
                measured::ends(&evaluation, ends);
                balanced.resize(layout.lines.len(), None);
                rate::velocities(&evaluation, nodes, certificates, balanced);
            }
            let at = At { nodes, ..*at };
            let evaluation = Evaluation {
                at: &at,
                balanced,
                ..evaluation
            };
            assembly.collect(&evaluation);
            solver.accelerate(&evaluation, assembly);
            solver.write_derivative(&evaluation, assembly, rates);
        }
        Quantity::Balance => {
            assembly.collect(&evaluation);
            for (node, declared) in layout.nodes.iter().enumerate() {
                if let Some(force) = assembly.points.get(declared.point) {
                    write(out, 3 * node, force);
                }
            }
        }
        Quantity::Forces => {
            assembly.collect(&evaluation);
            solver.write_applied(&evaluation, assembly, out);
        }
        Quantity::Guards => measured::guards(&evaluation, out),
        Quantity::Outputs => measured::outputs(&evaluation, out),
        Quantity::Coordinates => measured::coordinates(&evaluation, out),
        Quantity::CountedAngles => measured::counted_angles(&evaluation, out),
        Quantity::Energy => {
            let mut drives = forces::drive_power(&evaluation);
            if layout.joints.iter().any(|joint| joint.driven) {
                assembly.collect(&evaluation);
                solver.accelerate(&evaluation, assembly);
                drives += solver.drive_power(&evaluation, assembly);
            }
            energy::energy(&evaluation, drives, out);
        }
        Quantity::Momentum => energy::momentum(&evaluation, out),
        Quantity::Bodies => measured::bodies(&evaluation, out),
        Quantity::MassMatrix => solver.write_mass(&evaluation, out),
        Quantity::BiasForce => solver.write_bias(&evaluation, out),
        Quantity::Lines => measured::lines(&evaluation, out),
        Quantity::Constraint
        | Quantity::ConstraintJacobian
        | Quantity::ConstraintRate
        | Quantity::ConstraintBias => solver.write_rows(what, &evaluation, out),
        Quantity::Multipliers | Quantity::Reactions => {
            assembly.collect(&evaluation);
            solver.accelerate(&evaluation, assembly);
            solver.write_solved(what, &evaluation, assembly, out);
        }
        Quantity::ProjectionStep => solver.correct(&evaluation, out),
        Quantity::Residual => {
            assembly.collect(&evaluation);
            solver.write_residual(&evaluation, assembly, out);
        }
        Quantity::InverseDynamics => {
            assembly.collect(&evaluation);
            residual.clear();
            residual.resize(layout.len(Quantity::Residual), S::zero());
            solver.write_residual(&evaluation, assembly, residual);
            let own = residual.get(layout.nq..layout.nq + layout.nv);
            out.copy_from_slice(own.unwrap_or_default());
        }
        Quantity::CentreOfMass => energy::centre_of_mass(&evaluation, out),
        Quantity::CentreOfMassJacobian => jacobian::centre_of_mass(&evaluation, moments, out),
        Quantity::FrameJacobian(body, frame) => {
            jacobian::frame(&evaluation, [body, frame], moments, out);
        }
        Quantity::JointCoordinates => measured::joint_coordinates(&evaluation, out),
        Quantity::Factor => solver.write_factor(&evaluation, out),
        Quantity::Solve => solver.solve_by_factor(&evaluation, out),
        Quantity::GravityForce
        | Quantity::Equilibrium(_)
        | Quantity::NodeByAnchor(_)
        | Quantity::CondensedStiffness(_)
        | Quantity::Partial(..) => {}
    }
}

/// Evaluates [`Quantity::NodeByAnchor`] or [`Quantity::CondensedStiffness`], which read nothing of a scene but its layout: a model that does
/// not spell them out ([`Layout::spells_out`]) solves its network for them on numbers.
pub fn sensitivity<S: Real>(what: Quantity, layout: &Layout, at: &At<'_, S>, out: &mut [S]) {
    if out.len() != layout.len(what) {
        return;
    }
    match what {
        Quantity::NodeByAnchor(network) => node::node_by_anchor(layout, at, network, out),
        Quantity::CondensedStiffness(network) => {
            node::condensed_stiffness(layout, at, network, out);
        }
        _ => {}
    }
}

/// Writes the diagonal of the mass matrix (n_v) [kg, kg m²].
pub fn masses(
    scene: &Scene,
    layout: &Layout,
    numbers: &Numbers<f64>,
    at: &At<'_, f64>,
    scratch: &mut Scratch<f64>,
    out: &mut [f64],
) {
    let evaluation = scratch.kinematics.read(scene, layout, numbers, at);
    match scratch.solver.tree() {
        Some(tree) => tree.write_masses(&evaluation, out),
        None => mass::masses(&evaluation, out),
    }
}

/// Writes how large the element of Φ_v M⁻¹ Φ_vᵀ of each row of joints is at least (n_c) [1/kg, 1/(kg m²)], where it can vanish: in relative
/// coordinates, of the joints that close loops. Zero elsewhere.
pub fn row_sizes(
    scene: &Scene,
    layout: &Layout,
    numbers: &Numbers<f64>,
    at: &At<'_, f64>,
    scratch: &mut Scratch<f64>,
    out: &mut [f64],
) {
    let evaluation = scratch.kinematics.read(scene, layout, numbers, at);
    match scratch.solver.tree() {
        Some(tree) => tree.write_row_sizes(&evaluation, out),
        None => out.fill(0.0),
    }
}

/// Writes momentum, force and torque of gravity and loads, and how much momentum moves: P [kg m/s], L [kg m²/s], F [N], τ [N m], Σ |m v|,
/// Σ |r| |m v| + |I ω|, the sizes of forces and of their torques; L and τ about the world origin (16 numbers).
pub fn impulses(
    scene: &Scene,
    layout: &Layout,
    numbers: &Numbers<f64>,
    at: &At<'_, f64>,
    scratch: &mut Scratch<f64>,
    out: &mut [f64],
) {
    let evaluation = scratch.kinematics.read(scene, layout, numbers, at);
    energy::impulses(&evaluation, out);
}

/// The coordinates that motors drive, where their courses have them.
pub(crate) fn driven_coordinates(
    scene: &Scene,
    layout: &Layout,
    numbers: &Numbers<f64>,
    at: &At<'_, f64>,
    scratch: &mut Scratch<f64>,
) -> Vec<JointStart> {
    let any = scene.joints.iter().any(|it| it.motors().next().is_some());
    if !any {
        return Vec::new();
    }
    let evaluation = scratch.kinematics.read(scene, layout, numbers, at);
    let joints = scene.joints.iter().enumerate();
    let motors = joints.flat_map(|(index, joint)| joint.motors().map(move |it| (index, it)));
    let driven = motors.map(|(joint, (coordinate, formula))| {
        let course = evaluation.course(formula);
        JointStart {
            joint,
            coordinate,
            value: Some(course.value),
            rate: Some(course.rate),
            about: false,
        }
    });
    driven.collect()
}

/// Appends the coordinate that every lock holds, or would hold [m or rad], in the order of [`JointSlots::held`](crate::JointSlots::held).
pub fn locked(
    scene: &Scene,
    layout: &Layout,
    numbers: &Numbers<f64>,
    at: &At<'_, f64>,
    scratch: &mut Scratch<f64>,
    out: &mut Vec<f64>,
) {
    let evaluation = scratch.kinematics.read(scene, layout, numbers, at);
    let joints = scene.joints.iter().zip(&layout.joints);
    let locks = joints.filter(|(_, slots)| slots.held.is_some());
    let coordinates = locks.filter_map(|(joint, _)| joint.law.couples().first());
    out.extend(coordinates.map(|&(joint, index)| {
        let value = formula::Context::coordinate(&evaluation, joint, index);
        value.unwrap_or(f64::NAN)
    }));
}

/// Appends one number a formula [SI].
pub fn scalars(
    formulas: &mut dyn Iterator<Item = &Formula>,
    scene: &Scene,
    layout: &Layout,
    numbers: &Numbers<f64>,
    at: &At<'_, f64>,
    scratch: &mut Scratch<f64>,
    out: &mut Vec<f64>,
) {
    let evaluation = scratch.kinematics.read(scene, layout, numbers, at);
    out.extend(formulas.map(|one| formula::scalar(one, &evaluation)));
}

/// What a motor is told, or a line that is wound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToldMotion {
    /// Value, rate and acceleration of a motor; free length and rate of a line, whose acceleration nobody gives: zero.
    pub told: [f64; 3],
    /// The rates of value and rate as they follow from their expressions, inputs held; of a line that of its free length alone.
    pub follows: [f64; 2],
}

/// The first joint that motion took to another branch, of those that are `joined`, and how.
pub fn folded(
    scene: &Scene,
    layout: &Layout,
    numbers: &Numbers<f64>,
    at: &At<'_, f64>,
    scratch: &mut Scratch<f64>,
    joined: &dyn Fn(usize) -> bool,
) -> Option<(usize, Fold)> {
    let evaluation = scratch.kinematics.read(scene, layout, numbers, at);
    let mut folding = scene.folding_joints().filter(|(joint, _)| joined(*joint));
    folding.find(|(joint, fold)| branch_of(&evaluation, *joint)[0] < fold.least)
}

/// Appends what every motor is told, in the order of [`Scene::commanded`], then every line of [`Scene::commanded_lines`].
pub fn commands(
    scene: &Scene,
    layout: &Layout,
    numbers: &Numbers<f64>,
    at: &At<'_, f64>,
    scratch: &mut Scratch<f64>,
    out: &mut Vec<ToldMotion>,
) {
    let evaluation = scratch.kinematics.read(scene, layout, numbers, at);
    let motors = scene.commanded().map(|(_, parts)| parts);
    for parts in motors.chain(scene.commanded_lines().map(|(_, parts)| parts)) {
        let number = |index: usize| match parts.get(index) {
            Some(part) => formula::scalar(part, &evaluation),
            None => 0.0,
        };
        let follows = |index: usize| match parts.get(index + 1) {
            Some(_) => evaluation.rate_of(&parts[index]),
            None => 0.0,
        };
        out.push(ToldMotion {
            told: [0, 1, 2].map(number),
            follows: [0, 1].map(follows),
        });
    }
}
