//! The laws of mechanics, each written once over [`Real`]: numbers run them, dual numbers differentiate them, symbols record them.

mod algebra;
mod along;
mod articulated;
mod assemble;
mod body;
mod configuration;
mod constraint;
mod coordinate;
mod coupling;
mod ends;
mod evaluation;
mod forces;
mod formula;
mod given;
mod gravity;
mod ground;
mod joint_ends;
mod kinematics;
pub mod line;
mod motor;
mod node;
mod numbers;
mod reference;
pub mod rows;
mod system;

use algebra::{elements, vector, write};
use constraint::Constraints;
use evaluation::Evaluation;
use forces::Assembly;
use kinematics::Kinematics;
use nalgebra::Vector3;

pub use algebra::{inverse, rotation, symmetric};
pub use along::{AlongNumbers, jumping_angles};

pub(crate) use configuration::Configuration;
pub use coupling::{Coupling, is_discontinuous};
pub use formula::norm;
pub use given::evaluate_given;
pub use ground::{FrameMotion, ground};
pub use joint_ends::{branch, out_of_plane};
pub use numbers::{
    BodyNumbers, FrameNumbers, GravityNumbers, LineNumbers, Numbers, OblateNumbers, constant,
};

use crate::{At, InputSource, Layout, PointSlots, Quantity, Real, Scene};

/// Scratch of one evaluation: carries nothing from call to call.
#[derive(Clone, Debug)]
pub struct Scratch<S: Real> {
    kinematics: Kinematics<S>,
    multipliers: Vec<S>,
    assembly: Assembly<S>,
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
            assembly: Assembly::new(bodies, points),
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
            return node::equilibrium(layout, at, network, |line| line_name(scene, line), out);
        }
        Quantity::NodeByAnchor(_) | Quantity::CondensedStiffness(_) => {
            return sensitivity(what, layout, at, out);
        }
        Quantity::Partial(..) => return,
        _ => {}
    }
    let evaluation = scratch.kinematics.read(scene, layout, numbers, at);
    let evaluation = if layout.asks_efforts(what) {
        scratch.assembly.collect(&evaluation);
        scratch
            .constraints
            .accelerate(&evaluation, &scratch.assembly);
        scratch.multipliers.resize(layout.nc, S::zero());
        scratch.constraints.write_forces(
            Quantity::Multipliers,
            &evaluation,
            &mut scratch.multipliers,
        );
        Evaluation {
            multipliers: &scratch.multipliers,
            ..evaluation
        }
    } else {
        evaluation
    };
    match what {
        Quantity::Ends => ends(&evaluation, out),
        Quantity::Derivative => {
            scratch.assembly.collect(&evaluation);
            if layout.nc > 0 {
                scratch
                    .constraints
                    .accelerate(&evaluation, &scratch.assembly);
            }
            derivative(&evaluation, &scratch.assembly, &scratch.constraints, out);
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
            applied_forces(&evaluation, &scratch.assembly, out);
        }
        Quantity::Guards => guards(&evaluation, out),
        Quantity::Outputs => outputs(&evaluation, out),
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
            energy(&evaluation, drives + through_joints, out);
        }
        Quantity::Momentum => momentum(&evaluation, out),
        Quantity::MassMatrix => mass_matrix(&evaluation, out),
        Quantity::BiasForce => bias_force(&evaluation, out),
        Quantity::Lines => lines(&evaluation, out),
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
        Quantity::Correction => scratch.constraints.correct(&evaluation, out),
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

fn line_name(scene: &Scene, line: usize) -> &str {
    scene
        .lines
        .get(line)
        .map_or("line", |line| line.name.as_str())
}

fn ends<S: Real>(evaluation: &Evaluation<'_, S>, out: &mut [S]) {
    let layout = evaluation.layout;
    for (index, anchor) in layout.anchors.iter().enumerate() {
        S::section(line_name(evaluation.scene, anchor.line));
        if let (Some(p), Some(v)) = (
            evaluation.position_of(anchor.place),
            evaluation.velocity_of(anchor.place),
        ) {
            write(out, 6 * index, &p);
            write(out, 6 * index + 3, &v);
        }
    }
    for (index, node) in layout.nodes.iter().enumerate() {
        write(
            out,
            6 * layout.anchors.len() + 3 * index,
            &forces::node_load(evaluation, node.point),
        );
    }
}

/// Gravity at a body [m/s²].
fn body_gravity<S: Real>(evaluation: &Evaluation<'_, S>, body: usize) -> Vector3<S> {
    let given = evaluation.given(InputSource::BodyGravity(body), 0);
    gravity::acceleration(
        &evaluation.numbers.gravity,
        &evaluation.motions[body].position,
        &given,
    )
}

/// Gravity at a point with mass [m/s²].
fn point_gravity<S: Real>(evaluation: &Evaluation<'_, S>, point: usize, q: usize) -> Vector3<S> {
    let given = evaluation.given(InputSource::PointGravity(point), 0);
    gravity::acceleration(
        &evaluation.numbers.gravity,
        &evaluation.layout.directions.linear(evaluation.at.state, q),
        &given,
    )
}

