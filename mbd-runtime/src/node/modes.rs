//! Modes of damped lines between located events, the guards that end them, and the switch at an event.
//!
//! ```text
//! slack     s = 0 upwards        → active        (the force jumps up by C ṡ)
//! active    pull = 0 downwards   → idle,         s = 0 downwards → slack
//! idle      pull = 0 upwards     → active,       s = 0 downwards → slack           pull = f(s) + C ṡ
//! ```
//!
//! The same table serves lines between bodies and points with mass and the lines of `rate` nodes; without damping stretch and pull vanish
//! together and no line is idle. A stop of a joint is such a line: its stretch is the depth, slack is open, taut is touched. Springs and the lines of static and stepwise nodes have no modes and no guards.

use mbd_scene::{Float, Layout, LineEnd, Model, NodeModel, Quantity, Work};

use super::error::NodeError;
use super::memory::{Mode, NodeMemory};
use super::rate::{Leg, Spread};
use super::scene::{Plan, triple};
use super::stage::Nodes;

/// A stretch or a pull that ends the mode of a line when it passes zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guard<T> {
    /// The line; behind the lines, the stop.
    pub line: usize,
    /// ≥ 0 while the mode holds [m]: ± stretch, or ± pull over K.
    pub value: T,
    /// The mode that follows.
    pub leads_to: Mode,
}

impl<T: Float> Leg<T> {
    /// Its mode.
    #[must_use]
    pub fn mode(&self) -> Mode {
        match (self.taut, self.active) {
            (false, _) => Mode::Slack,
            (true, true) => Mode::Active,
            (true, false) => Mode::Idle,
        }
    }
}

impl Mode {
    /// The mode as a number, for `At::hold`.
    #[must_use]
    pub fn hold<T: Float>(self) -> T {
        match self {
            Mode::Free => T::zero(),
            Mode::Active => T::one(),
            Mode::Slack | Mode::Idle => -T::one(),
        }
    }
}

/// Whether a line or, behind the lines, a stop switches between modes at located instants: one-way, and not of a static or stepwise node,
/// whose lines switch inside the solve of the node.
pub(crate) fn switches<T: Float>(model: &dyn Model<T>, line: usize) -> bool {
    let (scene, layout) = (model.scene(), model.layout());
    match (scene.lines.get(line), layout.lines.get(line)) {
        (Some(declared), Some(slots)) => declared.kind.is_unilateral() && slots.effective.is_none(),
        _ => line < layout.unilateral(),
    }
}

/// Whether a line or a stop has a mode now: a line of a `rate` node has one only if it is damped.
pub(crate) fn has_mode<T: Float>(model: &dyn Model<T>, line: usize) -> bool {
    let damped = model
        .lines()
        .get(line)
        .is_some_and(|n| n.damping > T::zero());
    switches(model, line) && (damped || !is_node_line(model.layout(), line))
}

/// Whether a line ends at a node.
pub(crate) fn is_node_line(layout: &Layout, line: usize) -> bool {
    layout
        .lines
        .get(line)
        .is_some_and(|slots| slots.ends.iter().any(|end| matches!(end, LineEnd::Node(_))))
}

impl<T: Float> Nodes<T> {
    /// Calls `visit` on every guard: from the values of [`Quantity::Guards`] at any state inside a step (with frozen modes) and the memory.
    pub fn guards(
        &self,
        model: &dyn Model<T>,
        values: &[T],
        memory: &NodeMemory<T>,
        mut visit: impl FnMut(Guard<T>),
    ) {
        for (line, (pair, &mode)) in values.chunks_exact(2).zip(&memory.modes).enumerate() {
            let (stretch, numbers) = (pair[0], model.lines().get(line));
            let pull = numbers.map_or(pair[1], |numbers| pair[1] / numbers.stiffness);
            let mut guard = |value, leads_to| {
                visit(Guard {
                    line,
                    value,
                    leads_to,
                });
            };
            match mode {
                Mode::Free => {}
                Mode::Slack => guard(-stretch, Mode::Active),
                Mode::Active => {
                    guard(pull, Mode::Idle);
                    guard(stretch, Mode::Slack);
                }
                Mode::Idle => {
                    guard(-pull, Mode::Active);
                    guard(stretch, Mode::Slack);
                }
            }
        }
    }

    /// Whether some line with modes does not carry: then guards can leave and return within a step and must be sampled inside it.
    #[must_use]
    pub fn must_sample(&self, memory: &NodeMemory<T>) -> bool {
        memory
            .modes
            .iter()
            .any(|mode| matches!(mode, Mode::Slack | Mode::Idle))
    }

