//! AppliedForces: what lines and loads do to bodies, points and nodes.

use nalgebra::Vector3;

use crate::laws::evaluation::Evaluation;
use crate::laws::formula;
use crate::laws::joint_forces::JointForcesAt;
use crate::{InputSource, Layout, LoadKind, Place, Real};

/// Force and torque on everything that moves, world axes; torque about the centre of mass.
#[derive(Clone, Debug)]
pub struct AppliedForces<S: Real> {
    /// Per body: force [N] and torque [N m].
    pub bodies: Vec<(Vector3<S>, Vector3<S>)>,
    /// Per body: torque of what acts along joint coordinates, body axes [N m], besides the torque above.
    pub own: Vec<Vector3<S>>,
    /// Per point: force [N].
    pub points: Vec<Vector3<S>>,
    /// Per speed what acts along the coordinates of the joints of the tree [N or N m]; empty in absolute coordinates.
    pub along: Vec<S>,
}

impl<S: Real> AppliedForces<S> {
    /// Room for one scene.
    pub fn new(layout: &Layout) -> Self {
        let (bodies, points) = (layout.bodies.len(), layout.points.len());
        AppliedForces {
            bodies: vec![(Vector3::zeros(), Vector3::zeros()); bodies],
            own: vec![Vector3::zeros(); bodies],
            points: vec![Vector3::zeros(); points],
            along: vec![S::zero(); layout.tree.as_ref().map_or(0, |_| layout.nv)],
        }
    }

    fn clear(&mut self) {
        self.bodies.fill((Vector3::zeros(), Vector3::zeros()));
        self.own.fill(Vector3::zeros());
        self.points.fill(Vector3::zeros());
        self.along.fill(S::zero());
    }

    /// Adds a force at a place.
    fn push(&mut self, evaluation: &Evaluation<'_, S>, place: Place, force: &Vector3<S>) {
        match place {
            Place::World(_) => {}
            Place::Body(body, frame) => {
                let arm = evaluation
                    .motions
                    .get(body)
                    .zip(evaluation.numbers.bodies.get(body))
                    .and_then(|(motion, numbers)| {
                        let frame = numbers.frames.get(frame)?;
                        Some(motion.arm(&frame.position))
                    });
                if let (Some(wrench), Some(arm)) = (self.bodies.get_mut(body), arm) {
                    wrench.0 += force;
                    wrench.1 += arm.cross(force);
                }
            }
            Place::Point(point) => {
                if let Some(total) = self.points.get_mut(point) {
                    *total += force;
                }
            }
        }
    }

    /// Collects every line, every load, and what acts along joint coordinates.
    pub fn collect(&mut self, evaluation: &Evaluation<'_, S>) {
        self.clear();
        self.collect_lines(evaluation);
        for load in 0..evaluation.scene.loads.len() {
            self.collect_load(evaluation, load);
        }
        crate::laws::joint_forces::visit(evaluation, &mut |acting| match evaluation
            .layout
            .carried(acting.joint)
        {
            Some(link) => self.along[link.slots.v + acting.number()] += acting.effort(),
            None => self.collect_effort(acting),
        });
    }

    fn collect_lines(&mut self, evaluation: &Evaluation<'_, S>) {
        for (index, declared) in evaluation.scene.lines.iter().enumerate() {
            if let Some(motion) = evaluation.line_motion(index) {
                let force = crate::scalar::algebra::labelled(
                    motion.geometry.direction.map(|u| motion.tension * u),
                    ["force_x", "force_y", "force_z"],
                );
                self.push(evaluation, declared.from, &force);
                self.push(evaluation, declared.to, &-force);
            }
        }
    }

    /// Φ_vᵀ Q of one joint coordinate.
    fn collect_effort(&mut self, acting: &JointForcesAt<'_, S>) {
        let Some([parent, child]) = acting.places() else {
            return;
        };
        let (effort, row) = (acting.effort(), acting.row());
        for (place, columns) in [(parent, row.parent()), (child, row.child())] {
            let force = columns.linear.map(|x| x * effort);
            match place {
                Place::World(_) => {}
                Place::Body(body, _) => {
                    let totals = self.bodies.get_mut(body).zip(self.own.get_mut(body));
                    if let Some((wrench, own)) = totals {
                        wrench.0 += force;
                        *own += columns.angular.map(|x| x * effort);
                    }
                }
                Place::Point(point) => {
                    if let Some(total) = self.points.get_mut(point) {
                        *total += force;
                    }
                }
            }
        }
    }

    fn collect_load(&mut self, evaluation: &Evaluation<'_, S>, index: usize) {
        let Some(load) = evaluation.scene.loads.get(index) else {
            return;
        };
        let (force, torque) = wrench(evaluation, index);
        if let Some(force) = force {
            self.push(evaluation, load.at, &force);
        }
        if let (Place::Body(body, _), Some(torque)) = (load.at, torque)
            && let Some(total) = self.bodies.get_mut(body)
        {
            total.1 += torque;
        }
    }
}

