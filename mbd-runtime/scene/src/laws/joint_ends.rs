//! Where a joint sits: its two ends, on bodies, points and the world, and what they say of it at one instant.

use nalgebra::Vector3;

use crate::laws::evaluation::Evaluation;
use crate::laws::formula;
use crate::laws::kinematics::Kinematics;
use crate::rows::{End, Ends, Rotation, Row, Rows, WholeRow};
use crate::{
    AngularVelocity, At, Coordinate, Formula, Jet, Joint, Layout, Part, Place, PointSlots, Real,
    RowSet, Scene,
};

impl<S: Real> Evaluation<'_, S> {
    /// The two ends of a joint; own components as asked.
    pub(crate) fn ends(&self, joint: usize, components: AngularVelocity) -> Option<Ends<'_, S>> {
        let declared = self.scene.joints.get(joint)?;
        let numbers = self.numbers.joints.get(joint)?;
        Some(Ends::new(
            self.end(declared.parent, components)?,
            self.end(declared.child, components)?,
            numbers,
            components,
        ))
    }

    /// Writes those rows of a joint's law that are asked for, what is prescribed on their right-hand sides: the rows of its own ends, or of a
    /// coupling the sum over the joints that it couples, with their `ends`.
    pub(crate) fn law_rows<'e>(
        &'e self,
        (joint, own): (usize, &Ends<'e, S>),
        ends: &dyn Fn(usize) -> Option<Ends<'e, S>>,
        asked: RowSet,
        rows: &mut Rows<S>,
    ) {
        rows.begin(asked);
        let Some(declared) = self.scene.joints.get(joint) else {
            return;
        };
        if let Some(coupling) = self.numbers.couplings.get(joint).and_then(Option::as_ref) {
            let couples = declared.law.couples().iter();
            let coordinates = couples.filter_map(|&(of, index)| {
                let (_, coordinate) = self.scene.coordinate(of, index)?;
                let ends = ends(of)?;
                let mut row = ends.row(&coordinate);
                row.prescribe(&ends);
                Some(row)
            });
            let slots = self.layout.joints.get(joint);
            match slots.and_then(|slots| slots.held) {
                Some(at) => coupling.hold(coordinates, self.at.hold.get(at).copied(), rows),
                None => coupling.constrain(coordinates, rows),
            }
            return;
        }
        declared.law.constrain(own, rows);
        rows.prescribe(own);
    }

    /// First speed of a part that moves, its velocity, world axes, and its angular velocity as asked.
    pub(crate) fn speeds_of(
        &self,
        part: Part,
        components: AngularVelocity,
    ) -> Option<(usize, [Vector3<S>; 2])> {
        match part {
            Part::Body(body) => {
                let (motion, slots) = (self.motions.get(body)?, self.layout.own_slots(part)?);
                let omega = match components {
                    AngularVelocity::Body => motion.omega_body,
                    AngularVelocity::World => motion.omega_world,
                };
                Some((slots.v, [motion.velocity, omega]))
            }
            Part::Point(point) => match *self.layout.points.get(point)? {
                PointSlots::Mass(slots) => {
                    let velocity = self.velocity_of(Place::Point(point))?;
                    Some((slots.v, [velocity, Vector3::zeros()]))
                }
                PointSlots::Node(_) => None,
            },
            Part::Joint(_) | Part::Coordinates(_) => None,
        }
    }

    /// Φ_t of a row in the world, where what stands still prescribes nothing: that from the origin less what the origin's motion makes of ends there.
    pub(crate) fn prescribed_in_world(&self, joint: usize, row: WholeRow<'_, S>) -> S {
        let (Some(origin), Some(slots)) = (self.origin, self.layout.joints.get(joint)) else {
            return row.time;
        };
        let ends = slots.ends.iter().zip(row.all_columns());
        let on_ground = ends.filter(|(end, _)| end.is_none());
        on_ground.fold(row.time, |time, (_, columns)| {
            time + columns.linear.dot(&origin.velocity)
        })
    }

    /// The coordinates of a joint that motors drive, and their courses.
    pub(crate) fn motors<'e>(
        &'e self,
        joint: &'e Joint,
    ) -> impl Iterator<Item = (Coordinate, Jet<S>)> + 'e {
        joint.motors().filter_map(|(index, course)| {
            let coordinate = joint.law.coordinate(index)?;
            Some((coordinate, self.course(course)))
        })
    }

    /// The course of a motor: a function of time, or a coordinate with its rate and its acceleration, each of inputs, states and time.
    pub(crate) fn course(&self, course: &Formula) -> Jet<S> {
        let Formula::Vector(parts) = course else {
            return crate::laws::ground::course(course, self.scene, self.numbers, self.at.time);
        };
        let part = |index: usize| match parts.get(index) {
            Some(part) => formula::scalar(part, self),
            None => S::from_f64(f64::NAN),
        };
        Jet {
            value: part(0),
            rate: part(1),
            curve: part(2),
        }
    }

    /// The end of a joint at a place; own components as asked.
    pub(crate) fn end(&self, place: Place, components: AngularVelocity) -> Option<End<S>> {
        match place {
            Place::World(frame) => {
                let end = match self.moving(frame) {
                    Some(motion) => End::moving(motion),
                    None => {
                        let frame = self.numbers.world_frames.get(frame)?;
                        End::fixed(frame.position, frame.rotation.into())
                    }
                };
                Some(End {
                    position: self.position_from_origin(end.position),
                    velocity: self.velocity_from_origin(end.velocity),
                    // From an origin that moves, what stands still moves.
                    prescribed: end
                        .prescribed
                        .or(self.origin.map(|_| [Vector3::zeros(); 2])),
                    ..end
                })
            }
            Place::Point(point) => match *self.layout.points.get(point)? {
                PointSlots::Mass(_) => Some(End {
                    position: self.position_of(place)?,
                    velocity: self.velocity_of(place)?,
                    ..End::fixed(Vector3::zeros(), Rotation::Identity)
                }),
                PointSlots::Node(_) => None,
            },
            Place::Body(body, frame) => {
                let motion = self.motions.get(body)?;
                let frame = self.numbers.bodies.get(body)?.frames.get(frame)?;
                let own = Rotation::from(frame.rotation);
                let (omega, outward, arm, frame) = match components {
                    AngularVelocity::Body => (
                        motion.omega_body,
                        Rotation::Matrix(motion.rotation),
                        frame.position,
                        own,
                    ),
                    AngularVelocity::World => (
                        motion.omega_world,
                        Rotation::Identity,
                        motion.arm(&frame.position),
                        Rotation::Matrix(motion.rotation).after(&own),
                    ),
                };
                Some(End {
                    position: motion.position,
                    velocity: motion.velocity,
                    omega,
                    outward,
                    arm,
                    reference: Vector3::zeros(),
                    frame,
                    prescribed: None,
                })
            }
        }
    }
}

