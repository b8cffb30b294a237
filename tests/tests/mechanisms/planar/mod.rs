//! Planar scenes: the laws, every joint, and generated code.

mod generated;
mod joints;
mod laws;
mod without_rows;
