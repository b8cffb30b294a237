//! Joints in the equations of motion: rows, accelerations under them, multipliers, reactions, the projection step.
//!
//! ```text
//! [M  Φ_vᵀ] [ v̇]   [f − h]
//! [Φ_v   0] [−λ] = [  γ  ]     the constraints push the bodies with +Φ_vᵀ λ                                     (1)
//! [M  Φ_vᵀ] [ δ]   [ 0 ]
//! [Φ_v   0] [−μ] = [−r ]       the smallest move, weighted by mass, that takes r out of the rows                 (2)
//! F = Σ λ (linear columns of the child),  T = Σ λ (couples on the child)                                        (3)
//! ```
//!
//! The system is written in body components whatever the state carries: M is constant there and γ and λ are the same numbers. Uniform
//! gravity is left out of (1) and added to the result: it moves every body alike, so only joints to the world feel it.
//! Rows that repeat others are not in the system ([`crate::Redundancy`]): their multipliers are zero.
//! In a plane the unknowns of a body are its two velocities there and ω, and the columns, masses and forces those of the plane.
//! Source: Kamman, Connecting Joints I, rows joined to the equations of motion as second-order equations.

use nalgebra::Vector3;

use super::algebra::write;
use super::block::System;
use super::evaluation::Evaluation;
use super::forces::Assembly;
use super::rows::{Columns, End, Ends, Row, Rows, Turn};
use super::{GravityNumbers, body_gravity, point_gravity};
use crate::elimination::Part;
use crate::joints::Coordinate;
use crate::{
    AngularVelocity, At, Directions, Jet, Joint, Layout, Partition, Place, PointSlots, Quantity,
    Real, RowSet, Scene,
};

/// Rows and system of one scene. Carries nothing from call to call.
#[derive(Clone, Debug)]
pub struct Constraints<S: Real> {
    rows: Vec<Rows<S>>,
    /// The rows of the system, where they are not all rows of the joint.
    kept: Vec<Rows<S>>,
    system: System<S>,
}

impl<S: Real> Evaluation<'_, S> {
    /// The two ends of a joint; own components as asked.
    pub(super) fn ends(&self, joint: usize, components: AngularVelocity) -> Option<Ends<'_, S>> {
        let declared = self.scene.joints.get(joint)?;
        let numbers = self.numbers.joints.get(joint)?;
        Some(Ends::new(
            self.end(declared.parent, components)?,
            self.end(declared.child, components)?,
            numbers,
            components,
        ))
    }

    /// The coordinates of a joint that motors drive, and their courses.
    pub(super) fn motors<'e>(
        &'e self,
        joint: &'e Joint,
    ) -> impl Iterator<Item = (Coordinate, Jet<S>)> + 'e {
        joint.motors().filter_map(|(index, course)| {
            let coordinate = joint.law.coordinate(index)?;
            let course = super::ground::course(course, self.scene, self.numbers, self.at.time);
            Some((coordinate, course))
        })
    }

    /// The two ends of a joint in the system: columns multiply the velocity of each body's [`Evaluation::reference`]. Body components.
    fn system_ends(&self, joint: usize) -> Option<Ends<'_, S>> {
        let mut ends = self.ends(joint, AngularVelocity::Body)?;
        let declared = self.scene.joints.get(joint)?;
        for (end, place) in [
            (&mut ends.parent, declared.parent),
            (&mut ends.child, declared.child),
        ] {
            if let Place::Body(body, _) = place {
                end.reference = self.reference(body).unwrap_or_else(Vector3::zeros);
            }
        }
        Some(ends)
    }

    /// The point of a body whose velocity is its unknown in the system, body axes: where the joint that carries it holds it; `None` is
    /// the centre of mass.
    fn reference(&self, body: usize) -> Option<Vector3<S>> {
        let carrier = (*self.layout.elimination.carriers.get(body)?)?;
        match self.scene.joints.get(carrier)?.child {
            Place::Body(body, frame) => {
                let frames = &self.numbers.bodies.get(body)?.frames;
                Some(frames.get(frame)?.position)
            }
            _ => None,
        }
    }

    /// Rows k of R r̃ for the reference point r of a body: a velocity of the centre of mass is that of the reference point + R r̃ ω′.
    fn levers(&self, body: usize) -> Option<[Vector3<S>; 3]> {
        let (reference, motion) = (self.reference(body)?, self.motions.get(body)?);
        let turn = Turn::By(motion.rotation);
        Some(std::array::from_fn(|k| turn.row(k).cross(&reference)))
    }

    fn end(&self, place: Place, components: AngularVelocity) -> Option<End<S>> {
        match place {
            Place::World(frame) => Some(match self.moving(frame) {
                Some(motion) => End::moving(motion),
                None => {
                    let frame = self.numbers.world_frames.get(frame)?;
                    End::fixed(frame.position, frame.rotation.into())
                }
            }),
            Place::Point(point) => match *self.layout.points.get(point)? {
                PointSlots::Mass(slots) => Some(End {
                    speeds: Some((slots.v, self.layout.directions.moves().len())),
                    position: self.position_of(place)?,
                    velocity: self.velocity_of(place)?,
                    ..End::fixed(Vector3::zeros(), Turn::None)
                }),
                PointSlots::Node(_) => None,
            },
            Place::Body(body, frame) => {
                let (motion, slots) = (self.motions.get(body)?, self.layout.bodies.get(body)?);
                let frame = self.numbers.bodies.get(body)?.frames.get(frame)?;
                let end = End {
                    speeds: Some((slots.v, self.layout.directions.speeds())),
                    position: motion.position,
                    velocity: motion.velocity,
                    ..End::fixed(frame.position, frame.rotation.into())
                };
                Some(match components {
                    AngularVelocity::Body => End {
                        omega: motion.omega_body,
                        outward: Turn::By(motion.rotation),
                        ..end
                    },
                    AngularVelocity::World => End {
                        omega: motion.omega_world,
                        arm: motion.arm(&frame.position),
                        frame: Turn::By(match frame.rotation {
                            Some(rotation) => motion.rotation * rotation,
                            None => motion.rotation,
                        }),
                        ..end
                    },
                })
            }
        }
    }
}

