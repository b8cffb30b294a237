//! The extremes: mass ratios, stiffness, damping, spin, steps that are too long, flat linkages, slack lines, drift, single precision, far from the
//! origin, other units, long runs and runs back. A run of each keeps its energy, its momentum or its start within a bound, or is stopped by a typed
//! error: what counts is that no number is wrong without a word.

use std::fmt;
use std::io;
use std::path::Path;

use mbd_compiler::read_text;
use mbd_runtime::{Generic, Method, Options, Quantity, RunError, Scalar, Simulation};

use crate::files::{make_folder, write_text};
use crate::report::{Cell, Report, Table};

/// What is looked at in a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Energy made or lost, over the energy that moved.
    Energy,
    /// The change of angular momentum about the world origin, over the one at the start.
    Momentum,
    /// The largest deviation of a quaternion from length 1.
    Quaternion,
    /// The distance from the start after a run out, with all speeds turned round, and back [m, m/s, rad/s].
    Return,
}

impl fmt::Display for Measure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Measure::Energy => "energy",
            Measure::Momentum => "angular momentum",
            Measure::Quaternion => "unit quaternions",
            Measure::Return => "way back to the start",
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
pub struct Case {
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
    pub measure: Measure,
    /// What it must do.
    pub promise: Promise,
}

/// What came of a case.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// It reached its end; the measure.
    Ran(f64),
    /// It was stopped by the typed error of this status, with its sentence.
    Stopped(&'static str, String),
}

