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
    let scale = [xx, yy, zz, xy, xz, yz]
        .iter()
        .fold(0.0, |largest: f64, element| largest.max(element.abs()));
    if !scale.is_finite() || scale == 0.0 {
        return Err(WrongInertia::NotPositive(scale));
    }
    let matrix = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz) / scale;
    let mut moments: Vec<f64> = matrix
        .symmetric_eigenvalues()
        .iter()
        .map(|moment| moment * scale)
        .collect();
    moments.sort_by(f64::total_cmp);
    let [smallest, middle, largest] = moments[..] else {
        return Ok(());
    };
    if smallest <= ROUNDING * ROUNDING * largest.abs() {
        return Err(WrongInertia::NotPositive(smallest));
    }
    if largest > (smallest + middle) * (1.0 + ROUNDING) {
        return Err(WrongInertia::Triangle(largest, smallest + middle));
    }
    Ok(())
}
