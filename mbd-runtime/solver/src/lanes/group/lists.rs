//! Lists of numbers in lanes.

use super::super::Lanes;

/// Zero in a lane in which all numbers of a list are finite, NaN in others; four sums, none of which waits for another.
pub(in crate::lanes) fn faults<L: Lanes>(list: &[L]) -> L {
    let zero = L::zero();
    let (chunks, rest) = list.as_chunks::<4>();
    let mut sums = [zero; 4];
    for chunk in chunks {
        for (sum, x) in sums.iter_mut().zip(chunk) {
            // 0 x is zero for a finite number and NaN for others.
            *sum = zero.fmadd(*x, *sum);
        }
    }
    for (sum, x) in sums.iter_mut().zip(rest) {
        *sum = zero.fmadd(*x, *sum);
    }
    let [a, b, c, d] = sums;
    (a + b) + (c + d)
}

/// Writes a list into a lane.
pub(in crate::lanes) fn set<L: Lanes>(lane: usize, lanes: &mut [L], list: &[f64]) {
    for (numbers, x) in lanes.iter_mut().zip(list) {
        if let Some(number) = numbers.numbers_mut().get_mut(lane) {
            *number = *x;
        }
    }
}

/// Reads a list out of a lane.
pub(in crate::lanes) fn get<L: Lanes>(lane: usize, lanes: &[L], list: &mut [f64]) {
    // By reference: a register is not copied for one of its numbers.
    for (x, numbers) in list.iter_mut().zip(lanes) {
        if let Some(number) = numbers.numbers().get(lane) {
            *x = *number;
        }
    }
}
