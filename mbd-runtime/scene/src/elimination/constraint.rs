//! Joints in the equations of motion: rows, accelerations under them, multipliers, reactions, the projection step.
//!
//! ```text
//! [M  Φ_vᵀ] [ v̇]   [f − h]
//! [Φ_v   0] [−λ] = [  γ  ]     the constraints push the bodies with +Φ_vᵀ λ                                     (1)
//! [M  Φ_vᵀ] [ δ]   [ 0 ]
//! [Φ_v   0] [−μ] = [−r ]       the smallest move, weighted by mass, that takes r out of the rows                 (2)
//! F = Σ λ (linear columns of the child),  T = Σ λ (couples on the child), beside what acts along coordinates       (3)
//! ```
//!
//! The system is written in body components whatever the state carries: M is constant there and γ and λ are the same numbers. Uniform
//! gravity is left out of (1) and added to the result: it moves every body alike, so only joints to the world feel it.
//! The rows of a joint that is detached are zero, and −1 on the diagonal says that its λ are: 0 = −(−λ).
//! Rows that repeat others are not in the system ([`crate::Redundancy`]): their multipliers are zero.
//! In a plane the unknowns of a body are its two velocities there and ω, and the columns, masses and forces those of the plane.
//! Source: Kamman, Connecting Joints I, rows joined to the equations of motion as second-order equations.

use nalgebra::Vector3;

use crate::elimination::assemble::Carriage;
use crate::elimination::reference::Reference;
use crate::elimination::system::BlockSystem;
use crate::laws::GravityNumbers;
use crate::laws::evaluation::Evaluation;
use crate::laws::forces::AppliedForces;
use crate::laws::gravity::{body_gravity, point_gravity};
use crate::laws::joint_forces::add_on_children;
use crate::rows::{Ends, Rotation, Row, Rows};
use crate::scalar::algebra::write;
use crate::{AngularVelocity, Layout, Part, PointSlots, Quantity, Real, Scene};

/// Rows and system of one scene. Carries nothing from call to call.
#[derive(Clone, Debug)]
pub struct Constraints<S: Real> {
    pub(super) rows: Vec<Rows<S>>,
    /// The rows of the system, where they are not all rows of the joint.
    pub(super) kept: Vec<Rows<S>>,
    pub(super) system: BlockSystem<S>,
    /// Axes and point of the unknowns of each body.
    pub(super) references: Vec<Option<Reference<S>>>,
    /// The linear acceleration of each body that the motion of what carries it brings along: a constant part of its unknowns, which acts on
    /// its mass alone instead of the inertia of all that it carries.
    pub(super) brought: Vec<Vector3<S>>,
    /// What each joint that carries its child says of it.
    pub(super) carriages: Vec<Option<Carriage<S>>>,
}

/// The rows of a joint that are in the system.
pub(super) fn in_system<'a, S: Real>(
    layout: &Layout,
    joint: usize,
    all: &'a [Rows<S>],
    kept: &'a [Rows<S>],
) -> &'a Rows<S> {
    if layout.joints[joint].all_kept() {
        &all[joint]
    } else {
        &kept[joint]
    }
}

/// Force and torque of (3) on the child of a joint, world axes, from its rows and their −λ; `outward` takes the child's components in the rows
/// to world axes. What a plane carries is no reaction of the joint.
pub(crate) fn reaction<'a, S: Real>(
    evaluation: &Evaluation<'_, S>,
    outward: &Rotation<S>,
    rows: impl Iterator<Item = (&'a Row<S>, S)>,
) -> [Vector3<S>; 2] {
    let (mut force, mut torque) = (Vector3::zeros(), Vector3::zeros());
    for (row, unknown) in rows {
        force -= row.child().linear.map(|x| unknown * x);
        torque -= row.couple.map(|x| unknown * x);
    }
    torque = outward.apply(&torque);
    if let Some(plane) = evaluation.layout.directions.plane {
        force[plane.normal()] = S::zero();
        torque = plane.axis().vector().map(|x: S| x * torque[plane.normal()]);
    }
    [force, torque]
}

