//! Rows of joints have more roots than the one that is meant: every joint must be on its own branch, at a start and while a run goes on.

use mbd_scene::{Float, laws};

use super::System;
use crate::columns::joint_name;
use crate::error::StepError;
use crate::laws::Laws;
use crate::node::NodeMemory;
use crate::unilateral::Mode;

/// Whether no event has detached a joint, by the number of its switch.
fn is_joined<T: Float>(memory: &NodeMemory<T>, switch: Option<usize>) -> bool {
    switch.and_then(|at| memory.modes().get(at)) != Some(&Mode::Detached)
}

impl<T: Float> System<T> {
    /// Number of independent rows, at least, of the joints that no event has detached.
    pub(crate) fn rank(&self) -> usize {
        let layout = self.model.layout();
        layout.rank_where(|joint| is_joined(&self.memory, layout.joints[joint].switch))
    }

    /// Lists the rows kept of the joints that no event has detached.
    pub(crate) fn list_kept_rows(&self, rows: &mut Vec<usize>) {
        let joints = self.model.layout().joints.iter();
        let joined = joints.filter(|slots| is_joined(&self.memory, slots.switch));
        rows.clear();
        rows.extend(joined.flat_map(|slots| slots.kept.rows().map(|row| slots.row + row)));
    }

    /// Whether every joint is on its branch at a start.
    ///
    /// # Errors
    /// Those that are not.
    pub(crate) fn check_branches(&self, time: f64, state: &[T]) -> Result<(), StepError> {
        let (scene, layout) = (self.model.scene(), self.model.layout());
        let (numbers, arguments) = self.in_double(time, state);
        let at = arguments.at();
        let joints = layout.joints.iter().enumerate();
        let flipped: Vec<String> = joints
            .filter(|(joint, slots)| {
                let signs = laws::branch(scene, layout, &numbers, &at, *joint);
                let held = slots.len > 0 && is_joined(&self.memory, slots.switch);
                held && !signs.iter().all(|sign| *sign > 0.0)
            })
            .map(|(joint, _)| joint_name(scene, joint).to_owned())
            .collect();
        if flipped.is_empty() {
            return Ok(());
        }
        Err(StepError::WrongBranch { joints: flipped })
    }

    /// Whether motion took a joint to another branch, at the end of a step.
    ///
    /// # Errors
    /// The first that it took there.
    #[inline]
    pub(crate) fn check_folds(&mut self, time: f64, state: &[T]) -> Result<(), StepError> {
        match self.may_fold {
            true => self.look_for_folds(time, state),
            false => Ok(()),
        }
    }

    fn look_for_folds(&mut self, time: f64, state: &[T]) -> Result<(), StepError> {
        let state = state.get(..self.nx).unwrap_or_default();
        let at = self.nodes.at(T::from_f64(time), state, &self.inputs);
        let (model, memory) = (&*self.model, &self.memory);
        let joints = &model.layout().joints;
        let joined =
            |joint: usize| is_joined(memory, joints.get(joint).and_then(|slots| slots.switch));
        let mut folded = None;
        let laws = self.laws.get_or_insert_with(|| Laws::new(model));
        laws.run(model, &at, |scene, layout, numbers, at, scratch| {
            folded = mbd_scene::folded(scene, layout, numbers, at, scratch, &joined);
        });
        match folded {
            Some((joint, fold)) => Err(StepError::FoldedJoint {
                joint: joint_name(self.model.scene(), joint).to_owned(),
                time,
                fold,
            }),
            None => Ok(()),
        }
    }
}
