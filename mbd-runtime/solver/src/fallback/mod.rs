//! What solves the rows of joints where the emitted elimination cannot: a chain of strategies, chosen at step boundaries and held for a step.
//!
//! 1. `Emitted`: the rows kept in the declaration, in the emitted elimination.
//! 2. `Chosen`: where other rows leave too little to the pivot of one of them, rows chosen anew at the start of the step, by what is new in
//!    each, solved without structure; in passing such a state, with the multipliers at the limit (`limit`). Stages of the step
//!    that are regular again keep the emitted rows, unless one of them fails. Where a step is rejected near such a state, limits are taken
//!    farther from it until it is passed: there the emitted elimination leaves so much of rounding in accelerations that steps of a tight
//!    tolerance see nothing else, and a jump where limits begin, which no step resolves.
//!    Where rows that were left out hold better than those kept, as they repeat them elsewhere, steps take these from farther away on (`outdone`).
//! 3. `Whole`: where masses differ so much that the emitted elimination loses digits, the whole matrix with row exchange.
//! 4. `Regularised`: where the rows held for a step fail at a stage inside it, that stage alone with all rows, regularised and refined until
//!    nothing is gained, and only if the equations then hold. The last strategy before [`StepError::SingularConstraints`]: near a state
//!    where rows lose rank such a step is of order two.
//!
//! Rows are never chosen again inside a step: order four would drop to two.
//! A step that passes close to a singular state can have a stage there although both its ends are regular. Between rows at an angle α the
//! margin is sin² α, so its root runs straight towards such a state: stages are measured one by one in the steps that could reach it.
//!
//! A step on the emitted strategy passes [`System::accelerate`] with one comparison; everything else here is cold.

use mbd_scene::{Float, Quantity, row_sizes};

use self::chain::HeldRows;
pub(crate) use self::chain::{Fallback, RowStrategy, SavedStrategy};
use self::dense::Dense;
pub(crate) use self::dependence::{Dependence, dependent};
pub(crate) use self::limits::NEW;
use self::limits::{LASTING, LEFT, LEFT_INSIDE, MARGIN, NEAR, POWER, WIDE};
use self::outdone::outdone_from;
use crate::error::StepError;
use crate::laws::Laws;
use crate::moving::moving;
use crate::options::Stabilise;
use crate::system::System;

mod chain;
mod chosen;
mod conditioning;
mod dense;
mod dependence;
mod limit;
mod limits;
mod outdone;
mod received;

pub(crate) use received::trusted_in_passing;

/// The margin below which limits are better than the emitted elimination, whatever it was trusted with before a step was rejected.
fn wide<T: Float>() -> f64 {
    (WIDE * T::EPSILON.to_f64().powf(POWER)).powi(2)
}

impl<T: Float> System<T> {
    /// Whether the last factor of the emitted elimination can be trusted.
    pub(crate) fn is_regular(&self) -> bool {
        self.fallback.margin >= self.trusted_from(self.fallback.lasting)
    }

    /// The margin from which on the emitted elimination is trusted, near a state that is passed or that lasts.
    fn trusted_from(&self, lasting: bool) -> f64 {
        let trusted = match lasting {
            true => MARGIN.max(T::EPSILON.to_f64() / LASTING),
            false => trusted_in_passing::<T>(),
        };
        match self.fallback.held() {
            _ if lasting => trusted,
            held if held.outdone => trusted.max(outdone_from::<T>()),
            held if held.wide => trusted.max(wide::<T>()),
            _ => trusted,
        }
    }

    /// Rows that were left out have come apart: from here on as many as can be are taken. False if they are already.
    #[cold]
    pub(crate) fn takes_more_rows(&mut self) -> bool {
        let more = !self.fallback.lasting && self.trusted_from(true) < self.trusted_from(false);
        self.fallback.lasting |= more;
        more
    }

    /// Part of a row that is new in rows that are independent.
    pub(crate) fn new_from(&self) -> f64 {
        // Where masses and not a position ask for another strategy, a row is left out only if it cannot be told from others.
        let lasting = self.fallback.lasting || self.fallback.base == RowStrategy::Whole;
        self.trusted_from(lasting).sqrt()
    }

