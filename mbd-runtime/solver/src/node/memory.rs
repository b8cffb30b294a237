//! What the nodes carry from one accepted step to the next: written on accept, untouched by rejected steps and trial stages.

use mbd_scene::{Detachable, Float, Layout};
use serde::{Deserialize, Serialize};

use super::error::NodeError;
use crate::unilateral::Mode;

/// The memory of all nodes and damped lines of one run.
///
/// A value of this type, the state and the time are everything a run needs to continue: two runs from equal triples are equal bit by bit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct NodeMemory<T> {
    /// Nodes p_n, 3 a node [m].
    pub(crate) nodes: Vec<T>,
    /// How fast each node moved in the last step against the mean of its anchors, 3 a node [m/s]; zero after a start, where a line changed between slack
    /// and taut or all are slack, and of `rate` nodes.
    #[serde(default = "Vec::new")]
    pub(crate) against: Vec<T>,
    /// Anchors P_n, 3 an anchor [m]; as the next two, of `rate` nodes those of any step before.
    pub(crate) anchors: Vec<T>,
    /// Stretch s_n of each line, either sign [m].
    pub(crate) stretch: Vec<T>,
    /// Stretch s_{n−1} of each line [m].
    pub(crate) previous: Vec<T>,
    /// The accepted K_e, L_e of each line with effective numbers: they give back T_n at p_n.
    pub(crate) effective: Vec<T>,
    /// The last step h_prev [s].
    pub(crate) step: T,
    /// Per network: s_{n−1} may be used (no line changed between slack and taut in the last step).
    pub(crate) smooth: Vec<bool>,
    /// Per network: directions spanned by the lines of a `rate` node that stays on the line or plane of its anchors; 3: none is held.
    pub(crate) ranks: Vec<usize>,
    /// How long the next step may be on the way to where a `rate` node is drawn straight [s].
    #[serde(default = "Option::default")]
    pub(crate) before_straight: Option<f64>,
    /// Mode of each line, of each stop, of each joint that may be detached; nothing of each lock.
    pub(crate) modes: Vec<Mode>,
    /// What each lock holds its coordinate at [m or rad].
    #[serde(default = "Vec::new")]
    pub(crate) held: Vec<T>,
    /// Angles whose turns are counted, at the last accepted step [rad].
    #[serde(default = "Vec::new")]
    pub(crate) turns: Vec<T>,
}

/// The mode of every element before a run decides it: what is detached at the start, nothing of the rest.
fn start_modes(layout: &Layout) -> Vec<Mode> {
    let of = |detached| match detached {
        true => Mode::Detached,
        false => Mode::Free,
    };
    layout.start_detached().map(of).collect()
}

/// Nodes, anchors and stretches at the last accepted step, stretches at the one before it.
pub(crate) struct LastStep<'a, T> {
    /// Positions of the nodes, 3 each [m].
    pub nodes: &'a [T],
    /// How fast they moved in the last step against their anchors, 3 each [m/s].
    pub against: &'a [T],
    /// Positions of their anchors, 3 each [m].
    pub anchors: &'a [T],
    /// Stretch of every line [m].
    pub stretch: &'a [T],
    /// The same a step before [m].
    pub previous: &'a [T],
    /// K_e and L_e of each line with effective numbers.
    pub effective: &'a [T],
    /// Per network whether no line changed between slack and taut in the last step.
    pub smooth: &'a [bool],
    /// Size of the last step [s].
    pub step: T,
}

impl<T: Float> NodeMemory<T> {
    /// An empty memory; [`Nodes::start`](super::Nodes::start) fills it.
    #[must_use]
    pub fn new(layout: &Layout) -> Self {
        let list = |n: usize| vec![T::zero(); n];
        NodeMemory {
            nodes: list(3 * layout.nodes.len()),
            against: list(3 * layout.nodes.len()),
            anchors: list(3 * layout.anchors.len()),
            stretch: list(layout.lines.len()),
            previous: list(layout.lines.len()),
            effective: list(layout.effective_numbers),
            step: T::zero(),
            smooth: vec![false; layout.networks.len()],
            ranks: vec![3; layout.networks.len()],
            before_straight: None,
            modes: start_modes(layout),
            held: list(layout.locks),
            turns: list(layout.turns.len()),
        }
    }