/// Force at its place [N] and couple [N m] of a load, world axes.
fn wrench<S: Real>(
    evaluation: &Evaluation<'_, S>,
    index: usize,
) -> (Option<Vector3<S>>, Option<Vector3<S>>) {
    let Some(load) = evaluation.scene.loads.get(index) else {
        return (None, None);
    };
    S::section(&load.name);
    match &load.kind {
        LoadKind::Force(formula) => (Some(formula::vector(formula, evaluation)), None),
        LoadKind::Torque(formula) => (None, Some(formula::vector(formula, evaluation))),
        LoadKind::External => {
            let source = InputSource::Load(index);
            let couple = matches!(load.at, Place::Body(..)).then(|| evaluation.input(source, 3));
            (Some(evaluation.input(source, 0)), couple)
        }
    }
}

/// Load W on a node [N]: the sum of its declared loads.
pub fn node_load<S: Real>(evaluation: &Evaluation<'_, S>, point: usize) -> Vector3<S> {
    let mut total = Vector3::zeros();
    for (index, load) in evaluation.scene.loads.iter().enumerate() {
        if load.at == Place::Point(point)
            && let (Some(force), _) = wrench(evaluation, index)
        {
            total += force;
        }
    }
    total
}

/// Ẇ: the rate of the load on a node [N/s]; [`Scene::tells_load_rate`] says of which loads it is told.
pub fn node_load_rate<S: Real>(evaluation: &Evaluation<'_, S>, point: usize) -> Vector3<S> {
    let mut total = Vector3::zeros();
    for load in &evaluation.scene.loads {
        if load.at == Place::Point(point)
            && let LoadKind::Force(formula) = &load.kind
            && evaluation.scene.tells_load_rate(formula)
        {
            total += evaluation.rates_of(formula);
        }
    }
    total
}

/// Force of all loads [N] and their torque about the world origin [N m]; loads on nodes, which their lines pass on, among them.
pub fn loads<S: Real>(evaluation: &Evaluation<'_, S>) -> (Vector3<S>, Vector3<S>) {
    let (mut total, mut torque) = (Vector3::zeros(), Vector3::zeros());
    for (index, load) in evaluation.scene.loads.iter().enumerate() {
        let (force, couple) = wrench(evaluation, index);
        if let (Some(force), Some(position)) = (force, evaluation.position_of(load.at)) {
            total += force;
            torque += evaluation.in_world(position).cross(&force);
        }
        if let Some(couple) = couple {
            torque += couple;
        }
    }
    (total, torque)
}

/// Power of the loads [W]; those on nodes do work as the nodes move, on the bodies and in the lines.
pub fn load_power<S: Real>(evaluation: &Evaluation<'_, S>) -> S {
    let mut power = S::zero();
    for (index, load) in evaluation.scene.loads.iter().enumerate() {
        let velocity = evaluation.velocity_of(load.at);
        let velocity = velocity.map(|velocity| evaluation.rate_in_world(velocity));
        let spin = match load.at {
            Place::Body(body, _) => evaluation
                .motions
                .get(body)
                .map(|motion| motion.omega_world),
            _ => None,
        };
        let (force, torque) = wrench(evaluation, index);
        if let (Some(force), Some(velocity)) = (force, velocity) {
            power += force.dot(&velocity);
        }
        if let (Some(torque), Some(spin)) = (torque, spin) {
            power += torque.dot(&spin);
        }
    }
    power
}

/// Power that moving frames of the world put into the lines and the joint coordinates that end there, and winches into their lines [W]: the
/// drive holds against the pull, T u·v at the `to` end, −T u·v at the `from` end, −T L̇0 where the line is wound; against the effort, −Q times
/// the share of the frame in the rate.
pub fn drive_power<S: Real>(evaluation: &Evaluation<'_, S>) -> S {
    let mut power = S::zero();
    for (index, line) in evaluation.scene.lines.iter().enumerate() {
        let velocity = |place: Place| match place {
            Place::World(frame) => evaluation.moving(frame).map(|motion| motion.velocity),
            _ => None,
        };
        let (from, to) = (velocity(line.from), velocity(line.to));
        let winding = evaluation.rate_of_winding(index);
        if from.is_none() && to.is_none() && winding.is_none() {
            continue;
        }
        let Some(motion) = evaluation.line_motion(index) else {
            continue;
        };
        let along =
            |velocity: Vector3<S>| motion.tension * motion.geometry.direction.dot(&velocity);
        if let Some(velocity) = to {
            power += along(velocity);
        }
        if let Some(velocity) = from {
            power -= along(velocity);
        }
        if let Some(winding) = winding {
            power -= motion.tension * winding;
        }
    }
    crate::laws::joint_forces::visit(evaluation, &mut |acting| {
        if let Some(driven) = acting.driven() {
            power -= driven;
        }
    });
    power
}
