//! Joints: one binary, because each would compile the generic solver, the interpreter and the simulation again.
//!
//! `cargo test -p tests --test joints contract` runs one of the files.

mod carried;
mod contract;
mod coordinates;
mod counts;
mod couplings;
mod derivatives;
mod equivalents;
mod fallback;
mod flat;
mod interface;
mod loads;
mod masses;
mod mechanisms;
mod orders;
mod redundant;
mod reference;
mod run;
mod shafts;
mod singular;
mod split;
mod told;
mod trees;
mod turns;