/// The acceleration of free fall where it is the same everywhere; zero else, and out of a plane.
pub(crate) fn common_fall<S: Real>(evaluation: &Evaluation<'_, S>) -> Vector3<S> {
    let GravityNumbers::Uniform(mut fall) = evaluation.numbers.gravity else {
        return Vector3::zeros();
    };
    if let Some(plane) = evaluation.layout.directions.plane {
        fall[plane.normal()] = S::zero();
    }
    fall
}

impl<S: Real> Constraints<S> {
    /// Room for one scene.
    pub fn new(layout: &Layout) -> Self {
        Constraints {
            rows: vec![Rows::default(); layout.joints.len()],
            kept: vec![Rows::default(); layout.joints.len()],
            system: BlockSystem::new(&layout.elimination),
            references: vec![None; layout.bodies.len()],
            brought: vec![Vector3::zeros(); layout.bodies.len()],
            carriages: vec![None; layout.joints.len()],
        }
    }

    /// Runs the rows of every joint that is asked for, between these ends of it and of the joints that it couples.
    pub(super) fn run<'a>(
        &mut self,
        evaluation: &'a Evaluation<'a, S>,
        asked: &dyn Fn(usize) -> bool,
        ends: &dyn Fn(usize) -> Option<Ends<'a, S>>,
    ) {
        let joints = evaluation
            .scene
            .joints
            .iter()
            .zip(&evaluation.layout.joints);
        for (index, ((joint, slots), rows)) in joints.zip(&mut self.rows).enumerate() {
            if slots.len == 0 || !asked(index) {
                continue;
            }
            S::section(&joint.name);
            if let Some(own) = ends(index) {
                evaluation.law_rows((index, &own), ends, slots.law, rows);
                for (coordinate, course) in evaluation.motors(joint) {
                    rows.motor(&own, &coordinate, &course);
                }
                if let Some(joined) = evaluation.joined(index) {
                    rows.scale(joined);
                }
                if !slots.all_kept() {
                    rows.keep(slots.kept, &own, &mut self.kept[index]);
                }
            }
        }
    }

    /// Writes Φ, Φ_v, Φ_v v + Φ_t or γ.
    pub fn write(&mut self, what: Quantity, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        let components = evaluation.scene.angular_velocity;
        let ends = |joint: usize| evaluation.ends(joint, components);
        self.run(evaluation, &|_| true, &ends);
        let layout = evaluation.layout;
        let joints = layout.joints.iter().zip(&self.rows).enumerate();
        for (index, (slots, rows)) in joints.filter(|(_, (slots, _))| slots.len > 0) {
            S::section(&evaluation.scene.joints[index].name);
            for (row, number) in rows.whole().zip(slots.row..) {
                match what {
                    Quantity::Constraint => out[number] = row.value,
                    Quantity::ConstraintBias => out[number] = row.bias,
                    Quantity::ConstraintRate => {
                        let parts = row.parts(&slots.ends);
                        let rates = parts.filter_map(|(part, columns)| {
                            let (_, velocities) = evaluation.speeds_of(part, components)?;
                            Some(columns.rate(&velocities))
                        });
                        let rate = rates.reduce(|sum, rate| sum + rate);
                        out[number] = rate.map_or(row.time, |rate| rate + row.time);
                    }
                    _ => {
                        let line = &mut out[number * layout.nv..(number + 1) * layout.nv];
                        for (part, columns) in row.parts(&slots.ends) {
                            if let Some((first, _)) = evaluation.speeds_of(part, components) {
                                let own = line.iter_mut().skip(first);
                                for (slot, value) in own.zip(columns.of(part, layout.directions)) {
                                    *slot = value;
                                }
                            }
                        }
                    }
                }
            }
        }
    }

    /// Solves (1): accelerations less the common fall, and −λ.
    pub fn accelerate(&mut self, evaluation: &Evaluation<'_, S>, assembly: &AppliedForces<S>) {
        self.prepare(evaluation);
        let (layout, numbers) = (evaluation.layout, evaluation.numbers);
        let (plan, directions) = (&layout.elimination, layout.directions);
        let fall = common_fall(evaluation);
        let uniform = matches!(numbers.gravity, GravityNumbers::Uniform(_));
        self.bring_along(evaluation);
        for (index, step) in plan.steps.iter().enumerate() {
            enter::<S>(evaluation.scene, step.part);
            if step.paired {
                continue;
            }
            let right = self.system.unknowns_mut(plan, index);
            match step.part {
                Part::Body(body) => {
                    let (motion, numbers) = (&evaluation.motions[body], &numbers.bodies[body]);
                    let (mut force, torque) = assembly.bodies[body];
                    let brought = self.brought[body];
                    if !uniform {
                        force += body_gravity(evaluation, body).map(|g| numbers.mass * g);
                    }
                    if brought.iter().any(|x| !x.is_zero()) {
                        force -= brought.map(|x| numbers.mass * x);
                    }
                    let Some(reference) = self.references[body] else {
                        continue;
                    };
                    let (own, gyroscopic) = (assembly.own[body], motion.gyroscopic(numbers));
                    let mut torque = match reference.turn {
                        Rotation::Identity => reference.outward.back(&torque) + own - gyroscopic,
                        turn => reference.outward.back(&torque) + turn.apply(&(own - gyroscopic)),
                    };
                    for (k, lever) in reference.levers().iter().flatten().enumerate() {
                        torque += lever.map(|x| x * force[k]);
                    }
                    directions.write_linear(right, 0, &force);
                    directions.write_angular(right, 0, &torque);
                }
                Part::Point(point) => {
                    let mut force = assembly.points[point];
                    if let (false, PointSlots::Mass(slots)) = (uniform, layout.points[point]) {
                        let mass = numbers.points[point].0;
                        force += point_gravity(evaluation, point, slots.q).map(|g| mass * g);
                    }
                    directions.write_linear(right, 0, &force);
                }
                Part::Coordinates(_) => {}
                Part::Joint(joint) => {
                    let ends = &layout.joints[joint].ends;
                    // Where nothing sits on the world the common fall cancels: the linear columns add up to nothing.
                    let grounded = ends.contains(&None);
                    let rows = in_system(layout, joint, &self.rows, &self.kept);
                    for (slot, row) in right.iter_mut().zip(rows.whole()) {
                        *slot = row.bias;
                        for (part, columns) in row.parts(ends) {
                            if grounded {
                                *slot -= columns.linear.dot(&fall);
                            }
                            if let Part::Body(body) = part {
                                *slot -= columns.linear.dot(&self.brought[body]);
                            }
                        }
                    }
                }
            }
        }
        self.system
            .solve(plan, &|part| enter::<S>(evaluation.scene, part));
        for (index, step) in plan.steps.iter().enumerate() {
            if let Part::Body(body) = step.part {
                enter::<S>(evaluation.scene, step.part);
                let unknowns = self.system.unknowns_mut(plan, index);
                let linear: Vector3<S> = directions.linear(unknowns, 0);
                directions.write_linear(unknowns, 0, &(linear + self.brought[body]));
            }
        }
    }

    /// Linear acceleration (world axes) and ω̇ (components of the state) of a body that joints hold, after [`Constraints::accelerate`].
    pub fn body_acceleration(
        &self,
        evaluation: &Evaluation<'_, S>,
        body: usize,
    ) -> Option<[Vector3<S>; 2]> {
        let plan = &evaluation.layout.elimination;
        let unknowns = self.system.unknowns(plan, plan.step_of(Part::Body(body))?);
        let [acceleration, spin] = self.motion_of(evaluation, body, unknowns)?;
        Some([acceleration + common_fall(evaluation), spin])
    }

    /// Acceleration of a point that joints hold, world axes.
    pub fn point_acceleration(
        &self,
        evaluation: &Evaluation<'_, S>,
        point: usize,
    ) -> Option<Vector3<S>> {
        let plan = &evaluation.layout.elimination;
        let unknowns = self
            .system
            .unknowns(plan, plan.step_of(Part::Point(point))?);
        let acceleration = evaluation.layout.directions.linear(unknowns, 0);
        Some(acceleration + common_fall(evaluation))
    }

    /// Writes the multipliers, or the reactions by (3) with what acts along coordinates, after [`Constraints::accelerate`].
    pub fn write_forces(&self, what: Quantity, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        let layout = evaluation.layout;
        for (index, slots) in layout.joints.iter().enumerate() {
            let Some(step) = layout.elimination.step_of(Part::Joint(index)) else {
                // It has no rows.
                let own = out.get_mut(6 * index..6 * index + 6);
                if let (Quantity::Reactions, Some(own)) = (what, own) {
                    own.fill(S::zero());
                }
                continue;
            };
            enter::<S>(evaluation.scene, Part::Joint(index));
            let carried = self.multipliers(evaluation, index);
            let unknowns = match &carried {
                Some(multipliers) => &multipliers[..slots.len],
                None => self.system.unknowns(&layout.elimination, step),
            };
            if what == Quantity::Multipliers {
                let own = &mut out[slots.row..slots.row + slots.len];
                own.fill(S::zero());
                self.each_kept(evaluation, index, &mut |number, row, part| {
                    own[row] -= unknowns[number] * part;
                });
                continue;
            }
            let rows = in_system(layout, index, &self.rows, &self.kept);
            let unknowns = unknowns.iter().copied();
            let outward = match (&self.carriages[index], slots.ends[1]) {
                (Some(carriage), _) => carriage.outward,
                (None, Some(Part::Body(body))) => {
                    self.references[body].map_or(Rotation::Identity, |reference| reference.outward)
                }
                _ => Rotation::Identity,
            };
            let [force, torque] = reaction(evaluation, &outward, rows.rows().iter().zip(unknowns));
            write(out, 6 * index, &force);
            write(out, 6 * index + 3, &torque);
        }
        if what == Quantity::Reactions {
            add_on_children(evaluation, |_| true, out);
        }
    }

    /// Power that prescribed motions put in through the joints, −λᵀ Φ_t [W], after [`Constraints::accelerate`].
    pub fn drive_power(&self, evaluation: &Evaluation<'_, S>) -> S {
        let layout = evaluation.layout;
        let mut power = S::zero();
        for index in 0..layout.joints.len() {
            let driven = layout.joints.get(index).is_some_and(|slots| slots.driven);
            let step = layout.elimination.step_of(Part::Joint(index));
            let (Some(step), true) = (step, driven) else {
                continue;
            };
            let carried = self.multipliers(evaluation, index);
            let unknowns = match &carried {
                Some(multipliers) => multipliers,
                None => self.system.unknowns(&layout.elimination, step),
            };
            let rows = in_system(layout, index, &self.rows, &self.kept);
            for (row, &unknown) in rows.whole().zip(unknowns) {
                power += unknown * evaluation.prescribed_in_world(index, row);
            }
        }
        power
    }

    /// Hands out what each row of the system is made of: its number, a row of the joint, and how much of it.
    fn each_kept(
        &self,
        evaluation: &Evaluation<'_, S>,
        joint: usize,
        each: &mut dyn FnMut(usize, usize, S),
    ) {
        kept_parts(evaluation, joint, &self.rows, each);
    }

    /// The velocity, or its rate, of the centre of mass, world axes, and ω or its rate in the components of the state, from the unknowns of
    /// a body.
    pub(super) fn motion_of(
        &self,
        evaluation: &Evaluation<'_, S>,
        body: usize,
        unknowns: &[S],
    ) -> Option<[Vector3<S>; 2]> {
        let directions = evaluation.layout.directions;
        let reference = (*self.references.get(body)?)?;
        let (at_reference, spin): (Vector3<S>, Vector3<S>) = (
            directions.linear(unknowns, 0),
            directions.angular(unknowns, 0),
        );
        let at_centre = match reference.levers() {
            Some(levers) => Vector3::from_fn(|k, _| at_reference[k] + levers[k].dot(&spin)),
            None => at_reference,
        };
        let spin = match evaluation.scene.angular_velocity {
            AngularVelocity::Body => reference.own_components(&spin),
            AngularVelocity::World => reference.outward.apply(&spin),
        };
        Some([at_centre, spin])
    }

    /// Solves (2) for the rows of the arguments and writes δ, and behind it the margin of the factor.
    pub fn correct(&mut self, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        let layout = evaluation.layout;
        let (plan, directions) = (&layout.elimination, layout.directions);
        if evaluation.at.rows.len() != layout.nc {
            return out.fill(S::from_f64(f64::NAN));
        }
        self.prepare(evaluation);
        for (joint, slots) in layout.joints.iter().enumerate() {
            if let Some(step) = plan.step_of(Part::Joint(joint)) {
                enter::<S>(evaluation.scene, Part::Joint(joint));
                let asked = &evaluation.at.rows[slots.row..slots.row + slots.len];
                let mut right = [S::zero(); 6];
                self.each_kept(evaluation, joint, &mut |number, row, part| {
                    right[number] -= asked[row] * part;
                });
                if self.hold_rows(evaluation, (joint, step), &right) {
                    continue;
                }
                let own = self.system.unknowns_mut(plan, step);
                own.copy_from_slice(&right[..own.len()]);
            }
        }
        self.system
            .solve(plan, &|part| enter::<S>(evaluation.scene, part));
        out.fill(S::zero());
        out[layout.nv] = self.system.margin(plan);
        for (index, step) in plan.steps.iter().enumerate() {
            enter::<S>(evaluation.scene, step.part);
            let unknowns = self.system.unknowns(plan, index);
            match step.part {
                Part::Body(body) => {
                    let moved = self.motion_of(evaluation, body, unknowns);
                    if let (Some([moved, rotated]), Some(slots)) = (moved, layout.bodies[body]) {
                        directions.write_linear(out, slots.v, &moved);
                        directions.write_angular(out, slots.v, &rotated);
                    }
                }
                Part::Point(point) => {
                    if let PointSlots::Mass(slots) = layout.points[point] {
                        let moved = directions.linear(unknowns, 0);
                        directions.write_linear(out, slots.v, &moved);
                    }
                }
                Part::Joint(_) | Part::Coordinates(_) => {}
            }
        }
    }
}

