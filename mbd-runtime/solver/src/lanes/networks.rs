//! Equilibrium points of several runs, solved beside each other: warm Newton until every lane has converged, each frozen when it is done.

use mbd_scene::laws::{LineNumbers, line};
use mbd_scene::{Layout, Quantity};
use nalgebra::Vector3;

use super::Lanes;
use super::form::LaneParameters;
use super::group::{Stages, faults, get as read, set};
use crate::node::{
    BalanceEvaluation, NetworkPlan, NodeMemory, Nodes, RateFormula, Tolerance, WARM_STEPS, triple,
    warm,
};
use crate::simulation::ModelRun;
use crate::simulation::beside::Spent;

/// The networks of several runs: what each remembers of its last accepted step, and what their solves cost.
pub(super) struct Networks<L> {
    lines: Vec<LineNumbers<L>>,
    nodes: Vec<L>,
    against: Vec<L>,
    /// The same as the stage before shows it.
    motion: Vec<L>,
    /// Where each node would be at the stage that moved as its anchors do on the average [m].
    carried: Vec<Vector3<L>>,
    anchors: Vec<L>,
    stretch: Vec<L>,
    previous: Vec<L>,
    /// Stretch of every line at the end of the step.
    end: Vec<L>,
    /// The step before per network [s]; zero where a line changed between slack and taut in it.
    steps: Vec<L>,
    /// The step before [s], and the effective numbers of the lines at its end.
    size: L,
    effective: Vec<L>,
    /// The law of the lines of each `stepwise` network at the last stage, and how long that is after the last accepted step [s]; `None` where their effective
    /// numbers are not those of it. Stages in the middle of a step of RK4 are both as late, and so are those at its end.
    formulas: Vec<Option<(L, RateFormula<L>)>>,
    /// Room for the balance of each network.
    balances: Vec<BalanceEvaluation<L>>,
    /// Newton steps so far, the most of one solve, and solves that ended slack.
    spent: [L; 3],
}

/// Flags of lanes: one where something holds, else zero.
pub(super) fn flag<L: Lanes>(mask: L::Mask) -> L {
    L::select(mask, L::one(), L::zero())
}

impl<L: Lanes> Networks<L> {
    pub(super) fn new(layout: &Layout) -> Self {
        let list = |length: usize| vec![L::zero(); length];
        let none = LineNumbers {
            stiffness: L::one(),
            damping: L::zero(),
            free_length: L::zero(),
        };
        let networks = layout.networks.iter();
        Networks {
            lines: vec![none; layout.lines.len()],
            nodes: list(3 * layout.nodes.len()),
            against: list(3 * layout.nodes.len()),
            motion: list(3 * layout.nodes.len()),
            carried: vec![Vector3::repeat(L::zero()); layout.nodes.len()],
            anchors: list(3 * layout.anchors.len()),
            stretch: list(layout.lines.len()),
            previous: list(layout.lines.len()),
            end: list(layout.lines.len()),
            steps: list(layout.networks.len()),
            size: L::zero(),
            effective: list(layout.effective_numbers),
            formulas: vec![None; layout.networks.len()],
            balances: networks
                .map(|network| BalanceEvaluation::new(network.nodes.len(), network.blocks.len()))
                .collect(),
            spent: [L::zero(); 3],
        }
    }

    /// Takes what a run remembers into a lane.
    pub(super) fn load(&mut self, lane: usize, run: &ModelRun<f64>) {
        let last = run.system.memory.last_step();
        set(lane, &mut self.nodes, last.nodes);
        set(lane, &mut self.against, last.against);
        set(lane, &mut self.anchors, last.anchors);
        set(lane, &mut self.stretch, last.stretch);
        set(lane, &mut self.previous, last.previous);
        set(lane, &mut self.effective, last.effective);
        put(lane, &mut self.size, last.step);
        for (step, smooth) in self.steps.iter_mut().zip(last.smooth) {
            put(lane, step, if *smooth { last.step } else { 0.0 });
        }
    }

