//! How a simulation runs.

use std::fmt;

use mbd_scene::plain;
use serde::{Deserialize, Serialize};

use crate::error::StepError;
use crate::integrate::Scales;
use crate::turns;

/// The integrator and its step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Method {
    /// Classical Runge–Kutta of order 4 at a fixed step.
    Rk4 {
        /// The step [s].
        step: f64,
    },
    /// Symmetric and symplectic steps of order 4 at a fixed step, for long runs: energy stays bounded, momentum is kept to rounding, and time can be
    /// reversed. Not in `f32`, and not with `rate` and `stepwise` nodes, whose past cannot be gone back to.
    Rattle {
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
    /// Verner's pair of orders 7(6), adaptive: cheaper than Tsit5 from a tolerance of about 1e-5 down.
    Vern7 {
        /// Relative tolerance; absolute tolerances are this times [`Options::scales`].
        rtol: f64,
        /// The largest step [s]; infinite for none.
        max_step: f64,
    },
    /// Steinebach's Rosenbrock method of orders 5(4), adaptive, for stiff lines and loads: one Jacobian and one factor a step. Inputs are held:
    /// functions of time and state have no derivatives.
    Rodas5P {
        /// Relative tolerance; absolute tolerances are this times [`Options::scales`].
        rtol: f64,
        /// The largest step [s]; infinite for none.
        max_step: f64,
    },
    /// Tsit5 from a tolerance of 1e-5 up, Vern7 below, and Rodas5P where the scene is stiff, as long as it is: fifteen of twenty steps at the limit of
    /// stability. Inputs are held, as for Rodas5P.
    Auto {
        /// Relative tolerance; absolute tolerances are this times [`Options::scales`].
        rtol: f64,
        /// The largest step [s]; infinite for none.
        max_step: f64,
    },
}

impl Method {
    /// The loosest relative tolerance: at 0.1 errors were 400 times the tolerance.
    pub const LOOSEST: f64 = 0.01;

    /// The words of the methods with a fixed step, as [`Method::fixed`] reads them.
    pub const FIXED: [&str; 2] = ["rk4", "rattle"];

    /// The method of a word with a fixed step [s]; `None` of another word.
    #[must_use]
    pub fn fixed(word: &str, step: f64) -> Option<Method> {
        Some(match word {
            "rk4" => Method::Rk4 { step },
            "rattle" => Method::Rattle { step },
            _ => return None,
        })
    }

    /// The words of the adaptive methods, as [`Method::adaptive`] reads them.
    pub const ADAPTIVE: [&str; 4] = ["tsit5", "vern7", "rodas5p", "auto"];

    /// The adaptive method of a word, without a largest step; `None` of another word.
    #[must_use]
    pub fn adaptive(word: &str, rtol: f64) -> Option<Method> {
        let max_step = f64::INFINITY;
        Some(match word {
            "tsit5" => Method::Tsit5 { rtol, max_step },
            "vern7" => Method::Vern7 { rtol, max_step },
            "rodas5p" => Method::Rodas5P { rtol, max_step },
            "auto" => Method::Auto { rtol, max_step },
            _ => return None,
        })
    }

    /// The same with a largest step [s]; a fixed step stays.
    #[must_use]
    pub fn with_largest_step(mut self, largest: f64) -> Method {
        match &mut self {
            Method::Rk4 { .. } | Method::Rattle { .. } => {}
            Method::Tsit5 { max_step, .. }
            | Method::Vern7 { max_step, .. }
            | Method::Rodas5P { max_step, .. }
            | Method::Auto { max_step, .. } => *max_step = largest,
        }
        self
    }

    /// The word of the method: `rk4`, `tsit5`, ….
    #[must_use]
    pub fn word(&self) -> &'static str {
        match self {
            Method::Rk4 { .. } => "rk4",
            Method::Rattle { .. } => "rattle",
            Method::Tsit5 { .. } => "tsit5",
            Method::Vern7 { .. } => "vern7",
            Method::Rodas5P { .. } => "rodas5p",
            Method::Auto { .. } => "auto",
        }
    }

    /// The name of the method: `RK4`, `Tsit5`, ….
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Method::Rk4 { .. } => "RK4",
            Method::Rattle { .. } => "Rattle",
            Method::Tsit5 { .. } => "Tsit5",
            Method::Vern7 { .. } => "Vern7",
            Method::Rodas5P { .. } => "Rodas5P",
            Method::Auto { .. } => "Auto",
        }
    }

    /// The fixed step [s] of a method that has one.
    #[must_use]
    pub fn fixed_step(&self) -> Option<f64> {
        match self {
            Method::Rk4 { step } | Method::Rattle { step } => Some(*step),
            _ => None,
        }
    }

    /// Whether it solves with derivatives of the rates, at least now and then.
    pub(crate) fn needs_derivatives(&self) -> bool {
        matches!(self, Method::Rodas5P { .. } | Method::Auto { .. })
    }

    /// Relative tolerance and largest step [s] of an adaptive method.
    #[must_use]
    pub fn tolerance(&self) -> Option<[f64; 2]> {
        match self {
            Method::Rk4 { .. } | Method::Rattle { .. } => None,
            Method::Tsit5 { rtol, max_step }
            | Method::Vern7 { rtol, max_step }
            | Method::Rodas5P { rtol, max_step }
            | Method::Auto { rtol, max_step } => Some([*rtol, *max_step]),
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.fixed_step(), self.tolerance()) {
            (_, Some([rtol, _])) => write!(f, "{} {rtol:e}", self.name()),
            (step, None) => {
                let step = plain(step.unwrap_or(f64::NAN), 4);
                write!(f, "{} {step} s", self.name())
            }
        }
    }
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

