//! What a model can be asked for, by running the laws on a scalar.

mod residual;
mod with_multipliers;

pub use with_multipliers::evaluate_with_multipliers;

use crate::elimination::Constraints;
use crate::laws::{
    energy,
    evaluation::Evaluation,
    forces::{self, AppliedForces},
    gravity, joint_forces,
    kinematics::Kinematics,
    mass, measured, node,
    numbers::Numbers,
    rate,
};
use crate::scalar::algebra::write;
use crate::{At, Layout, PointSlots, Quantity, Real, Scene};

/// Scratch of one evaluation: carries nothing from call to call.
#[derive(Clone, Debug)]
pub struct Scratch<S: Real> {
    kinematics: Kinematics<S>,
    multipliers: Vec<S>,
    reactions: Vec<S>,
    rates: Vec<S>,
    nodes: Vec<S>,
    assembly: AppliedForces<S>,
    constraints: Constraints<S>,
}

impl<S: Real> Scratch<S> {
    /// Room for the scene of a layout.
    #[must_use]
    pub fn new(layout: &Layout) -> Self {
        let (bodies, points) = (layout.bodies.len(), layout.points.len());
        Scratch {
            kinematics: Kinematics::new(layout),
            multipliers: Vec::new(),
            reactions: Vec::new(),
            rates: Vec::new(),
            nodes: Vec::new(),
            assembly: AppliedForces::new(bodies, points),
            constraints: Constraints::new(layout),
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
        Quantity::Partial(..) => return,
        _ => {}
    }
    let evaluation = scratch.kinematics.read(scene, layout, numbers, at);
    let asked = layout.asked(what);
    let evaluation = if asked.any() {
        scratch.assembly.collect(&evaluation);
        if layout.nc > 0 {
            scratch
                .constraints
                .accelerate(&evaluation, &scratch.assembly);
        }
        let lists = [
            (
                asked.multipliers,
                Quantity::Multipliers,
                &mut scratch.multipliers,
            ),
            (asked.reactions, Quantity::Reactions, &mut scratch.reactions),
        ];
        for (asked, forces, list) in lists {
            list.clear();
            if asked {
                list.resize(layout.len(forces), S::zero());
                scratch.constraints.write_forces(forces, &evaluation, list);
            }
        }
        scratch.rates.clear();
        if asked.accelerations {
            scratch.rates.resize(layout.nx(), S::zero());
            derivative(
                &evaluation,
                &scratch.assembly,
                &scratch.constraints,
                &mut scratch.rates,
            );
        }
        Evaluation {
            multipliers: &scratch.multipliers,
            reactions: &scratch.reactions,
            accelerations: scratch
                .rates
                .get(layout.nq..layout.nq + layout.nv)
                .unwrap_or_default(),
            ..evaluation
        }
    } else {
        evaluation
    };
    match what {
        Quantity::AnchorStates => measured::ends(&evaluation, out),
        Quantity::Derivative | Quantity::Rates => {
            let (rates, rest) = out.split_at_mut(layout.nx());
            scratch.nodes.clear();
            scratch.nodes.extend_from_slice(at.nodes);
            if what == Quantity::Rates {
                let (ends, certificates) = rest.split_at_mut(layout.len(Quantity::AnchorStates));
                measured::ends(&evaluation, ends);
                rate::velocities(&evaluation, &mut scratch.nodes, certificates);
            }
            let at = At {
                nodes: &scratch.nodes,
                ..*at
            };
            let evaluation = Evaluation {
                at: &at,
                ..evaluation
            };
            scratch.assembly.collect(&evaluation);
            if layout.nc > 0 {
                scratch
                    .constraints
                    .accelerate(&evaluation, &scratch.assembly);
            }
            derivative(&evaluation, &scratch.assembly, &scratch.constraints, rates);
        }
        Quantity::Balance => {
            scratch.assembly.collect(&evaluation);
            for (node, declared) in layout.nodes.iter().enumerate() {
                if let Some(force) = scratch.assembly.points.get(declared.point) {
                    write(out, 3 * node, force);
                }
            }
        }
        Quantity::Forces => {
            scratch.assembly.collect(&evaluation);
            mass::applied_forces(&evaluation, &scratch.assembly, out);
        }
        Quantity::Guards => measured::guards(&evaluation, out),
        Quantity::Outputs => measured::outputs(&evaluation, out),
        Quantity::Coordinates => measured::coordinates(&evaluation, out),
        Quantity::Energy => {
            let drives = forces::drive_power(&evaluation);
            let through_joints = if layout.joints.iter().any(|joint| joint.driven) {
                scratch.assembly.collect(&evaluation);
                scratch
                    .constraints
                    .accelerate(&evaluation, &scratch.assembly);
                scratch.constraints.drive_power(&evaluation)
            } else {
                S::zero()
            };
            energy::energy(&evaluation, drives + through_joints, out);
        }
        Quantity::Momentum => energy::momentum(&evaluation, out),
        Quantity::MassMatrix => mass::mass_matrix(&evaluation, out),
        Quantity::BiasForce => mass::bias_force(&evaluation, out),
        Quantity::Lines => measured::lines(&evaluation, out),
        Quantity::Constraint
        | Quantity::ConstraintJacobian
        | Quantity::ConstraintRate
        | Quantity::ConstraintBias => scratch.constraints.write(what, &evaluation, out),
        Quantity::Multipliers | Quantity::Reactions => {
            scratch.assembly.collect(&evaluation);
            scratch
                .constraints
                .accelerate(&evaluation, &scratch.assembly);
            scratch.constraints.write_forces(what, &evaluation, out);
        }
        Quantity::ProjectionStep => scratch.constraints.correct(&evaluation, out),
        Quantity::Residual => {
            scratch.assembly.collect(&evaluation);
            residual::residual(
                &evaluation,
                &scratch.assembly,
                &mut scratch.constraints,
                out,
            );
        }
        Quantity::JointCoordinates => measured::joint_coordinates(&evaluation, out),
        Quantity::Factor => scratch.constraints.write_factor(&evaluation, out),
        Quantity::Solve => scratch.constraints.solve_by_factor(&evaluation, out),
        Quantity::Equilibrium(_)
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

/// ẋ: q̇ = N(q) v, ż = w, ṡ as declared; v̇ = M⁻¹ (f − h) of what no joint holds, the solution of the constrained system for the rest.
fn derivative<S: Real>(
    evaluation: &Evaluation<'_, S>,
    assembly: &AppliedForces<S>,
    constraints: &Constraints<S>,
    out: &mut [S],
) {
    let (layout, numbers) = (evaluation.layout, evaluation.numbers);
    let (directions, components) = (layout.directions, evaluation.scene.angular_velocity);
    for (index, slots) in layout.bodies.iter().enumerate() {
        S::section(&evaluation.scene.bodies[index].name);
        let (motion, body, (force, torque)) = (
            &evaluation.motions[index],
            &numbers.bodies[index],
            &assembly.bodies[index],
        );
        evaluation.write_body_rate(index, *slots, out);
        let at = layout.nq + slots.v;
        if let Some([acceleration, spin]) = constraints.body_acceleration(evaluation, index) {
            directions.write_linear(out, at, &acceleration);
            directions.write_angular(out, at, &spin);
            continue;
        }
        let acceleration =
            force.map(|f| f * body.inverse_mass) + gravity::body_gravity(evaluation, index);
        directions.write_linear(out, at, &acceleration);
        let spin = motion.angular_acceleration(body, torque, components);
        directions.write_angular(out, at, &spin);
    }
    for (index, slots) in layout.points.iter().enumerate() {
        if let PointSlots::Mass(slots) = slots {
            S::section(&evaluation.scene.points[index].name);
            let at = layout.nq + slots.v;
            evaluation.write_point_rate(*slots, out);
            if let Some(acceleration) = constraints.point_acceleration(evaluation, index) {
                directions.write_linear(out, at, &acceleration);
                continue;
            }
            let inverse_mass = numbers.points[index].1;
            let acceleration = assembly.points[index].map(|f| f * inverse_mass)
                + gravity::point_gravity(evaluation, index, slots.q);
            directions.write_linear(out, at, &acceleration);
        }
    }
    evaluation.write_other_rates(out);
}

/// Writes the diagonal of the mass matrix (n_v) [kg, kg m²].
pub fn masses<S: Real>(
    scene: &Scene,
    layout: &Layout,
    numbers: &Numbers<S>,
    at: &At<'_, S>,
    scratch: &mut Scratch<S>,
    out: &mut [S],
) {
    mass::masses(&scratch.kinematics.read(scene, layout, numbers, at), out);
}

/// Writes momentum, force and torque of gravity and loads, and how much momentum moves: P [kg m/s], L [kg m²/s], F [N], τ [N m], Σ |m v|,
/// Σ |r × m v| + |I ω|; L and τ about the world origin (14 numbers).
pub fn impulses<S: Real>(
    scene: &Scene,
    layout: &Layout,
    numbers: &Numbers<S>,
    at: &At<'_, S>,
    scratch: &mut Scratch<S>,
    out: &mut [S],
) {
    let evaluation = scratch.kinematics.read(scene, layout, numbers, at);
    energy::impulses(&evaluation, out);
}

/// Appends the angles in (−π, π] that a spring or a stop pushes back, joint by joint: where one jumps by a full turn, so does the torque.
pub fn jumping_angles<S: Real>(
    scene: &Scene,
    layout: &Layout,
    numbers: &Numbers<S>,
    at: &At<'_, S>,
    scratch: &mut Scratch<S>,
    out: &mut Vec<S>,
) {
    let evaluation = scratch.kinematics.read(scene, layout, numbers, at);
    joint_forces::visit(&evaluation, |acting| {
        if acting.jumps() {
            out.push(acting.value());
        }
    });
}

/// Appends value, rate and acceleration of every motor whose value is an input, or depends on one: what the caller commands. In the order of
/// [`Scene::commanded`], then free length and rate of the lines of [`Scene::commanded_lines`], whose acceleration nobody gives: zero.
pub fn commands<S: Real>(
    scene: &Scene,
    layout: &Layout,
    numbers: &Numbers<S>,
    at: &At<'_, S>,
    scratch: &mut Scratch<S>,
    out: &mut Vec<[S; 3]>,
) {
    let evaluation = scratch.kinematics.read(scene, layout, numbers, at);
    for (joint, index) in scene.commanded() {
        let motors = scene.joints[joint].motors();
        for (_, course) in motors.filter(|(driven, _)| *driven == index) {
            let course = evaluation.course(course);
            out.push([course.value, course.rate, course.curve]);
        }
    }
    for line in scene.commanded_lines() {
        let told = [evaluation.wound(line), evaluation.rate_of_winding(line)];
        let [length, rate] = told.map(|number| number.unwrap_or_else(|| S::from_f64(f64::NAN)));
        out.push([length, rate, S::zero()]);
    }
}
