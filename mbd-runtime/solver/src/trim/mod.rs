//! Trim: a state and inputs at which nothing accelerates, with chosen coordinates, rates and inputs where they are wanted.
//!
//! ```text
//! ρ(ξ, u, z) = [η̇ ; ż ; ṡ] = 0 at η = 0, or at the rates that are given                                              (1)
//! (JᵀJ + μ diag JᵀJ) δ = −Jᵀ ρ,   J = [∂ρ/∂ξ  ∂ρ/∂u  ∂ρ/∂(z, s)] from A and B                                          (2)
//! ```
//!
//! Damped least squares (Levenberg and Marquardt) with exact derivatives in minimal coordinates; after every step the joints are closed again by Newton
//! steps that keep the coordinates where they are wanted. What (1) does not decide stays where the guess has it.

mod search;

use std::sync::Arc;

use mbd_scene::similar::near_and_all;
use mbd_scene::{Model, plain};

use crate::columns::Name;
use crate::compiled::Scalar;
use crate::linearise::{Kink, LinearisationError, StateSpace};
use crate::system::Remembered;
use crate::{RunError, Simulation};

pub(crate) use search::find;

/// What is looked for: see [`trim`].
pub struct Trim<T: Scalar> {
    model: Arc<dyn Model<T>>,
    asked: TrimProblem,
}

/// Everything that a trim is asked with, whatever the scalar.
#[derive(Clone, Debug, Default)]
pub struct TrimProblem {
    pub(super) time: f64,
    pub(super) state: Option<Vec<f64>>,
    pub(super) nodes: Option<Vec<f64>>,
    pub(super) given: Option<Vec<f64>>,
    pub(super) inputs: Vec<(String, f64)>,
    pub(super) free: Vec<String>,
    pub(super) fixed: Vec<(String, Option<f64>)>,
    pub(super) rates: Vec<(String, f64)>,
    pub(super) guesses: Vec<(String, f64)>,
    pub(super) along: Vec<String>,
    pub(super) remembered: Option<Remembered>,
}

impl TrimProblem {
    /// All numbers that were given beside time, state and inputs, each with what it was given for.
    pub(super) fn numbers(&self) -> impl Iterator<Item = (&str, f64)> {
        let nodes = self.nodes.iter().flatten().map(|value| ("nodes", *value));
        let named = [&self.inputs, &self.rates, &self.guesses];
        let named = named.into_iter().flatten();
        let fixed = self.fixed.iter();
        let fixed = fixed.filter_map(|(name, value)| Some((name.as_str(), (*value)?)));
        nodes
            .chain(named.map(|(name, value)| (name.as_str(), *value)))
            .chain(fixed)
    }
}

/// A steady motion.
#[derive(Clone, Debug)]
pub struct Trimmed {
    /// The state x = [q | v | z | s].
    pub state: Vec<f64>,
    /// The inputs, in the order of [`Layout::inputs`](mbd_scene::Layout::inputs).
    pub inputs: Vec<f64>,
    /// The positions of the nodes, 3 each [m], as [`Simulation::set_nodes`] takes them.
    pub nodes: Vec<f64>,
    /// The linear system there.
    pub space: StateSpace,
    /// Unknowns that nothing decides, by name: they stayed where the guess had them.
    pub undecided: Vec<String>,
    /// Steps taken.
    pub iterations: usize,
    pub(crate) remembered: Remembered,
    pub(super) names: Vec<Name>,
    /// None of a turn in space, which is measured from here.
    pub(super) values: Vec<Option<f64>>,
}

/// Why there is no trim.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum TrimError {
    /// Nothing that is free can take away all accelerations.
    Unbalanced {
        /// What is left most, a coordinate's name.
        worst: String,
        /// Its acceleration, or the rate of a number behind the speeds: a state, a node.
        residual: f64,
        /// Its unit.
        unit: String,
        /// Whether it is a number behind the speeds.
        is_state: bool,
        /// How many unknowns were free, and how many accelerations were to vanish.
        counts: [usize; 2],
        /// The steps taken.
        iterations: usize,
        /// Lines that are slack there, by name: what hangs on them has nothing that holds it.
        slack: Vec<String>,
        /// A kink of a rate there, by what was free: on the one side it may have no derivative that leads on.
        kink: Option<Box<Kink>>,
    },
    /// An input that there is not.
    UnknownInput {
        /// The name.
        name: String,
        /// Those that there are.
        known: String,
    },
    /// The turn of a body in space cannot be set by a number: give it with the state, and hold it.
    Turn {
        /// The name.
        name: String,
    },
    /// The joints cannot be closed with the coordinates where they are wanted.
    Open {
        /// What is left [m or 1].
        gap: f64,
    },
    /// No derivatives, a name that is not known, or a number that was given and is not finite.
    Linearisation(
        /// Why.
        LinearisationError,
    ),
}

