//! Relative coordinates: the same mechanics as absolute ones, and the numbers of independent tools.

mod agreement;
mod counts;
mod digits;
mod generated;
mod planar;
mod reference;
mod runs;
