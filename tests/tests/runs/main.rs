//! What a run promises: its accuracy, its events and actions, what it measures, and where it ends.
//!
//! `cargo test -p tests --test runs accuracy` runs one of the files.

mod accuracy;
mod actions;
mod closed_forms;
mod conservation;
mod costs;
mod everywhere;
mod far_away;
mod fast_outputs;
mod growing;
mod invariance;
mod known_jumps;
mod long_runs;
mod measures;
mod metrics;
mod no_number;
mod origin;
mod precision;
mod pulses;
mod resumed;
mod rounded_guards;
mod sampled_outputs;
mod snapshots;
mod time_jumps;
mod told_events;
mod too_long;
mod two_sides;
mod wanted_errors;
mod without_mass;
