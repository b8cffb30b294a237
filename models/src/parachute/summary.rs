//! What the study found, as one table for people and one file for machines.

use serde::Serialize;

use super::comparison::EQUAL_ERROR;
use super::study::{Study, StudyRun, TimedPair};
use crate::report::{Cell, ReportTable};

/// `summary.json`.
#[derive(Clone, Debug, Serialize)]
pub struct ParachuteSummary {
    /// What was run.
    pub what: &'static str,
    /// Every run.
    pub runs: Vec<RunSummary>,
    /// Largest stable step of the equilibrium point over that of a point with mass.
    pub step_ratio: Vec<Ratio>,
    /// Wall time of a point with mass over that of the equilibrium point at equal error.
    pub speedup: Vec<Ratio>,
    /// Riser force at the end of case 2 over the weight of the capsule there.
    pub steady_over_weight: f64,
}

/// A ratio and the mass it was measured at.
#[derive(Clone, Debug, Serialize)]
pub struct Ratio {
    /// The ratio.
    pub value: f64,
    /// The mass that the equilibrium point replaces [kg].
    pub mass_kg: f64,
    /// Step of the point with mass [s].
    pub mass_dt_s: f64,
    /// Step of the equilibrium point [s].
    pub node_dt_s: f64,
    /// Model of the equilibrium point.
    pub node: &'static str,
}

/// One run of `summary.json`.
#[derive(Clone, Debug, Serialize)]
pub struct RunSummary {
    /// 2 or 3.
    pub case: u32,
    /// `mass`, `static`, `stepwise` or `rate`.
    pub node: &'static str,
    /// `damped`, `undamped`, and the difference formula.
    pub detail: &'static str,
    /// Mass of the confluence [kg]; 0 for an equilibrium point.
    pub mass_kg: f64,
    /// Step [s].
    pub dt_s: f64,
    /// Whether slack/taut switches were located.
    pub located: bool,
    /// Largest stable step from a taut start [s].
    pub max_stable_dt_s: f64,
    /// Largest stable step over the whole of case 2, damped lines only [s].
    pub max_stable_dt_whole_s: Option<f64>,
    /// Right-hand sides per simulated second.
    pub rhs_per_s: f64,
    /// Mean iterations of a node solve.
    pub newton_mean: f64,
    /// Most iterations of a node solve.
    pub newton_max: u64,
    /// Wall time per simulated second [s/s].
    pub wall_s_per_s: f64,
    /// Largest difference of the riser force from the tight reference, whole run [N].
    pub riser_error_n: f64,
    /// The same from 2 s on [N].
    pub riser_error_after_2s_n: f64,
    /// Riser force at the end, 100 s [N].
    pub steady_force_n: f64,
    /// Highest frequency in the riser force between 4 and 6 s [Hz].
    pub highest_frequency_hz: Option<f64>,
    /// Its amplitude [N].
    pub highest_frequency_amplitude_n: Option<f64>,
}

impl ParachuteSummary {
    /// Draws the study together.
    #[must_use]
    pub fn of(study: &Study) -> Self {
        let steady = study
            .runs
            .iter()
            .find(|run| run.confluence.node() == "stepwise")
            .map_or(f64::NAN, |run| run.steady);
        ParachuteSummary {
            what: "AAS 03-163, test cases 2 and 3, with assumed numbers where the paper's are lost",
            runs: study.runs.iter().map(RunSummary::of).collect(),
            step_ratio: study
                .races
                .iter()
                .map(|race| step_ratio(study, race))
                .collect(),
            speedup: study.races.iter().map(speedup).collect(),
            steady_over_weight: steady / study.weight,
        }
    }
}

impl RunSummary {
    fn of(run: &StudyRun) -> Self {
        let counters = run.flight.statistics;
        RunSummary {
            case: run.case.number(),
            node: run.confluence.node(),
            detail: run.confluence.detail(),
            mass_kg: run.confluence.mass_kg(),
            dt_s: run.step,
            located: run.located,
            max_stable_dt_s: run.limit.taut,
            max_stable_dt_whole_s: run.limit.whole,
            rhs_per_s: run.rhs_per_s(),
            newton_mean: counters.node_iterations_mean(),
            newton_max: counters.node_iterations_max,
            wall_s_per_s: run.wall_s_per_s(),
            riser_error_n: run.error[0],
            riser_error_after_2s_n: run.error[1],
            steady_force_n: run.steady,
            highest_frequency_hz: run.tone.map(|[hz, _]| hz),
            highest_frequency_amplitude_n: run.tone.map(|[_, n]| n),
        }
    }
}

