//! Gram–Schmidt: what of a vector is new against orthonormal ones.

/// Takes out of `rest` what the orthonormal `units` have of it, and reports each part with the number of its unit. Of a unit those numbers are
/// told that are not zero, with the place of the first. Twice: once leaves the rounding of the vector, twice nothing but the new part.
pub fn take_out<'u>(
    rest: &mut [f64],
    units: impl Iterator<Item = (usize, &'u [f64])> + Clone,
    mut part: impl FnMut(usize, f64),
) {
    for _ in 0..2 {
        for (index, (first, unit)) in units.clone().enumerate() {
            let rest = rest.get_mut(first..).unwrap_or_default();
            let along = dot(rest, unit);
            subtract(rest, along, unit);
            part(index, along);
        }
    }
}

/// The inner product of two lists.
#[must_use]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// from ← from − times · what.
pub fn subtract(from: &mut [f64], times: f64, what: &[f64]) {
    for (a, b) in from.iter_mut().zip(what) {
        *a -= times * b;
    }
}
