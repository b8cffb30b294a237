//! Rate nodes found along with the state derivative, in one evaluation of the model: the case of almost every stage. What it cannot answer, lines
//! that change between slack and taut, lines that do not span space, nodes on a line or plane, is left to [`RateNode`](super::RateNode).

use std::ops::Range;

use mbd_scene::laws::rate::NODE_CERTIFICATE;
use mbd_scene::{Float, Quantity, Real, StageInputs, StepStages, Work};

use super::error::NodeError;
use super::memory::NodeMemory;
use super::rate::ROUNDING;
use super::scene::NetworkPlan;
use super::stage::{Nodes, Stage};
use crate::integrate::INNER;
use crate::list::copy;
use crate::unilateral::Mode;

/// Lines that span space.
const SPANNING: usize = 3;

impl<T: Float> Nodes<T> {
    /// The state derivative at a stage, `span` after the last accepted step [s], with the nodes placed as by [`Nodes::solve_stage`]; all lists have the
    /// lengths of the layout.
    ///
    /// # Errors
    /// As there.
    #[inline]
    pub(crate) fn differentiate(
        &mut self,
        stage: Stage<'_, T>,
        span: T,
        memory: &NodeMemory<T>,
        work: &mut Work<T>,
        out: &mut [T],
    ) -> Result<(), NodeError> {
        if self.has_networks() {
            if self.find_rates(stage, span, memory, work, out) {
                return Ok(());
            }
            self.solve_networks(stage, span, memory, work)?;
        } else {
            self.hold_once(memory);
        }
        let at = self.at(stage.time, stage.state, stage.inputs);
        stage.model.evaluate(Quantity::Derivative, &at, work, out);
        Ok(())
    }

    /// Makes the stages inside a step of a size that starts at a stage in one call, and the state at its end, as [`Nodes::differentiate`] makes them
    /// one by one; `false`: nothing is done.
    #[inline]
    pub(crate) fn make_inner_stages(
        &mut self,
        (stage, inputs): (Stage<'_, T>, Option<&mut dyn StageInputs<T>>),
        span: [f64; 2],
        memory: &NodeMemory<T>,
        work: &mut Work<T>,
        (rates, next): (&mut [T], &mut [T]),
    ) -> bool {
        if !self.has_networks() {
            self.hold_once(memory);
        } else if self.spanned && (self.held || self.hold_for_rates(memory)) {
            self.has_held();
        } else {
            // Where nodes were found by other rules they mostly are again.
            return false;
        }
        let at = stage.at([&self.nodes, &self.effective, &self.hold, &self.ends]);
        let step = StepStages {
            at,
            inputs: inputs.map(|inputs| inputs as &mut dyn StageInputs<T>),
            span,
            rates,
            next,
            found: &mut self.inner,
        };
        stage.model.inner_stages(step, work) && self.takes_inner_stages()
    }

    /// Whether the nodes of the stages inside a step may be taken as they were found.
    fn takes_inner_stages(&self) -> bool {
        let (layout, length) = (self.layout_of_rates(), self.rates.len());
        let mut stages = (0..INNER).map(|number| number * length);
        length == 0 || stages.all(|first| layout.holds(&self.inner, first, T::EPSILON))
    }

    /// Whether nodes and derivative may be found at once at a stage: lines that may span space carry at every node. Elements are then held in the modes
    /// of the memory.
    pub(crate) fn hold_for_rates(&mut self, memory: &NodeMemory<T>) -> bool {
        if self.held_for_rates && self.modes == memory.modes && memory.held.is_empty() {
            let mut plans = self.plans.iter();
            return plans.all(|plan| memory.ranks.get(plan.index) == Some(&3));
        }
        if self.rates.is_empty() || !self.may_span(memory) {
            return false;
        }
        self.hold_modes(memory);
        if !self.frozen {
            let legs = self.plans.iter().flat_map(|plan| &plan.legs);
            for (_, leg) in legs {
                let mode = memory.modes.get(leg.line);
                if let (Some(hold), Some(mode)) = (self.hold.get_mut(leg.line), mode) {
                    *hold = mode.hold();
                }
            }
        }
        let carries = |plan: &NetworkPlan<T>| {
            let mut legs = plan.legs.iter();
            legs.all(|(_, leg)| self.modes.get(leg.line) == Some(&Mode::Active))
        };
        self.all_carry = self.plans.iter().all(carries);
        self.held_for_rates = true;
        true
    }

    /// Takes over what [`Quantity::Rates`] was elsewhere at a stage, as if it had been evaluated here, for elements held by [`Nodes::hold_for_rates`];
    /// `false` where the rules of [`RateNode`](super::RateNode) decide.
    pub(crate) fn receive_rates(
        &mut self,
        stage: Stage<'_, T>,
        span: T,
        fill: impl FnOnce(&mut [T]),
    ) -> bool {
        fill(&mut self.rates);
        self.take_rates(stage, span)
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
        if self.rates.is_empty() || !self.held && !self.hold_for_rates(memory) {
            return false;
        }
        self.has_held();
        // A model that does not find them leaves these numbers as they were made, and nothing holds.
        let at = stage.at([&self.nodes, &self.effective, &self.hold, &self.ends]);
        let rates = &mut self.rates;
        stage.model.evaluate(Quantity::Rates, &at, work, rates);
        let found = self.take_rates(stage, span);
        if let (true, Some(own)) = (found, self.rates.get(..out.len())) {
            copy(own, out);
        }
        found
    }

    /// Whether the lines that carry may span space at every node, and none is detached.
    fn may_span(&self, memory: &NodeMemory<T>) -> bool {
        self.plans.iter().all(|plan| {
            let (mut carrying, mut detached) = (0, false);
            for (_, leg) in &plan.legs {
                let mode = memory.modes.get(leg.line);
                carrying += usize::from(mode == Some(&Mode::Active));
                detached |= mode == Some(&Mode::Detached);
            }
            !detached && carrying >= SPANNING && memory.ranks.get(plan.index) == Some(&3)
        })
    }

    /// Takes over nodes, anchors and lines out of [`Quantity::Rates`], if the lines that were held are those which carry.
    fn take_rates(&mut self, stage: Stage<'_, T>, span: T) -> bool {
        if !self.holds(&self.rates) {
            return false;
        }
        // What its lines do is read off where somebody asks: most stages are followed by others.
        for plan in &mut self.plans {
            if let (Some(&node), Some(z)) = (plan.nodes.first(), plan.z) {
                let velocity = self.rates.get(z..).and_then(<[T]>::first_chunk::<3>);
                let place = stage.state.get(z..).and_then(<[T]>::first_chunk::<3>);
                let node = self.nodes.get_mut(3 * node..);
                if let (Some(velocity), Some(place)) = (velocity, place)
                    && let Some(own) = node.and_then(<[T]>::first_chunk_mut)
                    && let Some(p) = plan.p.first_chunk_mut()
                {
                    (*own, *p) = (*velocity, *place);
                }
            }
        }
        self.count_solves(1);
        (self.span, self.spanned) = (span, true);
        true
    }

    /// Whether the lines that were held are those which carry.
    fn holds(&self, rates: &[T]) -> bool {
        self.layout_of_rates().holds(rates, 0, T::EPSILON)
    }

    /// What [`Nodes::accept`] writes where nodes were found along with the derivative: nothing of such a node begins in the step before it but the
    /// modes of its lines, and those of lines that carry stay as they are.
    pub(super) fn accept_rates(&mut self, h: T, memory: &mut NodeMemory<T>) {
        (memory.step, memory.before_straight) = (h, None);
        for plan in &self.plans {
            let place = plan.nodes.first().map(|node| 3 * node);
            let kept = place.and_then(|at| memory.nodes.get_mut(at..));
            let kept = kept.and_then(<[T]>::first_chunk_mut::<3>);
            if let (Some(kept), Some(own)) = (kept, plan.p.first_chunk()) {
                *kept = *own;
            }
        }
        if !self.frozen && !self.all_carry {
            self.find_modes_along();
            memory.modes.copy_from_slice(&self.modes);
        }
    }

    /// The modes of lines that do not all carry, of nodes that were found along with the derivative.
    fn find_modes_along(&mut self) {
        self.held_for_rates = false;
        let lines = self.rates.get(self.certificates.end..);
        let mut lines = lines.unwrap_or_default().iter();
        for plan in &self.plans {
            for ((_, leg), stretch) in plan.legs.iter().zip(&mut lines) {
                // They were held in the modes of the memory: a line that carried pulls.
                let carries = self.modes[leg.line] == Mode::Active;
                self.modes[leg.line] = Mode::of(*stretch > T::zero(), carries);
            }
        }
    }

    /// Counts every network as solved so often.
    pub(crate) fn count_solves(&mut self, times: usize) {
        self.statistics.solves += (times * self.plans.len()) as u64;
    }

    /// Where nodes and lines are in [`Quantity::Rates`].
    pub(crate) fn layout_of_rates(&self) -> RatesLayout<'_, T> {
        RatesLayout {
            plans: &self.plans,
            certificates: self.certificates.clone(),
            frozen: self.frozen,
        }
    }
}

