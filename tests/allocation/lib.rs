//! What a run allocates is counted in `tests/steps.rs`.
