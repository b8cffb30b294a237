//! Accelerations, forces and inertia along the tree, and the system of the equations of motion.

use nalgebra::{Matrix3, Vector3};

use super::system::{TreeSystem, links};
use crate::elimination::{common_fall, enter};
use crate::laws::GravityNumbers;
use crate::laws::evaluation::Evaluation;
use crate::laws::forces::AppliedForces;
use crate::laws::gravity::body_gravity;
use crate::{Layout, Part, Place, PointSlots, Real, Twist};

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

    /// Assembles and factorises (1); the rows need the accelerations of the links without u̇.
    pub(super) fn prepare(&mut self, evaluation: &Evaluation<'_, S>) {
        let layout = evaluation.layout;
        let (plan, n) = (&layout.elimination, layout.nv);
        self.group_inertias(evaluation);
        self.run_rows(evaluation, true);
        self.compose(evaluation);
        self.system.clear();
        for (index, step) in plan.steps.iter().enumerate() {
            enter::<S>(evaluation.scene, step.part);
            let Some((first, _)) = speeds_of(layout, step.part) else {
                self.leave_out_detached(evaluation, index, step.part);
                continue;
            };
            for i in 0..step.size {
                for j in 0..=i {
                    let value = self.mass[(first + i) * n + first + j];
                    self.system.set_diagonal(plan, index, (i, j), value);
                }
            }
            for below in &step.below {
                let other = &plan.steps[below.step];
                if let Some((to, _)) = speeds_of(layout, other.part) {
                    for i in 0..step.size {
                        for j in 0..other.size {
                            let value = self.mass[(first + i) * n + to + j];
                            self.system
                                .set_coupling(plan, (below.step, j), (index, i), value);
                        }
                    }
                } else if let Part::Joint(joint) = other.part {
                    let row = layout.joints[joint].row;
                    for j in 0..other.size {
                        for i in 0..step.size {
                            let value = self.rows.lines[(row + j) * n + first + i];
                            self.system
                                .set_coupling(plan, (below.step, j), (index, i), value);
                        }
                    }
                }
            }
        }
        self.system
            .factor(plan, |part| enter::<S>(evaluation.scene, part));
    }
}

/// The acceleration of a link that floats, less the common fall, without those of its speeds.
pub(super) fn falling<S: Real>(evaluation: &Evaluation<'_, S>, index: usize) -> Twist<S> {
    Twist::slide(evaluation.links[index].axes.transpose() * -common_fall(evaluation))
}

/// First speed and number of speeds of a node of the system; `None` for rows.
pub(super) fn speeds_of(layout: &Layout, part: Part) -> Option<(usize, usize)> {
    match part {
        Part::Body(body) => Some((
            layout.bodies.get(body).copied().flatten()?.v,
            layout.directions.speeds(),
        )),
        Part::Point(point) => match *layout.points.get(point)? {
            PointSlots::Mass(slots) => Some((slots.v, layout.directions.translations().len())),
            PointSlots::Node(_) => None,
        },
        Part::Coordinates(joint) => layout
            .carried(joint)
            .map(|link| (link.slots.v, link.speeds)),
        Part::Joint(_) => None,
    }
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
