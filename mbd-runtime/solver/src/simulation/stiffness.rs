//! Stiff systems: seen by an explicit method, named where it cannot go on, and left to the stiff method in runs that have both.

use mbd_scene::{Float, Line, Part, Place};

use super::{ModelRun, Pace};
use crate::error::Stiff;

impl<T: Float> ModelRun<T> {
    /// Looks at the attempted step of an adaptive run before it is taken; true when the run goes on with its other method.
    #[inline]
    pub(super) fn sees_stiffness(&mut self, step: f64) -> bool {
        match self.pace {
            Pace::Fixed(_) => false,
            Pace::Adaptive(..) => self.compare_with_limit(step),
        }
    }

    fn compare_with_limit(&mut self, step: f64) -> bool {
        let part = self.method.part_of_limit(step, &self.watch_weights);
        let changes = match self.method.is_stiff() {
            true => self.stiffness.eases(part),
            false => self.stiffness.sees(part),
        };
        changes && self.method.has_both()
    }

    /// Goes on with the other method, from the step that was taken.
    pub(super) fn change_method(&mut self) {
        self.method.change();
        self.stiffness = Default::default();
        let counters = &mut self.system.counters;
        counters.method_changes = counters.method_changes.saturating_add(1);
        if let Pace::Adaptive(control, _) = &mut self.pace {
            control.retune([self.method.exponent(), self.method.memory()]);
        }
    }

    /// What makes the steps of an explicit method small, if it is stiffness.
    #[cold]
    pub(super) fn stiff(&mut self) -> Option<Box<Stiff>> {
        let Pace::Adaptive(control, norm) = &self.pace else {
            return None;
        };
        if self.method.is_stiff() || !self.stiffness.is_stiff() {
            return None;
        }
        let (step, limit) = (control.step, self.method.limit());
        let part = self.method.part_of_limit(step, &self.watch_weights);
        let block = norm.heaviest(&self.watch_weights, self.method.differences());
        let (scene, lines) = (self.system.model.scene(), self.system.model.lines());
        let owner = norm.owner(block);
        // The line with the largest rate on this body or point, as a step sees it: C + K h.
        let held = |line: &&(usize, &Line)| owner.is_some_and(|part| holds(line.1, part));
        let rate = |index: usize| {
            let numbers = lines.get(index);
            numbers.map_or(0.0, |line| {
                line.damping.to_f64() + step * line.stiffness.to_f64()
            })
        };
        let all: Vec<(usize, &Line)> = scene.lines.iter().enumerate().collect();
        let line = all.iter().filter(held);
        let line = line.max_by(|a, b| rate(a.0).total_cmp(&rate(b.0)));
        Some(Box::new(Stiff {
            method: self.options.method.name(),
            rho: part * limit,
            limit,
            block: norm.name(block, scene),
            line: line.map(|(_, line)| line.name.clone()),
        }))
    }
}

/// Whether a line ends on a body or a point.
fn holds(line: &Line, part: Part) -> bool {
    [line.from, line.to].iter().any(|end| match *end {
        Place::Body(body, _) => part == Part::Body(body),
        Place::Point(point) => part == Part::Point(point),
        Place::World(_) => false,
    })
}
