//! The extremes: mass ratios, stiffness, damping, spin, steps that are too long, flat linkages, slack lines, drift, single precision, far from the
//! origin, other units, long runs and runs back. A run of each keeps its energy, its momentum or its start within a bound, or is stopped by a typed
//! error: what counts is that no number is wrong without a word.

mod cases;

use std::fmt;
use std::io;
use std::path::Path;

use mbd_compiler::read_text;
use mbd_runtime::{Generic, Options, Quantity, RunError, Scalar, Simulation};

pub use cases::cases;

use mbd_report::files::{make_folder, write_text};
use mbd_report::{Cell, Report, ReportTable};

/// What is looked at in a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExtremeMeasure {
    /// Energy made or lost, over the energy that moved: the most at any step.
    Energy,
    /// What of it never comes back: the least of the last tenth of the run.
    LostForGood,
    /// The change of angular momentum about the world origin, over the one at the start.
    Momentum,
    /// The largest deviation of a quaternion from length 1.
    Quaternion,
    /// The distance from the start after a run out, with all speeds reversed, and back [m, m/s, rad/s].
    Return,
}

impl fmt::Display for ExtremeMeasure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            ExtremeMeasure::Energy => "energy",
            ExtremeMeasure::LostForGood => "energy in the end",
            ExtremeMeasure::Momentum => "angular momentum",
            ExtremeMeasure::Quaternion => "unit quaternions",
            ExtremeMeasure::Return => "way back to the start",
        })
    }
}

/// What a case must do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Promise {
    /// Reach its end with the measure at most this.
    Keeps(f64),
    /// That, or be stopped by a typed error.
    KeepsOrStops(f64),
    /// Be stopped by the typed error of this status.
    Stops(&'static str),
}

/// One case.
#[derive(Clone, Debug)]
pub struct ExtremeCase {
    /// What is extreme: `stiffness`, `spin`, ….
    pub group: &'static str,
    /// How much.
    pub amount: String,
    /// The declaration.
    pub text: String,
    /// Numbers of the state that differ from the declared start.
    pub start: Vec<(usize, f64)>,
    /// How it is run.
    pub options: Options,
    /// To when [s].
    pub until: f64,
    /// Whether in single precision.
    pub single: bool,
    /// What is looked at.
    pub measure: ExtremeMeasure,
    /// What it must do.
    pub promise: Promise,
}

/// What came of a case.
#[derive(Clone, Debug, PartialEq)]
pub enum CaseOutcome {
    /// It reached its end; the measure.
    Ran(f64),
    /// It was stopped by the typed error of this status, with its sentence.
    Stopped(&'static str, String),
}

impl ExtremeCase {
    /// What it must do, in words.
    #[must_use]
    pub fn promised(&self) -> String {
        match self.promise {
            Promise::Keeps(bound) => format!("{} to {bound:.0e}", self.measure),
            Promise::KeepsOrStops(bound) => format!("{} to {bound:.0e}, or stopped", self.measure),
            Promise::Stops(status) => format!("stopped: {status}"),
        }
    }

    /// Runs it.
    ///
    /// # Errors
    /// A declaration that cannot be read: the case itself is wrong.
    pub fn run(&self) -> Result<CaseOutcome, String> {
        let outcome = match self.single {
            true => self.fly::<f32>()?,
            false => self.fly::<f64>()?,
        };
        Ok(match outcome {
            Ok(lost) => CaseOutcome::Ran(lost),
            Err(error) => CaseOutcome::Stopped(error.cause.status(), error.cause.to_string()),
        })
    }

    fn fly<T: Scalar>(&self) -> Result<Result<f64, RunError>, String> {
        let reading = read_text(&self.text);
        let scene = reading.scene.ok_or_else(|| {
            let errors = reading.errors.iter().map(ToString::to_string);
            errors.collect::<Vec<_>>().join("; ")
        })?;
        let model = Generic::<T>::with_defaults(scene).map_err(|error| error.to_string())?;
        let fly = || {
            let mut run = Simulation::new(&model, self.options)?;
            if !self.start.is_empty() {
                let mut state = run.state().to_vec();
                for (slot, value) in &self.start {
                    if let Some(slot) = state.get_mut(*slot) {
                        *slot = T::from_f64(*value);
                    }
                }
                run.set_state(0.0, &state)?;
            }
            self.look(&mut run)
        };
        Ok(fly())
    }

