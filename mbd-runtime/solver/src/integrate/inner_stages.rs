//! The stages inside a step of RK4 where the length of the state is known: compiled with the model, so that sums of stages are straight-line code and a step
//! asks for them once.

use mbd_scene::{At, Float, StepStages};

use super::RK4;
use crate::list::combined;

/// How many stages there are inside a step.
pub(crate) const INNER: usize = 3;

/// Makes the stages inside a step of a model whose state has N numbers by its `derivative`; `false`: the lists have other lengths, and nothing is done.
#[inline]
pub fn inner_stages<T: Float, const N: usize>(
    step: StepStages<'_, T>,
    mut derivative: impl FnMut(&At<'_, T>, &mut [T]),
) -> bool {
    let StepStages {
        at,
        span: [from, over],
        rates,
        next,
        ..
    } = step;
    let (rates, _) = rates.as_chunks_mut::<N>();
    let (Ok(state), Some([k1, k2, k3, k4]), Ok(next)) = (
        <&[T; N]>::try_from(at.state),
        rates.first_chunk_mut(),
        <&mut [T; N]>::try_from(next),
    ) else {
        return false;
    };
    let h = T::from_f64(over);
    let mut stage = |number: usize, trial: [T; N], rates: &mut [T; N]| {
        let time = T::from_f64(from + RK4.c[number] * over);
        let at = At {
            time,
            state: &trial,
            ..at
        };
        derivative(&at, rates);
    };
    let [_, second, third, fourth, end] = &RK4.a;
    stage(1, combined(state, h, second, [k1]), k2);
    stage(2, combined(state, h, third, [k1, k2]), k3);
    stage(3, combined(state, h, fourth, [k1, k2, k3]), k4);
    *next = combined(state, h, end, [k1, k2, k3, k4]);
    true
}

/// The same of a model whose rates are the first N of R numbers that nodes are found with.
#[inline]
pub fn inner_rates<T: Float, const N: usize, const R: usize>(
    step: StepStages<'_, T>,
    mut find: impl FnMut(&At<'_, T>, &mut [T]),
) -> bool {
    let StepStages {
        at,
        span,
        rates,
        next,
        found,
    } = step;
    let mut found = match found.as_chunks_mut::<R>() {
        (found, []) if found.len() == INNER => found.iter_mut(),
        _ => return false,
    };
    let step = StepStages {
        at,
        span,
        rates,
        next,
        found: &mut [],
    };
    inner_stages::<T, N>(step, |at, rates| {
        if let Some(found) = found.next() {
            find(at, found);
            if let (Some(own), Ok(rates)) = (found.first_chunk(), <&mut [T; N]>::try_from(rates)) {
                *rates = *own;
            }
        }
    })
}