    /// Whether the strategy of the run solves without the emitted elimination.
    pub(crate) fn solves_chosen(&self) -> bool {
        self.fallback.base == RowStrategy::Chosen
    }

    /// Takes another strategy for the whole run: the rows that were kept are not enough.
    #[cold]
    pub(crate) fn choose_always(&mut self) {
        self.fallback.base = RowStrategy::Chosen;
    }

    /// Decides how the rows of the step that starts at a projected state are solved.
    pub(crate) fn pick(&mut self, time: f64, state: &[T]) {
        if !self.keeps_emitted(time, state) {
            self.pick_anew(time, state);
        }
    }

    /// The same as far as the emitted elimination is kept; whether it is.
    fn keeps_emitted(&mut self, time: f64, state: &[T]) -> bool {
        let size = self.margin_size();
        let change = (size - self.fallback.now.size).abs();
        self.fallback.at_end = true;
        self.fallback.next.strategy = self.fallback.base;
        self.fallback.next.whole_step = false;
        self.fallback.next.size = size;
        self.fallback.next.wide = false;
        if self.fallback.now.wide {
            self.stay_wide(self.fallback.margin, time, state);
        }
        // Also where there was no step before.
        self.fallback.next.near = !matches!(
            size.partial_cmp(&(NEAR * change)),
            Some(std::cmp::Ordering::Greater)
        );
        if self.fallback.margin >= self.trusted_from(false) {
            self.fallback.lasting = false;
        }
        self.is_regular() && self.fallback.base == RowStrategy::Emitted
    }

    #[cold]
    fn pick_anew(&mut self, time: f64, state: &[T]) {
        let strategy = self.fallback.base.max(RowStrategy::Chosen);
        self.read_dense(time, state);
        let mut rows = std::mem::take(&mut self.fallback.next.rows);
        self.fallback.dense.choose(&mut rows);
        self.fallback.most = self.fallback.most.max(rows.len());
        let whole_step = strategy == RowStrategy::Whole
            || self.fallback.base == RowStrategy::Chosen
            || self.fallback.next.outdone;
        self.fallback.next = HeldRows {
            strategy,
            rows,
            whole_step,
            ..self.fallback.next
        };
        self.fallback.worst = self.fallback.worst.max(strategy);
        self.counters.rows_chosen = self.counters.rows_chosen.saturating_add(1);
    }

    /// The rows of the step that is tried cannot be solved as they are: chooses them anew at its start. False if that was done before.
    #[cold]
    pub(crate) fn escalate(&mut self, time: f64, state: &[T]) -> bool {
        if self.fallback.now.strategy != RowStrategy::Emitted || self.model.layout().nc == 0 {
            return false;
        }
        let state = state.get(..self.nx).unwrap_or_default();
        self.pick_again(time, state);
        self.fallback.now.whole_step = true;
        true
    }

    /// Chooses rows at the start of the step that is tried.
    fn pick_again(&mut self, time: f64, state: &[T]) {
        self.fallback.next.clone_from(&self.fallback.now);
        self.pick_anew(time, state);
        self.fallback.commit();
    }

    /// A step between two times and states did not pass the error test. Near a singular state that is passed, what the test saw may be what
    /// rounding leaves of accelerations, which no shorter step takes out: from here on they are taken at their limit as far as that is better.
    /// True if that changes the accelerations at the start of the step.
    #[cold]
    pub(crate) fn widen(&mut self, times: [f64; 2], states: [&[T]; 2]) -> bool {
        let Fallback { now, next, .. } = &self.fallback;
        let margins = [now.size, next.size].map(|size| size * size);
        let nearest = usize::from(margins[1] < margins[0]);
        let is_passed = self.fallback.base != RowStrategy::Whole && !self.fallback.lasting;
        let may = is_passed && self.has_limits() && self.trusted_from(false) < wide::<T>();
        if !may || now.wide {
            return false;
        }
        let states = states.map(|state| state.get(..self.nx).unwrap_or_default());
        self.fallback.at_end = false;
        let changes = self.stay_wide(margins[nearest], times[nearest], states[nearest])
            && margins[0] < wide::<T>();
        if changes {
            self.pick_again(times[0], states[0]);
        }
        changes
    }

