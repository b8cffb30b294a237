//! Inertia: which symmetric matrices belong to a rigid body.

use mbd_scene::{Inertia, Scene};
use nalgebra::Matrix3;

use crate::resolve::fold::at_defaults;

/// Why a matrix is no inertia.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WrongInertia {
    /// A principal moment is zero or negative: the smallest.
    NotPositive(f64),
    /// The largest principal moment, and the smaller sum of the other two.
    Triangle(f64, f64),
}

/// A flat body has exactly equality: rounding may not make it impossible.
const ROUNDING: f64 = 1e-9;

/// Checks the principal moments a ≤ b ≤ c with all params at their defaults: a > 0, c ≤ a + b.
pub fn inertia(inertia: &Inertia, scene: &Scene) -> Result<(), WrongInertia> {
    let value = |element| at_defaults(element, scene);
    let elements = [
        &inertia.xx,
        &inertia.yy,
        &inertia.zz,
        &inertia.xy,
        &inertia.xz,
        &inertia.yz,
    ]
    .map(value);
    let [Some(xx), Some(yy), Some(zz), Some(xy), Some(xz), Some(yz)] = elements else {
        return Ok(());
    };
    moments_of_a_body(&Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz))
}

/// Checks the principal moments a ≤ b ≤ c of a body: a > 0, c ≤ a + b.
pub fn moments_of_a_body(matrix: &Matrix3<f64>) -> Result<(), WrongInertia> {
    let moments = principal_moments(matrix)?;
    let [smallest, _, largest] = moments;
    if smallest <= ROUNDING * ROUNDING * largest.abs() {
        return Err(WrongInertia::NotPositive(smallest));
    }
    within_triangle(moments)
}

/// Checks a part of a body, which may be a point or a rod: no principal moment is negative, c ≤ a + b.
pub fn moments_of_a_part(matrix: &Matrix3<f64>) -> Result<(), WrongInertia> {
    let moments = principal_moments(matrix)?;
    let [smallest, _, largest] = moments;
    if smallest < -ROUNDING * largest.abs() {
        return Err(WrongInertia::NotPositive(smallest));
    }
    within_triangle(moments)
}

/// The principal moments, the smallest first [kg·m²].
fn principal_moments(matrix: &Matrix3<f64>) -> Result<[f64; 3], WrongInertia> {
    let scale = matrix.amax();
    if scale == 0.0 {
        return Ok([0.0; 3]);
    }
    if !matrix.iter().all(|element| element.is_finite()) {
        return Err(WrongInertia::NotPositive(f64::NAN));
    }
    let moments = (matrix / scale).symmetric_eigenvalues() * scale;
    let mut moments: [f64; 3] = moments.into();
    moments.sort_by(f64::total_cmp);
    Ok(moments)
}

fn within_triangle([smallest, middle, largest]: [f64; 3]) -> Result<(), WrongInertia> {
    match largest > (smallest + middle) * (1.0 + ROUNDING) {
        true => Err(WrongInertia::Triangle(largest, smallest + middle)),
        false => Ok(()),
    }
}
