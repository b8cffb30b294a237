//! The nodes of a model at one stage of an integration step.

use std::ops::Range;

use mbd_scene::laws::LineNumbers;
use mbd_scene::laws::rate::NODE_CERTIFICATE;
use mbd_scene::{At, Float, Layout, Model, Quantity, Work};
use nalgebra::Vector3;

use super::balance::triple;
use super::error::NodeError;
use super::memory::NodeMemory;
use super::scene::{NetworkPlan, PlanLine, SceneBalance, is_detached, of_scene};
use super::solver::{Outcome, Strategy, Tolerance};
use super::stepwise::RateFormula;
use super::warm::{against, carried, predicted};
use crate::integrate::INNER;
use crate::list::copy;
use crate::unilateral::Mode;

/// The node unknowns, effective line numbers and line modes of one stage, with all the room their solve needs.
///
/// Carries nothing from step to step: what must persist is in [`NodeMemory`], so a rejected step cannot corrupt anything. From stage to stage of one trial
/// step goes where the search for the next node begins.
#[derive(Clone, Debug)]
pub struct Nodes<T: Float> {
    pub(crate) layout: Layout,
    pub(crate) plans: Vec<NetworkPlan<T>>,
    pub(crate) ends: Vec<T>,
    pub(crate) nodes: Vec<T>,
    pub(crate) effective: Vec<T>,
    pub(crate) hold: Vec<T>,
    /// Stretch of each node line at the last solve, once it has been asked for.
    pub(crate) stretch: Vec<T>,
    /// Free lengths of the lines at the last solve, while the stretches are not those of it.
    free_lengths: Vec<T>,
    /// Whether they are.
    pub(super) stretched: bool,
    /// Mode of each line, of each stop, of each joint that may be detached, at the last solve.
    pub(crate) modes: Vec<Mode>,
    /// `Quantity::Guards` of the last request.
    pub(crate) guards: Vec<T>,
    pub(crate) frozen: bool,
    /// Whether nothing is accepted or switched until it is said that it may be again.
    kept: bool,
    /// Whether the elements are held in the modes of the memory, and have been since it was kept.
    pub(super) held: bool,
    /// Whether they are held as nodes are found along with the derivative, in the modes that stand here.
    pub(super) held_for_rates: bool,
    /// Whether all lines of nodes carry in these.
    pub(super) all_carry: bool,
    /// Room for `Quantity::Rates`, no number before they are found; empty where the nodes are not found that way.
    pub(crate) rates: Vec<T>,
    /// The same at the stages inside a step.
    pub(super) inner: Vec<T>,
    /// Where it says of the nodes whether they hold.
    pub(super) certificates: Range<usize>,
    /// Whether the last solve found all nodes along with the derivative, by lines that span space.
    pub(crate) spanned: bool,
    /// Time since the last accepted step, of the last solve.
    pub(crate) span: T,
    /// How fast each node moves against its anchors, 3 a node [m/s]: as the stage before in the trial step shows it, at its start as the memory has it.
    pub(crate) against: Vec<T>,
    pub(crate) statistics: NodeStatistics,
}

/// When and where a model is evaluated.
#[derive(Clone, Copy)]
pub struct Stage<'a, T> {
    /// The model.
    pub model: &'a dyn Model<T>,
    /// Time [s].
    pub time: T,
    /// State x = [q | v | z].
    pub state: &'a [T],
    /// Inputs, in the order of `Layout::inputs`.
    pub inputs: &'a [T],
}

