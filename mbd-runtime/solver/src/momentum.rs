//! The balance of momentum of a run that the ground does not hold: what its steps make or lose that neither gravity nor loads gave.
//!
//! ```text
//! imbalance = P(t) − P(0) − ∫ F dt,    L(t) − L(0) − ∫ τ dt          F, τ of gravity and loads alone, τ and L about the world origin      (1)
//! ```
//!
//! is zero for the exact motion: forces between the parts of a scene, in lines and joints, change neither. ∫ of a step is that of three points of Gauss
//! inside it, exact for polynomials of degree five, at the states that the method's interpolant has there. Source: derived. Rejected: the cubic
//! through step ends that the [balance of energy](crate::balance) takes, which says nothing of the long steps of an adaptive method.

use mbd_scene::Float;
use serde::{Deserialize, Serialize};

use crate::simulation::ModelRun;
use crate::system::System;

/// Places inside a step and their weights.
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// What of a number rounding may leave, in units of the precision.
const ROUNDING: f64 = 64.0;

/// What a run made or lost of momentum without a cause.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MomentumImbalance {
    /// The largest component of |P − P(0) − ∫ F dt| at a step end [kg m/s].
    pub linear: f64,
    /// The largest component of |L − L(0) − ∫ τ dt| at a step end, about the world origin [kg m²/s].
    pub angular: f64,
    /// The momentum that moved, the largest Σ |m v| [kg m/s].
    pub linear_moved: f64,
    /// The same about the world origin, the largest Σ |r| |m v| + |I ω| [kg m²/s].
    pub angular_moved: f64,
    /// What of both rounding and the tolerance of the run explain, by the impulses of gravity and loads and what moved.
    pub explained: [f64; 2],
}

impl MomentumImbalance {
    /// The larger of both imbalances over what moved of their kind, without what rounding and the tolerance explain; zero where nothing moved.
    #[must_use]
    pub fn relative(&self) -> f64 {
        let [linear, angular] = self.explained;
        let share = |part: f64, explained: f64, of: f64| match of > 0.0
            && (part.is_nan() || part > explained)
        {
            true => (part - explained) / of,
            false => 0.0,
        };
        let angular = share(self.angular, angular, self.angular_moved);
        let linear = share(self.linear, linear, self.linear_moved);
        if linear >= angular { linear } else { angular }
    }
}

/// Momentum of a scene and what gives it some, at an instant.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Impulses {
    /// P and L.
    momentum: [f64; 6],
    /// F and τ.
    external: [f64; 6],
    /// Σ |m v| and Σ |r| |m v| + |I ω|.
    sizes: [f64; 2],
    /// Σ |F| and Σ |r| |F| + |τ|.
    forces: [f64; 2],
}

/// (1) so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct MomentumBalance {
    last: [f64; 6],
    surplus: [f64; 6],
    pub(crate) so_far: MomentumImbalance,
}

impl MomentumBalance {
    /// Begins at an instant.
    fn new(start: &Impulses) -> Self {
        let mut balance = MomentumBalance {
            last: start.momentum,
            ..MomentumBalance::default()
        };
        balance.widen(start);
        balance
    }

    /// Goes on after momentum jumped by declaration: what jumped is neither made nor lost.
    fn take_up(&mut self, now: &Impulses) {
        self.last = now.momentum;
        self.widen(now);
    }

