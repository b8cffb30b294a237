//! What is looked at at the end of a step beside its error: joints that may fold, motions that are prescribed, lines that are wound.

use mbd_scene::Float;

use super::System;
use crate::error::StepError;
use crate::laws::Laws;
use crate::unilateral::Mode;

impl<T: Float> System<T> {
    /// Looks at what motors are commanded at a state, `span` after the last accepted step [s], at a start `None`, and takes it up.
    ///
    /// # Errors
    /// Commands that do not go on from those of the last step.
    pub(crate) fn follow_commands(
        &mut self,
        time: f64,
        span: Option<f64>,
        state: &[T],
    ) -> Result<(), StepError> {
        self.compare_commands(time, span, state)?;
        self.take_commands();
        Ok(())
    }

    /// Looks at the end of a step that is about to be taken: at joints that may fold, at what is prescribed and what is wound.
    ///
    /// # Errors
    /// What ends the run there.
    #[inline]
    pub(crate) fn check_end(&mut self, time: f64, step: f64, state: &[T]) -> Result<(), StepError> {
        self.check_folds(time, state)?;
        match self.commands.is_none() {
            true => Ok(()),
            false => self.compare_commands(time, Some(step), state),
        }
    }

    /// A jump of what is prescribed within a time from a step on that cannot be taken: no step passes it.
    #[cold]
    pub(crate) fn prescribed_jump(&mut self, time: f64, within: f64) -> Option<StepError> {
        let commands = self.commands.as_ref()?;
        let laws = self.laws.get_or_insert_with(|| Laws::new(&*self.model));
        let known = (self.model.scene(), &**laws.numbers());
        let checked = commands.check_parts(known, (time + within, within));
        checked.err()
    }

    /// The next step goes on from the commands that were looked at last.
    #[inline]
    pub(crate) fn take_commands(&mut self) {
        if let Some(commands) = &mut self.commands {
            std::mem::swap(&mut commands.last, &mut commands.now);
        }
    }

    /// Whether nothing but the state is looked at where a step is taken: nothing that is prescribed, wound or may fold.
    pub(crate) fn needs_no_ends(&self) -> bool {
        self.commands.is_none() && !self.may_fold
    }

    fn compare_commands(
        &mut self,
        time: f64,
        span: Option<f64>,
        state: &[T],
    ) -> Result<(), StepError> {
        if self.commands.is_none() {
            return Ok(());
        }
        let state = state.get(..self.nx).unwrap_or_default();
        self.supply(time, state)?;
        let Some(commands) = &mut self.commands else {
            return Ok(());
        };
        let at = self.nodes.at(T::from_f64(time), state, &self.inputs);
        if span.is_some() {
            let modes = &self.memory.modes;
            let is_attached = |line: usize| modes.get(line) != Some(&Mode::Detached);
            let model = &*self.model;
            let of = (model.scene(), model.layout());
            commands.check_lengths((of.0, time), is_attached, |line| {
                mbd_scene::laws::free_length(of, model.params(), &at, line)
            })?;
        }
        if !commands.are_prescribed() {
            return Ok(());
        }
        let laws = self.laws.get_or_insert_with(|| Laws::new(&*self.model));
        commands.now.clear();
        laws.run(&*self.model, &at, |scene, layout, numbers, at, scratch| {
            mbd_scene::commands(scene, layout, numbers, at, scratch, &mut commands.now);
        });
        if let Some(span) = span {
            let known = (self.model.scene(), &**laws.numbers());
            commands.check::<T>(known, (time, span))?;
        }
        Ok(())
    }
}
