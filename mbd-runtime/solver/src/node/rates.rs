//! Rate nodes found along with the state derivative, in one evaluation of the model: the case of almost every stage. What it cannot answer, lines
//! that change between slack and taut, lines that do not span space, nodes on a line or plane, is left to [`RateNode`](super::RateNode).

use std::ops::Range;

use mbd_scene::{Float, Quantity, Real, Work};

use super::error::NodeError;
use super::memory::NodeMemory;
use super::rate::ROUNDING;
use super::scene::NetworkPlan;
use super::stage::{Nodes, Stage};
use crate::unilateral::Mode;

/// Lines that span space.
const SPANNING: usize = 3;

impl<T: Float> Nodes<T> {
    /// The state derivative at a stage, `span` after the last accepted step [s], with the nodes placed as by [`Nodes::solve_stage`]; all lists have the
    /// lengths of the layout.
    ///
    /// # Errors
    /// As there.
    pub(crate) fn differentiate(
        &mut self,
        stage: Stage<'_, T>,
        span: T,
        memory: &NodeMemory<T>,
        work: &mut Work<T>,
        out: &mut [T],
    ) -> Result<(), NodeError> {
        if self.find_rates(stage, span, memory, work, out) {
            return Ok(());
        }
        if !self.is_idle() {
            self.solve_networks(stage, span, memory, work)?;
        }
        let at = self.at(stage.time, stage.state, stage.inputs);
        stage.model.evaluate(Quantity::Derivative, &at, work, out);
        Ok(())
    }

    /// Whether nodes and derivative may be found at once at a stage: lines that may span space carry at every node. Elements are then held in the modes
    /// of the memory.
    pub(crate) fn hold_for_rates(&mut self, memory: &NodeMemory<T>) -> bool {
        if self.rates.is_empty() || !self.may_span(memory) {
            return false;
        }
        self.hold_modes(memory);
        for plan in &self.plans {
            for (_, line) in &plan.legs {
                self.hold[line.line] = memory.modes[line.line].hold();
            }
        }
        true
    }

    /// Takes over what [`Quantity::Rates`] was elsewhere at a stage, as if it had been evaluated here, for elements held by [`Nodes::hold_for_rates`];
    /// `false` where the rules of [`RateNode`](super::RateNode) decide.
    pub(crate) fn receive_rates(
        &mut self,
        stage: Stage<'_, T>,
        span: T,
        memory: &NodeMemory<T>,
        fill: impl FnOnce(&mut [T]),
    ) -> bool {
        let mut rates = std::mem::take(&mut self.rates);
        fill(&mut rates);
        let found = self.take_rates(stage, &rates, memory);
        if found {
            self.span = span;
        }
        self.rates = rates;
        found
    }

    /// Finds nodes and derivative at once; `false`: nothing is found, the rules of [`RateNode`](super::RateNode) decide.
    fn find_rates(
        &mut self,
        stage: Stage<'_, T>,
        span: T,
        memory: &NodeMemory<T>,
        work: &mut Work<T>,
        out: &mut [T],
    ) -> bool {
        if self.rates.is_empty() {
            return false;
        }
        let nx = self.layout.nx();
        if out.len() != nx || !self.hold_for_rates(memory) {
            return false;
        }
        let mut rates = std::mem::take(&mut self.rates);
        // A model that does not find them leaves this as it is.
        let margins = self.margins_of_rates();
        rates[margins].fill(T::from_f64(f64::NAN));
        let at = self.at(stage.time, stage.state, stage.inputs);
        stage.model.evaluate(Quantity::Rates, &at, work, &mut rates);
        let found = self.take_rates(stage, &rates, memory);
        if found {
            self.span = span;
            out.copy_from_slice(&rates[..nx]);
        }
        self.rates = rates;
        found
    }

    /// Where the margins of the nodes are in [`Quantity::Rates`], each with the largest term of a pull behind it.
    fn margins_of_rates(&self) -> Range<usize> {
        let first = self.layout.nx() + self.ends.len();
        first..first + 2 * self.layout.nodes.len()
    }

    /// Whether the lines that carry may span space at every node, and none is detached.
    fn may_span(&self, memory: &NodeMemory<T>) -> bool {
        self.plans.iter().all(|plan| {
            let carries = |line: usize| memory.modes.get(line) == Some(&Mode::Active);
            let mut lines = plan.legs.iter().map(|(_, leg)| memory.modes.get(leg.line));
            if lines.any(|mode| mode == Some(&Mode::Detached)) {
                return false;
            }
            let carrying = plan.legs.iter().filter(|(_, leg)| carries(leg.line));
            memory.ranks.get(plan.index) == Some(&3) && carrying.count() >= SPANNING
        })
    }

