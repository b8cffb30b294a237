//! The mass matrix, the bias force h and the applied forces f of M v̇ + h = f.

use crate::laws::{
    evaluation::Evaluation,
    forces::AppliedForces,
    gravity::{body_gravity, point_gravity},
};
use crate::{PointSlots, Real};

pub fn mass_matrix<S: Real>(evaluation: &Evaluation<'_, S>, out: &mut [S]) {
    let (n, directions) = (evaluation.layout.nv, evaluation.layout.directions);
    for (index, slots) in evaluation.layout.own_bodies() {
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
            for i in slots.v..slots.v + directions.translations().len() {
                out[i * n + i] = evaluation.numbers.points[index].0;
            }
        }
    }
}

/// The diagonal of M (n_v): what a scene of thousands of bodies has room for.
pub fn masses<S: Real>(evaluation: &Evaluation<'_, S>, out: &mut [S]) {
    let directions = evaluation.layout.directions;
    for (index, slots) in evaluation.layout.own_bodies() {
        let mut block = [S::zero(); 36];
        evaluation.motions[index].mass_block(
            &evaluation.numbers.bodies[index],
            (directions, evaluation.scene.angular_velocity),
            &mut block,
            6,
            0,
        );
        let own = out.iter_mut().skip(slots.v).take(directions.speeds());
        own.zip(block.iter().step_by(7))
            .for_each(|(to, from)| *to = *from);
    }
    for (index, slots) in evaluation.layout.points.iter().enumerate() {
        if let PointSlots::Mass(slots) = slots {
            let moves = directions.translations().len();
            out[slots.v..slots.v + moves].fill(evaluation.numbers.points[index].0);
        }
    }
}

pub fn bias_force<S: Real>(evaluation: &Evaluation<'_, S>, out: &mut [S]) {
    let directions = evaluation.layout.directions;
    for (index, slots) in evaluation.layout.own_bodies() {
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

pub fn applied_forces<S: Real>(
    evaluation: &Evaluation<'_, S>,
    assembly: &AppliedForces<S>,
    out: &mut [S],
) {
    let directions = evaluation.layout.directions;
    for (index, slots) in evaluation.layout.own_bodies() {
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
