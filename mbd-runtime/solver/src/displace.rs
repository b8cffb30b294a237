//! Moving positions by small moves in the components of the speeds; rotations by the exponential, q ← q ∘ exp(δ/2) in body components,
//! q ← exp(δ/2) ∘ q in world components.

use std::borrow::Borrow;

use mbd_scene::{AngularVelocity, Real, quaternion_rate};
use nalgebra::Vector3;

use crate::moving::Moving;

/// Moves the positions of these parts of a state by `share` of δ (n_v) [m, rad]. Quaternions keep their length but for rounding.
pub(crate) fn displace<T: Real>(
    (parts, components): (impl Iterator<Item: Borrow<Moving>>, AngularVelocity),
    state: &mut [T],
    moves: &[T],
    share: T,
) {
    let body_axes = components == AngularVelocity::Body;
    for part in parts {
        let part = part.borrow();
        let [moved, rotated] =
            [part.moves(), part.turns()].map(|speeds| moves.get(speeds).unwrap_or(&[]));
        let position = state.get_mut(part.position.clone()).unwrap_or_default();
        for (x, dx) in position.iter_mut().zip(moved) {
            *x += share * *dx;
        }
        let attitude = state.get_mut(part.attitude.clone()).unwrap_or_default();
        if part.has_quaternion() {
            rotate(
                attitude,
                rotated,
                share,
                body_axes || part.carried.is_some(),
            );
            continue;
        }
        for (angle, more) in attitude.iter_mut().zip(rotated) {
            *angle += share * *more;
        }
    }
}

/// The sum of the squares.
pub(crate) fn square<T: Real>(vector: &[T]) -> T {
    vector.iter().fold(T::zero(), |sum, x| sum + *x * *x)
}

/// Rotates a quaternion w x y z by `part` of a rotation vector, in body axes or in world axes.
fn rotate<T: Real>(quaternion: &mut [T], turn: &[T], part: T, body_axes: bool) {
    let (Ok(old), &[a, b, c]) = (<[T; 4]>::try_from(&*quaternion), turn) else {
        return;
    };
    let half = T::from_f64(0.5) * part * square(turn).sqrt();
    let (sine, cosine) = half.sin_cos();
    let scale = T::select(T::zero().lt(half), part * sine / half, T::zero());
    let moved = Vector3::new(a, b, c).map(|x| x * scale);
    let more = quaternion_rate(old, &moved, body_axes);
    for (to, (old, more)) in quaternion.iter_mut().zip(old.into_iter().zip(more)) {
        *to = old * cosine + more;
    }
}

#[cfg(test)]
mod tests {
    use super::rotate;

    #[test]
    fn a_rotation_in_body_axes_is_one_about_the_axes_they_have_in_the_world() {
        // A quarter turn about z carries body x onto world y.
        let root = 0.5_f64.sqrt();
        let mut body = [root, 0.0, 0.0, root];
        let mut world = body;
        rotate(&mut body, &[0.3, 0.0, 0.0], 1.0, true);
        rotate(&mut world, &[0.0, 0.3, 0.0], 1.0, false);
        for (a, b) in body.iter().zip(&world) {
            assert!((a - b).abs() < 1e-15, "{body:?} {world:?}");
        }
        assert!((body.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-15);
    }
}