/// Where nodes and lines are in [`Quantity::Rates`].
#[derive(Clone, Debug)]
pub(crate) struct RatesLayout<'a, T: Float> {
    plans: &'a [NetworkPlan<T>],
    /// What is said of every node, [`NODE_CERTIFICATE`] numbers each; the stretches of their lines follow.
    certificates: Range<usize>,
    /// Whether the modes of lines are kept, whatever stretch and pull say.
    frozen: bool,
}

impl<T: Float> RatesLayout<'_, T> {
    /// Where the velocity of every node is in the rates, and in the node unknowns.
    pub(crate) fn velocities(&self) -> impl Iterator<Item = [usize; 2]> {
        let places = self.plans.iter();
        places.filter_map(|plan| Some([plan.z?, 3 * plan.nodes.first()?]))
    }

    /// Whether the lines that were held are those which carry, in rates that begin at a place: at every node they pull beyond rounding and span space, and
    /// where modes are not frozen every line does what was held of it.
    #[inline]
    pub(crate) fn holds<S: Real>(&self, rates: &[S], first: usize, epsilon: S) -> S::Mask {
        let zero = S::zero();
        let Range { start, end } = self.certificates;
        let Some(nodes) = rates.get(first + start..first + end) else {
            return zero.lt(zero);
        };
        let rounding = epsilon * S::from_f64(ROUNDING);
        let mut all = zero.le(zero);
        // Numbers that were never found are none, and nothing holds.
        for &[margin, size, most, agreed] in nodes.as_chunks::<NODE_CERTIFICATE>().0 {
            // Where nothing pulls, or D may have lost a direction, the node follows other rules.
            all = S::both(all, S::both((size * rounding).lt(most), zero.lt(margin)));
            if !self.frozen {
                all = S::both(all, zero.lt(agreed));
            }
        }
        all
    }
}
