//! A fixed step that is too large is silent: the tension clamp turns instability into bounded chatter with worthless forces.
//!
//! The stages of RK4 show step times largest rate, hρ = 2 |k₃ − k₂| / |k₂ − k₁|. Five of the last fifty steps above 2.5 stop the run: the method is
//! stable up to about 2.8. The norm is that of the energy, |k|² = v̇ᵀ diag(M) v̇ + ω² q̇ᵀ diag(M) q̇, ω² = the largest ΣK/m of a body or point over its
//! lines and joint coordinates (K/I for angles), at least 1/h²: in it the exchange of kinetic and elastic energy is a rotation, and the ratio is
//! bounded by the rates of the scene. Rejected: the plain sum of squares (a step whose stages differ mostly in velocity shows h K/m instead of
//! h √(K/m)), ω² without M (a turning body with a long lever shows the lever), and a floor for ω that has a unit. Stages that agree to 1e-3 of k₁ say
//! nothing: on a smooth motion k₂ − k₁ can vanish in the slow directions and leave any ratio, while an unstable run soon has differences as large as
//! the rates themselves.
//!
//! Rattle shows how forces change along the motion of the last part of a step, hρ = h √(|ΔK|/|Δx|) in the norm of M, and is stable up to 3.0.
//!
//! What stays below this limit may still lose or make energy, and what is far above flies apart within a step or two: both show in the
//! [balance](crate::balance) of energy.

use std::fmt;
use std::sync::Arc;

use mbd_scene::laws::Numbers;
use mbd_scene::{Float, Model};
use serde::{Deserialize, Serialize};

use crate::moving::{Moving, moving};
use crate::stiffness::Stiffness;
use crate::turns;

/// What hρ may not exceed often.
pub(crate) const LIMIT: f64 = 2.5;
/// Differences of stages below this part of k₁ are not looked at.
pub(crate) const NEGLIGIBLE: f64 = 1e-3;
/// The part of the energy that moved that a fixed-step run may make or lose.
pub(crate) const ENERGY: f64 = 0.02;
/// For how many steps in a row it must be. From rest energy grows like a power of time, and the first step has an error like its whole: the
/// balance of a run that is right holds after the next.
const PERSISTS: u64 = 3;
/// The part of what is allowed at which a state is still good: nothing has grown.
const GOOD: f64 = 0.1;
/// How many steps are remembered, and how many of them may exceed the limit.
const WINDOW: u32 = 50;
const ALLOWED: u32 = 5;

/// The last fifty steps of a fixed-step run, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Watch {
    above: u64,
    /// hρ of the last step above the limit.
    last: f64,
    /// After how many steps in a row the energy was out of balance.
    over: u64,
    /// How many steps were recorded.
    #[serde(default)]
    seen: u64,
}

impl Watch {
    /// Records one step; true when the run is unstable.
    pub(crate) fn sees(&mut self, stiffness: f64) -> bool {
        let kept = (1_u64 << WINDOW) - 1;
        let is_above = stiffness > LIMIT;
        self.above = ((self.above << 1) | u64::from(is_above)) & kept;
        self.seen = self.seen.saturating_add(1);
        if is_above {
            self.last = stiffness;
        }
        // Almost no window has any.
        self.above != 0 && self.above.count_ones() >= ALLOWED
    }

    /// What grows where a step cannot even be made: energy, or else stages; `None` where nothing does.
    pub(crate) fn sees_growth(&self, excess: f64) -> Option<Instability> {
        match self.is_calm(excess) {
            true => None,
            false if self.above == 0 || excess.abs() > GOOD * ENERGY => {
                Some(Instability::Energy(excess))
            }
            false => Some(Instability::Stages(self.last)),
        }
    }

    /// What the stages of more than one step show: what jumps inside a step shows in that one alone, and is no growth.
    pub(crate) fn sees_stages(&self) -> Option<Instability> {
        (self.above.count_ones() > 1).then_some(Instability::Stages(self.last))
    }

    /// Whether nothing grows: no step of the window was above the limit, and the balance of energy, if there is one, holds to a tenth of
    /// what is allowed.
    pub(crate) fn is_calm(&self, excess: f64) -> bool {
        self.above == 0 && excess.abs() <= GOOD * ENERGY
    }

    /// What a run has shown that ends before anything could persist: a step was above the limit, all of them where there are more than a few, and
    /// the energy at its end is out of balance.
    pub(crate) fn sees_end(&self, excess: f64) -> Option<Instability> {
        let above = u64::from(self.above.count_ones());
        let is_long = above > 0 && (self.seen < PERSISTS || above == self.seen);
        let is_over = excess.is_nan() || excess.abs() > ENERGY;
        (is_long && is_over).then_some(Instability::Stages(self.last))
    }

