//! The rows of relative coordinates: joints that close loops, motors, as lines over the speeds of the tree.
//!
//! ```text
//! Φ_u = Φ_v B,   Φ_ut = Φ_t + Φ_v B_t,   γ_u = γ − Φ_v B̂            v = B u + B_t, v̇ = B u̇ + B̂           (1)
//! Φ = q_k − f(t),   Φ = Σ f q − c             a motor of a joint of the tree, a coupling of such joints         (2)
//! ```
//!
//! B_t is what frames of the world that move give their trees, and what an origin that moves takes from those on the world.
//!
//! A row pushes its two ends, and the tree hands that on to the world: (1) by (2) of [`super::inertia`]. Above the link that carries both ends
//! nothing arrives. Source: Featherstone, Rigid Body Dynamics Algorithms, loop joints.

use nalgebra::Vector3;

use super::assemble::carried_along;
use super::kinematics::LinkMotion;
use crate::elimination::{common_fall, kept_parts, sparse_dot};
use crate::laws::evaluation::Evaluation;
use crate::rows::{Columns, Rows, WholeRow};
use crate::{AngularVelocity, Layout, Part, Place, PointSlots, Quantity, Real, Tree, Twist};

/// A row over the speeds of the links and points: Φ, Φ_t, γ of (1).
#[derive(Clone, Copy, Debug)]
pub(super) struct Level<S> {
    pub value: S,
    pub time: S,
    /// Φ_t in the world, whatever positions are measured from.
    pub drive: S,
    pub bias: S,
}

/// The rows of one scene. Carries nothing from call to call.
#[derive(Clone, Debug)]
pub(super) struct TreeRows<S: Real> {
    /// The rows of the joints, between their ends.
    pub rows: Vec<Rows<S>>,
    kept: Vec<Rows<S>>,
    /// Row by row what a unit of each speed gives, n_v numbers a row.
    pub lines: Vec<S>,
    /// What else is said of each row.
    pub levels: Vec<Level<S>>,
    pushes: Vec<Twist<S>>,
}

impl<S: Real> TreeRows<S> {
    pub fn new(layout: &Layout) -> Self {
        TreeRows {
            rows: vec![Rows::default(); layout.joints.len()],
            kept: vec![Rows::default(); layout.joints.len()],
            lines: vec![S::zero(); layout.nc * layout.nv],
            levels: vec![
                Level {
                    value: S::zero(),
                    time: S::zero(),
                    drive: S::zero(),
                    bias: S::zero(),
                };
                layout.nc
            ],
            pushes: vec![Twist::zero(); layout.bodies.len()],
        }
    }

    /// Begins with the rows of the tree itself, by (2).
    pub fn run_tree(&mut self, evaluation: &Evaluation<'_, S>) {
        let layout = evaluation.layout;
        self.lines.fill(S::zero());
        for (joint, slots) in layout.joints.iter().enumerate() {
            let declared = &evaluation.scene.joints[joint];
            if let Some(link) = layout.carried(joint) {
                S::section(&declared.name);
                for (row, (index, course)) in (slots.row..).zip(declared.motors()) {
                    let course = evaluation.course(course);
                    self.lines[row * layout.nv + link.slots.v + index] = S::one();
                    self.levels[row] = Level {
                        value: evaluation.at.state[link.slots.q + index] - course.value,
                        time: -course.rate,
                        drive: -course.rate,
                        bias: course.curve,
                    };
                }
            } else if let Some(dependent) = layout.elimination.coupled_by(joint)
                && let Some(coupling) = &evaluation.numbers.couplings[joint]
            {
                S::section(&declared.name);
                let mut sum = S::zero();
                for (number, &(of, index)) in declared.law.couples().iter().enumerate() {
                    let Some(link) = layout.carried(of) else {
                        continue;
                    };
                    let factor = coupling.factor(number);
                    sum += factor * evaluation.at.state[link.slots.q + index];
                    self.lines[dependent.row * layout.nv + link.slots.v + index] = factor;
                }
                // Coordinates are measured from the frames that joints sit on: what moves these takes part in the work alone.
                let mut drive = S::zero();
                if slots.driven {
                    self.between(evaluation, joint);
                    for row in self.rows[joint].whole() {
                        drive += evaluation.prescribed_in_world(joint, row);
                    }
                }
                self.levels[dependent.row] = Level {
                    value: coupling.value(sum),
                    time: S::zero(),
                    drive,
                    bias: S::zero(),
                };
            }
        }
    }

