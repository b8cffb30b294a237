//! Rows of a history that are due inside a step, and at its ends.

use mbd_scene::Float;

use super::{ModelRun, Pace};
use crate::balance::EnergyBalance;
use crate::error::StepError;
use crate::integrate::{Control, StiffnessTest};
use crate::momentum::MomentumBalance;
use crate::row::RowPlace;
use crate::trajectory::{Trajectory, resolution};
use crate::watch::Watch;

/// What the tests of a step remember, as it was before the step.
pub(super) struct Judgement {
    control: Option<Control>,
    watch: Watch,
    balance: Option<EnergyBalance>,
    momentum: Option<MomentumBalance>,
    stiffness: StiffnessTest,
}

impl<T: Float> ModelRun<T> {
    /// Rows due strictly inside the attempted step, of a size and with this end [s], or at its end, which is seen from before where events act there: then
    /// it is a row as well when every step is asked for. Between two rows the run may be cancelled: the step then is not taken, and
    /// its rows are dropped, so that a run that goes on writes them as if nothing had been.
    pub(super) fn record_inside(
        &mut self,
        [step, told]: [f64; 2],
        trajectory: &mut Option<&mut Trajectory>,
        go_on: &mut dyn FnMut(f64) -> bool,
        (acts, before): (bool, Option<Judgement>),
    ) -> Result<(), StepError> {
        let Some(trajectory) = trajectory else {
            return Ok(());
        };
        if acts && trajectory.due().is_none() {
            self.inside_state(1.0, step)?;
            let place = self.place_before(step);
            return trajectory.push(
                &mut self.system,
                (told, place),
                &self.inside,
                &mut self.scratch,
            );
        }
        let end = self.time + step;
        let instant = match acts {
            true => self.one_instant(step),
            false => resolution(end),
        };
        while let Some(due) = trajectory.due() {
            if due > end + resolution(end) {
                break;
            }
            let theta = match end - due > instant {
                true => (due - self.time) / step,
                false => 1.0,
            };
            self.inside_state(theta, step)?;
            if theta < 1.0 {
                self.system.stay(due, &mut self.inside)?;
            }
            let place = match theta >= 1.0 {
                true if acts => self.place_before(step),
                true if !self.system.sees_before() => RowPlace::End,
                _ => RowPlace::After(due - self.time),
            };
            trajectory.push(
                &mut self.system,
                (due, place),
                &self.inside,
                &mut self.scratch,
            )?;
            if theta < 1.0 && !go_on(due) {
                trajectory.cut(self.time);
                if let Some(before) = before {
                    self.judge_anew(before);
                }
                return Err(StepError::Cancelled);
            }
        }
        Ok(())
    }

    /// What a step changes before it is taken.
    pub(super) fn judgement(&self) -> Judgement {
        Judgement {
            control: match &self.pace {
                Pace::Fixed(_) => None,
                Pace::Adaptive(control, _) => Some(control.clone()),
            },
            watch: self.watch,
            balance: self.balance,
            momentum: self.momentum,
            stiffness: self.stiffness,
        }
    }

    /// Takes back what an attempted step changed: it will be made again.
    #[cold]
    fn judge_anew(&mut self, before: Judgement) {
        if let (Pace::Adaptive(control, _), Some(before)) = (&mut self.pace, before.control) {
            *control = before;
        }
        (self.watch, self.balance) = (before.watch, before.balance);
        self.momentum = before.momentum;
        self.stiffness = before.stiffness;
    }

    /// A row at the accepted step, when every step is asked for.
    #[inline]
    pub(super) fn record_step(
        &mut self,
        trajectory: &mut Option<&mut Trajectory>,
    ) -> Result<(), StepError> {
        match trajectory {
            Some(trajectory) if trajectory.due().is_none() => trajectory.push(
                &mut self.system,
                (self.time, RowPlace::After(0.0)),
                &self.state,
                &mut self.scratch,
            ),
            _ => Ok(()),
        }
    }

    /// Puts the state at `theta` of the attempted step into `inside`.
    pub(crate) fn inside_state(&mut self, theta: f64, step: f64) -> Result<(), StepError> {
        if theta >= 1.0 {
            self.inside.copy_from_slice(self.method.next());
        } else {
            if self.lacks_stages {
                self.make_stages(step)?;
            }
            let (time, state) = (self.time, &self.state);
            self.method.complete(&mut self.system, time, step, state)?;
            self.method
                .interpolate(theta, step, state, &mut self.inside);
            self.system.normalise(&mut self.inside);
        }
        Ok(())
    }

    /// The same by the ends of the step alone, where the interpolant needs stages of its own that nobody asked for yet; whether it is that.
    pub(crate) fn inside_by_ends(&mut self, theta: f64, step: f64) -> bool {
        let method = self.method.explicit();
        let Some(method) = method.filter(|method| theta < 1.0 && method.is_incomplete()) else {
            return false;
        };
        method.interpolate_ends(theta, step, &self.state, &mut self.inside);
        self.system.normalise(&mut self.inside);
        true
    }
}
