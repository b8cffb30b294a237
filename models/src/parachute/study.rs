//! The study: every model of the confluence flown on both test cases, measured against tight references.

use mbd_runtime::Options;

use super::scene::{Instant, TestCase};
use super::stability::{Limit, largest_stable_step};
use super::variant::{Confluence, Damping, Flight, FlightError, Plan, fly};
use crate::report::Spectrum;

/// The end of every flight [s]. The paper's runs end near terminal speed; the riser carries the capsule's weight to 1e-3 only after 85 s.
pub const END: f64 = 100.0;
/// Relative tolerance of the reference runs.
pub const TIGHT: f64 = 1e-10;
/// The accuracy at which speeds are compared: riser force to this share of the steady force.
pub const EQUAL_ERROR: f64 = 1e-3;
/// The window of the paper's figures 4c and 5b [s].
pub const MIDWAY: [f64; 2] = [5.0, 6.0];
/// Where the spectrum of the force is taken [s], and its sampling [s]: fine enough for 1 kHz.
const TONE: [f64; 2] = [4.0, 6.0];
const TONE_STEP: f64 = 1.0 / 2048.0;
/// A tone counts from this amplitude [N].
const TONE_LEAST: f64 = 1e-3;

/// One run of the table.
#[derive(Clone, Debug)]
pub struct Run {
    /// The test case.
    pub case: TestCase,
    /// The model of the confluence.
    pub confluence: Confluence,
    /// The step [s].
    pub step: f64,
    /// Whether slack/taut switches were located.
    pub located: bool,
    /// The flight, sampled on [`grid`].
    pub flight: Flight,
    /// Largest difference of the riser force from the tight reference: whole run, and from 2 s on [N].
    pub error: [f64; 2],
    /// Riser force at the end [N].
    pub steady: f64,
    /// The highest frequency in the riser force midway and its amplitude [Hz, N].
    pub tone: Option<[f64; 2]>,
    /// Largest stable step.
    pub limit: Limit,
}

impl Run {
    /// Right-hand sides per simulated second.
    #[must_use]
    pub fn rhs_per_s(&self) -> f64 {
        self.flight.statistics.rhs as f64 / END
    }

    /// Wall time per simulated second [s/s].
    #[must_use]
    pub fn wall_s_per_s(&self) -> f64 {
        self.flight.wall_s / END
    }
}

/// Two runs that reach the same accuracy, timed in turn.
#[derive(Clone, Debug)]
pub struct Race {
    /// The point with mass.
    pub mass: Contender,
    /// The equilibrium point.
    pub node: Contender,
}

impl Race {
    /// How many times faster the equilibrium point is.
    #[must_use]
    pub fn speedup(&self) -> f64 {
        self.mass.wall_s_per_s / self.node.wall_s_per_s
    }
}

/// One side of a [`Race`].
#[derive(Clone, Copy, Debug)]
pub struct Contender {
    /// The model.
    pub confluence: Confluence,
    /// The largest step at which it is as accurate as asked [s].
    pub step: f64,
    /// Its riser-force error after 2 s [N].
    pub error: f64,
    /// Wall time per simulated second, the median of several runs [s/s].
    pub wall_s_per_s: f64,
}

/// Everything the report shows.
#[derive(Clone, Debug)]
pub struct Study {
    /// The runs, in the order of the table.
    pub runs: Vec<Run>,
    /// Equal-error races, one for each replaced mass.
    pub races: Vec<Race>,
    /// Weight of the capsule where it ends [N].
    pub weight: f64,
}

/// The models of the table and the steps they are flown at [s].
const TABLE: &[(Confluence, f64, bool)] = &[
    (Confluence::Mass(0.1, Damping::On), 1e-4, true),
    (Confluence::Mass(1.0, Damping::On), 1e-3, true),
    (Confluence::Mass(0.1, Damping::Off), 1e-4, false),
    (Confluence::Mass(1.0, Damping::Off), 1e-3, false),
    (Confluence::Static, 0.01, false),
    (Confluence::Stepwise, 0.01, false),
    (Confluence::Rate, 0.01, true),
];

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

