//! The consistent start of a run: where the nodes are, which lines carry, and the forces of a taut start.

use mbd_scene::laws::line as law;
use mbd_scene::{Clamp, Difference, Float, Model, Work};
use nalgebra::Vector3;

use super::balance::{Tie, Tied, triple};
use super::error::{NodeError, Uneven};
use super::memory::NodeMemory;
use super::scene::{ENDLESS, NetworkPlan, is_detached};
use super::solver::Tolerance;
use super::stage::{Nodes, Stage};
use super::stepwise::{History, effective};
use super::warm::{against, carried};
use crate::unilateral::{Mode, is_node_line};

/// The tiny step that finds the first forces of networks without a rate problem, as a part of the shortest C/K.
const TINY_STEP: f64 = 1e-4;

impl<T: Float> Nodes<T> {
    /// Places the nodes at the start of a run and writes the positions of `rate` nodes into the state: see [`Nodes::start_stage`].
    ///
    /// # Errors
    /// As there.
    #[allow(
        clippy::too_many_arguments,
        reason = "the arguments of a pure evaluation: when, where, what is carried, scratch"
    )]
    pub fn start(
        &mut self,
        model: &dyn Model<T>,
        time: T,
        state: &mut [T],
        inputs: &[T],
        guess: Option<&[T]>,
        memory: &mut NodeMemory<T>,
        work: &mut Work<T>,
    ) -> Result<(), NodeError> {
        let stage = Stage {
            model,
            time,
            state,
            inputs,
        };
        self.start_stage(stage, guess, memory, work)?;
        self.place_in(state);
        Ok(())
    }

    /// Starts a run at a state: places the nodes at `guess` (3 a node [m]) or, without one, where the undamped lines balance, searched from
    /// the stiffness-weighted mean of the anchors; decides all modes; finds the forces of damped taut lines from the rate problem, because
    /// starting from zero costs an order. [`Nodes::place_in`] then writes the positions of `rate` nodes into the state.
    ///
    /// # Errors
    /// [`NodeError`] for lines that are none, node models that cannot hold the scene, numbers that are not finite, or no balance.
    pub fn start_stage(
        &mut self,
        stage: Stage<'_, T>,
        guess: Option<&[T]>,
        memory: &mut NodeMemory<T>,
        work: &mut Work<T>,
    ) -> Result<(), NodeError> {
        memory.check(&self.layout)?;
        memory.step = T::zero();
        self.span = T::zero();
        memory.smooth.fill(false);
        memory.ranks.fill(3);
        let decided = memory.modes.iter_mut();
        let decided = decided.filter(|mode| **mode != Mode::Detached);
        decided.for_each(|mode| *mode = Mode::Free);
        if let Some(guess) = guess {
            NodeError::same_length("guess", guess.len(), self.nodes.len())?;
            NodeError::check_finite("guess", guess)?;
        }
        self.read_ends(stage, work)?;
        self.check_lines(stage.model)?;
        self.hold_modes(memory);
        self.each_plan(|nodes, plan| nodes.start_plan(stage, plan, guess, work))?;
        self.find_modes(stage, memory, work);
        self.find_stretches(stage.model.lines());
        memory.previous.fill(T::zero());
        memory.against.fill(T::zero());
        self.record(memory);
        Ok(())
    }

    /// Writes the positions of `rate` nodes into a state, as the last solve has them.
    pub fn place_in(&self, state: &mut [T]) {
        for plan in &self.plans {
            if let Some(target) = plan.z.and_then(|z| state.get_mut(z..z + 3)) {
                target.copy_from_slice(&plan.p);
            }
        }
    }

    fn check_lines(&self, model: &dyn Model<T>) -> Result<(), NodeError> {
        for (index, numbers) in model.lines().iter().enumerate() {
            if !is_node_line(&self.layout, index) {
                continue;
            }
            let n = numbers;
            NodeError::check_line(index, n.stiffness, n.damping, n.free_length)?;
            let declared = model.scene().lines.get(index);
            if let Some(why) = declared.and_then(|line| line.kind.not_at_node()) {
                return Err(NodeError::LineAtNode { line: index, why });
            }
        }
        for plan in &self.plans {
            let node = plan.nodes.first().copied().unwrap_or_default();
            let unlike = |&node: &usize| {
                let found = self.layout.nodes.get(node);
                found.is_some_and(|found| found.model != plan.model)
            };
            if plan.nodes.iter().any(unlike) {
                let why = "nodes joined by lines need the same `equilibrium`";
                return Err(NodeError::Unsupported { node, why });
            }
            if !plan.is_rate() {
                continue;
            }
            if !plan.is_single() {
                let why = "`equilibrium: rate` needs every line to end on a body, the world or a point with mass; declare `stepwise`";
                return Err(NodeError::Unsupported { node, why });
            }
            for (_, line) in &plan.legs {
                if let Some(numbers) = line.numbers(model)
                    && numbers.damping <= T::zero()
                {
                    return Err(NodeError::InvalidLine {
                        line: line.line,
                        what: "damping at a node with equilibrium: rate",
                        value: numbers.damping.to_f64(),
                    });
                }
            }
        }
        Ok(())
    }

    fn start_plan(
        &mut self,
        stage: Stage<'_, T>,
        plan: &mut NetworkPlan<T>,
        guess: Option<&[T]>,
        work: &mut Work<T>,
    ) -> Result<(), NodeError> {
        let model = stage.model;
        plan.set_law(model, &self.modes, |_, numbers| {
            [numbers.stiffness, numbers.free_length]
        });
        // A given z is where its node is.
        let given = |z| triple(stage.state, z);
        let given = plan.z.map(given).filter(|p| *p != triple(&[], 0));
        match (guess, given) {
            (Some(guess), _) => {
                for (&node, p) in plan.nodes.iter().zip(plan.p.chunks_exact_mut(3)) {
                    p.copy_from_slice(triple(guess, 3 * node).as_slice());
                }
            }
            (None, Some(place)) => plan.p.copy_from_slice(place.as_slice()),
            (None, None) => self.to_mean(plan),
        }
        if plan.is_rate() {
            if guess.is_none() && given.is_none() {
                self.balance_alone(plan)?;
            }
            let decided = self.decide_placed(model, plan);
            return self.finish_rate(plan, decided);
        }
        let damped = plan.lines.iter().any(|line| line.is_damped(model));
        let elastic = plan.stepwise().is_none() || !damped;
        if elastic || guess.is_none() {
            self.balance(stage, plan, work)?;
        }
        if elastic {
            self.start_velocities(plan, |nodes, local| {
                nodes.mean_velocity(plan.own_anchors[local].iter().copied())
            });
            return Ok(());
        }
        self.start_damped(stage, plan, work)
    }

    /// Gives the nodes whose lines are damped by differences their velocities.
    fn start_velocities(&mut self, plan: &NetworkPlan<T>, of: impl Fn(&Self, usize) -> Vector3<T>) {
        for (local, &node) in plan.nodes.iter().enumerate() {
            if let Some(at) = self.layout.nodes.get(node).and_then(|node| node.velocity) {
                let velocity = of(self, local);
                self.effective[at..at + 3].copy_from_slice(velocity.as_slice());
            }
        }
    }

    /// The velocity of anchors on the average.
    fn mean_velocity(&self, anchors: impl ExactSizeIterator<Item = usize>) -> Vector3<T> {
        let velocities = anchors.map(|anchor| triple(&self.ends, 6 * anchor + 3));
        carried(triple(&[], 0), velocities)
    }

    /// Each node at the mean of its anchors, weighted by the stiffness of their lines.
    fn to_mean(&self, plan: &mut NetworkPlan<T>) {
        for (local, own_anchors) in plan.own_anchors.iter().enumerate() {
            let (mut sum, mut total) = (triple(&[], 0), T::zero());
            for &anchor in own_anchors {
                let line = self.layout.anchors.get(anchor).map(|anchor| anchor.line);
                let place = plan.lines.iter().position(|own| Some(own.line) == line);
                let weight = place.and_then(|place| plan.k.get(place)).copied();
                let weight = weight.unwrap_or_default();
                sum += triple(&self.ends, 6 * anchor).map(|x| weight * x);
                total += weight;
            }
            if total > T::zero()
                && let Some(p) = plan.p.get_mut(3 * local..3 * local + 3)
            {
                p.copy_from_slice(sum.map(|x| x / total).as_slice());
            }
        }
    }

    /// Moves a rate node to the balance of its lines without damping.
    fn balance_alone(&mut self, plan: &mut NetworkPlan<T>) -> Result<(), NodeError> {
        let anchor = |(anchor, _): &(usize, _)| Tie::Anchor(triple(&self.ends, 6 * anchor).into());
        let ties = plan.legs.iter().map(|leg| [Tie::Node(0), anchor(leg)]);
        let mut balance = Tied {
            load: &plan.load,
            blocks: &[(0, 0)],
            lines: &ties.collect::<Vec<_>>(),
        };
        let tolerance = Tolerance::inside_step();
        let outcome = plan
            .solver
            .solve(&mut balance, &plan.k, &plan.l, &mut plan.p, tolerance);
        self.statistics.count(&outcome);
        outcome.check(plan.nodes.first().copied(), || {
            let uneven = plan.solver.uneven(&balance, &plan.k, &plan.l)?;
            let [softest, stiffest] =
                [uneven.softest, uneven.stiffest].map(|leg| plan.legs.get(leg));
            Some(Uneven {
                softest: softest?.1.line,
                stiffest: stiffest?.1.line,
                ..uneven
            })
        })
    }

    /// Decides which lines of a node carry, all taut ones assumed to at first; one that must lie between its anchors is put there.
    fn decide_placed(&self, model: &dyn Model<T>, plan: &mut NetworkPlan<T>) -> bool {
        plan.rate.hold_rank(3);
        plan.set_legs(model, &self.modes, &self.ends);
        let mut decided = decide(plan);
        if let Some(projected) = plan.rate.projected() {
            plan.p.copy_from_slice(projected.as_slice());
            plan.set_legs(model, &self.modes, &self.ends);
            decided = decide(plan);
        }
        decided
    }

    /// Forces of a damped stepwise network at its start, written as K (d − L_e) with the L_e that gives them.
    fn start_damped(
        &mut self,
        stage: Stage<'_, T>,
        plan: &mut NetworkPlan<T>,
        work: &mut Work<T>,
    ) -> Result<(), NodeError> {
        let model = stage.model;
        let all_damped = plan.lines.iter().all(|line| line.is_damped(model));
        if plan.is_single()
            && all_damped
            && triple(&plan.load, 0) == triple(&[], 0)
            && self.decide_placed(model, plan)
        {
            for (tension, leg) in plan.k.iter_mut().zip(plan.rate.legs()) {
                let pull = leg.pull.max(T::zero());
                *tension = if leg.active { pull } else { T::zero() };
            }
            self.carry_tensions(model, plan);
            self.start_velocities(plan, |_, _| plan.rate.velocity());
            return Ok(());
        }
        self.tiny_step(stage, plan, work)
    }

    /// The forces after one tiny first-order step: for networks, and for nodes with undamped lines or a load.
    fn tiny_step(
        &mut self,
        stage: Stage<'_, T>,
        plan: &mut NetworkPlan<T>,
        work: &mut Work<T>,
    ) -> Result<(), NodeError> {
        let model = stage.model;
        let damped = plan.lines.iter().filter(|line| line.is_damped(model));
        let relaxations = damped.filter_map(|line| line.numbers(model));
        let relaxations = relaxations.map(|numbers| numbers.damping / numbers.stiffness);
        let shortest = relaxations.reduce(|least, one| least.min(one));
        let span = shortest.unwrap_or_default() * T::from_f64(TINY_STEP);
        self.place(plan);
        let before = plan.p.clone();
        let (nodes, ends) = (&self.nodes, &self.ends);
        let stretches = plan.lines.iter().map(|line| {
            let free = line.numbers(model).map_or(T::zero(), |n| n.free_length);
            (line.line, plan.stretch(line, free, ends, nodes))
        });
        let stretches: Vec<(usize, T)> = stretches.collect();
        plan.set_law(model, &self.modes, |line, numbers| {
            let last = stretches.iter().find(|(own, _)| *own == line.line);
            let last = last.map_or(T::zero(), |(_, stretch)| *stretch);
            let history = History { last, before: None };
            effective(numbers, Difference::Euler, Clamp::Positive, span, history)
        });
        let ends = self.ends.clone();
        let anchors = 0..self.layout.anchors.len();
        let mean = self.mean_velocity(anchors.clone());
        for anchor in anchors {
            let slip = triple(&ends, 6 * anchor + 3) - mean;
            let moved = triple(&ends, 6 * anchor) + slip.map(|x| x * span);
            self.ends[6 * anchor..6 * anchor + 3].copy_from_slice(moved.as_slice());
        }
        let solved = self.balance(stage, plan, work);
        self.start_velocities(plan, |nodes, local| {
            let [before, now] = [(&before, local), (&nodes.nodes, plan.nodes[local])]
                .map(|(list, place)| triple(list, 3 * place));
            mean + against(now, before, span)
        });
        for (line, (k, l)) in plan.lines.iter().zip(plan.k.iter_mut().zip(&plan.l)) {
            let vector = line.vector(&self.ends, &self.nodes);
            *k = law::effective_tension(*k, law::geometry(&vector, *l).stretch);
        }
        self.ends = ends;
        solved?;
        self.carry_tensions(model, plan);
        self.rebalance(stage, plan, work)
    }

    /// Solves the balance once more with the carried numbers as the law: the tiny step moved the anchors, and momentum asks for exact balance.
    fn rebalance(
        &mut self,
        stage: Stage<'_, T>,
        plan: &mut NetworkPlan<T>,
        work: &mut Work<T>,
    ) -> Result<(), NodeError> {
        let mut is_law = true;
        for (line, (k, l)) in plan.lines.iter().zip(plan.k.iter_mut().zip(&mut plan.l)) {
            let at = line.effective.map_or(usize::MAX, |at| 2 * at);
            if let Some(&[stiffness, free_length]) = self.effective.get(at..at.saturating_add(2)) {
                is_law &= stiffness > T::zero() && free_length >= T::zero();
                (*k, *l) = (stiffness, free_length);
            }
        }
        if is_law {
            self.balance(stage, plan, work)?;
        }
        Ok(())
    }

    /// Writes the node positions of a plan where the model reads them.
    fn place(&mut self, plan: &NetworkPlan<T>) {
        for (&node, p) in plan.nodes.iter().zip(plan.p.chunks_exact(3)) {
            self.nodes[3 * node..3 * node + 3].copy_from_slice(p);
        }
    }

    /// Effective numbers which give the tensions in `plan.k` at the present node; all zero if nothing pulls.
    fn carry_tensions(&mut self, model: &dyn Model<T>, plan: &NetworkPlan<T>) {
        self.place(plan);
        let pulls = plan.k.iter().any(|&tension| tension > T::zero());
        for (line, &tension) in plan.lines.iter().zip(&plan.k) {
            let (Some(at), Some(numbers)) = (line.effective, line.numbers(model)) else {
                continue;
            };
            if is_detached(&self.modes, line) {
                let pair = [numbers.stiffness, T::from_f64(ENDLESS)];
                self.effective[2 * at..2 * at + 2].copy_from_slice(&pair);
                continue;
            }
            let vector = line.vector(&self.ends, &self.nodes);
            let length = law::geometry(&vector, numbers.free_length).length;
            let pair = if !pulls {
                [T::zero(); 2]
            } else if tension > T::zero() {
                [numbers.stiffness, length - tension / numbers.stiffness]
            } else {
                [numbers.stiffness, length.max(numbers.free_length)]
            };
            self.effective[2 * at..2 * at + 2].copy_from_slice(&pair);
        }
    }
}

/// Decides the active set of a plan's rate problem, all taut lines assumed active at first.
fn decide<T: Float>(plan: &mut NetworkPlan<T>) -> bool {
    (0..plan.legs.len()).for_each(|index| plan.rate.set_mode(index, true, true));
    plan.rate.taut_by_stretch();
    plan.rate.decide()
}
