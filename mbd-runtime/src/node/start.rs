//! The consistent start of a run: where the nodes are, which lines carry, and the forces of a taut start.

use mbd_scene::laws::line as law;
use mbd_scene::{Float, Model, NodeModel, Work};

use super::confluence::{Tie, Web, WebLine};
use super::error::NodeError;
use super::memory::{Mode, NodeMemory};
use super::modes::is_node_line;
use super::scene::{Plan, triple, vector};
use super::solver::Tolerance;
use super::stage::{Nodes, Stage};

/// The tiny step that finds the first forces of networks without a rate problem, as a part of the shortest C/K.
const TINY_STEP: f64 = 1e-4;

impl<T: Float> Nodes<T> {
    /// Starts a run at `state`: places the nodes at `guess` (3 a node [m]) or, without one, where the undamped lines balance, searched from
    /// the stiffness-weighted mean of the anchors; decides all modes; finds the forces of damped taut lines from the rate problem, because
    /// starting from zero costs an order. Writes the positions of `rate` nodes into the state.
    ///
    /// # Errors
    /// [`NodeError`] for lines that are none, node models that cannot hold the scene, numbers that are not finite, or no balance.
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
        memory.check(&self.layout)?;
        memory.step = T::zero();
        self.span = T::zero();
        memory.smooth.fill(false);
        memory.ranks.fill(3);
        memory.modes.fill(Mode::Free);
        if let Some(guess) = guess {
            NodeError::same_length("guess", guess.len(), self.nodes.len())?;
            NodeError::check_finite("guess", guess)?;
        }
        self.read_ends(model, time, state, inputs, work)?;
        self.check_lines(model)?;
        self.hold_lines(model, memory);
        let mut plans = std::mem::take(&mut self.plans);
        let mut result = Ok(());
        for plan in &mut plans {
            result = self.start_plan((model, time, inputs), plan, state, guess, work);
            if result.is_err() {
                break;
            }
        }
        self.plans = plans;
        result?;
        self.find_modes(model, time, state, inputs, memory, work);
        self.find_stretches(model);
        memory.previous.fill(T::zero());
        self.record(memory);
        Ok(())
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
            if plan.model != NodeModel::Rate {
                continue;
            }
            if !plan.is_single() {
                let why = "`equilibrium: rate` needs every line to end on a body, the world or a point with mass; declare `stepwise`";
                return Err(NodeError::Unsupported { node, why });
            }
            for (_, line) in &plan.legs {
                if let Some(numbers) = model.lines().get(line.line)
                    && numbers.damping <= T::zero()
                {
                    return Err(NodeError::InvalidLine {
                        line: line.line,
                        what: "damping at a node with `equilibrium: rate`",
                        value: numbers.damping.to_f64(),
                    });
                }
            }
        }
        Ok(())
    }

    fn start_plan(
        &mut self,
        (model, time, inputs): (&dyn Model<T>, T, &[T]),
        plan: &mut Plan<T>,
        state: &mut [T],
        guess: Option<&[T]>,
        work: &mut Work<T>,
    ) -> Result<(), NodeError> {
        let damped = plan.lines.iter().any(|line| {
            let numbers = model.lines().get(line.line);
            numbers.is_some_and(|numbers| numbers.damping > T::zero())
        });
        for ((line, k), l) in plan.lines.iter().zip(&mut plan.k).zip(&mut plan.l) {
            if let Some(numbers) = model.lines().get(line.line) {
                (*k, *l) = (numbers.stiffness, numbers.free_length);
            }
        }
        // A given z is where its node is.
        let given = match (guess, plan.z) {
            (None, Some(z)) => Some(triple(state, z)).filter(|p| p.iter().any(|x| *x != T::zero())),
            _ => None,
        };
        match (guess, given) {
            (Some(guess), _) => {
                for (&node, p) in plan.nodes.iter().zip(plan.p.chunks_exact_mut(3)) {
                    p.copy_from_slice(triple(guess, 3 * node).as_slice());
                }
            }
            (None, Some(place)) => plan.p.copy_from_slice(place.as_slice()),
            (None, None) => self.to_mean(plan),
        }
        let elastic = plan.model == NodeModel::Static || !damped;
        if plan.model == NodeModel::Rate {
            if guess.is_none() && given.is_none() {
                self.balance_alone(plan)?;
            }
            if let Some(target) = plan.z.and_then(|z| state.get_mut(z..z + 3)) {
                target.copy_from_slice(&plan.p);
            }
            self.place_rate(model, plan, state, &NodeMemory::new(&self.layout));
            return self.start_rate(plan, state);
        }
        let stage = Stage {
            model,
            time,
            state,
            inputs,
        };
        if elastic || guess.is_none() {
            self.balance(&stage, plan, work)?;
        }
        if elastic {
            return Ok(());
        }
        self.start_damped(&stage, plan, work)
    }

    /// Each node at the mean of its anchors, weighted by the stiffness of their lines.
    fn to_mean(&self, plan: &mut Plan<T>) {
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
    fn balance_alone(&mut self, plan: &mut Plan<T>) -> Result<(), NodeError> {
        let anchor = |&(anchor, _): &(usize, _)| triple(&self.ends, 6 * anchor).into();
        let line = |(index, (&stiffness, &free_length))| WebLine {
            ends: [Tie::Node(0), Tie::Anchor(index)],
            stiffness,
            free_length,
        };
        let web = Web {
            anchors: plan.legs.iter().map(anchor).collect(),
            loads: vec![triple(&plan.load, 0).into()],
            lines: plan.k.iter().zip(&plan.l).enumerate().map(line).collect(),
        };
        let start = [triple(&plan.p, 0).into()];
        let found = web.solve(&start, Tolerance::inside_step())?;
        plan.p.copy_from_slice(found.nodes.as_flattened());
        self.statistics.count(&found.outcome);
        Ok(())
    }

    /// Decides which lines of a rate node carry, all taut ones assumed to at first; one that must lie between its anchors is put there.
    fn start_rate(&mut self, plan: &mut Plan<T>, state: &mut [T]) -> Result<(), NodeError> {
        let mut decided = decide(plan);
        if let Some(projected) = plan.rate.projected()
            && let Some(target) = plan.z.and_then(|z| state.get_mut(z..z + 3))
        {
            target.copy_from_slice(projected.as_slice());
            plan.p.copy_from_slice(projected.as_slice());
            plan.rate.place(projected, triple(&plan.load, 0));
            decided = decide(plan);
        }
        self.finish_rate(plan, decided)
    }

    /// Forces of a damped stepwise network at its start, written as K (d − L_e) with the L_e that gives them.
    fn start_damped(
        &mut self,
        stage: &Stage<'_, T>,
        plan: &mut Plan<T>,
        work: &mut Work<T>,
    ) -> Result<(), NodeError> {
        let model = stage.model;
        let all_damped = plan.lines.iter().all(|line| {
            let numbers = model.lines().get(line.line);
            numbers.is_some_and(|numbers| numbers.damping > T::zero())
        });
        if plan.is_single() && all_damped && triple(&plan.load, 0) == triple(&[], 0) {
            self.place_rate(model, plan, &[], &NodeMemory::new(&self.layout));
            let mut decided = decide(plan);
            if let Some(projected) = plan.rate.projected() {
                plan.p.copy_from_slice(projected.as_slice());
                plan.rate.place(projected, triple(&plan.load, 0));
                decided = decide(plan);
            }
            if decided {
                for (tension, leg) in plan.k.iter_mut().zip(plan.rate.legs()) {
                    let pull = leg.pull.max(T::zero());
                    *tension = if leg.active { pull } else { T::zero() };
                }
                self.carry_tensions(model, plan);
                return Ok(());
            }
        }
        self.tiny_step(stage, plan, work)
    }

    /// The forces after one tiny first-order step: for networks, and for nodes with undamped lines or a load.
    fn tiny_step(
        &mut self,
        stage: &Stage<'_, T>,
        plan: &mut Plan<T>,
        work: &mut Work<T>,
    ) -> Result<(), NodeError> {
        let model = stage.model;
        let mut span = None;
        for line in &plan.lines {
            if let Some(n) = model.lines().get(line.line)
                && n.damping > T::zero()
            {
                let relaxation = n.damping / n.stiffness;
                span = Some(span.map_or(relaxation, |least: T| least.min(relaxation)));
            }
        }
        let span = span.unwrap_or_default() * T::from_f64(TINY_STEP);
        self.place(plan);
        self.stretch_of(model, plan);
        Self::first_law(model, plan, span, &self.stretch);
        let ends = self.ends.clone();
        let mut mean = triple(&[], 0);
        let anchors = self.layout.anchors.len();
        for anchor in 0..anchors {
            mean += triple(&ends, 6 * anchor + 3);
        }
        let mean = mean.map(|x| x / T::from_f64(anchors.max(1) as f64));
        for anchor in 0..anchors {
            let slip = triple(&ends, 6 * anchor + 3) - mean;
            let moved = triple(&ends, 6 * anchor) + slip.map(|x| x * span);
            self.ends[6 * anchor..6 * anchor + 3].copy_from_slice(moved.as_slice());
        }
        let solved = self.balance(stage, plan, work);
        for (line, (k, l)) in plan.lines.iter().zip(plan.k.iter_mut().zip(&plan.l)) {
            let vector = vector(&line.ends, &self.ends, &self.nodes);
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
        stage: &Stage<'_, T>,
        plan: &mut Plan<T>,
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
    fn place(&mut self, plan: &Plan<T>) {
        for (&node, p) in plan.nodes.iter().zip(plan.p.chunks_exact(3)) {
            self.nodes[3 * node..3 * node + 3].copy_from_slice(p);
        }
    }

    /// Effective numbers which give the tensions in `plan.k` at the present node; all zero if nothing pulls.
    fn carry_tensions(&mut self, model: &dyn Model<T>, plan: &Plan<T>) {
        self.place(plan);
        let pulls = plan.k.iter().any(|&tension| tension > T::zero());
        for (line, &tension) in plan.lines.iter().zip(&plan.k) {
            let (Some(at), Some(numbers)) = (line.effective, model.lines().get(line.line)) else {
                continue;
            };
            let vector = vector(&line.ends, &self.ends, &self.nodes);
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
fn decide<T: Float>(plan: &mut Plan<T>) -> bool {
    for index in 0..plan.legs.len() {
        plan.rate.set_mode(index, true, true);
    }
    plan.rate.taut_by_stretch();
    plan.rate.decide()
}
