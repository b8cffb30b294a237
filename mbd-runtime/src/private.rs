//! What generated code calls and nobody else should.

use mbd_scene::laws::{LineNumbers, Numbers};
use mbd_scene::{Float, Layout, ParamError, Real, Redundancy, Scene, check_params};

use crate::{LineState, Reaction};

pub use crate::parts::{member, read, write};
pub use crate::verify::verify;

/// What every generated model carries besides its equations.
#[derive(Clone, Debug)]
pub struct Parts<T> {
    /// The declaration.
    pub scene: Scene,
    /// Where everything lives.
    pub layout: Layout,
    /// Stiffness, damping and free length of every line.
    pub lines: Vec<LineNumbers<T>>,
}

impl<T: Real> Parts<T> {
    /// The parts of a scene, the rows of whose joints are known, for given parameters.
    #[must_use]
    pub fn new(scene: Scene, redundancy: Redundancy, params: &[T]) -> Self {
        Parts {
            layout: Layout::keeping(&scene, redundancy),
            lines: Numbers::new(&scene, params).lines,
            scene,
        }
    }

    /// The same after checking the parameters.
    ///
    /// # Errors
    /// The first parameter that cannot be run.
    pub fn checked(scene: Scene, redundancy: Redundancy, params: &[T]) -> Result<Self, ParamError>
    where
        T: Float,
    {
        check_params(&scene, params)?;
        Ok(Self::new(scene, redundancy, params))
    }
}

/// The slice as an array, if it has the right length.
#[inline]
#[must_use]
pub fn fixed<T, const N: usize>(slice: &[T]) -> Option<&[T; N]> {
    slice.try_into().ok()
}

/// The slice as an array to write to, if it has the right length.
#[inline]
pub fn fixed_mut<T, const N: usize>(slice: &mut [T]) -> Option<&mut [T; N]> {
    slice.try_into().ok()
}

/// The state as coordinates, speeds and node positions, if it has the right length.
#[inline]
#[must_use]
#[allow(clippy::type_complexity, reason = "three arrays of three lengths")]
pub fn split<T, const Q: usize, const V: usize, const Z: usize>(
    state: &[T],
) -> Option<(&[T; Q], &[T; V], &[T; Z])> {
    let (q, rest) = state.split_first_chunk()?;
    let (v, rest) = rest.split_first_chunk()?;
    Some((q, v, rest.try_into().ok()?))
}

/// Ten numbers a line as line states.
#[must_use]
pub fn line_states<T: Real, const N: usize>(numbers: &[T]) -> [LineState<T>; N] {
    let mut lines = numbers.chunks_exact(10);
    std::array::from_fn(|_| {
        let line: Option<&[T; 10]> = lines.next().and_then(fixed);
        let [tension, length, stretch, rate, xx, xy, xz, yy, yz, zz] =
            *line.unwrap_or(&[T::zero(); 10]);
        LineState {
            tension,
            length,
            stretch,
            rate,
            stiffness: [xx, xy, xz, yy, yz, zz],
        }
    })
}

/// Six numbers a joint as reactions.
#[must_use]
pub fn reactions<T: Real, const N: usize>(numbers: &[T]) -> [Reaction<T>; N] {
    let mut joints = numbers.chunks_exact(6);
    std::array::from_fn(|_| {
        let joint: Option<&[T; 6]> = joints.next().and_then(fixed);
        let [fx, fy, fz, tx, ty, tz] = *joint.unwrap_or(&[T::zero(); 6]);
        Reaction {
            force: [fx, fy, fz],
            torque: [tx, ty, tz],
        }
    })
}
