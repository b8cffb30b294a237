//! The equations of motion before they are solved, the factor of their system as a list of numbers, and solutions by it: what derivatives are made of.

use super::articulated_factor::articulated_len;
use super::dependent::DependentSpeeds;
use super::system::{
    TreeSystem, each_floating, floating_len, into_link, into_state, rotate_by_list,
    write_coordinate_rates,
};
use crate::elimination::{enter, factored, sparse_dot};
use crate::laws::evaluation::Evaluation;
use crate::laws::forces::AppliedForces;
use crate::laws::gravity::point_gravity;
use crate::{Layout, Part, PointSlots, Real};

impl<S: Real> TreeSystem<S> {
    /// Writes the equations of motion before they are solved, at given v̇ and λ.
    pub fn write_residual(
        &mut self,
        evaluation: &Evaluation<'_, S>,
        assembly: &AppliedForces<S>,
        out: &mut [S],
    ) {
        let (layout, given) = (evaluation.layout, evaluation.at.rows);
        if given.len() != layout.nv + layout.nc {
            return out.fill(S::from_f64(f64::NAN));
        }
        write_coordinate_rates(evaluation, out);
        evaluation.write_other_rates(out);
        let (rates, multipliers) = given.split_at(layout.nv);
        if layout.nc > 0 {
            self.run_rows(evaluation, true);
        }
        let mut own = std::mem::take(&mut self.rates);
        own.copy_from_slice(rates);
        into_link(evaluation, &mut own);
        self.group_inertias(evaluation);
        self.move_links(evaluation, &own);
        self.balance(evaluation, Some(assembly));
        self.hand_on(evaluation);
        let n = layout.nv;
        for (slot, acting) in self.along.iter_mut().zip(&assembly.along) {
            *slot -= *acting;
        }
        for (point, slots) in layout.points.iter().enumerate() {
            if let PointSlots::Mass(slots) = slots {
                let mass = evaluation.numbers.points[point].0;
                let directions = layout.directions;
                let fall =
                    directions.linear(&own, slots.v) - point_gravity(evaluation, point, slots.q);
                let left = fall.map(|x| mass * x) - assembly.points[point];
                directions.write_linear(&mut self.along, slots.v, &left);
            }
        }
        let rows = out.len() - layout.nc;
        for (joint, slots) in layout.joints.iter().enumerate() {
            S::section(&evaluation.scene.joints[joint].name);
            out[rows + slots.row..rows + slots.row + slots.len].fill(S::zero());
            for number in slots.row..slots.row + slots.kept.len() {
                let line = &self.rows.lines[number * n..(number + 1) * n];
                for (slot, &column) in self
                    .along
                    .iter_mut()
                    .zip(line)
                    .filter(|(_, column)| !column.is_zero())
                {
                    *slot -= column * multipliers[number];
                }
                let left = sparse_dot(line, &own);
                out[rows + number] = left - self.rows.levels[number].bias;
            }
        }
        self.rates = own;
        out[layout.nq..layout.nq + n].copy_from_slice(&self.along);
        into_state(evaluation, &mut out[layout.nq..layout.nq + n]);
    }

    /// Eliminates and writes what solutions need: the factor, T of the bodies that float, what dependent speeds need; last the margin.
    pub fn write_factor(&mut self, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        if evaluation.layout.elimination.order.articulated_factor {
            return self.write_articulated_factor(evaluation, out);
        }
        self.prepare(evaluation, &|_, _| S::zero());
        let plan = &evaluation.layout.elimination;
        let mut place = 0;
        let mut next = |value: S| {
            out[place] = value;
            place += 1;
        };
        factored(plan, &mut |bank, at| next(self.system.factored(bank, at)));
        each_floating(evaluation, &mut |_, axes| {
            axes.iter().for_each(|x| next(*x))
        });
        self.dependent.each_factored(&mut |number| next(*number));
        next(self.system.margin(plan));
    }

    /// Solves by that list, and writes x and y.
    pub fn solve_by_factor(&mut self, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        let (layout, given) = (evaluation.layout, evaluation.at.rows);
        let plan = &layout.elimination;
        let count = given.len().saturating_sub(layout.nv + layout.nc);
        if count != layout.factor {
            return out.fill(S::from_f64(f64::NAN));
        }
        let (list, asked) = given.split_at(count);
        if plan.order.articulated_factor {
            return self.solve_articulated(evaluation, list, out);
        }
        self.system.clear();
        let mut place = 0;
        factored(plan, &mut |bank, at| {
            self.system.set_factored(bank, at, list[place]);
            place += 1;
        });
        let floating = &list[place..place + floating_len(layout)];
        self.along.copy_from_slice(&asked[..layout.nv]);
        rotate_by_list(evaluation, floating, true, &mut self.along);
        let behind = count - 1 - DependentSpeeds::<S>::factored_len(layout);
        let mut behind = list[behind..count - 1].iter();
        self.dependent.each_factored(&mut |number| {
            if let Some(listed) = behind.next() {
                *number = *listed;
            }
        });
        self.dependent
            .prescribe(plan, &|row| asked[layout.nv + row]);
        self.dependent.take_inertia_off(plan, &mut self.along);
        self.dependent.substitute_forces(plan, &mut self.along);
        for (index, step) in plan.steps.iter().enumerate() {
            let right = self.system.unknowns_mut(plan, index);
            for (slot, &speed) in right.iter_mut().zip(&step.speeds) {
                *slot = self.along[speed];
            }
            if let Part::Joint(joint) = step.part {
                let first = layout.joints[joint].row;
                for (row, slot) in (first..).zip(right) {
                    *slot = asked[layout.nv + row] - self.dependent.along(plan, row);
                }
            }
        }
        self.system
            .solve(plan, &|part| enter::<S>(evaluation.scene, part));
        out.fill(S::zero());
        for (index, step) in plan.steps.iter().enumerate() {
            let unknowns = self.system.unknowns(plan, index);
            for (&speed, rate) in step.speeds.iter().zip(unknowns) {
                out[speed] = *rate;
            }
            if let Part::Joint(joint) = step.part {
                for (row, x) in (layout.joints[joint].row..).zip(unknowns) {
                    out[layout.nv + row] = -*x;
                    self.dependent.note(row, -*x);
                }
            }
        }
        let (rates, multipliers) = out.split_at_mut(layout.nv);
        self.dependent
            .follow(plan, rates, &mut |row, own| multipliers[row] = own);
        for (point, slots) in layout.points.iter().enumerate() {
            if let (PointSlots::Mass(slots), None) = (slots, plan.step_of(Part::Point(point))) {
                let inverse = evaluation.numbers.points[point].1;
                let own = slots.v..slots.v + layout.directions.translations().len();
                for (to, from) in out[own.clone()].iter_mut().zip(&self.along[own]) {
                    *to = *from * inverse;
                }
            }
        }
        rotate_by_list(evaluation, floating, false, &mut out[..layout.nv]);
    }
}

/// Length of the list of a factor.
pub(crate) fn factored_len(layout: &Layout) -> usize {
    if layout.elimination.order.articulated_factor {
        return articulated_len(layout);
    }
    let mut count = 1;
    factored(&layout.elimination, &mut |_, _| count += 1);
    count + DependentSpeeds::<f64>::factored_len(layout) + floating_len(layout)
}