    /// Takes over nodes, anchors and lines out of [`Quantity::Rates`], if the lines that were held are those which carry.
    fn take_rates(&mut self, stage: Stage<'_, T>, rates: &[T], memory: &NodeMemory<T>) -> bool {
        let carries = |line: usize| memory.modes[line] == Mode::Active;
        let holds = self.layout_of_rates().holds(rates, T::EPSILON, carries);
        if !holds {
            return false;
        }
        let (_, of_lines) = rates.split_at(self.margins_of_rates().end);
        let legs = self.plans.iter().flat_map(|plan| &plan.legs);
        for ((_, leg), own) in legs.zip(of_lines.chunks_exact(2)) {
            if !self.frozen {
                self.modes[leg.line] = Mode::of(own[0] > T::zero(), carries(leg.line));
            }
            self.stretch[leg.line] = own[0];
        }
        for plan in &mut self.plans {
            if let (Some(&node), Some(z)) = (plan.nodes.first(), plan.z) {
                self.nodes[3 * node..3 * node + 3].copy_from_slice(&rates[z..z + 3]);
                plan.p.copy_from_slice(&stage.state[z..z + 3]);
            }
        }
        self.count_solves(1);
        self.spanned = true;
        true
    }

    /// Counts every network as solved so often.
    pub(crate) fn count_solves(&mut self, times: usize) {
        self.statistics.solves += (times * self.plans.len()) as u64;
    }

    /// Where nodes and lines are in [`Quantity::Rates`].
    pub(crate) fn layout_of_rates(&self) -> RatesLayout<'_, T> {
        RatesLayout {
            plans: &self.plans,
            margins: self.margins_of_rates(),
            frozen: self.frozen,
        }
    }
}

/// Where nodes and lines are in [`Quantity::Rates`].
#[derive(Clone, Debug)]
pub(crate) struct RatesLayout<'a, T: Float> {
    plans: &'a [NetworkPlan<T>],
    /// The margin of every node, each with the largest term of a pull behind it; stretch and pull of their lines follow.
    margins: Range<usize>,
    /// Whether the modes of lines are kept, whatever stretch and pull say.
    frozen: bool,
}

impl<T: Float> RatesLayout<'_, T> {
    /// Where the velocity of every node is in the rates, and in the node unknowns.
    pub(crate) fn velocities(&self) -> impl Iterator<Item = [usize; 2]> {
        let places = self.plans.iter();
        places.filter_map(|plan| Some([plan.z?, 3 * plan.nodes.first()?]))
    }

    /// Whether the lines that were held are those which carry: at every node they pull beyond rounding and span space, and where modes are not
    /// frozen every line does what was held of it.
    pub(crate) fn holds<S: Real>(
        &self,
        rates: &[S],
        epsilon: S,
        carries: impl Fn(usize) -> S::Mask,
    ) -> S::Mask {
        let (zero, one) = (S::zero(), S::one());
        let flag = |mask: S::Mask| S::select(mask, one, zero);
        let no = zero.lt(zero);
        let mut lines = rates
            .get(self.margins.end..)
            .unwrap_or_default()
            .chunks_exact(2);
        let mut all = one;
        for plan in self.plans {
            let own = plan.nodes.first().and_then(|node| {
                let at = self.margins.start + 2 * node;
                rates.get(at..)?.first_chunk().filter(|_| plan.is_rate())
            });
            let Some(&[margin, size]) = own else {
                return no;
            };
            let rounding = size * epsilon * S::from_f64(ROUNDING);
            // Where nothing pulls, or D may have lost a direction, the node follows other rules.
            let (mut pulls, spans) = (zero, flag(zero.lt(margin)));
            for (_, leg) in &plan.legs {
                let Some(&[stretch, pull]) = lines.next().and_then(<[S]>::first_chunk) else {
                    return no;
                };
                let carries = carries(leg.line);
                if !self.frozen {
                    let carried = flag(S::both(zero.lt(stretch), zero.le(pull)));
                    let let_go = S::select(stretch.le(zero), one, flag(pull.le(zero)));
                    all *= S::select(carries, carried, let_go);
                }
                pulls = S::select(S::both(carries, rounding.lt(pull)), one, pulls);
            }
            all *= pulls * spans;
        }
        zero.lt(all)
    }
}
