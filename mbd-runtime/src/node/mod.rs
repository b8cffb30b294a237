//! Nodes: massless points where lines meet and balance.
pub mod balance;
pub mod confluence;
mod error;
pub mod factor;
mod law;
pub mod solver;

pub use balance::{Balance, Evaluation};
pub use confluence::{Confluence, Equilibrium, Tie, Web, WebBalance, WebLine};
pub use error::NodeError;
pub use factor::BlockCholesky;
pub use solver::{Outcome, Rung, Solver, Tolerance};