/// Flies everything. `tell` is called with what is done next and the share that is done.
///
/// # Errors
/// What stopped a flight that must not stop.
pub fn study(mut tell: impl FnMut(&str, f64)) -> Result<Study, FlightError> {
    let times = grid();
    let total = (2 * TABLE.len()) as f64 + 3.0;
    let (mut runs, mut weight): (Vec<Run>, f64) = (Vec::new(), f64::NAN);
    for case in [TestCase::Two, TestCase::Three] {
        let mut references: Vec<(Confluence, Flight)> = Vec::new();
        for &(confluence, step, located) in TABLE {
            tell(
                &format!("case {}, {confluence}, step {step} s", case.number()),
                runs.len() as f64 / total,
            );
            let exact = confluence.exact();
            if !references.iter().any(|(known, _)| *known == exact) {
                references.push((
                    exact,
                    fly(&Plan::new(case, exact, tight(TIGHT), END).sampled(&times))?,
                ));
            }
            let reference = references
                .iter()
                .find(|(known, _)| *known == exact)
                .map(|(_, flight)| flight);
            let limit = match runs.iter().find(|run: &&Run| run.confluence == confluence) {
                Some(known) => known.limit,
                None => largest_stable_step(confluence)?,
            };
            let flight =
                fly(&Plan::new(case, confluence, options(step, located), END).sampled(&times))?;
            weight = capsule_weight(&flight.end);
            runs.push(Run {
                case,
                confluence,
                step,
                located,
                error: reference.map_or([f64::NAN; 2], |reference| errors(&flight, reference)),
                steady: flight.riser().last().copied().unwrap_or(f64::NAN),
                tone: tone(&flight),
                limit,
                flight,
            });
        }
    }
    let mut races = Vec::new();
    for kg in [0.1, 1.0] {
        tell(
            &format!("equal error, {kg} kg against the equilibrium point"),
            (runs.len() + races.len()) as f64 / total,
        );
        races.push(race(
            Confluence::Mass(kg, Damping::On),
            Confluence::Euler,
            weight,
        )?);
    }
    tell("drawing", 1.0);
    Ok(Study {
        runs,
        races,
        weight,
    })
}

/// Adaptive steps at a tight tolerance: the light point with mass keeps them at its stability limit, a million for 100 s.
#[must_use]
pub fn tight(rtol: f64) -> Options {
    Options {
        max_steps: u64::MAX,
        ..Options::tsit5(rtol)
    }
}

/// RK4 at a fixed step. The tables search for and cross the limit, so the watch is off where it would stop the search.
fn options(step: f64, located: bool) -> Options {
    Options {
        locate: located,
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

/// The highest frequency in the riser force between the times of [`TONE`].
fn tone(flight: &Flight) -> Option<[f64; 2]> {
    let rows = flight.times().iter().zip(flight.riser());
    let samples: Vec<f64> = rows
        .filter(|(time, _)| (TONE[0]..TONE[1]).contains(*time))
        .map(|(_, force)| *force)
        .collect();
    let peak = Spectrum::of(&samples, TONE_STEP)?.highest(1e-3, TONE_LEAST)?;
    Some([peak.frequency_hz, peak.amplitude])
}

/// m g at the end of a flight, from the declared planet [N].
fn capsule_weight(end: &Instant) -> f64 {
    let height = 3_404_590.0 + end.q[9];
    761.0 * 4.2828e13 / (height * height)
}

/// Finds the largest step at which each model is accurate, then times both in turn.
fn race(mass: Confluence, node: Confluence, weight: f64) -> Result<Race, FlightError> {
    let [mass_step, node_step] = [accurate_step(mass, weight)?, accurate_step(node, weight)?];
    let mut walls = [Vec::new(), Vec::new()];
    for _ in 0..5 {
        for (wall, (confluence, step)) in walls
            .iter_mut()
            .zip([(mass, mass_step.0), (node, node_step.0)])
        {
            wall.push(
                fly(&Plan::new(
                    TestCase::Two,
                    confluence,
                    options(step, false),
                    END,
                ))?
                .wall_s
                    / END,
            );
        }
    }
    let [mass_wall, node_wall] = walls.map(median);
    Ok(Race {
        mass: Contender {
            confluence: mass,
            step: mass_step.0,
            error: mass_step.1,
            wall_s_per_s: mass_wall,
        },
        node: Contender {
            confluence: node,
            step: node_step.0,
            error: node_step.1,
            wall_s_per_s: node_wall,
        },
    })
}

/// The largest of a ladder of steps (ratio 0.9) at which the riser force of case 2 is accurate from 2 s on, and its error.
fn accurate_step(confluence: Confluence, weight: f64) -> Result<(f64, f64), FlightError> {
    let times: Vec<f64> = (0..=136).map(|i| 2.0 + 0.5 * f64::from(i)).collect();
    let exact =
        fly(&Plan::new(TestCase::Two, confluence.exact(), tight(TIGHT), END).sampled(&times))?;
    let mut step = largest_stable_step(confluence)?.taut;
    loop {
        let plan = Plan::new(
            TestCase::Two,
            confluence,
            Options {
                watch: false,
                ..options(step, false)
            },
            END,
        )
        .sampled(&times);
        if let Ok(flight) = fly(&plan) {
            let error = errors(&flight, &exact)[1];
            if error <= EQUAL_ERROR * weight {
                return Ok((step, error));
            }
        }
        step *= 0.9;
    }
}

fn median(mut list: Vec<f64>) -> f64 {
    list.sort_by(f64::total_cmp);
    list.get(list.len() / 2).copied().unwrap_or(f64::NAN)
}