impl std::fmt::Display for TrimError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            TrimError::Unbalanced {
                worst,
                residual,
                unit,
                is_state,
                counts: [unknowns, residuals],
                iterations,
                slack,
                kink,
            } => {
                let what = match is_state {
                    true => "a rate",
                    false => "an acceleration",
                };
                write!(
                    f,
                    "no balance found: `{worst}` keeps {what} of {} {unit} after {iterations} steps, with {unknowns} unknowns for {residuals} accelerations and rates of states",
                    plain(*residual, 4)
                )?;
                if let Some(kink) = kink {
                    let [one, other] = kink.sides.map(|side| plain(side, 4));
                    return write!(
                        f,
                        ": the search stands at a kink, where the rate of `{}` changes by {one} per unit of `{by}` on one side and by {other} on the other; let it begin beside the kink, with another value of `{by}`",
                        kink.of.name,
                        by = kink.by.name,
                    );
                }
                match (unknowns < residuals, slack.is_empty()) {
                    (true, _) => write!(f, ": fix fewer coordinates, or free an input"),
                    (false, true) => write!(f, ": give a better guess, or fix less"),
                    (false, false) => write!(
                        f,
                        ": `{}` is slack there, and what is slack holds nothing; give a guess at which it pulls",
                        slack.join("`, `")
                    ),
                }
            }
            TrimError::UnknownInput { name, known } if known.is_empty() => {
                write!(f, "`{name}` is no input: this scene has none")
            }
            TrimError::UnknownInput { name, known } => {
                let known = near_and_all(name, known.split(", "));
                write!(f, "`{name}` is no input of this scene{known}")
            }
            TrimError::Turn { name } => write!(
                f,
                "`{name}` is a turn in space, which no single number sets: give the attitude with `state`, and `hold` it"
            ),
            TrimError::Open { gap } => write!(
                f,
                "the joints stay open by {} with these coordinates: fix fewer of them, or others",
                plain(*gap, 2)
            ),
            TrimError::Linearisation(cause @ LinearisationError::NotFinite { .. }) => write!(
                f,
                "{cause}; in a trim all rates are zero but those that are given: where the scene has no rest, give its rate"
            ),
            TrimError::Linearisation(cause) => write!(f, "{cause}"),
        }
    }
}

impl std::error::Error for TrimError {}

impl From<LinearisationError> for TrimError {
    fn from(cause: LinearisationError) -> Self {
        TrimError::Linearisation(cause)
    }
}

/// Looks for a state, and inputs, at which nothing accelerates: `trim(&model).fix("lift.angle", 0.3).free_input("push").solve()`.
///
/// All rates are zero but those that [`Trim::rate`] gives, so that a motion at constant rates is one, too. Coordinates are named as in
/// [`StateSpace::states`]: those of joints, `lift.angle`, positions, `buoy.x`, and turns of bodies, `drone.turn_x`. SI units throughout.
///
/// ```
/// use mbd_runtime::{model, trim};
///
/// model! {
///     /// A pendulum of 2 kg at 0.5 m below its pin, swung by a torque.
///     model Arm {
///         gravity: [0.0, 0.0, -9.81] m/s^2;
///         emit: [derivative];
///         input motor: torque;
///         body arm {
///             mass: 2.0 kg,
///             inertia: diag(0.1, 0.1, 0.01) kg*m^2,
///             frame top at [0.0, 0.0, 0.5] m,
///         }
///         joint pin: hinge from world to arm.top { axis: y, force: motor }
///     }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let arm = Arm::new(ArmParams::default())?;
/// let held = trim(&arm).fix("pin.angle", 0.4).free_input("motor").solve()?;
///
/// // The torque that holds it: m g l sin θ.
/// assert!((held.inputs[0] - 2.0 * 9.81 * 0.5 * 0.4_f64.sin()).abs() < 1e-9);
/// # Ok(())
/// # }
/// ```
#[must_use]
pub fn trim<T: Scalar>(model: &(impl Model<T> + ?Sized)) -> Trim<T> {
    Trim {
        model: model.share(),
        asked: TrimProblem::default(),
    }
}

impl<T: Scalar> Trim<T> {
    /// The time at which prescribed motions stand [s]; 0 else.
    #[must_use]
    pub fn at(mut self, time: f64) -> Self {
        self.asked.time = time;
        self
    }

    /// The state to start from; else the declared start of the scene.
    #[must_use]
    pub fn state(mut self, state: &[f64]) -> Self {
        self.asked.state = Some(state.to_vec());
        self
    }

