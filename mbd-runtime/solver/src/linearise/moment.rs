//! A scene at one moment, in `f64` whatever the scalar of its model: state, inputs, nodes in balance. What everything cold looks at that needs more
//! than a quantity: state-space matrices, trim, inverse dynamics.

use std::sync::Arc;

use mbd_scene::{
    At, Float, JointStart, LINE_NUMBERS, Layout, Model, NodeModel, Quantity, Scene, Variable, Work,
};
use nalgebra::{DMatrix, DVector};

use super::{Linearisation, LinearisationError};
use crate::columns::{input_name, line_name, state_names};
use crate::displace::displace;
use crate::generic::Generic;
use crate::laws::{numbers_of, params_of};
use crate::moving::moving;
use crate::slopes::{Effective, Slopes};
use crate::system::{Remembered, SAME_PLACE, System};
use crate::unilateral::Mode;

/// A scene at one moment.
pub(crate) struct SceneMoment {
    pub model: Arc<Generic<f64>>,
    pub time: f64,
    pub state: Vec<f64>,
    pub inputs: Vec<f64>,
    /// The `stepwise` nodes with damped lines, by name.
    pub damped_by_steps: Vec<String>,
    system: System<f64>,
    work: Work<f64>,
    slopes: Slopes,
}

impl SceneMoment {
    /// The scene of a model at a time and a state, for these inputs. Its nodes are not placed yet.
    pub(crate) fn new<T: Float>(
        model: &dyn Model<T>,
        at: (f64, &[f64], &[f64]),
    ) -> Result<Self, LinearisationError> {
        Self::with_layout(model, model.layout().clone(), at)
    }

    /// The same for a scene at rest, or in steady motion, where damping by differences from step to step pulls with nothing: nodes with it are in the balance
    /// of `static` ones.
    pub(crate) fn at_rest<T: Float>(
        model: &dyn Model<T>,
        at: (f64, &[f64], &[f64]),
    ) -> Result<Self, LinearisationError> {
        let mut layout = model.layout().clone();
        let nodes = layout.nodes.iter_mut().map(|node| {
            node.velocity = None;
            &mut node.model
        });
        let networks = layout.networks.iter_mut();
        for own in nodes.chain(networks.map(|network| &mut network.model)) {
            if let NodeModel::Stepwise { .. } = own {
                *own = NodeModel::Static;
            }
        }
        Self::with_layout(model, layout, at)
    }

    fn with_layout<T: Float>(
        model: &dyn Model<T>,
        layout: Layout,
        (time, state, inputs): (f64, &[f64], &[f64]),
    ) -> Result<Self, LinearisationError> {
        let scene = model.scene();
        check_lists((scene, &layout), (time, state, inputs))?;
        let (params, numbers) = (params_of(model.params()), numbers_of(model));
        let generic = Arc::new(Generic {
            scene: Arc::new(scene.clone()),
            layout: Arc::new(layout),
            lines: numbers.lines.clone(),
            numbers,
            params,
        });
        let mut system = System::new(generic.clone(), Vec::new(), false);
        system.hold(inputs);
        system.remember_starts(&[], (time, state));
        Ok(SceneMoment {
            slopes: Slopes::new(scene, &generic.layout, &generic.params),
            damped_by_steps: damped_by_steps(model),
            work: generic.scratch(),
            system,
            model: generic,
            time,
            state: state.to_vec(),
            inputs: inputs.to_vec(),
        })
    }

    /// The scene beside this moment: moved by these numbers in the state, with these inputs and its nodes in balance.
    pub(crate) fn beside(
        &self,
        moves: &DVector<f64>,
        inputs: Vec<f64>,
    ) -> Result<Self, LinearisationError> {
        let state = self.state.iter().zip(moves.iter());
        let mut state: Vec<f64> = state.map(|(x, more)| x + more).collect();
        self.system.normalise(&mut state);
        let layout = (*self.model.layout).clone();
        let mut beside = Self::with_layout(&*self.model, layout, (self.time, &state, &inputs))?;
        beside.recall(&self.remembered());
        beside.balance_nodes(Some(&self.node_positions()))?;
        Ok(beside)
    }

    /// Counts turns of angles from these starts of joints on.
    pub(crate) fn begin_turns(&mut self, starts: &[JointStart]) {
        let at = (self.time, &self.state[..]);
        self.system.remember_starts(starts, at);
    }

