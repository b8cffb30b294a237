//! What the ground holds: a scene with nothing of it keeps its momentum but for gravity and loads.

use crate::{JointLaw, Place, Scene};

impl Scene {
    /// The first joint or line by which the ground holds something, and what it holds; `None` where the ground holds nothing: then only gravity and
    /// loads change the momentum of the scene. A `free` joint holds nothing, unless something acts along its coordinates.
    #[must_use]
    pub fn held_by_ground(&self) -> Option<[&str; 2]> {
        let other_end = |a: Place, b: Place| match (a, b) {
            (Place::World(_), other) | (other, Place::World(_)) => Some(self.part(other)),
            _ => None,
        };
        let joints = self.joints.iter().filter(|joint| {
            let free = matches!(joint.law, JointLaw::Free(_)) && joint.forces.is_empty();
            !free && joint.law.couples().is_empty()
        });
        let joints = joints.filter_map(|joint| {
            let part = other_end(joint.parent, joint.child)?;
            Some([joint.name.as_str(), part])
        });
        let lines = self.lines.iter();
        let lines =
            lines.filter_map(|line| Some([line.name.as_str(), other_end(line.from, line.to)?]));
        joints.chain(lines).next()
    }

    /// The name of what a place is on.
    fn part(&self, place: Place) -> &str {
        let name = match place {
            Place::World(_) => None,
            Place::Body(body, _) => self.bodies.get(body).map(|body| body.name.as_str()),
            Place::Point(point) => self.points.get(point).map(|point| point.name.as_str()),
        };
        name.unwrap_or("world")
    }
}
