//! Energy and momentum.

use nalgebra::Vector3;

use crate::laws::{evaluation::Evaluation, forces, formula, gravity, joint_forces};
use crate::scalar::algebra::write;
use crate::{PointSlots, Real};

/// Kinetic, gravitational, elastic energy; power of loads, power of dampers −(T − f(s₊)) ṡ and friction, power of prescribed motions.
pub fn energy<S: Real>(evaluation: &Evaluation<'_, S>, drives: S, out: &mut [S]) {
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
        elastic += evaluation.where_attached(index, line.energy(stretch));
        let winding = match line.damped {
            true => evaluation.rate_of_winding(index),
            false => None,
        };
        let rate = winding.map_or(rate, |winding| rate - winding);
        if let Some(power) = line.damping_power(stretch, rate, tension) {
            damping -= evaluation.where_attached(index, power);
        }
    }
    let mut load = forces::load_power(evaluation);
    joint_forces::visit(evaluation, |acting| {
        let [stored, given, lost] = acting.energy();
        elastic += stored;
        load += given;
        damping += lost;
    });
    out.copy_from_slice(&[kinetic, potential, elastic, load, damping, drives]);
}

pub fn momentum<S: Real>(evaluation: &Evaluation<'_, S>, out: &mut [S]) {
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