    /// Runs the other rows: all of them, or of each joint those that are in the system, first. `accelerations`: those of the links for the u̇ that
    /// the rows of the tree prescribe, or without any, gravity taken off.
    pub fn run(
        &mut self,
        evaluation: &Evaluation<'_, S>,
        accelerations: &[Twist<S>],
        in_system: bool,
    ) {
        let layout = evaluation.layout;
        let Some(tree) = &layout.tree else { return };
        for (joint, slots) in layout.joints.iter().enumerate() {
            let of_tree =
                layout.carried(joint).is_some() || layout.elimination.coupled_by(joint).is_some();
            if slots.len == 0 || of_tree {
                continue;
            }
            S::section(&evaluation.scene.joints[joint].name);
            self.between(evaluation, joint);
            let rows = match in_system && !slots.all_kept() {
                true => &self.kept[joint],
                false => &self.rows[joint],
            };
            let lines = self.lines.chunks_mut(layout.nv.max(1));
            let own = lines.zip(&mut self.levels).skip(slots.row);
            for (row, (line, level)) in rows.whole().zip(own) {
                *level = write_line((evaluation, tree), joint, row, accelerations, line);
            }
        }
    }

    /// The rows of a joint between its ends.
    fn between(&mut self, evaluation: &Evaluation<'_, S>, joint: usize) {
        let (declared, slots) = (
            &evaluation.scene.joints[joint],
            &evaluation.layout.joints[joint],
        );
        let ends = |joint: usize| evaluation.ends(joint, AngularVelocity::Body);
        let Some(own) = ends(joint) else { return };
        let rows = &mut self.rows[joint];
        evaluation.law_rows((joint, &own), &ends, slots.law, rows);
        for (coordinate, course) in evaluation.motors(declared) {
            rows.motor(&own, &coordinate, &course);
        }
        if let Some(joined) = evaluation.joined(joint) {
            rows.scale(joined);
        }
        if !slots.all_kept() {
            rows.keep(slots.kept, &own, &mut self.kept[joint]);
        }
    }

    /// Adds up what the rows of all joints push the links with, for their multipliers (n_c, all rows), at the origins of the links.
    pub fn pushes(&mut self, evaluation: &Evaluation<'_, S>, multipliers: &[S]) -> &[Twist<S>] {
        let layout = evaluation.layout;
        self.pushes.fill(Twist::zero());
        for (joint, slots) in layout.joints.iter().enumerate() {
            if slots.len == 0 || layout.carried(joint).is_some() {
                continue;
            }
            self.between(evaluation, joint);
            let Some(tree) = &layout.tree else { continue };
            for (row, &multiplier) in self.rows[joint].whole().zip(&multipliers[slots.row..]) {
                for (end, columns) in slots.ends.iter().zip(row.all_columns()) {
                    if let Some(Part::Body(body)) = *end {
                        let link = tree.of_body[body];
                        let push = taken(&evaluation.links[link], columns);
                        self.pushes[link] = self.pushes[link].plus(&push, multiplier);
                    }
                }
            }
        }
        &self.pushes
    }

    /// Hands out what each row in the system of a joint is made of: its number, a row of the joint, and how much of it.
    pub fn each_kept(
        &self,
        evaluation: &Evaluation<'_, S>,
        joint: usize,
        each: &mut dyn FnMut(usize, usize, S),
    ) {
        kept_parts(evaluation, joint, &self.rows, each);
    }

    /// Hands out how large the element of each row of a joint is at least before rows are taken out of it [1/kg, 1/(kg m²)]: what it would be if all
    /// that moves were one body at its ends. Along the speeds of a tree a row can vanish, a rod in line with its cranks, and the part that is left of
    /// an element that is gone says nothing. Of a joint of the tree nothing: what it prescribes is always there.
    pub fn each_size(
        &self,
        evaluation: &Evaluation<'_, S>,
        joint: usize,
        in_system: bool,
        each: &mut dyn FnMut(usize, S),
    ) {
        let layout = evaluation.layout;
        let slots = &layout.joints[joint];
        let of_tree =
            layout.carried(joint).is_some() || layout.elimination.coupled_by(joint).is_some();
        if slots.len == 0 || of_tree {
            return;
        }
        let rows = match in_system && !slots.all_kept() {
            true => &self.kept[joint],
            false => &self.rows[joint],
        };
        let [mass, inertia] = whole(evaluation);
        let directions = layout.directions;
        let square = |axes: &[usize], of: &Vector3<S>| {
            let parts = axes.iter().map(|&axis| of[axis] * of[axis]);
            parts.fold(S::zero(), |sum, x| sum + x)
        };
        for (number, row) in rows.whole().enumerate() {
            let ends = slots.ends.iter().zip(row.all_columns());
            let moving = ends.filter(|(end, _)| end.is_some());
            let size = moving.fold(S::zero(), |sum, (_, columns)| {
                let slides = square(directions.translations(), &columns.linear);
                let turns = square(directions.rotations(), &columns.angular);
                sum + slides / mass + turns / inertia
            });
            each(number, size);
        }
    }

