//! What the interpolant of an attempted step tells of its events, before any step is redone: that there is none, or where the first one is but for the
//! error of the interpolant.

use mbd_scene::Float;

use crate::error::StepError;
use crate::locate::EventBracket;
use crate::simulation::ModelRun;

/// Places inside a step at which margins are read to see that they keep away from zero, and those at which the ends of them are counted.
pub(crate) const FEW_LOOKS: usize = 4;
/// How far margins stay away from zero, over the largest of their second differences.
const AWAY: f64 = 4.0;
/// Most redone steps until there is one on each side.
const MOST_TRIALS: u32 = 5;
/// Most looks for the zero of an interpolated margin, and the part of the step to which it is found: the interpolant does not know it better.
const MOST_LOOKS: u32 = 12;
const KNOWN: f64 = 1e-5;

/// The longest C/K of the lines, in steps: a margin s + C/K ṡ that is all velocity magnifies what the interpolant is off by.
const LONGEST_DELAY: f64 = 1e3;

impl<T: Float> ModelRun<T> {
    /// Whether every margin stays away from zero throughout the attempted step, as four looks show: positive, and far from zero over how much it
    /// bends between them. A margin that turns around near zero, or starts there, does not.
    pub(crate) fn keeps_away(&mut self, step: f64) -> Result<bool, StepError> {
        let count = self.margins.start.len();
        let mut looks = std::mem::take(&mut self.margins.looks);
        looks.clear();
        looks.extend_from_slice(&self.margins.start);
        let mut failed = None;
        for look in 1..=FEW_LOOKS {
            if let Err(cause) = self.look_inside(look as f64 / FEW_LOOKS as f64, step) {
                failed = Some(cause);
                break;
            }
            looks.extend_from_slice(&self.margins.now);
        }
        let margin = |look: usize, index: usize| looks.get(look * count + index).copied();
        let away = |index: usize| {
            let least = (0..=FEW_LOOKS).filter_map(|look| margin(look, index));
            let least = least.fold(f64::INFINITY, f64::min);
            let bend = |look: usize| {
                Some(
                    margin(look - 1, index)? - 2.0 * margin(look, index)?
                        + margin(look + 1, index)?,
                )
            };
            let bends = (1..FEW_LOOKS).filter_map(bend);
            least > AWAY * bends.fold(0.0, |most, bend| bend.abs().max(most))
        };
        let all = failed.is_none() && (0..count).all(away);
        self.margins.looks = looks;
        failed.map_or(Ok(all), Err)
    }

    /// A bracket of the first passing of the chosen margins between `low`, where they are `above` zero, and `high`, both [s] from the start of the
    /// step: where the interpolant says, and on the other side as far off as the redone steps turn out to be. `None`: no bracket is found that way.
    pub(crate) fn approach(
        &mut self,
        low: f64,
        above: f64,
        high: f64,
        step: f64,
    ) -> Result<Option<EventBracket>, StepError> {
        if self.margins.delay > LONGEST_DELAY * step {
            return Ok(None);
        }
        let Some((mut place, slope)) = self.interpolated_zero([low, high], above, step)? else {
            return Ok(None);
        };
        let [mut clear, mut passed] = [None; 2];
        for _ in 0..MOST_TRIALS {
            if place < self.resolved(step) {
                // At the beginning of the step; one that short has no meaning to a method.
                break;
            }
            let margin = self.redo(place)?;
            match margin < 0.0 {
                true => passed = Some((place, margin)),
                false => clear = Some((place, margin.max(f64::MIN_POSITIVE))),
            }
            if let (Some((low, above)), Some((high, below))) = (clear, passed) {
                return Ok((low < high).then_some(EventBracket {
                    low,
                    above,
                    high,
                    below,
                }));
            }
            // Twice as far as the zero seems to be.
            let off = (2.0 * margin.abs() / slope).max(self.resolved(step));
            place = match margin < 0.0 {
                true => place - off,
                false => (place + off).min(step),
            };
            let inside = place > 0.0 && clear.is_none_or(|(clear, _)| clear < step);
            if !inside {
                break;
            }
        }
        Ok(None)
    }

    /// Where the smallest of the chosen margins passes zero on the interpolant [s], and how fast it falls there [1/s of it].
    fn interpolated_zero(
        &mut self,
        [mut low, mut high]: [f64; 2],
        above: f64,
        step: f64,
    ) -> Result<Option<(f64, f64)>, StepError> {
        self.look_inside(high / step, step)?;
        let mut margins = [above, self.margins.smallest(&self.chosen)];
        let mut weights = margins;
        let mut moved = 0;
        for _ in 0..MOST_LOOKS {
            let slope = (margins[0] - margins[1]) / (high - low);
            let [above, below] = weights;
            if !(above > 0.0 && below < 0.0 && slope.is_finite()) {
                return Ok(None);
            }
            let middle = low + (high - low) * above / (above - below);
            self.look_inside(middle / step, step)?;
            let margin = self.margins.smallest(&self.chosen);
            if margin.abs() <= KNOWN * slope * step {
                return Ok(Some((middle, slope)));
            }
            // Illinois, as on redone steps.
            if margin < 0.0 {
                (high, margins[1], weights[1]) = (middle, margin, margin);
                weights[0] *= if moved > 0 { 0.5 } else { 1.0 };
                moved = 1;
            } else {
                (low, margins[0], weights[0]) = (middle, margin, margin);
                weights[1] *= if moved < 0 { 0.5 } else { 1.0 };
                moved = -1;
            }
        }
        Ok(None)
    }
}
