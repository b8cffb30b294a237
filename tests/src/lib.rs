//! What the tests that cross crates share, beside what tests of the laws alone share: `laws`.

pub mod agreement;
pub mod cores;
pub mod declared;
pub mod double;
pub mod flights;
pub mod minimal;
pub mod planar;
pub mod points;
pub mod turning;

pub use nodes::{families, networks, web};

pub use laws::{
    assert_close, implicit, instant, jet, largest_difference, linkage, looped, mechanism, obeying,
    oracle, random, reference, relative, system,
};
