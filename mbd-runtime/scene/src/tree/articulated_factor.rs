//! M⁻¹ of a long tree without rows, as a list of numbers, and solutions by it in one pass to the root and one back: linear in the number of links, where
//! the dense factor of M takes a number for every pair of speeds of which one carries the other.
//!
//! ```text
//! u = τ − h·p,   p += V u,   p_p += [p_f; p_n + r × p_f]            from the leaves, columns last to first                    (1)
//! u̇ = u/D − V·A,   A += h u̇,   A = [A_p + α_p × r; α_p]            from the root                                             (2)
//! V = U/D,  U = I h,  D = h·U                                         of [`super::articulated`]; h, V, r in world axes          (3)
//! ```
//!
//! In world axes a force goes from link to link without rotation, and what a plane leaves out is zero in all of them.

use nalgebra::Vector3;

use super::articulated::{Articulated, unit};
use super::system::{TreeSystem, each_floating, floating_len, links, rotate_by_list};
use crate::laws::evaluation::Evaluation;
use crate::{Layout, PointSlots, Real, Twist};

/// Numbers of an offset, and of a column with V and 1/D.
const OFFSET: usize = 3;
const COLUMN: usize = 13;

/// Length of the list.
pub(super) fn articulated_len(layout: &Layout) -> usize {
    let all = links(layout).iter();
    let columns: usize = all.map(|link| OFFSET + COLUMN * link.speeds).sum();
    columns + floating_len(layout) + 1
}

fn twist<S: Real>(numbers: &[S]) -> Twist<S> {
    Twist {
        linear: Vector3::from_column_slice(&numbers[..3]),
        angular: Vector3::from_column_slice(&numbers[3..6]),
    }
}

impl<S: Real> TreeSystem<S> {
    /// Writes r, then h, V, 1/D of each column, link by link; T of the bodies that float; last the margin, of no rows.
    pub(super) fn write_articulated_factor(
        &mut self,
        evaluation: &Evaluation<'_, S>,
        out: &mut [S],
    ) {
        let all = links(evaluation.layout);
        self.group_inertias(evaluation);
        for (index, inertia) in self.inertias.iter().enumerate() {
            self.articulated[index] = Articulated::of(inertia, Twist::zero());
        }
        let (still, forces) = (Twist::zero(), [S::zero(); 6]);
        for (index, link) in all.iter().enumerate().rev() {
            S::section(&evaluation.scene.bodies[link.body].name);
            let motion = &evaluation.links[index];
            self.articulated[index].release(motion, &forces, |_| true);
            if let Some(inboard) = link.inboard {
                let (before, own) = self.articulated.split_at_mut(index);
                before[inboard].take(&own[0], motion, &still);
            }
        }
        let mut place = 0;
        let mut next = |values: &[S]| {
            out[place..place + values.len()].copy_from_slice(values);
            place += values.len();
        };
        for (index, link) in all.iter().enumerate() {
            S::section(&evaluation.scene.bodies[link.body].name);
            let motion = &evaluation.links[index];
            let offset = link.inboard.map_or_else(Vector3::zeros, |inboard| {
                evaluation.links[inboard].axes * motion.offset
            });
            next(offset.as_slice());
            for (k, column) in motion.columns.iter().enumerate() {
                let (push, inverse) = self.articulated[index].eliminated(k);
                let [column, mut push] = [*column, push].map(|own| Twist {
                    linear: motion.axes * own.linear,
                    angular: motion.axes * own.angular,
                });
                push.linear *= inverse;
                push.angular *= inverse;
                // h·V = 1: what is left along an axis after (1) is τ itself.
                match unit(&column) {
                    Some(axis @ 0..3) => push.linear[axis] = S::one(),
                    Some(axis) => push.angular[axis - 3] = S::one(),
                    None => {}
                }
                for part in [&column, &push] {
                    next(part.linear.as_slice());
                    next(part.angular.as_slice());
                }
                next(&[inverse]);
            }
        }
        each_floating(evaluation, &mut |_, axes| next(axes.as_slice()));
        next(&[S::one()]);
    }

    /// Solves by that list, and writes x.
    pub(super) fn solve_articulated(
        &mut self,
        evaluation: &Evaluation<'_, S>,
        list: &[S],
        out: &mut [S],
    ) {
        let (layout, all) = (evaluation.layout, links(evaluation.layout));
        out.copy_from_slice(&evaluation.at.rows[list.len()..]);
        for (point, slots) in layout.points.iter().enumerate() {
            if let PointSlots::Mass(slots) = slots {
                let inverse = evaluation.numbers.points[point].1;
                let own = slots.v..slots.v + layout.directions.translations().len();
                out[own].iter_mut().for_each(|slot| *slot *= inverse);
            }
        }
        let mut place = list.len() - 1 - floating_len(layout);
        let floating = &list[place..];
        rotate_by_list(evaluation, floating, true, out);
        self.pushes.fill(Twist::zero());
        for (index, link) in all.iter().enumerate().rev() {
            S::section(&evaluation.scene.bodies[link.body].name);
            let mut push = self.pushes[index];
            for speed in (link.slots.v..link.slots.v + link.speeds).rev() {
                place -= COLUMN;
                let (h, v) = (twist(&list[place..]), twist(&list[place + 6..]));
                let force = out[speed];
                out[speed] -= h.dot(&push);
                push = push.plus(&v, out[speed]);
                match unit(&h) {
                    Some(axis @ 0..3) => push.linear[axis] = force,
                    Some(axis) => push.angular[axis - 3] = force,
                    None => {}
                }
            }
            place -= OFFSET;
            if let Some(inboard) = link.inboard {
                let offset = Vector3::from_column_slice(&list[place..place + OFFSET]);
                let own = &mut self.pushes[inboard];
                own.angular += push.angular + offset.cross(&push.linear);
                own.linear += push.linear;
            }
        }
        for (index, link) in all.iter().enumerate() {
            S::section(&evaluation.scene.bodies[link.body].name);
            let offset = Vector3::from_column_slice(&list[place..place + OFFSET]);
            place += OFFSET;
            let mut own = link.inboard.map_or_else(Twist::zero, |inboard| {
                let inboard = self.accelerations[inboard];
                Twist {
                    linear: inboard.linear + inboard.angular.cross(&offset),
                    ..inboard
                }
            });
            for slot in &mut out[link.slots.v..link.slots.v + link.speeds] {
                let (h, v) = (twist(&list[place..]), twist(&list[place + 6..]));
                *slot = *slot * list[place + 12] - v.dot(&own);
                own = own.plus(&h, *slot);
                place += COLUMN;
            }
            self.accelerations[index] = own;
        }
        rotate_by_list(evaluation, floating, false, out);
    }
}
