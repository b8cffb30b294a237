//! Events that a guard passes and comes back from inside a step: the margin is below zero between two looks that both find it above.
//!
//! Three looks make a parabola. Where its lowest point lies between them and comes near zero, that point is looked at, and takes the place of the
//! farthest look, until the margin is found below zero or the parabola says that it stays above:
//!
//!   m(θ) = m₁ + (θ − θ₁) s + (θ − θ₁)(θ − θ₀) c,   lowest where m′ = 0, for c > 0                    (1)
//!
//! It comes near zero where its lowest value is no more than a quarter of 2 c d², d half the distance of the outer looks: what the third order may
//! change. Where the middle look is the lowest, the margin may be as sharp as a distance that is passed closely, too: two lines of one slope,
//!
//!   m(θ) = max(m_a − s (θ − θ_a), m_b − s (θ_b − θ)),   lowest (m_a + m_b − s (θ_b − θ_a))/2           (2)
//!
//! with s the steeper of both secants; where (2) is not above zero, its lowest point is looked at; at the ends of a step also where the margin
//! rises ever faster, or falls ever slower. Rejected: more looks at even distances, which find a passage only if it lasts longer than one of these,
//! and cost the same everywhere.

use mbd_scene::Float;

use crate::error::StepError;
use crate::simulation::ModelRun;

/// The most looks after one dip.
const FOLLOWED: u32 = 8;
/// What the lowest value may be over 2 c d² and still be looked at.
const NEAR: f64 = 0.25;

/// Three looks at a margin: where in the step, and what it is; rising in the first.
type Looks = [[f64; 2]; 3];

/// Where the margin is lowest by (1), or else by (2), if that is between the looks and near zero.
fn lowest(looks: Looks) -> Option<f64> {
    rounded(looks).or_else(|| sharp(looks))
}

/// Where (2) is lowest, if it does not stay above zero.
fn sharp([[t0, m0], [t1, m1], [t2, m2]]: Looks) -> Option<f64> {
    let (first, second) = ((m1 - m0) / (t1 - t0), (m2 - m1) / (t2 - t1));
    let slope = first.abs().max(second.abs());
    let of = |[ta, ma]: [f64; 2], [tb, mb]: [f64; 2]| {
        let value = 0.5 * (ma + mb - slope * (tb - ta));
        let at = ta + (ma - value) / slope;
        (value <= 0.0 && at > ta && at < tb).then_some((value, at))
    };
    let both = [of([t0, m0], [t1, m1]), of([t1, m1], [t2, m2])];
    let lowest = both.into_iter().flatten();
    let lowest = lowest.min_by(|a, b| a.0.total_cmp(&b.0));
    // At the ends of a step nothing stands before the first look, and behind the last.
    let rising = t0 == 0.0 && 0.0 < first && first < second;
    let falling = t2 == 1.0 && first < second && second < 0.0;
    (m1 <= m0 && m1 <= m2 || rising || falling).then_some(lowest?.1)
}

/// Where the parabola (1) is lowest, if that is between the looks and near zero.
fn rounded([[t0, m0], [t1, m1], [t2, m2]]: Looks) -> Option<f64> {
    let (first, second) = ((m1 - m0) / (t1 - t0), (m2 - m1) / (t2 - t1));
    let bend = (second - first) / (t2 - t0);
    let at = 0.5 * (t0 + t1) - 0.5 * first / bend;
    let value = m1 + (at - t1) * (first + bend * (at - t0));
    let half = 0.5 * (t2 - t0);
    let inside = bend > 0.0 && at > t0 && at < t2;
    (inside && value <= NEAR * 2.0 * bend * half * half).then_some(at)
}

/// The three looks around the lowest of four.
fn around(looks: Looks, at: [f64; 2]) -> Looks {
    let [first, second, third] = looks;
    let all = match at[0] < second[0] {
        true => [first, at, second, third],
        false => [first, second, at, third],
    };
    match all[1][1] < all[2][1] {
        true => [all[0], all[1], all[2]],
        false => [all[1], all[2], all[3]],
    }
}

impl<T: Float> ModelRun<T> {
    /// Looks at where a declared event may have passed and come back between the last three looks, at these parts of the step; none of its margins was found
    /// passed. Where one is, the looks around it: the margins of the first are `before` then, and the passed ones chosen.
    pub(crate) fn find_dip(
        &mut self,
        [t0, t1, t2]: [f64; 3],
        step: f64,
    ) -> Result<Option<[f64; 2]>, StepError> {
        let mut looked = false;
        for index in 0..self.margins.now.len() {
            let Some([m0, m1, m2]) = self.margins.declared_looks(index) else {
                continue;
            };
            let mut looks = [[t0, m0], [t1, m1], [t2, m2]];
            for look in 0..FOLLOWED {
                let Some(at) = lowest(looks) else {
                    break;
                };
                let nearest = looks.iter().map(|look| (look[0] - at).abs());
                if nearest.fold(f64::INFINITY, f64::min) * step <= self.resolved(step) {
                    break;
                }
                if !looked {
                    self.margins.keep_latest();
                    looked = true;
                }
                match look {
                    0 => self.look_first(at, step)?,
                    _ => self.look_inside(at, step)?,
                }
                if self.choose_passed() {
                    let low = if at < t1 { t0 } else { t1 };
                    if at < t1 {
                        self.margins.before.copy_from_slice(&self.margins.earlier);
                    }
                    return Ok(Some([low, at]));
                }
                let margin = self.margins.now.get(index).copied();
                looks = around(looks, [at, margin.unwrap_or(f64::NAN)]);
            }
            if looked {
                self.margins.take_latest();
            }
        }
        if looked {
            // What was looked at last is not the end of the step.
            self.look_inside(t2, step)?;
        }
        Ok(None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_that_dips_below_zero_between_looks_is_seen_and_one_far_above_is_not() {
        let of = |m: fn(f64) -> f64| [0.0, 0.5, 1.0].map(|t| [t, m(t)]);
        let at = lowest(of(|t| (t - 0.3).powi(2) - 1e-6));
        assert!(at.is_some_and(|at| (at - 0.3).abs() < 1e-12), "{at:?}");
        assert_eq!(lowest(of(|t| (t - 0.3).powi(2) + 1.0)), None);
        assert_eq!(lowest(of(|t| 1.0 - t)), None);
        assert_eq!(lowest(of(|_| f64::INFINITY)), None);
    }

    #[test]
    fn a_distance_that_is_passed_closely_is_followed_to_its_least() {
        // The distance from a place that is passed at 0.02, less 0.03, of even motion.
        for passed in [0.13, 0.26, 0.5, 0.61, 0.87] {
            let margin = |t: f64| (t - passed).hypot(0.02) - 0.03;
            let mut looks = [0.0, 0.5, 1.0].map(|t| [t, margin(t)]);
            let mut found = looks[1][1];
            for _ in 0..FOLLOWED {
                let Some(at) = lowest(looks) else { break };
                found = found.min(margin(at));
                looks = around(looks, [at, margin(at)]);
            }
            assert!(found < 0.0, "{passed}: {found}");
        }
        // One that is passed at ten times that is not.
        let far = [0.0, 0.5, 1.0].map(|t: f64| [t, (t - 0.5).hypot(0.3) - 0.03]);
        assert_eq!(sharp(far), None);
    }
}
