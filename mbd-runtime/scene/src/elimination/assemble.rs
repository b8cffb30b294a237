//! Bodies, points and joints written into the system of the constraints: masses, rows, and what a joint that carries its child says of it.

use crate::elimination::constraint::{Constraints, enter, in_system};
use crate::elimination::reference::{Reference, rotated};
use crate::joints::Carried;
use crate::laws::evaluation::Evaluation;
use crate::rows::{Ends, Rotation, Row, Rows, WholeRow};
use crate::scalar::Few;
use crate::{Carrying, Part, Place, Real, Twist};
use nalgebra::{Matrix3, Vector3};

/// A joint that carries its child, at one instant. Twists at its joint point Q: see [`Carried`].
#[derive(Clone, Debug)]
pub struct Carriage<S: Real> {
    /// H and N; of the columns of H those that nothing drives.
    carried: Carried<S>,
    /// The columns of its rows on the child.
    rows: Few<Twist<S>, 8>,
    /// N γ, and what the motion of the parent brings along.
    pub(super) bias: Twist<S>,
    /// Components of the rows on the child → world axes.
    pub(super) outward: Rotation<S>,
    /// Components of the angular parts → those of the child's unknowns.
    turn: Rotation<S>,
    /// Where the angular parts have axes of their own: ω_T by the parent's angular velocity, its own components, as the rows tell it.
    across: Option<Matrix3<S>>,
    /// Q from the reference point of the child's unknowns, where these are another: rows k of R q̃.
    lever: Option<[Vector3<S>; 3]>,
}

impl<S: Real> Carriage<S> {
    fn new(
        evaluation: &Evaluation<'_, S>,
        joint: usize,
        carrying: &Carrying,
        rows: &Rows<S>,
    ) -> Option<Self> {
        let (layout, declared) = (evaluation.layout, evaluation.scene.joints.get(joint)?);
        let ends = evaluation.carrying_ends(joint, carrying.own)?;
        let rows = rows.rows();
        let mut carried = match layout.directions.plane {
            Some(_) => Carried::in_plane(rows, carrying, layout.directions)?,
            None => declared.law.carried(&ends, carrying.axes)?,
        };
        let axes = Rotation::from(carried.axes);
        let columns = |row: &Row<S>| Twist {
            linear: row.child().linear,
            angular: axes.back(&row.child().angular),
        };
        let mut along: Few<Twist<S>, 8> = Few::new(Twist::zero());
        along.extend(rows.iter().map(columns));
        let columns = along;
        if layout.directions.plane.is_none() {
            let mut driven: Few<usize, 3> = Few::new(0);
            for ((index, _), row) in declared
                .motors()
                .zip(columns.iter().skip(declared.law.rows()))
            {
                carried.drive(index, row);
                driven.push(index);
            }
            let mut column = 0..;
            carried
                .free
                .retain(|_| column.next().is_some_and(|k| !driven.contains(&k)));
        }
        let relative = |number: usize| rows.get(number).map_or_else(S::zero, |row| row.relative);
        let first = carried.bias.unwrap_or_else(|| carried.first(relative));
        let own = carried.solve(first, &columns, relative);
        let grounded = layout.joints.get(joint)?.ends.first() == Some(&None);
        let brought = brought(evaluation, &ends, (carrying.meets, grounded));
        let bias = Twist {
            linear: own.linear + brought.linear,
            angular: own.angular + axes.back(&brought.angular),
        };
        let across = carried.axes.map(|_| {
            let held = carried.held.iter().zip(rows);
            held.fold(Matrix3::zeros(), |sum, (held, row)| {
                let told = row.parent().angular.map(|x| -(x * held.inverse));
                Matrix3::from_fn(|i, j| {
                    let along = held.column.angular[i];
                    let none = along.is_zero() || told[j].is_zero();
                    if none {
                        sum[(i, j)]
                    } else {
                        sum[(i, j)] + along * told[j]
                    }
                })
            })
        });
        Some(Carriage {
            bias,
            across,
            outward: ends.child.outward,
            turn: Rotation::Identity,
            lever: None,
            rows: columns,
            carried,
        })
    }

