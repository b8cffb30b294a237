//! What makes flights comparable: their times, tolerances and the error of one against another.

use mbd_runtime::Options;

use super::variant::Flight;

/// The end of every flight [s]. The paper's runs end near terminal speed; the riser carries the capsule's weight to 1e-3 only after 85 s.
pub const END: f64 = 100.0;
/// Relative tolerance of the reference runs.
pub const TIGHT: f64 = 1e-10;
/// The accuracy at which speeds are compared: riser force to this share of the steady force.
pub const EQUAL_ERROR: f64 = 1e-3;
/// Where the spectrum of the force is taken [s].
pub const TONE: [f64; 2] = [4.0, 6.0];
/// The sampling there [s]: fine enough for 1 kHz.
pub const TONE_STEP: f64 = 1.0 / 2048.0;

/// The times at which histories are kept and compared: fine in the first two seconds and midway, every 0.05 s elsewhere.
#[must_use]
pub fn grid() -> Vec<f64> {
    let stretch = |from: f64, to: f64, step: f64| {
        let count = ((to - from) / step).round() as usize;
        (0..count).map(move |i| from + i as f64 * step)
    };
    stretch(0.0, 2.0, 0.002)
        .chain(stretch(2.0, TONE[0], 0.05))
        .chain(stretch(TONE[0], TONE[1], TONE_STEP))
        .chain(stretch(TONE[1], END, 0.05))
        .chain([END])
        .collect()
}

/// Adaptive steps at a tight tolerance: the light point with mass keeps them at its stability limit, a million for 100 s.
#[must_use]
pub fn tight(rtol: f64) -> Options {
    Options {
        max_steps: u64::MAX,
        ..Options::tsit5(rtol)
    }
}

/// RK4 at a fixed step. Searches cross the stability limit on purpose, so the watch is off.
#[must_use]
pub fn options(step: f64, located: bool) -> Options {
    Options {
        locate: located,
        watch: false,
        ..Options::rk4(step)
    }
}

/// Largest difference of the riser force: over all rows, and from 2 s on [N].
#[must_use]
pub fn errors(flight: &Flight, reference: &Flight) -> [f64; 2] {
    let rows = flight
        .times()
        .iter()
        .zip(flight.riser())
        .zip(reference.riser());
    rows.fold([0.0; 2], |[whole, late], ((&time, force), exact)| {
        let difference = (force - exact).abs();
        [
            f64::max(whole, difference),
            if time >= 2.0 {
                f64::max(late, difference)
            } else {
                late
            },
        ]
    })
}