    /// Whether limits are taken farther from a singular state at the step that is held, where this margin and state are.
    #[cold]
    fn stay_wide(&mut self, margin: f64, time: f64, state: &[T]) -> bool {
        self.fallback.held_mut().wide = true;
        let mut stays = margin < wide::<T>();
        // Uneven masses make margins small, too: rows that are independent as lengths are have no limit to go to.
        if stays && !self.fallback.lasting {
            self.read_dense(time, state);
            let Fallback { dense, spare, .. } = &mut self.fallback;
            dense.choose(spare);
            stays = self.fallback.spare.len() < self.full_rank();
        }
        self.fallback.held_mut().wide = stays;
        stays
    }

    /// Overwrites the accelerations of a stage where the strategy of its step is not the emitted one.
    ///
    /// # Errors
    /// [`StepError::SingularConstraints`] where this strategy cannot solve the stage.
    pub(crate) fn accelerate(
        &mut self,
        time: f64,
        state: &[T],
        rates: &mut [T],
    ) -> Result<(), StepError> {
        (self.fallback.anew, self.fallback.regularised) = (false, false);
        let held = self.fallback.held();
        match held.strategy {
            RowStrategy::Emitted if self.fallback.at_end || !held.near => Ok(()),
            RowStrategy::Emitted => self.check_stage(time, state, rates),
            _ => self.accelerate_anew(time, state, rates),
        }
    }

    /// Refuses a stage of an emitted step at which rows lose rank, or others hold better; that behind the step is solved for itself.
    #[cold]
    fn check_stage(&mut self, time: f64, state: &[T], rates: &mut [T]) -> Result<(), StepError> {
        if !self.projection.any() {
            return Ok(());
        }
        self.fallback.margin = f64::NAN;
        self.measure(time, state);
        let is_regular = self.is_regular() || self.fallback.margin.is_nan();
        if is_regular && !self.is_outdone(time, state) {
            return Ok(());
        }
        if self.fallback.behind {
            self.read_dense(time, state);
            self.read_right(time, state);
            self.regularise(time, state)?;
            self.take_accelerations(rates);
            return Ok(());
        }
        self.fallback.held_mut().outdone |= is_regular;
        Err(self.singular(time, state))
    }

    /// Solves a stage with all rows, regularised, after [`System::read_dense`] and [`System::read_right`].
    fn regularise(&mut self, time: f64, state: &[T]) -> Result<(), StepError> {
        let dense = &mut self.fallback.dense;
        let left = dense.accelerate_regularised(T::EPSILON.to_f64());
        // A state that is not finite is found by those who read the rates.
        if left > LEFT_INSIDE {
            return Err(self.singular(time, state));
        }
        self.fallback.worst = RowStrategy::Regularised;
        self.fallback.regularised = true;
        self.counters.rows_regularised = self.counters.rows_regularised.saturating_add(1);
        Ok(())
    }

    /// Overwrites accelerations by those that were solved for.
    fn take_accelerations(&mut self, rates: &mut [T]) {
        let rates = rates.iter_mut().skip(self.model.layout().nq);
        for (rate, found) in rates.zip(&self.fallback.dense.force) {
            *rate = T::from_f64(*found);
        }
        self.fallback.anew = true;
    }

    #[cold]
    fn accelerate_anew(
        &mut self,
        time: f64,
        state: &[T],
        rates: &mut [T],
    ) -> Result<(), StepError> {
        if !self.fallback.at_end && !self.fallback.now.whole_step {
            // Only the start of this step is singular; a stage that is not keeps its rows.
            self.fallback.margin = f64::NAN;
            self.measure(time, state);
            if self.is_regular() {
                return Ok(());
            }
        }
        self.read_dense(time, state);
        self.read_right(time, state);
        let Fallback {
            now,
            next,
            at_end,
            dense,
            ..
        } = &mut self.fallback;
        let held = if *at_end { &*next } else { &*now };
        if !dense.are_independent(&held.rows) {
            self.regularise(time, state)?;
        } else if held.strategy == RowStrategy::Whole {
            dense.accelerate_whole(&held.rows);
        } else {
            dense.factor(&held.rows);
            dense.accelerate(&held.rows);
            // As many as there ever are: nothing is left open.
            if self.fallback.held().rows.len() < self.full_rank() {
                self.approach_limit(time, state);
            }
            // Speeds that the rows allow at an instant need not belong to any motion; rows left out for what little is new in them disagree.
            if self.fallback.dense.left() > LEFT.max(0.5 * self.trusted_from(false).sqrt()) {
                return Err(self.singular(time, state));
            }
        }
        self.take_accelerations(rates);
        Ok(())
    }

