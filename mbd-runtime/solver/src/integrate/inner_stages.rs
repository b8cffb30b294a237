//! The stages inside a step of RK4 where the length of the state is known: compiled with the model, so that sums of stages are straight-line code and a step
//! asks for them once.

use mbd_scene::{At, Float, StageInputs, StepStages};

use super::RK4;
use crate::list::{all_finite, combined};

/// How many stages there are inside a step.
pub(crate) const INNER: usize = 3;

/// Makes the stages inside a step of a model whose state has N numbers by its `derivative`; `false`: the lists have other lengths, or the end of the step is
/// not finite, which stages tell one by one: no rate that is not finite makes an end that is.
/// Inputs change inside a step only where the scene has some: `INPUTS`.
#[inline]
pub fn inner_stages<T: Float, const N: usize, const INPUTS: bool>(
    step: StepStages<'_, T>,
    derivative: impl FnMut(&At<'_, T>, &mut [T]),
) -> bool {
    let (rates, _) = step.rates.as_chunks_mut::<N>();
    let Some([first, second, third, fourth]) = rates.first_chunk_mut() else {
        return false;
    };
    let rates: StageRates<'_, T, N> = (first, [second, third, fourth], step.next);
    make::<T, N, INPUTS>((step.at, step.span), step.inputs, rates, derivative)
}

/// The same of a model whose rates are the first N of R numbers that nodes are found with.
#[inline]
pub fn inner_rates<T: Float, const N: usize, const R: usize, const INPUTS: bool>(
    step: StepStages<'_, T>,
    find: impl FnMut(&At<'_, T>, &mut [T]),
) -> bool {
    let (rates, _) = step.rates.as_chunks_mut::<N>();
    let Some((first, rates)) = rates.split_first_mut() else {
        return false;
    };
    let (found, []) = step.found.as_chunks_mut::<R>() else {
        return false;
    };
    let Ok([second, third, fourth]) = <&mut [_; INNER]>::try_from(&mut *found) else {
        return false;
    };
    // Sums read them where they were found: a copy would be waited for.
    let inner: StageRates<'_, T, N> = (first, [second, third, fourth], step.next);
    let made = make::<T, N, INPUTS>((step.at, step.span), step.inputs, inner, find);
    for (rates, found) in rates.iter_mut().zip(found) {
        if let Some(own) = found.first_chunk() {
            *rates = *own;
        }
    }
    made
}

/// The rates of the first stage, those of the stages inside the step as the first N numbers of their lists, and the state at its end.
type StageRates<'a, T, const N: usize> = (&'a [T; N], [&'a mut [T]; INNER], &'a mut [T]);

/// Makes the stages inside a step, and the state at its end. Where inputs are held no stage is handed to anything but the model, and none needs a place in memory.
#[inline(always)]
fn make<T: Float, const N: usize, const INPUTS: bool>(
    start: (At<'_, T>, [f64; 2]),
    inputs: Option<&mut dyn StageInputs<T>>,
    rates: StageRates<'_, T, N>,
    mut find: impl FnMut(&At<'_, T>, &mut [T]),
) -> bool {
    match inputs {
        Some(functions) if INPUTS => make_by(start, rates, |time, at, out| {
            let inputs = functions.at_stage(time, &at);
            find(&At { inputs, ..at }, out);
        }),
        Some(_) => false,
        None => make_by(start, rates, |_, at, out| find(&at, out)),
    }
}

/// The same by what finds the rates at a time [s].
#[inline(always)]
fn make_by<T: Float, const N: usize>(
    (at, [from, over]): (At<'_, T>, [f64; 2]),
    (first, [second, third, fourth], next): StageRates<'_, T, N>,
    mut find: impl FnMut(f64, At<'_, T>, &mut [T]),
) -> bool {
    let (Ok(state), Ok(next)) = (<&[T; N]>::try_from(at.state), <&mut [T; N]>::try_from(next))
    else {
        return false;
    };
    let h = T::from_f64(over);
    let mut stage = |number: usize, trial: [T; N], out: &mut [T]| {
        let time = from + RK4.c[number] * over;
        let at = At {
            time: T::from_f64(time),
            state: &trial,
            ..at
        };
        find(time, at, out);
    };
    let [_, to_second, to_third, to_fourth, end] = &RK4.a;
    let k1 = first;
    stage(1, combined(state, h, to_second, [k1]), second);
    let Some(k2) = second.first_chunk() else {
        return false;
    };
    stage(2, combined(state, h, to_third, [k1, k2]), third);
    let Some(k3) = third.first_chunk() else {
        return false;
    };
    stage(3, combined(state, h, to_fourth, [k1, k2, k3]), fourth);
    let Some(k4) = fourth.first_chunk() else {
        return false;
    };
    *next = combined(state, h, end, [k1, k2, k3, k4]);
    all_finite(next)
}