/// How far a joint of a planar scene is from holding out of the plane: the largest of the rows that its joint has in space and not in the
/// plane [m or 1]; zero in space. Positions alone matter.
pub fn out_of_plane(
    scene: &Scene,
    layout: &Layout,
    numbers: &crate::laws::Numbers<f64>,
    at: &At<'_, f64>,
    joint: usize,
) -> f64 {
    let (Some(declared), Some(slots)) = (scene.joints.get(joint), layout.joints.get(joint)) else {
        return 0.0;
    };
    let left = RowSet(RowSet::all(declared.law.rows()).0 & !slots.law.0);
    let mut kinematics = Kinematics::new(layout);
    let evaluation = kinematics.read(scene, layout, numbers, at);
    let mut rows = Rows::default();
    let ends = |joint: usize| evaluation.ends(joint, AngularVelocity::Body);
    if let Some(own) = ends(joint) {
        evaluation.law_rows((joint, &own), &ends, left, &mut rows);
    }
    let sizes = rows.rows().iter().map(|row| row.value.abs());
    sizes.fold(0.0, Real::max)
}

/// The units of the rows of a joint, in their order: `m` of one that the places of its ends change, else `rad`; of a coupling that of the coordinate
/// that it is written for.
pub fn row_units(
    scene: &Scene,
    layout: &Layout,
    numbers: &crate::laws::Numbers<f64>,
    at: &At<'_, f64>,
    joint: usize,
) -> Vec<&'static str> {
    let (Some(declared), Some(slots)) = (scene.joints.get(joint), layout.joints.get(joint)) else {
        return Vec::new();
    };
    if let Some(&(of, index)) = declared.law.couples().last() {
        let coordinate = scene.coordinate(of, index);
        let unit = coordinate.map_or("m", |(_, coordinate)| coordinate.unit());
        return vec![unit; slots.len];
    }
    let mut kinematics = Kinematics::new(layout);
    let evaluation = kinematics.read(scene, layout, numbers, at);
    let mut rows = Rows::default();
    let ends = |joint: usize| evaluation.ends(joint, AngularVelocity::Body);
    if let Some(own) = ends(joint) {
        evaluation.law_rows((joint, &own), &ends, slots.law, &mut rows);
        for (coordinate, course) in evaluation.motors(declared) {
            rows.motor(&own, &coordinate, &course);
        }
    }
    let is_length = |row: &Row<f64>| {
        let mut linear = row.columns.iter().flat_map(|columns| columns.linear.iter());
        linear.any(|x| *x != 0.0)
    };
    let units = rows.rows().iter();
    units
        .map(|row| if is_length(row) { "m" } else { "rad" })
        .collect()
}

/// Whether a joint is on the branch it means: three numbers, all positive if it is (1 where its rows have no other root). Positions alone
/// matter; a joint or a place that is not there gives NaN.
pub fn branch(
    scene: &Scene,
    layout: &Layout,
    numbers: &crate::laws::Numbers<f64>,
    at: &At<'_, f64>,
    joint: usize,
) -> [f64; 3] {
    let mut kinematics = Kinematics::new(layout);
    branch_of(&kinematics.read(scene, layout, numbers, at), joint)
}

/// The same of what is evaluated already.
pub(crate) fn branch_of(evaluation: &Evaluation<'_, f64>, joint: usize) -> [f64; 3] {
    let ends = evaluation.ends(joint, AngularVelocity::Body);
    let (Some(ends), Some(declared)) = (ends, evaluation.scene.joints.get(joint)) else {
        return [f64::NAN; 3];
    };
    let [a, b, c] = declared.law.branch(&ends);
    let courses = evaluation.motors(declared);
    let driven = courses.fold(c, |least, (coordinate, course)| {
        least.min(ends.prescribed_cosine(&coordinate, course.value))
    });
    [a, b, driven]
}
