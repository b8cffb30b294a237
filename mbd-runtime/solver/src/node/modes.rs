//! Rate nodes among the nodes of a model, and the modes of elements: decided at a start, held between located events, switched at one.

use mbd_scene::{Float, Quantity, Work};

use super::balance::triple;
use super::error::NodeError;
use super::memory::NodeMemory;
use super::rate::Leg;
use super::scene::{NetworkPlan, is_detached};
use super::stage::{Nodes, Stage};
use crate::unilateral::{Mode, has_mode};

/// The part of the way to where a node is drawn straight that a step makes: the way is known by how it moves now, and its velocity grows without bound. Less than a
/// half, so that a node whose lines carry there is not put there from as far as a step is long.
const STRAIGHTEN: f64 = 0.45;

impl<T: Float> Leg<T> {
    /// Its mode.
    #[must_use]
    pub fn mode(&self) -> Mode {
        Mode::of(self.taut, self.active)
    }
}

impl<T: Float> Nodes<T> {
    /// Puts the elements of `switches` (element, new mode) into their new modes at a located event, then decides the active sets of their
    /// nodes again where the switch left a line pushing, or idle although it would pull. The unknowns are those of the new modes afterwards. Pulls are
    /// known to `within` [m of stretch]: one below that counts as none, but that of a line which begins to pull.
    ///
    /// # Errors
    /// As [`Nodes::solve`].
    pub fn switch(
        &mut self,
        stage: Stage<'_, T>,
        (switches, within): (&[(usize, Mode)], T),
        memory: &mut NodeMemory<T>,
        work: &mut Work<T>,
    ) -> Result<(), NodeError> {
        memory.check(&self.layout)?;
        for &(element, mode) in switches {
            if let Some(slot) = memory.modes.get_mut(element)
                && !matches!(*slot, Mode::Free | Mode::Detached)
            {
                *slot = mode;
            }
        }
        self.read_ends(stage, work)?;
        self.hold_modes(memory);
        let switched = self.each_plan(|nodes, plan| {
            if !plan.is_rate() {
                return Ok(());
            }
            nodes.place_rate(stage, plan, memory);
            // Another set of lines spans other directions.
            plan.rate.hold_rank(3);
            let switched = |line: usize| switches.iter().find(|(element, _)| *element == line);
            let mut legs = plan.legs.iter();
            let is_behind = legs.any(|(_, leg)| switched(leg.line).is_some());
            if is_behind {
                for (index, (_, line)) in plan.legs.iter().enumerate() {
                    let begins = matches!(switched(line.line), Some((_, Mode::Active)));
                    plan.rate.look_behind(index, begins, within);
                }
            }
            plan.rate.solve_frozen();
            let decided = !plan.rate.inconsistent() || plan.rate.decide();
            if is_behind {
                plan.rate.place_again();
                plan.rate.solve_frozen();
            }
            let result = nodes.finish_rate(plan, decided);
            memory.ranks[plan.index] = plan.rate.rank();
            for (leg, (_, line)) in plan.rate.legs().iter().zip(&plan.legs) {
                if let Some(slot) = memory.modes.get_mut(line.line)
                    && *slot != Mode::Detached
                {
                    *slot = leg.mode();
                }
            }
            result
        });
        memory.before_straight = self.before_straight();
        switched
    }

    /// Decides the modes of all elements outside nodes anew from the state: at the start of a run.
    pub(crate) fn find_modes(
        &mut self,
        stage: Stage<'_, T>,
        memory: &mut NodeMemory<T>,
        work: &mut Work<T>,
    ) {
        self.held_for_rates = false;
        let mut guards = std::mem::take(&mut self.guards);
        let at = self.at(stage.time, stage.state, stage.inputs);
        stage
            .model
            .evaluate(Quantity::Guards, &at, work, &mut guards);
        let elements = guards.chunks_exact(2).take(self.layout.one_way());
        for (element, pair) in elements.enumerate() {
            if has_mode(stage.model, element) && memory.modes[element] != Mode::Detached {
                let mode = Mode::of(pair[0] > T::zero(), pair[1] >= T::zero());
                self.modes[element] = mode;
                memory.modes[element] = mode;
            }
        }
        self.guards = guards;
    }

    /// The velocity of a rate node at a stage: on the frozen active set, or on the one decided here.
    pub(crate) fn solve_rate(
        &mut self,
        stage: Stage<'_, T>,
        plan: &mut NetworkPlan<T>,
        memory: &NodeMemory<T>,
    ) -> Result<(), NodeError> {
        self.place_rate(stage, plan, memory);
        let decided = if self.frozen {
            plan.rate.solve_frozen();
            true
        } else {
            plan.rate.taut_by_stretch();
            plan.rate.decide()
        };
        self.finish_rate(plan, decided)
    }