impl Case {
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
    pub fn run(&self) -> Result<Outcome, String> {
        let outcome = match self.single {
            true => self.fly::<f32>()?,
            false => self.fly::<f64>()?,
        };
        Ok(match outcome {
            Ok(lost) => Outcome::Ran(lost),
            Err(error) => Outcome::Stopped(error.cause.status(), error.cause.to_string()),
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
            Measure::Energy => {
                run.run(self.until)?;
                // Without energy that moved there is nothing to lose.
                worst = run.imbalance().map_or(0.0, |it| it.relative());
            }
            Measure::Momentum => {
                let start = angular_momentum(run)?;
                let size = start.iter().map(|x| x * x).sum::<f64>().sqrt();
                for look in 1..=LOOKS {
                    run.run(self.until * f64::from(look) / f64::from(LOOKS))?;
                    let now = angular_momentum(run)?;
                    let changes = now.iter().zip(&start).map(|(now, start)| now - start);
                    worst = changes.fold(worst, |worst, change| worst.max(change.abs() / size));
                }
            }
            Measure::Quaternion => {
                for look in 1..=LOOKS {
                    run.run(self.until * f64::from(look) / f64::from(LOOKS))?;
                    worst = worst.max(off_unit_length(run));
                }
            }
            Measure::Return => {
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
    pub fn holds(&self, outcome: &Outcome) -> bool {
        match (self.promise, outcome) {
            (Promise::Keeps(bound) | Promise::KeepsOrStops(bound), Outcome::Ran(lost)) => {
                *lost <= bound
            }
            (Promise::KeepsOrStops(_), Outcome::Stopped(..)) => true,
            (Promise::Stops(status), Outcome::Stopped(found, _)) => status == *found,
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

/// About the world origin [kg m²/s].
fn angular_momentum<T: Scalar>(run: &mut Simulation<T>) -> Result<[f64; 3], RunError> {
    let mut momentum = [T::zero(); 6];
    run.evaluate(Quantity::Momentum, &mut momentum)?;
    let [.., x, y, z] = momentum;
    Ok([x, y, z].map(|x| x.to_f64()))
}

fn case(
    group: &'static str,
    amount: impl Into<String>,
    text: impl Into<String>,
    (method, until): (Method, f64),
    promise: Promise,
) -> Case {
    let options = Options::of(method);
    // Adaptive runs tell their energy where they integrate what gives and takes it.
    let options = Options {
        work: method.fixed_step().is_none(),
        ..options
    };
    Case {
        group,
        amount: amount.into(),
        text: text.into(),
        start: Vec::new(),
        options,
        until,
        single: false,
        measure: Measure::Energy,
        promise,
    }
}

/// How often a long run is looked at.
const LOOKS: u32 = 100;

const RATTLE: fn(f64) -> Method = |step| Method::Rattle { step };
const RK4: fn(f64) -> Method = |step| Method::Rk4 { step };
const AUTO: fn(f64) -> Method = |rtol| Method::Auto {
    rtol,
    max_step: f64::INFINITY,
};

/// A chain of four rods on hinges, of these masses [kg], let go from a bend.
fn chain(masses: [f64; 4]) -> String {
    let mut text = String::from("model Chain { gravity: [0, 0, -9.81] m/s^2; ");
    for (index, mass) in masses.into_iter().enumerate() {
        let inertia = mass / 12.0;
        text += &format!(
            "body b{index} {{ mass: {mass:e} kg, inertia: diag({inertia:e}, {inertia:e}, {inertia:e}) kg*m^2,
             frame top at [0, 0, 0.5] m, frame end at [0, 0, -0.5] m }} "
        );
        let from = match index {
            0 => "world".to_owned(),
            _ => format!("b{}.end", index - 1),
        };
        text += &format!(
            "joint j{index}: hinge from {from} to b{index}.top {{ axis: y, start: 0.4 rad }} "
        );
    }
    text + "}"
}

/// A mass of 1 kg let go above a line that catches it.
fn caught(stiffness: f64, damping: f64) -> String {
    format!(
        "model Caught {{ gravity: [0, 0, -9.81] m/s^2; point bob {{ mass: 1 kg, start at [0, 0, -0.9] m }}
         line rope from world to bob {{ free_length: 1 m, stiffness: {stiffness:e} N/m, damping: {damping:e} N*s/m }} }}"
    )
}

/// A pendulum on a spring, everything moved away from the origin.
fn away(distance: f64) -> String {
    format!(
        "model Away {{ gravity: [0, 0, -9.81] m/s^2; world {{ frame hook at [{distance:e}, 0, 0] m }}
         point bob {{ mass: 1 kg, start at [{distance:e} + 0.3, 0, -1] m }}
         spring rope from world.hook to bob {{ free_length: 1 m, stiffness: 1e4 N/m, damping: 1 N*s/m }} }}"
    )
}

const FREE: &str = "model Free { gravity: none; body b { mass: 1 kg, inertia: diag(1, 2, 3) kg*m^2 } joint loose: free from world to b.com; }";

/// Two cranks and a bar, all in one line at the start, where rows lose rank, and pushed through.
const FLAT: &str = "model Flat { gravity: none;
    body a { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame one at [-0.5, 0, 0] m, frame two at [0.5, 0, 0] m, start at [0.5, 0, 0] m velocity [0, 0, -1] m/s }
    body b { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame one at [-1, 0, 0] m, frame two at [1, 0, 0] m, start at [2, 0, 0] m velocity [0, 0, -2] m/s }
    body c { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame one at [-0.5, 0, 0] m, frame two at [0.5, 0, 0] m, start at [2.5, 0, 0] m velocity [0, 0, -1] m/s }
    world { frame far at [2, 0, 0] m }
    joint p: hinge from world to a.one { axis: y }
    joint q: hinge from a.two to b.one { axis: y }
    joint r: hinge from b.two to c.two { axis: y }
    joint s: hinge from world.far to c.one { axis: y } }";

