//! The study: every model of the confluence flown on both test cases, measured against tight references.

use super::comparison::{END, TONE, TONE_STEP, errors, grid, options};
use super::motion::{MovingFlight, moving};
use super::prepare::{Prepared, Task, prepare};
use super::scene::{SceneInstant, TestCase};
use super::stability::StabilityLimit;
use super::variant::{Confluence, Damping, Flight, FlightError, FlightPlan, fly};
use crate::report::Spectrum;

/// The window of the paper's figures 4c and 5b [s].
pub const MIDWAY: [f64; 2] = [5.0, 6.0];
/// A tone counts from this amplitude [N].
const TONE_LEAST: f64 = 1e-3;

/// One run of the table.
#[derive(Clone, Debug)]
pub struct StudyRun {
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
    pub limit: StabilityLimit,
}

impl StudyRun {
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
pub struct TimedPair {
    /// The point with mass.
    pub mass: Contender,
    /// The equilibrium point.
    pub node: Contender,
}

impl TimedPair {
    /// How many times faster the equilibrium point is.
    #[must_use]
    pub fn speedup(&self) -> f64 {
        self.mass.wall_s_per_s / self.node.wall_s_per_s
    }
}

/// One side of a [`TimedPair`].
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
    pub runs: Vec<StudyRun>,
    /// Equal-error races, one for each replaced mass.
    pub races: Vec<TimedPair>,
    /// What is shown as it moves.
    pub moving: Vec<MovingFlight>,
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

/// The masses that are raced against the equilibrium point [kg].
const RACED: [f64; 2] = [0.1, 1.0];

/// Flies everything. `tell` is called with what is done next and the share that is done.
///
/// # Errors
/// What stopped a flight that must not stop.
pub fn study(mut tell: impl FnMut(&str, f64)) -> Result<Study, FlightError> {
    let end = fly(&FlightPlan::new(
        TestCase::Two,
        Confluence::Stepwise,
        options(0.01, false),
        END,
    ))?
    .end;
    let weight = capsule_weight(&end);
    let found = prepare(&tasks(), weight, |what, share| tell(what, 0.5 * share))?;
    let mut runs: Vec<StudyRun> = Vec::new();
    for case in CASES {
        for &(confluence, step, located) in TABLE {
            let share = runs.len() as f64 / (2 * TABLE.len()) as f64;
            tell(
                &format!("case {}, {confluence}, step {step} s", case.number()),
                0.5 + 0.3 * share,
            );
            runs.push(run(case, confluence, step, located, &found)?);
        }
    }
    tell("equal error, timed in turn", 0.8);
    let races = RACED
        .iter()
        .map(|&kg| race(Confluence::Mass(kg, Damping::On), RACER, &found));
    let races = races.collect::<Result<Vec<TimedPair>, FlightError>>()?;
    tell("drawing", 1.0);
    Ok(Study {
        runs,
        races,
        moving: moving()?,
        weight,
    })
}

/// The equilibrium point of the races.
const RACER: Confluence = Confluence::Euler;
const CASES: [TestCase; 2] = [TestCase::Two, TestCase::Three];

/// Everything to be found before the flights, each thing once, the long ones first.
fn tasks() -> Vec<Task> {
    let mut tasks = Vec::new();
    for &(confluence, ..) in TABLE {
        tasks.extend(CASES.map(|case| Task::Reference(case, confluence.exact())));
    }
    tasks.extend(RACED.map(|kg| Task::Accurate(Confluence::Mass(kg, Damping::On))));
    tasks.push(Task::Accurate(RACER));
    tasks.extend(
        TABLE
            .iter()
            .map(|&(confluence, ..)| Task::Limit(confluence)),
    );
    let mut once: Vec<Task> = Vec::new();
    for task in tasks {
        if !once.contains(&task) {
            once.push(task);
        }
    }
    once
}

/// One flight of the table, timed and measured against its reference.
fn run(
    case: TestCase,
    confluence: Confluence,
    step: f64,
    located: bool,
    found: &[(Task, Prepared)],
) -> Result<StudyRun, FlightError> {
    let flight =
        fly(&FlightPlan::new(case, confluence, options(step, located), END).sampled(&grid()))?;
    let known = |task: Task| {
        found
            .iter()
            .find(|(known, _)| *known == task)
            .map(|(_, found)| found)
    };
    let error = match known(Task::Reference(case, confluence.exact())) {
        Some(Prepared::Reference(reference)) => errors(&flight, reference),
        _ => [f64::NAN; 2],
    };
    let limit = match known(Task::Limit(confluence)) {
        Some(Prepared::Limit(limit)) => *limit,
        _ => StabilityLimit {
            taut: f64::NAN,
            whole: None,
        },
    };
    Ok(StudyRun {
        case,
        confluence,
        step,
        located,
        error,
        steady: flight.riser().last().copied().unwrap_or(f64::NAN),
        tone: tone(&flight),
        limit,
        flight,
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
fn capsule_weight(end: &SceneInstant) -> f64 {
    let height = 3_404_590.0 + end.q[9];
    761.0 * 4.2828e13 / (height * height)
}

/// Times two models in turn, each at its largest accurate step.
fn race(
    mass: Confluence,
    node: Confluence,
    found: &[(Task, Prepared)],
) -> Result<TimedPair, FlightError> {
    let accurate = |confluence| {
        let known = found
            .iter()
            .find(|(task, _)| *task == Task::Accurate(confluence));
        match known {
            Some((_, Prepared::Accurate(step, error))) => (*step, *error),
            _ => (f64::NAN, f64::NAN),
        }
    };
    let mut sides = [mass, node].map(|confluence| (confluence, accurate(confluence), Vec::new()));
    for _ in 0..5 {
        for (confluence, (step, _), walls) in &mut sides {
            let plan = FlightPlan::new(TestCase::Two, *confluence, options(*step, false), END);
            walls.push(fly(&plan)?.wall_s / END);
        }
    }
    let [mass, node] = sides.map(|(confluence, (step, error), walls)| Contender {
        confluence,
        step,
        error,
        wall_s_per_s: median(walls),
    });
    Ok(TimedPair { mass, node })
}

fn median(mut list: Vec<f64>) -> f64 {
    list.sort_by(f64::total_cmp);
    list.get(list.len() / 2).copied().unwrap_or(f64::NAN)
}
