//! Accelerations, forces and inertia along the tree, and the system of the equations of motion.

use nalgebra::{Matrix3, Vector3};

use super::rows::Level;
use super::system::{TreeSystem, links};
use crate::elimination::{common_fall, enter};
use crate::laws::GravityNumbers;
use crate::laws::evaluation::Evaluation;
use crate::laws::forces::AppliedForces;
use crate::laws::gravity::body_gravity;
use crate::{Link, Part, Place, PointSlots, Real, Twist};

impl<S: Real> TreeSystem<S> {
    /// Accelerations of the links, less the common fall, for those of their coordinates, in the components of the links.
    pub(super) fn move_links(&mut self, evaluation: &Evaluation<'_, S>, rates: &[S]) {
        for (index, link) in links(evaluation.layout).iter().enumerate() {
            S::section(&evaluation.scene.bodies[link.body].name);
            let rates = rates
                .get(link.slots.v..link.slots.v + link.speeds)
                .unwrap_or_default();
            let motion = &evaluation.links[index];
            let own = match self.inboard(evaluation, index) {
                Some(inboard) => motion.accelerated(&inboard),
                None => falling(evaluation, index),
            };
            let columns = motion.columns.iter().zip(rates);
            self.accelerations[index] =
                columns.fold(own, |own, (column, &rate)| own.plus(column, rate));
        }
    }

    /// The acceleration of what carries a link, less the common fall; `None` for one that floats.
    pub(super) fn inboard(&self, evaluation: &Evaluation<'_, S>, index: usize) -> Option<Twist<S>> {
        let link = &links(evaluation.layout)[index];
        Some(match link.inboard {
            Some(inboard) => self.accelerations[inboard],
            None => base(
                evaluation,
                link.joint?,
                link.reversed,
                &common_fall(evaluation),
            ),
        })
    }

    /// The rows of the joints: all of them, or of each joint those that are in the system, first.
    pub(super) fn run_rows(&mut self, evaluation: &Evaluation<'_, S>, in_system: bool) {
        self.rows.run_tree(evaluation);
        self.move_links(evaluation, &[]);
        self.rows.run(evaluation, &self.accelerations, in_system);
    }

    /// What the joints must push the links with for these accelerations, against `forces` if given, by the inertias at hand.
    pub(super) fn balance(
        &mut self,
        evaluation: &Evaluation<'_, S>,
        forces: Option<&AppliedForces<S>>,
    ) {
        for (index, link) in links(evaluation.layout).iter().enumerate() {
            S::section(&evaluation.scene.bodies[link.body].name);
            let (motion, inertia) = (&evaluation.links[index], self.inertias[index]);
            let mut push = inertia.inertial(&self.accelerations[index], &motion.omega);
            push.add(&self.weight(evaluation, index));
            if let Some(forces) = forces {
                push = push.plus(&applied(evaluation, index, forces), -S::one());
            }
            self.pushes[index] = push;
        }
    }

    /// What gravity that is not the same everywhere asks of the joint of a link.
    pub(super) fn weight(&self, evaluation: &Evaluation<'_, S>, index: usize) -> Twist<S> {
        let numbers = evaluation.numbers;
        if matches!(
            numbers.gravity,
            GravityNumbers::Uniform(_) | GravityNumbers::None
        ) {
            return Twist::zero();
        }
        let body = links(evaluation.layout)[index].body;
        let weight = body_gravity(evaluation, body).map(|g| -(numbers.bodies[body].mass * g));
        evaluation.links[index].taken([&weight, &Vector3::zeros()], &Vector3::zeros())
    }

    /// Hands pushes on from the leaves, and writes what they are along the coordinates.
    pub(super) fn hand_on(&mut self, evaluation: &Evaluation<'_, S>) {
        let all = links(evaluation.layout);
        for (index, link) in all.iter().enumerate().rev() {
            S::section(&evaluation.scene.bodies[link.body].name);
            let (motion, push) = (&evaluation.links[index], self.pushes[index]);
            for k in 0..link.speeds {
                self.along[link.slots.v + k] = motion.along(k, &push);
            }
            if let Some(inboard) = link.inboard {
                let push = motion.hand_on(&push);
                self.pushes[inboard].add(&push);
            }
        }
    }

    /// Writes M of (1) into `mass`, in the components of the links.
    pub(super) fn compose(&mut self, evaluation: &Evaluation<'_, S>) {
        let (layout, all) = (evaluation.layout, links(evaluation.layout));
        let n = layout.nv;
        self.mass.fill(S::zero());
        self.composites.copy_from_slice(&self.inertias);
        for (index, link) in all.iter().enumerate().rev() {
            S::section(&evaluation.scene.bodies[link.body].name);
            let (motion, composite) = (&evaluation.links[index], self.composites[index]);
            if let Some(inboard) = link.inboard {
                self.composites[inboard].take(&composite, &motion.turn, &motion.offset);
            }
            for k in 0..link.speeds {
                let mut push = composite.push(&motion.columns[k]);
                let row = link.slots.v + k;
                for l in 0..=k {
                    let column = link.slots.v + l;
                    self.mass[row * n + column] = motion.along(l, &push);
                    self.mass[column * n + row] = self.mass[row * n + column];
                }
                let mut outboard = index;
                while let Some(inboard) = all[outboard].inboard {
                    push = evaluation.links[outboard].hand_on(&push);
                    for l in 0..all[inboard].speeds {
                        let column = all[inboard].slots.v + l;
                        self.mass[row * n + column] = evaluation.links[inboard].along(l, &push);
                        self.mass[column * n + row] = self.mass[row * n + column];
                    }
                    outboard = inboard;
                }
            }
        }
        for (point, slots) in layout.points.iter().enumerate() {
            if let PointSlots::Mass(slots) = slots {
                for k in slots.v..slots.v + layout.directions.translations().len() {
                    self.mass[k * n + k] = evaluation.numbers.points[point].0;
                }
            }
        }
    }

