//! The size of a step's error: root mean square inside a block, maximum over the blocks, so that quiet bodies do not dilute a failing one.
//!
//! One block a body and kind: position, rotation (as a tangent angle), velocity, angular velocity; and one a point. Positions and rotations are
//! measured against fixed scales, never against |y|: moving or turning the world must change nothing.

use mbd_scene::{Float, Layout, Model, PointSlots, Scene};
use serde::{Deserialize, Serialize};

/// What counts as one unit of error before the relative tolerance is applied.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scales {
    /// Length [m].
    pub length: f64,
    /// Angle [rad].
    pub angle: f64,
    /// Speed [m/s].
    pub speed: f64,
    /// Angular speed [rad/s].
    pub rate: f64,
}

impl Default for Scales {
    /// One metre, one radian, one metre a second, one radian a second.
    fn default() -> Self {
        Scales {
            length: 1.0,
            angle: 1.0,
            speed: 1.0,
            rate: 1.0,
        }
    }
}

impl Scales {
    /// Scales of a scene: the longest free length of its lines (1 m without lines), that length a second, one radian, one radian a second.
    #[must_use]
    pub fn of<T: Float, M: Model<T>>(model: &M) -> Self {
        let longest = model
            .lines()
            .iter()
            .map(|line| line.free_length.to_f64())
            .fold(0.0, f64::max);
        let length = if longest > 0.0 && longest.is_finite() {
            longest
        } else {
            1.0
        };
        Scales {
            length,
            speed: length,
            ..Scales::default()
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Position,
    Rotation,
    Velocity,
    AngularVelocity,
    Node,
}

#[derive(Clone, Copy, Debug)]
struct Block {
    kind: Kind,
    at: usize,
    /// Body or point index.
    owner: usize,
}

/// The norm of one scene.
#[derive(Clone, Debug)]
pub(crate) struct ErrorNorm {
    blocks: Vec<Block>,
    scales: Scales,
    /// Relative tolerance.
    pub tolerance: f64,
    worst: usize,
}

impl ErrorNorm {
    pub(crate) fn new(layout: &Layout, scales: Scales, tolerance: f64) -> Self {
        let mut blocks = Vec::new();
        let mut block = |kind, at, owner| blocks.push(Block { kind, at, owner });
        for (body, slots) in layout.bodies.iter().enumerate() {
            block(Kind::Position, slots.q, body);
            block(Kind::Rotation, slots.q + 3, body);
            block(Kind::Velocity, layout.nq + slots.v, body);
            block(Kind::AngularVelocity, layout.nq + slots.v + 3, body);
        }
        for (point, slots) in layout.points.iter().enumerate() {
            match slots {
                PointSlots::Mass(slots) => {
                    block(Kind::Node, slots.q, point);
                    block(
                        Kind::Velocity,
                        layout.nq + slots.v,
                        layout.bodies.len() + point,
                    );
                }
                PointSlots::Node(node) => {
                    if let Some(z) = layout.nodes.get(*node).and_then(|node| node.z) {
                        block(Kind::Node, layout.nq + layout.nv + z, point);
                    }
                }
            }
        }
        ErrorNorm {
            blocks,
            scales,
            tolerance,
            worst: 0,
        }
    }

    /// The error relative to the tolerance: 1 is just acceptable. NaN anywhere gives NaN.
    pub(crate) fn measure<T: Float>(&mut self, error: &[T], old: &[T], new: &[T]) -> f64 {
        let mut largest = 0.0;
        for (index, block) in self.blocks.iter().enumerate() {
            let size = block.measure(&self.scales, error, old, new) / self.tolerance;
            // A NaN must win over every number.
            if size > largest || size.is_nan() {
                largest = size;
                self.worst = index;
            }
            if largest.is_nan() {
                break;
            }
        }
        largest
    }

    /// The block with the largest error of the last measurement, in words.
    pub(crate) fn worst(&self, scene: &Scene) -> String {
        let Some(block) = self.blocks.get(self.worst) else {
            return "state".into();
        };
        let bodies = scene.bodies.len();
        let body = scene.bodies.get(block.owner).map(|body| body.name.as_str());
        let point = |index: usize| scene.points.get(index).map(|point| point.name.as_str());
        let (owner, what) = match block.kind {
            Kind::Position => (body, "position"),
            Kind::Rotation => (body, "rotation"),
            Kind::AngularVelocity => (body, "angular velocity"),
            Kind::Velocity if block.owner < bodies => (body, "velocity"),
            Kind::Velocity => (point(block.owner - bodies), "velocity"),
            Kind::Node => (point(block.owner), "position"),
        };
        format!("{} of {}", what, owner.unwrap_or("state"))
    }
}

impl Block {
    fn measure<T: Float>(&self, scales: &Scales, error: &[T], old: &[T], new: &[T]) -> f64 {
        match self.kind {
            Kind::Position | Kind::Node => mean(triple(error, self.at)) / scales.length,
            Kind::Rotation => {
                tangent(quadruple(old, self.at), quadruple(error, self.at)) / scales.angle
            }
            Kind::Velocity => self.speed(scales.speed, error, old, new),
            Kind::AngularVelocity => self.speed(scales.rate, error, old, new),
        }
    }

    fn speed<T: Float>(&self, scale: f64, error: &[T], old: &[T], new: &[T]) -> f64 {
        let (error, old, new) = (
            triple(error, self.at),
            triple(old, self.at),
            triple(new, self.at),
        );
        // One size for the three components: the norm must not depend on the axes.
        let size = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        mean(error) / (scale + size(old).max(size(new)))
    }
}

/// Root mean square of three components.
fn mean(v: [f64; 3]) -> f64 {
    (v.iter().map(|x| x * x).sum::<f64>() / 3.0).sqrt()
}

/// Root mean square of the tangent angle 2 vec(q* ∘ δq).
fn tangent([w, x, y, z]: [f64; 4], [dw, dx, dy, dz]: [f64; 4]) -> f64 {
    mean([
        2.0 * (w * dx - x * dw - y * dz + z * dy),
        2.0 * (w * dy + x * dz - y * dw - z * dx),
        2.0 * (w * dz - x * dy + y * dx - z * dw),
    ])
}

fn triple<T: Float>(values: &[T], at: usize) -> [f64; 3] {
    pick(values, at)
}

fn quadruple<T: Float>(values: &[T], at: usize) -> [f64; 4] {
    pick(values, at)
}

fn pick<T: Float, const N: usize>(values: &[T], at: usize) -> [f64; N] {
    let mut out = [0.0; N];
    for (to, from) in out.iter_mut().zip(values.iter().skip(at)) {
        *to = from.to_f64();
    }
    out
}