/// Largest stable step of the stepwise node over that of the mass of a race.
fn step_ratio(study: &Study, race: &TimedPair) -> Ratio {
    let limit = |matches: &dyn Fn(&StudyRun) -> bool| {
        study
            .runs
            .iter()
            .find(|run| matches(run))
            .map_or(f64::NAN, |run| run.limit.taut)
    };
    let mass = limit(&|run| run.confluence == race.mass.confluence);
    let node = limit(&|run| run.confluence.node() == "stepwise");
    Ratio {
        value: node / mass,
        mass_kg: race.mass.confluence.mass_kg(),
        mass_dt_s: mass,
        node_dt_s: node,
        node: "stepwise",
    }
}

fn speedup(race: &TimedPair) -> Ratio {
    Ratio {
        value: race.speedup(),
        mass_kg: race.mass.confluence.mass_kg(),
        mass_dt_s: race.mass.step,
        node_dt_s: race.node.step,
        node: race.node.confluence.node(),
    }
}

/// The table of the terminal and of the report.
#[must_use]
pub fn table(study: &Study) -> ReportTable {
    let mut table = ReportTable::new("Every model of the confluence, both test cases")
        .column("case", "")
        .column("model", "")
        .column("mass", "kg")
        .number("step", "s", 3)
        .number("largest stable step", "s", 3)
        .number("right-hand sides", "1/s", 4)
        .number("node iterations, mean", "", 3)
        .column("max", "")
        .number("wall time", "µs/s", 3)
        .number("riser error", "N", 2)
        .number("after 2 s", "N", 2)
        .number("steady riser force", "N", 6)
        .number("highest frequency", "Hz", 3);
    for run in &study.runs {
        let counters = run.flight.statistics;
        let node = counters.node_solves > 0;
        table.push([
            Cell::Count(u64::from(run.case.number())),
            Cell::Text(format!(
                "{}, {}",
                run.confluence.node(),
                run.confluence.detail()
            )),
            if run.confluence.mass_kg() > 0.0 {
                Cell::Number(run.confluence.mass_kg())
            } else {
                Cell::Missing
            },
            Cell::Number(run.step),
            Cell::Number(run.limit.taut),
            Cell::Number(run.rhs_per_s()),
            if node {
                Cell::Number(counters.node_iterations_mean())
            } else {
                Cell::Missing
            },
            if node {
                Cell::Count(counters.node_iterations_max)
            } else {
                Cell::Missing
            },
            Cell::Number(1e6 * run.wall_s_per_s()),
            Cell::Number(run.error[0]),
            Cell::Number(run.error[1]),
            Cell::Number(run.steady),
            run.tone.map_or(Cell::Missing, |[hz, _]| Cell::Number(hz)),
        ]);
    }
    table
        .note("Step: RK4 at a fixed step; switches between slack and taut are located for mass (damped) and rate.")
        .note("Largest stable step: found by bisection, riser force within 1 % of a tight run over 4 s from a taut start (case 2 at 10 s), switches not located.")
        .note("Riser error: largest difference from a tight run of the same model (Tsit5, relative tolerance 1e-10, switches located). Undamped lines bounce for ever and amplify every error.")
        .note("Highest frequency: in the riser force between 4 and 6 s, amplitude at least 0.001 N and 0.1 % of the largest tone; – if there is none.")
}

/// The two ratios the study is about.
#[must_use]
pub fn ratios(study: &Study) -> ReportTable {
    let mut table = ReportTable::new("What the equilibrium point gains, by the mass it replaces")
        .column("replaced mass", "kg")
        .number("largest stable step, mass", "s", 3)
        .number("equilibrium point", "s", 3)
        .number("step ratio", "", 3)
        .number("step at equal error, mass", "s", 3)
        .number("equilibrium point ", "s", 3)
        .number("wall time, mass", "µs/s", 3)
        .number("equilibrium point  ", "µs/s", 3)
        .number("speed-up", "", 3);
    for race in &study.races {
        let ratio = step_ratio(study, race);
        table.push([
            Cell::Number(ratio.mass_kg),
            Cell::Number(ratio.mass_dt_s),
            Cell::Number(ratio.node_dt_s),
            Cell::Number(ratio.value),
            Cell::Number(race.mass.step),
            Cell::Number(race.node.step),
            Cell::Number(1e6 * race.mass.wall_s_per_s),
            Cell::Number(1e6 * race.node.wall_s_per_s),
            Cell::Number(race.speedup()),
        ]);
    }
    table.note(format!(
        "Equal error: the largest step of each at which the riser force of case 2 stays within {EQUAL_ERROR} of the steady force from 2 s on; \
         timed in turn, median of five. The gain depends on the mass that is replaced: a heavier point is less stiff."
    ))
}