/// ẋ: q̇ = N(q) v, ż = w; v̇ = M⁻¹ (f − h) of what no joint holds, the solution of the constrained system for the rest.
fn derivative<S: Real>(
    evaluation: &Evaluation<'_, S>,
    assembly: &Assembly<S>,
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
        directions.write_linear(out, slots.q, &motion.velocity);
        let attitude = slots.q + directions.moves().len();
        motion.write_attitude_rate(out, attitude, directions, components);
        let at = layout.nq + slots.v;
        if let Some([acceleration, spin]) = constraints.body_acceleration(evaluation, index) {
            directions.write_linear(out, at, &acceleration);
            directions.write_angular(out, at, &spin);
            continue;
        }
        let acceleration = force.map(|f| f * body.inverse_mass) + body_gravity(evaluation, index);
        directions.write_linear(out, at, &acceleration);
        let spin = motion.angular_acceleration(body, torque, components);
        directions.write_angular(out, at, &spin);
    }
    for (index, slots) in layout.points.iter().enumerate() {
        if let PointSlots::Mass(slots) = slots {
            S::section(&evaluation.scene.points[index].name);
            let at = layout.nq + slots.v;
            let velocity: Vector3<S> = directions.linear(evaluation.at.state, at);
            directions.write_linear(out, slots.q, &velocity);
            if let Some(acceleration) = constraints.point_acceleration(evaluation, index) {
                directions.write_linear(out, at, &acceleration);
                continue;
            }
            let inverse_mass = numbers.points[index].1;
            let acceleration = assembly.points[index].map(|f| f * inverse_mass)
                + point_gravity(evaluation, index, slots.q);
            directions.write_linear(out, at, &acceleration);
        }
    }
    for (index, node) in layout.nodes.iter().enumerate() {
        if let Some(z) = node.z {
            write(
                out,
                layout.nq + layout.nv + z,
                &vector(evaluation.at.nodes, 3 * index),
            );
        }
    }
}

fn applied_forces<S: Real>(evaluation: &Evaluation<'_, S>, assembly: &Assembly<S>, out: &mut [S]) {
    let directions = evaluation.layout.directions;
    for (index, slots) in evaluation.layout.bodies.iter().enumerate() {
        S::section(&evaluation.scene.bodies[index].name);
        let ((force, torque), own) = (assembly.bodies[index], assembly.own[index]);
        directions.write_linear(out, slots.v, &force);
        let torque = match evaluation.scene.angular_velocity {
            crate::AngularVelocity::Body => {
                evaluation.motions[index].rotation.transpose() * torque + own
            }
            crate::AngularVelocity::World => torque + evaluation.motions[index].rotation * own,
        };
        directions.write_angular(out, slots.v, &torque);
    }
    for (index, slots) in evaluation.layout.points.iter().enumerate() {
        if let PointSlots::Mass(slots) = slots {
            directions.write_linear(out, slots.v, &assembly.points[index]);
        }
    }
}

fn bias_force<S: Real>(evaluation: &Evaluation<'_, S>, out: &mut [S]) {
    let directions = evaluation.layout.directions;
    for (index, slots) in evaluation.layout.bodies.iter().enumerate() {
        S::section(&evaluation.scene.bodies[index].name);
        let (motion, body) = (
            &evaluation.motions[index],
            &evaluation.numbers.bodies[index],
        );
        directions.write_linear(
            out,
            slots.v,
            &body_gravity(evaluation, index).map(|g| -(body.mass * g)),
        );
        let gyroscopic = motion.gyroscopic(body);
        let gyroscopic = match evaluation.scene.angular_velocity {
            crate::AngularVelocity::Body => gyroscopic,
            crate::AngularVelocity::World => motion.rotation * gyroscopic,
        };
        directions.write_angular(out, slots.v, &gyroscopic);
    }
    for (index, slots) in evaluation.layout.points.iter().enumerate() {
        if let PointSlots::Mass(slots) = slots {
            let mass = evaluation.numbers.points[index].0;
            directions.write_linear(
                out,
                slots.v,
                &point_gravity(evaluation, index, slots.q).map(|g| -(mass * g)),
            );
        }
    }
}

fn mass_matrix<S: Real>(evaluation: &Evaluation<'_, S>, out: &mut [S]) {
    let (n, directions) = (evaluation.layout.nv, evaluation.layout.directions);
    for (index, slots) in evaluation.layout.bodies.iter().enumerate() {
        S::section(&evaluation.scene.bodies[index].name);
        let body = &evaluation.numbers.bodies[index];
        evaluation.motions[index].mass_block(
            body,
            (directions, evaluation.scene.angular_velocity),
            out,
            n,
            slots.v,
        );
    }
    for (index, slots) in evaluation.layout.points.iter().enumerate() {
        if let PointSlots::Mass(slots) = slots {
            for i in slots.v..slots.v + directions.moves().len() {
                out[i * n + i] = evaluation.numbers.points[index].0;
            }
        }
    }
}