/// What a scene is at a state, for looking at one joint.
fn looked<S: Real, R>(
    scene: &Scene,
    layout: &Layout,
    numbers: &super::Numbers<S>,
    at: &At<'_, S>,
    look: impl FnOnce(&Evaluation<'_, S>) -> R,
) -> R {
    let motions: Vec<_> = layout
        .bodies
        .iter()
        .map(|&slots| {
            let (directions, components) = (layout.directions, scene.angular_velocity);
            super::Motion::read(at.state, slots, layout.nq, directions, components)
        })
        .collect();
    let mut ground = Vec::new();
    super::ground::ground(scene, numbers, at.time, &mut ground);
    look(&Evaluation {
        scene,
        layout,
        numbers,
        at,
        motions: &motions,
        ground: &ground,
        multipliers: &[],
    })
}

/// How far a joint of a planar scene is from holding out of the plane: the largest of the rows that its joint has in space and not in the
/// plane [m or 1]; zero in space. Positions alone matter.
pub fn out_of_plane<S: Real>(
    scene: &Scene,
    layout: &Layout,
    numbers: &super::Numbers<S>,
    at: &At<'_, S>,
    joint: usize,
) -> S {
    let (Some(declared), Some(slots)) = (scene.joints.get(joint), layout.joints.get(joint)) else {
        return S::zero();
    };
    let left = RowSet(RowSet::all(declared.law.rows()).0 & !slots.law.0);
    looked(scene, layout, numbers, at, |evaluation| {
        let mut rows = Rows::default();
        rows.begin(left);
        if let Some(ends) = evaluation.ends(joint, AngularVelocity::Body) {
            declared.law.constrain(&ends, &mut rows);
        }
        let sizes = rows.rows().iter().map(|row| row.value.abs());
        sizes.fold(S::zero(), Real::max)
    })
}

/// Whether a joint is on the branch it means: three numbers, all positive if it is (1 where its rows have no other root). Positions alone
/// matter; a joint or a place that is not there gives NaN.
pub fn branch<S: Real>(
    scene: &Scene,
    layout: &Layout,
    numbers: &super::Numbers<S>,
    at: &At<'_, S>,
    joint: usize,
) -> [S; 3] {
    looked(scene, layout, numbers, at, |evaluation| {
        let ends = evaluation.ends(joint, AngularVelocity::Body);
        let (Some(ends), Some(joint)) = (ends, scene.joints.get(joint)) else {
            return [S::from_f64(f64::NAN); 3];
        };
        let [a, b, c] = joint.law.branch(&ends);
        let courses = evaluation.motors(joint);
        let driven = courses.fold(c, |least, (coordinate, course)| {
            least.min(ends.prescribed_cosine(&coordinate, course.value))
        });
        [a, b, driven]
    })
}

/// The rows of a joint that are in the system.
fn in_system<'a, S: Real>(
    layout: &Layout,
    joint: usize,
    all: &'a [Rows<S>],
    kept: &'a [Rows<S>],
) -> &'a [Row<S>] {
    if layout.joints[joint].all_kept() {
        all[joint].rows()
    } else {
        kept[joint].rows()
    }
}

