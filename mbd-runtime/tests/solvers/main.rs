//! What integrators, the batch and its lanes do with models of every kind: orders, promises of reliability, bits that stay the same.
//!
//! `cargo test -p mbd-runtime --test solvers lanes` runs one of the files.

mod batch;
mod beside;
mod beside_joints;
mod lanes;
mod methods;
mod orders;
mod parachute;
mod reliability;
mod same_bits;
mod step_asks;
mod stiff;
mod support;
