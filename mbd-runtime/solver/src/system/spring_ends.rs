//! Springs push along their direction: where both ends of one are at the same place, it has none.

use mbd_scene::{Float, LINE_NUMBERS, Line, Quantity};

use super::System;
use crate::columns::line_name;
use crate::error::StepError;
use crate::unilateral::Mode;

/// Ends that are nearer than this part of the scale of lengths are at the same place: rounding alone says which way they are apart.
pub(crate) const SAME_PLACE: f64 = 1e-13;

impl<T: Float> System<T> {
    /// Looks at every spring at a start.
    ///
    /// # Errors
    /// The first that pushes or pulls with both ends at the same place, `length` the scale of lengths [m].
    pub(crate) fn check_spring_ends(
        &mut self,
        time: f64,
        state: &[T],
        length: f64,
    ) -> Result<(), StepError> {
        let pushes = |line: &Line| !line.kind.is_unilateral();
        if !self.model.scene().lines.iter().any(pushes) {
            return Ok(());
        }
        let mut numbers = vec![0.0; self.model.layout().len(Quantity::Lines)];
        self.by_laws(Quantity::Lines, time, state, &mut numbers);
        let scene = self.model.scene();
        let lines = scene.lines.iter().zip(numbers.chunks_exact(LINE_NUMBERS));
        for (index, (line, numbers)) in lines.enumerate() {
            let [force, apart, stretch, ..] = *numbers else {
                continue;
            };
            let is_attached = self.memory.modes().get(index) != Some(&Mode::Detached);
            let same = SAME_PLACE * length;
            // A spring of zero free length is at rest there.
            let strained = stretch.abs() > same && force != 0.0;
            if pushes(line) && is_attached && apart <= same && strained {
                return Err(StepError::NoDirection {
                    spring: line_name(scene, index).to_owned(),
                    time,
                    force,
                });
            }
        }
        Ok(())
    }
}