/// Force and torque of (3) on the child of a joint, world axes, from its rows and their −λ. What a plane carries is no reaction of the joint.
pub(super) fn reaction<'a, S: Real>(
    evaluation: &Evaluation<'_, S>,
    joint: usize,
    rows: impl Iterator<Item = (&'a Row<S>, S)>,
) -> [Vector3<S>; 2] {
    let (mut force, mut torque) = (Vector3::zeros(), Vector3::zeros());
    for (row, unknown) in rows {
        force -= row.child.linear.map(|x| unknown * x);
        torque -= row.couple.map(|x| unknown * x);
    }
    if let Some(Part::Body(body)) = evaluation.layout.joints[joint].ends[1] {
        torque = evaluation.motions[body].rotation * torque;
    }
    if let Some(plane) = evaluation.layout.directions.plane {
        force[plane.normal()] = S::zero();
        torque = plane.axis().vector().map(|x: S| x * torque[plane.normal()]);
    }
    [force, torque]
}

/// The acceleration of free fall where it is the same everywhere; zero else, and out of a plane.
fn common_fall<S: Real>(evaluation: &Evaluation<'_, S>) -> Vector3<S> {
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
            system: System::new(&layout.elimination),
        }
    }

    /// Runs the rows of every joint.
    fn run<'a>(
        &mut self,
        evaluation: &'a Evaluation<'a, S>,
        ends: impl Fn(usize) -> Option<Ends<'a, S>>,
    ) {
        let joints = evaluation
            .scene
            .joints
            .iter()
            .zip(&evaluation.layout.joints);
        for (index, ((joint, slots), rows)) in joints.zip(&mut self.rows).enumerate() {
            rows.begin(slots.law);
            if slots.len == 0 {
                continue;
            }
            S::section(&joint.name);
            if let Some(ends) = ends(index) {
                joint.law.constrain(&ends, rows);
                for (coordinate, course) in evaluation.motors(joint) {
                    rows.motor(&ends, &coordinate, &course);
                }
                rows.prescribe(&ends);
                if !slots.all_kept() {
                    rows.keep(slots.kept, &ends, &mut self.kept[index]);
                }
            }
        }
    }

    /// Writes Φ, Φ_v, Φ_v v + Φ_t or γ.
    pub fn write(&mut self, what: Quantity, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        let components = evaluation.scene.angular_velocity;
        self.run(evaluation, |joint| evaluation.ends(joint, components));
        let layout = evaluation.layout;
        for (index, (slots, rows)) in layout.joints.iter().zip(&self.rows).enumerate() {
            let Some(ends) = evaluation.ends(index, components).filter(|_| slots.len > 0) else {
                continue;
            };
            S::section(&evaluation.scene.joints[index].name);
            for (row, number) in rows.rows().iter().zip(slots.row..) {
                match what {
                    Quantity::Constraint => out[number] = row.value,
                    Quantity::ConstraintRate => out[number] = row.rate(&ends),
                    Quantity::ConstraintBias => out[number] = row.bias,
                    _ => {
                        let line = &mut out[number * layout.nv..(number + 1) * layout.nv];
                        for (end, columns) in
                            [(&ends.parent, &row.parent), (&ends.child, &row.child)]
                        {
                            write_columns(layout.directions, end, columns, line);
                        }
                    }
                }
            }
        }
    }

    /// Fills and factorises the system of (1) and (2).
    fn prepare(&mut self, evaluation: &Evaluation<'_, S>) {
        let (layout, numbers) = (evaluation.layout, evaluation.numbers);
        let plan = &layout.elimination;
        self.run(evaluation, |joint| evaluation.system_ends(joint));
        self.system.clear();
        for (index, step) in plan.steps.iter().enumerate() {
            enter::<S>(evaluation.scene, step.part);
            match step.part {
                Part::Body(body) => self.write_body(evaluation, index, body),
                Part::Point(point) => {
                    let mass = numbers.points[point].0;
                    for i in 0..step.size {
                        self.system.set_diagonal(plan, index, (i, i), mass);
                    }
                }
                Part::Joint(joint) => {
                    let [parent, child] = layout.joints[joint].ends.map(|end| plan.step_of(end?));
                    let rows = in_system(layout, joint, &self.rows, &self.kept);
                    let hidden = !step.rides && plan.carriers.iter().any(Option::is_some);
                    for (number, row) in rows.iter().enumerate() {
                        if hidden {
                            let size = self.size(evaluation, joint, row);
                            self.system.set_size(plan, index, number, size);
                        }
                        for (end, columns) in [(parent, &row.parent), (child, &row.child)] {
                            let Some(end) = end else { continue };
                            let both = layout
                                .directions
                                .components(&columns.linear, &columns.angular);
                            let speeds = plan.steps[end].size;
                            for (speed, value) in both.take(speeds).enumerate() {
                                let (row, column) = ((index, number), (end, speed));
                                self.system.set_coupling(plan, row, column, value);
                            }
                        }
                    }
                }
            }
        }
        self.system
            .factor(plan, |part| enter::<S>(evaluation.scene, part));
    }

    /// The element of Φ_v M⁻¹ Φ_vᵀ of a row, products of inertia aside.
    fn size(&self, evaluation: &Evaluation<'_, S>, joint: usize, row: &Row<S>) -> S {
        let (numbers, directions) = (evaluation.numbers, evaluation.layout.directions);
        let ends = evaluation.layout.joints[joint].ends.into_iter();
        ends.zip([&row.parent, &row.child])
            .fold(S::zero(), |sum, (end, columns)| {
                let moves = directions.moves().iter().map(|&k| columns.linear[k]);
                let linear = moves.fold(S::zero(), |sum, x| sum + x * x);
                match end {
                    Some(Part::Body(body)) => {
                        let body = &numbers.bodies[body];
                        let turns = directions.turns().iter();
                        let turned = turns.fold(linear * body.inverse_mass, |sum, &k| {
                            let x = columns.angular[k];
                            sum + x * x * body.inverse_inertia[(k, k)]
                        });
                        sum + turned
                    }
                    Some(Part::Point(point)) => sum + linear * numbers.points[point].1,
                    _ => sum,
                }
            })
    }

    /// Writes the mass block of a body about its reference point r: [m I, m R r̃; ·, I′ + m r̃ᵀ r̃], in a plane its part there, and the
    /// directions of its speeds.
    fn write_body(&mut self, evaluation: &Evaluation<'_, S>, index: usize, body: usize) {
        let plan = &evaluation.layout.elimination;
        let numbers = &evaluation.numbers.bodies[body];
        let mut inertia = numbers.inertia;
        if let Some(r) = evaluation.reference(body) {
            let square = r.dot(&r);
            inertia = nalgebra::Matrix3::from_fn(|i, j| {
                let diagonal = if i == j { square } else { S::zero() };
                inertia[(i, j)] + numbers.mass * (diagonal - r[i] * r[j])
            });
        }
        let levers = evaluation.levers(body);
        let (moves, turns) = (
            evaluation.layout.directions.moves(),
            evaluation.layout.directions.turns(),
        );
        for k in 0..moves.len() {
            self.system.set_diagonal(plan, index, (k, k), numbers.mass);
        }
        for (i, &turn) in turns.iter().enumerate() {
            let row = moves.len() + i;
            for (j, &other) in turns.iter().enumerate().take(i + 1) {
                let place = (row, moves.len() + j);
                self.system
                    .set_diagonal(plan, index, place, inertia[(turn, other)]);
            }
            if let Some(levers) = &levers {
                for (k, &along) in moves.iter().enumerate() {
                    let value = numbers.mass * levers[along][turn];
                    self.system.set_diagonal(plan, index, (row, k), value);
                }
            }
        }
        let carrier = plan.carriers.get(body).copied().flatten();
        if let (Some(partition), Some(joint)) = (plan.steps[index].partition, carrier) {
            self.write_directions(evaluation, index, joint, &partition);
        }
    }

    /// Writes the directions E of a carried body's angular speeds: those its joint determines first.
    fn write_directions(
        &mut self,
        evaluation: &Evaluation<'_, S>,
        index: usize,
        joint: usize,
        partition: &Partition,
    ) {
        if evaluation.layout.directions.plane.is_some() {
            // There is one angular speed.
            return;
        }
        let Some(ends) = evaluation.ends(joint, AngularVelocity::Body) else {
            return;
        };
        let [u, v] = partition.axis.complement();
        let (free, first, second) = (
            ends.child.axis(&partition.axis),
            ends.child.axis(&u),
            ends.child.axis(&v),
        );
        let [first, second] = match (partition.turns, self.rows[joint].rows().get(3)) {
            (1, Some(row)) => [row.child.angular, free.cross(&row.child.angular)],
            _ => [first, second],
        };
        let plan = &evaluation.layout.elimination;
        let directions = nalgebra::Matrix3::from_columns(&[first, second, free]);
        self.system.set_directions(plan, index, &directions);
    }

    /// Solves (1): accelerations less the common fall, and −λ.
    pub fn accelerate(&mut self, evaluation: &Evaluation<'_, S>, assembly: &Assembly<S>) {
        self.prepare(evaluation);
        let (layout, numbers) = (evaluation.layout, evaluation.numbers);
        let (plan, directions) = (&layout.elimination, layout.directions);
        let fall = common_fall(evaluation);
        let uniform = matches!(numbers.gravity, GravityNumbers::Uniform(_));
        for (index, step) in plan.steps.iter().enumerate() {
            enter::<S>(evaluation.scene, step.part);
            let right = self.system.unknowns_mut(plan, index);
            match step.part {
                Part::Body(body) => {
                    let (motion, numbers) = (&evaluation.motions[body], &numbers.bodies[body]);
                    let (mut force, torque) = assembly.bodies[body];
                    if !uniform {
                        force += body_gravity(evaluation, body).map(|g| numbers.mass * g);
                    }
                    let mut torque = motion.rotation.transpose() * torque + assembly.own[body]
                        - motion.gyroscopic(numbers);
                    for (k, lever) in evaluation.levers(body).iter().flatten().enumerate() {
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
                Part::Joint(joint) => {
                    let ends = layout.joints[joint].ends;
                    let rows = in_system(layout, joint, &self.rows, &self.kept);
                    for (slot, row) in right.iter_mut().zip(rows) {
                        // Between two bodies the common fall cancels: their linear columns are opposite.
                        *slot = match ends {
                            [Some(_), Some(_)] => row.bias,
                            [Some(_), None] => row.bias - row.parent.linear.dot(&fall),
                            _ => row.bias - row.child.linear.dot(&fall),
                        };
                    }
                }
            }
        }
        self.system
            .solve(plan, |part| enter::<S>(evaluation.scene, part));
    }

    /// Linear acceleration (world axes) and ω̇ (components of the state) of a body that joints hold, after [`Constraints::accelerate`].
    pub fn body_acceleration(
        &self,
        evaluation: &Evaluation<'_, S>,
        body: usize,
    ) -> Option<[Vector3<S>; 2]> {
        let plan = &evaluation.layout.elimination;
        let unknowns = self.system.unknowns(plan, plan.step_of(Part::Body(body))?);
        let spin = evaluation.layout.directions.angular(unknowns, 0);
        let spin = state_components(evaluation, body, spin);
        let acceleration = of_centre(evaluation, body, unknowns);
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

    /// Writes the multipliers, or the reactions by (3), after [`Constraints::accelerate`].
    pub fn write_forces(&self, what: Quantity, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        let layout = evaluation.layout;
        for (index, slots) in layout.joints.iter().enumerate() {
            let Some(step) = layout.elimination.step_of(Part::Joint(index)) else {
                if what == Quantity::Reactions {
                    out[6 * index..6 * index + 6].fill(S::zero());
                }
                continue;
            };
            enter::<S>(evaluation.scene, Part::Joint(index));
            let unknowns = self.system.unknowns(&layout.elimination, step);
            if what == Quantity::Multipliers {
                let own = &mut out[slots.row..slots.row + slots.len];
                own.fill(S::zero());
                self.each_kept(evaluation, index, |number, row, part| {
                    own[row] -= unknowns[number] * part;
                });
                continue;
            }
            let rows = in_system(layout, index, &self.rows, &self.kept);
            let unknowns = unknowns.iter().copied();
            let [force, torque] = reaction(evaluation, index, rows.iter().zip(unknowns));
            write(out, 6 * index, &force);
            write(out, 6 * index + 3, &torque);
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
            let Some(ends) = evaluation.ends(index, AngularVelocity::Body) else {
                continue;
            };
            let unknowns = self.system.unknowns(&layout.elimination, step);
            let rows = in_system(layout, index, &self.rows, &self.kept);
            for (row, &unknown) in rows.iter().zip(unknowns) {
                power += unknown * row.prescribed_rate(&ends);
            }
        }
        power
    }

    /// Hands out what each row of the system is made of: its number, a row of the joint, and how much of it.
    fn each_kept(
        &self,
        evaluation: &Evaluation<'_, S>,
        joint: usize,
        mut each: impl FnMut(usize, usize, S),
    ) {
        let slots = &evaluation.layout.joints[joint];
        if slots.all_kept() {
            return (0..slots.len).for_each(|row| each(row, row, S::one()));
        }
        let Some(ends) = evaluation.ends(joint, AngularVelocity::Body) else {
            return;
        };
        for (number, row) in slots.kept.rows().enumerate() {
            let parts = self.rows[joint].parts(row, &ends);
            for (row, part) in parts.into_iter().flatten() {
                each(number, row, part);
            }
        }
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
                self.each_kept(evaluation, joint, |number, row, part| {
                    right[number] -= asked[row] * part;
                });
                let own = self.system.unknowns_mut(plan, step);
                own.copy_from_slice(&right[..own.len()]);
            }
        }
        self.system
            .solve(plan, |part| enter::<S>(evaluation.scene, part));
        out.fill(S::zero());
        out[layout.nv] = self.system.margin(plan);
        for (index, step) in plan.steps.iter().enumerate() {
            enter::<S>(evaluation.scene, step.part);
            let unknowns = self.system.unknowns(plan, index);
            match step.part {
                Part::Body(body) => {
                    let at = layout.bodies[body].v;
                    let turn = directions.angular(unknowns, 0);
                    let turn = state_components(evaluation, body, turn);
                    directions.write_linear(out, at, &of_centre(evaluation, body, unknowns));
                    directions.write_angular(out, at, &turn);
                }
                Part::Point(point) => {
                    if let PointSlots::Mass(slots) = layout.points[point] {
                        let moved = directions.linear(unknowns, 0);
                        directions.write_linear(out, slots.v, &moved);
                    }
                }
                Part::Joint(_) => {}
            }
        }
    }
}