    /// The values of the angles of [`Layout::turns`] [rad].
    pub(crate) fn turns(&self) -> Vec<f64> {
        self.system.memory.turns.clone()
    }

    /// Goes on from these values of the angles of [`Layout::turns`] [rad].
    pub(crate) fn count_turns_from(&mut self, angles: impl IntoIterator<Item = f64>) {
        self.system.count_turns_from(angles);
    }

    /// Puts the nodes in balance at the state as it is now; `guess` has their positions, of `rate` nodes those that they keep.
    pub(crate) fn balance_nodes(
        &mut self,
        guess: Option<&[f64]>,
    ) -> Result<(), LinearisationError> {
        self.system.hold(&self.inputs);
        let started = self.system.start(self.time, &mut self.state, guess);
        started.map_err(|cause| LinearisationError::Nodes(Box::new(cause)))
    }

    /// Moves bodies and points by δ in the components of the speeds.
    pub(crate) fn displace(&mut self, moves: &[f64]) {
        let components = self.scene().angular_velocity;
        displace(
            (moving(&self.model.layout), components),
            &mut self.state,
            moves,
            1.0,
        );
        self.system.normalise(&mut self.state);
        self.system.count_turns(self.time, &self.state);
    }

    /// Goes on from what a run remembers.
    pub(crate) fn recall(&mut self, remembered: &Remembered) {
        self.system.recall(remembered);
    }

    /// What is remembered here.
    pub(crate) fn remembered(&self) -> Remembered {
        self.system.remembered()
    }

    /// Number of independent rows, at least, of the joints that hold.
    pub(crate) fn rank(&self) -> usize {
        self.system.rank()
    }

    pub(crate) fn scene(&self) -> &Scene {
        &self.model.scene
    }

    pub(crate) fn layout(&self) -> &Layout {
        &self.model.layout
    }

    /// A quantity here; `rows` as in [`At::rows`].
    pub(crate) fn evaluate(&mut self, what: Quantity, rows: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.model.layout.len(what)];
        let at = self.system.nodes.at(self.time, &self.state, &self.inputs);
        self.model
            .run(what, &At { rows, ..at }, &mut self.work, &mut out);
        out
    }

    /// ∂(quantity)/∂(state) at fixed nodes.
    pub(crate) fn by_state(&mut self, what: Quantity, rows: &[f64]) -> DMatrix<f64> {
        self.by(what, Variable::State, rows)
    }

    /// Derivatives of a quantity by the inputs at fixed node unknowns.
    pub(crate) fn by_input(&mut self, what: Quantity) -> DMatrix<f64> {
        self.by(what, Variable::Input, &[])
    }

    fn by(&mut self, what: Quantity, variable: Variable, rows: &[f64]) -> DMatrix<f64> {
        let layout = &self.model.layout;
        let (lines, columns) = (layout.len(what), layout.variables(variable));
        let mut out = vec![0.0; lines * columns];
        let at = self.system.nodes.at(self.time, &self.state, &self.inputs);
        let (scene, of) = ((&*self.model.scene, &**layout), (what, variable));
        let at = At { rows, ..at };
        self.slopes
            .differentiate(scene, of, Effective::Fixed, &at, &mut out);
        DMatrix::from_row_slice(lines, columns, &out)
    }

    /// Whether accelerations here are those of masses.
    ///
    /// # Errors
    /// A speed that nothing gives an inertia.
    pub(crate) fn check_inertia(&mut self) -> Result<(), LinearisationError> {
        let checked = self.system.check_inertia(self.time, &self.state);
        checked.map_err(|cause| LinearisationError::Inertia(Box::new(cause)))
    }

    /// Total derivatives here.
    pub(crate) fn linearise(&mut self) -> Result<Linearisation<f64>, LinearisationError> {
        self.check_inertia()?;
        let mut linear = Linearisation::new(&self.model.layout);
        let at = self.system.nodes.at(self.time, &self.state, &self.inputs);
        linear.run(&*self.model, &at, &mut self.work)?;
        Ok(linear)
    }

    /// ẋ here.
    ///
    /// # Errors
    /// One that is not finite.
    pub(crate) fn rates(&mut self) -> Result<Vec<f64>, LinearisationError> {
        let rates = self.evaluate(Quantity::Derivative, &[]);
        match rates.iter().position(|x| !x.is_finite()) {
            None => Ok(rates),
            Some(at) => {
                let names = state_names(&self.model.scene, &self.model.layout);
                Err(LinearisationError::NotFinite {
                    what: Quantity::Derivative,
                    of: names
                        .into_iter()
                        .nth(at)
                        .map_or_else(String::new, |name| name.name),
                })
            }
        }
    }

    /// The lines and springs with both ends at the same place whose damping has no direction there.
    ///
    /// # Errors
    /// The first spring whose force has none: one that has a free length.
    pub(crate) fn without_direction(&mut self) -> Result<Vec<String>, LinearisationError> {
        let numbers = self.evaluate(Quantity::Lines, &[]);
        let (scene, layout) = (self.scene(), self.layout());
        let lines = scene.lines.iter().zip(&layout.lines);
        let lines = lines.zip(numbers.chunks_exact(LINE_NUMBERS)).enumerate();
        let mut undamped = Vec::new();
        for (index, ((line, slots), numbers)) in lines {
            let [force, apart, stretch, ..] = *numbers else {
                continue;
            };
            let detached = self.system.memory.modes().get(index) == Some(&Mode::Detached);
            if slots.effective.is_some() || detached || apart > SAME_PLACE {
                continue;
            }
            let name = line_name(scene, index).to_owned();
            match stretch.abs() > SAME_PLACE {
                true if !line.kind.is_unilateral() && force != 0.0 => {
                    return Err(LinearisationError::NoDirection { spring: name });
                }
                false if !scene.is_zero(&line.damping) => undamped.push(name),
                _ => (),
            }
        }
        Ok(undamped)
    }

    /// Positions of the nodes at the state as it is now, as the last balance has them.
    pub(crate) fn node_positions(&self) -> Vec<f64> {
        let layout = &self.model.layout;
        layout.node_positions(&self.state, self.system.nodes.nodes())
    }
}

