//! A step that ends on declared events is made of what holds before them.
//!
//! What jumps where an event is, a load `if(x < 0 m, 2 N, -1 N)` beside `x crosses 0 m`, has its value from behind the event at those stages that come to the end
//! of the step: their states are off by the error of the stage, and the end lies a rounding behind. One such stage makes the step one of order one. It is evaluated
//! as much earlier as it is behind,
//!
//! ```text
//! ẋ(t − τ, x − τ ẋ),   τ the shortest that is before every event,                                                (1)
//! ```
//!
//! which changes the stage by as much as it is off, and by no jump. Time itself is known exactly: no stage sees a later one than just before the end.
//! Derived.

use mbd_scene::{Float, Formula, Model, Quantity, Scene};

use super::System;
use crate::error::StepError;
use crate::integrate::Rates;

/// Where the rate of a guard is measured, in parts of the time since the start of the step, or further where numbers have fewer digits; and how much further than it
/// says a stage is moved.
const PROBE: f64 = 1e-6;
const BEYOND: f64 = 1.01;
/// By how much the next look is further, where the last one moved nothing.
const GROWTH: f64 = 4.0;
/// Most looks for τ, and the largest part of the time since the start of the step that it may be: what is further behind is not behind by an error.
const MOST_LOOKS: u32 = 12;
const LARGEST: f64 = 0.5;

/// The side on which a guard was at the start of a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GuardSide {
    /// Its place among the guards.
    pub at: usize,
    /// What counts as zero.
    pub value: f64,
    /// Whether it was positive.
    pub positive: bool,
}

/// The sides of all declared events, for scenes in which something may jump.
#[derive(Clone, Debug)]
pub(crate) struct NearSide<T> {
    /// Whether what may jump acts, and is not only told.
    acts: bool,
    sides: Vec<GuardSide>,
    guards: Vec<T>,
    rates: Vec<T>,
    state: Vec<T>,
}

impl<T: Float> NearSide<T> {
    /// Room for a model; `None` where nothing jumps, or no event says where.
    pub(crate) fn new(model: &dyn Model<T>) -> Option<Box<Self>> {
        let (scene, layout) = (model.scene(), model.layout());
        let acts = scene.acting_formulas().any(|it| jumps(scene, it));
        let outputs = || scene.outputs.iter().map(|output| &output.value);
        let told = acts || outputs().any(|it| jumps(scene, it));
        (told && !scene.events.is_empty()).then(|| {
            let room = |length| vec![T::zero(); length];
            Box::new(NearSide {
                acts,
                sides: Vec::with_capacity(scene.events.len()),
                guards: room(layout.len(Quantity::Guards)),
                rates: room(layout.nx()),
                state: room(layout.nx()),
            })
        })
    }

    /// The guard that is furthest behind its side, and by how much: positive where it is.
    fn behind(&self) -> Option<(GuardSide, f64)> {
        let all = self.sides.iter().filter_map(|side| {
            let guard = self.guards.get(side.at)?.to_f64() - side.value;
            // At its value a guard is on no side: what jumps there may have jumped.
            let is_behind = guard == 0.0 || (guard > 0.0) != side.positive;
            is_behind.then_some((*side, guard.abs()))
        });
        all.max_by(|(_, a), (_, b)| a.total_cmp(b))
    }

    /// A guard, as far as it is behind its side; negative where it is not.
    fn guard(&self, side: GuardSide) -> f64 {
        let guard = self.guards.get(side.at).map_or(f64::NAN, |x| x.to_f64()) - side.value;
        if side.positive { -guard } else { guard }
    }
}

/// Whether a formula chooses between values.
fn jumps(scene: &Scene, formula: &Formula) -> bool {
    use mbd_scene::Function::{Floor, IfAtMost, IfLess};
    scene.contains(formula, |part| {
        matches!(part, Formula::Apply(Floor | IfAtMost | IfLess, _))
    })
}

impl<T: Float> System<T> {
    /// Whether something that acts may jump where an event is.
    #[inline]
    pub(crate) fn may_jump(&self) -> bool {
        self.near.as_ref().is_some_and(|near| near.acts)
    }

