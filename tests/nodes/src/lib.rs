//! Equilibrium points and networks of them as problems of their own, of kinds that try the solver, and what solving many of them came to.

pub mod families;
pub mod networks;
pub mod web;
