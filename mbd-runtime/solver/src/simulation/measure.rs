//! What a history measures of a run, step by step.

use mbd_scene::Float;

use super::ModelRun;
use crate::error::StepError;
use crate::measure::MeasuredStep;
use crate::row::RowPlace;
use crate::trajectory::Trajectory;

/// To which part of its size a quantity is resolved inside the steps of methods without a tolerance.
const FIXED: f64 = 1e-10;
/// The same over the tolerance of a method, and never below this.
const OF_TOLERANCE: f64 = 0.01;
const FINEST: f64 = 1e-12;

impl<T: Float> ModelRun<T> {
    /// Measures the attempted step, of a size and with this end [s], which will be taken.
    pub(super) fn measure_step(
        &mut self,
        [size, end]: [f64; 2],
        trajectory: &mut Option<&mut Trajectory>,
    ) -> Result<(), StepError> {
        let Some((measures, [_, maker])) = trajectory.as_mut().and_then(|it| it.measuring()) else {
            return Ok(());
        };
        let start = self.time;
        let good = self.good.as_ref();
        if self.watched && good.is_some_and(|good| good.time() == start) {
            measures.keep(start);
        }
        let (model, of_time) = (self.system.model.clone(), self.system.of_time.clone());
        let hidden =
            |span: [f64; 2], seen: &[f64]| of_time.hides(model.scene(), span, seen.iter().copied());
        let step = MeasuredStep {
            hidden: of_time.measures().then_some(&hidden),
            ..self.measured_step([size, end])
        };
        self.jumped = false;
        let mut at = |theta: f64, out: &mut [f64]| {
            let span = theta * size;
            if theta >= 1.0 && !self.system.sees_before() {
                let end = (start + span, RowPlace::End);
                let state = (self.method.next(), self.scratch.as_mut_slice());
                return maker.pick(&mut self.system, end, state, out);
            }
            if theta > 0.0 {
                self.inside_state(theta, size)?;
            } else {
                self.inside.copy_from_slice(&self.state);
            }
            if theta > 0.0 && theta < 1.0 {
                self.system.stay(start + span, &mut self.inside)?;
            }
            let place = match theta >= 1.0 {
                true => self.place_before(size),
                false => RowPlace::After(span),
            };
            let state = (self.inside.as_slice(), self.scratch.as_mut_slice());
            maker.pick(&mut self.system, (start + span, place), state, out)
        };
        measures.step(step, &mut at)
    }

    /// The place of a row right before the events on which the attempted step of a size ends, with its state in `inside` in place of that at the end.
    pub(super) fn place_before(&mut self, size: f64) -> RowPlace {
        let end = [self.time + size, size];
        let time = self.system.end_before(end, &self.state, &mut self.inside);
        RowPlace::Before(time, time - self.time)
    }

    /// The step from here on, of a size and with this end [s], as what is measured sees it.
    pub(super) fn measured_step(&self, [size, end]: [f64; 2]) -> MeasuredStep<'static> {
        let tolerance = self.options.method.tolerance();
        let tolerance = tolerance.map_or(FIXED, |[tolerance, _]| OF_TOLERANCE * tolerance);
        MeasuredStep {
            time: self.time,
            size,
            end,
            tolerance: tolerance.max(FINEST).max(16.0 * T::EPSILON.to_f64()),
            straight: self.straight,
            continues: !self.jumped,
            hidden: None,
        }
    }

    /// Measures the accepted state.
    pub(super) fn measure_instant(
        &mut self,
        trajectory: &mut Option<&mut Trajectory>,
    ) -> Result<(), StepError> {
        let Some((measures, [maker, _])) = trajectory.as_mut().and_then(|it| it.measuring()) else {
            return Ok(());
        };
        let time = self.time;
        measures.instant(time, |out| {
            let state = (self.state.as_slice(), self.scratch.as_mut_slice());
            let now = (time, RowPlace::After(0.0));
            maker.pick(&mut self.system, now, state, out)
        })
    }

    /// The last instant of a run that stops: it is measured, and a row.
    pub(super) fn record_end(
        &mut self,
        trajectory: &mut Option<&mut Trajectory>,
    ) -> Result<(), StepError> {
        self.measure_instant(trajectory)?;
        match trajectory {
            Some(trajectory) => {
                let (system, scratch) = (&mut self.system, &mut self.scratch);
                trajectory.push_end(system, self.time, &self.state, scratch)
            }
            None => Ok(()),
        }
    }
}