    /// Where the nodes are searched from, 3 numbers each [m].
    #[must_use]
    pub fn nodes(mut self, guess: &[f64]) -> Self {
        self.asked.nodes = Some(guess.to_vec());
        self
    }

    /// An input that stays as given, or where a free one begins; else its declared default, zero where there is none.
    #[must_use]
    pub fn input(mut self, name: &str, value: f64) -> Self {
        self.asked.inputs.push((name.to_owned(), value));
        self
    }

    /// All inputs, in the order of [`Layout::inputs`](mbd_scene::Layout::inputs).
    #[must_use]
    pub fn all_inputs(mut self, values: &[f64]) -> Self {
        self.asked.given = Some(values.to_vec());
        self
    }

    /// An input that is looked for. A vector of inputs has components: `wind.x`.
    #[must_use]
    pub fn free_input(mut self, name: &str) -> Self {
        self.asked.free.push(name.to_owned());
        self
    }

    /// A coordinate that stays at a value.
    #[must_use]
    pub fn fix(mut self, name: &str, value: f64) -> Self {
        self.asked.fixed.push((name.to_owned(), Some(value)));
        self
    }

    /// A coordinate that stays where the guess has it.
    #[must_use]
    pub fn hold(mut self, name: &str) -> Self {
        self.asked.fixed.push((name.to_owned(), None));
        self
    }

    /// A coordinate that goes on at a constant rate: it stays where the guess has it, and its acceleration vanishes.
    #[must_use]
    pub fn rate(mut self, name: &str, rate: f64) -> Self {
        self.asked.rates.push((name.to_owned(), rate));
        self
    }

    /// Where a coordinate begins.
    #[must_use]
    pub fn guess(mut self, name: &str, value: f64) -> Self {
        self.asked.guesses.push((name.to_owned(), value));
        self
    }

    /// Begins where a run stands: its time and state, the turns of its angles, what is locked and detached there, its inputs and nodes. Params are those of this
    /// model; [`Simulation::trim`] takes those of the run, as its events left them.
    #[must_use]
    pub fn begin_at(mut self, run: &Simulation<T>) -> Self {
        let wide = |list: &[T]| -> Vec<f64> { list.iter().map(|x| x.to_f64()).collect() };
        self.asked.time = run.time();
        self.asked.state = Some(wide(run.state()));
        self.asked.given = Some(wide(&run.run.system.inputs));
        let layout = run.model().layout();
        self.asked.nodes = Some(wide(&layout.node_positions(run.state(), run.nodes())));
        self.asked.remembered = Some(run.run.system.remembered());
        self
    }

    /// A coordinate that is to be one of the linear system, before those that are named otherwise.
    #[must_use]
    pub fn along(mut self, name: &str) -> Self {
        self.asked.along.push(name.to_owned());
        self
    }

    /// Looks for it.
    ///
    /// # Errors
    /// [`TrimError`].
    pub fn solve(&self) -> Result<Trimmed, TrimError> {
        T::find_trim(&*self.model, &self.asked)
    }
}

impl<T: Scalar> Simulation<T> {
    /// Looks for a rest from where this run stands, as [`trim`] does: with the params, the locks and what is detached as its events left them, the turns of
    /// its angles, its inputs and nodes. It does not change the run; [`Simulation::set_rest`] takes it to what is found.
    #[must_use]
    pub fn trim(&self) -> Trim<T> {
        let asked = TrimProblem::default();
        let model = self.model().clone();
        Trim { model, asked }.begin_at(self)
    }

    /// Stands at a rest that was found: its state, inputs and nodes, the turns of its angles, what is locked and detached there. Time and params stay.
    ///
    /// # Errors
    /// A rest of another scene, by its lengths.
    pub fn set_rest(&mut self, rest: &Trimmed) -> Result<(), RunError> {
        T::give_rest(&mut self.run, rest)
    }
}

impl Trimmed {
    /// Coordinates, their rates and inputs, with their values. The turns in space that the linear system has as coordinates (`drone.turn_x`) are measured
    /// from here, and are not among them: attitudes are those of the state.
    pub fn values(&self) -> impl Iterator<Item = (&Name, f64)> {
        let all = self.names.iter().zip(&self.values);
        all.filter_map(|(name, value)| Some((name, (*value)?)))
    }

    /// The value of a coordinate, its rate, or an input, by name; `None` of a turn in space, too.
    #[must_use]
    pub fn value(&self, name: &str) -> Option<f64> {
        let mut all = self.values();
        all.find(|(known, _)| known.name == name)
            .map(|(_, value)| value)
    }
}
