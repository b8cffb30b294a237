//! The ways to model the confluence, and one flight with any of them.

use std::fmt;
use std::time::Instant as Clock;

use mbd_runtime::{
    Content, Model, Options, ParamError, RunError, Sampling, Simulation, Statistics, Trajectory,
};

use super::scene::{
    ParachuteEuler, ParachuteEulerParams, ParachuteLiteral, ParachuteLiteralParams, ParachuteMass,
    ParachuteMassParams, ParachuteRate, ParachuteRateParams, ParachuteStatic,
    ParachuteStaticParams, ParachuteStepwise, ParachuteStepwiseParams, SceneInstant, TestCase,
};

/// A model of the confluence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Confluence {
    /// A point with mass [kg], its lines damped or not.
    Mass(f64, Damping),
    /// An equilibrium point of undamped lines.
    Static,
    /// An equilibrium point, damping by the second-order difference.
    Stepwise,
    /// An equilibrium point, damping by the first-order difference.
    Euler,
    /// The paper's formula taken literally.
    Literal,
    /// An equilibrium point with its exact velocity.
    Rate,
}

/// Whether the lines of a point with mass are damped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Damping {
    /// As declared.
    On,
    /// C = 0.
    Off,
}

impl Confluence {
    /// `mass`, `static`, `stepwise` or `rate`.
    #[must_use]
    pub fn node(self) -> &'static str {
        match self {
            Confluence::Mass(..) => "mass",
            Confluence::Static => "static",
            Confluence::Stepwise | Confluence::Euler | Confluence::Literal => "stepwise",
            Confluence::Rate => "rate",
        }
    }

    /// What distinguishes it among those of the same [`Confluence::node`].
    #[must_use]
    pub fn detail(self) -> &'static str {
        match self {
            Confluence::Mass(_, Damping::On) | Confluence::Rate => "damped",
            Confluence::Mass(_, Damping::Off) | Confluence::Static => "undamped",
            Confluence::Stepwise => "damped, BDF2",
            Confluence::Euler => "damped, Euler",
            Confluence::Literal => "damped, literal clamp",
        }
    }

    /// The mass at the confluence [kg]; zero for an equilibrium point.
    #[must_use]
    pub fn mass_kg(self) -> f64 {
        match self {
            Confluence::Mass(kg, _) => kg,
            _ => 0.0,
        }
    }

    /// Whether the lines are damped.
    #[must_use]
    pub fn is_damped(self) -> bool {
        !matches!(self, Confluence::Mass(_, Damping::Off) | Confluence::Static)
    }

    /// The model whose exact solution is the reference of this one: itself for a point with mass, `static` and `rate` for the others.
    #[must_use]
    pub fn exact(self) -> Self {
        match self {
            Confluence::Mass(..) | Confluence::Static => self,
            _ => Confluence::Rate,
        }
    }

    /// A short name for files, `mass_0.1kg_undamped`.
    #[must_use]
    pub fn slug(self) -> String {
        match self {
            Confluence::Mass(kg, damping) => {
                format!(
                    "mass_{kg}kg{}",
                    if damping == Damping::On {
                        ""
                    } else {
                        "_undamped"
                    }
                )
            }
            Confluence::Euler => "stepwise_euler".into(),
            Confluence::Literal => "stepwise_literal".into(),
            _ => self.node().into(),
        }
    }
}

impl fmt::Display for Confluence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Confluence::Mass(kg, _) => write!(f, "point of {kg} kg, {}", self.detail()),
            _ => write!(f, "equilibrium point, {} ({})", self.node(), self.detail()),
        }
    }
}

/// A flight to be made.
#[derive(Clone, Debug)]
pub struct FlightPlan {
    /// The model of the confluence.
    pub confluence: Confluence,
    /// Where it starts.
    pub from: SceneInstant,
    /// When it ends [s].
    pub until: f64,
    /// The integrator.
    pub options: Options,
    /// The rows to keep.
    pub sampling: Sampling,
    /// What is in them.
    pub content: Content,
}

impl FlightPlan {
    /// A test case from its start.
    #[must_use]
    pub fn new(case: TestCase, confluence: Confluence, options: Options, until: f64) -> Self {
        FlightPlan {
            confluence,
            from: SceneInstant::start(case),
            until,
            options,
            sampling: Sampling::At(vec![until]),
            content: Content::RESULTS,
        }
    }

    /// The same with rows at these times.
    #[must_use]
    pub fn sampled(mut self, times: &[f64]) -> Self {
        self.sampling = Sampling::At(times.to_vec());
        self
    }

    /// The same with the motion, too.
    #[must_use]
    pub fn moving(mut self) -> Self {
        self.content = Content::ALL;
        self
    }

    /// The same with a row after every step.
    #[must_use]
    pub fn every_step(mut self) -> Self {
        self.sampling = Sampling::Steps;
        self
    }
}

/// What a flight left.
#[derive(Clone, Debug)]
pub struct Flight {
    /// Its history: line tensions and outputs.
    pub history: Trajectory,
    /// Its counters.
    pub statistics: Statistics,
    /// Where it ended.
    pub end: SceneInstant,
    /// Wall time [s].
    pub wall_s: f64,
}

impl Flight {
    /// The riser force of every row [N].
    #[must_use]
    pub fn riser(&self) -> &[f64] {
        self.history.column("riser_force").unwrap_or(&[])
    }

