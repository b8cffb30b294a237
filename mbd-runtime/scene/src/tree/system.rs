//! The equations of motion in relative coordinates, and their solution.
//!
//! ```text
//! [M  Φ_uᵀ] [ u̇]   [τ − h]
//! [Φ_u   0] [−λ] = [  γ  ]            M by composite bodies, h by recursive Newton–Euler at u̇ = 0                          (1)
//! ```
//!
//! The speeds of a body that floats are those of its centre of mass in its own axes here, V = T v; in the state they are v. Gravity that is the same
//! everywhere is an acceleration of the world upwards. Source: Featherstone, Rigid Body Dynamics Algorithms, ch. 6 and 8.

use nalgebra::{Matrix3, Vector3};

use super::articulated::Articulated;
use super::inertia::Inertia;
use super::rows::{TreeRows, three};
use crate::elimination::{System, common_fall, enter, factored};
use crate::laws::GravityNumbers;
use crate::laws::evaluation::Evaluation;
use crate::laws::forces::AppliedForces;
use crate::laws::gravity::{body_gravity, point_gravity};
use crate::laws::joint_forces::on_child;
use crate::scalar::algebra::write;
use crate::{
    AngularVelocity, Layout, Link, Part, Place, PointSlots, Quantity, Real, Relative, Twist,
};

/// Σ a b over the products in which neither is zero.
pub(super) fn sparse_dot<S: Real>(products: impl Iterator<Item = (S, S)>) -> S {
    products
        .filter(|(a, b)| !a.is_zero() && !b.is_zero())
        .fold(S::zero(), |sum, (a, b)| sum + a * b)
}

/// Scratch of one scene. Carries nothing from call to call.
#[derive(Clone, Debug)]
pub(crate) struct TreeSystem<S: Real> {
    system: System<S>,
    rows: TreeRows<S>,
    /// Accelerations of the links, less the common fall.
    accelerations: Vec<Twist<S>>,
    /// What the joints must push the links with.
    pushes: Vec<Twist<S>>,
    composites: Vec<Inertia<S>>,
    articulated: Vec<Articulated<S>>,
    /// n_v numbers: generalised forces, speeds or accelerations in the components of the links.
    along: Vec<S>,
    /// u̇ in the components of the links, after [`TreeSystem::accelerate`].
    rates: Vec<S>,
    /// λ of all rows.
    multipliers: Vec<S>,
    mass: Vec<S>,
}

/// The links of a layout.
fn links(layout: &Layout) -> &[Link] {
    layout.tree.as_ref().map_or(&[][..], |tree| &tree.links)
}

/// V = T v of a body that floats, or forces likewise: linear part along its axes; angular part, too, where the state has world components.
fn into_link<S: Real>(evaluation: &Evaluation<'_, S>, list: &mut [S]) {
    each_floating(evaluation, |link, axes| {
        let back = axes.transpose();
        rotate(evaluation, link, &back, list);
    });
}

/// The way back.
fn into_state<S: Real>(evaluation: &Evaluation<'_, S>, list: &mut [S]) {
    each_floating(evaluation, |link, axes| {
        rotate(evaluation, link, axes, list)
    });
}

fn each_floating<S: Real>(
    evaluation: &Evaluation<'_, S>,
    mut each: impl FnMut(&Link, &Matrix3<S>),
) {
    for (link, motion) in links(evaluation.layout).iter().zip(evaluation.links) {
        if link.joint.is_none() {
            each(link, &motion.axes);
        }
    }
}

fn rotate<S: Real>(evaluation: &Evaluation<'_, S>, link: &Link, axes: &Matrix3<S>, list: &mut [S]) {
    let at = link.slots.v;
    let linear = axes * three(list, at);
    write(list, at, &linear);
    if evaluation.scene.angular_velocity == AngularVelocity::World {
        let angular = axes * three(list, at + 3);
        write(list, at + 3, &angular);
    }
}