    /// Writes Φ, Φ_v v + Φ_t or γ of every row.
    pub fn write(&self, what: Quantity, speeds: &[S], out: &mut [S]) {
        let lines = self.lines.chunks(speeds.len().max(1));
        for ((slot, level), line) in out.iter_mut().zip(&self.levels).zip(lines) {
            *slot = match what {
                Quantity::Constraint => level.value,
                Quantity::ConstraintBias => level.bias,
                _ => level.time + sparse_dot(line, speeds),
            };
        }
    }
}

/// The mass of all that moves [kg], and an inertia that is not less than that of all of it about any of its joints, as far as these sit from each other [kg m²].
fn whole<S: Real>(evaluation: &Evaluation<'_, S>) -> [S; 2] {
    let (numbers, layout) = (evaluation.numbers, evaluation.layout);
    let (mut mass, mut inertia, mut square) = (S::zero(), S::zero(), S::zero());
    for body in &numbers.bodies {
        mass += body.mass;
        for &axis in layout.directions.rotations() {
            inertia += body.inertia[(axis, axis)];
        }
    }
    for point in &numbers.points {
        mass += point.0;
    }
    for joint in &evaluation.scene.joints {
        for place in [joint.parent, joint.child] {
            if let Place::Body(body, frame) = place {
                let arm = &numbers.bodies[body].frames[frame].position;
                square += arm.dot(arm);
            }
        }
    }
    [mass, inertia + mass * square]
}

/// Writes one row as a line, by (1), and says the rest of it.
fn write_line<S: Real>(
    (evaluation, tree): (&Evaluation<'_, S>, &Tree),
    joint: usize,
    row: WholeRow<'_, S>,
    accelerations: &[Twist<S>],
    line: &mut [S],
) -> Level<S> {
    let layout = evaluation.layout;
    let ends = &layout.joints[joint].ends;
    let grounded = ends.contains(&None);
    let fall = common_fall(evaluation);
    let (mut time, mut bias) = (row.time, row.bias);
    for (pair, columns) in ends.chunks(2).zip(row.pairs()) {
        let links = tree.links_of(pair);
        let meet = tree.meeting(links);
        for ((end, link), columns) in pair.iter().zip(links).zip(columns) {
            if grounded && end.is_some() {
                // Accelerations are told less the common fall.
                bias -= columns.linear.dot(&fall);
            }
            if let Some(Part::Point(point)) = *end
                && let PointSlots::Mass(slots) = layout.points[point]
            {
                let moves = layout.directions.translations().iter().enumerate();
                moves.for_each(|(k, &axis)| line[slots.v + k] += columns.linear[axis]);
                bias += columns.linear.dot(&fall);
            }
            let Some(link) = link else { continue };
            let motion = &evaluation.links[link];
            let push = taken(motion, columns);
            let (own, centre) = (&accelerations[link], &motion.centre);
            let turning = motion.omega.cross(&motion.omega.cross(centre));
            bias -= push.linear.dot(&(own.linear + turning)) + push.angular.dot(&own.angular);
            let mut push = push;
            for link in tree.path(link).take_while(|link| Some(*link) != meet) {
                let (declared, motion) = (&tree.links[link], &evaluation.links[link]);
                for k in 0..declared.speeds {
                    line[declared.slots.v + k] += motion.along(k, &push);
                }
                push = motion.hand_on(&push);
            }
            // What has come down to the world moves with the frame that carries it there.
            let root = tree.path(link).last().filter(|_| meet.is_none());
            if let Some(moved) = root.and_then(|root| carried_along(evaluation, &tree.links[root]))
            {
                time += push.dot(&moved);
            }
        }
    }
    Level {
        value: row.value,
        time,
        drive: evaluation.prescribed_in_world(joint, row),
        bias,
    }
}

/// Columns of a row on a body, world axes and its own components, as a push at the origin of its link.
fn taken<S: Real>(motion: &LinkMotion<S>, columns: &Columns<S>) -> Twist<S> {
    motion.taken([&columns.linear, &Vector3::zeros()], &columns.angular)
}
