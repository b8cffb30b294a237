//! How often a step is looked into for the guards of declared events: as often as they go up and down along it, as those of a toothed rail that is passed.
//!
//! Three looks that are a part apart make a parabola. Where a look between two of them is elsewhere by more than a part of what the guard changes there, it goes up and
//! down between the looks, and there are more of them.

use mbd_scene::Float;

use crate::error::StepError;
use crate::event::BETWEEN;
use crate::simulation::ModelRun;

/// The most looks at a step, and how many more there are where a guard is not resolved.
const MOST_LOOKS: u32 = 1 << 16;
const FINER: u32 = 4;
/// The fewest parts of a step whose looks are compared.
const PARTS: u32 = 8;

impl<T: Float> ModelRun<T> {
    /// At least so many looks, and as many as the guards of declared events take that go up and down along the step.
    /// Where the error of the step says nothing of how far it may go, looks that seem to resolve them must do so with more of them, too.
    pub(crate) fn resolving_looks(&mut self, least: u32, step: f64) -> Result<u32, StepError> {
        let mut looks = least;
        let mut resolved = None;
        while looks < MOST_LOOKS {
            match (self.goes_up_and_down(looks, step)?, resolved) {
                (true, _) => resolved = None,
                (false, Some(looks)) => return Ok(looks),
                (false, None) if self.looks == 0 => return Ok(looks),
                (false, None) => resolved = Some(looks),
            }
            looks *= FINER;
        }
        Ok(resolved.unwrap_or(looks))
    }

    /// Whether guards go up and down between so many looks at the attempted step: at its start, and, as a kink or a jump is in one place, elsewhere.
    fn goes_up_and_down(&mut self, looks: u32, step: f64) -> Result<bool, StepError> {
        let places: &[f64] = if self.looks == 0 {
            &[0.0]
        } else {
            &[0.0, 0.31, 0.63]
        };
        let mut found = 0;
        for from in places {
            found += u32::from(self.goes_up_and_down_behind(*from, looks, step)?);
        }
        if self.looks == 0 && found > 0 {
            found += u32::from(self.goes_up_and_down_behind(0.5, looks, step)?);
        }
        Ok(found > 1)
    }

    fn goes_up_and_down_behind(
        &mut self,
        from: f64,
        looks: u32,
        step: f64,
    ) -> Result<bool, StepError> {
        let part = 1.0 / f64::from(looks.max(PARTS));
        if from > 0.0 {
            self.look_roughly(from, step)?;
        }
        self.margins.begin_looks(from == 0.0);
        self.look_roughly(from + part, step)?;
        self.margins.earlier.copy_from_slice(&self.margins.now);
        self.look_roughly(from + 2.0 * part, step)?;
        self.margins.before.copy_from_slice(&self.margins.now);
        for behind in [0.0, 1.0] {
            self.look_roughly(from + (behind + BETWEEN) * part, step)?;
            if self.margins.is_unresolved::<T>(behind) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Reads the margins at `theta` of the attempted step, as good as its ends tell: that takes no further stages.
    fn look_roughly(&mut self, theta: f64, step: f64) -> Result<(), StepError> {
        match self.inside_by_ends(theta, step) {
            true => self.read_margins(self.time + theta * step, theta * step),
            false => self.look_inside(theta, step),
        }
    }
}
