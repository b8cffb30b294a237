//! Medians of many short batches, taken in turn.

use std::time::Instant;

/// Batches of each.
const ROUNDS: usize = 61;
/// Length of a batch [s]: shorter than the slices of time that a busy machine hands out.
const BATCH: f64 = 0.001;

/// Median time of one call of each [s].
pub fn medians<const N: usize>(calls: [&mut dyn FnMut(); N]) -> [f64; N] {
    let mut calls = calls.map(|call| {
        let mut count = 1u32;
        loop {
            let spent = batch(call, count);
            if spent > 0.5 * BATCH {
                break;
            }
            count *= 2;
        }
        (call, count, Vec::with_capacity(ROUNDS))
    });
    for _ in 0..ROUNDS {
        for (call, count, times) in &mut calls {
            times.push(batch(*call, *count) / f64::from(*count));
        }
    }
    calls.map(|(_, _, mut times)| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    })
}

fn batch(call: &mut dyn FnMut(), count: u32) -> f64 {
    let start = Instant::now();
    for _ in 0..count {
        call();
    }
    start.elapsed().as_secs_f64()
}

/// A time in µs, three digits.
pub fn microseconds(seconds: f64) -> String {
    let time = seconds * 1e6;
    let digits = (2 - time.log10().floor() as i32).clamp(0, 3) as usize;
    format!("{time:.digits$}")
}
