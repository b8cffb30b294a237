//! The laws on numbers, against closed forms, reference data and each other. One binary, because each would compile the laws again.
//!
//! `cargo test -p laws joints::contract` runs one of the files.

mod along;
mod balances;
mod formulas;
mod gravity;
mod joints;
mod lines;
mod motions;
mod nodes;
mod relative;
mod things;
