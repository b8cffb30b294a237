//! Equilibrium points: one binary, because each would link the node solvers, the generic solver and the simulation again.
//!
//! `cargo test -p tests --test nodes families` runs one of the files.

mod common;
mod counterexamples;
mod derivatives;
mod families;
mod large_networks;
mod linearise;
mod models;
mod networks;
mod parachute;
mod rank;