    /// From here on stages see nothing of what is behind `latest` [s], nor of what is behind the sides of these guards.
    pub(crate) fn see_before(&mut self, latest: f64, sides: impl Iterator<Item = GuardSide>) {
        self.latest = latest;
        if let Some(near) = &mut self.near {
            near.sides.clear();
            near.sides.extend(sides);
        }
    }

    /// Stages see everything.
    #[inline]
    pub(crate) fn see_all(&mut self) {
        self.latest = f64::INFINITY;
        if let Some(near) = &mut self.near {
            near.sides.clear();
        }
    }

    /// Whether stages see nothing of what is behind the end of the step.
    pub(crate) fn sees_before(&self) -> bool {
        self.latest < f64::INFINITY
    }

    /// Evaluates a stage again that is behind an event, by (1).
    pub(super) fn keep_before(
        &mut self,
        time: f64,
        span: f64,
        state: &[T],
        out: &mut [T],
    ) -> Result<(), StepError> {
        let Some(mut near) = self.near.take_if(|near| !near.sides.is_empty()) else {
            return Ok(());
        };
        for (own, rate) in near.rates.iter_mut().zip(out.iter()) {
            *own = *rate;
        }
        let earlier = self.earlier(&mut near, [time, span], state);
        let found = match earlier {
            Some(earlier) => self.rates(time - earlier, span - earlier, &near.state, out),
            None => Ok(()),
        };
        self.near = Some(near);
        found
    }

    /// Moves the end of a step that ends on events in front of them, along the way from its start; the time there.
    pub(crate) fn end_before(&mut self, [time, step]: [f64; 2], start: &[T], end: &mut [T]) -> f64 {
        let limit = time.min(self.latest);
        let Some(mut near) = self.near.take_if(|near| !near.sides.is_empty()) else {
            return limit;
        };
        let per_second = T::from_f64(1.0 / step);
        for ((own, to), from) in near.rates.iter_mut().zip(end.iter()).zip(start) {
            *own = (*to - *from) * per_second;
        }
        let earlier = self.earlier(&mut near, [time, step], end);
        if earlier.is_some() {
            for (x, before) in end.iter_mut().zip(&near.state) {
                *x = *before;
            }
        }
        self.near = Some(near);
        limit.min(time - earlier.unwrap_or(0.0))
    }

    /// τ of (1) for the rates in `near`, with the state there in it; `None` where nothing is behind, or too far.
    fn earlier(
        &mut self,
        near: &mut NearSide<T>,
        [time, span]: [f64; 2],
        state: &[T],
    ) -> Option<f64> {
        self.guards_at(near, time, state, 0.0);
        let (mut side, mut behind) = near.behind()?;
        let mut earlier = 0.0;
        let mut probe = PROBE.max(T::EPSILON.to_f64().sqrt()) * span;
        // What a guard says of far places moves in steps of their numbers: less than one of them moves nothing.
        let mut least = 4.0 * f64::EPSILON * (time.abs() + span) + T::EPSILON.to_f64() * span;
        for _ in 0..MOST_LOOKS {
            self.guards_at(near, time, state, earlier + probe);
            while near.guard(side) == behind && probe < LARGEST * span {
                probe *= GROWTH;
                self.guards_at(near, time, state, earlier + probe);
            }
            let slope = (behind - near.guard(side)) / probe;
            if slope.is_nan() || slope <= 0.0 {
                return None;
            }
            earlier += BEYOND * behind / slope + least;
            least *= GROWTH;
            if earlier > LARGEST * span {
                return None;
            }
            self.guards_at(near, time, state, earlier);
            match near.behind() {
                None => return Some(earlier),
                Some(next) => (side, behind) = next,
            }
        }
        None
    }

    /// The guards at x − τ ẋ.
    fn guards_at(&mut self, near: &mut NearSide<T>, time: f64, state: &[T], earlier: f64) {
        let back = T::from_f64(earlier);
        for ((x, from), rate) in near.state.iter_mut().zip(state).zip(&near.rates) {
            *x = *from - back * *rate;
        }
        let at = self
            .nodes
            .at(T::from_f64(time - earlier), &near.state, &self.inputs);
        self.model
            .evaluate(Quantity::Guards, &at, &mut self.work, &mut near.guards);
    }
}
