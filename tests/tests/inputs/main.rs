//! Starts, states, inputs and controllers.
//!
//! `cargo test -p tests --test inputs control` runs one of the files.

mod assembly;
mod control;
mod declared_starts;
mod driving;
mod lets;
mod other_params;
mod placed_anywhere;
mod refused;
mod starts;
mod state_space;
mod states;
mod user_states;
