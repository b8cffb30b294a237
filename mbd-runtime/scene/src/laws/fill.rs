//! Bodies, points and joints written into the system of the constraints: masses, rows, and the directions in which a carried body moves.

use super::constraint::{Constraints, enter, in_system};
use super::evaluation::Evaluation;
use super::rows::Row;
use crate::elimination::Part;
use crate::{AngularVelocity, Partition, Real};

impl<S: Real> Constraints<S> {
    /// Fills and factorises the system of (1) and (2).
    pub(super) fn prepare(&mut self, evaluation: &Evaluation<'_, S>) {
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
}