    /// Puts the lines of `switches` (line, new mode) into their new modes at a located event, then decides the active sets of their nodes
    /// again where the switch left a line pushing, or idle although it would pull. The unknowns are those of the new modes afterwards.
    ///
    /// # Errors
    /// As [`Nodes::solve`].
    #[allow(
        clippy::too_many_arguments,
        reason = "the arguments of a pure evaluation: when, where, what changes, what is carried, scratch"
    )]
    pub fn switch(
        &mut self,
        model: &dyn Model<T>,
        time: T,
        state: &[T],
        inputs: &[T],
        switches: &[(usize, Mode)],
        memory: &mut NodeMemory<T>,
        work: &mut Work<T>,
    ) -> Result<(), NodeError> {
        memory.check(&self.layout)?;
        for &(line, mode) in switches {
            if let Some(slot) = memory.modes.get_mut(line)
                && *slot != Mode::Free
            {
                *slot = mode;
            }
        }
        self.read_ends(model, time, state, inputs, work)?;
        self.hold_lines(model, memory);
        let mut plans = std::mem::take(&mut self.plans);
        let mut result = Ok(());
        for plan in plans
            .iter_mut()
            .filter(|plan| plan.model == NodeModel::Rate)
        {
            self.place_rate(model, plan, state, memory);
            plan.rate.solve_frozen();
            let decided = !plan.rate.inconsistent() || plan.rate.decide();
            result = self.finish_rate(plan, decided);
            memory.ranks[plan.index] = plan.rate.rank();
            for (leg, (_, line)) in plan.rate.legs().iter().zip(&plan.legs) {
                if let Some(slot) = memory.modes.get_mut(line.line) {
                    *slot = leg.mode();
                }
            }
            if result.is_err() {
                break;
            }
        }
        self.plans = plans;
        result
    }

    /// Decides the modes of all damped lines anew from the state: at the start of a run.
    pub(crate) fn find_modes(
        &mut self,
        model: &dyn Model<T>,
        time: T,
        state: &[T],
        inputs: &[T],
        memory: &mut NodeMemory<T>,
        work: &mut Work<T>,
    ) {
        let mut guards = std::mem::take(&mut self.guards);
        model.evaluate(
            Quantity::Guards,
            &self.at(time, state, inputs),
            work,
            &mut guards,
        );
        for (line, pair) in guards
            .chunks_exact(2)
            .take(self.layout.unilateral())
            .enumerate()
        {
            if has_mode(model, line) && !is_node_line(&self.layout, line) {
                let mode = match (pair[0] > T::zero(), pair[1] >= T::zero()) {
                    (false, _) => Mode::Slack,
                    (true, true) => Mode::Active,
                    (true, false) => Mode::Idle,
                };
                self.modes[line] = mode;
                memory.modes[line] = mode;
            }
        }
        self.guards = guards;
    }

    /// The velocity of a rate node at a stage: on the frozen active set, or on the one decided here.
    pub(crate) fn solve_rate(
        &mut self,
        model: &dyn Model<T>,
        plan: &mut Plan<T>,
        state: &[T],
        memory: &NodeMemory<T>,
    ) -> Result<(), NodeError> {
        self.place_rate(model, plan, state, memory);
        let decided = if self.frozen {
            plan.rate.solve_frozen();
            true
        } else {
            plan.rate.taut_by_stretch();
            plan.rate.decide()
        };
        self.finish_rate(plan, decided)
    }

    /// Reads anchors, velocities and carried modes of a rate node and places it where the state has it.
    pub(crate) fn place_rate(
        &self,
        model: &dyn Model<T>,
        plan: &mut Plan<T>,
        state: &[T],
        memory: &NodeMemory<T>,
    ) {
        for (index, &(anchor, line)) in plan.legs.iter().enumerate() {
            if let Some(&numbers) = model.lines().get(line.line) {
                let place = triple(&self.ends, 6 * anchor);
                let velocity = triple(&self.ends, 6 * anchor + 3);
                plan.rate.set_leg(index, place, velocity, numbers);
            }
            let mode = memory.modes.get(line.line).copied().unwrap_or_default();
            let taut = matches!(mode, Mode::Active | Mode::Idle);
            plan.rate.set_mode(index, taut, mode == Mode::Active);
        }
        let rank = memory.ranks.get(plan.index).copied();
        plan.rate.hold_rank(rank.unwrap_or(3));
        if let Some(z) = plan.z {
            plan.p.copy_from_slice(triple(state, z).as_slice());
        }
        plan.rate.place(triple(&plan.p, 0), triple(&plan.load, 0));
    }

    /// Writes velocity, modes and holds of a rate node.
    pub(crate) fn finish_rate(
        &mut self,
        plan: &mut Plan<T>,
        decided: bool,
    ) -> Result<(), NodeError> {
        let Some(&node) = plan.nodes.first() else {
            return Ok(());
        };
        let velocity = plan.rate.velocity();
        self.nodes[3 * node..3 * node + 3].copy_from_slice(velocity.as_slice());
        for (leg, (_, line)) in plan.rate.legs().iter().zip(&plan.legs) {
            self.modes[line.line] = leg.mode();
            self.hold[line.line] = leg.mode().hold();
        }
        self.statistics.solves += 1;
        if plan.rate.unbalanced() {
            return Err(NodeError::Unsupported {
                node,
                why: "its load acts in a direction that no taut line spans; declare `equilibrium: stepwise`",
            });
        }
        NodeError::check_finite("velocity of a rate node", velocity.as_slice())?;
        match (decided, plan.rate.spread()) {
            (true, _) => Ok(()),
            // The singular approach: taut lines about to fall into one line or plane; ẏ grows without bound there.
            (false, Spread::Algebraic) => Err(NodeError::Unsupported {
                node,
                why: "its taut lines are falling into one line or plane, where its velocity is unbounded; declare `equilibrium: stepwise`",
            }),
            (false, _) => Err(NodeError::NotConverged {
                node,
                residual_n: f64::NAN,
                iterations: 0,
            }),
        }
    }

    /// Puts rate nodes whose carrying lines do not span space back on the line or plane through their anchors (rule 4), which an integration
    /// leaves at the order of the method, and those that reach it within the step (rule 5). Call it on an accepted state after the
    /// [`Nodes::solve`] at its end; `true`: the state changed, solve again.
    pub fn project(&self, state: &mut [T]) -> bool {
        let mut changed = false;
        for plan in self
            .plans
            .iter()
            .filter(|plan| plan.model == NodeModel::Rate)
        {
            let crossing = || plan.rate.crossing(self.span).map(|(place, _)| place);
            let target = plan.rate.projected().or_else(crossing);
            if let (Some(z), Some(p)) = (plan.z, target)
                && let Some(target) = state.get_mut(z..z + 3)
            {
                target.copy_from_slice(p.as_slice());
                changed = true;
            }
        }
        changed
    }
}