    /// Gives a run back what it remembers.
    pub(super) fn unload(&self, lane: usize, memory: &mut NodeMemory<f64>) {
        read(lane, &self.nodes, &mut memory.nodes);
        memory.make_room();
        read(lane, &self.against, &mut memory.against);
        read(lane, &self.anchors, &mut memory.anchors);
        read(lane, &self.stretch, &mut memory.stretch);
        read(lane, &self.previous, &mut memory.previous);
        read(lane, &self.effective, &mut memory.effective);
        for (smooth, step) in memory.smooth.iter_mut().zip(&self.steps) {
            *smooth = step.lane(lane) > 0.0;
        }
        memory.step = self.size.lane(lane);
    }

    /// Finds the stretches of the lines with the nodes where the last stage has them.
    pub(super) fn find_stretches(&mut self, plans: &Nodes<f64>, stages: &Stages<L>) {
        for line in plans.plans().iter().flat_map(|plan| &plan.lines) {
            let own = (self.lines.get(line.line), self.end.get_mut(line.line));
            if let (Some(numbers), Some(end)) = own {
                let vector = line.vector(&stages.ends, &stages.nodes);
                *end = line::geometry(&vector, numbers.free_length).stretch;
            }
        }
    }

    /// How fast nodes moved against their anchors up to the last stage.
    pub(super) fn motion(&self) -> &[L] {
        &self.motion
    }

    /// The stretches that were found last.
    pub(super) fn stretches(&self) -> &[L] {
        &self.end
    }

    /// A step of a size is over in the lanes of a mask.
    pub(super) fn count(&mut self, mask: L::Mask, size: L) {
        self.size = L::select(mask, size, self.size);
    }

    /// Goes on from the end of a step of a size, in the lanes of a mask: what [`Nodes::commit`] does for a run.
    pub(super) fn go_on(&mut self, mask: L::Mask, plans: &Nodes<f64>, stages: &Stages<L>, size: L) {
        let taut = |list: &[L], line: usize| flag::<L>(L::zero().lt(get(list, line)));
        select(mask, &mut self.effective, 0, &stages.effective);
        for plan in plans.plans() {
            let unlike = plan.lines.iter().fold(L::zero(), |sum, line| {
                let [now, before] = [&self.end, &self.stretch].map(|list| taut(list, line.line));
                sum + (now - before).abs()
            });
            if let Some(step) = self.steps.get_mut(plan.index) {
                let smooth = L::select(unlike.le(L::zero()), size, L::zero());
                *step = L::select(mask, smooth, *step);
            }
            for &node in &plan.nodes {
                let here = triple(&stages.nodes, 3 * node);
                select(mask, &mut self.nodes, 3 * node, here.as_slice());
                let moved = triple(&self.motion, 3 * node);
                let known = moved.map(|x| L::select(unlike.le(L::zero()), x, L::zero()));
                select(mask, &mut self.against, 3 * node, known.as_slice());
            }
        }
        let all = self.previous.iter_mut().zip(&mut self.stretch);
        for ((previous, stretch), end) in all.zip(&self.end) {
            *previous = L::select(mask, *stretch, *previous);
            *stretch = L::select(mask, *end, *stretch);
        }
        let ends = stages.ends.chunks_exact(6);
        for (anchor, end) in self.anchors.chunks_exact_mut(3).zip(ends) {
            for (x, now) in anchor.iter_mut().zip(end) {
                *x = L::select(mask, *now, *x);
            }
        }
    }

    /// An accepted node, carried with the mean displacement of its anchors since.
    fn carried(&self, node: usize, own_anchors: &[usize], stages: &Stages<L>) -> Vector3<L> {
        warm::carried(
            triple(&self.nodes, 3 * node),
            own_anchors.iter().map(|anchor| {
                let [now, last] = [(&stages.ends, 6), (&self.anchors, 3)]
                    .map(|(list, width)| triple(list, width * anchor));
                now - last
            }),
        )
    }

    /// Takes the constants of its lines.
    pub(super) fn load_lines(&mut self, lane: usize, lines: &[LineNumbers<f64>]) {
        for (to, from) in self.lines.iter_mut().zip(lines) {
            put(lane, &mut to.stiffness, from.stiffness);
            put(lane, &mut to.damping, from.damping);
            put(lane, &mut to.free_length, from.free_length);
        }
    }

    /// A step begins: counts from here on, and knows nothing of it.
    pub(super) fn begin(&mut self) {
        self.spent = [L::zero(); 3];
        self.formulas.fill(None);
        self.motion.copy_from_slice(&self.against);
    }