impl<S: Real> TreeSystem<S> {
    /// Room for one scene.
    pub fn new(layout: &Layout) -> Self {
        let count = links(layout).len();
        TreeSystem {
            system: System::new(&layout.elimination),
            rows: TreeRows::new(layout),
            accelerations: vec![Twist::zero(); count],
            pushes: vec![Twist::zero(); count],
            composites: vec![Inertia::none(); count],
            articulated: vec![Articulated::of(&Inertia::none(), Twist::zero()); count],
            along: vec![S::zero(); layout.nv],
            rates: vec![S::zero(); layout.nv],
            multipliers: vec![S::zero(); layout.nc],
            mass: vec![S::zero(); if count > 0 { layout.nv * layout.nv } else { 0 }],
        }
    }

    /// Accelerations of the links, less the common fall, for those of their coordinates, in the components of the links.
    fn move_links(&mut self, evaluation: &Evaluation<'_, S>, rates: &[S]) {
        let fall = common_fall(evaluation);
        for (index, link) in links(evaluation.layout).iter().enumerate() {
            S::section(&evaluation.scene.bodies[link.body].name);
            let motion = &evaluation.links[index];
            let rates = rates
                .get(link.slots.v..link.slots.v + link.speeds)
                .unwrap_or_default();
            self.accelerations[index] = match (link.joint, link.inboard) {
                (None, _) => {
                    let falling = motion.axes.transpose() * -fall;
                    let mut own = Twist::slide(falling);
                    for (column, &rate) in motion.columns.iter().zip(rates) {
                        own = own.plus(column, rate);
                    }
                    own
                }
                (_, Some(inboard)) => motion.accelerated(&self.accelerations[inboard], rates),
                (Some(joint), None) => {
                    motion.accelerated(&base(evaluation, joint, link.reversed, &fall), rates)
                }
            };
        }
    }

    /// What the joints must push the links with for these accelerations, against `forces` if given: leaves first; and along the coordinates.
    fn balance(&mut self, evaluation: &Evaluation<'_, S>, forces: Option<&AppliedForces<S>>) {
        let numbers = evaluation.numbers;
        for (index, link) in links(evaluation.layout).iter().enumerate() {
            S::section(&evaluation.scene.bodies[link.body].name);
            let (motion, body) = (&evaluation.links[index], &numbers.bodies[link.body]);
            let inertia = Inertia::of(body, motion);
            let mut push = inertia.push(&self.accelerations[index]);
            push.add(&inertia.gyroscopic(&motion.omega));
            push.add(&self.weight(evaluation, index));
            if let Some(forces) = forces {
                push = push.plus(&applied(evaluation, index, forces), -S::one());
            }
            self.pushes[index] = push;
        }
    }

