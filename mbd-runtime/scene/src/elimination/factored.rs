//! The factor of the system as a list of numbers, and solutions by it: many right-hand sides for one elimination.
//!
//! ```text
//! M x = b + Φ_vᵀ y,   Φ_v x = c                                                                                  (1)
//! x = T ξ,   right-hand side of ξ: Tᵀ b          T: unknowns of a body in the system → its speeds                (2)
//! ν = N c,   y = Nᵀ (push − …)                   N: of a joint that carries its child, rows → its unknowns       (3)
//! ```
//!
//! The list: what [`BlockSystem::solve`](super::system::BlockSystem::solve) reads, then body by body T (of a body that no joint holds the inverse of its
//! inertia), joint by joint N, then the margin of the factor.

use nalgebra::Vector3;

use super::articulated::{factored, sparse_dot, sparse_sum};
use super::constraint::{Constraints, enter, in_system};
use crate::laws::evaluation::Evaluation;
use crate::{AngularVelocity, Layout, Part, PointSlots, Real};

/// Length of the list.
pub(crate) fn factored_len(layout: &Layout) -> usize {
    let mut count = 1;
    factored(&layout.elimination, &mut |_, _| count += 1);
    let turns = layout.directions.rotations().len();
    let speeds = layout.directions.speeds();
    for body in 0..layout.bodies.len() {
        count += match layout.elimination.step_of(Part::Body(body)) {
            Some(_) => speeds * speeds,
            None => turns * turns,
        };
    }
    let joints = 0..layout.joints.len();
    let carried = joints.filter(|&joint| layout.elimination.child_of(joint).is_some());
    count
        + carried
            .map(|joint| speeds * layout.joints[joint].kept.len())
            .sum::<usize>()
}

impl<S: Real> Constraints<S> {
    /// Adds what the joints leave over of the equations of motion: −Φ_vᵀ λ to the balances, and the rows Φ_v v̇ − γ behind everything.
    pub fn leave_over(&mut self, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        let components = evaluation.scene.angular_velocity;
        self.run(evaluation, &|_| true, &|joint| {
            evaluation.ends(joint, components)
        });
        let (layout, given) = (evaluation.layout, evaluation.at.rows);
        let directions = layout.directions;
        for (joint, slots) in layout.joints.iter().enumerate() {
            let rows = out.len() - layout.nc + slots.row;
            out[rows..rows + slots.len].fill(S::zero());
            if layout.elimination.step_of(Part::Joint(joint)).is_none() {
                continue;
            }
            enter::<S>(evaluation.scene, Part::Joint(joint));
            let kept = in_system(layout, joint, &self.rows, &self.kept);
            for (number, row) in kept.whole().enumerate() {
                let multiplier = given[layout.nv + slots.row + number];
                let mut left = -row.bias;
                for (part, columns) in row.parts(&slots.ends) {
                    let Some((first, _)) = evaluation.speeds_of(part, components) else {
                        continue;
                    };
                    for (speed, column) in columns.of(part, directions).enumerate() {
                        if column.is_zero() {
                            continue;
                        }
                        out[layout.nq + first + speed] -= column * multiplier;
                        left += column * given[first + speed];
                    }
                }
                out[rows + number] = left;
            }
        }
    }

    /// Eliminates and writes the list.
    pub fn write_factor(&mut self, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        self.prepare(evaluation);
        let layout = evaluation.layout;
        let plan = &layout.elimination;
        let mut place = 0;
        let mut next = |value: S| {
            out[place] = value;
            place += 1;
        };
        factored(plan, &mut |bank, at| next(self.system.factored(bank, at)));
        let (directions, speeds) = (layout.directions, layout.directions.speeds());
        for body in 0..layout.bodies.len() {
            enter::<S>(evaluation.scene, Part::Body(body));
            if plan.step_of(Part::Body(body)).is_none() {
                let inertia = evaluation.numbers.bodies[body].inverse_inertia;
                let rotation = &evaluation.motions[body].rotation;
                let inverse = match evaluation.scene.angular_velocity {
                    AngularVelocity::Body => inertia,
                    AngularVelocity::World => rotation * inertia * rotation.transpose(),
                };
                for &i in directions.rotations() {
                    directions
                        .rotations()
                        .iter()
                        .for_each(|&j| next(inverse[(i, j)]));
                }
                continue;
            }
            for column in 0..speeds {
                let moved = self.motion_of(evaluation, body, &unit::<S>(column)[..speeds]);
                let [linear, angular] = moved.unwrap_or_else(|| [Vector3::zeros(); 2]);
                directions
                    .components(&linear, &angular)
                    .take(speeds)
                    .for_each(&mut next);
            }
        }
        for (joint, slots) in layout.joints.iter().enumerate() {
            if let Some(carriage) = &self.carriages[joint] {
                enter::<S>(evaluation.scene, Part::Joint(joint));
                for row in 0..slots.kept.len() {
                    let held = carriage.to_unknowns(&carriage.solve(&unit(row)));
                    let held = directions.components(&held.linear, &held.angular);
                    held.take(speeds).for_each(&mut next);
                }
            }
        }
        next(self.system.margin(plan));
    }