    /// Records the balance of energy, `steps` after the last look at it; true when the run made or lost too much, and goes on to.
    pub(crate) fn sees_energy(&mut self, excess: f64, steps: u64) -> bool {
        let is_over = excess.is_nan() || excess.abs() > ENERGY;
        self.over = if is_over {
            self.over.saturating_add(steps)
        } else {
            0
        };
        self.over >= PERSISTS || !excess.is_finite()
    }
}

/// What a step that is too long shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Instability {
    /// Stages that grow: step times the largest rate of the scene; RK4 is stable below about 2.8, Rattle below 3.0.
    Stages(f64),
    /// Energy from nothing (positive) or lost (negative), over the energy that moved.
    Energy(f64),
    /// An angle whose turns are counted sweeps over this much in the step, by its rates at the ends [rad]: beyond half a turn nothing tells which turn
    /// it is.
    Turn(f64),
}

impl Instability {
    /// That of a step times the largest rate of a scene, if it is too long.
    pub(crate) fn beyond(rho: f64) -> Option<Self> {
        (rho > LIMIT).then_some(Instability::Stages(rho))
    }

    /// The least part of what follows a number of the state that rounding of it makes where this is its doing: as much as of an energy, or a tenth of the energy
    /// that comes or goes, of which other work is the most.
    pub(crate) fn least_rounding(self) -> f64 {
        match self {
            Instability::Stages(_) => ENERGY,
            Instability::Energy(part) => (0.1 * part.abs()).max(ENERGY),
            Instability::Turn(_) => f64::INFINITY,
        }
    }

    /// A step that should do in place of this one: hρ = 2, with the rate taken no smaller than the limit implies; or energy kept to a tenth of what is
    /// allowed, with an error of the energy that grows like h⁴; or angles that sweep over what they may in adaptive steps.
    pub(crate) fn suggestion(self, step: f64) -> f64 {
        match self {
            Instability::Stages(rho) => step * 2.0 / rho.max(LIMIT),
            Instability::Energy(part) => {
                let finer = (0.1 * ENERGY / part.abs()).powf(0.25);
                step * finer.clamp(1.0 / 16.0, 0.5)
            }
            Instability::Turn(swept) => step * turns::MOST / swept,
        }
    }
}

impl fmt::Display for Instability {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Instability::Stages(rho) => write!(f, "step times rate is {rho:.2}"),
            Instability::Turn(swept) => write!(
                f,
                "an angle turns by {swept:.2} rad in it, and beyond half a turn nothing tells which turn it is"
            ),
            Instability::Energy(part) if !part.is_finite() => {
                write!(f, "it makes energy without bound")
            }
            Instability::Energy(part) => write!(
                f,
                "it {} {:.2} % of the energy that moves",
                if part > 0.0 { "makes" } else { "loses" },
                100.0 * part.abs()
            ),
        }
    }
}

/// The weights of the norm above for steps of a size [s], one a coordinate of the state, from the diagonal of the mass matrix.
pub(crate) fn weights<T: Float>(
    (model, numbers): (&dyn Model<T>, Arc<Numbers<f64>>),
    masses: &[f64],
    step: f64,
) -> Vec<T> {
    let layout = model.layout();
    let mass = |v: usize| masses.get(v).copied().unwrap_or(0.0);
    // Its inertia, the mean of its moments; in a plane there is one.
    let inertia_of = |part: &Moving| {
        let own = part.speeds().skip(part.velocity.len());
        own.map(mass).sum::<f64>() / part.spin.len() as f64
    };
    let stiffness = Stiffness::new(model, numbers);
    let mut frequency = step.powi(-2);
    let mut lightest = f64::INFINITY;
    for owner in moving(layout) {
        let slides = !owner.velocity.is_empty();
        let mass = if slides { mass(owner.speed) } else { 0.0 };
        let inertia = inertia_of(&owner);
        let rates = [
            stiffness.moving(&owner, false) / mass,
            stiffness.turning(&owner, false) / inertia,
        ];
        let fastest = rates.into_iter().filter(|rate| rate.is_finite());
        frequency = fastest.fold(frequency, f64::max);
        if slides {
            lightest = lightest.min(mass);
        }
    }
    let mut weights = vec![T::zero(); layout.nx()];
    let mut set = |at: usize, value: f64| {
        if let Some(weight) = weights.get_mut(at) {
            *weight = T::from_f64(value);
        }
    };
    (0..layout.nv).for_each(|v| set(layout.nq + v, mass(v)));
    for owner in moving(layout) {
        for (at, speed) in owner.position.clone().zip(owner.speeds()) {
            set(at, frequency * mass(speed));
        }
        // A turn by the angle a moves the quaternion by a/2.
        let square = if owner.has_quaternion() { 4.0 } else { 1.0 };
        let weight = square * frequency * inertia_of(&owner);
        owner.attitude.clone().for_each(|at| set(at, weight));
    }
    let massless = if lightest.is_finite() { lightest } else { 1.0 };
    (0..layout.nz).for_each(|z| set(layout.nq + layout.nv + z, frequency * massless));
    weights
}