/// Hands out what each row in the system of a joint is made of: its number, a row of the joint, and how much of it. `all`: the rows of all joints.
pub(crate) fn kept_parts<S: Real>(
    evaluation: &Evaluation<'_, S>,
    joint: usize,
    all: &[Rows<S>],
    each: &mut dyn FnMut(usize, usize, S),
) {
    let slots = &evaluation.layout.joints[joint];
    if slots.all_kept() {
        return (0..slots.len).for_each(|row| each(row, row, S::one()));
    }
    let Some(ends) = evaluation.ends(joint, AngularVelocity::Body) else {
        return;
    };
    for (number, row) in slots.kept.rows().enumerate() {
        for (row, part) in all[joint].parts(row, &ends).into_iter().flatten() {
            each(number, row, part);
        }
    }
}

/// Says that the terms which follow belong to a part of the system.
pub(crate) fn enter<S: Real>(scene: &Scene, part: Part) {
    let name = match part {
        Part::Body(body) => scene.bodies.get(body).map(|body| &body.name),
        Part::Point(point) => scene.points.get(point).map(|point| &point.name),
        Part::Joint(joint) | Part::Coordinates(joint) => {
            scene.joints.get(joint).map(|joint| &joint.name)
        }
    };
    S::section(name.map_or("", String::as_str));
}
