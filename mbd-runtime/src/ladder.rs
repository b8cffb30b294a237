//! The ladder behind the emitted solver of rows, climbed at step boundaries only and held for a whole step.
//!
//! 1. The rows kept in the declaration, in the emitted elimination.
//! 2. Where other rows leave less than 1e-10 to the pivot of one of them: rows chosen anew, by what is new in each, solved without structure.
//! 3. Where masses differ so much that the emitted elimination loses digits: the whole matrix with row exchange.
//!
//! Rows are never chosen again inside a step: order four would drop to two.

use mbd_scene::{Float, Model, Quantity};

use crate::dense::Dense;
use crate::error::StepError;
use crate::system::{External, System};

/// Part left to a pivot below which its row counts as dependent on others; more where the scalar has fewer digits.
const MARGIN: f64 = 1e-10;
/// A ratio of masses from which on the emitted elimination is compared with the whole matrix.
const RATIO: f64 = 1e3;
/// Relative loss from which on the whole matrix takes over.
const LOSS: f64 = 1e-11;

/// A way to solve the rows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Rung {
    /// As emitted.
    #[default]
    Emitted,
    /// Rows chosen anew.
    Chosen,
    /// The whole matrix.
    Whole,
}

/// What is held for a step.
#[derive(Clone, Debug, Default)]
struct Held {
    rung: Rung,
    rows: Vec<usize>,
}

/// The ladder of one run.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ladder<T> {
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
    /// Room for a quantity, and for h.
    list: Vec<T>,
    bias: Vec<f64>,
    /// Room for rows chosen in a projection.
    spare: Vec<usize>,
    /// The worst rung used.
    pub worst: Rung,
    /// Relative loss of the emitted elimination at the start, where it was measured.
    pub loss: f64,
}

