//! A scene at rest in a configuration that can be moved part by part: for looking at joints before a run, one at a time.

use nalgebra::{Matrix3, Rotation3, Vector3};

use crate::laws::body::{BodyMotion, attitude_of};
use crate::laws::evaluation::Evaluation;
use crate::laws::ground;
use crate::laws::numbers::Numbers;
use crate::random::SplitMix64;
use crate::rows::{Row, Rows};
use crate::{
    AngularVelocity, At, FrameMotion, Jet, Layout, Part, Place, PointSlots, RowSet, Scene,
};

/// By which part of their defaults params differ elsewhere.
const ELSEWHERE: f64 = 0.05;

/// A configuration of a scene at rest; mostly with its parameters at their defaults, at time zero.
pub(crate) struct Configuration<'a> {
    pub scene: &'a Scene,
    pub layout: &'a Layout,
    pub numbers: Numbers<f64>,
    state: Vec<f64>,
    inputs: Vec<f64>,
    /// [s]
    time: f64,
    motions: Vec<BodyMotion<f64>>,
    ground: Vec<Option<FrameMotion<f64>>>,
}

impl<'a> Configuration<'a> {
    /// Every part at the origin.
    pub fn new(scene: &'a Scene, layout: &'a Layout) -> Self {
        let defaults: Vec<f64> = scene.params.iter().map(|param| param.default).collect();
        Self::at(scene, layout, &defaults, 0.0)
    }

    /// The same with parameters that differ from their defaults, within their ranges, and at another time.
    pub fn elsewhere(scene: &'a Scene, layout: &'a Layout, random: &mut SplitMix64) -> Self {
        let params = scene.params.iter().map(|param| {
            let wide = if param.default == 0.0 {
                1.0
            } else {
                param.default
            };
            let [low, high] = param.range.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
            let moved = param.default + ELSEWHERE * wide * random.number();
            moved.min(high).max(low)
        });
        let params: Vec<f64> = params.collect();
        Self::at(scene, layout, &params, random.number().abs())
    }

    fn at(scene: &'a Scene, layout: &'a Layout, params: &[f64], time: f64) -> Self {
        let numbers = Numbers::new(scene, params);
        let mut moving = Vec::new();
        ground(scene, &numbers, time, &mut moving);
        let mut configuration = Configuration {
            scene,
            layout,
            numbers,
            ground: moving,
            state: vec![0.0; layout.nx()],
            inputs: vec![0.0; layout.ni],
            time,
            motions: vec![BodyMotion::unknown(); layout.bodies.len()],
        };
        for body in 0..layout.bodies.len() {
            configuration.place(Part::Body(body), Vector3::zeros(), &Matrix3::identity());
        }
        configuration
    }

    /// Puts every part where a state has it.
    pub fn take(&mut self, state: &[f64]) {
        if state.len() != self.state.len() {
            return;
        }
        self.state.copy_from_slice(state);
        let (nq, directions) = (self.layout.nq, self.layout.directions);
        for v in self.state.iter_mut().skip(nq) {
            *v = 0.0;
        }
        for (motion, slots) in self.motions.iter_mut().zip(&self.layout.bodies) {
            if let Some(slots) = slots {
                *motion =
                    BodyMotion::read(&self.state, *slots, nq, directions, AngularVelocity::Body);
            }
        }
    }

    /// Where a part is: position and axes in the world.
    pub fn pose(&self, part: Part) -> (Vector3<f64>, Matrix3<f64>) {
        match part {
            Part::Body(body) => self.motions.get(body).map_or_else(
                || (Vector3::zeros(), Matrix3::identity()),
                |motion| (motion.position, motion.rotation),
            ),
            Part::Point(point) => match self.layout.points.get(point) {
                Some(PointSlots::Mass(slots)) => (
                    self.layout.directions.linear(&self.state, slots.q),
                    Matrix3::identity(),
                ),
                _ => (Vector3::zeros(), Matrix3::identity()),
            },
            Part::Joint(_) | Part::Coordinates(_) => (Vector3::zeros(), Matrix3::identity()),
        }
    }

    /// Where a joint's frame sits on its part: position and axes in the axes of the part.
    pub fn frame(&self, place: Place) -> (Vector3<f64>, Matrix3<f64>) {
        if let Place::World(frame) = place
            && let Some(motion) = self.ground.get(frame).copied().flatten()
        {
            let axes = motion.rotation.unwrap_or_else(Matrix3::identity);
            return (motion.position, axes);
        }
        let found = match place {
            Place::World(frame) => self.numbers.world_frames.get(frame),
            Place::Body(body, frame) => {
                let body = self.numbers.bodies.get(body);
                body.and_then(|body| body.frames.get(frame))
            }
            Place::Point(_) => None,
        };
        found.map_or_else(
            || (Vector3::zeros(), Matrix3::identity()),
            |frame| {
                let axes = frame.rotation.unwrap_or_else(Matrix3::identity);
                (frame.position, axes)
            },
        )
    }

