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
use super::assemble::{applied, falling};
use super::dependent::DependentSpeeds;
use super::inertia::SpatialInertia;
use super::rows::TreeRows;
use crate::elimination::{BlockSystem, common_fall, enter};
use crate::laws::evaluation::Evaluation;
use crate::laws::forces::AppliedForces;
use crate::laws::gravity::point_gravity;
use crate::{AngularVelocity, Layout, Link, Part, PointSlots, Quantity, Real, Relative, Twist};

/// Scratch of one scene. Carries nothing from call to call.
#[derive(Clone, Debug)]
pub(crate) struct TreeSystem<S: Real> {
    pub(super) system: BlockSystem<S>,
    pub(super) rows: TreeRows<S>,
    pub(super) dependent: DependentSpeeds<S>,
    /// Accelerations of the links, less the common fall.
    pub(super) accelerations: Vec<Twist<S>>,
    /// What the joints must push the links with.
    pub(super) pushes: Vec<Twist<S>>,
    pub(super) inertias: Vec<SpatialInertia<S>>,
    pub(super) composites: Vec<SpatialInertia<S>>,
    pub(super) articulated: Vec<Articulated<S>>,
    /// n_v numbers: generalised forces, speeds or accelerations in the components of the links.
    pub(super) along: Vec<S>,
    /// u̇ in the components of the links, after [`TreeSystem::accelerate`].
    pub(super) rates: Vec<S>,
    /// λ of all rows.
    pub(super) multipliers: Vec<S>,
    pub(super) mass: Vec<S>,
}

/// The links of a layout.
pub(super) fn links(layout: &Layout) -> &[Link] {
    layout.tree.as_ref().map_or(&[][..], |tree| &tree.links)
}

/// V = T v of a body that floats, or forces likewise: linear part along its axes; angular part, too, where the state has world components.
pub(super) fn into_link<S: Real>(evaluation: &Evaluation<'_, S>, list: &mut [S]) {
    each_floating(evaluation, &mut |link, axes| {
        let back = axes.transpose();
        rotate(evaluation, link, &back, list);
    });
}

/// The way back.
pub(super) fn into_state<S: Real>(evaluation: &Evaluation<'_, S>, list: &mut [S]) {
    each_floating(evaluation, &mut |link, axes| {
        rotate(evaluation, link, axes, list)
    });
}

pub(super) fn each_floating<S: Real>(
    evaluation: &Evaluation<'_, S>,
    each: &mut dyn FnMut(&Link, &Matrix3<S>),
) {
    for (link, motion) in links(evaluation.layout).iter().zip(evaluation.links) {
        if link.joint.is_none() {
            each(link, &motion.axes);
        }
    }
}

/// Numbers of T of all bodies that float, in the list of a factor.
pub(super) fn floating_len(layout: &Layout) -> usize {
    9 * links(layout)
        .iter()
        .filter(|link| link.joint.is_none())
        .count()
}

/// V = T v by the T that a factor lists, or the way back: see [`into_link`], [`into_state`].
pub(super) fn rotate_by_list<S: Real>(
    evaluation: &Evaluation<'_, S>,
    list: &[S],
    back: bool,
    numbers: &mut [S],
) {
    let mut axes = list.chunks_exact(9);
    each_floating(evaluation, &mut |link, _| {
        if let Some(axes) = axes.next() {
            let axes = Matrix3::from_column_slice(axes);
            let axes = if back { axes.transpose() } else { axes };
            rotate(evaluation, link, &axes, numbers);
        }
    });
}

pub(super) fn rotate<S: Real>(
    evaluation: &Evaluation<'_, S>,
    link: &Link,
    axes: &Matrix3<S>,
    list: &mut [S],
) {
    let at = link.slots.v;
    let directions = evaluation.layout.directions;
    let linear = axes * directions.linear(list, at);
    directions.write_linear(list, at, &linear);
    if evaluation.scene.angular_velocity == AngularVelocity::World {
        let angular = axes * directions.angular(list, at);
        directions.write_angular(list, at, &angular);
    }
}

impl<S: Real> TreeSystem<S> {
    /// Room for one scene.
    pub fn new(layout: &Layout) -> Self {
        let (count, square) = (links(layout).len(), layout.nv * layout.nv);
        TreeSystem {
            system: BlockSystem::new(&layout.elimination),
            rows: TreeRows::new(layout),
            dependent: DependentSpeeds::new(layout),
            accelerations: vec![Twist::zero(); count],
            pushes: vec![Twist::zero(); count],
            inertias: vec![SpatialInertia::none(); count],
            composites: vec![SpatialInertia::none(); count],
            articulated: vec![Articulated::of(&SpatialInertia::none(), Twist::zero()); count],
            along: vec![S::zero(); layout.nv],
            rates: vec![S::zero(); layout.nv],
            multipliers: vec![S::zero(); layout.nc],
            mass: vec![S::zero(); square],
        }
    }

