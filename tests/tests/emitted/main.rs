//! Emitted code against the laws and the generic solver, and what users see of it.
//!
//! `cargo test -p tests --test emitted accelerations` runs one of the files.

mod accelerations;
mod agreement;
mod equations;
mod generated;
mod interface;
mod laws;
mod only_what_is_required;
mod scenes;
mod through_rustc;
