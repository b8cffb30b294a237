//! Private stand-in for `mbd_scene::laws::line`.
use mbd_scene::{Real, TINY};
use nalgebra::{Matrix3, Vector3};

pub struct Geometry<S: Real> {
    pub length: S,
    pub inverse_length: S,
    pub direction: Vector3<S>,
    pub stretch: S,
}

pub fn geometry<S: Real>(vector: &Vector3<S>, free_length: S) -> Geometry<S> {
    let length = vector.dot(vector).sqrt();
    let inverse_length = S::one() / length.max(S::from_f64(TINY));
    let direction = vector.map(|x| x * inverse_length);
    Geometry {
        length,
        inverse_length,
        direction,
        stretch: length - free_length,
    }
}

pub fn effective_tension<S: Real>(stiffness: S, stretch: S) -> S {
    stiffness * stretch.max(S::zero())
}

pub fn stiffness<S: Real>(
    geometry: &Geometry<S>,
    stiffness: S,
    free_length: S,
    tension: S,
) -> Matrix3<S> {
    let zero = S::zero();
    let taut = zero.le(geometry.stretch);
    let across = S::select(
        zero.lt(free_length),
        tension * geometry.inverse_length,
        stiffness,
    );
    let across = S::select(taut, across, zero);
    let along = S::select(taut, stiffness, zero) - across;
    let u = &geometry.direction;
    let weighted = u.map(|x| along * x);
    Matrix3::from_diagonal_element(across) + weighted * u.transpose()
}
