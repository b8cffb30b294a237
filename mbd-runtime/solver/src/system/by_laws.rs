//! Quantities by the laws themselves, not by the model, which may not have been asked to emit them.

use std::sync::Arc;

use mbd_scene::laws::Numbers;
use mbd_scene::{At, Float, Model, Quantity};

use super::System;
use crate::error::StepError;
use crate::laws::Laws;

impl<T: Float> System<T> {
    /// The numbers of the scene with its params.
    pub(crate) fn numbers(&mut self) -> &Arc<Numbers<f64>> {
        let laws = self.laws.get_or_insert_with(|| Laws::new(&*self.model));
        laws.numbers()
    }

    /// A quantity at the stage that was evaluated last, with what was supplied there, if formulas read another time.
    #[cold]
    pub(crate) fn at_another_time(
        &mut self,
        what: Quantity,
        time: f64,
        state: &[T],
        out: &mut [T],
    ) {
        let state = state.get(..self.nx).unwrap_or_default();
        let at = self.nodes.at(T::from_f64(time), state, &self.inputs);
        self.model.evaluate(what, &at, &mut self.work, out);
    }

    /// A quantity at the stage that was evaluated last by the laws themselves, not by the model, which may not have been asked for it.
    #[cold]
    pub(crate) fn by_laws(&mut self, what: Quantity, time: f64, state: &[T], out: &mut [f64]) {
        let at = self.nodes.at(T::from_f64(time), state, &self.inputs);
        let laws = self.laws.get_or_insert_with(|| Laws::new(&*self.model));
        laws.evaluate(&*self.model, what, &at, out);
    }

    /// The bodies as absolute coordinates have them where joint coordinates place them; empty in absolute coordinates.
    pub(crate) fn placed_by_joints(&mut self, time: f64, state: &[T]) -> Vec<f64> {
        let mut bodies = vec![0.0; self.model.layout().len(Quantity::Bodies)];
        if !bodies.is_empty() {
            self.by_laws(Quantity::Bodies, time, state, &mut bodies);
        }
        bodies
    }

    /// Hands over the laws at the stage that was evaluated last, or at the state that was looked at last (`seen`).
    pub(crate) fn by_laws_at(
        &mut self,
        (time, state): (f64, &[T]),
        seen: bool,
        ask: impl FnOnce(&mut Laws, &dyn Model<T>, &At<'_, T>),
    ) {
        let state = state.get(..self.nx).unwrap_or_default();
        let nodes = match seen && !self.sees_end {
            true => &self.probe,
            false => &self.nodes,
        };
        let at = nodes.at(T::from_f64(time), state, &self.inputs);
        let laws = self.laws.get_or_insert_with(|| Laws::new(&*self.model));
        ask(laws, &*self.model, &at);
    }

    /// The same for the multipliers, and the accelerations, that the fallback found last, where those of the model mean nothing: reactions, energy or outputs.
    #[cold]
    pub(crate) fn by_multipliers(
        &mut self,
        what: Quantity,
        (time, state): (f64, &[T]),
        found: [&[f64]; 2],
        out: &mut [T],
    ) {
        let at = self.nodes.at(T::from_f64(time), state, &self.inputs);
        let laws = self.laws.get_or_insert_with(|| Laws::new(&*self.model));
        self.wide.clear();
        self.wide.resize(out.len(), 0.0);
        laws.evaluate_with_multipliers(&*self.model, what, &at, found, &mut self.wide);
        for (to, from) in out.iter_mut().zip(&self.wide) {
            *to = T::from_f64(*from);
        }
    }

    /// What every event would set, a number a setting in declaration order [SI], at the stage that was evaluated last.
    #[cold]
    pub(crate) fn settings(&mut self, time: f64, state: &[T]) -> Result<Vec<f64>, StepError> {
        let state = state.get(..self.nx).unwrap_or_default();
        self.supply(time, state)?;
        let at = self.nodes.at(T::from_f64(time), state, &self.inputs);
        let laws = self.laws.get_or_insert_with(|| Laws::new(&*self.model));
        let mut values = Vec::new();
        laws.run(&*self.model, &at, |scene, layout, numbers, at, scratch| {
            let all = scene.events.iter().flat_map(|event| &event.actions.set);
            let all = &mut all.map(|setting| &setting.value);
            mbd_scene::scalars(all, scene, layout, numbers, at, scratch, &mut values);
        });
        Ok(values)
    }

    /// Where the coordinate of every lock is [m or rad], at the stage that was evaluated last.
    #[cold]
    pub(crate) fn locked(&mut self, time: f64, state: &[T]) -> Vec<f64> {
        let mut values = Vec::new();
        if self.model.layout().locks > 0 {
            self.by_laws_at((time, state), false, |laws, model, at| {
                laws.run(model, at, |scene, layout, numbers, at, scratch| {
                    mbd_scene::locked(scene, layout, numbers, at, scratch, &mut values);
                });
            });
        }
        values
    }
}