    /// What gravity that is not the same everywhere asks of the joint of a link.
    fn weight(&self, evaluation: &Evaluation<'_, S>, index: usize) -> Twist<S> {
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
    fn hand_on(&mut self, evaluation: &Evaluation<'_, S>) {
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

    /// Writes M of (1) into `mass`, lower triangle by speeds, in the components of the links.
    fn compose(&mut self, evaluation: &Evaluation<'_, S>) {
        let (layout, all) = (evaluation.layout, links(evaluation.layout));
        let n = layout.nv;
        self.mass.fill(S::zero());
        for (index, link) in all.iter().enumerate() {
            self.composites[index] = Inertia::of(
                &evaluation.numbers.bodies[link.body],
                &evaluation.links[index],
            );
        }
        for (index, link) in all.iter().enumerate().rev() {
            S::section(&evaluation.scene.bodies[link.body].name);
            let (motion, composite) = (&evaluation.links[index], self.composites[index]);
            if let Some(inboard) = link.inboard {
                self.composites[inboard].take(&composite, motion);
            }
            for k in 0..link.speeds {
                let mut push = composite.push(&motion.columns[k]);
                let row = link.slots.v + k;
                for l in 0..=k {
                    self.mass[row * n + link.slots.v + l] = motion.along(l, &push);
                }
                let mut outboard = index;
                while let Some(inboard) = all[outboard].inboard {
                    push = evaluation.links[outboard].hand_on(&push);
                    for l in 0..all[inboard].speeds {
                        let value = evaluation.links[inboard].along(l, &push);
                        self.mass[row * n + all[inboard].slots.v + l] = value;
                    }
                    outboard = inboard;
                }
            }
        }
        for (point, slots) in layout.points.iter().enumerate() {
            if let PointSlots::Mass(slots) = slots {
                for k in slots.v..slots.v + 3 {
                    self.mass[k * n + k] = evaluation.numbers.points[point].0;
                }
            }
        }
    }

    /// Assembles and factorises (1); the rows need the accelerations of the links without u̇.
    fn prepare(&mut self, evaluation: &Evaluation<'_, S>) {
        let layout = evaluation.layout;
        let (plan, n) = (&layout.elimination, layout.nv);
        self.move_links(evaluation, &[]);
        self.compose(evaluation);
        if layout.nc > 0 {
            let accelerations = std::mem::take(&mut self.accelerations);
            self.rows.run(evaluation, &accelerations, true);
            self.accelerations = accelerations;
        }
        self.system.clear();
        for (index, step) in plan.steps.iter().enumerate() {
            enter::<S>(evaluation.scene, step.part);
            let Some((first, _)) = speeds_of(layout, step.part) else {
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
                            // Rows of M belong to what is carried.
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

    /// Solves (1): u̇ in the components of the links, and λ of all rows.
    pub fn accelerate(&mut self, evaluation: &Evaluation<'_, S>, assembly: &AppliedForces<S>) {
        let (layout, numbers) = (evaluation.layout, evaluation.numbers);
        let plan = &layout.elimination;
        if plan.order.articulated {
            self.articulate(evaluation, assembly);
            return self.move_points(evaluation, assembly);
        }
        self.prepare(evaluation);
        self.balance(evaluation, Some(assembly));
        self.hand_on(evaluation);
        for (index, step) in plan.steps.iter().enumerate() {
            enter::<S>(evaluation.scene, step.part);
            let right = self.system.unknowns_mut(plan, index);
            match step.part {
                Part::Joint(joint) => {
                    let row = layout.joints[joint].row;
                    for (slot, level) in right.iter_mut().zip(&self.rows.levels[row..]) {
                        *slot = level.bias;
                    }
                }
                Part::Point(point) => {
                    if let PointSlots::Mass(slots) = layout.points[point] {
                        let weight = point_gravity(evaluation, point, slots.q)
                            .map(|g| numbers.points[point].0 * g);
                        write(right, 0, &(assembly.points[point] + weight));
                    }
                }
                part => {
                    if let Some((first, _)) = speeds_of(layout, part) {
                        for (i, slot) in right.iter_mut().enumerate() {
                            *slot = assembly.along[first + i] - self.along[first + i];
                        }
                    }
                }
            }
        }
        self.system
            .solve(plan, |part| enter::<S>(evaluation.scene, part));
        self.take_solution(evaluation);
        self.move_points(evaluation, assembly);
    }

    /// u̇ of the points that no joint holds.
    fn move_points(&mut self, evaluation: &Evaluation<'_, S>, assembly: &AppliedForces<S>) {
        let layout = evaluation.layout;
        for (point, slots) in layout.points.iter().enumerate() {
            let held = layout.elimination.step_of(Part::Point(point));
            if let (PointSlots::Mass(slots), None) = (slots, held) {
                S::section(&evaluation.scene.points[point].name);
                let inverse = evaluation.numbers.points[point].1;
                let rate = assembly.points[point].map(|f| f * inverse)
                    + point_gravity(evaluation, point, slots.q);
                write(&mut self.rates, slots.v, &rate);
            }
        }
    }

    /// u̇ by articulated bodies, where no rows close loops.
    fn articulate(&mut self, evaluation: &Evaluation<'_, S>, assembly: &AppliedForces<S>) {
        let all = links(evaluation.layout);
        let fall = common_fall(evaluation);
        for (index, link) in all.iter().enumerate() {
            S::section(&evaluation.scene.bodies[link.body].name);
            let motion = &evaluation.links[index];
            let inertia = Inertia::of(&evaluation.numbers.bodies[link.body], motion);
            let mut push = inertia.gyroscopic(&motion.omega);
            push.add(&self.weight(evaluation, index));
            push = push.plus(&applied(evaluation, index, assembly), -S::one());
            self.articulated[index] = Articulated::of(&inertia, push);
        }
        for (index, link) in all.iter().enumerate().rev() {
            S::section(&evaluation.scene.bodies[link.body].name);
            let motion = &evaluation.links[index];
            let forces = &assembly.along[link.slots.v..link.slots.v + link.speeds];
            self.articulated[index].release(motion, forces);
            if let Some(inboard) = link.inboard {
                let (before, own) = self.articulated.split_at_mut(index);
                before[inboard].take(&own[0], motion, &motion.brought());
            }
        }
        for (index, link) in all.iter().enumerate() {
            S::section(&evaluation.scene.bodies[link.body].name);
            let motion = &evaluation.links[index];
            let own = match (link.joint, link.inboard) {
                (None, _) => Twist::slide(motion.axes.transpose() * -fall),
                (_, Some(inboard)) => motion.accelerated(&self.accelerations[inboard], &[]),
                (Some(joint), None) => {
                    motion.accelerated(&base(evaluation, joint, link.reversed, &fall), &[])
                }
            };
            let rates = &mut self.rates[link.slots.v..link.slots.v + link.speeds];
            self.accelerations[index] = self.articulated[index].find(motion, own, rates);
        }
    }

    /// Takes accelerations, or moves, and multipliers of all rows out of the solved system.
    fn take_solution(&mut self, evaluation: &Evaluation<'_, S>) {
        let layout = evaluation.layout;
        let plan = &layout.elimination;
        self.multipliers.fill(S::zero());
        for (index, step) in plan.steps.iter().enumerate() {
            enter::<S>(evaluation.scene, step.part);
            let unknowns = self.system.unknowns(plan, index);
            if let Some((first, count)) = speeds_of(layout, step.part) {
                self.rates[first..first + count].copy_from_slice(unknowns);
            } else if let Part::Joint(joint) = step.part {
                let own = layout.joints[joint].row;
                let multipliers = &mut self.multipliers;
                self.rows.each_kept(evaluation, joint, |number, row, part| {
                    multipliers[own + row] -= unknowns[number] * part;
                });
            }
        }
    }

    /// Writes ẋ, after [`TreeSystem::accelerate`].
    pub fn write_derivative(&self, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        write_coordinate_rates(evaluation, out);
        let layout = evaluation.layout;
        self.write_rates(evaluation, &mut out[layout.nq..layout.nq + layout.nv]);
        evaluation.write_other_rates(out);
    }

    /// Writes v̇ in the components of the state, after [`TreeSystem::accelerate`].
    fn write_rates(&self, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        out.copy_from_slice(&self.rates);
        into_state(evaluation, out);
    }

    /// Accelerations of every body, linear in world axes and angular in the components of the state, for v̇.
    pub fn body_accelerations(
        &mut self,
        evaluation: &Evaluation<'_, S>,
        rates: &[S],
        out: &mut Vec<[Vector3<S>; 2]>,
    ) {
        out.clear();
        out.resize(evaluation.layout.bodies.len(), [Vector3::zeros(); 2]);
        let mut along = std::mem::take(&mut self.along);
        along.copy_from_slice(rates);
        into_link(evaluation, &mut along);
        self.move_links(evaluation, &along);
        self.along = along;
        let fall = common_fall(evaluation);
        for (index, link) in links(evaluation.layout).iter().enumerate() {
            let (motion, own) = (&evaluation.links[index], &self.accelerations[index]);
            let (w, c) = (&motion.omega, &motion.centre);
            let centre = own.linear + own.angular.cross(c) + w.cross(&w.cross(c));
            let spin = match evaluation.scene.angular_velocity {
                AngularVelocity::Body => motion.body.transpose() * own.angular,
                AngularVelocity::World => motion.axes * own.angular,
            };
            out[link.body] = [motion.axes * centre + fall, spin];
        }
    }

    /// Writes the rows of the joints.
    pub fn write_rows(&mut self, what: Quantity, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        let layout = evaluation.layout;
        self.move_links(evaluation, &[]);
        let accelerations = std::mem::take(&mut self.accelerations);
        self.rows.run(evaluation, &accelerations, false);
        self.accelerations = accelerations;
        if what == Quantity::ConstraintJacobian {
            for (to, from) in out
                .chunks_exact_mut(layout.nv)
                .zip(self.rows.lines.chunks_exact(layout.nv))
            {
                to.copy_from_slice(from);
                into_state(evaluation, to);
            }
            return;
        }
        self.along
            .copy_from_slice(&evaluation.at.state[layout.nq..layout.nq + layout.nv]);
        into_link(evaluation, &mut self.along);
        self.rows.write(what, &self.along, out);
    }

    /// Writes M, dense.
    pub fn write_mass(&mut self, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        self.compose(evaluation);
        let n = evaluation.layout.nv;
        for i in 0..n {
            for j in 0..=i {
                // A speed that is carried may stand before one that carries it.
                let value = match self.mass[i * n + j].is_zero() {
                    true => self.mass[j * n + i],
                    false => self.mass[i * n + j],
                };
                self.mass[i * n + j] = value;
                self.mass[j * n + i] = value;
            }
        }
        for _ in 0..2 {
            // T M Tᵀ: rows, then the rows of the transpose.
            for row in self.mass.chunks_exact_mut(n) {
                into_state(evaluation, row);
            }
            for i in 0..n {
                for j in 0..i {
                    self.mass.swap(i * n + j, j * n + i);
                }
            }
        }
        for (to, from) in out.iter_mut().zip(&self.mass) {
            if !from.is_zero() {
                *to = *from;
            }
        }
    }

    /// Writes the diagonal of M.
    pub fn write_masses(&mut self, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        self.write_mass(evaluation, &mut []);
        let n = evaluation.layout.nv;
        for (to, from) in out.iter_mut().zip(self.mass.iter().step_by(n + 1)) {
            *to = *from;
        }
    }

    /// Writes h: what the joints must push with at rest of the speeds, gravity and velocities alone.
    pub fn write_bias(&mut self, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        self.move_links(evaluation, &[]);
        self.balance(evaluation, None);
        self.hand_on(evaluation);
        out.copy_from_slice(&self.along);
        for (point, slots) in evaluation.layout.points.iter().enumerate() {
            if let PointSlots::Mass(slots) = slots {
                let mass = evaluation.numbers.points[point].0;
                write(
                    out,
                    slots.v,
                    &point_gravity(evaluation, point, slots.q).map(|g| -(mass * g)),
                );
            }
        }
        into_state(evaluation, out);
    }

    /// Writes the applied forces f.
    pub fn write_forces(
        &mut self,
        evaluation: &Evaluation<'_, S>,
        assembly: &AppliedForces<S>,
        out: &mut [S],
    ) {
        for index in 0..self.pushes.len() {
            self.pushes[index] = applied(evaluation, index, assembly);
        }
        self.hand_on(evaluation);
        for (slot, (a, b)) in out.iter_mut().zip(self.along.iter().zip(&assembly.along)) {
            *slot = *a + *b;
        }
        for (point, slots) in evaluation.layout.points.iter().enumerate() {
            if let PointSlots::Mass(slots) = slots {
                write(out, slots.v, &assembly.points[point]);
            }
        }
        into_state(evaluation, out);
    }

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
    }

    /// What every joint pushes its link with, forces along its coordinate included, by u̇ and λ at hand.
    fn find_pushes(&mut self, evaluation: &Evaluation<'_, S>, assembly: &AppliedForces<S>) {
        let rates = std::mem::take(&mut self.rates);
        self.move_links(evaluation, &rates);
        self.rates = rates;
        self.balance(evaluation, Some(assembly));
        let multipliers = std::mem::take(&mut self.multipliers);
        let by_rows = self.rows.pushes(evaluation, &multipliers);
        for (push, row) in self.pushes.iter_mut().zip(by_rows) {
            *push = push.plus(row, -S::one());
        }
        self.multipliers = multipliers;
        self.hand_on(evaluation);
    }

    /// Force and torque of a joint of the tree on its child about the origin of frame 2, world axes; what acts along its coordinates is none of it.
    fn reaction(
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
        let [along, about] = on_child(evaluation, joint);
        [force - along, torque - about]
    }

    /// The same of a joint that closes a loop, from its rows.
    fn rows_on_child(&self, evaluation: &Evaluation<'_, S>, joint: usize) -> [Vector3<S>; 2] {
        let slots = &evaluation.layout.joints[joint];
        let rows = self.rows.rows[joint].rows().iter();
        let own = self.multipliers[slots.row..slots.row + slots.len]
            .iter()
            .map(|&x| -x);
        match evaluation.ends(joint, AngularVelocity::Body) {
            Some(ends) if slots.len > 0 => {
                crate::elimination::reaction(evaluation, &ends.child.outward, rows.zip(own))
            }
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
        for (joint, slots) in layout
            .joints
            .iter()
            .enumerate()
            .filter(|(_, slots)| slots.driven)
        {
            let _ = joint;
            for row in slots.row..slots.row + slots.len {
                power -= self.multipliers[row] * self.rows.levels[row].time;
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
                // On the frame acts the opposite; the reaction is told on the child about frame 2.
                let sign = if link.reversed { -S::one() } else { S::one() };
                let child = evaluation.position_of(evaluation.scene.joints[joint].child);
                let arm = child.unwrap_or(frame.position) - frame.position;
                let about = torque + arm.cross(&force);
                power += sign * (force.dot(&frame.velocity) + about.dot(&frame.omega));
            }
        }
        power
    }

    /// Solves for the move that takes the rows of the arguments out, and writes it with the margin of the factor behind.
    pub fn correct(&mut self, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        let layout = evaluation.layout;
        let plan = &layout.elimination;
        if evaluation.at.rows.len() != layout.nc {
            return out.fill(S::from_f64(f64::NAN));
        }
        self.prepare(evaluation);
        for (joint, slots) in layout.joints.iter().enumerate() {
            if let Some(step) = plan.step_of(Part::Joint(joint)) {
                enter::<S>(evaluation.scene, Part::Joint(joint));
                let asked = &evaluation.at.rows[slots.row..slots.row + slots.len];
                let own = self.system.unknowns_mut(plan, step);
                self.rows.each_kept(evaluation, joint, |number, row, part| {
                    own[number] -= asked[row] * part;
                });
            }
        }
        self.system
            .solve(plan, |part| enter::<S>(evaluation.scene, part));
        self.rates.fill(S::zero());
        self.take_solution(evaluation);
        self.write_rates(evaluation, &mut out[..layout.nv]);
        out[layout.nv] = self.system.margin(plan);
    }

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
            self.move_links(evaluation, &[]);
            let accelerations = std::mem::take(&mut self.accelerations);
            self.rows.run(evaluation, &accelerations, true);
            self.accelerations = accelerations;
        }
        let mut own = std::mem::take(&mut self.rates);
        own.copy_from_slice(rates);
        into_link(evaluation, &mut own);
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
                let fall = three(&own, slots.v) - point_gravity(evaluation, point, slots.q);
                write(
                    &mut self.along,
                    slots.v,
                    &(fall.map(|x| mass * x) - assembly.points[point]),
                );
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
                let left = sparse_dot(line.iter().copied().zip(own.iter().copied()));
                out[rows + number] = left - self.rows.levels[number].bias;
            }
        }
        self.rates = own;
        out[layout.nq..layout.nq + n].copy_from_slice(&self.along);
        into_state(evaluation, &mut out[layout.nq..layout.nq + n]);
    }

    /// Eliminates and writes what solutions need: the factor, T of the bodies that float, the margin.
    pub fn write_factor(&mut self, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        self.prepare(evaluation);
        let plan = &evaluation.layout.elimination;
        let mut place = 0;
        let mut next = |value: S| {
            out[place] = value;
            place += 1;
        };
        factored(plan, |bank, at| next(self.system.factored(bank, at)));
        each_floating(evaluation, |_, axes| axes.iter().for_each(|x| next(*x)));
        next(self.system.margin(plan));
    }

    /// Solves by that list, and writes x and y.
    pub fn solve_by_factor(&mut self, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        let (layout, given) = (evaluation.layout, evaluation.at.rows);
        let plan = &layout.elimination;
        let count = given.len().saturating_sub(layout.nv + layout.nc);
        if count != factored_len(layout) {
            return out.fill(S::from_f64(f64::NAN));
        }
        let (list, asked) = given.split_at(count);
        self.system.clear();
        let mut place = 0;
        factored(plan, |bank, at| {
            self.system.set_factored(bank, at, list[place]);
            place += 1;
        });
        let turn = |list_at: usize, back: bool, numbers: &mut [S]| {
            let mut at = list_at;
            each_floating(evaluation, |link, _| {
                let axes = Matrix3::from_column_slice(&list[at..at + 9]);
                at += 9;
                let axes = if back { axes.transpose() } else { axes };
                rotate(evaluation, link, &axes, numbers);
            });
        };
        self.along.copy_from_slice(&asked[..layout.nv]);
        turn(place, true, &mut self.along);
        for (index, step) in plan.steps.iter().enumerate() {
            let right = self.system.unknowns_mut(plan, index);
            if let Some((first, count)) = speeds_of(layout, step.part) {
                right.copy_from_slice(&self.along[first..first + count]);
            } else if let Part::Joint(joint) = step.part {
                let from = layout.nv + layout.joints[joint].row;
                right.copy_from_slice(&asked[from..from + right.len()]);
            }
        }
        self.system
            .solve(plan, |part| enter::<S>(evaluation.scene, part));
        out.fill(S::zero());
        for (index, step) in plan.steps.iter().enumerate() {
            let unknowns = self.system.unknowns(plan, index);
            if let Some((first, count)) = speeds_of(layout, step.part) {
                out[first..first + count].copy_from_slice(unknowns);
            } else if let Part::Joint(joint) = step.part {
                let own = layout.nv + layout.joints[joint].row;
                for (slot, x) in out[own..].iter_mut().zip(unknowns) {
                    *slot = -*x;
                }
            }
        }
        for (point, slots) in layout.points.iter().enumerate() {
            if let (PointSlots::Mass(slots), None) = (slots, plan.step_of(Part::Point(point))) {
                let inverse = evaluation.numbers.points[point].1;
                for k in slots.v..slots.v + 3 {
                    out[k] = self.along[k] * inverse;
                }
            }
        }
        turn(place, false, &mut out[..layout.nv]);
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
        self.move_links(evaluation, &[]);
        let accelerations = std::mem::take(&mut self.accelerations);
        self.rows.run(evaluation, &accelerations, false);
        self.accelerations = accelerations;
        self.drive_power(evaluation, assembly)
    }
}

/// Length of the list of a factor.
pub(crate) fn factored_len(layout: &Layout) -> usize {
    let mut count = 1;
    factored(&layout.elimination, |_, _| count += 1);
    count
        + 9 * links(layout)
            .iter()
            .filter(|link| link.joint.is_none())
            .count()
}

/// First speed and number of speeds of a node of the system; `None` for rows.
fn speeds_of(layout: &Layout, part: Part) -> Option<(usize, usize)> {
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
fn near<S: Real>(evaluation: &Evaluation<'_, S>, joint: usize, reversed: bool) -> Option<Place> {
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
fn applied<S: Real>(
    evaluation: &Evaluation<'_, S>,
    link: usize,
    forces: &AppliedForces<S>,
) -> Twist<S> {
    let body = links(evaluation.layout)[link].body;
    let (force, torque) = &forces.bodies[body];
    evaluation.links[link].taken([force, torque], &forces.own[body])
}

/// Writes q̇ of everything.
fn write_coordinate_rates<S: Real>(evaluation: &Evaluation<'_, S>, out: &mut [S]) {
    let (layout, scene) = (evaluation.layout, evaluation.scene);
    for (body, slots) in layout.own_bodies() {
        S::section(&scene.bodies[body].name);
        evaluation.write_body_rate(body, slots, out);
    }
    for (joint, link) in layout.joint_links() {
        S::section(&scene.joints[joint].name);
        let state = evaluation.at.state;
        let v = layout.nq + link.slots.v;
        let at = Relative {
            q: &state[link.slots.q..link.slots.q + link.coordinates],
            u: &state[v..v + link.speeds],
            numbers: &evaluation.numbers.joints[joint],
        };
        scene.joints[joint]
            .law
            .rates(&at, &mut out[link.slots.q..link.slots.q + link.coordinates]);
    }
    for (point, slots) in layout.points.iter().enumerate() {
        if let PointSlots::Mass(slots) = slots {
            S::section(&scene.points[point].name);
            evaluation.write_point_rate(*slots, out);
        }
    }
}
