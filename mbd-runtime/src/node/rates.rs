//! Rate nodes found along with the state derivative, in one evaluation of the model: the case of almost every stage. What it cannot answer, lines
//! that change between slack and taut, lines that do not span space, nodes on a line or plane, is left to [`RateNode`](super::RateNode).

use std::ops::Range;

use mbd_scene::{Float, Quantity, Work};

use super::error::NodeError;
use super::memory::NodeMemory;
use super::rate::ROUNDING;
use super::stage::{Nodes, Stage};
use crate::unilateral::Mode;

/// Lines that span space.
const SPANNING: usize = 3;

impl<T: Float> Nodes<T> {
    /// The state derivative at a stage, `span` after the last accepted step [s], with the nodes placed as by [`Nodes::solve_stage`].
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
        self.solve_stage(stage, span, memory, work)?;
        let at = self.at(stage.time, stage.state, stage.inputs);
        stage.model.evaluate(Quantity::Derivative, &at, work, out);
        Ok(())
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
        let nx = self.layout.nx();
        if self.rates.is_empty() || !self.may_span(memory) || out.len() != nx {
            return false;
        }
        if self.check_shape(stage).is_err() || memory.check(&self.layout).is_err() {
            return false;
        }
        self.hold_modes(memory);
        for plan in &self.plans {
            for (_, line) in &plan.legs {
                self.hold[line.line] = memory.modes[line.line].hold();
            }
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
        let zero = T::zero();
        let (_, rest) = rates.split_at(self.layout.nx());
        let (_, rest) = rest.split_at(self.ends.len());
        let (of_nodes, of_lines) = rest.split_at(2 * self.layout.nodes.len());
        let mut lines = of_lines.chunks_exact(2);
        for plan in &self.plans {
            let (Some(&node), true) = (plan.nodes.first(), plan.is_rate()) else {
                return false;
            };
            let [margin, size] = [0, 1].map(|k| of_nodes[2 * node + k]);
            let rounding = size * T::EPSILON * T::from_f64(ROUNDING);
            let mut pulls = false;
            for (_, leg) in &plan.legs {
                let Some(&[stretch, pull]) = lines.next().and_then(<[T]>::first_chunk) else {
                    return false;
                };
                let carries = memory.modes[leg.line] == Mode::Active;
                let consistent = match carries {
                    true => stretch > zero && pull >= zero,
                    false => stretch <= zero || pull <= zero,
                };
                if !self.frozen && !consistent {
                    return false;
                }
                pulls |= carries && pull > rounding;
                if !self.frozen {
                    self.modes[leg.line] = Mode::of(stretch > zero, carries);
                }
                self.stretch[leg.line] = stretch;
            }
            // Where nothing pulls, or D may have lost a direction, the node follows other rules.
            let spans = margin > zero;
            if !(pulls && spans) {
                return false;
            }
        }
        for plan in &mut self.plans {
            if let (Some(&node), Some(z)) = (plan.nodes.first(), plan.z) {
                self.nodes[3 * node..3 * node + 3].copy_from_slice(&rates[z..z + 3]);
                plan.p.copy_from_slice(&stage.state[z..z + 3]);
            }
        }
        self.statistics.solves += self.plans.len() as u64;
        self.spanned = true;
        true
    }
}
