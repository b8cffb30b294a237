//! Rate nodes found along with the state derivative, in one evaluation of the model: the case of almost every stage. What it cannot answer, lines
//! that change between slack and taut, lines that do not span space, nodes on a line or plane, is left to [`RateNode`](super::RateNode).

use mbd_scene::laws::rate::NODE_CERTIFICATE;
use mbd_scene::{Float, Quantity, Real, StageInputs, StepEnd, StepStages, Work};

use super::error::NodeError;
use super::memory::NodeMemory;
use super::rate::ROUNDING;
use super::scene::NetworkPlan;
use super::stage::{Nodes, Stage};
use crate::integrate::Made;
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
    /// one by one; with `end`, where quaternions begin and by how much they were off, the last stage, too.
    #[inline]
    pub(crate) fn make_stages(
        &mut self,
        (stage, inputs): (Stage<'_, T>, Option<&mut dyn StageInputs<T>>),
        span: [f64; 2],
        memory: &NodeMemory<T>,
        work: &mut Work<T>,
        (rates, next): (&mut [T], &mut [T]),
        end: Option<(&[usize], &mut f64)>,
    ) -> Made {
        if !self.has_networks() {
            self.hold_once(memory);
        } else if self.spanned && (self.held || self.hold_for_rates(memory)) {
            self.has_held();
        } else {
            // Where nodes were found by other rules they mostly are again.
            return Made::Nothing;
        }
        let certificates = self.certificates();
        let (to_end, mut made) = (end.is_some(), false);
        let step = StepStages {
            at: stage.at([&self.nodes, &self.effective, &self.hold, &self.ends]),
            inputs: inputs.map(|inputs| inputs as &mut dyn StageInputs<T>),
            span,
            rates,
            next: &mut *next,
            found: &mut self.inner,
            holds: &|found: &[T]| certificates.hold(found),
            end: end.map(|(quaternions, drift)| StepEnd {
                quaternions,
                drift,
                found: &mut self.rates,
                made: &mut made,
            }),
        };
        if !stage.model.inner_stages(step, work) {
            return Made::Nothing;
        }
        match (to_end, made) {
            (false, _) => Made::Inside,
            (true, false) => Made::End,
            (true, true) => {
                if self.has_networks() {
                    self.take_nodes(next, T::from_f64(span[1]));
                }
                Made::Whole
            }
        }
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
        let holds = self.holds(&self.rates);
        if holds {
            self.take_nodes(stage.state, span);
        }
        holds
    }

    /// Takes over the nodes where they were found at a state.
    fn take_nodes(&mut self, state: &[T], span: T) {
        // What its lines do is read off where somebody asks: most stages are followed by others.
        for plan in &mut self.plans {
            if let (Some(&node), Some(z)) = (plan.nodes.first(), plan.z) {
                let velocity = self.rates.get(z..).and_then(<[T]>::first_chunk::<3>);
                let place = state.get(z..).and_then(<[T]>::first_chunk::<3>);
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
    }

    /// Whether the lines that were held are those which carry.
    fn holds(&self, rates: &[T]) -> bool {
        self.certificates().hold(rates)
    }

    /// What tells of rates whether their nodes hold.
    pub(crate) fn certificates(&self) -> Certificates {
        Certificates {
            places: [self.certificates.start, self.certificates.end],
            frozen: self.frozen,
        }
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

    /// Where the velocity of every node is in [`Quantity::Rates`], and in the node unknowns.
    pub(crate) fn velocities_in_rates(&self) -> impl Iterator<Item = [usize; 2]> {
        let places = self.plans.iter();
        places.filter_map(|plan| Some([plan.z?, 3 * plan.nodes.first()?]))
    }
}

/// What [`Quantity::Rates`] says of every node, [`NODE_CERTIFICATE`] numbers each.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Certificates {
    /// Where it begins, and where it ends: the stretches of the lines follow.
    places: [usize; 2],
    /// Whether the modes of lines are kept, whatever stretch and pull say.
    frozen: bool,
}

impl Certificates {
    /// Whether the lines that were held are those which carry: at every node they pull beyond rounding and span space, and where modes are not frozen every
    /// line does what was held of it.
    #[inline]
    fn hold<T: Float>(&self, rates: &[T]) -> bool {
        let rounding = T::EPSILON * T::from_f64(ROUNDING);
        // One after the other: most scenes have one.
        let nodes = self.of(rates);
        nodes.is_some_and(|nodes| nodes.iter().all(|node| self.node_holds(node, rounding)))
    }

    /// The same in lanes.
    pub(crate) fn hold_beside<S: Real>(&self, rates: &[S], epsilon: S) -> S::Mask {
        let zero = S::zero();
        let Some(nodes) = self.of(rates) else {
            return zero.lt(zero);
        };
        let rounding = epsilon * S::from_f64(ROUNDING);
        let nodes = nodes.iter();
        nodes.fold(zero.le(zero), |all, node| {
            S::both(all, self.node_holds(node, rounding))
        })
    }

    /// What is said of every node.
    #[inline]
    fn of<'a, S>(&self, rates: &'a [S]) -> Option<&'a [[S; NODE_CERTIFICATE]]> {
        let [start, end] = self.places;
        Some(rates.get(start..end)?.as_chunks().0)
    }

    /// Whether a node is where its lines hold it. Numbers that were never found are none, and nothing holds.
    #[inline]
    fn node_holds<S: Real>(
        &self,
        &[margin, size, most, agreed]: &[S; NODE_CERTIFICATE],
        rounding: S,
    ) -> S::Mask {
        let zero = S::zero();
        // Where nothing pulls, or D may have lost a direction, the node follows other rules.
        let carries = S::both((size * rounding).lt(most), zero.lt(margin));
        match self.frozen {
            true => carries,
            false => S::both(carries, zero.lt(agreed)),
        }
    }
}
