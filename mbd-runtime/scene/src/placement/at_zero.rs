//! Where nothing is given: all coordinates are zero, or what couplings make of that, or where loops close from there; what no loop closes with stays
//! where it is.

use super::{CLOSED, JointStart, Placement, PlacingJoint};
use crate::{Part, Quantity};

impl Placement<'_> {
    /// All coordinates zero but those of motors and what couplings make of them, as they are here. Loops that are open there are closed. Where none closes,
    /// parts between the ends of a joint that does not hold, and all that hangs on them, stay where they are; those that lead to a part with a
    /// place of its own are at zero, since what does not fit is that place.
    pub(super) fn rest(&mut self, motors: &[JointStart], state: &mut [f64]) {
        if self.holds_anywhere() {
            self.walk(state);
            return;
        }
        let before = state.to_vec();
        let gaps = self.rows(Quantity::Constraint, state);
        if gaps.amax() > CLOSED.sqrt() && self.closes(motors, state) {
            return;
        }
        let mut open: Vec<Part> = Vec::new();
        for (joint, slots) in self.layout.joints.iter().enumerate() {
            let mut rows = gaps.iter().skip(slots.row).take(slots.len);
            let holds = rows.all(|gap| gap.abs() <= CLOSED.sqrt());
            if !holds && self.layout.starts_joined(joint) {
                let paths: Vec<Vec<Part>> = (slots.ends.iter().flatten())
                    .map(|end| self.path(*end))
                    .collect();
                let own_place =
                    |path: &Vec<Part>| path.last().is_some_and(|end| self.fixed.contains(end));
                if paths.iter().any(own_place) {
                    continue;
                }
                let placed = |part: &Part| self.links.iter().any(|link| link.to == *part);
                let common =
                    |part: &Part| paths.len() > 1 && paths.iter().all(|path| path.contains(part));
                let own = paths.iter().flatten();
                open.extend(own.filter(|part| placed(part) && !common(part)));
            }
        }
        for link in &self.links {
            let on = self.from(link);
            if on.is_some_and(|on| open.contains(&on)) {
                open.push(link.to);
            }
        }
        state.copy_from_slice(&before);
        self.links.retain(|link| !open.contains(&link.to));
        self.walk(state);
    }

    /// Closes loops from the coordinates as they are, on the branches that joints mean; where that fails nothing is changed.
    fn closes(&mut self, motors: &[JointStart], state: &mut [f64]) -> bool {
        let before = (self.q.clone(), self.u.clone());
        let closed = self.solve(motors, state).is_ok() && self.is_on_branch(state);
        if !closed {
            (self.q, self.u) = before;
        }
        closed
    }

    /// Whether every joint holds whatever the coordinates: all of them place a part, by as many coordinates as they leave free.
    pub(super) fn holds_anywhere(&self) -> bool {
        let places = |joint: usize| {
            let law = &self.scene.joints[joint].law;
            let linked = self.links.iter().any(|link| link.joint == joint);
            linked && law.coordinates() >= law.freedoms()
        };
        let mut joined = (0..self.layout.joints.len()).filter(|&j| self.layout.starts_joined(j));
        joined.all(places)
    }

    /// The part that a link starts from; `None`: the world.
    fn from(&self, link: &PlacingJoint) -> Option<Part> {
        let ends = &self.layout.joints.get(link.joint)?.ends;
        *ends.get(usize::from(link.to_parent))?
    }

    /// A part and those it hangs on, one after the other.
    fn path(&self, part: Part) -> Vec<Part> {
        let mut path = vec![part];
        while let Some(link) = self.links.iter().find(|link| Some(&link.to) == path.last()) {
            match self.from(link) {
                Some(on) => path.push(on),
                None => break,
            }
        }
        path
    }
}
