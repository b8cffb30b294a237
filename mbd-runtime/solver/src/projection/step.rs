//! Room for the projection steps of a run, and the last of them.

use mbd_scene::{Float, Layout};

use crate::moving::{Moving, moving};
use crate::options::Stabilise;

/// Room for the projection of one scene.
pub(crate) struct Projection<T> {
    /// How the run stays on the joints.
    pub stabilise: Stabilise,
    /// Length of the scene [m].
    pub length: f64,
    /// How far from the origin places of a tree may be, whose coordinates do not say so; zero in absolute coordinates [m].
    pub extent: f64,
    /// What moves.
    pub(super) parts: Vec<Moving>,
    pub(super) rows: Vec<T>,
    /// δ, and behind it the margin of the factor.
    pub(super) shift: Vec<T>,
    pub(super) trial: Vec<T>,
}

impl<T: Float> Projection<T> {
    /// Room for a layout; nothing to do without rows.
    pub(crate) fn new(layout: &Layout) -> Self {
        let room = |length| vec![T::zero(); if layout.nc > 0 { length } else { 0 }];
        let parts = moving(layout).filter(|_| layout.nc > 0);
        Projection {
            stabilise: Stabilise::Projection,
            length: 1.0,
            extent: 0.0,
            parts: parts.collect(),
            rows: room(layout.nc),
            shift: room(layout.nv + 1),
            trial: room(layout.nx()),
        }
    }

    /// δ of the last solve.
    pub(super) fn moves(&self) -> &[T] {
        self.shift.split_last().map_or(&[], |(_, moves)| moves)
    }

    /// The smallest part that other rows left to the pivot of a row in the last solve.
    pub(super) fn margin(&self) -> f64 {
        self.shift.last().map_or(1.0, |margin| margin.to_f64())
    }

    /// Whether there are rows.
    #[inline]
    pub(crate) fn any(&self) -> bool {
        !self.rows.is_empty()
    }
}
