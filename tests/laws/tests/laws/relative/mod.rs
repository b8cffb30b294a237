//! Relative coordinates: the same mechanics as absolute ones, and the numbers of independent tools.

mod agreement;
mod reference;
