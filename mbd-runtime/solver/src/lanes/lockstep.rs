//! RK4 for several cases in lock-step: one step of all of them is one step of lanes.

use std::convert::Infallible;

use mbd_scene::{At, Layout, Quantity};

use super::{Equations, Lanes};
use crate::error::StepError;
use crate::integrate::{Explicit, RK4};
use crate::trajectory::resolution;

/// Several cases of one model, a case a lane, with the same fixed step of RK4: each lane is what a run with
/// [`Options::rk4`](crate::Options::rk4) gives, to the bit.
///
/// For scenes in which nothing happens and nothing is solved: no rows of joints (open trees in relative coordinates have none; a lane in which they cannot be
/// solved as emitted has no run here that solves them otherwise), no equilibrium points,
/// no lines and stops that may let go (springs do not), no events. A run ends a step where what acts jumps at a time known beforehand, `if(time < 3 s, …)`; steps of lanes, whose params may
/// say other times, do not. A lane that stops being finite disturbs no other.
///
/// ```
/// use mbd_runtime::{Lanes, Lanes8, LockStep, Model, model};
///
/// model! {
///     /// A stone that falls in air.
///     model Stone<T> {
///         gravity: [0.0, 0.0, -9.81] m/s^2;
///         param mass = 1.0 kg in 0.1 kg ..= 10.0 kg;
///         point stone { mass: mass }
///         load air on stone = -0.02 kg/m * norm(stone.velocity) * stone.velocity;
///     }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let masses = Lanes8::each(|lane| 0.5 + 0.5 * lane as f64);
/// let stones = Stone::unchecked(StoneParams { mass: masses });
/// let layout = Stone::<f64>::new(StoneParams::default())?.layout().clone();
/// let start = StoneState::<Lanes8>::at_origin().to_vec();
/// let mut run = LockStep::of_model(stones, &layout, 0.01, start)?;
/// run.run(2.0)?;
/// // The heavier falls faster.
/// let speed = run.state()[5];
/// assert!((1..8).all(|lane| speed.lane(lane) < speed.lane(lane - 1)));
/// # Ok(())
/// # }
/// ```
pub struct LockStep<L, F> {
    rates: F,
    quaternions: Vec<usize>,
    step: f64,
    time: f64,
    /// Steps count from here.
    origin: f64,
    count: u64,
    state: Vec<L>,
    method: Explicit<L>,
}

impl<L: Lanes> LockStep<L, ()> {
    /// Steps [s] of a generated model over lanes from a state at time zero, on one list that all evaluations share.
    ///
    /// # Errors
    /// Those of [`LockStep::new`]; a layout of another model; a model with inputs, which a closure can give.
    #[allow(
        clippy::type_complexity,
        reason = "a closure without a name, which no alias can stand for"
    )]
    pub fn of_model<E: Equations<L>>(
        model: E,
        layout: &Layout,
        step: f64,
        start: Vec<L>,
    ) -> Result<LockStep<L, impl FnMut(f64, &[L], &mut [L])>, StepError> {
        if layout != E::layout() {
            return Err(StepError::Unsupported {
                what: "a run in lock-step with the layout of another model".into(),
                instead:
                    "give it that of the model over one scalar: `Stone::<f64>::new(…)?.layout()`"
                        .into(),
            });
        }
        if layout.ni > 0 {
            return Err(StepError::Unsupported {
                what: "a run in lock-step of a model with inputs".into(),
                instead: "write its rates yourself, with the inputs: `LockStep::new`".into(),
            });
        }
        let mut work = vec![L::zero(); model.room()];
        LockStep::new(layout, step, start, move |time, state, rates| {
            let at = At::of_state(L::from_f64(time), state, &[]);
            model.evaluate(Quantity::Derivative, &at, &mut work, rates);
        })
    }
}

