//! Energy and momentum.

use nalgebra::Vector3;

use crate::laws::body::BodyMotion;
use crate::laws::formula::norm;
use crate::laws::{evaluation::Evaluation, forces, formula, gravity, joint_forces};
use crate::scalar::algebra::write;
use crate::{Place, PointSlots, Real};

/// Kinetic, gravitational, elastic energy; power of loads, power of dampers −(T − f(s₊)) ṡ and friction, power of prescribed motions.
pub fn energy<S: Real>(evaluation: &Evaluation<'_, S>, drives: S, out: &mut [S]) {
    let numbers = evaluation.numbers;
    let (mut kinetic, mut potential, mut elastic, mut damping) =
        (S::zero(), S::zero(), S::zero(), S::zero());
    let half = S::from_f64(0.5);
    let bodies = evaluation.scene.bodies.iter();
    for (declared, (motion, body)) in bodies.zip(evaluation.motions.iter().zip(&numbers.bodies)) {
        S::section(&declared.name);
        let in_world = BodyMotion {
            velocity: evaluation.rate_in_world(motion.velocity),
            ..*motion
        };
        kinetic += in_world.kinetic_energy(body);
        let position = evaluation.in_world(motion.position);
        potential += gravity::energy(&numbers.gravity, body.mass, &position);
    }
    let points = evaluation.layout.points.iter().zip(&numbers.points);
    for (declared, (slots, &(mass, _))) in evaluation.scene.points.iter().zip(points) {
        if let PointSlots::Mass(slots) = slots {
            S::section(&declared.name);
            let (directions, nq) = (evaluation.layout.directions, evaluation.layout.nq);
            let velocity = directions.linear(evaluation.at.state, nq + slots.v);
            let velocity = evaluation.rate_in_world(velocity);
            kinetic += half * (mass * velocity.dot(&velocity));
            let position = directions.linear(evaluation.at.state, slots.q);
            let position = evaluation.in_world(position);
            potential += gravity::energy(&numbers.gravity, mass, &position);
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
    joint_forces::visit(evaluation, &mut |acting| {
        let [stored, given, lost] = acting.energy();
        elastic += stored;
        load += given;
        damping += lost;
    });
    out.copy_from_slice(&[kinetic, potential, elastic, load, damping, drives]);
}

/// Visits the mass, position in the world, linear momentum there and angular momentum about itself of everything that moves, bodies first.
fn visit_moving<S: Real>(
    evaluation: &Evaluation<'_, S>,
    mut visit: impl FnMut(Place, S, &Vector3<S>, &Vector3<S>, &Vector3<S>),
) {
    let bodies = evaluation.motions.iter().zip(&evaluation.numbers.bodies);
    for (index, (motion, body)) in bodies.enumerate() {
        S::section(&evaluation.scene.bodies[index].name);
        let velocity = evaluation.rate_in_world(motion.velocity);
        let linear = velocity.map(|v| body.mass * v);
        let spin = motion.rotation * (body.inertia * motion.omega_body);
        let position = evaluation.in_world(motion.position);
        let place = Place::Body(index, 0);
        visit(place, body.mass, &position, &linear, &spin);
    }
    for (index, slots) in evaluation.layout.points.iter().enumerate() {
        if let PointSlots::Mass(slots) = slots {
            S::section(&evaluation.scene.points[index].name);
            let (mass, _) = evaluation.numbers.points[index];
            let (directions, nq) = (evaluation.layout.directions, evaluation.layout.nq);
            let velocity = directions.linear(evaluation.at.state, nq + slots.v);
            let linear = evaluation.rate_in_world(velocity).map(|v| mass * v);
            let position = directions.linear(evaluation.at.state, slots.q);
            let position = evaluation.in_world(position);
            let place = Place::Point(index);
            visit(place, mass, &position, &linear, &Vector3::zeros());
        }
    }
}

/// Position and velocity of the centre of mass of everything that moves.
pub fn centre_of_mass<S: Real>(evaluation: &Evaluation<'_, S>, out: &mut [S]) {
    let (mut whole, mut place, mut momentum) = (S::zero(), Vector3::zeros(), Vector3::zeros());
    visit_moving(evaluation, |_, mass, position, p, _| {
        whole += mass;
        place += position.map(|x| mass * x);
        momentum += p;
    });
    let inverse = S::one() / whole;
    write(out, 0, &place.map(|x: S| x * inverse));
    write(out, 3, &momentum.map(|x: S| x * inverse));
}

pub fn momentum<S: Real>(evaluation: &Evaluation<'_, S>, out: &mut [S]) {
    let (mut linear, mut angular) = (Vector3::zeros(), Vector3::zeros());
    visit_moving(evaluation, |_, _, position, p, spin| {
        linear += p;
        angular += position.cross(p) + spin;
    });
    write(out, 0, &linear);
    write(out, 3, &angular);
}

/// P, L, then force and torque of gravity and loads, then Σ |m v| and Σ |r| |m v| + |I ω|, then the sizes of these forces and, for
/// their torques, of forces times levers; about the world origin. Levers, not moments: a ring that breathes about the origin has
/// none, and its rounding would be large beside them.
pub fn impulses<S: Real>(evaluation: &Evaluation<'_, S>, out: &mut [S]) {
    momentum(evaluation, out);
    let (mut force, mut torque) = forces::loads(evaluation);
    let [mut linear, mut angular] = [S::zero(); 2];
    let [mut push, mut twist] = [norm(&force), norm(&torque)];
    visit_moving(evaluation, |place, mass, position, p, spin| {
        let weight = gravity::at(evaluation, place).map(|g| mass * g);
        force += weight;
        torque += position.cross(&weight);
        push += norm(&weight);
        twist += norm(position) * norm(&weight);
        linear += norm(p);
        angular += norm(position) * norm(p) + norm(spin);
    });
    // A plane takes up what points out of it.
    let directions = evaluation.layout.directions;
    for (axis, (force, torque)) in force.iter_mut().zip(torque.iter_mut()).enumerate() {
        if !directions.translations().contains(&axis) {
            *force = S::zero();
        }
        if !directions.rotations().contains(&axis) {
            *torque = S::zero();
        }
    }
    write(out, 6, &force);
    write(out, 9, &torque);
    let sizes = [linear, angular, push, twist];
    for (slot, size) in out.iter_mut().skip(12).zip(sizes) {
        *slot = size;
    }
}