    /// Solves (1): u̇ in the components of the links, and λ of all rows.
    pub fn accelerate(&mut self, evaluation: &Evaluation<'_, S>, assembly: &AppliedForces<S>) {
        let (layout, numbers) = (evaluation.layout, evaluation.numbers);
        let plan = &layout.elimination;
        if plan.order.articulated {
            self.articulate(evaluation, assembly);
            return self.move_points(evaluation, assembly);
        }
        self.prepare(evaluation, &|level, _| level.bias);
        self.balance(evaluation, Some(assembly));
        self.hand_on(evaluation);
        for (slot, acting) in self.along.iter_mut().zip(&assembly.along) {
            *slot = *acting - *slot;
        }
        self.dependent.substitute_forces(plan, &mut self.along);
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
                        let force = assembly.points[point] + weight;
                        layout.directions.write_linear(right, 0, &force);
                    }
                }
                _ => {
                    for (slot, &speed) in right.iter_mut().zip(&step.speeds) {
                        *slot = self.along[speed];
                    }
                }
            }
        }
        self.system
            .solve(plan, &|part| enter::<S>(evaluation.scene, part));
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
                layout
                    .directions
                    .write_linear(&mut self.rates, slots.v, &rate);
            }
        }
    }

    /// ζ of a link: what velocities and motors bring.
    fn brought(&self, evaluation: &Evaluation<'_, S>, index: usize) -> Twist<S> {
        let (motion, link) = (&evaluation.links[index], &links(evaluation.layout)[index]);
        let given = motion.columns.iter().zip(link.slots.v..);
        given
            .filter(|(_, speed)| evaluation.layout.elimination.gives(*speed).is_some())
            .fold(motion.brought(), |sum, (column, speed)| {
                sum.plus(column, self.dependent.rates[speed])
            })
    }

    /// u̇ by articulated bodies, where no rows close loops.
    fn articulate(&mut self, evaluation: &Evaluation<'_, S>, assembly: &AppliedForces<S>) {
        let all = links(evaluation.layout);
        let plan = &evaluation.layout.elimination;
        self.group_inertias(evaluation);
        self.rows.run_tree(evaluation);
        self.dependent.read(evaluation);
        let levels = &self.rows.levels;
        self.dependent.prescribe(plan, &|row| levels[row].bias);
        for (index, link) in all.iter().enumerate() {
            S::section(&evaluation.scene.bodies[link.body].name);
            let (motion, inertia) = (&evaluation.links[index], self.inertias[index]);
            let mut push = inertia.inertial(&Twist::zero(), &motion.omega);
            push.add(&self.weight(evaluation, index));
            push = push.plus(&applied(evaluation, index, assembly), -S::one());
            self.articulated[index] = Articulated::of(&inertia, push);
        }
        for (index, link) in all.iter().enumerate().rev() {
            S::section(&evaluation.scene.bodies[link.body].name);
            let motion = &evaluation.links[index];
            let forces = &assembly.along[link.slots.v..link.slots.v + link.speeds];
            let is_free = |k| plan.gives(link.slots.v + k).is_none();
            self.articulated[index].release(motion, forces, is_free);
            if let Some(inboard) = link.inboard {
                let brought = self.brought(evaluation, index);
                let (before, own) = self.articulated.split_at_mut(index);
                before[inboard].take(&own[0], motion, &brought);
            }
        }
        for (index, link) in all.iter().enumerate() {
            S::section(&evaluation.scene.bodies[link.body].name);
            let own = match self.inboard(evaluation, index) {
                Some(inboard) => {
                    let mut own = evaluation.links[index].followed(&inboard);
                    own.add(&self.brought(evaluation, index));
                    own
                }
                None => falling(evaluation, index),
            };
            let motion = &evaluation.links[index];
            for (k, speed) in (link.slots.v..link.slots.v + link.speeds).enumerate() {
                if let Some(row) = plan.gives(speed) {
                    self.rates[speed] = self.dependent.rates[speed];
                    let push = self.articulated[index].force(&own);
                    self.multipliers[row] = motion.along(k, &push) - assembly.along[speed];
                }
            }
            let rates = &mut self.rates[link.slots.v..link.slots.v + link.speeds];
            let is_free = |k| plan.gives(link.slots.v + k).is_none();
            self.accelerations[index] = self.articulated[index].find(motion, own, rates, is_free);
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
            for (&speed, rate) in step.speeds.iter().zip(unknowns) {
                self.rates[speed] = *rate;
            }
            if let Part::Joint(joint) = step.part {
                let own = layout.joints[joint].row;
                let multipliers = &mut self.multipliers;
                self.rows
                    .each_kept(evaluation, joint, &mut |number, row, part| {
                        multipliers[own + row] -= unknowns[number] * part;
                    });
                for (number, unknown) in unknowns.iter().enumerate() {
                    self.dependent.note(own + number, -*unknown);
                }
            }
        }
        let multipliers = &mut self.multipliers;
        self.dependent
            .follow(plan, &mut self.rates, &mut |row, own| {
                multipliers[row] = own
            });
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
        self.run_rows(evaluation, false);
        if what == Quantity::ConstraintJacobian {
            for (to, from) in out
                .chunks_exact_mut(layout.nv.max(1))
                .zip(self.rows.lines.chunks_exact(layout.nv.max(1)))
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

    /// M, dense, in the components of the state.
    fn mass(&mut self, evaluation: &Evaluation<'_, S>) -> &[S] {
        self.group_inertias(evaluation);
        self.compose(evaluation);
        let n = evaluation.layout.nv;
        for _ in 0..2 {
            // T M Tᵀ: rows, then the rows of the transpose.
            for row in self.mass.chunks_exact_mut(n.max(1)) {
                into_state(evaluation, row);
            }
            for i in 0..n {
                for j in 0..i {
                    self.mass.swap(i * n + j, j * n + i);
                }
            }
        }
        &self.mass
    }

    /// Writes M, dense.
    pub fn write_mass(&mut self, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        out.copy_from_slice(self.mass(evaluation));
    }

    /// Writes how large the element of each row is at least ([`TreeRows::each_size`]); zero of rows of the tree.
    pub fn write_row_sizes(&mut self, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        self.run_rows(evaluation, false);
        out.fill(S::zero());
        for (joint, slots) in evaluation.layout.joints.iter().enumerate() {
            self.rows
                .each_size(evaluation, joint, false, &mut |number, size| {
                    out[slots.row + number] = size;
                });
        }
    }

    /// Writes the diagonal of M.
    pub fn write_masses(&mut self, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        let n = evaluation.layout.nv;
        for (to, from) in out
            .iter_mut()
            .zip(self.mass(evaluation).iter().step_by(n + 1))
        {
            *to = *from;
        }
    }

    /// Writes h: what the joints must push with at rest of the speeds, gravity and velocities alone.
    pub fn write_bias(&mut self, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        self.group_inertias(evaluation);
        self.move_links(evaluation, &[]);
        self.balance(evaluation, None);
        self.hand_on(evaluation);
        out.copy_from_slice(&self.along);
        for (point, slots) in evaluation.layout.points.iter().enumerate() {
            if let PointSlots::Mass(slots) = slots {
                let mass = evaluation.numbers.points[point].0;
                let weight = point_gravity(evaluation, point, slots.q).map(|g| -(mass * g));
                let directions = evaluation.layout.directions;
                directions.write_linear(out, slots.v, &weight);
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
                let directions = evaluation.layout.directions;
                directions.write_linear(out, slots.v, &assembly.points[point]);
            }
        }
        into_state(evaluation, out);
    }

    /// Solves for the move that takes the rows of the arguments out, and writes it with the margin of the factor behind.
    pub fn correct(&mut self, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        let layout = evaluation.layout;
        let plan = &layout.elimination;
        if evaluation.at.rows.len() != layout.nc {
            return out.fill(S::from_f64(f64::NAN));
        }
        self.prepare(evaluation, &|_, row| -evaluation.at.rows[row]);
        self.along.fill(S::zero());
        self.dependent.take_inertia_off(plan, &mut self.along);
        self.dependent.substitute_forces(plan, &mut self.along);
        for (index, step) in plan.steps.iter().enumerate() {
            enter::<S>(evaluation.scene, step.part);
            let own = self.system.unknowns_mut(plan, index);
            for (slot, &speed) in own.iter_mut().zip(&step.speeds) {
                *slot = self.along[speed];
            }
            if let Part::Joint(joint) = step.part {
                let slots = &layout.joints[joint];
                let asked = &evaluation.at.rows[slots.row..slots.row + slots.len];
                self.rows
                    .each_kept(evaluation, joint, &mut |number, row, part| {
                        own[number] -= asked[row] * part;
                    });
                for (number, slot) in own.iter_mut().enumerate() {
                    *slot -= self.dependent.along(plan, slots.row + number);
                }
            }
        }
        self.system
            .solve(plan, &|part| enter::<S>(evaluation.scene, part));
        self.rates.fill(S::zero());
        self.take_solution(evaluation);
        self.write_rates(evaluation, &mut out[..layout.nv]);
        out[layout.nv] = self.system.margin(plan);
    }
}

/// Writes q̇ of everything.
pub(super) fn write_coordinate_rates<S: Real>(evaluation: &Evaluation<'_, S>, out: &mut [S]) {
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