    /// Takes up the reference frame of the child, where it is that of the parent.
    fn refer(&mut self, reference: &Reference<S>, place: &Vector3<S>) {
        let outward = self.outward.after(&Rotation::from(self.carried.axes));
        self.turn = reference.turn_from(&outward);
        let point = reference.turn.apply(place) - reference.arm();
        self.lever = Some(reference.lever(&point));
    }

    /// N γ for right-hand sides of the rows.
    pub(super) fn solve(&self, right: &[S; 6]) -> Twist<S> {
        let first = self.carried.first(|number| right[number]);
        self.carried
            .solve(first, &self.rows, |number| right[number])
    }

    /// A velocity of the child at Q in its unknowns.
    pub(super) fn to_unknowns(&self, motion: &Twist<S>) -> Twist<S> {
        let angular = self.turn.apply(&motion.angular);
        let mut linear = motion.linear;
        for (k, lever) in self.lever.iter().flatten().enumerate() {
            linear[k] += lever.dot(&angular);
        }
        Twist { linear, angular }
    }

    /// A force and couple on the unknowns of the child, at Q.
    fn push_in_unknowns(&self, push: &Twist<S>) -> Twist<S> {
        let mut angular = push.angular;
        for (k, lever) in self.lever.iter().flatten().enumerate() {
            angular += lever.map(|x| x * push.linear[k]);
        }
        Twist {
            linear: push.linear,
            angular: self.turn.back(&angular),
        }
    }
}

/// What the motion of the parent brings along, an acceleration of the child at Q: (7) of [`crate::rows`]; of a parent that time or free fall
/// moves, that as well. `grounded`: the parent is the world.
fn brought<S: Real>(
    evaluation: &Evaluation<'_, S>,
    ends: &Ends<'_, S>,
    (meets, grounded): (bool, bool),
) -> Twist<S> {
    let (mut linear, mut angular) = match meets {
        true => (ends.meeting(), ends.spin_in_child().cross),
        false => (ends.sliding(), ends.spin_in_child().cross),
    };
    if let Some([acceleration, alpha]) = ends.parent.prescribed {
        linear += acceleration;
        if !meets {
            linear += alpha.cross(&ends.reach());
        }
        angular += ends.relative().back(&alpha);
    }
    if grounded {
        linear -= crate::elimination::constraint::common_fall(evaluation);
    }
    Twist { linear, angular }
}

