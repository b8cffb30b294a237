//! The ladder behind the emitted solver of rows, climbed at step boundaries only and held for a whole step.
//!
//! 1. The rows kept in the declaration, in the emitted elimination.
//! 2. Where other rows leave less than 1e-10 (in f32 5e-3) to the pivot of one of them: rows chosen anew at the start of the step, by what is new in
//!    each, solved without structure; in passing such a state, with the multipliers they tend to there (`beside`). Stages of the step
//!    that are regular again keep the emitted rows, unless one of them fails.
//! 3. Where masses differ so much that the emitted elimination loses digits: the whole matrix with row exchange.
//! 4. Where the rows held for a step fail at a stage inside it: that stage alone with all rows, regularised and refined until nothing is
//!    gained, and only if the equations then hold. The last rung before [`StepError::SingularConstraints`]: near a state where rows lose
//!    rank such a step is of order two.
//!
//! Rows are never chosen again inside a step: order four would drop to two.
//! A step that passes close to a singular state can have a stage there although both its ends are regular. Between rows at an angle α the
//! margin is sin² α, so its root runs straight towards such a state: stages are measured one by one in the steps that could reach it.

use mbd_scene::{Float, PointSlots, Quantity};
use serde::{Deserialize, Serialize};

use crate::dense::Dense;
use crate::error::StepError;
use crate::system::System;

mod beside;
mod weigh;

/// Part left to a pivot below which its row counts as dependent on others; more where the scalar has fewer digits.
const MARGIN: f64 = 1e-10;
/// What rounding ε of a state may cost accelerations in passing a state where rows lose rank, relative. It costs them ε over the margin: closer
/// than that, what they tend to from farther away (`beside`) is better. In f32 that is good to ε^(4/7) = 1e-4; in f64 [`MARGIN`] is wider.
const PASSING: f64 = 2.5e-5;
/// The same where rows stay near such a state and nothing better is known.
const LASTING: f64 = 2e-2;
/// What a solution without all rows may leave of a row, relative, at least.
const LEFT: f64 = 1e-3;
/// What a regularised stage may leave of a row, relative: inside a step rows disagree by the step times the rate of the motion.
const LEFT_INSIDE: f64 = 3e-2;
/// A step is watched at its stages while the root of the margin is less than this many times its change over the step before.
const NEAR: f64 = 2.0;

/// A way to solve the rows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(crate) enum Rung {
    /// As emitted.
    #[default]
    Emitted,
    /// Rows chosen anew.
    Chosen,
    /// The whole matrix.
    Whole,
    /// All rows, regularised: a stage, never a step.
    Proximal,
}

/// What is held for a step.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Held {
    rung: Rung,
    rows: Vec<usize>,
    /// Whether every stage of the step takes these rows: one of them could not be solved otherwise.
    whole_step: bool,
    /// √ of the margin at the start of the step.
    size: f64,
    /// Whether the step may pass a singular state.
    near: bool,
}

/// What a run needs to go on solving its rows as it did.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Footing {
    held: Held,
    base: Rung,
    lasting: bool,
}

/// The ladder of one run.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ladder {
    /// Of the step that is tried.
    now: Held,
    /// Of the step after it.
    next: Held,
    /// Whether the stage to come is the first of the step after.
    at_end: bool,
    /// The rung of a run away from singular states.
    base: Rung,
    /// What the last factor left to its smallest pivot; NaN when there was none since the last step.
    pub margin: f64,
    dense: Dense,
    /// Whether the stage that was evaluated last was solved by `dense`, and whether regularised.
    anew: bool,
    regularised: bool,
    /// Whether rows have lost rank for longer than an instant.
    lasting: bool,
    /// Distance over which a motion changes [m], once it was asked for.
    reach: Option<f64>,
    /// Room for h.
    bias: Vec<f64>,
    /// Room for rows chosen in a projection.
    spare: Vec<usize>,
    /// The worst rung used.
    pub worst: Rung,
    /// Decimal digits that uneven masses cost on the rung of the run.
    pub lost_digits: u64,
}

impl Ladder {
    fn held(&self) -> &Held {
        if self.at_end { &self.next } else { &self.now }
    }

    fn held_mut(&mut self) -> &mut Held {
        if self.at_end {
            &mut self.next
        } else {
            &mut self.now
        }
    }

    /// A trial step begins.
    pub(crate) fn enter(&mut self) {
        self.at_end = false;
    }

    /// The trial step is taken.
    pub(crate) fn commit(&mut self) {
        self.now.clone_from(&self.next);
        self.at_end = false;
    }

    /// What the step to come is solved with.
    pub(crate) fn footing(&self) -> Footing {
        Footing {
            held: self.now.clone(),
            base: self.base,
            lasting: self.lasting,
        }
    }

