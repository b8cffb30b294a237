//! Declared events whose guards the joints hold at their value: of a latch that locks what it measures, of a rope that is attached where it comes taut.
//! What such a guard shows is rounding, and inside a step the error of a state beside the joints: it passes nothing while it is held.
//!
//! ```text
//! x′ = x + δ·scale·r,  t′ = t + δ·scale        r random in −1 … 1, δ = ε^¼, x′ put on the joints at t′: y′              (1)
//! held:  |g(t′, y′) − g(t, x)| ≤ ε^⅓ |g(t′, x′) − g(t, x)|  for every r,  and |g(t, x)| below 1e-3 of the right-hand side's difference   (2)
//! ```
//!
//! Whatever a guard depends on that the joints do not hold (a clock, a state, another freedom) moves it in (2). Source: derived.
//! Rejected: rules by what stands in a guard, which see `slide falls 0` of a locked slide and not `norm(tip.position) rises L` of a rope; a tolerance
//! on guards, which have any unit.

use mbd_scene::Float;
use mbd_scene::random::SplitMix64;

use crate::error::StepError;
use crate::integrate::Scales;
use crate::moving::moving;
use crate::simulation::ModelRun;

/// The noise of a guard, in last places of what it is made of.
const NOISE: f64 = 64.0;
/// The directions r of (1).
const TRIES: u64 = 3;
/// A guard further from its value than this part of what (1) makes of it beside the joints is not at its value.
const AT_VALUE: f64 = 1e-3;

impl<T: Float> ModelRun<T> {
    /// Finds the guards that the joints hold from here on. What is held no more is on the side that the motion takes it to.
    pub(crate) fn find_held_guards(&mut self) -> Result<(), StepError> {
        if !self.margins.declares() || !self.system.projection.any() {
            return Ok(());
        }
        let counters = self.system.counters;
        let state = self.state.clone();
        let here = self.guards_at(self.time, &state).unwrap_or_default();
        let found = self.held_guards(&here);
        self.system.counters = counters;
        let mut released = Vec::new();
        for ((index, at), rounding) in found {
            if rounding.is_none() && self.margins.is_held(index) {
                released.push(index);
                let guard = here.get(at).copied().unwrap_or(0.0);
                self.margins.release(index, (self.time, guard));
            } else {
                self.margins.hold(index, rounding);
            }
        }
        if !released.is_empty() {
            self.settle_sides(&|index| released.contains(&index))?;
            let epsilon = T::EPSILON.to_f64();
            for index in released {
                // What (1) makes of a guard is δ of its size.
                self.margins
                    .clear_noise(index, NOISE * epsilon.powf(5.0 / 12.0));
            }
        }
        self.resume_margins()
    }

    /// Per declared event, by its margin and its place among the guards, whether (2) holds, and what of its guard is rounding then.
    fn held_guards(&mut self, here: &[f64]) -> Vec<((usize, usize), Option<f64>)> {
        let declared: Vec<(usize, usize)> = self.margins.declared().collect();
        let epsilon = T::EPSILON.to_f64();
        let mut held: Vec<Option<f64>> = vec![Some(f64::INFINITY); declared.len()];
        for number in 0..TRIES {
            let (time, beside) = self.beside(number, epsilon.powf(0.25));
            let raw = self.guards_at(time, &beside).unwrap_or_default();
            let off = |guards: &[f64], at: usize| Some((guards.get(at)? - here.get(at)?).abs());
            for ((_, at), held) in declared.iter().zip(&mut held) {
                let at_value = |moved: &f64| {
                    let guard = here.get(*at);
                    guard.is_some_and(|guard| guard.abs() <= AT_VALUE * moved)
                };
                let rounding = off(&raw, *at)
                    .filter(at_value)
                    .map(|moved| epsilon.cbrt() * moved);
                *held = held.zip(rounding).map(|(known, new)| known.min(new));
            }
            if held.iter().all(Option::is_none) {
                break;
            }
            let mut on_joints = beside;
            let own = on_joints.get_mut(..self.system.nx).unwrap_or_default();
            let put = self.system.put_on_joints(time, own);
            let put = put.ok().and_then(|()| self.guards_at(time, &on_joints));
            let put = put.unwrap_or_default();
            for ((_, at), held) in declared.iter().zip(&mut held) {
                let moved = off(&put, *at);
                *held = held.filter(|rounding| moved.is_some_and(|moved| moved <= *rounding));
            }
        }
        declared.into_iter().zip(held).collect()
    }

    /// t′ and x′ of (1).
    fn beside(&self, number: u64, part: f64) -> (f64, Vec<T>) {
        let model = &*self.system.model;
        let scales = self.options.scales.unwrap_or_else(|| Scales::of(model));
        let layout = model.layout();
        let mut random = SplitMix64(number);
        let mut beside = self.state.clone();
        let mut shake = |at: usize, scale: f64| {
            if let Some(x) = beside.get_mut(at) {
                *x += T::from_f64(part * scale * random.number());
            }
        };
        for moving in moving(layout) {
            let lists = [
                (moving.position, scales.length),
                (moving.attitude, scales.angle),
                (moving.velocity, scales.speed),
                (moving.spin, scales.rate),
            ];
            for (list, scale) in lists {
                list.for_each(|at| shake(at, scale));
            }
        }
        for at in layout.nq + layout.nv..layout.states() {
            shake(at, scales.length);
        }
        for at in layout.states()..layout.nx() {
            let size = self.state.get(at).map_or(0.0, |x| x.to_f64().abs());
            shake(at, if size > 0.0 { size } else { scales.state });
        }
        self.system.normalise(&mut beside);
        (self.time + part * scales.length / scales.speed, beside)
    }

    /// The guards at a state beside the run; `None` where they cannot be evaluated.
    pub(crate) fn guards_at(&mut self, time: f64, state: &[T]) -> Option<Vec<f64>> {
        self.inside.copy_from_slice(state);
        self.read_margins(time, 0.0).ok()?;
        let guards = self.scratch.get(..self.guards)?;
        Some(guards.iter().map(|guard| guard.to_f64()).collect())
    }
}