impl<S: Real> Constraints<S> {
    /// Assembles and factorises the system of (1) and (2).
    pub(super) fn prepare(&mut self, evaluation: &Evaluation<'_, S>) {
        let (layout, numbers) = (evaluation.layout, evaluation.numbers);
        let plan = &layout.elimination;
        let carrying = |joint: usize| plan.child_of(joint).map(|(_, carrying)| carrying);
        self.run(evaluation, &|joint| carrying(joint).is_some(), &|joint| {
            evaluation.carrying_ends(joint, carrying(joint)?.own)
        });
        for (joint, declared) in evaluation.scene.joints.iter().enumerate() {
            S::section(&declared.name);
            self.carriages[joint] = carrying(joint).and_then(|carrying| {
                Carriage::new(evaluation, joint, &carrying, &self.rows[joint])
            });
        }
        self.refer(evaluation);
        let references = std::mem::take(&mut self.references);
        self.run(evaluation, &|joint| carrying(joint).is_none(), &|joint| {
            evaluation.system_ends(joint, &references)
        });
        self.references = references;
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
                Part::Coordinates(_) => {}
                Part::Joint(joint) if step.paired => self.write_carriage(evaluation, index, joint),
                Part::Joint(joint) => self.write_rows(evaluation, index, joint),
            }
        }
        self.system
            .factor(plan, &|part| enter::<S>(evaluation.scene, part));
    }

    /// The reference frames of all bodies of the system, parents before their children.
    fn refer(&mut self, evaluation: &Evaluation<'_, S>) {
        let plan = &evaluation.layout.elimination;
        for step in plan.steps.iter().rev() {
            let Part::Body(body) = step.part else {
                continue;
            };
            enter::<S>(evaluation.scene, step.part);
            let reference = evaluation.reference(body, &self.references);
            self.references[body] = reference;
            let shared = plan.carrying(body).filter(|(_, carrying)| carrying.shared);
            if let (Some(reference), Some((joint, _))) = (reference, shared)
                && let Some(carriage) = self.carriages[joint].as_mut()
                && let Some(place) = evaluation.arm_of(evaluation.scene.joints[joint].child)
            {
                carriage.refer(&reference, &place);
            }
        }
    }

    /// Writes the rows of a joint that stay in the system.
    fn write_rows(&mut self, evaluation: &Evaluation<'_, S>, index: usize, joint: usize) {
        let layout = evaluation.layout;
        let plan = &layout.elimination;
        let ends = &layout.joints[joint].ends;
        let rows = in_system(layout, joint, &self.rows, &self.kept);
        let hidden = plan.parent_joints.iter().any(Option::is_some);
        let left_out = evaluation.joined(joint).map(|joined| S::one() - joined);
        for (number, row) in rows.whole().enumerate() {
            if let Some(left_out) = left_out {
                self.system
                    .set_diagonal(plan, index, (number, number), -left_out);
            }
            if hidden {
                let mut size = self.size(evaluation, joint, row);
                if let Some(left_out) = left_out {
                    size += left_out;
                }
                self.system.set_size(plan, index, number, size);
            }
            for (part, columns) in row.parts(ends) {
                let Some(step) = plan.step_of(part) else {
                    continue;
                };
                for (speed, value) in columns.of(part, layout.directions).enumerate() {
                    let (row, column) = ((index, number), (step, speed));
                    self.system.set_coupling(plan, row, column, value);
                }
            }
        }
    }

    /// Writes X and H of a joint that carries its child.
    fn write_carriage(&mut self, evaluation: &Evaluation<'_, S>, index: usize, joint: usize) {
        let layout = evaluation.layout;
        let (plan, directions) = (&layout.elimination, layout.directions);
        let (Some(carriage), Some((body, carrying))) =
            (&self.carriages[joint], plan.child_of(joint))
        else {
            return;
        };
        let mass = evaluation.numbers.bodies[body].mass;
        if let Some(axes) = &carriage.carried.axes {
            self.system.set_axes(plan, index - 1, axes);
        }
        for (number, column) in carriage.carried.free.iter().enumerate() {
            // Half the body's own share: off unit quaternions it is a little less than the whole.
            let slides = column.angular.iter().all(|x| x.is_zero());
            let half = S::from_f64(0.5) * mass;
            let square = || column.linear.dot(&column.linear);
            let least = slides.then(|| match directions.plane {
                // What a row holds may lie in the plane by a part only.
                Some(_) => half * square(),
                None => half,
            });
            let column = carriage.to_unknowns(column);
            let values = directions.components(&column.linear, &column.angular);
            self.system.set_free(plan, index - 1, number, values, least);
        }
        let Some(Some(parent)) = layout.joints[joint].ends.first().copied() else {
            return;
        };
        let Some(step) = plan.step_of(parent) else {
            return;
        };
        let (turn, levers) = match (parent, self.references[body]) {
            (Part::Body(parent), Some(child)) if !carrying.shared => {
                match self.references[parent] {
                    Some(parent) => {
                        let lever = evaluation.transport(joint, &parent, carrying.meets);
                        let turn = match &carriage.across {
                            // The rows are in the parent's own components.
                            Some(across) => Rotation::Matrix(*across).after_back(&parent.turn),
                            None => child.rotation_from(&parent),
                        };
                        (turn, lever)
                    }
                    None => return,
                }
            }
            _ => (Rotation::Identity, None),
        };
        let none = [Vector3::zeros(); 3];
        let levers = levers.unwrap_or(none);
        // V_c of a unit of each speed of the parent.
        let units = Matrix3::identity();
        let moves = directions.translations().iter().map(|&axis| Twist {
            linear: units.column(axis).into_owned(),
            angular: Vector3::zeros(),
        });
        let turns = directions.rotations().iter().map(|&axis| Twist {
            linear: Vector3::from_fn(|k, _| levers[k][axis]),
            angular: turn.column(axis),
        });
        for (speed, twist) in moves.chain(turns).enumerate().take(plan.steps[step].size) {
            let both = directions.components(&twist.linear, &twist.angular);
            for (own, value) in both.enumerate() {
                self.system
                    .set_transport(plan, (index, step), (own, speed), value);
            }
        }
    }

    /// Puts what moves the child of every joint that carries one where the system takes it: the linear part adds up from parent to child
    /// ([`Constraints::brought`]), the angular part is ν.
    pub(super) fn bring_along(&mut self, evaluation: &Evaluation<'_, S>) {
        let layout = evaluation.layout;
        let plan = &layout.elimination;
        self.brought.fill(Vector3::zeros());
        for (index, step) in plan.steps.iter().enumerate().rev() {
            let (Part::Joint(joint), true) = (step.part, step.paired) else {
                continue;
            };
            enter::<S>(evaluation.scene, step.part);
            let (Some(carriage), &[parent, Some(Part::Body(child))]) =
                (&self.carriages[joint], &*layout.joints[joint].ends)
            else {
                continue;
            };
            let mut motion = carriage.to_unknowns(&carriage.bias);
            if layout.directions.plane.is_some() {
                // In a plane it saves little, and sums along loops would add to the rounding near positions at which rows lose rank.
                self.hold(evaluation, index - 1, &motion);
                continue;
            }
            if let Some(Part::Body(parent)) = parent {
                motion.linear += self.brought[parent];
            }
            self.brought[child] = motion.linear;
            motion.linear = Vector3::zeros();
            self.hold(evaluation, index - 1, &motion);
        }
    }

    /// Puts ν of the body of a step where the system takes it.
    fn hold(&mut self, evaluation: &Evaluation<'_, S>, body: usize, motion: &Twist<S>) {
        let directions = evaluation.layout.directions;
        let held = self.system.held_mut(&evaluation.layout.elimination, body);
        directions.write_linear(held, 0, &motion.linear);
        directions.write_angular(held, 0, &motion.angular);
    }

    /// Puts N γ for the right-hand sides of the rows of a joint where the system takes it; whether it carries its child.
    pub(super) fn hold_rows(
        &mut self,
        evaluation: &Evaluation<'_, S>,
        (joint, step): (usize, usize),
        right: &[S; 6],
    ) -> bool {
        let Some(carriage) = &self.carriages[joint] else {
            return false;
        };
        let motion = carriage.to_unknowns(&carriage.solve(right));
        self.hold(evaluation, step - 1, &motion);
        true
    }

    /// −λ of a joint that carries its child, after a solution.
    pub(super) fn multipliers(
        &self,
        evaluation: &Evaluation<'_, S>,
        joint: usize,
    ) -> Option<[S; 6]> {
        let (plan, directions) = (&evaluation.layout.elimination, evaluation.layout.directions);
        let carriage = self.carriages[joint].as_ref()?;
        let body = plan.step_of(Part::Joint(joint))?.checked_sub(1)?;
        let push = self.system.push(plan, body);
        let push = carriage.push_in_unknowns(&Twist {
            linear: directions.linear(push, 0),
            angular: directions.angular(push, 0),
        });
        Some(carriage.carried.multipliers(push, &carriage.rows))
    }

    /// The element of Φ_v M⁻¹ Φ_vᵀ of a row, products of inertia aside.
    fn size(&self, evaluation: &Evaluation<'_, S>, joint: usize, row: WholeRow<'_, S>) -> S {
        let (numbers, directions) = (evaluation.numbers, evaluation.layout.directions);
        row.parts(&evaluation.layout.joints[joint].ends)
            .fold(S::zero(), |sum, (part, columns)| {
                let moves = directions.translations().iter().map(|&k| columns.linear[k]);
                let linear = moves.fold(S::zero(), |sum, x| sum + x * x);
                match part {
                    Part::Body(body) => {
                        let angular = match self.references[body] {
                            // Unknowns elsewhere and along other axes.
                            Some(reference) if !matches!(reference.turn, Rotation::Identity) => {
                                let pushed = reference.outward.back(&columns.linear);
                                let about_centre = reference.arm().cross(&pushed) + columns.angular;
                                reference.turn.back(&about_centre)
                            }
                            _ => columns.angular,
                        };
                        let body = &numbers.bodies[body];
                        let turns = directions.rotations().iter();
                        let rotated = turns.fold(linear * body.inverse_mass, |sum, &k| {
                            let x = angular[k];
                            sum + x * x * body.inverse_inertia[(k, k)]
                        });
                        sum + rotated
                    }
                    Part::Point(point) => sum + linear * numbers.points[point].1,
                    Part::Joint(_) | Part::Coordinates(_) => sum,
                }
            })
    }

    /// Writes the mass block of a body about its reference point r: [m I, m R r̃; ·, I + m r̃ᵀ r̃], in a plane its part there.
    fn write_body(&mut self, evaluation: &Evaluation<'_, S>, index: usize, body: usize) {
        let plan = &evaluation.layout.elimination;
        let numbers = &evaluation.numbers.bodies[body];
        let Some(reference) = self.references.get(body).copied().flatten() else {
            return;
        };
        let about = |inertia: Matrix3<S>, r: &Vector3<S>| {
            let square = r.dot(r);
            Matrix3::from_fn(|i, j| {
                let diagonal = if i == j { square } else { S::zero() };
                inertia[(i, j)] + numbers.mass * (diagonal - r[i] * r[j])
            })
        };
        let inertia = match (&reference.place, &reference.point) {
            // The point is a place on the body: its inertia about that is constant.
            (Some(place), _) => rotated(&reference.turn, &about(numbers.inertia, place)),
            (None, Some(point)) => about(rotated(&reference.turn, &numbers.inertia), point),
            (None, None) => rotated(&reference.turn, &numbers.inertia),
        };
        let levers = reference.levers();
        let (moves, turns) = (
            evaluation.layout.directions.translations(),
            evaluation.layout.directions.rotations(),
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
    }
}

impl<S: Real> Evaluation<'_, S> {
    /// The velocity of a joint's point by the angular velocity of its parent: rows of R x̃ᵀ, x the point from the parent's reference point.
    fn transport(
        &self,
        joint: usize,
        parent: &Reference<S>,
        meets: bool,
    ) -> Option<[Vector3<S>; 3]> {
        let declared = self.scene.joints.get(joint)?;
        let point = if meets {
            parent.turn.apply(&self.arm_of(declared.parent)?)
        } else {
            let (Place::Body(on, _), Place::Body(body, _)) = (declared.parent, declared.child)
            else {
                return None;
            };
            let (near, far) = (self.motions.get(on)?, self.motions.get(body)?);
            // The terms of the rows' reach.
            let apart = far.position - near.position;
            let reach = apart + far.arm(&self.arm_of(declared.child)?);
            parent.outward.back(&reach)
        };
        Some(parent.lever(&(parent.arm() - point)))
    }
}