    /// Runs to the end and measures.
    fn look<T: Scalar>(&self, run: &mut Simulation<T>) -> Result<f64, RunError> {
        let mut worst: f64 = 0.0;
        match self.measure {
            ExtremeMeasure::Energy => {
                run.run(self.until)?;
                // Without energy that moved there is nothing to lose; a balance that is not known passes nothing.
                worst = run.imbalance().map_or(f64::NAN, |it| it.relative());
            }
            ExtremeMeasure::LostForGood => {
                run.start()?;
                let start = energy(run)?;
                let mut least = f64::INFINITY;
                for look in 1..=LOOKS {
                    run.run(self.until * f64::from(look) / f64::from(LOOKS))?;
                    if 10 * look > 9 * LOOKS {
                        least = least.min((energy(run)? - start).abs());
                    }
                }
                worst = run.imbalance().map_or(f64::NAN, |it| least / it.moved);
            }
            ExtremeMeasure::Momentum => {
                let start = angular_momentum(run)?;
                let size = start.iter().map(|x| x * x).sum::<f64>().sqrt();
                for look in 1..=LOOKS {
                    run.run(self.until * f64::from(look) / f64::from(LOOKS))?;
                    let now = angular_momentum(run)?;
                    let changes = now.iter().zip(&start).map(|(now, start)| now - start);
                    worst = changes.fold(worst, |worst, change| worst.max(change.abs() / size));
                }
            }
            ExtremeMeasure::Quaternion => {
                for look in 1..=LOOKS {
                    run.run(self.until * f64::from(look) / f64::from(LOOKS))?;
                    worst = worst.max(off_unit_length(run));
                }
            }
            ExtremeMeasure::Return => {
                run.start()?;
                let start = run.state().to_vec();
                let speeds = run.model().layout().nq..;
                for _ in 0..2 {
                    run.run(self.until)?;
                    let mut state = run.state().to_vec();
                    let reversed = state.get_mut(speeds.clone()).unwrap_or_default();
                    reversed.iter_mut().for_each(|speed| *speed = -*speed);
                    run.set_state(0.0, &state)?;
                }
                let pairs = run.state().iter().zip(&start);
                worst = pairs.fold(worst, |worst, (now, then)| {
                    worst.max((now.to_f64() - then.to_f64()).abs())
                });
            }
        }
        Ok(worst)
    }

    /// Whether an outcome is what was promised.
    #[must_use]
    pub fn holds(&self, outcome: &CaseOutcome) -> bool {
        match (self.promise, outcome) {
            (Promise::Keeps(bound) | Promise::KeepsOrStops(bound), CaseOutcome::Ran(lost)) => {
                *lost <= bound
            }
            (Promise::KeepsOrStops(_), CaseOutcome::Stopped(..)) => true,
            (Promise::Stops(status), CaseOutcome::Stopped(found, _)) => status == *found,
            _ => false,
        }
    }
}

/// The largest | |q| − 1 | of a run's quaternions.
fn off_unit_length<T: Scalar>(run: &Simulation<T>) -> f64 {
    let quaternions = run.model().layout().quaternions();
    let own = quaternions.filter_map(|at| run.state().get(at..at + 4));
    let off = own.map(|q| {
        let square: f64 = q.iter().map(|x| x.to_f64().powi(2)).sum();
        (square.sqrt() - 1.0).abs()
    });
    off.fold(0.0, f64::max)
}

/// Kinetic, gravitational and elastic energy [J].
fn energy<T: Scalar>(run: &mut Simulation<T>) -> Result<f64, RunError> {
    let mut energies = [T::zero(); 6];
    run.evaluate(Quantity::Energy, &mut energies)?;
    Ok(energies.iter().take(3).map(|energy| energy.to_f64()).sum())
}

/// About the world origin [kg m²/s].
fn angular_momentum<T: Scalar>(run: &mut Simulation<T>) -> Result<[f64; 3], RunError> {
    let mut momentum = [T::zero(); 6];
    run.evaluate(Quantity::Momentum, &mut momentum)?;
    let [.., x, y, z] = momentum;
    Ok([x, y, z].map(|x| x.to_f64()))
}

/// How often a long run is looked at.
const LOOKS: u32 = 100;

/// Runs cases: one table of bounds, what was measured and whether it holds, and how many do not.
#[must_use]
pub fn run(cases: &[ExtremeCase]) -> (ReportTable, usize) {
    let mut table = ReportTable::new("Extremes")
        .column("what", "")
        .column("how much", "")
        .column("promised", "")
        .number("measured", "", 2)
        .column("stopped by", "")
        .column("holds", "");
    let mut broken = 0;
    for case in cases {
        let outcome = case.run();
        let holds = outcome.as_ref().is_ok_and(|outcome| case.holds(outcome));
        broken += usize::from(!holds);
        let (lost, stopped): (Cell, Cell) = match &outcome {
            Ok(CaseOutcome::Ran(lost)) => ((*lost).into(), Cell::Missing),
            Ok(CaseOutcome::Stopped(status, _)) => (Cell::Missing, (*status).into()),
            Err(text) => (Cell::Missing, text.as_str().into()),
        };
        table.push([
            case.group.into(),
            case.amount.as_str().into(),
            case.promised().into(),
            lost,
            stopped,
            if holds { "yes" } else { "NO" }.into(),
        ]);
    }
    (table, broken)
}

/// Writes `report.html` and `extremes.csv` into a folder.
///
/// # Errors
/// The folder or a file cannot be written.
pub fn publish(table: &ReportTable, folder: &Path) -> io::Result<()> {
    make_folder(folder)?;
    write_text(&folder.join("extremes.csv"), &table.csv())?;
    let report = Report::new("Extremes")
        .paragraph("Each run keeps the energy that moved, its momentum, or its start when it comes back, within a bound, or is stopped by a typed error: no number is wrong without a word.")
        .table(table);
    write_text(&folder.join("report.html"), &report.html())
}
