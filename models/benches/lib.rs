//! Benchmarks of ready scenes; see `parachute.rs` and `joints/main.rs`.