    /// Places a rate node where the state has it, with the modes and the rank that the memory carries.
    fn place_rate(&self, stage: Stage<'_, T>, plan: &mut NetworkPlan<T>, memory: &NodeMemory<T>) {
        for (index, (_, line)) in plan.legs.iter().enumerate() {
            let mode = memory.modes.get(line.line).copied().unwrap_or_default();
            let taut = matches!(mode, Mode::Active | Mode::Idle);
            plan.rate.set_mode(index, taut, mode == Mode::Active);
        }
        let rank = memory.ranks.get(plan.index).copied();
        plan.rate.hold_rank(rank.unwrap_or(3));
        if let Some(z) = plan.z {
            plan.p.copy_from_slice(triple(stage.state, z).as_slice());
        }
        plan.set_legs(stage.model, &self.modes, &self.ends);
    }

    /// Writes velocity, modes and holds of a rate node.
    pub(crate) fn finish_rate(
        &mut self,
        plan: &mut NetworkPlan<T>,
        decided: bool,
    ) -> Result<(), NodeError> {
        let Some(&node) = plan.nodes.first() else {
            return Ok(());
        };
        let velocity = plan.rate.velocity();
        self.nodes[3 * node..3 * node + 3].copy_from_slice(velocity.as_slice());
        for (leg, (_, line)) in plan.rate.legs().iter().zip(&plan.legs) {
            if !is_detached(&self.modes, line) {
                self.modes[line.line] = leg.mode();
                self.hold[line.line] = leg.mode().hold();
            }
        }
        self.statistics.solves += 1;
        if plan.rate.unbalanced() {
            // One line or two are followed to where they carry a load that turns; three in a plane carry none across it, however short the step.
            let why = match plan.rate.is_carried_with_load() {
                true => {
                    "its load acts in a direction that no taut line spans: take shorter steps, or declare `equilibrium: stepwise`"
                }
                false => {
                    "its load acts in a direction that no taut line spans: give the point a mass, or declare `equilibrium: stepwise`"
                }
            };
            return Err(NodeError::Unsupported { node, why });
        }
        NodeError::check_finite("velocity of a rate node", velocity.as_slice())?;
        match decided {
            true => Ok(()),
            false => Err(NodeError::NotConverged {
                node,
                residual_n: f64::NAN,
                iterations: 0,
                uneven: None,
            }),
        }
    }

    /// Whether the last solve left a rate node where its lines carry its load by their directions only: what the step leaves it beside that place is
    /// an error that no stage shows where the load turns.
    pub(crate) fn carries_by_place(&self) -> bool {
        let mut plans = self.plans.iter().filter(|plan| plan.z.is_some());
        !self.spanned && plans.any(|plan| plan.rate.is_carried_with_load())
    }

    /// Puts rate nodes whose carrying lines do not span space back on the line or plane through their anchors (rule 4), which an integration
    /// leaves at the order of the method, and those that reach it within the step (rule 5). Call it on an accepted state after the
    /// [`Nodes::solve`] at its end; `true`: the state changed, solve again.
    pub fn project(&self, state: &mut [T]) -> bool {
        let mut changed = false;
        for plan in self.plans.iter().filter(|_| !self.spanned) {
            let crossing = || plan.rate.crossing(self.span);
            let crossing = || crossing().filter(|it| it.taut).map(|it| it.place);
            if let Some(z) = plan.z
                && let Some(p) = plan.rate.projected().or_else(crossing)
                && let Some(target) = state.get_mut(z..z + 3)
            {
                target.copy_from_slice(p.as_slice());
                changed = true;
            }
        }
        changed
    }

    /// Puts rate nodes whose lines are about to be drawn straight without force on the line or plane through their anchors (rule 5), where modes are held,
    /// and lists the lines that are slack there. Call it as [`Nodes::project`]; `true`: the state changed.
    pub(crate) fn straighten(&self, state: &mut [T], slack: &mut Vec<(usize, Mode)>) -> bool {
        let mut changed = false;
        for plan in self.plans.iter().filter(|_| self.frozen) {
            if let Some(z) = plan.z
                && let Some(crossing) = plan.rate.crossing(self.span).filter(|it| !it.taut)
                && let Some(target) = state.get_mut(z..z + 3)
            {
                target.copy_from_slice(crossing.place.as_slice());
                let legs = plan.rate.legs().iter().zip(&plan.legs);
                let slackens = legs.filter(|(leg, _)| leg.active && !crossing.keeps_taut(leg));
                slack.extend(slackens.map(|(_, (_, line))| (line.line, Mode::Slack)));
                changed = true;
            }
        }
        changed
    }

    /// How long a step may be on the way to where a rate node is drawn straight without force (rule 5), where modes are held, as the last solve has it [s]. `None`
    /// where none is on such a way.
    pub(crate) fn before_straight(&self) -> Option<f64> {
        let held = self.frozen && !self.spanned;
        let plans = self.plans.iter().filter(|plan| held && plan.z.is_some());
        let ways = plans.filter_map(|plan| plan.rate.straight_in());
        let steps = ways.map(|way| STRAIGHTEN * way.to_f64());
        steps.reduce(f64::min)
    }
}
