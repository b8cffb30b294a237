//! Relative coordinates: the same mechanics as absolute ones, and the numbers of independent tools.

mod agreement;
mod counts;
mod functions;
mod generated;
mod reference;
mod runs;