fn guards<S: Real>(evaluation: &Evaluation<'_, S>, out: &mut [S]) {
    let lines = evaluation.scene.lines.len();
    for index in 0..lines {
        if let Some(motion) = evaluation.line_motion(index) {
            out[2 * index] = motion.geometry.length - evaluation.numbers.lines[index].free_length;
            out[2 * index + 1] = motion.pull;
        }
    }
    along::visit(evaluation, |acting| {
        for stop in acting.stops() {
            out[2 * (lines + stop.stop)] = stop.depth;
            out[2 * (lines + stop.stop) + 1] = stop.pull;
        }
    });
    let events = 2 * evaluation.layout.one_way();
    for (index, event) in evaluation.scene.events.iter().enumerate() {
        out[events + index] = formula::scalar(&event.guard, evaluation);
    }
}

fn outputs<S: Real>(evaluation: &Evaluation<'_, S>, out: &mut [S]) {
    let mut column = 0;
    for output in &evaluation.scene.outputs {
        S::section(&output.name);
        match formula::value(&output.value, evaluation) {
            formula::Value::Scalar(a) => write(&mut out[..column + 1], column, &Vector3::repeat(a)),
            formula::Value::Vector(a) => write(out, column, &a),
        }
        column += output.components;
    }
}

/// Kinetic, gravitational, elastic energy; power of loads, power of dampers −(T − f(s₊)) ṡ and friction, power of prescribed motions.
fn energy<S: Real>(evaluation: &Evaluation<'_, S>, drives: S, out: &mut [S]) {
    let numbers = evaluation.numbers;
    let (mut kinetic, mut potential, mut elastic, mut damping) =
        (S::zero(), S::zero(), S::zero(), S::zero());
    let half = S::from_f64(0.5);
    let bodies = evaluation.scene.bodies.iter();
    for (declared, (motion, body)) in bodies.zip(evaluation.motions.iter().zip(&numbers.bodies)) {
        S::section(&declared.name);
        kinetic += motion.kinetic_energy(body);
        potential += gravity::energy(&numbers.gravity, body.mass, &motion.position);
    }
    let points = evaluation.layout.points.iter().zip(&numbers.points);
    for (declared, (slots, &(mass, _))) in evaluation.scene.points.iter().zip(points) {
        if let PointSlots::Mass(slots) = slots {
            S::section(&declared.name);
            let (directions, nq) = (evaluation.layout.directions, evaluation.layout.nq);
            let velocity: Vector3<S> = directions.linear(evaluation.at.state, nq + slots.v);
            kinetic += half * (mass * velocity.dot(&velocity));
            potential += gravity::energy(
                &numbers.gravity,
                mass,
                &directions.linear(evaluation.at.state, slots.q),
            );
        }
    }
    for index in 0..evaluation.scene.lines.len() {
        let Some([tension, _, stretch, rate]) = formula::Context::line(evaluation, index) else {
            continue;
        };
        let Some(line) = evaluation.element(index) else {
            continue;
        };
        elastic += line.energy(stretch);
        if let Some(power) = line.damping_power(stretch, rate, tension) {
            damping -= power;
        }
    }
    let mut load = forces::load_power(evaluation);
    along::visit(evaluation, |acting| {
        let [stored, given, lost] = acting.energy();
        elastic += stored;
        load += given;
        damping += lost;
    });
    out.copy_from_slice(&[kinetic, potential, elastic, load, damping, drives]);
}

fn momentum<S: Real>(evaluation: &Evaluation<'_, S>, out: &mut [S]) {
    let (mut linear, mut angular) = (Vector3::zeros(), Vector3::zeros());
    let bodies = evaluation.motions.iter().zip(&evaluation.numbers.bodies);
    for (declared, (motion, body)) in evaluation.scene.bodies.iter().zip(bodies) {
        S::section(&declared.name);
        let p = motion.velocity.map(|v| body.mass * v);
        linear += p;
        angular += motion.position.cross(&p) + motion.rotation * (body.inertia * motion.omega_body);
    }
    let points = evaluation
        .layout
        .points
        .iter()
        .zip(&evaluation.numbers.points);
    for (declared, (slots, &(mass, _))) in evaluation.scene.points.iter().zip(points) {
        if let PointSlots::Mass(slots) = slots {
            S::section(&declared.name);
            let (directions, nq) = (evaluation.layout.directions, evaluation.layout.nq);
            let velocity: Vector3<S> = directions.linear(evaluation.at.state, nq + slots.v);
            let p = velocity.map(|v| mass * v);
            linear += p;
            let position: Vector3<S> = directions.linear(evaluation.at.state, slots.q);
            angular += position.cross(&p);
        }
    }
    write(out, 0, &linear);
    write(out, 3, &angular);
}

fn lines<S: Real>(evaluation: &Evaluation<'_, S>, out: &mut [S]) {
    for (index, out) in out.chunks_exact_mut(10).enumerate() {
        let state = formula::Context::line(evaluation, index).zip(evaluation.line_motion(index));
        let Some((numbers, motion)) = state else {
            continue;
        };
        let block = line::stiffness(&motion.geometry, &motion.tangent, motion.tension);
        out[..4].copy_from_slice(&numbers);
        out[4..].copy_from_slice(&elements(&block));
    }
}
