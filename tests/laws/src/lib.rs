//! What tests of the laws share: mechanisms built in code, motions that obey joints, the derivative oracle, reference data, seeded random
//! numbers, and one way to compare. Nothing here knows the compiler or the solvers.

pub mod implicit;
pub mod instant;
pub mod jet;
pub mod linkage;
pub mod looped;
pub mod mechanism;
pub mod obeying;
pub mod oracle;
pub mod random;
pub mod reference;
pub mod relative;
pub mod system;

/// Asserts that every number of `got` equals that of `want` to `relative` of the largest number of `want`, plus `absolute`.
///
/// # Panics
/// With the first numbers that differ, the place, and the rule that failed.
#[track_caller]
pub fn assert_close(got: &[f64], want: &[f64], relative: f64, absolute: f64, what: &str) {
    assert_eq!(
        got.len(),
        want.len(),
        "{what}: {} numbers, expected {}",
        got.len(),
        want.len()
    );
    let scale = want.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    for (i, (a, b)) in got.iter().zip(want).enumerate() {
        let bound = relative * scale + absolute;
        assert!(
            (a - b).abs() <= bound,
            "{what}[{i}]: got {a:e}, want {b:e}, difference {:e} > {bound:e} (relative {relative:e} of {scale:e}, absolute {absolute:e})",
            (a - b).abs()
        );
    }
}

/// The largest difference between two lists.
#[must_use]
pub fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |m, (x, y)| m.max((x - y).abs()))
}
