//! What the tests that cross crates share, beside what tests of the laws alone share: `laws`.

pub mod agreement;
pub mod cores;
pub mod declared;
pub mod double;
pub mod families;
pub mod flights;
pub mod minimal;
pub mod networks;
pub mod planar;
pub mod points;
pub mod turning;
pub mod web;

pub use laws::{
    assert_close, implicit, instant, jet, largest_difference, linkage, looped, mechanism, obeying,
    oracle, random, reference, relative, system,
};
