//! Lines, the points where they meet, and what tables say of their force.
//!
//! `cargo test -p tests --test lines dampers` runs one of the files.

mod dampers;
mod nodes;
mod parachute;
mod table_lines;
mod tables;
mod wound_lines;
