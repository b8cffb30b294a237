//! ẋ in absolute coordinates.

use crate::elimination::Constraints;
use crate::laws::evaluation::Evaluation;
use crate::laws::forces::AppliedForces;
use crate::laws::gravity;
use crate::{PointSlots, Real};

/// ẋ: q̇ = N(q) v, ż = w, ṡ as declared; v̇ = M⁻¹ (f − h) of what no joint holds, the solution of the constrained system for the rest.
pub(super) fn derivative<S: Real>(
    evaluation: &Evaluation<'_, S>,
    assembly: &AppliedForces<S>,
    constraints: &Constraints<S>,
    out: &mut [S],
) {
    let (layout, numbers) = (evaluation.layout, evaluation.numbers);
    let (directions, components) = (layout.directions, evaluation.scene.angular_velocity);
    for (index, slots) in layout.own_bodies() {
        S::section(&evaluation.scene.bodies[index].name);
        let (motion, body, (force, torque), own) = (
            &evaluation.motions[index],
            &numbers.bodies[index],
            &assembly.bodies[index],
            &assembly.own[index],
        );
        evaluation.write_body_rate(index, slots, out);
        let at = layout.nq + slots.v;
        if let Some([acceleration, spin]) = constraints.body_acceleration(evaluation, index) {
            directions.write_linear(out, at, &acceleration);
            directions.write_angular(out, at, &spin);
            continue;
        }
        let acceleration =
            force.map(|f| f * body.inverse_mass) + gravity::body_gravity(evaluation, index);
        directions.write_linear(out, at, &acceleration);
        let spin = motion.angular_acceleration(body, [torque, own], components);
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