    /// The time of every row [s].
    #[must_use]
    pub fn times(&self) -> &[f64] {
        self.history.times()
    }
}

/// Why a flight could not be made.
#[derive(Debug)]
pub enum FlightError {
    /// Parameters outside their declaration.
    Params(ParamError),
    /// The run stopped.
    Run(RunError),
}

impl fmt::Display for FlightError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FlightError::Params(error) => error.fmt(f),
            FlightError::Run(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for FlightError {}

impl From<ParamError> for FlightError {
    fn from(error: ParamError) -> Self {
        FlightError::Params(error)
    }
}

impl From<RunError> for FlightError {
    fn from(error: RunError) -> Self {
        FlightError::Run(error)
    }
}

/// Makes a flight with the generated model of its confluence.
///
/// # Errors
/// Parameters outside their declaration, or what stopped the run.
pub fn fly(plan: &FlightPlan) -> Result<Flight, FlightError> {
    with_model(plan.confluence, |model| fly_model(plan, model))
}

/// Does something with the compiled model of a confluence.
///
/// # Errors
/// Parameters outside their declaration, or those of what is done.
pub fn with_model<R>(
    confluence: Confluence,
    act: impl FnOnce(&dyn Model<f64>) -> Result<R, FlightError>,
) -> Result<R, FlightError> {
    match confluence {
        Confluence::Mass(kg, damping) => {
            let mut params = ParachuteMassParams {
                m_point: kg,
                ..ParachuteMassParams::default()
            };
            if damping == Damping::Off {
                params.riser_c = 0.0;
                params.leg_c = 0.0;
            }
            act(&ParachuteMass::new(params)?)
        }
        Confluence::Static => act(&ParachuteStatic::new(ParachuteStaticParams::default())?),
        Confluence::Stepwise => act(&ParachuteStepwise::new(ParachuteStepwiseParams::default())?),
        Confluence::Euler => act(&ParachuteEuler::new(ParachuteEulerParams::default())?),
        Confluence::Literal => act(&ParachuteLiteral::new(ParachuteLiteralParams::default())?),
        Confluence::Rate => act(&ParachuteRate::new(ParachuteRateParams::default())?),
    }
}

/// Makes a flight with any model of the scene.
///
/// # Errors
/// What stopped the run.
pub fn fly_model(plan: &FlightPlan, model: &dyn Model<f64>) -> Result<Flight, FlightError> {
    let mut simulation = Simulation::new(model, plan.options)?;
    simulation.set_state(plan.from.time, &state(model, &plan.from))?;
    if owner(model) == ConfluenceOwner::Solver {
        simulation.set_nodes(&plan.from.point)?;
    }
    let mut history = Trajectory::new(model, plan.sampling.clone(), plan.content);
    let clock = Clock::now();
    simulation.record(plan.until, &mut history)?;
    let wall_s = clock.elapsed().as_secs_f64();
    let end = instant(
        owner(model),
        simulation.time(),
        simulation.state(),
        simulation.nodes(),
    );
    Ok(Flight {
        history,
        statistics: simulation.statistics(),
        end,
        wall_s,
    })
}

/// Who owns the position of the confluence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ConfluenceOwner {
    /// It is a coordinate, and has a speed.
    Coordinate,
    /// It is a node state.
    NodeState,
    /// The node solver finds it.
    Solver,
}

fn owner(model: &dyn Model<f64>) -> ConfluenceOwner {
    let layout = model.layout();
    match (layout.nodes.is_empty(), layout.nz) {
        (true, _) => ConfluenceOwner::Coordinate,
        (false, 0) => ConfluenceOwner::Solver,
        (false, _) => ConfluenceOwner::NodeState,
    }
}

/// The state [q | v | z] of a model of the scene at an instant.
#[must_use]
pub fn state(model: &dyn Model<f64>, at: &SceneInstant) -> Vec<f64> {
    let owner = owner(model);
    let mut state = at.q.to_vec();
    if owner == ConfluenceOwner::Coordinate {
        state.extend(at.point);
    }
    state.extend(at.v);
    match owner {
        ConfluenceOwner::Coordinate => state.extend(at.velocity),
        ConfluenceOwner::NodeState => state.extend(at.point),
        ConfluenceOwner::Solver => {}
    }
    state
}

/// The instant a state stands for. `nodes` are node positions, or velocities where the position is a state. A confluence found by the solver
/// has no speed of its own; the capsule's stands for it.
fn instant(owner: ConfluenceOwner, time: f64, state: &[f64], nodes: &[f64]) -> SceneInstant {
    fn list<const N: usize>(from: &[f64], at: usize) -> [f64; N] {
        std::array::from_fn(|i| from.get(at + i).copied().unwrap_or(f64::NAN))
    }
    let q = list(state, 0);
    let v: [f64; 12] = list(
        state,
        if owner == ConfluenceOwner::Coordinate {
            17
        } else {
            14
        },
    );
    let (point, velocity) = match owner {
        ConfluenceOwner::Coordinate => (list(state, 14), list(state, 29)),
        ConfluenceOwner::NodeState => (list(state, 26), list(nodes, 0)),
        ConfluenceOwner::Solver => (list(nodes, 0), list(&v, 6)),
    };
    SceneInstant {
        time,
        q,
        v,
        point,
        velocity,
    }
}