    /// Whether the accelerations of a stage inside a step are those of the model.
    #[inline]
    pub(crate) fn solves_as_emitted(&self) -> bool {
        let Fallback { now, at_end, .. } = &self.fallback;
        let pulls_back = matches!(self.projection.stabilise, Stabilise::Baumgarte { .. });
        !at_end && now.strategy == RowStrategy::Emitted && !now.near && !pulls_back
    }

    /// Solves for the move that takes `rows` out, with rows chosen at this state.
    #[cold]
    pub(crate) fn correct_anew(&mut self, time: f64, state: &[T], rows: &[T], moves: &mut [T]) {
        self.read_dense(time, state);
        let Fallback { dense, spare, .. } = &mut self.fallback;
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

    /// Solves for the move along the normals at one state that takes `rows` out at another one.
    #[cold]
    pub(crate) fn correct_across(
        &mut self,
        [start, end]: [f64; 2],
        [state, other]: [&[T]; 2],
        rows: &[T],
        moves: &mut [T],
    ) {
        let length = self.model.layout().len(Quantity::ConstraintJacobian);
        let mut ahead = std::mem::take(&mut self.fallback.ahead);
        ahead.resize(length, 0.0);
        self.by_laws(Quantity::ConstraintJacobian, end, other, &mut ahead);
        self.read_dense(start, state);
        let Fallback { dense, spare, .. } = &mut self.fallback;
        dense.choose(spare);
        for (to, from) in dense.right.iter_mut().zip(rows) {
            *to = from.to_f64();
        }
        dense.correct_across(spare, &mut ahead);
        for (to, from) in moves.iter_mut().zip(&dense.force) {
            *to = T::from_f64(*from);
        }
        self.fallback.ahead = ahead;
    }

    /// Reads M and Φ_v.
    fn read_dense(&mut self, time: f64, state: &[T]) {
        let model = self.model.clone();
        let layout = model.layout();
        let new_from = self.new_from();
        if self.fallback.dense.mass.is_empty() {
            self.fallback.dense = Dense::new(layout.nv, layout.nc, new_from);
            self.fallback.bias = vec![0.0; layout.nv];
        }
        let mut dense = std::mem::take(&mut self.fallback.dense);
        dense.new_from = new_from;
        self.by_laws(Quantity::MassMatrix, time, state, &mut dense.mass);
        let jacobian = &mut dense.jacobian;
        self.by_laws(Quantity::ConstraintJacobian, time, state, jacobian);
        match layout.tree {
            None => moving(layout).for_each(|part| dense.set_mass(part.speeds())),
            // The speeds of a tree share their mass.
            Some(_) => {
                dense.set_mass(0..layout.nv);
                let at = self.nodes.at(T::from_f64(time), state, &self.inputs);
                let laws = self.laws.get_or_insert_with(|| Laws::new(&*model));
                laws.run(&*model, &at, |scene, layout, numbers, at, scratch| {
                    row_sizes(scene, layout, numbers, at, scratch, &mut dense.least);
                });
            }
        }
        self.fallback.dense = dense;
    }

    /// Reads γ and f − h.
    fn read_right(&mut self, time: f64, state: &[T]) {
        let mut dense = std::mem::take(&mut self.fallback.dense);
        self.by_laws(Quantity::ConstraintBias, time, state, &mut dense.right);
        self.by_laws(Quantity::Forces, time, state, &mut dense.force);
        let mut bias = std::mem::take(&mut self.fallback.bias);
        self.by_laws(Quantity::BiasForce, time, state, &mut bias);
        for (force, bias) in dense.force.iter_mut().zip(&bias) {
            *force -= bias;
        }
        self.fallback.bias = bias;
        self.fallback.dense = dense;
    }
}
