//! Warm Newton of a network of one node whose stiffness certainly has full rank: what almost every solve is. What it does not end is left to the chain of
//! [`Solver`](super::Solver), which begins from the same place.

use mbd_scene::{At, Float, Quantity, Work};

use super::balance::norm;
use super::scene::NetworkPlan;
use super::solver::{Outcome, Strategy, Tolerance, WARM_STEPS};
use super::stage::{Nodes, Stage};
use super::warm::{Standing, direction_of_one};

impl<T: Float> Nodes<T> {
    /// The balance of one node from `plan.p` with the law in `plan.k`, `plan.l`, by the steps that the chain begins with, to the bit. `None` where these do
    /// not end it, or there are more nodes: `plan.p` is as it was.
    pub(super) fn balance_one(
        &mut self,
        stage: Stage<'_, T>,
        plan: &mut NetworkPlan<T>,
        work: &mut Work<T>,
    ) -> Option<Outcome<T>> {
        let (&[node], &[x, y, z]) = (plan.nodes.as_slice(), plan.p.as_slice()) else {
            return None;
        };
        let numbers = plan.k.iter().zip(&plan.l);
        for (line, (&k, &l)) in plan.lines.iter().zip(numbers) {
            let slots = self.effective.get_mut(2 * line.effective?..)?;
            *slots.first_chunk_mut()? = [k, l];
        }
        let targets = Tolerance::inside_step().warm();
        let load = norm(&plan.load);
        let what = Quantity::Equilibrium(plan.index);
        let here = plan.solver.evaluation_mut();
        let mut p = [x, y, z];
        for iterations in 0..=WARM_STEPS {
            *self.nodes.get_mut(3 * node..)?.first_chunk_mut()? = p;
            let at = At {
                time: stage.time,
                state: stage.state,
                nodes: &self.nodes,
                effective: &self.effective,
                hold: &self.hold,
                ends: &self.ends,
                inputs: stage.inputs,
                rows: &[],
            };
            stage.model.evaluate(what, &at, work, here.values_mut());
            let residual = norm(here.gradient());
            let outcome = match targets.judge(&here.pulls(), residual, load) {
                Standing { slack: true, .. } => Outcome::Slack { iterations },
                Standing { balanced: true, .. } => Outcome::Taut {
                    iterations,
                    residual,
                    strategy: Strategy::Warm,
                },
                _ if iterations == WARM_STEPS => return None,
                _ => {
                    let (delta, true) = direction_of_one(&here.of_one()?, T::EPSILON) else {
                        return None;
                    };
                    for (p, delta) in p.iter_mut().zip(delta.iter()) {
                        *p += *delta;
                    }
                    continue;
                }
            };
            plan.p.copy_from_slice(&p);
            if let Outcome::Slack { .. } = outcome {
                self.let_go(plan);
            }
            return Some(outcome);
        }
        None
    }

    /// Lines of a network that carries nothing have neither force nor stiffness.
    pub(super) fn let_go(&mut self, plan: &NetworkPlan<T>) {
        for at in plan.lines.iter().filter_map(|line| line.effective) {
            if let Some(slots) = self.effective.get_mut(2 * at..2 * at + 2) {
                slots.fill(T::zero());
            }
        }
    }
}
