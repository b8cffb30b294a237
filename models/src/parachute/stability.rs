//! The largest stable step, found by search: the riser force must stay within 1 % of a tight run.

use std::sync::OnceLock;

use mbd_runtime::Options;

use super::comparison::{END, tight};
use super::scene::{SceneInstant, TestCase};
use super::variant::{Confluence, Flight, FlightError, FlightPlan, fly};

/// How far the riser force may be off [1].
const WITHIN: f64 = 0.01;
/// The taut search starts here, in the smooth descent of case 2, and lasts so long [s].
const TAUT_START: f64 = 10.0;
const TAUT_SPAN: f64 = 4.0;

/// Largest stable steps of RK4 [s].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StabilityLimit {
    /// From a taut start, 4 s.
    pub taut: f64,
    /// Over the whole of case 2, force compared from 2 s on; only for damped lines (undamped bouncing is chaotic).
    pub whole: Option<f64>,
}

/// Searches the largest stable steps of RK4, switches not located.
///
/// # Errors
/// What stopped a tight run.
pub fn largest_stable_step(confluence: Confluence) -> Result<StabilityLimit, FlightError> {
    let taut = largest_taut_step(confluence)?;
    if !confluence.is_damped() {
        return Ok(StabilityLimit { taut, whole: None });
    }
    let end = END;
    let plan = FlightPlan::new(TestCase::Two, confluence.exact(), tight(1e-9), end);
    let exact = fly(&plan.sampled(&every(0.0, end, 0.01)))?;
    let passes = |step: f64| {
        let plan = FlightPlan::new(TestCase::Two, confluence, fixed(step), end).every_step();
        fly(&plan).is_ok_and(|flight| follows(&flight, &exact, 2.0))
    };
    Ok(StabilityLimit {
        taut,
        whole: Some(down_from(taut, passes)),
    })
}

/// Searches the largest stable step of RK4 from a taut start.
///
/// # Errors
/// What stopped a tight run.
pub fn largest_taut_step(confluence: Confluence) -> Result<f64, FlightError> {
    let from = taut_start()?;
    let until = TAUT_START + TAUT_SPAN;
    let plan = |confluence: Confluence, options: Options| FlightPlan {
        from: from.clone(),
        ..FlightPlan::new(TestCase::Two, confluence, options, until)
    };
    let tightly = plan(confluence.exact(), tight(1e-9));
    let exact = fly(&tightly.sampled(&every(TAUT_START, until, 0.001)))?;
    Ok(search(|step| {
        fly(&plan(confluence, fixed(step)).every_step())
            .is_ok_and(|flight| follows(&flight, &exact, TAUT_START))
    }))
}

/// The state of case 2 at 10 s, all lines taut, computed once.
fn taut_start() -> Result<SceneInstant, FlightError> {
    static START: OnceLock<SceneInstant> = OnceLock::new();
    if let Some(known) = START.get() {
        return Ok(known.clone());
    }
    let flight = fly(&FlightPlan::new(
        TestCase::Two,
        Confluence::Rate,
        tight(1e-10),
        TAUT_START,
    ))?;
    Ok(START.get_or_init(|| flight.end).clone())
}

fn fixed(step: f64) -> Options {
    Options {
        locate: false,
        watch: false,
        ..Options::rk4(step)
    }
}

fn every(from: f64, to: f64, step: f64) -> Vec<f64> {
    (0..=((to - from) / step).round() as usize)
        .map(|i| from + i as f64 * step)
        .collect()
}

/// Whether the riser force of every row from `since` on lies within 1 % of the (finely sampled) tight run.
fn follows(flight: &Flight, exact: &Flight, since: f64) -> bool {
    let (times, forces) = (exact.times(), exact.riser());
    flight
        .times()
        .iter()
        .zip(flight.riser())
        .filter(|(time, _)| **time >= since)
        .all(|(&time, &force)| {
            let after = times
                .partition_point(|t| *t < time)
                .clamp(1, times.len().max(2) - 1);
            let (Some(&[t0, t1]), Some(&[f0, f1])) =
                (times.get(after - 1..=after), forces.get(after - 1..=after))
            else {
                return false;
            };
            let expected = f0 + (f1 - f0) * (time - t0) / (t1 - t0);
            (force - expected).abs() <= WITHIN * expected.abs()
        })
}

/// Bisection between a step that passes and one that fails, to 1 %.
fn search(passes: impl Fn(f64) -> bool) -> f64 {
    let mut good = 2e-5;
    let mut bad = good;
    while bad < 0.5 && passes(bad) {
        good = bad;
        bad *= 2.0;
    }
    bisect(good, bad, passes)
}

/// The largest passing step at or below `limit`.
fn down_from(limit: f64, passes: impl Fn(f64) -> bool) -> f64 {
    let (mut good, mut bad) = (limit, limit);
    while good > 1e-6 && !passes(good) {
        bad = good;
        good *= 0.8;
    }
    bisect(good, bad, passes)
}

fn bisect(mut good: f64, mut bad: f64, passes: impl Fn(f64) -> bool) -> f64 {
    while bad > 1.01 * good {
        let middle = (good * bad).sqrt();
        if passes(middle) {
            good = middle;
        } else {
            bad = middle;
        }
    }
    good
}