/// All cases; `reduced` leaves out those that run for long.
#[must_use]
pub fn cases(reduced: bool) -> Vec<Case> {
    let mut all = Vec::new();
    for ratio in [1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9] {
        for (place, masses) in [
            ("tip", [1.0, 1.0, 1.0, ratio]),
            ("alternating", [1.0, ratio, 1.0, ratio]),
        ] {
            all.push(case(
                "mass ratio",
                format!("{ratio:.0e}, {place}"),
                chain(masses),
                (RK4(1e-3), 0.5),
                Promise::KeepsOrStops(0.02),
            ));
        }
    }
    for stiffness in [1e-2, 1e2, 1e4, 1e6, 1e8, 1e10, 1e12] {
        // Damped to a tenth of critical.
        let damping = 0.2 * f64::sqrt(stiffness);
        let text = caught(stiffness, damping);
        let amount = format!("K = {stiffness:.0e} N/m, adaptive");
        let promise = Promise::Keeps(1e-3);
        all.push(case(
            "stiffness",
            amount,
            text.clone(),
            (AUTO(1e-6), 0.5),
            promise,
        ));
        let amount = format!("K = {stiffness:.0e} N/m, steps of 1 ms");
        let promise = Promise::KeepsOrStops(0.02);
        all.push(case("stiffness", amount, text, (RK4(1e-3), 0.5), promise));
    }
    for damping in [1e3, 1e6, 1e9] {
        let text = caught(1e3, damping);
        let amount = format!("C = {damping:.0e} N s/m, adaptive");
        all.push(case(
            "damping",
            amount,
            text.clone(),
            (AUTO(1e-6), 2.0),
            Promise::Keeps(1e-3),
        ));
        let amount = format!("C = {damping:.0e} N s/m, steps of 1 ms");
        all.push(case(
            "damping",
            amount,
            text,
            (RK4(1e-3), 2.0),
            Promise::KeepsOrStops(0.02),
        ));
    }
    for (spin, step) in [(1e2, 1e-4), (1e4, 1e-6), (1e4, 1e-4)] {
        let promise = match spin * step {
            turn if turn < 0.1 => Promise::Keeps(1e-6),
            _ => Promise::Stops("unstable_step"),
        };
        all.push(Case {
            start: vec![(7 + 3, 1e-3 * spin), (7 + 4, spin)],
            ..case(
                "spin",
                format!("{spin:.0e} rad/s, h = {step:.0e} s"),
                FREE,
                (RK4(step), 1e3 * step),
                promise,
            )
        });
    }
    for step in [0.05, 0.2, 1.0] {
        let promise = Promise::KeepsOrStops(0.02);
        all.push(case(
            "step too long",
            format!("a chain, h = {step} s"),
            chain([1.0; 4]),
            (RK4(step), 10.0),
            promise,
        ));
        all.push(case(
            "step too long",
            format!("a line of 1e4 N/m, h = {step} s"),
            caught(1e4, 10.0),
            (RK4(step), 10.0),
            promise,
        ));
    }
    for method in [RK4(1e-3), AUTO(1e-8)] {
        all.push(case(
            "flat linkage",
            method.to_string(),
            FLAT,
            (method, 2.0),
            Promise::Keeps(1e-6),
        ));
    }
    let slack =
        "model Slack { gravity: none; point bob { mass: 1 kg, start at [0.1, 0, 0] m } point knot;
         world { frame left at [-1, 0, 0] m, frame right at [1, 0, 0] m }
         line a from world.left to knot { free_length: 2 m, stiffness: 1 kN/m }
         line b from world.right to knot { free_length: 2 m, stiffness: 1 kN/m }
         line c from knot to bob { free_length: 2 m, stiffness: 1 kN/m } }";
    all.push(case(
        "all lines slack",
        "a knot of three",
        slack,
        (AUTO(1e-6), 1.0),
        Promise::Keeps(1e-9),
    ));
    let zero = "model Zero { gravity: [0, 0, -9.81] m/s^2; point bob { mass: 1 kg }
         spring s from world to bob { free_length: 0 m, stiffness: 100 N/m, damping: 1 N*s/m } }";
    all.push(case(
        "zero length",
        "a spring from where it hangs",
        zero,
        (AUTO(1e-8), 1.0),
        Promise::Keeps(1e-6),
    ));
    for (distance, promise) in [
        (1e3, Promise::Keeps(1e-6)),
        (1e6, Promise::Keeps(1e-6)),
        (1e9, Promise::Keeps(1e-3)),
        (1e12, Promise::Stops("lost_digits")),
    ] {
        all.push(case(
            "far from the origin",
            format!("{distance:.0e} m"),
            away(distance),
            (AUTO(1e-8), 1.0),
            promise,
        ));
    }
    for (distance, promise) in [
        (1.0, Promise::Keeps(1e-3)),
        (1e3, Promise::KeepsOrStops(0.05)),
        (1e6, Promise::Stops("lost_digits")),
    ] {
        all.push(Case {
            single: true,
            ..case(
                "single precision",
                format!("{distance:.0e} m away"),
                away(distance),
                (RK4(1e-3), 1.0),
                promise,
            )
        });
    }
    all.push(Case {
        single: true,
        ..case(
            "single precision",
            "a chain",
            chain([1.0; 4]),
            (RK4(1e-3), 2.0),
            Promise::Keeps(1e-4),
        )
    });
    // One oscillator of hω = 1.5 in metres and seconds, in micrometres and in days: found too long for its step in all of them.
    for (unit, length, mass, time) in [
        ("m, kg, s", 1.0, 1.0, 1.0),
        ("µm, mg", 1e-6, 1e-6, 1.0),
        ("km, t, hours", 1e3, 1e3, 3600.0),
    ] {
        let stiffness = mass * f64::powi(1.5 / time, 2);
        let text = format!(
            "model Units {{ gravity: none; point bob {{ mass: {mass:e} kg, start at [{:e}, 0, 0] m }}
             spring s from world to bob {{ free_length: {length:e} m, stiffness: {stiffness:e} N/m, damping: 0 N*s/m }} }}",
            1.1 * length
        );
        all.push(case(
            "units",
            unit,
            text,
            (RK4(time), 100.0 * time),
            Promise::Stops("unstable_step"),
        ));
    }
    let steps = if reduced { 1e4 } else { 1e6 };
    all.push(case(
        "drift",
        format!("a chain, {steps:.0e} steps"),
        chain([1.0; 4]),
        (RK4(1e-3), 1e-3 * steps),
        Promise::Keeps(1e-3),
    ));
    all.extend(long_runs(steps));
    all
}

