//! Relative coordinates: the same mechanics as absolute ones, and the numbers of independent tools.

mod alike;
mod bodies;
mod counts;
mod dependent;
mod digits;
mod functions;
mod generated;
mod near_flat;
mod planar;
mod redundant_loops;
mod runs;
mod vanishing_row;