    /// Takes up what another run held, for the stage at its last step; [`Ladder::commit`] follows.
    pub(crate) fn resume(&mut self, footing: &Footing) {
        self.next.clone_from(&footing.held);
        self.base = footing.base;
        self.lasting = footing.lasting;
        self.at_end = true;
    }
}

impl<T: Float> System<T> {
    /// Whether the last factor of the emitted elimination can be trusted.
    pub(crate) fn is_regular(&self) -> bool {
        self.ladder.margin >= self.trusted_from(self.ladder.lasting)
    }

    /// The margin from which on the emitted elimination is trusted, near a state that is passed or that lasts.
    fn trusted_from(&self, lasting: bool) -> f64 {
        let cost = if lasting { LASTING } else { PASSING };
        MARGIN.max(T::EPSILON.to_f64() / cost)
    }

    /// Rows that were left out have come apart: from here on as many as can be are taken. False if they are already.
    #[cold]
    pub(crate) fn takes_more_rows(&mut self) -> bool {
        let more = !self.ladder.lasting && self.trusted_from(true) < self.trusted_from(false);
        self.ladder.lasting |= more;
        more
    }

    /// Part of a row that is new in rows that are independent.
    pub(crate) fn new_from(&self) -> f64 {
        // Where masses and not a position ask for another rung, a row is left out only if it cannot be told from others.
        let lasting = self.ladder.lasting || self.ladder.base != Rung::Emitted;
        self.trusted_from(lasting).sqrt()
    }

    /// Whether the rung of the run solves without the emitted elimination.
    pub(crate) fn solves_chosen(&self) -> bool {
        self.ladder.base == Rung::Chosen
    }

    /// Takes another rung for the whole run: the rows that were kept are not enough.
    #[cold]
    pub(crate) fn choose_always(&mut self) {
        self.ladder.base = Rung::Chosen;
    }

    /// Decides how the rows of the step that starts at a projected state are solved.
    pub(crate) fn pick(&mut self, time: f64, state: &[T]) {
        let size = self.ladder.margin.max(0.0).sqrt();
        let change = (size - self.ladder.now.size).abs();
        self.ladder.at_end = true;
        self.ladder.next.rung = self.ladder.base;
        self.ladder.next.whole_step = false;
        self.ladder.next.size = size;
        // Also where there was no step before.
        self.ladder.next.near = !matches!(
            size.partial_cmp(&(NEAR * change)),
            Some(std::cmp::Ordering::Greater)
        );
        if self.ladder.margin >= self.trusted_from(false) {
            self.ladder.lasting = false;
        }
        if self.is_regular() && self.ladder.base == Rung::Emitted {
            return;
        }
        self.pick_anew(time, state);
    }

    #[cold]
    fn pick_anew(&mut self, time: f64, state: &[T]) {
        let rung = self.ladder.base.max(Rung::Chosen);
        self.read_dense(time, state);
        let mut rows = std::mem::take(&mut self.ladder.next.rows);
        self.ladder.dense.choose(&mut rows);
        let whole_step = rung == Rung::Whole || self.ladder.base == Rung::Chosen;
        self.ladder.next = Held {
            rung,
            rows,
            whole_step,
            ..self.ladder.next
        };
        self.ladder.worst = self.ladder.worst.max(rung);
        self.counters.rows_chosen = self.counters.rows_chosen.saturating_add(1);
    }

    /// The rows of the step that is tried cannot be solved as they are: chooses them anew at its start. False if that was done before.
    #[cold]
    pub(crate) fn climb(&mut self, time: f64, state: &[T]) -> bool {
        if self.ladder.now.rung != Rung::Emitted || self.model.layout().nc == 0 {
            return false;
        }
        let state = state.get(..self.nx).unwrap_or_default();
        self.pick_anew(time, state);
        self.ladder.next.whole_step = true;
        self.ladder.commit();
        true
    }

    /// Overwrites the accelerations of a stage where the rung of its step is not the emitted one.
    ///
    /// # Errors
    /// [`StepError::SingularConstraints`] where this rung cannot solve the stage.
    pub(crate) fn accelerate(
        &mut self,
        time: f64,
        state: &[T],
        rates: &mut [T],
    ) -> Result<(), StepError> {
        (self.ladder.anew, self.ladder.regularised) = (false, false);
        let held = self.ladder.held();
        match held.rung {
            Rung::Emitted if self.ladder.at_end || !held.near => Ok(()),
            Rung::Emitted => self.check_stage(time, state),
            _ => self.accelerate_anew(time, state, rates),
        }
    }

