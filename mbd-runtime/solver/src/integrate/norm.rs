//! The size of a step's error: root mean square inside a block, maximum over the blocks, so that quiet bodies do not dilute a failing one.
//!
//! One block a body and kind: position, rotation (as a tangent angle), velocity, angular velocity; and one a point. Positions and rotations are
//! measured against fixed scales, never against |y|: moving or turning the world must change nothing.

use std::ops::Range;

use mbd_scene::{Float, Layout, Model, Part, Scene};
use serde::{Deserialize, Serialize};

use crate::columns::part_name;
use crate::moving::{Moving, moving};

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
    /// Work [J], when it is integrated along.
    pub energy: f64,
    /// A declared state that starts at zero [its SI unit]; one that starts elsewhere has its start for a scale.
    #[serde(default = "one")]
    pub state: f64,
}

impl Default for Scales {
    /// One metre, one radian, one metre a second, one radian a second, one joule.
    fn default() -> Self {
        Scales {
            length: 1.0,
            angle: 1.0,
            speed: 1.0,
            rate: 1.0,
            energy: 1.0,
            state: 1.0,
        }
    }
}

/// The scale that a text written before there were states means.
fn one() -> f64 {
    1.0
}

impl Scales {
    /// Scales of a scene: the longest free length of its lines (1 m without lines), that length a second, one radian, one radian a second.
    #[must_use]
    pub fn of<T: Float>(model: &dyn Model<T>) -> Self {
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
enum NormKind {
    Position,
    Rotation,
    Angle,
    Velocity,
    AngularVelocity,
    /// A declared state, by index.
    State(usize),
    Work,
}

/// Some numbers of the state that have one size.
#[derive(Clone, Debug)]
struct NormBlock {
    kind: NormKind,
    at: Range<usize>,
    /// Whose they are.
    owner: Option<Part>,
    /// What counts as one unit of error.
    scale: f64,
}

/// The norm of one scene.
#[derive(Clone, Debug)]
pub(crate) struct ErrorNorm {
    blocks: Vec<NormBlock>,
    /// Relative tolerance.
    pub tolerance: f64,
    scales: Scales,
    worst: usize,
}

impl ErrorNorm {
    /// The norm of states of `length`: those of the layout, with integrals behind. `resolution` has the length [m] and the angle [rad] of a body or
    /// point; `starts`: where the declared states start.
    pub(crate) fn new(
        layout: &Layout,
        length: usize,
        (scales, tolerance): (Scales, f64),
        starts: &[f64],
        resolution: impl Fn(&Moving) -> [f64; 2],
    ) -> Self {
        let mut blocks = Vec::new();
        let mut block = |kind, at: Range<usize>, owner, scale| {
            if !at.is_empty() {
                blocks.push(NormBlock {
                    kind,
                    at,
                    owner,
                    scale,
                });
            }
        };
        for part in moving(layout) {
            let attitude = match part.has_quaternion() {
                true => NormKind::Rotation,
                false => NormKind::Angle,
            };
            let owner = Some(part.part);
            let [length, angle] = resolution(&part);
            block(NormKind::Position, part.position, owner, length);
            block(attitude, part.attitude, owner, angle);
            block(NormKind::Velocity, part.velocity, owner, scales.speed);
            block(NormKind::AngularVelocity, part.spin, owner, scales.rate);
        }
        for node in &layout.nodes {
            if let Some(z) = node.z.map(|z| layout.nq + layout.nv + z) {
                let owner = Some(Part::Point(node.point));
                block(NormKind::Position, z..z + 3, owner, scales.length);
            }
        }
        (0..layout.ns).for_each(|state| {
            let at = layout.states() + state;
            let start = starts.get(state).map_or(0.0, |start| start.abs());
            let scale = if start > 0.0 { start } else { scales.state };
            block(NormKind::State(state), at..at + 1, None, scale);
        });
        (layout.nx()..length).for_each(|at| block(NormKind::Work, at..at + 1, None, scales.energy));
        ErrorNorm {
            blocks,
            tolerance,
            scales,
            worst: 0,
        }
    }

    /// The error relative to the tolerance: 1 is just acceptable. NaN anywhere gives NaN.
    pub(crate) fn measure<T: Float>(&mut self, error: &[T], old: &[T], new: &[T]) -> f64 {
        let mut largest = 0.0;
        for (index, block) in self.blocks.iter().enumerate() {
            let size = block.measure(error, old, new) / self.tolerance;
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

    /// The same of a list that is no error of a step: what failed last stays.
    pub(crate) fn size<T: Float>(&self, list: &[T], old: &[T], new: &[T]) -> f64 {
        self.largest(list, old, new).0
    }

    /// The same, and the block with the largest.
    pub(crate) fn largest<T: Float>(&self, list: &[T], old: &[T], new: &[T]) -> (f64, usize) {
        let sizes = self.blocks.iter().enumerate();
        let sizes = sizes.map(|(index, block)| (block.measure(list, old, new), index));
        let (largest, block) = sizes.fold((0.0, 0), |most: (f64, usize), size| {
            if size.0 > most.0 || size.0.is_nan() {
                size
            } else {
                most
            }
        });
        (largest / self.tolerance, block)
    }

    /// How far apart positions are that numbers tell apart at a state, over the tolerance: the largest.
    pub(crate) fn coarseness<T: Float>(&self, state: &[T]) -> f64 {
        let positions = self.blocks.iter();
        let positions = positions.filter(|block| block.kind == NormKind::Position);
        let apart = positions.map(|block| T::EPSILON.to_f64() * block.mean(state) / block.scale);
        apart.fold(0.0, f64::max) / self.tolerance
    }

    /// How far bodies and points get in a step by their speeds in a state, and how much speeds and declared states change by their rates, over the scales
    /// of each: the furthest of them.
    pub(crate) fn motion<T: Float>(&self, step: f64, state: &[T], rates: &[T]) -> f64 {
        let size = |block: &NormBlock, list: &[T]| step * block.square(list).sqrt();
        let far = self.blocks.iter().map(|block| {
            let change = size(block, rates) / block.scale;
            match block.kind {
                NormKind::Velocity => change.max(size(block, state) / self.scales.length),
                NormKind::AngularVelocity => change.max(size(block, state) / self.scales.angle),
                NormKind::State(_) => change,
                _ => 0.0,
            }
        });
        far.fold(0.0, f64::max)
    }

    /// Gives every declared state in `weights` of a norm of energy its weight: at one unit of it as much as the heaviest of the `speeds` at its scale.
    pub(crate) fn weigh_states<T: Float>(&self, weights: &mut [T], speeds: Range<usize>) {
        let own = weights.get(speeds).unwrap_or_default();
        let heaviest = own.iter().fold(0.0_f64, |most, x| most.max(x.to_f64()));
        let energy = match heaviest > 0.0 {
            true => heaviest * self.scales.speed.powi(2),
            false => 1.0,
        };
        for block in &self.blocks {
            if let (NormKind::State(_), Some(weight)) =
                (block.kind, weights.get_mut(block.at.start))
            {
                *weight = T::from_f64(energy / block.scale.powi(2));
            }
        }
    }

    /// How long what moves at the scale of speeds takes for that of lengths [s].
    pub(crate) fn seconds(&self) -> f64 {
        self.scales.length / self.scales.speed
    }

    /// The block with the largest Σ weight x², by number.
    pub(crate) fn heaviest<T: Float>(&self, weights: &[T], list: &[T]) -> usize {
        let size = |block: &NormBlock| {
            let own = weights.iter().zip(list);
            let own = own.skip(block.at.start).take(block.at.len());
            own.fold(0.0, |sum, (w, x)| sum + w.to_f64() * x.to_f64().powi(2))
        };
        let sizes = self.blocks.iter().map(size).enumerate();
        let most = sizes.max_by(|a, b| a.1.total_cmp(&b.1));
        most.map_or(0, |(block, _)| block)
    }

    /// Whose a block is.
    pub(crate) fn owner(&self, block: usize) -> Option<Part> {
        self.blocks.get(block)?.owner
    }

    /// The block with the largest error of the last measurement, in words.
    pub(crate) fn worst(&self, scene: &Scene) -> String {
        self.name(self.worst, scene)
    }

    /// A block in words.
    pub(crate) fn name(&self, block: usize, scene: &Scene) -> String {
        let Some(block) = self.blocks.get(block) else {
            return "state".into();
        };
        let owner = block.owner.map(|part| part_name(scene, part));
        let what = match block.kind {
            NormKind::Position => "position",
            NormKind::Rotation | NormKind::Angle => "rotation",
            NormKind::Velocity => "velocity",
            NormKind::AngularVelocity => "angular velocity",
            NormKind::State(state) => {
                let state = scene.states.get(state);
                return state.map_or_else(|| "state".into(), |state| state.name.clone());
            }
            NormKind::Work => "work",
        };
        format!("{what} of {}", owner.unwrap_or("the run"))
    }
}

impl NormBlock {
    fn measure<T: Float>(&self, error: &[T], old: &[T], new: &[T]) -> f64 {
        match self.kind {
            NormKind::Position | NormKind::Angle => self.mean(error) / self.scale,
            NormKind::Rotation => {
                let [old, error] = [old, error].map(|list| pick(list, self.at.start));
                tangent(old, error) / self.scale
            }
            NormKind::Velocity | NormKind::AngularVelocity => self.speed(error, old, new),
            NormKind::State(_) | NormKind::Work => {
                let [error, old, new] =
                    [error, old, new].map(|list| pick::<T, 1>(list, self.at.start)[0].abs());
                error / (self.scale + old.max(new))
            }
        }
    }

    fn speed<T: Float>(&self, error: &[T], old: &[T], new: &[T]) -> f64 {
        // One size for all components: the norm must not depend on the axes.
        let size = |list: &[T]| self.square(list).sqrt();
        self.mean(error) / (self.scale + size(old).max(size(new)))
    }

    /// Sum of the squares of its components.
    fn square<T: Float>(&self, list: &[T]) -> f64 {
        let own = list.get(self.at.clone()).unwrap_or_default();
        own.iter().fold(0.0, |sum, x| sum + x.to_f64() * x.to_f64())
    }

    /// Root mean square of its components.
    fn mean<T: Float>(&self, list: &[T]) -> f64 {
        (self.square(list) / self.at.len() as f64).sqrt()
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

fn pick<T: Float, const N: usize>(values: &[T], at: usize) -> [f64; N] {
    let mut out = [0.0; N];
    for (to, from) in out.iter_mut().zip(values.iter().skip(at)) {
        *to = from.to_f64();
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use mbd_scene::Slots;

    fn norm() -> ErrorNorm {
        let layout = Layout {
            nq: 7,
            nv: 6,
            bodies: vec![Some(Slots { q: 0, v: 0 })],
            ..Layout::default()
        };
        ErrorNorm::new(&layout, 13, (Scales::default(), 1e-6), &[], |_| [1.0; 2])
    }

    const STATE: [f64; 13] = [
        1.0, 2.0, 3.0, 0.6, 0.8, 0.0, 0.0, 0.3, -0.2, 0.5, 1.0, 0.0, -2.0,
    ];
    const ERROR: [f64; 13] = [
        3e-7, -1e-7, 2e-7, -4e-7, 3e-7, 1e-7, -5e-7, 1e-7, 8e-7, -3e-7, 2e-7, -6e-7, 1e-7,
    ];

    #[test]
    fn the_error_does_not_depend_on_where_the_origin_is() {
        let mut moved = STATE;
        moved.iter_mut().take(3).for_each(|x| *x += 3.4e6);
        let here = norm().measure(&ERROR, &STATE, &STATE);
        assert_eq!(here, norm().measure(&ERROR, &moved, &moved));
    }

    #[test]
    fn the_error_does_not_depend_on_where_the_axes_point() {
        // x → y → z → x.
        let turn = |v: &[f64; 13]| {
            let mut rotated = *v;
            for at in [0, 7] {
                (rotated[at], rotated[at + 1], rotated[at + 2]) = (v[at + 2], v[at], v[at + 1]);
            }
            // (½, ½, ½, ½) ∘ q turns the body with the axes; body components stay.
            let [w, x, y, z] = [v[3], v[4], v[5], v[6]].map(|x| 0.5 * x);
            (rotated[3], rotated[4]) = (w - x - y - z, w + x + z - y);
            (rotated[5], rotated[6]) = (w + y + x - z, w + z + y - x);
            rotated
        };
        let (state, error) = (turn(&STATE), turn(&ERROR));
        let (here, there) = (
            norm().measure(&ERROR, &STATE, &STATE),
            norm().measure(&error, &state, &state),
        );
        assert!((here - there).abs() < 1e-14 * here, "{here} {there}");
    }

    #[test]
    fn one_failing_block_decides_and_a_nan_is_never_accepted() {
        let mut error = [0.0; 13];
        error[8] = 5e-6;
        let mut norm = norm();
        assert!(norm.measure(&error, &STATE, &STATE) > 1.0);
        error[4] = f64::NAN;
        assert!(norm.measure(&error, &STATE, &STATE).is_nan());
    }
}
