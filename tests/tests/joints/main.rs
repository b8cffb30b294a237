//! Joints: one binary, because each would compile the generic solver, the interpreter and the simulation again.
//!
//! `cargo test -p tests --test joints couplings` runs one of the files. What every joint promises by itself is in `tests/laws`.

mod counts;
mod couplings;
mod derivatives;
mod fallback;
mod flat;
mod interface;
mod loads;
mod masses;
mod mechanisms;
mod redundant;
mod run;
mod shafts;
mod singular;
mod told;
mod transmitted;
mod turns;
