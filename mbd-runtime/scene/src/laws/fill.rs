//! Bodies, points and joints written into the system of the constraints: masses, rows, and the directions in which a carried body moves.

use super::constraint::{Constraints, enter, in_system};
use super::evaluation::Evaluation;
use super::rows::{Row, RowKind, Turn};
use crate::elimination::Part;
use crate::partition::Ways;
use crate::{AngularVelocity, Partition, Real};
use nalgebra::Vector3;

impl<S: Real> Constraints<S> {
    /// Fills and factorises the system of (1) and (2).
    pub(super) fn prepare(&mut self, evaluation: &Evaluation<'_, S>) {
        let (layout, numbers) = (evaluation.layout, evaluation.numbers);
        let plan = &layout.elimination;
        let mut seats = std::mem::take(&mut self.seats);
        evaluation.seats(&mut seats);
        self.run(evaluation, |joint| evaluation.system_ends(joint, &seats));
        self.seats = seats;
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
                    let locked = step.rides && plan.locks(index);
                    if let (true, Some(parent)) = (locked, parent) {
                        self.system.set_carried(plan, index, parent);
                    }
                    let hidden = !step.rides && plan.carriers.iter().any(Option::is_some);
                    for (number, row) in rows.iter().enumerate() {
                        if hidden {
                            let size = self.size(evaluation, joint, row);
                            self.system.set_size(plan, index, number, size);
                        }
                        // A body that is locked to its parent has its unknowns.
                        let parent = parent.filter(|_| !locked);
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
                        let angular = match self.seats[body] {
                            // A locked body has unknowns elsewhere and along other axes.
                            Some(seat) if !matches!(seat.turn, Turn::None) => {
                                let pushed = seat.outward.back(&columns.linear);
                                let about_centre = seat.arm().cross(&pushed) + columns.angular;
                                seat.turn.back(&about_centre)
                            }
                            _ => columns.angular,
                        };
                        let body = &numbers.bodies[body];
                        let turns = directions.turns().iter();
                        let turned = turns.fold(linear * body.inverse_mass, |sum, &k| {
                            let x = angular[k];
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
        let Some(seat) = self.seats.get(body).copied().flatten() else {
            return;
        };
        let mut inertia = match seat.turn {
            Turn::None => numbers.inertia,
            Turn::By(turn) => turn * numbers.inertia * turn.transpose(),
        };
        if let Some(r) = seat.reference {
            let square = r.dot(&r);
            inertia = nalgebra::Matrix3::from_fn(|i, j| {
                let diagonal = if i == j { square } else { S::zero() };
                inertia[(i, j)] + numbers.mass * (diagonal - r[i] * r[j])
            });
        }
        let levers = seat.levers();
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
            match partition.locked {
                None => self.write_directions(evaluation, index, joint, &partition),
                Some(ways) => self.write_ways(evaluation, (index, body), joint, &ways),
            }
        }
    }

    /// Writes the directions along which the joint's point of a locked body slides, and where that point is.
    fn write_ways(
        &mut self,
        evaluation: &Evaluation<'_, S>,
        (index, body): (usize, usize),
        joint: usize,
        ways: &Ways,
    ) {
        let (plan, directions) = (&evaluation.layout.elimination, evaluation.layout.directions);
        let ends = evaluation.ends(joint, AngularVelocity::Body);
        let (Some(ends), Some(seat)) = (ends, self.seats[body]) else {
            return;
        };
        let point = seat.turn.apply(&ends.child.arm) - seat.arm();
        let levers: [Vector3<S>; 3] = std::array::from_fn(|k| point.cross(&seat.outward.row(k)));
        for (k, &along) in directions.moves().iter().enumerate() {
            for (j, &turn) in directions.turns().iter().enumerate() {
                let (place, value) = ((3 + k, j), levers[along][turn]);
                self.system.set_way(plan, index, place, value);
            }
        }
        let mass = evaluation.numbers.bodies[body].mass;
        let mut rows = self.rows[joint].rows().iter();
        let held = rows.find(|row| matches!(row.kind, RowKind::Along(_)));
        for (way, axis) in ways.axes.iter().enumerate().take(ways.free) {
            let parent = &ends.parent;
            let mut slide = parent.outward.apply(&parent.axis(axis));
            // Half the body's own share: off unit quaternions it is a little less than the whole.
            let mut least = S::from_f64(0.5) * mass;
            if let Some(plane) = directions.plane {
                // What a row holds may lie in the plane by a part only; across it, in the plane, the point is free.
                slide = match held {
                    Some(row) => plane.axis().vector::<S>().cross(&row.child.linear),
                    None => Turn::None.row(directions.moves()[way.min(1)]),
                };
                least *= slide.dot(&slide);
            }
            for (k, &along) in directions.moves().iter().enumerate() {
                self.system.set_way(plan, index, (way, k), slide[along]);
            }
            self.system.set_least(plan, index, way, least);
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