/// How a simulation runs. Start from [`Options::rk4`], [`Options::rattle`], [`Options::tsit5`], [`Options::vern7`] or [`Options::rodas5p`]
/// and change fields.
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
    /// Whether the work of loads, dampers and prescribed motions is integrated along with the run. Without it an adaptive run of a scene with one of
    /// these has no [balance of energy](crate::Simulation::imbalance): fixed steps take it from the power at their ends. Where joints are driven this solves the system of
    /// the joints once more a stage. In a step from a state at which rows lose rank the work of motors is as good as their power times the step. A model that
    /// does not emit `energy` has none.
    pub work: bool,
    /// Whether a run follows its [momentum](crate::Simulation::momentum_imbalance), where the ground holds nothing of the scene: four evaluations of
    /// gravity and loads by the laws a step.
    pub momentum: bool,
    /// Whether a run stops on a declared event.
    pub stop_at_events: bool,
    /// What one unit of error is; by itself [`Scales::of`] the model. Positions of what lines and stops hold are resolved by the amplitude V/ω at
    /// which it swings on them at the speed scale V, ω² = ΣK/m, where that is less than the length scale.
    pub scales: Option<Scales>,
    /// How far a line or a stop must pass its switch to count as switching [m, rad]; by itself the error of each step as its stages show it at fixed
    /// steps; in adaptive runs the relative tolerance times the amplitude V/ω at which what the line holds swings on it at the speed scale V, at
    /// most the length scale: so a switch is found before its force is wrong by more than that part of V √(K m). It must exceed the error of a step.
    pub guard_tolerance: Option<f64>,
    /// How far an angle whose turns are counted sweeps over an adaptive step at most [rad]; 2 by itself, and no more: beyond half a turn nothing would
    /// tell which turn it is.
    #[serde(default = "most_angle")]
    pub max_angle: f64,
    /// How the run stays on its joints.
    pub stabilise: Stabilise,
}

fn most_angle() -> f64 {
    turns::MOST
}

impl Options {
    /// Steps of a method: switches located, fixed steps watched.
    #[must_use]
    pub fn of(method: Method) -> Self {
        Options {
            method,
            locate: true,
            watch: true,
            max_steps: match method.fixed_step() {
                Some(_) => 10_000_000,
                None => 1_000_000,
            },
            work: false,
            momentum: false,
            stop_at_events: false,
            scales: None,
            guard_tolerance: None,
            max_angle: turns::MOST,
            stabilise: Stabilise::Projection,
        }
    }

    /// Fixed steps of RK4 [s].
    #[must_use]
    pub fn rk4(step: f64) -> Self {
        Options::of(Method::Rk4 { step })
    }

    /// Fixed steps of Rattle [s].
    #[must_use]
    pub fn rattle(step: f64) -> Self {
        Options::of(Method::Rattle { step })
    }

    /// Adaptive steps at a relative tolerance.
    #[must_use]
    pub fn tsit5(rtol: f64) -> Self {
        let max_step = f64::INFINITY;
        Options::of(Method::Tsit5 { rtol, max_step })
    }

    /// Adaptive steps at a tight relative tolerance.
    #[must_use]
    pub fn vern7(rtol: f64) -> Self {
        let max_step = f64::INFINITY;
        Options::of(Method::Vern7 { rtol, max_step })
    }

    /// Adaptive steps of a stiff method at a relative tolerance.
    #[must_use]
    pub fn rodas5p(rtol: f64) -> Self {
        let max_step = f64::INFINITY;
        Options::of(Method::Rodas5P { rtol, max_step })
    }

    /// Adaptive steps at a relative tolerance with the method that the scene needs at the time.
    #[must_use]
    pub fn auto(rtol: f64) -> Self {
        let max_step = f64::INFINITY;
        Options::of(Method::Auto { rtol, max_step })
    }

    /// Refuses numbers that cannot be used with states of a scalar whose rounding unit is `epsilon`.
    pub(crate) fn check(&self, epsilon: f64) -> Result<(), StepError> {
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
        if let Some(step) = self.method.fixed_step() {
            positive("step", step, true)?;
        }
        if let Some([rtol, max_step]) = self.method.tolerance() {
            positive("max_step", max_step, false)?;
            positive("rtol", rtol, true)?;
            if rtol > Method::LOOSEST {
                return Err(StepError::InvalidInput {
                    slot: format!(
                        "rtol (at most {}: above it nothing is resolved)",
                        Method::LOOSEST
                    ),
                    value: rtol,
                });
            }
            // Below, the scalar cannot hold the answer: a run in `f32` would go on rejecting rounding.
            let finest = 8.0 * epsilon;
            if epsilon > f64::EPSILON && rtol < finest {
                return Err(StepError::InvalidInput {
                    slot: format!("rtol (states in f32 hold {finest:.0e}; run in f64)"),
                    value: rtol,
                });
            }
        }
        positive("max_angle", self.max_angle, true)?;
        if self.max_angle > turns::MOST {
            return Err(StepError::InvalidInput {
                slot: format!(
                    "max_angle (at most {}: beyond half a turn nothing tells which turn it is)",
                    turns::MOST
                ),
                value: self.max_angle,
            });
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
