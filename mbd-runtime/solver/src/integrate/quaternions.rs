//! Unit quaternions at the end of a step.

use mbd_scene::Float;

/// Makes the quaternions that begin at these places unit quaternions; returns the largest | |q| − 1 | there was. A zero quaternion stays.
#[inline(always)]
pub(crate) fn normalise<T: Float>(state: &mut [T], places: &[usize]) -> f64 {
    let mut drift: f64 = 0.0;
    for &at in places {
        let own = state.get_mut(at..).and_then(<[T]>::first_chunk_mut::<4>);
        let Some(quaternion) = own else {
            continue;
        };
        let square = quaternion.iter().fold(T::zero(), |sum, x| sum + *x * *x);
        let norm = square.sqrt();
        drift = drift.max((norm.to_f64() - 1.0).abs());
        if norm > T::zero() && norm.is_finite() {
            let inverse = T::one() / norm;
            for x in quaternion {
                *x *= inverse;
            }
        }
    }
    drift
}