    /// Solves (1) by the list in the arguments and writes x and y; numbers that are not finite where the arguments have another length.
    pub fn solve_by_factor(&mut self, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        let (layout, numbers) = (evaluation.layout, evaluation.numbers);
        let (plan, given) = (&layout.elimination, evaluation.at.rows);
        let (directions, speeds) = (layout.directions, layout.directions.speeds());
        let count = given.len().saturating_sub(layout.nv + layout.nc);
        let (list, asked) = given.split_at(count);
        if count != layout.factor {
            return out.fill(S::from_f64(f64::NAN));
        }
        out.fill(S::zero());
        self.system.clear();
        let mut place = 0;
        factored(plan, &mut |bank, at| {
            self.system.set_factored(bank, at, list[place]);
            place += 1;
        });
        let (bodies, points) = (place, layout.points.iter().enumerate());
        for (body, slots) in layout.own_bodies() {
            enter::<S>(evaluation.scene, Part::Body(body));
            let own = &asked[slots.v..slots.v + speeds];
            if let Some(step) = plan.step_of(Part::Body(body)) {
                let columns = list[place..].chunks_exact(speeds);
                let unknowns = self.system.unknowns_mut(plan, step);
                for (unknown, column) in unknowns.iter_mut().zip(columns) {
                    *unknown = sparse_dot(column, own);
                }
                place += speeds * speeds;
                continue;
            }
            let (moves, turns) = own.split_at(directions.translations().len());
            let at = slots.v + moves.len();
            for (slot, x) in out[slots.v..at].iter_mut().zip(moves) {
                *slot = numbers.bodies[body].inverse_mass * *x;
            }
            for (slot, row) in out[at..].iter_mut().zip(turns.iter().enumerate()) {
                let row = &list[place + turns.len() * row.0..][..turns.len()];
                *slot = sparse_dot(row, turns);
            }
            place += turns.len() * turns.len();
        }
        for (point, slots) in points {
            let PointSlots::Mass(slots) = slots else {
                continue;
            };
            let own = slots.v..slots.v + directions.translations().len();
            let Some(step) = plan.step_of(Part::Point(point)) else {
                for (slot, x) in out[own.clone()].iter_mut().zip(&asked[own]) {
                    *slot = numbers.points[point].1 * *x;
                }
                continue;
            };
            let unknowns = self.system.unknowns_mut(plan, step);
            unknowns.copy_from_slice(&asked[own]);
        }
        let joints = place;
        for (joint, slots) in layout.joints.iter().enumerate() {
            let Some(step) = plan.step_of(Part::Joint(joint)) else {
                continue;
            };
            enter::<S>(evaluation.scene, Part::Joint(joint));
            let own = &asked[layout.nv + slots.row..][..slots.kept.len()];
            if plan.child_of(joint).is_none() {
                self.system.unknowns_mut(plan, step).copy_from_slice(own);
                continue;
            }
            let held = self.system.held_mut(plan, step - 1);
            for (number, slot) in held.iter_mut().enumerate() {
                let rows = list[place..].chunks_exact(speeds);
                let row = rows.map(|column| column[number]);
                *slot = sparse_sum(row.zip(own.iter().copied()));
            }
            place += speeds * own.len();
        }
        self.system
            .solve(plan, &|part| enter::<S>(evaluation.scene, part));
        place = bodies;
        for (body, slots) in layout.own_bodies() {
            let Some(step) = plan.step_of(Part::Body(body)) else {
                place += directions.rotations().len().pow(2);
                continue;
            };
            enter::<S>(evaluation.scene, Part::Body(body));
            let unknowns = self.system.unknowns(plan, step);
            for (number, slot) in out[slots.v..slots.v + speeds].iter_mut().enumerate() {
                let columns = list[place..].chunks_exact(speeds);
                let row = columns.map(|column| column[number]);
                *slot = sparse_sum(row.zip(unknowns.iter().copied()));
            }
            place += speeds * speeds;
        }
        for (point, slots) in layout.points.iter().enumerate() {
            if let (PointSlots::Mass(slots), Some(step)) = (slots, plan.step_of(Part::Point(point)))
            {
                let own = slots.v..slots.v + directions.translations().len();
                out[own].copy_from_slice(self.system.unknowns(plan, step));
            }
        }
        place = joints;
        for (joint, slots) in layout.joints.iter().enumerate() {
            let Some(step) = plan.step_of(Part::Joint(joint)) else {
                continue;
            };
            enter::<S>(evaluation.scene, Part::Joint(joint));
            let own = &mut out[layout.nv + slots.row..][..slots.kept.len()];
            if plan.child_of(joint).is_none() {
                for (slot, x) in own.iter_mut().zip(self.system.unknowns(plan, step)) {
                    *slot = -*x;
                }
                continue;
            }
            let push = self.system.push(plan, step - 1);
            for (slot, row) in own.iter_mut().zip(list[place..].chunks_exact(speeds)) {
                *slot = -sparse_dot(row, push);
            }
            place += speeds * own.len();
        }
    }
}

/// A list with a one at a place.
fn unit<S: Real>(place: usize) -> [S; 6] {
    std::array::from_fn(|k| if k == place { S::one() } else { S::zero() })
}
