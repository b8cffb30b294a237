//! What joints push with: reactions, and the power of prescribed motions.

use nalgebra::Vector3;

use super::assemble::near;
use super::system::{TreeSystem, into_link, links};
use crate::elimination::reaction;
use crate::laws::evaluation::Evaluation;
use crate::laws::forces::AppliedForces;
use crate::laws::joint_forces::{add_on_children, on_child};
use crate::scalar::algebra::write;
use crate::{AngularVelocity, Link, Place, Quantity, Real};

impl<S: Real> TreeSystem<S> {
    /// Writes λ, or force and torque of every joint on its child, after [`TreeSystem::accelerate`].
    pub fn write_solved(
        &mut self,
        what: Quantity,
        evaluation: &Evaluation<'_, S>,
        assembly: &AppliedForces<S>,
        out: &mut [S],
    ) {
        if what == Quantity::Multipliers {
            return out.copy_from_slice(&self.multipliers);
        }
        self.find_pushes(evaluation, assembly);
        let layout = evaluation.layout;
        out.fill(S::zero());
        for joint in 0..layout.joints.len() {
            S::section(&evaluation.scene.joints[joint].name);
            let [force, torque] = match layout.carried(joint) {
                Some(link) => self.reaction(evaluation, joint, link),
                None => self.rows_on_child(evaluation, joint),
            };
            write(out, 6 * joint, &force);
            write(out, 6 * joint + 3, &torque);
        }
        let closes = |joint: usize| layout.carried(joint).is_none();
        add_on_children(evaluation, closes, out);
    }

    /// What every joint pushes its link with, forces along its coordinate included, by u̇ and λ at hand.
    pub(super) fn find_pushes(
        &mut self,
        evaluation: &Evaluation<'_, S>,
        assembly: &AppliedForces<S>,
    ) {
        let rates = std::mem::take(&mut self.rates);
        self.move_links(evaluation, &rates);
        self.rates = rates;
        // What joints carry depends on where the mass is.
        self.read_inertias(evaluation);
        self.balance(evaluation, Some(assembly));
        let multipliers = std::mem::take(&mut self.multipliers);
        let by_rows = self.rows.pushes(evaluation, &multipliers);
        for (push, row) in self.pushes.iter_mut().zip(by_rows) {
            *push = push.plus(row, -S::one());
        }
        self.multipliers = multipliers;
        self.hand_on(evaluation);
    }

    /// Force and torque of a joint of the tree on its child about the origin of frame 2, world axes, what acts along its coordinates among them.
    pub(super) fn reaction(
        &self,
        evaluation: &Evaluation<'_, S>,
        joint: usize,
        link: &Link,
    ) -> [Vector3<S>; 2] {
        let Some(index) = evaluation
            .layout
            .tree
            .as_ref()
            .and_then(|tree| *tree.of_joint.get(joint)?)
        else {
            return [Vector3::zeros(); 2];
        };
        let (motion, push) = (&evaluation.links[index], &self.pushes[index]);
        let (mut force, mut torque) = (motion.axes * push.linear, motion.axes * push.angular);
        if link.reversed {
            // On the child the opposite, about the other frame.
            let far = evaluation.position_of(evaluation.scene.joints[joint].child);
            let arm = motion.origin - far.unwrap_or(motion.origin);
            torque = -(torque + arm.cross(&force));
            force = -force;
        }
        let directions = evaluation.layout.directions;
        [directions.in_plane(force), directions.about_normal(torque)]
    }

    /// The same of a joint that closes a loop, from its rows.
    pub(super) fn rows_on_child(
        &self,
        evaluation: &Evaluation<'_, S>,
        joint: usize,
    ) -> [Vector3<S>; 2] {
        let slots = &evaluation.layout.joints[joint];
        let rows = self.rows.rows[joint].rows().iter();
        let own = self.multipliers[slots.row..slots.row + slots.len]
            .iter()
            .map(|&x| -x);
        match evaluation.ends(joint, AngularVelocity::Body) {
            Some(ends) if slots.len > 0 => reaction(evaluation, &ends.child.outward, rows.zip(own)),
            _ => [Vector3::zeros(); 2],
        }
    }

    /// Power that prescribed motions put in through the joints [W], after [`TreeSystem::accelerate`].
    pub fn drive_power(
        &mut self,
        evaluation: &Evaluation<'_, S>,
        assembly: &AppliedForces<S>,
    ) -> S {
        let layout = evaluation.layout;
        let mut power = S::zero();
        let driven = || layout.joints.iter().filter(|slots| slots.driven);
        if driven().any(|slots| !slots.all_kept()) {
            // Multipliers are those of all rows.
            self.run_rows(evaluation, false);
        }
        for slots in driven() {
            for row in slots.row..slots.row + slots.len {
                power -= self.multipliers[row] * self.rows.levels[row].drive;
            }
        }
        let moving = |link: &Link| {
            let place = near(evaluation, link.joint?, link.reversed)?;
            match place {
                Place::World(frame) => evaluation.moving(frame).copied(),
                _ => None,
            }
        };
        if !links(layout).iter().any(|link| moving(link).is_some()) {
            return power;
        }
        self.find_pushes(evaluation, assembly);
        for link in links(layout) {
            if let (Some(frame), Some(joint)) = (moving(link), link.joint) {
                let [force, torque] = self.reaction(evaluation, joint, link);
                // What acts along coordinates has its power elsewhere.
                let [along, about] = on_child(evaluation, joint);
                let (force, torque) = (force - along, torque - about);
                // On the frame acts the opposite; the reaction is told on the child about frame 2.
                let sign = if link.reversed { -S::one() } else { S::one() };
                let child = evaluation.position_of(evaluation.scene.joints[joint].child);
                let place = evaluation.position_from_origin(frame.position);
                let arm = child.unwrap_or(place) - place;
                let about = torque + arm.cross(&force);
                power += sign * (force.dot(&frame.velocity) + about.dot(&frame.omega));
            }
        }
        power
    }

    /// Force and torque of every joint on its child for given u̇, in the components of the state, and λ of all rows.
    pub fn reactions_for(
        &mut self,
        evaluation: &Evaluation<'_, S>,
        assembly: &AppliedForces<S>,
        out: &mut [S],
    ) {
        self.rates.copy_from_slice(evaluation.accelerations);
        into_link(evaluation, &mut self.rates);
        self.multipliers.copy_from_slice(evaluation.multipliers);
        self.write_solved(Quantity::Reactions, evaluation, assembly, out);
    }

    /// The power of [`TreeSystem::drive_power`] for given u̇ and λ.
    pub fn drive_power_for(
        &mut self,
        evaluation: &Evaluation<'_, S>,
        assembly: &AppliedForces<S>,
    ) -> S {
        self.rates.copy_from_slice(evaluation.accelerations);
        into_link(evaluation, &mut self.rates);
        self.multipliers.copy_from_slice(evaluation.multipliers);
        self.run_rows(evaluation, false);
        self.drive_power(evaluation, assembly)
    }
}
