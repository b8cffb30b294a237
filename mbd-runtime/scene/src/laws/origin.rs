//! The origin that positions are measured from: that of the world, or one that follows a body or a point.
//!
//! ```text
//! p = o + x,   ṗ = w + ẋ,   o(t) = o₀ + w (t − t₀)                                                               (1)
//! ```
//!
//! p, ṗ in the world; x, ẋ what a state holds. w is constant until the origin is moved on, so that x is measured in an inertial frame whose axes are
//! those of the world: every law between things that move is the same in x as in p, to the last bit of its form, and the digits that p would lose far
//! away are those of o alone, which only what refers to the world reads:
//!
//! ```text
//! an end on a frame of the world at a               a − o, moving with ȧ − w                                     (2)
//! gravity that depends on the place                 g(o + x)                                                     (3)
//! positions and velocities in formulas              o + x, w + ẋ; of two in a difference x₁ − x₂                 (4)
//! energy, momentum, work of loads, bodies           with o + x and w + ẋ                                         (5)
//! ```
//!
//! A run moves the origin on after a step that led what it follows away from it by x̂, v̂: o₀ ← o + x̂, w ← w + v̂, x ← x − x̂, ẋ ← ẋ − v̂, with o₀ and w as
//! sums of two numbers each, so that nothing of them is lost however often. Derived (a Galilean change of frame).
//!
//! Rejected: x measured from the body itself, whose acceleration then acts on everything else. It needs that acceleration before the system that
//! gives it is solved, and puts the digits of a large common acceleration into every equation. Rejected: o as part of the state, which stops where a
//! step moves it by less than its last digit.

use nalgebra::Vector3;

use crate::scalar::algebra::{labelled, vector};
use crate::{At, Layout, Real};

/// How many numbers say how the origin moves: o₀ [m], w [m/s], t₀ [s].
pub const NUMBERS: usize = 7;

/// The origin at an instant.
#[derive(Clone, Copy, Debug)]
pub struct Origin<S: Real> {
    /// o, world axes [m].
    pub position: Vector3<S>,
    /// w, world axes [m/s].
    pub velocity: Vector3<S>,
}

impl<S: Real> Origin<S> {
    /// By (1); at rest in that of the world where nothing is said.
    pub(crate) fn read(layout: &Layout, at: &At<'_, S>) -> Self {
        let numbers = at.hold.get(layout.origin_at()..).unwrap_or_default();
        let Some(&since) = numbers.get(NUMBERS - 1) else {
            return Origin {
                position: Vector3::zeros(),
                velocity: Vector3::zeros(),
            };
        };
        let (start, velocity): (Vector3<S>, Vector3<S>) = (vector(numbers, 0), vector(numbers, 3));
        let passed = (at.time - since).label("passed");
        let position = start + velocity.map(|w| w * passed);
        Origin {
            position: labelled(position, ["o_x", "o_y", "o_z"]),
            velocity,
        }
    }

    /// Position and velocity from it of what has these in the world, by (2).
    pub(crate) fn sees(&self, [position, velocity]: [Vector3<S>; 2]) -> [Vector3<S>; 2] {
        [position - self.position, velocity - self.velocity]
    }
}