    /// What the solves of a lane cost since [`Networks::begin`].
    pub(super) fn spent(&self, lane: usize) -> Spent {
        let [iterations, most, slack] = self.spent.map(|x| x.lane(lane) as u64);
        Spent {
            iterations,
            most: most as usize,
            slack,
        }
    }

    /// Places the nodes of a stage, `span` after the last accepted step; one in every lane where warm Newton found them.
    pub(super) fn solve(
        &mut self,
        form: &mut dyn LaneParameters<L>,
        plans: &Nodes<f64>,
        stages: &mut Stages<L>,
        (time, span, state): (L, L, &[L]),
    ) -> L {
        let mut ends = std::mem::take(&mut stages.ends);
        form.evaluate(Quantity::AnchorStates, &stages.at(time, state), &mut ends);
        let mut usable = flag::<L>(L::zero().le(faults(&ends)));
        stages.ends = ends;
        for plan in plans.plans() {
            let known = self.formulas.get(plan.index).and_then(Option::as_ref);
            let known = known.filter(|(then, _)| *then == span);
            let known = known.map(|(_, formula)| *formula);
            let formula = known.or_else(|| {
                let step = get(&self.steps, plan.index);
                Some(RateFormula::new(plan.stepwise()?, span, step))
            });
            if known.is_none() {
                self.lay_down(plan, stages, (formula.as_ref(), span));
            }
            self.begin_search(plan, stages, span);
            let [solved, is_slack] = self.descend(form, plan, stages, (time, state));
            usable *= solved;
            let formula = (formula.as_ref(), span);
            self.note_motion(plan, stages, (&plans.layout, formula), is_slack);
        }
        usable
    }

    /// The law of the lines.
    fn lay_down(
        &mut self,
        plan: &NetworkPlan<f64>,
        stages: &mut Stages<L>,
        (formula, span): (Option<&RateFormula<L>>, L),
    ) {
        for line in &plan.lines {
            let (Some(numbers), Some(at)) = (self.lines.get(line.line), line.effective) else {
                continue;
            };
            let law = match formula {
                Some(formula) => {
                    let known = [&self.stretch, &self.previous];
                    formula.law(numbers, known.map(|list| get(list, line.line)))
                }
                None => [numbers.stiffness, numbers.free_length],
            };
            if let Some(slots) = stages.effective.get_mut(2 * at..2 * at + 2) {
                slots.copy_from_slice(&law);
            }
        }
        if let Some(known) = self.formulas.get_mut(plan.index) {
            *known = formula.map(|formula| (span, *formula));
        }
    }

    /// Where the search for the nodes begins.
    fn begin_search(&mut self, plan: &NetworkPlan<f64>, stages: &mut Stages<L>, span: L) {
        for (&node, own_anchors) in plan.nodes.iter().zip(&plan.own_anchors) {
            let carried = self.carried(node, own_anchors, stages);
            let against = triple(&self.motion, 3 * node);
            place(stages, node, &warm::predicted(carried, against, span));
            if let Some(slot) = self.carried.get_mut(node) {
                *slot = carried;
            }
        }
    }

    /// Notes how fast the nodes of a network moved against their anchors up to a solve, not at all where it is slack, and the velocities of those whose lines
    /// are damped by differences: what [`Nodes`] does for a run.
    fn note_motion(
        &mut self,
        plan: &NetworkPlan<f64>,
        stages: &mut Stages<L>,
        (layout, (formula, span)): (&Layout, (Option<&RateFormula<L>>, L)),
        is_slack: L,
    ) {
        let slack = L::zero().lt(is_slack);
        for (&node, own_anchors) in plan.nodes.iter().zip(&plan.own_anchors) {
            let Some(carried) = self.carried.get(node) else {
                continue;
            };
            let moved = warm::against(triple(&stages.nodes, 3 * node), *carried, span);
            let known = moved.map(|x| L::select(slack, L::zero(), x));
            if let Some(own) = self.motion.get_mut(3 * node..3 * node + 3) {
                own.copy_from_slice(known.as_slice());
            }
            let slot = layout.nodes.get(node).and_then(|node| node.velocity);
            if let (Some(at), Some(formula)) = (slot, formula) {
                let anchors = own_anchors.iter();
                let anchors = anchors.map(|anchor| triple(&stages.ends, 6 * anchor + 3));
                let before = triple(&self.against, 3 * node);
                let velocity = formula.velocity(anchors, [moved, before]);
                if let Some(own) = stages.effective.get_mut(at..at + 3) {
                    own.copy_from_slice(velocity.as_slice());
                }
            }
        }
    }