    /// Takes a step that ended with `now` and in which gravity and loads gave `impulse`, and their sizes did; `share`: what tolerance and rounding
    /// make of a number.
    fn take(&mut self, (impulse, sizes): ([f64; 6], [f64; 2]), now: &Impulses, share: f64) {
        for (explained, (impulse, moved)) in self
            .so_far
            .explained
            .iter_mut()
            .zip(sizes.iter().zip(now.sizes))
        {
            *explained += share * impulse + f64::EPSILON * moved;
        }
        for (index, surplus) in self.surplus.iter_mut().enumerate() {
            *surplus += now.momentum[index] - self.last[index] - impulse[index];
        }
        self.last = now.momentum;
        // A number that is none is the largest of all.
        let size = |x: &f64| if x.is_nan() { f64::INFINITY } else { x.abs() };
        let largest = |list: &[f64]| list.iter().map(size).fold(0.0, f64::max);
        let (linear, angular) = self.surplus.split_at(3);
        self.so_far.linear = self.so_far.linear.max(largest(linear));
        self.so_far.angular = self.so_far.angular.max(largest(angular));
        self.widen(now);
    }

    fn widen(&mut self, now: &Impulses) {
        let [linear, angular] = now.sizes;
        self.so_far.linear_moved = self.so_far.linear_moved.max(linear);
        self.so_far.angular_moved = self.so_far.angular_moved.max(angular);
    }
}

impl<T: Float> ModelRun<T> {
    /// Begins to follow the momentum of a run, once its first stage is evaluated.
    pub(crate) fn begin_momentum(&mut self) {
        let scene = self.system.model.scene();
        let tells = self.options.momentum && scene.held_by_ground().is_none();
        self.momentum = tells.then(|| {
            let start = self.system.impulses(self.time, &self.state, false);
            MomentumBalance::new(&start)
        });
    }

    /// Takes the attempted step into the balance; it cannot be told any more where the inside of a step has no state.
    pub(crate) fn follow_momentum(&mut self, step: f64) {
        let Some(mut balance) = self.momentum else {
            return;
        };
        let tolerance = self
            .options
            .method
            .tolerance()
            .map_or(0.0, |[rtol, _]| rtol);
        let share = tolerance.max(ROUNDING * T::EPSILON.to_f64());
        self.momentum = self.impulse_of(step).map(|impulse| {
            let end = self.time + step;
            let now = self.system.impulses(end, self.method.next(), false);
            balance.take(impulse, &now, share);
            balance
        });
    }

    /// Takes up the momentum after something jumped by declaration.
    pub(crate) fn rebase_momentum(&mut self) {
        if let Some(mut balance) = self.momentum {
            let now = self.system.impulses(self.time, &self.state, false);
            balance.take_up(&now);
            self.momentum = Some(balance);
        }
    }

    /// ∫ of F and τ over the attempted step, and of their sizes.
    fn impulse_of(&mut self, step: f64) -> Option<([f64; 6], [f64; 2])> {
        let (mut impulse, mut sizes) = ([0.0; 6], [0.0; 2]);
        for (theta, weight) in GAUSS {
            self.inside_state(theta, step).ok()?;
            let span = theta * step;
            let time = self.time + span;
            self.system.look(time, span, &self.inside).ok()?;
            let inside = self.system.impulses(time, &self.inside, true);
            for (sum, rate) in impulse.iter_mut().zip(inside.external) {
                *sum += weight * step * rate;
            }
            for (sum, size) in sizes.iter_mut().zip(inside.forces) {
                *sum += weight * step * size;
            }
        }
        Some((impulse, sizes))
    }
}

impl<T: Float> System<T> {
    /// Momentum and what changes it by the laws, at the stage that was evaluated last or at the state that [`System::look`] saw last.
    fn impulses(&mut self, time: f64, state: &[T], seen: bool) -> Impulses {
        let mut numbers = [0.0; 16];
        self.by_laws_at((time, state), seen, |laws, model, at| {
            laws.run(model, at, |scene, layout, laws, at, scratch| {
                mbd_scene::impulses(scene, layout, laws, at, scratch, &mut numbers);
            });
        });
        let [a, b, c, d, e, f, g, h, i, j, k, l, p, q, forces @ ..] = numbers;
        Impulses {
            momentum: [a, b, c, d, e, f],
            external: [g, h, i, j, k, l],
            sizes: [p, q],
            forces,
        }
    }
}