    /// What the next solves of networks start from.
    pub(crate) fn last_step(&self) -> LastStep<'_, T> {
        LastStep {
            nodes: &self.nodes,
            against: &self.against,
            anchors: &self.anchors,
            stretch: &self.stretch,
            previous: &self.previous,
            effective: &self.effective,
            smooth: &self.smooth,
            step: self.step,
        }
    }

    /// Takes the numbers of another memory of the same layout, in the room that is there.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        let NodeMemory {
            nodes,
            against,
            anchors,
            stretch,
            previous,
            effective,
            step,
            smooth,
            ranks,
            before_straight,
            modes,
            held,
            turns,
        } = other;
        self.nodes.clone_from(nodes);
        self.against.clone_from(against);
        self.anchors.clone_from(anchors);
        self.stretch.clone_from(stretch);
        self.previous.clone_from(previous);
        self.effective.clone_from(effective);
        self.step = *step;
        self.smooth.clone_from(smooth);
        self.ranks.clone_from(ranks);
        self.before_straight = *before_straight;
        self.modes.clone_from(modes);
        self.held.clone_from(held);
        self.turns.clone_from(turns);
    }

    /// Makes room for what a memory that an older version kept does not have.
    pub(crate) fn make_room(&mut self) {
        self.against.resize(self.nodes.len(), T::zero());
    }

    /// The last step [s] of a network no line of which changed between slack and taut in it, else zero.
    pub(crate) fn smooth_step(&self, network: usize) -> T {
        match self.smooth.get(network) {
            Some(true) => self.step,
            _ => T::zero(),
        }
    }

    /// The accepted node positions p_n, 3 a node [m].
    #[must_use]
    pub fn nodes(&self) -> &[T] {
        &self.nodes
    }

    /// The mode of each line, of each stop of a joint, of each joint that may be detached.
    #[must_use]
    pub fn modes(&self) -> &[Mode] {
        &self.modes
    }

    /// Puts an element into a mode that an event or a start says; [`Nodes::start`](super::Nodes::start) decides all others.
    pub(crate) fn set_mode(&mut self, element: usize, mode: Mode) {
        if let Some(slot) = self.modes.get_mut(element) {
            *slot = mode;
        }
    }

    /// Of a lock that holds nothing yet: it holds its coordinate at that one of these numbers.
    pub(crate) fn lock(&mut self, layout: &Layout, what: Detachable, numbers: &[f64]) {
        let switch = layout.switch_of(what).and_then(|at| self.modes.get(at));
        if let Some(Mode::Detached) = switch {
            self.hold_at(layout, what, numbers);
        }
    }

    /// A lock holds its coordinate at that one of these numbers from here on.
    pub(crate) fn hold_at(&mut self, layout: &Layout, what: Detachable, numbers: &[f64]) {
        if let Some(place) = layout.held_of(what)
            && let (Some(slot), Some(&number)) = (self.held.get_mut(place), numbers.get(place))
        {
            *slot = T::from_f64(number);
        }
    }

    /// Every element as it is before a run.
    pub(crate) fn forget_modes(&mut self, layout: &Layout) {
        self.modes = start_modes(layout);
    }

    /// Whether this memory belongs to that layout (it may have been read from a file).
    pub(crate) fn check(&self, layout: &Layout) -> Result<(), NodeError> {
        // One after the other: a table of them would be written at every stage.
        let same = NodeError::same_length;
        let (lines, networks) = (layout.lines.len(), layout.networks.len());
        same("memory of nodes", self.nodes.len(), 3 * layout.nodes.len())?;
        same(
            "memory of anchors",
            self.anchors.len(),
            3 * layout.anchors.len(),
        )?;
        same("memory of stretch", self.stretch.len(), lines)?;
        same("memory of stretch", self.previous.len(), lines)?;
        same(
            "memory of forces",
            self.effective.len(),
            layout.effective_numbers,
        )?;
        same("memory of networks", self.smooth.len(), networks)?;
        same("memory of networks", self.ranks.len(), networks)?;
        same("memory of modes", self.modes.len(), layout.holds())?;
        same("memory of locks", self.held.len(), layout.locks)?;
        same("memory of turns", self.turns.len(), layout.turns.len())
    }
}