/// The `stepwise` nodes with damped lines.
fn damped_by_steps<T: Float>(model: &dyn Model<T>) -> Vec<String> {
    let (scene, layout) = (model.scene(), model.layout());
    let is_damped = |&line: &usize| {
        let numbers = model.lines().get(line);
        numbers.is_some_and(|numbers| numbers.damping > T::zero())
    };
    let by_steps = layout.nodes.iter().filter(|node| {
        let network = layout.networks.get(node.network);
        let damped = network.is_some_and(|network| network.lines.iter().any(is_damped));
        matches!(node.model, NodeModel::Stepwise { .. }) && damped
    });
    let names = by_steps.filter_map(|node| scene.points.get(node.point));
    names.map(|point| point.name.clone()).collect()
}

/// Refuses a time, a state and inputs that are no moment of a scene: lists of another length, numbers that are not finite.
pub(crate) fn check_lists(
    (scene, layout): (&Scene, &Layout),
    (time, state, inputs): (f64, &[f64], &[f64]),
) -> Result<(), LinearisationError> {
    for (what, got, expected) in [
        ("state", state.len(), layout.nx()),
        ("inputs", inputs.len(), layout.ni),
    ] {
        if got != expected {
            return Err(LinearisationError::Length {
                what,
                got,
                expected,
            });
        }
    }
    check_given([("time", time)])?;
    let all = || state.iter().chain(inputs);
    match all().all(|x| x.is_finite()) {
        true => Ok(()),
        false => {
            let names = state_names(scene, layout).into_iter().map(|own| own.name);
            let names = names.chain((0..layout.ni).map(|at| input_name(scene, layout, at)));
            check_given(names.zip(all().copied()))
        }
    }
}

/// Refuses the first number that is not finite, of some with what they were given for.
pub(crate) fn check_given<N: Into<String>>(
    given: impl IntoIterator<Item = (N, f64)>,
) -> Result<(), LinearisationError> {
    match given.into_iter().find(|(_, value)| !value.is_finite()) {
        None => Ok(()),
        Some((name, value)) => Err(LinearisationError::Given {
            name: name.into(),
            value,
        }),
    }
}

/// A matrix of derivatives in another form.
pub(super) fn dense(matrix: &super::Matrix<f64>) -> DMatrix<f64> {
    DMatrix::from_row_slice(matrix.rows(), matrix.columns(), matrix.values())
}