    /// Puts a part somewhere; in a plane at the nearest place and turn there.
    pub fn place(&mut self, part: Part, position: Vector3<f64>, axes: &Matrix3<f64>) {
        let directions = self.layout.directions;
        let slots = self.layout.own_slots(part);
        let Some(slots) = slots else { return };
        directions.write_linear(&mut self.state, slots.q, &position);
        let Part::Body(body) = part else { return };
        let attitude = self
            .state
            .iter_mut()
            .skip(slots.q + directions.translations().len());
        for (slot, value) in attitude.zip(attitude_of(axes, directions)) {
            *slot = value;
        }
        if let Some(motion) = self.motions.get_mut(body) {
            let nq = self.layout.nq;
            // At rest in any components.
            *motion = BodyMotion::read(&self.state, slots, nq, directions, AngularVelocity::Body);
        }
    }

    /// A turn about the normal of the plane; none in space.
    pub fn turn(&self, angle: f64) -> Matrix3<f64> {
        let plane = self.layout.directions.plane;
        plane.map_or_else(Matrix3::identity, |plane| plane.axis().turn(angle))
    }

    /// Moves a part by a translation and a small turn in world axes.
    pub fn shift(&mut self, part: Part, by: Vector3<f64>, turn: Vector3<f64>) {
        let (position, axes) = self.pose(part);
        let turn = Rotation3::new(turn);
        self.place(part, position + by, &(turn.into_inner() * axes));
    }

    /// Calls `look` with the evaluation of this configuration.
    fn look<R>(&self, look: impl FnOnce(&Evaluation<'_, f64>) -> R) -> R {
        let at = At::of_state(self.time, &self.state, &self.inputs);
        look(&Evaluation {
            scene: self.scene,
            layout: self.layout,
            numbers: &self.numbers,
            at: &at,
            motions: &self.motions,
            ground: &self.ground,
            networks: &[],
            lets: &[],
            multipliers: &[],
            reactions: &[],
            accelerations: &[],
            body_accelerations: &[],
            balanced: &[],
            links: &[],
            origin: None,
        })
    }

    /// Writes the rows of a joint that count, world components.
    pub fn rows(&self, joint: usize, rows: &mut Rows<f64>) {
        let law = self.layout.joints.get(joint).map(|slots| slots.law);
        self.rows_of_law(joint, law.unwrap_or_default(), rows);
    }

    /// Writes rows of the law of a joint, world components.
    pub fn rows_of_law(&self, joint: usize, asked: RowSet, rows: &mut Rows<f64>) {
        self.look(|evaluation| {
            let ends = |joint: usize| evaluation.ends(joint, AngularVelocity::World);
            if let Some(own) = ends(joint) {
                evaluation.law_rows((joint, &own), &ends, asked, rows);
            }
        });
    }

    /// Writes the rows of the motors of a joint, world components; the coordinates they drive.
    pub fn motor_rows(&self, joint: usize, rows: &mut Rows<f64>) -> Vec<usize> {
        rows.begin(RowSet::default());
        self.look(|evaluation| {
            let ends = evaluation.ends(joint, AngularVelocity::World);
            let (Some(ends), Some(joint)) = (ends, self.scene.joints.get(joint)) else {
                return Vec::new();
            };
            let mut driven = Vec::new();
            for (index, _) in joint.motors() {
                if let Some(coordinate) = joint.law.coordinate(index) {
                    // What forbids a rate is the same for every course.
                    rows.motor(&ends, &coordinate, &Jet::constant(0.0));
                    driven.push(index);
                }
            }
            driven
        })
    }

    /// A coordinate of a joint as a row, world components; `None` if there is no such coordinate.
    pub fn coordinate_row(&self, joint: usize, coordinate: usize) -> Option<Row<f64>> {
        let (_, coordinate) = self.scene.coordinate(joint, coordinate)?;
        self.look(|evaluation| {
            let ends = evaluation.ends(joint, AngularVelocity::World)?;
            Some(ends.row(&coordinate))
        })
    }

    /// Writes all rows of a joint in the form the system takes those of a joint that loses some.
    pub fn system_rows(&self, joint: usize, all: &mut Rows<f64>, rows: &mut Rows<f64>) {
        self.rows(joint, all);
        self.look(|evaluation| {
            // In the components of the bodies: in a plane the rows that are left go along the axes of the parent, as those of the system do.
            if let Some(ends) = evaluation.ends(joint, AngularVelocity::Body) {
                all.keep(RowSet::all(all.rows().len()), &ends, rows);
            }
        });
    }

    /// Whether a joint is on the branch it means.
    pub fn on_branch(&self, joint: usize) -> bool {
        self.look(|evaluation| {
            let ends = evaluation.ends(joint, AngularVelocity::World);
            match (ends, self.scene.joints.get(joint)) {
                (Some(ends), Some(joint)) => joint.law.branch(&ends).iter().all(|sign| *sign > 0.0),
                _ => false,
            }
        })
    }

    /// The largest coordinate of a position.
    pub fn reach(&self) -> f64 {
        let bodies = self.motions.iter().map(|motion| motion.position.amax());
        bodies.fold(0.0, f64::max)
    }
}
