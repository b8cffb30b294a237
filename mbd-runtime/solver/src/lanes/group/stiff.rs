//! A step of the stiff method in lanes: derivatives, factor, stages and the rates at its end.

use std::convert::Infallible;

use mbd_scene::{Differentiated, Quantity, Variable};

use super::super::Lanes;
use super::super::form::LaneParameters;
use super::super::lockstep::normalise;
use super::Stages;
use super::lists::faults;
use crate::integrate::Rosenbrock;

/// What is known of the step beside what the method has.
pub(super) struct StiffEnds<L> {
    /// The largest | |q| − 1 | of a quaternion at the end, before it was normalised.
    pub drift: L,
    /// Zero in a lane in which every rate and every derivative is finite.
    pub faults: L,
}

/// Makes steps from states whose rates the method has.
pub(super) fn make<L: Lanes>(
    method: &mut Rosenbrock<L>,
    (form, stages): (&mut dyn LaneParameters<L>, &Stages<L>),
    [time, step]: [L; 2],
    state: &[L],
    quaternions: &[usize],
) -> StiffEnds<L> {
    let slopes = method.slopes_mut();
    slopes.fill(L::zero());
    let by_state = Quantity::Partial(Differentiated::Derivative, Variable::State);
    form.evaluate(by_state, &stages.at(time, state), slopes);
    let mut faults_so_far = faults(slopes);
    method.take_slopes(state);
    method.factor(step, |x| x);
    let rates = |[time, _]: [L; 2], trial: &[L], rates: &mut [L]| {
        form.evaluate(Quantity::Derivative, &stages.at(time, trial), rates);
        faults_so_far += faults(rates);
        Ok::<(), Infallible>(())
    };
    let Ok(()) = method.stages([time, step], |x| x, state, rates);
    let [next, last] = method.end_mut();
    let drift = normalise(quaternions, next);
    form.evaluate(Quantity::Derivative, &stages.at(time + step, next), last);
    StiffEnds {
        drift,
        faults: faults_so_far + faults(last),
    }
}