impl<'a, T: Float> Stage<'a, T> {
    /// What a model may read here, with nodes, effective numbers, holds and anchors of their own.
    #[inline]
    pub(super) fn at(&self, [nodes, effective, hold, ends]: [&'a [T]; 4]) -> At<'a, T> {
        At {
            nodes,
            effective,
            hold,
            ends,
            ..At::of_state(self.time, self.state, self.inputs)
        }
    }
}

/// Work of the solves so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NodeStatistics {
    /// Networks solved.
    pub solves: u64,
    /// Newton steps in all strategies.
    pub iterations: u64,
    /// The most Newton steps of one solve.
    pub most: usize,
    /// The highest strategy needed.
    pub strategy: Strategy,
    /// Solves that ended with every line slack.
    pub slack: u64,
}

impl<T: Float> Nodes<T> {
    /// Room for the nodes of a layout; the only allocation.
    #[must_use]
    pub fn new(layout: &Layout) -> Self {
        let list = |n: usize| vec![T::zero(); n];
        let first = layout.nx() + layout.len(Quantity::AnchorStates);
        Nodes {
            plans: NetworkPlan::of(layout),
            ends: list(layout.len(Quantity::AnchorStates)),
            nodes: list(3 * layout.nodes.len()),
            effective: list(layout.effective_numbers),
            hold: list(layout.origin_at()),
            stretch: list(layout.lines.len()),
            free_lengths: list(layout.lines.len()),
            stretched: true,
            modes: vec![Mode::Free; layout.holds()],
            guards: list(layout.len(Quantity::Guards)),
            frozen: false,
            kept: false,
            held: false,
            held_for_rates: false,
            all_carry: false,
            rates: vec![T::from_f64(f64::NAN); layout.len(Quantity::Rates)],
            inner: list(INNER * layout.len(Quantity::Rates)),
            certificates: first..first + NODE_CERTIFICATE * layout.nodes.len(),
            spanned: false,
            span: T::zero(),
            against: list(3 * layout.nodes.len()),
            statistics: NodeStatistics::default(),
            layout: layout.clone(),
        }
    }

    /// The node unknowns of the last solve, for [`At::nodes`]: 3 a node, position [m], or velocity [m/s] of a `rate` node.
    #[must_use]
    pub fn nodes(&self) -> &[T] {
        &self.nodes
    }

    /// K_e [N/m] and L_e [m] of the lines at the last solve, all zero for a slack network: no force, no stiffness; behind them velocities of nodes [m/s]. For
    /// [`At::effective`].
    #[must_use]
    pub fn effective(&self) -> &[T] {
        &self.effective
    }

    /// Modes of the last solve as numbers, for [`At::hold`].
    #[must_use]
    pub fn hold(&self) -> &[T] {
        &self.hold
    }

    /// `Quantity::AnchorStates` of the last solve, for [`At::ends`].
    #[inline]
    #[must_use]
    pub fn ends(&self) -> &[T] {
        match self.spanned {
            true => self.ends_along(),
            false => &self.ends,
        }
    }

    /// The same where they were found along with the rates.
    fn ends_along(&self) -> &[T] {
        let first = self.layout.nx();
        let along = self.rates.get(first..first + self.ends.len());
        along.unwrap_or(&self.ends)
    }

    /// Measures places from an origin that moves so: the numbers behind the others of [`At::hold`].
    pub(crate) fn measure_from(&mut self, origin: &[T]) {
        self.hold.truncate(self.layout.origin_at());
        self.hold.extend_from_slice(origin);
    }

    /// Counts the turns of angles from these values on [rad].
    pub(crate) fn set_turns(&mut self, angles: &[T]) {
        let own = self.hold.iter_mut().skip(self.layout.holds());
        own.zip(angles).for_each(|(own, angle)| *own = *angle);
    }