/// What Rattle keeps over many steps, and back again.
fn long_runs(steps: f64) -> Vec<Case> {
    let mut all = Vec::new();
    // Energy is off by (h |ω|)⁴ and stays there; momentum only by rounding.
    for (spin, step, measure, bound) in [
        (1.0, 0.01, Measure::Energy, 1e-10),
        (1.0, 0.1, Measure::Energy, 1e-7),
        (1.0, 0.1, Measure::Momentum, 1e-11),
        (1.0, 0.1, Measure::Quaternion, 1e-14),
        (1e4, 1e-4, Measure::Energy, 1e-3),
        (1e4, 1e-4, Measure::Momentum, 1e-11),
    ] {
        let amount = format!("spin of {spin:.0e} rad/s, h = {step:.0e} s, {steps:.0e} steps");
        let run = (RATTLE(step), step * steps);
        all.push(Case {
            start: vec![(7 + 3, 1e-3 * spin), (7 + 4, spin), (7 + 5, 1e-3 * spin)],
            measure,
            ..case("long run", amount, FREE, run, Promise::Keeps(bound))
        });
    }
    let steps = 0.3 * steps;
    all.push(case(
        "long run",
        format!("a chain, {steps:.0e} steps of Rattle"),
        chain([1.0; 4]),
        (RATTLE(1e-3), 1e-3 * steps),
        Promise::Keeps(1e-8),
    ));
    for (what, text) in [
        ("a chain", chain([1.0; 4])),
        ("a tumbling body", FREE.to_owned()),
    ] {
        all.push(Case {
            start: match what {
                "a chain" => Vec::new(),
                _ => vec![(7 + 3, 0.5), (7 + 4, 1.0), (7 + 5, -0.3)],
            },
            measure: Measure::Return,
            ..case(
                "time reversal",
                format!("{what}, 2000 steps of Rattle and back"),
                text,
                (RATTLE(1e-3), 2.0),
                Promise::Keeps(1e-12),
            )
        });
    }
    all
}

/// Runs cases: one table of bounds, what was measured and whether it holds, and how many do not.
#[must_use]
pub fn run(cases: &[Case]) -> (Table, usize) {
    let mut table = Table::new("Extremes")
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
            Ok(Outcome::Ran(lost)) => ((*lost).into(), Cell::Missing),
            Ok(Outcome::Stopped(status, _)) => (Cell::Missing, (*status).into()),
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
pub fn publish(table: &Table, folder: &Path) -> io::Result<()> {
    make_folder(folder)?;
    write_text(&folder.join("extremes.csv"), &table.csv())?;
    let report = Report::new("Extremes")
        .paragraph("Each run keeps the energy that moved, its momentum, or its start when it comes back, within a bound, or is stopped by a typed error: no number is wrong without a word.")
        .table(table);
    write_text(&folder.join("report.html"), &report.html())
}
