//! States along flights of any model: fixed steps of the classical Runge–Kutta method, with the nodes at hand.

use mbd_runtime::Work;
use mbd_runtime::node::{NodeError, NodeMemory, Nodes, Stage};
use mbd_scene::{Model, Quantity};

use crate::instant::Instant;
use crate::random::Random;

/// A model under way. Lines decide slack or taut by themselves at every stage.
pub struct Course<'m> {
    /// The model.
    pub model: &'m dyn Model<f64>,
    /// The nodes of the last stage.
    pub nodes: Nodes<f64>,
    /// What they carry from step to step.
    pub memory: NodeMemory<f64>,
    /// State of the last accepted step.
    pub state: Vec<f64>,
    /// Its time [s].
    pub time: f64,
    work: Work<f64>,
}

impl<'m> Course<'m> {
    /// Starts at a state, with nodes searched from `guess`.
    ///
    /// # Errors
    /// No equilibrium of a node.
    pub fn new(model: &'m dyn Model<f64>, state: &[f64], guess: &[f64]) -> Result<Self, NodeError> {
        let layout = model.layout();
        let mut course = Course {
            nodes: Nodes::new(layout),
            memory: NodeMemory::new(layout),
            state: state.to_vec(),
            time: 0.0,
            work: model.work(),
            model,
        };
        let guess = (guess.len() == 3 * layout.nodes.len()).then_some(guess);
        let stage = Stage {
            model,
            time: 0.0,
            state,
            inputs: &[],
        };
        course
            .nodes
            .start_stage(stage, guess, &mut course.memory, &mut course.work)?;
        course.nodes.place_in(&mut course.state);
        Ok(course)
    }

    /// Solves the nodes at a state `span` after the last accepted step.
    ///
    /// # Errors
    /// No equilibrium of a node.
    pub fn solve(&mut self, span: f64, state: &[f64]) -> Result<(), NodeError> {
        let stage = Stage {
            model: self.model,
            time: self.time + span,
            state,
            inputs: &[],
        };
        self.nodes
            .solve_stage(stage, span, &self.memory, &mut self.work)
    }

    /// All arguments of an evaluation at a state with the nodes of the last solve.
    #[must_use]
    pub fn instant(&self, state: &[f64]) -> Instant<f64> {
        let at = self.nodes.at(self.time, state, &[]);
        Instant {
            time: at.time,
            state: at.state.to_vec(),
            nodes: at.nodes.to_vec(),
            effective: at.effective.to_vec(),
            hold: at.hold.to_vec(),
            ends: at.ends.to_vec(),
            rows: at.rows.to_vec(),
            inputs: at.inputs.to_vec(),
        }
    }

    /// One step of length `h` [s].
    ///
    /// # Errors
    /// No equilibrium of a node.
    pub fn step(&mut self, h: f64) -> Result<(), NodeError> {
        let start = self.state.clone();
        let mut total = vec![0.0; start.len()];
        let mut slope: Vec<f64> = vec![0.0; start.len()];
        for (part, weight) in [(0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)] {
            let stage = along(&start, &slope, part * h);
            self.solve(part * h, &stage)?;
            let at = self.nodes.at(self.time + part * h, &stage, &[]);
            self.model
                .evaluate(Quantity::Derivative, &at, &mut self.work, &mut slope);
            total = along(&total, &slope, weight / 6.0);
        }
        let mut end = along(&start, &total, h);
        normalise(self.model, &mut end);
        self.solve(h, &end)?;
        if self.nodes.project(&mut end) {
            self.solve(h, &end)?;
        }
        self.state = end;
        self.time += h;
        self.nodes.commit(h, &mut self.memory);
        Ok(())
    }

    /// The state of the last accepted step, moved at random: millimetres, milliradians, decimetres and deciradians per second.
    #[must_use]
    pub fn nearby(&self, random: &mut Random) -> Vec<f64> {
        let layout = self.model.layout();
        let mut state = self.state.clone();
        for (index, x) in state.iter_mut().enumerate() {
            let is_speed = (layout.nq..layout.nq + layout.nv).contains(&index);
            let size = if is_speed { 0.1 } else { 1e-3 };
            *x += random.uniform(-size, size);
        }
        normalise(self.model, &mut state);
        state
    }
}

fn along(from: &[f64], slope: &[f64], h: f64) -> Vec<f64> {
    from.iter().zip(slope).map(|(x, k)| x + h * k).collect()
}

fn normalise(model: &dyn Model<f64>, state: &mut [f64]) {
    for (_, body) in model.layout().own_bodies() {
        let attitude = &mut state[body.q + 3..body.q + 7];
        let size = attitude.iter().map(|x| x * x).sum::<f64>().sqrt();
        attitude.iter_mut().for_each(|x| *x /= size);
    }
}
