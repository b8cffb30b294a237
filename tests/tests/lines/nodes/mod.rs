//! Equilibrium points.

mod common;
mod counterexamples;
mod derivatives;
mod families;
mod large_networks;
mod light_points;
mod linearise;
mod models;
mod moving_loads;
mod networks;
mod parachute;
mod rank;
