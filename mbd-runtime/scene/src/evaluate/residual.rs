//! The equations of motion before they are solved, whose partial derivatives are local: each depends on one body and its neighbours.
//!
//! ```text
//! r = [ N(q) v ; M v̇ + h − f − Φ_vᵀ λ ; ż ; ṡ ; Φ_v v̇ − γ ]      at given v̇ and λ                              (1)
//! K [∂v̇; ∂λ] = −[∂r_v; ∂r_c],   K = [M −Φ_vᵀ; Φ_v 0]             at fixed v̇ and λ on the right                 (2)
//! ```
//!
//! (2) is the derivative of the accelerations through the joints by anything that r depends on: no elimination is differentiated.
//! Source: implicit function theorem; Jain and Rodriguez, Linearization of manipulator dynamics using spatial operators, 1993.

use nalgebra::Vector3;

use crate::elimination::Constraints;
use crate::laws::evaluation::Evaluation;
use crate::laws::forces::AppliedForces;
use crate::laws::gravity::{body_gravity, point_gravity};
use crate::{AngularVelocity, PointSlots, Real};

/// Writes (1); numbers that are not finite where the list of v̇ and λ has another length.
pub(super) fn residual<S: Real>(
    evaluation: &Evaluation<'_, S>,
    assembly: &AppliedForces<S>,
    constraints: &mut Constraints<S>,
    out: &mut [S],
) {
    let (layout, numbers) = (evaluation.layout, evaluation.numbers);
    let given = evaluation.at.rows;
    if given.len() != layout.nv + layout.nc {
        return out.fill(S::from_f64(f64::NAN));
    }
    let (directions, components) = (layout.directions, evaluation.scene.angular_velocity);
    for (index, slots) in layout.own_bodies() {
        S::section(&evaluation.scene.bodies[index].name);
        let (motion, body) = (&evaluation.motions[index], &numbers.bodies[index]);
        let ((force, torque), own) = (assembly.bodies[index], assembly.own[index]);
        evaluation.write_body_rate(index, slots, out);
        let at = layout.nq + slots.v;
        let acceleration: Vector3<S> = directions.linear(given, slots.v);
        let fall = acceleration - body_gravity(evaluation, index);
        directions.write_linear(out, at, &(fall.map(|x| body.mass * x) - force));
        let spin: Vector3<S> = directions.angular(given, slots.v);
        let torque = motion.rotation.transpose() * torque + own;
        let couple = match components {
            AngularVelocity::Body => body.inertia * spin + motion.gyroscopic(body) - torque,
            AngularVelocity::World => {
                let spin = motion.rotation.transpose() * spin;
                motion.rotation * (body.inertia * spin + motion.gyroscopic(body) - torque)
            }
        };
        directions.write_angular(out, at, &couple);
    }
    for (index, slots) in layout.points.iter().enumerate() {
        if let PointSlots::Mass(slots) = slots {
            S::section(&evaluation.scene.points[index].name);
            let at = layout.nq + slots.v;
            evaluation.write_point_rate(*slots, out);
            let acceleration: Vector3<S> = directions.linear(given, slots.v);
            let fall = acceleration - point_gravity(evaluation, index, slots.q);
            let mass = numbers.points[index].0;
            let balance = fall.map(|x| mass * x) - assembly.points[index];
            directions.write_linear(out, at, &balance);
        }
    }
    evaluation.write_other_rates(out);
    if layout.nc > 0 {
        constraints.leave_over(evaluation, out);
    }
}
