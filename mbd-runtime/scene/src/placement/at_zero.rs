//! Where nothing is given: all coordinates are zero, or what couplings make of that, or where loops close from there; what no loop closes with stays
//! where it is.

use super::{CLOSED, JointStart, Placement, PlacementReport};
use crate::{Part, Quantity};

impl Placement<'_> {
    /// All coordinates zero but those of motors and what couplings make of them, as they are here. Loops that are open there are closed. Where none closes,
    /// parts between the ends of a joint that does not hold, and all that hangs on them, stay where they are; those that lead to a part with a
    /// place of its own are at zero, since what does not fit is that place. Tells what nothing decides of loops that were closed.
    pub(super) fn rest(&mut self, motors: &[JointStart], state: &mut [f64]) -> PlacementReport {
        if self.holds_anywhere() {
            self.walk(state);
            return PlacementReport::default();
        }
        let before = state.to_vec();
        let gaps = self.rows(Quantity::Constraint, state);
        if gaps.amax() > CLOSED.sqrt()
            && let Some(report) = self.closes(motors, state)
        {
            return report;
        }
        let mut open: Vec<Part> = Vec::new();
        for (joint, slots) in self.layout.joints.iter().enumerate() {
            let mut rows = gaps.iter().skip(slots.row).take(slots.len);
            let holds = rows.all(|gap| gap.abs() <= CLOSED.sqrt());
            if !holds && self.layout.starts_joined(joint) {
                let paths: Vec<Vec<Part>> = (slots.ends.iter().flatten())
                    .map(|end| self.path(Some(*end)))
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
        PlacementReport::default()
    }

    /// Closes loops from the coordinates as they are, on the branches that joints mean; where that fails nothing is changed.
    fn closes(&mut self, motors: &[JointStart], state: &mut [f64]) -> Option<PlacementReport> {
        let before = (self.q.clone(), self.u.clone());
        let closed = self.solve(motors, state).ok();
        let closed = closed.filter(|_| self.is_on_branch(state));
        if closed.is_none() {
            (self.q, self.u) = before;
        }
        closed
    }
}
