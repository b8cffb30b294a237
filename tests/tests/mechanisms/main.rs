//! Bodies, joints, trees and loops, in both families of coordinates, and what drives them.
//!
//! `cargo test -p tests --test mechanisms joints::couplings` runs one of the files.

mod car_axis;
mod chosen;
mod driven;
mod joints;
mod joints_generated;
mod linear;
mod motors;
mod motors_by_input;
mod planar;
mod prescribed;
mod rattle;
mod relative;
mod robots;
mod shapes;