impl<T> Ladder<T> {
    fn held(&self) -> &Held {
        if self.at_end { &self.next } else { &self.now }
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
}

impl<T: Float, M: Model<T>, E: External<T>> System<'_, T, M, E> {
    /// Whether the last factor of the emitted elimination can be trusted.
    pub(crate) fn is_regular(&self) -> bool {
        self.ladder.margin >= MARGIN.max(50.0 * T::EPSILON.to_f64())
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
        self.ladder.at_end = true;
        self.ladder.next.rung = self.ladder.base;
        if self.ladder.base == Rung::Emitted && self.is_regular() {
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
        self.ladder.next = Held { rung, rows };
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
        self.ladder.commit();
        true
    }

    /// At a start: whether masses cost digits, by comparison with the whole matrix. Rates are those of the start.
    #[cold]
    pub(crate) fn weigh(
        &mut self,
        time: f64,
        state: &[T],
        rates: &mut [T],
    ) -> Result<(), StepError> {
        let state = state.get(..self.nx).unwrap_or_default();
        let (nq, nv) = (self.model.layout().nq, self.model.layout().nv);
        if self.ladder.now.rung != Rung::Emitted || !self.is_uneven(time, state) {
            return Ok(());
        }
        let mut rows = std::mem::take(&mut self.ladder.next.rows);
        self.ladder.dense.choose(&mut rows);
        self.read_right(time, state);
        self.ladder.dense.accelerate_whole(&rows);
        let emitted = rates.get(nq..nq + nv).unwrap_or_default();
        let precise = &self.ladder.dense.force;
        let scale = precise.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let pairs = emitted.iter().zip(precise);
        let off = pairs.fold(0.0, |most: f64, (a, b)| most.max((a.to_f64() - b).abs()));
        let loss = if scale > 0.0 { off / scale } else { off };
        self.ladder.loss = loss;
        if loss > LOSS.max(64.0 * T::EPSILON.to_f64()) || !loss.is_finite() {
            self.ladder.base = Rung::Whole;
            self.ladder.worst = Rung::Whole;
            self.ladder.next = Held {
                rung: Rung::Whole,
                rows,
            };
            self.ladder.commit();
            self.accelerate(time, state, rates);
        }
        Ok(())
    }

    /// Whether masses differ by more than [`RATIO`].
    fn is_uneven(&mut self, time: f64, state: &[T]) -> bool {
        self.read_dense(time, state);
        let nv = self.model.layout().nv;
        let masses = self.ladder.dense.mass.iter().step_by(nv + 1);
        let layout = self.model.layout();
        let linear = |speed: usize| {
            let bodies = layout.bodies.iter().map(|slots| slots.v);
            !bodies.into_iter().any(|v| (v + 3..v + 6).contains(&speed))
        };
        let (least, most) = masses.enumerate().filter(|(speed, _)| linear(*speed)).fold(
            (f64::INFINITY, 0.0),
            |(least, most): (f64, f64), (_, mass)| (least.min(*mass), most.max(*mass)),
        );
        most > RATIO * least
    }

    /// Overwrites the accelerations of a stage where the rung of its step is not the emitted one.
    pub(crate) fn accelerate(&mut self, time: f64, state: &[T], rates: &mut [T]) {
        if self.ladder.held().rung != Rung::Emitted {
            self.accelerate_anew(time, state, rates);
        }
    }

    #[cold]
    fn accelerate_anew(&mut self, time: f64, state: &[T], rates: &mut [T]) {
        self.read_dense(time, state);
        self.read_right(time, state);
        let Ladder {
            now,
            next,
            at_end,
            dense,
            ..
        } = &mut self.ladder;
        let held = if *at_end { next } else { now };
        if held.rung == Rung::Whole {
            dense.accelerate_whole(&held.rows);
        } else {
            dense.factor(&held.rows);
            dense.accelerate(&held.rows);
        }
        let rates = rates.iter_mut().skip(self.model.layout().nq);
        for (rate, found) in rates.zip(&self.ladder.dense.force) {
            *rate = T::from_f64(*found);
        }
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
        dense.correct(spare);
        for (to, from) in moves.iter_mut().zip(&dense.force) {
            *to = T::from_f64(*from);
        }
    }

    /// Reads M and Φ_v.
    fn read_dense(&mut self, time: f64, state: &[T]) {
        let layout = self.model.layout();
        if self.ladder.dense.mass.is_empty() {
            self.ladder.dense = Dense::new(layout.nv, layout.nc);
            let most = layout.nv * layout.nv.max(layout.nc);
            self.ladder.list = vec![T::zero(); most];
            self.ladder.bias = vec![0.0; layout.nv];
        }
        let mut dense = std::mem::take(&mut self.ladder.dense);
        self.read_list(Quantity::MassMatrix, time, state, &mut dense.mass);
        self.read_list(
            Quantity::ConstraintJacobian,
            time,
            state,
            &mut dense.jacobian,
        );
        self.ladder.dense = dense;
    }

    /// Reads γ and f − h.
    fn read_right(&mut self, time: f64, state: &[T]) {
        let mut dense = std::mem::take(&mut self.ladder.dense);
        self.read_list(Quantity::ConstraintBias, time, state, &mut dense.right);
        self.read_list(Quantity::Forces, time, state, &mut dense.force);
        let mut bias = std::mem::take(&mut self.ladder.bias);
        self.read_list(Quantity::BiasForce, time, state, &mut bias);
        for (force, bias) in dense.force.iter_mut().zip(&bias) {
            *force -= bias;
        }
        self.ladder.bias = bias;
        self.ladder.dense = dense;
    }

    fn read_list(&mut self, what: Quantity, time: f64, state: &[T], out: &mut [f64]) {
        let at = self.nodes.at(T::from_f64(time), state, &self.inputs);
        let list = self.ladder.list.get_mut(..out.len()).unwrap_or_default();
        list.fill(T::zero());
        self.model.evaluate(what, &at, &mut self.work, list);
        for (to, from) in out.iter_mut().zip(list) {
            *to = from.to_f64();
        }
    }
}