/// The velocity, or its rate, of the centre of mass, world axes, from the unknowns of a body.
fn of_centre<S: Real>(evaluation: &Evaluation<'_, S>, body: usize, unknowns: &[S]) -> Vector3<S> {
    let directions = evaluation.layout.directions;
    let (at_reference, spin): (Vector3<S>, Vector3<S>) = (
        directions.linear(unknowns, 0),
        directions.angular(unknowns, 0),
    );
    match evaluation.levers(body) {
        Some(levers) => Vector3::from_fn(|k, _| at_reference[k] + levers[k].dot(&spin)),
        None => at_reference,
    }
}

/// A vector of a body's own axes in the components the state carries.
fn state_components<S: Real>(
    evaluation: &Evaluation<'_, S>,
    body: usize,
    own: Vector3<S>,
) -> Vector3<S> {
    match evaluation.scene.angular_velocity {
        AngularVelocity::Body => own,
        AngularVelocity::World => evaluation.motions[body].rotation * own,
    }
}

/// Says that the terms which follow belong to a part of the system.
fn enter<S: Real>(scene: &Scene, part: Part) {
    let name = match part {
        Part::Body(body) => scene.bodies.get(body).map(|body| &body.name),
        Part::Point(point) => scene.points.get(point).map(|point| &point.name),
        Part::Joint(joint) => scene.joints.get(joint).map(|joint| &joint.name),
    };
    S::section(name.map_or("", String::as_str));
}

/// Writes the non-zero columns of one end into a row of Φ_v.
fn write_columns<S: Real>(
    directions: Directions,
    end: &End<S>,
    columns: &Columns<S>,
    line: &mut [S],
) {
    let Some((first, speeds)) = end.speeds else {
        return;
    };
    let both = directions.components(&columns.linear, &columns.angular);
    for (slot, value) in line.iter_mut().skip(first).zip(both.take(speeds)) {
        *slot = value;
    }
}
