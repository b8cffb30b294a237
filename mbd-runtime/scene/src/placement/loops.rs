//! Which coordinates of the tree close its loops.
//!
//! A joint that does not hold whatever they are ties its two ends by what lies between them: the links on the way to one end and not on the way to the
//! other. What is above a loop, or beside it, moves none of its rows: it is where nobody says otherwise, at zero, whatever the search for the others tries.

use super::Placement;
use super::tree::PlacingJoint;
use crate::Part;

impl Placement<'_> {
    /// Whether every joint holds whatever the coordinates: all of them place a part, by as many coordinates as they leave free.
    pub(super) fn holds_anywhere(&self) -> bool {
        self.closing().next().is_none()
    }

    /// The joints of the tree whose coordinates move a row.
    pub(super) fn in_loops(&self) -> Vec<usize> {
        let mut found = Vec::new();
        for closing in self.closing() {
            // A coupling has two ends for each of its coordinates.
            let ends: Vec<Option<Part>> =
                self.layout.joints[closing].ends.iter().copied().collect();
            for pair in ends.chunks(2) {
                let paths = pair.iter().map(|end| self.path(*end));
                let paths: Vec<Vec<Part>> = paths.collect();
                let between =
                    |part: &Part| paths.iter().filter(|path| path.contains(part)).count() == 1;
                let links = self.links.iter().filter(|link| between(&link.to));
                found.extend(links.map(|link| link.joint));
            }
        }
        found
    }

    /// The joints that coordinates have to be found for.
    fn closing(&self) -> impl Iterator<Item = usize> {
        let places = |joint: usize| {
            let law = &self.scene.joints[joint].law;
            let linked = self.links.iter().any(|link| link.joint == joint);
            linked && law.coordinates() >= law.freedoms()
        };
        let joined = (0..self.layout.joints.len()).filter(|&j| self.layout.starts_joined(j));
        joined.filter(move |&joint| !places(joint))
    }

    /// The part that a link starts from; `None`: the world.
    pub(super) fn from(&self, link: &PlacingJoint) -> Option<Part> {
        let ends = &self.layout.joints.get(link.joint)?.ends;
        *ends.get(usize::from(link.to_parent))?
    }

    /// A part and those it hangs on, one after the other; none of the world.
    pub(super) fn path(&self, end: Option<Part>) -> Vec<Part> {
        let mut path: Vec<Part> = end.into_iter().collect();
        while let Some(link) = self.links.iter().find(|link| Some(&link.to) == path.last()) {
            match self.from(link) {
                Some(on) => path.push(on),
                None => break,
            }
        }
        path
    }
}
