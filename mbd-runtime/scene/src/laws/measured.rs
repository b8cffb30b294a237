//! What is measured at a state: guards, outputs, lines, the ends of the lines of nodes.

use nalgebra::Vector3;

use crate::laws::body::Attitude;
use crate::laws::formula::Context;
use crate::laws::{evaluation::Evaluation, forces, formula, joint_forces, line};
use crate::scalar::algebra::{elements, quaternion_of, write};
use crate::{AngularVelocity, Real, Scene};

/// Position and velocity of every anchor, and the load at every node.
pub fn ends<S: Real>(evaluation: &Evaluation<'_, S>, out: &mut [S]) {
    let layout = evaluation.layout;
    for (index, anchor) in layout.anchors.iter().enumerate() {
        S::section(evaluation.scene.line_name(anchor.line));
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
        if let Some(at) = node.load_rate {
            write(out, at, &forces::node_load_rate(evaluation, node.point));
        }
    }
}

/// The guards of lines, stops and events.
pub fn guards<S: Real>(evaluation: &Evaluation<'_, S>, out: &mut [S]) {
    let lines = evaluation.scene.lines.len();
    for index in 0..lines {
        if let Some(motion) = evaluation.line_motion(index) {
            let wound = evaluation.wound(index);
            let free = wound.unwrap_or(evaluation.numbers.lines[index].free_length);
            out[2 * index] = motion.geometry.stretch_over(free);
            out[2 * index + 1] = motion.pull;
        }
    }
    joint_forces::visit(evaluation, &mut |acting| {
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

/// The columns of the outputs.
pub fn outputs<S: Real>(evaluation: &Evaluation<'_, S>, out: &mut [S]) {
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

/// Value and rate of every joint coordinate.
pub fn coordinates<S: Real>(evaluation: &Evaluation<'_, S>, out: &mut [S]) {
    each_coordinate(evaluation.scene, out, |joint, index| {
        let value = evaluation.coordinate(joint, index)?;
        Some([value, evaluation.coordinate_rate(joint, index)?])
    });
}

/// Every angle whose turns are counted, and its rate.
pub fn counted_angles<S: Real>(evaluation: &Evaluation<'_, S>, out: &mut [S]) {
    for (slot, &(joint, index)) in out.chunks_exact_mut(2).zip(&evaluation.layout.turns) {
        let angle = evaluation.coordinate(joint, index);
        let rate = evaluation.coordinate_rate(joint, index);
        slot.copy_from_slice(&[angle, rate].map(|x| x.unwrap_or_else(|| S::from_f64(f64::NAN))));
    }
}

/// Value, rate and acceleration of every joint coordinate, the latter for the accelerations of the evaluation, or for none where there are none.
pub fn joint_coordinates<S: Real>(evaluation: &Evaluation<'_, S>, out: &mut [S]) {
    each_coordinate(evaluation.scene, out, |joint, index| {
        let value = evaluation.coordinate(joint, index)?;
        let rate = evaluation.coordinate_rate(joint, index)?;
        let second = evaluation.coordinate_acceleration(joint, index)?;
        Some([value, rate, second])
    });
}

/// Writes N numbers of every measured coordinate, joint by joint; numbers that are not finite where a joint has an end on a point without mass.
fn each_coordinate<S: Real, const N: usize>(
    scene: &Scene,
    out: &mut [S],
    numbers: impl Fn(usize, usize) -> Option<[S; N]>,
) {
    let joints = scene.joints.iter().enumerate();
    let coordinates = joints.flat_map(|(joint, declared)| {
        let all = 0..declared.law.coordinates();
        let measured = all.filter(|&index| declared.law.coordinate(index).is_some());
        measured.map(move |index| (joint, index))
    });
    for (slot, (joint, index)) in out.chunks_exact_mut(N).zip(coordinates) {
        let found = numbers(joint, index);
        slot.copy_from_slice(&found.unwrap_or([S::from_f64(f64::NAN); N]));
    }
}

/// Tension, length, stretch, rate and stiffness block of every line.
pub fn lines<S: Real>(evaluation: &Evaluation<'_, S>, out: &mut [S]) {
    for (index, out) in out.chunks_exact_mut(10).enumerate() {
        let state = formula::Context::line(evaluation, index).zip(evaluation.line_motion(index));
        let Some((numbers, motion)) = state else {
            continue;
        };
        let block = line::stiffness(&motion.geometry, &motion.tangent, motion.tension);
        out[..4].copy_from_slice(&numbers);
        if let Some(winding) = evaluation.rate_of_winding(index) {
            out[3] -= winding;
        }
        out[4..].copy_from_slice(&elements(&block));
    }
}

/// Position, attitude, velocity and angular velocity of every body, as absolute coordinates have them.
pub fn bodies<S: Real>(evaluation: &Evaluation<'_, S>, out: &mut [S]) {
    let directions = evaluation.layout.directions;
    for ((motion, body), out) in evaluation
        .motions
        .iter()
        .zip(&evaluation.scene.bodies)
        .zip(out.chunks_exact_mut(directions.motion()))
    {
        S::section(&body.name);
        directions.write_linear(out, 0, &evaluation.in_world(motion.position));
        let (attitude, speeds) = out.split_at_mut(directions.coordinates());
        let attitude = &mut attitude[directions.translations().len()..];
        match motion.attitude {
            Attitude::Quaternion(quaternion) => attitude.copy_from_slice(&quaternion),
            Attitude::Axes => attitude.copy_from_slice(&quaternion_of(&motion.rotation)),
            Attitude::Angle(angle) => attitude.fill(angle),
        }
        directions.write_linear(speeds, 0, &evaluation.rate_in_world(motion.velocity));
        let omega = match evaluation.scene.angular_velocity {
            AngularVelocity::Body => &motion.omega_body,
            AngularVelocity::World => &motion.omega_world,
        };
        directions.write_angular(speeds, 0, omega);
    }
}