    /// Refuses a stage of an emitted step at which rows lose rank.
    #[cold]
    fn check_stage(&mut self, time: f64, state: &[T]) -> Result<(), StepError> {
        if !self.projection.any() {
            return Ok(());
        }
        self.ladder.margin = f64::NAN;
        self.measure(time, state);
        if self.is_regular() || self.ladder.margin.is_nan() {
            return Ok(());
        }
        Err(self.singular(time, state))
    }

    #[cold]
    fn accelerate_anew(
        &mut self,
        time: f64,
        state: &[T],
        rates: &mut [T],
    ) -> Result<(), StepError> {
        if !self.ladder.at_end && !self.ladder.now.whole_step {
            // Only the start of this step is singular; a stage that is not keeps its rows.
            self.ladder.margin = f64::NAN;
            self.measure(time, state);
            if self.is_regular() {
                return Ok(());
            }
        }
        self.read_dense(time, state);
        self.read_right(time, state);
        let Ladder {
            now,
            next,
            at_end,
            dense,
            ..
        } = &mut self.ladder;
        let held = if *at_end { &*next } else { &*now };
        if !dense.are_independent(&held.rows) {
            let left = dense.accelerate_regularised(T::EPSILON.to_f64());
            // A state that is not finite is found by those who read the rates.
            if left > LEFT_INSIDE {
                return Err(self.singular(time, state));
            }
            self.ladder.worst = Rung::Proximal;
            self.ladder.regularised = true;
            self.counters.rows_regularised = self.counters.rows_regularised.saturating_add(1);
        } else if held.rung == Rung::Whole {
            dense.accelerate_whole(&held.rows);
        } else {
            dense.factor(&held.rows);
            dense.accelerate(&held.rows);
            // As many as there ever are: nothing is left open.
            if self.ladder.held().rows.len() < self.model.layout().rank() {
                self.tend(time, state);
            }
            // Speeds that the rows allow at an instant need not belong to any motion; rows left out for what little is new in them disagree.
            if self.ladder.dense.left() > LEFT.max(0.5 * self.trusted_from(false).sqrt()) {
                return Err(self.singular(time, state));
            }
        }
        let rates = rates.iter_mut().skip(self.model.layout().nq);
        for (rate, found) in rates.zip(&self.ladder.dense.force) {
            *rate = T::from_f64(*found);
        }
        self.ladder.anew = true;
        Ok(())
    }

    /// Solves for the move that takes `rows` out, with rows chosen at this state.
    #[cold]
    pub(crate) fn correct_anew(&mut self, time: f64, state: &[T], rows: &[T], moves: &mut [T]) {
        self.read_dense(time, state);
        let Ladder { dense, spare, .. } = &mut self.ladder;
        dense.choose(spare);
        for (to, from) in dense.right.iter_mut().zip(rows) {
            *to = from.to_f64();
        }
        dense.factor(spare);
        dense.correct(spare);
        for (to, from) in moves.iter_mut().zip(&dense.force) {
            *to = T::from_f64(*from);
        }
    }

    /// Reads M and Φ_v.
    fn read_dense(&mut self, time: f64, state: &[T]) {
        let model = self.model.clone();
        let layout = model.layout();
        let new_from = self.new_from();
        if self.ladder.dense.mass.is_empty() {
            self.ladder.dense = Dense::new(layout.nv, layout.nc, new_from);
            self.ladder.bias = vec![0.0; layout.nv];
        }
        let mut dense = std::mem::take(&mut self.ladder.dense);
        dense.new_from = new_from;
        self.by_laws(Quantity::MassMatrix, time, state, &mut dense.mass);
        let jacobian = &mut dense.jacobian;
        self.by_laws(Quantity::ConstraintJacobian, time, state, jacobian);
        let directions = layout.directions;
        for slots in &layout.bodies {
            dense.weigh(slots.v, directions.speeds());
        }
        for slots in &layout.points {
            if let PointSlots::Mass(slots) = slots {
                dense.weigh(slots.v, directions.moves().len());
            }
        }
        self.ladder.dense = dense;
    }

    /// Reads γ and f − h.
    fn read_right(&mut self, time: f64, state: &[T]) {
        let mut dense = std::mem::take(&mut self.ladder.dense);
        self.by_laws(Quantity::ConstraintBias, time, state, &mut dense.right);
        self.by_laws(Quantity::Forces, time, state, &mut dense.force);
        let mut bias = std::mem::take(&mut self.ladder.bias);
        self.by_laws(Quantity::BiasForce, time, state, &mut bias);
        for (force, bias) in dense.force.iter_mut().zip(&bias) {
            *force -= bias;
        }
        self.ladder.bias = bias;
        self.ladder.dense = dense;
    }
}