impl<L: Lanes, F: FnMut(f64, &[L], &mut [L])> LockStep<L, F> {
    /// Steps [s] from a state at time zero; `rates` writes ẋ at a time [s] and a state.
    ///
    /// # Errors
    /// A step that is not positive; a state of another length, or with a quaternion that is none; a scene in which something happens or is solved.
    pub fn new(layout: &Layout, step: f64, start: Vec<L>, rates: F) -> Result<Self, StepError> {
        if !(step > 0.0 && step.is_finite()) {
            let slot = "step".into();
            return Err(StepError::InvalidInput { slot, value: step });
        }
        let length = layout.nx();
        if start.len() != length {
            return Err(StepError::length("state", start.len(), length));
        }
        if let Some(what) = happens(layout) {
            return Err(StepError::Unsupported {
                what: format!("a run in lock-step of a scene with {what}"),
                instead: "run its cases one by one: `Batch`".into(),
            });
        }
        let (mut start, quaternions) = (start, layout.quaternions().collect::<Vec<_>>());
        // As at the start of a run; a lane that is no number disturbs no other.
        let drift = normalise(&quaternions, &mut start);
        let refused = drift
            .numbers()
            .iter()
            .find_map(|drift| StepError::quaternion(*drift));
        if let Some(refused) = refused {
            return Err(refused);
        }
        let mut this = LockStep {
            rates,
            quaternions,
            step,
            time: 0.0,
            origin: 0.0,
            count: 0,
            method: Explicit::new(&RK4, length),
            state: start,
        };
        (this.rates)(0.0, &this.state, this.method.first_mut());
        Ok(this)
    }

    /// Time [s].
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }

    /// The states of all lanes, x = [q | v | z | s].
    #[must_use]
    pub fn state(&self) -> &[L] {
        &self.state
    }

    /// Whether the state of a lane is finite.
    #[must_use]
    pub fn is_finite(&self, lane: usize) -> bool {
        self.state.iter().all(|x| x.lane(lane).is_finite())
    }

    /// Steps until a time [s]; the last step is shorter where it would go beyond.
    ///
    /// # Errors
    /// A time that is not finite, or lies behind; the state stays.
    pub fn run(&mut self, until: f64) -> Result<(), StepError> {
        if !until.is_finite() {
            let slot = "end time".into();
            return Err(StepError::InvalidInput { slot, value: until });
        }
        if until < self.time - resolution(self.time) {
            let now = self.time;
            return Err(StepError::Backwards { now, until });
        }
        while until - self.time > resolution(self.time) {
            let left = until - self.time;
            if self.step >= left * (1.0 - 1e-9) {
                self.advance(left);
                (self.time, self.origin, self.count) = (until, until, 0);
            } else {
                self.step();
            }
        }
        Ok(())
    }

    /// One step of all lanes.
    pub fn step(&mut self) {
        self.advance(self.step);
        self.count += 1;
        // A product, so that rounding does not accumulate.
        self.time = self.origin + self.count as f64 * self.step;
    }

    fn advance(&mut self, step: f64) {
        let (rates, quaternions) = (&mut self.rates, &self.quaternions);
        let each = |last, [time, _]: [f64; 2], trial: &mut [L], stage: &mut [L]| {
            if last {
                normalise(quaternions, trial);
            }
            rates(time, trial, stage);
            Ok::<(), Infallible>(())
        };
        let (method, h) = (&mut self.method, L::from_f64(step));
        let Ok(()) = method.stages([self.time, step], h, &self.state, each);
        method.accept(&mut self.state);
    }
}

/// What happens in a scene or is solved in it, if anything, in words.
fn happens(layout: &Layout) -> Option<&'static str> {
    let all = [
        (layout.nc > 0, "joints with rows"),
        (!layout.nodes.is_empty(), "equilibrium points"),
        (layout.events > 0, "events"),
        (!layout.stops.is_empty(), "stops"),
        (
            layout.lines.iter().any(|line| line.slackens),
            "lines, which may slacken",
        ),
        (
            layout.lines.iter().any(|line| line.detached),
            "springs that are detached",
        ),
    ];
    let mut all = all.into_iter();
    all.find_map(|(is, what)| is.then_some(what))
}

/// Makes every quaternion a unit quaternion, and tells the largest | |q| − 1 | there was; one that is zero or not finite stays.
pub(super) fn normalise<L: Lanes>(quaternions: &[usize], state: &mut [L]) -> L {
    let mut drift = L::zero();
    for &at in quaternions {
        let Some(quaternion) = state.get_mut(at..at + 4) else {
            continue;
        };
        let square = quaternion.iter().fold(L::zero(), |sum, x| sum + *x * *x);
        let norm = square.sqrt();
        drift = drift.max((norm - L::one()).abs());
        let usable = L::both(L::zero().lt(norm), norm.le(L::from_f64(f64::MAX)));
        let inverse = L::one() / norm;
        for x in quaternion {
            *x = L::select(usable, *x * inverse, *x);
        }
    }
    drift
}
