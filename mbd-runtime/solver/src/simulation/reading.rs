//! What a caller holds of a run, and reads of it.

use std::sync::Arc;

use mbd_scene::{Float, Model};

use super::{Acted, ModelRun, Moved, PassedStop, narrow};
use crate::balance::Imbalance;
use crate::dropped_here::DroppedHere;
use crate::error::{RunError, Statistics};
use crate::event::Occurrence;
use crate::momentum::MomentumImbalance;
use crate::node::NodeMemory;
use crate::options::Options;
use crate::rounding::CoarsePositions;
use crate::state_rounding::CoarseState;
use crate::step_sizes::StepSizes;
use crate::supply::Law;

/// A simulation of one model. `T` is the scalar of the state; time is always `f64`.
///
/// It owns its model and borrows nothing: it can be stored, returned, and moved to another thread.
///
/// ```
/// use mbd_runtime::{Options, PointState, Simulation, model};
///
/// model! {
///     /// A stone that falls.
///     model Stone {
///         gravity: [0.0, 0.0, -9.81] m/s^2;
///         emit: [derivative];
///         point stone { mass: 1.0 kg }
///     }
/// }
///
/// /// A stone at a height [m] that moves at 2 m/s along x.
/// fn thrown_from(height: f64) -> Result<Simulation<f64>, Box<dyn std::error::Error>> {
///     let stone = Stone::new(StoneParams::default())?;
///     let mut start = StoneState::at_origin();
///     start.set_stone(PointState { position: [0.0, 0.0, height], velocity: [2.0, 0.0, 0.0] });
///     let mut simulation = Simulation::new(&stone, Options::rk4(0.1))?;
///     simulation.set_state(0.0, &start.to_vec())?;
///     Ok(simulation)
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let mut simulation = thrown_from(10.0)?;
/// simulation.run(1.0)?;
///
/// // z = 10 m − ½ g t²; RK4 integrates a parabola exactly.
/// let end = StoneState::from_slice(simulation.state()).expect("the state of a stone").stone();
/// assert!((end.position[0] - 2.0).abs() < 1e-12);
/// assert!((end.position[2] - (10.0 - 0.5 * 9.81)).abs() < 1e-12);
/// assert_eq!(simulation.statistics().steps, 10);
/// # Ok(())
/// # }
/// ```
pub struct Simulation<T: Float> {
    pub(crate) run: DroppedHere<ModelRun<T>>,
}

impl<T: Float> Simulation<T> {
    /// What [`Simulation::new`] does.
    pub(crate) fn make(
        model: Arc<dyn Model<T>>,
        options: Options,
        controls: Vec<Law<T>>,
    ) -> Result<Self, RunError> {
        let run = ModelRun::make(model, options, controls)?;
        Ok(Simulation {
            run: DroppedHere::new(run),
        })
    }

    /// What the start moved so that the joints hold, the largest distance first; empty where they held already. The state that is set says where
    /// bodies are wanted; where joints forbid it, [`Simulation::start`] takes the nearest state that they allow, weighted by mass.
    #[must_use]
    pub fn start_moved(&self) -> &[Moved] {
        &self.run.moved
    }

    /// Where joint coordinates start that the declaration or [`Simulation::set_joints`] says to be about a value, and declared ones that gave way to what
    /// that gives: name, what was said and what was taken [m or rad].
    #[must_use]
    pub fn started_about(&self) -> Vec<(String, f64, f64)> {
        self.run.assembly.told_about(self.run.system.model.scene())
    }

    /// Joint coordinates that neither what was said of others nor their loops decide: where they start was chosen, near zero or near where they were.
    /// Only loops of which something is said are looked at; a coordinate in none is zero.
    #[must_use]
    pub fn start_undecided(&self) -> Vec<String> {
        self.run
            .assembly
            .told_undecided(self.run.system.model.scene())
    }

    /// Whether the start is a singular position of the joints: one where rows repeat each other that do nowhere else, as of bars in one line. More
    /// than one motion is possible from there, and which one a run takes is decided by rounding.
    #[must_use]
    pub fn starts_singular(&self) -> bool {
        self.run.singular_start
    }

    /// A time at which what acts with time alone does so between the stages of fixed steps, and none of them sees it, in the calls so far [s]: a pulse shorter
    /// than a step, a swing as fast as the steps. Adaptive steps end there. Of RK4 also one at which what follows an angle that turns by more than half a turn in a
    /// step, or a declared state, does so, as far as the first step, the second, the fourth and so on show it.
    #[must_use]
    pub fn hidden_from_steps(&self) -> Option<f64> {
        self.run.hidden
    }

    /// The model that is run.
    #[must_use]
    pub fn model(&self) -> &Arc<dyn Model<T>> {
        &self.run.system.model
    }

    /// Time of the last accepted step [s].
    #[must_use]
    pub fn time(&self) -> f64 {
        self.run.time
    }

    /// State x = [q | v | z | s] of the last accepted step, in the world: of a scene whose origin follows something with as many digits as numbers have
    /// there. [`Simulation::near_origin`] has the rest.
    #[must_use]
    pub fn state(&self) -> &[T] {
        let own = self.run.state.get(..self.run.system.nx).unwrap_or(&[]);
        match self.run.system.following {
            None => own,
            Some(_) => self
                .run
                .shown
                .state
                .get_or_init(|| narrow(self.run.system.in_world(self.run.time, own))),
        }
    }

    /// Of a scene whose origin follows something: where the origin is [m] and how fast it moves [m/s], world axes, and the state with positions
    /// and velocities measured from it.
    #[must_use]
    pub fn near_origin(&self) -> Option<([[f64; 3]; 2], &[T])> {
        let origin = self.run.system.origin()?;
        let own = self.run.state.get(..self.run.system.nx).unwrap_or(&[]);
        Some((origin.at(self.run.time), own))
    }

