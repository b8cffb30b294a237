//! Stand-in until the node solver lands.
use mbd_scene::{At, Float, Layout, LineKind, Model, Quantity};
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    Free,
    Slack,
    Active,
    Idle,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct NodeMemory<T> {
    pub(crate) modes: Vec<Mode>,
    pub p: Vec<T>,
}

impl<T> NodeMemory<T> {
    pub fn modes(&self) -> &[Mode] {
        &self.modes
    }
}

#[derive(Clone, Debug, PartialEq)]
pub enum NodeError {
    NotConverged {
        node: usize,
        residual_n: f64,
        iterations: usize,
    },
}

#[derive(Clone, Debug)]
pub struct Nodes<T> {
    hold: Vec<T>,
    frozen: bool,
    guards: usize,
}

impl<T: Float> Nodes<T> {
    pub fn new(layout: &Layout) -> Self {
        Nodes {
            hold: vec![T::zero(); layout.lines.len()],
            frozen: false,
            guards: layout.len(Quantity::Guards),
        }
    }
    pub fn frozen(&mut self, frozen: bool) {
        self.frozen = frozen;
    }
    #[allow(clippy::too_many_arguments)]
    pub fn start<M: Model<T>>(
        &mut self,
        model: &M,
        time: T,
        state: &mut [T],
        inputs: &[T],
        _guess: Option<&[T]>,
        memory: &mut NodeMemory<T>,
        work: &mut M::Work,
    ) -> Result<(), NodeError> {
        let mut guards = vec![T::zero(); self.guards];
        self.hold.fill(T::zero());
        let at = At {
            time,
            state,
            nodes: &[],
            effective: &[],
            hold: &self.hold,
            ends: &[],
            inputs,
        };
        model.evaluate(Quantity::Guards, &at, work, &mut guards);
        memory.modes.clear();
        for (pair, line) in guards.chunks_exact(2).zip(&model.scene().lines) {
            let [s, pull] = pair else { continue };
            memory.modes.push(
                if line.kind == LineKind::Spring || model.scene().is_zero(&line.damping) {
                    Mode::Free
                } else if *s > T::zero() && *pull >= T::zero() {
                    Mode::Active
                } else if *s > T::zero() {
                    Mode::Idle
                } else {
                    Mode::Slack
                },
            );
        }
        Ok(())
    }
    #[allow(clippy::too_many_arguments)]
    pub fn solve<M: Model<T>>(
        &mut self,
        _model: &M,
        _time: T,
        _span: T,
        _state: &[T],
        _inputs: &[T],
        memory: &NodeMemory<T>,
        _work: &mut M::Work,
    ) -> Result<(), NodeError> {
        for (hold, mode) in self.hold.iter_mut().zip(&memory.modes) {
            *hold = match mode {
                _ if !self.frozen => T::zero(),
                Mode::Free => T::zero(),
                Mode::Active => T::one(),
                _ => -T::one(),
            };
        }
        Ok(())
    }
    pub fn switch(&mut self, line: usize, mode: Mode, memory: &mut NodeMemory<T>) {
        if let Some(old) = memory.modes.get_mut(line) {
            *old = mode;
        }
    }
    pub fn nodes(&self) -> &[T] {
        &[]
    }
    pub fn effective(&self) -> &[T] {
        &[]
    }
    pub fn hold(&self) -> &[T] {
        &self.hold
    }
    pub fn commit(&mut self, _h: T, _memory: &mut NodeMemory<T>) {}
    pub fn iterations(&self) -> usize {
        0
    }
    pub fn rung(&self) -> usize {
        0
    }
}