    /// Newton from there; one in every lane that came to an end, and in every one that is slack.
    fn descend(
        &mut self,
        form: &mut dyn LaneParameters<L>,
        plan: &NetworkPlan<f64>,
        stages: &mut Stages<L>,
        (time, state): (L, &[L]),
    ) -> [L; 2] {
        let (zero, one) = (L::zero(), L::one());
        let epsilon = L::from_f64(f64::EPSILON);
        let (Some(&node), Some(balance)) = (plan.nodes.first(), self.balances.get_mut(plan.index))
        else {
            return [zero; 2];
        };
        let targets = Tolerance::<f64>::inside_step().warm().map(L::from_f64);
        let load = triple(&stages.ends, 6 * (self.anchors.len() / 3) + 3 * node);
        let (load, certain) = warm::certain_norm(&load.into(), epsilon);
        let mut usable = flag::<L>(certain);
        let (mut active, mut is_slack, mut iterations) = (usable, zero, zero);
        let what = Quantity::Equilibrium(plan.index);
        let mut here = triple(&stages.nodes, 3 * node);
        for step in 0..=WARM_STEPS {
            form.evaluate(what, &stages.at(time, state), balance.values_mut());
            let Some(at_node) = balance.of_one() else {
                return [zero; 2];
            };
            let (residual, certain) = warm::certain_norm(&at_node.gradient, epsilon);
            let standing = targets.judge(&at_node.pulls, residual, load);
            let slack = active * flag::<L>(standing.slack);
            let done = L::select(standing.slack, one, flag::<L>(standing.balanced));
            is_slack += slack;
            // A lane whose residual has no certain size is left to its run, and so is one whose direction follows other rules.
            let certain = flag::<L>(certain);
            let looks_on = active * certain * (one - done);
            let (delta, found) = match step < WARM_STEPS && is_any(looks_on) {
                true => {
                    let (delta, regular) = warm::direction_of_one(&at_node, epsilon);
                    (delta, flag::<L>(regular))
                }
                false => (Vector3::repeat(zero), zero),
            };
            let goes_on = looks_on * found;
            usable -= active * (one - certain * L::select(zero.lt(done), one, found));
            active = goes_on;
            if !is_any(active) {
                break;
            }
            let moves = zero.lt(active);
            here = here.zip_map(&delta, |p, delta| L::select(moves, p + delta, p));
            place(stages, node, &here);
            iterations += active;
        }
        // Few are.
        let slackened = match is_any(is_slack) {
            true => {
                self.formulas.fill(None);
                plan.lines.as_slice()
            }
            false => &[],
        };
        for at in slackened.iter().filter_map(|line| line.effective) {
            let slots = stages.effective.get_mut(2 * at..2 * at + 2);
            for x in slots.unwrap_or_default() {
                *x = L::select(zero.lt(is_slack), zero, *x);
            }
        }
        let [all, most, slack] = self.spent;
        self.spent = [all + iterations, most.max(iterations), slack + is_slack];
        [usable, is_slack]
    }
}

/// Whether a flag is set in some lane.
pub(super) fn is_any<L: Lanes>(flags: L) -> bool {
    L::is_any(L::zero().lt(flags))
}

fn place<L: Lanes>(stages: &mut Stages<L>, node: usize, place: &Vector3<L>) {
    if let Some(slots) = stages.nodes.get_mut(3 * node..3 * node + 3) {
        slots.copy_from_slice(place.as_slice());
    }
}

/// Writes numbers into a list from a place on, in the lanes of a mask.
fn select<L: Lanes>(mask: L::Mask, list: &mut [L], at: usize, numbers: &[L]) {
    for (x, number) in list.iter_mut().skip(at).zip(numbers) {
        *x = L::select(mask, *number, *x);
    }
}

/// Writes a number into a lane.
pub(super) fn put<L: Lanes>(lane: usize, lanes: &mut L, x: f64) {
    if let Some(number) = lanes.numbers_mut().get_mut(lane) {
        *number = x;
    }
}

fn get<L: Lanes>(list: &[L], at: usize) -> L {
    list.get(at).copied().unwrap_or_else(L::zero)
}