    /// Everything that a model without equilibrium points may read.
    #[inline]
    pub(crate) fn at_no_node<'a>(&'a self, time: T, state: &'a [T], inputs: &'a [T]) -> At<'a, T> {
        At {
            hold: &self.hold,
            ..At::of_state(time, state, inputs)
        }
    }

    /// Everything a model may read, with the unknowns of the last solve.
    #[inline]
    #[must_use]
    pub fn at<'a>(&'a self, time: T, state: &'a [T], inputs: &'a [T]) -> At<'a, T> {
        At {
            time,
            state,
            nodes: &self.nodes,
            effective: &self.effective,
            hold: &self.hold,
            ends: self.ends(),
            inputs,
            rows: &[],
        }
    }

    /// Work so far.
    #[must_use]
    pub fn statistics(&self) -> NodeStatistics {
        self.statistics
    }

    /// Whether the modes of damped lines stay as the memory holds them (`true`: runs with located events) or every stage decides anew.
    pub fn freeze(&mut self, frozen: bool) {
        (self.frozen, self.held_for_rates) = (frozen, false);
    }

    /// Whether the memory that solves are given stays as it is from here on: then it need not be read for every one of them.
    #[inline]
    pub(crate) fn keep(&mut self, kept: bool) {
        (self.kept, self.held) = (kept, false);
    }

    /// Holds the elements in the modes of the memory, unless that is done.
    #[inline]
    pub(crate) fn hold_once(&mut self, memory: &NodeMemory<T>) {
        if !self.held && !self.modes.is_empty() {
            self.hold_modes(memory);
            self.has_held();
        }
    }

    /// The elements are in the modes of the memory.
    #[inline]
    pub(super) fn has_held(&mut self) {
        self.held = self.kept;
    }

    /// Places the nodes at a time and a state: `span` is the time since the last accepted step, 0 at its start [s].
    ///
    /// # Errors
    /// [`NodeError`] for numbers that are not finite, lists of wrong length, or a network without a balance. The memory is only read.
    #[allow(
        clippy::too_many_arguments,
        reason = "the arguments of a pure evaluation: when, where, what is carried, scratch"
    )]
    pub fn solve(
        &mut self,
        model: &dyn Model<T>,
        time: T,
        span: T,
        state: &[T],
        inputs: &[T],
        memory: &NodeMemory<T>,
        work: &mut Work<T>,
    ) -> Result<(), NodeError> {
        let stage = Stage {
            model,
            time,
            state,
            inputs,
        };
        self.solve_stage(stage, span, memory, work)
    }

    /// [`Nodes::solve`] at a stage.
    ///
    /// # Errors
    /// As there.
    pub fn solve_stage(
        &mut self,
        stage: Stage<'_, T>,
        span: T,
        memory: &NodeMemory<T>,
        work: &mut Work<T>,
    ) -> Result<(), NodeError> {
        self.check_shape(stage)?;
        memory.check(&self.layout)?;
        self.enter(memory);
        self.solve_networks(stage, span, memory, work)
    }

    /// A trial step begins: nothing is known of it.
    pub(crate) fn enter(&mut self, memory: &NodeMemory<T>) {
        // `rate` nodes are not searched for.
        if self.spanned {
            return;
        }
        let known = memory.against.len().min(self.against.len());
        let (own, unknown) = self.against.split_at_mut(known);
        copy(&memory.against, own);
        unknown.fill(T::zero());
    }

    /// The same for lists of the right lengths.
    pub(super) fn solve_networks(
        &mut self,
        stage: Stage<'_, T>,
        span: T,
        memory: &NodeMemory<T>,
        work: &mut Work<T>,
    ) -> Result<(), NodeError> {
        self.span = span;
        self.hold_modes(memory);
        self.held = false;
        if self.plans.is_empty() {
            return Ok(());
        }
        self.read_anchors(stage, work)?;
        let result = self.each_plan(|nodes, plan| {
            if plan.is_rate() {
                return nodes.solve_rate(stage, plan, memory);
            }
            if plan.stepwise().is_some() && span <= T::zero() {
                nodes.restore(plan, memory);
                return Ok(());
            }
            nodes.law(stage.model, plan, span, memory);
            nodes.predict(plan, span, memory);
            let is_slack = nodes.balance(stage, plan, work)?;
            nodes.note_motion(plan, span, memory, is_slack);
            Ok(())
        });
        // Most stages are followed by others: the lines are measured where somebody asks.
        let lines = self.free_lengths.iter_mut().zip(stage.model.lines());
        lines.for_each(|(own, numbers)| *own = numbers.free_length);
        self.stretched = false;
        result
    }

    /// Does something with every network in turn, until one fails.
    pub(crate) fn each_plan(
        &mut self,
        mut act: impl FnMut(&mut Self, &mut NetworkPlan<T>) -> Result<(), NodeError>,
    ) -> Result<(), NodeError> {
        let mut plans = std::mem::take(&mut self.plans);
        let result = plans.iter_mut().try_for_each(|plan| act(self, plan));
        self.plans = plans;
        result
    }

    /// The networks of equilibrium points.
    pub(crate) fn plans(&self) -> &[NetworkPlan<T>] {
        &self.plans
    }

    /// Whether there are equilibrium points.
    #[inline]
    pub(crate) fn has_networks(&self) -> bool {
        !self.plans.is_empty()
    }

    /// Whether every network is one node whose position is solved for, so that warm Newton needs no factor.
    pub(crate) fn are_single(&self) -> bool {
        let single = |plan: &NetworkPlan<T>| !plan.is_rate() && plan.nodes.len() == 1;
        self.has_networks() && self.plans.iter().all(single)
    }

    /// Holds elements in the modes of the memory, where every network is a single node with all its lines; `false` where that is not so.
    pub(crate) fn hold_for_warm(&mut self, memory: &NodeMemory<T>) -> bool {
        let attached = |plan: &NetworkPlan<T>| {
            let mut lines = plan.lines.iter();
            lines.all(|line| !is_detached(&memory.modes, line))
        };
        let solves = self.are_single() && self.plans.iter().all(attached);
        if !solves || memory.check(&self.layout).is_err() {
            return false;
        }
        self.hold_modes(memory);
        true
    }

    /// Takes over nodes that were solved elsewhere at a stage, as if it had been done here: `fill` writes anchors and loads, nodes, effective line
    /// numbers, stretches, and how fast nodes move against their anchors.
    pub(crate) fn receive_warm(&mut self, span: T, fill: impl FnOnce([&mut [T]; 5])) {
        (self.span, self.spanned) = (span, false);
        // The stretches are those of this solve.
        self.stretched = true;
        let Nodes {
            ends,
            nodes,
            effective,
            stretch,
            against,
            ..
        } = self;
        fill([ends, nodes, effective, stretch, against]);
    }

    /// Whether there is no line, no stop and no equilibrium point.
    #[inline]
    pub(crate) fn is_idle(&self) -> bool {
        self.plans.is_empty() && self.stretch.is_empty() && self.modes.is_empty()
    }

    /// Writes the memory after an accepted step of length `h` [s] whose last solve was at its end.
    pub fn commit(&mut self, h: T, memory: &mut NodeMemory<T>) {
        if self.is_idle() || memory.check(&self.layout).is_err() {
            return;
        }
        self.accept(h, memory);
    }

    /// The same for the memory of a run, which has the shape of its layout, where there is a line, a stop or an equilibrium point.
    pub(crate) fn accept(&mut self, h: T, memory: &mut NodeMemory<T>) {
        if self.plans.is_empty() {
            // Lines that end at no node are the same before and after: their modes are those of the memory.
            memory.step = h;
            return;
        }
        if self.spanned {
            self.accept_rates(h, memory);
            return;
        }
        self.measure_lines();
        let zero = T::zero();
        for (plan, smooth) in self.plans.iter().zip(&mut memory.smooth) {
            let taut = |stretch: &[T], line: &PlanLine| {
                stretch.get(line.line).copied().unwrap_or_default() > zero
            };
            *smooth = plan
                .lines
                .iter()
                .all(|line| taut(&self.stretch, line) == taut(&memory.stretch, line));
        }
        std::mem::swap(&mut memory.previous, &mut memory.stretch);
        memory.step = h;
        memory.make_room();
        for plan in self.plans.iter().filter(|plan| plan.z.is_none()) {
            let is_smooth = memory.smooth.get(plan.index) == Some(&true);
            for at in plan.nodes.iter().flat_map(|node| 3 * node..3 * node + 3) {
                memory.against[at] = if is_smooth { self.against[at] } else { zero };
            }
        }
        self.record(memory);
    }

    /// Notes how fast the nodes of a network moved against their anchors up to a solve, `span` after the last accepted step, and the velocities of those whose
    /// lines are damped by differences. What begins the next search is not at all where the network is slack, and its nodes are anywhere.
    fn note_motion(
        &mut self,
        plan: &NetworkPlan<T>,
        span: T,
        memory: &NodeMemory<T>,
        is_slack: bool,
    ) {
        let zero = Vector3::zeros();
        let step = memory.smooth_step(plan.index);
        let formula = plan.stepwise().map(|how| RateFormula::new(how, span, step));
        for (&node, own_anchors) in plan.nodes.iter().zip(&plan.own_anchors) {
            let moved = match span <= T::zero() {
                true => zero,
                false => {
                    let place = triple(&self.nodes, 3 * node);
                    against(place, self.carried(node, own_anchors, memory), span)
                }
            };
            let known = if is_slack { zero } else { moved };
            self.against[3 * node..3 * node + 3].copy_from_slice(known.as_slice());
            let slot = self.layout.nodes.get(node).and_then(|node| node.velocity);
            if let (Some(at), Some(formula)) = (slot, &formula) {
                let anchors = own_anchors.iter();
                let anchors = anchors.map(|anchor| triple(&self.ends, 6 * anchor + 3));
                let before = triple(&memory.against, 3 * node);
                let velocity = formula.velocity(anchors, [moved, before]);
                self.effective[at..at + 3].copy_from_slice(velocity.as_slice());
            }
        }
    }

    /// An accepted node, carried with the mean displacement of its anchors since.
    fn carried(&self, node: usize, own_anchors: &[usize], memory: &NodeMemory<T>) -> Vector3<T> {
        let steps = own_anchors
            .iter()
            .map(|anchor| triple(&self.ends, 6 * anchor) - triple(&memory.anchors, 3 * anchor));
        carried(triple(&memory.nodes, 3 * node), steps)
    }

    /// Writes everything but the previous step into the memory.
    pub(crate) fn record(&mut self, memory: &mut NodeMemory<T>) {
        memory.stretch.copy_from_slice(&self.stretch);
        memory.nodes.copy_from_slice(&self.nodes);
        for plan in self.plans.iter().filter(|plan| plan.z.is_some()) {
            let crossing = plan.rate.crossing(self.span).filter(|it| it.taut);
            memory.ranks[plan.index] = crossing.map_or(plan.rate.rank(), |it| it.rank);
            for (&node, p) in plan.nodes.iter().zip(plan.p.chunks_exact(3)) {
                memory.nodes[3 * node..3 * node + 3].copy_from_slice(p);
            }
        }
        memory.before_straight = self.before_straight();
        memory.effective.copy_from_slice(&self.effective);
        memory.modes.copy_from_slice(&self.modes);
        for (carried, now) in memory
            .anchors
            .chunks_exact_mut(3)
            .zip(self.ends().chunks_exact(6))
        {
            carried.copy_from_slice(&now[..3]);
        }
    }

    pub(super) fn check_shape(&self, stage: Stage<'_, T>) -> Result<(), NodeError> {
        let lines = stage.model.lines().len();
        NodeError::same_length("state", stage.state.len(), self.layout.nx())?;
        NodeError::same_length("inputs", stage.inputs.len(), self.layout.ni)?;
        NodeError::same_length("lines", lines, self.layout.one_way())
    }

    /// Reads the anchors and loads of this stage.
    pub(crate) fn read_ends(
        &mut self,
        stage: Stage<'_, T>,
        work: &mut Work<T>,
    ) -> Result<(), NodeError> {
        self.spanned = false;
        self.check_shape(stage)?;
        match self.plans.is_empty() {
            true => Ok(()),
            false => self.read_anchors(stage, work),
        }
    }

    /// The same for lists of the right lengths.
    fn read_anchors(&mut self, stage: Stage<'_, T>, work: &mut Work<T>) -> Result<(), NodeError> {
        self.spanned = false;
        let mut ends = std::mem::take(&mut self.ends);
        let at = self.at(stage.time, stage.state, stage.inputs);
        stage
            .model
            .evaluate(Quantity::AnchorStates, &at, work, &mut ends);
        self.ends = ends;
        NodeError::check_finite("anchors and loads of the nodes", &self.ends)?;
        for plan in &mut self.plans {
            plan.read_loads(&self.ends, &self.layout);
        }
        Ok(())
    }

    /// Takes the modes of the memory, and holds the elements in them if modes are frozen, detached ones always; those of `rate` nodes are decided
    /// afterwards.
    pub(crate) fn hold_modes(&mut self, memory: &NodeMemory<T>) {
        self.held_for_rates = false;
        let slots = self.hold.iter_mut().zip(&mut self.modes);
        let slots = slots.zip(&memory.modes);
        match self.frozen {
            true => slots.for_each(|((hold, mode), carried)| {
                (*hold, *mode) = (carried.hold(), *carried);
            }),
            false => slots.for_each(|((hold, mode), carried)| {
                *mode = *carried;
                *hold = match *carried {
                    Mode::Detached => carried.hold(),
                    _ => T::zero(),
                };
            }),
        }
        if memory.held.is_empty() {
            return;
        }
        let locks = self.layout.holds().saturating_sub(memory.held.len());
        for (hold, held) in self.hold.iter_mut().skip(locks).zip(&memory.held) {
            *hold = *held;
        }
    }

    /// The start of a solve, `span` after the last accepted step.
    fn predict(&self, plan: &mut NetworkPlan<T>, span: T, memory: &NodeMemory<T>) {
        let is_single = plan.nodes.len() == 1;
        for ((&node, own_anchors), p) in plan
            .nodes
            .iter()
            .zip(&plan.own_anchors)
            .zip(plan.p.chunks_exact_mut(3))
        {
            let carried = self.carried(node, own_anchors, memory);
            let start = match is_single {
                true => predicted(carried, triple(&self.against, 3 * node), span),
                false => carried,
            };
            p.copy_from_slice(start.as_slice());
        }
    }

    /// The accepted node and forces again: the first stage of a step.
    fn restore(&mut self, plan: &NetworkPlan<T>, memory: &NodeMemory<T>) {
        for &node in &plan.nodes {
            let slots = 3 * node..3 * node + 3;
            self.nodes[slots.clone()].copy_from_slice(&memory.nodes[slots]);
        }
        let lines = plan.lines.iter().filter_map(|line| line.effective);
        let nodes = plan
            .nodes
            .iter()
            .filter_map(|&node| self.layout.nodes.get(node)?.velocity);
        let numbers = lines.map(|at| 2 * at..2 * at + 2);
        for slots in numbers.chain(nodes.map(|at| at..at + 3)) {
            self.effective[slots.clone()].copy_from_slice(&memory.effective[slots]);
        }
    }

    /// Solves the balance of a static or stepwise network from `plan.p` with the law in `plan.k`, `plan.l`; whether it is slack.
    pub(crate) fn balance(
        &mut self,
        stage: Stage<'_, T>,
        plan: &mut NetworkPlan<T>,
        work: &mut Work<T>,
    ) -> Result<bool, NodeError> {
        if let Some(outcome) = self.balance_one(stage, plan, work) {
            self.statistics.count(&outcome);
            return Ok(matches!(outcome, Outcome::Slack { .. }));
        }
        let mut balance = SceneBalance {
            stage,
            work,
            network: plan.index,
            members: &plan.nodes,
            lines: &plan.lines,
            load: &plan.load,
            ends: &self.ends,
            hold: &self.hold,
            nodes: &mut self.nodes,
            effective: &mut self.effective,
        };
        let outcome = plan.solver.solve(
            &mut balance,
            &plan.k,
            &plan.l,
            &mut plan.p,
            Tolerance::inside_step(),
        );
        let checked = outcome.check(plan.nodes.first().copied(), || {
            let uneven = plan.solver.uneven(&balance, &plan.k, &plan.l);
            uneven.and_then(|it| of_scene(it, &plan.lines))
        });
        balance.scatter(&plan.p, &plan.k, &plan.l);
        self.statistics.count(&outcome);
        let is_slack = matches!(outcome, Outcome::Slack { .. });
        if is_slack {
            self.let_go(plan);
        }
        checked.map(|()| is_slack)
    }

    /// The line law of a static or stepwise network at `span` after the last accepted step.
    fn law(
        &self,
        model: &dyn Model<T>,
        plan: &mut NetworkPlan<T>,
        span: T,
        memory: &NodeMemory<T>,
    ) {
        let step = memory.smooth_step(plan.index);
        let formula = plan.stepwise().map(|how| RateFormula::new(how, span, step));
        plan.set_law(model, &self.modes, |line, numbers| match &formula {
            Some(formula) => {
                let known = [&memory.stretch, &memory.previous];
                let of = |list: &Vec<T>| list.get(line.line).copied().unwrap_or_default();
                formula.law(numbers, known.map(of))
            }
            None => [numbers.stiffness, numbers.free_length],
        });
    }

    /// Measures the lines where the last solve put the nodes, unless that is done.
    fn measure_lines(&mut self) {
        if self.stretched {
            return;
        }
        self.stretched = true;
        let lengths = std::mem::take(&mut self.free_lengths);
        for plan in &self.plans {
            for line in &plan.lines {
                if let Some(free) = lengths.get(line.line) {
                    let stretch = plan.stretch(line, *free, &self.ends, &self.nodes);
                    self.stretch[line.line] = stretch;
                }
            }
        }
        self.free_lengths = lengths;
    }

    /// Stretches of the node lines with the nodes where the last solve put them.
    pub(crate) fn find_stretches(&mut self, lines: &[LineNumbers<T>]) {
        let own = self.free_lengths.iter_mut().zip(lines);
        own.for_each(|(own, numbers)| *own = numbers.free_length);
        self.stretched = false;
        self.measure_lines();
    }
}

impl NodeStatistics {
    /// Counts what solves cost that were made elsewhere.
    pub(crate) fn add(&mut self, iterations: u64, most: usize, slack: u64) {
        self.iterations += iterations;
        self.most = self.most.max(most);
        self.slack += slack;
    }

    /// Counts one solve.
    pub(crate) fn count<T: Float>(&mut self, outcome: &Outcome<T>) {
        self.solves += 1;
        self.iterations += outcome.iterations() as u64;
        self.most = self.most.max(outcome.iterations());
        match outcome {
            Outcome::Taut { strategy, .. } => self.strategy = self.strategy.max(*strategy),
            Outcome::Slack { .. } => self.slack += 1,
            Outcome::NotConverged { .. } => {}
        }
    }
}
