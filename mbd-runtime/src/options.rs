//! How a simulation runs.

use serde::{Deserialize, Serialize};

use crate::error::StepError;
use crate::integrate::Scales;

/// The integrator and its step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Method {
    /// Classical Runge–Kutta of order 4 at a fixed step.
    Rk4 {
        /// The step [s].
        step: f64,
    },
    /// Tsitouras' pair of orders 5(4), adaptive.
    Tsit5 {
        /// Relative tolerance; absolute tolerances are this times [`Options::scales`].
        rtol: f64,
        /// The largest step [s]; infinite for none.
        max_step: f64,
    },
}

/// How a run stays on its joints.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum Stabilise {
    /// Positions, then velocities, are moved back onto the joints in every step: the smallest move weighted by mass.
    #[default]
    Projection,
    /// Nothing: joints drift apart with the error of the steps.
    None,
    /// The acceleration rows become Φ_v v̇ = γ − 2α Φ̇ − α² Φ. For those who must match another code; 10 1/s is usual.
    Baumgarte {
        /// α [1/s].
        alpha: f64,
    },
}

/// How a simulation runs. Start from [`Options::rk4`] or [`Options::tsit5`] and change fields.
///
/// ```
/// use mbd_runtime::{Options, PointState, Simulation, Stop, model};
///
/// model! {
///     /// A mass that is drawn to the origin: 10 rad/s.
///     model Oscillator {
///         gravity: none;
///         emit: [derivative];
///         point bob { mass: 1.0 kg }
///         load pull on bob = -100 N/m * bob.position;
///         event passes = bob.position.x falls 0 m;
///     }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let oscillator = Oscillator::new(OscillatorParams::default())?;
/// let mut start = OscillatorState::at_origin();
/// start.set_bob(PointState { position: [0.1, 0.0, 0.0], velocity: [0.0; 3] });
///
/// // Adaptive steps, and an end at the first declared event: a quarter of the period 2π √(m/k).
/// let options = Options { stop_at_events: true, ..Options::tsit5(1e-9) };
/// let mut simulation = Simulation::new(&oscillator, options)?;
/// simulation.set_state(0.0, &start.to_vec())?;
/// assert_eq!(simulation.run(1.0)?, Stop::Event(0));
/// let quarter = std::f64::consts::PI / 20.0;
/// assert!((simulation.time() - quarter).abs() < 1e-8);
///
/// // A number that cannot be used is refused by name.
/// let refused = Simulation::new(&oscillator, Options::rk4(-0.1)).err().expect("no negative steps");
/// assert!(refused.to_string().contains("step"));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Options {
    /// The integrator.
    pub method: Method,
    /// Whether slack/taut switches and declared events are located: steps end on them, and the mode of every line is frozen inside a step. Without,
    /// each line decides by itself at every stage and declared events are not looked for. Lines of static and stepwise nodes are never located.
    pub locate: bool,
    /// Whether a run follows its [energy](crate::Simulation::imbalance), and a fixed step is watched: past its stability limit, or after it has made
    /// or lost 2 % of the energy that moved, the run ends with [`StepError::UnstableStep`], in the last good state. Motions that are
    /// prescribed are not judged by their energy. Scenes with `stepwise` nodes are not watched: their instability lives in what the node remembers,
    /// and the stages of a step do not show it.
    pub watch: bool,
    /// The most accepted and rejected steps of one call.
    pub max_steps: u64,
    /// Whether the work of loads, dampers and prescribed motions is integrated along with the run. Where joints are driven this solves the system of
    /// the joints once more a stage. In a step from a state at which rows lose rank the work of motors is as good as their power times the step.
    pub work: bool,
    /// Whether a run stops on a declared event.
    pub stop_at_events: bool,
    /// What one unit of error is; by itself [`Scales::of`] the model. Positions of what lines and stops hold are resolved by the amplitude V/ω at
    /// which it swings on them at the speed scale V, ω² = ΣK/m, where that is less than the length scale.
    pub scales: Option<Scales>,
    /// How far a line or a stop must pass its switch to count as switching [m, rad]; by itself the error of each step as its stages show it at fixed
    /// steps; in adaptive runs the relative tolerance times the amplitude V/ω at which what the line holds swings on it at the speed scale V, at
    /// most the length scale: so a switch is found before its force is wrong by more than that part of V √(K m). It must exceed the error of a step.
    pub guard_tolerance: Option<f64>,
    /// How the run stays on its joints.
    pub stabilise: Stabilise,
}

impl Options {
    /// Fixed steps of RK4 [s]: switches located, stability watched.
    #[must_use]
    pub fn rk4(step: f64) -> Self {
        Options {
            method: Method::Rk4 { step },
            locate: true,
            watch: true,
            max_steps: 10_000_000,
            work: false,
            stop_at_events: false,
            scales: None,
            guard_tolerance: None,
            stabilise: Stabilise::Projection,
        }
    }

    /// Adaptive steps at a relative tolerance: switches located.
    #[must_use]
    pub fn tsit5(rtol: f64) -> Self {
        Options {
            method: Method::Tsit5 {
                rtol,
                max_step: f64::INFINITY,
            },
            max_steps: 1_000_000,
            ..Options::rk4(0.0)
        }
    }

    /// Refuses numbers that cannot be used.
    pub(crate) fn check(&self) -> Result<(), StepError> {
        let positive = |slot: &str, value: f64, finite: bool| {
            if value > 0.0 && (value.is_finite() || !finite) {
                Ok(())
            } else {
                Err(StepError::InvalidInput {
                    slot: slot.into(),
                    value,
                })
            }
        };
        match self.method {
            Method::Rk4 { step } => positive("step", step, true)?,
            Method::Tsit5 { rtol, max_step } => {
                positive("max_step", max_step, false)?;
                positive("rtol", rtol, true)?;
                // Above this nothing is resolved; below, a double cannot hold the answer: the run would only report a collapse of the step.
                if rtol > 0.1 {
                    return positive("rtol", -rtol, true);
                }
            }
        }
        if let Stabilise::Baumgarte { alpha } = self.stabilise {
            positive("stabilise.alpha", alpha, true)?;
        }
        if let Some(scales) = self.scales {
            positive("scales.length", scales.length, true)?;
            positive("scales.angle", scales.angle, true)?;
            positive("scales.speed", scales.speed, true)?;
            positive("scales.rate", scales.rate, true)?;
            positive("scales.energy", scales.energy, true)?;
        }
        match self.guard_tolerance {
            Some(tolerance) => positive("guard_tolerance", tolerance, true),
            None => Ok(()),
        }
    }
}
