//! The stages of a step of RK4 where the length of the state is known: compiled with the model, so that sums of stages are straight-line code and a step
//! asks for them once.

use mbd_scene::{At, Float, StageInputs, StepStages};

use super::{RK4, normalise};
use crate::list::{all_finite, combined};

/// How many stages there are inside a step.
pub(crate) const INNER: usize = 3;
/// The number of the stage at its end.
const LAST: usize = INNER + 1;

/// Makes the stages inside a step of a model whose state has N numbers by its `derivative`, and the last one where that is asked for; `false`: the lists have
/// other lengths, or the end of the step is not finite, which stages tell one by one: no rate that is not finite makes an end that is.
/// Inputs change inside a step only where the scene has some: `INPUTS`.
#[inline]
pub fn inner_stages<T: Float, const N: usize, const INPUTS: bool>(
    step: StepStages<'_, T>,
    mut derivative: impl FnMut(&At<'_, T>, &mut [T]),
) -> bool {
    let (rates, _) = step.rates.as_chunks_mut::<N>();
    let (Some([first, second, third, fourth, last]), Ok(next)) =
        (rates.first_chunk_mut(), <&mut [T; N]>::try_from(step.next))
    else {
        return false;
    };
    let start = (step.at, step.span);
    let inner: StageRates<'_, T, N> = (first, [second, third, fourth], next);
    if !make::<T, N, INPUTS>(start, step.inputs, inner, &mut derivative) {
        return false;
    }
    if let Some(end) = step.end {
        *end.drift = normalise(next, end.quaternions);
        make_stage(start, LAST, next, last, |_, at, out| derivative(&at, out));
        *end.made = all_finite(last);
    }
    true
}

/// The same of a model whose rates are the first N of R numbers that nodes are found with.
#[inline]
pub fn inner_rates<T: Float, const N: usize, const R: usize, const INPUTS: bool>(
    step: StepStages<'_, T>,
    mut find: impl FnMut(&At<'_, T>, &mut [T]),
) -> bool {
    let (rates, _) = step.rates.as_chunks_mut::<N>();
    let (Some([first, rates @ .., last]), Ok(next), Ok(found)) = (
        rates.first_chunk_mut::<{ LAST + 1 }>(),
        <&mut [T; N]>::try_from(step.next),
        <&mut [[T; R]; INNER]>::try_from(step.found.as_chunks_mut().0),
    ) else {
        return false;
    };
    let start = (step.at, step.span);
    let [second, third, fourth] = &mut *found;
    // Sums read them where they were found: a copy would be waited for.
    let inner: StageRates<'_, T, N> = (first, [second, third, fourth], next);
    if !make::<T, N, INPUTS>(start, step.inputs, inner, &mut find)
        || !found.iter().all(|found| (step.holds)(found))
    {
        return false;
    }
    for (rates, found) in rates.iter_mut().zip(found) {
        take(rates, found);
    }
    if let Some(end) = step.end {
        *end.drift = normalise(next, end.quaternions);
        make_stage(start, LAST, next, end.found, |_, at, out| find(&at, out));
        take(last, end.found);
        *end.made = all_finite(last) && (step.holds)(end.found);
    }
    true
}

/// Takes over the rates of a stage from what was found there.
#[inline(always)]
fn take<T: Float, const N: usize>(rates: &mut [T; N], found: &[T]) {
    if let Some(own) = found.first_chunk() {
        *rates = *own;
    }
}

/// The rates of the first stage, those of the stages inside the step as the first N numbers of their lists, and the state at its end.
type StageRates<'a, T, const N: usize> = (&'a [T; N], [&'a mut [T]; INNER], &'a mut [T; N]);

/// Makes the stages inside a step, and the state at its end. Where inputs are held no stage is handed to anything but the model, and none needs a place in memory.
#[inline(always)]
fn make<T: Float, const N: usize, const INPUTS: bool>(
    start: (At<'_, T>, [f64; 2]),
    inputs: Option<&mut dyn StageInputs<T>>,
    rates: StageRates<'_, T, N>,
    find: &mut impl FnMut(&At<'_, T>, &mut [T]),
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
    start: (At<'_, T>, [f64; 2]),
    (first, [second, third, fourth], next): StageRates<'_, T, N>,
    mut find: impl FnMut(f64, At<'_, T>, &mut [T]),
) -> bool {
    let (at, [_, over]) = start;
    let Ok(state) = <&[T; N]>::try_from(at.state) else {
        return false;
    };
    let h = T::from_f64(over);
    let [_, to_second, to_third, to_fourth, end] = &RK4.a;
    let k1 = first;
    let trial = combined(state, h, to_second, [k1]);
    make_stage(start, 1, &trial, second, &mut find);
    let Some(k2) = second.first_chunk() else {
        return false;
    };
    let trial = combined(state, h, to_third, [k1, k2]);
    make_stage(start, 2, &trial, third, &mut find);
    let Some(k3) = third.first_chunk() else {
        return false;
    };
    let trial = combined(state, h, to_fourth, [k1, k2, k3]);
    make_stage(start, 3, &trial, fourth, &mut find);
    let Some(k4) = fourth.first_chunk() else {
        return false;
    };
    *next = combined(state, h, end, [k1, k2, k3, k4]);
    all_finite(next)
}

/// Finds the rates of a stage, by its number.
#[inline(always)]
fn make_stage<T: Float, const N: usize>(
    (at, [from, over]): (At<'_, T>, [f64; 2]),
    number: usize,
    state: &[T; N],
    out: &mut [T],
    mut find: impl FnMut(f64, At<'_, T>, &mut [T]),
) {
    let time = from + RK4.c[number] * over;
    let at = At {
        time: T::from_f64(time),
        state,
        ..at
    };
    find(time, at, out);
}