    /// The rows of a joint that is detached are zero, and −1 on the diagonal says that its λ are.
    fn leave_out_detached(&mut self, evaluation: &Evaluation<'_, S>, step: usize, part: Part) {
        let plan = &evaluation.layout.elimination;
        let Part::Joint(joint) = part else { return };
        if let Some(joined) = evaluation.joined(joint) {
            for row in 0..plan.steps[step].size {
                let left_out = joined - S::one();
                self.system.set_diagonal(plan, step, (row, row), left_out);
            }
        }
    }

    /// Assembles and factorises (1) for the independent speeds; what is `prescribed` of each row of the tree is in the accelerations of the links.
    pub(super) fn prepare(
        &mut self,
        evaluation: &Evaluation<'_, S>,
        prescribed: &dyn Fn(&Level<S>, usize) -> S,
    ) {
        let layout = evaluation.layout;
        let (plan, n) = (&layout.elimination, layout.nv);
        self.group_inertias(evaluation);
        self.rows.run_tree(evaluation);
        self.dependent.read(evaluation);
        let levels = &self.rows.levels;
        self.dependent
            .prescribe(plan, &|row| prescribed(&levels[row], row));
        let rates = std::mem::take(&mut self.dependent.rates);
        let given = match plan.dependents.is_empty() {
            true => &[][..],
            false => &rates,
        };
        self.move_links(evaluation, given);
        self.dependent.rates = rates;
        self.rows.run(evaluation, &self.accelerations, true);
        self.compose(evaluation);
        self.dependent
            .substitute(plan, &mut self.mass, &mut self.rows.lines);
        self.system.clear();
        for (index, step) in plan.steps.iter().enumerate() {
            enter::<S>(evaluation.scene, step.part);
            self.leave_out_detached(evaluation, index, step.part);
            if let Part::Joint(joint) = step.part {
                let (rows, system) = (&self.rows, &mut self.system);
                rows.each_size(evaluation, joint, true, &mut |number, size| {
                    system.set_size(plan, index, number, size);
                });
            }
            let own = &step.speeds;
            for i in 0..own.len() {
                for j in 0..=i {
                    let value = self.mass[own[i] * n + own[j]];
                    self.system.set_diagonal(plan, index, (i, j), value);
                }
            }
            for below in &step.below {
                let other = &plan.steps[below.step];
                for (i, from) in own.iter().enumerate() {
                    for (j, to) in other.speeds.iter().enumerate() {
                        let value = self.mass[from * n + to];
                        self.system
                            .set_coupling(plan, (below.step, j), (index, i), value);
                    }
                }
                if let Part::Joint(joint) = other.part {
                    let row = layout.joints[joint].row;
                    for j in 0..other.size {
                        for (i, speed) in own.iter().enumerate() {
                            let value = self.rows.lines[(row + j) * n + speed];
                            self.system
                                .set_coupling(plan, (below.step, j), (index, i), value);
                        }
                    }
                }
            }
        }
        self.system
            .factor(plan, &|part| enter::<S>(evaluation.scene, part));
    }
}

/// The acceleration of a link that floats, less the common fall, without those of its speeds.
pub(super) fn falling<S: Real>(evaluation: &Evaluation<'_, S>, index: usize) -> Twist<S> {
    Twist::slide(evaluation.links[index].axes.transpose() * -common_fall(evaluation))
}

/// Where the joint of a link sits on what carries it.
pub(super) fn near<S: Real>(
    evaluation: &Evaluation<'_, S>,
    joint: usize,
    reversed: bool,
) -> Option<Place> {
    let declared = evaluation.scene.joints.get(joint)?;
    Some(if reversed {
        declared.child
    } else {
        declared.parent
    })
}

/// The acceleration of what carries a link on the world, less the common fall, its axes.
fn base<S: Real>(
    evaluation: &Evaluation<'_, S>,
    joint: usize,
    reversed: bool,
    fall: &Vector3<S>,
) -> Twist<S> {
    let frame = match near(evaluation, joint, reversed) {
        Some(Place::World(frame)) => evaluation.moving(frame),
        _ => None,
    };
    let Some(motion) = frame else {
        return Twist::slide(-fall);
    };
    let back = motion
        .rotation
        .map_or_else(Matrix3::identity, |rotation| rotation.transpose());
    Twist {
        linear: back * (motion.acceleration - fall),
        angular: back * motion.alpha,
    }
}

/// The velocity of what carries a link on the world, its axes; `None` of what rests there, of a link on another, and of one that floats.
pub(super) fn carried_along<S: Real>(
    evaluation: &Evaluation<'_, S>,
    link: &Link,
) -> Option<Twist<S>> {
    let Place::World(frame) = near(evaluation, link.joint?, link.reversed)? else {
        return None;
    };
    let Some(motion) = evaluation.moving(frame) else {
        return evaluation
            .origin
            .map(|origin| Twist::slide(-origin.velocity));
    };
    let back = motion
        .rotation
        .map_or_else(Matrix3::identity, |rotation| rotation.transpose());
    Some(Twist {
        linear: back * evaluation.velocity_from_origin(motion.velocity),
        angular: back * motion.omega,
    })
}

/// The forces applied to the body of a link, at its origin.
pub(super) fn applied<S: Real>(
    evaluation: &Evaluation<'_, S>,
    link: usize,
    forces: &AppliedForces<S>,
) -> Twist<S> {
    let body = links(evaluation.layout)[link].body;
    let (force, torque) = &forces.bodies[body];
    evaluation.links[link].taken([force, torque], &forces.own[body])
}
