//! The rows of joints of several runs beside each other: putting the ends of their steps back on their joints.
//!
//! The rounds are those of [`crate::projection`], with the operations of a run alone and as many of them: a lane that is done stays as it is. Where the
//! emitted elimination cannot be trusted, or rows stay open, a lane is left to its run.

use std::convert::Infallible;

use mbd_scene::{AngularVelocity, At, Layout, Quantity};

use super::Lanes;
use super::form::LaneParameters;
use super::group::{Stages, faults};
use super::lockstep::normalise;
use super::networks::{flag, put};
use crate::fallback::trusted_in_passing;
use crate::list::largest_size;
use crate::moving::{Moving, moving};
use crate::projection::{
    JointMeasures, OnJoints, STEP, displace_shortened, project_positions, project_velocities,
};
use crate::simulation::ModelRun;

/// What is needed to put states on joints, and room for it.
pub(super) struct Joints<L> {
    measures: JointMeasures<L>,
    parts: Vec<Moving>,
    components: AngularVelocity,
    rows: Vec<L>,
    /// δ, and behind it the margin of the factor.
    shift: Vec<L>,
    /// The state before a move.
    kept: Vec<L>,
    /// The margin of the last factor of each lane; not a number where there was none in this step.
    margin: L,
    /// One in a lane with a step whose moves could all be trusted.
    usable: L,
}

/// What evaluates rows at a time: equations, what their stages hold, and where quaternions begin.
pub(super) type PutOn<'a, L> = (
    &'a mut (dyn LaneParameters<L> + 'static),
    &'a Stages<L>,
    &'a [usize],
);

impl<L: Lanes> Joints<L> {
    pub(super) fn new(layout: &Layout, components: AngularVelocity) -> Self {
        let room = |length| vec![L::zero(); if layout.nc > 0 { length } else { 0 }];
        Joints {
            measures: JointMeasures {
                epsilon: f64::EPSILON,
                length: L::one(),
                extent: L::zero(),
                coordinates: layout.nq,
                speeds: layout.nv,
            },
            parts: moving(layout).filter(|_| layout.nc > 0).collect(),
            components,
            rows: room(layout.nc),
            shift: room(layout.nv + 1),
            kept: room(layout.nx()),
            margin: L::from_f64(f64::NAN),
            usable: L::zero(),
        }
    }

    /// Takes the sizes of a scene into a lane.
    pub(super) fn load(&mut self, lane: usize, run: &ModelRun<f64>) {
        let JointMeasures { length, extent, .. } = run.system.measures();
        put(lane, &mut self.measures.length, length);
        put(lane, &mut self.measures.extent, extent);
    }

    /// Steps begin in these lanes.
    pub(super) fn begin(&mut self, has_step: impl Fn(usize) -> bool) {
        self.margin = L::from_f64(f64::NAN);
        self.usable = L::each(|lane| if has_step(lane) { 1.0 } else { 0.0 });
    }

    /// What the last factor of each lane left to its smallest pivot.
    pub(super) fn margin(&self) -> L {
        self.margin
    }

    /// Puts the states at the ends of steps back on the joints, and measures the rows there; one in a lane that is on its joints.
    pub(super) fn put_on(&mut self, by: PutOn<'_, L>, time: L, state: &mut [L]) -> L {
        if self.rows.is_empty() {
            return L::one();
        }
        let begun = L::zero().lt(self.usable);
        let mut on = LanesOnJoints {
            own: self,
            by,
            time,
        };
        let Ok(left) = project_positions(&mut on, state, STEP, begun);
        let together = left.le(on.own.measures.apart(state));
        on.own.usable *= flag(together);
        let usable = L::zero().lt(on.own.usable);
        let Ok(()) = project_velocities(&mut on, state, usable);
        on.measure(state);
        on.own.usable
    }
}

/// The joints of all lanes, each at its time [s].
struct LanesOnJoints<'a, L> {
    own: &'a mut Joints<L>,
    by: PutOn<'a, L>,
    time: L,
}

impl<L: Lanes> LanesOnJoints<'_, L> {
    /// Solves for the move of the rows.
    fn solve_rows(&mut self, state: &[L]) {
        let (form, stages, _) = &mut self.by;
        let at = At {
            rows: &self.own.rows,
            ..stages.at(self.time, state)
        };
        form.evaluate(Quantity::ProjectionStep, &at, &mut self.own.shift);
    }

    /// Takes the margin of the last factor in the lanes of a mask.
    fn take_margin(&mut self, mask: L::Mask) -> L {
        let margin = self.own.shift.last().copied().unwrap_or_else(L::one);
        self.own.margin = L::select(mask, margin, self.own.margin);
        margin
    }

    /// Factorises the rows where no move had to be solved for.
    fn measure(&mut self, state: &[L]) {
        let known = self.own.margin.le(self.own.margin);
        let unknown = Self::but(L::zero().lt(self.own.usable), known);
        if Self::is_any(unknown) {
            self.own.rows.fill(L::zero());
            self.solve_rows(state);
            self.take_margin(unknown);
        }
    }
}

impl<L: Lanes> OnJoints<L> for LanesOnJoints<'_, L> {
    type Error = Infallible;

    fn measures(&self) -> JointMeasures<L> {
        self.own.measures
    }

    fn read(&mut self, what: Quantity, state: &[L]) -> L {
        let (form, stages, _) = &mut self.by;
        form.evaluate(what, &stages.at(self.time, state), &mut self.own.rows);
        largest_size(&self.own.rows)
    }

    fn solve(&mut self, state: &[L], open: L::Mask) -> Result<L::Mask, Infallible> {
        self.solve_rows(state);
        let margin = self.take_margin(open);
        let finite = L::zero().le(faults(self.moves()));
        let regular = L::from_f64(trusted_in_passing::<f64>()).le(margin);
        let solved = L::both(open, L::both(finite, regular));
        self.own.usable = L::select(Self::but(open, solved), L::zero(), self.own.usable);
        Ok(solved)
    }

    fn moves(&self) -> &[L] {
        self.own.shift.split_last().map_or(&[], |(_, moves)| moves)
    }

    fn moves_all(&self) -> bool {
        true
    }

    fn displace(&mut self, state: &mut [L], open: L::Mask) {
        let (_, _, quaternions) = self.by;
        self.own.kept.copy_from_slice(state);
        let parts = (&self.own.parts[..], self.own.components);
        displace_shortened(parts, state, self.moves());
        normalise(quaternions, state);
        for (x, kept) in state.iter_mut().zip(&self.own.kept) {
            *x = L::select(open, *x, *kept);
        }
    }

    fn hasten(&mut self, state: &mut [L], open: L::Mask) {
        let speeds = state.iter_mut().skip(self.own.measures.coordinates);
        for (speed, more) in speeds.zip(self.moves()) {
            *speed = L::select(open, *speed + *more, *speed);
        }
    }

    fn is_any(mask: L::Mask) -> bool {
        L::is_any(mask)
    }

    fn but(mask: L::Mask, other: L::Mask) -> L::Mask {
        let kept = L::select(other, L::zero(), flag(mask));
        L::zero().lt(kept)
    }
}