    /// Work of the loads, of the dampers and of prescribed motions on bodies and points since the start [J], when [`Options::work`] asks for it.
    #[must_use]
    pub fn work(&self) -> Option<[f64; 3]> {
        match self.run.state.get(self.run.system.nx..)? {
            [loads, dampers, drives] => Some([loads, dampers, drives].map(|work| work.to_f64())),
            _ => None,
        }
    }

    /// What the nodes and lines remember of the last accepted step; places from the origin, where that follows something.
    #[must_use]
    pub fn memory(&self) -> &NodeMemory<T> {
        &self.run.system.memory
    }

    /// Node unknowns of the last stage evaluated, as in `At::nodes`, in the world.
    #[must_use]
    pub fn nodes(&self) -> &[T] {
        let own = self.run.system.nodes.nodes();
        match self.run.system.following {
            None => own,
            Some(_) => self
                .run
                .shown
                .nodes
                .get_or_init(|| narrow(self.run.system.nodes_in_world(self.run.time, own))),
        }
    }

    /// Rates ẋ at the last accepted step, once started; of positions against the origin, where that follows something.
    #[must_use]
    pub fn rates(&self) -> &[T] {
        self.run
            .method
            .first()
            .get(..self.run.system.nx)
            .unwrap_or(&[])
    }

    /// Counters since creation.
    #[must_use]
    pub fn statistics(&self) -> Statistics {
        self.run.system.statistics()
    }

    /// How long the steps of this run are, where they are adaptive.
    #[must_use]
    pub fn step_sizes(&self) -> &StepSizes {
        &self.run.step_sizes
    }

    /// Keeps adaptive steps below those of another run at the same time, by as much as a tenth of its tolerance makes them shorter: with
    /// [`Options::finer`](crate::Options::finer) the run that tells the error of that one, where events, samples and entries of tables end the steps
    /// of both.
    pub fn refine(&mut self, other: &StepSizes) {
        self.run.below = Some(other.clone());
    }

    /// Located events of this run, in order. [`Simulation::set_state`] and [`Simulation::set_joints`] begin another run, with an empty list.
    #[must_use]
    pub fn events(&self) -> &[Occurrence] {
        &self.run.events
    }

    /// What actions of events did in this run so far, in order. [`Simulation::set_state`] and [`Simulation::set_joints`] begin another run: they
    /// take back what these changed and empty this list.
    #[must_use]
    pub fn actions(&self) -> &[Acted] {
        &self.run.changes.all
    }

    /// The stops that the start is beyond, in the order of the declaration; empty before [`Simulation::start`].
    #[must_use]
    pub fn starts_beyond_stops(&self) -> &[PassedStop] {
        &self.run.passed_stops
    }

    /// The numbers of the inputs that are held, in the order of [`Layout::inputs`](mbd_scene::Layout::inputs).
    #[must_use]
    pub fn held_inputs(&self) -> &[T] {
        &self.run.system.held
    }

    /// Positions with fewer digits than the tolerance of this run asks for, so that rounding decided its adaptive steps for the most part: far from the origin
    /// of the world, or in single precision.
    #[must_use]
    pub fn coarse_positions(&self) -> Option<CoarsePositions> {
        let model = &self.run.system.model;
        let known = (model.scene(), model.layout());
        self.run
            .step_rounding
            .told::<T>(known, self.run.sizes.length())
    }

    /// The angle of a joint or the declared state whose rounding makes most of what follows it, from a thousandth on: numbers that grow have ever fewer digits
    /// behind the point, and a sine of 1e7 rad has none in single precision.
    #[must_use]
    pub fn coarse_state(&self) -> Option<CoarseState> {
        self.run.coarse_state()
    }

    /// Energy that the run made or lost so far, over the energy that moved: an estimate of what its steps got wrong of everything that has an energy.
    /// `None` where it cannot be told, which says nothing good of the run: gravity is the caller's, the model does not emit its energy, nothing has run
    /// yet, or the scene has loads, dampers or motors and the steps are adaptive without their work: ask for [`Options::work`](crate::Options::work).
    #[must_use]
    pub fn imbalance(&self) -> Option<Imbalance> {
        let balance = self.run.balance.as_ref();
        balance.map(|balance| balance.imbalance(T::EPSILON.to_f64()))
    }

    /// Momentum that the run made or lost so far, over the momentum that moved, where [`Options::momentum`](crate::Options::momentum) asks for it. `None`
    /// where it does not, where the [ground holds](mbd_scene::Scene::held_by_ground) something, whose reactions change it, or where nothing has run yet.
    #[must_use]
    pub fn momentum_imbalance(&self) -> Option<MomentumImbalance> {
        self.run.momentum.as_ref().map(|balance| balance.so_far)
    }

    /// The most that rounding of positions made so far of what accelerates a body or a point through lines, springs and stops, or of an arm of the
    /// joints, at the start and at every tenth step: far from the origin of the world differences of positions have few digits. A run
    /// does not go beyond a tenth; from a thousandth on its forces have less than three digits. So it is with what rounding of time makes of accelerations
    /// where formulas read time: late in a run of single precision; and with what rounding of angles and declared states that grow makes of what follows
    /// them ([`Simulation::coarse_state`] names it).
    #[must_use]
    pub fn rounding(&self) -> f64 {
        let of_state = self.run.state_rounding.told();
        let of_state = of_state.map_or(0.0, |worst| worst.share);
        self.run
            .rounded
            .max(self.run.time_rounding.share())
            .max(of_state)
    }
}
