//! What a run knows of how its rows are solved: the strategy held for a step, that of the step after it, and room for the solvers.

use serde::{Deserialize, Serialize};

use super::dense::Dense;

/// How the rows are solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(crate) enum RowStrategy {
    /// As emitted.
    #[default]
    Emitted,
    /// Rows chosen anew.
    Chosen,
    /// The whole matrix.
    Whole,
    /// All rows, regularised: a stage, never a step.
    Regularised,
}

/// What is held for a step.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct HeldRows {
    pub strategy: RowStrategy,
    pub rows: Vec<usize>,
    /// Whether every stage of the step takes these rows: one of them could not be solved otherwise.
    pub whole_step: bool,
    /// √ of the margin at the start of the step.
    pub size: f64,
    /// Whether the step may pass a singular state.
    pub near: bool,
    /// Whether limits are taken wherever they are better than the emitted elimination: a step was rejected near a state that is not passed yet.
    #[serde(default)]
    pub wide: bool,
    /// Whether rows that were left out tell the motion better than those kept.
    #[serde(default)]
    pub outdone: bool,
    /// √ of the margin at which that was asked last and was not so; zero where it was not asked.
    #[serde(default)]
    pub asked: f64,
}

/// What a run needs to go on solving its rows as it did.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct SavedStrategy {
    held: HeldRows,
    base: RowStrategy,
    lasting: bool,
    #[serde(default)]
    most: usize,
}

/// The chain of one run.
#[derive(Clone, Debug, Default)]
pub(crate) struct Fallback {
    /// Of the step that is tried.
    pub(super) now: HeldRows,
    /// Of the step after it.
    pub(super) next: HeldRows,
    /// Whether the stage to come is the first of the step after.
    pub(super) at_end: bool,
    /// Whether the stage to come is asked for behind a step that was made: nobody makes that step again.
    pub(super) behind: bool,
    /// The strategy of a run away from singular states.
    pub(super) base: RowStrategy,
    /// What the last factor left to its smallest pivot; NaN when there was none since the last step.
    pub margin: f64,
    pub(super) dense: Dense,
    /// Whether the stage that was evaluated last was solved by `dense`, and whether regularised.
    pub(super) anew: bool,
    pub(super) regularised: bool,
    /// Whether rows have lost rank for longer than an instant.
    pub(super) lasting: bool,
    /// The most rows that were chosen at once, in runs that choose them all along, since rows began or an event changed them.
    pub(super) most: usize,
    /// Distance over which a motion changes [m], once it was asked for.
    pub(super) reach: Option<f64>,
    /// Room for h.
    pub(super) bias: Vec<f64>,
    /// Room for Φ_v at the end of a step.
    pub(super) ahead: Vec<f64>,
    /// Room for rows chosen in a projection.
    pub(super) spare: Vec<usize>,
    /// Room for the rows kept.
    pub(super) kept: Vec<usize>,
    /// The worst strategy used.
    pub worst: RowStrategy,
    /// Decimal digits that uneven masses cost on the strategy of the run.
    pub lost_digits: u64,
}

impl Fallback {
    pub(super) fn held(&self) -> &HeldRows {
        if self.at_end { &self.next } else { &self.now }
    }

    pub(super) fn held_mut(&mut self) -> &mut HeldRows {
        if self.at_end {
            &mut self.next
        } else {
            &mut self.now
        }
    }

    /// A trial step begins.
    pub(crate) fn enter(&mut self) {
        self.at_end = false;
    }

    /// Stages inside the step come after that at its end; returns what [`Fallback::come_back`] takes.
    pub(crate) fn leave_end(&mut self) -> (bool, f64, [bool; 2]) {
        let left = (self.at_end, self.margin, [self.anew, self.regularised]);
        (self.at_end, self.behind) = (false, true);
        left
    }

    /// The stages inside the step are evaluated.
    pub(crate) fn come_back(
        &mut self,
        (at_end, margin, [anew, regularised]): (bool, f64, [bool; 2]),
    ) {
        (self.at_end, self.behind, self.margin) = (at_end, false, margin);
        (self.anew, self.regularised) = (anew, regularised);
    }

    /// The trial step is taken.
    pub(crate) fn commit(&mut self) {
        self.now.clone_from(&self.next);
        self.at_end = false;
    }

    /// Writes what the step to come is solved with, in the room that is there.
    pub(crate) fn save(&self, to: &mut SavedStrategy) {
        let HeldRows {
            strategy,
            rows,
            whole_step,
            size,
            near,
            wide,
            outdone,
            asked,
        } = &self.now;
        to.held.rows.clone_from(rows);
        to.held = HeldRows {
            rows: std::mem::take(&mut to.held.rows),
            strategy: *strategy,
            whole_step: *whole_step,
            size: *size,
            near: *near,
            wide: *wide,
            outdone: *outdone,
            asked: *asked,
        };
        to.base = self.base;
        to.lasting = self.lasting;
        to.most = self.most;
    }

    /// Takes up what another run held, for the stage at its last step; [`Fallback::commit`] follows.
    pub(crate) fn resume(&mut self, footing: &SavedStrategy) {
        self.next.clone_from(&footing.held);
        self.base = footing.base;
        self.lasting = footing.lasting;
        self.most = footing.most;
        self.at_end = true;
    }
}
